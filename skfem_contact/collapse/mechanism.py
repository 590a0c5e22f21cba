"""Mechanisms: motions that bars, blocks in contact and points that flow do not resist."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, diags

from ..arrays import max_abs, quotient
from ..errors import NoEquilibrium, NotConverged, warn
from ..forms.assembly import SWING, has_corners_only, locked, swing
from ..forms.base import Form, Forms, Response, States, solids_of
from ..limit_analysis import Bounds
from ..materials.spectral import principal_stresses
from ..nonlinear.newton import Newton
from ..nonlinear.step import Attempt, Step
from ..nonlinear.system import System
from ..results.patch_recovery import projected
from ..results.stage import StageResult
from ..solvers.direct import SingularSystem

FACTOR = "factor of safety"
LOAD = "limit load"
#: Stiffnesses of the springs, relative to the largest entry of each row of the tangent, and a
#: sequence that leads to them one by one: a cube of quadratic tetrahedra that is crushed as a
#: whole, with two equal stresses, fails without, and takes 2 to 5 iterations with each of these.
_SOFT = (1e-7, 1e-9)
_SOFTER = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)
#: Least share of the load that springs resist in a mechanism, and its ratio for the two
#: stiffnesses: 1 in a mechanism, 0.01 where something else resists, 0.6 to 0.8 where that is as
#: soft as the springs (a bar of .015 m lever, limit load 16.4 instead of 16.7 with a ratio of 0.5;
#: five bars, 7.44 instead of 7.51 with one of 0.7).
_SHARE = 1e-3
_SAME = 0.9
#: Share of the forces out of balance that may remain: a push of 1 % of the weight is within the
#: tolerance of a search.
_BALANCE = 0.1
#: Displacement up to which displacements count as small, over the extent of the model. Five nails
#: as elastic beams in a slope of 8 m led a search to 193 m and a factor of 1.61, for 1.575 at a
#: tenth of the extent, 2.4 m.
_FAR = 0.1

#: Share that the mesh adds, over what the stresses lose by their projection. Alone it gives .2 to
#: .5 of the true share under rigid strips on sand with a weight, and .3 to .6 on slopes.
_ADDED = 1.76
#: Share that the mesh adds, over the power by which stresses vary in elements, with the mean of
#: the power of the strength and the power of the load. Alone it gives .5 to 2 of the true share
#: under strips with a weight, .6 to 1.2 on slopes and cuts, and 2.4 to 2.6 under even loads on
#: sand. The mean of both is .55 to 1.94 on 39 scenes whose meshes add 1.7 to 41 %: rough and
#: smooth strips on clay and on sand with phi of 20 to 35 degrees, with and without weight and
#: surcharge, even loads, slopes, cuts with and without tensile strength. On 16 scenes that were not
#: used for these numbers, slopes of 27 to 70 degrees with phi of 0 to 35 degrees, quadrilaterals,
#: slices of tetrahedra and hexahedra, and strips with a weight, whose meshes add 3 to 43 %, it is
#: .50 to 1.24, by projection alone .15 to 1.5. On meshes of few elements it is as little as .37
#: under strips on sand of 20 degrees with a weight, and .26 on slopes of 70 degrees with phi of 35
#: degrees: there a search with every element cut shows the share, see finer.py.
_VARIATION = 1.72
#: Largest ratio of this estimate and the one by projection, each without its limits: smooth
#: stresses vary, but lose nothing. It is at most 2.3 on these scenes.
_SMOOTH = 2.5
#: Largest share of a value that a mesh adds.
_MOST = 0.9
#: Largest part of one element in the power that the stresses lose, over the power of its strength
#: and over the whole power. At singular points the projection loses more than the stresses: where
#: the mesh adds 8.9 and 4.6 % to vertical cuts without tensile strength, the estimate is 7.3 % for
#: both, and 67 and 76 % without these; under an even load on sand 5.8 and 15.7 % for 5.6 %.
_OF_ELEMENT = 0.04
_OF_WHOLE = 0.005
#: Largest share that the mesh adds, over the power by which stresses vary in elements: that is .26
#: to 1.8 of the true share on these slopes, the seven published ones, strips at and below the
#: surface, even loads and cuts with and without tensile strength, and does not change as elements
#: shrink. A projection crosses the crack of a cut without tensile strength: there the estimate
#: without this limit is up to 7 times the true share.
_VARIED = 3.5
#: Least and largest true share over its estimate, see above and finer.py.
_DOUBT = (0.5, 2.6)
#: Largest variation of strains in an element over the largest strain that is round-off.
_UNIFORM = 1e-9
#: Variation of strains, as a share of the largest, below which a body strains evenly: 1e-9 in
#: samples.
_EVEN = 1e-6
#: Share of the slip below which a region does not matter.
_COUNTS = 0.01
#: Share of the way from the lower to the upper bound on a mesh at which the exact value lies: .24
#: to .33 on these slopes, if the bounds are closer than the second number, as a share of the upper
#: one.
_BETWEEN = 0.3
_CLOSE = 0.4
#: Share by which a mesh is too coarse where bounds do not show it, and times the tolerance where
#: they do.
COARSE = 0.025
_TIMES = 2.0

#: Change of volume over the largest shear strain, the sine of the dilation angle, that is none.
_ISOCHORIC = 0.1

#: Kinds of remarks on what changes a collapse load.
_TOLD = ("pivot", "locking", "torque")


class _Springs(Form):
    """Springs that hold all motions at a configuration."""

    symmetric = True

    def __init__(self, stiffness: ndarray, x: ndarray) -> None:
        self._stiffness = stiffness
        self._x = x

    def assemble(self, x: ndarray, state: Any) -> Response:
        return Response(
            self._stiffness * (x - self._x),
            lambda: state,
            lambda: csr_matrix(diags(self._stiffness)),
        )


def as_collapse(
    error: NotConverged,
    system: System,
    x: ndarray,
    states: States,
    load: ndarray,
    newton: Newton,
) -> NotConverged:
    """Return the error, or :class:`NoEquilibrium` if only soft springs hold the structure.

    The tangent of a mechanism is singular, but so is the tangent of single points without pressure
    at an equilibrium.
    """
    # hold all dofs by springs, soft over the rows of the tangent
    begun = system.evaluate(x, states, load)
    rows = abs(system.tangent(begun)).max(axis=1).toarray().ravel()
    rows[system.layout.still] = 0.0
    exact = replace(newton, tolerance=min(newton.tolerance, _BALANCE * begun.norm))
    name = " ".join([*system.forms, "springs"])  # longer than every other name

    def shares(stiffnesses: tuple[float, ...]) -> tuple[ndarray, dict[float, float]]:
        """Return displacements with the softest springs, and shares of the work by stiffness."""
        now = x
        share = {}
        for soft in stiffnesses:
            springs = _Springs(soft * rows, x)
            held = system.with_forms({**system.forms, name: springs})
            step = Step(held, x, {**states, name: None}, load, x[system.fixed], start=now)
            now = step.equilibrium(exact, Attempt(at_least=1, damp=True)).x
            work = float(begun.residual @ (now - x))
            resisted = float(springs.assemble(now, None).force @ (now - x))
            share[soft] = resisted / work if work > 0.0 else 0.0
        return now, share

    # compare the shares of the work: equal in a mechanism, falling where something else resists
    try:
        now, share = shares(_SOFT)
    except NotConverged:
        try:
            now, share = shares(_SOFTER)
        except NotConverged:
            return error
    last = share[_SOFT[-1]]
    if last < max(_SHARE, _SAME * share[_SOFT[0]]):
        return error
    return NoEquilibrium(
        f"nothing resists a motion: only springs would resist {last:.1%} of the load",
        now,
        error.residuals,
        int(np.argmax(np.abs(now - x))),
    )


def warn_of_errors(system: System, x: ndarray, states: States) -> None:
    """Raise warnings of errors of a collapse load: joints that turn or hook, elements that lock."""
    for name, form in system.forms.items():
        for remark in form.outputs(x[: form.size], states[name]).remarks:
            if remark.kind in _TOLD:
                warn(f"{name}: {remark.text}")


def warn_of_locking(
    forms: Forms,
    bands: Mapping[str, ndarray],
    states: States,
    motion: ndarray,
) -> None:
    """Raise a warning of elements that lock, as soil flows in them without change of volume.

    Where no flow keeps the volume at all points of an element, its mean stresses, less their linear
    part, are many times the shear strength.
    """
    for name, form in _banded(forms, bands):
        if has_corners_only(form.basis):
            continue
        # See whether the volume stays.
        slip = form.weight * bands[name]
        volume = form.strains(motion[: form.size])[:3].sum(axis=0)
        if (form.weight * np.abs(volume)).sum() > _ISOCHORIC * slip.sum():
            continue

        times = swing(form.basis, states[name].stress, slip)
        if times > SWING:
            warn(
                f"{name}: soil flows without change of volume in {locked(form.basis, times)}, and "
                "the result may be higher than its estimated error says: take ElementTriP2 or "
                "ElementQuadS2 with intorder=2"
            )


def slips_on_planes(
    forms: Forms,
    bands: Mapping[str, ndarray],
    motion: ndarray,
) -> bool:
    """Return True if materials slip along their planes, and strains vary in the mechanism."""
    whole = sum(float((form.weight * bands[name]).sum()) for name, form in _banded(forms, bands))
    for name, form in _banded(forms, bands):
        strain = form.strains(motion[: form.size])
        slip = form.weight * bands[name]
        for region in form.regions:
            own = strain[:, region.elements]
            varies = np.ptp(own, axis=(1, 2)).max() > _EVEN * max_abs(own)
            counts = slip[region.elements].sum() > _COUNTS * whole
            if region.material.slips_on_planes and varies and counts:
                return True
    return False


def warn_of_planes(what: str) -> None:
    """Raise a warning of a value whose error is not known, as rock slips along its joints."""
    warn(
        f"by how much the mesh adds to the {what} is not known where rock slips along its joints, "
        "which few elements can: it may be far too high. Put a row of elements of one thickness "
        "along the joint that slips, or a ContactPair, and compare"
    )


def _banded(forms: Forms, bands: Mapping[str, ndarray]) -> list[tuple[str, Any]]:
    """Return the solids that have bands."""
    return [(name, form) for name, form in solids_of(forms).items() if name in bands]


def warn_of_motion(
    what: str,
    value: float,
    curve: ndarray,
    tolerance: float,
    end: StageResult,
) -> None:
    """Raise a warning if the curve, (n, 3), still rises at displacements that are not small."""
    # Displacements of a tenth of the model are far.
    if end.layout:
        coordinates = end.layout.coordinates
    else:
        coordinates = np.zeros((2, 1))
    near = _FAR * np.ptp(coordinates, axis=1).max()
    moved = np.maximum.accumulate(curve[1:, 2])
    if not len(moved) or not moved[-1] > near > 0.0:
        return
    # Compare the limit with the values that near displacements reach.
    values = curve[:, 1]
    is_near = curve[:, 2] <= near
    at_end = np.interp(near, moved, values[1:])
    reached = max(at_end, values[is_near].max(initial=-np.inf))
    if value - reached > tolerance:
        warn(
            f"the {what} {value:.4g} belongs to displacements of {moved[-1]:.3g}, and those up to "
            f"{near:.3g}, a tenth of the model, give {reached:.4g}: parts such as elastic beams "
            "resist without limit, or bodies are soft"
        )


def describe_mesh(forms: Forms) -> str:
    """Return elements and dofs in one line, such as ``576 ElementTriP2, 2442 dofs``."""
    bases = [form.basis for form in solids_of(forms).values()]
    if not bases:
        return "no elements"
    count = Counter[str]()
    for basis in bases:
        count[type(basis.elem.elem).__name__] += basis.nelems
    elements = " and ".join(f"{n} {kind}" for kind, n in count.items())
    return f"{elements}, {bases[0].N} dofs"


class Lost(NamedTuple):
    """Powers that a mesh adds to a mechanism, by element: (n,) each."""

    elements: ndarray  # numbers of the elements
    added: ndarray  # power that the mesh adds, of either sign
    varied: ndarray  # power of the stresses less their means in the elements
    strength: ndarray  # power of the strength


def lost_power(
    forms: Forms,
    bands: Mapping[str, ndarray],
    states: States,
    motion: ndarray,
) -> Lost:
    r"""Return the power that the size of elements adds to a mechanism, and the one of the strength.

    The exact stresses balance the exact load, also on the mechanism of the mesh,
    :math:`\dot\varepsilon`, so that
    :math:`\int (\sigma - \sigma_{\rm exact}) : \dot\varepsilon` is the power that the mesh adds.
    Stresses that are projected on linear functions stand for the exact ones.

    Means of the stresses in an element, weighted by :math:`\dot\gamma`, are on the safe side of a
    convex strength, so that the power :math:`\int (\sigma - \bar\sigma) : \dot\varepsilon` is
    positive. Elements of one strain do not show it; theirs is infinite.

    Strength adds the power :math:`\int \tau (\dot\gamma^2 - \dot\varepsilon_V^2) / \dot\gamma` of
    the largest shear stresses and strains; soil with friction,
    :math:`\dot\varepsilon_V = \dot\gamma \sin\phi`, gets less from it. Bands are these strains by
    solid, (n_elements, n_points).
    """
    parts = [Lost(np.zeros(0, int), np.zeros(0), np.zeros(0), np.zeros(0))]
    for name, form in _banded(forms, bands):
        stress = states[name].stress
        strain = form.strains(motion[: form.size])
        slip = bands[name]

        # int (sigma - sigma_projected) : strain
        at, _, smooth = projected(form, stress)
        excess = stress - (at @ smooth).T.reshape(stress.shape)
        power_density = (excess * strain).sum(axis=0)
        added = (form.weight * power_density).sum(axis=1)

        # int (sigma - mean) : strain
        flow = form.weight * slip + np.finfo(float).tiny
        mean = (stress * flow).sum(axis=2) / flow.sum(axis=1)
        varies = ((stress - mean[:, :, None]) * strain).sum(axis=0)
        varied = (form.weight * varies).sum(axis=1)
        if np.ptp(strain, axis=2).max() <= _UNIFORM * max_abs(strain):
            varied[:] = np.inf

        # int tau (gamma^2 - eps_V^2) / gamma
        volume = strain[:3].sum(axis=0)
        less = quotient(volume**2, slip)
        largest, _, smallest = principal_stresses(stress)
        spent = form.weight * (largest - smallest) * np.maximum(slip - less, 0.0)
        parts.append(Lost(form.elements, added, varied, 0.5 * spent.sum(axis=1)))
    return Lost(*map(np.concatenate, zip(*parts, strict=True)))


def power_of_contact(system: System, states: States, motion: ndarray, load: ndarray) -> float:
    """Return the power that contact takes of the load in a mechanism, 0 without contact."""
    if not system.unilateral:
        return 0.0
    # power of the load, less that of the stresses
    left = float(load @ motion)
    for name, form in solids_of(system.forms).items():
        density = (states[name].stress * form.strains(motion[: form.size])).sum(axis=0)
        left -= float((form.weight * density).sum())
    return max(left, 0.0)


def added_by_mesh(lost: Lost, power: float | None, contact: float = 0.0) -> float:
    r"""Estimate the share that the size of elements adds to a factor or a limit load.

    The whole power P is the given one of a limit load, or the power S of the strength and the power
    of contact. The power that the mesh adds has two estimates, which err in opposite directions:
    the loss of the stresses by their projection, over P, is too little under the edges of rigid
    parts, and their variation in elements, over :math:`\sqrt{P S}`, is too much under the edges of
    even loads. Their mean is a share s of the value that was found, which exceeds the exact one by
    s / (1 - s).
    """
    # limit the part of every element
    strength = float(lost.strength.sum())
    if power is None:
        whole = strength + contact
    else:
        whole = power
    if not min(whole, strength) > 0.0:
        return 0.0
    most = np.maximum(_OF_ELEMENT * lost.strength, _OF_WHOLE * whole)
    projected = _ADDED * float(np.clip(lost.added, -most, most).sum()) / whole
    # limit the sum by the variation of the stresses in the elements
    varied = float(lost.varied.sum())
    share = max(min(projected, _VARIED * varied / whole), 0.0)
    # average it with the variation, which elements of one strain do not show
    if np.isfinite(varied):
        unlimited = _ADDED * max(float(lost.added.sum()), 0.0) / whole
        variation = _VARIATION * varied / np.sqrt(whole * strength)
        share = 0.5 * (share + max(min(variation, _SMOOTH * unlimited), 0.0))
    share = min(share, _MOST)
    return share / (1.0 - share)


def within_bounds(added: float, value: float, proven: Bounds) -> float:
    """Return the share that the mesh adds to a value, limited by proven bounds of the exact one."""
    least = value / proven.upper - 1.0
    most = np.inf
    if proven.lower > 0.0 and not proven.estimate:
        most = value / proven.lower - 1.0
    return max(min(max(added, least), most), 0.0)


def warn_of_mesh(
    what: str,
    value: float,
    added: float,
    proven: Bounds | None,
    tolerance: float,
) -> None:
    """Raise a warning if a value lies outside of its bounds, or if the mesh adds much to it."""
    least, most = (doubt * added for doubt in _DOUBT)
    if proven is None:
        if added > COARSE:
            _warn_of_coarse_mesh(what, value, added, (least, most))
        return
    low = proven.lower
    high = proven.upper
    bounds = f"[{low:.4g}, {high:.4g}]"

    # take the share that the mesh adds from bounds that are close, otherwise its estimate
    if proven.estimate or not low > (1.0 - _CLOSE) * high:
        if added > COARSE:
            least = within_bounds(least, value, proven)
            most = within_bounds(most, value, proven)
            _warn_of_coarse_mesh(what, value, added, (least, most))
    elif added * value > tolerance:
        exact = low + _BETWEEN * (high - low)
        if high + tolerance >= value > exact + _TIMES * tolerance:
            between = (max(value / high - 1.0, 0.0), value / low - 1.0)
            _warn_of_coarse_mesh(what, value, value / exact - 1.0, between, bounds)

    # compare the value with the bounds
    if value > high + tolerance:
        warn(
            f"the {what} {value:.4g} lies above {bounds}, its bounds: the mesh is too coarse by at "
            f"least {value / high - 1.0:.1%}, or elements of corner nodes lock; `proven.mesh` is "
            "a better one"
        )
    elif value < low - tolerance and not proven.estimate:
        warn(
            f"the {what} {value:.4g} lies below {bounds}, its bounds: the search ended too early, "
            "or the flow is not associated"
        )


def _warn_of_coarse_mesh(
    what: str,
    value: float,
    share: float,
    between: tuple[float, float],
    bounds: str = "",
) -> None:
    """Raise a warning of a value that is too high by a share, estimated or from bounds."""
    least, most = between
    evidence = f"bounds are {bounds}; " if bounds else ""
    warn(
        f"the {what} {value:.4g} is about {share:.1%} too high ({least:.1%} to {most:.1%}), for "
        f"displacements do not jump inside of elements: {evidence}refine the mesh along the "
        "mechanism"
    )


def is_singular(error: NotConverged) -> bool:
    """Return True if a tangent was singular."""
    return isinstance(error.__cause__, SingularSystem)
