#!/usr/bin/env bash
# openturns 1.27.post1: the probability of failure rises from 5e-7 to 0.5 with the unit of the margin.
#
# Expected: FORM finds the same reliability index for a margin of strength in kPa, GPa or TPa, or a
#     message says that it did not converge.
# Seen: a normal strength (30, scatter 3) against a log-normal load (10, scatter 2).  With the factor
#     1 on the margin all of Cobyla, AbdoRackwitz and SQP have the index 4.872.  With 1e-6 Cobyla has
#     2.689, and with 1e-9 it has 0.000, the starting point; AbdoRackwitz has 4.969 at a point with
#     a strength of 20.0 and a load of 20.3.  SQP is right.  No message.
# Meaning: the tolerances of these solvers are absolute, and the check of the design point too: 1e-5 GPa
#     are 10 kPa.  Margins of discharge in m3/s, of settlement in m and of pressure in
#     large units give a structure any index.  With large factors there is an error instead.  Divide
#     the margin by its value at the mean, and insert the design point.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openturns==1.27.post1
cat > run.py <<'PY'
import openturns

STRENGTH = openturns.Normal(30.0, 3.0)
LOAD = openturns.LogNormalMuSigma(10.0, 2.0).getDistribution()
START = [30.0, 10.0]
SEEN = {"Cobyla": (4.872, 2.689, 0.0), "AbdoRackwitz": (4.872, 4.969, 4.969), "SQP": (4.872,) * 3}


def form(solver, factor):
    """Reliability index and design point of strength minus load, times a factor."""
    margin = openturns.SymbolicFunction(["r", "s"], [f"{factor} * (r - s)"])
    variables = openturns.RandomVector(openturns.JointDistribution([STRENGTH, LOAD]))
    output = openturns.CompositeRandomVector(margin, variables)
    event = openturns.ThresholdEvent(output, openturns.Less(), 0.0)
    algorithm = getattr(openturns, solver)()
    algorithm.setStartingPoint(START)
    algorithm.setMaximumCallsNumber(10000)
    analysis = openturns.FORM(algorithm, event)
    analysis.run()
    result = analysis.getResult()
    return result.getGeneralisedReliabilityIndex(), result.getPhysicalSpaceDesignPoint()


for solver, indices in SEEN.items():
    for factor, seen in zip(("1", "1e-6", "1e-9"), indices):
        index, point = form(solver, factor)
        probability = openturns.Normal().computeComplementaryCDF(index)
        print(f"{solver}, factor {factor}: index {index:.3f}, probability {probability:.1e}, "
              f"strength {point[0]:.2f}, load {point[1]:.2f}")
        assert abs(index - seen) < 0.01

# Independent value: the closest point of the limit state in the space of standard normal variables.
strengths = [10 + 0.005 * k for k in range(5000)]
loads = [openturns.Normal().computeQuantile(LOAD.computeCDF(value))[0] for value in strengths]
distances = [((value - 30) / 3) ** 2 + load**2 for value, load in zip(strengths, loads)]
print(f"by search along the limit state {min(distances) ** 0.5:.3f}")
assert abs(min(distances) ** 0.5 - 4.872) < 0.001
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
