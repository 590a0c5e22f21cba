r"""
A wedge pushed into clay
========================

A smooth wedge is pushed into clay of the undrained strength :math:`s_u` in plane strain. The clay
rises beside it to straight lips, and keeps its shape while it grows: Hill, Lee and Tupper (1947)
found the exact solution of rigid and perfectly plastic bodies. With the wedge's semi-angle
:math:`\theta` its slip lines turn by the angle :math:`\psi` between face and lip,

.. math::

    \cos(2 \theta - \psi) = \frac{\cos \psi}{1 + \sin \psi} ,
    \qquad h = \frac{w}{\cos \theta - \sin(\theta - \psi)} ,
    \qquad F = 4 s_u (1 + \psi) \, h \sin \theta ,

with the penetration w and the length h of the contact on each face. The lip is as long as h, at the
angle :math:`\theta - \psi` to the surface before.
"""

import json
import sys
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from into_clay import force_of, losses_of, model_of, pushed, sizes, stages_of, surface_of
from scipy.optimize import brentq

import skfem_contact as sc
import skfem_contact.plot as plot

su = 1.0
numbers = [float(given) for given in sys.argv[1:] if not given.startswith("-")]
h = numbers[0] if numbers else 0.1
theta = np.radians(70.0)
wide, deep = 5.0, 4.0
WAY = 0.04  # of a stage
N = 8  # stages
size = sizes(h, 0.2, 1.0)


def build(mesh):
    """Return the model of a half of the clay; the wedge stays and the bottom moves up."""
    clay = sc.Tresca(E=2000.0 * su, nu=0.49, c=su)
    end = 4.0 * np.array([np.sin(theta), np.cos(theta)])
    wedge = sc.rigid.polyline([end, (0.0, 0.0), (-end[0], end[1])])
    return model_of(mesh, clay, wedge, sc.Coulomb(), 3, 20_000.0 * su)


# %%
# The run makes a new mesh after every fifth stage and continues by itself.

began = process_time()
result = pushed(build, size, wide, deep, WAY, N)
seconds = process_time() - began
stages = stages_of(result)

# %%
# The exact solution, and the surface as it was found.


def slip_lines_differ(psi):
    """Return the difference of the two sides of the equation for the angle psi."""
    return np.cos(2.0 * theta - psi) - np.cos(psi) / (1.0 + np.sin(psi))


psi = brentq(slip_lines_differ, 0.0, theta)
w = WAY * np.arange(1, N + 1)
length = w / (np.cos(theta) - np.sin(theta - psi))
exact = 4.0 * su * (1.0 + psi) * length * np.sin(theta)
force = 2.0 * np.array([force_of(stage) for stage in stages])
errors = force / exact - 1.0
x, z = surface_of(stages[-1])
lip = z.max() / (length[-1] * np.cos(theta)) - 1.0
for k in (3, 5, 7):
    print(f"w = {w[k]:.2f}: F / (su w) = {force[k] / (su * w[k]):.2f}, {errors[k]:+.1%} off")
print(f"the lip is {z.max() / w[-1]:.3f} w above the apex, {lip:+.1%} off")

fig, (left, right) = plt.subplots(1, 2, figsize=(9, 3.5))
left.plot(w, exact / su, "k-", label="Hill, Lee and Tupper 1947")
left.plot(w, force / su, "o", ms=3, label="computed")
left.set_xlabel("penetration w")
left.set_ylabel("F / su")
left.legend()
tip = length[-1] * np.array([np.sin(theta), np.cos(theta)])
foot = tip[0] + length[-1] * np.cos(theta - psi)
right.plot([0.0, tip[0], foot, 1.3 * foot], [0.0, tip[1], w[-1], w[-1]], "k-", label="exact")
right.plot(x[x < 1.3 * foot], z[x < 1.3 * foot], "o", ms=3, label="computed")
right.set_aspect("equal")
right.legend()
plt.show()

# %%
# A contact ends within an element, here a 14th of its length, and few elements are too stiff: on
# the exact shape of a wedge of 45 degrees, 10, 20 and 40 of them on a face give 7, 4 and 2 % too
# much.

plot.contour(stages[-1], "mises")

lost = losses_of(result)
print(f"largest loss at a new mesh: volume {lost[0]:.1e}, stress {lost[1]:.1e}")
assert np.abs(errors[3:]).max() < 0.05
assert abs(lip) < 0.01
assert lost[0] < 1e-4
assert lost[1] < 1e-3
print(
    json.dumps(
        {
            "case": "wedge_in_clay",
            "rows": [
                {
                    "method": "T6, new meshes",
                    "n": int(stages[-1].forms["clay"].basis.nelems),
                    "unknowns": int(stages[-1].forms["clay"].basis.N),
                    "error": float(np.abs(errors[3:]).max()),
                    "cpu_s": seconds,
                    "iterations": sum(sum(stage.iterations) for stage in stages),
                }
            ],
        }
    )
)
