#!/usr/bin/env bash
# gstools 1.7.0: a strength of 50 kPa that scatters by 15 kPa has a standard deviation of 0.3 kPa, and a mean of 48 kPa.
#
# Expected: kriging with `normalizer=LogNormal()` returns the mean and the variance of the strength, in kPa and kPa2,
#     as without normalizer; far from the boreholes they are the ones of the ground.
# Seen: a log-normal strength with mean 50 kPa and standard deviation 15 kPa, known at five depths.  Far away the field
#     is 47.89 kPa and the variance 0.0862, whose root is 0.294.  The characteristic value (mean less 1.645 standard
#     deviations) is 47.4 kPa; the right 5 % fractile of the strength is 29.5 kPa.  No message.
# Meaning: the field is turned back by exp, so it is the median exp(m), smaller than the mean by the factor
#     exp(-s**2 / 2); the variance stays the one of the logarithm, s**2, without a unit.  It is small for all soils,
#     and looks like a good survey.  For the mean take exp(m + s**2 / 2), for the scatter the mean times
#     (exp(s**2) - 1)**0.5, for fractiles exp(m - 1.645 s).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    gstools==1.7.0 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import gstools
import numpy as np

MEAN, SCATTER = 50.0, 15.0  # kPa
s = np.sqrt(np.log(1 + (SCATTER / MEAN) ** 2))
m = np.log(MEAN) - s**2 / 2
correlation = gstools.Exponential(dim=1, var=s**2, len_scale=2.0)
depths = np.array([1.0, 3.0, 5.0, 7.0, 9.0])
strengths = np.exp(m + s * np.array([-1.0, 0.5, 0.0, 1.2, -0.7]))
far = np.array([5.0, 100.0, 200.0])

kriging = gstools.krige.Simple(correlation, depths, strengths, mean=m, normalizer=gstools.normalizer.LogNormal())
field, variance = kriging(far)
print(f"at a borehole: {field[0]:.3f} kPa (measured {strengths[2]:.3f}), variance {variance[0]:.2e}")
print(f"far away: field {field[-1]:.2f} kPa, root of the variance {variance[-1] ** 0.5:.4f}")
print(f"right: mean {MEAN:.2f} kPa, standard deviation {SCATTER:.2f} kPa; of the logarithm {m:.4f} and {s:.4f}")
characteristic = field[-1] - 1.645 * variance[-1] ** 0.5
print(f"characteristic {characteristic:.2f} kPa, right fractile {np.exp(m - 1.645 * s):.2f} kPa")
assert abs(field[0] - strengths[2]) < 1e-6 and abs(variance[0]) < 1e-9
assert np.allclose(field[1:], np.exp(m)) and np.allclose(variance[1:], s**2)
assert abs(field[-1] / MEAN - np.exp(-(s**2) / 2)) < 1e-6

plain = gstools.krige.Simple(gstools.Exponential(dim=1, var=SCATTER**2, len_scale=2.0), depths, strengths, mean=MEAN)
field, variance = plain(far)
print(f"without normalizer, far away: field {field[-1]:.2f} kPa, root of the variance {variance[-1] ** 0.5:.2f} kPa")
assert np.allclose(field[1:], MEAN) and np.allclose(variance[1:], SCATTER**2)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
