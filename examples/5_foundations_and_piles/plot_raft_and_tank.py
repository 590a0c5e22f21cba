r"""
Shells: the wall of a tank, a raft, and a raft on piles
=======================================================

``sc.Shell`` is a thin plate or shell in space, with nodes of its own or on facets of the ground.
The wall of a tank full of water is compared with Timoshenko's solution, and a raft under columns
with the same raft of solid elements. Units are kN and m.
"""

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementHex1, ElementHex2, ElementVector, MeshHex, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

begin = process_time()
concrete = {"E": 3e7, "nu": 0.2}

# %%
# The wall of a tank
# ------------------
# A quarter of a cylinder, clamped at its foot. With :math:`\beta^4 = 3 (1 - \nu^2) / (R t)^2` water
# of the height H bends it at its foot by :math:`\gamma R H t / \sqrt{12 (1 - \nu^2)} \,
# (1 - 1 / \beta H)`.

R, H, t = 8.0, 5.0, 0.25
z = H * np.linspace(0.0, 1.0, 25) ** 1.4
mesh = MeshQuad.init_tensor(np.linspace(0.0, np.pi / 2.0, 33), z)
angle, height = mesh.p
points = np.column_stack((R * np.cos(angle), R * np.sin(angle), height))
cells = mesh.t.T[:, ::-1]  # the normals point outwards
wall = sc.Shell(None, points, cells=cells, thickness=t, axis=(0, 0, 1), **concrete)

supports = []
for point, a, h in zip(points, angle, height, strict=True):
    if h == 0.0:
        supports += wall.dofs(point)
    if a == 0.0:
        supports += wall.dofs(point, ["u^2", "theta^1", "theta^3"])
    elif a == np.pi / 2.0:
        supports += wall.dofs(point, ["u^1", "theta^2", "theta^3"])
model = sc.Model({"wall": wall}, supports)
water = model.forms["wall"].pressure_load(lambda x: -10.0 * (H - x[2]))
table = model.run([sc.Stage("full", water)], progress=False)["full"].table("wall")

row = np.searchsorted(z, table["z"]) - 1  # means of each row of elements
area = np.bincount(row, wall.areas)
level, hoop, bent = (
    np.bincount(row, table[name] * wall.areas) / area for name in ("z", "n_2", "m_1")
)
b = (3.0 * (1.0 - 0.2**2) / (R * t) ** 2) ** 0.25
at = np.linspace(0.0, H, 200)
wave, mixed = np.exp(-b * at) * np.cos(b * at), np.exp(-b * at) * np.sin(b * at)
hoop_exact = 10.0 * R * (H - at - H * wave - (H - 1.0 / b) * mixed)
foot = 10.0 * R * H * t / np.sqrt(12.0 * (1.0 - 0.2**2)) * (1.0 - 1.0 / (b * H))
bent_exact = -foot * wave + 10.0 * R * t / np.sqrt(12.0 * (1.0 - 0.2**2)) * H * mixed

fig, axes = plt.subplots(1, 2, figsize=(7.0, 3.5), sharey=True, layout="constrained")
axes[0].plot(hoop_exact, at, label="Timoshenko")
axes[0].plot(hoop, level, "o", markersize=3, label="shell")
axes[1].plot(bent_exact, at, bent, level, "o", markersize=3)
axes[0].set(xlabel="hoop force (kN/m)", ylabel="height (m)")
axes[1].set(xlabel="moment (kNm/m)")
axes[0].legend(frameon=False)
errors = [
    np.abs(hoop - np.interp(level, at, hoop_exact)).max() / hoop_exact.max(),
    np.abs(bent - np.interp(level, at, bent_exact)).max() / foot,
]
print(f"moment at the foot {foot:.2f} kNm/m; largest differences {errors[0]:.2%}, {errors[1]:.2%}")
assert max(errors) < 0.02, errors

# %%
# A raft on the ground
# --------------------
# A quarter of a raft of 12 m by 12 m and 0.6 m, with a column of 1 m by 1 m in each quarter. The
# shell has the nodes of the ground; no elements of concrete are needed.

d = 0.6
x = np.append(np.linspace(0.0, 6.0, 7), [8.0, 11.0, 16.0, 24.0])
deep = np.array([-20.0, -13.0, -8.0, -4.0, -1.5, 0.0])


def column(x):
    """Pressure of 900 kN on a square metre."""
    on = (np.abs(x[0] - 3.5) < 0.5) & (np.abs(x[1] - 3.5) < 0.5)
    return 0.0 * x[0], 0.0 * x[0], -900.0 * on


