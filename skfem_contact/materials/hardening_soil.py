"""Hardening Soil: stiffness by stress, shear and cap hardening, failure by Mohr-Coulomb."""

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
    along_elements,
    as_parameters,
    check_shapes,
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
# the largest stress.
_OUTSIDE = 1e-6
# Increments without an admissible result are halved so often; step of the differences of their
# tangents, as a share.
_HALVINGS = 6
_DIFFERENCE = 1e-5
# Parameters that may vary by element: they act on the initial memory alone.
_BY_ELEMENT = ("OCR", "POP")


@dataclass(frozen=True, eq=False)
class HardeningSoil(CohesiveFrictional):
    """Hardening Soil of Schanz, Vermeer and Bonnier (1999): hyperbola, cap, Rowe's dilatancy.

    The stiffness grows with the power m of the least compression. In an increment it is the mean of
    its values at both ends, so that reversed cycles of strain do not drift and errors fall with the
    square of the increment. Shear hardening follows the hyperbola of drained triaxial tests up
    to Mohr-Coulomb failure; the cap ``q~^2 / M^2 + p^2 = p_p^2`` hardens with plastic compression.
    M and the modulus of the cap follow in closed form from ``K0nc`` and ``Eoed_ref``. The mobilised
    dilatancy is Rowe's, without contraction and not over ``psi``. Stresses count from c cot(phi).
    As published, the strain of the cap adds to the hyperbola. Drained triaxial tests have the
    secant modulus ``E50_ref`` where the cap rests (``OCR``). Normally consolidated samples are
    softer by 7 to 27 %: the lower ``Eoed_ref``, the softer.
    Below a thousandth of ``p_ref`` the stiffness does not fall any more: sand at a free surface
    needs a small cohesion. The parameters have PLAXIS' names and are floats; OCR and POP may vary.

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
    OCR, POP : float or ndarray
        Overconsolidation: the largest vertical stress of the past is ``OCR`` times the present
        one, plus ``POP``. Arrays have one value an element.
    G0_ref, gamma_07 : float, optional
        Small-strain stiffness (Benz): shear modulus at very small strains at the pressure `p_ref`,
        and shear strain at which the secant modulus has fallen to 0.722 of it. The elastic
        stiffness follows this curve from the last reversal of the strain down to unloading; plastic
        strains harden faster by ``(G / G_ur)**(1 + E_ur / (2 E_i))``. Closed loops obey Masing's
        rule.

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
    OCR: Parameter = 1.0
    POP: Parameter = 0.0
    G0_ref: float | None = None
    gamma_07: float | None = None

    internal = (
        Internal(PLASTIC_STRAIN),
        Internal("hardening shear strain"),
        Internal("preconsolidation"),
    )
    stress_dependent = True

    def __post_init__(self) -> None:
        # keep the parameters as numbers, the history by element, and check their ranges
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name not in _BY_ELEMENT and (value is not None or field.default is not None):
                object.__setattr__(self, field.name, number(value, field.name))
        as_parameters(self)
        for name, holds, demand in (
            ("E50_ref", self.E50_ref > 0, "be positive"),
            ("Eoed_ref", self.Eoed_ref > 0, "be positive"),
            ("Eur_ref", self.Eur_ref > 0, "be positive"),
            ("p_ref", self.p_ref > 0, "be positive"),
            ("m", 0 <= self.m <= 1, "lie in 0..1"),
            ("c", self.c >= 0, "not be negative"),
            ("phi", 0 < self.phi < 90, "lie between 0 and 90 degrees"),
            ("psi", 0 <= self.psi <= self.phi, "lie between 0 and phi"),
            ("nu_ur", 0 <= self.nu_ur < 0.5, "lie in [0, 0.5)"),
            ("R_f", 0 < self.R_f < 1, "lie between 0 and 1"),
            ("OCR", np.greater_equal(self.OCR, 1), "be at least 1"),
            ("POP", np.greater_equal(self.POP, 0), "not be negative"),
        ):
            require(name, getattr(self, name), holds, demand)

        # check the parameters that depend on each other
        initial = 2 * self.E50_ref / (2 - self.R_f)
        demand = f"exceed the initial modulus {initial:.6g} of E50_ref"
        require("Eur_ref", self.Eur_ref, self.Eur_ref > initial, demand)
        if self.K0nc is not None:
            require("K0nc", self.K0nc, 0 < self.K0nc < 1, "lie between 0 and 1")
        self._check_small_strains()
        warn_of_radians(phi=self.phi)
        self.constants  # noqa: B018  a cap that cannot be met is refused here

    def _check_small_strains(self) -> None:
        """Check the parameters of small strains, and declare their memory."""
        if (self.G0_ref is None) != (self.gamma_07 is None):
            raise ValueError("small-strain stiffness needs both G0_ref and gamma_07")
        if self.G0_ref is None or self.gamma_07 is None:
            return
        G_ur = self.Eur_ref / (2 * (1 + self.nu_ur))
        demand = f"exceed the shear modulus {G_ur:.6g} of Eur_ref"
        require("G0_ref", self.G0_ref, self.G0_ref > G_ur, demand)
        require("gamma_07", self.gamma_07, 0 < self.gamma_07 < 0.1, "lie between 0 and 0.1")
        object.__setattr__(self, "internal", (*type(self).internal, *SMALL_STRAIN))

    @property
    def _K0(self) -> float:
        """Ratio of horizontal to vertical stress in normal consolidation."""
        if self.K0nc is None:
            return 1 - float(np.sin(np.radians(self.phi)))
        return self.K0nc

    @cached_property
    def constants(self) -> Constants:
        """Constants of the return mapping, the cap among them.

        Normal consolidation goes along the K0 line; the two rates of its plastic strain give slope
        and modulus.
        """
        # find the friction of constant volume by Rowe's rule, and the first slope of the hyperbola
        sin = float(np.sin(np.radians(self.phi)))
        sin_psi = float(np.sin(np.radians(self.psi)))
        shift = self.c / float(np.tan(np.radians(self.phi)))
        sin_cv = (sin - sin_psi) / (1 - sin * sin_psi)
        failure = 2 * sin / (1 - sin)
        initial = 2 * self.E50_ref / (2 - self.R_f)
        nu = self.nu_ur

        # shear along the K0 line at the vertical stress 1, by the hyperbola
        K0 = self._K0
        reached = (1 - K0) * self.R_f / (failure * K0)
        if reached >= self.R_f:
            raise ValueError(
                f"K0nc is {K0:.4g}: beyond failure, which begins at {(1 - sin) / (1 + sin):.4g}"
            )
        scale = K0**self.m
        q = 1 - K0
        p = (1 + 2 * K0) / 3
        gamma = 2 * q / scale * (1 / (initial * (1 - reached)) - 1 / self.Eur_ref)

        # subtract elastic strains and strains of shear from the oedometer's strains
        mobilised = q / (1 + K0)
        sheared = (1 - self.m) * gamma
        s = max((mobilised - sin_cv) / (1 - mobilised * sin_cv), 0.0)
        unloading = self.Eur_ref * scale
        elastic = (1 - 2 * nu * K0) / unloading
        axial = 1 / self.Eoed_ref - elastic - 0.5 * sheared * (1 - s)
        lateral = -(K0 - nu * (1 + K0)) / unloading + 0.25 * sheared * (1 + s)
        volume = axial + 2 * lateral
        if volume <= 0 or axial <= lateral:
            raise ValueError(
                f"Eoed_ref={self.Eoed_ref:g} and K0nc={K0:.4g} cannot both be met with "
                f"E50_ref={self.E50_ref:g} and Eur_ref={self.Eur_ref:g}: "
                + ("lower Eoed_ref" if volume <= 0 else "raise K0nc")
            )

        # the rest is plastic compression of the cap, and normal to it
        multiplier = volume / (2 * p)
        slope = 3 * q * multiplier / (axial - lateral)
        cap = float(np.sqrt(q * q / slope + p * p))
        return Constants(
            shift,
            reference=self.p_ref + shift,
            m=self.m,
            initial=initial,
            unloading=self.Eur_ref,
            lam=self.Eur_ref * nu / ((1 + nu) * (1 - 2 * nu)),
            mu=self.Eur_ref / (2 * (1 + nu)),
            failure=failure,
            asymptote=failure / self.R_f,
            sin_cv=sin_cv,
            sin_psi=sin_psi,
            cap_slope=slope,
            cap_modulus=cap ** (1 - self.m) / (2 * p * multiplier),
            lode=(3 + sin) / (3 - sin),
        )

    @cached_property
    def _small(self) -> SmallStrain | None:
        """Small-strain stiffness, if it is given."""
        if self.G0_ref is None or self.gamma_07 is None:
            return None
        return SmallStrain(self.G0_ref * 2 * (1 + self.nu_ur) / self.Eur_ref, self.gamma_07)

    def _stiffening(self, strain: Array, memory: Array) -> Stiffening:
        """Return the stiffening of small strains, or none."""
        if self._small is not None:
            return self._small.stiffening(strain, memory)
        n = strain.shape[1]
        return Stiffening(np.ones(n), np.zeros((1, n)), memory)

    @override
    def elasticity(
        self,
        ncomp: int,
        stress: Array | None = None,
        internal: Array | None = None,
    ) -> Array:
        k = self.constants
        if stress is None:
            scale = k.scale(np.array(k.reference))
        else:
            scale = k.scale(k.shift - principal_stresses(stress)[0])
        if internal is not None and self._small is not None:
            no_strain = np.zeros((ncomp, internal[0].size))
            factor = self._stiffening(no_strain, internal[3:].reshape(13, -1)).factor
            scale = scale * factor.reshape(scale.shape)
        return scale[..., None, None] * k.stiffness(ncomp)

    @override
    def initial_internal(self, stress: Array) -> Array:
        k = self.constants
        c = k.shift - principal_stresses(stress)[::-1].reshape(3, -1)
        self._check_initial(c)

        # find the shear strain on the hyperbola
        least = np.maximum(c[2], LEAST * k.reference)
        scale = k.scale(c[2])
        q = np.minimum(c[0] - c[2], k.failure * least)
        secant = k.initial * (1 - q / (k.asymptote * least))
        gamma = 2 * q / scale * (1 / secant - 1 / k.unloading)

        # find the cap through the present stress or the vertical stress of the past
        ratio = np.ravel(along_elements(self.OCR, stress.shape))
        more = np.ravel(along_elements(self.POP, stress.shape))
        vertical = ratio * (c[0] - k.shift) + more + k.shift
        lateral = self._K0 * vertical
        past = np.stack((vertical, lateral, lateral))
        cap = np.maximum(k.cap_stress(past), k.cap_stress(c))
        cap = np.maximum(cap, LEAST * k.reference)

        memory = np.zeros((self.n_internal, gamma.size))
        memory[1] = gamma
        memory[2] = cap
        return memory.reshape(-1, *stress.shape[1:])

    def _check_initial(self, c: Array) -> None:
        """Refuse stresses (3, n), compression positive, in tension or outside of the surface."""
        # find the stress that lies outside most
        k = self.constants
        size = np.abs(c).max(axis=0)
        excess = c[0] - c[2] - k.failure * c[2]
        outside = np.flatnonzero(excess > _OUTSIDE * np.maximum(size, LEAST * k.reference))
        if outside.size:
            worst = outside[np.argmax(excess[outside])]
            s3, s1 = k.shift - c[[0, 2], worst]
            where = f"outside the failure surface by {excess[worst]:.4g}"
            if c[2, worst] < 0:
                where = "in tension"
            raise InadmissibleStress(
                f"initial stress of HardeningSoil {where} at {outside.size} of {c.shape[1]} "
                f"points, most at point {worst}: principal stresses {s1:.4g} and {s3:.4g} with "
                f"c={self.c:g}, phi={self.phi:g}; change K0, or give more cohesion",
                int(worst),
            )

        # warn of points whose stiffness is bounded below
        bare = np.count_nonzero(c[2] < LEAST * k.reference)
        if bare and size.max() > 0:
            warn(
                f"{bare} points of HardeningSoil are compressed by less than "
                f"{LEAST * k.reference:.3g}, where the stiffness does not fall with the stress any "
                "more: give a small cohesion c, or a surcharge"
            )

    @override
    def update(self, strain_increment: Array, stress: Array, internal: Array) -> Update:
        check_shapes(strain_increment, stress)
        increment = strain_increment.reshape(len(stress), -1)
        before = internal.reshape(len(internal), -1)
        new, memory, tangent = self._followed(
            increment, stress.reshape(len(stress), -1), before, _HALVINGS
        )
        points = np.arange(new.shape[1])
        return Update(new.reshape(stress.shape), memory.reshape(internal.shape), points, tangent)

    def _followed(
        self,
        increment: Array,
        stress: Array,
        memory: Array,
        halvings: int,
    ) -> tuple[Array, Array, Callable[[], Array]]:
        """Return stresses, internal variables and tangent; halve increments without a result."""
        # return the points in blocks
        new = stress.copy()
        after = memory.copy()
        blocks = []
        failures = [np.zeros(0, np.intp)]
        for start in range(0, stress.shape[1], BLOCK):
            block = self._return_block(increment, new, after, slice(start, start + BLOCK))
            blocks.append(block)
            failures.append(start + block.points[block.returned.failed])

        # halve the increments of the others
        failed = np.concatenate(failures)
        if failed.size and halvings == 0:
            raise IncrementTooLarge(
                f"{failed.size} of {stress.shape[1]} points of HardeningSoil have no admissible "
                f"stress: the increment of the first is {increment[:, failed[0]]}"
            )
        remaining = take((increment, stress, memory), failed)
        if failed.size:
            new[:, failed], after[:, failed] = self._by_halves(*remaining, halvings - 1)

        def tangent() -> Array:
            slopes = np.concatenate([_tangent(block, self.constants) for block in blocks])
            if failed.size:
                slopes[failed] = self._differences(*remaining, halvings - 1)
            return slopes

        return new, after, tangent

    def _by_halves(
        self,
        increment: Array,
        stress: Array,
        memory: Array,
        halvings: int,
    ) -> tuple[Array, Array]:
        """Return stresses and internal variables after the two halves of an increment."""
        for _ in range(2):
            stress, memory, _ = self._followed(0.5 * increment, stress, memory, halvings)
        return stress, memory

    def _differences(self, increment: Array, stress: Array, memory: Array, halvings: int) -> Array:
        """Return the tangent of halved increments, (n, ncomp, ncomp), by central differences."""
        ncomp, n = increment.shape
        size = _DIFFERENCE * np.abs(increment).max(axis=0)
        unit = np.eye(ncomp)
        units = np.concatenate((unit, -unit))
        steps = units[:, :, None] * size  # (2 ncomp, ncomp, n)
        ends = np.concatenate(list(increment + steps), axis=1)
        stresses = np.tile(stress, 2 * ncomp)
        memories = np.tile(memory, 2 * ncomp)
        results = self._by_halves(ends, stresses, memories, halvings)[0]
        ahead, behind = results.reshape(ncomp, 2, ncomp, n).transpose(1, 3, 0, 2)
        return (ahead - behind) / (2 * size[:, None, None])

    def _return_block(self, increment: Array, stress: Array, memory: Array, block: slice) -> _Block:
        """Update the points of a block in place: stress (ncomp, n), memory (n_internal, n)."""
        k = self.constants
        strain = increment[:, block]
        new = stress[:, block]
        own = memory[:, block]

        # stiffen the increment at small strains
        small = self._stiffening(strain, own[3:])
        own[3:] = small.memory
        faster = small.factor ** (1 + 0.5 * k.unloading / k.initial)

        # try the elastic stress
        push = 2 * k.mu * strain
        push[3:] *= 0.5
        push[:3] += k.lam * strain[:3].sum(axis=0)
        t = Points(
            new.copy(),
            push,
            gamma=own[1].copy(),
            cap=own[2].copy(),
            scale=k.scale(k.shift - principal_stresses(new)[0]),
            factor=small.factor,
            faster=faster,
        )
        scale = elastic_scale(t, k)
        new[...] = t.stress + scale * push

        # find the points outside of the yield surface
        c = k.shift - t.trial(scale).values[::-1]
        largest = np.maximum(np.abs(c[0]), np.abs(c[2]))
        size = np.maximum(largest, LEAST * k.reference)
        strength, _, _ = k.shear_strength(c[2], own[1], k.scale(c[2]))
        sheared = c[0] - c[2] - strength
        crushed = np.where(c.sum(axis=0) > 0, k.cap_stress(c) - own[2], 0.0)
        points = np.flatnonzero(~(np.maximum(sheared, crushed) <= ROUND_OFF * size))

        # return them
        t = take(t, points)
        returned = hardening_return(t, k)
        scale[points] = returned.scale
        frame = t.trial(returned.scale)
        values = k.shift - returned.c[::-1]
        new[:, points] = frame.stress(values)
        own[0, points] += equivalent_shear_strain(frame.values - values, k.mu * returned.scale)
        own[1, points] = returned.gamma
        own[2, points] = returned.cap
        return _Block(
            points,
            strain,
            new,
            push,
            scale,
            small,
            frame,
            values,
            returned,
        )

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
    """Increments of a block of points, and the data of the points that yield."""

    points: NDArray[np.intp]  # that yield
    strain: Array  # (ncomp, n)
    stress: Array  # (ncomp, n)
    push: Array  # elastic change of the stress at the scale 1, (ncomp, n)
    scale: Array  # (n,)
    small: Stiffening
    frame: Frame  # of the yielding points
    values: Array  # their principal stresses, (3, n)
    returned: Returned


def _tangent(block: _Block, k: Constants) -> Array:
    """Return the tangent, (n, ncomp, ncomp): of a fixed scale, and of its change.

    d stress = D d strain + by_scale d scale, with d scale by stress and strain at the end.
    """
    points = block.points
    ncomp = len(block.stress)
    n = block.scale.size

    # differentiate the stress with the scale fixed
    result = block.scale[:, None, None] * k.stiffness(ncomp)
    slopes, own = block.returned.slopes()
    scale = block.scale[points]
    volume = slopes.sum(axis=1, keepdims=True)
    moduli = (2 * k.mu * slopes + k.lam * volume) * scale
    moduli = moduli[::-1, ::-1]
    result[points] = block.frame.tangent(moduli, block.values, k.mu * scale)

    # differentiate it by the scale
    by_scale = block.push.copy()
    hardened = block.frame.stress(own[::-1])
    pushed = np.einsum("nij,jn->in", result[points], block.strain[:, points])
    by_scale[:, points] = (pushed - hardened) / scale

    # add the change of the factor of small strains
    factor = block.small.factor
    if len(block.small.slope) == ncomp:
        by_factor = block.scale / factor * by_scale
        power = 1 + 0.5 * k.unloading / k.initial
        by_factor[:, points] += power / factor[points] * hardened
        result += by_factor.T[:, :, None] * block.small.slope.T[:, None, :]

    # add the change of the scale by the stress at the end
    axes = principal(block.stress)
    least = k.shift - axes.values[0]
    by_least = k.scale_slope(least, k.scale(least))
    direction = axes.stress(np.eye(3)[:, :1] * np.ones(n))
    rate = -0.5 * factor * by_least * direction
    rate[3:] *= 2
    own = 1 - (rate * by_scale).sum(axis=0)
    gain = np.einsum("in,nij->nj", rate, result) / own[:, None]
    return result + by_scale.T[:, :, None] * gain[:, None, :]
