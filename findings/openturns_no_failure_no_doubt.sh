#!/usr/bin/env bash
# openturns 1.27: after 1,000 samples without a failure, the probability of failure is 0 +- 0.
#
# Expected: a simulation of a rare failure by `ProbabilitySimulationAlgorithm` with its default settings
#     continues until its scatter is small (the default limit of the coefficient of variation is 0.1), or
#     has a confidence interval with an upper end, as n samples without failure prove about 3/n.
# Seen: a footing with the capacity 300 +- 40 kN under 100 +- 20 kN fails with 3.9e-6.  The run stops
#     after 1,000 samples: the estimate is 0, the length of the 95 % interval 0, and its distribution
#     "Normal(mu = 0, sigma = 0)"; the coefficient of variation is -1.  0.0030 is the upper end that 1,000
#     samples allow.  FORM has 3.9e-6.  With 100 times more samples and a probability of 1e-3 all is
#     right.
# Meaning: "0 within 0 at 95 %" reads as the best result, for a footing that may fail by 0.003 as far as
#     the samples know.  It passes every check of the form "upper end below the target".  Look at
#     `getCoefficientOfVariation` for -1, and set the number of samples.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openturns==1.27.post1
cat > run.py <<'PY'
import math

import openturns

openturns.Log.Show(openturns.Log.NONE)


def event(load):
    """Failure of a footing with the capacity 300 +- 40 kN under a load with +- 20 kN."""
    variables = openturns.RandomVector(
        openturns.JointDistribution([openturns.Normal(300, 40), openturns.Normal(load, 20)])
    )
    margin = openturns.CompositeRandomVector(openturns.SymbolicFunction(["r", "s"], ["r - s"]), variables)
    return openturns.ThresholdEvent(margin, openturns.Less(), 0.0)


def right(load):
    """Exact probability of failure."""
    return openturns.Normal().computeComplementaryCDF((300 - load) / math.hypot(40, 20))


seen = []
for seed in range(20):
    openturns.RandomGenerator.SetSeed(seed)
    run = openturns.ProbabilitySimulationAlgorithm(event(100))
    limit = run.getMaximumCoefficientOfVariation()
    run.run()
    result = run.getResult()
    seen.append(
        (result.getProbabilityEstimate(), result.getConfidenceLength(), result.getCoefficientOfVariation())
    )
print(f"limit of the coefficient of variation {limit}, {result.getOuterSampling()} samples")
print(
    f"20 runs: estimate, length and coefficient of variation {set(seen)}, {result.getProbabilityDistribution()}"
)
print(f"right {right(100):.2g}, upper end of the 95 % interval of 1000 samples {1 - 0.05 ** (1 / 1000):.4f}")
assert limit == 0.1 and result.getOuterSampling() * result.getBlockSize() == 1000
assert set(seen) == {(0.0, 0.0, -1.0)}

openturns.RandomGenerator.SetSeed(0)
run = openturns.ProbabilitySimulationAlgorithm(event(162))
run.setBlockSize(100)
run.run()
result = run.getResult()
print(
    f"right {right(162):.3g}: {result.getProbabilityEstimate():.3g}, length {result.getConfidenceLength():.2g}",
    end=", ",
)
print(f"coefficient of variation {result.getCoefficientOfVariation():.3f}")
assert (
    abs(result.getProbabilityEstimate() / right(162) - 1) < 0.3 and result.getCoefficientOfVariation() < 0.11
)
optimum = openturns.AbdoRackwitz()
optimum.setStartingPoint([300, 100])
form = openturns.FORM(optimum, event(100))
form.run()
print(f"FORM {form.getResult().getEventProbability():.3g}")
assert abs(form.getResult().getEventProbability() / right(100) - 1) < 0.01
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
