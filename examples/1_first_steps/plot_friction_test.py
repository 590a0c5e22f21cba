"""
Two blocks and a friction test
==============================

A soil sample on a concrete plate, pressed and pushed: how rough is the joint? This tutorial builds
a small analysis with contact from its parts, explains each of them, measures the coefficient of
friction as a laboratory would, and ends with a Newton loop of your own.

Units are kN and m. Tension is positive, and so is a gap; a *traction* is a force per area.
"""

# %%
# Two bodies, one mesh
# --------------------
# Every body is an ordinary scikit-fem mesh. ``with_defaults`` names its sides ``left``, ``right``,
# ``bottom`` and ``top``. The meshes need not match: the plate's elements are 5 mm long, the
# sample's 4 mm.

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import (
    Basis,
    ElementQuad1,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshQuad,
    condense,
    solve,
)

import skfem_contact as sc
import skfem_contact.plot as plot
from skfem_contact.contact.laws import Status

plot.set_units("kN", "m")

plate = MeshQuad.init_tensor(
    np.linspace(0.00, 0.16, 33), np.linspace(0.00, 0.02, 5)
).with_defaults()
sample = MeshQuad.init_tensor(
    np.linspace(0.02, 0.12, 26), np.linspace(0.02, 0.04, 6)
).with_defaults()

# %%
# ``join_bodies`` puts them side by side into one mesh. They touch, but they share no node: nothing
# holds them together yet. Names take the body's name as a prefix, so that the sample's lower side
# is now ``sample:bottom``.

mesh = sc.join_bodies({"plate": plate, "sample": sample})
print(mesh)

# %%
# The basis is scikit-fem's, too: two displacements at every node of a four-node quadrilateral, and
# 2 x 2 quadrature points in every element.

basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)

# %%
# What carries load
# -----------------
# A *form* turns displacements into forces. There are two kinds:
#
# * A ``SolidForm`` holds the bodies together inside. It needs a material for every body.
# * A ``ContactPair`` acts between two boundaries. It looks for contact from the *slave*, the softer
#   body, on the *master*. Where the two touch, the pressure follows from a tiny penetration and the
#   friction from a tiny slip, up to Coulomb's limit :math:`|t_T| \le \mu |t_N|`.
#
# How tiny? That is the *penalty*: traction per penetration. Left out, it is taken from the
# stiffness of the elements on both sides, and a warning tells if they give way by more than a
# hundredth of what moves. Here 100 kPa penetrate by a micrometre.

mu = 0.5
concrete, soil = sc.LinearElastic(E=3e7, nu=0.2), sc.LinearElastic(E=1e4, nu=0.3)
forms = {
    "bodies": sc.SolidForm(basis, {"plate": concrete, "sample": soil}),
    "joint": sc.ContactPair(
        basis,
        slave="sample:bottom",
        master="plate:top",
        law=sc.Coulomb(mu=mu),
        quadrature="nodal",
        penalty=1e8,
    ),
}

# %%
# Loads and supports
# ------------------
# Loads are load vectors, made by scikit-fem's linear forms: here a pressure of 1 kPa on the top of
# the sample.

top = FacetBasis(mesh, basis.elem, facets="sample:top")
pressure = LinearForm(lambda v, w: -1.0 * v[1]).assemble(top)

# %%
# The plate rests on the ground. The sample's top is glued to a loading frame that moves sideways,
# and is free to move up and down; its horizontal displacements are prescribed. All these unknowns
# are *fixed*: they do not come from equilibrium.

held = basis.get_dofs("plate:bottom").all()
frame = basis.get_dofs("sample:top").all("u^1")
fixed = np.concatenate((held, frame))

# %%
# Press, then push
# ----------------
# A *stage* is a load and the displacements of the fixed unknowns, both as they stand at its end.
# Each stage starts from what the bodies carry. We press with 100 kPa, and push the frame by 1 mm in
# ten stages.


def press_and_push(kilopascals):
    """Press the sample, then move the frame by 1 mm in steps of 0.1 mm."""
    stages = [sc.Stage("press", kilopascals * pressure)]
    for millimetres in np.arange(1, 11) / 10:
        moved = basis.zeros()
        moved[frame] = 1e-3 * millimetres
        stages.append(sc.Stage(f"{millimetres:.1f} mm", kilopascals * pressure, prescribed=moved))
    return sc.Model(forms, fixed).run(stages)


result = press_and_push(100.0)
print(result)

# %%
# The table tells how the joint goes from stick to slip, point by point. Two points at the rear edge
# lift off, for the frame pushes at the top of the sample and friction holds it at the bottom. This
# is the sample at the end, displacements ten times enlarged; its shape before the test is grey.

plot.contour(result["1.0 mm"], "syy", deformed=10.0)

