r"""
Threads
=======

What a second core saves. Small dense blocks and small factors are computed by one thread, which is
faster. Factors by PARDISO (the extra ``fast``) of more than some hundred thousand entries use all
cores that the process may use; the variable ``OMP_NUM_THREADS`` limits them, and analyses side by
side in one process have one each.

A rigid footing is pressed onto soil until some of it yields, in the plane and in space, and the
strength of a slope is reduced until it fails. Compared are wall times of whole Newton iterations,
from assembly to solution, with one thread and with all of them in turn. Run with ``--full`` for
large bodies, and with ``--busy`` beside another process that keeps one core busy.
"""

# %%
# The scenes
# ----------
# The soil of the footing is not associated, so its tangent is not symmetric. The slope is the first
# one of Griffiths and Lane.

import json
import os
import subprocess
import sys
from contextlib import contextmanager
from functools import partial
from time import perf_counter

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementHex1, ElementTriP2, ElementVector, MeshHex, MeshTri

import skfem_contact as sc
from skfem_contact.solvers.threads import allowed

SAND = sc.MohrCoulomb(E=2e4, nu=0.3, c=5.0, phi=30.0, psi=20.0)
CLAY = sc.MohrCoulomb(E=1e5, nu=0.3, c=10.0, phi=20.0, psi=20.0)
DEPTH = 5e-4
BEFORE = os.environ.pop("OMP_NUM_THREADS", None)
ONE, ALL = 1, allowed()


def footing(dim, n):
    """Model of ground of n elements along its sides, and its analysis under a rigid footing."""
    sides = (np.linspace(0.0, 1.0, n + 1),) * dim
    kind, element = (MeshTri, ElementTriP2()) if dim == 2 else (MeshHex, ElementHex1())
    mesh = kind.init_tensor(*sides).with_boundaries(
        {"footing": lambda x: (x[-1] == 1.0) & (x[0] < 0.3) & (x[-2 if dim == 3 else 0] < 0.3)}
    )
    basis = Basis(mesh, ElementVector(element), intorder=2)
    foot = basis.get_dofs("footing").all(f"u^{dim}")
    model = sc.Model(
        {"ground": sc.SolidForm(basis, SAND, unit_weight=20.0)},
        np.union1d(sc.box_supports(basis), foot),
        solver=SOLVER,
    )
    start, pressed = model.k0_state(K0=0.5), np.zeros(basis.N)
    pressed[foot] = -DEPTH

    def analysis():
        stage = model.run([sc.Stage("pressed", prescribed=pressed)], start=start, progress=False)[
            "pressed"
        ]
        return sum(stage.iterations), np.linalg.norm(stage.x)

    return model, analysis


def slope(n):
    """Model of a slope of n elements along its sides, and its search for the factor of safety."""
    side = np.linspace(0.0, 1.0, n + 1)
    square = MeshTri.init_tensor(side, side)
    mesh = MeshTri(
        np.stack((square.p[0] * (32.0 - 20.0 * square.p[1]), 10.0 * square.p[1])), square.t
    )
    basis = Basis(
        mesh.with_boundaries({"base": lambda x: x[1] == 0.0, "left": lambda x: x[0] == 0.0}),
        ElementVector(ElementTriP2()),
        intorder=2,
    )
    fixed = np.union1d(basis.get_dofs("base").all(), basis.get_dofs("left").all("u^1"))
    model = sc.Model({"slope": sc.SolidForm(basis, CLAY, unit_weight=20.0)}, fixed, solver=SOLVER)

    def analysis():
        found = model.strength_reduction(certify=False, progress=False)
        return found.iterations, found.factor

    return model, analysis


def seconds(scene, threads):
    """Wall time of an iteration, the iterations, a result and the unknowns of a new model: models
    keep factors.
    """
    os.environ["OMP_NUM_THREADS"] = str(threads)
    model, analysis = scene()
    begin = perf_counter()
    iterations, result = analysis()
    return (perf_counter() - begin) / iterations, iterations, result, model.layout.size


@contextmanager
def other_process(busy):
    """Keep one core busy by another process."""
    other = subprocess.Popen([sys.executable, "-c", "while True: pass"]) if busy else None
    yield
    if other is not None:
        other.kill()


# %%
# Measurements
# ------------
# The shortest of runs in alternation.

try:
    import pypardiso

    SOLVER = "pardiso"
except ImportError:
    pypardiso, SOLVER = None, "superlu"
FULL = "--full" in sys.argv
SIZES = (
    {"plane": (20, 112, 194), "space": (6, 18, 26), "slope": (20, 70)}
    if FULL
    else {"plane": (10, 20), "space": (4,), "slope": (8,)}
)
SCENES = {"plane": partial(footing, 2), "space": partial(footing, 3), "slope": slope}
rows = []
with other_process("--busy" in sys.argv):
    for kind, n in ((kind, n) for kind, sizes in SIZES.items() for n in sizes):
        runs = {ONE: [], ALL: []}
        for threads in (ONE, ALL) * 2:
            runs[threads].append(seconds(partial(SCENES[kind], n), threads))
        (one, iterations, result, unknowns), (both, _, again, _) = min(runs[ONE]), min(runs[ALL])
        assert abs(result - again) < 1e-8 * result  # threads change round-off only
        rows.append(
            {
                "method": f"{kind}, {ALL} threads",
                "unknowns": unknowns,
                "error": abs(result - again) / result,
                "cpu_s": None,
                "wall_one_s": one,
                "wall_s": both,
                "ratio": one / both,
                "iterations": iterations,
            }
        )
        print(
            f"{kind} {unknowns:7} unknowns: {one:7.3f} s an iteration with one thread, {both:7.3f} "
            f"s with {ALL}, ratio {one / both:.2f}",
            flush=True,
        )
os.environ.pop("OMP_NUM_THREADS")
os.environ |= {} if BEFORE is None else {"OMP_NUM_THREADS": BEFORE}

# %%
# The larger the factor, the more a second core saves:

figure, axes = plt.subplots(figsize=(6, 3.5), constrained_layout=True)
for kind in SCENES:
    chosen = [row for row in rows if row["method"].startswith(kind)]
    axes.semilogx(
        [row["unknowns"] for row in chosen], [row["ratio"] for row in chosen], "o-", label=kind
    )
axes.axhline(1.0, color="grey", linewidth=0.8)
axes.set_xlabel("unknowns")
axes.set_ylabel(f"time with 1 thread / with {ALL}")
axes.legend(frameon=False)
print(json.dumps({"case": "threads", "rows": rows}))
