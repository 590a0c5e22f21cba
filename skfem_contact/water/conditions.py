"""What is known at boundaries: heads, faces where water may leave, and joints through which it passes freely."""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix, diags_array, eye, lil_matrix
from scipy.sparse.csgraph import connected_components
from skfem import CellBasis, FacetBasis, Mesh

from ..errors import look_up, names_of, place
from ..layout import elements_of

#: Head or pressure on a boundary: a number, or a function of places (dim, ...).
Given = float | Callable[[ndarray], ndarray]
#: Heads and heights that differ by less than this part of the model's size are the same.
_SAME = 1e-9
#: Conductance of a joint over that of the elements beside it: its sides differ by a thousandth of the drop in one.
_OPEN = 1e3
#: Nodes farther than this from the other side, in sizes of its facets, lie beside it: the joint is not there.
_BESIDE = 0.1
#: Pairs of nodes and facets that are compared at a time.
_PAIRS = 200_000


@dataclass(frozen=True)
class Conditions:
    """Conditions at the nodes.

    Attributes
    ----------
    held
        Whether the head of a node is given, (N,) of bool.
    head
        Given heads, (N,); NaN elsewhere.
    face
        Whether water may leave at a node and not enter, (N,) of bool.
    passing
        Facets of the boundaries through which water passes, by name.
    """

    held: ndarray
    head: ndarray
    face: ndarray
    passing: Mapping[str, ndarray]


def nodes_on(basis: CellBasis, boundary: str) -> ndarray:
    """Nodes of the porous ground of a basis of heads or pressures on a boundary."""
    facets = look_up(boundary, basis.mesh.boundaries or {}, "boundary")
    found = np.intersect1d(basis.mesh.facets[:, facets], basis.element_dofs)
    if len(found) == 0:
        raise ValueError(f"boundary '{boundary}' has no node of the porous ground")
    return found


def values_at(given: Given, x: ndarray, what: str) -> ndarray:
    """What is given, at places (dim, n)."""
    values = np.asarray(given(x) if callable(given) else given, dtype=float)
    if values.shape not in ((), x.shape[1:]) or not np.isfinite(values).all():
        raise ValueError(f"the {what} must be a finite number, or a function of places that gives one for each")
    return np.broadcast_to(values, x.shape[1:])


def conditions(basis: CellBasis, head: Mapping[str, Given], face: str | Sequence[str]) -> Conditions:
    """Conditions at the nodes from those on boundaries; a head holds at and below its own height."""
    mesh, faces = basis.mesh, names_of(face)
    if not isinstance(head, Mapping) or not head:
        raise ValueError("there is no head: give {boundary: head} for the boundaries at which water stands")
    nodes = {name: nodes_on(basis, name) for name in (*head, *faces)}
    passing = {name: np.asarray(mesh.boundaries[name]) for name in nodes}
    values, by = np.full(basis.N, np.nan), np.zeros(basis.N, dtype=object)
    tolerance = _SAME * float(np.ptp(mesh.p, axis=1).max())
    for name, value in head.items():
        wet, heads = _below(name, value, mesh.p[:, nodes[name]], tolerance)
        at = nodes[name][wet]
        clash = np.flatnonzero(np.abs(values[at] - heads[wet]) > tolerance)
        if len(clash):
            raise ValueError(f"the boundaries '{by[at[clash[0]]]}' and '{name}' share the node at "
                             f"{place(mesh.p[:, at[clash[0]]])} and give it different heads")
        values[at], by[at] = heads[wet], name
    held = ~np.isnan(values)
    on_face = np.zeros(basis.N, dtype=bool)
    for name in faces:
        on_face[nodes[name]] = True
    return Conditions(held, values, on_face & ~held, passing)


def _below(name: str, value: Given, x: ndarray, tolerance: float) -> tuple[ndarray, ndarray]:
    """Which nodes of a boundary lie at or below the given head, and the heads of all."""
    heads = values_at(value, x, f"head of boundary '{name}'")
    wet = x[-1] <= heads + tolerance
    if not wet.any():
        raise ValueError(f"the head of boundary '{name}', {heads.max():.4g} at most, is below all of it, from "
                         f"{x[-1].min():.4g} up: no water stands there; name it in seepage_face= if water may leave")
    return wet, heads


def check_connected(basis: CellBasis, held: ndarray, tie: csr_matrix) -> None:
    """Refuse parts of the ground, connected by elements or by tied nodes, that have no head."""
    dofs, porous = basis.element_dofs, np.unique(basis.element_dofs)
    first = np.broadcast_to(dofs[0], dofs.shape)
    graph = csr_matrix((np.ones(dofs.size), (first.ravel(), dofs.ravel())), shape=tie.shape) + tie
    part = connected_components(graph, directed=False)[1]
    lost = porous[~np.isin(part[porous], part[held])]
    if len(lost):
        raise ValueError(f"no head is given in the part of the ground around {place(basis.mesh.p[:, lost[0]])}, "
                         f"{len(lost)} nodes: bodies that share no node need connected= or a head each")


