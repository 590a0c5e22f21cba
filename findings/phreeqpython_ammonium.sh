#!/usr/bin/env bash
# phreeqpython 1.6.2: sulphate is a mass of sulphate, ammonium a mass of nitrogen.
#
# Expected: in a solution in mg/l all amounts are masses of one kind: of the ions that a laboratory reports,
#     or of the elements.
# Seen: 300 mg/l of S(6) are 3.12 mmol/l, as 300 mg/l of the ion SO4.  60 mg/l of N(-3) are 4.28 mmol/l, as
#     60 mg/l of nitrogen, where the ion NH4 has 3.33 mmol/l: 77 mg/l of it.  50 mg/l of N(5) are 3.57
#     mmol/l in place of 0.81 mmol/l of the ion NO3.  100 mg/l of C(4) are 1.64 mmol/l, of the ion HCO3.
#     10 mg/l of P are 0.32 mmol/l, of the element.  The database sets the formula of each.
# Meaning: an analysis of ground water for the attack on concrete that is copied as it stands has 29 % too
#     much ammonium, and nitrate is 4.4 times too high in the balance of charges.  Give moles.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    phreeqpython==1.6.2
cat > run.py <<'PY'
from phreeqpython import PhreeqPython

# Amount in mg/l, element, molar masses in g/mol of the ion and of the element, and which one is used.
AMOUNTS = {
    "S(6)": (300, "S", 96.06, 32.06, "ion"), "N(-3)": (60, "N", 18.04, 14.007, "element"),
    "N(5)": (50, "N", 62.0, 14.007, "element"), "C(4)": (100, "C", 61.02, 12.011, "ion"),
    "P": (10, "P", 94.97, 30.974, "element"),
}
water = PhreeqPython()
for name, (amount, element, ion, atom, used) in AMOUNTS.items():
    solution = water.add_solution({"units": "mg/l", name: amount})
    found = solution.total_element(element)
    by = {"ion": amount / ion, "element": amount / atom}
    print(f"{amount} mg/l of {name}: {found:.2f} mmol/l; of the ion {by['ion']:.2f}, "
          f"of the element {by['element']:.2f}")
    assert abs(found / by[used] - 1) < 0.01
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
