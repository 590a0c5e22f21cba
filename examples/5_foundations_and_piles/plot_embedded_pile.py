r"""
Piles and nails embedded in the ground
======================================

A pile, a nail or the grouted body of an anchor is thin beside the elements of the ground. It is a
:class:`skfem_contact.Beam` whose nodes need not meet those of the mesh: springs join it to the
ground inside the elements (:class:`skfem_contact.Embedded`). Along the beam they carry the skin
resistance, at its end that of the foot.

Here a row of piles is loaded until skin and foot yield, a nail is pulled out, and a pile in space
stands beside a solid one.
"""

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from pile_meshes import disc, layers, rings
from skfem import (
    Basis,
    ElementHexS2,
    ElementQuad2,
    ElementTriP2,
    ElementVector,
    MeshHex,
    MeshQuad,
    MeshTri,
)

import skfem_contact as sc

# %%
# A row of piles
# --------------
# Piles of 10 m, 2 m apart, have a skin resistance of 40 kN/m and a foot that bears 120 kN: the row
# carries 260 kN a metre. All that one pile has is given for one pile; forces and loads are those
# per metre of the row.


def pile(n):
    """Model of a row of piles, in a mesh of n elements in 4 m, and its unit load."""
    mesh = MeshTri.init_tensor(
        np.linspace(-15.3, 15, 6 * n + 1), np.linspace(-20, 0, 5 * n + 1)
    ).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    beam = sc.Beam(None, np.linspace((0, 0), (0, -10), 11), EI=2e5, EA=6e6, GA=2e6, spacing=2.0)
    forms = {
        "soil": sc.SolidForm(basis, sc.LinearElastic(E=3e4, nu=0.3)),
        "pile": beam,
        "skin": sc.Embedded(basis, beam, T_max=40.0, F_max=120.0),
    }
    model = sc.Model(forms, sc.box_supports(basis))
    return model, model.forms["pile"].load((0.0, -1.0), at=(0.0, 0.0))


rows = []
for n in (2, 4):
    begin = process_time()
    model, load = pile(n)
    found = model.limit_load(load, step=50.0, progress=False)
    rows.append(
        {
            "method": "row of piles",
            "n": n,
            "unknowns": int(model.layout.size),
            "error": abs(found.multiplier / 260 - 1),
            "cpu_s": round(process_time() - begin, 2),
            "iterations": found.iterations,
        }
    )
    print(f"n = {n}: the row carries {found.multiplier:.3f} kN/m, stopped by {found.stop.kind}")
    assert rows[-1]["error"] < 1e-4 and found.stop.kind == "plateau"

# %%
# Under 240 kN/m the foot has reached its limit, and half of the skin. The settlement of a row in
# the plane depends on the mesh as that of a line load does, by one or two per cent here.

stages = [sc.Stage(f"{force}", force * load) for force in (60, 120, 180, 240)]
result = model.run(stages, progress=False)
head = model.forms["pile"].numbers((0.0, 0.0))[1]
fig, (left, right) = plt.subplots(1, 2, figsize=(8, 4), layout="constrained")
depth = model.forms["skin"].positions
for stage in result:
    left.plot(-stage.states["skin"].skin, depth)
    forces = stage.section_forces("pile")
    label = f"{stage.name} kN/m: {-1e3 * stage.x[head]:.1f} mm"
    right.plot(-2.0 * forces.N, -forces.y, label=label)
left.set(xlabel="skin of a pile [kN/m]", ylabel="depth [m]", ylim=(10, 0))
right.legend(frameon=False, loc="lower right", fontsize="small")
right.set(xlabel="thrust in a pile [kN]", ylim=(10, 0))
plt.show()
last = result["240"].states["skin"]
yields = (abs(last.skin) > 39.999).mean()
print(f"under 240 kN/m the foot bears {-last.foot[0]:.1f} kN, and {yields:.0%} of the skin yields")
assert abs(last.foot[0] + 120.0) < 0.01 and 0.4 < yields < 0.6

# %%
# A nail
# ------
# A nail of 5 m, inclined, is pulled at its head: the skin resistance times its length.

