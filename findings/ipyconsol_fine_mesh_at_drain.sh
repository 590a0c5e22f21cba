#!/usr/bin/env bash
# ucla-geotech-tools 3.1.0 (ipyconsol): with a finer mesh at the drains, clay takes five times as long to consolidate.
#
# Expected: `depth` is an array of depths, so that elements may be thinner where the pore pressure is steep, and
#     the result tends to the closed form for every family of meshes.
# Seen: 10 m of uniform clay, drained at both ends, a small load, no weight and no creep.  At the time of 90 % in
#     Terzaghi's series, 40 equal elements give 90.0 %.  Elements of 5 cm in the outer metres and 0.5 m between give
#     44.7 %, and with half and a quarter of these sizes 44.3 and 44.1 %: they converge to a wrong value, and reach 90 %
#     after 4.7 times the time.  A mesh graded by a cosine gives 71.4 %.  No message.
# Meaning: the second derivative is taken as (u1 - 2 u2 + u3) over the square of the mean spacing, which is a
#     second derivative only for equal spacings: where 5 cm meet 0.5 m, the flow jumps by a factor of ten.  Depths
#     from a borehole, or a fine mesh at a drain, slow the settlement down by a factor.  Use equal spacings.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    ucla-geotech-tools==3.1.0 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
from ucla_geotech_tools import ipyconsol

HEIGHT, PERMEABILITY, INITIAL, INDEX, OCR, WATER = 10.0, 1e-9, 1000.0, 0.1, 4.0, 9.81  # m, m/s, kPa, kN/m3
void_ratio = 1 - 2 * INDEX * np.log10(OCR) + INDEX * np.log10(OCR)
compressibility = INDEX / np.log(10) / INITIAL / (1 + void_ratio)
diffusion = PERMEABILITY / (WATER * compressibility)


def terzaghi(time):
    """Degree of consolidation of a layer that is drained at both ends."""
    roots = np.pi * (np.arange(200) + 0.5)
    return 1 - np.sum(2 / roots**2 * np.exp(-(roots**2) * diffusion * time / (HEIGHT / 2) ** 2))


def consolidation(depth, times):
    """Degree of consolidation at the last time, after a load of a thousandth of the stress in the ground."""
    def nodes(value):
        return np.full(len(depth), value)

    result = ipyconsol.compute(
        depth=depth, time=times, loadfactor=np.ones(len(times)), Cc=nodes(2 * INDEX), Cr=nodes(INDEX),
        sigvref=nodes(INITIAL), esigvref=nodes(1.0), Gs=nodes(1.0), kref=nodes(PERMEABILITY), ekref=nodes(1.0),
        Ck=nodes(1e6), Ca=nodes(0.0), tref=nodes(1.0), qo=INITIAL, dsigv=nodes(1.0),
        ocrvoidratiotype=nodes(0).astype(int), ocrvoidratio=nodes(OCR), drainagetype=0, gammaw=WATER,
    )
    return 1 - np.trapezoid(result["u"][:, -1], depth) / HEIGHT


times = np.linspace(0, 0.848 * (HEIGHT / 2) ** 2 / diffusion, 201)[1:]
right = terzaghi(times[-1])
assert abs(right - 0.9) < 1e-3
for finer in (1, 2, 4):
    meshes = {
        "equal elements": (np.linspace(0, HEIGHT, 40 * finer + 1), 0.8996),
        "fine at the drains": (np.interp(np.linspace(0, 56, 56 * finer + 1), [0, 20, 36, 56], [0, 1, 9, 10]), 0.444),
        "cosine": (HEIGHT / 2 * (1 - np.cos(np.linspace(0, np.pi, 40 * finer + 1))), 0.714),
    }
    for name, (depth, seen) in meshes.items():
        found = consolidation(depth, times)
        spacing = np.diff(depth)
        print(f"{name}, {spacing.min():.4f} m to {spacing.max():.4f} m: {found:.4f}, right {right:.4f}")
        assert abs(found - seen) < 0.004

late = consolidation(meshes["fine at the drains"][0], 4.7 * times)
print(f"fine at the drains, 4.7 times as late: {late:.4f}")
assert abs(late - 0.9) < 0.01
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
