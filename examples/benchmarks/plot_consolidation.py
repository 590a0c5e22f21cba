r"""
Consolidation
=============

Ground that is loaded quickly carries the load by the pressure of its water first; as the water
leaves, it settles. Four problems have exact solutions by M. A. Biot's theory:

* **Terzaghi** (1923): a layer that drains at its top settles by
  :math:`U(T) = 1 - \sum 2 m^{-2} e^{-m^2 T}`,
  :math:`m = \pi/2, 3\pi/2, \ldots`;
* **Mandel** (1953): a block between rigid plates drains at its sides. Its pressure *rises* first,
  because the sides that have drained are softer and the middle takes over their load;
* **Cryer** (1963): so does that in a sphere under an outer pressure;
* **strip** on a layer of thickness 2a, width 2a: settlement of its middle by transforms of Fourier
  and Laplace.

Times are :math:`T = c_v t / H^2`. Steps in time are of second order and as long as their estimated
error allows.

A plain script of scikit-fem with equal steps of first order stands beside the strip. ``--full``
adds finer meshes, and ``--peers`` OpenGeoSys on the strip where it is installed (``pip install
ogs``). ``error`` is that of the settlement over the final one (Terzaghi), of the largest pressure
(Mandel, Cryer), and of the settlement (strip). Last comes what the water costs: the time to factor
the matrix of both, over that for the ground alone.
"""

import json
import sys
import time

import matplotlib.pyplot as plt
import numpy as np
import opengeosys
from one_program import version_of
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.sparse import bmat, csr_matrix, diags_array
from scipy.sparse.linalg import splu
from skfem import (
    Basis,
    BilinearForm,
    ElementQuad1,
    ElementQuad2,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
    MeshQuad,
    MeshTri,
    MeshTri2,
)
from skfem.helpers import ddot, div, dot, grad, sym_grad
from skfem.models.elasticity import lame_parameters, linear_stress

import skfem_contact as sc
from skfem_contact.solvers.direct import DirectSolver

FULL, PEERS = "--full" in sys.argv, "--peers" in sys.argv
E, K, Q = 1e4, 1e-2, 100.0  # stiffness, permeability over the unit weight of water, load
ELEMENTS = {
    "P2-P1": (MeshTri, ElementTriP2, 4),
    "Q2-Q1": (MeshQuad, ElementQuad2, 4),
    "Q1-Q1, stabilised": (MeshQuad, ElementQuad1, 2),
}

# %%
# The analysis
# ------------
# Water stands beside the solid; the pressures of drained boundaries are among the fixed dofs. A
# short stage puts the load on, others wait.


def consolidate(basis, nu, traction, fixed, drained, times, more=None, ramp=0.5, **measure):
    """Stages that end at times T, after a load that comes within a share of the first one."""
    forms = {
        "ground": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=nu), **measure),
        "water": sc.PoreWater(basis, permeability=K, unit_weight=1.0),
        **(more or {}),
    }
    load = sc.traction(forms["ground"], *traction)
    c_v = K * E * (1 - nu) / (1 + nu) / (1 - 2 * nu)
    # a load that grows in proportion within a short time acts like one at once in the middle of
    # that time
    whole = np.concatenate(([ramp * times[0]], np.asarray(times) + 0.5 * ramp * times[0]))
    stages = [
        sc.Stage(f"T = {T:.4g}" if k else "load", load, duration=d / c_v)
        for k, (T, d) in enumerate(zip(whole, np.diff(whole, prepend=0.0)))
    ]
    fixed = [fixed, forms["water"].dofs(drained)]
    result = sc.Model(forms, fixed).run(stages, progress=False)
    return (
        forms["water"],
        list(result)[1:],
        [iterations for stage in result for iterations in stage.iterations],
    )


def row(case, method, n, stages, began, error, steps, **more):
    """Figures of a run."""
    rows.append(
        {
            "method": f"{case}, {method}",
            "n": n,
            "unknowns": len(stages[-1].x),
            "error": error,
            "cpu_s": round(time.process_time() - began, 2),
            "steps": len(steps),
            "iterations": sum(steps),
            **more,
        }
    )
    print(
        f"{case:<9} {method:<18} n = {n:2d} {len(stages[-1].x):6d} unknowns {len(steps):4d} steps  "
        f"error {error:8.2e}"
    )


rows = []

