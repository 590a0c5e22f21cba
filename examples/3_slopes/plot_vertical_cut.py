r"""
Height of a vertical cut in clay
================================

How high can a vertical cut in undrained clay stand?  The stability number :math:`\gamma H / c` of
this classical problem has no closed form; limit analysis brackets it between 3.772 (Lyamin and
Sloan) and 3.786.  Here the weight of the ground is raised by indirect continuation until the cut
fails.  Quadratic triangles do not lock, so the number falls towards the bracket as the mesh is
refined.
"""

# %%
# Model
# -----
# Height 1, strength 1: the multiplier of a unit weight at collapse is the stability number.  The
# mesh is cut out of a grid that is finer towards the toe, each of its quadrilaterals divided into
# four triangles.

import json
import sys
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshQuad

import skfem_contact as sc

LOWER, REFERENCE = 3.772, 3.776  # rigorous lower bound, best estimate
WIDTH, DEPTH = 2.0, 1.0


def ground(n: int) -> Basis:
    """Ground with a cut of height 1 to the right of x = 0; n elements over the height."""
    x = np.concatenate(
        (
            -WIDTH * np.linspace(1, 0, 3 * n // 2 + 1) ** 1.3,
            WIDTH * np.linspace(0, 1, n + 1)[1:] ** 1.5,
        )
    )
    y = np.concatenate(
        (-DEPTH * np.linspace(1, 0, n // 2 + 1) ** 1.3, np.linspace(0, 1, n + 1)[1:])
    )
    grid = MeshQuad.init_tensor(x, y)
    middle = grid.p[:, grid.t].mean(axis=1)
    cut = grid.restrict(np.flatnonzero((middle[0] < 0) | (middle[1] < 0)))
    return Basis(cut.to_meshtri(style="x"), ElementVector(ElementTriP2()), intorder=2)


# %%
# Collapse
# --------
rows = []
for n in (6, 12, 24) if "--full" in sys.argv else (6, 12):
    begin = process_time()
    basis = ground(n)
    forms = {"ground": sc.SolidForm(basis, sc.Tresca(E=1e4, nu=0.49, c=1.0))}
    sides = basis.get_dofs(lambda x: np.isclose(np.abs(x[0]), WIDTH)).all("u^1")
    fixed = np.concatenate((basis.get_dofs(lambda x: np.isclose(x[1], -DEPTH)).all(), sides))
    limit = sc.Model(forms, fixed).limit_load(sc.weight(basis, 1.0))
    rows.append(
        {
            "method": "P2, continuation",
            "n": n,
            "unknowns": int(basis.N),
            "error": limit.multiplier / REFERENCE - 1,
            "cpu_s": round(process_time() - begin, 2),
            "iterations": limit.iterations,
        }
    )
    print(
        f"{basis.N:6d} unknowns  gamma H / c = {limit.multiplier:.3f}  ({rows[-1]['error']:+.2%})  "
        f"{limit.iterations} iterations"
    )
    assert limit.multiplier > LOWER

errors = [row["error"] for row in rows]
assert errors == sorted(errors, reverse=True)  # from above
assert errors[-1] <= 0.03

# %%
# Mechanism
# ---------
# The shear strain of the mechanism: a block slides out on a slightly curved band through the toe.
mesh = basis.mesh
bands = limit.bands["ground"].mean(axis=1)
fig, (left, right) = plt.subplots(1, 2, figsize=(10, 4), width_ratios=(1.3, 1))
left.tripcolor(mesh.p[0], mesh.p[1], mesh.t.T, np.sqrt(bands / bands.max()), cmap="magma_r")
left.set(
    aspect="equal",
    xlim=(-1.5, 1),
    ylim=(-0.6, 1.02),
    xlabel="x / H",
    ylabel="y / H",
    title="shear strain of the mechanism",
)
work, multiplier, displacement = limit.curve.T
right.plot(displacement / displacement[0], multiplier, "o-", ms=3)
right.axhspan(LOWER, 3.786, color="0.85")
right.set(
    xlabel="largest displacement over that of the first step",
    ylabel=r"$\gamma H / c$",
    title="curve to collapse",
)
fig.tight_layout()
plt.show()

# %%
# Headline numbers
# ----------------
print(json.dumps({"case": "vertical cut", "rows": rows}))
