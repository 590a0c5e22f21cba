#!/usr/bin/env bash
# rockmechpy 1.0.4: samples that have broken are safe by 31 %, if they were tested in triaxial cells.
#
# Expected: the factor of safety of a sample at failure is 1, by any of the three kinds of input, and with the
#     tolerance of 5 % the class is "Critical".
# Seen: samples exactly on an envelope with c = 10 MPa and a friction angle of 40 degrees, which is found
#     exactly.  With the normal and shear stresses of shear boxes (`direct_shear`) `fos_values`
#     of `plot_condition` is 1.000.  With the same states as principal stresses or as s and t it is 1.305, "Safe",
#     which is the inverse of the cosine of 40 degrees.
# Meaning: the radius of Mohr's circle is compared with the envelope above its centre, which it never reaches;
#     at failure the circle touches beside it, and c cos(phi) + s sin(phi) is right.  The picture calls the line
#     at 1 "theoretical tangency".  The envelope itself is right.  Multiply these factors by the cosine of the
#     friction angle.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    rockmechpy==1.0.4 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2
cat > run.py <<'PY'
import matplotlib

matplotlib.use("Agg")
import numpy as np
from matplotlib import pyplot
from rockmechpy.failure_criteria import MCenvelope

COHESION, ANGLE = 10.0, np.radians(40.0)  # MPa

# Mohr's circles that touch the envelope
centre = np.array([20.0, 40.0, 60.0, 80.0])
radius = COHESION * np.cos(ANGLE) + centre * np.sin(ANGLE)
states = {
    "direct_shear": (centre - radius * np.sin(ANGLE), radius * np.cos(ANGLE)),
    "principal_stress": (centre - radius, centre + radius),
    "s_t_space": (centre, radius),
}
for kind, (x, y) in states.items():
    envelope = MCenvelope(x, y, input_type=kind)
    envelope.plot_condition()
    colours = [bar.get_facecolor()[:3] for bar in pyplot.gca().patches]
    pyplot.close("all")
    found = f"c = {envelope.cohesion:.2f} MPa, {envelope.friction_angle:.2f} degrees"
    print(f"{kind}: {found}, factors {envelope.fos_values}")
    assert abs(envelope.cohesion - COHESION) < 1e-6 and abs(envelope.friction_angle - 40) < 1e-6
    right = 1.0 if kind == "direct_shear" else 1 / np.cos(ANGLE)
    colour = "gold" if kind == "direct_shear" else "forestgreen"
    assert np.allclose(envelope.fos_values, right, rtol=1e-9)
    assert np.allclose(colours, matplotlib.colors.to_rgb(colour))
print(f"1 / cos(40 degrees) = {1 / np.cos(ANGLE):.4f}")
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