# %%
# Terzaghi's layer
# ----------------
# The worst error of the settlement from T = 0.001 to 1, with 40 steps in all. The layer's elements
# are thinner towards the drain.


def degree(T):
    """Degree of consolidation."""
    m = np.pi * (np.arange(2000) + 0.5)
    return 1 - np.exp(-np.outer(T, m**2)) @ (2 / m**2)


times = np.geomspace(1e-3, 1.0, 32)
figure, ax = plt.subplots(figsize=(6, 3.6), layout="constrained")
for method, (kind, element, order) in ELEMENTS.items():
    began = time.process_time()
    mesh = kind.init_tensor(np.array([0.0, 0.1]), 1 - np.linspace(1, 0, 21) ** 1.8).with_defaults()
    basis = Basis(mesh, ElementVector(element()), intorder=order)
    water, stages, steps = consolidate(
        basis,
        0.2,
        ("top", (0, -Q)),
        sc.box_supports(basis, base="rollers"),
        "top",
        times,
        ramp=0.25,
        strain="b_bar" if element is ElementQuad1 else "full",
    )
    final = Q * 1.2 * 0.6 / (E * 0.8)
    U = np.array([-stage.x[basis.get_dofs("top").all("u^2")].mean() / final for stage in stages])
    last = stages[-1].states["water"]
    lost = abs(water.inflow(last, "top") / water.volume(last) - 1)
    row(
        "Terzaghi",
        method,
        20,
        stages,
        began,
        np.abs(U - degree(times)).max(),
        steps,
        water_lost=lost,
    )
    assert rows[-1]["error"] < 0.002 and len(steps) <= 45 and lost < 1e-8
    ax.semilogx(times, U, "o", ms=3, label=method)
ax.semilogx(times, degree(times), color="0.4", zorder=0, label="exact")
ax.set(title="Terzaghi", xlabel="T", ylabel="degree of consolidation")
ax.legend(frameon=False)

# %%
# The same layer cut in two at half its height by a joint that is open to water. Contact there
# carries the effective stress, and is so stiff that its closing is no settlement.

began = time.process_time()
heights = 1 - np.linspace(1, 0, 21) ** 1.8
cut = np.abs(heights - 0.5).argmin()
mesh = sc.join_bodies(
    {
        name: MeshTri.init_tensor(np.array([0.0, 0.1]), part).with_defaults()
        for name, part in (("low", heights[: cut + 1]), ("high", heights[cut:]))
    }
)
basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
joint = ("high:bottom", "low:top")
forms = {
    "ground": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.2)),
    "water": sc.PoreWater(basis, permeability=K, unit_weight=1.0, connected=[joint]),
    "joint": sc.ContactPair(basis, *joint, sc.Tied(), penalty=1e3 * E),
}
sides = basis.get_dofs(
    {f"{body}:{side}" for body in ("low", "high") for side in ("left", "right")}
).all("u^1")
fixed = [basis.get_dofs("low:bottom").all("u^2"), sides, forms["water"].dofs("high:top")]
load = sc.traction(basis, "high:top", (0, -Q))
whole = np.append(0.25 * times[0], times + 0.125 * times[0]) / (K * Q / final)
stages = [sc.Stage(f"{k}", load, duration=d) for k, d in enumerate(np.diff(whole, prepend=0.0))]
result = list(sc.Model(forms, fixed).run(stages, progress=False))
U = np.array(
    [-stage.x[basis.get_dofs("high:top").all("u^2")].mean() / final for stage in result[1:]]
)
row(
    "Terzaghi",
    "P2-P1, cut",
    20,
    result[1:],
    began,
    np.abs(U - degree(times)).max(),
    [k for stage in result for k in stage.iterations],
)
assert rows[-1]["error"] < 0.002

# %%
# A layer that becomes tighter
# ----------------------------
# The load compresses the layer by a tenth, its void ratio falls from 1 to .8, and its permeability
# to .4 of that at the start, see
# :class:`Permeability <skfem_contact.water.Permeability>`. A plain script of finite volumes is
# compared with it. With the permeability at the start half of the settlement has happened
# at T = .197.


