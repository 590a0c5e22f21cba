#!/usr/bin/env bash
# FoundationDesign 0.1.2: the ground pulls on a footing, and the pressure that it should bear passes the check.
#
# Expected: ground bears no tension: if the load leaves the middle third, a part of the base lifts, and the largest
#     pressure is 4 N / (3 B (L - 2 e)), or the check fails with a message.
# Seen: 3 m x 3 m, 639 kN with the weight of the footing, a moment of 600 kNm: the eccentricity is 0.939 m, above L / 6.
#     `bearing_pressure_check_sls` has -62 to 204 kPa and "PASS" for a bearing capacity of 220 kPa; right are 253 kPa
#     on 56 % of the base.  With 900 kNm the load stands 1.408 m from the middle, and the pressures are -129 to
#     271 kPa; right are 1544 kPa.  With 960 kNm it stands outside the base, and passes with a capacity of 300 kPa.
# Meaning: Navier's formula is used for every eccentricity, and the check only asks whether pressures are too large: a
#     footing that turns over passes.  Reinforcement is sized for ground that holds the slab down.  Look at the sign of
#     the smallest pressure first.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    FoundationDesign==0.1.2 indeterminatebeam==2.2.1 plotly==5.24.1 numpy==2.4.6 sympy==1.14.0
cat > run.py <<'PY'
from FoundationDesign import PadFoundation

SIDE = 3.0  # m
for moment, capacity, seen in ((100, 220, (48.778, 93.222)), (600, 220, (-62.338, 204.338)),
                               (900, 300, (-129.004, 271.004)), (960, 300, (-142.338, 284.338))):
    pad = PadFoundation(3000, 3000, 400, 400, 1500, 1500, soil_bearing_capacity=capacity)
    pad.foundation_loads(
        foundation_thickness=500, soil_depth_abv_foundation=500, soil_unit_weight=18, concrete_unit_weight=24
    )
    pad.column_axial_loads(permanent_axial_load=450)
    pad.column_moments_xdir(permanent_moment_xdir=moment)
    check = pad.bearing_pressure_check_sls()
    load, eccentricity = pad.total_force_Z_dir_sls(), pad.eccentricity_X_direction_sls() / 1e3
    assert load == 639 and abs(eccentricity - moment / load) < 1e-3
    if eccentricity < SIDE / 6:
        right = f"{load / SIDE**2 * (1 + 6 * eccentricity / SIDE):.1f} kPa on the whole base"
    elif eccentricity < SIDE / 2:
        part = 3 * (SIDE / 2 - eccentricity)
        right = f"{2 * load / (SIDE * part):.1f} kPa on {100 * part / SIDE:.0f} % of the base"
    else:
        right = "it turns over"
    low, high = check["minimum_pad_pressure"], check["maximum_pad_pressure"]
    print(f"moment {moment} kNm, eccentricity {eccentricity:.3f} m: {low} to {high} kPa, {check['status'][:4]} with a "
          f"capacity of {capacity} kPa; right: {right}")
    assert abs(low - seen[0]) < 0.1 and abs(high - seen[1]) < 0.1 and check["status"].startswith("PASS")
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
