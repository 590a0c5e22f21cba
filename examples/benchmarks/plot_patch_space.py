r"""
Patch test in space: skewed facets must pass a uniform pressure
===============================================================

Two unit cubes of the same material are pressed together. The facets of the upper one are skewed,
and its mesh is finer than the lower one's: 6 elements on 4 with the linear hexahedra. The stress is
uniform, and what a contact method makes of it is its own error. The sides are free to move
sideways.

* Linear and quadratic tetrahedra; hexahedra of 8, 20 and 27 nodes.
* Gauss points on the facets of the slave, two or three in each direction, or ``"segments"``: Gauss
  points on the pieces into which the facets of both sides divide each other.
* Either cube is the slave.

The largest deviation of the vertical stress from its mean counts, among all integration points.
"""

import json
from itertools import product
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from space_problems import ELEMENTS, YOUNG, patch

import skfem_contact as sc

RULES = {"Gauss(2)": 2, "Gauss(3)": 3, "segments": "segments"}
SLAVES = {"finer": ("upper:bottom", "lower:top"), "coarser": ("lower:top", "upper:bottom")}


def press(element, rule, slave):
    """A row: the deviation, unknowns, points, CPU time and iterations of one problem."""
    problem, begin = patch(element), process_time()
    pair = sc.ContactPair(
        problem.basis, *SLAVES[slave], sc.Coulomb(), RULES[rule], penalty=50 * YOUNG
    )
    forms = {"cubes": problem.solid, "joint": pair}
    stage = sc.Stage("press", problem.basis.zeros(), problem.pressed)
    result = sc.Model(forms, problem.fixed).run([stage], progress=False)
    stress = result[-1].states["cubes"].stress[2]
    return {
        "method": rule,
        "element": element,
        "slave": slave,
        "n": ELEMENTS[element][3],
        "unknowns": int(problem.basis.N),
        "points": len(result[-1].states["joint"].gap),
        "error": float(np.abs(stress / stress.mean() - 1).max()),
        "cpu_s": round(process_time() - begin, 3),
        "iterations": sum(result[-1].iterations),
    }


rows = [press(*choice) for choice in product(ELEMENTS, RULES, SLAVES)]
errors = {(row["element"], row["method"], row["slave"]): row["error"] for row in rows}
print(f"{'slave':14}", *(f"{rule:>10}" for rule in RULES))
for element, slave in product(ELEMENTS, SLAVES):
    print(f"{element}, {slave:10}", *(f"{errors[element, rule, slave]:10.1e}" for rule in RULES))

# %%
# Deviations
# ----------

fig, ax = plt.subplots(figsize=(8, 4), layout="constrained")
position = np.arange(len(ELEMENTS))
for i, (slave, rule) in enumerate(product(SLAVES, RULES)):
    color, hatch = f"C{list(RULES).index(rule)}", "" if slave == "finer" else "//"
    values = [errors[element, rule, slave] for element in ELEMENTS]
    ax.bar(
        position + 0.13 * (i - 2.5),
        values,
        0.12,
        color=color,
        hatch=hatch,
        ec="w",
        label=f"{rule}, {slave} slave",
    )
ax.set(yscale="log", ylabel="largest deviation", ylim=(1e-15, 1e2))
ax.set_xticks(position, list(ELEMENTS))
ax.legend(frameon=False, ncols=2, loc="upper left", fontsize="small")
# %%
# Maps of triangles are affine, so that the integrals over the pieces are exact. On a skewed
# quadrilateral the shape functions are no polynomials of the coordinates, and what is left is the
# error of the rule on a piece: up to 1e-7 with 8 nodes, 4e-6 with 20 and 27.
#
# Headline numbers
# ----------------

for slave in SLAVES:
    for element in ("P1", "P2"):
        assert errors[element, "segments", slave] <= 1e-11
    assert errors["Q1", "segments", slave] <= 1e-7
    assert errors["S2", "segments", slave] <= 1e-6
    assert errors["Q2", "segments", slave] <= 1e-5
assert errors["Q1", "Gauss(2)", "finer"] <= 0.025
assert errors["Q1", "Gauss(3)", "finer"] <= 0.006

plt.show()
print(json.dumps({"case": "patch in space", "rows": rows}))
