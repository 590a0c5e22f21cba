"""
Anchors: jacked, locked, loaded until they yield
================================================

A wall of 8 m stands fixed at its foot. An anchor at its top is stressed by a jack, locked, and
takes its share of the pressure that then acts on the wall, until it yields. Bars
(:class:`~skfem_contact.Bar`) and springs (:class:`~skfem_contact.Spring`) are forms like bodies and
contact pairs; they come and go, and change, by stages.
"""

# %%
# A wall of concrete, half a metre thick. The far end of the anchor is held by ground that does not
# move, so it need be no node of the mesh.
import json
from time import process_time

import numpy as np
from skfem import Basis, ElementQuad2, ElementVector, FacetBasis, LinearForm, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("kN", "m")

begin = process_time()
mesh = MeshQuad.init_tensor(np.linspace(0, 0.5, 3), np.linspace(0, 8, 33)).with_defaults()
basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
wall = sc.SolidForm(basis, sc.LinearElastic(E=3e7, nu=0.2))
anchor = sc.Bar(basis, start=(0.5, 8.0), end=(8.5, 0.0), EA=2e4, fixed_end=True, yield_force=120.0)
fixed = basis.get_dofs("bottom").all()

# %%
# The jack keeps the force at 80 kN whatever the wall does. Locked, the anchor goes on from there.
# Pressure on the left side pushes the wall away from the anchor: its force falls; pressure on the
# right side stretches it until it yields.
left, right = (FacetBasis(mesh, basis.elem, facets=side) for side in ("left", "right"))
pushed = LinearForm(lambda v, w: 10.0 * v[0]).assemble(left)
pulled = LinearForm(lambda v, w: -40.0 * v[0]).assemble(right)
stages = [
    sc.Stage("jack", basis.zeros()),
    sc.Stage("lock", basis.zeros(), change={"anchor": anchor}),
    sc.Stage("push", pushed),
    sc.Stage("pull", pulled),
    sc.Stage("rest", basis.zeros()),
]
result = sc.Model({"wall": wall, "anchor": anchor.prestressed(80.0)}, fixed).run(
    stages, progress=False
)
print(result)

# %%
# The oracle is superposition: the wall without its anchor, under each load and under a force of one
# along the anchor.
axis = np.array([8.0, -8.0]) / np.hypot(8.0, 8.0)
top = sc.dofs_at(basis, (0.5, 8.0))[0]
unit = basis.zeros()
unit[top] = axis
alone = {
    name: sc.Model({"wall": wall}, fixed).run([sc.Stage(name, load)], progress=False)[name].x[top]
    @ axis
    for name, load in (("unit", unit), ("push", pushed), ("pull", pulled))
}
stiffness = 2e4 / np.hypot(8.0, 8.0)
share = stiffness / (1.0 + stiffness * alone["unit"])
forces = {stage.name: float(stage.states["anchor"].force[0]) for stage in result}
exact = {"jack": 80.0, "lock": 80.0, "push": 80.0 - share * alone["push"]}
exact |= {
    "pull": 120.0,
    "rest": 120.0 + share * alone["pull"],
}  # it has yielded, and is longer ever after
print({name: f"{force:.2f}" for name, force in forces.items()})

# %%
# Deformed 200 times: the wall as the jack bends it, with the stress along its height.
plot.contour(result["lock"], "syy", deformed=200.0)

# %%
# Figures
# -------
rows = []
for name in exact:
    error = abs(forces[name] - exact[name]) / 80.0
    assert error < 1e-7  # linear: the tolerance of the iterations
    rows.append(
        {
            "method": name,
            "n": 32,
            "unknowns": int(basis.N),
            "error": error,
            "force": round(forces[name], 3),
            "iterations": sum(result[name].iterations),
            "cpu_s": round(process_time() - begin, 2),
        }
    )
assert 80.0 - share * alone["pull"] > 120.0  # what it would carry if it could
print(json.dumps({"case": "anchors", "rows": rows}))
