r"""
Rain between ditches and above drains
=====================================

Rain of the intensity N seeps through a layer on a tight base to two ditches. Where the free surface
lies is not known beforehand, but one integral is, whatever its shape (N. K. Girinskii),

.. math:: \int_0^\infty \langle h - y \rangle \, dy = \frac{h_0^2}{2} + \frac{N}{2k} x (L - x) ,

and Dupuit's ellipse follows if the head does not change with the depth. For drains of radius r at
the depth D above the base, S. B. Hooghoudt replaced the layer below them by a thinner one of the
depth d and found the rise h of the table midway,

.. math:: N L^2 = 8 k d h + 4 k h^2 .

In deep ground the flow to flat drains is known exactly by the hodograph, with which J. J. van
Deemter (1950) and F. Engelund (1951) solved problems of this kind.

``error`` is that of the integral midway, or of the rise; Hooghoudt's formula is an approximation
itself.
"""

import json
import time

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq
from skfem import Basis, ElementQuad1, MeshQuad

import skfem_contact as sc

K, WATER = 1e-5, 9.81

# %%
# Ditches
# -------
# The rate of rain on a boundary is a `flux`. What the ground does not take would run off.

LENGTH, HEIGHT, LEVEL, RAIN = 40.0, 10.0, 3.0, 1e-6


def ditches(n):
    """Flow with n elements over the height."""
    mesh = MeshQuad.init_tensor(
        np.linspace(0, LENGTH, 2 * n + 1), np.linspace(0, HEIGHT, n + 1)
    ).with_defaults()
    levels = {"left": LEVEL, "right": LEVEL}
    return sc.water.Flow(Basis(mesh, ElementQuad1()), K, unit_weight=WATER).steady(
        sc.water.Conditions(head=levels, flux={"top": RAIN}, seepage_face=list(levels))
    )


def integral(water, x):
    """Integral of the pressure head over the depth."""
    y = np.linspace(0, HEIGHT, 4001)
    above = np.maximum(water.head_at(np.array([np.full_like(y, x), y])) - y, 0.0)
    return float(0.5 * np.sum((above[1:] + above[:-1]) * np.diff(y)))


rows = []
exact = 0.5 * LEVEL**2 + RAIN / K * LENGTH**2 / 8
for n in (10, 20, 40):
    began = time.process_time()
    water = ditches(n)
    error = integral(water, 0.5 * LENGTH) / exact - 1
    lost = water.discharge("left") / (-0.5 * RAIN * LENGTH) - 1
    rows.append(
        {
            "method": "ditches, Q1",
            "n": n,
            "unknowns": len(water.head),
            "error": abs(error),
            "cpu_s": round(time.process_time() - began, 2),
            "iterations": sum(water.iterations),
            "lost": abs(lost),
        }
    )
    print(f"ditches, {n} elements: integral {error:+.2%}, discharge {lost:+.1e}")
    assert rows[-1]["error"] < 1e-3 and rows[-1]["lost"] < 1e-8

# %%
# Drains
# ------
# One half of the spacing, with elements that grow away from the drain. A square of the side b
# drains as a pipe of the radius 0.59 b.

SPACING, DEPTH, SIDE, SHOWER = 20.0, 4.0, 0.2, 1e-7


def graded(ends, near, growth=1.25):
    """Coordinates from the drain to an end, each step larger than the one before."""
    steps = [near]
    while sum(steps) < abs(ends):
        steps.append(steps[-1] * growth)
    return np.sign(ends) * np.concatenate(([0.0], np.cumsum(steps) * abs(ends) / sum(steps)))


def drained(near):
    """Flow to a drain; `near` is the size of the elements beside it."""
    half = 0.5 * SIDE
    core = np.linspace(-half, half, round(SIDE / near) + 1)
    x = np.concatenate((core[core >= -1e-12], half + graded(0.5 * SPACING - half, near)[1:]))
    y = np.concatenate(
        (-half + graded(half - DEPTH, near)[:0:-1], core, half + graded(2.0 - half, near)[1:])
    )
    mesh = MeshQuad.init_tensor(x, y)
    middle = mesh.p[:, mesh.t].mean(axis=1)
    mesh = mesh.remove_elements(np.flatnonzero((middle[0] < half) & (abs(middle[1]) < half)))
    mesh = mesh.with_boundaries(
        {
            "drain": lambda p: (
                (p[0] < half + 1e-9)
                & (abs(p[1]) < half + 1e-9)
                & ((abs(abs(p[1]) - half) < 1e-9) | (abs(p[0] - half) < 1e-9))
            ),
            "top": lambda p: p[1] > 2.0 - 1e-9,
        }
    )
    return sc.water.Flow(Basis(mesh, ElementQuad1()), K, unit_weight=WATER).steady(
        sc.water.Conditions(head={"drain": 0.0}, flux={"top": SHOWER}, seepage_face="drain")
    )


def hooghoudt(radius):
    """Rise of the table midway; the depth of the thinner layer in closed form (van der Molen and
    Wesseling 1991).
    """
    odd = np.arange(1, 60, 2)
    decay = np.exp(-4 * np.pi * odd * DEPTH / SPACING)
    depth = (
        np.pi
        * SPACING
        / 8
        / (np.log(SPACING / np.pi / radius) + np.sum(4 * decay / (odd * (1 - decay))))
    )
    return float(-depth + np.sqrt(depth**2 + SHOWER * SPACING**2 / 4 / K))


