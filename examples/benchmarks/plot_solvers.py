r"""
The linear solver
=================

Direct factorisation is most of an analysis. The default orders the unknowns by a nested dissection
of the mesh, once, and hands them to SuperLU; what scipy's ``splu`` does by itself is ordered anew
in every call, by COLAMD. Where ``pypardiso`` is installed (the extra ``fast``), PARDISO takes the
place of SuperLU. In space factors fill up much faster than in the plane: there, large bodies are
solved by algebraic multigrid that is told their rigid motions, where ``pyamg`` is installed (the
extra ``amg``). Contact in space costs it no iterations, whatever the penalty.

Compared is what an iteration pays: a tangent with new values is factored and a system is solved.
"""

# %%
# Two blocks in frictional contact
# --------------------------------
# On a structured mesh; on meshes of triangles without any structure, graded towards the contact by
# 1:20; and on structured triangles of second order.

import json
import sys
from functools import partial
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from scipy.sparse.linalg import splu
from scipy.spatial import Delaunay
from skfem import (
    Basis,
    ElementHex1,
    ElementQuad1,
    ElementTetP2,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
    MeshHex,
    MeshQuad,
    MeshTet,
    MeshTri,
)
from space_problems import YOUNG, paraboloid

import skfem_contact as sc
from skfem_contact.contact.penalty import choose_penalties
from skfem_contact.solvers.direct import DirectSolver
from skfem_contact.solvers.multigrid import AmgSolver

try:
    import pypardiso
except ImportError:
    pypardiso = None
try:
    import pyamg
except ImportError:
    pyamg = None
rng = np.random.default_rng(1)


def structured(kind):
    """Unit square of n by n cells."""
    return lambda n: kind.init_tensor(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))


def graded(n):
    """Unit square of about n by n nodes that come closer towards y = 1, moved at random and joined
    by Delaunay.
    """
    s = np.linspace(0, 1, n + 1)
    across, up = s, (1.0 - 0.05**s) / 0.95
    x, y = (v.ravel().copy() for v in np.meshgrid(across, up, indexing="ij"))
    inside = (x > 0) & (x < 1) & (y > 0) & (y < 1)
    spacing = np.broadcast_to(np.gradient(up), (n + 1, n + 1)).ravel()
    x[inside] += rng.uniform(-0.45, 0.45, inside.sum()) / n
    y[inside] += rng.uniform(-0.35, 0.35, inside.sum()) * spacing[inside]
    p = np.array([x, y])
    t = Delaunay(p.T).simplices.T
    (ax, ay), (bx, by) = p[:, t[1]] - p[:, t[0]], p[:, t[2]] - p[:, t[0]]
    return MeshTri(p, np.ascontiguousarray(t[:, abs(ax * by - ay * bx) > 1e-14]))


CASES = {
    "structured Q1": (structured(MeshQuad), ElementQuad1(), 1),
    "graded unstructured P1": (graded, ElementTriP1(), 1),
    "graded unstructured P2": (graded, ElementTriP2(), 2),
    "structured P2": (structured(MeshTri), ElementTriP2(), 2),
}


def system(case, unknowns):
    """Two tangents that differ in their values, the coordinates of the unknowns, and the free
    ones.
    """
    square, element, order = CASES[case]
    n = round((unknowns / 2 / 1.81) ** 0.5 / order) + 1
    lower, upper = square(n), square(round(0.9 * n))
    mirrored = type(upper)(np.array([upper.p[0], 2.0 - upper.p[1]]), np.ascontiguousarray(upper.t))
    mesh = sc.join_bodies({"lower": lower.with_defaults(), "upper": mirrored.with_defaults()})
    basis = Basis(mesh, ElementVector(element), intorder=2)
    forms = choose_penalties(
        {
            "blocks": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
            "contact": sc.ContactPair(
                basis, "upper:bottom", "lower:top", sc.Coulomb(mu=0.3), "nodal"
            ),
        }
    )
    x, dofs = basis.zeros(), basis.get_dofs(elements="upper")
    x[dofs.all("u^2")] = -1e-4
    x[dofs.all("u^1")] = 2e-4  # it slips: the tangent is not symmetric
    K = sum(form.assemble(x, form.initial_state()).stiffness for form in forms.values())
    other = K.copy()
    other.data *= 1.0 + 1e-3 * np.sin(np.arange(K.nnz))
    fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
    return (K, other), basis.doflocs, np.setdiff1d(np.arange(basis.N), fixed)


