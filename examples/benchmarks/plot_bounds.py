r"""
Bounds of published problems
============================

Factors of safety and limit loads between two proven numbers: slopes of Griffiths and Lane, ACADS
and Dawson, a vertical cut, footings and a block on a joint. Each bracket holds the exact answer, or
overlaps the rigorous bracket of others. The cases stand in ``bound_cases.py``.

Run with ``--full`` for small gaps, and for a diagram of the gap over time beside the error of
strength reduction.
"""

import json
import sys
import warnings
from time import process_time

import matplotlib.pyplot as plt
from bound_cases import CASES, bracket, supported

import skfem_contact as sc

FULL = "--full" in sys.argv
STEEP = ("N_c, 30 degrees", "footing with c, q and weight")  # friction of 30 degrees
SMALL = {"Griffiths and Lane 1": 0.003, "sliding block": 2e-5, **dict.fromkeys(STEEP, 0.02)}

# %%
# All cases
# ---------
# ``cpu_s`` is cumulative: all meshes, both bounds.

rows, histories = [], {}
names = (
    list(CASES)
    if FULL
    else ["Griffiths and Lane 1", "vertical cut", "N_c, 20 degrees", "sliding block"]
)
for name in names:
    problem, (low, high) = CASES[name]
    gap = SMALL.get(name, 0.01) if FULL else 0.04
    begin = process_time()
    found = bracket(**problem, gap=gap, progress=False)
    seconds = process_time() - begin
    histories[name] = found.history
    rows.append(
        {
            "method": name,
            "n": found.mesh.nelements,
            "lower": round(found.lower, 6),
            "upper": round(found.upper, 6),
            "error": found.gap,
            "elements": found.mesh.nelements,
            "unknowns": found.certificates[1].unknowns,
            "cpu_s": round(seconds, 2),
            "iterations": sum(c.iterations for c in found.history),
        }
    )
    print(
        f"{name:30} [{found.lower:.6g}, {found.upper:.6g}], gap {found.gap:.3%}, "
        f"{found.mesh.nelements} triangles, {seconds:.1f} s"
    )
    assert found.gap <= gap
    assert found.lower <= high * (1 + 1e-6) and found.upper >= low * (1 - 1e-6)

# %%
# Gap over time
# -------------
# Griffiths and Lane 1. The factor of strength reduction converges to the bracket from above; how
# far it is from it, only the bracket tells.


def gaps(history):
    """Gap of the best bounds so far, and processor time."""
    lower, upper, points = 0.0, float("inf"), []
    for c in history:
        lower, upper = (
            (max(lower, c.value), upper) if c.kind == "lower" else (lower, min(upper, c.value))
        )
        if lower > 0 and upper < float("inf"):
            points.append((c.cpu, 2 * (upper - lower) / (upper + lower)))
    return points


problem, _ = CASES["Griffiths and Lane 1"]
reduction = []
for times in range(3 if FULL else 2):
    first = problem["forms"]["soil"]
    basis, fixed = supported(first.basis.mesh.refined(times + 1))
    model = sc.Model({"soil": sc.SolidForm(basis, first.materials["all"])}, fixed)
    begin = process_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sc.AnalysisWarning)
        factor = model.strength_reduction(
            model.weight(20.0), tolerance=0.002, certify=False, progress=False
        ).factor
    reduction.append((process_time() - begin, abs(factor / 1.3772 - 1)))

figure, ax = plt.subplots(figsize=(7, 4), layout="constrained")
ax.loglog(*zip(*gaps(histories["Griffiths and Lane 1"])), "o-", label="gap of the bounds")
ax.loglog(*zip(*reduction), "s-", label="strength reduction, difference from 1.3772")
ax.set(xlabel="processor time [s]", ylabel="relative")
ax.legend(frameon=False)
ax.grid(color="#dddddd", linewidth=0.6)
plt.show()

print(json.dumps({"case": "bounds", "rows": rows}))
