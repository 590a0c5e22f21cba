r"""
Finite kinematics against small ones
====================================

A Newton iteration evaluates force and tangent of each solid. How much more do large rotations and
strains cost, with logarithms of tensors at each point and the exact tangent? The small solid only
corrects its elastic stiffness where soil yields; here nearly all points yield. The pairs are timed
by turns, so that other work on the machine concerns both. Run with ``--full`` on a quiet machine,
where the limits of the ratios are checked.
"""

# %%
# Bodies that yield
# -----------------
# Meshes of 10,000 dofs, in one process and one thread.

import json
import sys
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import (
    Basis,
    ElementHex1,
    ElementQuad1,
    ElementQuad2,
    ElementTriP2,
    ElementVector,
    MeshHex,
    MeshQuad,
    MeshTri,
)

import skfem_contact as sc

CLAY = sc.Tresca(E=500.0, nu=0.49, c=1.0)
#: Mesh, element, order of the quadrature, elements a side.
CASES = {
    "Q1": (MeshQuad, ElementQuad1(), 2, 70),
    "Q2": (MeshQuad, ElementQuad2(), 4, 35),
    "P2": (MeshTri, ElementTriP2(), 4, 35),
    "Hex1": (MeshHex, ElementHex1(), 2, 14),
}
#: Largest ratio of the times.
LIMITS = {2: 4.0, 3: 3.0}


def sheared(name, scale):
    """Basis of a square or a cube, and displacements that shear it."""
    kind, element, order, n = CASES[name]
    dim = 3 if kind is MeshHex else 2
    sides = [np.linspace(0.0, 1.0, max(2, round(n * scale)) + 1)] * dim
    basis = Basis(kind.init_tensor(*sides), ElementVector(element), intorder=order)
    x = basis.zeros()
    X = basis.doflocs[:, 0::dim]
    x[0::dim] = 0.01 * (X[0] + X[1]) ** 2
    return basis, x


# %%
# Timings
# -------
# The shortest of several evaluations, by turns.


def seconds(form, x, state):
    """Time of force, and of force and tangent."""
    start = process_time()
    response = form.assemble(x, state)
    force = process_time() - start
    _ = response.stiffness
    return force, process_time() - start


rows = []
FULL = "--full" in sys.argv
sizes = [float(word) for word in sys.argv[1:] if word != "--full"]
scale = sizes[0] if sizes else 1.0
for name in CASES:
    basis, x = sheared(name, scale)
    kinds = {"small": {"strain": "full"}, "finite": {"strain": "full", "kinematics": "finite"}}
    if name in ("Q1", "Hex1"):
        kinds["finite, F-bar"] = {"strain": "f_bar", "kinematics": "finite"}
    forms = {kind: sc.SolidForm(basis, CLAY, **options) for kind, options in kinds.items()}
    states = {kind: form.initial_state() for kind, form in forms.items()}
    best = dict.fromkeys(forms, (np.inf, np.inf))
    for _ in range(6 if FULL else 2):
        for kind, form in forms.items():
            best[kind] = tuple(np.minimum(best[kind], seconds(form, x, states[kind])))
    yielded = np.mean(forms["finite"].assemble(x, states["finite"]).state.internal[0] > 0.0)
    for kind, (force, both) in best.items():
        ratio = both / best["small"][1]
        print(
            f"{name:4s} {basis.N:6d} dofs, {yielded:.0%} yield, {kind:13s}: force "
            f"{1e3 * force:5.1f} ms, force and tangent {1e3 * both:5.1f} ms, {ratio:.1f} times"
        )
        assert not FULL or ratio < LIMITS[basis.mesh.dim()], (name, kind, ratio)
        rows.append(
            {
                "method": f"{name} {kind}",
                "n": basis.mesh.nelements,
                "unknowns": int(basis.N),
                "error": None,
                "cpu_s": both,
                "iterations": 1,
                "ratio": ratio,
            }
        )

# %%

fig, ax = plt.subplots()
labels = [row["method"] for row in rows]
ax.barh(labels, [row["ratio"] for row in rows])
ax.invert_yaxis()
ax.set_xlabel("time of force and tangent over that of small kinematics")
plt.show()

print(json.dumps({"case": "kinematics", "rows": rows}))
