r"""
A footing in space, by multigrid and by a direct solver
=======================================================

In space the factors of a direct solver take time in proportion to the square of the unknowns.
Algebraic multigrid (``solver="amg"``, the extra ``amg``) takes a time that grows little faster than
their number. Here a rigid footing is pressed onto sand that yields, in five stages.

Three things make multigrid fast where soil yields. Linear solutions are as accurate as Newton's
method needs at that moment (Eisenstat and Walker), about .03 of the residual far from equilibrium.
Aggregates of nodes are kept from tangent to tangent, and only their stiffness is computed anew.
Smoothers are polynomials of the tangent itself.

Run with ``--full`` for 10,000 to 100,000 unknowns.
"""

# %%
# The scene
# ---------
# A quarter of the footing on a cube of sand, in hexahedra with averaged volumetric strains. The
# flow is not associated, so the tangent is not symmetric.

import json
import logging
import os
import sys
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from own_process import apart, peak
from skfem import Basis, ElementHex1, ElementVector, MeshHex

import skfem_contact as sc

SAND = sc.MohrCoulomb(E=2e4, nu=0.3, c=5.0, phi=30.0, psi=5.0)
STAGES, DEPTH, WIDTH = 5, 0.01, 0.3


def footing(n, solver, sand=SAND):
    """Model of ground of n elements along its sides, and the vertical dofs of its footing."""
    side = np.linspace(0.0, 1.0, n + 1)
    mesh = MeshHex.init_tensor(side, side, side).with_boundaries(
        {"footing": lambda x: (x[2] == 1.0) & (x[0] < WIDTH) & (x[1] < WIDTH)}
    )
    basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2)
    ground = sc.SolidForm(basis, sand, strain="b_bar", unit_weight=20.0)
    foot = basis.get_dofs("footing").all("u^3")
    return sc.Model(
        {"ground": ground}, np.union1d(sc.box_supports(basis), foot), solver=solver
    ), foot


class Counter(logging.Handler):
    """Iterations of multigrid, from the log."""

    def __init__(self):
        super().__init__(logging.DEBUG)
        self.counts = []

    def emit(self, record):
        """Keep the number of a line about a solution."""
        if record.msg.startswith("multigrid: %d iterations"):
            self.counts.append(record.args[0])


def analyse(n, solver, stages):
    """Figures of an analysis of some of the stages."""
    log, counter = logging.getLogger("skfem_contact"), Counter()
    log.setLevel(logging.DEBUG)
    log.addHandler(counter)
    begin = process_time()
    model, foot = footing(n, solver)
    path = []
    for k in range(stages):
        x = np.zeros(model.layout.size)
        x[foot] = -DEPTH * (k + 1) / STAGES
        path.append(sc.Stage(f"{1000 * DEPTH * (k + 1) / STAGES:g} mm", prescribed=x))
    result = model.run(path, start=model.k0_state(K0=0.5), progress=False)
    cost = process_time() - begin
    ground = model.forms["ground"]
    found = [result[stage.name] for stage in path]
    loads = [
        float(-ground.assemble(stage.x, stage.states["ground"]).force[foot].sum())
        for stage in found
    ]
    return {
        "method": f"{solver}, {stages} stages",
        "solver": solver,
        "n": n,
        "unknowns": model.layout.size,
        "stages": stages,
        "cpu_s": cost,
        "iterations": sum(sum(stage.iterations) for stage in found),
        "linear_iterations": sum(counter.counts),
        "peak_MB": peak(),
        "loads": loads,
    }


# %%
# Measurements
# ------------
# Processor times of one thread, from the mesh to the result. The direct solver computes one stage
# of the finest mesh, so the ratio there is that of the first stage.

BEFORE = os.environ.get("OMP_NUM_THREADS")
os.environ["OMP_NUM_THREADS"] = "1"
try:
    import pypardiso

    DIRECT = "pardiso"
except ImportError:
    pypardiso, DIRECT = None, "superlu"
try:
    import pyamg
except ImportError:
    pyamg = None
FULL = "--full" in sys.argv
SIZES = (14, 22, 31) if FULL else (5, 7)
rows, ratios, errors = [], {}, {}


def measured(n, solver, stages):
    """Row of an analysis, which is printed."""
    row = apart(analyse, n, solver, stages)
    rows.append(row)
    print(
        f"{row['unknowns']:7} unknowns  {solver:8} {stages} stages {row['cpu_s']:8.2f} s  "
        f"{row['iterations']:3} "
        f"iterations, {row['linear_iterations']:4} of the linear solver, {row['peak_MB']:5.0f} MB",
        flush=True,
    )
    return row


