#!/usr/bin/env bash
# mujoco 4.0.0: wood sinks in water, and a block on the sea bed weighs as much as in air.
#
# Expected: the `density` of the medium, 1000 kg/m3 for water, gives buoyancy as well as drag: a block of 1 m3 and 2000
#     kg presses on the ground with 9.81 kN under water, and wood of 500 kg/m3 rises.
# Seen: the contact forces of the block sum up to 19.62 kN, with and without water.  A wooden ball of 0.1 m radius sinks
#     with 1.3 m/s, or 1.1 m/s with `fluidshape="ellipsoid"`.  A ball of rock (2650 kg/m3) reaches 3.01 m/s in place of
#     2.38 m/s, by the drag of the first model and its weight under water.  With
#     `gravcomp` 0.5 on the body, the ratio of the densities, the block presses with 9.81 kN.  No message.
# Meaning: rocks of a scour protection, blocks of a breakwater and objects that are set down on the sea bed have
#     twice the friction that holds them, and fall too fast.  Set `gravcomp` of each body to the density of water over
#     its own, and check one contact force.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    mujoco==4.0.0 numpy==2.4.6
cat > run.py <<'PY'
import math

import mujoco
import numpy as np

GRAVITY, WATER, BLOCK, WOOD, ROCK, RADIUS = 9.81, 1000.0, 2000.0, 500.0, 2650.0, 0.1


def run(medium, body, ground="", seconds=5.0):
    """State of a free body after some seconds in a medium."""
    text = (
        f'<mujoco><option density="{medium}" gravity="0 0 {-GRAVITY}" timestep="0.001"/><worldbody>{ground}'
        f"{body}</worldbody></mujoco>"
    )
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    for _ in range(round(seconds / model.opt.timestep)):
        mujoco.mj_step(model, data)
    return model, data


def weight(medium, compensation):
    """Sum of the vertical contact forces in kN below a block of 1 m3."""
    block = (
        f'<body pos="0 0 0.5" gravcomp="{compensation}"><freejoint/>'
        f'<geom type="box" size="0.5 0.5 0.5" density="{BLOCK}"/></body>'
    )
    model, data = run(medium, block, '<geom type="plane" size="5 5 0.1"/>')
    wrench, total = np.zeros(6), 0.0
    for contact in range(data.ncon):
        mujoco.mj_contactForce(model, data, contact, wrench)
        total += wrench[0] / 1e3
    return total


def velocity(density, compensation, shape="none"):
    """Vertical velocity of a ball after a long fall in water."""
    ball = (
        f'<body gravcomp="{compensation}"><freejoint/>'
        f'<geom type="sphere" size="{RADIUS}" density="{density}" fluidshape="{shape}"/></body>'
    )
    return run(WATER, ball, seconds=20.0)[1].qvel[2]


in_air, in_water, compensated = weight(0.0, 0.0), weight(WATER, 0.0), weight(WATER, WATER / BLOCK)
right = (BLOCK - WATER) * GRAVITY / 1e3
print(f"block: {in_air:.3f} kN in air, {in_water:.3f} in water, {compensated:.3f} with gravcomp, right {right:.3f}")
assert math.isclose(in_air, BLOCK * GRAVITY / 1e3, rel_tol=1e-4) and math.isclose(in_water, in_air, rel_tol=1e-4)
assert math.isclose(compensated, right, rel_tol=1e-4)

wood = [velocity(WOOD, 0.0, shape) for shape in ("none", "ellipsoid")]
rising = velocity(WOOD, WATER / WOOD)
print(f"ball of wood: {wood[0]:.2f} and {wood[1]:.2f} m/s, with gravcomp {rising:.2f} m/s")
assert -1.5 < wood[0] < -1.0 and -1.5 < wood[1] < -1.0 and rising > 1.0

rock, slower = velocity(ROCK, 0.0), velocity(ROCK, WATER / ROCK)
print(f"ball of rock: {rock:.2f} m/s, with gravcomp {slower:.2f} m/s")
assert math.isclose(rock / slower, math.sqrt(ROCK / (ROCK - WATER)), rel_tol=1e-3)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
