"""Rigid punches pressed into an elastic box whose edges move as those of a half-plane do: no error
of truncation.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy import ndarray
from scipy.sparse.linalg import spsolve
from skfem import Basis, BilinearForm, FacetBasis

import skfem_contact as sc
from skfem_contact.contact.penalty import choose_penalties
from skfem_contact.results import StageResult
from tests.oracles.halfplane import Potential
from tests.tools.helpers import grid, vector_basis

E, NU = 1000.0, 0.3
#: Below the surface by next to nothing: where the potentials of the body and of its mirror image
#: differ.
_BELOW = -1e-12


def displacement(exact: Potential, x: ndarray | float, y: ndarray | float, deep: float) -> ndarray:
    """Displacements of the symmetric half-plane, (2, ...); the shift along x is taken out at a
    depth y < 0.
    """
    field = exact.displacement(x, np.minimum(y, _BELOW), E, NU)
    field[0] -= exact.displacement(0.0, deep, E, NU)[0]
    return field


@dataclass(frozen=True)
class Indentation:
    """Half of a symmetric box under a punch.

    Attributes
    ----------
    basis, forms
        The box ``0 < x``, ``y < 0`` and its forms, "box" and "punch".
    stage
        What the analysis has found.
    """

    basis: Basis
    forms: dict
    stage: StageResult

    @property
    def force(self) -> float:
        """Force on the punch: twice that of this half."""
        return 2 * float(self._forces.sum())

    @property
    def _forces(self) -> ndarray:
        return -(self.forms["box"].elastic_stiffness @ self.stage.x)[
            self.forms["punch"].slave.dofs[:, 1]
        ]

    @property
    def pressure(self) -> tuple[ndarray, ndarray, ndarray]:
        """Places, lengths and pressures at Gauss points: the field whose work is that of the nodal
        forces.
        """
        top = FacetBasis(self.basis.mesh, self.basis.elem, facets="top", intorder=6)
        dofs = self.forms["punch"].slave.dofs[:, 1]
        mass = BilinearForm(lambda u, v, w: u[1] * v[1]).assemble(top)[dofs][:, dofs]
        field = np.zeros(self.basis.N)
        field[dofs] = spsolve(mass.tocsc(), self._forces)
        return (
            top.global_coordinates()[0].ravel(),
            top.dx.ravel(),
            np.asarray(top.interpolate(field))[1].ravel(),
        )

    def pressure_error(self, exact: Callable[[ndarray], ndarray], within: float) -> float:
        """Error of the pressure on ``x < within`` in the L2 norm, over the norm of the exact one
        there.
        """
        x, dx, computed = self.pressure
        here = x < within
        square = ((computed - exact(x)) ** 2)[here] @ dx[here]
        return float(np.sqrt(square / (exact(x)[here] ** 2 @ dx[here])))

    def displacement_error(self, exact: Potential) -> float:
        """Error of the displacements in the box in the L2 norm, over the norm of the exact ones
        about their mean.
        """
        place = self.basis.global_coordinates()
        field = displacement(exact, place[0], place[1], self.basis.mesh.p[1].min())
        error = np.asarray(self.basis.interpolate(self.stage.x)) - field
        about = (
            field - (field * self.basis.dx).sum(axis=(1, 2), keepdims=True) / self.basis.dx.sum()
        )
        return float(np.sqrt((error**2 * self.basis.dx).sum() / (about**2 * self.basis.dx).sum()))


def pressed(
    element: str, x: ndarray, y: ndarray, exact: Potential, punch: sc.Surface, **options
) -> Indentation:
    """Press a rigid punch into the box that the lines x and y mesh.

    The sides and the bottom move as they do in the half-plane under the exact pressure; the punch
    stands still, at the place that it has in that solution.  Options are those of the pair,
    ``increments`` and ``newton``.
    """
    increments = options.pop("increments", 1)
    newton = options.pop("newton", sc.Newton(tolerance=1e-10, max_iterations=40))
    basis = vector_basis(grid(element, x, y), element, intorder=4)
    options = {"quadrature": "segments", "enforcement": sc.AugmentedLagrangian(1e-5), **options}
    forms = {
        "box": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=NU)),
        "punch": sc.ContactPair(basis, "top", punch, sc.Coulomb(), **options),
    }
    edges = basis.get_dofs({"right", "bottom"}).all()
    fixed = np.union1d(edges, basis.get_dofs("left").all("u^1"))
    field = displacement(exact, *basis.doflocs[:, ::2], y.min()).T.ravel()
    prescribed = np.zeros(basis.N)
    prescribed[edges] = field[edges]
    stage = sc.Stage("press", basis.zeros(), prescribed, increments)
    result = sc.Model(forms, fixed, newton=newton).run([stage], progress=False)
    return Indentation(basis, choose_penalties(forms), result[0])
