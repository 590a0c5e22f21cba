#!/usr/bin/env bash
# pint 0.25.3, unyt 3.2.0, quantities 0.16.4: a cubic metre of water weighs 1.1 tons.
#
# Expected: "ton" is 1000 kg in a package whose base units are the SI, or is refused as it can be
#     three things.
# Seen: 2.4 ton/m3 are 2177 kg/m3 in pint, and 1 ton is 907.18 kg in unyt and as `quantities.ton`: the
#     short ton of the United States.  "t", "tonne" and "metric_ton" (pint, unyt) are 1000 kg.  `force_ton`
#     of pint is 8.896 kN, not 9.807 kN.
# Meaning: weights, loads of cranes and allowable soil pressures in ton/m2 from a report are read 9 % too
#     low.  Write "t" or "tonne".
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pint==0.25.3 unyt==3.2.0 quantities==0.16.4 numpy==2.4.6
cat > run.py <<'PY'
import pint
import quantities
import unyt

registry = pint.UnitRegistry()
density = registry("2.4 ton/m**3").to("kg/m**3").magnitude
force = registry("1 force_ton").to("kN").magnitude
tons = {
    "pint": registry("1 ton").to("kg").magnitude,
    "unyt": float(unyt.unyt_quantity(1, "ton").to("kg").value),
    "quantities": float(quantities.ton.rescale("kg").magnitude),
}
tonnes = {
    "pint": registry("1 t").to("kg").magnitude,
    "unyt": float(unyt.unyt_quantity(1, "t").to("kg").value),
    "quantities": float(quantities.tonne.rescale("kg").magnitude),
}
print(f"2.4 ton/m3 = {density:.0f} kg/m3; 1 ton of force = {force:.3f} kN")
print(f"1 ton = {tons} kg; 1 t = {tonnes} kg")
assert abs(density - 2177.2) < 0.1 and abs(force - 8.896) < 0.001
assert all(abs(mass - 907.185) < 0.001 for mass in tons.values())
assert all(abs(mass - 1000) < 1e-9 for mass in tonnes.values())
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
