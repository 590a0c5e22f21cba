r"""
Drainage of a column of sand
============================

A column of Del Monte sand, 1 m high, is flushed with water until its pressure is zero everywhere.
Then its top is closed, and the water drains at its bottom (A. C. Liakopoulos 1965). Air enters from
the top, and the suction compresses the sand. B. A. Schrefler and Zhan Xiaoyong (1993) gave the
curves of its saturation S and its relative permeability for a suction s,

.. math:: S = 1 - 1.9722 \cdot 10^{-11} s^{2.4279} , \qquad k_r = 1 - 2.207\, (1 - S)^{0.9529}
   \qquad \text{(Pa)},

and elastic ground for the column.
:class:`PoreWater <skfem_contact.PoreWater>` with a retention is compared with a plain script of
finite volumes. ``error`` is that of the pressures, over the largest suction of 9.81 kPa.
"""

import json
import time

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import solve_ivp
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc

E, NU, POROSITY, K, WATER = 1.3e6, 0.4, 0.2975, 4.41e-6, 9810.0  # N, m, s
MINUTES = [5, 10, 20, 30, 60, 120]

# %%
# The curves
# ----------
# A retention law of one's own has a saturation and a relative permeability, each with its slope
# over the suction head.


def saturation(s):
    """Saturation and its slope by a suction in Pa."""
    return 1 - 1.9722e-11 * s**2.4279, -1.9722e-11 * 2.4279 * s**1.4279


def permeability(s):
    """Relative permeability and its slope by a suction in Pa."""
    filled, slope = saturation(s)
    dry = np.maximum(1 - filled, 1e-12)
    return 1 - 2.207 * (1 - filled) ** 0.9529, 2.207 * 0.9529 * dry ** (0.9529 - 1) * slope


class Sand(sc.water.Retention):
    """Del Monte sand."""

    content = (0.0, POROSITY)

    def saturation(self, suction, size):
        """Return the saturation by a suction head."""
        filled, slope = saturation(WATER * np.maximum(suction, 0))
        return filled, WATER * slope

    def relative(self, suction, size):
        """Return the relative permeability by a suction head."""
        k, slope = permeability(WATER * np.maximum(suction, 0))
        return k, WATER * slope


# %%
# The column
# ----------
# The head at the start is the height: the pressure is zero, and the water flows down. Boundaries
# are tight, so that no water enters at the top any more.


