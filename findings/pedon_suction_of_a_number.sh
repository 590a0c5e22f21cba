#!/usr/bin/env bash
# pedon 0.1.0: the drier the soil, the smaller its suction, if the water content is a single number.
#
# Expected: `Brooks.h(theta)` is the inverse of `Brooks.theta(h)`, for a number as for an array.
# Seen: bubbling pressure 10 cm, index 2, water contents of 0.05 to 0.40.  The water contents that the model has at
#     suctions of 10, 50 and 200 cm give back 2.07, 0.0828 and 0.00518 cm as numbers, and 10, 50 and 200 cm as an array.
#     An element of an array counts as a number.  `Genuchten.h` and `Campbell.h` are right for both.  No message.
# Meaning: the power belongs to the pore space alone, not to the ratio: for a number the suction is proportional to the
#     water content.  Apparent cohesion and initial heads from single readings of moisture are too small by orders of
#     magnitude, and fade as the ground dries.  Pass arrays, and check h(theta(h)).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pedon==0.1.0 numpy==2.4.6 scipy==1.17.1 pandas==3.1.1 matplotlib==3.11.2
cat > run.py <<'PY'
import numpy as np
import pedon

RESIDUAL, SATURATED, BUBBLING, INDEX = 0.05, 0.40, 10.0, 2.0
suctions = np.array([10.0, 50.0, 200.0])
soil = pedon.Brooks(k_s=100.0, theta_r=RESIDUAL, theta_s=SATURATED, h_b=BUBBLING, l=INDEX)
contents = soil.theta(suctions)
array, numbers = soil.h(contents), [soil.h(float(content)) for content in contents]
element = soil.h(contents[1])
for suction, content, found, number in zip(suctions, contents, array, numbers):
    print(f"suction {suction:.0f} cm, water content {content:.5f}: array {found:.3f} cm, number {number:.5f} cm")
print(f"element of the array at 50 cm: {element:.5f} cm")
assert np.allclose(array, suctions)
assert np.allclose(numbers, (2.070628, 0.0828251, 0.0051766), rtol=1e-4) and element == numbers[1]
assert np.allclose(numbers, BUBBLING * (contents - RESIDUAL) * (SATURATED - RESIDUAL) ** (1 / INDEX))

for other in (
    pedon.Genuchten(k_s=100.0, theta_r=RESIDUAL, theta_s=SATURATED, alpha=0.05, n=2.0),
    pedon.Campbell(k_s=100.0, theta_s=SATURATED, h_b=BUBBLING, b=3.0),
):
    back = [other.h(float(other.theta(suction))) for suction in suctions]
    print(f"{type(other).__name__}: {np.round(back, 6)} cm as numbers")
    assert np.allclose(back, suctions)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
