#!/usr/bin/env bash
# pypiles 0.5.2: blow counts are corrected with the total stress, and the ground water has no influence on them.
#
# Expected: `Borehole` corrects the blow count of a standard penetration test as AASHTO does, N1 = 0.77 log10(40 / s')
#     N with the vertical effective stress s' in ksf, at most twice; `ss_bot_eff` above the water table is the total
#     stress.
# Seen: 20 blows in 19 kN/m3 at 17.5 m depth: 11.7 with water at the surface and with water at 20 m; right is 16.6
#     with water at the surface, s' of 161 kPa, and 11.7 without.  A clay gets a strength of 59 in place of 83 kPa
#     from it, and the shaft 32 in place of 46 kPa.  With water at 20 m the effective stress at 5 m depth is 242 kPa,
#     of a total of 95 kPa.
# Meaning: CN is taken from `ss_mid`, the total stress: under water blow counts, friction angles and strengths are too
#     low, the deeper the more, here by 29 %.  At layer bottoms above the water table the pore pressure is negative
#     without limit, a suction of 147 kPa that enters the tip resistance of dense sand of 2012.  Give `su` of clays
#     and check `nl60` by hand.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pypiles==0.5.2 pandas==2.3.3 numpy==2.4.6
cat > run.py <<'PY'
import math

from pypiles import AnalysisConfig, Borehole, Pile, SoilLayer

BLOWS, WEIGHT, WATER, KSF = 20, 19.0, 9.8, 47.8803  # -, kN/m3, kN/m3, kPa


def layers(kind, depth_of_water):
    hole = Borehole(AnalysisConfig(ver=2024), Pile(diameter=1.0, length=20.0), water_table_depth=depth_of_water,
                    hammer_energy_ratio=0.6)
    for number in range(4):
        hole.add_layer(SoilLayer(number, 5.0 * number, 5.0 * number + 5.0, kind, BLOWS, WEIGHT))
    return hole.layers


def corrected(depth, depth_of_water):
    """Blow count by AASHTO LRFD 10.4.6.2.4 with the effective stress."""
    stress = WEIGHT * depth - WATER * max(depth - depth_of_water, 0.0)
    return min(2.0, 0.77 * math.log10(40 * KSF / stress)) * BLOWS


for place, depth in enumerate((2.5, 7.5, 12.5, 17.5)):
    wet, dry = layers("clay", 0.0)[place], layers("clay", 20.0)[place]
    right = corrected(depth, 0.0)
    print(f"{depth} m: blow count {wet.nl60:.2f} under water, {dry.nl60:.2f} dry, right {right:.2f} and "
          f"{corrected(depth, 20.0):.2f}; strength {wet.su:.1f}, right {5 * right:.1f} kPa, shaft {wet.qs:.1f} kPa")
    assert math.isclose(dry.nl60, corrected(depth, 20.0), rel_tol=1e-6)
    assert wet.nl60 == dry.nl60 and math.isclose(wet.ss_mid_eff, (WEIGHT - WATER) * depth)
    assert wet.su == 5 * wet.nl60 and right > 1.1 * wet.nl60
assert abs(wet.nl60 / right - 0.706) < 2e-3 and abs(wet.qs - 0.55 * wet.su) < 1e-9

first = layers("sand", 20.0)[0]
print(f"bottom of the first layer, water at 20 m: total {first.ss_bot:.0f}, effective {first.ss_bot_eff:.0f} kPa")
assert first.ss_bot == 95.0 and math.isclose(first.ss_bot_eff, 95.0 + WATER * 15.0)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
