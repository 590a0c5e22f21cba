r"""
Rain on a long slope
====================

Dry ground sucks, and suction makes it strong. Rain takes that away, and where it cannot leave,
water rises on the rock below: many shallow slides follow. The factor of safety of a slope of
infinite length is exact at every depth z, whatever the pressure of the water there (N. Lu and J.
Godt 2008; S is the effective saturation):

.. math:: F = \frac{\tan\varphi}{\tan\beta} + \frac{2 c}{\gamma z \sin 2\beta}
          - \frac{S\,u_w}{\gamma z} (\tan\beta + \cot\beta) \tan\varphi .

The flow is that of :meth:`Flow.in_time <skfem_contact.water.Flow.in_time>`, the factor
that of the strength reduction of a strip whose sides move alike. ``error`` is that of the factor.
"""

import json
import time
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from scipy.sparse import csr_matrix
from skfem import Basis, ElementQuad1, ElementQuad2, ElementVector, MeshQuad

import skfem_contact as sc

BETA, DEPTH, GAMMA, WATER = np.radians(30.0), 2.0, 18.0, 9.81
C, PHI = 3.0, 32.0
K, RAIN = 0.17, 0.05  # m/day
DAYS = [0.0, 4.0, 7.0, 7.5, 8.0, 8.5, 9.0, 9.5, 16.0]

# %%
# The water
# ---------
# On a long slope everything depends on the vertical depth z alone. The flow in it is that of a
# vertical column whose height, permeability and rain are :math:`\cos^2\beta` times as large. The
# rock is tight. When the ground is full the rain runs off.

turned = np.cos(BETA) ** 2
column = MeshQuad.init_tensor(
    np.array([0.0, 0.1]), np.linspace(0, DEPTH * turned, 81)
).with_defaults()
silt = sc.water.VanGenuchten(alpha=1.5, n=2.0, content=(0.05, 0.4))
flow = sc.water.Flow(
    Basis(column, ElementQuad1()), K * turned, unit_weight=WATER, retention=silt
).in_time(sc.water.Conditions(flux={"top": RAIN * turned}), times=DAYS, start=lambda x: x[1] - 2.0)
print(flow)
assert flow.balance_error < 1e-8
assert abs(flow.entered[1] / (4.0 * RAIN * turned * 0.1) - 1) < 1e-6  # nothing runs off at first


def pressure(water):
    """Pressure with the suction stress, as a function of the coordinates of the slope."""
    sucking = water.with_suction()
    return lambda x: sucking.pressure_at(
        np.array([np.full_like(x[0], 0.05), DEPTH * turned - depth(x) * turned])
    )


def depth(x):
    """Vertical depth below the surface of the slope."""
    return np.clip(DEPTH + x[0] * np.tan(BETA) - x[1], 0.0, DEPTH)


# %%
# The ground
# ----------
# Springs between the two sides of a strip, which are alike, make it a slope without ends.


@dataclass(frozen=True, eq=False)
class Ties(sc.Form):
    """Stiff springs between the sides."""

    matrix: csr_matrix

    def assemble(self, x, state):
        """Return the forces of the springs and their stiffness."""
        return sc.Response(self.matrix @ x, lambda: None, lambda: self.matrix)


grid = MeshQuad.init_tensor(np.array([0.0, 0.1]), np.linspace(0, DEPTH, 41)).with_defaults()
strip = MeshQuad(
    np.array([grid.p[0], grid.p[1] + np.tan(BETA) * grid.p[0]]), grid.t
).with_boundaries(grid.boundaries)
basis = Basis(strip, ElementVector(ElementQuad2()), intorder=4)
base = basis.get_dofs("bottom").all()
left, right = (np.setdiff1d(basis.get_dofs(side).all(), base) for side in ("left", "right"))
left, right = (dofs[np.lexsort((basis.doflocs[1, dofs], dofs % 2))] for dofs in (left, right))
pairs, one = np.arange(len(left)), np.ones(len(left))
apart = csr_matrix(
    (np.append(one, -one), (np.append(pairs, pairs), np.append(left, right))), (len(left), basis.N)
)
soil = sc.MohrCoulomb(E=2e4, nu=0.3, c=C, phi=PHI, psi=PHI)
model = sc.Model(
    {"ground": sc.SolidForm(basis, soil), "ties": Ties((1e5 * apart.T @ apart).tocsr())}, base
)

# %%
# Factor against time
# -------------------

z = np.linspace(0.02, 1.0, 2000) * DEPTH
rows, factors, exact = [], [], []
for day, water in zip(DAYS, flow, strict=True):
    began = time.process_time()
    u = pressure(water)
    found = model.strength_reduction(
        sc.weight(basis, GAMMA) + sc.water_load(basis, u),
        tolerance=2e-3,
        certify=False,
        progress=False,
    )
    tan = np.tan(np.radians(PHI))
    at = (
        tan / np.tan(BETA)
        + 2 * C / (GAMMA * z * np.sin(2 * BETA))
        - u(np.array([0 * z, DEPTH - z])) / (GAMMA * z) * (np.tan(BETA) + 1 / np.tan(BETA)) * tan
    )
    factors.append(found.factor)
    exact.append(at.min())
    rows.append(
        {
            "method": f"day {day:g}",
            "n": strip.nelements,
            "unknowns": int(basis.N),
            "error": abs(found.factor / exact[-1] - 1),
            "cpu_s": round(time.process_time() - began, 2),
            "iterations": found.iterations,
            "factor": round(found.factor, 4),
        }
    )
    print(
        f"day {day:4g}: F = {factors[-1]:.3f}, exact {exact[-1]:.3f} at the depth "
        f"{z[at.argmin()]:.2f} m"
    )
    assert rows[-1]["error"] < 0.01

# %%
# In the end the flow is parallel to the slope, and the factor that of text books.

full = 2 * C / (GAMMA * DEPTH * np.sin(2 * BETA)) + (1 - WATER / GAMMA) * tan / np.tan(BETA)
print(f"full: F = {full:.3f}")
assert abs(exact[-1] / full - 1) < 0.01

figure, (ax, below) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
ax.plot(DAYS, exact, color="0.6", label="exact")
ax.plot(DAYS, factors, "o", color="#1f4e8c", label="strength reduction")
ax.axhline(1.0, color="0.6", linewidth=0.8)
ax.axhline(full, color="#d55e00", linestyle="--", label="full, flow along the slope")
ax.set(xlabel="time [days]", ylabel="factor of safety")
ax.legend(frameon=False, loc="center left", fontsize="small")
for i in (0, 1, 4, 6, -1):
    below.plot(pressure(flow[i])(np.array([0 * z, DEPTH - z])), z, label=f"day {DAYS[i]:g}")
below.set(xlabel="suction stress, pore pressure [kPa]", ylabel="depth [m]")
below.invert_yaxis()
below.legend(frameon=False)
plt.show()

print(json.dumps({"case": "rain on a slope", "rows": rows}))
