"""
A block on sand, meshed by Gmsh
===============================

Tutorial three: a mesh of your own. ``block_on_sand.geo``, which stands beside this script,
describes a block of concrete on sand; ``gmsh -2 -format msh22 block_on_sand.geo`` makes the mesh.
Its *physical surfaces* become subdomains, its *physical curves* boundaries. Units are kN and m.

In Gmsh's mesh both bodies share the nodes between them. ``join_bodies`` takes them apart, and names
the two sides of the joint ``sand|block`` and ``block|sand``.
"""

import numpy as np
from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("kN", "m")
mesh = sc.join_bodies(
    sc.load_mesh("block_on_sand.msh"), bodies={"sand": "sand", "block": "concrete"}
)
basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)

sand = sc.MohrCoulomb(E=3e4, nu=0.3, c=2.0, phi=33.0, psi=3.0)
forms = {
    "sand": sc.SolidForm(basis.with_elements("sand"), sand, unit_weight=18.0),
    "block": sc.SolidForm(
        basis.with_elements("block"), sc.LinearElastic(E=3e7, nu=0.2), unit_weight=24.0
    ),
    "joint": sc.ContactPair(
        basis, slave="sand|block", master="block|sand", law=sc.Coulomb(mu=0.5), quadrature=3
    ),
}
push = sc.traction(basis, "top", (12.0, -40.0))
result = sc.Model(forms, sc.box_supports(basis)).run(
    [sc.Stage("weight"), sc.Stage("push", push, increments=3)]
)
print(result)
print(result["push"].report("joint"))

# %%
# The load, the tractions that the sand exerts on the block, and the points that yield:
plot.contour(
    result["push"], "syy", loads=push, contact=True, points=True, window=(-3, 3, -2.2, 1.6)
)

# %%
plot.diagram({stage.name: stage.tractions("joint") for stage in result}, along="x")

# sphinx_gallery_start_ignore
import json

report = result["push"].report("joint")
expected = np.array(
    [-2 * 12.0, 2 * 1.0 * 24.0 + 2 * 40.0]
)  # what the sand exerts on the block, with the sign turned
error = float(np.abs(report.force + expected * (1, 1)).max() / expected[1])
assert error < 1e-4, (report.force, expected)
print(
    json.dumps(
        {
            "case": "block_on_sand",
            "rows": [
                {
                    "method": "P2",
                    "n": 1,
                    "unknowns": int(basis.N),
                    "error": error,
                    "cpu_s": None,
                    "iterations": int(sum(sum(stage.iterations) for stage in result)),
                }
            ],
        }
    )
)
# sphinx_gallery_end_ignore