rise = hooghoudt(0.59 * SIDE)
began = time.process_time()
flow = drained(0.05)
found = float(flow.head_at(np.array([[0.5 * SPACING], [0.0]]))[0])
rows.append(
    {
        "method": "drains, Q1",
        "n": int(SIDE / 0.05),
        "unknowns": len(flow.head),
        "error": abs(found / rise - 1),
        "cpu_s": round(time.process_time() - began, 2),
        "iterations": sum(flow.iterations),
    }
)
print(
    f"drains, {len(flow.head)} nodes: rise {found:.4f}, Hooghoudt {rise:.4f} "
    f"({found / rise - 1:+.1%}), "
    f"discharge {flow.discharge('drain') / (-0.5 * SHOWER * SPACING) - 1:+.1e}"
)
assert rows[-1]["error"] < 0.02

# %%
# Deep ground
# -----------
# A drain is flat and of the half width w, and water falls into it from both faces. With the
# potential
# :math:`\Omega = k h + i \psi` the functions :math:`\Omega + i k z` and :math:`\Omega + i N z` map
# the ground on half-strips of the widths k L / 2 and N L / 2. With r = N / k and s from e at the
# drain to 1 midway, the table is
#
# .. math:: x = \frac{L}{2} - \frac{L \arccos s}{2 \pi (1 - r)} , \qquad
#           y = \frac{r L}{2 \pi (1 - r)} \operatorname{arcosh} \frac{2 s + 1 - e}{1 + e} ,
#
# and e follows from w, the largest x on the drain.

RATIO, HALF_WIDTH = RAIN / K, 1.0


def edge(e):
    """Half width of the drain."""
    s = (e - RATIO**2) / (1 - RATIO**2)
    turned = np.arccos(s) - RATIO * np.arccos((2 * s + 1 - e) / (1 + e))
    return SPACING * (0.5 - turned / (2 * np.pi * (1 - RATIO)))


def table(e, s):
    """Coordinates of the table."""
    scale = 0.5 * SPACING / np.pi / (1 - RATIO)
    return 0.5 * SPACING - scale * np.arccos(s), RATIO * scale * np.arccosh(
        (2 * s + 1 - e) / (1 + e)
    )


def deep(near):
    """Flow to a flat drain in ground as deep as the spacing; `near` is the size of the elements
    beside its edge.
    """
    x = HALF_WIDTH + np.append(
        graded(-HALF_WIDTH, near)[:0:-1], graded(0.5 * SPACING - HALF_WIDTH, near, 1.06)
    )
    y = np.append(graded(-SPACING, near)[:0:-1], np.linspace(0.0, 1.8, round(1.8 / near) + 1))
    mesh = (
        MeshQuad.init_tensor(x, y)
        .with_defaults()
        .with_boundaries(
            {"drain": lambda p: (abs(p[1]) < 1e-9) & (p[0] < HALF_WIDTH)}, boundaries_only=False
        )
    )
    return sc.water.Flow(Basis(mesh, ElementQuad1()), K, unit_weight=WATER).steady(
        sc.water.Conditions(head={"drain": 0.0}, flux={"top": RAIN}, seepage_face="drain")
    )


start = brentq(lambda e: edge(e) - HALF_WIDTH, -0.9, 0.9)
highest = table(start, 1.0)[1]
for near in (0.2, 0.1):
    began = time.process_time()
    below = deep(near)
    found = max(
        line[np.isclose(line[:, 0], 0.5 * SPACING), 1].max(initial=0.0)
        for line in below.free_surface
    )
    rows.append(
        {
            "method": "deep ground, Q1",
            "n": int(HALF_WIDTH / near),
            "unknowns": len(below.head),
            "error": abs(found / highest - 1),
            "cpu_s": round(time.process_time() - began, 2),
            "iterations": sum(below.iterations),
        }
    )
    print(
        f"deep ground, {len(below.head)} nodes: rise {found:.4f}, exact {highest:.4f} "
        f"({found / highest - 1:+.2%}), "
        f"discharge {below.discharge('drain') / (-0.5 * RAIN * SPACING) - 1:+.1e}"
    )
    assert rows[-1]["error"] < 0.05 * near  # .80 % and .36 %: half as much with half the size

# %%
# The table between the ditches and above the drains
# --------------------------------------------------

figure, (left, right, last) = plt.subplots(1, 3, figsize=(12, 3.2), layout="constrained")
x = np.linspace(0, LENGTH, 101)
left.plot(x, np.sqrt(LEVEL**2 + RAIN / K * x * (LENGTH - x)), "k--", label="Dupuit's ellipse")
left.plot(*water.free_surface[0].T, "b", label="free surface")
left.set(xlabel="x", ylabel="height", title="ditches", ylim=(0, HEIGHT))
left.legend()
right.plot(*flow.free_surface[0].T, "b")
right.plot(0.5 * SPACING, rise, "ko", label="Hooghoudt")
right.plot([0, 0], [-0.5 * SIDE, 0.5 * SIDE], "r", lw=6, label="drain")
right.set(xlabel="x", title="half of the drains' spacing")
right.legend()
last.plot(*table(start, np.linspace(start, 1, 101)), "k--", label="exact")
last.plot(*below.free_surface[0].T, "b")
last.plot([0, HALF_WIDTH], [0, 0], "r", lw=4, label="drain")
last.set(xlabel="x", title="half of the spacing, deep ground")
last.legend()
plt.show()
print(json.dumps({"case": "drains", "rows": rows}))
