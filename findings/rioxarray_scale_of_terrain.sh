#!/usr/bin/env bash
# rioxarray 0.19.0, rasterio 1.4.4, xarray 2026.9.0: a hill of 345 m above the sea has 24,512 m, gaps taken care of.
#
# Expected: a terrain model with heights as whole numbers, a scale of 0.01, an offset of 100 m and a value for gaps is
#     read in metres, at least by `open_rasterio(masked=True)`, which looks after the gaps and returns floats.
# Seen: 24512.0, with the scale in an attribute; without `masked` the mean is 20,932 since the gap is a height, too.
#     rasterio's `read(masked=True)` and `sample` give 24512.  `open_rasterio(mask_and_scale=True)` and xarray's
#     `open_dataset(engine="rasterio")`, by the same library, give 345.12 m.  No message.
# Meaning: two calls of one library return the same file in two units.  In heights that are stored in cm or dm the
#     slope, the depth of a cut and the volume are wrong by the factor of the scale, and without the offset all levels
#     are.  Heights near the sea hide it.  Give `mask_and_scale=True`, and compare one level with a map.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    rioxarray==0.19.0 rasterio==1.4.4 xarray==2026.9.0 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import rasterio
import rioxarray
import xarray
from rasterio.transform import from_origin

SCALE, OFFSET, GAP = 0.01, 100.0, -32768
STORED = 24512
HEIGHT = STORED * SCALE + OFFSET  # m

heights = np.full((4, 4), STORED, dtype=np.int16)
heights[0, 0] = GAP
profile = {"driver": "GTiff", "width": 4, "height": 4, "count": 1, "dtype": "int16", "nodata": GAP}
with rasterio.open("terrain.tif", "w", crs="EPSG:25832", transform=from_origin(0, 40, 10, 10), **profile) as file:
    file.write(heights, 1)
    file.scales, file.offsets = (SCALE,), (OFFSET,)

with rasterio.open("terrain.tif") as file:
    assert file.scales == (SCALE,) and file.offsets == (OFFSET,)
    by_rasterio = float(file.read(1, masked=True).mean())
    (point,) = next(file.sample([(35, 5)]))
means = {
    "open_rasterio": float(rioxarray.open_rasterio("terrain.tif").mean()),
    "open_rasterio, masked": float(rioxarray.open_rasterio("terrain.tif", masked=True).mean()),
    "open_rasterio, mask_and_scale": float(rioxarray.open_rasterio("terrain.tif", mask_and_scale=True).mean()),
    "open_dataset": float(xarray.open_dataset("terrain.tif", engine="rasterio").band_data.mean()),
    "rasterio, masked": by_rasterio,
    "rasterio, sample": float(point),
}
for name, mean in means.items():
    print(f"{name}: {mean:.2f} m, right {HEIGHT:.2f} m")
assert means["open_rasterio"] == heights.mean()
for name in ("open_rasterio, masked", "rasterio, masked", "rasterio, sample"):
    assert means[name] == STORED
for name in ("open_rasterio, mask_and_scale", "open_dataset"):
    assert abs(means[name] - HEIGHT) < 1e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
