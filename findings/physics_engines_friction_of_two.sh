#!/usr/bin/env bash
# mujoco 4.0.0, pybullet 3.2.7, pymunk 7.3.1: one coefficient of friction, three slopes.
#
# Expected: a block and a plane, both with a friction coefficient of 0.6 (31 degrees), rest at 25
#     degrees; a smooth block (0.1) slides on a rough plane (1.0) at 20 degrees.
# Seen: at 25 degrees the block rests in mujoco and slides more than a metre in 2 s in pybullet and
#     pymunk, which take the product, 0.36 (20 degrees).  The smooth block slides in these two and stays
#     in mujoco, which takes the larger one.  A plane without a value has 1 in mujoco, 0.5 in pybullet
#     and 0 in pymunk.
# Meaning: a coefficient from a tilt test must be entered as its root for both bodies in two of the
#     programs.  In mujoco a smooth base, a membrane or an oiled plane has no effect as long as the
#     other body keeps the default of 1: a slide that should happen does not.  Check one tilt test.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    mujoco==4.0.0 pybullet==3.2.7 pymunk==7.3.1 numpy==2.4.6
cat > run.py <<'PY'
import mujoco
import numpy as np
import pybullet
import pymunk

SCENE = """<mujoco><option gravity="{x} 0 {z}" cone="elliptic"/><worldbody>
<geom type="plane" size="50 50 1" {plane}/>
<body pos="0 0 0.25"><freejoint/>
<geom type="box" size="0.5 0.5 0.25" mass="100" {block}/></body></worldbody></mujoco>"""


def in_mujoco(x, z, block, plane):
    words = ["" if mu is None else f'friction="{mu} 0.005 0.0001"' for mu in (block, plane)]
    model = mujoco.MjModel.from_xml_string(SCENE.format(x=x, z=z, block=words[0], plane=words[1]))
    data = mujoco.MjData(model)
    while data.time < 2:
        mujoco.mj_step(model, data)
    return data.qpos[0]


def in_pybullet(x, z, block, plane):
    pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(x, 0, z)
    ground = pybullet.createMultiBody(0, pybullet.createCollisionShape(pybullet.GEOM_PLANE))
    box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[0.5, 0.5, 0.25])
    body = pybullet.createMultiBody(100, box, basePosition=[0, 0, 0.25])
    for number, mu in ((body, block), (ground, plane)):
        if mu is not None:
            pybullet.changeDynamics(number, -1, lateralFriction=mu)
    for _ in range(480):
        pybullet.stepSimulation()
    place, _ = pybullet.getBasePositionAndOrientation(body)
    pybullet.disconnect()
    return place[0]


def in_pymunk(x, z, block, plane):
    space = pymunk.Space()
    space.gravity = (x, z)
    ground = pymunk.Segment(space.static_body, (-50, 0), (50, 0), 0.0)
    body = pymunk.Body(100, 100)
    body.position = (0, 0.25)
    box = pymunk.Poly.create_box(body, (1, 0.5))
    for shape, mu in ((box, block), (ground, plane)):
        if mu is not None:
            shape.friction = mu
    space.add(ground, body, box)
    for _ in range(1000):
        space.step(1 / 500)
    return body.position.x


# Degrees, coefficients of block and plane, and who moves in mujoco, pybullet, pymunk.
for degrees, block, plane, moves in (
    (25, 0.6, 0.6, (False, True, True)),
    (15, 0.6, 0.6, (False, False, False)),
    (20, 0.1, 1.0, (False, True, True)),
    (30, 1.0, None, (False, True, True)),
    (10, 1.0, None, (False, False, True)),
):
    x, z = 9.81 * np.sin(np.radians(degrees)), -9.81 * np.cos(np.radians(degrees))
    slips = [run(x, z, block, plane) for run in (in_mujoco, in_pybullet, in_pymunk)]
    print(f"{degrees} degrees, {block} on {plane}: {np.round(slips, 2)} m")
    assert tuple(slip > 0.5 for slip in slips) == moves
    assert all(slip > 0.5 or slip < 0.02 for slip in slips)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
