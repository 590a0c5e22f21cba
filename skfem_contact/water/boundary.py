"""Conditions of water at the nodes: heads, seepage faces, fluxes, wells, drains, connections."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, eye, lil_matrix
from scipy.sparse.csgraph import connected_components
from skfem import Basis, CellBasis, FacetBasis, LinearForm, Mesh

from ..arrays import max_abs, row_norms
from ..checks import facets_of, finite, format_point, look_up, names_of, positive
from ..layout import elements_of, facet_corners
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
class NodalConditions:
    """Conditions at the nodes, (N,) each.

    Attributes
    ----------
    held, head
        Nodes with a given head, and the heads, NaN elsewhere.
    face
        Nodes of seepage faces.
    supply
        Water that enters per time as given.
    passing
        Facets of the boundaries through which water passes, by name.
    conductance, level
        Drains take the conductance times the head above their level.
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

    def above(self, datum: float) -> NodalConditions:
        """Return the conditions with heads and levels that count from a datum."""
        return replace(self, head=self.head - datum, level=self.level - datum)

    def taken(self, head: ndarray) -> ndarray:
        """Return the water that drains take at heads, (N,)."""
        return np.asarray(self.conductance * np.maximum(head - self.level, 0.0))

    def taking(self, head: ndarray) -> ndarray:
        """Return its slope over the heads, (N,)."""
        return np.asarray(self.conductance * (head >= self.level))


def nodes_on(basis: CellBasis, boundary: str) -> ndarray:
    """Return the nodes of the porous ground of a basis of heads or pressures on a boundary."""
    facets = facets_of(basis.mesh, boundary)
    nodes = np.intersect1d(basis.mesh.facets[:, facets], basis.element_dofs)
    if len(nodes) == 0:
        raise ValueError(f"boundary '{boundary}' has no node of the porous ground")
    return nodes


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
) -> NodalConditions:
    """Return the conditions at the nodes; a head holds at and below its own height.

    Boundaries with a flux into the ground are seepage faces as well: the water that the ground does
    not take runs off.
    """
    # Find the nodes of each condition.
    mesh = basis.mesh
    faces = names_of(seepage_face)
    nodes = {name: nodes_on(basis, name) for name in (*head, *faces, *flux)}
    tolerance = _SAME * float(np.ptp(mesh.p, axis=1).max())
    if axisymmetric:
        _refuse_axis(mesh, nodes, tolerance)
    heads = _heads(mesh, {name: nodes[name] for name in head}, head, basis.N, tolerance)
    held = ~np.isnan(heads)
    # Add the water that enters.
    passing = {name: np.asarray(mesh.boundaries[name]) for name in nodes}
    supply = sourced(basis, sources, axisymmetric)
    on_face = np.zeros(basis.N, dtype=bool)
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
    return NodalConditions(held, heads, on_face & ~held, supply, passing)


def _refuse_axis(mesh: Mesh, nodes: Mapping[str, ndarray], tolerance: float) -> None:
    """Refuse boundaries on the axis."""
    for name, indices in nodes.items():
        if max_abs(mesh.p[0, indices]) <= tolerance:
            raise ValueError(
                f"boundary '{name}' lies on the axis and has no area: no water passes through "
                "it; a well has a radius"
            )


def _heads(
    mesh: Mesh,
    nodes: Mapping[str, ndarray],
    given: Mapping[str, Given],
    n: int,
    tolerance: float,
) -> ndarray:
    """Return given heads at nodes at or below them, (n,), NaN elsewhere."""
    result = np.full(n, np.nan)
    owner = np.zeros(n, dtype=object)
    for name, value in given.items():
        # Nodes above the given head are dry.
        x = mesh.p[:, nodes[name]]
        heads = values_at(value, x, f"head of boundary '{name}'")
        wet = x[-1] <= heads + tolerance
        if not wet.any():
            raise ValueError(
                f"the head of boundary '{name}', {heads.max():.4g} at most, is below all of it, "
                f"from {x[-1].min():.4g} up: it is dry; name it in seepage_face= if water may leave"
            )
        indices = nodes[name][wet]
        # Refuse two heads at one node.
        clash = np.flatnonzero(np.abs(result[indices] - heads[wet]) > tolerance)
        if len(clash):
            node = indices[clash[0]]
            raise ValueError(
                f"the boundaries '{owner[node]}' and '{name}' share the node at "
                f"{format_point(mesh.p[:, node])} and give it different heads"
            )
        result[indices] = heads[wet]
        owner[indices] = name
    return result


