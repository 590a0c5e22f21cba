r"""
Flow under a sheet pile wall
============================

Water stands higher by :math:`h` on one side of a wall that reaches down to the depth :math:`s` in a
layer of the thickness :math:`T`. With :math:`m = \sin(\pi s / 2 T)` and the complete elliptic
integrals :math:`K(m)` and
:math:`K'(m) = K(\sqrt{1 - m^2})` the discharge and the exit gradient, at the wall where the water
leaves, are

.. math:: q = k h \, \frac{K'}{2 K}, \qquad i = \frac{h}{T} \, \frac{\pi}{4 K m}

(M. E. Harr, Groundwater and Seepage, 1962, ch. 3 and 4). The flow is confined, and the problem
linear. The difficulty is the toe, at which the velocity is infinite.
"""

import json
import sys
import time

import matplotlib.pyplot as plt
import numpy as np
from scipy.special import ellipk
from skfem import Basis, ElementQuad1, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

THICKNESS, WIDTH, DROP, K = 1.0, 3.0, 1.0, 1.0

# %%
# Two bodies and a joint
# ----------------------
# The ground on both sides is meshed by itself; below the toe a joint lets the water through. There
# is no wall to be meshed: where there is no joint, there is no flow. The elements shrink towards
# the toe.


def ground(n: int, toe: float):
    """Ground on both sides of the wall, about 2.4 n² nodes."""
    x = WIDTH * np.linspace(0, 1, n + 1) ** 3
    rows = np.linspace(0, 1, int(0.6 * n) + 1) ** 2
    y = np.append(-toe - (THICKNESS - toe) * rows[::-1], -toe * (1 - rows[1:]))
    left, right = MeshQuad.init_tensor(-x[::-1], y), MeshQuad.init_tensor(x, y)
    mesh = sc.join_bodies({"left": left.with_defaults(), "right": right.with_defaults()})

    def below(name):
        facets = mesh.boundaries[name]
        return facets[mesh.p[1, mesh.facets[:, facets]].mean(axis=0) < -toe]

    return mesh.with_boundaries(
        {"left|right": below("left:right"), "right|left": below("right:left")}
    )


def exact(toe: float) -> tuple[float, float]:
    """Discharge and exit gradient."""
    m = np.sin(np.pi * toe / 2 / THICKNESS)
    return K * DROP * ellipk(1 - m * m) / ellipk(m * m) / 2, DROP / THICKNESS * np.pi / 4 / ellipk(
        m * m
    ) / m


rows = []


def flow(n: int, toe: float) -> sc.water.Seepage:
    """The flow, and its row of the table."""
    began = time.process_time()
    basis = Basis(ground(n, toe), ElementQuad1())
    water = sc.water.Flow(
        basis, K, unit_weight=9.81, connected=[("left|right", "right|left")]
    ).steady(sc.water.Conditions(head={"left:top": DROP, "right:top": 0.0}))
    q, (nodes, flux) = water.discharge("left:top"), water.flux("right:top")
    gradient = -flux[basis.mesh.p[0, nodes].argmin()] / K
    rows.append(
        {
            "method": f"Q1, s/T = {toe / THICKNESS:g}",
            "n": n,
            "unknowns": len(water.head),
            "error": abs(q / exact(toe)[0] - 1),
            "gradient error": abs(gradient / exact(toe)[1] - 1),
            "cpu_s": round(time.process_time() - began, 2),
            "iterations": sum(water.iterations),
        }
    )
    print(
        f"s/T = {toe:.1f}, {len(water.head):5d} unknowns: q / kh = {q:.5f}, exact "
        f"{exact(toe)[0]:.5f}; exit gradient {gradient:.4f}, exact {exact(toe)[1]:.4f}"
    )
    assert abs(1 + water.discharge("right:top") / q) < 1e-8
    return water


# %%
# Refinement at s/T = 0.5, where q / kh = 0.5, and other depths of the wall
# -------------------------------------------------------------------------

SIZES = (12, 24, 34, 68) if "--full" in sys.argv else (12, 24, 34)
flows = {n: flow(n, 0.5) for n in SIZES}
errors = [row["error"] for row in rows]
assert errors == sorted(errors, reverse=True)
for toe in (0.2, 0.4, 0.6, 0.8):
    flow(34, toe)
for row in rows:
    if row["n"] >= 34:
        assert row["unknowns"] <= 3300 or "--full" in sys.argv
        assert row["error"] < 2.5e-3 and row["gradient error"] < 0.02

# %%
# The flow net
# ------------

figure, net = plt.subplots(figsize=(9, 4), layout="constrained")
plot.flow_diagram(flows[34], ax=net)
net.plot([0, 0], [-0.5, 0.05], color="black", linewidth=3)
net.set(xlim=(-1.5, 1.5), xlabel="x / T", ylabel="y / T", title="head over h")

# %%
# How discharge and exit gradient converge:

figure, work = plt.subplots(figsize=(6, 4), layout="constrained")
work.loglog([r["unknowns"] for r in rows[: len(SIZES)]], errors, "o-", label="discharge")
work.loglog(
    [r["unknowns"] for r in rows[: len(SIZES)]],
    [r["gradient error"] for r in rows[: len(SIZES)]],
    "s-",
    label="exit gradient",
)
work.set(xlabel="unknowns", ylabel="error", title="s / T = 0.5")
work.legend(frameon=False)
plt.show()

print(json.dumps({"case": "sheet pile flow", "rows": rows}))
