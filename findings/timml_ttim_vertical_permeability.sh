#!/usr/bin/env bash
# timml 6.9.0, ttim 0.8.0: the same aquifer has a tenth of the vertical permeability in the sister.
#
# Expected: a `Model3D` of the steady program and one of the transient program with the same layers
#     and the same permeability describe the same ground, so that long pumping ends in the steady
#     state.
# Seen: a well in the uppermost of ten layers (20 m, 10 m per day, 500 m3 per day).  The drawdown near
#     the well minus the one at the base is 5.06 m in timml and 9.31 m in ttim.  The default of
#     `kzoverkh`, the vertical over the horizontal permeability, is 1 in timml and 0.1 in ttim.  With
#     the same number given to both they agree to 0.3 %.
# Meaning: a pumping test that is fitted in one program and predicted in the other changes its ground
#     on the way: uplift below an excavation, flow around a cut-off wall and the yield of a short
#     screen are off by up to a factor of two.  Give `kzoverkh` in both.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    timml==6.9.0 ttim==0.8.0 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import timml
import ttim

# Ten confined layers of 2 m; a well in the uppermost one takes 500 m3 per day.
SOIL = dict(kaq=10, z=np.linspace(20, 0, 11))


def steady(**option):
    """Drawdowns of the layers at 1 m from the well; the head at 10 km is constant."""
    model = timml.Model3D(**SOIL, **option)
    timml.Constant(model, 1e4, 0, 0.0)
    timml.Well(model, 0, 0, Qw=500.0, rw=0.1, layers=0)
    model.solve(silent=True)
    return -model.headalongline([1.0], [0.0])[:, 0]


def late(**option):
    """Drawdowns at the same place a thousand days after the start of pumping."""
    model = ttim.Model3D(Saq=1e-5, tmin=1, tmax=1e4, **SOIL, **option)
    ttim.Well(model, 0, 0, rw=0.1, tsandQ=[(0, 500.0)], layers=0)
    model.solve(silent=True)
    return -model.headalongline([1.0], [0.0], [1000.0])[:, 0, 0]


for option in ({}, {"kzoverkh": 1}, {"kzoverkh": 0.1}):
    first, second = steady(**option), late(**option)
    # Late drawdowns grow alike in all layers, and their differences are steady.
    first, second = first[0] - first[-1], second[0] - second[-1]
    print(f"{option or 'defaults'}: between top and base {first:.2f} m in timml, {second:.2f} in ttim")
    if option:
        assert abs(second / first - 1) < 0.005
    else:
        assert abs(first - 5.06) < 0.02 and abs(second - 9.31) < 0.02
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
