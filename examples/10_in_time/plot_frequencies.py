r"""
Natural frequencies of an embankment dam
========================================

A dam of triangular section, height H and shear wave velocity c vibrates across its axis. Taken as
a beam that deforms in shear alone, with the same shear strain on every level, it has the
frequencies :math:`f_k = \beta_k c / (2 \pi H)` with the zeros 2.405, 5.520, ... of the Bessel
function :math:`J_0` (Mononobe, Takata and Matumura 1936). Plane finite elements also bend, and
their levels do not stay plane: their first frequency is a tenth lower.
"""

# %%
# Model
# -----
# Masses are unit weights over the acceleration of gravity.

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc
import skfem_contact.plot as plot

H, c, density, nu = 40.0, 250.0, 2.0, 0.3
E = 2 * density * c**2 * (1 + nu)

# %%
# The section is a square grid that narrows towards the crest.


def section(slope, n=10):
    """Basis of a dam with a slope of `slope` : 1 on both sides, whose crest is narrow."""
    grid = MeshTri.init_tensor(np.linspace(-1, 1, 4 * n + 1), np.linspace(0, 1, n + 1))
    x, y = grid.p
    wide = slope * H * (1 - 0.98 * y)
    mesh = MeshTri(np.stack((x * wide, H * y)), grid.t).with_defaults()
    base = {"base": mesh.facets_satisfying(lambda x: x[1] < 1e-9)}
    return Basis(mesh.with_boundaries(base), ElementVector(ElementTriP2()), intorder=4)


def dam(slope):
    """Model of the dam on rock."""
    basis = section(slope)
    fill = sc.SolidForm(basis, sc.LinearElastic(E=E, nu=nu), unit_weight=9.81 * density)
    return sc.Model({"dam": fill}, basis.get_dofs("base").all(), gravity_acceleration=9.81)


# %%
# Modes
# -----
# The table has the share of the mass that each mode moves along x and y.

modes = dam(2.0).modes(6)
print(modes)

# %%
plot.contour(modes.stage(0), "ux", deformed="auto")

# %%
# Steep dams bend
# ---------------
# The flatter the slopes, the less the dam bends, and the less its levels move as a whole. In
# between the shear beam is best.

beam = 2.405 * c / (2 * np.pi * H)
slopes = np.array([0.5, 0.75, 1.0, 1.5, 2.0, 3.0])
first = []
for slope in slopes:
    found = dam(slope).modes(6)
    first.append(found.frequencies[np.argmax(found.effective[:, 0])])
ratio = np.array(first) / beam
for slope, value in zip(slopes, ratio):
    print(f"slope {slope:.2f} : 1   first frequency {value:.3f} of the shear beam")

fig, ax = plt.subplots(figsize=(6, 3.5), layout="constrained")
ax.axhline(1.0, color="k", lw=0.5)
ax.plot(slopes, ratio, "o-")
ax.set(xlabel="slope, width : height", ylabel="frequency / shear beam", ylim=(0, 1.1))

# sphinx_gallery_start_ignore
import json

assert ((ratio[2:] > 0.85) & (ratio[2:] < 0.92)).all()
assert ratio[0] < 0.75  # steep walls bend: a cantilever has a lower frequency
print(
    json.dumps(
        {
            "case": "frequencies",
            "rows": [
                {
                    "method": "T6",
                    "n": 10,
                    "unknowns": 3402,
                    "error": None,
                    "cpu_s": None,
                    "iterations": 0,
                }
            ],
        }
    )
)
# sphinx_gallery_end_ignore
