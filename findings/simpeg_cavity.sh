#!/usr/bin/env bash
# simpeg 0.25.2, harmonica 0.7.0: a cavity under a road makes an anomaly of +8.7 mGal.
#
# Expected: a cavity (2000 kg/m3 missing in 2 m x 2 m x 2 m, 2.5 m below the receiver) lowers the
#     vertical gravity by 0.0087 mGal, as in harmonica, the package for gravity in SI units.
# Seen: harmonica has -0.00865 mGal.  simpeg has +8.65 mGal with the same density: the component `gz`
#     is positive upwards, and densities are in g/cm3.  Both have five digits in common with the
#     formula of the prism.  No message.
# Meaning: with kg/m3 the size gives the mistake away, with g/cm3 nothing does: +0.0087 mGal is a
#     boulder to anybody who knows anomalies.  An inversion of field data, which are positive
#     downwards, finds dense bodies for cavities and cavities for foundations.  Change the sign of
#     the readings, and compute one known body first.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    simpeg==0.25.2 harmonica==0.7.0 numpy==2.4.6
cat > run.py <<'PY'
import discretize
import harmonica
import numpy as np
from simpeg import maps
from simpeg.potential_fields import gravity

HEIGHT, MISSING = 0.5, -2000.0
reference = harmonica.prism_gravity(
    (np.zeros(1), np.zeros(1), np.full(1, HEIGHT)), [[-1, 1, -1, 1, -4, -2]], [MISSING], field="g_z"
)[0]
mesh = discretize.TensorMesh([np.ones(10)] * 3, origin="CCN")
x, y, z = mesh.cell_centers.T
cavity = (abs(x) < 1) & (abs(y) < 1) & (z > -4) & (z < -2)
receiver = gravity.receivers.Point(np.array([[0.0, 0.0, HEIGHT]]), components="gz")
survey = gravity.survey.Survey(gravity.sources.SourceField([receiver]))
simulation = gravity.simulation.Simulation3DIntegral(
    mesh, survey=survey, rhoMap=maps.IdentityMap(nP=mesh.n_cells)
)
in_si, in_grams = [simulation.dpred(np.where(cavity, value, 0.0))[0] for value in (MISSING, MISSING / 1e3)]
print(f"harmonica {reference:.5f} mGal; simpeg {in_si:.5f} mGal with kg/m3, {in_grams:.5f} with g/cm3")
assert abs(reference + 0.008654) < 1e-6
assert abs(in_si / reference + 1000) < 0.01 and abs(in_grams / reference + 1) < 1e-5
PY
OMP_NUM_THREADS=1 venv/bin/python run.py 2>&1
