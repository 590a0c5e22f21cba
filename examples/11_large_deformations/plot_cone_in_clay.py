r"""
A cone pushed into clay
=======================

A smooth cone of 120 degrees, a spudcan without a shaft, is pushed into weightless clay of the
undrained strength :math:`s_u`. The clay flows aside and heaves, with new meshes on the way. Bodies
that are rigid up to yield have no length of their own, so that the force grows with the square of
the penetration, :math:`F = C s_u w^2`.

The force is compared with slip lines in the ground as it is deformed. The same lines give the exact
5.69 of a smooth circular footing on flat ground (Eason and Shield 1960).
"""

import json
import sys
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from into_clay import force_of, losses_of, model_of, pushed, sizes, stages_of, surface_of
from numpy.polynomial import Polynomial

import skfem_contact as sc
import skfem_contact.plot as plot

su = 1.0
numbers = [float(given) for given in sys.argv[1:] if not given.startswith("-")]
h = numbers[0] if numbers else 0.08
gamma = np.radians(30.0)  # angle of the cone's face from the horizontal
wide, deep = 6.0, 5.0
WAY = 0.025  # of a stage
N = 12  # stages
size = sizes(h, 0.2, 0.9)


def build(mesh):
    """Return the model of the clay, in axial symmetry; the cone stays and the bottom moves up."""
    clay = sc.Tresca(E=500.0 * su, nu=0.49, c=su)
    cone = sc.rigid.polyline([(3.0, 3.0 * np.tan(gamma)), (0.0, 0.0), (-0.5, 0.5 * np.tan(gamma))])
    contact = sc.Coulomb(), 3, 5000.0 * su
    return model_of(mesh, clay, cone, *contact, coordinates="axisymmetric")


# %%
# The run makes a new mesh after every fifth stage and continues by itself.

began = process_time()
result = pushed(build, size, wide, deep, WAY, N)
seconds = process_time() - began
stages = stages_of(result)
w = WAY * np.arange(1, N + 1)
force = 2.0 * np.pi * np.array([force_of(stage) for stage in stages])
C = force / (su * w**2)


# %%
# Slip lines: with the hoop stress equal to the smaller compression in the plane (Haar and von
# Karman), the mean pressure p and the direction psi of the larger one obey, along both lines,
#
# .. math::
#
#     dp \pm 2 s_u \, d\psi + \frac{s_u}{r} (dr \pm dz) = 0
#     \quad \text{along} \quad \frac{dz}{dr} = \tan(\psi \pm \pi / 4) .
#
# They start at the free surface, :math:`p = s_u` and psi along it, turn round the rim of the
# contact, and end at the cone, normal to which psi is.


def crossing(plus, minus):
    """Return r, z, p, psi where a plus line from one point meets a minus line from another."""
    (r1, z1, p1, psi1), (r2, z2, p2, psi2) = plus, minus
    psi = 0.5 * (psi1 + psi2)
    for _ in range(12):
        a = 0.5 * (psi1 + psi) + np.pi / 4
        b = 0.5 * (psi2 + psi) - np.pi / 4
        length = ((r2 - r1) * np.sin(b) - (z2 - z1) * np.cos(b)) / np.sin(b - a)
        r = r1 + length * np.cos(a)
        z = z1 + length * np.sin(a)
        # Both equations by differences from the two points
        first = p1 + 2 * su * psi1 - 2 * su / (r + r1) * (r - r1 + z - z1)
        second = p2 - 2 * su * psi2 - 2 * su / (r + r2) * (r - r2 - z + z2)
        psi = (first - second) / (4 * su)
    return r, z, 0.5 * (first + second), psi


def at_face(plus, rim, angle):
    """Return r, z, p, psi where a plus line from a point meets the face through the rim."""
    r1, z1, p1, psi1 = plus
    psi = angle - np.pi / 2
    a = 0.5 * (psi1 + psi) + np.pi / 4
    slope = np.tan(angle)
    length = (rim[1] + (r1 - rim[0]) * slope - z1) / (np.sin(a) - slope * np.cos(a))
    r = r1 + length * np.cos(a)
    z = z1 + length * np.sin(a)
    p = p1 + 2 * su * (psi1 - psi) - 2 * su / (r + r1) * (r - r1 + z - z1)
    return r, z, p, psi


