#!/usr/bin/env bash
# liquepy 0.6.34: ground that liquefies from 2 m down has the severity number 0.5, which means no damage.
#
# Expected: the volumetric strains of `calc_volumetric_strain_zhang_2002` can be given to `calc_lsn`, its
#     neighbour in `liquepy.trigger`, as those of the shear strains can be given to `calc_ldi`.
# Seen: clean sand with 6 MPa, water at 2 m, 0.3 g and a magnitude of 7.5: factors of safety of 0.4 to
#     0.6.  `calc_lsn` has 0.46, and 1000 times the integral of strain over depth (Tonkin and Taylor,
#     2013) is 46.3.  The strains are decimal, as documented, and the number wants percent, as documented
#     further down.  `calc_ldi` takes the decimal shear strains of the same group and returns metres.  The
#     index LPI is 34, "very high".  No message: 2.65 percent and 0.0265 are both plausible.
# Meaning: below 10 the number stands for little to no damage, above 40 for severe damage, and any ground
#     is below 1 if a factor of 100 is missing.  Ranking of sites stays the same, so a map does not show
#     it.  Multiply by 100, and compare with a second index.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    liquepy==0.6.34 numpy==2.3.1 scipy==1.16.3 pandas==2.3.3
cat > run.py <<'PY'
import liquepy
import numpy as np

depth = np.arange(0.1, 12, 0.1)
pore = np.clip((depth - 2) * 9.8, 0, None)
cone = liquepy.field.CPT(depth, np.full_like(depth, 6000.0), np.full_like(depth, 30.0), pore, 2.0)
result = liquepy.trigger.run_bi2014(cone, pga=0.3, m_w=7.5, gwl=2.0)
factors = result.factor_of_safety
strains = liquepy.trigger.calc_volumetric_strain_zhang_2002(factors, result.q_c1n_cs)
right = 1000 * np.trapezoid(strains / depth, depth)
found, percent = (liquepy.trigger.calc_lsn(scale * strains, depth) for scale in (1, 100))
index = liquepy.trigger.calc_lpi(factors, depth)
shear = liquepy.trigger.calc_shear_strain_zhang_2004(factors, np.full_like(depth, 0.5))
print(
    f"factors of safety below the water {factors[25:].min():.2f} to {factors[25:].max():.2f}, LPI {index:.1f}"
)
print(f"largest volumetric strain {strains.max():.4f}, largest shear strain {shear.max():.3f}")
print(
    f"severity number {found:.3f}, from percent {percent:.1f}, 1000 x integral of strain / depth {right:.1f}"
)
assert 0.3 < factors[25:].min() and factors[25:].max() < 0.7 and 33 < index < 36
assert 0.02 < strains.max() < 0.06 and 0.1 < shear.max() < 0.6
assert abs(found - 0.456) < 0.005 and abs(right - 46.3) < 0.5
assert abs(percent / right - 1) < 0.02
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
