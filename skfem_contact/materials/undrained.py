"""Ground from which no water can leave: any law in effective stresses, and water in its pores."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..errors import AnalysisWarning
from .base import Array, Material, Parameter, Update, along_elements, as_parameter, require
from .reduction import Flow, check_reduction


@dataclass(frozen=True, eq=False)
class Undrained:
    r"""A soil whose pores are full of water that cannot leave.

    The soil takes the strain with its own, effective parameters; the water resists its volume part. With the bulk
    modulus :math:`K_w` of the water over the porosity the excess pore pressure, positive in compression, grows by
    :math:`-K_w\,\Delta\varepsilon_v`, and the stress of this material is the effective stress less that pressure. It
    is the last internal variable, see :meth:`~skfem_contact.results.StageResult.pore_pressure`.

    Parameters
    ----------
    soil : Material
        The law in effective stresses: any material.
    Kw : float or ndarray, optional
        Bulk modulus of the water over the porosity (stress), not negative; a float or one value an element.
    nu_u : float or ndarray, optional
        Poisson's ratio of the soil and its water, for instance 0.495, in place of `Kw`:
        :math:`K_w = 2 G (1 + \nu_u) / (3 (1 - 2 \nu_u)) - K`.

    Raises
    ------
    ValueError
        Both or none of `Kw` and `nu_u`, one that is out of its range, or `nu_u` below the soil's own ratio.

    Warns
    -----
    AnalysisWarning
        The soil dilates: undrained it then gets stronger without end.

    Notes
    -----
    Elements must bear nearly constant volume: quadratic triangles or :func:`~skfem_contact.b_bar`. The error of a
    finite `Kw` is about :math:`K / K_w`.

    Examples
    --------
    Isotropic compression by 1: nearly all of it is taken by the water.

    >>> import numpy as np
    >>> from skfem_contact.materials import LinearElastic, Undrained
    >>> clay = Undrained(LinearElastic(E=3., nu=0.), Kw=99.)
    >>> strain = np.array([[-.01], [0.], [0.], [0.]])
    >>> new = clay.update(strain, np.zeros((4, 1)), np.zeros((2, 1)))
    >>> new.stress[:3].mean().round(12), new.internal[-1].round(12)
    (np.float64(-1.0), array([0.99]))
    """

    soil: Material
    Kw: Parameter | None = None
    nu_u: Parameter | None = None

    def __post_init__(self) -> None:
        if (self.Kw is None) == (self.nu_u is None):
            raise ValueError("an undrained soil needs either Kw or nu_u")
        if not hasattr(self.soil, "update") or isinstance(self.soil, type | Undrained):
            raise ValueError(f"the soil must be a material in effective stresses, not {self.soil!r}")
        for name in ("Kw", "nu_u"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, as_parameter(name, getattr(self, name)))
        if self.nu_u is not None:
            require("nu_u", self.nu_u, np.less(self.nu_u, 0.5), "be less than 0.5")
        require("Kw" if self.nu_u is None else "Kw (from nu_u)", self.bulk_modulus,
                np.greater_equal(self.bulk_modulus, 0), "not be negative")
        if np.any(np.greater(getattr(self.soil, "psi", 0.0), 0.0)):
            warnings.warn("a soil that dilates, psi > 0, gets stronger without end where its water cannot leave; "
                          "undrained soils take psi=0", AnalysisWarning, stacklevel=3)

    @property
    def bulk_modulus(self) -> Parameter:
        """Bulk modulus of the water over the porosity."""
        if self.Kw is not None:
            return self.Kw
        D, nu_u = self.soil.elasticity(4), np.asarray(self.nu_u, dtype=float)
        shear, bulk = D[..., 3, 3], D[..., :3, :3].mean(axis=(-1, -2))
        return as_parameter("Kw", 2 * shear * (1 + nu_u) / (3 * (1 - 2 * nu_u)) - bulk)

    @property
    def n_internal(self) -> int:
        """Those of the soil, of which the first is its plastic strain (zero where it has none), and the pressure."""
        return max(self.soil.n_internal, 1) + 1

    @property
    def symmetric(self) -> bool:
        """The tangent is symmetric if that of the soil is."""
        return getattr(self.soil, "symmetric", False)

    @property
    def reduced(self) -> Callable[..., Undrained]:
        """``reduced(factor, flow="given")``: the strength of the soil divided by a factor, if it has a strength.

        The flow has no effect: without drainage soil with psi = 0 flows in its total stresses as :class:`Tresca` does,
        associated, and with the dilation of an associated soil it would have no limit.
        """
        weaker: Any = self.soil.reduced  # type: ignore[attr-defined]

        def reduced(factor: float, flow: Flow = "given") -> Undrained:
            check_reduction(factor, flow)
            return replace(self, soil=weaker(factor))

        return reduced

    def elasticity(self, ncomp: int) -> Array:
        """Elastic stiffness of soil and water, (ncomp, ncomp) or (n_elements, ncomp, ncomp)."""
        water = np.asarray(self.bulk_modulus)
        stiffness = self.soil.elasticity(ncomp) + np.zeros((*water.shape, 1, 1))
        stiffness[..., :3, :3] += water[..., None, None]
        return stiffness

    def update(self, strain_increment: Array, stress: Array, internal: Array) -> Update:
        """As :meth:`Material.update`, of the stress of soil and water; the last internal variable is the pressure."""
        before, own = internal[-1], slice(0, self.soil.n_internal)
        pressure = before - along_elements(self.bulk_modulus, stress.shape) * strain_increment[:3].sum(axis=0)
        effective = stress.copy()
        effective[:3] += before
        new = self.soil.update(strain_increment, effective, internal[own])
        total, variables = new.stress.copy(), internal.copy()
        total[:3] -= pressure
        variables[own], variables[-1] = new.internal, pressure
        return Update(total, variables, new.plastic, lambda: self._tangent(new, stress.shape))

    def drained(self, stress: Array, internal: Array) -> tuple[Array, Array]:
        """Accepted stress and internal variables once the water may leave: without its excess pressure."""
        effective, variables = stress.copy(), internal.copy()
        effective[:3] += internal[self.n_internal - 1]
        variables[self.n_internal - 1] = 0.0
        return effective, variables

    def _tangent(self, new: Update, shape: tuple[int, ...]) -> Array:
        """The soil's tangents at its plastic points, and the water's."""
        tangent = new.tangent().copy()
        water = np.broadcast_to(along_elements(self.bulk_modulus, shape), shape[1:]).reshape(-1)
        tangent[:, :3, :3] += water[new.plastic, None, None]
        return tangent
