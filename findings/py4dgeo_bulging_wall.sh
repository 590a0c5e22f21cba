#!/usr/bin/env bash
# py4dgeo 1.2.0: a retaining wall that bulges by 50 mm has not moved on average.
#
# Expected: `M3C2` gives signed distances between two scans of a face, with one sign for a movement out of the face;
#     the normals of a plane face point to one side.
# Seen: a vertical wall of 20 m x 10 m, scanned with a scatter of 3 mm, has moved outwards by 50 mm; 200 points,
#     each with 0.5 m of radius.  All distances are 50 mm, with a limit of detection of 1 mm, but 104 point inwards
#     and 96 outwards: the mean is -2 mm.  On a slope of 45 degrees all have the same sign.  With the normal of the
#     wall as `orientation_vector` the mean is 50.0 mm.  No message.
# Meaning: normals are turned upwards by default, and the normal of a wall has no upward part but scatter.  Maps of
#     a wall or a rock face are speckled with movements to both sides; means over a field, the trend in time and the
#     alarm that is set on them see nothing.  Give the direction to the scanner as orientation.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    py4dgeo==1.2.0 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import py4dgeo

MOVEMENT, SCATTER, POINTS = 0.05, 0.003, 40000  # m, m


def scan(normal, movement, seed):
    """Points of a plane face of 20 m x 10 m with the given unit normal, which has moved along its normal."""
    random = np.random.default_rng(seed)
    along, up = random.uniform(0, 20, POINTS), random.uniform(0, 10, POINTS)
    out = movement + random.normal(0, SCATTER, POINTS)
    normal = np.array(normal)
    dip = np.cross(normal, [0.0, 1.0, 0.0])
    return along[:, None] * [0.0, 1.0, 0.0] + up[:, None] * dip + out[:, None] * normal


def distances(normal, **options):
    """Signed distances of the second scan from the first one in m, and the largest limit of detection."""
    before = py4dgeo.Epoch(scan(normal, 0.0, 1))
    after = py4dgeo.Epoch(scan(normal, MOVEMENT, 2))
    result, uncertainty = py4dgeo.M3C2(
        epochs=(before, after), corepoints=before.cloud[::200], cyl_radius=0.5, normal_radii=[1.0], **options
    ).run()
    return result, uncertainty["lodetection"].max()


WALL, SLOPE = (-1.0, 0.0, 0.0), (-np.sqrt(0.5), 0.0, np.sqrt(0.5))
for name, normal, options in (
    ("slope", SLOPE, {}),
    ("wall", WALL, {}),
    ("wall with its orientation", WALL, {"orientation_vector": np.array(WALL)}),
):
    found, limit = distances(normal, **options)
    outwards = int((found > 0).sum())
    print(f"{name}: mean {1e3 * found.mean():.1f} mm, mean size {1e3 * abs(found).mean():.1f} mm, right "
          f"{1e3 * MOVEMENT:.1f} mm; {outwards} of {found.size} outwards, limit of detection {1e3 * limit:.1f} mm")
    assert limit < 0.002 and np.allclose(abs(found), MOVEMENT, atol=0.002)
    if name == "wall":
        assert 60 < outwards < 140 and abs(found.mean()) < 0.02
    else:
        assert outwards == found.size and abs(found.mean() - MOVEMENT) < 2e-4
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
