r"""
A tube of rubber under pressure
===============================

A thick tube of rubber is blown up until its inner radius has doubled. The pressure follows the
wall: it acts on the present area, normal to it. For an incompressible neo-Hookean tube

.. math::

    p = \int_a^b \mu \left(l^2 - l^{-2}\right) \frac{dr}{r}, \qquad l = \frac{r}{R},

with the present radii a and b. The largest pressure is never reached by a thin tube: here the wall
is as thick as the radius.
"""

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import quad
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

A, B, mu = 1.0, 2.0, 1.0
radii, angles = np.linspace(A, B, 9), np.linspace(0.0, np.pi / 2.0, 25)
grid = MeshQuad.init_tensor(radii, angles).with_defaults()
points = np.array([grid.p[0] * np.cos(grid.p[1]), grid.p[0] * np.sin(grid.p[1])])
mesh = MeshQuad(points, grid.t, _boundaries=grid.boundaries)
basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)

rubber = sc.NeoHooke(E=3.0 * mu, nu=0.4999)
tube = sc.SolidForm(basis, rubber, "f_bar", kinematics="finite")
air = sc.Pressure(tube, "left")
symmetry = [basis.get_dofs("bottom").all("u^2"), basis.get_dofs("top").all("u^1")]
model = sc.Model({"tube": tube, "air": air}, np.concatenate(symmetry))

# %%
# The load of a pressure comes from the form of the model. The last pressure is that of a doubled
# radius.


def exact(a):
    """Pressure of an inner radius."""
    b = np.sqrt(a**2 + B**2 - A**2)

    def share(r):
        square = r**2 / (r**2 - a**2 + A**2)
        return mu * (square - 1.0 / square) / r

    return quad(share, a, b)[0]


start = process_time()
pressures = exact(2.0 * A) * np.linspace(0.0, 1.0, 9)[1:]
stages = [sc.Stage(f"p = {p:.2f}", model.forms["air"].load(p)) for p in pressures]
result = model.run(stages)
seconds = process_time() - start

inner = basis.get_dofs("left").all("u^1")
wall = inner[np.argmax(basis.doflocs[0, inner])]
found = np.array([A + stage.x[wall] for stage in result])
curve = np.linspace(A, 2.2 * A, 40)

fig, ax = plt.subplots()
ax.plot(curve, [exact(a) for a in curve], "k-", lw=0.8, label="incompressible")
ax.plot(found, pressures, "o", label="computed")
ax.set_xlabel("inner radius")
ax.set_ylabel("pressure")
ax.legend()
plt.show()

# %%
# Cauchy stresses along x.

plot.contour(result[-1], "sxx")

errors = np.array([exact(a) for a in found]) / pressures - 1.0
error = float(np.abs(errors).max())
print(f"inner radius {found[-1]:.4f}, exact {2.0 * A}; largest error of a pressure {error:.2%}")
assert error < 0.005
print(
    json.dumps(
        {
            "case": "rubber_tube",
            "rows": [
                {
                    "method": "Q1, F-bar",
                    "n": 192,
                    "unknowns": int(basis.N),
                    "error": error,
                    "cpu_s": seconds,
                    "iterations": sum(sum(stage.iterations) for stage in result),
                }
            ],
        }
    )
)
