#!/usr/bin/env bash
# fatiguepy 2.3.2: the density of peaks by Rice has the last amplitude's share of the normal law at every amplitude.
#
# Expected: `Rice.RC.PDF` is Rice's density of peaks: for a narrow band the Rayleigh density, for white noise between
#     both, with P(peak > 0) = (1 + alpha_2)/2 as area over positive amplitudes.
# Seen: two humps at 3 and 20 Hz with alpha_2 of 0.60: the area is 0.92, right is 0.80; the density at half the rms is
#     1.22 times right, and the damage with k of 3 1.07 times that of Rice.  At 3 and 40 Hz with 0.24: 0.71 in place
#     of 0.62, and damage 1.20 times.
# Meaning: the loop over the amplitudes keeps one number, the value of the normal law at the largest amplitude, nearly
#     1.  So small peaks are counted that Rice has below zero, and the damage of wide-band stresses and
#     `counting_cycles` are too large, the more the wider the band.  Evaluate the normal law at all amplitudes, as
#     scipy.stats.norm.cdf does.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 fatpack==0.7.8 matplotlib==3.11.2 pandas==3.0.6
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    --no-deps fatiguepy==2.3.2
cat > run.py <<'PY'
import math

import numpy as np
from fatiguepy import Rice
from fatiguepy.prob_moment import Probability_Moment
from scipy.stats import norm

POWER, CONSTANT, RMS = 3.0, 1e12, 100.0  # N S^k = C with amplitudes in MPa
frequency = np.linspace(0.01, 60.0, 6000)
amplitudes = np.linspace(0.0, 10 * RMS, 2001)
step = amplitudes[1] - amplitudes[0]


def rice(width):
    """Density of the peaks of a Gaussian process (Rice 1945), alpha_2 the ratio of crossings to peaks."""
    z = amplitudes / RMS
    rest = math.sqrt(1 - width**2)
    first = rest / math.sqrt(2 * math.pi) * np.exp(-(z**2) / (2 * rest**2))
    return (first + width * z * np.exp(-(z**2) / 2) * norm.cdf(width * z / rest)) / RMS


for share, second, factor, ratio in ((0.3, 20, 1.216, 1.073), (0.03, 40, 1.120, 1.202)):
    density = np.exp(-0.5 * ((frequency - 3) / 0.3) ** 2) + share * np.exp(-0.5 * ((frequency - second) / 0.5) ** 2)
    density *= RMS**2 / (density.sum() * (frequency[1] - frequency[0]))
    width = Probability_Moment(density, frequency).alphan(2)
    method = Rice.RC(POWER, CONSTANT, density, frequency, 1.0, amplitudes)
    found, right = method.PDF(), rice(width)
    half = np.searchsorted(amplitudes, RMS / 2)
    damage = (amplitudes**POWER * found).sum() / (amplitudes**POWER * right).sum()
    # areas by the trapezoidal rule
    areas = [np.trapezoid(values, amplitudes) for values in (found, right)]
    print(f"alpha_2 {width:.3f}: area {areas[0]:.3f}, right {areas[1]:.3f}, (1 + alpha_2) / 2 {(1 + width) / 2:.3f}; "
          f"density at half the rms {found[half] / right[half]:.3f} times right, damage {damage:.3f} times")
    assert abs(areas[1] - (1 + width) / 2) < 1e-3 and areas[0] > areas[1] + 0.08
    assert abs(found[half] / right[half] - factor) < 0.01 and abs(damage - ratio) < 0.01
    # the same number of the normal law at all amplitudes gives the difference
    rest = math.sqrt(1 - width**2)
    z = amplitudes / RMS
    share_of_all = norm.cdf(width * z / rest) - norm.cdf(width * z[-1] / rest)
    assert np.allclose(found + width * z * np.exp(-(z**2) / 2) / RMS * share_of_all, right)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
