"""Hardening Soil: stiffness that depends on stress, shear and cap hardening, failure by
Mohr-Coulomb.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from ..checks import number
from ..errors import InadmissibleStress, IncrementTooLarge, warn
from .base import (
    PLASTIC_STRAIN,
    Array,
    Flow,
    Internal,
    Material,
    Parameter,
    Update,
    require,
    warn_of_radians,
)
from .hardening_return import Returned, hardening_return
from .hardening_stiffness import LEAST, Constants, Points, elastic_scale
from .local_newton import take
from .mohr_coulomb import CohesiveFrictional, MohrCoulomb
from .plastic import BLOCK, ROUND_OFF, equivalent_shear_strain
from .small_strain import SMALL_STRAIN, SmallStrain, Stiffening
from .spectral import Frame, principal, principal_stresses

# Excess of an initial stress over the failure surface that is round-off of an analysis, relative to
# q_f.
_OUTSIDE = 1e-6
# Increments without an admissible result are halved so often; step of the differences of their
# tangents, as a share.
_HALVINGS, _DIFFERENCE = 6, 1e-5


@dataclass(frozen=True, eq=False)
class HardeningSoil(CohesiveFrictional):
    """Hardening Soil of Schanz, Vermeer and Bonnier (1999): hyperbola in shear, cap, Rowe's
    dilatancy.

    The stiffness grows with the power m of the least compression; that of an increment is the mean
    of its values at both ends, so that reversed cycles of strain do not drift and errors fall with
    the square of the increment. Shear hardening follows the hyperbola of drained triaxial tests up
    to Mohr-Coulomb failure; the cap ``q~^2 / M^2 + p^2 = p_p^2`` hardens with plastic compression.
    M and the modulus of the cap follow in closed form from ``K0nc`` and ``Eoed_ref``. The mobilised
    dilatancy is Rowe's, without contraction and not over ``psi``. Stresses count from c cot(phi).
    Below a thousandth of ``p_ref`` the stiffness does not fall any more: sand at a free surface
    needs a small cohesion. The parameters have PLAXIS' names and are floats.

    Parameters
    ----------
    E50_ref, Eoed_ref, Eur_ref : float
        Secant modulus at half the failure load, oedometer modulus, and modulus of unloading, at the
        pressure `p_ref`.
    m : float
        Power of the stress in the stiffness, 0 to 1.
    c, phi, psi : float
        Cohesion, friction angle and dilatancy angle in degrees, 0 <= psi <= phi, phi positive.
    nu_ur : float
        Poisson's ratio of unloading.
    p_ref : float
        Reference pressure: 100 with stresses in kPa.
    K0nc : float, optional
        Ratio of horizontal to vertical stress in normal consolidation, 1 - sin(phi) by default.
    R_f : float
        Failure ratio, the share of the hyperbola's asymptote that can be reached.
    OCR, POP : float
        Overconsolidation: the largest vertical stress of the past is ``OCR`` times that of now,
        plus ``POP``.
    G0_ref, gamma_07 : float, optional
        Small-strain stiffness (Benz): shear modulus at very small strains at the pressure `p_ref`,
        and shear strain at which the secant modulus has fallen to 0.722 of it. The elastic
        stiffness follows this curve from the last reversal of the strain down to that of unloading;
        plastic strains harden faster by ``(G / G_ur)**(1 + E_ur / (2 E_i))``. Closed loops obey
        Masing's rule.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sand = sc.HardeningSoil(37e3, 29.6e3, 90e3, m=0.5, c=0.0, phi=41.0, psi=14.0, K0nc=0.34)
    >>> f"{sand.constants.cap_slope:.5f}"
    '5.32012'
    """

    E50_ref: float
    Eoed_ref: float
    Eur_ref: float
    m: float
    c: float
    phi: float
    psi: float = 0.0
    nu_ur: float = 0.2
    p_ref: float = 100.0
    K0nc: float | None = None
    R_f: float = 0.9
    OCR: float = 1.0
    POP: float = 0.0
    G0_ref: float | None = None
    gamma_07: float | None = None

    internal = (
        Internal(PLASTIC_STRAIN),
        Internal("hardening shear strain"),
        Internal("preconsolidation"),
    )
    stress_dependent = True

    def __post_init__(self) -> None:
        for name in (field.name for field in fields(self)):
            value = getattr(self, name)
            if value is None and name in ("K0nc", "G0_ref", "gamma_07"):
                continue
            object.__setattr__(self, name, number(value, name))
        for name in ("E50_ref", "Eoed_ref", "Eur_ref", "p_ref"):
            require(name, getattr(self, name), getattr(self, name) > 0, "be positive")
        require("m", self.m, 0 <= self.m <= 1, "lie in 0..1")
        require("c", self.c, self.c >= 0, "not be negative")
        require("phi", self.phi, 0 < self.phi < 90, "lie between 0 and 90 degrees")
        require("psi", self.psi, 0 <= self.psi <= self.phi, "lie between 0 and phi")
        require("nu_ur", self.nu_ur, 0 <= self.nu_ur < 0.5, "lie in [0, 0.5)")
        require("R_f", self.R_f, 0 < self.R_f < 1, "lie between 0 and 1")
        require("OCR", self.OCR, self.OCR >= 1, "be at least 1")
        require("POP", self.POP, self.POP >= 0, "not be negative")
        least = 2 * self.E50_ref / (2 - self.R_f)
        require(
            "Eur_ref",
            self.Eur_ref,
            self.Eur_ref > least,
            f"exceed the initial modulus {least:.6g} of E50_ref",
        )
        if self.K0nc is not None:
            require("K0nc", self.K0nc, 0 < self.K0nc < 1, "lie between 0 and 1")
        if (self.G0_ref is None) != (self.gamma_07 is None):
            raise ValueError("small-strain stiffness needs both G0_ref and gamma_07")
        if self.G0_ref is not None and self.gamma_07 is not None:
            unloading = self.Eur_ref / (2 * (1 + self.nu_ur))
            require(
                "G0_ref",
                self.G0_ref,
                self.G0_ref > unloading,
                f"exceed the shear modulus {unloading:.6g} of Eur_ref",
            )
            require("gamma_07", self.gamma_07, 0 < self.gamma_07 < 0.1, "lie between 0 and 0.1")
            object.__setattr__(self, "internal", (*type(self).internal, *SMALL_STRAIN))
        warn_of_radians(phi=self.phi)
        self.constants  # noqa: B018  a cap that cannot be met is refused here

    @cached_property
    def constants(self) -> Constants:
        """Constants of the return mapping, the cap among them.

        Normal consolidation goes along the K0 line; the two rates of its plastic strain give slope
        and modulus.
        """
        sin, sin_psi = (float(np.sin(np.radians(angle))) for angle in (self.phi, self.psi))
        shift, sin_cv = (
            self.c / float(np.tan(np.radians(self.phi))),
            (sin - sin_psi) / (1 - sin * sin_psi),
        )
        failure = 2 * sin / (1 - sin)
        K0, initial = 1 - sin if self.K0nc is None else self.K0nc, 2 * self.E50_ref / (2 - self.R_f)
        reached = (1 - K0) * self.R_f / (failure * K0)
        if reached >= self.R_f:
            raise ValueError(
                f"K0nc is {K0:.4g}: beyond failure, which begins at {(1 - sin) / (1 + sin):.4g}"
            )
        scale, q, p, nu = K0**self.m, 1 - K0, (1 + 2 * K0) / 3, self.nu_ur
        gamma = 2 * q / scale * (1 / (initial * (1 - reached)) - 1 / self.Eur_ref)
        mobilised, sheared = q / (1 + K0), (1 - self.m) * gamma
        s = max((mobilised - sin_cv) / (1 - mobilised * sin_cv), 0.0)
        axial = (
            1 / self.Eoed_ref - (1 - 2 * nu * K0) / (self.Eur_ref * scale) - 0.5 * sheared * (1 - s)
        )
        lateral = -(K0 - nu * (1 + K0)) / (self.Eur_ref * scale) + 0.25 * sheared * (1 + s)
        if axial + 2 * lateral <= 0 or axial <= lateral:
            raise ValueError(
                f"Eoed_ref={self.Eoed_ref:g} and K0nc={K0:.4g} cannot both be met with "
                f"E50_ref={self.E50_ref:g} and Eur_ref={self.Eur_ref:g}: "
                + ("lower Eoed_ref" if axial + 2 * lateral <= 0 else "raise K0nc")
            )
        multiplier = (axial + 2 * lateral) / (2 * p)
        slope = 3 * q * multiplier / (axial - lateral)
        cap = float(np.sqrt(q * q / slope + p * p))
        return Constants(
            shift,
            self.p_ref + shift,
            self.m,
            initial,
            self.Eur_ref,
            nu,
            failure,
            failure / self.R_f,
            sin_cv,
            sin_psi,
            slope,
            cap ** (1 - self.m) / (2 * p * multiplier),
            (3 + sin) / (3 - sin),
        )

    @cached_property
    def _small(self) -> SmallStrain | None:
        """Small-strain stiffness, if there is any."""
        if self.G0_ref is None or self.gamma_07 is None:
            return None
        return SmallStrain(self.G0_ref * 2 * (1 + self.nu_ur) / self.Eur_ref, self.gamma_07)

    def _stiffening(self, strain: Array, memory: Array) -> Stiffening:
        """Return the stiffening of small strains, one without them."""
        if self._small is None:
            return Stiffening(np.ones(strain.shape[1]), np.zeros((1, strain.shape[1])), memory)
        return self._small.stiffening(strain, memory)

    @override
    def elasticity(
        self, ncomp: int, stress: Array | None = None, internal: Array | None = None
    ) -> Array:
        k = self.constants
        scale = k.scale(
            np.array(k.reference) if stress is None else k.shift - principal_stresses(stress)[0]
        )
        if internal is not None and self._small is not None:
            none = np.zeros((ncomp, internal[0].size))
            scale = scale * self._stiffening(none, internal[3:].reshape(13, -1)).factor.reshape(
                scale.shape
            )
        stiffness = 2 * k.mu * np.diag(np.r_[np.ones(3), np.full(ncomp - 3, 0.5)])
        stiffness[:3, :3] += k.lam
        return scale[..., None, None] * stiffness

    @override
    def initial_internal(self, stress: Array) -> Array:
        k = self.constants
        c = k.shift - principal_stresses(stress)[::-1].reshape(3, -1)
        self._check_initial(c)
        gamma, least = np.zeros(c.shape[1]), np.maximum(c[2], LEAST * k.reference)
        scale, q = k.scale(c[2]), np.minimum(c[0] - c[2], k.failure * least)
        gamma = (
            2 * q / scale * (1 / (k.initial * (1 - q / (k.asymptote * least))) - 1 / k.unloading)
        )
        vertical = self.OCR * (c[0] - k.shift) + self.POP + k.shift
        K0 = 1 - np.sin(np.radians(self.phi)) if self.K0nc is None else self.K0nc
        past = np.maximum(
            k.cap_stress(np.stack((vertical, K0 * vertical, K0 * vertical))), k.cap_stress(c)
        )
        cap = np.maximum(past, LEAST * k.reference)
        history = np.zeros((self.n_internal - 3, gamma.size))
        return np.concatenate(([0 * gamma, gamma, cap], history)).reshape(-1, *stress.shape[1:])

    def _check_initial(self, c: Array) -> None:
        """Refuse initial stresses, shifted and compression positive, in tension or outside the
        failure surface.
        """
        k, size = self.constants, np.abs(c).max(axis=0)
        excess = c[0] - c[2] - k.failure * c[2]
        outside = np.flatnonzero(excess > _OUTSIDE * np.maximum(size, LEAST * k.reference))
        if outside.size:
            worst = outside[np.argmax(excess[outside])]
            s3, s1 = k.shift - c[[0, 2], worst]
            where = (
                "in tension"
                if c[2, worst] < 0
                else f"outside the failure surface by {excess[worst]:.4g}"
            )
            raise InadmissibleStress(
                f"initial stress of HardeningSoil {where} at {outside.size} of {c.shape[1]} "
                f"points, most at point "
                f"{worst}: principal stresses {s1:.4g} and {s3:.4g} with c={self.c:g}, "
                f"phi={self.phi:g}; change K0, or "
                "give more cohesion",
                int(worst),
            )
        bare = np.count_nonzero(c[2] < LEAST * k.reference)
        if bare and size.max() > 0:
            warn(
                f"{bare} points of HardeningSoil are compressed by less than "
                f"{LEAST * k.reference:.3g}, where the "
                "stiffness does not fall with the stress any more: give a small cohesion c, or a "
                "surcharge"
            )

    @override
    def update(self, strain_increment: Array, stress: Array, internal: Array) -> Update:
        if (
            strain_increment.shape != stress.shape
            or stress.ndim < 2
            or stress.shape[0] not in (4, 6)
        ):
            raise ValueError(
                "strain increment and stress must share a shape (4 or 6, n_elements, ...), "
                f"got {strain_increment.shape} and {stress.shape}"
            )
        increment, start, before = (
            values.reshape(len(values), -1) for values in (strain_increment, stress, internal)
        )
        result, memory, tangent = self._followed(increment, start, before, _HALVINGS)
        return Update(
            result.reshape(stress.shape),
            memory.reshape(internal.shape),
            np.arange(result.shape[1]),
            tangent,
        )

    def _followed(
        self, increment: Array, stress: Array, memory: Array, halvings: int
    ) -> tuple[Array, Array, Callable[[], Array]]:
        """Return stresses, internal variables and tangent; halve the increments of points without a
        result.
        """
        result, new = stress.copy(), memory.copy()
        starts = range(0, stress.shape[1], BLOCK)
        blocks = [
            self._return_block(increment, result, new, slice(start, start + BLOCK))
            for start in starts
        ]
        found = (start + block.at[block.returned.failed] for start, block in zip(starts, blocks))
        lost = np.concatenate([np.zeros(0, np.intp), *found])
        if lost.size and halvings == 0:
            raise IncrementTooLarge(
                f"{lost.size} of {stress.shape[1]} points of HardeningSoil have no admissible "
                f"stress: the increment of the first is {increment[:, lost[0]]}"
            )
        given = stress[:, lost], memory[:, lost], halvings - 1
        if lost.size:
            result[:, lost], new[:, lost] = self._by_halves(increment[:, lost], *given)

        def tangent() -> Array:
            slopes = np.concatenate([_tangent(block, self.constants) for block in blocks])
            if lost.size:
                slopes[lost] = self._differences(increment[:, lost], *given)
            return slopes

        return result, new, tangent

    def _by_halves(
        self, increment: Array, stress: Array, memory: Array, halvings: int
    ) -> tuple[Array, Array]:
        """Return stresses and internal variables after the two halves of an increment."""
        for _ in range(2):
            stress, memory, _ = self._followed(0.5 * increment, stress, memory, halvings)
        return stress, memory

    def _differences(self, increment: Array, stress: Array, memory: Array, halvings: int) -> Array:
        """Return the tangent of halved increments, (n, ncomp, ncomp), by central differences, all
        of them at once.
        """
        (ncomp, n), size = increment.shape, _DIFFERENCE * np.abs(increment).max(axis=0)
        steps = np.concatenate((np.eye(ncomp), -np.eye(ncomp)))[:, :, None] * size
        ends = np.concatenate(list(increment + steps), axis=1)
        there = self._by_halves(
            ends, np.tile(stress, 2 * ncomp), np.tile(memory, 2 * ncomp), halvings
        )[0]
        ahead, behind = there.reshape(ncomp, 2, ncomp, n).transpose(1, 3, 0, 2)
        return (ahead - behind) / (2 * size[:, None, None])

    def _return_block(self, increment: Array, stress: Array, memory: Array, at: slice) -> _Block:
        """Update the points of a block in place: stress (ncomp, n) and internal variables
        (n_internal, n).
        """
        k, part, own = self.constants, stress[:, at], memory[:, at]
        push = 2 * k.mu * increment[:, at]
        push[3:] *= 0.5
        push[:3] += k.lam * increment[:3, at].sum(axis=0)
        small = self._stiffening(increment[:, at], own[3:])
        own[3:] = small.memory
        faster = small.factor ** (1 + 0.5 * k.unloading / k.initial)
        t = Points(
            part.copy(),
            push,
            own[1].copy(),
            own[2].copy(),
            k.scale(k.shift - principal_stresses(part)[0]),
            small.factor,
            faster,
        )
        scale = elastic_scale(t, k)
        c = k.shift - t.trial(scale).values[::-1]
        size = np.maximum(np.maximum(np.abs(c[0]), np.abs(c[2])), LEAST * k.reference)
        sheared = c[0] - c[2] - k.shear_strength(c[2], own[1], k.scale(c[2]))[0]
        crushed = np.where(c.sum(axis=0) > 0, k.cap_stress(c) - own[2], 0.0)
        outside = ~(np.maximum(sheared, crushed) <= ROUND_OFF * size)
        part[...] = t.stress + scale * push
        points = np.flatnonzero(outside)
        t = take(t, points)
        returned = hardening_return(t, k)
        frame, scale[points] = t.trial(returned.scale), returned.scale
        values = k.shift - returned.c[::-1]
        part[:, points] = frame.stress(values)
        own[0, points] += equivalent_shear_strain(frame.values - values, k.mu * returned.scale)
        own[1, points], own[2, points] = returned.gamma, returned.cap
        return _Block(points, increment[:, at], part, push, scale, small, frame, values, returned)

    @property
    def strength(self) -> MohrCoulomb:
        """Mohr-Coulomb soil of the same strength, with the stiffness E50_ref."""
        return MohrCoulomb(self.E50_ref, self.nu_ur, self.c, self.phi, self.psi)

    @override
    def reduced(self, factor: float, flow: Flow = "given") -> Material:
        """Return the Mohr-Coulomb soil of the reduced strength: hardening changes no collapse."""
        return self.strength.reduced(factor, flow)

    @override
    def cone(self, flow: Flow = "associated") -> tuple[Parameter, Parameter, Parameter] | None:
        return self.strength.cone(flow)


class _Block(NamedTuple):
    """Points of a block: strain increments, stresses, elastic changes at the scale 1, scales; those
    that yield.
    """

    at: NDArray[np.intp]
    strain: Array
    stress: Array
    push: Array
    scale: Array
    small: Stiffening
    frame: Frame
    values: Array
    returned: Returned


def _tangent(block: _Block, k: Constants) -> Array:
    """Return the tangent, (n, ncomp, ncomp): that of a held scale, and its change with stress and
    strain.
    """
    n, ncomp, factor = block.scale.size, len(block.stress), block.small.factor
    elastic = np.diag(np.r_[np.full(3, 2 * k.mu), np.full(ncomp - 3, k.mu)])
    elastic[:3, :3] += k.lam
    result, by_scale = block.scale[:, None, None] * elastic, block.push.copy()
    slopes, own = block.returned.slopes()
    scale, at = block.scale[block.at], block.at
    moduli = (2 * k.mu * slopes + k.lam * slopes.sum(axis=1, keepdims=True)) * scale
    result[at] = block.frame.tangent(moduli[::-1, ::-1], block.values, k.mu * scale)
    hardened = block.frame.stress(own[::-1])
    by_scale[:, at] = (np.einsum("nij,jn->in", result[at], block.strain[:, at]) - hardened) / scale
    if len(block.small.slope) == ncomp:
        by_factor = block.scale / factor * by_scale
        by_factor[:, at] += (1 + 0.5 * k.unloading / k.initial) / factor[at] * hardened
        result += by_factor.T[:, :, None] * block.small.slope.T[:, None, :]
    axes = principal(block.stress)
    least = k.shift - axes.values[0]
    rate = (
        -0.5
        * factor
        * k.scale_slope(least, k.scale(least))
        * axes.stress(np.eye(3)[:, :1] * np.ones(n))
    )
    rate[3:] *= 2
    gain = np.einsum("in,nij->nj", rate, result) / (1 - (rate * by_scale).sum(axis=0))[:, None]
    return result + by_scale.T[:, :, None] * gain[:, None, :]
