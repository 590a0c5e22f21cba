"""
A press fit in millimetres and newtons
======================================

A hollow shaft of steel is pressed into a ring of bronze; it is 0.04 mm larger than the hole in
radius. A quarter is computed, with curved elements of second order. The meshes fit, and the
interference is a number of the contact pair. Lamé's formula for two thick rings gives the pressure.
"""

import numpy as np
from skfem import Basis, ElementQuad2, ElementVector, MeshQuad, MeshQuad2

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("N", "mm")
steel, bronze = sc.LinearElastic(E=210e3, nu=0.3), sc.LinearElastic(E=110e3, nu=0.34)
a, b, c, interference = 10.0, 25.0, 40.0, 0.04


def quarter_ring(inner, outer, n):
    """A quarter of a ring whose edges are curved."""
    grid = MeshQuad.init_tensor(np.linspace(inner, outer, 6), np.linspace(0, np.pi / 2, n + 1))
    second = MeshQuad2.from_mesh(grid)
    r, angle = second.doflocs
    sides = {
        "inner": grid.facets_satisfying(lambda x: x[0] < inner + 1e-9),
        "outer": grid.facets_satisfying(lambda x: x[0] > outer - 1e-9),
    }
    return MeshQuad2(np.stack((r * np.cos(angle), r * np.sin(angle))), second.t).with_boundaries(
        sides
    )


mesh = sc.join_bodies({"shaft": quarter_ring(a, b, 12), "ring": quarter_ring(b, c, 16)})
basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
forms = {
    "bodies": sc.SolidForm(basis, {"shaft": steel, "ring": bronze}),
    "fit": sc.ContactPair(
        basis, "ring:inner", "shaft:outer", sc.Coulomb(), quadrature=3, initial=interference
    ),
}
left, bottom = (
    basis.get_dofs(lambda x: x[0] < 1e-9),
    basis.get_dofs(lambda x: x[1] < 1e-9),
)  # symmetry
result = sc.Model(forms, [left.all("u^1"), bottom.all("u^2")]).run([sc.Stage("fit")])
pressure = result["fit"].tractions("fit").pressure
print(f"pressure {pressure.mean():.1f} MPa, between {pressure.min():.1f} and {pressure.max():.1f}")

# %%
plot.contour(result["fit"], "mises", deformed=1.0)

# sphinx_gallery_start_ignore
import json

(E1, n1), (E2, n2) = (
    (m.E / (1 - m.nu**2), m.nu / (1 - m.nu)) for m in (steel, bronze)
)  # plane strain
exact = interference / (
    b * (((c**2 + b**2) / (c**2 - b**2) + n2) / E2 + ((b**2 + a**2) / (b**2 - a**2) - n1) / E1)
)
error = abs(pressure.mean() / exact - 1)
assert error < 0.02, (pressure.mean(), exact)
print(
    json.dumps(
        {
            "case": "press_fit",
            "rows": [
                {
                    "method": "Q2",
                    "n": 12,
                    "unknowns": int(basis.N),
                    "error": error,
                    "cpu_s": None,
                    "iterations": sum(result["fit"].iterations),
                }
            ],
        }
    )
)
# sphinx_gallery_end_ignore
