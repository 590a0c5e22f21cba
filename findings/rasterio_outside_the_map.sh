#!/usr/bin/env bash
# rasterio 1.4.4: a borehole outside the map stands at sea level.
#
# Expected: the height at a point outside a raster is NaN or masked, or an error, and the mean height
#     in a polygon is the one of the cells in it.
# Seen: a ground of 300 m everywhere, saved without a value for missing data.  `sample` 5 m beyond its
#     edge has 0 m.  `mask` with a triangle, cropped, has a mean of 125 m.  A window that reaches beyond
#     the edge (`boundless=True`) and `reproject` to a larger grid have zeros there too.  With
#     nodata=-9999 the values are -9999.  Only `masked=True` and `filled=False` tell them apart.
# Meaning: heights of boreholes near the edge of a tile, the mean level of a site, volumes of cut and
#     fill and the ground of a mesh mix with the sea.  Ask for masked arrays.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    rasterio==1.4.4 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
from rasterio.io import MemoryFile
from rasterio.mask import mask
from rasterio.transform import from_origin
from rasterio.warp import reproject
from rasterio.windows import Window

GRID = dict(crs="EPSG:25832", transform=from_origin(500000, 5800000, 10, 10))
GROUND = np.full((10, 10), 300.0, dtype="float32")
corners = [(500000, 5800000), (500055, 5800000), (500000, 5799945), (500000, 5800000)]
triangle = [{"type": "Polygon", "coordinates": [corners]}]
points = [(500050, 5799950), (500105, 5799950)]

for missing, seen in ((None, 0), (-9999, -9999)):
    file = MemoryFile()
    size = dict(height=10, width=10, count=1, dtype="float32", nodata=missing)
    with file.open(driver="GTiff", **size, **GRID) as raster:
        raster.write(GROUND, 1)
    with file.open() as raster:
        inside, outside = (float(value[0]) for value in raster.sample(points))
        flagged = [bool(np.ma.getmaskarray(value)[0]) for value in raster.sample(points, masked=True)]
        cropped, _ = mask(raster, triangle, crop=True)
        masked, _ = mask(raster, triangle, crop=True, filled=False)
        window = raster.read(1, window=Window(5, 5, 10, 10), boundless=True)
    print(f"nodata {missing}: inside {inside} m, outside {outside} m, masked {flagged}; mean "
          f"in the triangle {cropped.mean():.0f} m, as masked array {masked.mean():.0f} m; least of a "
          f"window {window.min()} m")
    assert (inside, outside) == (300, seen) and flagged == [False, True]
    assert abs(masked.mean() - 300) < 1e-3 and window.min() == seen
    assert abs(cropped.mean() - (125 if missing is None else -5707.75)) < 0.01

larger = np.zeros((12, 12), dtype="float32")
reproject(GROUND, larger, src_transform=GRID["transform"], src_crs=GRID["crs"], dst_crs=GRID["crs"],
          dst_transform=from_origin(499990, 5800010, 10, 10))
print(f"reprojected to a larger grid: from {larger.min()} to {larger.max()} m")
assert larger.min() == 0 and larger.max() == 300
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
