r"""
Natural frequencies of an embankment dam
========================================

A dam of height H and shear wave velocity c vibrates across its axis. Taken as a truncated wedge
that deforms in shear alone, with the same motion on every level (as in G. Gazetas 1982, Int. J.
Numer. Anal. Meth. Geomech. 6, 219), it has frequencies in closed form. With a crest of
:math:`\lambda` times the width of the base

.. math:: f_k = \frac{(1 - \lambda)\, \beta_k\, c}{2 \pi H}, \qquad
   J_0(\beta) Y_1(\lambda \beta) = Y_0(\beta) J_1(\lambda \beta) ,

and without a crest the zeros 2.405, 5.520, ... of :math:`J_0` (Mononobe, Takata and Matumura 1936).
Finite elements whose levels move as a whole have these frequencies; free ones also bend, and their
first frequency is a tenth lower.
"""

# %%
# Model
# -----
# Masses are unit weights over the acceleration of gravity.

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq
from scipy.special import j0, j1, y0, y1
from skfem import Basis, ElementQuad2, ElementTriP2, ElementVector, MeshQuad, MeshTri

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
# The shear beam
# --------------
# Without vertical displacements, and with a Poisson's ratio near 1/2, levels keep their width: the
# model is the shear beam. Its lowest four frequencies are the closed form within 0.2 %.


def shear_beam(crest, count=4):
    """Frequencies of a dam whose crest has a share of the width of its base."""

    def condition(beta):
        return j0(beta) * y1(crest * beta) - y0(beta) * j1(crest * beta)

    tried = np.linspace(0.5, 40, 4000)
    change = np.flatnonzero(np.diff(np.sign(condition(tried))))[:count]
    roots = [brentq(condition, tried[k], tried[k + 1]) for k in change]
    return (1 - crest) * np.array(roots) * c / (2 * np.pi * H)


def level_dam(crest, slope=2.0, nu=0.499):
    """Model of a dam with a crest, whose levels move along x as a whole."""
    grid = MeshQuad.init_tensor(np.linspace(-1, 1, 9), np.linspace(0, 1, 13))
    x, y = grid.p
    wide = slope * H / (1 - crest) * (1 - (1 - crest) * y)
    mesh = MeshQuad(np.stack((x * wide, H * y)), grid.t)
    base = mesh.with_boundaries({"base": mesh.facets_satisfying(lambda x: x[1] < 1e-9)})
    basis = Basis(base, ElementVector(ElementQuad2()), intorder=5)
    elastic = sc.LinearElastic(E=2 * density * c**2 * (1 + nu), nu=nu)
    fill = sc.SolidForm(basis, elastic, unit_weight=9.81 * density)
    vertical = np.arange(1, basis.N, 2)
    fixed = [basis.get_dofs("base").all(), vertical]
    return sc.Model({"dam": fill}, fixed, gravity_acceleration=9.81)


errors = []
for crest in (0.02, 0.1, 0.25, 0.5):
    closed = shear_beam(crest)
    found = level_dam(crest).frequencies(4, mass="consistent")
    errors.append(np.abs(found / closed - 1).max())
    print(f"crest {crest:4.2f}   {found.round(3)} Hz, largest error {errors[-1]:.2%}")

# %%
# Modes of a dam that is free to bend
# -----------------------------------
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

assert max(errors) < 0.002
assert np.allclose(shear_beam(1e-4, 2), np.array([2.4048, 5.5201]) * c / (2 * np.pi * H), rtol=1e-3)
assert ((ratio[2:] > 0.85) & (ratio[2:] < 0.92)).all()
assert ratio[0] < 0.75  # steep walls bend: a cantilever has a lower frequency
print(
    json.dumps(
        {
            "case": "frequencies",
            "rows": [
                {
                    "method": "Q2, four modes of the shear beam",
                    "n": 12,
                    "unknowns": int(level_dam(0.1).forms["dam"].basis.N),
                    "error": float(max(errors)),
                    "cpu_s": None,
                    "iterations": 0,
                }
            ],
        }
    )
)
# sphinx_gallery_end_ignore
