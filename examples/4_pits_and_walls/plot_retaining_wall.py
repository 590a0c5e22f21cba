r"""
Earth pressure on a retaining wall, active and passive
======================================================

A concrete wall holds 6 m of sand. It is moved away from the sand until that slides after it, which
takes the earth pressure down to the *active* one, or against the sand until a wedge is pushed up:
the *passive* pressure. Wall and sand are bodies of their own with a contact pair between them; the
friction angle of the pair is the angle of wall friction :math:`\delta`.

For a smooth wall Rankine's coefficients :math:`\tan^2(45° \mp \varphi/2)` are exact. For a rough
one limit analysis brackets the coefficient of the horizontal thrust: Lancellotta's stress field
from below, Coulomb's wedge from above.

The sand is there from the beginning, so the analysis starts from the pressure at rest by the K0
procedure, which gives the contact its tractions too.
"""

# sphinx_gallery_thumbnail_number = 2

import json
import logging
import sys
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuadS2, ElementVector, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("kN", "m")

logging.getLogger("skfem_contact").setLevel(
    logging.ERROR
)  # increments that are cut are expected: the sand slides
HEIGHT, BELOW, LENGTH, THICK, WEIGHT, PHI, K0 = 6.0, 3.0, 30.0, 0.5, 18.0, 30.0, 0.5
SAND = sc.MohrCoulomb(
    E=1e6, nu=0.3, c=0.02, phi=PHI, psi=PHI
)  # associated, as the brackets suppose
CONCRETE = sc.LinearElastic(E=3e7, nu=0.2)

# coefficients of the horizontal thrust: angle of wall friction, side, bracket
RANKINE = {"active": 1 / 3, "passive": 3.0}
BRACKETS = {
    (20.0, "active"): (0.2794, 0.2852),
    (20.0, "passive"): (4.633, 5.737),
    (30.0, "passive"): (5.026, 8.743),
}
MOVE = {"active": -0.0005, "passive": 0.01}  # enough for the stiff sand to slide

# %%
# Mesh
# ----
# Eight-node elements with 2 x 2 integration points, which do not lock; smaller ones towards the toe
# of the wall, where the slip surface begins. Below the toe the sand is held aside.


def graded(n, ratio):
    """Points from 0 to 1 with growing distances."""
    return np.expm1(ratio * np.linspace(0, 1, n + 1)) / np.expm1(ratio)


