r"""
Ironing: a block drawn over a softer slab
=========================================

A block with a round bottom is pressed on a slab, ten times as soft, and drawn along it. The contact
travels: again and again points of the one body arrive before segments of the other and leave them
behind, and every such event may show in the forces. What must come out is known:

* The slab is elastic and gives back behind the block what it took in front. Nothing is ploughed up,
  and the horizontal force H is :math:`\mu` times the vertical force V, up to a share of the size of
  the strains.
* The work done on the block is stored in the bodies or dissipated by friction, which never gives
  energy back.
* Once the slide is steady so are the forces. What they ripple by is due to the mesh, and must
  vanish with it.

The solids assume small strains. The block is therefore pressed in by no more than 1/300 of its
radius, where the pressure is 4 % of the slab's modulus.
"""

# %%
# Model
# -----
# The meshes do not match: the block's elements are by a fifth smaller than the slab's. Its top is
# led: down, and then sideways, at first in small steps in which friction builds up.

import json
from dataclasses import replace
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot
from skfem_contact.contact.penalty import choose_penalties
from skfem_contact.results.tractions import tractions
from skfem_contact.surfaces.material_points import along_chain

mu, radius, pressed, stroke, E = 0.3, 6.0, 0.02, 1.2, 1.0

down = np.linspace(0, pressed, 4)[1:]
aside = np.concatenate(([0.001, 0.003, 0.01], np.linspace(0, stroke, 23)[1:]))
path = np.concatenate(
    (np.stack((0 * down, -down), axis=1), np.stack((aside, 0 * aside - pressed), axis=1))
)


