#!/usr/bin/env bash
# openseespy 3.7.1.2: the tip of a pile settles 12 % more under half its resistance than the material was told.
#
# Expected: z50 of `QzSimple1` and y50 of `PySimple1` are the displacements at which 50 % of the ultimate load are
#     mobilised, as documented, and as z50 of `TzSimple1` is.
# Seen: at z50 the tip has 45.5 % (clay) and 47.5 % (sand) of its ultimate load, a lateral spring 49.2 and 47.4 %, and
#     the shaft 50.0 % of both types.  Half the load is reached at 1.12 z50 (clay) and 1.13 z50 (sand) at the tip.
# Meaning: the curve of the tip is an elastic spring in series with a plastic one, and their constants are rounded:
#     with the share q of the load z / z50 = 0.35 ((0.8 / (1 - q))**(1 / 1.2) - 1) + q / 0.525 in clay.  A pile that was
#     fitted to a load test at half its resistance settles 12 % more in the model, while its shaft is right,
#     so that the load moves from the tip to the shaft.  Divide z50 by 1.12 or 1.13.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    openseespy==3.7.1.2
cat > run.py <<'PY'
import openseespy.opensees as ops

ULTIMATE, HALF = 100.0, 0.01  # kN, m


def mobilised(material, kind, *places):
    """Shares of the ultimate load at displacements, given in z50, that are reached one after the other."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    ops.node(1, 0.0)
    ops.node(2, 0.0)
    ops.fix(1, 1)
    drag = (0.3,) if material == "PySimple1" else ()
    ops.uniaxialMaterial(material, 1, kind, ULTIMATE, HALF, *drag)
    ops.element("zeroLength", 1, 1, 2, "-mat", 1, "-dir", 1)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    ops.sp(2, 1, -HALF)
    ops.constraints("Lagrange")
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.test("NormDispIncr", 1e-10, 50)
    ops.algorithm("Newton")
    shares, reached = [], 0.0
    for place in places:
        ops.integrator("LoadControl", (place - reached) / 100)
        ops.analysis("Static")
        assert ops.analyze(100) == 0
        reached = place
        shares.append(-ops.eleResponse(1, "material", 1, "stress")[0] / ULTIMATE)
    return shares


def place_of(share):
    """Displacement over z50 at the tip of a pile in clay."""
    return 0.35 * ((0.8 / (1 - share)) ** (1 / 1.2) - 1) + share / 0.525


for material, kind, seen in (
    ("QzSimple1", 1, 0.455), ("QzSimple1", 2, 0.4745), ("PySimple1", 1, 0.492), ("PySimple1", 2, 0.4735),
    ("TzSimple1", 1, 0.5), ("TzSimple1", 2, 0.5),
):
    share = mobilised(material, kind, 1.0)[0]
    print(f"{material} of type {kind}: {share:.4f} of the ultimate load at z50")
    assert abs(share - seen) < 1e-3
for kind, place in ((1, 1.120), (2, 1.134)):
    share = mobilised("QzSimple1", kind, place)[0]
    print(f"QzSimple1 of type {kind}: {share:.4f} at {place} z50")
    assert abs(share - 0.5) < 1e-3
places = (0.5, 1.0, 2.0, 5.0)
for place, share in zip(places, mobilised("QzSimple1", 1, *places)):
    print(f"{place} z50: {share:.4f}, for which the formula has {place_of(share):.4f} z50")
    assert abs(place_of(share) / place - 1) < 2e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py 2>&1