def wall_and_sand(n):
    """Basis of both bodies."""
    heights = HEIGHT * graded(n, 2.5)
    depths = -BELOW * graded(n // 2, 2.5)[:0:-1]
    sand = MeshQuad.init_tensor(
        LENGTH * graded(2 * n, 4.5), np.append(depths, heights)
    ).with_boundaries(
        {
            "face": lambda x: (x[0] < 1e-9) & (x[1] > 0),
            "below": lambda x: (x[0] < 1e-9) & (x[1] < 0),
            "base": lambda x: x[1] < 1e-9 - BELOW,
            "far": lambda x: x[0] > LENGTH - 1e-9,
        }
    )
    wall = MeshQuad.init_tensor([-THICK, -THICK / 2, 0], heights).with_boundaries(
        {
            "face": lambda x: x[0] > -1e-9,
            "back": lambda x: x[0] < 1e-9 - THICK,
            "foot": lambda x: x[1] < 1e-9,
        }
    )
    return Basis(
        sc.join_bodies({"sand": sand, "wall": wall}), ElementVector(ElementQuadS2()), intorder=3
    )


# %%
# Stages
# ------
# The point of the sand at the toe is held aside like all below; when the wall moves it is let go
# (``fixed`` of the stage), and its reaction is released. The wall is moved by its back.


def analyse(n, delta, side, steps=1):
    """Forms, result, and the coefficients of the thrust at the end of the stages."""
    basis = wall_and_sand(n)
    law = sc.Coulomb(mu=np.tan(np.radians(delta)))
    forms = {
        "sand": sc.SolidForm(basis.with_elements("sand"), SAND),
        "wall": sc.SolidForm(basis.with_elements("wall"), CONCRETE),
        "joint": sc.ContactPair(basis, "sand:face", "wall:face", law, quadrature=2),
    }
    below, back = basis.get_dofs("sand:below").all("u^1"), basis.get_dofs("wall:back").all("u^1")
    toe = below[np.argmax(basis.doflocs[1, below])]
    fixed = np.concatenate(
        (
            below,
            basis.get_dofs("sand:base").all(),
            basis.get_dofs("sand:far").all("u^1"),
            back,
            basis.get_dofs({"wall:back", "wall:foot"}).all("u^2"),
        )
    )
    load = sc.weight(basis, WEIGHT)
    start = sc.Model(forms, fixed).k0_state(load, unit_weights=WEIGHT, K0=K0, name="at rest")
    assert start["at rest"].residual < 1e-12
    stages = []
    for k in range(steps):
        moved = basis.zeros()
        moved[back] = MOVE[side] * ((k + 1) / steps) ** 2
        released = np.setdiff1d(fixed, toe) if k == 0 else None
        stages.append(sc.Stage(f"{side} {k + 1}", load, moved, increments=2, fixed=released))
    newton = sc.Newton(tolerance=1e-6)
    result = sc.Model(forms, fixed, newton=newton).run(stages, start=start)
    return forms, result, [thrust(forms, stage) / (0.5 * WEIGHT * HEIGHT**2) for stage in result]


def thrust(forms, stage):
    """Horizontal force between sand and wall."""
    joint = stage.tractions("joint")
    return float((joint.weight * joint.pressure).sum())


# %%
# Coefficients
# ------------
# Strength is overestimated by any mesh: passive thrusts are too large, active ones too small, in
# proportion to the size of the elements. The last column extrapolates to none. The ``error`` of a
# rough wall is the distance to its bracket.

sizes = (4, 8, 12) if "--full" in sys.argv else (4, 8)
cases = {(0.0, side): (value, value) for side, value in RANKINE.items()} | BRACKETS
rows = []
for (delta, side), (low, high) in cases.items():
    found = []
    for n in sizes:
        begin = process_time()
        _, result, coefficients = analyse(n, delta, side)
        assert abs(coefficients[0] - K0) < 1e-9
        found.append(coefficients[-1])
        error = max(0.0, low / found[-1] - 1, found[-1] / high - 1)
        rows.append(
            {
                "method": f"{side}, wall friction {delta:g}",
                "n": n,
                "unknowns": len(result[-1].x),
                "error": error,
                "cpu_s": round(process_time() - begin, 2),
                "iterations": sum(sum(s.iterations) for s in result),
                "coefficient": found[-1],
            }
        )
    extrapolated = found[-1] + (found[-1] - found[-2]) * sizes[-2] / (sizes[-1] - sizes[-2])
    bracket = f"exact {low:.4f}" if low == high else f"bracket [{low:.4f}, {high:.4f}]"
    print(
        f"{side:7} {delta:2g}°: {', '.join(f'{k:.4f}' for k in found)} -> {extrapolated:.4f}, "
        f"{bracket}"
    )
    assert 0.97 * low < extrapolated < 1.03 * high
    if side == "passive":
        assert found[-2] > found[-1] > low
    else:
        assert found[-2] < found[-1] < high

# %%
# From rest to both sides
# -----------------------
# The thrust on a wall with a friction angle of 20°. The active state needs next to no movement.

fig, (curve, pressure) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
depth, states = np.linspace(0, HEIGHT, 2), {}
for side, color in (("active", "#1f4e8c"), ("passive", "#d55e00")):
    forms, result, coefficients = analyse(6, 20.0, side, steps=4)
    states[side] = forms, result
    moved = [0.0] + [1e3 * MOVE[side] * ((k + 1) / 4) ** 2 for k in range(4)]
    curve.plot(moved, coefficients, "o-", color=color, label=side, markersize=4)
    joint = result[-1].tractions("joint")
    pressure.plot(joint.pressure, HEIGHT - joint.y, "o", color=color, markersize=3.5, label=side)
    mean = sum(BRACKETS[20.0, side]) / 2
    pressure.plot(mean * WEIGHT * depth, depth, color=color, linewidth=1)
rest = result["at rest"].tractions("joint")
pressure.plot(rest.pressure, HEIGHT - rest.y, "s", color="#777777", markersize=3, label="at rest")
curve.set(
    xlabel="movement of the wall against the sand [mm]",
    ylabel="coefficient of the thrust",
    ylim=(0, None),
)
pressure.set(xlabel="contact pressure [kPa]", ylabel="depth [m]", ylim=(HEIGHT, 0), xlim=(0, 700))
for ax in (curve, pressure):
    ax.grid(color="#dddddd", linewidth=0.6)
    ax.legend(frameon=False)
np.testing.assert_allclose(rest.pressure, K0 * WEIGHT * (HEIGHT - rest.y), atol=1e-9)

# %%
# The passive wedge: plastic strains in the sand.

forms, result = states["passive"]
# sphinx_gallery_thumbnail_number = 2
plot.contour(
    result[-1],
    "plastic",
    deformed=40.0,
    window=(-2, 18, -3, 8),
    colors="magma_r",
    limits=(0.0, 0.01),
)

# %%
# Figures
# -------

print(json.dumps({"case": "retaining_wall", "rows": rows}))
