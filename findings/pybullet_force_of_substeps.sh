#!/usr/bin/env bash
# pybullet 3.2.7: with four substeps a block weighs a quarter.
#
# Expected: the contact forces of a block at rest add up to its weight, however many substeps a step
#     has; more substeps make them more exact.
# Seen: a block of 100 kg on a slope of 10 degrees has a normal force of 966 N and a friction of 170 N
#     without substeps, which is right.  With numSubSteps of 2, 4 and 10 `getContactPoints` returns 483,
#     240 and 97 N, and 85, 43 and 17 N.  The block rests in all cases.
# Meaning: the impulse of the last substep is divided by the length of the whole step.  Loads on
#     nets, walls and foundations, and joint forces that are compared with a strength, are too small
#     by the number of substeps, which is raised where a stiff contact needs it.  The ratio of friction
#     to normal force stays right and hides it.  Compare with the weight.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pybullet==3.2.7 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import pybullet

MASS, SLOPE = 100.0, np.radians(10)


def forces(substeps):
    """Normal force and friction between a block at rest and a slope, in N."""
    pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(9.81 * np.sin(SLOPE), 0, -9.81 * np.cos(SLOPE))
    pybullet.setPhysicsEngineParameter(fixedTimeStep=1 / 240, numSubSteps=substeps)
    ground = pybullet.createMultiBody(0, pybullet.createCollisionShape(pybullet.GEOM_PLANE))
    box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[0.5, 0.5, 0.25])
    block = pybullet.createMultiBody(MASS, box, basePosition=[0, 0, 0.25])
    for body in (ground, block):
        pybullet.changeDynamics(body, -1, lateralFriction=1.0)
    for _ in range(480):
        pybullet.stepSimulation()
    points = pybullet.getContactPoints(block, ground)
    normal = sum(point[9] for point in points)
    friction = sum(
        point[10] * np.array(point[11]) + point[12] * np.array(point[13]) for point in points
    )
    speed, _ = pybullet.getBaseVelocity(block)
    pybullet.disconnect()
    assert np.linalg.norm(speed) < 1e-3
    return normal, np.linalg.norm(friction)


weight = 9.81 * MASS * np.array([np.cos(SLOPE), np.sin(SLOPE)])
for substeps in (0, 2, 4, 10):
    found = np.array(forces(substeps))
    print(f"numSubSteps={substeps}: {found.round(1)} N, right {weight.round(1)} N")
    assert np.allclose(found, weight / max(substeps, 1), rtol=0.02)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
