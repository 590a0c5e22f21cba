#!/usr/bin/env bash
# pybullet 3.2.7: a cube that stands on level ground falls over.
#
# Expected: the centre of mass of a body whose shape is a mesh is the centroid of the mesh, wherever the
#     origin of its coordinates lies, and its inertia is that of the solid.
# Seen: a cube of 1 m on level ground rests if its coordinates begin in its middle.  With the same cube in
#     the same place and the origin 5 cm outside a face it turns by 90 degrees to the other side.  The
#     inertia of a tetrahedron is 0.169 in place of 0.075, the one of a box around it.  mujoco 4.0.0
#     finds the centroid, and its cube rests in both cases.  No message.
# Meaning: the centre of mass is the origin of the mesh, and the inertia that of a bounding box.  Rocks
#     from a survey or a scan have their origin at a corner or in map coordinates: toppling, run-out and
#     bearing pressure are those of another body.  Move the coordinates to the centroid, and set
#     `localInertiaDiagonal`.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pybullet==3.2.7 mujoco==4.0.0 numpy==2.4.6
cat > run.py <<'PY'
import mujoco
import numpy as np
import pybullet

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
MIDDLE = CUBE - 0.5
OUTSIDE = MIDDLE + [0.55, 0, 0]


def tilt_in_pybullet(points):
    """Largest angle between the vertical and the axis that was vertical, in degrees."""
    pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(0, 0, -9.81)
    pybullet.createMultiBody(0, pybullet.createCollisionShape(pybullet.GEOM_PLANE))
    shape = pybullet.createCollisionShape(pybullet.GEOM_MESH, vertices=points.tolist())
    place = [-points[:, 0].mean(), 0, 0.5]
    body = pybullet.createMultiBody(100, shape, basePosition=place)
    largest = 0.0
    for _ in range(720):
        pybullet.stepSimulation()
        _, turn = pybullet.getBasePositionAndOrientation(body)
        upright = np.reshape(pybullet.getMatrixFromQuaternion(turn), (3, 3))[2, 2]
        largest = max(largest, np.degrees(np.arccos(np.clip(upright, -1, 1))))
    pybullet.disconnect()
    return largest


def tilt_in_mujoco(points):
    """The same in the other program."""
    vertex = " ".join(str(value) for value in points.ravel())
    model = mujoco.MjModel.from_xml_string(f"""<mujoco>
    <asset><mesh name="cube" vertex="{vertex}"/></asset>
    <worldbody><geom type="plane" size="5 5 1"/>
    <body pos="{-points[:, 0].mean()} 0 0.5"><freejoint/><geom type="mesh" mesh="cube"/></body>
    </worldbody></mujoco>""")
    data = mujoco.MjData(model)
    largest = 0.0
    while data.time < 3:
        mujoco.mj_step(model, data)
        upright = data.xmat[1].reshape(3, 3)[2, 2]
        largest = max(largest, np.degrees(np.arccos(np.clip(upright, -1, 1))))
    return largest


for name, points in (("in the middle", MIDDLE), ("5 cm outside", OUTSIDE)):
    bullet, other = tilt_in_pybullet(points), tilt_in_mujoco(points)
    print(f"origin {name}: the cube turns by {bullet:.1f} degrees, in mujoco by {other:.1f}")
    assert other < 0.5
    assert bullet < 0.5 if points is MIDDLE else bullet > 80

# A tetrahedron of unit mass around its centroid: 3/80 of the sum of two squares of its edges.
corner = np.vstack([np.zeros(3), np.eye(3)]) - 0.25
pybullet.connect(pybullet.DIRECT)
shape = pybullet.createCollisionShape(pybullet.GEOM_MESH, vertices=corner.tolist())
inertia = pybullet.getDynamicsInfo(pybullet.createMultiBody(1, shape), -1)[2]
right = 2 * 3 / 80
print(f"inertia of the tetrahedron {np.round(inertia, 4)}, right {right} about each axis")
assert np.allclose(inertia, 0.1687, atol=0.002)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
