"""Flow of water through deforming ground: Darcy's law, and permeability that depends on strain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from skfem import CellBasis

from ..checks import positive
from .darcy import Tensor, regions
from .moisture import Moisture
from .porous import Numbered, Porous


@dataclass(frozen=True, eq=False)
class Permeability:
    r"""Permeability k that changes with the void ratio e (D. W. Taylor 1948).

    .. math:: k = k_0\, 10^{(e - e_0) / C_k}, \qquad e - e_0 = (1 + e_0)\, \varepsilon_v ,

    where :math:`\varepsilon_v` is the mean volume strain of an element since the water became
    active. Soft clay under a high embankment consolidates several times slower in the end than at
    first.

    Parameters
    ----------
    start
        Permeability :math:`k_0` at the start (length per time), as of :class:`PoreWater`.
    void_ratio
        Void ratio :math:`e_0` at the start, for all ground or by subdomain.
    change
        Change :math:`C_k` of the void ratio by which the permeability changes tenfold, likewise; of
        clay about half of :math:`e_0`.

    Examples
    --------
    A layer that is compressed by a tenth conducts .4 times as well in the end, and its water leaves
    later:

    >>> import numpy as np
    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> mesh = MeshTri.init_tensor(np.array([0., .1]), np.linspace(0, 1, 11)).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    >>> k = sc.water.Permeability(1e-4, void_ratio=1., change=.5)
    >>> forms = {"clay": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.)),
    ...          "water": sc.PoreWater(basis, k, unit_weight=10.)}
    >>> fixed = [sc.box_supports(basis, base="rollers"), forms["water"].dofs("top")]
    >>> load = sc.traction(basis, "top", (0., -100.))
    >>> stages = [sc.Stage("load", load, duration=.2), sc.Stage("wait", load, duration=19.6)]
    >>> result = sc.Model(forms, fixed).run(stages, progress=False)
    >>> settlement = -result["wait"].x[basis.get_dofs("top").all("u^2")].mean() / .1
    >>> round(float(settlement), 2)  # of the final one, for .50 with the permeability at the start
    0.4
    """

    start: Tensor | Mapping[str, Tensor]
    void_ratio: float | Mapping[str, float]
    change: float | Mapping[str, float]

    def rate(self, basis: CellBasis) -> ndarray:
        """Return the slope of log(k) over the volume strain, (n_elements,)."""
        ratio = _by_element(basis, self.void_ratio, "void_ratio")
        tenfold = _by_element(basis, self.change, "change")
        return np.asarray(np.log(10.0) * (1.0 + ratio) / tenfold)


def _by_element(basis: CellBasis, given: float | Mapping[str, float], name: str) -> ndarray:
    values = np.empty(basis.nelems)
    for part, value in regions(basis, given, name):
        values[part] = positive(value, name)
    return values


class Slopes(NamedTuple):
    """Derivatives of the water that leaves the corners of the elements.

    They are over the pressures, (n_elements, n_p, n_p), and over the displacements, (n_elements,
    n_u, n_p), or None where the flow does not depend on these.
    """

    by_pressure: ndarray
    by_strain: ndarray | None


class Conductivity(Numbered):
    """Water that leaves the nodes of the ground by its pressures and volume strains.

    The permeability is constant, or changes with the volume strain of the elements by a `rate`,
    (n_elements,), or falls with the suction of partly saturated ground.
    """

    def __init__(self, porous: Porous, rate: ndarray | None, moisture: Moisture | None) -> None:
        self._porous = porous
        self._rate = rate
        self._moisture = moisture
        #: True if the flow is a linear function of the pressures.
        self.linear = rate is None and moisture is None

    @cached_property
    def saturated(self) -> csr_matrix:
        """Negative flow through saturated ground, on the pattern of all dofs."""
        parts = self._porous
        return parts.matrix(self.first, 0.0 * parts.coupling, -parts.flow, -1.0)

    @cached_property
    def _among_pressures(self) -> csr_matrix:
        return self.saturated[self.first :, self.first :]

    @cached_property
    def _gross(self) -> csr_matrix:
        return abs(self._among_pressures)

    def gross(self, pressure: ndarray) -> ndarray:
        """Return the water that flows in and out of the nodes, (n_vertices,)."""
        return np.asarray(self._gross @ np.abs(pressure))

    def leaving(self, pressure: ndarray, strain: ndarray | None) -> ndarray:
        """Return the water that leaves the nodes in a unit of time, (n_vertices,)."""
        if self.linear:
            return np.asarray(-(self._among_pressures @ pressure))
        parts = self._porous
        return parts.gathered(self._corners(pressure, strain)) + parts.across @ pressure

    def change(
        self,
        middle: ndarray,
        after: ndarray,
        strain_middle: ndarray | None,
        strain_after: ndarray | None,
    ) -> float:
        """Return the sum of the changes of the flow between two pressures."""
        if self.linear:
            difference = self._among_pressures @ (after - middle)
        else:
            difference = self.leaving(after, strain_after) - self.leaving(middle, strain_middle)
        return float(np.abs(difference).sum())

    def round_off(self, pressure: ndarray) -> float | ndarray:
        """Return the round-off of the flow where it is more than the round-off of forces."""
        if self._moisture is None:
            return 0.0
        return self._moisture.round_off(pressure)

    def slopes(self, pressure: ndarray, strain: ndarray | None) -> Slopes:
        """Return the derivatives of the flow of the elements."""
        parts = self._porous
        if self._moisture is None:
            by_pressure = parts.flow
        else:
            by_pressure = self._moisture.passing(pressure)
        if self._rate is None:
            return Slopes(by_pressure, None)
        by_pressure = self._faster(strain)[:, None, None] * by_pressure
        corners = self._corners(pressure, strain)
        by_growth = self._rate[:, None] * parts.growth
        by_strain = by_growth[:, :, None] * corners[:, None, :]
        return Slopes(by_pressure, by_strain)

    def _corners(self, pressure: ndarray, strain: ndarray | None) -> ndarray:
        """Return the water that leaves the corners of the elements, (n_elements, n_p)."""
        parts = self._porous
        if self._moisture is None:
            corners = np.einsum("eij,ej->ei", parts.flow, pressure[parts.corners])
        else:
            corners = self._moisture.leaving(pressure)
        if self._rate is None:
            return corners
        return np.asarray(self._faster(strain)[:, None] * corners)

    def _faster(self, strain: ndarray | None) -> ndarray:
        """Return the permeability over the permeability at the start, (n_elements,)."""
        assert self._rate is not None and strain is not None
        return np.exp(self._rate * strain)
