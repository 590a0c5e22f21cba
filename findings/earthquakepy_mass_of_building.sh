#!/usr/bin/env bash
# earthquakepy 0.4.1: an earthquake moves a building of 1000 kg by a thousandth of what it moves one of 1 kg.
#
# Expected: the response to a base acceleration depends on period and damping alone, whatever the mass and its unit:
#     under a sudden constant acceleration a an undamped oscillator reaches 2 a / w**2 against the base, and its
#     relative acceleration lies between -a and a.
# Seen: period 1 s, a = 1 m/s2, right is -50.7 mm.  `Sdof(m=..., k=...).get_response(..., tsType="baseExcitation")`
#     has +50.7 mm with 1 kg, +0.0507 mm with 1000 kg and 50.7 m with 0.001 (kg in a model of tons and kN).  `acc`
#     reaches 3, 1.002 and 2001 m/s2, right is 1.  Given as a force m a (`tsType="force"`) the displacement is right for
#     all three.  `Sdof(T=1)` sets m = 1, so that only the sign is wrong.  No message.
# Meaning: the equation of motion takes every series as a force and divides it by the mass; only `acc` knows the
#     type.  Drifts and forces of a frame or a soil column are off by the number of the mass: by 1000 between kg and
#     tons.  Multiply the record by -m and give it as a force, or set T and turn the sign.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    earthquakepy==0.4.1 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2
cat > run.py <<'PY'
import numpy as np
from earthquakepy.singledof import Sdof
from earthquakepy.timeseries import TimeSeries

PERIOD, BASE = 1.0, 1.0  # s, m/s2
frequency = 2 * np.pi / PERIOD
right = -2 * BASE / frequency**2
time = np.arange(0, 2.0, 0.01)
options = {"t_span": (0.0, 2.0), "max_step": 0.002, "rtol": 1e-9, "atol": 1e-12}


def extremes(building, scale, kind):
    """Displacement of the largest size and largest size of the acceleration."""
    response = building.get_response(TimeSeries(time, np.full(time.size, scale * BASE)), tsType=kind, **options)
    moved = response.y[0]
    return moved[np.abs(moved).argmax()], np.abs(response.acc).max()


for mass in (1e-3, 1.0, 1e3):
    building = Sdof(m=mass, k=mass * frequency**2)
    moved, acceleration = extremes(building, 1.0, "baseExcitation")
    forced, _ = extremes(building, -mass, "force")
    print(
        f"mass {mass:g}: base acceleration {1e3 * moved:.4f} mm, as a force {1e3 * forced:.4f} mm, "
        f"right {1e3 * right:.4f} mm; relative acceleration {acceleration:.3f} m/s2, right {BASE:.3f}"
    )
    assert abs(moved * mass / -right - 1) < 1e-3 and abs(forced / right - 1) < 1e-3
    assert abs(acceleration / (BASE * (1 + 2 / mass)) - 1) < 2e-3

moved, _ = extremes(Sdof(T=PERIOD), 1.0, "baseExcitation")
print(f"by its period: {1e3 * moved:.4f} mm")
assert abs(moved / -right - 1) < 1e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
