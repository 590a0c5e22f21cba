r"""
Shallow ironing
===============

A round block is pressed into a slab a tenth as stiff and drawn along it, with friction 0.3 (after
Fischer and Wriggers 2006). Both are neo-Hookean, strain and turn, and the contact slides over many
facets. Points choose their facets between increments, so that kinks of the surfaces do not throw
the iterations back and forth.

Six programs of other authors have a vertical force of 268 to 332 N/mm and a horizontal one of 55 to
71 N/mm at the end of pressing, and 337 to 421 and 102 to 189 N/mm on the way. The forces here lie
within both. The law decides: with linear elasticity in logarithmic strains they are a tenth larger.
Penalties, the augmented Lagrangian method and multipliers go the same way, smoothly: over the whole
10 mm, ``plot_shallow_ironing.py 10``, the largest change of the horizontal force from one step to
the next is 4, 7 and 3 % of its mean. Up to 8 mm the forces lie within the curves of four programs;
near the end of the slab the horizontal one is up to 6 % above them.

The option ``--calculix`` runs CalculiX with ``NLGEOM`` on the same mesh, as one layer of hexahedra
that cannot move across the plane, in the same steps and with the penalty. Its rubber resists
changes of volume by another law, with which the vertical forces here would be 2 % larger.
"""

import json
import sys
from dataclasses import replace
from time import process_time

import layer
import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("N", "mm")
n = 4  # elements in a length of 1 mm
given = [argument for argument in sys.argv[1:] if argument != "--calculix"]
way = float(given[0]) if given else 1.0  # up to 10 mm
step = 0.05
radius = 0.75
slab = MeshQuad.init_tensor(np.linspace(0, 12, 12 * n + 1), np.linspace(0, 4, 4 * n + 1))
grid = MeshQuad.init_tensor(np.linspace(-0.6, 0.6, 2 * n + 1), np.linspace(0, 1, n + 1))
slab, grid = slab.with_defaults(), grid.with_defaults()
x, y = grid.p
arch = radius - np.sqrt(radius**2 - x**2)
block = replace(grid, doflocs=np.stack((0.8 + x, 4.2 + arch + y * (1.2 - arch))))
basis = Basis(
    sc.join_bodies({"slab": slab, "block": block}), ElementVector(ElementQuad1()), intorder=2
)

# %%
# The slab, which is longer, is the slave. Rules with points that do not move, here five on a facet,
# suit long ways.

E, nu, mu = {"slab": 689.6, "block": 6896.0}, 0.32, 0.3
laws = {name: sc.NeoHooke(E=stiffness, nu=nu) for name, stiffness in E.items()}
bodies = sc.SolidForm(basis, laws, kinematics="finite")
methods = {
    "penalty": None,
    "augmented": sc.AugmentedLagrangian(),
    "multipliers": sc.DualMultipliers(),
}
top, bottom = basis.get_dofs("block:top"), basis.get_dofs("slab:bottom")
along, down = top.all("u^1"), top.all("u^2")

# %%
# The block is pressed by 1 mm, then drawn.


def moved(depth, distance):
    """Displacements of the block's top."""
    u = np.zeros(basis.N)
    u[down], u[along] = -depth, distance
    return u


down_to = np.arange(1, 6) / 5
stages = [sc.Stage(f"{d:.1f} down", prescribed=moved(d, 0.0)) for d in down_to]
distances = np.arange(step, way + 1e-9, step)
stages += [sc.Stage(f"{d:.2f} along", prescribed=moved(1.0, d)) for d in distances]
results, seconds = {}, {}
for name, method in methods.items():
    law = sc.Coulomb(mu=mu)
    contact = sc.ContactPair(
        basis, "slab:top", "block:bottom", law, quadrature=5, enforcement=method
    )
    model = sc.Model({"bodies": bodies, "contact": contact}, np.union1d(top.all(), bottom.all()))
    start = process_time()
    results[name] = model.run(stages)
    seconds[name] = process_time() - start

V, H = {}, {}
for name, result in results.items():
    V[name] = np.array([abs(stage.reactions()[down].sum()) for stage in result])
    H[name] = np.array([abs(stage.reactions()[along].sum()) for stage in result])
steps = np.concatenate([down_to, 1.0 + distances])

fig, ax = plt.subplots()
for name in methods:
    (line,) = ax.plot(steps, V[name], label=f"vertical, {name}")
    ax.plot(steps, H[name], "--", color=line.get_color(), label=f"horizontal, {name}")
ax.set_xlabel("way of the block, down and along [mm]")
ax.set_ylabel("force [N/mm]")
ax.legend()
plt.show()

# %%
# The slab bulges before the block.

plot.contour(results["multipliers"][-1], "mises")

