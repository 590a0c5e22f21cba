#!/usr/bin/env bash
# jaxlem 0.1.8: soft clay below an embankment raises the factor of safety, the lighter it is.
#
# Expected: the weight of a slice is that of its embankment part with `embankment_gamma` and of its clay part with
#     `clay_gamma`. The clay below the level of the toe is symmetrical about the centre of the circle, so that its
#     unit weight has no moment and the factor of safety does not depend on it.
# Seen: embankment of 4 m, 20 kN/m3; strengths of 20 and 25 kPa. Circle of 24 m radius: 1.74 with clay of 20 kN/m3,
#     right is 1.73; 2.07 with 14 kN/m3, right is 1.73. Radius 34 m: 1.72 and 2.19. Radius 11 m: 1.80 and 1.67, right
#     is 1.80. More slices give the same.
# Meaning: a slice has one unit weight, the one of the soil in which its centroid lies. Deep circles, which govern on
#     soft clay, weigh the embankment as clay and are unsafe by 20 to 27 % here; shallow ones weigh clay as fill. Use
#     the same unit weight for both, that of the embankment.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    --no-deps jaxlem==0.1.8 jax==0.4.38 jaxlib==0.4.38 jaxopt==0.8.5 jax-tqdm==0.3.1 jaxtyping==0.2.38 flax==0.8.5 \
    optax==0.2.4 chex==0.1.88 numpy==1.26.4 scipy==1.14.1 ml_dtypes==0.5.1 opt_einsum==3.4.0 tqdm==4.67.1 \
    absl-py==2.1.0 typing_extensions==4.12.2 toolz==1.0.0 wadler_lindig==0.1.3 matplotlib==3.10.0 contourpy==1.3.1 \
    cycler==0.12.1 fonttools==4.55.3 kiwisolver==1.4.8 packaging==24.2 pillow==11.1.0 pyparsing==3.2.1 \
    python-dateutil==2.9.0.post0 six==1.17.0 msgpack==1.1.0 etils==1.11.0 rich==13.9.4 pygments==2.19.1 \
    markdown-it-py==3.0.0 mdurl==0.1.2 pyyaml==6.0.2 orbax-checkpoint==0.6.4 tensorstore==0.1.71 nest-asyncio==1.6.0 \
    importlib_resources==6.5.2 zipp==3.21.0 protobuf==5.29.3 humanize==4.11.0
cat > run.py <<'PY'
import math

import jax.numpy as jnp
import numpy as np
from jaxlem.stability.stability import SlopeStability
from jaxlem.stability.stability_utils import FailureBox, StabilityConfig

HEIGHT, FILL, STRENGTHS = 4.0, 20.0, (20.0, 25.0)  # m, kN/m3, kPa of embankment and clay
KEEP = []  # models stay alive, since jax keeps compiled functions by the identity of their model


def by_library(circle, clay):
    """Factor of safety of a circle (x, z, radius) with 100 slices."""
    box = FailureBox((0.0, 1.0), (0.0, 1.0), (1.0, 2.0))
    config = StabilityConfig(
        failure_box=box, slope_height=HEIGHT, slope_length=8.0, crest_length=80.0, toe_length=60.0, clay_thickness=20.0,
        embankment_gamma=FILL, clay_gamma=clay, su_embankment=STRENGTHS[0],
    )
    KEEP.append(SlopeStability(config))
    return float(KEEP[-1].safety_factor_point(jnp.full(300, STRENGTHS[1]), jnp.array(circle)))


def by_integration(circle, clay):
    """The same by integration of weights over x and of strengths over the arc."""
    centre, level, radius = circle
    left, right = centre - math.sqrt(radius**2 - (HEIGHT - level) ** 2), centre + math.sqrt(radius**2 - level**2)
    x = np.linspace(left, right, 200001)
    top = np.interp(x, (80.0, 88.0), (HEIGHT, 0.0))
    base = level - np.sqrt(np.maximum(radius**2 - (x - centre) ** 2, 0.0))
    weight = FILL * np.maximum(top - np.maximum(base, 0.0), 0.0) + clay * np.maximum(np.minimum(top, 0.0) - base, 0.0)
    load = weight * (centre - x)
    driving = np.sum((load[1:] + load[:-1]) / 2 * np.diff(x))
    start, toe = math.asin((centre - left) / radius), math.acos(level / radius)
    resisting = radius**2 * (STRENGTHS[0] * (start - toe) + STRENGTHS[1] * 2 * toe)
    return resisting / driving


for circle, ratio in (((86.0, 12.0, 24.0), 1.193), ((86.0, 16.0, 34.0), 1.269), ((84.0, 8.0, 11.0), 0.925)):
    for clay in (20.0, 14.0):
        found, right = by_library(circle, clay), by_integration(circle, clay)
        print(f"radius {circle[2]} m, clay {clay} kN/m3: {found:.3f}, right {right:.3f}")
        assert abs(found / right - (1.0 if clay == FILL else ratio)) < 0.003
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
