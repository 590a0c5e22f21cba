r"""
Time and memory against size
============================

Four analyses on finer and finer meshes: the buried culvert, with contact and both stages, a slope
of which gravity makes a part yield, a footing on sand in space, and a paraboloid pressed onto a
block. What do they cost, and how does the cost grow?

A two-dimensional mesh of :math:`N` unknowns has factors of :math:`O(N \log N)` entries that take
:math:`O(N^{3/2})` operations; everything else is linear. An exponent below 1.5 is what a direct
solver can reach in the plane. In space factors have :math:`O(N^{4/3})` entries and take
:math:`O(N^2)` operations, where multigrid takes :math:`O(N)` for an iteration.
"""

# %%
# The scenes
# ----------
# The culvert is that of the tutorial, its elements divided by four again and again, in soils that
# dilate as their flow rule says when it is associated. (Without dilatancy both stages take 20
# iterations instead of 8 at 66,000 unknowns, the time of 32 factorisations, and 85 factorisations
# at 260,000, an increment that fails included.) The slope is that of Griffiths and Lane, 1:2, on
# triangles of second order. The footing in space goes down by 2 mm in sand that dilates, solved by
# multigrid; the paraboloid is pressed in four increments with multipliers, and its bodies are
# factored once.

import json
import sys
from importlib.resources import files
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from own_process import apart, peak
from skfem import (
    Basis,
    ElementHex1,
    ElementQuad1,
    ElementTriP2,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshHex,
    MeshTri,
)
from space_problems import MASTER, SLAVE, paraboloid

import skfem_contact as sc
from skfem_contact.contact.penalty import choose_penalties
from skfem_contact.solvers.direct import DirectSolver


def culvert(refinements):
    """Forms, stages and supports of the buried culvert."""
    welded = sc.load_mesh(files("skfem_contact") / "data" / "culvert.msh").refined(refinements)
    mesh = sc.join_bodies(welded, bodies={"ground": ["soft", "stiff"], "culvert": "culvert"})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    soils = {
        "soft": sc.MohrCoulomb(E=1e4, nu=0.40, c=5.0, phi=25.0, psi=25.0),
        "stiff": sc.MohrCoulomb(E=5e4, nu=0.35, c=10.0, phi=35.0, psi=35.0),
    }
    concrete = sc.LinearElastic(E=2.8e7, nu=0.2)
    forms = {
        "ground": sc.SolidForm(basis.with_elements("ground"), soils, strain="b_bar"),
        "culvert": sc.SolidForm(basis.with_elements("culvert"), concrete, strain="b_bar"),
        "skin": sc.ContactPair(
            basis,
            slave="ground|culvert",
            master="culvert|ground",
            law=sc.Coulomb(mu=0.6),
            quadrature="nodal",
            smoothing=0.5,
            initial="adjusted",
        ),
    }
    gravity = sc.weight(basis, {"soft": 18.0, "stiff": 20.0, "culvert": 25.0})
    surface = FacetBasis(mesh, basis.elem, facets="surface")
    strip = LinearForm(lambda v, w: -35.0 * v[1] * (w.x[0] > 0.0) * (w.x[0] < 1.8)).assemble(
        surface
    )
    fixed = np.concatenate(
        (basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    )
    return (
        basis,
        forms,
        [sc.Stage("gravity", gravity), sc.Stage("surcharge", gravity + strip)],
        fixed,
    )


def slope(n):
    """Forms, stage and supports of the slope, n cells high."""
    s = np.linspace(0, 1, n + 1)
    mesh = MeshTri.init_tensor(np.linspace(0, 1, 2 * n + 1), s).with_defaults()
    y = 10.0 * mesh.p[1]
    mesh = MeshTri(np.array([mesh.p[0] * (12.0 + 2.0 * (10.0 - y)), y]), mesh.t).with_boundaries(
        mesh.boundaries
    )
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    soil = sc.MohrCoulomb(E=1e5, nu=0.3, c=10.0, phi=20.0, psi=20.0)
    fixed = np.concatenate((basis.get_dofs("bottom").all(), basis.get_dofs("left").all("u^1")))
    return (
        basis,
        {"slope": sc.SolidForm(basis, soil)},
        [sc.Stage("gravity", sc.weight(basis, 20.0))],
        fixed,
    )


def footing(n):
    """Forms, stage and supports of a quarter of a footing on a cube, n elements along its side."""
    side = np.linspace(0.0, 1.0, n + 1)
    mesh = MeshHex.init_tensor(side, side, side).with_boundaries(
        {"footing": lambda x: (x[2] == 1.0) & (x[0] < 0.3) & (x[1] < 0.3)}
    )
    basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2)
    sand = sc.MohrCoulomb(E=2e4, nu=0.3, c=5.0, phi=30.0, psi=5.0)
    foot = basis.get_dofs("footing").all("u^3")
    down = basis.zeros()
    down[foot] = -0.002
    return (
        basis,
        {"sand": sc.SolidForm(basis, sand, strain="b_bar", unit_weight=20.0)},
        [sc.Stage("down", prescribed=down)],
        np.union1d(sc.box_supports(basis), foot),
    )