def tighter(T, void_ratio, change, strain, n=200):
    """Degree of consolidation of n cells by the method of lines; times and pressures are
    relative.
    """
    rate, z = (
        np.log(10) * (1 + void_ratio) / change * strain,
        np.append(np.full(n - 1, 1 / n), 0.5 / n),
    )

    def by_time(t, p):
        k = np.exp(rate * (np.append(p, 0) - 1))
        flow = 0.5 * (k[1:] + k[:-1]) * np.diff(p, append=0) / z
        return n * np.diff(flow, prepend=0)

    return 1 - solve_ivp(
        by_time, (0, T[-1]), np.ones(n), method="BDF", t_eval=T, rtol=1e-6, atol=1e-7
    ).y.mean(axis=0)


began, times = time.process_time(), np.array([0.02, 0.05, 0.1, 0.197, 0.4, 0.8])
mesh = MeshTri.init_tensor(np.array([0.0, 0.1]), 1 - np.linspace(1, 0, 21) ** 1.8).with_defaults()
basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
forms = {
    "ground": sc.SolidForm(basis, sc.LinearElastic(E=10 * Q, nu=0.0)),
    "water": sc.PoreWater(basis, sc.water.Permeability(K, 1.0, 0.5), unit_weight=1.0),
}
load = sc.traction(basis, "top", (0, -Q))
stages = [
    sc.Stage(f"T = {T:g}", load, duration=d / (10 * Q * K))
    for T, d in zip(np.append(0.0, times), [1e-5, *np.diff(times, prepend=0.0)], strict=True)
]
fixed = [sc.box_supports(basis, base="rollers"), forms["water"].dofs("top")]
result = list(sc.Model(forms, fixed).run(stages, progress=False))
U = np.array([-stage.x[basis.get_dofs("top").all("u^2")].mean() / 0.1 for stage in result[1:]])
row(
    "Terzaghi",
    "tighter",
    20,
    result[1:],
    began,
    np.abs(U - tighter(times, 1.0, 0.5, 0.1)).max(),
    [k for stage in result for k in stage.iterations],
    half=float(U[3]),
)
assert rows[-1]["error"] < 0.002 and U[3] < 0.42

# %%
# Mandel's block
# --------------
# A quarter of the block. The plate is rigid: the nodes below it are tied by stiff springs, a form
# of its own.


def mandel(T, nu):
    """Pressure in the middle over that at first."""
    r = (1 - nu) / (0.5 - nu)
    a = np.array(
        [
            brentq(
                lambda a: np.sin(a) - r * a * np.cos(a),
                max(i * np.pi, 1e-3),
                (i + 0.5) * np.pi - 1e-12,
            )
            for i in range(100)
        ]
    )
    return np.exp(-np.outer(T, a**2)) @ (
        2 * np.sin(a) * (1 - np.cos(a)) / (a - np.sin(a) * np.cos(a))
    )


def plate(basis):
    """Springs between neighbouring nodes below the plate."""
    top = basis.get_dofs("top").all("u^2")
    top = top[np.argsort(basis.doflocs[0, top])]
    m = len(top) - 1
    data = 1e3 * np.sqrt(E) * np.repeat([-1.0, 1.0], m)
    D = csr_matrix((data, (np.tile(np.arange(m), 2), np.r_[top[:-1], top[1:]])), (m, basis.N))
    return {"plate": sc.MatrixForm(csr_matrix(D.T @ D))}