begin = process_time()
mesh = MeshTri.init_tensor(np.linspace(0, 10, 17), np.linspace(0, 6, 12)).with_defaults()
basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
nail = sc.Beam(None, np.linspace((0.4, 3.0), (5.2, 1.6), 7), EI=10.0, EA=1e5)
forms = {
    "soil": sc.SolidForm(basis, sc.LinearElastic(E=3e4, nu=0.3)),
    "nail": nail,
    "skin": sc.Embedded(basis, nail, T_max=15.0),
}
model = sc.Model(forms, basis.get_dofs("bottom").all(), newton=sc.Newton(tolerance=1e-8))
pull = model.forms["nail"].load((-0.96, 0.28), at=(0.4, 3.0))
found = model.limit_load(pull, step=20.0, progress=False)
rows.append(
    {
        "method": "nail",
        "n": 6,
        "unknowns": int(model.layout.size),
        "error": abs(found.multiplier / 75 - 1),
        "cpu_s": round(process_time() - begin, 2),
        "iterations": found.iterations,
    }
)
print(f"the nail bears {found.multiplier:.4f} kN for 75")
assert rows[-1]["error"] < 1e-5

# %%
# A pile in space
# ---------------
# Beside a line in space the ground moves without bounds as the mesh becomes finer. A pile in space
# therefore has a radius: it moves with the ground on the mean over a circle, that of its shaft or,
# in coarse elements, a wider one, with springs for the ground in between. A pile of 20 m and 0.8 m
# across stands beside a solid pile: in axial symmetry for its settlement, in a quarter of the space
# for a push at its head, which elements 3.2 m wide overrate by 6 %. The push moves the ground along
# the plane across it in no direction but its own.

LENGTH, RADIUS, FAR, SOIL, PILE = 20.0, 0.4, 50.0, 1e4, 1e7
AREA = np.pi * RADIUS**2
GROUND, SHAFT = sc.LinearElastic(E=SOIL, nu=0.3), sc.LinearElastic(E=PILE, nu=0.3)


def graded(first, last, n):
    """Distances from 0 to 1, n of them after zero, whose steps grow from a first to a last
    share.
    """
    steps = np.geomspace(first, last, n)
    return np.append(0.0, np.cumsum(steps) / steps.sum())


def embedded(side, pushed):
    """Movement of the head of a quarter of a pile under 1000 kN, or under a push of 100 kN."""
    x = np.append(side * np.arange(3), 2 * side + (FAR - 2 * side) * graded(1, 8, 5)[1:])
    z = np.concatenate(
        (-FAR + (FAR - LENGTH) * graded(4, 1, 4), -LENGTH + LENGTH * np.linspace(0, 1, 11)[1:])
    )
    mesh = MeshHex.init_tensor(x, x, z)
    basis = Basis(mesh, ElementVector(ElementHexS2()), intorder=4)
    depth, more, part = np.linspace(0, -LENGTH, 21), PILE - SOIL, 0.25
    beam = sc.Beam(
        None,
        np.column_stack((0 * depth, 0 * depth, depth)),
        EI=part * more * AREA * RADIUS**2 / 4,
        EA=part * more * AREA,
        GA=part * 0.35 * more * AREA,
    )
    forms = {
        "soil": sc.SolidForm(basis, GROUND),
        "pile": beam,
        "skin": sc.Embedded(basis, beam, T_max=1e6, F_max=1e6, radius=RADIUS),
    }
    fixed = [basis.get_dofs(lambda x: np.isclose(x[2], -FAR)).all()]
    for c, names in enumerate((["u^2", "u^3"] if pushed else ["u^1"], ["u^2"])):
        fixed += [
            basis.get_dofs(lambda x, c=c: np.isclose(x[c], 0.0)).all(names),
            basis.get_dofs(lambda x, c=c: np.isclose(x[c], FAR)).all(f"u^{c + 1}"),
        ]
    names = ["u^2", "theta^1", "theta^3", *(["u^3"] if pushed else ["u^1", "theta^2"])]
    model = sc.Model(
        forms, [*fixed, *(dof for point in beam.points for dof in beam.dofs(point, names))]
    )
    form, force = model.forms["pile"], (25.0, 0.0, 0.0) if pushed else (0.0, 0.0, -250.0)
    stage = model.run([sc.Stage("load", form.load(force, (0, 0, 0)))], progress=False)["load"]
    return 1e3 * abs(stage.x[form.numbers((0, 0, 0))[0 if pushed else 2]]), model.layout.size


