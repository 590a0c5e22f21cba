r"""
Slope in Hoek-Brown rock
========================

A slope of 45 degrees, 10 m high, in a poor rock mass: :math:`\sigma_{ci}` = 30 MPa, :math:`m_b` =
0.067,
:math:`s` = 2.5e-5, :math:`a` = 0.619, 25 kN/m³.  R. E. Hammah, T. E. Yacoub, B. Corkum, J. H.
Curran (40th U.S. Symposium on Rock Mechanics, 2005, 05-810) found a factor of safety of 1.15 by
strength reduction and 1.152 by limit equilibrium.

A strength reduction divides the shear strength on every plane by the factor: cohesion and
:math:`\tan\varphi` of every tangent of the curved envelope are divided.  The lower bound has chords
of the envelope, the upper one tangents.
"""

# %%
# Strength reduction
# ------------------

import json
import warnings
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshQuad

import skfem_contact as sc

PUBLISHED = 1.15
rock = sc.HoekBrown(E=5e6, nu=0.3, sigma_ci=30e3, m_b=0.067, s=2.5e-5, a=0.619)


def slope(size: float) -> sc.Model:
    """Ground with its toe at the origin and elements of about a size."""
    x, y = np.arange(-22.5, 10.1, size), np.arange(-7.5, 10.1, size)
    grid = MeshQuad.init_tensor(x, y).to_meshtri(style="x")
    middle = grid.p[:, grid.t].mean(axis=1)
    basis = Basis(
        grid.restrict(np.flatnonzero((middle[1] < 0) | (middle[1] < -middle[0]))),
        ElementVector(ElementTriP2()),
        intorder=2,
    )
    sides = basis.get_dofs(lambda x: np.isclose(x[0], -22.5) | np.isclose(x[0], 10.0)).all("u^1")
    fixed = np.concatenate((basis.get_dofs(lambda x: np.isclose(x[1], -7.5)).all(), sides))
    return sc.Model({"rock": sc.SolidForm(basis, rock, unit_weight=25.0)}, fixed)


begin = process_time()
model = slope(1.25)
found = model.strength_reduction(flow="associated", certify=False)
error = found.factor / PUBLISHED - 1.0
rows = [
    {
        "method": "strength reduction, psi = phi",
        "n": 8,
        "unknowns": int(model.forms["rock"].basis.N),
        "error": abs(error),
        "cpu_s": round(process_time() - begin, 2),
        "iterations": found.iterations,
    }
]
print(f"factor {found.factor:.3f}, published {PUBLISHED}")
assert abs(error) < 0.03

# %%
# Bounds
# ------
# A few hundred triangles take as long as the elements and leave a gap, which a finer mesh closes.
begin = process_time()
with warnings.catch_warnings():
    warnings.simplefilter("ignore", sc.AnalysisWarning)
    proof = slope(5.0 / 2.0).bounds(flow="associated", elements=450)
print(proof)
assert proof.lower < PUBLISHED < proof.upper
assert proof.lower < found.factor < 1.01 * proof.upper
rows.append(
    {
        "method": "gap of the bounds",
        "n": 4,
        "unknowns": 0,
        "error": proof.gap,
        "cpu_s": round(process_time() - begin, 2),
        "iterations": 0,
    }
)

# %%
# Mechanism
# ---------
mesh = proof.mesh
a, b, c = mesh.p[:, mesh.t].transpose(1, 0, 2)
power = proof.dissipation / np.abs((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0])
fig, ax = plt.subplots(figsize=(7, 3.6), layout="constrained")
ax.tripcolor(*mesh.p, mesh.t.T, np.minimum(power / np.quantile(power, 0.97), 1.0), cmap="magma_r")
ax.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", title="dissipation of the upper bound")
plt.show()

# %%
# Headline numbers
# ----------------
print(json.dumps({"case": "slope in Hoek-Brown rock", "rows": rows}))
