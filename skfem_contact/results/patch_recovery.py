r"""Fields at nodes from values at integration points, region by region.

Stresses of linear elements are recovered from the forces of their nodes: Boroomand and Zienkiewicz
(Int. J. Numer. Methods Eng. 40 (1997) 137-164), recovery by equilibrium in patches. Around every
vertex a linear field
:math:`\sigma^*` is sought whose nodal forces are those of the elements,

.. math:: \sum_p \Big| \int_p B^T \sigma^* - \int_p \bar B^T \sigma_h \Big|^2
          + \beta \int_p |\sigma^* - \sigma_h|^2 \to \min,

for these balance the loads even where the elements are too stiff in bending (full integration) or
too soft (B-bar), and a surface without load gets no stress from the inside. Around vertices of
elements of second order the field is quadratic. Other fields have no forces: the second term alone
is superconvergent patch recovery (Zienkiewicz and Zhu, Int. J. Numer. Methods Eng. 33 (1992)
1331-1364).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix, diags_array
from scipy.sparse.linalg import cg

from ..forms.assembly import strain_operator
from ..forms.solid import SolidForm
from ..layout import linear_element, nodes

#: Weight of the stresses themselves beside the forces, by the order of the elements and whether
#: they are triangles or tetrahedra. Fibre of a beam of one to four layers, largest error for
#: weights of .007, .1, .3 and 1: four-node elements 1.3, 4.5, 9 and 13 % (below .007, one-sided
#: patches at corners lose digits); six-node triangles 2.1, 1.4, .9 and .3 %; three-node ones, of
#: three and four layers, 15, 9, 5 and 11 %.
_BETA = {(1, False): 0.007, (1, True): 0.3, (2, False): 1.0, (2, True): 1.0}
_PROJECTED = 1e-12  # residual of a projection, as a share
_CHUNK = 500  # patches at a time


class RegionMesh(NamedTuple):
    """Nodes and elements of the regions of solids; both regions of a border have its nodes."""

    nodes: ndarray  # region after region, (n,)
    cells: ndarray  # positions in `nodes`, (n_elements, k)
    region: ndarray  # of every element, counted through all solids


def region_mesh(*forms: SolidForm) -> RegionMesh:
    """Return the regions of some solids on one mesh."""
    numbers = np.concatenate([nodes(form.basis) for form in forms])
    sizes = [
        len(range(form.basis.nelems)[region.elements]) for form in forms for region in form.regions
    ]
    region, n = np.repeat(np.arange(len(sizes)), sizes), int(numbers.max()) + 1
    keys, cells = np.unique(region[:, None] * n + numbers, return_inverse=True)
    return RegionMesh(keys % n, cells.reshape(numbers.shape), region)


def recovered(
    form: SolidForm, values: ndarray, *, balanced: bool = False, limited: bool = False
) -> ndarray:
    """Return values at the nodes of the :func:`region_mesh` of a solid, (n_components, n), from
    those at its points.

    Balanced values are stresses, whose nodal forces count. Limited ones stay within those of the
    elements nearby.
    """
    mesh = region_mesh(form)
    found = _fitted(form, values, mesh, balanced)
    return within_points(found, values, mesh) if limited else found


def projected(form: SolidForm, values: ndarray) -> tuple[csr_matrix, ndarray, ndarray]:
    """Project values at points, (n_components, n_elements, n_points), on linear functions of each
    region.

    Returns the functions at the points, (n_elements * n_points, n_vertices), the vertices of the
    elements, and the values there, (n_vertices, n_components).
    """
    corners, cells = len(form.basis.mesh.t), region_mesh(form).cells
    linear = form.basis.with_element(linear_element(form.basis.mesh)).basis
    shapes = np.stack(
        [np.broadcast_to(linear[j][0], form.weight.shape) for j in range(corners)], axis=2
    )
    vertex = np.unique(cells[:, :corners], return_inverse=True)[1].reshape(-1, corners)
    columns = np.broadcast_to(vertex[:, None], shapes.shape).ravel()
    at = csr_matrix((shapes.ravel(), columns, np.arange(0, shapes.size + 1, corners)))
    weighted = csr_matrix(at.multiply(form.weight.reshape(-1, 1))).T
    mass = csr_matrix(weighted @ at)
    scale = diags_array(
        1.0 / mass.diagonal()
    )  # the condition is then 5 on any mesh (A. J. Wathen 1987)
    found = [cg(mass, weighted @ part.ravel(), rtol=_PROJECTED, M=scale)[0] for part in values]
    return at, vertex, np.column_stack(found)


def within_points(found: ndarray, values: ndarray, mesh: RegionMesh) -> ndarray:
    """Clip values at nodes to the range of the points around each of them."""
    low, high = np.full_like(found, np.inf), np.full_like(found, -np.inf)
    for c, part in enumerate(values):
        np.minimum.at(low[c], mesh.cells, part.min(axis=1)[:, None])
        np.maximum.at(high[c], mesh.cells, part.max(axis=1)[:, None])
    return np.clip(found, low, high)


def _fitted(form: SolidForm, values: ndarray, mesh: RegionMesh, balanced: bool) -> ndarray:
    """Fit polynomials in the patches around the vertices, and evaluate them at the nodes:
    (n_components, n).
    """
    basis, cells = form.basis, mesh.cells
    dim, corners = basis.mesh.dim(), basis.mesh.t.shape[0]
    vertex = np.unique(cells[:, :corners])
    incidence = _incidence(cells, len(mesh.nodes))[vertex]
    coordinates = np.asarray(basis.doflocs[:, dim * mesh.nodes])
    center = coordinates[:, vertex]
    size = np.asarray(incidence @ np.asarray(basis.dx).sum(axis=1)) ** (1.0 / dim)
    points = np.asarray(basis.global_coordinates())
    forces = form.element_forces(values, np.arange(basis.nelems)).T if balanced else None
    B = strain_operator(form.basis, "full", str(form.coordinates)).B if balanced else None
    degree = 2 if cells.shape[1] > corners else 1
    beta = _BETA[degree, corners == dim + 1]
    m, nc = len(_powers(np.zeros((dim, 1)), degree)), len(values)
    fits = np.empty((len(vertex), nc, m))
    for start in range(0, len(vertex), _CHUNK):
        chunk = incidence[start : start + _CHUNK]
        patch = np.repeat(np.arange(chunk.shape[0]), np.diff(chunk.indptr))
        e = chunk.indices
        x = (points[:, e] - center[:, start + patch, None]) / size[start + patch, None]
        p = _powers(x, degree).transpose(1, 2, 0)  # (pairs, points, m)
        w = form.weight[e] / np.bincount(patch, form.weight[e].sum(axis=1))[patch][:, None]
        mass = _sum_of(patch, chunk.shape[0], np.einsum("pqa,pqb,pq->pab", p, p, w))
        r = _sum_of(patch, chunk.shape[0], np.einsum("cpq,pqa,pq->pca", values[:, e], p, w))
        if B is None or forces is None:  # component by component
            fits[start : start + _CHUNK] = r @ _inverse(mass)
            continue
        scaled = w * size[start + patch, None]
        H, f = _balance(
            patch, cells[e], B[e], p, scaled, forces[e] * (scaled / form.weight[e])[:, :1]
        )
        A = H.transpose(0, 2, 1) @ H + beta * np.einsum("cd,pab->pcadb", np.eye(nc), mass).reshape(
            len(r), nc * m, -1
        )
        r = np.einsum("pra,pr->pa", H, f) + beta * r.reshape(len(r), -1)
        fits[start : start + _CHUNK] = np.einsum("pab,pb->pa", _inverse(A), r).reshape(-1, nc, m)
    return _evaluated(
        fits, coordinates, center, size, _sources(form, mesh, vertex, incidence), degree
    )


def _powers(x: ndarray, degree: int) -> ndarray:
    """Return the terms, (m, ...), of complete polynomials of coordinates (dim, ...)."""
    terms = [np.ones((1, *x.shape[1:])), x]
    if degree == 2:
        i, j = np.triu_indices(len(x))
        terms.append(x[i] * x[j])
    return np.concatenate(terms)


def _incidence(cells: ndarray, n: int) -> csr_matrix:
    """Return the incidence of nodes and elements, (n, n_elements)."""
    rows, columns = cells.ravel(), np.repeat(np.arange(len(cells)), cells.shape[1])
    return coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(n, len(cells))).tocsr()


def _balance(
    patch: ndarray, cells: ndarray, B: ndarray, p: ndarray, w: ndarray, forces: ndarray
) -> tuple[ndarray, ndarray]:
    """Return nodal forces of the fields, (patches, rows, nc m), and of the elements, (patches,
    rows).
    """
    dim = forces.shape[1] // cells.shape[1]
    H = np.einsum("pqci,pqa,pq->pica", B, p, w, optimize=True)
    H = H.reshape(*H.shape[:2], -1)
    keys, row = np.unique(patch[:, None] * (cells.max() + 1) + cells, return_inverse=True)
    owner = keys // (cells.max() + 1)  # the rows of a patch follow each other
    first = np.searchsorted(owner, np.arange(owner[-1] + 2))
    position = (np.arange(len(keys)) - first[owner])[row.reshape(cells.shape)]
    n, rows = owner[-1] + 1, int(np.diff(first).max()) * dim
    slot = (dim * position[:, :, None] + np.arange(dim)).reshape(len(cells), -1) + rows * patch[
        :, None
    ]
    full = np.array(
        [
            np.bincount(slot.ravel(), H[..., a].ravel(), minlength=n * rows)
            for a in range(H.shape[2])
        ]
    )
    return full.T.reshape(n, rows, -1), np.bincount(
        slot.ravel(), forces.ravel(), minlength=n * rows
    ).reshape(n, rows)


def _sum_of(patch: ndarray, n: int, values: ndarray) -> ndarray:
    """Return sums over the elements of each patch."""
    pick = csr_matrix((np.ones(len(patch)), (patch, np.arange(len(patch)))), shape=(n, len(patch)))
    return np.asarray(pick @ values.reshape(len(patch), -1)).reshape(n, *values.shape[1:])


def _inverse(A: ndarray) -> ndarray:
    """Return pseudoinverses: solutions have the least norm where a patch has too few points."""
    return np.linalg.pinv(A, rcond=1e-10, hermitian=True)


def _sources(
    form: SolidForm, mesh: RegionMesh, vertex: ndarray, incidence: csr_matrix
) -> csr_matrix:
    """Return the shares of patches in the value at a node, (n_nodes, n_patches).

    A vertex inside a region has its own patch. Patches of boundary nodes are one-sided: these
    nodes, and those between vertices, use the patches of inner vertices of their elements, or the
    largest patches.
    """
    grid = form.basis.mesh
    sides = mesh.region[:, None] * grid.nfacets + grid.t2f[:, form.elements].T
    _, first, count = np.unique(sides, return_index=True, return_counts=True)
    element, side = np.divmod(first[count == 1], sides.shape[1])
    inside = ~np.isin(vertex, mesh.cells[element[:, None], np.array(grid.elem.refdom.facets)[side]])
    score = np.where(inside, np.inf, incidence.getnnz(axis=1))
    near = (_incidence(mesh.cells, len(mesh.nodes)) @ incidence.T).tocoo()
    best = np.zeros(len(mesh.nodes))
    np.maximum.at(best, near.row, score[near.col])
    own = np.zeros(len(mesh.nodes), bool)
    own[vertex] = score == best[vertex]
    chosen = np.where(
        own[near.row], near.row == vertex[near.col], score[near.col] == best[near.row]
    )
    rows, columns = near.row[chosen], near.col[chosen]
    return coo_matrix((1.0 / np.bincount(rows)[rows], (rows, columns)), shape=near.shape).tocsr()


def _evaluated(
    fits: ndarray,
    coordinates: ndarray,
    center: ndarray,
    size: ndarray,
    sources: csr_matrix,
    degree: int,
) -> ndarray:
    """Return means of the fits of the sources at every node, (n_components, n_nodes)."""
    share = sources.tocoo()
    x = (coordinates[:, share.row] - center[:, share.col]) / size[share.col]
    at = np.einsum("sca,as,s->sc", fits[share.col], _powers(x, degree), share.data)
    return _sum_of(share.row, coordinates.shape[1], at).T
