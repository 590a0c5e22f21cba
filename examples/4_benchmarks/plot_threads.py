r"""
Threads
=======

What a second core saves. Small dense blocks and small factors are computed by one thread, which is faster. Factors by
PARDISO (the extra ``fast``) of more than some hundred thousand entries use all cores that the process may use; the
variable ``OMP_NUM_THREADS`` limits them, and analyses side by side in one process have one each.

A footing is pressed onto soil until some of it yields, in the plane and in space. Compared are wall times of whole
Newton iterations, from assembly to solution, with one thread and with all of them in turn. Run with ``--full`` for
large bodies, and with ``--busy`` beside another process that keeps one core busy.
"""

# %%
# The scene
# ---------
# The soil is not associated, so its tangent is not symmetric.

import json
import os
import subprocess
import sys
from contextlib import contextmanager
from time import perf_counter

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementHex1, ElementTriP2, ElementVector, MeshHex, MeshTri

import skfem_contact as sc
from skfem_contact.solvers.threads import allowed

SAND = sc.MohrCoulomb(E=2e4, nu=0.3, c=5.0, phi=30.0, psi=5.0)
BEFORE = os.environ.pop("OMP_NUM_THREADS", None)
ONE, ALL = 1, allowed()


def footing(dim, n):
    """Model of ground of n elements along its sides, and the load of its footing."""
    sides = (np.linspace(0.0, 1.0, n + 1),) * dim
    kind, element = (MeshTri, ElementTriP2()) if dim == 2 else (MeshHex, ElementHex1())
    mesh = kind.init_tensor(*sides).with_boundaries(
        {"footing": lambda x: (x[-1] == 1.0) & (x[0] < 0.3) & (x[-2 if dim == 3 else 0] < 0.3)})  # fmt: skip
    basis = Basis(mesh, ElementVector(element), intorder=2)
    model = sc.Model({"ground": sc.SolidForm(basis, SAND, unit_weight=20.0)}, sc.box_supports(basis), solver=SOLVER)
    return model, model.traction("footing", (0.0,) * (dim - 1) + (-60.0,))


def seconds(model, load, threads):
    """Wall time of an iteration, the iterations, and the largest displacement."""
    os.environ["OMP_NUM_THREADS"] = str(threads)
    start = model.k0_state(K0=0.5)
    begin = perf_counter()
    stage = model.run([sc.Stage("load", load, increments=2)], start=start, progress=False)["load"]
    iterations = sum(stage.iterations)
    return (perf_counter() - begin) / iterations, iterations, abs(stage.x).max()


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
SIZES = {2: (20, 112, 194), 3: (6, 18, 26)} if "--full" in sys.argv else {2: (10, 20), 3: (4,)}
rows = []
with other_process("--busy" in sys.argv):
    for dim, sizes in SIZES.items():
        for n in sizes:
            model, load = footing(dim, n)
            runs = {ONE: [], ALL: []}
            for threads in (ONE, ALL) * 3:
                runs[threads].append(seconds(model, load, threads))
            (one, iterations, moved), (both, _, again) = min(runs[ONE]), min(runs[ALL])
            assert abs(moved - again) < 1e-8 * moved  # threads change round-off only
            rows.append({"method": f"{'plane' if dim == 2 else 'space'}, {ALL} threads", "n": n,
                         "unknowns": model.layout.size, "error": abs(moved - again) / moved, "cpu_s": None,
                         "wall_one_s": one, "wall_s": both, "ratio": one / both, "iterations": iterations})  # fmt: skip
            print(f"{'plane' if dim == 2 else 'space'} {model.layout.size:7} unknowns: {one:7.3f} s an iteration with "
                  f"one thread, {both:7.3f} s with {ALL}, ratio {one / both:.2f}")
os.environ.pop("OMP_NUM_THREADS")
os.environ |= {} if BEFORE is None else {"OMP_NUM_THREADS": BEFORE}

# %%
# The larger the factor, the more a second core saves:

figure, axes = plt.subplots(figsize=(6, 3.5), constrained_layout=True)
for kind in ("plane", "space"):
    chosen = [row for row in rows if row["method"].startswith(kind)]
    axes.semilogx([row["unknowns"] for row in chosen], [row["ratio"] for row in chosen], "o-", label=kind)
axes.axhline(1.0, color="grey", linewidth=0.8)
axes.set_xlabel("unknowns")
axes.set_ylabel(f"time with 1 thread / with {ALL}")
axes.legend(frameon=False)
print(json.dumps({"case": "threads", "rows": rows}))