def tied_heads(basis: CellBasis, joints: Sequence[tuple[str, str]], held: ndarray) -> csr_matrix:
    """Heads of all nodes from those of the nodes that are not tied, (N, N).

    A node on the side with the smaller facets has the head of the place on the other side that is nearest to it, unless
    its head is given.
    """
    mesh, n = basis.mesh, basis.N
    tie, tied = lil_matrix(eye(n)), np.zeros(n, dtype=bool)
    for joint in joints:
        if len(joint) != 2 or isinstance(joint, str):
            raise ValueError(f"a joint is a pair of boundaries, not {joint!r}")
        sides = [np.asarray(look_up(name, mesh.boundaries or {}, "boundary")) for name in joint]
        sides.sort(key=lambda facets: float(np.ptp(mesh.p[:, mesh.facets[:, facets]], axis=1).max(axis=0).mean()))
        nodes = np.setdiff1d(mesh.facets[:, sides[0]], np.flatnonzero(held | tied))
        corners, weights, near = _nearest(mesh, mesh.p[:, nodes], sides[1])
        if not near.any():
            raise ValueError(f"the boundaries '{joint[0]}' and '{joint[1]}' are nowhere next to each other")
        for node, at, share in zip(nodes[near], corners[near], weights[near]):
            tie[node, :] = 0.0
            tie[node, at] = share
        tied[nodes[near]] = True
    result = tie.tocsr()
    for _ in joints:  # tied to nodes that are tied themselves
        result = result @ result
    result.eliminate_zeros()
    if result[:, tied].nnz:
        raise ValueError(f"the joints {list(joints)} tie bodies to each other in a circle: name each pair once")
    return csr_matrix(result)


def open_joints(basis: CellBasis, joints: Sequence[tuple[str, str]], conductance: ndarray
                ) -> tuple[coo_matrix, ndarray]:
    """Water that leaves the nodes through joints, (N, N), by the pressures, and the facets that face each other.

    The conductance is the water that leaves the nodes of the ground by a pressure of one there, (N,).
    """
    n, mesh, facets = basis.N, basis.mesh, [np.zeros(0, int)]
    apart = csr_matrix(eye(n) - tied_heads(basis, joints, np.zeros(n, dtype=bool)))
    for name, other in (sides for joint in joints for sides in (joint, joint[::-1])):
        side, opposite = (np.asarray(mesh.boundaries[each]) for each in (name, other))
        if not np.isin(mesh.f2t[0, side], elements_of(basis)).all():
            raise ValueError(f"a joint is open where there is porous ground on both sides, but not on '{name}'")
        facets.append(side[_nearest(mesh, mesh.p[:, mesh.facets[:, side]].mean(axis=1), opposite)[2]])
    return coo_matrix(apart.T @ diags_array(_OPEN * conductance) @ apart), np.unique(np.concatenate(facets))


def pressed(basis: CellBasis, pressures: CellBasis, facets: ndarray, axisymmetric: bool) -> ndarray:
    """Volume that displacements sweep at facets, weighted with the shape functions of the pressure.

    As :attr:`Porous.coupling`, (n_elements, n_u, n_p).
    """
    result = np.zeros((basis.nelems, basis.Nbfun, pressures.Nbfun))
    if len(facets) == 0:
        return result
    sides = FacetBasis(basis.mesh, basis.elem, facets=facets)
    there = FacetBasis(basis.mesh, pressures.elem, facets=facets, quadrature=sides.quadrature)
    weight = sides.dx * sides.global_coordinates()[0] if axisymmetric else sides.dx
    swept = np.stack([np.einsum("ifq,ifq->fq", sides.basis[b][0], sides.normals) for b in range(sides.Nbfun)])
    shapes = np.stack([np.broadcast_to(there.basis[j][0], weight.shape) for j in range(there.Nbfun)])
    number = np.zeros(basis.mesh.nelements, int)
    number[elements_of(basis)] = np.arange(basis.nelems)
    np.add.at(result, number[basis.mesh.f2t[0, facets]], np.einsum("bfq,jfq,fq->fbj", swept, shapes, weight))
    return result


def _nearest(mesh: Mesh, points: ndarray, facets: ndarray) -> tuple[ndarray, ndarray, ndarray]:
    """Corners and weights of the places on facets nearest to points, (n, dim) each, and whether these are near."""
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
        share = np.clip(np.concatenate((1.0 - local.sum(axis=2, keepdims=True), local), axis=2), 0.0, None)
        share /= share.sum(axis=2, keepdims=True)
        distance = np.linalg.norm(offset - np.einsum("mij,nmj->nmi", along, share[..., 1:]), axis=2)
        best, rows = distance.argmin(axis=1), np.arange(len(block))
        found.append(parts[:, best].T)
        weights.append(share[rows, best])
        near.append(distance[rows, best] <= _BESIDE * size[best])
    return np.concatenate(found), np.concatenate(weights), np.concatenate(near)
