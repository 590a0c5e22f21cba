#!/usr/bin/env bash
# chaospy 4.3.21: one in five samples of a truncated strength is its upper limit.
#
# Expected: a normal distribution that is cut at two limits (`Trunc` with `lower` and `upper`) is the
#     truncated normal distribution: no sample at a limit, and the distribution function reaches 1.
# Seen: mean 10, standard deviation 2, cut at 10 and 12.  The distribution function at the upper limit
#     is 0.811, and 18.8 % of the samples are 12.0.  The density is 81 % of the right one, and the mean of
#     the samples is 11.12, where `E` has 10.92, the right value.  For limits of 8 and 12 it is 3.5 %, for
#     8 and 10 there are 18.8 % at 10.  A log-normal load, cut twice, behaves alike.  With one limit, and
#     with `TruncNormal`, all is right.  No message.
# Meaning: the two tails are taken off by the product of two factors.  Strengths, friction angles
#     and loads between physical limits have a lump at the upper one, so that probabilities of
#     failure and percentiles by sampling are wrong, and `E` and `Std` do not show it.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    chaospy==4.3.21 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import chaospy
import numpy as np
from scipy import stats

SAMPLES = 100_000


def at_limit(distribution, upper):
    """Part of the samples at the upper limit, and their mean."""
    samples = distribution.sample(SAMPLES, seed=1)
    return (samples == upper).mean(), samples.mean()


normal = chaospy.Normal(10, 2)
for lower, upper, seen in ((10, 12, 0.189), (8, 12, 0.0356), (8, 10, 0.189)):
    exact = stats.truncnorm((lower - 10) / 2, (upper - 10) / 2, 10, 2)
    cut, named = chaospy.Trunc(normal, lower=lower, upper=upper), chaospy.TruncNormal(lower, upper, 10, 2)
    part, mean = at_limit(cut, upper)
    middle = (lower + upper) / 2
    density = cut.pdf(middle) / exact.pdf(middle)
    print(f"cut at {lower} and {upper}: {100 * part:.1f} % at the upper limit, distribution function there "
          f"{cut.cdf(upper - 1e-9):.3f}, density {density:.3f} of the right one; mean of samples {mean:.2f}, "
          f"E {chaospy.E(cut):.2f}, right {exact.mean():.2f}")
    assert abs(density - (1 - seen)) < 0.001
    assert abs(part - seen) < 0.005 and abs(cut.cdf(upper - 1e-9) - (1 - seen)) < 0.001
    assert abs(chaospy.E(cut) - exact.mean()) < 1e-3
    part, mean = at_limit(named, upper)
    assert part == 0 and abs(mean - exact.mean()) < 0.01

load = chaospy.LogNormal(2, 0.5)
tails = load.cdf([5, 12])
right = (load.cdf(8) - tails[0]) / (tails[1] - tails[0])
cut = chaospy.Trunc(load, lower=5, upper=12)
print(f"log-normal load between 5 and 12: {cut.cdf(8):.3f} below 8, right {right:.3f}")
assert abs(cut.cdf(8) - 0.530) < 0.001 and abs(right - 0.561) < 0.001

one = chaospy.Trunc(normal, upper=12)
assert at_limit(one, 12)[0] == 0 and abs(one.cdf(12 - 1e-9) - 1) < 1e-6
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
