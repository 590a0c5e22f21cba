r"""
Wells
=====

A well pumps the discharge Q from a layer of the thickness b. In a confined layer the steady
drawdown between two radii is :math:`Q \ln(R / r) / 2 \pi k b` (G. Thiem 1906), and after the time t
it is

.. math:: s = \frac{Q}{4 \pi T} \, W\!\left(\frac{r^2 S}{4 T t}\right) , \qquad T = k b , \quad
          S = \gamma_w b \left( \frac{1}{M} + n \beta \right) ,

with the exponential integral W, the stiffness M of the ground without lateral strain, and the
storage of the water (C. V. Theis 1935). What recovers after the pump has stopped follows by
superposition. With a free surface the discharge is :math:`\pi k (h_2^2 - h_1^2) / \ln(R / r)` (J.
Dupuit), in spite of the seepage face above the level in the well. Below the surface of a half-space
a pump settles the ground above it in the course of time (J. R. Booker and J. P. Carter 1986).

``error`` is the largest relative error of the drawdown, of the discharge, or of the settlement.
"""

import json
import time

import matplotlib.pyplot as plt
import numpy as np
from scipy.special import exp1, j0
from skfem import Basis, ElementQuad1, ElementQuad2, ElementVector, MeshQuad

import skfem_contact as sc

K, WATER, PUMPED, THICK, WELL = 1e-4, 9.81, 0.01, 5.0, 0.1
PER_RADIAN = PUMPED / (2 * np.pi)


def layer(far, n, m=1, height=THICK):
    """Rings of elements that grow with the radius, between the well and the radius `far`."""
    mesh = MeshQuad.init_tensor(np.geomspace(WELL, far, n + 1), np.linspace(0, height, m + 1))
    return mesh.with_boundaries(
        {
            "screen": lambda x: x[0] < WELL * (1 + 1e-9),
            "far": lambda x: x[0] > far * (1 - 1e-9),
            "bottom": lambda x: x[1] == 0.0,
        }
    )


rows = []


def row(method, n, unknowns, error, began, limit):
    """Note and check the error of an analysis."""
    rows.append(
        {
            "method": method,
            "n": n,
            "unknowns": unknowns,
            "error": float(error),
            "cpu_s": round(time.process_time() - began, 2),
        }
    )
    print(f"{method:<24} n = {n:3d}  error {error:.1e}")
    assert error < limit


# %%
# Steady flow
# -----------
# The screen is a boundary with one unknown head. A well that falls dry is told.

for n in (25, 50, 100):
    began = time.process_time()
    flow = sc.water.Flow(
        Basis(layer(50.0, n), ElementQuad1()), K, unit_weight=WATER, coordinates="axisymmetric"
    ).steady(sc.water.Conditions(head={"far": 40.0}, wells={"screen": PER_RADIAN}))
    drawdown = 40.0 - flow.head[np.isclose(flow.basis.mesh.p[0], WELL)][0]
    exact = PER_RADIAN / (K * THICK) * np.log(50.0 / WELL)
    row("confined, steady", n, len(flow.head), abs(drawdown / exact - 1), began, 4 / n**2)

for n in (20, 40):
    began = time.process_time()
    basis = Basis(layer(20.0, 2 * n, n, 10.0), ElementQuad1())
    flow = sc.water.Flow(basis, K, unit_weight=WATER, coordinates="axisymmetric").steady(
        sc.water.Conditions(head={"far": 10.0, "screen": 4.0}, seepage_face="screen")
    )
    exact = K * (100 - 16) / 2 / np.log(20.0 / WELL)
    row("free surface", n, len(flow.head), abs(flow.discharge("far") / exact - 1), began, 2e-3)

# %%
# A pumping test
# --------------
# `Inflow` is a form that brings water, or takes it, at a rate: the pump runs for 20 hours, and
# stops. The ground does not strain sideways, and its cover is a constant load.

DAY, STIFFNESS, STORAGE = 7.2e4, 1e5, 2e-6
OBSERVED = (1.0, 5.0, 25.0)


