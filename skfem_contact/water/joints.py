"""Joints between bodies that share no nodes, through which water passes freely."""
from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix, diags_array, eye, lil_matrix
from skfem import CellBasis, FacetBasis, Mesh

from ..errors import look_up
from ..unknowns import elements_of

#: Conductance of a joint over that of the elements beside it: its sides differ by a thousandth of the drop in one.
_OPEN = 1e3
#: Nodes farther than this from the other side, in sizes of its facets, lie beside it: the joint is not there.
_BESIDE = 0.1
#: Pairs of nodes and facets that are compared at a time.
_PAIRS = 200_000


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
