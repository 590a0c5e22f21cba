"""Loads, contacts and strength of a limit analysis on triangles, and the program of a bound."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import CellBasis, Mesh

from ..arrays import max_abs
from ..checks import facets_of, format_point, is_number
from ..errors import AnalysisWarning
from ..layout import facet_corners, facet_counts, linear_element
from ..loads import Pressure, by_element, traction, water_load, weight
from .elements import Block, Elements, Joint, Program, Reduction
from .strength import Profile, Strength
from .triangles import (
    SURFACE,
    Contact,
    Tag,
    Triangles,
    facet_lengths,
    gradients,
    outward_normals,
    pairs,
)

#: A traction: a function of coordinates (2, n).
Field = Callable[[ndarray], ndarray]
#: A pressure: a function of coordinates (2, n) and of their elements of the first mesh, (n,).
PressureField = Callable[[ndarray, ndarray], ndarray]
#: A traction: (t_x, t_y), or a function of coordinates (2, n) with values (2, n).
TractionLike = ArrayLike | Callable[[ndarray], ndarray]
#: Pressure of water at rest in all pores and on all boundaries, and its load vector; None without
#: water.
AtRest = Callable[[], tuple[Pressure, ndarray] | None]
#: Largest rest of a vector after its decomposition, as a share of it: other rules of integration
#: leave some.
_LEFT = 1e-8
#: Share of a load's part in the vector below which it is none.
_NONE = 1e-10


class Site(NamedTuple):
    """Bodies that loads act on."""

    basis: CellBasis
    elements: ndarray  # of the solids
    porous: ndarray  # elements with pores
    fixed: ndarray  # dofs that are held


class Traction(NamedTuple):
    """Traction on named facets, (2, n) at coordinates (2, n)."""

    tag: Tag
    value: Field
    live: bool  # multiplied


class Water(NamedTuple):
    """Pressure in some elements of the first mesh, (n_elements,); None for all of them."""

    pressure: PressureField
    elements: ndarray | None


class Loads(NamedTuple):
    """Distributed loads, by elements and coordinates of the mesh."""

    dead: ndarray  # fixed body forces, (n_elements, 2)
    live: ndarray  # multiplied body forces, (n_elements, 2)
    tractions: tuple[Traction, ...] = ()
    water: tuple[Water, ...] = ()  # pressures in the pores, positive
    submerged: tuple[Tag, ...] = ()  # boundaries with water outside
    remarks: tuple[str, ...] = ()

    def largest_stress(self, triangles: Triangles, centre: ndarray, size: float) -> float:
        """Return the stress of the weights over the whole height, plus the largest tractions."""
        mesh = triangles.mesh
        heaviest = max_abs(self.dead + self.live)
        stress = float(heaviest * size * np.ptp(mesh.p[1]))
        for tag, value, _ in self.tractions:
            ends = mesh.facets[:, triangles.tags[tag]]
            x = centre[:, None] + size * mesh.p[:, ends].reshape(2, -1)
            traction = np.abs(value(x))
            stress += float(traction.max(initial=0.0))
        return stress

    def scaled(self, centre: ndarray, size: float, stress: float) -> Loads:
        """Return the loads at coordinates from a centre, in units of a size and of a stress."""

        def field(value: Field) -> Field:
            return lambda x: np.asarray(value(centre[:, None] + size * x)) / stress

        unit = size / stress
        return self._replace(
            dead=self.dead * unit,
            live=self.live * unit,
            tractions=tuple(each._replace(value=field(each.value)) for each in self.tractions),
            water=tuple(
                each._replace(pressure=_in_units(each.pressure, centre, size, stress))
                for each in self.water
            ),
        )


def _in_units(water: PressureField, centre: ndarray, size: float, stress: float) -> PressureField:
    """Return a pressure at coordinates from a centre, in units of a size and of a stress."""
    return lambda x, elements: water(centre[:, None] + size * x, elements) / stress


def named_loads(
    site: Site,
    weight: float | Mapping[str, float],
    tractions: Mapping[str, TractionLike],
    water: Pressure | None,
    submerged: Collection[str],
    seismic: float,
    live: Collection[str],
) -> Loads:
    """Check loads that are given by name, see :func:`~skfem_contact.bounds`."""
    # check the names
    mesh = site.basis.mesh
    _check_live(live, {"weight", *tractions})
    for name in (*tractions, *submerged):
        facets_of(mesh, name)
    if not is_number(seismic, -np.inf, np.inf):
        raise ValueError(f"seismic must be a finite number, not {seismic!r}")
    if submerged and water is None:
        raise ValueError("submerged boundaries need the pressure of water: give `water`")

    # make fields of the values
    body = by_element(mesh, weight)[:, None] * np.array([seismic, -1.0])
    fields = tuple(
        Traction(name, _traction(name, value), name in live) for name, value in tractions.items()
    )
    if not body.any() and not fields and water is None:
        raise ValueError("there is no load: give `weight`, `tractions` or `water`")
    remarks: tuple[str, ...] = ()
    if any(map(callable, tractions.values())):
        remarks = ("tractions are linear along every facet",)
    forces = np.zeros((2, *body.shape))  # fixed and multiplied ones, (2, n_elements, 2)
    forces[int("weight" in live)] = body
    dead, multiplied = forces
    return Loads(
        dead,
        multiplied,
        tractions=fields,
        water=_waters(water, mesh),
        submerged=tuple(submerged),
        remarks=remarks,
    )


def _check_live(live: Collection[str], known: set[str]) -> None:
    """Refuse unknown names of multiplied loads."""
    for name in live:
        if name not in known:
            raise ValueError(
                f"there is no load '{name}' to multiply; existing: {', '.join(sorted(known))}"
            )


def _traction(name: str, value: TractionLike) -> Field:
    """Return a traction as a function of coordinates, checked."""
    # Check a function at every call.
    if callable(value):

        def field(x: ndarray) -> ndarray:
            result = np.asarray(value(x), dtype=float)
            if result.shape != x.shape or not np.isfinite(result).all():
                raise ValueError(
                    f"the traction on '{name}' must have shape {x.shape} and finite values"
                )
            return result

        return field
    # A constant is checked once.
    constant = np.asarray(value, dtype=float)
    if constant.shape != (2,) or not np.isfinite(constant).all():
        raise ValueError(
            f"the traction on '{name}' must be (t_x, t_y) or a function of coordinates, not "
            f"{value!r}"
        )
    return lambda x: np.broadcast_to(constant[:, None], x.shape)


def _waters(water: Pressure | Mapping[str, Pressure] | None, mesh: Mesh) -> tuple[Water, ...]:
    """Return the pressures of water and the elements in which they act."""
    if water is None:
        return ()
    if not isinstance(water, Mapping):
        return (Water(_pressure(water, mesh), None),)
    found = []
    for name, part in water.items():
        elements = np.zeros(mesh.nelements, bool)
        elements[mesh.subdomains[name]] = True
        found.append(Water(_pressure(part, mesh), elements))
    return tuple(found)


def _pressure(water: Pressure, mesh: Mesh) -> PressureField:
    """Return the pressure of water as a function of coordinates and elements."""
    # Check the shape of values at nodes.
    if not callable(water) and np.shape(water) != (mesh.nvertices,):
        raise ValueError(
            f"water is a pressure, hydrostatic(level) or values at {mesh.nvertices} nodes, not "
            f"{water!r}"
        )

    def field(x: ndarray, elements: ndarray) -> ndarray:
        if callable(water):
            values = water(x)
        else:
            values = _interpolated(water, mesh, x, elements)
        pressure = np.asarray(values, dtype=float)
        if not np.isfinite(pressure).all():
            raise ValueError("the pressure of water must be finite everywhere in the bodies")
        return pressure

    return field


def _interpolated(values: ArrayLike, mesh: Mesh, x: ndarray, elements: ndarray) -> ndarray:
    """Return values at the nodes of a mesh, interpolated at coordinates (2, n) in elements, (n,).

    Points at a boundary need not lie inside: round-off moves them.
    """
    at_nodes = np.asarray(values, dtype=float)[mesh.t[:, elements]]
    X = mesh.mapping().invF(x[:, :, None], tind=elements)
    element = linear_element(mesh)
    shares = [element.lbasis(X, corner)[0][:, 0] for corner in range(len(mesh.t))]
    return np.einsum("ci,ci->i", at_nodes, np.stack(shares))


def vector_loads(
    site: Site,
    dead: ndarray,
    live: ndarray | None,
    water: Pressure | None = None,
    submerged: Collection[str] = (),
    at_rest: AtRest | None = None,
) -> Loads:
    """Decompose load vectors into weights, tractions on boundaries, and forces of water."""
    # take off the load of water
    basis = site.basis
    dead = dead[: basis.N]
    rest = None if at_rest is None else at_rest()
    if rest is not None:
        if water is not None or submerged:
            raise ValueError(
                "the search has its own water: leave `water` and `submerged` out of `certify`"
            )
        water = rest[0]
        dead = dead - rest[1][: basis.N]
    elif water is not None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", AnalysisWarning)  # it was given with the load
            dead = dead - water_load(basis.with_elements(site.porous), water, tuple(submerged))

    # decompose the remaining load, and the multiplied one
    decomposition = _Decomposition(site)
    body, tractions = decomposition.of(dead, False)
    multiplied = np.zeros_like(body)
    if live is not None:
        multiplied, more = decomposition.of(live[: basis.N], True)
        tractions += more
    return Loads(
        body,
        multiplied,
        tractions=tractions,
        water=_waters(water, basis.mesh),
        submerged=(SURFACE,) if rest is not None else tuple(submerged),
    )


class _Decomposition:
    """Decomposition of load vectors into weights of subdomains and tractions on boundaries."""

    def __init__(self, site: Site) -> None:
        self._basis = site.basis
        self._free = np.setdiff1d(np.arange(site.basis.N), site.fixed)
        self._kinds = _kinds(site)
        self._sides = _unit_tractions(site)
        weights = []
        for kind in range(self._kinds.max() + 1):
            part = site.basis.with_elements(np.flatnonzero(self._kinds == kind))
            weights += [weight(part, 1.0, axis) for axis in ((1.0, 0.0), (0.0, 1.0))]
        self._weights = np.column_stack(weights)[self._free]

    def of(self, load: ndarray, live: bool) -> tuple[ndarray, tuple[Traction, ...]]:
        """Return body forces (n_elements, 2) and tractions of a load vector.

        Boundaries are added one by one: each time the one that leaves least.
        """
        # add boundaries until nothing but round-off remains
        target = load[self._free]
        size = float(np.linalg.norm(target))
        names: list[str] = []
        remaining, share = self._fitted(names, target)
        while np.linalg.norm(remaining) > _LEFT * size and len(names) < len(self._sides):
            candidates = [name for name in self._sides if name not in names]
            fits = {name: self._fitted([*names, name], target) for name in candidates}
            best = min(candidates, key=lambda name: float(np.linalg.norm(fits[name][0])))
            names.append(best)
            remaining, share = fits[best]
        if np.linalg.norm(remaining) > _LEFT * size:
            worst = self._basis.doflocs[:, self._free[np.abs(remaining).argmax()]]
            raise ValueError(
                "bounds need distributed loads, but the load vector is no sum of weights of "
                "subdomains and tractions that are linear along named boundaries: "
                f"{np.linalg.norm(remaining) / size:.2g} of it are left, most at "
                f"{format_point(worst)}; name the boundary that is loaded, give water by "
                "certify={'water': ...}, or call `bounds`"
            )

        # read the weights by subdomain, and the coefficients of the tractions
        n = self._weights.shape[1]
        solid = self._kinds >= 0
        body = np.zeros((len(self._kinds), 2))
        body[solid] = share[:n].reshape(-1, 2)[self._kinds[solid]]
        coefficients = share[n:].reshape(-1, 2, 3)  # of a traction that is linear in x and y
        mesh = self._basis.mesh
        return body, tuple(
            Traction(name, _linear(mesh, each), live) for name, each in zip(names, coefficients)
        )

    def _fitted(self, names: list[str], target: ndarray) -> tuple[ndarray, ndarray]:
        """Return the rest of a vector after weights and some tractions, and their shares."""
        columns = np.column_stack(
            [self._weights, *(self._sides[name][self._free] for name in names)]
        )
        scale = np.linalg.norm(columns, axis=0)
        scale[scale == 0] = 1.0
        share = np.linalg.lstsq(columns / scale, target, rcond=1e-10)[0]
        share[np.abs(share) < _NONE * np.linalg.norm(target)] = 0.0
        return target - (columns / scale) @ share, share / scale


def _kinds(site: Site) -> ndarray:
    """Return a number for elements of the same subdomains, (n_elements,); -1 without a solid."""
    mesh = site.basis.mesh
    parts = (mesh.subdomains or {}).values()
    member = np.zeros((len(parts) + 1, mesh.nelements), bool)
    for row, part in zip(member, parts):
        row[part] = True
    _, number = np.unique(member[:, site.elements], axis=1, return_inverse=True)
    kinds = np.full(mesh.nelements, -1)
    kinds[site.elements] = number.ravel()
    return kinds


def _unit_tractions(site: Site) -> dict[str, ndarray]:
    """Return loads of unit tractions, constant and linear in x and y, on boundaries, (N, 6)."""
    mesh = site.basis.mesh
    units = np.eye(6).reshape(6, 2, 3)
    count = facet_counts(mesh, site.elements)
    columns = {}
    for name, facets in (mesh.boundaries or {}).items():
        if len(facets) and (count[facets] == 1).all():
            loads = [traction(site.basis, name, _linear(mesh, unit)) for unit in units]
            columns[name] = np.column_stack(loads)
    return columns


def _linear(mesh: Mesh, coefficients: ndarray) -> Field:
    """Return a traction as a function of coordinates, from its six coefficients (2, 3)."""
    low = mesh.p.min(axis=1)
    high = mesh.p.max(axis=1)
    centre = 0.5 * (low + high)
    size = float((high - low).max())

    def field(x: ndarray) -> ndarray:
        origin = centre.reshape(2, *(1,) * (x.ndim - 1))
        away = (x - origin) / size
        terms = np.stack([np.ones_like(away[0]), *away])  # 1, x, y
        return np.einsum("cs,s...->c...", coefficients, terms)

    return field


@dataclass(frozen=True)
class LimitModel:
    """Strength and loads; lengths and stresses are of order one.

    All arrays have one value for each element of the first mesh, (n_first,): triangles know their
    `origin`.
    """

    triangles: Triangles  # the first mesh; facets that are held are tagged ("held", component)
    soil: Strength
    rigid: ndarray  # number of the rigid body of an element, -1 for none: these have pores
    loads: Loads
    contacts: tuple[Contact, ...] = ()
    profiles: tuple[Profile, ...] = ()
    outer: Strength | None = None  # of the upper bound, where the strength is curved

    def strength(self, triangles: Triangles, soft: ndarray, elements: Elements) -> Strength:
        r"""Return the strength at the corners of triangles that can yield, for one of the bounds.

        Linear stresses are admissible in a triangle if they are at its corners. The dissipation of
        linear strains is convex, so that it is at most the sum over the corners, each with the mean
        of the strength by its shape function:
        :math:`\int c\, D(\sum_i \lambda_i \varepsilon_i) \le
        \sum_i D(\varepsilon_i) \int \lambda_i c`.
        """
        soil = self.soil
        if self.outer is not None and not elements.statical:
            soil = self.outer
        strength = soil.at(np.repeat(triangles.origin[soft], 3))
        for profile in self.profiles:
            varies, cohesion = profile.at(triangles, soft)
            strength.c.reshape(-1, 3)[varies] = cohesion @ elements.strength
        return strength

    def power(self, triangles: Triangles, elements: Elements) -> tuple[ndarray, ndarray]:
        """Return the power of the fixed and of the multiplied loads, (n,) each."""
        mesh = triangles.mesh
        origin = triangles.origin
        total = [elements.of_body(f[origin]) for f in (self.loads.dead, self.loads.live)]
        for tag, value, live in self.loads.tractions:
            facets = triangles.tags[tag]
            x = facet_corners(mesh, facets)  # (2, 2 ends, n)
            values = np.asarray(value(x.reshape(2, -1)))
            total[live] += elements.of_tractions(facets, values.reshape(x.shape).T)
        for water in self.loads.water:
            # Nodes of a region take their pressure in one of its elements.
            if water.elements is None:
                here = slice(None)
            else:
                here = water.elements[origin]
            elements_at = np.zeros(mesh.nvertices, int)
            elements_at[mesh.t] = origin
            elements_at[mesh.t[:, here]] = origin[here]
            pressure = water.pressure(mesh.p, elements_at)
            total[0] += self._power_of_water(pressure, water.elements, triangles, elements)
        return total[0], total[1]

    def _power_of_water(
        self,
        u: ndarray,
        region: ndarray | None,
        triangles: Triangles,
        elements: Elements,
    ) -> ndarray:
        r"""Return the power of a pressure u, :math:`\int u\, {\rm div}\, v - \int u\, n v`.

        The first integral is over the pores of a region, the second over its submerged boundaries.
        By parts, a pressure linear in every triangle is a body force -grad u and a traction u n on
        all facets that bound the pores.
        """
        # body force
        mesh = triangles.mesh
        porous = self.rigid[triangles.origin] < 0
        if region is not None:
            porous = porous & region[triangles.origin]
        gradient = gradients(mesh)[0]
        body = -np.einsum("ie,eic->ec", u[mesh.t], gradient) * porous[:, None]
        power = elements.of_body(body)

        # facets that bound the pores, with the pressure, and submerged ones with water, not suction
        inside = np.where(mesh.f2t >= 0, porous[mesh.f2t], False)
        edge = np.flatnonzero(inside[0] != inside[1])
        outside = [triangles.tags[tag] for tag in self.loads.submerged]
        if region is not None:
            outside = [facets[inside[0, facets]] for facets in outside]
        facets = np.concatenate([edge, *outside])
        inner = np.arange(len(facets)) < len(edge)
        side = np.zeros(len(facets), int)
        side[inner] = inside[1, edge]
        normal = outward_normals(mesh, facets, mesh.f2t[side, facets])
        at = u[mesh.facets[:, facets]]  # (2 ends, n)
        pressure = np.where(inner, at, -np.maximum(at, 0.0))
        pressed = pressure.T[:, :, None] * normal.T[:, None]  # (n, 2 ends, 2)
        return power + elements.of_tractions(facets, pressed)


def discretise(model: LimitModel, triangles: Triangles, elements: Elements) -> Program:
    """Return the program of a bound on a refinement of the first mesh whose contacts match."""
    # collect the points of soil and joints
    rigid = model.rigid[triangles.origin]
    soft = np.flatnonzero(rigid < 0)
    joints, tied = joined(model.contacts, triangles, elements)
    strengths = [model.strength(triangles, soft, elements)]
    parts = [(elements.B[soft], elements.dofs[soft])]
    for joint in joints:
        strengths.append(joint.strength)
        parts.append((joint.B, joint.dofs))

    # reduce velocities to the motions of rigid bodies and free nodes
    held = []
    for k in (0, 1):
        facets = triangles.tags["held", k]
        held.append(elements.facets[facets, :, k].ravel())
    used = np.concatenate([dofs.ravel() for _, dofs in parts])
    reduction = Reduction.of(elements, used, np.concatenate(held), tied, rigid)
    blocks: list[Block] = []
    first = 0
    for B, dofs in parts:
        n, at_each = B.shape[:2]
        points = first + np.arange(n * at_each).reshape(n, at_each)
        blocks += reduction.reduced(B, points, dofs)
        first += n * at_each

    # refuse what cannot yield and what can move without resistance
    if not blocks:
        raise ValueError(
            "nothing can yield: all bodies are elastic, which bounds take for rigid, and joints "
            "are tied"
        )
    moved = np.unique(np.concatenate([block.dofs.ravel() for block in blocks]))
    if len(np.setdiff1d(np.arange(reduction.size), moved)) and not len(joints):
        raise ValueError(
            "a rigid (elastic) body can move freely: hold it, or connect it to the ground by a "
            "contact"
        )
    dead, live = (reduction.matrix.T @ f for f in model.power(triangles, elements))
    return Program(
        blocks,
        strengths,
        reduction=reduction,
        dead=dead,
        live=live,
        soft=soft,
        joints=joints,
    )


def joined(
    contacts: tuple[Contact, ...], triangles: Triangles, elements: Elements
) -> tuple[list[Joint], ndarray]:
    """Return joints that can part or slip, and pairs of velocities that are tied, (2, n)."""
    joints = []
    tied = [np.zeros((2, 0), int)]
    for contact in contacts:
        slave, master, turned = pairs(contact, triangles)
        sides = elements.facets[slave], elements.on_facets(master, turned)
        if contact.tied:
            tied.append(np.stack([dofs.ravel() for dofs in sides]))
        elif len(slave):
            jump = _jumps(contact, triangles, elements, slave)
            B = np.concatenate([-jump, jump], axis=3)
            dofs = np.hstack([dofs.reshape(len(slave), -1) for dofs in sides])
            joints.append(Joint(slave, master, B, dofs, _strength_of(contact, B)))
    return joints, np.hstack(tied)


def _strength_of(contact: Contact, B: ndarray) -> Strength:
    """Return the strength of a contact at the points of an operator, (n_facets, n_points, ...)."""
    n = B.shape[0] * B.shape[1]
    return Strength(
        c=np.full(n, contact.a),
        t=np.full(n, contact.mu),
        tension=np.full(n, contact.tension),
        reduced=np.full(n, contact.reduced),
        joint=True,
    )


def _jumps(contact: Contact, triangles: Triangles, elements: Elements, slave: ndarray) -> ndarray:
    """Return opening, slip and an idle row times weight, of the master's velocities.

    The shape is (n, n_points, 3, n_local).
    """
    mesh = triangles.mesh
    normal = outward_normals(mesh, slave, mesh.f2t[0, slave])
    tangent = np.stack([-normal[1], normal[0]])
    if contact.a == 0 and contact.mu == 0:
        tangent = 0.0 * tangent
    axes = np.stack([normal, tangent, 0 * normal])  # (3, 2, n)
    axes = axes.transpose(2, 0, 1)
    weight = facet_lengths(mesh)[slave] / len(elements.jump)
    jump = np.einsum("pl,fic,f->fpilc", elements.jump, axes, weight)
    return jump.reshape(*jump.shape[:3], -1)
