#!/usr/bin/env bash
# trimesh 5.2.0 with manifold3d 3.5.4: a pit of 520 m3 has 537 m3, because it lies far from the origin.
#
# Expected: the difference of two closed meshes in double precision is right to a millimetre wherever
#     the origin is, as the coordinates of both are.
# Seen: a pit of 10.2 m x 10.2 m x 5 m is cut from a block of ground.  Near the origin its volume is
#     520.2 m3.  At x = 350 km, y = 5800 km, as on a map, it is 536.5 m3, and its sides lie up to 0.2 m
#     off.  The result is closed, its outer faces are where they were, and no message is given.
# Meaning: `trimesh.boolean` passes single precision to the library of the solids, although the same
#     library has a type in double precision (`Mesh64`).  Quantities of soil, gaps of joints and
#     linings of centimetres are wrong or closed in map coordinates.  Move the model to the origin
#     before it is cut.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    trimesh==5.2.0 manifold3d==3.5.4 numpy==2.4.6
cat > run.py <<'PY'
import manifold3d
import numpy as np
import trimesh

SEEN = {(0, 0): 520.2, (350e3, 5800e3): 536.484}


def pit(origin):
    """Volume that is cut from a block, and the largest distance of a side of the pit."""
    move = np.array([*origin, 0.0])
    ground = trimesh.creation.box(bounds=np.array([[0, 0, -20], [50, 50, 0.0]]) + move)
    tool = trimesh.creation.box(bounds=np.array([[20.1, 20.1, -5], [30.3, 30.3, 1]]) + move)
    rest = trimesh.boolean.difference([ground, tool], engine="manifold")
    assert rest.is_watertight and np.allclose(rest.bounds, ground.bounds)
    points = rest.vertices - move
    inner = points[(points[:, 0] > 1) & (points[:, 0] < 49)][:, :2]
    side = max(min(abs(value - 20.1), abs(value - 30.3)) for value in inner.ravel())
    return ground.volume - rest.volume, side


for origin, seen in SEEN.items():
    volume, side = pit(origin)
    print(f"origin {origin}: volume {volume:.3f} m3, sides within {side:.3f} m")
    assert abs(volume - seen) < 0.01 and (side < 1e-5 or side > 0.1)


def solid(low, high):
    """Box as a solid in double precision."""
    box = trimesh.creation.box(bounds=np.array([low, high]))
    return manifold3d.Manifold(manifold3d.Mesh64(np.array(box.vertices), np.array(box.faces, dtype=np.uint64)))


x, y = 350e3, 5800e3
ground = solid([x, y, -20], [x + 50, y + 50, 0])
rest = ground - solid([x + 20.1, y + 20.1, -5], [x + 30.3, y + 30.3, 1])
print(f"manifold3d in double precision: {ground.volume() - rest.volume():.3f} m3")
assert abs(ground.volume() - rest.volume() - 520.2) < 1e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
