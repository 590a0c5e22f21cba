"""
A block on sand, meshed by Gmsh
===============================

Tutorial three: a mesh of your own. ``block_on_sand.geo``, which stands beside this script,
describes a block of concrete on sand; ``gmsh -2 -format msh22 block_on_sand.geo`` makes the mesh.
Its *physical surfaces* become subdomains, its *physical curves* boundaries. Units are kN and m.

In Gmsh's mesh both bodies share the nodes between them. ``join_bodies`` takes them apart, and names
the two sides of the joint ``sand|block`` and ``block|sand``.
"""

import json

import numpy as np
from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("kN", "m")
bodies = {"sand": "sand", "block": "concrete"}
mesh = sc.join_bodies(sc.load_mesh("block_on_sand.msh"), bodies=bodies)
basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)

sand = sc.MohrCoulomb(E=3e4, nu=0.3, c=2.0, phi=33.0, psi=3.0)
concrete = sc.LinearElastic(E=3e7, nu=0.2)
forms = {
    "sand": sc.SolidForm(basis.with_elements("sand"), sand, unit_weight=18.0),
    "block": sc.SolidForm(basis.with_elements("block"), concrete, unit_weight=24.0),
    "joint": sc.ContactPair(basis, "sand|block", "block|sand", sc.Coulomb(mu=0.5), quadrature=3),
}
push = sc.traction(basis, "top", (12.0, -40.0))
stages = [sc.Stage("weight"), sc.Stage("push", push, increments=3)]
result = sc.Model(forms, sc.box_supports(basis)).run(stages)
print(result)
print(result["push"].contact("joint"))

# %%
# The load, the tractions that the sand exerts on the block, and the points that yield:
plot.contour(
    result["push"], "syy", loads=push, contact=True, points=True, window=(-3, 3, -2.2, 1.6)
)

# %%
plot.diagram({stage.name: stage.tractions("joint") for stage in result}, along="x")

# sphinx_gallery_start_ignore
report = result["push"].contact("joint")
by_hand = np.array([2 * 12.0, -2 * 1.0 * 24.0 - 2 * 40.0])  # push and weight, on the sand
error = float(np.abs(report.force - by_hand).max() / 128.0)
assert error < 1e-4, (report.force, by_hand)
iterations = sum(sum(stage.iterations) for stage in result)
row = {"method": "P2", "n": 1, "unknowns": int(basis.N), "error": error}
row |= {"cpu_s": None, "iterations": iterations}
print(json.dumps({"case": "block_on_sand", "rows": [row]}))
# sphinx_gallery_end_ignore
