r"""
A retaining wall that slides and tilts
======================================

A gravity wall is pushed by earth pressure and shaken until it slides and its heel lifts. An
independent integration of a rigid wall with three degrees of freedom has the same bed: springs
without tension, :math:`p = k \langle -g \rangle`, and Coulomb's friction. These are the penalties
of the contact pair, so that both walls are the same physics. They slide and tilt alike.
"""

# %%
# Wall, bed and earth pressure
# ----------------------------
# The wall is stiff, its bed is a subgrade of ``k`` per area. The backfill pushes with the active
# thrust at a third of the height, and the increment of Seed and Whitman (1970),
# :math:`\tfrac34 k_h \gamma H^2 / 2` at 0.6 of the height, in phase with the ground.

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc

b, H, g, mu, k = 2.4, 4.0, 9.81, 0.5, 2e5
thrust = 0.5 * 0.3 * 18.0 * H**2
increment = 0.75 * 18.0 * H**2 / 2  # by a unit of k_h

step = 2e-3
time = step * np.arange(1001)
rise = np.sin(np.pi * np.minimum(time, 1.0))
shaking = sc.Record(step, -0.5 * g * np.sin(4 * np.pi * time) * rise)

# %%
# Finite elements
# ---------------
# Rotations count: solids have finite rotations, and consistent masses stay at their nodes. The
# damping brakes masses only, with 5/s in both models.

mesh = MeshQuad.init_tensor(np.linspace(-b / 2, b / 2, 9), np.linspace(0, H, 5)).with_defaults()
basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
concrete = sc.LinearElastic(E=3e7, nu=0.2)
wall = sc.SolidForm(basis, concrete, unit_weight=24.0, kinematics="finite")
floor = sc.rigid.line((-20.0, 0.0), (20.0, 0.0))
base = sc.ContactPair(basis, "bottom", floor, sc.Coulomb(mu=mu), penalty=k)
model = sc.Model({"wall": wall, "base": base}, gravity_acceleration=g)

at_rest = sc.traction(basis, "left", lambda x: (2 * thrust / H * (1 - x[1] / H), 0 * x[0]))
by_k = sc.traction(
    basis, "left", lambda x: (increment / H * (1 + 0.6 * (2 * x[1] / H - 1)), 0 * x[0])
)
settings = sc.Dynamic(
    step,
    mass="consistent",
    contact_mass="kept",
    damping=sc.Rayleigh(0.25, f=(5 / np.pi, 1e6)),
    points=[(-b / 2, 0.0), (b / 2, 0.0)],
)
push = sc.Stage("push", at_rest, increments=2)
shake = sc.Stage(
    "shake",
    lambda t: at_rest - by_k * shaking.at(t) / g,
    duration=time[-1],
    dynamic=settings,
    base=shaking,
)
result = model.run([push, shake])
print(result)

heel, toe = (result["shake"].history(x).values for x in settings.points)
slide = (heel + toe)[:, 0] / 2
slide = slide - slide[0]
tilt = np.arctan2(heel[:, 1] - toe[:, 1], b + toe[:, 0] - heel[:, 0])

# %%
# The rigid wall
# --------------
# Small explicit steps, without the package: displacements of the centre and the rotation, springs
# along the base whose tangential force yields at :math:`\mu p`.


def rigid_wall(mu=mu, k=k, dt=2e-4, springs=40):
    """Slide of the base and tilt at the times of the record."""
    m = 24.0 / g * b * H
    inertia = np.array([m, m, m * (b**2 + H**2) / 12])
    area = b / springs
    x = area * (np.arange(springs) + 0.5) - b / 2
    tangential = np.zeros(springs)
    q, v = np.array([0.0, -m * g / (k * b), 0.0]), np.zeros(3)

    def step_of(a, damping):
        nonlocal q, v, tangential
        cos, sin = np.cos(q[2]), np.sin(q[2])
        X, Z = cos * x - sin * H / 2, -sin * x - cos * H / 2  # base from the centre
        p = k * np.maximum(-(Z + H / 2 + q[1]), 0)
        trial = tangential - k * (v[0] + v[2] * Z) * dt
        tangential = np.clip(trial, -mu * p, mu * p)
        extra = -increment * a / g
        force = np.array([tangential.sum() * area, p.sum() * area - m * g, 0.0])
        force[2] = area * (tangential @ Z - p @ X)
        for push, height in ((thrust, H / 3), (extra, 0.6 * H)):
            force[0] += push
            force[2] += push * (sin * b / 2 + cos * (height - H / 2))
        force[0] -= m * a
        v = v + dt * (force / inertia - damping * v)
        q = q + dt * v

    for _ in range(5_000):  # come to rest
        step_of(0.0, 30.0)
    v[:] = 0.0
    found = [q]
    parts = round(step / dt)
    for a0, a1 in zip(shaking.values, shaking.values[1:]):
        for j in range(parts):
            step_of(a0 + (j + 0.5) / parts * (a1 - a0), 5.0)
        found.append(q)
    ux, _, turned = np.array(found).T
    moved = ux - H / 2 * np.sin(turned)
    return moved - moved[0], turned


exact, turned = rigid_wall()
print(f"residual slide {slide[-1]:.4f} m, rigid wall {exact[-1]:.4f} m")
print(f"largest tilt {tilt.max():.5f}, rigid wall {turned.max():.5f}")

fig, (top, bottom) = plt.subplots(2, 1, sharex=True, figsize=(7, 5), layout="constrained")
top.plot(time, exact, "k", lw=3, alpha=0.3, label="rigid wall")
top.plot(time, slide, label="finite elements")
top.set(ylabel="slide [m]")
top.legend(frameon=False)
bottom.plot(time, np.degrees(turned), "k", lw=3, alpha=0.3)
bottom.plot(time, np.degrees(tilt))
bottom.set(xlabel="time [s]", ylabel="tilt [degrees]")

# %%
# What the slide depends on
# -------------------------
# A tenth less friction changes the slide by far more than both walls differ. The bed is elastic:
# the wall rocks back to its first tilt, and the slide stays.

slippery = rigid_wall(mu=0.9 * mu)[0][-1]
print(f"with a tenth less friction {slippery:.4f} m")

# sphinx_gallery_start_ignore
import json

errors = abs(slide[-1] / exact[-1] - 1), abs(tilt.max() / turned.max() - 1)
assert max(errors) < 0.05, errors
assert exact[-1] > 0.04
assert turned.max() > np.radians(0.9)
assert slippery > 1.2 * exact[-1], slippery
# both have come to rest, and the way, not the end alone
assert abs(exact[-100] / exact[-1] - 1) < 0.01
assert np.abs(slide - exact).max() < 0.05 * exact.max()
assert np.abs(tilt - turned).max() < 0.1 * turned.max()
# the steps of the rigid wall are short enough
finer = rigid_wall(dt=1e-4)
assert abs(finer[0][-1] / exact[-1] - 1) < 1e-3
print(
    json.dumps(
        {
            "case": "shaken_wall",
            "rows": [
                {
                    "method": method,
                    "n": 8,
                    "unknowns": int(basis.N),
                    "error": float(error),
                    "cpu_s": None,
                    "iterations": sum(result["shake"].iterations),
                }
                for method, error in zip(("residual slide", "largest tilt"), errors)
            ],
        }
    )
)
# sphinx_gallery_end_ignore