# %%
# What happens at the joint
# -------------------------
# A stage's result has the displacements ``x`` and the *state* of every form. From the state of a
# contact pair, ``tractions`` takes pressure, shear, gap, slip and status at each of its points,
# here the nodes of the sample's lower side.

fig, axes = plt.subplots(1, 3, figsize=(9, 3.2), sharey=True, layout="constrained")
for axis, stage in zip(axes, ("0.2 mm", "0.3 mm", "0.5 mm")):
    joint = result[stage].tractions("joint")
    axis.fill_between(
        1e3 * joint.x, mu * joint.pressure, color="0.9", label=r"friction limit $\mu p$"
    )
    axis.plot(1e3 * joint.x, joint.shear, "C0-", lw=1)
    for status, color in ((Status.STICK, "white"), (Status.SLIP, "C0")):
        at = joint.status == status
        label = f"friction, {status.name.lower()}"
        axis.plot(1e3 * joint.x[at], joint.shear[at], "C0o", mfc=color, label=label)
    axis.set(title=f"frame moved by {stage}", xlabel="position [mm]")
axes[0].set_ylabel("traction [kPa]")
axes[0].legend(frameon=False)

# %%
# The forces on the joint are sums over its points, each with the length of surface that belongs to
# it.


def forces(stage):
    """Normal and shear force of the joint in kN per metre of width."""
    joint = stage.tractions("joint")
    return (joint.pressure * joint.weight).sum(), (joint.shear * joint.weight).sum()


# %%
# The friction test
# -----------------
# The same with three pressures. The shear force rises with the stiffness of the sample until all
# points slip; then it stays, however far we push. These last values lie on Coulomb's line, and its
# slope is what we wanted to measure.

begin = process_time()
tests = {kilopascals: press_and_push(kilopascals) for kilopascals in (50.0, 100.0, 150.0)}
moved = np.arange(11) / 10
history = {
    kilopascals: np.array([forces(stage) for stage in test]) for kilopascals, test in tests.items()
}
last = np.array([curve[-1] for curve in history.values()])
measured = np.polyfit(*last.T, 1)[0]
cpu = process_time() - begin

fig, axes = plt.subplots(1, 2, figsize=(9, 3.4), sharey=True, layout="constrained")
for kilopascals, curve in history.items():
    axes[0].plot(moved, curve[:, 1], "o-", ms=4, label=f"{kilopascals:.0f} kPa")
axes[0].set(xlabel="frame moved by [mm]", ylabel="shear force [kN/m]")
axes[0].legend(frameon=False)
axes[1].plot([0, 17], [0, 17 * measured], "0.6", label=f"slope {measured:.4f}")
for force in last:
    axes[1].plot(*force, "o")
axes[1].set(xlabel="normal force [kN/m]", xlim=(0, 17), ylim=(0, 8.5), xticks=range(0, 16, 5))
axes[1].legend(frameon=False)

# %%
# A Newton loop of your own
# -------------------------
# ``run`` adds a line search, automatic steps and a progress bar. The method itself takes ten lines:
# sum up the forces, stop if they balance the load, else solve with the sum of the stiffnesses.
# Nothing is changed by a form's ``assemble``: it takes the last *accepted* state and proposes a new
# one.

load = 100.0 * pressure
free = np.setdiff1d(np.arange(basis.N), fixed)

x, state = basis.zeros(), {name: form.initial_state() for name, form in forms.items()}
for iteration in range(20):
    out = {name: form.assemble(x, state[name]) for name, form in forms.items()}
    residual = load - sum(o.force for o in out.values())
    print(f"iteration {iteration}: residual {np.linalg.norm(residual[free]):.1e}")
    if np.linalg.norm(residual[free]) < 1e-8 * np.linalg.norm(load):
        break
    x = x + solve(*condense(sum(o.stiffness for o in out.values()), residual, D=fixed))
state = {name: o.state for name, o in out.items()}  # accepting the step is an assignment

# %%
# Headline numbers
# ----------------
# The script checks what it has shown, and prints it in a form that programs can read.

normal_forces = last[:, 0] / (0.1 * np.array(list(tests)))
np.testing.assert_allclose(
    normal_forces, 1.0, rtol=1e-5
)  # the joint carries the load, up to its tilt
np.testing.assert_allclose(last[:, 1] / last[:, 0], mu, rtol=1e-6)  # all points slip
np.testing.assert_allclose(
    x, result["press"].x, atol=1e-8 * abs(x).max()
)  # two ways, one equilibrium

iterations = sum(sum(stage.iterations) for test in tests.values() for stage in test)
row = {
    "method": "node-to-segment",
    "n": len(joint.x),
    "unknowns": int(basis.N),
    "error": abs(measured / mu - 1.0),
    "cpu_s": round(cpu, 2),
    "iterations": iterations,
}
plt.show()
print(json.dumps({"case": "friction test", "rows": [row]}))
