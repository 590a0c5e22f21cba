r"""
Clay whose strength rises with depth
====================================

The undrained strength of normally consolidated clay is :math:`c = c_0 + \rho z` at the depth z.  A
parameter of a material may be a function of the coordinates: the elements take it at their
integration points, the bounds at the corners of their triangles, where a linear one is exact.  Two
problems have references:

- a smooth strip footing of width B, :math:`\rho B / c_0 = 4`: E. H. Davis, J. R. Booker,
  Géotechnique 23 (1973) 551-563 found :math:`q = F (5.14\, c_0 + \rho B / 4)` by slip lines, here
  with F = 1.273,
- a vertical cut: a plane through its toe gives :math:`F \le 4 c_0 / (\gamma H) + 2 \rho / \gamma`,
  which is exact without :math:`c_0` (R. E. Gibson, N. R. Morgenstern, Géotechnique 12 (1962)
  212-216).
"""

# %%
# Footing
# -------
# Half of a stiff footing rests on the ground without friction. The load on it is multiplied until
# the clay collapses.

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc

C0, RHO = 1.0, 4.0
SLIP_LINES = 7.8187  # tests/oracles/strip_on_profile.py
clay = sc.Tresca(E=lambda x: 500.0 * (C0 - RHO * x[1]), nu=0.49, c=lambda x: C0 - RHO * x[1])


def footing(n: int) -> tuple[sc.Model, Basis]:
    """Half of a footing of width 1 on ground down to a depth of 1, with n elements below it."""
    x = np.concatenate(
        (np.linspace(0.0, 0.5, n + 1), 0.5 + 1.5 * np.linspace(0.0, 1.0, 2 * n + 1)[1:] ** 1.5)
    )
    soil = MeshTri.init_tensor(x, -(np.linspace(1.0, 0.0, 2 * n + 1) ** 1.5)).with_defaults()
    plate = MeshTri.init_tensor(
        np.linspace(0.0, 0.5, n + 1), np.array([0.0, 0.1, 0.2])
    ).with_defaults()
    basis = Basis(
        sc.join_bodies({"soil": soil, "plate": plate}), ElementVector(ElementTriP2()), intorder=2
    )
    forms = {
        "soil": sc.SolidForm(basis.with_elements("soil"), clay),
        "plate": sc.SolidForm(basis.with_elements("plate"), sc.LinearElastic(E=1e6, nu=0.3)),
        "base": sc.ContactPair(
            basis, slave="plate:bottom", master="soil:top", law=sc.Coulomb(mu=0.0)
        ),
    }
    sides = [basis.get_dofs(name).all("u^1") for name in ("soil:left", "soil:right", "plate:left")]
    return sc.Model(forms, np.concatenate((basis.get_dofs("soil:bottom").all(), *sides))), basis


begin = process_time()
model, basis = footing(12)
limit = model.limit_load(sc.traction(basis, "plate:top", (0.0, -1.0)))
bracket = footing(3)[0].bounds(
    tractions={"plate:top": (0.0, -1.0)}, live="plate:top", gap=0.07, elements=800
)
print(
    f"q = {limit.multiplier:.3f} by elements, in [{bracket.lower:.3f}, {bracket.upper:.3f}]; slip "
    f"lines {SLIP_LINES}"
)
assert bracket.lower < SLIP_LINES < bracket.upper
assert 0.0 < limit.multiplier / SLIP_LINES - 1.0 < 0.02  # quadratic triangles come from above
rows = [
    {
        "method": "smooth footing, P2",
        "n": 12,
        "unknowns": int(basis.N),
        "error": limit.multiplier / SLIP_LINES - 1.0,
        "cpu_s": round(process_time() - begin, 2),
        "iterations": limit.iterations,
    },
    {
        "method": "smooth footing, gap of the bounds",
        "n": 3,
        "unknowns": 0,
        "error": bracket.gap,
        "cpu_s": 0.0,
        "iterations": 0,
    },
]

# %%
# Vertical cut
# ------------
GAMMA, PLANE = 20.0, 4.0 * 0.5 / 20.0 + 2.0 * 10.0 / 20.0


def cut(n: int) -> sc.Model:
    """Cut of height 1 in clay with the strength 0.5 + 10 z, n elements over the height."""
    grid = MeshTri.init_tensor(
        np.linspace(-1.5, 1.0, 5 * n // 2 + 1), np.linspace(-1.5, 0.0, 3 * n // 2 + 1)
    )
    x, y = grid.p[:, grid.t].mean(axis=1)
    basis = Basis(
        grid.restrict(np.flatnonzero((x < 0.0) | (y < -1.0))),
        ElementVector(ElementTriP2()),
        intorder=2,
    )
    soft = sc.Tresca(E=1e4, nu=0.49, c=lambda x: 0.5 - 10.0 * x[1])
    sides = basis.get_dofs(lambda x: np.isclose(x[0], -1.5) | np.isclose(x[0], 1.0)).all("u^1")
    fixed = np.concatenate((basis.get_dofs(lambda x: np.isclose(x[1], -1.5)).all(), sides))
    return sc.Model({"ground": sc.SolidForm(basis, soft, unit_weight=GAMMA)}, fixed)


begin = process_time()
safety = cut(12).strength_reduction(certify=False)
proof = cut(4).bounds(gap=0.03, elements=1000)
print(
    f"factor {safety.factor:.3f} by elements, in [{proof.lower:.4f}, {proof.upper:.4f}], at most "
    f"{PLANE} by a plane"
)
assert proof.lower < PLANE + 1e-9 and proof.gap < 0.03
assert 0.0 < safety.factor / PLANE - 1.0 < 0.05  # from above
rows.append(
    {
        "method": "vertical cut, gap of the bounds",
        "n": 4,
        "unknowns": 0,
        "error": proof.gap,
        "cpu_s": round(process_time() - begin, 2),
        "iterations": safety.iterations,
    }
)

# %%
# Mechanisms
# ----------
# The share of the dissipation in every triangle of the upper bounds, over its area.
fig, axes = plt.subplots(1, 2, figsize=(10, 3.6), layout="constrained")
for ax, found, title in zip(axes, (bracket, proof), ("smooth footing", "vertical cut")):
    mesh = found.mesh
    a, b, c = mesh.p[:, mesh.t].transpose(1, 0, 2)
    area = np.abs((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0]) / 2.0
    power = found.dissipation / area
    ax.tripcolor(
        *mesh.p, mesh.t.T, np.minimum(power / np.quantile(power, 0.97), 1.0), cmap="magma_r"
    )
    ax.set(aspect="equal", title=title, xlabel="x", ylabel="y")
plt.show()

# %%
# Headline numbers
# ----------------
print(json.dumps({"case": "strength rising with depth", "rows": rows}))
