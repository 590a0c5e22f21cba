r"""
Cook's membrane of steel
========================

A tapered panel of hardening steel is held at its left side and sheared at its right one. Plastic
flow keeps the volume: elements of four nodes lock, and move by a third of the right amount. With
F-bar, the default of ``kinematics="finite"`` for a law that flows, they converge as elements of
second order do, to 6.9 mm at the upper corner (Simo and Armero 1992, de Souza Neto et al. 1996).
"""

import json
from time import process_time

import numpy as np
from skfem import Basis, ElementQuad1, ElementQuad2, ElementVector, MeshQuad
from steel import Steel

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("kN", "mm")


def panel(n):
    """Mesh of n times n elements between heights of 44 and 16 at a length of 48 mm."""
    grid = MeshQuad.init_tensor(*[np.linspace(0.0, 1.0, n + 1)] * 2).with_defaults()
    x, y = grid.p
    points = np.array([48.0 * x, 44.0 * x * (1.0 - y) + y * (44.0 + 16.0 * x)])
    return MeshQuad(points, grid.t, _boundaries=grid.boundaries)


def sheared(n, element, order, strain=None):
    """Run the panel; return the last stage and the rise of its upper corner."""
    basis = Basis(panel(n), ElementVector(element), intorder=order)
    body = sc.SolidForm(basis, Steel(), strain, kinematics="finite")
    model = sc.Model({"panel": body}, basis.get_dofs("left").all())
    load = model.traction("right", (0.0, 5.0 / 16.0))
    stage = model.run([sc.Stage("shear", load, increments=10)])["shear"]
    corner = sc.dofs_at(basis, (48.0, 60.0)).ravel()
    return stage, float(stage.x[corner[1]])


# %%
# The default, elements of second order, and four-node elements with their own volumes at each
# point, which lock.

cases = {
    "Q1, F-bar": (ElementQuad1(), 2, None, (8, 16, 32)),
    "Q2": (ElementQuad2(), 4, None, (8, 16)),
    "Q1, full": (ElementQuad1(), 2, "full", (8,)),
}
rows = []
for method, (element, order, strain, sizes) in cases.items():
    for n in sizes:
        start = process_time()
        stage, rise = sheared(n, element, order, strain)
        print(f"{method:10s} {n:3d} elements a side: {rise:.3f} mm")
        rows.append(
            {
                "method": method,
                "n": n,
                "unknowns": len(stage.x),
                "error": abs(rise / 6.9 - 1.0),
                "cpu_s": process_time() - start,
                "iterations": sum(stage.iterations),
            }
        )

# %%
# The plastic strain of the finest four-node mesh.

stage, rise = sheared(32, ElementQuad1(), 2)
plot.contour(stage, "plastic")

by_case = {(row["method"], row["n"]): row["error"] for row in rows}
# the published 6.9 has two digits
assert by_case["Q1, F-bar", 32] < 0.01
assert by_case["Q2", 16] < 0.02
assert by_case["Q1, full", 8] > 0.5
print(json.dumps({"case": "cook", "rows": rows}))