def column(n):
    """Pressures at the heights by time, water that has left and settlement, with n elements over
    the height.
    """
    mesh = MeshTri.init_tensor(np.array([0.0, 0.1]), np.linspace(0, 1, n + 1)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    water = sc.PoreWater(basis, K, retention=Sand(), start=lambda x: x[1], unit_weight=WATER)
    forms = {"sand": sc.SolidForm(basis, sc.LinearElastic(E, NU)), "water": water}
    model = sc.Model(forms, [sc.box_supports(basis, base="rollers"), water.dofs("bottom")])
    lengths = np.diff(MINUTES, prepend=0)
    result = model.run(
        [
            sc.Stage(f"{end} min", duration=60.0 * length, increments=4)
            for end, length in zip(MINUTES, lengths, strict=True)
        ],
        progress=False,
    )
    left = np.flatnonzero(mesh.p[0] == 0)
    left = left[np.argsort(mesh.p[1, left])]
    p = np.array([stage.forms["water"].pressure(stage.x)[left] for stage in result])
    states = [stage.states["water"] for stage in result]
    out = np.array([-water.inflow(state, "bottom") for state in states]) / 0.1
    lost = max(abs(water.volume(state) - water.inflow(state, "bottom")) for state in states) / 0.1
    top = basis.get_dofs("top").all("u^2")
    down = np.array([-stage.x[top].mean() for stage in result])
    return (
        mesh.p[1, left],
        p,
        out,
        down,
        lost / out[-1],
        int(basis.N + mesh.nvertices),
        sum(sum(stage.iterations) for stage in result),
    )


# %%
# The plain script
# ----------------
# The stress above a point has lost the weight of the water there. Strain, saturation and flow of
# cells follow from their pressures, whose rates are found from the balance of the water.


def finite_volumes(n):
    """Heights and pressures of n cells by time, water that has left and settlement: the method of
    lines.
    """
    d, modulus = 1.0 / n, E * (1 - NU) / (1 + NU) / (1 - 2 * NU)
    z, above = (
        (np.arange(n) + 0.5) * d,
        WATER * POROSITY * d * (np.triu(np.ones((n, n))) - 0.5 * np.eye(n)),
    )

    def state(p):
        filled, slope = saturation(np.maximum(-p, 0))
        growth = (filled * p - above @ (filled - 1)) / modulus
        return filled, -slope, growth

    def flow(p):
        k = permeability(np.maximum(-np.append(0.0, p), 0))[0]
        slope = np.diff(p, prepend=0) / np.append(0.5 * d, np.full(n - 1, d))
        return np.append(-K / WATER * 0.5 * (k[1:] + k[:-1]) * (slope + WATER), 0.0)

    def rate(t, p):
        filled, slope, growth = state(p)
        capacity = (
            np.diag(slope * (POROSITY + growth) + filled * (filled + slope * p) / modulus)
            - filled[:, None] * above * slope / modulus
        )
        return np.linalg.solve(capacity, -np.diff(flow(p)) / d)

    done = solve_ivp(
        rate,
        (0, 60 * MINUTES[-1]),
        np.zeros(n),
        method="BDF",
        t_eval=60 * np.array(MINUTES),
        rtol=1e-5,
        atol=1e-2,
    )
    found = [state(p) for p in done.y.T]
    out = [d * np.sum(POROSITY - filled * (POROSITY + growth)) for filled, _, growth in found]
    return z, done.y.T, np.array(out), np.array([-d * growth.sum() for *_, growth in found])


z, p, out, down = finite_volumes(60)
rows = []
for n in (10, 20):
    began = time.process_time()
    y, found, left, settled, lost, unknowns, iterations = column(n)
    off = max(np.abs(np.interp(z, y, a) - b).max() for a, b in zip(found, p, strict=True))
    rows.append(
        {
            "method": "P2/P1",
            "n": n,
            "unknowns": unknowns,
            "error": float(off / WATER),
            "cpu_s": round(time.process_time() - began, 2),
            "iterations": iterations,
            "outflow error": float(np.abs(left / out - 1).max()),
            "settlement error": float(np.abs(settled / down - 1).max()),
        }
    )
    print(
        f"{n} elements: pressures {rows[-1]['error']:.2%}, outflow "
        f"{rows[-1]['outflow error']:.2%}, settlement "
        f"{rows[-1]['settlement error']:.2%}, water lost {lost:.0e}"
    )
    assert lost < 1e-8
assert (
    rows[-1]["error"] < 0.01
    and rows[-1]["outflow error"] < 0.01
    and rows[-1]["settlement error"] < 0.01
)

figure, (ax, below) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
for i, minutes in enumerate(MINUTES):
    (line,) = ax.plot(found[i] / 1e3, y, label=f"{minutes} min")
    ax.plot(p[i, ::4] / 1e3, z[::4], "o", color=line.get_color(), markersize=3)
ax.set(xlabel="pressure of the water [kPa]", ylabel="height [m]")
ax.legend(frameon=False)
below.plot(MINUTES, 1e3 * left, color="#1f4e8c", label="water that has left [mm]")
below.plot(MINUTES, 1e3 * out, "o", color="#1f4e8c")
below.plot(MINUTES, 100e3 * settled, color="#d55e00", label="settlement [mm / 100]")
below.plot(MINUTES, 100e3 * down, "o", color="#d55e00")
below.set(xlabel="time [min]")
below.legend(frameon=False)
plt.show()

print(json.dumps({"case": "drainage of a column of sand", "rows": rows}))
