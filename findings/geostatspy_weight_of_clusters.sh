#!/usr/bin/env bash
# geostatspy 0.0.79: declustering for the smallest mean takes the largest, and leaves clustered data as they are.
#
# Expected: `declus` with `iminmax`: "1 / True: for use cell size with max decluster mean, 0 / False: for declustered
#     mean minimizing cell size".  Borings crowd where the ground is bad or good; with the crowd in the strong part one
#     gives 0, as in GSLIB, and the weights bring the mean down.
# Seen: 36 soundings on a grid with 10 MPa and 40 more within 10 m with 20 MPa: the plain mean is 15.3 MPa.  With 0 all
#     weights are 1 and the mean is 15.3 MPa; with 1 the mean is 10.6 MPa, the smallest over the cell sizes that the
#     function itself returns.  With the crowd in weak ground, 20 on the grid and 10 MPa in the crowd, 1 keeps the plain
#     mean, 14.7 MPa, and 0 gives 19.4.  No message.
# Meaning: the meaning of the flag is the reverse of its description and of GSLIB.  Characteristic values
#     from crowded borings are not declustered at all, on the unsafe side if the crowd is in strong ground.  Compare the
#     weighted mean with the returned means of the cell sizes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    geostatspy==0.0.79 numpy==2.4.6 scipy==1.17.1 pandas==2.3.3 statsmodels==0.15.0 numba==0.68.1 tqdm==4.70.1
cat > run.py <<'PY'
import contextlib
import io

import numpy as np
import pandas as pd
from geostatspy import geostats

grid = np.array(np.meshgrid(np.linspace(5, 95, 6), np.linspace(5, 95, 6))).reshape(2, -1)  # m
crowd = np.random.default_rng(1).uniform(40, 50, (2, 40))
east, north = np.concatenate([grid, crowd], axis=1)

for name, on_grid, in_crowd in (("strong crowd", 10.0, 20.0), ("weak crowd", 20.0, 10.0)):
    strength = np.r_[np.full(grid.shape[1], on_grid), np.full(crowd.shape[1], in_crowd)]  # MPa
    data = pd.DataFrame({"east": east, "north": north, "strength": strength})
    mean = {}
    for flag in (0, 1):
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            weights, _, means = geostats.declus(data, "east", "north", "strength", flag, 10, 20, 5, 60)
        mean[flag] = np.average(strength, weights=weights)
        means = means[:-1]
        print(f"{name}, iminmax={flag}: mean {mean[flag]:.2f} MPa, plain {strength.mean():.2f}; "
              f"by cell size {means.min():.2f} to {means.max():.2f}")
    # The description says the reverse: 0 for the smallest mean, 1 for the largest.
    assert np.isclose(mean[0], means.max()) and np.isclose(mean[1], means.min())
    plain = mean[0] if name == "strong crowd" else mean[1]
    assert np.isclose(plain, strength.mean())
    assert abs(mean[0] - mean[1]) > 4
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
