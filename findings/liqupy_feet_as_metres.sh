#!/usr/bin/env bash
# LiquPy 0.13.1.0: a borehole in feet and pounds has another factor of safety, and twice the settlement, than in metres.
#
# Expected: `Borehole(..., units="british")` takes depths in ft, and its page asks for the water table in the same
#     units; the factors of safety of a log do not depend on its units, and the settlement in ft is the one in m over
#     0.3048.
# Seen: sand, N of 6 to 14, water at 1 m, magnitude 7, 0.25 g. At 1.5 m the factor is 0.66 with m and kN/m3, and 0.46
#     with ft and lb/ft3; at 3 m 0.60 and 0.45. The settlement is 0.32 m, and 2.05 ft = 0.62 m. With ft and kip/ft3
#     the vertical effective stress is negative, the factors are -25 to -252, and 0.25 m remain. No message.
# Meaning: the argument changes only the labels of a drawing. Water weighs 9.81 per cubic foot, one atmosphere is 100,
#     and the curve of the stress reduction takes feet as metres. Convert the log to m and kN/m3 before.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    --no-deps LiquPy==0.13.1.0 scikit-learn==1.8.0 joblib==1.5.2 threadpoolctl==3.6.0 pandas==3.0.0 \
    matplotlib==3.10.8 contourpy==1.3.3 cycler==0.12.1 fonttools==4.61.0 kiwisolver==1.4.9 packaging==25.0 \
    pillow==12.0.0 pyparsing==3.2.5 python-dateutil==2.9.0.post0 six==1.17.0 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import contextlib
import io
import warnings

import pandas as pd

warnings.simplefilter("ignore")
from liqupy.boreholes import Borehole  # noqa: E402

FOOT, POUND = 0.3048, 0.157087  # m; kN/m3 of one lb/ft3
DEPTHS, BLOWS, WEIGHT, WATER = (1.5, 3.0, 4.5, 6.0, 7.5, 9.0), (6, 7, 9, 10, 12, 14), 19.0, 1.0


def analyse(units, length, weight):
    """Factors of safety and the settlement in m of a log in the given units."""
    count = len(DEPTHS)
    columns = (range(count), [depth / length for depth in DEPTHS], BLOWS, ["SP"] * count, [0] * count, [5.0] * count)
    log = pd.DataFrame(dict(enumerate((*columns, [WEIGHT / weight] * count))))
    hole = Borehole(log, units=units)
    hole.simplified_liquefaction_triggering_fos(Pa=0.25, M=7.0, Zw=WATER / length, rod_extension=1.0 / length)
    with contextlib.redirect_stdout(io.StringIO()):
        hole.calc_ls_zhang2004()
    table = hole.new_bore_log_data
    return list(table["FS"]), sum(table["dSi"]) * length, list(table["sigmavp"])


metric = analyse("metric", 1.0, 1.0)
pounds = analyse("british", FOOT, POUND)
kips = analyse("british", FOOT, POUND * 1000)
for name, (factors, settlement, _) in (("m, kN", metric), ("ft, lb", pounds), ("ft, kip", kips)):
    print(f"{name}: factors of safety {[round(factor, 2) for factor in factors]}, settlement {settlement:.2f} m")
# The stress by hand in the middle of the log: the metric one is right.
assert abs(metric[2][2] - (WEIGHT * DEPTHS[2] - 9.81 * (DEPTHS[2] - WATER))) < 1e-9
assert abs(metric[0][0] - 0.660) < 0.002 and abs(pounds[0][0] - 0.458) < 0.002
assert pounds[1] / metric[1] > 1.5 and max(kips[0]) < -20 and max(kips[2]) < 0
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
