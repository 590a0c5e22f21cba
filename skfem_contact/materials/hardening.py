"""Mohr-Coulomb plasticity whose strength changes with the plastic shear strain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, cast

import numpy as np
from typing_extensions import override

from .base import (
    Array,
    Flow,
    Given,
    Parameter,
    along_elements,
    check_reduction,
    require,
    warn_of_radians,
)
from .elastic import reduced_dilatancy
from .mohr_coulomb import CohesiveFrictional, MohrCoulomb
from .plastic import ROUND_OFF, IsotropicPlasticity, Return, chosen, equivalent_shear_strain
from .pyramid import PyramidConstants, pyramid_excess, pyramid_return
from .spectral import extremes

_NEWTON_ITERATIONS = 20
_HALVINGS = 60  # from the bounds to the round-off


class _Constants(NamedTuple):
    """Constants over elements or points, angles in radians; ``range`` is the strain where the
    change ends.
    """

    lam: Parameter
    mu: Parameter
    sin_psi: Parameter
    c: Parameter
    phi: Parameter
    c_change: Parameter
    phi_change: Parameter
    range: Parameter
    accepted: Parameter = 0.0  # equivalent plastic shear strain


@dataclass(frozen=True, eq=False)
class HardeningMohrCoulomb(CohesiveFrictional, IsotropicPlasticity):
    """Mohr-Coulomb plasticity, hardening or softening linearly with the plastic shear strain.

    Cohesion and friction angle go linearly from their first to their last values while the
    accumulated equivalent plastic shear strain goes from zero to a given strain, and stay there.
    The dilatancy angle is constant. Stress and strength at the end of an increment fulfil the yield
    condition exactly. A softening body has no solution that is independent of the mesh: choose
    ``strain_end`` for the size of the elements.

    Parameters
    ----------
    E, nu, c, c_end, phi, phi_end, psi : float or ndarray
        As those of :class:`MohrCoulomb`, with first and last strength; psi must not exceed phi and
        phi_end.
    strain_end : float or ndarray
        Equivalent plastic shear strain at which the last values are reached, positive.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact.materials import HardeningMohrCoulomb
    >>> clay = HardeningMohrCoulomb(1e4, 0.3, c=20.0, c_end=5.0, phi=0.0, phi_end=0.0, strain_end=0.1)
    >>> update = clay.update(np.array([[0.0], [0.0], [0.0], [0.08]]), np.zeros((4, 1)), np.zeros((1, 1)))
    >>> update.stress[3].round(3), update.internal[0].round(4)
    (array([13.373]), array([0.0442]))
    """

    c: Given
    c_end: Given
    phi: Given
    phi_end: Given
    strain_end: Given
    psi: Given = 0.0

    @override
    def _check(self) -> None:
        super()._check()
        self._not_negative("c", "c_end", "psi")
        for name in ("phi", "phi_end"):
            angle = getattr(self, name)
            require(
                name,
                angle,
                np.greater_equal(angle, 0) & np.less(angle, 90),
                "lie in [0, 90) degrees",
            )
            require("psi", self.psi, np.less_equal(self.psi, angle), f"not exceed {name}")
        warn_of_radians(phi=np.maximum(self.phi, self.phi_end))
        require("strain_end", self.strain_end, np.greater(self.strain_end, 0), "be positive")

    @override
    def strength_at(self, internal: Array) -> tuple[Parameter, Parameter]:
        c, c_end, phi, phi_end, strain_end = (
            along_elements(value, internal.shape)
            for value in (
                self.c,
                self.c_end,
                np.radians(self.phi),
                np.radians(self.phi_end),
                self.strain_end,
            )
        )
        way = np.minimum(internal[0] / strain_end, 1.0)
        return c + way * (c_end - c), phi + way * (phi_end - phi)

    @override
    def reduced(self, factor: float, flow: Flow = "given") -> HardeningMohrCoulomb:
        check_reduction(factor, flow, self)
        if flow == "lagged":
            raise ValueError(
                "flow 'lagged' is for MohrCoulomb, not for HardeningMohrCoulomb, whose strength "
                "changes"
            )
        if flow != "given" and not np.all(self.phi == self.phi_end):
            raise ValueError(
                f"flow '{flow}' needs one friction angle: the constant psi of a "
                f"HardeningMohrCoulomb "
                "cannot follow phi to another phi_end"
            )
        first, last = (
            cast(MohrCoulomb, MohrCoulomb(self.E, self.nu, c, phi, self.psi).reduced(factor, flow))
            for c, phi in ((self.c, self.phi), (self.c_end, self.phi_end))
        )
        least, reduced = np.minimum(self.phi, self.phi_end), np.minimum(first.phi, last.phi)
        psi = reduced_dilatancy(self.psi, least, reduced) if flow == "given" else first.psi
        return self._with(c=first.c, c_end=last.c, phi=first.phi, phi_end=last.phi, psi=psi)

    @override
    def constants(self) -> _Constants:
        phi, phi_end, psi = np.radians(self.phi), np.radians(self.phi_end), np.radians(self.psi)
        c_change, phi_change = self.c_end - self.c, phi_end - phi
        return _Constants(
            *self.lame, np.sin(psi), self.c, phi, c_change, phi_change, self.strain_end
        )

    @override
    def at_state(self, constants: _Constants, internal: Array) -> _Constants:
        return constants._replace(accepted=internal)

    @override
    def yield_bound(self, stress: Array, constants: _Constants) -> Array:
        return pyramid_excess(*extremes(stress), _pyramid(constants.accepted, constants))

    @override
    def yield_function(self, values: Array, constants: _Constants) -> Array:
        return pyramid_excess(values[0], values[2], _pyramid(constants.accepted, constants))

    @override
    def return_map(self, trial: Array, constants: _Constants) -> Return:
        strain = _end_strain(trial, constants)
        returned = pyramid_return(trial, _pyramid(strain, constants))

        def moduli() -> Array:
            """Return the perfectly plastic moduli and the dyad of the change of strength."""
            perfect = returned.moduli()
            change = _stress_change(returned, strain, constants)
            gradient = _strain_gradient(trial - returned.values, constants.mu)
            lost = -np.einsum("in,ijn->jn", gradient, perfect)
            lost += constants.lam * gradient.sum(axis=0) + 2 * constants.mu * gradient
            lost /= 1 + np.einsum("in,in->n", gradient, change)
            return perfect + change[:, None] * lost

        return Return(returned.values, moduli, growth=strain - constants.accepted)


def _pyramid(strain: Parameter, k: _Constants) -> PyramidConstants:
    """Return the yield surface at an equivalent plastic shear strain."""
    progress = np.minimum(strain / k.range, 1)
    phi = k.phi + progress * k.phi_change
    strength = 2 * (k.c + progress * k.c_change) * np.cos(phi)
    return PyramidConstants(k.lam, k.mu, np.sin(phi), k.sin_psi, strength)


def _end_strain(trial: Array, k: _Constants) -> Array:
    """Solve for the equivalent plastic shear strain at the end of the increment.

    It is the root of: accepted strain + growth in the return to the surface at this strain - this
    strain. Newton's method is safeguarded by bisection between bounds: the growth is never
    negative, and never more than the strain that relaxes the whole deviator of the trial stress.
    """
    lower = np.broadcast_to(k.accepted, trial.shape[1:]).copy()
    upper = lower + equivalent_shear_strain(trial, k.mu)
    tolerance = ROUND_OFF / 10 * np.maximum(trial[0], -trial[2]) / k.mu
    strain = lower.copy()
    open_ = np.arange(strain.size)
    for iteration in range(_NEWTON_ITERATIONS + _HALVINGS):
        at, here = chosen(k, open_), strain[open_]
        growth, slope = _growth(here, trial[:, open_], at)
        residual = at.accepted + growth - here
        lower[open_] = np.where(residual > 0, here, lower[open_])
        upper[open_] = np.where(residual > 0, upper[open_], here)
        low, high = lower[open_], upper[open_]
        newton = here + residual / np.where(slope < 1, 1 - slope, 1)
        unsettled = (np.abs(residual) > tolerance[open_]) & (high - low > tolerance[open_])
        inside = (low < newton) & (newton < high) & (slope < 1) & (iteration < _NEWTON_ITERATIONS)
        strain[open_] = np.where(unsettled, np.where(inside, newton, (low + high) / 2), here)
        open_ = open_[unsettled]
        if not open_.size:
            break
    return strain


def _growth(strain: Array, trial: Array, k: _Constants) -> tuple[Array, Array]:
    """Return the plastic shear strain of the return to the surface at ``strain``, and its
    derivative.
    """
    surface = _pyramid(strain, k)
    returned = pyramid_return(trial, surface)
    relaxed = trial - returned.values
    change = _stress_change(returned, strain, k)
    slope = -(_strain_gradient(relaxed, k.mu) * change).sum(axis=0)
    outside = pyramid_excess(trial[0], trial[2], surface) > 0
    return np.where(outside, equivalent_shear_strain(relaxed, k.mu), 0), np.where(outside, slope, 0)


def _stress_change(returned: Return, strain: Array, k: _Constants) -> Array:
    """Return d returned principal stress (3, n) / d plastic shear strain, the trial fixed."""
    largest, _, smallest = returned.values
    phi = k.phi + np.minimum(strain / k.range, 1) * k.phi_change
    c = k.c + np.minimum(strain / k.range, 1) * k.c_change
    cos, sin = np.cos(phi), np.sin(phi)
    rise = ((largest + smallest) * cos + 2 * c * sin) * k.phi_change - 2 * cos * k.c_change
    assert returned.relief is not None
    return -returned.relief() * np.where(strain < k.range, rise / k.range, 0)


def _strain_gradient(relaxed: Array, mu: Parameter) -> Array:
    """Return d equivalent shear strain / d relaxed principal stress (3, n)."""
    deviator = relaxed - relaxed.mean(axis=0)
    size = np.sqrt((deviator * deviator).sum(axis=0))
    return deviator / (np.where(size > 0, size, 1) * np.sqrt(6) * mu)
