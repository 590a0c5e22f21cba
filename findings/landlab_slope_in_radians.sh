#!/usr/bin/env bash
# landlab 2.11.0: a slope that fails in three of four cases fails in one of a hundred.
#
# Expected: `calc_slope_at_node` returns the slope that the components of the same library take in the
#     field `topographic__slope`: rise over run.
# Seen: on a plane of 50 degrees it returns 0.873, the angle in radians, and the flow router 1.192, the
#     tangent.  `LandslideProbability` declares "tan theta" and takes any number: with 1.192 the
#     probability of failure is 0.77, with 0.873 it is 0.01 (5 kPa, 33 degrees, 1 m of soil).  The
#     factor of safety of the dry slope is 1.06 and 1.26.
# Meaning: a map of landslides from an elevation model is on the unsafe side just where it is
#     steep: 50 degrees count as 41, while 20 degrees are off by 0.8 only, so that gentle tests show
#     nothing.  Take the tangent of the values first, and print one known slope.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    landlab==2.11.0 requireit==0.6.0 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
from landlab import RasterModelGrid
from landlab.components import FlowAccumulator, LandslideProbability

STEEP, COHESION, FRICTION, DENSITY = np.radians(50), 5000.0, 33.0, 2000.0
SOIL = {
    "topographic__specific_contributing_area": 1.0, "soil__transmissivity": 20.0,
    "soil__saturated_hydraulic_conductivity": 20.0, "soil__thickness": 1.0,
    "soil__mode_total_cohesion": COHESION, "soil__minimum_total_cohesion": COHESION - 10,
    "soil__maximum_total_cohesion": COHESION + 10, "soil__density": DENSITY,
    "soil__internal_friction_angle": FRICTION,
}


def probability(slope):
    """Mean probability of failure with this value of the slope."""
    grid = RasterModelGrid((5, 5), xy_spacing=10.0)
    for name, value in {"topographic__slope": slope, **SOIL}.items():
        grid.add_full(name, value, at="node")
    component = LandslideProbability(
        grid, number_of_iterations=1000, groundwater__recharge_distribution="uniform",
        groundwater__recharge_min_value=0.01, groundwater__recharge_max_value=0.02, seed=1,
    )
    component.calculate_landslide_probability()
    return grid.at_node["landslide__probability_of_failure"][grid.core_nodes].mean()


def safety(angle):
    """Factor of safety of the dry infinite slope of 1 m."""
    cohesion = COHESION / (DENSITY * 9.81 * np.sin(angle) * np.cos(angle))
    return cohesion + np.tan(np.radians(FRICTION)) / np.tan(angle)


plane = RasterModelGrid((5, 5), xy_spacing=10.0)
plane.add_field("topographic__elevation", np.tan(STEEP) * plane.x_of_node, at="node")
slope = plane.calc_slope_at_node()[12]
FlowAccumulator(plane).run_one_step()
steepest = plane.at_node["topographic__steepest_slope"][12]
units = LandslideProbability.var_units("topographic__slope")
print(f"calc_slope_at_node {slope:.3f}, flow router {steepest:.3f}; the component takes {units!r}")
assert np.isclose(slope, STEEP) and np.isclose(steepest, np.tan(STEEP)) and units == "tan theta"
for value, seen in ((steepest, 0.77), (slope, 0.01)):
    found = probability(value)
    factor = safety(np.arctan(value))
    print(f"slope {value:.3f}: probability {found:.3f}, factor of safety {factor:.2f}")
    assert abs(found - seen) < 0.04
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
