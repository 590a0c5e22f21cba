#!/usr/bin/env bash
# civilpy 0.6.1: cohesion of 100 kPa presses on a wall eight times as much as none.
#
# Expected: `culmann_lateral_pressure` takes the cohesion off the thrust: Rankine's value less 2 c H sqrt(Ka) for a
#     smooth wall, and nothing once the soil stands by itself; the friction of the wall matters for sand as well.
# Seen: 18 kN/m3, 5 m, 25 degrees. 91 kN/m without cohesion, right. 10 kPa: 60, right is 28 kN/m. 30 kPa: 16, right is
#     none, since it stands to 10.5 m. 60 kPa: 157 and 100 kPa: 741 kN/m. Without cohesion the thrust is 91 kN/m for
#     each friction of the wall, also for 20 degrees, where 80 are right. No message.
# Meaning: the thrust is Rankine's times (1 - t / n)^2, where t grows with the cohesion, so that it rises again once t
#     exceeds n, and no wedge is weighed. Walls in stiff clay are designed for a multiple of any pressure, those in
#     soft clay for twice. Take another method, or trial wedges as below.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    --no-deps civilpy==0.6.1 numpy==2.4.6 scipy==1.17.1 contourpy==1.3.3 cycler==0.12.1 defusedxml==0.7.1 \
    flexcache==0.3 flexparser==0.4 fonttools==4.68.0 kiwisolver==1.5.1 matplotlib==3.10.8 mpmath==1.4.1 \
    packaging==26.4 pandas==3.0.0 pillow==13.0.0 Pint==0.25.3 platformdirs==4.14.9 pyparsing==3.3.3 \
    python-dateutil==4.0.0 sympy==1.14.0 typing_extensions==4.16.0
cat > run.py <<'PY'
import matplotlib

matplotlib.use("Agg")
import numpy as np
from civilpy.geotech import culmann_lateral_pressure

WEIGHT, HEIGHT, FRICTION = 18.0, 5.0, 25.0  # kN/m3, m, degrees


def by_wedges(cohesion, wall):
    """Thrust in kN/m by trial wedges, with cohesion on the plane and none on the wall."""
    plane, phi, delta = np.radians(np.linspace(FRICTION + 0.01, 89.9, 50001)), np.radians(FRICTION), np.radians(wall)
    driving = WEIGHT * HEIGHT**2 / 2 / np.tan(plane) * np.sin(plane - phi)
    holding = cohesion * HEIGHT / np.sin(plane) * np.cos(phi)
    return max(0.0, np.max((driving - holding) / np.cos(plane - phi - delta)))


for cohesion, wall, seen in (
    (0.0, 0.0, 91.3),
    (0.0, 20.0, 91.3),
    (10.0, 0.0, 59.6),
    (30.0, 0.0, 16.3),
    (60.0, 0.0, 156.5),
    (100.0, 0.0, 741.0),
):
    found, right = culmann_lateral_pressure(WEIGHT, HEIGHT, cohesion, FRICTION, wall), by_wedges(cohesion, wall)
    print(f"cohesion {cohesion} kPa, friction of the wall {wall}: {found:.1f} kN/m, by wedges {right:.1f} kN/m")
    assert abs(found - seen) < 0.2
coefficient = np.tan(np.radians(45 - FRICTION / 2)) ** 2
rankine = WEIGHT * HEIGHT**2 / 2 * coefficient - 2 * 10.0 * HEIGHT * np.sqrt(coefficient)
assert abs(by_wedges(10.0, 0.0) - rankine) < 0.05 and by_wedges(30.0, 0.0) == 0
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
