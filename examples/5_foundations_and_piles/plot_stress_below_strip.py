r"""
Stresses below a strip, and the trough beside it
================================================

A flexible strip of 2 m with 100 kPa lies on elastic ground. Values are read at points and along
lines, as a designer asks for them: stresses below the centre, the trough of the surface, and the
history of two points. Below the centre Boussinesq's stress of a half-space is
:math:`\sigma_z = q/\pi\,(\alpha + \sin\alpha)` with the angle
:math:`\alpha = 2 \arctan(b / 2 z)` that the strip subtends.
"""

import json
from time import process_time

import numpy as np
from skfem import Basis, ElementQuad2, ElementVector, MeshQuad

import skfem_contact as sc

begin = process_time()
sc.set_units("kN", "m")  # in all tables and pictures

# %%
# Half of the ground, 30 m wide and deep, with small elements near the strip. The load acts on the
# part of the surface from x = 0 to 1 m.
lines = np.concatenate((np.linspace(0.0, 2.0, 13), np.geomspace(2.3, 30.0, 14)))
mesh = MeshQuad.init_tensor(lines, -lines[::-1]).with_defaults()
mesh = mesh.with_boundaries({"strip": lambda x: (np.abs(x[1]) < 1e-9) & (x[0] < 1.0)})
basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
ground = sc.SolidForm(basis, sc.LinearElastic(E=2e4, nu=0.3))
model = sc.Model({"ground": ground}, sc.box_supports(basis))
load = model.traction("strip", (0.0, -100.0))
stages = [sc.Stage("half", 0.5 * load), sc.Stage("whole", load)]
result = model.run(stages)
stage = result["whole"]

# %%
# At points, as a table with units:
depths = np.array([0.5, 1.0, 2.0, 4.0])
points = {f"{z:g} m below": (0.0, -z) for z in depths}
below = stage.at(points, "syy", "sxx", "uy")
print(below)
angle = 2.0 * np.arctan(1.0 / depths)
by_hand = -100.0 / np.pi * (angle + np.sin(angle))
error = np.abs(below["syy"] / by_hand - 1.0)
print("by hand:", by_hand.round(1), "kPa")
assert error.max() < 0.01  # the ground ends at 30 m

# %%
# Along lines, as pictures: stresses below the centre, and the trough of the surface.
stage.along([(0.0, 0.0), (0.0, -8.0)], "syy", "sxx").plot()

# %%
trough = stage.along([(0.0, 0.0), (10.0, 0.0)], "uy", n=201)
trough.plot()
assert trough["uy"].argmin() == 0

# %%
# Through the stages; elastic ground settles in proportion to the load.
histories = result.at({"centre": (0.0, 0.0), "edge": (1.0, 0.0)}, "uy")
histories.plot()
print(histories)
centre = histories["uy"][histories["point"] == "centre"]
assert np.isclose(centre[1], 2.0 * centre[0], rtol=1e-9)

# %%
# Every table is written by ``to_csv`` and becomes a data frame by ``to_frame``.
print(below.to_csv())
sc.set_units()
row = {
    "method": "points",
    "n": mesh.nelements,
    "unknowns": int(basis.N),
    "error": float(error.max()),
}
row |= {"cpu_s": process_time() - begin, "iterations": 2}
print(json.dumps({"case": "stress below strip", "rows": [row]}))