def settled(as_shell):
    """Model, and settlements along the diagonal of the raft."""
    mesh = MeshHex.init_tensor(x, x, deep if as_shell else np.append(deep, d))
    middle = mesh.p[:, mesh.t].mean(axis=1)
    mesh = mesh.restrict(np.flatnonzero((middle[2] < 0) | (middle[:2] < 6.0).all(axis=0)))
    top = 0.0 if as_shell else d
    mesh = mesh.with_boundaries(
        {
            "raft": lambda x: (x[2] > top - 1e-9) & (x[:2] < 6.0).all(axis=0),
            "base": lambda x: x[2] < -20.0 + 1e-9,
            "x": lambda x: (x[0] < 1e-9) | (x[0] > 24.0 - 1e-9),
            "y": lambda x: (x[1] < 1e-9) | (x[1] > 24.0 - 1e-9),
        }
    )
    mesh = mesh.with_subdomains({"slab": lambda x: x[2] > 0, "soil": lambda x: x[2] < 0})
    basis = Basis(mesh, ElementVector(ElementHex2()), intorder=4)
    materials = {"soil": sc.LinearElastic(E=2e4, nu=0.3)}
    if not as_shell:
        materials["slab"] = sc.LinearElastic(**concrete)
    forms = {"ground": sc.SolidForm(basis, materials)}
    supports = [
        basis.get_dofs("base").all(),
        basis.get_dofs("x").all("u^1"),
        basis.get_dofs("y").all("u^2"),
    ]
    if as_shell:
        raft = forms["raft"] = sc.Shell(basis, "raft", thickness=d, **concrete)
        for point in raft.points:  # planes of symmetry
            if point[0] < 1e-9:
                supports += raft.dofs(point, ["theta^2", "theta^3"])
            if point[1] < 1e-9:
                supports += raft.dofs(point, ["theta^1", "theta^3"])
    model = sc.Model(forms, supports)
    stage = model.run([sc.Stage("columns", model.traction("raft", column))], progress=False)[-1]
    diagonal = np.linspace(0.0, 6.0, 7)
    nodes = sc.dofs_at(basis, np.column_stack((diagonal, diagonal, np.full(7, top))))
    return stage, -1e3 * stage.x[nodes[:, 2]]


stage, by_shell = settled(True)
_, by_solid = settled(False)
print("settlements along the diagonal (mm)")
print("shell", by_shell.round(2))
print("solid", by_solid.round(2))
different = np.abs(by_shell - by_solid).max() / by_solid.max()
assert different < 0.02, different

# %%
# Moments of the raft. The normal points upwards, so sagging moments, which stretch the lower side,
# are negative.

table = stage.table("raft")
sc.set_units("kN", "m")
plot.shells(stage, "m_1")

# %%
# Piles below a raft
# ------------------
# Beams that join the shell at their heads, with skins that tie them to the ground around them.

line = np.linspace(0.0, 12.0, 13)
levels = np.array([-24.0, -18.0, -14.0, -11.0, -9.0, -7.0, -5.0, -3.0, -1.5, 0.0])
mesh = MeshHex.init_tensor(line, line, levels).with_boundaries(
    {
        "raft": lambda x: (x[2] > -1e-9) & (np.abs(x[:2] - 6.0) < 3.0).all(axis=0),
        "base": lambda x: x[2] < -24.0 + 1e-9,
        "x": lambda x: np.abs(x[0] - 6.0) > 6.0 - 1e-9,
        "y": lambda x: np.abs(x[1] - 6.0) > 6.0 - 1e-9,
    }
)
basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2)
soil = sc.SolidForm(basis, sc.LinearElastic(E=2e4, nu=0.3), strain="b_bar")
raft = sc.Shell(basis, "raft", thickness=d, **concrete)
supports = [
    basis.get_dofs("base").all(),
    basis.get_dofs("x").all("u^1"),
    basis.get_dofs("y").all("u^2"),
]
heads = [(4.0, 4.0), (8.0, 4.0), (4.0, 8.0), (8.0, 8.0)]
radius = 0.25
pile = {"EI": 3e7 * np.pi * radius**4 / 4.0, "EA": 3e7 * np.pi * radius**2}
forms = {"soil": soil, "raft": raft}
for k, (a, b) in enumerate(heads):
    axis = np.linspace((a, b, 0.0), (a, b, -10.0), 11)
    forms[f"pile {k}"] = sc.Beam(basis, axis, joined_to=raft, **pile)
    forms[f"skin {k}"] = sc.Embedded(basis, forms[f"pile {k}"], T_max=1e4, radius=radius)
settlements = {}
for names in (["soil", "raft"], list(forms)):
    model = sc.Model({name: forms[name] for name in names}, supports)
    load = model.traction("raft", (0.0, 0.0, -100.0))
    stage = model.run([sc.Stage("load", load)], progress=False)["load"]
    settlements[len(names)] = -1e3 * stage.x[sc.dofs_at(basis, (6.0, 6.0, 0.0))[0, 2]]
alone, with_piles = settlements.values()
thrusts = [-stage.section_forces(f"pile {k}").N[0] for k in range(4)]
share = sum(thrusts) / (100.0 * 36.0)
print(f"{alone:.1f} mm alone, {with_piles:.1f} mm on piles, which bear {share:.0%}")
assert with_piles < 0.75 * alone and 0.6 < share < 0.95
assert np.ptp(thrusts) < 1e-6 * max(thrusts)

# %%
# The raft from below, with its piles.

plot.shells(stage, "uz", towards=(-1, 2, 1), deformed="auto")

# sphinx_gallery_start_ignore
assert table["m_1"].min() < -50.0
row = {
    "method": "raft",
    "n": len(table["x"]),
    "unknowns": len(stage.x),
    "error": float(different),
    "cpu_s": round(process_time() - begin, 1),
    "iterations": None,
}
print(json.dumps({"case": "raft_and_tank", "rows": [row]}))
# sphinx_gallery_end_ignore
