#!/usr/bin/env bash
# python-ags4 1.2.0: the strongest layers have no blow count, and the mean is the one of the soft clay.
#
# Expected: `convert_to_numeric` keeps results that are no plain numbers (">50", "50/150mm"), or says
#     that it cannot convert them.
# Seen: blow counts 4, 6, 8, ">50" and "50/150mm" of one borehole become 4, 6, 8 and two NaN, without a
#     message.  The mean of the column is 6, and the largest value 8.  An empty field becomes NaN,
#     too, so that a refusal and a missing test cannot be told apart afterwards.
# Meaning: refusals are the tests that stopped in rock, gravel or a boulder.  Profiles by depth end
#     above them, statistics of strength are those of the weak layers, and an obstacle to driving is
#     not in the model.  Compare the number of non-empty texts with the number of values.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    python-ags4==1.2.0 pandas==2.3.3
cat > run.py <<'PY'
import warnings

from python_ags4 import AGS4

LINES = [
    '"GROUP","ISPT"',
    '"HEADING","LOCA_ID","ISPT_TOP","ISPT_NVAL"',
    '"UNIT","","m",""',
    '"TYPE","ID","2DP","0DP"',
    *(f'"DATA","BH1","{depth}.00","{blows}"'
      for depth, blows in enumerate(("4", "6", "8", ">50", "50/150mm", ""), start=1)),
]
with open("borehole.ags", "w") as file:
    file.write("\n".join(LINES) + "\n")
tables, _ = AGS4.AGS4_to_dataframe("borehole.ags")
texts = tables["ISPT"].loc[2:, "ISPT_NVAL"]
with warnings.catch_warnings():
    warnings.simplefilter("error")
    blows = AGS4.convert_to_numeric(tables["ISPT"])["ISPT_NVAL"]
print("in the file:", texts.tolist())
print("converted:  ", blows.tolist())
print(f"mean {blows.mean()}, largest {blows.max()}")
assert (texts != "").sum() == 5 and blows.notna().sum() == 3
assert blows.mean() == 6 and blows.max() == 8
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
