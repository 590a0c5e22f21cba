#!/usr/bin/env bash
# seismic_bedload 0.2.0: one reading of a seismometer gives 1/40 of the bedload of two readings of the same.
#
# Expected: `inverse_bedload` of `SaltationModel` gives each reading of the noise of a river its bedload, whether it
#     stands alone or in a series; it is linear, so that the noise of `forward_psd` for 0.001 m2/s gives 0.001 m2/s
#     back.
# Seen: river of 10 m, grains with a median of 5 mm, geophone at 17 m. The noise of 0.001 m2/s at 0.4 m of water as
#     two readings: 0.00100 m2/s; as one: 0.000019. At 0.2 m 0.000039, at 0.8 m 0.000013. No message.
# Meaning: for a single reading the library takes 50 m for the median grain in place of `D50`, so that the critical
#     shear stress of each grain is thousands of times too large, grains hardly move and are loud. Reading by reading,
#     as a monitor on line does, gives a few per cent of the bedload. Pass each reading twice and take the first
#     result.
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

FLUX, MEDIAN, SLOPE = 1e-3, 0.005, np.tan(np.radians(0.7))  # m2/s, m, -
FREQUENCY, GRAINS = np.linspace(30.0, 80.0, 10), np.linspace(1e-4, 0.07, 100)  # Hz, m
SHARE = log_raised_cosine_pdf(GRAINS, 0.009, 0.85 / np.sqrt(1 / 3 - 2 / np.pi**2)) / GRAINS
RIVER = {"W": 10.0, "theta": SLOPE, "r0": 17.0, "D50": MEDIAN, "tau_c50": 0.045, "pdf": SHARE}
model = SaltationModel()


def bedload(depth, readings):
    """Bedload in m2/s from the noise of a known bedload, read once or more often."""
    noise = np.median(model.forward_psd(FREQUENCY, GRAINS, depth, qb=FLUX, **RIVER))
    level = np.full(readings, 10 * np.log10(noise))
    return model.inverse_bedload(level, FREQUENCY, GRAINS, np.full(readings, depth), qb=1.0, **RIVER)


for depth, seen in ((0.2, 0.0394), (0.4, 0.0187), (0.8, 0.0126)):
    (alone,), series = bedload(depth, 1), bedload(depth, 2)
    print(f"{depth} m of water: {alone:.2e} m2/s from one reading, {series} from two, right {FLUX}")
    assert np.allclose(series, FLUX, rtol=1e-9) and abs(alone / FLUX - seen) < 1e-3
    # With a median of 50 m the series has the number of the single reading.
    wrong = model.forward_psd(FREQUENCY, GRAINS, depth, qb=FLUX, **(RIVER | {"D50": 50}))
    right = model.forward_psd(FREQUENCY, GRAINS, depth, qb=FLUX, **RIVER)
    assert np.isclose(np.median(right) / np.median(wrong), alone / FLUX)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
