#!/usr/bin/env bash
# mujoco 4.0.0, trimesh 5.2.0, scipy 1.17.1, pybullet 3.2.7: a block that leans by 30 degrees lies upside down.
#
# Expected: four libraries that turn bodies by quaternions have one order of the four numbers, w x y z or x y z w, so
#     that the quaternion of a rock block in one of them is the one of the next.
# Seen: a turn by 30 degrees about y.  mujoco and trimesh write it as (0.966, 0, 0.259, 0), scipy and pybullet as (0,
#     0.259, 0, 0.966).  Given to scipy or pybullet, the first is a turn by 180 degrees about (0.966, 0, 0.259), and
#     the upward axis of the block, 30 degrees from the vertical, is 150 degrees from it.  No turn at all, (1, 0, 0,
#     0), becomes a half turn.  Given to mujoco or trimesh, the second is a half turn, too.  No message: both are unit
#     quaternions.
# Meaning: falls of rock that are simulated in one library and evaluated or drawn by another end in other positions,
#     which look as plausible as the right ones.  Pass matrices of rotation between libraries, or give scipy
#     `scalar_first=True`, and try the identity first.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    mujoco==4.0.0 trimesh==5.2.0 scipy==1.17.1 pybullet==3.2.7 numpy==2.4.6
cat > run.py <<'PY'
import mujoco
import numpy as np
import pybullet
import trimesh.transformations
from scipy.spatial.transform import Rotation

AXIS = np.array([0.0, 1.0, 0.0])


def of_mujoco(angle):
    """The quaternion of a turn about the axis."""
    quaternion = np.empty(4)
    mujoco.mju_axisAngle2Quat(quaternion, AXIS, angle)
    return quaternion


def matrix_of_mujoco(quaternion):
    """The matrix of a rotation."""
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, quaternion)
    return matrix.reshape(3, 3)


WRITE = {
    "mujoco": of_mujoco,
    "trimesh": lambda angle: trimesh.transformations.quaternion_about_axis(angle, AXIS),
    "scipy": lambda angle: Rotation.from_rotvec(angle * AXIS).as_quat(),
    "pybullet": lambda angle: np.array(pybullet.getQuaternionFromAxisAngle(AXIS.tolist(), angle)),
}
READ = {
    "mujoco": matrix_of_mujoco,
    "trimesh": lambda quaternion: trimesh.transformations.quaternion_matrix(quaternion)[:3, :3],
    "scipy": lambda quaternion: Rotation.from_quat(quaternion).as_matrix(),
    "pybullet": lambda quaternion: np.reshape(pybullet.getMatrixFromQuaternion(quaternion.tolist()), (3, 3)),
}
SCALAR_FIRST = ("mujoco", "trimesh")

for degrees in (0, 30):
    for writer, write in WRITE.items():
        quaternion = write(np.radians(degrees))
        for reader, read in READ.items():
            matrix = read(quaternion)
            # from the rotation's trace and from the block's upward axis
            turn = np.degrees(np.arccos(np.clip((np.trace(matrix) - 1) / 2, -1, 1)))
            lean = np.degrees(np.arccos(np.clip(matrix[2, 2], -1, 1)))
            print(f"{degrees} degrees by {writer} {quaternion.round(3)}, read by {reader}: "
                  f"turned by {turn:.1f}, upward axis {lean:.1f} degrees from the vertical")
            if (writer in SCALAR_FIRST) == (reader in SCALAR_FIRST):
                assert abs(turn - degrees) < 0.01 and abs(lean - degrees) < 0.01
            else:
                assert abs(turn - 180) < 0.01
            if writer in SCALAR_FIRST and reader not in SCALAR_FIRST:
                assert abs(lean - (180 - degrees)) < 0.01
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
