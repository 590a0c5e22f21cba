#!/usr/bin/env bash
# seismic_bedload 0.2.0: boulders that lie still make a river 100 times as loud.
#
# Expected: the noise of bedload in `SaltationModel` comes from grains that move, those whose shear stress exceeds the
#     critical one, so that grains below it add nothing, as a filter at the end of the model intends.
# Seen: slope of 0.01, gravel of 2 to 600 mm with a median of 60 mm. At 1 m of water all grains move. At 0.5 m, where
#     those above 112 mm lie still, the noise of 1e-4 m2/s at 10 Hz is 2.3e-14 (m/s)2/Hz, of the moving grains alone
#     2.2e-16. At 0.3 m nothing moves, and the noise is largest, 6.0e-14; it falls as the water rises. No message.
# Meaning: the filtered result is computed and not returned, so grains at rest count with a slow and low hop, and many
#     impacts of large mass. The bedload by `inverse_bedload` at low water comes out 100 times too small, and is not
#     zero when nothing moves. Set the share of grains below their critical stress to zero before.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    --no-deps seismic_bedload==0.2.0 tqdm==4.67.1 numpy==2.4.6 scipy==1.17.1 matplotlib==3.10.8 contourpy==1.3.3 \
    cycler==0.12.1 fonttools==4.61.0 kiwisolver==1.4.9 packaging==25.0 pillow==12.0.0 pyparsing==3.2.5 \
    python-dateutil==2.9.0.post0 six==1.17.0
cat > run.py <<'PY'
import numpy as np
from seismic_bedload import SaltationModel, log_raised_cosine_pdf

MEDIAN, SLOPE, FLUX, FREQUENCY = 0.06, 0.01, 1e-4, np.array([10.0])  # m, -, m2/s, Hz
GRAINS = np.linspace(0.002, 0.6, 600)  # m
SHARE = log_raised_cosine_pdf(GRAINS, MEDIAN, 0.85 / np.sqrt(1 / 3 - 2 / np.pi**2)) / GRAINS
model = SaltationModel()


def moving(depth):
    """Whether each grain moves: shear stress over the critical one, for the density of the model."""
    density = (model.sediment_params.rho_s - model.sediment_params.rho_f) / model.sediment_params.rho_f
    critical = model.estimate_critical_shear(SLOPE) * (GRAINS / MEDIAN) ** -0.9
    return depth * SLOPE / (density * GRAINS) > critical


def noise(depth, share):
    """Power of the noise at 10 Hz in (m/s)2/Hz."""
    return model.forward_psd(FREQUENCY, GRAINS, depth, 20.0, SLOPE, 50.0, FLUX, D50=MEDIAN, pdf=share)[0]


for depth, seen, right in ((0.3, 5.965e-14, 0.0), (0.5, 2.292e-14, 2.181e-16), (1.0, 6.090e-15, 6.090e-15)):
    every, mobile = noise(depth, SHARE), noise(depth, np.where(moving(depth), SHARE, 0.0))
    print(f"{depth} m: {moving(depth).sum()} of {GRAINS.size} sizes move, noise {every:.3e}, of these {mobile:.3e}")
    assert abs(every / seen - 1) < 0.01 and abs(mobile - right) <= 0.01 * right
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
