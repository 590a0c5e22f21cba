"""Mohr-Coulomb plasticity whose strength changes with the plastic shear strain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

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
    """Constants of the law: floats, or arrays over elements or points; angles in radians."""

    lam: Parameter
    mu: Parameter
    sin_psi: Parameter
    c: Parameter
    phi: Parameter
    c_change: Parameter
    phi_change: Parameter
    range: Parameter  # equivalent plastic shear strain at which the change ends
    accepted: Parameter = 0.0  # equivalent plastic shear strain


@dataclass(frozen=True, eq=False)
class HardeningMohrCoulomb(CohesiveFrictional, IsotropicPlasticity):
    """Mohr-Coulomb plasticity, hardening or softening linearly with the plastic shear strain.

    Cohesion and friction angle go linearly from their first to their last values while the
    accumulated equivalent plastic shear strain goes from zero to a given strain, then they stay.
    The dilatancy angle is constant. Stress and strength at the end of an increment fulfil the yield
    condition exactly. A softening body has no solution that is independent of the mesh: choose
    ``strain_end`` for the size of the elements.

    Parameters
    ----------
    E, nu, c, c_end, phi, phi_end, psi : float or ndarray
        As in :class:`MohrCoulomb`, with first and last strength; psi must not exceed phi and
        phi_end.
    strain_end : float or ndarray
        Equivalent plastic shear strain at which the last values are reached, positive.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact.materials import HardeningMohrCoulomb
    >>> clay = HardeningMohrCoulomb(
    ...     E=1e4, nu=0.3, c=20.0, c_end=5.0, phi=0.0, phi_end=0.0, strain_end=0.1
    ... )
    >>> strain = np.array([[0.0], [0.0], [0.0], [0.08]])
    >>> update = clay.update(strain, np.zeros((4, 1)), np.zeros((1, 1)))
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
            self._angle(name)
            not_above = np.less_equal(self.psi, getattr(self, name))
            require("psi", self.psi, not_above, f"not exceed {name}")
        warn_of_radians(phi=np.maximum(self.phi, self.phi_end))
        self._positive("strain_end")

    @override
    def strength_at(self, internal: Array) -> tuple[Parameter, Parameter]:
        angles = np.radians(self.phi), np.radians(self.phi_end)
        given = self.c, self.c_end, *angles, self.strain_end
        c, c_end, phi, phi_end, end = (along_elements(value, internal.shape) for value in given)
        progress = np.minimum(internal[0] / end, 1.0)
        c_now = c + progress * (c_end - c)
        phi_now = phi + progress * (phi_end - phi)
        return c_now, phi_now

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
                "HardeningMohrCoulomb cannot follow phi to another phi_end"
            )
        # Reduce the first and the last strength.
        first: Any = MohrCoulomb(self.E, self.nu, self.c, self.phi, self.psi)
        last: Any = MohrCoulomb(self.E, self.nu, self.c_end, self.phi_end, self.psi)
        first = first.reduced(factor, flow)
        last = last.reduced(factor, flow)

        # Keep the dilatancy below both friction angles.
        psi = first.psi
        if flow == "given":
            least = np.minimum(self.phi, self.phi_end)
            reduced = np.minimum(first.phi, last.phi)
            psi = reduced_dilatancy(self.psi, least, reduced)
        return self._with(c=first.c, c_end=last.c, phi=first.phi, phi_end=last.phi, psi=psi)

    @override
    def constants(self) -> _Constants:
        phi = np.radians(self.phi)
        return _Constants(
            *self.lame,
            sin_psi=np.sin(np.radians(self.psi)),
            c=self.c,
            phi=phi,
            c_change=self.c_end - self.c,
            phi_change=np.radians(self.phi_end) - phi,
            range=self.strain_end,
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
            # d s / d e = P + (d s / d k) (d k / d e) with the perfectly plastic moduli P, and from
            # the growth k = k(s_trial - s) with the gradient g and the elastic moduli D
            # d k / d e = g (D - P) / (1 + g d s / d k)
            perfect = returned.moduli()
            change = _stress_change(returned, strain, constants)
            gradient = _strain_gradient(trial - returned.values, constants.mu)
            rate = -np.einsum("in,ijn->jn", gradient, perfect)
            rate += constants.lam * gradient.sum(axis=0) + 2 * constants.mu * gradient
            rate /= 1 + np.einsum("in,in->n", gradient, change)
            return perfect + change[:, None] * rate

        return Return(returned.values, moduli, growth=strain - constants.accepted)


def _strength(strain: Parameter, k: _Constants) -> tuple[Parameter, Parameter]:
    """Return cohesion and friction angle at an equivalent plastic shear strain."""
    progress = np.minimum(strain / k.range, 1)
    return k.c + progress * k.c_change, k.phi + progress * k.phi_change


def _pyramid(strain: Parameter, k: _Constants) -> PyramidConstants:
    """Return the yield surface at an equivalent plastic shear strain."""
    c, phi = _strength(strain, k)
    return PyramidConstants(k.lam, k.mu, np.sin(phi), k.sin_psi, 2 * c * np.cos(phi))


def _end_strain(trial: Array, k: _Constants) -> Array:
    """Solve for the equivalent plastic shear strain at the end of the increment.

    It is the root of: accepted strain + growth in the return to the surface at this strain - this
    strain. Newton's method is safeguarded by bisection between bounds: the growth is never
    negative, and never more than the strain that relaxes the whole deviator of the trial stress.
    The upper bound is twice as far, so that the step to the apex, which ends there, is between.
    """
    lower = np.broadcast_to(k.accepted, trial.shape[1:]).copy()
    upper = lower + 2.0 * equivalent_shear_strain(trial, k.mu)
    tolerance = ROUND_OFF / 10 * np.maximum(trial[0], -trial[2]) / k.mu
    result = lower.copy()
    points = np.arange(result.size)
    for iteration in range(_NEWTON_ITERATIONS + _HALVINGS):
        # Narrow the bounds of the points that are not yet solved.
        some = chosen(k, points)
        strain = result[points]
        growth, slope = _growth(strain, trial[:, points], some)
        residual = some.accepted + growth - strain
        low = np.where(residual > 0, strain, lower[points])
        high = np.where(residual > 0, upper[points], strain)
        lower[points] = low
        upper[points] = high

        # Keep the solved points.
        remaining = (np.abs(residual) > tolerance[points]) & (high - low > tolerance[points])
        if not remaining.any():
            break

        # Step by Newton's method where it stays between the bounds, else halve them.
        newton = strain + residual / np.where(slope < 1, 1 - slope, 1)
        inside = (low < newton) & (newton < high) & (slope < 1) & (iteration < _NEWTON_ITERATIONS)
        new = np.where(inside, newton, (low + high) / 2)
        points = points[remaining]
        result[points] = new[remaining]
    return result


def _growth(strain: Array, trial: Array, k: _Constants) -> tuple[Array, Array]:
    """Return the plastic shear strain of the return to the surface at a strain, and its slope."""
    surface = _pyramid(strain, k)
    returned = pyramid_return(trial, surface)
    relaxed = trial - returned.values
    growth = equivalent_shear_strain(relaxed, k.mu)
    change = _stress_change(returned, strain, k)
    slope = -(_strain_gradient(relaxed, k.mu) * change).sum(axis=0)
    outside = pyramid_excess(trial[0], trial[2], surface) > 0
    return np.where(outside, growth, 0), np.where(outside, slope, 0)


def _stress_change(returned: Return, strain: Array, k: _Constants) -> Array:
    """Return d returned principal stress (3, n) / d plastic shear strain, the trial fixed.

    The yield function (s1 - s3) + (s1 + s3) sin(phi) - 2 c cos(phi) rises by the changes of phi
    and c.
    """
    largest, _, smallest = returned.values
    c, phi = _strength(strain, k)
    cos = np.cos(phi)
    by_phi = (largest + smallest) * cos + 2 * c * np.sin(phi)
    rise = by_phi * k.phi_change - 2 * cos * k.c_change
    assert returned.relief is not None
    return -returned.relief() * np.where(strain < k.range, rise / k.range, 0)


def _strain_gradient(relaxed: Array, mu: Parameter) -> Array:
    """Return d equivalent shear strain / d relaxed principal stress (3, n)."""
    deviator = relaxed - relaxed.mean(axis=0)
    size = np.sqrt((deviator * deviator).sum(axis=0))
    return deviator / (np.where(size > 0, size, 1) * np.sqrt(6) * mu)
