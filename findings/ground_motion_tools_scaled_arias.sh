#!/usr/bin/env bash
# ground-motion-tools 0.3.1: a record that is scaled to twice the acceleration has twice the Arias intensity.
#
# Expected: `im_adjust` gives the measures of the record after scaling to a target peak acceleration, as if they were
#     calculated from the scaled record: Arias intensity and the integral of squared velocity (`SED`) grow with the
#     square.
# Seen: a record is scaled from 1.47 to 5.88 m/s2, by 4: Arias intensity 3.54 in place of 14.16 m/s and `SED` a quarter
#     of right.  Peak values, `CAV`, `I_SUFFIX_C` and `I_V` agree with the scaled record.
# Meaning: the table of exponents has 1 for both.  Arias intensity is the measure of Newmark displacements and of
#     liquefaction triggering by energy: at a scale of 4 it is a quarter, and landslide displacements come out far too
#     small.  Scale the record and calculate the measures again.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    ground-motion-tools==0.3.1 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
from ground_motion_tools.enums import GMIMEnum
from ground_motion_tools.im import GMIntensityMeasures

STEP, SCALE, GRAVITY = 0.005, 4.0, 9.8  # s, -, m/s2 as in the package
time = np.arange(0.0, 20.0, STEP)
ground = 1.5 * np.sin(2 * np.pi * 1.2 * time) * np.exp(-0.1 * time)

MEASURES = [GMIMEnum.PGA, GMIMEnum.CAV, GMIMEnum.I_SUFFIX_C, GMIMEnum.I_V, GMIMEnum.I_SUFFIX_A, GMIMEnum.SED]
target = SCALE * np.abs(ground).max()
original = GMIntensityMeasures(ground, STEP).get_im(MEASURES)
adjusted = GMIntensityMeasures.im_adjust(original, GMIMEnum.PGA, target)
scaled = GMIntensityMeasures(SCALE * ground, STEP).get_im(MEASURES)

for name in scaled:
    ratio = adjusted[name][0] / scaled[name][0]
    print(f"{name}: {adjusted[name][0]:.3f}, of the scaled record {scaled[name][0]:.3f}, ratio {ratio:.3f}")
    expected = 1 / SCALE if name in ("I_SUFFIX_A", "SED") else 1.0
    assert abs(ratio - expected) < 1e-6
arias = np.pi / (2 * GRAVITY) * np.trapezoid((SCALE * ground) ** 2, time)
print(f"Arias intensity of the scaled record by integration: {arias:.3f} m/s")
assert abs(scaled["I_SUFFIX_A"][0] / arias - 1) < 0.01
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
