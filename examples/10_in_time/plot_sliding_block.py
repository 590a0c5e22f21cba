r"""
A block that slides on a slope that shakes
==========================================

Newmark (1965) took a mass that slides on a slope for a rigid block. It stays in place until the
ground accelerates up the slope by more than :math:`g (\mu \cos\alpha - \sin\alpha)`. It then slides
with constant friction, until both have the same velocity again. Here the block is elastic and
Coulomb's law acts between its base and the ground. The slip is that of the rigid block.
"""

# %%
# Model
# -----
# The slope is a rigid line, and gravity is turned instead of the ground. Nothing but contact holds
# the block.

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc

g, slope, mu = 9.81, np.radians(10.0), 0.4
mesh = MeshQuad.init_tensor(np.linspace(0, 2, 3), np.linspace(0, 1, 2)).with_defaults()
basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
block = sc.SolidForm(basis, sc.LinearElastic(E=2e6, nu=0.2), unit_weight=20.0)
ground = sc.rigid.line((-10.0, 0.0), (10.0, 0.0))
joint = sc.ContactPair(basis, "bottom", ground, sc.Coulomb(mu=mu))
model = sc.Model(
    {"block": block, "joint": joint},
    gravity=(-np.sin(slope), -np.cos(slope)),
    gravity_acceleration=g,
)

# %%
# Shaking
# -------
# The ground moves along the slope, up it in the direction of x: one sine of 2 Hz. A record, such as
# ``sc.Record.read("station.AT2", scale=9.81)``, would do as well. The damping acts on the stiffness
# alone, by a first frequency near zero: a part with the mass would brake the sliding block.

step = 0.0025
t = step * np.arange(301)
record = sc.Record(step, 5.0 * np.sin(4 * np.pi * t) * (t <= 0.5))
damping = sc.Rayleigh(0.02, f=(1e-3, 32.0))
settings = sc.Dynamic(step, damping=damping, points=[(0.0, 0.0)])
shake = sc.Stage("shake", duration=t[-1], dynamic=settings, base=record)
result = model.run([sc.Stage("weight"), shake])
print(result)

# %%
# The rigid block
# ---------------
# Small steps of its equation of motion, for both directions.


def rigid_block(record, parts=20):
    """Times and displacements of a rigid block relative to the ground, positive up the slope."""
    step = record.step / parts
    time = step * np.arange(parts * (len(record.values) - 1) + 1)
    moved, v = [0.0], 0.0
    for a in np.interp(time[:-1] + step / 2, record.time, record.values):
        drive = -g * np.sin(slope) - a  # relative to the ground
        friction = mu * g * np.cos(slope)
        if v == 0.0 and abs(drive) <= friction:
            new = 0.0
        else:
            against = np.sign(v) if v != 0.0 else np.sign(drive)
            new = v + step * (drive - against * friction)
            if v != 0.0 and new * v < 0.0:
                new = 0.0
        moved.append(moved[-1] + step * (v + new) / 2)
        v = new
    return time, np.array(moved)


time, exact = rigid_block(record)
motion = result["shake"].history((0.0, 0.0))
slip = motion.values[:, 0] - motion.values[0, 0]
print(f"slip {-slip[-1]:.4f} m down the slope, rigid block {-exact[-1]:.4f} m")

fig, (top, bottom) = plt.subplots(2, 1, sharex=True, figsize=(7, 5), layout="constrained")
top.plot(record.time, record.values, lw=0.8)
limit = g * (mu * np.cos(slope) - np.sin(slope))
top.axhline(limit, color="k", lw=0.5)
top.set(ylabel="ground [m/s²]")
bottom.plot(time, -exact, "k", lw=3, alpha=0.3, label="rigid block")
bottom.plot(motion.time, -slip, label="finite elements")
bottom.set(xlabel="time [s]", ylabel="slip down the slope [m]")
bottom.legend(frameon=False)

# %%
# Energy
# ------
# Friction takes what the shaking and the weight bring.

energy = result["shake"].energy
fig, ax = plt.subplots(figsize=(7, 3), layout="constrained")
ax.plot(energy["time"], energy["work"], label="work of loads")
ax.plot(energy["time"], energy["friction"], label="friction")
ax.set(xlabel="time [s]", ylabel="energy [kJ/m]")
ax.legend(frameon=False)

# sphinx_gallery_start_ignore
import json

error = abs(slip[-1] / exact[-1] - 1)
assert error < 0.005, (slip[-1], exact[-1])
force = mu * 2.0 * 20.0 * np.cos(slope)
assert energy["friction"][-1] >= force * abs(slip[-1]) * 0.98
print(
    json.dumps(
        {
            "case": "sliding_block",
            "rows": [
                {
                    "method": "penalty",
                    "n": 2,
                    "unknowns": int(basis.N),
                    "error": float(error),
                    "cpu_s": None,
                    "iterations": sum(result["shake"].iterations),
                }
            ],
        }
    )
)
# sphinx_gallery_end_ignore
