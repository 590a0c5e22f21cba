r"""
A braced excavation, stage by stage
===================================

A pit 5 m deep is dug beside a concrete wall that is in the ground already. The first lift of 2 m
makes the wall a cantilever; then a strut is set at its top, and the second lift of 3 m is dug.

Stages know what comes and goes by name: each lift is a :class:`~skfem_contact.SolidForm` of its
own, and so is its contact with the wall. What ``deactivate`` takes away is released in proportion
over the increments of the stage. The strut is a support that is added (``fixed``): it carries
nothing until the wall moves on.

Half of the pit is computed; its middle is on the left.
"""

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("kN", "m")

TOP, TOE, INNER, OUTER = 16.0, 6.0, 6.0, 6.5  # surface, toe and both faces of the wall
LIFTS = {"lift 1": (14.0, 16.0), "lift 2": (11.0, 14.0)}
WEIGHT, K0 = 20.0, 0.5

# %%
# Mesh and forms
# --------------
# The bodies are the ground, lifts included, and the wall. ``join_bodies`` names both sides of their
# interface; that of the ground is cut into the parts that belong to each lift and to the rest.


def is_wall(x):
    """Points of the wall."""
    return (x[0] > INNER) & (x[0] < OUTER) & (x[1] > TOE)


def in_lift(name):
    """Points of a lift."""
    low, high = LIFTS[name]
    return lambda x: (x[0] < INNER) & (x[1] > low) & (x[1] < high)


def pit(materials, bonded=False):
    """Basis, forms and supports; ``bonded``: the wall shares its nodes with the ground."""
    behind = OUTER + 18 * np.expm1(np.linspace(0, 1.6, 13)) / np.expm1(1.6)
    across = np.concatenate((np.linspace(0, INNER, 9), [6.25], behind))
    mesh = MeshQuad.init_tensor(across, np.linspace(0, TOP, 33)).with_subdomains(
        {
            "wall": is_wall,
            **{name: in_lift(name) for name in LIFTS},
            "soil": lambda x: ~(is_wall(x) | in_lift("lift 1")(x) | in_lift("lift 2")(x)),
        }
    )
    mesh = mesh.with_defaults()
    if not bonded:
        mesh = sc.join_bodies(mesh, bodies={"ground": ["soil", *LIFTS], "concrete": "wall"})
        facets = np.asarray(mesh.boundaries["ground|concrete"])
        parts = {
            name: facets[np.isin(mesh.f2t[0, facets], mesh.subdomains[name])]
            for name in ("soil", *LIFTS)
        }
        mesh = mesh.with_boundaries({f"{name}|wall": part for name, part in parts.items()})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    forms = {
        name: sc.SolidForm(basis.with_elements(name), material, "b_bar", unit_weight=WEIGHT)
        for name, material in materials.items()
    }
    if not bonded:
        friction = sc.Coulomb(mu=float(np.tan(np.radians(20))))
        forms |= {
            f"{name}|wall": sc.ContactPair(
                basis, f"{name}|wall", "concrete|ground", friction, quadrature=2
            )
            for name in ("soil", *LIFTS)
        }
    fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    return basis, forms, fixed


SOIL = sc.MohrCoulomb(E=4e4, nu=0.3, c=2.0, phi=30.0)
MATERIALS = {"soil": SOIL, "lift 1": SOIL, "lift 2": SOIL, "wall": sc.LinearElastic(E=3e7, nu=0.2)}
begin = process_time()
basis, forms, fixed = pit(MATERIALS)
for name, form in forms.items():
    print(f"{name}: {form}")

# %%
# Stages
# ------
# The wall is wished in place: it starts with the stresses of the ground around it, whose weight it
# has at first, and the contacts carry the pressure at rest. Its additional weight is the first
# stage.

model = sc.Model(forms, fixed)
start = model.k0_state(K0=K0, name="at rest")
print(f"out of balance at rest: {start['at rest'].residual:.1e}")


heavier = sc.weight(basis, {"wall": 5.0})
at_top = np.flatnonzero((basis.doflocs[1] == TOP) & (basis.doflocs[0] == INNER))
wall_nodes = np.unique(basis.element_dofs[:, basis.mesh.subdomains["wall"]])
strut = np.intersect1d(at_top[at_top % 2 == 0], wall_nodes)
stages = [
    sc.Stage("wall", heavier),
    sc.Stage("lift 1", heavier, deactivate=("lift 1", "lift 1|wall"), increments=4),
    sc.Stage("strut", heavier, fixed=[fixed, strut]),
    sc.Stage("lift 2", heavier, deactivate=("lift 2", "lift 2|wall"), increments=6),
]
result = model.run(stages, start=start)
print(result)
cpu, iterations = process_time() - begin, sum(sum(stage.iterations) for stage in result)

# %%
# Checks
# ------
# What acts on the wall is in balance: contact on both sides, and the strut.


last = result["lift 2"]
held = last.reactions()
reaction = held[strut][0]
contacts = [last.contact(name) for name in last.states if name.endswith("|wall")]
pushed = -sum(contact.force[0] for contact in contacts)
balance = abs(pushed + reaction) / abs(reaction)
base = held[fixed[fixed % 2 == 1]].sum()
lifted = base / last.load.sum() + 1
print(
    f"strut {reaction:.2f} kN/m; the wall is in balance to {balance:.1e} of it, the ground to "
    f"{abs(lifted):.1e}"
)
assert balance < 1e-5
assert abs(lifted) < 1e-6
assert result["strut"].iterations == (0,)  # a new support carries nothing at first
np.testing.assert_allclose(last.x[strut], result["lift 1"].x[strut])

