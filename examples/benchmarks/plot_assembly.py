r"""
Tangent and force against scikit-fem's forms
============================================

A Newton iteration needs the internal force and the tangent of every solid. Both can be written as
forms of scikit-fem, with the stresses and moduli at the integration points as their coefficients:

.. math:: f_i = \int \varepsilon(v_i) \cdot \sigma, \qquad K_{ij} = \int \varepsilon(v_i) \cdot
   D\,\varepsilon(u_j).

``SolidForm`` computes the same numbers from matrices that are prepared once per mesh. What does
that gain, with a fifth of the elements yielding? The return mapping is the same for both; it is
timed on its own.
"""

# %%
# The forms
# ---------
# Strains are those of Voigt's notation, as arrays of three components: the four of ``SolidForm``
# without the one out of plane, which vanishes.

import json
import sys
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import (
    Basis,
    BilinearForm,
    ElementQuad1,
    ElementTriP2,
    ElementVector,
    LinearForm,
    MeshQuad,
    MeshTri,
)

import skfem_contact as sc
from skfem_contact.materials import Update

IN_PLANE = np.array([0, 1, 3])


def strain(u):
    """Components xx, yy, xy of the strain of a field."""
    grad = np.asarray(u.grad)
    return grad[0, 0], grad[1, 1], grad[0, 1] + grad[1, 0]


@LinearForm
def internal_force(v, w):
    """Work of the stresses."""
    return sum(e * s for e, s in zip(strain(v), np.asarray(w.stress)))


@BilinearForm
def tangent(u, v, w):
    """Work of the change of the stresses: written out, which is twice as fast as ``einsum``."""
    return sum(
        e * (D[0] * xx + D[1] * yy + D[2] * xy)
        for xx, yy, xy in [strain(u)]
        for e, D in zip(strain(v), np.asarray(w.moduli))
    )


# %%
# A layer of soil of which a fifth yields
# ---------------------------------------
# Everything is compressed, and what lies left of ``x = 0.2`` is sheared far beyond its strength.

soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=5.0, phi=25.0, psi=5.0)
ELEMENTS = {"Q1": (MeshQuad, ElementQuad1(), (1, 1)), "P2": (MeshTri, ElementTriP2(), (2, 1))}


def scene(element, n):
    """Basis of about n elements, displacements."""
    kind, shape, (across, up) = ELEMENTS[element]
    cells = round((n / (across * up) / (2 if kind is MeshTri else 1)) ** 0.5)
    mesh = kind.init_tensor(
        np.linspace(0, 1, across * cells + 1), np.linspace(0, 1, up * cells + 1)
    )
    p = mesh.p + 0.2 / (2 * cells) * np.sin(40 * mesh.p[::-1]) * (
        np.prod(mesh.p * (1 - mesh.p), axis=0) > 1e-9
    )
    basis = Basis(kind(p, mesh.t), ElementVector(shape), intorder=2)
    x, y = basis.doflocs[:, ::2]
    u = np.stack((0 * x, -1e-3 * y - 0.05 * np.minimum(x - 0.2, 0.0)), axis=1)
    return basis, u.ravel()


class Returned:
    """A material that has been asked before: it repeats its answer."""

    n_internal = soil.n_internal
    elasticity = staticmethod(soil.elasticity)

    def __init__(self, answer):
        moduli = answer.tangent()
        self.answer = answer._replace(tangent=lambda: moduli)

    def update(self, strain_increment, stress, internal) -> Update:
        """The answer."""
        return (
            self.answer
            if internal.size == self.answer.internal.size
            else soil.update(strain_increment, stress, internal)
        )


# %%
# Timings
# -------
# The shortest of some runs; the other way round begins with the displacements as well.


def shortest(function, times=5):
    """Result and processor time of a function."""
    best, result = np.inf, None
    for _ in range(times):
        begin = process_time()
        result = function()
        best = min(best, process_time() - begin)
    return result, best


def compare(element, n):
    """Rows of figures of a mesh."""
    basis, x = scene(element, n)
    form = sc.SolidForm(basis, soil, "full")
    state = form.initial_state()
    strains = np.zeros_like(state.strain)
    strains[IN_PLANE] = np.stack(strain(basis.interpolate(x)))
    answer, mapping = shortest(lambda: soil.update(strains, state.stress, state.internal))
    moduli = np.broadcast_to(soil.elasticity(4)[:, :, None], (4, 4, strains[0].size)).copy()
    moduli[:, :, answer.plastic] = answer.tangent().transpose(1, 2, 0)
    moduli = moduli[np.ix_(IN_PLANE, IN_PLANE)].reshape(3, 3, *strains[0].shape)
    share = len(np.unique(answer.plastic // strains.shape[2])) / basis.nelems

    def by_forms():
        strain(basis.interpolate(x))
        return tangent.assemble(basis, moduli=moduli), internal_force.assemble(
            basis, stress=answer.stress[IN_PLANE]
        )

    form = form.with_materials({"all": Returned(answer)})
    form.elastic_stiffness  # once per analysis

    def ours():
        response = form.assemble(x, state)
        return response.stiffness, response.force

    (K, f), fast = shortest(ours)
    (K_forms, f_forms), slow = shortest(by_forms, 3)
    error = max(
        abs(K - K_forms).max() / abs(K_forms).max(), abs(f - f_forms).max() / abs(f_forms).max()
    )
    common = {
        "n": basis.nelems,
        "unknowns": int(basis.N),
        "iterations": None,
        "yielding": round(share, 3),
    }
    return [
        {"method": f"{element}, forms of scikit-fem", "error": 0.0, "cpu_s": slow, **common},
        {
            "method": f"{element}, SolidForm",
            "error": float(error),
            "cpu_s": fast,
            **common,
            "times_faster": slow / fast,
        },
        {"method": f"{element}, return mapping", "error": 0.0, "cpu_s": mapping, **common},
    ]


# %%
# Both ways give the same matrix and the same force up to round-off.

sizes = (2_500, 10_000, 40_000) if "--full" in sys.argv else (1_000, 2_500)
rows = [row for element in ELEMENTS for n in sizes for row in compare(element, n)]
for row in rows:
    print(
        f"{row['method']:28} {row['n']:6} elements {1e3 * row['cpu_s']:8.2f} ms"
        f"   error {row['error']:.0e}  {row.get('times_faster', 0):5.1f} times faster"
    )
    assert row["error"] < 1e-12
    assert 0.15 < row["yielding"] < 0.25
if "--full" in sys.argv:
    assert all(
        row["times_faster"] > 12
        for row in rows
        if row["n"] >= 39_000 and "SolidForm" in row["method"]
    )

# %%
# Time of one tangent and one force:

fig, ax = plt.subplots(figsize=(7, 4), layout="constrained")
for element, color in zip(ELEMENTS, ("#d55e00", "#1f4e8c")):
    for method, style in (("forms of scikit-fem", "o--"), ("SolidForm", "o-")):
        points = [row for row in rows if row["method"] == f"{element}, {method}"]
        ax.loglog(
            [row["n"] for row in points],
            [row["cpu_s"] for row in points],
            style,
            color=color,
            label=points[0]["method"],
        )
ax.set(xlabel="elements", ylabel="processor time [s]")
ax.grid(color="#dddddd", linewidth=0.6)
ax.legend(frameon=False)
plt.show()

# %%
# Figures
# -------

print(json.dumps({"case": "assembly", "rows": rows}))