def pumping_test(n, time_error):
    """Result of the pumping test on n rings."""
    basis = Basis(layer(4000.0, n), ElementVector(ElementQuad1()), intorder=2)
    pores = sc.PoreWater(basis, K, unit_weight=WATER, storage=STORAGE, time_error=time_error)
    forms = {
        "sand": sc.SolidForm(
            basis, sc.LinearElastic(E=STIFFNESS, nu=0.0), coordinates="axisymmetric"
        ),
        "water": pores,
        "pump": sc.water.Inflow(pores, {"screen": -PUMPED / (2 * np.pi * WELL * THICK)}),
    }
    fixed = [
        basis.get_dofs(elements=True).all("u^1"),
        basis.get_dofs("bottom").all("u^2"),
        pores.dofs("far"),
    ]
    times = np.geomspace(600.0, DAY, 9)
    stages = [
        sc.Stage(f"pump {i}", duration=float(step))
        for i, step in enumerate(np.diff(times, prepend=0.0))
    ]
    stages += [
        sc.Stage(f"rest {i}", duration=float(step), deactivate="pump" if i == 0 else ())
        for i, step in enumerate(np.diff(times, prepend=0.0))
    ]
    return sc.Model(forms, fixed).run(stages, progress=False)


def theis(r, t):
    """Drawdown after the time t of pumping."""
    T, S = K * THICK, WATER * THICK * (1 / STIFFNESS + STORAGE)
    return PUMPED / (4 * np.pi * T) * exp1(r**2 * S / (4 * T * t))


for n, time_error in ((60, 1e-3), (120, 1e-4)):
    began = time.process_time()
    result = pumping_test(n, time_error)
    water = result[-1].forms["water"]
    at = [np.abs(water.ground.mesh.p[0] - r).argmin() for r in OBSERVED]
    r = water.ground.mesh.p[0, at]
    t = np.array([stage.time for stage in result])
    drawdown = np.array([-water.pressure(stage.x)[at] / WATER for stage in result])
    after = np.maximum(t - DAY, 1e-30)[:, None]
    exact = theis(r, t[:, None]) - np.where(t[:, None] > DAY + 1.0, theis(r, after), 0.0)
    entered = water.inflow(result[-1].states["water"]) / (-PER_RADIAN * DAY) - 1
    error = np.abs(drawdown - exact).max(axis=0) / exact.max(axis=0)
    row(
        "pumping and recovery", n, len(result[-1].x), error.max(), began, 3e-3 if n == 120 else 1e-2
    )
    print(
        f"   {sum(len(stage.iterations) for stage in result)} steps, balance of the water "
        f"{entered:+.0e}"
    )
    assert abs(entered) < 1e-8

# %%
# Drawdown in the course of time
# ------------------------------

figure, ax = plt.subplots(figsize=(7, 4), layout="constrained")
for i, distance in enumerate(r):
    (line,) = ax.plot(t / 3600, exact[:, i], label=f"Theis, r = {distance:.1f} m")
    ax.plot(t / 3600, drawdown[:, i], "o", color=line.get_color(), ms=4)
ax.set(xlabel="time in hours", ylabel="drawdown")
ax.invert_yaxis()
ax.legend()

# %%
# A pump below the surface
# ------------------------
# A point at the depth h takes the discharge Q from a half-space with a drained surface. In the end
# the settlement of the surface is
# :math:`(1 - 2 \nu) \, Q \gamma_w h / (4 \pi k G \sqrt{r^2 + h^2})`. Until then it is an integral
# over wave numbers of an inverse Laplace transform. The sink is a source in two elements at the
# axis, and the mesh reaches to 1,000 h.

DEPTH, SINK, E, NU = 10.0, 0.5, 2e4, 0.25  # SINK: radius and half the height of the sink
G, M = E / 2 / (1 + NU), E * (1 - NU) / (1 + NU) / (1 - 2 * NU)
DIFFUSIVITY = K * M / WATER
TIMES = DEPTH**2 / DIFFUSIVITY * np.array([0.1, 0.3, 1.0, 3.0, 10.0, 100.0, 1e7])


