"""
A propped excavation
====================

A pit of 5 m beside a wall that is in the ground already: the first lift, a prop at the top of the
wall, the second lift. What is dug is named in ``deactivate``; the prop is a support that is added.
Half of the pit is computed. Units are kN and m.
"""

import numpy as np
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("kN", "m")
across = np.concatenate((np.linspace(0, 6, 9), [6.25], 6.5 + 18 * np.linspace(0, 1, 13) ** 2))
mesh = MeshQuad.init_tensor(across, np.linspace(0, 16, 33)).with_subdomains(
    {
        "concrete": lambda x: (x[0] > 6) & (x[0] < 6.5) & (x[1] > 6),
        "lift 1": lambda x: (x[0] < 6) & (x[1] > 14),
        "lift 2": lambda x: (x[0] < 6) & (x[1] > 11) & (x[1] < 14),
    }
)
dug = np.concatenate([mesh.subdomains[name] for name in ("concrete", "lift 1", "lift 2")])
mesh = mesh.with_subdomains({"soil": np.setdiff1d(np.arange(mesh.nelements), dug)})
mesh = sc.join_bodies(mesh, bodies={"ground": ["soil", "lift 1", "lift 2"], "wall": "concrete"})
basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)

sand, concrete = sc.MohrCoulomb(E=4e4, nu=0.3, c=2.0, phi=30.0), sc.LinearElastic(E=3e7, nu=0.2)
parts, skin = ("soil", "lift 1", "lift 2"), sc.Coulomb(mu=0.36)
forms = {
    name: sc.SolidForm(basis.with_elements(name), sand, "b_bar", unit_weight=20.0) for name in parts
}
forms["wall"] = sc.SolidForm(basis.with_elements("wall"), concrete, "b_bar", unit_weight=20.0)
forms |= {
    f"{name}|wall": sc.ContactPair(basis, f"{name}|wall", "wall|ground", skin, quadrature=2)
    for name in parts
}

fixed = sc.box_supports(basis)
prop = sc.dofs_at(basis, (6.0, 16.0), part="wall")[0, :1]
heavier = sc.weight(basis, {"wall": 5.0})  # concrete in place of ground
model = sc.Model(forms, fixed)
result = model.run(
    [
        sc.Stage("wall", heavier),
        sc.Stage("lift 1", heavier, deactivate=("lift 1", "lift 1|wall"), increments=4),
        sc.Stage("prop", heavier, fixed=[fixed, prop]),
        sc.Stage("lift 2", heavier, deactivate=("lift 2", "lift 2|wall"), increments=6),
    ],
    start=model.k0_state(K0=0.5, name="at rest"),
)
print(result)
print(f"prop {result['lift 2'].reactions()[prop][0]:.1f} kN/m")

# %%
# Forces of all stages in a table, and a report for others: one HTML file that a browser shows and
# prints.
cuts = sc.Cuts.line((6.25, 16.0), (6.25, 6.0), depth=0.5, n=41)
print(result.table(sections={"wall": cuts}).to_markdown())
file = result.report(
    "propped_excavation.html", title="A propped excavation", quantity="ux", sections={"wall": cuts}
)

# %%
plot.stages(
    [result["lift 1"], result["lift 2"]],
    "ux",
    since=result["wall"],
    deformed="auto",
    window=(0, 14, 4, 17),
)

# %%
plot.diagram(result["lift 2"].section_forces("wall", cuts), "M", on=result["lift 2"])

# sphinx_gallery_start_ignore
import json

last = result["lift 2"]
pushed = -sum(last.contact(name).force[0] for name in last.states if name.endswith("|wall"))
error = float(abs(pushed + last.reactions()[prop][0]) / abs(pushed))
assert error < 1e-4, error  # the wall is in balance
row = {"method": "Q1", "n": 33, "unknowns": int(basis.N), "error": error, "cpu_s": None}
row["iterations"] = int(sum(sum(stage.iterations) for stage in result))
print(json.dumps({"case": "propped_excavation", "rows": [row]}))
# sphinx_gallery_end_ignore
