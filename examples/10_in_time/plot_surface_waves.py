r"""
Surface waves of a blow, by explicit steps
==========================================

A short blow on the surface sends waves into the ground. Waves of pressure run ahead, shear waves
follow, and most of the energy stays at the surface as a Rayleigh wave. For :math:`\nu = 1/4` its
velocity is 0.9194 of the velocity of shear waves (Lamb 1904). The events are short and the waves
are as short as a few elements: explicit steps need no system of equations.
"""

# %%
# Model
# -----
# Half of the ground, with the axis of symmetry at the left. Waves leave through dashpots at the
# bottom and at the right. There is no weight on the way: the ground is at rest before the blow.

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

width, depth, h = 60.0, 30.0, 0.5
c_s, density, nu = 100.0, 2.0, 0.25
E = 2 * density * c_s**2 * (1 + nu)

x = np.arange(0, width + h / 2, h)
y = np.arange(-depth, h / 2, h)
basis = Basis(MeshQuad.init_tensor(x, y).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
ground = sc.SolidForm(basis, sc.LinearElastic(E=E, nu=nu), unit_weight=9.81 * density)
forms = {
    "ground": ground,
    "bottom": sc.ViscousBoundary(ground, "bottom"),
    "right": sc.ViscousBoundary(ground, "right"),
}
model = sc.Model(forms, sc.box_supports(basis), gravity_acceleration=9.81)

# %%
# Blow
# ----
# The stage holds the axis of symmetry alone. Steps are 0.9 of the longest stable one, which a wave
# of pressure needs for an element.

axis = basis.get_dofs("left").all("u^1")
push = np.asarray(sc.traction(basis, "top", lambda x: (0 * x[0], -50.0 * (x[0] < 2))))


def blow(t):
    """Return the load of a pulse of about 0.08 s."""
    return push * np.exp(-(((t - 0.05) / 0.02) ** 2))


stations = [(20.0, 0.0), (40.0, 0.0)]
settings = sc.Dynamic(explicit=True, points=stations)
stage = sc.Stage("blow", blow, duration=0.55, dynamic=settings, fixed=axis, keep=40)
result = model.run([sc.Stage("gravity"), stage])
waves = result["blow"]
print(f"{len(waves.iterations)} steps")

# %%
# Displacements since the blow began, when the surface wave has passed the first station.

plot.contour(waves.increments[2], "u", since=result["gravity"])

# %%
# Surface wave
# ------------
# The lag between two stations gives the velocity of the wave.

near, far = (waves.history(point, "velocity") for point in stations)
fig, ax = plt.subplots(figsize=(7, 4), layout="constrained")
for motion, (distance, _) in ((near, stations[0]), (far, stations[1])):
    ax.plot(motion.time, motion.values[:, 1], label=f"{distance:.0f} m")
ax.set(xlabel="time [s]", ylabel="vertical velocity (m/s)")
ax.legend(frameon=False)


def passes(motion):
    """Return the time of the largest downward velocity, by a parabola."""
    v = motion.values[:, 1]
    k = np.argmin(v)
    a, b, c = v[k - 1 : k + 2]
    return motion.time[k] + 0.5 * (a - c) / (a - 2 * b + c) * (motion.time[1] - motion.time[0])


velocity = 20.0 / (passes(far) - passes(near))
print(f"velocity of the surface wave {velocity:.2f} m/s, exact {0.9194 * c_s:.2f} m/s")

# sphinx_gallery_start_ignore
import json

error = abs(velocity / (0.9194 * c_s) - 1)
assert error < 0.02, velocity
print(
    json.dumps(
        {
            "case": "surface_waves",
            "rows": [
                {
                    "method": "explicit",
                    "n": int(width / h),
                    "unknowns": int(basis.N),
                    "error": float(error),
                    "cpu_s": None,
                    "iterations": len(waves.iterations),
                }
            ],
        }
    )
)
# sphinx_gallery_end_ignore
