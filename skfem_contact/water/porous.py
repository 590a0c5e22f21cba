"""Ground with water in its pores: what pressures do to its elements, what these store, and what flows through them."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix
from skfem import CellBasis

from ..errors import place
from ..forms.base import Form
from ..forms.solid import SolidForm
from ..forms.strain import strain_operator
from ..layout import elements_of, linear_element
from .conditions import open_joints, pressed

#: Name under which all ground shares the field of its pore pressures.
PRESSURE = "pore pressure"


@dataclass(frozen=True, eq=False)
class Porous:
    """Matrices of the elements.

    Attributes
    ----------
    basis
        Basis of the displacements.
    pressures
        Basis of the pressures, linear, at the same integration points.
    coupling
        Volume strain weighted with the shape functions of the pressure, (n_elements, n_u, n_p).
    mass
        Products of these shape functions, (n_elements, n_p, n_p).
    spread
        The same of what they differ by from their means over the element.
    flow
        Products of their gradients, with the permeability.
    conductance
        Water that leaves the nodes by a pressure of one there, (N,).
    across
        Water that leaves the nodes through joints, (N, N), by pressures.
    open
        Nodes at joints.
    """

    basis: CellBasis
    pressures: CellBasis
    coupling: ndarray
    mass: ndarray
    spread: ndarray
    flow: ndarray
    conductance: ndarray
    across: coo_matrix
    open: ndarray

    @classmethod
    def of(cls, basis: CellBasis, measure: tuple[str, str], mobility: ndarray, joints: Sequence[tuple[str, str]] = ()
           ) -> Porous:
        """Integrate the matrices: strain measure and coordinates, permeability over unit weight of water (n_elements, d, d).

        Water in joints presses on their sides, and what they open by it fills.
        """
        pressures = basis.with_element(linear_element(basis.mesh))
        B, weight = strain_operator(basis, *measure)
        shapes = [pressures.basis[j][0] for j in range(pressures.Nbfun)]
        N = np.stack([np.broadcast_to(np.asarray(shape), weight.shape) for shape in shapes])
        gradients = np.stack([np.asarray(shape.grad) for shape in shapes])
        coupling = np.einsum("eqb,jeq,eq->ebj", B[:, :, :3].sum(axis=2), N, weight)
        mass = np.einsum("ieq,jeq,eq->eij", N, N, weight, optimize=True)
        mean = np.einsum("ieq,eq->ei", N, weight)
        spread = mass - mean[:, :, None] * mean[:, None, :] / weight.sum(axis=1)[:, None, None]
        flow = np.einsum("ikeq,ekl,jleq,eq->eij", gradients, mobility, gradients, weight, optimize=True)
        conductance = _at_nodes(pressures, np.einsum("eii->ei", flow))
        across, sides = open_joints(pressures, joints, conductance)
        coupling = coupling - pressed(basis, pressures, sides, measure[1] == "axisymmetric")
        return cls(basis, pressures, coupling, mass, spread, flow, conductance, across,
                   np.unique(basis.mesh.facets[:, sides]))

    @property
    def linear(self) -> bool:
        """Whether displacements and pressures have the same nodes: such pairs are not stable by themselves."""
        return self.basis.Nbfun == self.basis.mesh.dim() * self.pressures.Nbfun

    def symmetric(self, first: int, coupling: ndarray, water: ndarray, across: float = 0.0) -> csr_matrix:
        """Matrix of all unknowns, of which the pressures begin with a number; its pattern is the same each time.

        With it goes `across` times what passes through joints.
        """
        u, p = self.basis.element_dofs.T, first + self.pressures.element_dofs.T
        blocks = ((u, p, coupling), (p, u, coupling.transpose(0, 2, 1)), (p, p, water))
        rows = [np.broadcast_to(r[:, :, None], values.shape).ravel() for r, _, values in blocks]
        columns = [np.broadcast_to(c[:, None], values.shape).ravel() for _, c, values in blocks]
        data = np.concatenate([*(values.ravel() for *_, values in blocks), across * self.across.data])
        places = np.concatenate([*rows, first + self.across.row]), np.concatenate([*columns, first + self.across.col])
        return csr_matrix(coo_matrix((data, places), 2 * (first + self.pressures.N,)))

    def at_nodes(self, density: ndarray) -> ndarray:
        """Integrals of something that elements have, (n_elements,), by the nodes that they belong to, (n_p,)."""
        return _at_nodes(self.pressures, self.mass.sum(axis=2) * density[:, None])


def _at_nodes(basis: CellBasis, values: ndarray) -> ndarray:
    """Sums of what the corners of the elements have, (n_elements, n_corners)."""
    return np.bincount(basis.element_dofs.T.ravel(), values.ravel(), minlength=basis.N)


class Surroundings(NamedTuple):
    """What the water takes from the other forms.

    Attributes
    ----------
    modulus, shear
        Stiffness of the ground in compression without lateral strain, and in shear, (n_elements,).
    leaks
        Whether water leaves through another form.
    touching
        Displacements that contact acts on, by its name.
    measure
        Strain measure and coordinates of the solids.
    """

    modulus: ndarray
    shear: ndarray
    leaks: bool
    touching: Mapping[str, ndarray]
    measure: tuple[str, str]

    @classmethod
    def of(cls, basis: CellBasis, forms: Mapping[str, Form]) -> Surroundings:
        """Collect the forms around the ground of a basis, all of which must belong to solids."""
        mesh, here = basis.mesh, elements_of(basis)
        modulus, shear = np.full((2, mesh.nelements), np.nan)
        measures = set()
        for name, form in forms.items():
            for region in form.regions if isinstance(form, SolidForm) else ():
                elements = form.elements[region.elements]
                if np.isin(elements, here).any():
                    measures.add((form.strain, form.coordinates))
                D = region.material.elasticity(4 if mesh.dim() == 2 else 6)
                modulus[elements], shear[elements] = D[..., 0, 0], D[..., 3, 3]
                if region.material.undrained and np.isin(elements, here).any():
                    raise ValueError(f"region '{region.name}' of '{name}' is Undrained and has PoreWater too: its "
                                     "water would count twice; give its soil alone")
        lost = here[np.isnan(modulus[here])]
        if len(lost):
            raise ValueError(f"there is PoreWater in {len(lost)} elements of no SolidForm, the first at "
                             f"{place(mesh.p[:, mesh.t[:, lost[0]]].mean(axis=1))}")
        if len(measures) > 1:
            raise ValueError(f"the solids of the porous ground have different strains, {sorted(measures)}: give all of "
                             "them the same `strain`")
        joins = {name: form.joins for name, form in forms.items() if form.joins is not None}
        touching = {name: at for name, at in joins.items()
                    if forms[name].unilateral and np.isin(at, basis.element_dofs).any()}
        leaks = any(field.shared == PRESSURE for form in forms.values() for field in form.borrowed)
        return cls(modulus[here], shear[here], leaks, touching, measures.pop())


@dataclass(frozen=True)
class PoreState:
    """What the water in the ground around the nodes remembers, (n,) each, of all vertices of the mesh.

    Attributes
    ----------
    stored
        Volume of water, more than in undeformed ground.
    first
        The same when the ground became active.
    entered
        Water that has entered at the nodes since: not zero only where pressures are given, or other ground begins.
    pressure
        Excess pore pressure, positive in compression.
    """

    stored: ndarray
    first: ndarray
    entered: ndarray
    pressure: ndarray
