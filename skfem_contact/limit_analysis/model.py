"""Loads, contacts and strength of a limit analysis on straight triangles, and the program of either
bound.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import Basis, CellBasis, Mesh

from ..checks import format_point, is_number, look_up
from ..errors import AnalysisWarning
from ..layout import linear_element
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

#: A traction or a pressure: a function of coordinates (2, n).
Field = Callable[[ndarray], ndarray]
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


class Loads(NamedTuple):
    """Distributed loads, by elements and coordinates of the mesh."""

    dead: ndarray  # fixed body forces, (n_elements, 2)
    live: ndarray  # multiplied body forces, (n_elements, 2)
    tractions: tuple[Traction, ...] = ()
    water: Field | None = None  # pressure in the pores, positive
    submerged: tuple[Tag, ...] = ()  # boundaries with water outside
    remarks: tuple[str, ...] = ()

    def largest_stress(self, triangles: Triangles, centre: ndarray, size: float) -> float:
        """Return the stress of the weights over the height of the triangles, plus the largest
        tractions.
        """
        stress = float(
            np.abs(self.dead + self.live).max(initial=0.0) * size * np.ptp(triangles.mesh.p[1])
        )
        for tag, value, _ in self.tractions:
            x = triangles.mesh.p[:, triangles.mesh.facets[:, triangles.tags[tag]]].reshape(2, -1)
            stress += float(np.abs(value(centre[:, None] + size * x)).max(initial=0.0))
        return stress

    def scaled(self, centre: ndarray, size: float, stress: float) -> Loads:
        """Return the loads at coordinates from a centre, in units of a size and of a stress."""

        def field(value: Field) -> Field:
            return lambda x: np.asarray(value(centre[:, None] + size * x)) / stress

        tractions = tuple(one._replace(value=field(one.value)) for one in self.tractions)
        water = None if self.water is None else field(self.water)
        unit = size / stress
        return self._replace(
            dead=self.dead * unit, live=self.live * unit, tractions=tractions, water=water
        )


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
    mesh, known = site.basis.mesh, {"weight", *tractions}
    for name in live:
        if name not in known:
            raise ValueError(
                f"there is no load '{name}' to multiply; existing: {', '.join(sorted(known))}"
            )
    for name in (*tractions, *submerged):
        look_up(name, mesh.boundaries or {}, "boundary")
    if not is_number(seismic, -np.inf, np.inf):
        raise ValueError(f"seismic must be a finite number, not {seismic!r}")
    if submerged and water is None:
        raise ValueError("submerged boundaries need the pressure of water: give `water`")
    body = by_element(mesh, weight)[:, None] * np.array([seismic, -1.0])
    fields = tuple(
        Traction(name, _traction(name, value), name in live) for name, value in tractions.items()
    )
    if not body.any() and not fields and water is None:
        raise ValueError("there is no load: give `weight`, `tractions` or `water`")
    dead, multiplied = (0 * body, body) if "weight" in live else (body, 0 * body)
    linear = any(callable(value) for value in tractions.values())
    return Loads(
        dead,
        multiplied,
        fields,
        _pressure(water, site.basis),
        tuple(submerged),
        ("tractions are linear along every facet",) * linear,
    )


def _traction(name: str, value: TractionLike) -> Field:
    """Return a traction as a function of coordinates, checked."""
    if callable(value):

        def field(x: ndarray) -> ndarray:
            result = np.asarray(value(x), dtype=float)
            if result.shape != x.shape or not np.isfinite(result).all():
                raise ValueError(
                    f"the traction on '{name}' must have shape {x.shape} and finite values"
                )
            return result

        return field
    constant = np.asarray(value, dtype=float)
    if constant.shape != (2,) or not np.isfinite(constant).all():
        raise ValueError(
            f"the traction on '{name}' must be (t_x, t_y) or a function of coordinates, not "
            f"{value!r}"
        )
    return lambda x: np.broadcast_to(constant[:, None], x.shape)


def _pressure(water: Pressure | None, basis: CellBasis) -> Field | None:
    """Return the pressure of water as a function of coordinates."""
    if water is None:
        return None
    mesh = basis.mesh
    if not callable(water) and np.shape(water) != (mesh.nvertices,):
        raise ValueError(
            f"water is a pressure, hydrostatic(level) or values at {mesh.nvertices} nodes, not "
            f"{water!r}"
        )
    inside = (
        water
        if callable(water)
        else Basis(mesh, linear_element(mesh)).interpolator(np.asarray(water, float))
    )

    def field(x: ndarray) -> ndarray:
        pressure = np.asarray(inside(x), dtype=float)
        if not np.isfinite(pressure).all():
            raise ValueError("the pressure of water must be finite everywhere in the bodies")
        return pressure

    return field


def vector_loads(
    site: Site,
    dead: ndarray,
    live: ndarray | None,
    water: Pressure | None = None,
    submerged: Collection[str] = (),
    at_rest: AtRest | None = None,
) -> Loads:
    """Decompose load vectors into weights of subdomains, tractions on boundaries, and forces of
    water.
    """
    basis, dead, rest = site.basis, dead[: site.basis.N], at_rest and at_rest()
    if rest:
        if water is not None or submerged:
            raise ValueError(
                "the search has its own water: leave `water` and `submerged` out of `certify`"
            )
        water, dead = rest[0], dead - rest[1][: basis.N]
    elif water is not None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", AnalysisWarning)  # it was given with the load
            dead = dead - water_load(basis.with_elements(site.porous), water, tuple(submerged))
    decomposed = _decomposition(site)
    body, tractions = decomposed(dead, False)
    multiplied, more = (0 * body, ()) if live is None else decomposed(live[: basis.N], True)
    return Loads(
        body,
        multiplied,
        tractions + more,
        _pressure(water, basis),
        (SURFACE,) if rest else tuple(submerged),
    )


def _decomposition(site: Site) -> Callable[[ndarray, bool], tuple[ndarray, tuple[Traction, ...]]]:
    """Return the function that decomposes a load vector into body forces (n_elements, 2) and
    tractions.
    """
    free = np.setdiff1d(np.arange(site.basis.N), site.fixed)
    kinds = _kinds(site)
    parts = [
        site.basis.with_elements(np.flatnonzero(kinds == kind)) for kind in range(kinds.max() + 1)
    ]
    weights = np.column_stack(
        [weight(part, 1.0, axis) for part in parts for axis in ((1.0, 0.0), (0.0, 1.0))]
    )[free]
    sides = _unit_tractions(site)

    def fitted(names: list[str], target: ndarray) -> tuple[ndarray, ndarray]:
        """Return the rest of a vector after the weights and the tractions on some boundaries, and
        their shares.
        """
        columns = np.column_stack([weights, *(sides[name][free] for name in names)])
        scale = np.linalg.norm(columns, axis=0)
        scale[scale == 0] = 1.0
        share = np.linalg.lstsq(columns / scale, target, rcond=1e-10)[0]
        share[np.abs(share) < _NONE * np.linalg.norm(target)] = 0.0
        return target - (columns / scale) @ share, share / scale

    def decomposed(load: ndarray, live: bool) -> tuple[ndarray, tuple[Traction, ...]]:
        """Select weights, and boundaries one by one: the best of each time."""
        target = load[free]
        size, names = float(np.linalg.norm(target)), list[str]()
        left, share = fitted(names, target)
        while np.linalg.norm(left) > _LEFT * size and len(names) < len(sides):
            fits = {name: fitted([*names, name], target) for name in sides if name not in names}
            names.append(min(fits, key=lambda name: float(np.linalg.norm(fits[name][0]))))
            left, share = fits[names[-1]]
        if np.linalg.norm(left) > _LEFT * size:
            worst = site.basis.doflocs[:, free[np.abs(left).argmax()]]
            raise ValueError(
                "bounds need distributed loads, but the load vector is no sum of weights of "
                "subdomains and tractions "
                f"that are linear along named boundaries: {np.linalg.norm(left) / size:.2g} of it "
                f"are left, most at "
                f"{format_point(worst)}; name the boundary that is loaded, give water by "
                f"certify={{'water': ...}}, or "
                "call `bounds`"
            )
        body, n = np.zeros((len(kinds), 2)), weights.shape[1]
        body[kinds >= 0] = share[:n].reshape(-1, 2)[kinds[kinds >= 0]]
        return body, tuple(
            Traction(name, _linear(site.basis.mesh, coefficients), live)
            for name, coefficients in zip(names, share[n:].reshape(-1, 2, 3))
        )

    return decomposed


def _kinds(site: Site) -> ndarray:
    """Return one number for the elements of the same subdomains, (n_elements,); -1 without a
    solid.
    """
    mesh = site.basis.mesh
    parts = (mesh.subdomains or {}).values()
    member = np.zeros((len(parts) + 1, mesh.nelements), bool)
    for row, part in zip(member, parts):
        row[part] = True
    kinds = np.full(mesh.nelements, -1)
    kinds[site.elements] = np.unique(member[:, site.elements], axis=1, return_inverse=True)[
        1
    ].ravel()
    return kinds


def _unit_tractions(site: Site) -> dict[str, ndarray]:
    """Return vectors of unit tractions, constant and linear in x and y, on boundaries of the
    solids, (N, 6) each.
    """
    mesh, units = site.basis.mesh, np.eye(6).reshape(6, 2, 3)
    count = np.bincount(mesh.t2f[:, site.elements].ravel(), minlength=mesh.nfacets)
    return {
        name: np.column_stack([traction(site.basis, name, _linear(mesh, unit)) for unit in units])
        for name, facets in (mesh.boundaries or {}).items()
        if len(facets) and (count[facets] == 1).all()
    }


def _linear(mesh: Mesh, coefficients: ndarray) -> Field:
    """Return a traction as a function of coordinates, from its six coefficients (2, 3)."""
    low, high = mesh.p.min(axis=1), mesh.p.max(axis=1)
    centre, size = 0.5 * (low + high), float((high - low).max())

    def field(x: ndarray) -> ndarray:
        away = (x - centre.reshape(2, *(1,) * (x.ndim - 1))) / size
        return np.einsum("cs,s...->c...", coefficients, np.stack([np.ones_like(away[0]), *away]))

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
        r"""Return the strength at the corners of triangles that can yield, for the bound of some
        elements.

        Linear stresses are admissible in a triangle if they are at its corners. The dissipation of
        linear strains is convex, so that it is at most that of the corners, each with the mean of
        the strength by its shape function:
        :math:`\int c\, D(\sum_i \lambda_i \varepsilon_i) \le \sum_i D(\varepsilon_i) \int \lambda_i c`.
        """
        found = (self.soil if elements.statical else self.outer or self.soil).at(
            np.repeat(triangles.origin[soft], 3)
        )
        for profile in self.profiles:
            here, cohesion = profile.at(triangles, soft)
            found.c.reshape(-1, 3)[here] = cohesion @ elements.strength
        return found

    def power(self, triangles: Triangles, elements: Elements) -> tuple[ndarray, ndarray]:
        """Return the power of the fixed and of the multiplied loads, (n,) each."""
        total = [
            elements.of_body(forces[triangles.origin])
            for forces in (self.loads.dead, self.loads.live)
        ]
        for tag, value, live in self.loads.tractions:
            facets = triangles.tags[tag]
            x = triangles.mesh.p[:, triangles.mesh.facets[:, facets]]  # (2, 2 ends, n)
            values = np.asarray(value(x.reshape(2, -1))).reshape(x.shape).T
            total[live] += elements.of_tractions(facets, values)
        if (water := self.loads.water) is not None:
            total[0] += self._power_of_water(water(triangles.mesh.p), triangles, elements)
        return total[0], total[1]

    def _power_of_water(self, u: ndarray, triangles: Triangles, elements: Elements) -> ndarray:
        r"""Return :math:`\int u\, {\rm div}\, v` in the pores less :math:`\int u\, n v` on
        submerged boundaries.

        By parts, a pressure linear in every triangle is a body force -grad u and a traction u n on
        all facets that bound the pores.
        """
        mesh, porous = triangles.mesh, self.rigid[triangles.origin] < 0
        body = -np.einsum("ie,eic->ec", u[mesh.t], gradients(mesh)[0]) * porous[:, None]
        inside = np.where(mesh.f2t >= 0, porous[mesh.f2t], False)
        edge = np.flatnonzero(inside[0] != inside[1])
        outside = np.concatenate(
            [np.zeros(0, int), *(triangles.tags[tag] for tag in self.loads.submerged)]
        )
        facets = np.append(edge, outside)
        side = np.append(inside[1, edge], np.zeros(len(outside), bool)).astype(int)
        at, inner = u[mesh.facets[:, facets]], np.arange(len(facets)) < len(edge)
        normal = outward_normals(mesh, facets, mesh.f2t[side, facets])
        pressed = (
            np.where(inner, at, -np.maximum(at, 0.0)).T[:, :, None] * normal.T[:, None]
        )  # beside suction is air
        return elements.of_body(body) + elements.of_tractions(facets, pressed)


def discretise(model: LimitModel, triangles: Triangles, elements: Elements) -> Program:
    """Return the program of some elements' bound, on a refinement of the first mesh whose contacts
    match.
    """
    rigid = model.rigid[triangles.origin]
    soft = np.flatnonzero(rigid < 0)
    joints, tied = joined(model.contacts, triangles, elements)
    parts = [(elements.B[soft], elements.dofs[soft]), *((joint.B, joint.dofs) for joint in joints)]
    strengths: list[Strength] = [
        model.strength(triangles, soft, elements),
        *(j.strength for j in joints),
    ]
    held = [elements.facets[triangles.tags["held", k], :, k].ravel() for k in (0, 1)]
    used = np.concatenate([dofs.ravel() for _, dofs in parts])
    reduction = Reduction.of(elements, used, np.concatenate(held), tied, rigid)
    blocks: list[Block] = []
    first = 0
    for B, dofs in parts:
        n, at_each = B.shape[:2]
        blocks += reduction.reduced(B, first + np.arange(n * at_each).reshape(n, at_each), dofs)
        first += n * at_each
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
    return Program(blocks, strengths, reduction, dead, live, soft, joints)


def joined(
    contacts: tuple[Contact, ...], triangles: Triangles, elements: Elements
) -> tuple[list[Joint], ndarray]:
    """Return joints that can part or slip, and pairs of velocities that are tied, (2, n)."""
    joints, tied = [], [np.zeros((2, 0), int)]
    for contact in contacts:
        one, other, turned = pairs(contact, triangles)
        sides = elements.facets[one], elements.on_facets(other, turned)
        if contact.tied:
            tied.append(np.stack([dofs.ravel() for dofs in sides]))
        elif len(one):
            jump = _jumps(contact, triangles, elements, one)
            n = jump.shape[0] * jump.shape[1]
            strength = Strength(
                np.full(n, contact.a),
                np.full(n, contact.mu),
                np.full(n, contact.tension),
                np.full(n, contact.reduced),
                joint=True,
            )
            dofs = np.hstack([dofs.reshape(len(one), -1) for dofs in sides])
            joints.append(Joint(one, other, np.concatenate([-jump, jump], axis=3), dofs, strength))
    return joints, np.hstack(tied)


def _jumps(contact: Contact, triangles: Triangles, elements: Elements, slave: ndarray) -> ndarray:
    """Return opening, slip and an idle row times weight, of the master's velocities, (n, n_points,
    3, n_local).
    """
    normal = outward_normals(triangles.mesh, slave, triangles.mesh.f2t[0, slave])
    tangent = np.stack([-normal[1], normal[0]])
    smooth = contact.a == 0 and contact.mu == 0
    axes = np.stack([normal, 0.0 * tangent if smooth else tangent, 0 * normal]).transpose(2, 0, 1)
    weight = facet_lengths(triangles.mesh)[slave] / len(elements.jump)
    jump = np.einsum("pl,fic,f->fpilc", elements.jump, axes, weight)
    return jump.reshape(*jump.shape[:3], -1)
