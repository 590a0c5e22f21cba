"""
An anchored wall in four stages, meshed by Gmsh
===============================================

Tutorial five: a sheet pile wall from a Gmsh file. ``anchored_pit.geo``, which stands beside this
script, describes the ground as three surfaces: ``ground`` and two lifts of a pit. A *physical
curve* inside them, ``wall``, is where the wall will be; it ends 9 m below the surface. ``gmsh -2
-format msh22 anchored_pit.geo`` makes the mesh. Units are kN and m.
"""

import numpy as np
from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("kN", "m")

# %%
# From the file to a mesh with a slit
# -----------------------------------
# ``split_along`` doubles the nodes of the curve, so that the ground can slip along the wall, and
# names the two sides. The toe stays single. The left side belongs to three bodies, two of which
# will be dug out: each part of it gets a name of its own, which later names the contact of the wall
# with this body.

mesh = sc.split_along(sc.load_mesh("anchored_pit.msh"), "wall")
left = mesh.boundaries["wall|left"]
bodies = ("ground", "lift 1", "lift 2")
mesh = mesh.with_boundaries(
    {f"wall|{name}": left[np.isin(mesh.f2t[0, left], mesh.subdomains[name])] for name in bodies}
)
basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)

# %%
# Ground, wall and anchor
# -----------------------
# The wall is a beam along the slit with nodes of its own. ``wall.contact`` makes one contact pair
# for each side that is named, with two thirds of the strength of the sand. The anchor is a bar from
# a node of the wall to the head of its grouted body, a beam inside the elements whose skin resists
# up to 120 kN per metre. Anchors stand 2 m apart: with ``spacing`` stiffnesses and forces are those
# of one anchor.

sand = sc.MohrCoulomb(E=4e4, nu=0.3, c=3.0, phi=30.0, psi=2.0)
wall = sc.Beam(basis, "wall|right", EI=4e4, EA=3e6, bonded=False)
grout = sc.Beam(None, np.linspace((7.0, -5.0), (11.0, -7.0), 6), EI=10.0, EA=2e5, spacing=2.0)
forms = {name: sc.SolidForm(basis.with_elements(name), sand, unit_weight=19.0) for name in bodies}
forms |= {
    "wall": wall,
    **wall.contact(
        basis,
        sc.Coulomb.from_soil(sand, 2 / 3),
        ["wall|right", *(f"wall|{name}" for name in bodies)],
    ),
}
forms |= {
    "grout": grout,
    "skin": sc.Embedded(basis, grout, T_max=120.0),
    "anchor": sc.Bar(None, wall.at((0.0, -1.5)), grout.at((7.0, -5.0)), EA=1e5, spacing=2.0),
}
model = sc.Model(forms, sc.box_supports(basis))

# %%
# Four stages
# -----------
# The wall is there at the beginning, in ground at rest that does not feel it; the anchor, which the
# start holds as well, is taken away in the first stage. A lift is dug by deactivation of its body
# and of its contact. The anchor is stressed by a jack that keeps its force, ``prestressed``, and
# locked in the next stage, where the bar itself continues from this force. A warning says that the
# head lost its adhesion: the wall left the sand there as it leaned into the pit, and the anchor
# pulls it back.

street = sc.traction(basis, "street", (0.0, -15.0))
anchor = ["grout", "skin", "anchor"]
stages = [
    sc.Stage("dig 1", deactivate=["lift 1", "wall|lift 1", *anchor], increments=2),
    sc.Stage("stress", activate=anchor, change={"anchor": forms["anchor"].prestressed(200.0)}),
    sc.Stage("dig 2", deactivate=["lift 2", "wall|lift 2"], change={"anchor": forms["anchor"]}),
    sc.Stage("street", street),
]
result = model.run(stages, start=model.k0_state(K0=0.46))
print(result)

# %%
# What the wall bears
# -------------------
# Section forces run along the wall from its head. The envelope has the extremes of all stages, and
# says which stage they come from; states on the way through a stage do not count.

envelope = result.envelope("wall")
print(envelope)
plot.diagram({stage.name: stage.section_forces("wall") for stage in result}, "M", upright=True)

# %%
# The moments on the wall itself, and what settles behind it.
# ``model.strength_reduction(start=result)`` computes the factor of safety: see
# :doc:`an anchored wall in stages </gallery/4_pits_and_walls/plot_anchored_wall>`.

plot.diagram(
    result["street"].section_forces("wall"), "M", on=result["street"], window=(-6, 8, -11, 1)
)
plot.contour(result["street"], "uy")

# sphinx_gallery_start_ignore
import json

stage = result["dig 2"]
force, V = float(stage.states["anchor"].force[0]), stage.section_forces("wall")
# the anchor pulls the wall: its shear force jumps by the level part of the force, but for friction
# beside the node
at = np.flatnonzero(abs(V.y + 1.5) < 1e-9)
error = abs(abs(V.V[at[1]] - V.V[at[0]]) / (force / 2.0 * 7.0 / np.hypot(7.0, 3.5)) - 1.0)
# the skin of the grouted body bears the anchor's force; section forces take the skin as constant
# along an element
assert abs(stage.section_forces("grout").N[0] * 2.0 / force - 1.0) < 0.01
assert error < 5e-3 and abs(V.M[[0, -1]]).max() < 1e-6 and 190.0 < force < 240.0
assert (
    result["street"].section_forces("wall").M.min() < V.M.min() < -10.0
)  # the load of the street bends the wall more
print(
    json.dumps(
        {
            "case": "anchored pit",
            "rows": [
                {
                    "method": "from Gmsh",
                    "n": 1,
                    "unknowns": int(model.layout.size),
                    "error": error,
                    "cpu_s": None,
                    "iterations": int(sum(sum(stage.iterations) for stage in result)),
                }
            ],
        }
    )
)
# sphinx_gallery_end_ignore
