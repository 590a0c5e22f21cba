r"""
Patch test: a uniform pressure must pass
========================================

Two blocks of the same material are pressed together. The stress is uniform, and a contact method
should let it pass where the meshes do not match (Taylor and Papadopoulos 1991). The lower block has
n elements across, the upper one 1.4 n.

* Four elements: linear and quadratic quadrilaterals and triangles.
* Either block is the slave.
* A level interface, and one with the slope 0.3.
* No friction; or so much that the blocks stick together.

The pressure is the vertical force on each node of the upper block's face over the width that
belongs to it, the stress is that of all integration points. The largest deviation from the mean
counts, for the worst of the problems with the same element and slave.

Run with ``--full`` for n = 20 as well, and with ``--peers`` for CalculiX on the four-node
quadrilaterals.
"""

import json
import sys
from itertools import product
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
import peers
from contact_problems import ELEMENTS, LOWER, UPPER, patch, patch_errors

import skfem_contact as sc

FULL, PEERS = "--full" in sys.argv, "--peers" in sys.argv
SIZES = (5, 20) if FULL else (5,)
RULES = {"nodal": "nodal", "Gauss(4)": 4, "segments": "segments"}
SLAVES = {"finer": UPPER, "coarser": LOWER}

# %%
# All problems
# ------------
# The pressure is 0.1 % of E as long as the interface is level. Where it slopes the penetration that
# a penalty leaves shifts the ends of the two faces past each other: the uniform stress is then no
# solution, whatever the rule. The augmented Lagrangian method leaves no penetration, down to its
# tolerance; it is used there with a sharp one, and at ten times the pressure, so that round-off
# stays below it.


def press(n, element, slope, stuck, slave, quadrature):
    """Deviations of pressure and stress, unknowns, CPU time and iterations of one problem."""
    begin = process_time()
    problem = patch(n, element, slope, stuck)
    options = {"enforcement": sc.AugmentedLagrangian(tolerance=1e-10)} if slope else {}
    pair = problem.pair(1.0 if stuck else 0.0, quadrature, SLAVES[slave], **options)
    stage = problem.stage("press", normal=10.0 if slope else 1.0)
    result = problem.run(pair, [stage], newton=sc.Newton(tolerance=1e-10))
    pressure, stress = patch_errors(problem, result[-1].x)
    return pressure, stress, problem.basis.N, process_time() - begin, sum(result[-1].iterations)


def worst(n, rule, element, slave):
    """A row: largest deviations on level and sloping interface, without friction and stuck; sums of
    the efforts.
    """
    runs = [
        press(n, element, slope, stuck, slave, RULES[rule])
        for slope, stuck in product((0.0, 0.3), (False, True))
    ]
    pressure, stress, unknowns, cpu, iterations = zip(*runs)
    return {
        "method": rule,
        "element": element,
        "slave": slave,
        "n": n,
        "unknowns": int(unknowns[0]),
        "error": max(pressure + stress),
        "pressure": max(pressure),
        "stress": max(stress),
        "cpu_s": round(sum(cpu), 3),
        "iterations": sum(iterations),
    }


rows = [
    worst(n, rule, element, slave)
    for n, rule, element, slave in product(SIZES, RULES, ELEMENTS, SLAVES)
]
errors = {(row["n"], row["method"], row["element"], row["slave"]): row["error"] for row in rows}
for n in SIZES:
    print(f"{f'n = {n}, slave':18}", *(f"{rule:>10}" for rule in RULES))
    for element, slave in product(ELEMENTS, SLAVES):
        print(
            f"{element}, {slave:14}",
            *(f"{errors[n, rule, element, slave]:10.1e}" for rule in RULES),
        )

# %%
# CalculiX on the level interface without friction, if asked for. It runs with the penalty that its
# manual advises.

methods = {
    "CalculiX, surface to surface": peers.SURFACE_TO_SURFACE,
    "CalculiX, node to surface": peers.NODE_TO_SURFACE,
}
for n, (name, method) in product(SIZES if PEERS and peers.available() else (), methods.items()):
    problem = patch(n)
    run = peers.calculix(problem, [problem.stage("press")], mu=0.0, method=method)
    if run.x is not None:
        pressure, stress = patch_errors(problem, run.x)
        rows.append(
            {
                "method": name,
                "element": "Q1",
                "slave": "finer",
                "n": n,
                "unknowns": int(problem.basis.N),
                "error": max(pressure, stress),
                "pressure": pressure,
                "stress": stress,
                "cpu_s": run.cpu,
                "iterations": run.iterations,
            }
        )
        print(f"{name}, n = {n}: {max(pressure, stress):.1e}")

# %%
# Deviations
# ----------

fig, ax = plt.subplots(figsize=(8, 4), layout="constrained")
position = np.arange(len(ELEMENTS))
for i, (slave, rule) in enumerate(product(SLAVES, RULES)):
    color, hatch = f"C{list(RULES).index(rule)}", "" if slave == "finer" else "//"
    values, label = (
        [errors[5, rule, element, slave] for element in ELEMENTS],
        f"{rule}, {slave} slave",
    )
    ax.bar(position + 0.13 * (i - 2.5), values, 0.12, color=color, hatch=hatch, ec="w", label=label)
ax.set(yscale="log", ylabel="largest deviation", ylim=(1e-12, 1e4))
ax.set_xticks(position, list(ELEMENTS))
ax.legend(frameon=False, ncols=2, loc="upper left", fontsize="small")
# %%
# One-pass node-to-segment contact fails by its nature: each node carries the pressure of its own
# length, and the lengths do not balance across the interface. Gauss points weigh the contact as an
# integral whose integrand has kinks at the nodes of the master, and what remains is the error of
# the quadrature there. Cut at the nodes of both sides the integrals are exact.
#
# At the corner nodes of quadratic elements the kink is three times as sharp as at those of linear
# ones, and the force is a third, so that the same points are wrong by nine times as much. It is the
# distance of the master's nodes that the points must resolve: slave segments that are longer are
# divided into pieces, with four points on each. That is so here for all quadratic elements, which
# are cut in two or three, and for the linear ones where the coarser face is the slave.
#
# Headline numbers
# ----------------

for n, element, slave in product(SIZES, ELEMENTS, SLAVES):
    assert errors[n, "segments", element, slave] <= 1e-9
    assert errors[n, "Gauss(4)", element, slave] <= 0.01
    assert errors[n, "nodal", element, slave] <= (0.11 if slave == "finer" else 0.5)

plt.show()
print(json.dumps({"case": "patch", "rows": rows}))
