r"""
A crushed tube that touches itself
==================================

Two stiff plates crush a rubber tube until its inner wall folds onto itself. The wall is one named
boundary, which is given as slave and as master. Facets near a point, along the wall, are its
neighbours and do not touch it; each wall carries half of the contact work.

The upper half of the tube on a smooth rigid plane of symmetry needs no self-contact. The plane is
touched at half of the gap, so with twice the penalty, and the force on the plates must be the same.
"""

import json
import sys
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

n = int(sys.argv[1]) if len(sys.argv) > 1 else 36  # elements on the half circle
inner, outer, penalty = 1.0, 1.25, 3e3


def tube(angle, parts):
    """Return the basis of the right part of a tube from an angle on, with plates."""
    elements = round(n * (0.5 - angle / np.pi))
    grid = MeshQuad.init_tensor(
        np.linspace(inner, outer, 4), np.linspace(angle, np.pi / 2, elements + 1)
    ).with_defaults()
    radius, turn = grid.p
    points = np.array([radius * np.cos(turn), radius * np.sin(turn)])
    bodies = {"tube": MeshQuad(points, grid.t, _boundaries=grid.boundaries)}
    plate = MeshQuad.init_tensor(np.linspace(0, 2, 16), np.linspace(0, 0.25, 2)).with_defaults()
    places = {"above": outer, "below": -outer - 0.25}
    bodies.update({part: plate.translated((0.0, places[part])) for part in parts})
    return Basis(sc.join_bodies(bodies), ElementVector(ElementQuad1()), intorder=2)


def solids(basis):
    """Return the bodies: a soft tube and stiff plates."""
    materials = {name: sc.NeoHooke(E=1000.0, nu=0.3) for name in basis.mesh.subdomains}
    materials["tube"] = sc.NeoHooke(E=10.0, nu=0.4)
    return sc.SolidForm(basis, materials, kinematics="finite")


# %%
# The whole tube, by its right half. Five points on each facet of the inner wall, which stay where
# they are, look for the wall opposite.

smooth = sc.Coulomb(mu=0.0)
basis = tube(-np.pi / 2, ["above", "below"])
forms = {
    "bodies": solids(basis),
    "above": sc.ContactPair(basis, "tube:right", "above:bottom", smooth, 5, 1e4),
    "below": sc.ContactPair(basis, "tube:right", "below:top", smooth, 5, 1e4),
    "inside": sc.ContactPair(basis, "tube:left", "tube:left", smooth, penalty=penalty),
}
above, below = basis.get_dofs("above:top"), basis.get_dofs("below:bottom")
middle = basis.get_dofs(lambda x: np.abs(x[0]) < 1e-9).all("u^1")
fixed = np.unique(np.concatenate([above.all(), below.all(), middle]))
ways = np.array([0.3, 0.6, 0.8, 0.9, 0.96, 0.99, 1.01, 1.03])

stages = []
for way in ways:
    u = np.zeros(basis.N)
    u[above.all("u^2")], u[below.all("u^2")] = -way, way
    stages.append(sc.Stage(f"{2 * way:.2f} crushed", prescribed=u))
start = process_time()
result = sc.Model(forms, fixed).run(stages)
seconds = process_time() - start

# %%
# The upper half on a rigid plane.

part = tube(0.0, ["above"])
plane = sc.rigid.line((-1.0, 0.0), (3.0, 0.0))
forms_of_part = {
    "bodies": solids(part),
    "above": sc.ContactPair(part, "tube:right", "above:bottom", smooth, 5, 1e4),
    "inside": sc.ContactPair(part, "tube:left", plane, smooth, quadrature=5, penalty=2 * penalty),
}
top = part.get_dofs("above:top")
axis = part.get_dofs(lambda x: np.abs(x[0]) < 1e-9).all("u^1")
held = np.unique(np.concatenate([top.all(), axis, part.get_dofs("tube:bottom").all("u^2")]))
stages_of_part = []
for way in ways:
    u = np.zeros(part.N)
    u[top.all("u^2")] = -way
    stages_of_part.append(sc.Stage(f"{2 * way:.2f} crushed", prescribed=u))
reference = sc.Model(forms_of_part, held).run(stages_of_part)

force = np.array([2 * abs(stage.reactions()[above.all("u^2")].sum()) for stage in result])
exact = np.array([2 * abs(stage.reactions()[top.all("u^2")].sum()) for stage in reference])

fig, ax = plt.subplots()
ax.semilogy(2 * ways, exact, "k-", lw=0.8, label="half on a plane")
ax.semilogy(2 * ways, force, "o", label="self-contact")
ax.set_xlabel("approach of the plates")
ax.set_ylabel("force on a plate")
ax.legend()
plt.show()

# %%
# The walls lie on each other except in the loop at the side.

plot.contour(result[-1], "mises")


touching = (result[-1].states["inside"].status > 0).mean()
iterations = [sum(stage.iterations) for stage in result]
error = float(np.abs(force / exact - 1.0).max())
print(f"largest difference of a force {error:.1e}; {touching:.0%} of the inner wall touches itself")
# the forces of the walls on each other have no resultant
resultant = float(np.abs(result[-1].contact("inside").normal).max())
print(f"resultant of self-contact {resultant:.1e}, force of a plate {force[-1]:.3g}")
assert resultant < 1e-9 * force[-1]
# gaps count along normals of facets, which tilt a little
assert error < 1e-4
assert touching > 0.5
print(
    json.dumps(
        {
            "case": "crushed_tube",
            "rows": [
                {
                    "method": "self-contact",
                    "n": n,
                    "unknowns": int(basis.N),
                    "error": error,
                    "cpu_s": seconds,
                    "iterations": sum(iterations),
                }
            ],
        }
    )
)