times = np.sort(np.append(np.geomspace(2e-3, 1.0, 40), 0.072))
figure, ax = plt.subplots(figsize=(6, 3.6), layout="constrained")
for method, n in (("P2-P1", 20), ("Q2-Q1", 20)) + ((("P2-P1", 40),) if FULL else ()):
    began = time.process_time()
    kind, element, order = ELEMENTS[method]
    mesh = kind.init_tensor(
        np.linspace(0, 1, n + 1), np.linspace(0, 0.5, n // 2 + 1)
    ).with_defaults()
    basis = Basis(mesh, ElementVector(element()), intorder=order)
    fixed = np.append(basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1"))
    water, stages, steps = consolidate(
        basis, 0.2, ("top", (0, -Q)), fixed, "right", times, more=plate(basis)
    )
    p = np.array([stage.forms["water"].pressure(stage.x)[0] / (Q / 2) for stage in stages])
    exact = mandel(times, 0.2)
    row(
        "Mandel",
        method,
        n,
        stages,
        began,
        abs(p.max() / exact.max() - 1),
        steps,
        peak=round(p.max(), 5),
    )
    assert rows[-1]["error"] < 2e-3 and abs(exact.max() - 1.1069) < 1e-4
    ax.semilogx(times, p, "o", ms=3, label=method)
ax.semilogx(times, exact, color="0.4", zorder=0, label="exact")
ax.set(title="Mandel", xlabel="T", ylabel="pressure in the middle")
ax.legend(frameon=False)

# %%
# Cryer's sphere
# --------------
# An eighth of it in axial symmetry, with curved elements at its surface.


def cryer(T, nu):
    """Pressure at the centre over that outside (A. Verruijt's series)."""
    eta = (1 - nu) / (1 - 2 * nu)
    f = lambda x: (1 - eta * x * x / 2) * np.sin(x) - x * np.cos(x)  # noqa: E731
    grid = np.linspace(1e-3, 300, 20000)
    x = np.array(
        [brentq(f, *grid[i : i + 2]) for i in np.flatnonzero(f(grid[1:]) * f(grid[:-1]) < 0)]
    )
    return np.exp(-np.outer(T, x**2)) @ (
        eta * (np.sin(x) - x) / (eta * x * np.cos(x) / 2 + (eta - 1) * np.sin(x))
    )


def ball(n):
    """A quarter of a disc, its outer sides curved."""
    disc = MeshTri.init_circle(n)
    disc = disc.restrict(np.flatnonzero((disc.p[:, disc.t].mean(axis=1) > 0).all(axis=0)))
    outer = disc.facets_satisfying(lambda x: x.min(axis=0) > 1e-9, boundaries_only=True)
    curved = MeshTri2.from_mesh(disc)
    points, middles = curved.doflocs.copy(), Basis(disc, ElementTriP2()).facet_dofs[0, outer]
    points[:, middles] /= np.hypot(*points[:, middles])
    return MeshTri2(points, curved.t).with_boundaries(
        {
            "axis": lambda x: x[0] < 1e-9,
            "base": lambda x: x[1] < 1e-9,
            "out": lambda x: x.min(axis=0) > 1e-9,
        }
    )


times = np.geomspace(5e-3, 0.3, 40)
figure, ax = plt.subplots(figsize=(6, 3.6), layout="constrained")
for n in (4, 5):
    began = time.process_time()
    basis = Basis(ball(n), ElementVector(ElementTriP2()), intorder=4)
    fixed = np.append(basis.get_dofs("base").all("u^2"), basis.get_dofs("axis").all("u^1"))
    inwards = ("out", lambda x: -Q * x / np.hypot(*x))
    water, stages, steps = consolidate(
        basis, 0.25, inwards, fixed, "out", times, coordinates="axisymmetric"
    )
    centre = np.hypot(*basis.mesh.p).argmin()
    p, exact = (
        np.array([stage.forms["water"].pressure(stage.x)[centre] / Q for stage in stages]),
        cryer(times, 0.25),
    )
    row(
        "Cryer",
        "P2-P1",
        2**n,
        stages,
        began,
        abs(p.max() / exact.max() - 1),
        steps,
        peak=round(p.max(), 5),
    )
    assert rows[-1]["error"] < (2e-3 if n == 5 else 4e-3) and abs(exact.max() - 1.3075) < 1e-3
ax.semilogx(times, p, "o", ms=3, label="P2-P1")
ax.semilogx(times, exact, color="0.4", zorder=0, label="exact")
ax.set(title="Cryer", xlabel="T", ylabel="pressure at the centre")
ax.legend(frameon=False)

# %%
# A strip on a layer
# ------------------
# Half of it, on a rough tight base; the surface drains. Exact values of :math:`G w / q a` for
# :math:`\nu` = 0.3.

EXACT = {0.01: 0.27642, 0.1: 0.32578, 1.0: 0.45461, 10.0: 0.54506}
WIDTH = 12.0


def strip(n):
    """Elements that grow away from the strip and downwards."""
    x = np.concatenate(
        (
            np.linspace(0, 1, n + 1)[:-1],
            np.linspace(1, 2, n + 1)[:-1],
            2 + (WIDTH - 2) * np.linspace(0, 1, 2 * n + 1) ** 1.5,
        )
    )
    y = -2 * (1 - np.linspace(0, 1, 2 * n + 1)) ** 1.4
    return (
        MeshTri.init_tensor(x, y)
        .with_defaults()
        .with_boundaries({"strip": lambda x: (x[1] > -1e-9) & (x[0] < 1)})
    )


def plain(basis, held, load, times, count):
    """Displacements at given times by equal steps of first order between them, each with one
    factor.
    """
    pressures = basis.with_element(ElementTriP1())
    stress = linear_stress(*lame_parameters(E, 0.3))
    A = BilinearForm(lambda u, v, w: ddot(stress(sym_grad(u)), sym_grad(v))).assemble(basis)
    C = BilinearForm(lambda p, v, w: -E * p * div(v)).assemble(pressures, basis)
    H = BilinearForm(lambda p, q, w: -(E**2) * K * dot(grad(p), grad(q))).assemble(pressures)
    held = np.append(held, basis.N + pressures.get_dofs("top").all())
    free = np.setdiff1d(np.arange(basis.N + pressures.N), held)
    x, right = np.zeros(basis.N + pressures.N), np.append(load, np.zeros(pressures.N))
    for step in np.diff(times, prepend=0.0) / count:
        factor = splu(bmat([[A, C], [C.T, step * H]], format="csc")[free][:, free].tocsc())
        for _ in range(count):
            right[basis.N :] = C.T @ x[: basis.N]
            x[free] = factor.solve(right[free])
        yield x[: basis.N].copy()


times = np.geomspace(0.01, 10.0, 19)
figure, ax = plt.subplots(figsize=(6, 3.6), layout="constrained")
for n in (4, 8, 10) if FULL else (4,):
    began = time.process_time()
    basis = Basis(strip(n), ElementVector(ElementTriP2()), intorder=4)
    fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    water, stages, steps = consolidate(basis, 0.3, ("strip", (0, -Q)), fixed, "top", times)
    middle = sc.dofs_at(basis, (0.0, 0.0))[0, 1]
    w = np.array([-stage.x[middle] * E / 2.6 / Q for stage in stages])
    errors = [w[np.isclose(times, T)][0] / exact - 1 for T, exact in EXACT.items()]
    row("strip", "P2-P1", n, stages, began, np.abs(errors).max(), steps)
    assert rows[-1]["error"] < (3e-3 if n == 4 else 1e-3)
    ours = rows[-1]["cpu_s"] / len(steps)
    for count in (3, 12):  # steps between two times
        began = time.process_time()
        basis = Basis(strip(n), ElementVector(ElementTriP2()), intorder=4)
        load = sc.traction(basis, "strip", (0, -Q))
        c_v = K * E * 0.7 / 1.3 / 0.4
        other = (
            -E
            / 2.6
            / Q
            * np.array([x[middle] for x in plain(basis, fixed, load, times / c_v, count)])
        )
        off = max(abs(other[np.isclose(times, T)][0] / exact - 1) for T, exact in EXACT.items())
        row("strip", f"plain, {count} steps", n, stages, began, off, 19 * count * [1])
        rows[-1] |= {"peer": True, "ratio": round(ours * 19 * count / rows[-1]["cpu_s"], 2)}
    print(
        "  ", ", ".join(f"T = {T:g}: {error:+.3%}" for T, error in zip(EXACT, errors, strict=True))
    )
ax.semilogx(times, w, "o", ms=3, label="P2-P1")
ax.semilogx(list(EXACT), list(EXACT.values()), "x", color="0.2", label="exact")
ax.set(title="strip on a layer", xlabel="T", ylabel="G w / q a")
ax.legend(frameon=False)
plt.show()

# %%
# Beside another program
# ----------------------
# OpenGeoSys steps by Euler's backward method. Here this does so too: five equal steps until T =
# 0.01, and nine to each further power of ten. The results then are the same, with its error; one
# iteration a step is enough for both. The first step is shorter than the elements beside the drain
# resolve: a warning says so.


class Euler(sc.PoreWater):
    """Water in steps of first order."""

    second_order = False


SIDES = {"bottom": (0, 1), "left": (0,), "right": (0,)}
counts, ends = np.array([1, 4, 9, 9, 9]), np.array([2e-3, *EXACT])
durations = np.diff(ends, prepend=0.0) / (K * E * 0.7 / 1.3 / 0.4)
for n in (4, 8) if FULL else (4,):
    began = time.process_time()
    basis = Basis(strip(n), ElementVector(ElementTriP2()), intorder=2)
    forms = {
        "ground": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.3)),
        "water": Euler(basis, K, unit_weight=1.0),
    }
    fixed = [basis.get_dofs(side).all([f"u^{c + 1}" for c in held]) for side, held in SIDES.items()]
    load = sc.traction(basis, "strip", (0, -Q))
    stages = [
        sc.Stage(f"T = {T:g}", load, duration=d, increments=count)
        for T, d, count in zip(ends, durations, counts.tolist(), strict=True)
    ]
    result = sc.Model(forms, [*fixed, forms["water"].dofs("top")]).run(stages, progress=False)
    middle = sc.dofs_at(basis, (0.0, 0.0))[0, 1]
    done = list(result)[1:]
    ours = [stage.x for stage in done]
    case = {"case": "strip, Euler"}
    error = max(
        abs(-x[middle] * E / 2.6 / Q / exact - 1)
        for x, exact in zip(ours, EXACT.values(), strict=True)
    )
    row(
        "strip",
        "P2-P1, Euler",
        n,
        done,
        began,
        error,
        [k for stage in result for k in stage.iterations],
    )
    rows[-1] |= case
    if not PEERS or not opengeosys.available():
        continue
    layer = opengeosys.Layer(basis, E, 0.3, K, SIDES, "top", "strip", -Q)
    theirs, cpu = opengeosys.consolidate(layer, durations / counts, counts.tolist())
    error = max(
        abs(-x[middle] * E / 2.6 / Q / exact - 1)
        for x, exact in zip(theirs, EXACT.values(), strict=True)
    )
    parts = slice(0, basis.N), slice(basis.N, None)
    apart = max(
        abs(x[part] - y[part]).max() / abs(y[part]).max()
        for x, y in zip(ours, theirs, strict=True)
        for part in parts
    )
    rows.append(
        {
            "method": "OpenGeoSys, strip",
            "peer": version_of("OpenGeoSys"),
            "n": n,
            "unknowns": len(theirs[0]),
            "error": error,
            "cpu_s": round(cpu, 2),
            "steps": int(counts.sum()),
            "iterations": int(counts.sum()),
            "apart": apart,
            "ratio": round(rows[-1]["cpu_s"] / cpu, 3),
            **case,
        }
    )
    print(
        f"OpenGeoSys, n = {n}: {cpu:.2f} s, ours {rows[-1]['ratio']:.2f} of it, {apart:.1e} apart"
    )
    assert apart < 1e-3

