r"""
Impact of two bars
==================

A bar of length L meets an equal one at rest. Waves of compression run through both with the
velocity :math:`c = \sqrt{E / \rho}` and come back from the free ends as waves of tension. The bars
touch for the time :math:`2 L / c`, press with the force :math:`\rho c v A / 2`, and exchange their
velocities: the first one rests, the second one flies on.
"""

# %%
# Model
# -----
# A stage with ``dynamic`` has inertia. Masses are unit weights over the acceleration of gravity.
# The first bar has a velocity at the start. Contact has no setting for impact: nodes of contact
# surfaces have no mass of their own, so that forces do not chatter.

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc

n, E, density, g, velocity = 60, 100.0, 1.0, 10.0, 0.1
h = 1.0 / n
c = np.sqrt(E / density)

left = MeshQuad.init_tensor(np.linspace(-1, 0, n + 1), [0, h]).with_defaults()
right = MeshQuad.init_tensor(np.linspace(0, 1, n + 1), [0, h]).with_defaults()
mesh = sc.join_bodies({"left": left, "right": right})
basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
bars = sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.0), unit_weight=density * g)
joint = sc.ContactPair(
    basis, "left:right", "right:left", sc.Coulomb(), enforcement=sc.DualMultipliers()
)
across = basis.get_dofs().all("u^2")
model = sc.Model({"bars": bars, "joint": joint}, across, gravity_acceleration=g)

# %%
# Run
# ---
# Waves pass one element in a step. ``rho_inf=1`` is the trapezoidal rule, which damps nothing.

at_start = basis.zeros()
at_start[basis.get_dofs(elements="left").all("u^1")] = velocity
settings = sc.Dynamic(step=h / c, rho_inf=1.0, velocity=at_start, points=[(-1, 0), (1, 0)])
stage = sc.Stage("impact", duration=3.0 / c, dynamic=settings, keep="all")
result = model.run([stage])
impact = result["impact"]
print(result)

# %%
# Force and energy
# ----------------

time = np.array([step.time for step in impact.increments])
force = np.array([step.contact("joint").force[0] for step in impact.increments])
exact = density * c * velocity * h / 2

fig, (top, bottom) = plt.subplots(2, 1, sharex=True, figsize=(7, 6), layout="constrained")
top.plot(time * c, -force / exact, label="contact")
top.plot([0, 0, 2, 2, 3], [0, 1, 1, 0, 0], "k:", label="exact")
top.set(ylabel=r"force / ($\rho$ c v A / 2)")
top.legend(frameon=False)
energy = impact.energy
for name in ("kinetic", "elastic"):
    bottom.plot(energy["time"] * c, energy[name] / energy["kinetic"][0], label=name)
bottom.set(xlabel="time c / L", ylabel="energy / first energy")
bottom.legend(frameon=False)

# %%
# The free ends wait for the wave
# -------------------------------
# The end of the first bar moves on with its velocity until the wave arrives after L / c, and then
# rests. The far end of the second bar then leaves with twice the velocity behind the wave.

fig, ax = plt.subplots(figsize=(7, 3), layout="constrained")
for point, label in (((-1, 0), "end of the left bar"), ((1, 0), "end of the right bar")):
    motion = impact.history(point, "velocity")
    ax.plot(motion.time * c, motion.values[:, 0] / velocity, label=label)
ax.set(xlabel="time c / L", ylabel="velocity / v")
ax.legend(frameon=False)

# sphinx_gallery_start_ignore
import json

touching = time[-force > 0.02 * exact].max() * c
assert abs(touching / 2 - 1) < 0.0101 * 100 / n, touching
mean = -force[(time * c > 0.1) & (time * c < 1.9)].mean() / exact
assert abs(mean - 1) < 0.01, mean
total = energy["kinetic"] + energy["elastic"]
assert abs(total / total[0] - 1).max() < 2e-3, total / total[0]
print(
    json.dumps(
        {
            "case": "impact",
            "rows": [
                {
                    "method": "multipliers",
                    "n": n,
                    "unknowns": int(basis.N),
                    "error": float(abs(touching / 2 - 1)),
                    "cpu_s": None,
                    "iterations": sum(impact.iterations),
                }
            ],
        }
    )
)
# sphinx_gallery_end_ignore
