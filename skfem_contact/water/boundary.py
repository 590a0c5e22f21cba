"""Boundary conditions of water: heads, seepage faces, fluxes, wells, drains, and connected
boundaries.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, eye, lil_matrix
from scipy.sparse.csgraph import connected_components
from skfem import Basis, CellBasis, FacetBasis, LinearForm, Mesh

from ..checks import finite, format_point, look_up, names_of, positive
from ..layout import elements_of
from .darcy import radius

#: Head or pressure on a boundary: a number, or a function of coordinates (dim, ...).
Given = float | Callable[[ndarray], ndarray]
#: Heads and heights that differ by less than this part of the model's size are the same.
_SAME = 1e-9
#: Nodes farther than this from the other side, in sizes of its facets, are not connected.
_BESIDE = 0.1
#: Pairs of nodes and facets that are compared at a time.
_PAIRS = 200_000


@dataclass(frozen=True)
class Conditions:
    """Conditions at the nodes: held heads, their values (NaN elsewhere), seepage faces and supply,
    (N,) each.

    The supply is the water that enters per time as given. Facets of the boundaries through which
    water passes are `passing`, by name. Drains take the conductance times the head above their
    level.
    """

    held: ndarray
    head: ndarray
    face: ndarray
    supply: ndarray
    passing: Mapping[str, ndarray]
    conductance: ndarray | float = 0.0
    level: ndarray | float = 0.0

    @property
    def known(self) -> ndarray:
        """Held heads and levels of drains, NaN elsewhere."""
        return np.where(np.asarray(self.conductance) > 0.0, self.level, self.head)

    def taken(self, head: ndarray) -> ndarray:
        """Return the water that drains take at heads, (N,)."""
        return np.asarray(self.conductance * np.maximum(head - self.level, 0.0))

    def taking(self, head: ndarray) -> ndarray:
        """Return its slope over the heads, (N,)."""
        return np.asarray(self.conductance * (head >= self.level))


def nodes_on(basis: CellBasis, boundary: str) -> ndarray:
    """Return the nodes of the porous ground of a basis of heads or pressures on a boundary."""
    facets = look_up(boundary, basis.mesh.boundaries or {}, "boundary")
    found = np.intersect1d(basis.mesh.facets[:, facets], basis.element_dofs)
    if len(found) == 0:
        raise ValueError(f"boundary '{boundary}' has no node of the porous ground")
    return found


def values_at(given: Given, x: ndarray, what: str) -> ndarray:
    """Return the values of a number or function at coordinates (dim, n)."""
    values = np.asarray(given(x) if callable(given) else given, dtype=float)
    if values.shape not in ((), x.shape[1:]) or not np.isfinite(values).all():
        raise ValueError(
            f"the {what} must be a finite number, or a function of coordinates that gives one for "
            f"each"
        )
    return np.broadcast_to(values, x.shape[1:])


def conditions(
    basis: CellBasis,
    head: Mapping[str, Given],
    seepage_face: str | Sequence[str],
    flux: Mapping[str, Given],
    sources: Mapping[str, Given],
    axisymmetric: bool,
) -> Conditions:
    """Return the conditions at the nodes from those on boundaries; a head holds at and below its
    own height.

    Boundaries with a flux into the ground are seepage faces as well: what the ground does not take
    runs off.
    """
    mesh, faces = basis.mesh, names_of(seepage_face)
    nodes = {name: nodes_on(basis, name) for name in (*head, *faces, *flux)}
    passing = {name: np.asarray(mesh.boundaries[name]) for name in nodes}
    values, by = np.full(basis.N, np.nan), np.zeros(basis.N, dtype=object)
    tolerance = _SAME * float(np.ptp(mesh.p, axis=1).max())
    on_axis = [
        name
        for name, at in nodes.items()
        if axisymmetric and np.abs(mesh.p[0, at]).max() <= tolerance
    ]
    if on_axis:
        raise ValueError(
            f"boundary '{on_axis[0]}' lies on the axis and has no area: no water passes through "
            f"it; a "
            "well has a radius"
        )
    for name, value in head.items():
        wet, heads = _below(name, value, mesh.p[:, nodes[name]], tolerance)
        at = nodes[name][wet]
        clash = np.flatnonzero(np.abs(values[at] - heads[wet]) > tolerance)
        if len(clash):
            raise ValueError(
                f"the boundaries '{by[at[clash[0]]]}' and '{name}' share the node at "
                f"{format_point(mesh.p[:, at[clash[0]]])} and give it different heads"
            )
        values[at], by[at] = heads[wet], name
    held = ~np.isnan(values)
    on_face, supply = np.zeros(basis.N, dtype=bool), sourced(basis, sources, axisymmetric)
    for name in faces:
        on_face[nodes[name]] = True
    for name, rate in flux.items():
        if held[nodes[name]].all():
            raise ValueError(
                f"boundary '{name}' has a flux and a head at all its nodes: give one of them"
            )
        entering = through(basis, passing[name], rate, axisymmetric)
        supply += entering
        on_face[entering > 0.0] = True
    return Conditions(held, values, on_face & ~held, supply, passing)


def through(basis: CellBasis, facets: ndarray, rate: Given, axisymmetric: bool) -> ndarray:
    """Return the water that enters the nodes through facets by a rate per area, (N,)."""
    if len(facets) == 0:
        return np.zeros(basis.N)
    sides = FacetBasis(basis.mesh, basis.elem, facets=facets)
    rates, entering = _at_points(sides, rate, "flux", axisymmetric), np.zeros(basis.N)
    on = np.unique(basis.mesh.facets[:, facets])
    entering[on] = LinearForm(lambda v, w: rates * v).assemble(sides)[
        on
    ]  # round-off at the other nodes
    return entering


def sourced(basis: CellBasis, sources: Mapping[str, Given], axisymmetric: bool) -> ndarray:
    """Return the water that enters the nodes by rates per volume of subdomains, (N,)."""
    total = np.zeros(basis.N)
    for name, rate in sources.items():
        elements = np.intersect1d(
            look_up(name, basis.mesh.subdomains or {}, "subdomain"), elements_of(basis)
        )
        if len(elements) == 0:
            raise ValueError(f"subdomain '{name}' has a source and no element of the porous ground")
        part = Basis(basis.mesh, basis.elem, intorder=2, elements=elements)
        rates = _at_points(part, rate, f"source of subdomain '{name}'", axisymmetric)
        total += LinearForm(lambda v, w, rates=rates: rates * v).assemble(part)
    return total


def _at_points(
    basis: CellBasis | FacetBasis, rate: Given, what: str, axisymmetric: bool
) -> ndarray:
    """Return a rate at the integration points, times the radius in axial symmetry."""
    x = np.asarray(basis.global_coordinates())
    return radius(basis, axisymmetric) * values_at(rate, x.reshape(len(x), -1), what).reshape(
        x.shape[1:]
    )


def pumped(
    basis: CellBasis, wells: Mapping[str, float], given: Conditions
) -> tuple[Conditions, ndarray]:
    """Return the conditions with wells, and the first node of the well for each of its nodes,
    itself else, (N,).
    """
    face, supply, passing, first = (
        given.face.copy(),
        given.supply.copy(),
        dict(given.passing),
        np.arange(basis.N),
    )
    for name, discharge in wells.items():
        at = nodes_on(basis, name)
        taken = at[given.held[at] | (first[at] != at)]
        if len(taken):
            raise ValueError(
                f"well '{name}' shares the node at {format_point(basis.mesh.p[:, taken[0]])} with "
                f"a head "
                "or another well"
            )
        first[at], face[at] = at[0], False
        supply[at[0]] -= float(finite(discharge, f"discharge of well '{name}'"))
        passing[name] = np.asarray(basis.mesh.boundaries[name])
    return replace(given, face=face, supply=supply, passing=passing), first


def drained(
    basis: CellBasis,
    drains: Mapping[str, tuple[Given, float]],
    given: Conditions,
    axisymmetric: bool,
) -> Conditions:
    """Return the conditions with drains: boundaries with a level and a resistance."""
    conductance, level, passing = np.zeros(basis.N), np.full(basis.N, np.nan), dict(given.passing)
    for name, (value, resistance) in drains.items():
        at, x = nodes_on(basis, name), basis.mesh.p
        taken = at[given.held[at] | (conductance[at] > 0.0)]
        if len(taken):
            raise ValueError(
                f"drain '{name}' shares the node at {format_point(x[:, taken[0]])} with a head or "
                f"another "
                "drain"
            )
        passing[name] = np.asarray(basis.mesh.boundaries[name])
        conductance += through(
            basis,
            passing[name],
            1.0 / positive(resistance, f"resistance of drain '{name}'"),
            axisymmetric,
        )
        level[at] = np.maximum(values_at(value, x[:, at], f"level of drain '{name}'"), x[-1, at])
    return replace(
        given,
        passing=passing,
        conductance=conductance,
        level=np.where(conductance > 0.0, level, 0.0),
    )


def screens_and_ties(
    basis: CellBasis, connected: Sequence[tuple[str, str]], held: ndarray, first: ndarray
) -> csr_matrix:
    """Return the matrix (N, N) that gives all heads from those of nodes that are not tied, nor in
    wells after one.
    """
    n, screened = basis.N, first != np.arange(basis.N)
    screened[first[screened]] = True
    tie = tied_heads(basis, connected, held | screened)
    return csr_matrix(tie @ csr_matrix((np.ones(n), (np.arange(n), first)), shape=tie.shape))


def _below(name: str, value: Given, x: ndarray, tolerance: float) -> tuple[ndarray, ndarray]:
    """Find the nodes of a boundary at or below the given head; return them as a mask, and the heads
    of all.
    """
    heads = values_at(value, x, f"head of boundary '{name}'")
    wet = x[-1] <= heads + tolerance
    if not wet.any():
        raise ValueError(
            f"the head of boundary '{name}', {heads.max():.4g} at most, is below all of it, from "
            f"{x[-1].min():.4g} up: it is dry; name it in seepage_face= if water may leave"
        )
    return wet, heads


def check_heads(basis: CellBasis, held: ndarray, tie: csr_matrix) -> None:
    """Refuse parts of the ground without a head; elements and tied nodes connect them."""
    dofs, porous = basis.element_dofs, np.unique(basis.element_dofs)
    first = np.broadcast_to(dofs[0], dofs.shape)
    graph = csr_matrix((np.ones(dofs.size), (first.ravel(), dofs.ravel())), shape=tie.shape) + tie
    part = connected_components(graph, directed=False)[1]
    lost = porous[~np.isin(part[porous], part[held])]
    if len(lost):
        raise ValueError(
            f"no head is given in the part of the ground around "
            f"{format_point(basis.mesh.p[:, lost[0]])}, "
            f"{len(lost)} nodes: bodies that share no node need connected= or a head each"
        )


def tied_heads(basis: CellBasis, connected: Sequence[tuple[str, str]], held: ndarray) -> csr_matrix:
    """Return the matrix (N, N) that gives the heads of all nodes from those of the nodes that are
    not tied.

    A node on the side with the smaller facets has the head of the nearest point of the other side,
    unless it is held.
    """
    mesh, n = basis.mesh, basis.N
    tie, tied = lil_matrix(eye(n)), np.zeros(n, dtype=bool)
    for pair in connected:
        if len(pair) != 2 or isinstance(pair, str):
            raise ValueError(f"connected boundaries are pairs of names, not {pair!r}")
        sides = [np.asarray(look_up(name, mesh.boundaries or {}, "boundary")) for name in pair]
        sides.sort(
            key=lambda facets: float(
                np.ptp(mesh.p[:, mesh.facets[:, facets]], axis=1).max(axis=0).mean()
            )
        )
        ends, other = (np.unique(mesh.facets[:, facets]) for facets in sides)
        nodes = np.setdiff1d(
            ends, np.append(np.flatnonzero(held | tied), other)
        )  # a slit ends in a node of both
        corners, weights, near = _nearest(mesh, mesh.p[:, nodes], sides[1])
        if not near.any():
            raise ValueError(
                f"the boundaries '{pair[0]}' and '{pair[1]}' are nowhere next to each other"
            )
        for node, at, share in zip(nodes[near], corners[near], weights[near]):
            tie[node, :] = 0.0
            tie[node, at] = share
        tied[nodes[near]] = True
    result = tie.tocsr()
    for _ in connected:  # tied to nodes that are tied themselves
        result = result @ result
    result.eliminate_zeros()
    if result[:, tied].nnz:
        raise ValueError(
            f"the pairs connected={list(connected)} tie bodies to each other in a circle: name "
            f"each pair "
            "once"
        )
    return csr_matrix(result)


def exchange(basis: CellBasis, connected: Sequence[tuple[str, str]]) -> tuple[csr_matrix, ndarray]:
    """Return the matrix (N, N) of pressures less those of the connected boundaries opposite, and
    their facets.
    """
    n, mesh, facets = basis.N, basis.mesh, [np.zeros(0, int)]
    apart = csr_matrix(eye(n) - tied_heads(basis, connected, np.zeros(n, dtype=bool)))
    for name, other in (sides for pair in connected for sides in (pair, pair[::-1])):
        side, opposite = (np.asarray(mesh.boundaries[each]) for each in (name, other))
        if not np.isin(mesh.f2t[0, side], elements_of(basis)).all():
            raise ValueError(
                f"connected boundaries have porous ground on both sides, but not on '{name}'"
            )
        facets.append(
            side[_nearest(mesh, mesh.p[:, mesh.facets[:, side]].mean(axis=1), opposite)[2]]
        )
    return apart, np.unique(np.concatenate(facets))


def _nearest(mesh: Mesh, points: ndarray, facets: ndarray) -> tuple[ndarray, ndarray, ndarray]:
    """Return corners and weights, (n, dim) each, of the nearest points on facets, and a mask of
    those that are near.
    """
    ends = mesh.facets[:, facets]
    parts = ends if len(ends) == mesh.dim() else np.hstack((ends[[0, 1, 2]], ends[[0, 2, 3]]))
    p = mesh.p[:, parts]  # (dim, corners, m)
    along = (p[:, 1:] - p[:, :1]).transpose(2, 0, 1)
    project = np.linalg.pinv(along)  # (m, corners - 1, dim)
    size = np.linalg.norm(along, axis=1).max(axis=1)
    found, weights, near = [], [], []
    for block in np.array_split(points.T, max(1, points.shape[1] * parts.shape[1] // _PAIRS)):
        offset = block[:, None] - p[:, 0].T  # (n, m, dim)
        local = np.einsum("mij,nmj->nmi", project, offset)
        share = np.clip(
            np.concatenate((1.0 - local.sum(axis=2, keepdims=True), local), axis=2), 0.0, None
        )
        share /= share.sum(axis=2, keepdims=True)
        distance = np.linalg.norm(offset - np.einsum("mij,nmj->nmi", along, share[..., 1:]), axis=2)
        best, rows = distance.argmin(axis=1), np.arange(len(block))
        found.append(parts[:, best].T)
        weights.append(share[rows, best])
        near.append(distance[rows, best] <= _BESIDE * size[best])
    return np.concatenate(found), np.concatenate(weights), np.concatenate(near)