# %%
# What it costs
# -------------
# The matrix of displacements and pressures is symmetric but not definite. Because the pressures are
# scaled by E/h the direct solver keeps to its order, at any length of a step.


def seconds(solver, K):
    """Least time of three to factor a matrix, after a first one that finds the order."""
    times = []
    for k in range(4):
        K.data *= 1 + 1e-6 * k  # or the last factors would do
        began = time.process_time()
        solver.factor(K, symmetric=True)
        times.append(time.process_time() - began)
    return min(times[1:])


for n in (8, 16, 32) if FULL else (8, 16):
    basis = Basis(strip(n), ElementVector(ElementTriP2()), intorder=4)
    solid, water = (
        sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.3)),
        sc.PoreWater(basis, K, unit_weight=1.0),
    )
    fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    free = np.setdiff1d(np.arange(basis.N), fixed)
    ground = seconds(DirectSolver(basis.doflocs, free), solid.elastic_stiffness.copy())
    model = sc.Model({"ground": solid, "water": water}, [fixed, water.dofs("top")])
    both, scale = model.checked_system(model.forms, model.fixed), model.layout.scale
    c_v = K * E * 0.7 / 1.3 / 0.4
    for T in (1.0, 1e-4, 1e-8):
        step = both.over(T / n**2 / c_v)
        states = {name: form.initial_state() for name, form in model.forms.items()}
        matrix = step.tangent(step.evaluate(np.zeros(step.size), states, np.zeros(step.size)))
        matrix = csr_matrix(diags_array(scale) @ matrix @ diags_array(scale))
        ratio = seconds(DirectSolver(model.layout.coordinates, both.free), matrix) / ground
        rows.append(
            {
                "method": f"refactoring, step {T:g} h²/c_v",
                "n": n,
                "unknowns": both.size,
                "error": None,
                "cpu_s": round(ratio * ground, 3),
                "iterations": 1,
                "ratio": round(ratio, 2),
            }
        )
        print(
            f"{both.size:6d} unknowns, step {T:5.0e} h²/c_v: {ratio * ground:.3f} s, {ratio:.2f} "
            f"times the ground"
        )

print(json.dumps({"case": "consolidation", "rows": rows}))