# %%
# Measurements
# ------------
# The shorter of two runs. Memory is counted in entries of the factors.


def colamd(matrices, locations, free, b):
    """Scipy's own way."""
    A = matrices[1][free][:, free].tocsc()
    begin = process_time()
    lu = splu(A)
    x = lu.solve(b[free])
    return (
        process_time() - begin,
        0.0,
        lu.nnz,
        np.linalg.norm(b[free] - A @ x) / np.linalg.norm(b[free]),
    )


def direct(engine):
    """An engine of ours, with what it prepares once."""

    def measure(matrices, locations, free, b):
        begin = process_time()
        solver = DirectSolver(locations, free, engine)
        solver.factor(matrices[0])
        first = process_time() - begin
        begin = process_time()
        x = solver.factor(matrices[1])(b)
        cost = process_time() - begin
        residual = np.linalg.norm((b - matrices[1] @ x)[free]) / np.linalg.norm(b[free])
        fill = solver._engine._fill if engine == "superlu" else 0
        return cost, first - cost, fill, residual

    return measure


METHODS = {"splu, COLAMD": colamd, "default": direct("superlu")}
if pypardiso is not None:
    METHODS["fast (PARDISO)"] = direct("pardiso")
sizes = (10_000, 50_000, 200_000) if "--full" in sys.argv else (2_000, 5_000)
rows = []
for case in CASES:
    for unknowns in sizes:
        problem = system(case, unknowns)
        b = np.random.default_rng(2).standard_normal(problem[1].shape[1])
        for method, measure in METHODS.items():
            cost, once, fill, residual = min(measure(*problem, b) for _ in range(2))
            rows.append(
                {
                    "method": f"{method}, {case}",
                    "case": case,
                    "solver": method,
                    "n": unknowns,
                    "unknowns": len(b),
                    "error": float(residual),
                    "cpu_s": cost,
                    "once_s": once,
                    "factor_entries": fill or None,
                    "iterations": None,
                }
            )
            print(
                f"{case:24} {len(b):7} unknowns  {method:16} {cost:8.3f} s, once {once:6.3f} s, "
                f"{fill / 1e6:6.1f} M entries, residual {residual:.0e}"
            )

# %%
# Checks: the default is never slower than ``splu`` by itself, and of large systems it is two and a
# half times faster and more, with less than 0.7 of the memory.


def gain(row, quantity="cpu_s", solver="splu, COLAMD"):
    """Ratio of another solver's figure to that of a row."""
    return (
        next(
            r[quantity]
            for r in rows
            if (r["case"], r["n"], r["solver"]) == (row["case"], row["n"], solver)
        )
        / row[quantity]
    )


assert all(row["error"] < 1e-8 for row in rows)
if "--full" in sys.argv:
    for row in rows:
        large = row["n"] == max(sizes)
        if row["solver"] == "default":
            assert gain(row) > (2.5 if large else 1.0), row  # 2.7 on a machine with a fast COLAMD
            assert gain(row, "factor_entries") > (1.0 / 0.7 if large else 1.0), row
        if row["solver"].startswith("fast") and large:
            assert gain(row, solver="default") > 1.5, row

# %%
# An elastic block in space
# -------------------------
# Clamped at one side and loaded by its weight, in hexahedra of first and tetrahedra of second
# order.

SPACE = {"hexahedra": (MeshHex, ElementHex1(), 1), "P2 tetrahedra": (MeshTet, ElementTetP2(), 2)}


def block(case, unknowns):
    """Two tangents that differ by a factor, the coordinates of the unknowns, the free ones, and the
    load.
    """
    kind, element, order = SPACE[case]
    n = round((unknowns / 6) ** (1 / 3) / order)
    mesh = kind.init_tensor(*(np.linspace(0, side, side * n + 1) for side in (2, 1, 1)))
    basis = Basis(mesh, ElementVector(element), intorder=2)
    K = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3), "full").elastic_stiffness
    free = np.setdiff1d(np.arange(basis.N), basis.get_dofs(lambda x: x[0] == 0.0).all())
    return (K, 1.01 * K), basis.doflocs, free, sc.weight(basis, 20.0)


