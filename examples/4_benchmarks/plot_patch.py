r"""
Patch test: a uniform pressure must pass
========================================

Two blocks of the same material are pressed together. The stress is uniform, and a contact method should let
it pass where the meshes do not match (Taylor and Papadopoulos 1991). The lower block has n elements across,
the upper one 1.4 n.

* Four elements: linear and quadratic quadrilaterals and triangles.
* Either block is the slave.
* A level interface, and one with the slope 0.3.
* No friction; or so much that the blocks stick together.

The pressure is the vertical force on each node of the upper block's face over the width that belongs to it,
the stress is that of all integration points. The largest deviation from the mean counts, for the worst of
the four elements' eight problems.
"""

import json
from itertools import product
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from contact_problems import ELEMENTS, LOWER, UPPER, patch, patch_errors

import skfem_contact as sc

N = 5
RULES = {"nodal": "nodal", "Gauss(4)": 4, "segments": "segments"}
SLAVES = {"finer": UPPER, "coarser": LOWER}

# %%
# All problems
# ------------
# The pressure is 0.1 % of E as long as the interface is level. Where it slopes the penetration that a
# penalty leaves shifts the ends of the two faces past each other: the uniform stress is then no solution,
# whatever the rule. The augmented Lagrangian method leaves no penetration, down to its tolerance; it is
# used there with a sharp one, and at ten times the pressure, so that round-off stays below it.


def press(element, slope, stuck, slave, quadrature):
    """Deviations of pressure and stress, and the figures of a run."""
    begin = process_time()
    problem = patch(N, element, slope, stuck)
    options = {"enforcement": sc.AugmentedLagrangian(tolerance=1e-10)} if slope else {}
    pair = problem.pair(1.0 if stuck else 0.0, quadrature, SLAVES[slave], **options)
    stage = problem.stage("press", normal=10.0 if slope else 1.0)
    result = problem.run(pair, [stage], newton=sc.Newton(tolerance=1e-10))
    pressure, stress = patch_errors(problem, result)
    cpu, iterations = round(process_time() - begin, 3), sum(result[-1].iterations)
    return {"n": N, "unknowns": int(problem.basis.N), "error": max(pressure, stress),
            "pressure": pressure, "stress": stress, "cpu_s": cpu, "iterations": iterations}  # fmt: skip


rows = [
    {"method": rule, "element": element, "slave": slave, "slope": slope, "friction": stuck,
     **press(element, slope, stuck, slave, RULES[rule])}
    for rule, element, slave, slope, stuck in product(RULES, ELEMENTS, SLAVES, (0.0, 0.3), (False, True))
]  # fmt: skip


def worst(rule, element, slave):
    """Largest deviation over level and sloping interface, without friction and stuck."""
    keys = {"method": rule, "element": element, "slave": slave}
    return max(row["error"] for row in rows if all(row[key] == value for key, value in keys.items()))


print(f"{'slave':18}", *(f"{rule:>10}" for rule in RULES))
for element, slave in product(ELEMENTS, SLAVES):
    print(f"{element}, {slave:14}", *(f"{worst(rule, element, slave):10.1e}" for rule in RULES))

# %%
# Deviations
# ----------

fig, ax = plt.subplots(figsize=(8, 4), layout="constrained")
place = np.arange(len(ELEMENTS))
for i, (slave, rule) in enumerate(product(SLAVES, RULES)):
    color, hatch = f"C{list(RULES).index(rule)}", "" if slave == "finer" else "//"
    values, label = [worst(rule, element, slave) for element in ELEMENTS], f"{rule}, {slave} slave"
    ax.bar(place + 0.13 * (i - 2.5), values, 0.12, color=color, hatch=hatch, ec="w", label=label)
ax.set(yscale="log", ylabel="largest deviation", ylim=(1e-12, 1e4))
ax.set_xticks(place, list(ELEMENTS))
ax.legend(frameon=False, ncols=2, loc="upper left", fontsize="small");

# %%
# One-pass node-to-segment contact fails by its nature: each node carries the pressure of its own length,
# and the lengths do not balance across the interface. Gauss points weigh the contact as an integral whose
# integrand has kinks at the nodes of the other side, and what remains is the error of the quadrature. It
# shows most in quadratic elements, whose corner nodes take only a sixth of the force on an element, and
# where the coarser face is the slave, so that a Gauss point stands for more of the kinks. Cut at the nodes
# of both sides the integrals are exact.
#
# Headline numbers
# ----------------

for element, slave in product(ELEMENTS, SLAVES):
    assert worst("segments", element, slave) <= 1e-9
    assert worst("nodal", element, slave) <= (0.11 if slave == "finer" else 0.5)
for element in ("Q1", "P1"):
    assert max(worst("Gauss(4)", element, slave) for slave in SLAVES) <= 0.01
for element in ("Q2", "P2"):
    assert worst("Gauss(4)", element, "finer") <= 0.015
    assert worst("Gauss(4)", element, "coarser") <= 0.08

plt.show()
print(json.dumps({"case": "patch", "rows": rows}))
