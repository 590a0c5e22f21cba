#!/usr/bin/env bash
# openturns 1.27.post1: a slope that fails on average has the reliability index +1.41.
#
# Expected: the Hasofer-Lind index of FORM is negative if the mean point is in the failure domain, as
#     beta = (mean R - mean S) / sqrt(variances) is for a linear limit state.
# Seen: with mean strengths of 12 and 8 against a load of 10 (scatter 1 each),
#     `getHasoferReliabilityIndex` returns 1.414 for both, and the probabilities are 0.079 and
#     0.921.  `getGeneralisedReliabilityIndex` returns 1.414 and -1.414.
# Meaning: the index is a distance, and the sign is in the other method.  A table of indices over
#     heights of a slope or levels of water falls to zero and rises again behind failure; a design
#     by a target index accepts the failed side.  Use the generalised index, or print the
#     probability beside it.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openturns==1.27.post1 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import openturns
from scipy.stats import norm


def reliability(strength):
    """Both indices and the probability of failure of strength minus load."""
    joint = openturns.JointDistribution([openturns.Normal(strength, 1.0), openturns.Normal(10.0, 1.0)])
    margin = openturns.CompositeRandomVector(openturns.SymbolicFunction(["r", "s"], ["r - s"]),
                                      openturns.RandomVector(joint))
    solver = openturns.Cobyla()
    solver.setStartingPoint(joint.getMean())
    analysis = openturns.FORM(solver, openturns.ThresholdEvent(margin, openturns.Less(), 0.0))
    analysis.run()
    result = analysis.getResult()
    return (result.getHasoferReliabilityIndex(), result.getGeneralisedReliabilityIndex(),
            result.getEventProbability())


for strength in (12.0, 8.0):
    right = (strength - 10) / 2**0.5
    hasofer, generalised, probability = reliability(strength)
    print(f"strength {strength}: right {right:.4f}, Hasofer-Lind {hasofer:.4f}, "
          f"generalised {generalised:.4f}, probability {probability:.4f}")
    assert abs(probability - norm.cdf(-right)) < 1e-3 and abs(generalised - right) < 1e-3
    assert abs(hasofer - abs(right)) < 1e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
