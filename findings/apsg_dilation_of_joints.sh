#!/usr/bin/env bash
# apsg 1.4.0: the joint that is pressed together most has the largest tendency to open.
#
# Expected: `dilation_tendency` of a plane is (sigma1 - normal stress) / (sigma1 - sigma3), between 0 for
#     the plane across the largest compression and 1 for the one across the smallest (Ferrill and others,
#     1999).
# Seen: stresses of -10 vertical, -5 to the north and -3 MPa to the east (tension positive, as documented,
#     and sigma1 is -10).  A flat joint has 2.86 in place of 0, one that dips 60 degrees to the north 2.32
#     in place of 0.54, and vertical ones 2.14 and 1.86 in place of 0.71 and 1.  The order of the planes
#     is reversed.  The normal stress enters by its magnitude, the principal stresses with their signs.
#     With a fluid pressure of 2 MPa it is 2.29 to 1.29.  `slip_tendency` and the normal stresses are
#     right.  No message.
# Meaning: leaking, grouted and blocky joints are searched by this number, in tunnels, dams and boreholes;
#     it points at those that are closed.  All values above 1 are the sign of it.  Compute it from
#     `normal_stress`.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    apsg==1.4.0 numpy==2.3.1 scipy==1.16.3 pandas==2.3.3
cat > run.py <<'PY'
from apsg import fol, stress

ground = stress.from_comp(xx=-5.0, yy=-3.0, zz=-10.0)
joints = {
    "flat": fol(0, 0),
    "60 degrees to the north": fol(0, 60),
    "faces north": fol(0, 90),
    "faces east": fol(90, 90),
}
print(f"sigma1 {ground.sigma1}, sigma3 {ground.sigma3}")
assert ground.sigma1 == -10 and ground.sigma3 == -3
found, wanted = [], []
for name, plane in joints.items():
    normal = float(ground.normal_stress(plane))
    right = (-10 - normal) / (-10 - -3)
    value, slip = float(ground.dilation_tendency(plane)), float(ground.slip_tendency(plane))
    wet = float(ground.dilation_tendency(plane, fp=2.0))
    print(
        f"{name}: normal stress {normal:.2f}, dilation tendency {value:.3f}, right {right:.3f}, with fluid {wet:.3f};",
        end=" ",
    )
    print(f"slip tendency {slip:.3f}")
    assert abs(value - (10 - normal) / 7) < 1e-9 and abs(wet - value + 4 / 7) < 1e-9
    assert abs(slip - abs(float(ground.shear_stress(plane)) / normal)) < 1e-9
    found.append(value)
    wanted.append(right)
assert abs(wanted[0]) < 1e-9 and abs(wanted[-1] - 1) < 1e-9 and wanted == sorted(wanted)
assert min(found) > 1.8 and found == sorted(found, reverse=True)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