def costs(make, matrices, locations, free, b):
    """Solution, time that is spent once, time of an iteration, and of one more solution with the
    same matrix.
    """
    begin = process_time()
    solver = make(locations, free)
    solver.factor(matrices[0], symmetric=True)
    first = process_time() - begin
    begin = process_time()
    solve = solver.factor(matrices[1], symmetric=True)
    prepared = process_time() - begin
    begin = process_time()
    x = solve(b)
    one_more = process_time() - begin
    return x, max(first - prepared, 0.0), prepared + one_more, one_more


IN_SPACE = {"SuperLU": lambda locations, free: DirectSolver(locations, free, "superlu")}
if pypardiso is not None:
    IN_SPACE["PARDISO"] = lambda locations, free: DirectSolver(locations, free, "pardiso")
if pyamg is not None:
    IN_SPACE["multigrid"] = AmgSolver
spent = {}
for case in SPACE:
    for unknowns in (10_000, 30_000, 100_000) if "--full" in sys.argv else (1_000, 4_000):
        problem = block(case, unknowns)
        b, free, solutions = problem[3], problem[2], {}
        for method, make in IN_SPACE.items():
            solutions[method], once, cost, one_more = costs(make, *problem)
            x, expected = solutions[method], solutions["SuperLU"]
            assert abs(x - expected).max() < 1e-7 * abs(expected).max(), (case, method)
            residual = float(
                np.linalg.norm((b - problem[0][1] @ x)[free]) / np.linalg.norm(b[free])
            )
            spent[method, case, len(b)] = cost
            rows.append(
                {
                    "method": f"{method}, {case} in space",
                    "case": case,
                    "solver": method,
                    "n": unknowns,
                    "unknowns": len(b),
                    "error": residual,
                    "cpu_s": cost,
                    "once_s": once,
                    "one_more_s": one_more,
                    "factor_entries": None,
                    "iterations": None,
                }
            )
            print(
                f"{case:24} {len(b):7} unknowns  {method:16} {cost:8.3f} s, once {once:6.3f} s, "
                f"one more {one_more:6.3f} s, residual {residual:.0e}"
            )
        if unknowns == 100_000 and pyamg is not None:
            assert spent["multigrid", case, len(b)] < 0.25 * spent["SuperLU", case, len(b)], case

# %%
# Contact in space
# ----------------
# The paraboloid on a block of the example on Hertz's problem in space, 0.02 deep in it, without
# friction and slipping with :math:`\mu = 0.3`. Its elements are stretched far from the contact,
# which costs multigrid iterations with or without contact. The penalty is 1 to 1000 times E/h.


def closed(n, mu, ratio):
    """Tangent of bodies in contact, that of the bodies, coordinates of the unknowns, the free ones,
    the interface.
    """
    problem = paraboloid(n)
    pair = sc.ContactPair(
        problem.basis,
        "upper:bottom",
        "lower:top",
        sc.Coulomb(mu=mu),
        2,
        penalty=ratio * YOUNG * n,
        tangent="primary",
    )
    x, upper = problem.basis.zeros(), problem.basis.get_dofs(elements="upper")
    x[upper.all("u^3")], x[upper.all("u^1")] = -0.02, 0.02 if mu else 0.0
    alone = problem.solid.elastic_stiffness
    free = np.setdiff1d(np.arange(problem.basis.N), problem.fixed)
    together = alone + pair.assemble(x, pair.initial_state()).stiffness
    return together.tocsr(), alone, problem.basis.doflocs, free, pair.changing


def timed(make, K, locations, free, symmetric):
    """Residual, times once, of an iteration and of one more solution, and multigrid's
    iterations.
    """
    b = np.random.default_rng(2).standard_normal(K.shape[0])
    begin = process_time()
    solver = make(locations, free)
    solver.factor(K, symmetric)
    first = process_time() - begin
    begin = process_time()
    solve = solver.factor((1.01 * K).tocsr(), symmetric)
    prepared = process_time() - begin
    x = solve(b)
    cost = process_time() - begin
    residual = float(np.linalg.norm((b - 1.01 * K @ x)[free]) / np.linalg.norm(b[free]))
    return (
        residual,
        max(first - prepared, 0.0),
        cost,
        cost - prepared,
        getattr(solver, "iterations", None),
    )


