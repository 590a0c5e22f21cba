#!/usr/bin/env bash
# disba 0.7.0: by one of two algorithms, ground without layers has a dispersion curve, 4 % off.
#
# Expected: two layers with the same properties are one half-space, in which Rayleigh waves run at one speed at all
#     periods, 186.5 m/s for shear waves of 200 m/s and pressure waves of 400 m/s; the algorithms `dunkin` and
#     `fast-delta` differ by round-off, as the second is only a faster form of the same determinant.
# Seen: `dunkin` is right to seven digits.  `fast-delta` begins at 186.5 m/s for short periods, falls to 179.7 m/s
#     where the wave is 7.5 times as long as the layer is thick, and rises again.  A crust of 10 km with 3.5 km/s has
#     3.145 in place of 3.264 km/s.  A step of the search of a tenth does not change it.  Both are the same at short
#     periods.  No message.
# Meaning: shear moduli go with the square of the speed, so that a back-analysis of surface waves finds a soft layer
#     of 8 % less stiffness in ground that has none, with an option whose name only promises speed.  Leave `dunkin`,
#     the default, and try a half-space of two equal layers first.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    disba==0.7.0 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
from disba import PhaseDispersion
from scipy.optimize import brentq


def rayleigh(pressure, shear):
    """Speed of the surface wave of a half-space from Rayleigh's equation."""

    def equation(ratio):
        slow, fast = 1 - ratio**2, 1 - (ratio * shear / pressure) ** 2
        return (2 - ratio**2) ** 2 - 4 * np.sqrt(slow * fast)

    return shear * brentq(equation, 0.5, 0.9999)


def speeds(algorithm, thickness, pressure, shear, periods, step):
    """Speeds in km/s of the fundamental mode in two equal layers."""
    layer = [thickness, pressure, shear, 1.8]
    layers = np.array([layer, [0.0, *layer[1:]]])
    curve = PhaseDispersion(*layers.T, algorithm=algorithm, dc=step)(periods, mode=0, wave="rayleigh")
    assert curve.period.size == periods.size
    return curve.velocity


# thickness in km, speeds in km/s, periods in s
for ground, seen in (
    ((0.005, 0.4, 0.2, np.linspace(0.01, 0.5, 50)), 0.1797),
    ((10.0, 7.0, 3.5, np.linspace(1, 40, 40)), 3.145),
):
    thickness, pressure, shear, periods = ground
    right = rayleigh(pressure, shear)
    for step in (shear / 400, shear / 4000):
        slow, fast = (speeds(name, *ground, step) for name in ("dunkin", "fast-delta"))
        lowest = fast.argmin()
        print(f"layer of {thickness} km, step {step:.2g} km/s: right {right:.4f}, dunkin {slow.min():.4f} to "
              f"{slow.max():.4f}, fast-delta {fast.min():.4f} to {fast.max():.4f} km/s; lowest where the wave is "
              f"{right * periods[lowest] / thickness:.1f} times the thickness")
        assert np.allclose(slow, right, rtol=1e-5)
        assert abs(fast.min() - seen) < 2e-3 * seen and abs(fast[0] - right) < 1e-3 * right
        assert fast[-1] > fast.min() and fast.min() < 0.97 * right
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