def solid(mesh, element, force, bottom, **options):
    """Movement of the head of a solid pile in millimetres, and the number of dofs."""
    axis = 1 if mesh.dim() == 2 else 2
    mesh = mesh.with_boundaries(
        {
            "head": lambda x: (
                np.isclose(x[axis], 0) & (np.linalg.norm(x[:axis], axis=0) < 1.01 * RADIUS)
            )
        }
    )
    basis = Basis(mesh, element, intorder=4)
    forms = {"all": sc.SolidForm(basis, {"pile": SHAFT, "soil": GROUND}, **options)}
    model = sc.Model(forms, bottom(basis))
    load = model.traction("head", force)
    moves = np.argmax(np.abs(force))
    stage = model.run([sc.Stage("load", load)], progress=False)["load"]
    return 1e3 * abs(stage.x[basis.get_dofs("head").all(f"u^{moves + 1}")].mean()), basis.N


def parts(mesh):
    """Mesh with the pile and the soil as subdomains."""
    height = mesh.dim() - 1
    inside = lambda x: (np.linalg.norm(x[:height], axis=0) < RADIUS) & (x[height] > -LENGTH)  # noqa: E731
    return mesh.with_subdomains({"pile": inside, "soil": lambda x: ~inside(x)})


r = np.concatenate(
    (RADIUS * np.linspace(0, 1, 4), RADIUS + (56.4 - RADIUS) * graded(1, 60, 18)[1:])
)
z = np.concatenate(
    (-FAR + (FAR - LENGTH) * graded(40, 1, 14), -LENGTH + LENGTH * np.linspace(0, 1, 41)[1:])
)
settlement, n_settlement = solid(
    parts(MeshQuad.init_tensor(r, z)),
    ElementVector(ElementQuad2()),
    (0.0, -1000.0 / AREA),
    lambda basis: [
        basis.get_dofs(lambda x: np.isclose(x[1], -FAR)).all(),
        basis.get_dofs(lambda x: np.isclose(x[0], 0) | np.isclose(x[0], 56.4)).all("u^1"),
    ],
    coordinates="axisymmetric",
)
rim = RADIUS * 1.0065  # a polygon of 16 sides with the second moment of the circle
z = np.concatenate(
    (-FAR + (FAR - LENGTH) * graded(6, 1, 6), -LENGTH + LENGTH * (1 - graded(1, 5, 14)[::-1])[1:])
)
section = disc(2, rim), rings(2, rim * (FAR / rim) ** np.linspace(0, 1, 11))
push, n_push = solid(
    parts(layers(section[0], z) + layers(section[1], z)),
    ElementVector(ElementHexS2()),
    (100.0 / AREA, 0.0, 0.0),
    lambda basis: [
        basis.get_dofs(lambda x: np.isclose(x[2], -FAR)).all(),
        basis.get_dofs(lambda x: np.hypot(x[0], x[1]) > 0.97 * FAR).all(["u^1", "u^2"]),
        basis.get_dofs(lambda x: np.isclose(x[0], 0)).all(["u^2", "u^3"]),
        basis.get_dofs(lambda x: np.isclose(x[1], 0)).all("u^2"),
    ],
)
print(
    f"solid pile: settlement {settlement:.3f} mm, push {push:.3f} mm, with {n_settlement} and "
    f"{n_push} dofs"
)
for name, pushed, exact, sides in (
    ("settlement", False, settlement, (3.2, 1.6)),
    ("push", True, push, (2.4, 1.6)),
):
    for side in sides:
        begin = process_time()
        found, n = embedded(side, pushed)
        error = abs(found / exact - 1)
        rows.append(
            {
                "method": f"pile in space, {name}",
                "n": side,
                "unknowns": int(n),
                "error": error,
                "cpu_s": round(process_time() - begin, 2),
                "iterations": 1,
            }
        )
        print(f"{name}, elements of {side:g} m: {found:.3f} mm, {found / exact - 1:+.1%}")
        assert error < 0.05

# %%
# Headline numbers
# ----------------
print(json.dumps({"case": "embedded pile", "rows": rows}))
