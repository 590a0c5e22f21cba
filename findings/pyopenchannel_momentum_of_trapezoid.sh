#!/usr/bin/env bash
# pyopenchannel 0.6.0: the momentum of flow in a trapezoidal channel is 1.2 times as large in one place as in another.
#
# Expected: `FlowState.momentum` of `UniformFlow` is the momentum function Q^2/(g A) + A z, z the depth of the
#     centroid of the section below the water, as `MomentumEquation.momentum_function` of the same library has it.
# Seen: 6 m3/s at a slope of 0.001. Rectangle of 3 m: 5.57 m3 in both. Trapezoid of 2 m with sides of 1:2: 4.28 in
#     place of 3.60 m3. Triangle: 5.95 in place of 4.19 m3. Integration over the section agrees with the second.
# Meaning: `UniformFlow` takes half the depth as the depth of the centroid, which only a rectangle has; in a triangle
#     it is a third. The force on a weir, a sill or a bank, and the search of a conjugate depth by this value, err by
#     up to 40 %. Take `MomentumEquation.momentum_function`, with the depth and the discharge of the state.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pyopenchannel==0.6.0 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import pyopenchannel as channels

DISCHARGE, SLOPE, ROUGHNESS, GRAVITY = 6.0, 0.001, 0.025, 9.81


def by_integration(channel, depth):
    """Momentum function in m3 by integration of widths over the depth."""
    height = np.linspace(0.0, depth, 20001)
    width = np.array([channel.top_width(max(h, 1e-9)) for h in height])
    area = np.trapezoid(width, height)
    return DISCHARGE**2 / (GRAVITY * area) + np.trapezoid(width * (depth - height), height)


for channel, wrong in (
    (channels.RectangularChannel(3.0), 1.0),
    (channels.TrapezoidalChannel(2.0, 2.0), 1.188),
    (channels.TriangularChannel(1.5), 1.421),
):
    state = channels.UniformFlow(channel, SLOPE, ROUGHNESS).calculate_flow_state(DISCHARGE)
    function = channels.MomentumEquation.momentum_function(channel, state.depth, DISCHARGE)
    right = by_integration(channel, state.depth)
    print(f"{channel}: state {state.momentum:.3f} m3, function {function:.3f} m3, by integration {right:.3f} m3")
    assert abs(function / right - 1) < 1e-3 and abs(state.momentum / right - wrong) < 2e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