def bodies(n):
    """Mesh of slab and block, with n elements per unit length of the slab."""
    slab = MeshQuad.init_tensor(
        np.linspace(0, 4, 4 * n + 1), np.linspace(0, 1, n + 1)
    ).with_defaults()
    block = MeshQuad.init_tensor(
        np.linspace(-0.6, 0.6, 8 * n // 5 + 1), np.linspace(0, 1, n // 2 + 1)
    ).with_defaults()
    x, y = block.p
    arch = radius - np.sqrt(radius**2 - x**2)
    block = replace(block, doflocs=np.stack((1.4 + x, 1 + arch + y * (0.6 - arch))))
    return sc.join_bodies({"slab": slab, "block": block})


def ironed(n, **options):
    """Forms, result and the force on the block in every step, horizontal and vertical (n_steps,
    2).
    """
    basis = Basis(bodies(n), ElementVector(ElementQuad1()), intorder=2)
    solid = sc.SolidForm(
        basis, {"slab": sc.LinearElastic(E=E, nu=0.3), "block": sc.LinearElastic(E=10 * E, nu=0.3)}
    )
    pair = sc.ContactPair(basis, "block:bottom", "slab:top", sc.Coulomb(mu=mu), **options)
    forms = choose_penalties({"bodies": solid, "joint": pair})
    top = basis.get_dofs("block:top")
    stages = []
    for k, (right, up) in enumerate(path):
        x = basis.zeros()
        x[top.all("u^1")], x[top.all("u^2")] = right, up
        stages.append(sc.Stage(f"step {k + 1}", basis.zeros(), x, increments=1 if k else 2))
    result = sc.Model(forms, basis.get_dofs({"slab:bottom", "block:top"}).all()).run(stages)
    forces = [solid.assemble(step.x, step.states["bodies"]).force for step in result]
    return (
        forms,
        result,
        np.array([(f[top.all("u^1")].sum(), f[top.all("u^2")].sum()) for f in forces]),
    )


# %%
# Three contacts, two meshes
# --------------------------
# The block's nodes on the slab's facets; the same on facets whose joints are rounded off, which a
# bent slab needs as much as a round drum; and the contact integrated between the cuts of both
# meshes, on rounded facets.

methods = {
    "nodal": {"quadrature": "nodal"},
    "smoothed": {"quadrature": "nodal", "smoothing": 0.5},
    "smoothed, segments": {"quadrature": "segments", "smoothing": 0.5},
}
meshes = {8: ":", 16: "-"}  # elements per length, and how they are drawn
runs = {}
for n in meshes:
    for name, options in methods.items():
        begin = process_time()
        runs[n, name] = *ironed(n, **options), process_time() - begin

# %%
# The end of the way. Friction drags the slab along and tilts the block, so that the stresses are
# not symmetric.

forms, result, *_ = runs[16, "smoothed, segments"]
plot.contour(result[-1], "syy", deformed=1.0)

# %%
# Forces on the way
# -----------------
# Friction builds up within a hundredth of the block's width. The ripple is plain to see in the
# ratio of the forces: on a facet the pressure has the facet's direction, and turns when the points
# of the block pass to the next one.

steady = path[:, 0] > 0.2
fig, axes = plt.subplots(1, 2, figsize=(9, 4.4), layout="constrained")
for n, line in meshes.items():
    for k, name in enumerate(methods):
        force = runs[n, name][2]
        axes[0].plot(path[:, 0], -1e3 * force[:, 1] / E, f"C{k}{line}")
        axes[0].plot(path[:, 0], 1e3 * force[:, 0] / E, f"C{k}{line}")
        axes[1].plot(
            path[steady, 0],
            -force[steady, 0] / force[steady, 1],
            f"C{k}{line}",
            label=f"{name}, n = {n}",
        )
axes[0].set(
    xlabel="way of the block", ylabel="1000 V / E (upper), 1000 H / E (lower)", ylim=(0, None)
)
axes[1].set(xlabel="way of the block", ylabel="H / V")
fig.legend(frameon=False, ncols=3, loc="outside lower center")

# %%
# Energy
# ------
# What friction dissipates at a point in a step is its traction times the way by which its stick
# point is dragged along. That way is measured on the undeformed slab, where the compressed surface
# seems longer by the strain.


def work(force):
    """Work done on the block in the steps after the first, summed up, (n_steps - 1,)."""
    return (0.5 * (force[1:] + force[:-1]) * np.diff(path, axis=0)).sum(axis=1).cumsum()


def stored(solid, result):
    """Energy of the strains in every step, (n_steps,)."""
    return np.array([0.5 * step.x @ (solid.elastic_stiffness @ step.x) for step in result])


def dissipated(pair, result):
    """Energy that every point dissipates in every step after the first, (n_steps - 1, n_points)."""
    states = [step.states["joint"] for step in result]
    dragged = np.diff([along_chain(pair.master, *state.stick) for state in states], axis=0)
    return dragged * [state.traction[1] for state in states[1:]] * tractions(pair, states[0]).weight


for n in meshes:
    forms, result, force, _ = runs[n, "smoothed"]
    energy = stored(forms["bodies"], result)
    friction = dissipated(forms["joint"], result)
    assert friction.min() >= 0.0
    balance = (work(force) - (energy[1:] - energy[0]))[-1] / friction.sum()
    print(f"n = {n:2}: (work - stored energy) / dissipation = {balance:.4f}")
    assert abs(balance - 1) < 0.01  # strain

# %%
# Headline numbers
# ----------------
# The ripple of a force is its largest distance from a smooth curve, a cubic polynomial, over the
# steady slide.


def ripple(force):
    """Ripple of a force relative to its mean."""
    s, f = path[steady, 0], force[steady]
    return np.abs(f - np.polynomial.Polynomial.fit(s, f, 3)(s)).max() / np.abs(f.mean())


rows = []
for (n, name), (forms, result, force, cpu) in runs.items():
    horizontal, vertical = force[:, 0], -force[:, 1]
    ratio = (horizontal[steady] / vertical[steady]).mean()
    print(
        f"{name:18} n = {n:2}: 1000 V/E = {1e3 * vertical[-1] / E:.3f}, H/V = {ratio:.4f}, "
        f"ripple of H {ripple(horizontal):.1e}, of V {ripple(vertical):.1e}"
    )
    assert abs(ratio / mu - 1) < 0.01  # strain
    for step in result:  # action is reaction
        on_bodies = forms["joint"].assemble(step.x, step.states["joint"]).force.reshape(-1, 2)
        assert (np.abs(on_bodies.sum(axis=0)) < 1e-12 * np.abs(on_bodies).sum()).all()  # round-off
    rows.append(
        {
            "method": name,
            "n": n,
            "unknowns": int(forms["bodies"].basis.N),
            "error": float(ripple(horizontal)),
            "cpu_s": round(cpu, 2),
            "iterations": int(sum(sum(step.iterations) for step in result)),
        }
    )

for name in methods:
    coarse, fine = runs[8, name][2][steady], runs[16, name][2][steady]
    assert (np.abs(coarse / fine - 1) < 0.02).all()  # both forces, all along the way
for name in ("smoothed", "smoothed, segments"):
    for n in meshes:
        assert ripple(runs[n, name][2][:, 0]) < 0.25 * ripple(runs[n, "nodal"][2][:, 0])
    for component in (0, 1):
        assert ripple(runs[16, name][2][:, component]) < 6e-4

plt.show()
print(json.dumps({"case": "ironing", "rows": rows}))
