r"""
Any penalty to start from
=========================

Two bodies that press on each other penetrate by the pressure over the penalty. A soft penalty gives
a wrong answer. A hard one lets Newton's method chatter between open and closed points, and more
points press than the nodes can follow. The right one lies in between, and a program that asks for a
number leaves finding it to its user. Here the Hertz contact is computed with penalties from 0.01 to
10,000 times E/h:

* with the penalty that was given,
* with the augmented Lagrangian method that starts from it.

The augmented method knows the stiffness k of the elements beside the surfaces, about E/h. It brings
a start that is out of proportion between k/10 and 10 k, goes to 10 k when it has a first solution,
and corrects the tractions until nothing penetrates.

Run with ``--full`` for 20 instead of 5 elements in the half-width of the contact.
"""

import json
import sys
import warnings
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from contact_problems import Contact, E, hertz

import skfem_contact as sc

N = 20 if "--full" in sys.argv else 5
PENALTIES = 10.0 ** np.arange(-2, 5)  # over E/h

METHODS = {"penalty": None, "augmented": sc.AugmentedLagrangian()}

# %%
# Seven penalties
# ---------------
# A penalty that lets the bodies penetrate by more than 1 % of an element is reported by a warning.
# It is silenced here, where this is the point.


def press(penalty, enforcement):
    """One row of the result; the error is infinite where Newton's method failed."""
    begin = process_time()
    problem = hertz(N)
    pair = problem.pair(mu=0.0, quadrature=4, penalty=penalty * E * N, enforcement=enforcement)
    row = {"n": N, "unknowns": int(problem.basis.N), "penalty": penalty}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", sc.AnalysisWarning)
            result = problem.run(pair, [problem.stage("press", increments=4)])
    except sc.NotConverged:
        return {**row, "error": None, "cpu_s": round(process_time() - begin, 3), "iterations": None}
    contact = Contact.of(problem, result[-1].x)
    cpu, iterations = round(process_time() - begin, 3), sum(result[-1].iterations)
    return {
        **row,
        "error": contact.pressure_error,
        "force": contact.normal_force,
        "peak": float(contact.pressure.max()),
        "cpu_s": cpu,
        "iterations": iterations,
    }


rows = [
    {"method": method, **press(penalty, enforcement)}
    for method, enforcement in METHODS.items()
    for penalty in PENALTIES
]
for row in rows:
    reached = (
        "L2 {error:6.2%}  force {force:.4f}  {iterations:3} its" if row["iterations"] else "failed"
    )
    print(("{method:10} {penalty:8g} E/h  " + reached).format(**row))

# %%
# Error and effort:

fig, axes = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
for method, marker in {"penalty": "o-", "augmented": "s-"}.items():
    own = [row for row in rows if row["method"] == method and row["error"] is not None]
    axes[0].loglog(
        [row["penalty"] for row in own], [100 * row["error"] for row in own], marker, label=method
    )
    axes[1].semilogx(
        [row["penalty"] for row in own], [row["iterations"] for row in own], marker, label=method
    )
axes[0].set(xlabel="penalty over E/h", ylabel="L2 error of the pressure [%]")
axes[1].set(xlabel="penalty over E/h", ylabel="iterations in four steps", ylim=(0, None))
axes[0].legend(frameon=False)
for ax in axes:
    ax.grid(alpha=0.3)

# %%
# Headline numbers
# ----------------

augmented = [row for row in rows if row["method"] == "augmented"]
assert all(row["error"] is not None for row in augmented)  # never fails
for quantity in ("force", "peak"):
    values = np.array([row[quantity] for row in augmented])
    print(f"augmented: {quantity} varies by {np.ptp(values) / values.mean():.1e}")
    assert np.ptp(values) <= 1e-3 * values.mean()
iterations = [row["iterations"] for row in augmented]
assert max(iterations) <= 2 * min(iterations)

plt.show()
print(json.dumps({"case": "penalty", "rows": rows}))
