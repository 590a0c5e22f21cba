r"""
The buried culvert, stage by stage
==================================

A concrete pipe lies in two layers of soil. First gravity acts, then a surcharge on one side of the
ground surface. What presses on the pipe, does the soil slip along it, and what must its wall carry?

This is example 1 of *Implementation of Computational Contact Analysis in Geotechnical Engineering*.
The paper fixes the pipe (diameters 1.80 m and 1.44 m, concrete with :math:`E = 2.8 \cdot 10^7`
kPa), the friction between concrete and soil (0.6), the two stages and the surcharge (35 kPa). The
soils, the depth of cover and the position of the surcharge stood in a figure that we do not have:
**they are our choice**, and so are the magnitudes that come out. What the paper says of its results
is checked at the end.

Units are kN and m. Tension is positive.
"""

# %%
# Mesh
# ----
# The file comes from Gmsh; its physical groups are scikit-fem's subdomains and boundaries. The pipe
# and the ground share the nodes of their interface there. ``join_bodies`` takes them apart: each
# side of the interface gets nodes of its own, and a name. ``ground|culvert`` is the side of the
# ground.

import json
from importlib.resources import files
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad1, ElementVector, FacetBasis, LinearForm

import skfem_contact as sc
import skfem_contact.plot as plot
from skfem_contact.contact.laws import Status
from skfem_contact.contact.penalty import choose_penalties

plot.set_units("kN", "m")

begin = process_time()
welded = sc.load_mesh(files("skfem_contact") / "data" / "culvert.msh")
mesh = sc.join_bodies(welded, bodies={"ground": ["soft", "stiff"], "culvert": "culvert"})
basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
print(mesh)

# %%
# What carries load
# -----------------
# Both soils are Mohr-Coulomb materials; the layers meet at mid-height of the pipe, the soft one
# above. ``b_bar`` keeps four-node quadrilaterals from locking when soil yields.
#
# The ground is the softer body and therefore the slave: contact is looked for at its nodes, the
# paper's node-to-segment rule. The pipe's surface is a polygon; ``smoothing`` rounds its corners,
# as the paper advises, and ``initial="adjusted"`` closes the small gap that this makes. The penalty
# is chosen from the stiffness of the elements.

soils = {
    "soft": sc.MohrCoulomb(E=1e4, nu=0.40, c=5.0, phi=25.0),
    "stiff": sc.MohrCoulomb(E=5e4, nu=0.35, c=10.0, phi=35.0),
}
concrete = sc.LinearElastic(E=2.8e7, nu=0.2)

forms = choose_penalties(
    {
        "ground": sc.SolidForm(basis.with_elements("ground"), soils, strain="b_bar"),
        "culvert": sc.SolidForm(basis.with_elements("culvert"), concrete, strain="b_bar"),
        "skin": sc.ContactPair(
            basis,
            slave="ground|culvert",
            master="culvert|ground",
            law=sc.Coulomb(mu=0.6),
            quadrature="nodal",
            smoothing=0.5,
            initial="adjusted",
        ),
    }
)

# %%
# Loads and supports
# ------------------
# Loads are vectors, added up as needed. The surcharge stands on a strip of 1.80 m to the right of
# the pipe's axis. The bottom of the ground is held, its sides are held horizontally.

gravity = sc.weight(basis, {"soft": 18.0, "stiff": 20.0, "culvert": 25.0})

surface = FacetBasis(mesh, basis.elem, facets="surface")
strip = LinearForm(lambda v, w: -35.0 * v[1] * (w.x[0] > 0.0) * (w.x[0] < 1.8)).assemble(surface)

