r"""
Seepage through a dam
=====================

Water seeps through a dam with vertical faces on a tight base. Its free surface is not known
beforehand: it begins at the level of the reservoir and ends somewhere on the downstream face, where
water leaves at zero pressure above the tailwater. Nevertheless the discharge is known exactly (I.
A. Charny 1951),

.. math:: q = k \, \frac{h_1^2 - h_2^2}{2 L} ,

because the thrust of the water, :math:`\int p \, dy`, falls in proportion to the distance from the
reservoir.

``--full`` adds the finest mesh, ``error`` is the relative error of the discharge.
"""

import json
import sys
import time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad1, ElementTriP1, MeshQuad, MeshTri

import skfem_contact as sc
import skfem_contact.plot as plot

HEIGHT = 10.0
#: Levels of the reservoir and of the tailwater, and lengths of the dams.
CASES = {"tailwater": (10.0, 2.0, 5.0), "no tailwater": (10.0, 0.0, 10.0)}
FULL = "--full" in sys.argv
SIZES = (10, 20, 40, 80) if FULL else (10, 20, 40)

# %%
# The analysis
# ------------
# The head of a boundary is the level of the water that stands there; it holds below that level.
# Above the tailwater the downstream face is a seepage face: water may leave, but not enter.


def dam(kind, n: int, length: float):
    """Elements of one size, n over the height."""
    x, y = np.linspace(0, length, int(n * length / HEIGHT) + 1), np.linspace(0, HEIGHT, n + 1)
    return kind.init_tensor(x, y).with_defaults()


def leak(mesh, up: float, down: float, k=1.0) -> sc.water.Seepage:
    """Flow from the left to the right."""
    element = ElementTriP1() if isinstance(mesh, MeshTri) else ElementQuad1()
    heads = {"left": up, "right": down} if down > 0 else {"left": up}
    return sc.water.Flow(Basis(mesh, element), k, unit_weight=9.81).steady(
        sc.water.Conditions(head=heads, seepage_face="right")
    )


rows = []
for name, (up, down, length) in CASES.items():
    exact = (up**2 - down**2) / 2 / length
    for kind in (MeshTri, MeshQuad):
        for n in SIZES:
            began = time.process_time()
            water = leak(dam(kind, n, length), up, down)
            q = water.discharge("left")
            rows.append(
                {
                    "method": f"{'P1' if kind is MeshTri else 'Q1'}, {name}",
                    "n": n,
                    "unknowns": len(water.head),
                    "error": abs(q / exact - 1),
                    "cpu_s": round(time.process_time() - began, 2),
                    "iterations": sum(water.iterations),
                    "lost": abs(1 + water.discharge("right") / q),
                }
            )
            print(
                f"{rows[-1]['method']:<18} n = {n:2d}  q = {q:.4f}, exact {exact:g} "
                f"({q / exact - 1:+.3%}), {rows[-1]['iterations']} iterations"
            )
            assert (
                rows[-1]["error"] < 1.5e-3
                and rows[-1]["iterations"] <= 40
                and rows[-1]["lost"] < 1e-8
            )

# %%
# Pressure, flow, and the free surface
# ------------------------------------
# Above the free surface the pores suck a little water from element to element: the permeability
# there is a thousandth.

water = leak(dam(MeshTri, 40, 5.0), 10.0, 2.0)
print(water)
plot.flow_diagram(water, "pressure")

# %%
# The thrust of the water falls along a straight line, here in a dam of 10 m with tailwater.

water = leak(dam(MeshTri, 40, 10.0), 10.0, 2.0)
x, y = np.linspace(0.1, 9.9, 50), (np.arange(2000) + 0.5) / 200
thrust = water.pressure_at(np.stack(np.broadcast_arrays(x[:, None], y))).mean(axis=1) * HEIGHT
exact = 9.81 / 2 * (100 - 9.6 * x)
print(f"largest error of the thrust: {np.abs(thrust / exact - 1).max():.2%}")
assert np.abs(thrust / exact - 1).max() < 0.01

# %%
# A core
# ------
# By the same argument zones side by side act in series:
# :math:`q = (h_1^2 - h_2^2) / (2 \sum L_i / k_i)`. The free surface falls inside the core, and the
# steeper the tighter it is.

n = 40 if FULL else 20
figure, axes = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
for ax, core in zip(axes, (0.1, 0.01), strict=True):
    began = time.process_time()
    mesh = dam(MeshTri, n, 10.0)
    mesh = mesh.with_subdomains(
        {"core": lambda x: abs(x[0] - 5) < 1, "shell": lambda x: abs(x[0] - 5) > 1}
    )
    water = leak(mesh, 10.0, 2.0, {"core": core, "shell": 1.0})
    exact = 48 / (8 + 2 / core)
    rows.append(
        {
            "method": f"P1, core {core:g} times as permeable",
            "n": n,
            "unknowns": len(water.head),
            "error": abs(water.discharge("left") / exact - 1),
            "cpu_s": round(time.process_time() - began, 2),
            "iterations": sum(water.iterations),
        }
    )
    print(rows[-1])
    assert rows[-1]["error"] < 5e-3
    plot.flow_diagram(water, "head", ax=ax)
    ax.axvspan(4, 6, color="0.5", alpha=0.3)
    ax.set_title(f"core {core:g} times as permeable")

# %%
# How the discharge converges, of the dams without a core:

figure, ax = plt.subplots(figsize=(6, 4), layout="constrained")
for case in (f"{element}, {name}" for name in CASES for element in ("P1", "Q1")):
    part = [row for row in rows if row["method"] == case]
    ax.loglog([row["n"] for row in part], [row["error"] for row in part], "o-", label=case)
ax.set(xlabel="elements over the height", ylabel="error of the discharge")
ax.legend(frameon=False)
plt.show()

print(json.dumps({"case": "dam", "rows": rows}))
