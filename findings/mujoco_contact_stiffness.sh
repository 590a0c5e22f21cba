#!/usr/bin/env bash
# mujoco 4.0.0: the settlement of a contact of 100 kN/m is the same under 1 kg and 10 tons.
#
# Expected: a contact whose `solref` is "-stiffness -damping", here -1e5 N/m and -1e3 Ns/m, settles by
#     weight over stiffness: 0.098 mm, 9.8 mm and 0.98 m under masses of 1, 100 and 10,000 kg.
# Seen: 0.011 mm under all three; the contact force is the right weight.  With solimp="0.5 0.5 0.001"
#     it is 0.049 mm under all three.  The number is an acceleration per length, and the part of the
#     gravity that the impedance of the contact leaves, 0.1 or 0.5, is divided by it.
# Meaning: the stiffness of a contact grows with the mass on it.  Stiffness that is taken from a plate
#     test or a subgrade modulus has no effect on settlements as expected, the shares of the loads of
#     a body on several supports come from other things, and a heavier load does not settle more.
#     Divide by the mass, and check one settlement by hand.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    mujoco==4.0.0 numpy==2.4.6
cat > run.py <<'PY'
import mujoco
import numpy as np

STIFFNESS, GRAVITY = 1e5, 9.81
SCENE = """<mujoco>
<option gravity="0 0 -9.81" timestep="0.0005"/>
<worldbody>
<geom type="plane" size="5 5 1" solref="-1e5 -1e3" solimp="{solimp}"/>
<body pos="0 0 0.5"><freejoint/>
<geom type="sphere" size="0.5" mass="{mass}" solref="-1e5 -1e3" solimp="{solimp}"/>
</body></worldbody></mujoco>"""


def rest(mass, solimp):
    """Settlement of a sphere at rest in m, and the contact force in N."""
    model = mujoco.MjModel.from_xml_string(SCENE.format(mass=mass, solimp=solimp))
    data = mujoco.MjData(model)
    while data.time < 5:
        mujoco.mj_step(model, data)
    force = np.zeros(6)
    mujoco.mj_contactForce(model, data, 0, force)
    assert abs(data.qvel[2]) < 1e-9
    return 0.5 - data.qpos[2], force[0]


for mass in (1, 100, 10_000):
    default, force = rest(mass, "0.9 0.95 0.001")
    half, _ = rest(mass, "0.5 0.5 0.001")
    right = mass * GRAVITY / STIFFNESS
    print(f"{mass} kg: {default * 1e3:.4f} mm and {half * 1e3:.4f} mm, right {right * 1e3:.4g} mm")
    assert abs(force / (mass * GRAVITY) - 1) < 1e-6
    assert abs(default - 1.093e-5) < 1e-7
    assert abs(half - 0.5 * GRAVITY / (0.5 * STIFFNESS) / 2) < 1e-7
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
