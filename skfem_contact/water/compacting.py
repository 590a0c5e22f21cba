"""Consolidation of ground whose permeability changes with its void ratio."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from skfem import CellBasis
from typing_extensions import Self, override

from ..checks import positive
from ..forms.base import Form, Response
from ..sparse import with_data
from .consolidation import PoreWater
from .darcy import Permeability, regions
from .porous import FLOWING, PoreState


@dataclass(frozen=True)
class CompactedState(PoreState):
    """State of the water around the nodes, and the volume strain of the elements, (n_elements,)
    each.

    Attributes
    ----------
    strain
        Mean volume strain since the water became active.
    before
        Part of it that displacements do not contain, because they were reset or the ground was
        active before.
    """

    strain: ndarray
    before: ndarray


class CompactingPoreWater(PoreWater):
    r"""Water in saturated ground whose permeability k changes with the void ratio e (D. W. Taylor
    1948).

    This is :class:`PoreWater` with

    .. math:: k = k_0\, 10^{(e - e_0) / C_k}, \qquad e - e_0 = (1 + e_0)\, \varepsilon_v ,

    where :math:`\varepsilon_v` is the mean volume strain of an element since the water became
    active. Soft clay under a high embankment consolidates several times slower in the end than at
    first.

    Parameters
    ----------
    basis, permeability, unit_weight, storage, time_error
        As for :class:`PoreWater`; the permeability is that at the start.
    void_ratio
        Void ratio :math:`e_0` at the start, for all ground or by subdomain.
    change
        Change :math:`C_k` of the void ratio by which the permeability changes tenfold, likewise; of
        clay about half of
        :math:`e_0`.

    Examples
    --------
    A layer that is compressed by a tenth conducts .4 times as well in the end, and its water leaves
    later:

    >>> import numpy as np
    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> mesh = MeshTri.init_tensor(np.array([0., .1]), np.linspace(0, 1, 11)).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    >>> forms = {"clay": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.)),
    ...          "water": sc.water.CompactingPoreWater(basis, 1e-4, void_ratio=1., change=.5, unit_weight=10.)}
    >>> model = sc.Model(forms, [sc.box_supports(basis, base="rollers"), forms["water"].dofs("top")])
    >>> load = sc.traction(basis, "top", (0., -100.))
    >>> stages = [sc.Stage("load", load, duration=.2), sc.Stage("wait", load, duration=19.6)]
    >>> result = model.run(stages, progress=False)
    >>> settlement = -result["wait"].x[basis.get_dofs("top").all("u^2")].mean() / .1
    >>> round(float(settlement), 2)  # of the final one, for .50 with the permeability at the start
    0.4
    """

    symmetric = False

    def __init__(
        self,
        basis: CellBasis,
        permeability: Permeability | Mapping[str, Permeability],
        *,
        void_ratio: float | Mapping[str, float],
        change: float | Mapping[str, float],
        unit_weight: float,
        storage: float | Mapping[str, float] = 0.0,
        time_error: float = 0.01,
    ) -> None:
        super().__init__(
            basis, permeability, unit_weight=unit_weight, storage=storage, time_error=time_error
        )
        start, tenfold = np.empty((2, basis.nelems))
        for values, given, name in ((start, void_ratio, "void_ratio"), (tenfold, change, "change")):
            for part, value in regions(basis, given, name):
                values[part] = positive(value, name)
        self._rate = np.log(10.0) * (1.0 + start) / tenfold

    @override
    def continues(self, old: Form) -> Self:
        new = super().continues(old)
        assert isinstance(new, type(self)) and isinstance(old, CompactingPoreWater)
        if not np.array_equal(old._rate, self._rate):
            raise ValueError("its void ratio or the change is another")
        return new

    @override
    def initial_state(self, x: ndarray | None = None) -> CompactedState:
        strain = np.zeros(self.ground.nelems) if x is None else self._grown(x)
        return CompactedState(**vars(super().initial_state(x)), strain=0.0 * strain, before=-strain)

    @cached_property
    def _growth(self) -> ndarray:
        """Mean volume strain of the elements by their dofs, (n_elements, n_u)."""
        parts = self.porous
        return np.asarray(parts.coupling.sum(axis=2) / parts.mass.sum(axis=(1, 2))[:, None])

    def _grown(self, x: ndarray) -> ndarray:
        return np.asarray(np.einsum("eb,eb->e", self._growth, x[self.ground.element_dofs.T]))

    def _leaving(self, pressure: ndarray, strain: ndarray) -> ndarray:
        """Return the water that leaves the corners in a unit of time, (n_elements, n_corners)."""
        by_corner = np.einsum(
            "eij,ej->ei", self.porous.flow, pressure[self.pressures.element_dofs.T]
        )
        return np.asarray(np.exp(self._rate * strain)[:, None] * by_corner)

    def _at_nodes(self, corners: ndarray) -> ndarray:
        return np.bincount(
            self.pressures.element_dofs.T.ravel(), corners.ravel(), minlength=self.fields[0].n
        )

    @override
    def assemble(self, x: ndarray, state: PoreState) -> Response:
        if self._duration is None:
            return self._standing(x, state)
        assert isinstance(state, CompactedState)
        first, pressure, strain = self.first, x[self.first :], self._grown(x) + state.before
        leaving, kept = self._duration * self._leaving(pressure, strain), self._kept @ x
        gained, force, measure = kept[first:] + state.stored, kept.copy(), kept.copy()
        force[first:] = gained - self._at_nodes(leaving)
        measure[first:] = np.abs(gained) + FLOWING * self._duration * (
            self._flow[1] @ np.abs(pressure)
        )
        new = replace(
            state,
            stored=-kept[first:],
            entered=state.entered - force[first:],
            pressure=pressure,
            strain=strain,
        )
        return Response(force, lambda: new, lambda: self._tangent(strain, leaving), measure=measure)

    def _tangent(self, strain: ndarray, leaving: ndarray) -> csr_matrix:
        assert self._duration is not None
        parts, kept = self.porous, self._kept
        passing = self._duration * np.exp(self._rate * strain)[:, None, None] * parts.flow
        faster = (self._rate[:, None] * self._growth)[:, :, None] * leaving[:, None, :]
        flow = parts.matrix(self.first, 0.0 * parts.coupling, -passing, squeezed=-faster)
        return with_data(kept, kept.data + flow.data)

    @override
    def time_error(self, middle: PoreState, after: PoreState) -> tuple[float, float]:
        assert (
            self._duration is not None
            and isinstance(middle, CompactedState)
            and isinstance(after, CompactedState)
        )
        change = self._leaving(after.pressure, after.strain) - self._leaving(
            middle.pressure, middle.strain
        )
        water = super().time_error(middle, after)[1]
        flowed = float(np.abs(self._at_nodes(change)).sum())
        return 0.5 * self._duration * flowed / self._time_error, water

    @override
    def rebased(self, x: ndarray, state: PoreState) -> PoreState:
        new = super().rebased(x, state)
        assert isinstance(new, CompactedState)
        return replace(new, before=new.before + self._grown(x))