# %%
# The wall bends into the pit below its strut, and the ground before it heaves.
inwards = {
    name: -1e3 * result[name].x[wall_nodes[wall_nodes % 2 == 0]].min()
    for name in ("lift 1", "lift 2")
}
heave = 1e3 * last.x[(basis.doflocs[1] == LIFTS["lift 2"][0]) & (np.arange(basis.N) % 2 == 1)].max()
print(
    f"wall {inwards['lift 1']:.1f} and {inwards['lift 2']:.1f} mm into the pit, bottom of the pit "
    f"{heave:.1f} mm up"
)
assert 0 < inwards["lift 1"] < inwards["lift 2"]

# %%
# How far is it from collapse? The strength of the soil is reduced from the last stage on, and that
# of its contact with the wall as well. What has been dug away is left out.
found = sc.Model(forms, [fixed, strut]).strength_reduction(
    start=result, reduce=["soil", "soil|wall"], certify=False
)
print(
    f"factor of safety {found.factor:.2f} in {found.iterations} iterations, stopped by {found.stop}"
)
assert 2.8 < found.factor < 3.2  # psi = 0: this much depends on path and method

# %%
# In elastic ground the number of lifts does not matter: with the wall bonded to it, two lifts and
# one are the same.

begin = process_time()
elastic = {name: sc.LinearElastic(E=4e4, nu=0.3) for name in MATERIALS} | {
    "wall": MATERIALS["wall"]
}
bonded_basis, *bonded = pit(elastic, bonded=True)
model = sc.Model(*bonded)
rest = model.k0_state(K0=K0)
two = model.run(
    [sc.Stage("1", deactivate="lift 1", increments=3), sc.Stage("2", deactivate="lift 2")],
    start=rest,
)
one = model.run([sc.Stage("both", deactivate=tuple(LIFTS))], start=rest)
there = np.unique(bonded_basis.with_elements({"soil", "wall"}).element_dofs)
difference = float(np.abs(two["2"].x - one["both"].x)[there].max() / np.abs(one["both"].x).max())
cpu_elastic = process_time() - begin
print(f"two lifts or one, elastic: the displacements differ by {difference:.1e}")
assert difference < 1e-10

# %%
# Pressures and moments
# ---------------------
# Contact pressure on the side of the ground and on that of the pit, and the moment in the wall.

fig, (left, right) = plt.subplots(1, 2, figsize=(9, 4.5), sharey=True, layout="constrained")
cuts = sc.Cuts.line(
    ((INNER + OUTER) / 2, TOP - 0.25), ((INNER + OUTER) / 2, TOE + 0.25), OUTER - INNER, n=39
)
for color, name in (("#777777", "at rest"), ("#1f4e8c", "lift 1"), ("#d55e00", "lift 2")):
    for part in ("soil", "lift 1", "lift 2"):
        if f"{part}|wall" in result[name].states:
            skin = result[name].tractions(f"{part}|wall")
            for face, sign in ((skin.x > OUTER - 1e-6, 1), (skin.x < INNER + 1e-6, -1)):
                label = name if part == "soil" and sign > 0 else None
                left.plot(
                    sign * skin.pressure[face],
                    TOP - skin.y[face],
                    ".-",
                    color=color,
                    label=label,
                    markersize=3,
                    linewidth=0.8,
                )
    forces = result[name].section_forces("wall", cuts)
    right.plot(forces.M, TOP - forces.y, color=color, label=name)
left.set(
    xlabel="contact pressure [kPa]: pit (−) and ground (+)", ylabel="depth [m]", ylim=(TOP - TOE, 0)
)
right.set(xlabel="moment in the wall [kNm/m]")
for ax in (left, right):
    ax.axvline(0, color="black", linewidth=0.8)
    ax.grid(color="#dddddd", linewidth=0.6)
    ax.legend(frameon=False)
moments = {
    name: np.abs(result[name].section_forces("wall", cuts).M).max()
    for name in ("at rest", "lift 1", "lift 2")
}
print({name: round(float(value), 1) for name, value in moments.items()})

# %%
# Horizontal displacements at the end, enlarged. What has been dug away is not drawn.

# sphinx_gallery_thumbnail_number = 2
plot.contour(last, "ux", deformed=40.0, window=(0, 18, 2, 17))

# %%
# Figures
# -------

print(
    json.dumps(
        {
            "case": "excavation",
            "rows": [
                {
                    "method": "staged, contact on both sides of the wall",
                    "n": 32,
                    "unknowns": int(basis.N),
                    "error": float(balance),
                    "cpu_s": round(cpu, 2),
                    "iterations": iterations,
                },
                {
                    "method": "elastic, two lifts or one",
                    "n": 32,
                    "unknowns": int(bonded_basis.N),
                    "error": difference,
                    "cpu_s": round(cpu_elastic, 2),
                    "iterations": sum(sum(stage.iterations) for stage in two),
                },
            ],
        }
    )
)
