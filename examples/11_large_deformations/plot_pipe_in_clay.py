r"""
A pipe pushed into clay, with new meshes
========================================

A smooth pipe of diameter D is pushed into weightless clay of the undrained strength :math:`s_u`,
by half of its diameter or more. The clay flows round the pipe and heaves beside it. Its elements
become too long before, so that the body gets new ones at each tenth of the diameter.

Merifield, White and Randolph (2009) fitted finite element analyses of large strains with

.. math::

    \frac{V}{D s_u} = 5.3 \left(\frac{w}{D}\right)^{0.25} .
"""

import json
import sys
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

D, su = 1.0, 1.0
h = 0.08 * D  # elements near the pipe
numbers = [float(given) for given in sys.argv[1:] if not given.startswith("-")]
depth = numbers[0] if numbers else 0.5  # 1.0 takes twice as long
wide, deep = 5.0 * D, 4.0 * D


def size(x):
    """Return the size of elements: constant within .8 D of the pipe's centre, then growing."""
    distance = np.hypot(x[0], x[1] - D / 2)
    return h + 0.3 * np.maximum(0.0, distance - 0.8 * D)


# %%
# The pipe is a rigid circle that stays; the bottom of the clay moves up. A penalty of 5000 su / D
# lets the clay penetrate by a thousandth of the diameter. The default one follows the stiffness of
# nearly incompressible clay, and is so hard that points go on and off in each iteration.


def model_of(mesh):
    """Return basis and model of the right half of the clay."""
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
    clay = sc.Tresca(E=500.0 * su, nu=0.49, c=su)
    circle = sc.rigid.circle((0.0, D / 2), D / 2)
    forms = {
        "clay": sc.SolidForm(basis, clay, kinematics="finite"),
        "pipe": sc.ContactPair(basis, "top", circle, sc.Coulomb(), 3, 5000.0 * su / D),
    }
    sides = [basis.get_dofs(name).all("u^1") for name in ("left", "right")]
    return basis, sc.Model(forms, np.concatenate([basis.get_dofs("bottom").all(), *sides]))


def pushed(basis, ways):
    """Return stages by which the bottom has moved up since the mesh was made."""
    bottom = basis.get_dofs("bottom").all("u^2")
    stages = []
    for way in ways:
        u = basis.zeros()
        u[bottom] = way
        stages.append(sc.Stage(f"{way:.3f} on", prescribed=u))
    return stages


# %%
# The first mesh is that of a block at rest. Each further one begins with the stresses and the
# contact of the last one, and finds equilibrium in its first stage.

block = MeshQuad.init_tensor(np.linspace(0, wide, 6), np.linspace(-deep, 0, 5)).to_meshtri()
block = block.with_boundaries(
    {
        "left": lambda x: x[0] < 1e-9,
        "right": lambda x: x[0] > wide - 1e-9,
        "bottom": lambda x: x[1] < 1e-9 - deep,
        "top": lambda x: x[1] > -1e-9,
    }
)
began = process_time()
basis, model = model_of(block)
stage = model.run([sc.Stage("at rest")])[-1]
w, V, lost, making = [0.0], [0.0], [], 0.0
iterations = 0
for _ in range(round(10 * depth)):
    making -= process_time()
    new = sc.remeshed(stage, size)
    basis, model = model_of(new.mesh)
    start = new.start(model)
    making += process_time()
    lost.append(new.loss(start)["lost"][:2])
    result = model.run(pushed(basis, D * np.arange(1, 6) / 50), start=start)
    for stage in list(result)[1:]:
        w.append(w[-1] + D / 50)
        V.append(2.0 * stage.reactions()[basis.get_dofs("bottom").all("u^2")].sum())
        iterations += sum(stage.iterations)
seconds = process_time() - began
w, V = np.array(w), np.array(V)

fig, ax = plt.subplots()
fine = np.linspace(0.0, depth, 100)
ax.plot(fine, 5.3 * fine**0.25, "k-", lw=0.8, label="Merifield et al. 2009")
ax.plot(w / D, V / (D * su), "o-", ms=3, label="computed")
ax.set_xlabel("penetration w / D")
ax.set_ylabel("V / (D su)")
ax.legend()
plt.show()

# %%
# The clay beside the pipe, with its last elements. Where a new mesh begins the force falls by a
# twentieth: interpolated stresses are out of balance until the clay flows on.

plot.contour(stage, "mises")

tenths = np.arange(5, len(w), 5)
errors = V[tenths] / (5.3 * (w[tenths] / D) ** 0.25 * D * su) - 1.0
for at, force, error in zip(w[tenths], V[tenths], errors):
    print(f"w / D = {at:.1f}: V / (D su) = {force:.3f}, {error:+.1%} off")
volume, strength = np.max(lost, axis=0)
print(f"largest loss at a new mesh: volume {volume:.1e}, stress {strength:.1e}")
print(f"new meshes and states take {making / seconds:.1%} of the time")
assert np.abs(errors).max() < 0.04
assert volume < 2e-4
assert strength < 1e-3
if "--full" in sys.argv:
    assert making < 0.1 * seconds
print(
    json.dumps(
        {
            "case": "pipe_in_clay",
            "rows": [
                {
                    "method": "T6, new meshes",
                    "n": int(new.mesh.nelements),
                    "unknowns": int(basis.N),
                    "error": float(np.abs(errors).max()),
                    "cpu_s": seconds,
                    "iterations": iterations,
                }
            ],
        }
    )
)