class Colamd:
    """Scipy's own way behind the call of a solver."""

    def __init__(self, locations, free):
        self.free = free

    def factor(self, K, symmetric):
        """Factor the free block."""
        lu, free = splu(K[self.free][:, self.free].tocsc()), self.free

        def solve(b):
            x = np.zeros(len(b))
            x[free] = lu.solve(b[free])
            return x

        return solve


iterations = {}
for n in (4, 6, 11) if "--full" in sys.argv else (2,):
    for mu, ratio in ((0.0, 1), (0.0, 10), (0.0, 1000), (0.3, 10), (0.3, 100)):
        K, alone, coordinates, free, interface = closed(n, mu, ratio)
        makers = {"splu, COLAMD": Colamd, **IN_SPACE} if ratio == 10 and n < 11 else dict(IN_SPACE)
        if pyamg is not None:
            makers["multigrid"] = partial(AmgSolver, interface=interface)
            _, _, _, _, iterations[n, "alone"] = timed(AmgSolver, alone, coordinates, free, True)
        for method, make in makers.items():
            if method != "multigrid" and ratio != 10:
                continue  # a factorisation does not know how stiff things are
            residual, once, cost, one_more, taken = timed(make, K, coordinates, free, mu == 0.0)
            case = f"{'slipping' if mu else 'closed'}, penalty {ratio} E/h"
            rows.append(
                {
                    "method": f"{method}, {case}, in space",
                    "case": f"contact in space, {case}",
                    "solver": method,
                    "n": n,
                    "unknowns": len(free),
                    "error": residual,
                    "cpu_s": cost,
                    "once_s": once,
                    "one_more_s": one_more,
                    "factor_entries": None,
                    "iterations": taken,
                }
            )
            print(
                f"{case:24} {len(free):7} unknowns  {method:16} {cost:8.3f} s, once {once:6.3f} s, "
                f"one more {one_more:6.3f} s, residual {residual:.0e}, iterations {taken}"
            )
            if taken is not None:
                iterations[n, mu, ratio] = taken
print("multigrid's iterations:", iterations)

# %%
# Checks: a factor in the order of a nested dissection costs no more than scipy's own, and contact
# costs multigrid no more than a fifth of the iterations that it needs for the bodies alone, on
# meshes like those of an analysis.

contacts = [row for row in rows if row["case"].startswith("contact in space")]
assert all(row["error"] < 1e-8 for row in contacts)
if "--full" in sys.argv:
    for row in contacts:
        if row["solver"] == "multigrid":
            assert row["iterations"] <= 1.2 * iterations[row["n"], "alone"], row
        if row["solver"] == "splu, COLAMD":
            own = next(
                r
                for r in contacts
                if (r["case"], r["n"], r["solver"]) == (row["case"], row["n"], "SuperLU")
            )
            assert own["cpu_s"] < row["cpu_s"], row

# %%
# Gains
# -----

fig, axes = plt.subplot_mosaic(
    [["time", "entries"], ["space", "space"]], figsize=(9, 7), layout="constrained"
)
for case, color in zip(CASES, ("#1f4e8c", "#d55e00", "#e69f00", "#009e73")):
    for ax, quantity in ((axes["time"], "cpu_s"), (axes["entries"], "factor_entries")):
        own = [row for row in rows if (row["case"], row["solver"]) == (case, "default")]
        ax.semilogx(
            [row["unknowns"] for row in own],
            [gain(row, quantity) for row in own],
            "o-",
            color=color,
            label=case,
        )
for ax, title in (
    (axes["time"], "time of splu / time of the default"),
    (axes["entries"], "entries of splu / entries of the default"),
):
    ax.set(xlabel="unknowns", title=title, ylim=(0, None))
    ax.axhline(1.0, color="#999999", linewidth=0.8)
axes["time"].legend(frameon=False)
for method, color in zip(IN_SPACE, ("#1f4e8c", "#d55e00", "#009e73")):
    for case, style in zip(SPACE, ("o-", "s--")):
        points = [
            (n, cost) for (name, of, n), cost in spent.items() if (name, of) == (method, case)
        ]
        axes["space"].loglog(*zip(*points), style, color=color, label=f"{method}, {case}")
axes["space"].set(xlabel="unknowns", title="time in space [s]")
axes["space"].legend(frameon=False)
plt.show()

# %%
# Figures
# -------

print(json.dumps({"case": "solvers", "rows": rows}))
