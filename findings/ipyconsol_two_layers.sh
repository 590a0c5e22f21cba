#!/usr/bin/env bash
# ucla-geotech-tools 3.1.0 (ipyconsol): clay on silt ten times as permeable, where a load of 1 kPa makes 111 kPa.
#
# Expected: material constants are arrays for soil "that can be non-uniform"; the excess pore pressure under a constant
#     load stays between zero and the load, and the lower the resistance, the faster the settlement.
# Seen: 5 m of clay on 5 m of silt, alike but for the permeability, drained at the top, a load of 1 kPa.  When uniform
#     clay has settled by half, a silt twice as permeable gives 51 %, right is 53 %; four times 40 %, five times 25 %,
#     right is 54 %.  Eight times gives 5 kPa of excess pressure and a heave of 2.4 times the final settlement; ten
#     times 111 kPa, and 440 kPa on a mesh four times finer.  Drained at both ends, ten times has settled by 116 % when
#     64 % are right, with -1.2 kPa.  No message.
# Meaning: the flow is the sum of k u'' and k' u' by central differences, and is not the same on both sides of a node.
#     The weight of a neighbour is k + (k1 - k3) / 4: it vanishes where one layer is five times as permeable as the
#     other, which cuts the layers off from each other, and is negative beyond.  A sand seam in clay has a
#     contrast of a thousand.  Spread each change of permeability over many nodes, and look for negative pressures.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    ucla-geotech-tools==3.1.0 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
from scipy.linalg import solve_banded
from ucla_geotech_tools import ipyconsol

HEIGHT, CLAY, INITIAL, INDEX, OCR, WATER = 10.0, 1e-9, 1000.0, 0.1, 4.0, 9.81  # m, m/s, kPa, kN/m3
TOP, BOTH = 1, 0
void_ratio = 1 - 2 * INDEX * np.log10(OCR) + INDEX * np.log10(OCR)
compressibility = INDEX / np.log(10) / INITIAL / (1 + void_ratio)
half = 0.848 * (HEIGHT / 2) ** 2 * WATER * compressibility / CLAY
times = np.linspace(0, half, 401)[1:]


def ipyconsol_result(contrast, drainage, parts=40):
    """Degrees of consolidation over time, smallest and largest excess pore pressure in kPa."""
    depth = np.linspace(0, HEIGHT, parts + 1)

    def nodes(value):
        return np.full(parts + 1, value)

    pressures = ipyconsol.compute(
        depth=depth, time=times, loadfactor=np.ones(len(times)), Cc=nodes(2 * INDEX), Cr=nodes(INDEX),
        sigvref=nodes(INITIAL), esigvref=nodes(1.0), Gs=nodes(1.0), ekref=nodes(1.0), Ck=nodes(1e6), Ca=nodes(0.0),
        kref=np.where(depth < HEIGHT / 2 + 1e-9, CLAY, contrast * CLAY), tref=nodes(1.0), qo=INITIAL,
        dsigv=nodes(1.0), ocrvoidratiotype=nodes(0).astype(int), ocrvoidratio=nodes(OCR), drainagetype=drainage,
        gammaw=WATER,
    )["u"]
    return 1 - np.trapezoid(pressures, depth, axis=0) / HEIGHT, pressures.min(), pressures.max()


def volumes(contrast, drainage, parts=1000):
    """Degrees of consolidation over time by finite volumes, the permeability between two cells being harmonic."""
    size = HEIGHT / parts
    permeability = np.where(np.arange(parts) < parts // 2, CLAY, contrast * CLAY)
    between = 2 / (1 / permeability[1:] + 1 / permeability[:-1])
    step = times[0] / WATER / size**2
    bands = np.zeros((3, parts))
    bands[0, 1:] = bands[2, :-1] = -step * between
    bands[1] = compressibility
    bands[1, :-1] += step * between
    bands[1, 1:] += step * between
    bands[1, 0] += 2 * step * permeability[0]
    if drainage == BOTH:
        bands[1, -1] += 2 * step * permeability[-1]
    pressure, degrees = np.ones(parts), []
    for _ in times:
        pressure = solve_banded((1, 1), bands, compressibility * pressure)
        degrees.append(1 - pressure.mean())
    return np.array(degrees)


# The finite volumes meet Terzaghi's series for uniform clay.
roots = np.pi * (np.arange(200) + 0.5)
series = 1 - np.sum(2 / roots**2 * np.exp(-(roots**2) * 0.848 / 4))
assert abs(volumes(1, TOP)[-1] - series) < 1e-3

for contrast, seen, right, largest in (
    (1, 0.516, 0.519, 1.0), (2, 0.513, 0.528, 1.0), (4, 0.396, 0.534, 1.0), (5, 0.250, 0.536, 1.0),
    (8, -2.43, 0.538, 5.16), (10, -62.8, 0.538, 111.3),
):
    degrees, low, high = ipyconsol_result(contrast, TOP)
    reference = volumes(contrast, TOP)[-1]
    print(f"drained at the top, contrast {contrast}: {degrees[-1]:.3f}, right {reference:.3f}, up to {high:.2f} kPa")
    assert abs(degrees[-1] / seen - 1) < 0.02 and abs(reference - right) < 0.003
    assert abs(high / largest - 1) < 0.02

_, _, finer = ipyconsol_result(10, TOP, 160)
print(f"contrast 10, four times finer: up to {finer:.1f} kPa")
assert finer > 300

degrees, low, high = ipyconsol_result(10, BOTH)
reference = volumes(10, BOTH)
print(f"drained at both ends, contrast 10: {degrees[39]:.3f}, right {reference[39]:.3f}, pressures from {low:.3f} kPa")
assert abs(degrees[39] - 1.160) < 0.01 and abs(reference[39] - 0.644) < 0.003 and low < -1.1
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
