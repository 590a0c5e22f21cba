#!/usr/bin/env bash
# pygmm 0.8.0: a magnitude of 6.5 at 30 km moves the rock of California by 6 cm/s, that of the east by 0.007 cm/s.
#
# Expected: `pgv` of every model is in cm/s, as its docstring says, and `pgd` in cm; a thousandfold difference between
#     two models for rock at the same distance is impossible.
# Seen: Vs30 of 760 m/s, 30 km. `AtkinsonBoore2006`: 0.0071 cm/s and 0.0019 cm, with a PGA of 0.157 g and a spectral
#     velocity of 12.9 cm/s at 0.5 s, that is 1800 times the peak velocity. `BooreStewartSeyhanAtkinson2014`: 6.1 cm/s
#     with 0.084 g, spectral velocity 1.4 times as large. Times 980.665 the first are 6.9 cm/s and 1.9 cm.
# Meaning: the model divides all of its rows by 980.665 to get g, also the rows of velocity and displacement, which
#     the paper has in cm/s and cm. Slides by Newmark's block, strains of tunnels and pipes (velocity over wave speed)
#     and liquefaction by intensity come out as zero. Multiply `pgv` and `pgd` of this model by 980.665.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pygmm==0.8.0 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import math

import pygmm

GRAVITY = 980.665  # cm/s2
SITE = {"mag": 6.5, "v_s30": 760.0, "mechanism": "SS"}


def amplification(model):
    """Spectral velocity at 0.5 s over the peak velocity."""
    acceleration = float(model.interp_spec_accels([0.5])[0]) * GRAVITY
    return acceleration * 0.5 / (2 * math.pi) / model.pgv


east = pygmm.AtkinsonBoore2006(pygmm.Scenario(dist_rup=30.0, **SITE))
west = pygmm.BooreStewartSeyhanAtkinson2014(pygmm.Scenario(dist_jb=30.0, region="california", **SITE))
for name, model in (("east", east), ("west", west)):
    print(f"{name}: PGA {model.pga:.3f} g, PGV {model.pgv:.4f} cm/s, spectral velocity {amplification(model):.1f} PGV")
print(f"east: {east.pgd:.4f} cm; times g: {east.pgv * GRAVITY:.2f} cm/s and {east.pgd * GRAVITY:.2f} cm")
assert abs(east.pgv - 0.00708) < 1e-4 and abs(east.pgd - 0.00194) < 1e-4
assert abs(west.pgv - 6.14) < 0.05 and 1 < amplification(west) < 3
assert amplification(east) > 1000 and 1 < amplification(east) / GRAVITY < 3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
