#!/usr/bin/env bash
# pystrata 0.5.4: the ground shakes before the earthquake.
#
# Expected: the response of a layer to a record whose shaking is in its last second is zero before, as
#     site response programs pad a record with zeros for the vibration that follows its end.
# Seen: a layer of 30 m (150 m/s, 2 % of damping) under a pulse of .1 g that ends .35 s before the end of
#     a record of 20.48 s.  In the first half of the computed motion the surface has .103 g, 71 % of
#     its peak of .146 g.  A record of 2,048 values is transformed as it is, without a zero, so the
#     vibration after its end comes back at its beginning.  2,000 values are padded to 2,048 and
#     leave .053 g.  With fa_length=16384 the first half has 1e-10 g.
# Meaning: records that are cut soon after the strong motion, of a length that happens to be a power of
#     two, give wrong histories, Arias intensities and durations; peaks, too, where both ends
#     shake.  Give `fa_length` room for some seconds of decay.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pystrata==0.5.4 pandas==3.1.1 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
from pystrata import motion, propagation, site

STEP = 0.01


def surface(n, **options):
    """Motion of the surface (g) under a pulse of 4 Hz, .6 s before the end of n values."""
    time = STEP * np.arange(n) - (STEP * (n - 1) - 0.6)
    pulse = 0.1 * np.sin(8 * np.pi * time) * np.cos(2 * np.pi * time) ** 2
    record = motion.TimeSeriesMotion("", "", STEP, np.where(abs(time) < 0.25, pulse, 0.0), **options)
    soil, rock = (site.SoilType("", weight, None, ratio) for weight, ratio in ((17, 0.02), (24, 0.01)))
    profile = site.Profile([site.Layer(soil, 30.0, 150.0), site.Layer(rock, 0.0, 1500.0)])
    outcrop, top = profile.location("outcrop", index=-1), profile.location("outcrop", index=0)
    calculator = propagation.LinearElasticCalculator()
    calculator(record, profile, outcrop)
    return record.calc_time_series(calculator.calc_accel_tf(outcrop, top))


found = {}
for n, options in ((2048, {}), (2000, {}), (2048, {"fa_length": 16384})):
    moved = np.abs(surface(n, **options))
    key = (n, options.get("fa_length"))
    found[key] = moved[: n // 2].max()
    print(f"{n} values, fa_length {key[1]}: peak {moved.max():.4f} g, first half {found[key]:.2g} g")
assert 0.100 < found[2048, None] < 0.107
assert 0.050 < found[2000, None] < 0.057
assert found[2048, 16384] < 1e-6
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
