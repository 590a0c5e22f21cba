"""Checks of a footing or gravity wall from the forces on it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy import ndarray

from ..arrays import cross_in_plane, left_of, row_norms
from ..checks import look_up, vector
from ..display import Table
from ..errors import warn
from ..forms.roles import Touching, having
from ..materials.base import parameters_of
from ..results.fields import basis_of
from ..results.fields import solids as solids_in
from ..results.stage import StageResult
from ..results.tractions import interfaces
from .bearing import BearingResistance, bearing_resistance
from .factored import divided
from .factors import EC7, PartialFactors

#: Distance of points of the base from its line, as a share of its length.
_ON_BASE = 1e-6
#: Unbalanced force on the body, as a share of all forces on it, that is warned of.
_UNBALANCED = 0.01


@dataclass(frozen=True)
class BaseCheck:
    """Forces on the base of a footing or wall, and its checks; printed as a table.

    Forces and moments come from the analysis; ratios hold design values: resistance over effect,
    at least 1 if the check passes, NaN where it was not asked for.

    Attributes
    ----------
    factors
        The set of partial factors.
    width
        Width of the base.
    vertical, horizontal
        Compression across the base, and force of the body on the ground along it, from heel to toe
        positive.
    eccentricity
        Distance of the resultant from the middle of the base, towards the toe.
    stabilising, overturning_moment
        Moments about the toe.
    bearing_resistance
        Characteristic or design resistance of the ground, see :func:`bearing_resistance`.
    rows
        Check, effect, resistance and ratio of each line of the table.
    """

    factors: PartialFactors
    width: float
    vertical: float
    horizontal: float
    eccentricity: float
    stabilising: float
    overturning_moment: float
    bearing_resistance: BearingResistance | None
    rows: tuple[tuple[str, float, float, float], ...]

    @property
    def effective_width(self) -> float:
        """Width whose middle is under the resultant, B - 2 e."""
        return self.width - 2.0 * abs(self.eccentricity)

    @property
    def sliding(self) -> float:
        """Resistance over effect of sliding."""
        return self._ratio("sliding")

    @property
    def overturning(self) -> float:
        """Resistance over effect of overturning, NaN where nothing overturns."""
        return self._ratio("overturning")

    @property
    def bearing(self) -> float:
        """Resistance over effect of bearing, NaN where no ground was given."""
        return self._ratio("bearing")

    @property
    def uplift(self) -> float:
        """Resistance over effect of uplift, NaN where nothing pushes upwards."""
        return self._ratio("uplift")

    def _ratio(self, name: str) -> float:
        return {row[0]: row[3] for row in self.rows}.get(name, np.nan)

    @property
    def passes(self) -> bool:
        """True if all ratios are at least 1."""
        return all(row[3] >= 1.0 for row in self.rows)

    @property
    def table(self) -> Table:
        """Table of effects, resistances and ratios."""
        caption = f"{self.factors.name}: e / B = {self.eccentricity / self.width:.3f}"
        head = ("check", "effect", "resistance", "ratio", "passes")
        rows = tuple((*row, "yes" if row[3] >= 1.0 else "no") for row in self.rows)
        return Table(head, rows, caption)

    def __str__(self) -> str:
        return str(self.table)

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return self.table._repr_html_()


def check(
    stage: StageResult,
    body: str,
    base: Sequence[Sequence[float]],
    *,
    factors: PartialFactors = EC7["characteristic"],
    ground: Any = None,
    unit_weight: float = 0.0,
    surcharge: float = 0.0,
    friction: float | None = None,
) -> BaseCheck:
    r"""Check sliding, overturning, bearing and uplift of a footing or gravity wall.

    Contact pairs along the base give its forces. Together with earth pressure,
    weight, water and loads they hold the body in equilibrium.

    Parameters
    ----------
    stage
        Stage of a run in the plane with the loads, and the strengths, of the set.
    body
        Name of the solid, region or subdomain that is the body. It touches the ground by contact
        pairs alone.
    base
        Toe and heel, the ends of the base: (x, y) each. Overturning is about the toe.
    factors
        Set of partial factors.
    ground
        Material below the base with characteristic `c` and `phi`, for bearing; it is divided by the
        factors here. Without it bearing is not checked.
    unit_weight, surcharge
        Effective unit weight of the ground below the base, and pressure next to it.
    friction
        Characteristic coefficient of friction of the base; it is divided by the factor on
        :math:`\tan\varphi`. By default friction and adhesion of the contact law, as they are in the
        stage.

    Returns
    -------
    BaseCheck
        Ratios and a table.

    Raises
    ------
    ValueError
        A body without contact along the base, or welded to the ground; a base in tension.

    Warns
    -----
    AnalysisWarning
        Other forces hold the body as well: an anchor, a prop or a support.

    Notes
    -----
    Horizontal forces and loads upwards, such as of water, overturn, all others stabilise. Moments
    about the toe are multiplied by the factors on permanent actions, `favourable` and `permanent`.
    Uplift is checked where loads and water together push upwards, against the weight of the body.

    Examples
    --------
    A block of 2 by 1 on a plate, with a horizontal force of 8 at its top:

    >>> import numpy as np
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> grid = MeshQuad.init_tensor(np.linspace(0, 2, 9), np.linspace(0, 1, 5)).with_defaults()
    >>> mesh = sc.join_bodies({"block": grid})
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> block = sc.SolidForm(basis, sc.LinearElastic(E=1e5, nu=0.), unit_weight=20.)
    >>> floor = sc.rigid.line((-1., 0.), (3., 0.))
    >>> skin = sc.ContactPair(basis, "block:bottom", floor, sc.Coulomb(mu=.5), penalty=1e8)
    >>> model = sc.Model({"block": block, "skin": skin})
    >>> load = model.traction("block:top", (-4., 0.))
    >>> stage = model.run([sc.Stage("push", load)])["push"]
    >>> print(sc.design.check(stage, "block", base=[(0., 0.), (2., 0.)]))
    characteristic: e / B = 0.100
    check        effect  resistance  ratio  passes
    sliding           8          20    2.5  yes
    overturning       8          40      5  yes
    """
    # Read the forces on the body.
    toe, heel = (vector(end, 2, "an end of the base") for end in base)
    dofs, elements = _body(stage, body)
    forces = _forces(stage, dofs, elements, toe, heel)
    _check_balance(forces, body)

    # Resolve the force on the base.
    width = float(np.linalg.norm(heel - toe))
    along = (toe - heel) / width
    across = np.array([-along[1], along[0]])
    if across[1] < 0.0:
        across = -across
    total = forces.base.sum(axis=0)
    vertical = float(total @ across)
    horizontal = -float(total @ along)
    if vertical <= 0.0:
        raise ValueError(
            f"the base of '{body}' is not in compression: its normal force is {vertical:.4g}"
        )
    moment = _moment(forces.points, forces.base, toe)
    lever = abs(moment) / vertical
    eccentricity = 0.5 * width - lever

    # Check one limit state after the other.
    rows = [_sliding(forces, across, horizontal, factors, friction)]
    stabilising, overturning = _moments(forces, toe)
    if overturning > 0.0:
        against = factors.permanent * overturning
        rows.append(_row("overturning", against, factors.favourable * stabilising))
    resistance = None
    if ground is not None:
        resistance = _bearing(
            ground,
            factors,
            vertical,
            horizontal,
            width,
            eccentricity,
            unit_weight,
            surcharge,
        )
        effect = factors.effect(vertical)
        rows.append(_row("bearing", effect, resistance.resistance / factors.bearing))
    rows += _uplift(forces, factors)

    return BaseCheck(
        factors=factors,
        width=width,
        vertical=vertical,
        horizontal=horizontal,
        eccentricity=eccentricity,
        stabilising=stabilising,
        overturning_moment=overturning,
        bearing_resistance=resistance,
        rows=tuple(rows),
    )


@dataclass(frozen=True)
class _Forces:
    """Forces on a body: of contact at points, and of loads at its nodes."""

    points: ndarray  # contact points on the base, (n, 2)
    base: ndarray  # forces there, (n, 2)
    strength: ndarray  # coefficient of friction and adhesion times length there, (2, n)
    other_points: ndarray  # other contact points, (m, 2)
    thrust: ndarray  # forces there, (m, 2)
    nodes: ndarray  # (k, 2)
    loads: ndarray  # (k, 2)
    weight: ndarray  # the part of the loads that is its own weight, (k, 2)


def _body(stage: StageResult, name: str) -> tuple[ndarray, Mapping[str, ndarray]]:
    """Return dofs, (n, 2), of a solid or region, and its elements by solid."""
    solids = solids_in(stage)
    if {form.coordinates for form in solids.values()} != {"plane"}:
        raise ValueError("checks of footings and walls need plane bodies")
    existing = dict.fromkeys(solids)
    for form in solids.values():
        existing |= dict.fromkeys(region.name for region in form.regions)
        existing |= dict.fromkeys(form.basis.mesh.subdomains or {})
    look_up(name, existing, f"solid, region or subdomain in stage '{stage.name}'")
    elements = {}
    for key, form in solids.items():
        part = _named_elements(form, key, name)
        if len(part):
            elements[key] = part

    # Refuse nodes in common with the rest.
    inside: list[ndarray] = []
    outside: list[ndarray] = []
    for key, form in solids.items():
        own = np.isin(np.arange(form.basis.nelems), elements.get(key, ()))
        inside.append(form.basis.element_dofs[:, own].ravel())
        outside.append(form.basis.element_dofs[:, ~own].ravel())
    dofs = np.unique(np.concatenate(inside))
    if np.isin(dofs, np.concatenate(outside)).any():
        raise ValueError(
            f"'{name}' is welded to other bodies: join the mesh as bodies of their own and put a "
            "ContactPair between them"
        )
    return dofs.reshape(-1, 2), elements


def _named_elements(form: Any, key: str, name: str) -> ndarray:
    """Return the elements of a solid, a region or a subdomain, as numbers in the solid."""
    own = np.arange(form.basis.nelems)
    parts = []
    for region in form.regions:
        if name in (key, region.name):
            parts.append(own[region.elements])
    if parts:
        return np.unique(np.concatenate(parts))
    numbers = (form.basis.mesh.subdomains or {}).get(name, ())
    return np.flatnonzero(np.isin(form.elements, numbers))


def _forces(
    stage: StageResult,
    dofs: ndarray,
    elements: Mapping[str, ndarray],
    toe: ndarray,
    heel: ndarray,
) -> _Forces:
    """Return all forces on a body with these dofs, (n, 2)."""
    points = []
    vectors = []
    strengths = []
    facets = interfaces(stage)
    for name, pair in having(stage.forms, Touching).items():
        if name not in facets:
            continue
        as_slave = np.isin(pair.slave.dofs, dofs).all()
        as_master = pair.master.meshed and np.isin(pair.master.dofs, dofs).all()
        if as_slave == as_master:  # of other bodies, or of the body with itself
            continue
        t = facets[name].tractions
        normal = facets[name].normal
        tangent = np.column_stack((normal[:, 1], -normal[:, 0]))
        traction = t.shear[:, None] * tangent - t.pressure[:, None] * normal
        force = t.weight[:, None] * traction
        force = _turned(force, stage.contact(name).force)
        points.append(np.column_stack((t.x, t.y)))
        vectors.append(force if as_slave else -force)
        strengths.append(_strength(pair, facets[name]))
    if not points:
        raise ValueError("no contact pair holds the body: give it one along its base")
    at = np.concatenate(points)
    force = np.concatenate(vectors)
    strength = np.concatenate(strengths, axis=1)

    # Separate the points of the base.
    span = heel - toe
    length = float(np.linalg.norm(span))
    across = np.array([-span[1], span[0]]) / length
    position = (at - toe) @ span / length**2
    on_base = np.abs((at - toe) @ across) <= _ON_BASE * length
    on_base &= (position >= -_ON_BASE) & (position <= 1.0 + _ON_BASE)
    if not on_base.any():
        raise ValueError(
            f"no contact point of the body lies on the base from {toe.tolist()} to {heel.tolist()}"
        )
    coordinates = np.asarray(basis_of(stage).doflocs)
    return _Forces(
        at[on_base],
        force[on_base],
        strength[:, on_base],
        at[~on_base],
        force[~on_base],
        nodes=coordinates[:, dofs[:, 0]].T,
        loads=stage.load[dofs],
        weight=_own_weight(stage, dofs, elements),
    )


def _own_weight(stage: StageResult, dofs: ndarray, elements: Mapping[str, ndarray]) -> ndarray:
    """Return the part of the loads that is the weight of the body, (k, 2)."""
    weight = np.zeros(dofs.shape)
    for name in elements:
        own = stage.forms[name].own_weight(np.array([0.0, -1.0]))  # type: ignore[attr-defined]
        if own is not None:
            weight += own[dofs]
    return weight


def _turned(forces: ndarray, resultant: ndarray) -> ndarray:
    r"""Return forces at points, (n, 2), with the resultant of the nodal forces.

    Tractions belong to the undeformed surface; the forces follow its rotation :math:`\theta`, by
    which they differ first: :math:`f' = f + \theta\, e_z \times f`. The rest is shared.
    """
    total = forces.sum(axis=0)
    size = row_norms(forces)
    if not size.any():
        return forces
    missing = resultant - total
    across = np.array([-total[1], total[0]])
    turn = float(missing @ across) / max(float(total @ total), np.finfo(float).tiny)
    turned = forces + turn * left_of(forces)
    rest = missing - turn * across
    return turned + rest * (size / size.sum())[:, None]


def _strength(pair: Any, facets: Any) -> ndarray:
    """Return friction and adhesion times length at the points of a pair, (2, n)."""
    found = []
    known = parameters_of(pair.law)
    for name in ("mu", "adhesion"):
        value = np.asarray(known.get(name, 0.0), float)
        if value.ndim:  # one value for each node of the slave
            node = pair.slave.dofs[:, 0] // pair.slave.dim
            by_node = np.zeros(int(facets.nodes.max()) + 1)
            by_node[node] = value
            value = (facets.shares * by_node[facets.nodes]).sum(axis=1)
        found.append(np.broadcast_to(value, len(facets.tractions.x)))
    return np.array([found[0], found[1] * facets.tractions.weight])


def _check_balance(forces: _Forces, body: str) -> None:
    """Warn of forces that are neither contact nor load."""
    parts = (forces.base, forces.thrust, forces.loads)
    total = sum(part.sum(axis=0) for part in parts)
    size = sum(float(row_norms(part).sum()) for part in parts)
    missing = float(np.linalg.norm(total))
    if missing > _UNBALANCED * size:
        warn(
            f"contact and loads leave {missing:.4g} on '{body}', {missing / size:.1%} of all "
            "forces on it: other forms or supports hold it as well, and their moments are left out"
        )


def _moment(points: ndarray, forces: ndarray, toe: ndarray) -> float:
    """Return the moment about the toe, anticlockwise positive."""
    arm = points - toe
    moments = cross_in_plane(arm, forces)
    return float(moments.sum())


def _moments(forces: _Forces, toe: ndarray) -> tuple[float, float]:
    """Return stabilising and overturning moments of thrust and loads about the toe."""
    # Loads besides the weight, such as water, push upwards on nodes that have weight, too.
    points = np.concatenate((forces.other_points, forces.nodes, forces.nodes))
    vectors = np.concatenate((forces.thrust, forces.loads - forces.weight, forces.weight))
    arm = points - toe
    # The base pushes upwards on the body: with the sense of its moment others overturn.
    sense = np.sign(_moment(forces.points, forces.base, toe))
    upright = sense * arm[:, 0] * vectors[:, 1]
    level = -sense * arm[:, 1] * vectors[:, 0]

    # Weights and friction on the back by their sum, horizontal forces likewise.
    downwards = upright[vectors[:, 1] < 0.0].sum()
    upwards = upright[vectors[:, 1] > 0.0].sum()
    parts = np.array([downwards, upwards])
    parts = np.append(parts, level.sum())
    stabilising = -float(parts[parts < 0.0].sum())
    return stabilising, float(parts[parts > 0.0].sum())


def _row(name: str, effect: float, resistance: float) -> tuple[str, float, float, float]:
    ratio = np.inf
    if effect > 0.0:
        ratio = resistance / effect
    return name, float(effect), float(resistance), float(ratio)


def _sliding(
    forces: _Forces,
    across: ndarray,
    horizontal: float,
    factors: PartialFactors,
    friction: float | None,
) -> tuple[str, float, float, float]:
    """Return the check of sliding along the base."""
    pressure = forces.base @ across
    closed = pressure > 0.0
    mu, adhesion = forces.strength
    resistance = float((mu * pressure + adhesion)[closed].sum())
    if friction is not None:
        resistance = friction / factors.phi * float(pressure.sum())
    return _row("sliding", factors.effect(abs(horizontal)), resistance / factors.sliding)


def _bearing(
    ground: Any,
    factors: PartialFactors,
    vertical: float,
    horizontal: float,
    width: float,
    eccentricity: float,
    unit_weight: float,
    surcharge: float,
) -> BearingResistance:
    """Return the bearing resistance with the design strength of the ground."""
    # Divide the strength by its factors.
    design = divided(ground, factors)
    known = parameters_of(design)
    if "soil" in known:
        known = parameters_of(known["soil"])
    c = known.get("c")
    if c is None or np.ndim(c) or callable(c):
        raise ValueError(f"bearing needs ground with one c and phi, not {ground!r}")
    # Multiply the effects by theirs.
    return bearing_resistance(
        width - 2.0 * abs(eccentricity),
        vertical=factors.effect(vertical),
        horizontal=factors.effect(horizontal),
        c=float(c),
        phi=float(known.get("phi", 0.0)),
        unit_weight=unit_weight,
        surcharge=surcharge,
    )


def _uplift(forces: _Forces, factors: PartialFactors) -> list[tuple[str, float, float, float]]:
    """Return the check of uplift where loads other than the weight push upwards, or nothing."""
    weight = -float(forces.weight[:, 1].sum())
    others = float(forces.loads[:, 1].sum()) + weight
    if others <= 1e-9 * max(weight, abs(others)):
        return []
    return [_row("uplift", factors.permanent * others, factors.favourable * weight)]