for n in SIZES:
    compared = STAGES if n < 31 else 1
    direct = measured(n, DIRECT, compared)
    if pyamg is not None:
        first = measured(n, "amg", compared) if compared < STAGES else None
        whole = measured(n, "amg", STAGES)
        own = first or whole
        ratios[n] = own["cpu_s"] / direct["cpu_s"]
        errors[n] = max(abs(a / b - 1.0) for a, b in zip(own["loads"], direct["loads"]))
        print(
            f"        multigrid takes {ratios[n]:.2f} times as long, loads differ by "
            f"{errors[n]:.0e}"
        )
if BEFORE is None:
    os.environ.pop("OMP_NUM_THREADS")
else:
    os.environ["OMP_NUM_THREADS"] = BEFORE

# %%
# Checks: both find the same loads. Of the large bodies multigrid takes a fraction of the time. More
# iterations of Newton's method on finer meshes are part of its growth.


def growth(quantity):
    """Exponent of a quantity of multigrid's whole analyses against the unknowns."""
    own = [row for row in rows if (row["solver"], row["stages"]) == ("amg", STAGES)]
    return float(
        np.polyfit(
            np.log([row["unknowns"] for row in own]), np.log([quantity(row) for row in own]), 1
        )[0]
    )


for row in rows:
    row["error"] = errors.get(row["n"]) if row["solver"] == "amg" else None
assert all(error < 1e-6 for error in errors.values())
exponents = {}
if pyamg is not None:
    exponents = {
        "time": growth(lambda row: row["cpu_s"]),
        "time of an iteration": growth(lambda row: row["cpu_s"] / row["iterations"]),
        "linear iterations": growth(lambda row: row["linear_iterations"] / row["iterations"]),
    }
    print(
        "growth with the unknowns:",
        ", ".join(f"{name} {value:.2f}" for name, value in exponents.items()),
    )
if FULL and pyamg is not None and DIRECT == "pardiso":
    assert ratios[22] <= 1.0
    assert ratios[31] <= 0.4
    assert rows[-1]["peak_MB"] <= 8 * 1024

# %%
# Sand that does not dilate
# -------------------------
# Without dilation the tangent leads nowhere while the first mechanism forms. Accelerated iterations
# find the equilibrium of the first stage in one increment; Newton's method alone cuts it to a
# quarter. Run with ``--full`` for five stages on 10,125 unknowns.

loose_n = 14 if FULL else 10
loose = sc.MohrCoulomb(E=2e4, nu=0.3, c=1.0, phi=40.0, psi=0.0)
model, foot = footing(loose_n, DIRECT, loose)
down = np.zeros(model.layout.size)
down[foot] = -DEPTH / STAGES
stages = [
    sc.Stage(f"{k + 1} of {STAGES}", prescribed=(k + 1) * down)
    for k in range(STAGES if FULL else 1)
]
begin = process_time()
result = model.run(stages, start=model.k0_state(K0=0.5), progress=False)
increments = [len(stage.iterations) for stage in result][-len(stages) :]
print(
    f"sand without dilation: {increments} increments, "
    f"{sum(sum(result[stage.name].iterations) for stage in stages)} iterations, "
    f"{process_time() - begin:.1f} s"
)
assert increments == [1] * len(stages)

# %%
# Times of whole analyses, and the load of the footing:

figure, axes = plt.subplots(1, 2, figsize=(8, 3.5), constrained_layout=True)
for solver in (DIRECT, "amg"):
    own = [row for row in rows if (row["solver"], row["stages"]) == (solver, STAGES)]
    if own:
        axes[0].loglog(
            [row["unknowns"] for row in own], [row["cpu_s"] for row in own], "o-", label=solver
        )
        depths = 1000 * DEPTH * np.arange(1, STAGES + 1) / STAGES
        for row in own if solver == "amg" or pyamg is None else ():
            axes[1].plot(depths, row["loads"], "o-", label=f"{row['unknowns']} unknowns")
axes[0].set(xlabel="unknowns", ylabel="processor time [s]")
axes[1].set(xlabel="depth [mm]", ylabel="load of a quarter [kN]", ylim=(0.0, None))
for ax in axes:
    ax.legend(frameon=False)
plt.show()

# %%
# Figures
# -------

print(json.dumps({"case": "footing in space", "rows": rows, "exponents": exponents}))
