#!/usr/bin/env bash
# pygmm 0.8.0: rock in eastern North America shakes 1.5 to 1.8 times as much as by the equations that it names.
#
# Expected: Atkinson and Boore (2006) made their equations for a stress drop of 140 bar.  Their factor for another one
#     is SF2, the factor of a doubled stress drop, to the power of log2(stress / 140), and Atkinson and Boore (2011)
#     let the stress drop depend on the magnitude, 10^(3.45 - 0.2 M).  At 140 bar, magnitude 6.52, the factor is 1.
# Seen: the factor on PGA is 1.58 at magnitude 6.52.  It is SF2 to the power of stress / 140, at most 2: 2.34 in place
#     of 1.54 at magnitude 5, and 1.34 in place of 0.74 at magnitude 7.5, where the stress drop is below 140 bar.
#     openquake 3.25.1, `AtkinsonBoore2006Modified2011`, has the right ones.
# Meaning: the motion of `AtkinsonBoore2006` is 1.5 to 1.8 times too large at PGA, and its page does not speak of
#     another stress drop.  No option gives the equations of 2006.  Divide by the factor, computed as below, or use
#     another library for these equations.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pygmm==0.8.0 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import logging
import math

import numpy as np
import pygmm

logging.disable(logging.WARNING)
MODEL, DISTANCE = pygmm.AtkinsonBoore2006, 40.0  # km


def base(magnitude):
    """PGA in g on rock of 760 m/s by equation 5 of 2006, for 140 bar and distances of 10 to 70 km."""
    row = MODEL.COEFF["bc"][MODEL.INDEX_PGA]
    logarithm = (
        row.c_1 + row.c_2 * magnitude + row.c_3 * magnitude**2
        + (row.c_4 + row.c_5 * magnitude) * math.log10(DISTANCE) + row.c_10 * DISTANCE
    )
    return 10**logarithm / 980.665


def doubled(magnitude):
    """Factor for a doubled stress drop at PGA, by equation 6 of 2006."""
    table = MODEL.COEFF_SF
    delta, low, high = (np.interp(0.0, table.period, table[name]) for name in ("delta", "m_1", "m_h"))
    return 10 ** min(delta + 0.05, 0.05 + delta * max(magnitude - low, 0.0) / (high - low))


equal = (3.45 - math.log10(140.0)) / 0.2
for magnitude, seen in ((5.0, 2.340), (6.0, 1.793), (equal, 1.583), (7.0, 1.445), (7.5, 1.340)):
    stress = 10 ** (3.45 - 0.2 * magnitude)
    right = doubled(magnitude) ** math.log2(stress / 140.0)
    found = MODEL(pygmm.Scenario(mag=magnitude, dist_rup=DISTANCE, v_s30=760.0)).pga / base(magnitude)
    print(
        f"magnitude {magnitude:.2f}, {stress:.0f} bar: factor {found:.3f}, right {right:.3f}, "
        f"ratio {found / right:.2f}"
    )
    assert abs(found - seen) < 2e-3 and found > 1.5 * right
    assert abs(found / doubled(magnitude) ** min(stress / 140.0, 2.0) - 1) < 1e-4
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