def slip_line_force(a, angle, surface, n=60):
    """Return the force on a smooth face of some angle, with a rim at r = a, below a surface."""
    # Turn round the rim from the surface to the face
    rim = (a, surface(a))
    slope = surface.deriv()
    fan = np.linspace(np.arctan(slope(a)), angle - np.pi / 2, n // 2)
    line = [(*rim, su + 2 * su * (fan[0] - psi), psi) for psi in fan]
    face = [line[-1]]
    # Each point of the surface begins a plus line, which crosses the minus lines of the last one
    for r in a * (1.0 + 1.6 / n * np.arange(1, 2 * n)):
        new = [(r, surface(r), su, np.arctan(slope(r)))]
        for minus in line:
            new.append(crossing(new[-1], minus))
        end = at_face(new[-1], rim, angle)
        if end[0] < 0.02 * a:
            break
        new.append(end)
        face.append(end)
        line = new
    # Integrate p + su over the area seen from above
    r, _, p, _ = np.array(face[::-1]).T
    inside = np.pi * r[0] ** 2 * (p[0] + su)
    return inside + 2.0 * np.pi * np.trapezoid((p + su) * r, r)


flat = slip_line_force(1.0, 0.0, Polynomial([0.0])) / (np.pi * su)
print(f"smooth circular footing by slip lines: {flat:.3f}, exact 5.693")
assert abs(flat / 5.693 - 1.0) < 2e-3

# %%
# The free surface beside the cone is a cubic through the points that do not touch, and its
# intersection with the face is the rim.


def deformed_surface(stage):
    """Return the radius of the rim and the free surface as a polynomial."""
    r, z = surface_of(stage)
    rim = r[z - r * np.tan(gamma) > -0.01 * h].max()
    outside = (r > rim) & (r < 1.5 * rim)
    surface = Polynomial.fit(r[outside], z[outside], 3).convert()
    roots = (surface - Polynomial([0.0, np.tan(gamma)])).roots()
    real = roots[np.abs(roots.imag) < 1e-9].real
    return real[np.argmin(np.abs(real - rim))], surface


errors = []
for k in (7, 9, 11):
    a, surface = deformed_surface(stages[k])
    expected = slip_line_force(a, gamma, surface)
    errors.append(force[k] / expected - 1.0)
    rim = a * np.tan(gamma) / w[k]
    print(f"w = {w[k]:.2f}: F / (su w^2) = {C[k]:.2f}, {errors[-1]:+.1%} off; rim at {rim:.2f} w")

fig, (left, right) = plt.subplots(1, 2, figsize=(9, 3.5))
left.plot(w, C, "o-", ms=3)
left.set_xlabel("penetration w")
left.set_ylabel("F / (su w²)")
r = np.linspace(a, 2.0 * a, 50)
right.plot(r, surface(r), "k-", label="surface")
right.plot([0.0, a], [0.0, a * np.tan(gamma)], "r-", label="cone")
right.axhline(w[-1], color="0.7", label="surface before")
right.set_aspect("equal")
right.legend()
plt.show()

# %%
plot.contour(stages[-1], "mises")

lost = losses_of(result)
print(f"largest loss at a new mesh: volume {lost[0]:.1e}, stress {lost[1]:.1e}")
assert np.abs(errors).max() < 0.025
assert np.abs(C[8:] / C[8:].mean() - 1.0).max() < 0.02
assert lost[0] < 1e-4
assert lost[1] < 1e-3
print(
    json.dumps(
        {
            "case": "cone_in_clay",
            "rows": [
                {
                    "method": "T6, new meshes",
                    "n": int(stages[-1].forms["clay"].basis.nelems),
                    "unknowns": int(stages[-1].forms["clay"].basis.N),
                    "error": float(np.abs(errors).max()),
                    "cpu_s": seconds,
                    "iterations": sum(sum(stage.iterations) for stage in stages),
                }
            ],
        }
    )
)
