r"""
A block pressed and slid: friction, dissipation, hysteresis
===========================================================

An elastic block is pressed on an elastic base and slid over six of its segments, back, and forward
again. What must come out is known without a computation:

* While the block slides, the shear force :math:`T` is :math:`\mu` times the normal force :math:`N`.
* Friction never gives energy back, at no point and in no step.
* The second forward stroke ends where the first did: the loop of force against displacement is
  closed, and its area is the energy that friction has dissipated.

The meshes do not match. Two quadrature rules of the contact pair are compared: ``"nodal"``, which
looks for contact at the nodes of the block, and two Gauss points on each of its facets.
"""

# %%
# Model
# -----

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot
from skfem_contact.contact.laws import Status
from skfem_contact.results.tractions import tractions
from skfem_contact.surfaces.material_points import along_chain

mu, pressed, stroke = 0.3, 0.005, 0.6

base = MeshQuad.init_tensor(np.linspace(0, 4, 41), np.linspace(0, 1, 11)).with_defaults()
block = MeshQuad.init_tensor(np.linspace(1, 2.5, 22), np.linspace(1, 2, 14)).with_defaults()
mesh = sc.join_bodies({"base": base, "block": block})
basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)

top = basis.get_dofs("block:top")
fixed = basis.get_dofs({"base:bottom", "block:top"}).all()
materials = {"base": sc.LinearElastic(E=1e5, nu=0.3), "block": sc.LinearElastic(E=2e4, nu=0.3)}
bodies = sc.SolidForm(basis, materials)

# %%
# The top of the block is held at its height and led sideways. Each stroke begins with a few small
# steps, in which the block shears until it slides.

first_steps = np.array([0.002, 0.004, 0.007, 0.01, 0.015])
forward = np.concatenate((first_steps, np.linspace(0, stroke, 9)[1:]))
path = np.concatenate(([0], forward, stroke - forward, forward))
first, second = len(forward), 3 * len(forward)  # the ends of the two forward strokes
sliding = np.concatenate(([False], np.tile(np.arange(len(forward)) >= len(first_steps), 3)))


def stage(step):
    """The block's top at a step of the path."""
    x = basis.zeros()
    x[top.all("u^1")] = path[step]
    x[top.all("u^2")] = -pressed
    return sc.Stage(f"step {step}", load=basis.zeros(), prescribed=x)


# %%
# What is measured
# ----------------
# The forces are taken where a laboratory would take them, at the top of the block, from the
# stresses in its elements. The dissipation of a point in a step is its friction times the distance
# by which its stick point is dragged along.


def force_on_block(step):
    """Horizontal and vertical force that moves the block, from its stresses."""
    force = bodies.assemble(step.x, step.states["bodies"]).force
    return force[top.all("u^1")].sum(), force[top.all("u^2")].sum()


def work_on_block(force):
    """Work that is done on the block up to every step, (n_steps,)."""
    return np.concatenate(([0], np.cumsum(0.5 * (force[1:, 0] + force[:-1, 0]) * np.diff(path))))


def dissipation(joint, result):
    """Energy that every point of the joint dissipates in every step but the first, (n_steps - 1,
    n_points).
    """
    states = [step.states["joint"] for step in result]
    dragged = np.diff([along_chain(joint.master, *state.stick) for state in states], axis=0)
    return (
        dragged * [state.traction[1] for state in states[1:]] * tractions(joint, states[0]).weight
    )


# %%
# Two analyses
# ------------

stages = [stage(step) for step in range(len(path))]
runs = {}
for quadrature in ("nodal", 2):
    begin = process_time()
    joint = sc.ContactPair(
        basis, "block:bottom", "base:top", sc.Coulomb(mu=mu), quadrature=quadrature, penalty=1e7
    )
    result = sc.Model({"bodies": bodies, "joint": joint}, fixed).run(stages)
    runs[quadrature] = joint, result, process_time() - begin

# %%
# The block near the middle of the first stroke: the pressure is highest at its front edge, to which
# the friction tilts it. Outlines of the start are grey.

plot.contour(runs["nodal"][1]["step 10"], "syy", deformed=1.0)

# %%
# The loop
# --------
# After the first stroke force and displacement follow a closed loop. Its area is the work that is
# done on the block, and all of it goes into friction.

joint, result, _ = runs["nodal"]
force = np.array([force_on_block(step) for step in result])
dissipated = np.concatenate(([0], dissipation(joint, result).sum(axis=1).cumsum()))
travelled = np.concatenate(([0], np.abs(np.diff(path)).cumsum()))
ratio = -force[:, 0] / force[:, 1]

fig, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
axes[0].axhline(mu, color="0.7", lw=1)
axes[0].axhline(-mu, color="0.7", lw=1)
axes[0].plot(path[: first + 1], ratio[: first + 1], "C0", label="first stroke")
axes[0].plot(
    path[first : second + 1], ratio[first : second + 1], "C1.-", label="back, and forward again"
)
axes[0].set(xlabel="displacement of the block", ylabel="T / N", yticks=[-mu, 0, mu])
axes[0].legend(frameon=False, loc="center")
axes[1].plot(travelled, work_on_block(force), "C0", label="work done on the block")
axes[1].plot(travelled, dissipated, "C1--", label="dissipated by friction")
axes[1].set(xlabel="distance travelled by the block", ylabel="energy")
axes[1].legend(frameon=False)

# %%
# Headline numbers
# ----------------
# While the block slides, T/N differs from :math:`\mu` by less than a thousandth: the surface of the
# base is bent a little, and the force at the top is not quite parallel to it.

rows = []
for quadrature, (joint, result, cpu) in runs.items():
    force = np.array([force_on_block(step) for step in result])
    error = np.abs(np.abs(force[sliding, 0] / force[sliding, 1]) / mu - 1.0).max()
    energy = dissipation(joint, result)
    work = work_on_block(force)
    iterations = np.array([sum(step.iterations) for step in result])

    assert all(
        (result[int(k)].states["joint"].status == Status.SLIP).all()
        for k in np.flatnonzero(sliding)
    )
    assert error < 1e-3  # bent surface
    assert energy.min() >= 0.0
    np.testing.assert_allclose(result[second].x, result[first].x, atol=1e-9)  # the loop is closed
    loop = energy[first:second].sum() / (work[second] - work[first])
    assert abs(loop - 1.0) < 0.005  # trapezoidal rule at the turning points
    assert iterations.mean() <= 8.0
    rows.append(
        {
            "method": f"quadrature={quadrature!r}",
            "n": energy.shape[1],
            "unknowns": int(basis.N),
            "error": float(error),
            "cpu_s": round(cpu, 2),
            "iterations": int(iterations.sum()),
        }
    )

plt.show()
print(json.dumps({"case": "two blocks", "rows": rows}))
