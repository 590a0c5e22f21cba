#!/usr/bin/env bash
# geofound 1.1.4: a square raft rocks with damping about one axis, and with none about the other.
#
# Expected: `damping.calc_rot_via_pais_1988` has one damping ratio for both axes of a square, and its
#     vertical one does not depend on which side of a raft is called length.
# Seen: a square of 2 m at the surface has the ratio 0.0142 about one axis and 2e-17 about the other at a0
#     = 0.5, and 0.0954 and 2e-16 at a0 = 1.  For 4 m x 2 m the weaker axis has 0.0133, and the stronger
#     one 2e-17, where the formula of Pais and Kausel (1988) has 0.0559.  The stiffness in N m is divided
#     by a bracket that has the stiffness, too, so the result has the unit 1 / (N m).  Vertically 4 m x 2
#     m has the ratio 0.411 and 2 m x 4 m 0.196, for the same raft; half of the first side stands for the
#     long one.  An embedded square has one value for both axes.  No message.
# Meaning: a structure on a raft at the surface has no radiation damping in rocking along the raft, so
#     that response spectra and histories are too high in that direction alone, which looks like an effect
#     of its shape.  Give the longer side as the length, and compare both axes of a square.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    geofound==1.1.4 sfsimodels==0.9.46 numpy==2.3.1
cat > run.py <<'PY'
import sfsimodels
from geofound.damping import pais_1988

soil = sfsimodels.Soil()
soil.g_mod, soil.poissons_ratio, soil.unit_dry_weight = 30e6, 0.3, 18e3


def raft(length, width, depth=0.0):
    """Rigid raft."""
    made = sfsimodels.RaftFoundation()
    made.length, made.width, made.depth, made.height = length, width, depth, depth or 0.1
    return made


def rocking(made, a0):
    """Damping ratios of rocking along the length and along the width."""
    return [
        float(pais_1988.calc_rot_via_pais_1988(soil, made, ip_axis=axis, a0=a0))
        for axis in ("length", "width")
    ]


def right(ratio, a0):
    """Damping ratio of rocking along the longer side, after Pais and Kausel (1988), for Poisson's ratio 0.3."""
    wave, stiffness = (2 * 0.7 / 0.4) ** 0.5, (3.73 * ratio**2.4 + 0.27) / 0.7
    dynamic = 1 - 0.55 * a0**2 / (0.6 + 1.4 / ratio**3 + a0**2)
    return (
        4
        * wave
        / 3
        * ratio**3
        * a0**2
        / (stiffness * (1.8 / (1 + 1.75 * (ratio - 1)) + a0**2))
        * a0
        / 2
        / dynamic
    )


for a0, seen in ((0.5, 0.01417), (1.0, 0.09545)):
    along, across = rocking(raft(2.0, 2.0), a0)
    print(f"2 m x 2 m, a0 = {a0}: {along:.2g} and {across:.4g}, right {right(1.0, a0):.4g}")
    assert 0 < along < 1e-14 and abs(across - seen) < 1e-5 and abs(right(1.0, a0) - across) < 1e-9
along, across = rocking(raft(4.0, 2.0), 0.5)
print(f"4 m x 2 m, a0 = 0.5: along {along:.2g}, right {right(2.0, 0.5):.4g}; across {across:.4g}")
assert 0 < along < 1e-14 and abs(right(2.0, 0.5) - 0.0559) < 1e-4 and abs(across - 0.01335) < 1e-5
along, across = rocking(raft(2.0, 2.0, depth=1.0), 0.5)
print(f"2 m x 2 m, 1 m deep, a0 = 0.5: {along:.4g} and {across:.4g}")
assert abs(along - across) < 1e-12 and along > 0.01
first, second = (
    float(pais_1988.calc_vert_via_pais_1988(soil, raft(*sides), a0=0.5)) for sides in ((4.0, 2.0), (2.0, 4.0))
)
print(f"vertical, a0 = 0.5: 4 m x 2 m {first:.4f}, 2 m x 4 m {second:.4f}")
assert abs(first - 0.4112) < 1e-4 and abs(second - 0.1958) < 1e-4
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