fixed = np.concatenate(
    (basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
)

# %%
# Two stages
# ----------
# A stage is the whole load at its end, and it starts from what the bodies carry: the second adds
# the strip to the stresses that gravity has left. The table says that nothing slips and nothing
# opens, in either stage.

result = sc.Model(forms, fixed).run(
    [sc.Stage("gravity", gravity), sc.Stage("surcharge", gravity + strip)]
)
cpu = process_time() - begin
print(result)

# %%
# The settlement that the surcharge adds, displacements enlarged, with the undeformed outline in
# grey; and what the ground exerts on the pipe at the end:

plot.contour(
    result["surcharge"], "uy", since=result["gravity"], deformed="auto", contact=True, loads=strip
)

# %%
# What presses on the pipe
# ------------------------
# ``tractions`` lists pressure, friction, gap, slip and status at the points of the interface.
# Angles are measured from the crown, clockwise. Friction is that on the pipe, positive clockwise.

skin = {stage.name: stage.tractions("skin") for stage in result}
angle = skin["gravity"].central_angle()

plot.diagram(
    {name: points.pressure for name, points in skin.items()}, "contact pressure (kPa)", angle=angle
)

# %%
# Under gravity the pressure is symmetric, and low at both sides, where the layers meet. The
# surcharge presses from the upper right and spoils the symmetry; the smallest pressure is now found
# at 90 degrees, at *the right interface between soft and stiff soil*.

plot.diagram({name: points.shear for name, points in skin.items()}, "friction (kPa)", angle=angle)

# %%
# The soil drags the upper half of the pipe down, and holds the lower half up. Nowhere does the
# friction reach its limit of 0.6 times the pressure:

for name, points in skin.items():
    print(
        f"{name:10} largest friction / pressure = {abs(points.shear / points.pressure).max():.2f}"
    )

# %%
# What the wall carries
# ---------------------
# ``section_forces`` cuts the ring and sums the nodal forces at every cut. The normal force is
# positive in tension, so that a thrust is negative; the moment is positive where it stretches the
# outer fibres.

cuts = sc.Cuts.ring(center=(0.0, 0.0), inner=0.72, outer=0.90, n=72)
ring = {stage.name: stage.section_forces("culvert", cuts) for stage in result}

plot.diagram(
    {name: forces.M for name, forces in ring.items()}, "moment (kNm/m)", angle=cuts.position
)

# %%

plot.diagram(
    {name: -forces.N for name, forces in ring.items()}, "thrust (kN/m)", angle=cuts.position
)

# %%
# Moment and thrust go round in the same rhythm in both stages, twice up and twice down: pressed
# harder from above and below than from the sides, the ring becomes an oval. The surcharge makes it
# flatter and turns it.


def oval(values):
    """The part of a quantity that goes twice up and down around the ring: its size, and the angle
    of its peak.
    """
    waves = np.fft.rfft(values) / len(values)
    assert abs(waves[1:]).argmax() == 1  # no other part is as large
    return 2.0 * abs(waves[2]), -0.5 * np.degrees(np.angle(waves[2])) % 180.0


for name, forces in ring.items():
    print(
        "{:10} moment: {:5.2f} kNm/m up and down, peak at {:.1f} degrees".format(
            name, *oval(forces.M)
        )
    )
    print(
        "{:10} thrust: {:5.2f} kN/m up and down, peak at {:.1f} degrees".format(
            name, *oval(-forces.N)
        )
    )

# %%
# Can it be trusted?
# ------------------
# The pipe floats in the ground: all contact forces on its nodes together must be its weight. (A
# form's ``force`` is what the nodes have to hold; the pipe feels the opposite.)

pipe = np.unique(basis.element_dofs[:, mesh.subdomains["culvert"]])
weight = -gravity[pipe].sum()
contact = {
    stage.name: forms["skin"].assemble(stage.x, stage.states["skin"]).force[pipe]
    for stage in result
}
carried = {
    name: np.array([-force[0::2].sum(), -force[1::2].sum()]) for name, force in contact.items()
}

for name, force in carried.items():
    print(
        f"{name:10} lifted by {force[1]:.6f} kN/m, pushed aside by {abs(force[0]):.0e}; weight "
        f"{weight:.6f} kN/m"
    )

# %%
# Cut the ring at crown and invert: the two thrusts must balance what pushes its right half to the
# left. The points at the cuts count for both halves.

share = np.select([angle % 180.0 == 0.0, angle < 180.0], [0.5, 1.0], 0.0)
across, along = np.sin(np.radians(angle)), np.cos(np.radians(angle))
push = {
    name: (share * p.weight * (p.pressure * across - p.shear * along)).sum()
    for name, p in skin.items()
}
thrusts = {name: -forces.N[[0, 36]].sum() for name, forces in ring.items()}

for name in push:
    print(f"{name:10} push {push[name]:.2f} kN/m, thrusts {thrusts[name]:.2f} kN/m")

# %%
# Gravity and the ground are symmetric, so the pressure must be, too, until the surcharge comes.

asymmetry = {}
for name, points in skin.items():
    clockwise = points.pressure[np.argsort(angle)]
    asymmetry[name] = abs(clockwise[1:] - clockwise[:0:-1]).max() / clockwise.max()
    print(f"{name:10} pressure differs by {asymmetry[name]:.0e} between right and left")

# %%
# Headline numbers
# ----------------
# What the paper says of its example, and what equilibrium demands, as assertions:

for name, points in skin.items():
    assert (points.status == Status.STICK).all()  # all pairs stick, no gap opens
    np.testing.assert_allclose(
        carried[name], (0.0, weight), atol=1e-6 * weight
    )  # Newton's tolerance is 1e-8
    assert (
        abs(push[name] / thrusts[name] - 1.0) < 0.01
    )  # tractions at points against forces at nodes
assert asymmetry["gravity"] < 1e-6 < 0.05 < asymmetry["surcharge"]
assert abs(angle[skin["surcharge"].pressure.argmin()] - 90.0) < 5.0  # one facet
assert (
    1.0 < oval(ring["surcharge"].M)[1] - oval(ring["gravity"].M)[1] < 10.0
)  # the same rhythm, shifted

plt.show()
row = {
    "method": "node-to-segment, smoothed",
    "n": len(angle),
    "unknowns": int(basis.N),
    "error": max(abs(push[name] / thrusts[name] - 1.0) for name in push),
    "cpu_s": round(cpu, 2),
    "iterations": sum(sum(stage.iterations) for stage in result),
}
print(json.dumps({"case": "buried culvert", "rows": [row]}))