#: Least and largest forces of Code_Aster, Fischer and Wriggers, Hartmann and others, Poulios and
#: Renard after each millimetre [N/mm], from curves of solids4foam's solid benchmarks.
V_PUBLISHED = (
    (324, 334, 336, 337, 337, 337, 336, 333),
    (405, 416, 420, 420, 421, 420, 418, 412),
)
H_PUBLISHED = (
    (99, 99, 101, 102, 102, 102, 101, 99),
    (173, 182, 190, 192, 189, 191, 191, 172),
)
rows = []
pressed = len(down_to) - 1  # the last stage of pressing
for name, result in results.items():
    v, h = V[name], H[name]
    iterations = [sum(stage.iterations) for stage in result]
    print(
        f"{name}: pressed V {v[pressed]:.0f}, H {h[pressed]:.0f} N/mm; "
        f"drawn V {v[-1]:.0f}, H {h[-1]:.0f}"
    )
    print(f"  {np.mean(iterations):.1f} iterations a stage")
    assert 268.0 < v[pressed] < 332.0
    assert 55.0 < h[pressed] < 71.0
    # from the place on at which all slides
    drawn_v, drawn_h = v[pressed + 11 :], h[pressed + 11 :]
    middle = distances[10:] < 6.0
    assert (drawn_v[middle] > 337.0).all()
    assert (drawn_v[middle] < 421.0).all()
    assert (drawn_h[middle] > 102.0).all()
    assert (drawn_h[middle] < 189.0).all()
    # at each millimetre, within the curves of four programs
    for k in range(1, min(int(way + 1e-9), 8) + 1):
        i = pressed + round(k / step)
        assert V_PUBLISHED[0][k - 1] < v[i] < V_PUBLISHED[1][k - 1]
        assert H_PUBLISHED[0][k - 1] < h[i] < H_PUBLISHED[1][k - 1]
    # forces change smoothly: largest change between steps over the mean
    jump_v = np.abs(np.diff(drawn_v)).max() / drawn_v.mean()
    jump_h = np.abs(np.diff(drawn_h)).max() / drawn_h.mean()
    print(f"  largest changes from step to step: V {jump_v:.1%}, H {jump_h:.1%}")
    assert jump_v < 0.015
    assert jump_h < (0.03 if way <= 5.0 else 0.08)
    assert np.mean(iterations) < 12.0
    excess = max(v[-1] / 421.0 - 1.0, h[-1] / 189.0 - 1.0, 0.0)
    rows.append(
        {
            "method": name,
            "n": n,
            "unknowns": len(result[-1].x),
            "error": excess,
            "cpu_s": seconds[name],
            "iterations": sum(iterations),
        }
    )

# %%
# CalculiX
# --------


def deck(penalty, thick):
    """Return CalculiX's input: one layer of hexahedra, and a step for each stage."""
    # Put each node on both sides of the layer.
    mesh = basis.mesh
    N = mesh.p.shape[1]
    lines = ["*NODE, NSET=NALL"]
    for first, z in ((1, 0.0), (N + 1, -thick)):
        lines += [f"{k}, {x:.12g}, {y:.12g}, {z}" for k, (x, y) in enumerate(mesh.p.T, first)]
    # Join them to hexahedra.
    for name, elements in mesh.subdomains.items():
        lines.append(f"*ELEMENT, TYPE=C3D8, ELSET={name}")
        for e in elements:
            corners = mesh.t[:, e] + 1
            lines.append(", ".join(map(str, (e + 1, *corners, *(corners + N)))))
    # Name surfaces and sets of nodes.
    for name, boundary in (("SLAVE", "slab:top"), ("MASTER", "block:bottom")):
        lines += [f"*SURFACE, NAME={name}", *layer.faces(mesh, boundary)]
    for name, boundary in (("TOP", "block:top"), ("BOTTOM", "slab:bottom")):
        nodes = np.unique(mesh.facets[:, mesh.boundaries[boundary]]) + 1
        lines += [f"*NSET, NSET={name}", *(f"{k}," for k in (*nodes, *(nodes + N)))]
    # Give laws, contact and supports.
    for name, stiffness in E.items():
        lines += layer.rubber(name, stiffness, nu)
    lines += [*layer.contact(penalty, mu), "*BOUNDARY", "NALL, 3, 3", "BOTTOM, 1, 2"]
    # Move the top of the block by a step for each stage.
    for stage in stages:
        lines += ["*STEP, NLGEOM, INC=1000", "*STATIC", "1., 1., 1e-4, 1.", "*BOUNDARY"]
        u = stage.prescribed
        lines += [f"TOP, 1, 1, {u[along[0]]}", f"TOP, 2, 2, {u[down[0]]}"]
        lines += ["*NODE PRINT, NSET=TOP, TOTALS=ONLY, FREQUENCY=1000", "RF", "*END STEP"]
    return "\n".join([*lines, ""])


if "--calculix" in sys.argv:
    thick = 1.0 / n
    penalty = results["penalty"][-1].forms["contact"].penalty[0]
    folder, theirs = layer.run("ironing", deck(penalty, thick))
    totals = [b for b in sc.testing.read_dat(folder / "ironing.dat") if b.quantity == "total force"]
    peer = np.abs([block.values[0] for block in totals]) / thick
    half = pressed + len(distances) // 2
    for name, i in (("pressed", pressed), ("half of the way", half), ("end", -1)):
        print(
            f"{name}: V {V['penalty'][i]:.1f}, H {H['penalty'][i]:.1f} N/mm, "
            f"CalculiX V {peer[i, 1]:.1f}, H {peer[i, 0]:.1f}"
        )
    ours = seconds["penalty"]
    print(f"{ours:.2f} s of processor time, CalculiX {theirs:.2f} s: 1/{theirs / ours:.1f}")
    # 2 % by the other law of volume; CalculiX's friction lags by a tenth in the steps of pressing
    off_v = np.abs(V["penalty"] / peer[:, 1] - 1.0)
    off_h = np.abs(H["penalty"] / peer[:, 0] - 1.0)
    assert off_v[pressed:].max() < 0.03
    assert off_h[pressed] < 0.12
    assert off_h[[half, -1]].max() < 0.05
    unknowns = 6 * basis.mesh.p.shape[1]
    rows.append({"peer": "CalculiX 2.20", "n": n, "unknowns": unknowns, "cpu_s": theirs})

print(json.dumps({"case": "shallow_ironing", "rows": rows}))
