#!/usr/bin/env bash
# FoundationDesign 0.1.2: a footing whose moment acts about the other axis has no moment at all.
#
# Expected: a square footing has the same four pressures, in another order, when its loads are turned by 90 degrees,
#     in both limit states.
# Seen: 3 m x 3 m, 800 kN and an imposed moment of 300 kNm.  In the x direction the pressures of the ultimate limit
#     state are 48 to 248 kPa, in the y direction 148 kPa at all corners.  The design moments of the slab are 484 and
#     304 kNm.  In the serviceability limit state both have 43 to 176 kPa, and permanent and wind moments count in both
#     directions.  No message.
# Meaning: the imposed moment in y is multiplied by `uls_strength_factor_imposed_unfavourable`, which is 0 by default,
#     the one in x by the factor for imposed loads.  Moments of cranes and traffic vanish from the reinforcement by the
#     choice of an axis.  Set the factor to 1.5, or turn the footing and compare.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    FoundationDesign==0.1.2 indeterminatebeam==2.2.1 plotly==5.24.1 numpy==2.4.6 sympy==1.14.0
cat > run.py <<'PY'
from FoundationDesign import PadFoundation, padFoundationDesign


def footing(direction, kind):
    """Pressures of both limit states and the larger design moment of a footing with a moment of 300 kNm."""
    pad = PadFoundation(3000, 3000, 400, 400, 1500, 1500, soil_bearing_capacity=250)
    pad.foundation_loads(
        foundation_thickness=500, soil_depth_abv_foundation=500, soil_unit_weight=18, concrete_unit_weight=24
    )
    pad.column_axial_loads(permanent_axial_load=800)
    name = f"wind_moments_{direction}dir" if kind == "wind" else f"{kind}_moment_{direction}dir"
    getattr(pad, f"column_moments_{direction}dir")(**{name: 300})
    design = padFoundationDesign(pad, fck=25, fyk=460, concrete_cover=50)
    moment = getattr(design, f"get_design_moment_{direction.upper()}")()
    return sorted(pad.pad_base_pressures_sls()), sorted(pad.pad_base_pressures_uls()), moment


for kind in ("permanent", "imposed", "wind"):
    (service, ultimate, moment), (service_y, ultimate_y, moment_y) = footing("x", kind), footing("y", kind)
    print(f"{kind}: serviceability {service[0]} to {service[-1]} kPa in x, {service_y[0]} to {service_y[-1]} kPa in y;")
    print(f"    ultimate {ultimate[0]} to {ultimate[-1]} kPa in x, {ultimate_y[0]} to {ultimate_y[-1]} kPa in y;")
    print(f"    design moments {moment} and {moment_y} kNm")
    assert service == service_y
    assert (ultimate == ultimate_y) == (kind != "imposed")
    if kind == "imposed":
        assert ultimate[0] == 48.35 and ultimate[-1] == 248.35 and ultimate_y == [148.35] * 4
        assert abs(moment - 484.467) < 0.01 and abs(moment_y - 304.2) < 0.01
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
