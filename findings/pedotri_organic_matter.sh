#!/usr/bin/env bash
# pedotri 0.4.1: 8 % of organic matter make no difference to the water that a loam holds.
#
# Expected: `saxton_rawls` takes sand, clay and organic matter in per cent. Loam (40 % sand, 20 % clay) with 2.5 % of
#     organic matter has the row of the paper (Saxton and Rawls 2006, table 3): wilting point 14 %, field capacity 28 %,
#     saturation 46 %, 15.5 mm/h, 1.43 g/cm3; organic matter raises all but the density.
# Seen: 12.2 %, 25.3 %, 39.5 %, 8.0 mm/h, 1.60 g/cm3. The saturation is 39.4 % without organic matter and 39.6 % with
#     8 % of it, by the equations 39.4 and 60.7 %. Sandy loam and clay alike. No message.
# Meaning: in the equations sand and clay are fractions of one, but organic matter is in per cent; the library divides
#     all three by 100. Dykes, covers and topsoil get half their permeability, too little storage and too large a
#     density. Give 100 times the organic matter, which is accepted up to 1 %, or use the equations below.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    --no-deps pedotri==0.4.1 numpy==2.4.6
cat > run.py <<'PY'
import math

from pedotri.ptf import saxton_rawls

PAPER = {  # sand, clay in %: wilting point, field capacity, saturation in %, mm/h, g/cm3 at 2.5 % of organic matter
    (40.0, 20.0): (14, 28, 46, 15.5, 1.43),
    (65.0, 10.0): (8, 18, 45, 50.3, 1.46),
    (25.0, 50.0): (30, 42, 50, 1.1, 1.33),
}


def by_equations(sand, clay, organic):
    """The same by equations 1 to 3, 5, 6, 15, 16 and 18 of the paper, organic matter in per cent."""
    s, c, o = sand / 100, clay / 100, organic
    dry = -0.024 * s + 0.487 * c + 0.006 * o + 0.005 * s * o - 0.013 * c * o + 0.068 * s * c + 0.031
    field = -0.251 * s + 0.195 * c + 0.011 * o + 0.006 * s * o - 0.027 * c * o + 0.452 * s * c + 0.299
    free = 0.278 * s + 0.034 * c + 0.022 * o - 0.018 * s * o - 0.027 * c * o - 0.584 * s * c + 0.078
    dry, field = 1.14 * dry - 0.02, field + 1.283 * field**2 - 0.374 * field - 0.015
    full = field + 1.636 * free - 0.107 - 0.097 * s + 0.043
    slope = (math.log(field) - math.log(dry)) / (math.log(1500) - math.log(33))
    return 100 * dry, 100 * field, 100 * full, 1930 * (full - field) ** (3 - slope), 2.65 * (1 - full)


def by_library(sand, clay, organic):
    """The same by the library."""
    soil = saxton_rawls(sand, clay, organic)
    water = (100 * soil.wilting_point, 100 * soil.field_capacity, 100 * soil.saturation)
    return *water, soil.saturated_conductivity, soil.bulk_density


for (sand, clay), row in PAPER.items():
    found, right = by_library(sand, clay, 2.5), by_equations(sand, clay, 2.5)
    print(f"{sand} % sand, {clay} % clay: {[round(value, 2) for value in found]}, right {[round(v, 2) for v in right]}")
    assert all(abs(value / given - 1) < 0.06 for value, given in zip(right, row))
    # The library divides by 100 once more: the equations agree with a hundredth of the organic matter.
    assert all(math.isclose(value, other, rel_tol=1e-9) for value, other in zip(found, by_equations(sand, clay, 0.025)))
bare, rich = by_library(40.0, 20.0, 0.0)[2], by_library(40.0, 20.0, 8.0)[2]
print(f"saturation of loam: {bare:.1f} % bare, {rich:.1f} % with 8 % of organic matter")
assert rich - bare < 0.3 and by_equations(40.0, 20.0, 8.0)[2] - bare > 15
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