def with_suction(
    basis: CellBasis, suction: Mapping[str, Given], given: NodalConditions
) -> NodalConditions:
    """Return the conditions with suctions on boundaries, which hold like heads."""
    held = given.held.copy()
    heads = given.head.copy()
    passing = dict(given.passing)
    for name, value in suction.items():
        nodes = nodes_on(basis, name)
        nodes = nodes[~given.held[nodes]]
        x = basis.mesh.p[:, nodes]
        heads[nodes] = x[-1] - values_at(value, x, f"suction of boundary '{name}'")
        held[nodes] = True
        passing[name] = np.asarray(basis.mesh.boundaries[name])
    return replace(given, held=held, head=heads, face=given.face & ~held, passing=passing)


def through(basis: CellBasis, facets: ndarray, rate: Given, axisymmetric: bool) -> ndarray:
    """Return the water that enters the nodes through facets by a rate per area, (N,)."""
    entering = np.zeros(basis.N)
    if len(facets) == 0:
        return entering
    sides = FacetBasis(basis.mesh, basis.elem, facets=facets)
    rates = _at_points(sides, rate, "flux", axisymmetric)
    nodes = np.unique(basis.mesh.facets[:, facets])
    # Nodes off the facets have round-off.
    entering[nodes] = LinearForm(lambda v, w: rates * v).assemble(sides)[nodes]
    return entering


def sourced(basis: CellBasis, sources: Mapping[str, Given], axisymmetric: bool) -> ndarray:
    """Return the water that enters the nodes by rates per volume of subdomains, (N,)."""
    total = np.zeros(basis.N)
    for name, rate in sources.items():
        subdomain = look_up(name, basis.mesh.subdomains or {}, "subdomain")
        elements = np.intersect1d(subdomain, elements_of(basis))
        if len(elements) == 0:
            raise ValueError(f"subdomain '{name}' has a source and no element of the porous ground")
        part = Basis(basis.mesh, basis.elem, intorder=2, elements=elements)
        rates = _at_points(part, rate, f"source of subdomain '{name}'", axisymmetric)
        total += LinearForm(lambda v, w, rates=rates: rates * v).assemble(part)
    return total


def _at_points(
    basis: CellBasis | FacetBasis,
    rate: Given,
    what: str,
    axisymmetric: bool,
) -> ndarray:
    """Return a rate at the integration points, times the radius in axial symmetry."""
    x = np.asarray(basis.global_coordinates())  # (dim, n, n_points)
    points = x.reshape(len(x), -1)
    rates = values_at(rate, points, what).reshape(x.shape[1:])
    return radius(basis, axisymmetric) * rates


def pumped(
    basis: CellBasis, wells: Mapping[str, float], given: NodalConditions
) -> tuple[NodalConditions, ndarray]:
    """Return the conditions with wells, and the first node of the well of each node, (N,).

    A node outside of wells is its own first node.
    """
    face = given.face.copy()
    supply = given.supply.copy()
    passing = dict(given.passing)
    first = np.arange(basis.N)
    for name, discharge in wells.items():
        nodes = nodes_on(basis, name)
        # The nodes of a well have one head, that of the first of them.
        taken = nodes[given.held[nodes] | (first[nodes] != nodes)]
        if len(taken):
            raise ValueError(
                f"well '{name}' shares the node at {format_point(basis.mesh.p[:, taken[0]])} with "
                "a head or another well"
            )
        first[nodes] = nodes[0]
        # Water leaves through the well alone, at its rate.
        face[nodes] = False
        supply[nodes[0]] -= float(finite(discharge, f"discharge of well '{name}'"))
        passing[name] = np.asarray(basis.mesh.boundaries[name])
    return replace(given, face=face, supply=supply, passing=passing), first