def contact(n):
    """Forms, stage and supports of the paraboloid, n elements in a unit of length."""
    problem = paraboloid(n)
    joint = sc.ContactPair(
        problem.basis,
        SLAVE,
        MASTER,
        sc.Coulomb(),
        "segments",
        enforcement=sc.DualMultipliers(),
    )
    stage = sc.Stage("press", problem.basis.zeros(), problem.pressed, increments=4)
    return problem.basis, {"bodies": problem.solid, "joint": joint}, [stage], problem.fixed


# %%
# Measurements
# ------------
# The unit of time in the plane is one factorisation of the last tangent. Each analysis has a
# process of its own, whose peak memory is taken, less what it holds at the start.


def factorisation(basis, forms, result, fixed):
    """Processor time of one factorisation of the last tangent."""
    forms, last = choose_penalties(forms), result[-1]
    K = sum(form.assemble(last.x, last.states[name]).stiffness for name, form in forms.items())
    solver = DirectSolver(basis.doflocs, np.setdiff1d(np.arange(basis.N), fixed), "superlu")
    solver.factor(K)
    begin = process_time()
    solver.factor(1.0001 * K)
    return process_time() - begin


def analyse(name, scene, n):
    """Figures of an analysis."""
    before, begin = peak(), process_time()
    basis, forms, stages, fixed = scene(n)
    set_up = process_time() - begin
    model = sc.Model(forms, fixed, solver="amg" if name == "footing" else None)
    start = model.k0_state(K0=0.5) if name == "footing" else None
    result = model.run(stages, start=start)
    cost, memory = process_time() - begin, peak() - before
    row = {
        "method": name,
        "n": n,
        "unknowns": int(basis.N),
        "error": max(stage.residual for stage in result),
        "cpu_s": cost,
        "set_up_s": set_up,
        "iterations": sum(sum(result[stage.name].iterations) for stage in stages),
        "peak_MB": memory,
        "KB_per_unknown": 1024 * memory / basis.N,
    }
    if basis.mesh.dim() == 2:
        row["factorisations"] = cost / factorisation(basis, forms, result, fixed)
    return row


full = "--full" in sys.argv
sizes = {
    "culvert": (culvert, range(4) if full else (0,)),
    "slope": (slope, (17, 34, 68, 136) if full else (8, 12)),
    "footing": (footing, (8, 14, 22) if full else (5, 7)),
    "contact": (contact, (3, 4, 6, 8) if full else (3,)),
}
rows = []
for name, (scene, numbers) in sizes.items():
    for n in numbers:
        row = apart(analyse, name, scene, n)
        rows.append(row)
        print(
            f"{name:8} {row['unknowns']:7} unknowns {row['cpu_s']:8.2f} s, "
            f"{row['iterations']:3} iterations, {row['KB_per_unknown']:.1f} KB per unknown",
            flush=True,
        )

# %%
# Exponents, fitted to all sizes of a scene. An iteration more or less on the way is part of the
# scatter, so the time of an iteration is fitted as well.


def exponent(name, quantity):
    """Slope of a quantity in double logarithmic scales."""
    own = [row for row in rows if row["method"] == name]
    return float(
        np.polyfit(
            np.log([row["unknowns"] for row in own]), np.log([quantity(row) for row in own]), 1
        )[0]
    )


exponents = {}
if full:
    for name in sizes:
        exponents[name] = {
            "time": exponent(name, lambda row: row["cpu_s"]),
            "time of an iteration": exponent(name, lambda row: row["cpu_s"] / row["iterations"]),
            "memory": exponent(name, lambda row: row["peak_MB"]),
        }
        texts = [f"{quantity} ~ N^{value:.2f}" for quantity, value in exponents[name].items()]
        print(f"{name}: {', '.join(texts)}")
        assert exponents[name]["time of an iteration"] < 1.4
    modules = 60.0  # MB of modules that analyses import on the way
    for row in rows:
        if row["unknowns"] > 60_000:
            assert row["peak_MB"] < modules + 8.0 * row["unknowns"] / 1024
            assert row["method"] == "slope" or row["factorisations"] < 60.0

fig, axes = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
for name, color in zip(sizes, ("#1f4e8c", "#d55e00", "#009e73", "#e69f00")):
    own = [row for row in rows if row["method"] == name]
    for ax, quantity in zip(axes, ("cpu_s", "peak_MB")):
        ax.loglog(
            [row["unknowns"] for row in own],
            [row[quantity] for row in own],
            "o-",
            color=color,
            label=name,
        )
for ax, title in zip(axes, ("processor time [s]", "peak memory [MB]")):
    ax.set(xlabel="unknowns", title=title)
    ax.grid(color="#dddddd", linewidth=0.6)
axes[0].legend(frameon=False)
plt.show()

# %%
# Figures
# -------

print(json.dumps({"case": "scaling", "rows": rows, "exponents": exponents}))
