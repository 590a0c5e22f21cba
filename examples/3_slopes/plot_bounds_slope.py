r"""
Bounds of a slope, and a mesh to go on with
===========================================

A factor of safety without a bracket is an opinion: meshes, elements and tolerances move it. Here a
slope gets two numbers that enclose the true factor, with a proof: stresses in equilibrium below, a
mechanism above. One call does it, and refines the mesh where the two differ. Strength reduction on
that mesh comes closer to the bracket than on a uniform one of more unknowns.

The slope is example 1 of Griffiths and Lane (1999). Units are kN and m. The soil flows with
:math:`\psi = \phi`.
"""

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementTriP1, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc

# %%
# Model
# -----
# A few triangles are enough to begin with. Names of boundaries hold on every mesh.

points = np.array(
    [(-32, 0), (-20, 0), (-10, 0), (0, 0), (-32, 10), (-20, 10), (-10, 5)], dtype=float
)
triangles = np.array([(0, 1, 5), (0, 5, 4), (1, 2, 6), (1, 6, 5), (2, 3, 6)])
start = (
    MeshTri(points.T, triangles.T)
    .refined(1)
    .with_boundaries(
        {"base": lambda p: np.isclose(p[1], 0.0), "side": lambda p: np.isclose(p[0], -32.0)}
    )
)


def model(mesh):
    """The slope on any mesh with these names."""
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    soil = sc.MohrCoulomb(E=1e5, nu=0.3, c=10.0, phi=20.0, psi=20.0)
    fixed = np.append(basis.get_dofs("base").all(), basis.get_dofs("side").all("u^1"))
    return sc.Model({"soil": sc.SolidForm(basis, soil, unit_weight=20.0)}, fixed)


# %%
# Bounds
# ------
# The table has a line for every mesh and bound: what was proven, and by how much equilibrium is
# violated.

begin = process_time()
proven = model(start).bounds(gap=0.011, progress=False)
seconds = process_time() - begin
print(proven)
assert proven.gap <= 0.011
assert proven.lower < 1.3800 and proven.upper > 1.3748  # the factor lies between these two

# %%
# The mechanism
# -------------
# Velocities of the upper bound, and where it dissipates: per area, on a logarithmic scale.

mesh = proven.mesh
area = Basis(mesh, ElementTriP1()).dx.sum(axis=1)
figure, ax = plt.subplots(figsize=(9, 3.6), layout="constrained")
ax.tripcolor(
    *mesh.p, mesh.t.T, np.log10(np.maximum(proven.dissipation / area, 1e-5)), cmap="magma_r"
)
ax.triplot(*mesh.p, mesh.t.T, color="#888888", linewidth=0.2)
shown = np.arange(0, mesh.nvertices, 5)
ax.quiver(*mesh.p[:, shown], *proven.mechanism[:, shown], scale=25, width=0.0015)
title = f"factor of safety in [{proven.lower:.4f}, {proven.upper:.4f}]"
ax.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", title=title)
plt.show()

# %%
# Strength reduction on the mesh of the bounds
# --------------------------------------------
# And on a uniform one, for comparison. The factor of finite elements converges from above: no
# theorem says so, but the bracket tells how far it is.

rows = [
    {
        "method": "bounds",
        "n": mesh.nelements,
        "unknowns": proven.certificates[1].unknowns,
        "error": proven.gap,
        "cpu_s": round(seconds, 2),
        "iterations": sum(c.iterations for c in proven.history),
    }
]
middle = 0.5 * (1.3753 + 1.3779)  # of the bounds with 10,000 triangles
for name, grid in (("mesh of the bounds", mesh), ("uniform mesh", start.refined(3))):
    begin = process_time()
    reduction = model(grid).strength_reduction(tolerance=0.002, certify=False, progress=False)
    rows.append(
        {
            "method": f"strength reduction, {name}",
            "n": grid.nelements,
            "unknowns": len(reduction.x),
            "error": abs(reduction.factor / middle - 1),
            "cpu_s": round(process_time() - begin, 2),
            "iterations": reduction.iterations,
        }
    )
    print(
        f"{name}: {reduction.factor:.4f} with {len(reduction.x)} unknowns, "
        f"{reduction.factor / middle - 1:+.2%}"
    )
assert rows[1]["error"] < 0.01 and rows[1]["unknowns"] < 6000
assert rows[1]["error"] < rows[2]["error"]

print(json.dumps({"case": "bounds of a slope", "rows": rows}))