def drained(
    basis: CellBasis,
    drains: Mapping[str, tuple[Given, float]],
    given: NodalConditions,
    axisymmetric: bool,
) -> NodalConditions:
    """Return the conditions with drains: boundaries with a level and a resistance."""
    conductance = np.zeros(basis.N)
    level = np.full(basis.N, np.nan)
    passing = dict(given.passing)
    for name, (value, resistance) in drains.items():
        nodes = nodes_on(basis, name)
        x = basis.mesh.p[:, nodes]
        # A node has one condition.
        taken = np.flatnonzero(given.held[nodes] | (conductance[nodes] > 0.0))
        if len(taken):
            raise ValueError(
                f"drain '{name}' shares the node at {format_point(x[:, taken[0]])} with a head or "
                "another drain"
            )
        passing[name] = np.asarray(basis.mesh.boundaries[name])
        # Inflow = -(head - level) / resistance, integrated over the boundary.
        rate = 1.0 / positive(resistance, f"resistance of drain '{name}'")
        conductance += through(basis, passing[name], rate, axisymmetric)
        # Drains are empty above their level.
        level[nodes] = np.maximum(values_at(value, x, f"level of drain '{name}'"), x[-1])
    level = np.where(conductance > 0.0, level, 0.0)
    return replace(given, passing=passing, conductance=conductance, level=level)


def screens_and_ties(
    basis: CellBasis,
    connected: Sequence[tuple[str, str]],
    held: ndarray,
    first: ndarray,
) -> csr_matrix:
    """Return the matrix (N, N) that gives all heads from the heads of free nodes.

    Nodes of connected boundaries are tied to the opposite side, nodes of a well to its first node.
    """
    n = basis.N
    screened = first != np.arange(n)
    screened[first[screened]] = True
    tie = tied_heads(basis, connected, held | screened)
    every = np.arange(n)
    to_first = csr_matrix((np.ones(n), (every, first)), shape=tie.shape)
    return csr_matrix(tie @ to_first)


def check_heads(basis: CellBasis, held: ndarray, tie: csr_matrix) -> None:
    """Refuse parts of the ground without a head; elements and tied nodes connect them."""
    dofs = basis.element_dofs
    porous = np.unique(dofs)
    first = np.broadcast_to(dofs[0], dofs.shape)
    ones = np.ones(dofs.size)
    graph = csr_matrix((ones, (first.ravel(), dofs.ravel())), shape=tie.shape)
    part = connected_components(graph + tie, directed=False)[1]
    without = porous[~np.isin(part[porous], part[held])]
    if len(without):
        raise ValueError(
            f"no head is given in the part of the ground around "
            f"{format_point(basis.mesh.p[:, without[0]])}, {len(without)} nodes: bodies that share "
            "no node need connected= or a head each"
        )


def tied_heads(basis: CellBasis, connected: Sequence[tuple[str, str]], held: ndarray) -> csr_matrix:
    """Return the matrix (N, N) that gives all heads from the heads of nodes that are not tied.

    A node on the side with the smaller facets has the head of the nearest point of the opposite
    side, unless it is held.
    """
    n = basis.N
    # The head of a tied node is that of the facet opposite.
    tie = lil_matrix(eye(n))
    tied = np.zeros(n, dtype=bool)
    for pair in connected:
        if len(pair) != 2 or isinstance(pair, str):
            raise ValueError(f"connected boundaries are pairs of names, not {pair!r}")
        nodes, corners, weights = _ties(basis.mesh, pair, held | tied)
        for node, indices, share in zip(nodes, corners, weights):
            tie[node, :] = 0.0
            tie[node, indices] = share
        tied[nodes] = True
    # Follow ties to nodes that are tied themselves.
    result = tie.tocsr()
    for _ in connected:
        result = result @ result
    result.eliminate_zeros()
    if result[:, tied].nnz:
        raise ValueError(
            f"the pairs connected={list(connected)} tie bodies to each other in a circle: name "
            "each pair once"
        )
    return csr_matrix(result)


