"""Certificates of stresses and velocities, computed after the solver by the theorems."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy import ndarray

from ..arrays import max_abs
from .elements import Program
from .interior_point import HIGHEST, Solution

#: Share of plain stiffness in the metric in which stresses are put into equilibrium: with the
#: solver's alone points at yield could not move at all, with the plain one soil of little stress
#: would lose up to 2 % of the factor. A larger one is taken where one leads to no equilibrium: with
#: noise of 1e-14 a pile in the ground has no lower bound in two of nine runs with the first alone,
#: and 1.3340 to 1.3341 in all with two, but with PARDISO one of four runs needs the last.
_PLAIN = 1e-5, 1e-4, 1e-3, 1e-2, 1e-1
#: Least stress, as a share of the largest, to which that metric is proportional. Of 150 stacks of
#: blocks 7 have no lower bound with a metric that is alike everywhere, 5 with 1e-3, 3 with 1e-6 and
#: 1e-9.
_SMALL = 1e-6
#: Equilibrium is repeated until it is violated by less than this share, at most so often; beyond
#: the last, refused. A pile in the ground (c = 7,500 and 32) leaves 2e-13 after 8 repetitions and
#: 2e-14 after 20.
_BALANCED = 1e-15
_REPETITIONS = 20
UNBALANCED = 1e-13
#: The change of volume and the overlap of a velocity are taken out until they are below this share
#: of the largest strain, at most so often: a slope in clay and a vertical cut take two or three
#: times, and round-off leaves 1e-15 to 2e-14.
_SHAPED = 1e-13
_SHAPINGS = 40
#: Stiffness against changes of volume that is added to that metric, as a share of it. Beside joints
#: changes of 1e-12 to 1e-9 stayed without it; with 1e6 two corrections leave 1e-15, with 1e2 33.
_INCOMPRESSIBLE = 1e6
#: Stress below this share of the largest is none.
_NO_STRESS = 1e-12
#: Power of the loads on a velocity, as a share of its terms, that is round-off: bounds of 1e20 come
#: from it.
_ROUND_OFF = 1e-12
#: Accuracy of the factor at which dissipation and power are equal.
_ROOT = 1e-13
#: Earlier stresses that are balanced where the last ones prove nothing, at most: at joints without
#: adhesion, to 1e-4 of the limit load, the one before the last proves all but 3e-5 of it.
_EARLIER = 4
#: Lacks of opening that are corrected, as shares of the opening that the slip demands: with a
#: smaller one a joint yields at a larger factor. Corrections of all yielding joints of a pile in
#: the ground moved it so much that no upper bound was left; a multiplied load has no other factor.
_LACKING = (0.01, 0.0)
#: Shares of an inner velocity that are mixed in where a velocity leaves the flow rule.
_MIXED = (0.0, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3)


@dataclass(frozen=True)
class Proof:
    """Bound and the field that proves it."""

    value: float  # factor or multiplier; -inf or inf where nothing was proven
    field: ndarray  # stresses (n_points, 3), or velocities (m,) that move the loads with unit power
    # largest relative violation of equilibrium, or of a flow rule that is an equation
    residual: float


def prove_lower(program: Program, found: Solution, live: bool) -> Proof:
    """Prove a lower bound: the largest factor that stresses in equilibrium admit.

    With a multiplied load the bound is a multiplier. Where the last stresses leave the strength as
    they are balanced, earlier ones follow, which are farther inside.
    """
    proof = _admissible(program, found, live)
    for inner in reversed(found.inner[-_EARLIER:]):
        proven = np.isfinite(proof.value) and proof.value != 0.0
        if proven or proof.residual > UNBALANCED:
            break
        before = replace(found, theta=inner.theta, stress=inner.stress)
        earlier = _admissible(program, before, live)
        if earlier.value > proof.value:
            proof = earlier
    return proof


def _admissible(program: Program, found: Solution, live: bool) -> Proof:
    """Return the bound by stresses: balanced, and scaled until they are admissible."""
    # Balance the stresses; a plainer balance follows where round-off leaves a residual.
    theta = 1.0
    if live:
        theta = found.theta
    for plain in _PLAIN:
        stress, residual = _balanced(program, found, theta, plain)
        if residual <= UNBALANCED:
            break
    else:
        return Proof(-np.inf, stress, residual)
    # Scale the stresses until they are admissible everywhere.
    round_off = _NO_STRESS * max_abs(stress)
    if not live:
        return Proof(_admitted(program, stress, round_off), stress, residual)
    # With a dead load the stresses are admissible or prove nothing.
    if np.any(program.dead):
        holds = _admitted(program, stress, round_off) >= 1.0
        return Proof(theta if holds else -np.inf, stress, residual)
    share = _largest_share(program, stress, round_off)
    return Proof(share * theta, share * stress, residual)


def _balanced(
    program: Program,
    found: Solution,
    theta: float,
    plain: float,
) -> tuple[ndarray, float]:
    """Move stresses into equilibrium, where it costs least; return also the relative violation."""
    f = program.dead + theta * program.live
    stress = found.stress.copy()
    terms = abs(program.matrix) @ np.abs(stress).ravel()
    scale = float(terms.max(initial=0.0)) or 1.0

    # metric of the solver, scaled at every point, with a share of plain stiffness
    trace = np.trace(found.metric, axis1=1, axis2=2)[:, None, None]
    scaled = np.divide(found.metric, trace, out=np.zeros_like(found.metric), where=trace > 0)
    metric = scaled + plain * np.eye(3)  # (n_points, 3, 3)

    # small stresses move less: joints that open stay within their strength
    size = np.abs(stress).max(axis=1)
    share = np.maximum(size / (size.max(initial=0.0) or 1.0), _SMALL)
    metric *= share[:, None, None]
    inverse = program.factor(metric)
    for _ in range(_REPETITIONS):
        r = f - program.forces(stress)
        if max_abs(r) < _BALANCED * scale:
            break
        strain = program.strains(inverse(r))
        stress = stress + np.einsum("nij,nj->ni", metric, strain)
    violation = np.abs(f - program.forces(stress))
    return stress, float(violation.max(initial=0.0)) / scale


def _admitted(program: Program, stress: ndarray, round_off: float) -> float:
    """Return the largest factor that stresses at all points admit."""
    factors = program.of_points(lambda s, points: s.factor(stress[points], round_off))
    return float(factors.min())


def _largest_share(program: Program, stress: ndarray, round_off: float) -> float:
    """Return the largest number that stresses may be multiplied by; zero stress is admissible."""

    def holds(share: float) -> bool:
        return _admitted(program, share * stress, share * round_off) >= 1.0

    low = 0.0
    high = 2.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        if holds(middle):
            low = middle
        else:
            high = middle
    return low


def prove_upper(program: Program, found: Solution, live: bool) -> Proof:
    """Prove an upper bound: the factor or multiplier that the power of a flow refutes."""
    inner = found.velocity
    if found.inner:
        inner = found.inner[len(found.inner) // 2].velocity
    best = Proof(np.inf, -found.velocity, np.inf)
    shaped = _shaping(program, found)
    lacking = _LACKING if program.joints else _LACKING[:1]
    for lack in lacking:
        last = shaped(-found.velocity, lack)
        middle = shaped(-inner, lack)
        for share in _MIXED:
            velocity = (1 - share) * last + share * middle
            proof = _refuted(program, velocity, live)
            if proof.value < best.value:
                best = proof
            elif np.isfinite(best.value):
                break
        if np.isfinite(best.value):
            break
    return best


def _refuted(program: Program, velocity: ndarray, live: bool) -> Proof:
    """Return the bound by velocities: the smallest factor of their flow at which the loads win."""
    # scale the velocities to unit power
    fixed = program.dead @ velocity
    power = program.live @ velocity
    if not live:
        power = power + fixed
    forces = np.abs(program.live) + np.abs(program.dead)
    size = float(forces @ np.abs(velocity))
    if not power > _ROUND_OFF * size:
        return Proof(np.inf, velocity, np.inf)
    strain = program.strains(velocity) / power
    round_off = program.round_off(velocity) / power
    velocity = velocity / power
    fixed = fixed / power

    # find the least factor at which they are a plastic flow, and the power of the loads
    largest = float(np.abs(strain).max(initial=1e-300))
    factors = program.of_points(
        lambda s, points: s.flow_factor(strain[points], round_off[points], largest)
    )
    flow = float(factors.max())
    external = 1.0
    if live:
        external = fixed

    def excess(factor: float) -> float:
        """Return the dissipation less the power of the fixed loads."""
        return float(dissipation(program, strain, factor).sum()) - external

    value = np.inf
    if live:
        if flow <= 1.0:
            value = excess(1.0)
    elif flow <= HIGHEST and excess(HIGHEST) <= 0:
        value = max(flow, 1.0 / HIGHEST)
        if excess(value) > 0:
            value = (1 + _ROOT) * scipy.optimize.brentq(
                excess, value, HIGHEST, xtol=_ROOT, rtol=_ROOT
            )

    # measure the change of volume where it must vanish
    kept = program.incompressible
    rates = (strain[kept] * program.volume[kept]).sum(1)
    change = max_abs(rates)
    return Proof(value, velocity, float(change / largest))


def dissipation(program: Program, strain: ndarray, factor: float) -> ndarray:
    """Return the dissipation at every point, (n_points,)."""
    return program.of_points(lambda s, points: s.dissipation(strain[points], factor))


def _shaping(program: Program, found: Solution) -> Callable[[ndarray, float], ndarray]:
    """Return the correction of velocities to constant volume, and to bodies that do not overlap.

    Joints are opened that lack more than a share of their opening, its second argument.
    """
    kept = program.incompressible
    if not len(kept) and not program.joints:
        return lambda velocity, lack: velocity
    # correct volumes and overlaps by forces, as a linear solid with the metric of the solution
    volume = program.volume
    squared = (volume**2).sum(1)
    metric = found.metric.copy()
    size = np.trace(metric, axis1=1, axis2=2) / squared
    added = _INCOMPRESSIBLE * size[:, None, None] * volume[:, :, None] * volume[:, None]
    metric[kept] += added[kept]
    by_volume = np.einsum("ni,nij,nj->n", volume, metric, volume)
    stiffness = by_volume / squared**2
    inverse = program.factor(metric)

    def shaped(velocity: ndarray, lack: float) -> ndarray:
        for _ in range(_SHAPINGS):
            strain = program.strains(velocity)
            missing = _overlap(program, strain, found.factor, lack)
            missing[kept] = -(strain[kept] * volume[kept]).sum(1)
            largest = max_abs(strain)
            if max_abs(missing) <= _SHAPED * largest:
                break
            stress = (stiffness * missing)[:, None] * volume
            velocity = velocity + inverse(program.forces(stress))
        return velocity

    return shaped


def _overlap(program: Program, strain: ndarray, factor: float, lack: float) -> ndarray:
    """Return the opening that every point lacks, (n_points,)."""
    return program.of_points(lambda s, points: s.overlap(strain[points], factor, lack))