def settlement(r, t, terms=20):
    """Settlement of the surface of a half-space with elastic ground, at a radius and a time."""
    x, weight = np.polynomial.legendre.leggauss(400)
    xi, weight = 20 / DEPTH * (x + 1), 20 / DEPTH * weight  # up to exp(-40)
    angle = np.arange(1, terms) * np.pi / terms  # J. Abate and P. P. Valkó 2004
    cot, first = 1 / np.tan(angle), 0.4 * terms
    contour = np.concatenate(([first], first * angle * (cot + 1j)))
    factors = np.concatenate(([0.5], 1 + 1j * angle * (1 + cot**2) - 1j * cot)) * np.exp(contour)
    s = (contour / t)[:, None]
    gamma = np.sqrt(xi**2 + s / DIFFUSIVITY)
    by_diffusion = 2 * DIFFUSIVITY / M / s**2 * (np.exp(-xi * DEPTH) - np.exp(-gamma * DEPTH))
    transformed = by_diffusion / (1 - 2 * G / M * xi * DIFFUSIVITY / s * (gamma - xi))
    in_time = 0.4 / t * (factors[:, None] * transformed).real.sum(axis=0)
    return PUMPED * WATER / (4 * np.pi * K) * float(weight @ (xi * in_time * j0(xi * r)))


def steady(r):
    """Settlement of the surface in the end."""
    return (1 - 2 * NU) * PUMPED * WATER * DEPTH / (4 * np.pi * K * G * np.hypot(r, DEPTH))


def half_space(n):
    """Mesh with n rings around the sink."""
    steps = np.geomspace(SINK, 1000.0 * DEPTH, n)
    up = steps[steps < 0.6 * DEPTH]
    above = np.linspace(up[-1], DEPTH, max(4, n // 6))[1:]
    mesh = MeshQuad.init_tensor(
        np.append(0.0, steps), np.concatenate((-steps[::-1], [0.0], up, above)) - DEPTH
    )
    mesh = mesh.with_boundaries(
        {
            "surface": lambda x: x[1] > -1e-9,
            "axis": lambda x: x[0] < 1e-9,
            "far": lambda x: (x[0] > steps[-1] - 1e-6) | (x[1] < -DEPTH - steps[-1] + 1e-6),
        }
    )
    return mesh.with_subdomains(
        {"sink": lambda x: (x[0] < steps[0]) & (abs(x[1] + DEPTH) < steps[0])}
    )


for n in (14, 28):
    began = time.process_time()
    basis = Basis(half_space(n), ElementVector(ElementQuad2()), intorder=4)
    pores = sc.PoreWater(basis, K, unit_weight=WATER)
    volume = 2 * np.pi * SINK**3
    forms = {
        "ground": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=NU), coordinates="axisymmetric"),
        "water": pores,
        "pump": sc.water.Inflow(pores, sources={"sink": -PUMPED / volume}),
    }
    fixed = [
        basis.get_dofs("axis").all("u^1"),
        basis.get_dofs("far").all(),
        pores.dofs("surface", "far"),
    ]
    stages = [
        sc.Stage(f"{i}", duration=float(step)) for i, step in enumerate(np.diff(TIMES, prepend=0.0))
    ]
    result = sc.Model(forms, fixed).run(stages, progress=False)
    dofs = basis.get_dofs("surface").all("u^2")
    r = basis.doflocs[0, dofs]
    above = dofs[r.argmin()]
    settled, exact = (
        -np.array([stage.x[above] for stage in result]),
        np.array([settlement(0.0, t) for t in TIMES]),
    )
    exact[-1] = steady(0.0)
    at = r < 2 * DEPTH
    after = -result[-1].x[dofs][at] / steady(r[at])
    error = max(np.abs(settled / exact - 1).max(), np.abs(after - 1).max())
    row("pump in a half-space", n, len(result[-1].x), error, began, 0.01 if n == 28 else 0.03)

assert abs(settlement(5.0, TIMES[-1]) / steady(5.0) - 1) < 1e-3
t = DEPTH**2 / DIFFUSIVITY * np.geomspace(0.05, 200.0, 40)
figure, ax = plt.subplots(figsize=(7, 4), layout="constrained")
ax.semilogx(t / 3600, [1e3 * settlement(0.0, each) for each in t], label="Booker and Carter")
ax.semilogx(TIMES[:-1] / 3600, 1e3 * settled[:-1], "o", ms=4, label=f"{n} rings")
ax.axhline(1e3 * steady(0.0), color="0.6", ls="--", label="in the end")
ax.set(xlabel="time in hours", ylabel="settlement above the pump in mm")
ax.invert_yaxis()
ax.legend()
plt.show()
print(json.dumps({"case": "well", "rows": rows}))