def _ties(mesh: Mesh, pair: tuple[str, str], held: ndarray) -> tuple[ndarray, ndarray, ndarray]:
    """Return the nodes of a pair that are tied, (n,), to corners by weights, (n, dim) each."""
    sides = [facets_of(mesh, name) for name in pair]
    fine, coarse = sorted(sides, key=lambda facets: _mean_size(mesh, facets))
    # The end of a slit is a node of both sides.
    fixed = np.append(np.flatnonzero(held), mesh.facets[:, coarse])
    nodes = np.setdiff1d(mesh.facets[:, fine], fixed)
    corners, weights, near = _nearest(mesh, mesh.p[:, nodes], coarse)
    if not near.any():
        raise ValueError(
            f"the boundaries '{pair[0]}' and '{pair[1]}' are nowhere next to each other"
        )
    return nodes[near], corners[near], weights[near]


def _mean_size(mesh: Mesh, facets: ndarray) -> float:
    ends = facet_corners(mesh, facets)
    return float(np.ptp(ends, axis=1).max(axis=0).mean())


def exchange(basis: CellBasis, connected: Sequence[tuple[str, str]]) -> tuple[csr_matrix, ndarray]:
    """Return the matrix (N, N) of differences of pressures across connected boundaries.

    The second value are the facets of these boundaries that have an opposite side.
    """
    mesh = basis.mesh
    n = basis.N
    # Tie the heads of both sides; the differences drive the exchange.
    apart = csr_matrix(eye(n) - tied_heads(basis, connected, np.zeros(n, dtype=bool)))
    facets = [np.zeros(0, int)]
    both_ways = [sides for pair in connected for sides in (pair, pair[::-1])]
    for name, opposite in both_ways:
        # Both sides must be porous.
        side = np.asarray(mesh.boundaries[name])
        if not np.isin(mesh.f2t[0, side], elements_of(basis)).all():
            raise ValueError(
                f"connected boundaries have porous ground on both sides, but not on '{name}'"
            )
        # Facets across are counted once, by the nearest of the other side.
        middles = facet_corners(mesh, side).mean(axis=1)
        near = _nearest(mesh, middles, np.asarray(mesh.boundaries[opposite]))[2]
        facets.append(side[near])
    return apart, np.unique(np.concatenate(facets))


def _nearest(mesh: Mesh, points: ndarray, facets: ndarray) -> tuple[ndarray, ndarray, ndarray]:
    """Return the nearest points on facets by corners and weights, (n, dim) each.

    The third value is a mask of the points (dim, n) that are near.
    """
    # Divide quadrilateral facets into triangles.
    ends = mesh.facets[:, facets]
    if len(ends) == mesh.dim():
        parts = ends
    else:
        parts = np.hstack((ends[[0, 1, 2]], ends[[0, 2, 3]]))
    p = mesh.p[:, parts]  # (dim, n_corners, m)
    along = (p[:, 1:] - p[:, :1]).transpose(2, 0, 1)  # (m, dim, n_corners - 1)
    project = np.linalg.pinv(along)  # (m, n_corners - 1, dim)
    size = row_norms(along).max(axis=1)
    corners = []
    weights = []
    near = []
    n_blocks = max(1, points.shape[1] * parts.shape[1] // _PAIRS)
    for block in np.array_split(points.T, n_blocks):
        # Project the points on all facets, and clip them to the facets.
        offset = block[:, None] - p[:, 0].T  # (n, m, dim)
        local = np.einsum("mij,nmj->nmi", project, offset)
        first = 1.0 - local.sum(axis=2, keepdims=True)
        share = np.concatenate((first, local), axis=2)
        share = np.clip(share, 0.0, None)
        share /= share.sum(axis=2, keepdims=True)
        # Take the nearest facet.
        nearest = np.einsum("mij,nmj->nmi", along, share[..., 1:])
        distance = np.linalg.norm(offset - nearest, axis=2)
        best = distance.argmin(axis=1)
        rows = np.arange(len(block))
        corners.append(parts[:, best].T)
        weights.append(share[rows, best])
        near.append(distance[rows, best] <= _BESIDE * size[best])
    return (
        np.concatenate(corners),
        np.concatenate(weights),
        np.concatenate(near),
    )
