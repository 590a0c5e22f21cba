r"""Fields at nodes from values at integration points, region by region.

Stresses of linear elements are recovered from the forces of their nodes: Boroomand and Zienkiewicz
(Int. J. Numer. Methods Eng. 40 (1997) 137-164), recovery by equilibrium in patches. Around every
vertex a linear field
:math:`\sigma^*` is sought whose nodal forces equal the forces of the elements,

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

#: Weight beta of the stresses relative to the forces, by the order of the elements and whether
#: they are triangles or tetrahedra. Fibre of a beam of one to four layers, largest error for
#: weights of .007, .1, .3 and 1: four-node elements 1.3, 4.5, 9 and 13 % (below .007, one-sided
#: patches at corners lose digits); six-node triangles 2.1, 1.4, .9 and .3 %; three-node ones, of
#: three and four layers, 15, 9, 5 and 11 %.
_BETA = {(1, False): 0.007, (1, True): 0.3, (2, False): 1.0, (2, True): 1.0}
#: Residual of a projection, as a share.
_PROJECTED = 1e-12
#: Patches that are fitted at a time.
_CHUNK = 500


class RegionMesh(NamedTuple):
    """Nodes and elements of the regions of solids; both regions of a border have its nodes."""

    nodes: ndarray  # region after region, (n,)
    cells: ndarray  # positions in `nodes`, (n_elements, k)
    region: ndarray  # of every element, counted through all solids


def element_regions(*forms: SolidForm) -> ndarray:
    """Return the region of every element, counted through all solids."""
    sizes = []
    for form in forms:
        elements = range(form.basis.nelems)
        sizes += [len(elements[region.elements]) for region in form.regions]
    return np.repeat(np.arange(len(sizes)), sizes)


def region_mesh(*forms: SolidForm) -> RegionMesh:
    """Return the regions of some solids on one mesh."""
    numbers = np.concatenate([nodes(form.basis) for form in forms])
    region = element_regions(*forms)
    n = int(numbers.max()) + 1
    keys, cells = np.unique(region[:, None] * n + numbers, return_inverse=True)
    return RegionMesh(keys % n, cells.reshape(numbers.shape), region)


def recovered(
    form: SolidForm,
    values: ndarray,
    *,
    balanced: bool = False,
    limited: bool = False,
    elements: ndarray | None = None,
) -> ndarray:
    """Return values at the nodes of the :func:`region_mesh`, (n_components, n), from points.

    Balanced values are stresses, whose nodal forces count. Limited values stay within the range of
    the elements nearby. Where some elements are given, (k,), only their nodes have values.
    """
    mesh = region_mesh(form)
    wanted = None
    if elements is not None:
        wanted = np.unique(mesh.cells[elements])
    n_stresses = len(values) if balanced else 0
    nodal = _fitted(form, values, mesh, n_stresses, wanted)
    if limited:
        return within_points(nodal, values, mesh)
    return nodal


def recovered_together(
    form: SolidForm, stress: ndarray, *others: ndarray, balanced: bool
) -> list[ndarray]:
    """Return stresses and other fields at the nodes as :func:`recovered` does, in one pass.

    Only stresses may be balanced.
    """
    fields = (stress, *others)
    ends = np.cumsum([len(values) for values in fields])
    mesh = region_mesh(form)
    n_stresses = len(stress) if balanced else 0
    nodal = _fitted(form, np.concatenate(fields), mesh, n_stresses)
    return np.split(nodal, ends[:-1])


def projected(form: SolidForm, values: ndarray) -> tuple[csr_matrix, ndarray, ndarray]:
    """Project values at points on linear functions of each region: M c = integral of N f.

    Parameters
    ----------
    form
        Solid whose integration points have the values.
    values
        Values f, (n_components, n_elements, n_points).

    Returns
    -------
    N, vertex, c
        Functions at the points, (n_elements * n_points, n_vertices), vertices of the elements,
        and values at the vertices, (n_vertices, n_components).
    """
    # Evaluate the functions of all elements at the points.
    corners = len(form.basis.mesh.t)
    element = linear_element(form.basis.mesh)
    linear = form.basis.with_element(element).basis
    columns = [np.broadcast_to(shape, form.weight.shape) for (shape,) in linear]
    shapes = np.stack(columns, axis=2)  # (n_elements, n_points, corners)

    # Number the vertices region by region.
    cells = region_mesh(form).cells[:, :corners]
    _, vertex = np.unique(cells, return_inverse=True)
    vertex = vertex.reshape(-1, corners)
    indices = np.broadcast_to(vertex[:, None], shapes.shape).ravel()
    rows = np.arange(0, shapes.size + 1, corners)
    N = csr_matrix((shapes.ravel(), indices, rows))

    # Solve; the condition of the scaled mass is 5 on any mesh (A. J. Wathen 1987).
    weighted = csr_matrix(N.multiply(form.weight.reshape(-1, 1))).T
    mass = csr_matrix(weighted @ N)
    scale = diags_array(1.0 / mass.diagonal())
    c = []
    for f in values:
        solution, _ = cg(mass, weighted @ f.ravel(), rtol=_PROJECTED, M=scale)
        c.append(solution)
    return N, vertex, np.column_stack(c)


def within_points(nodal: ndarray, values: ndarray, mesh: RegionMesh) -> ndarray:
    """Clip values at nodes to the range of the points around each of them."""
    low = np.full_like(nodal, np.inf)
    high = np.full_like(nodal, -np.inf)
    for c, part in enumerate(values):
        smallest = part.min(axis=1)
        largest = part.max(axis=1)
        np.minimum.at(low[c], mesh.cells, smallest[:, None])
        np.maximum.at(high[c], mesh.cells, largest[:, None])
    return np.clip(nodal, low, high)


def _fitted(
    form: SolidForm,
    values: ndarray,
    mesh: RegionMesh,
    balanced: int,
    wanted: ndarray | None = None,
) -> ndarray:
    """Fit polynomials around the vertices, and evaluate them at the nodes, (n_components, n).

    Only the patches of wanted nodes are fitted. As many components as are balanced, the first ones,
    are stresses with their forces.

    With the terms p of the polynomials, fits c of a patch minimise

        |H c - f|^2 + beta (c^T M c - 2 r^T c),  M = sum p p^T w,  r = sum sigma_h p w,

    with nodal forces H c of the fit and f of the elements; without forces M c = r.
    """
    # Number the patches, and find their elements, centres and sizes.
    basis = form.basis
    cells = mesh.cells
    dim = basis.mesh.dim()
    corners = basis.mesh.t.shape[0]
    vertex = np.unique(cells[:, :corners])
    incidence = _incidence(cells, len(mesh.nodes))[vertex]
    sources = _sources(form, mesh, vertex, incidence)
    patches = np.arange(len(vertex))
    if wanted is not None:
        patches = np.unique(sources[wanted].indices)
    coordinates = np.asarray(basis.doflocs[:, dim * mesh.nodes])
    center = coordinates[:, vertex]
    volume = np.asarray(basis.dx).sum(axis=1)
    size = np.asarray(incidence @ volume) ** (1.0 / dim)
    points = np.asarray(basis.global_coordinates())

    # Prepare the polynomials, the forces and the strain operator.
    degree = 1
    if cells.shape[1] > corners:
        degree = 2
    simplices = corners == dim + 1
    beta = _BETA[degree, simplices]
    origin = np.zeros((dim, 1))
    m = len(_powers(origin, degree))
    nc = balanced
    if balanced:
        metric = np.repeat([1.0, 2.0], [3, nc - 3])  # of |sigma|^2: shear stresses count twice
        every = np.arange(basis.nelems)
        forces = form.element_forces(values[:nc], every).T
        B = strain_operator(form.basis, "full", str(form.coordinates)).B

    fits = np.zeros((len(vertex), len(values), m))  # (n_patches, n_components, terms)
    for start in range(0, len(patches), _CHUNK):
        # Collect pairs of patches and elements, and weights relative to the patch.
        part = patches[start : start + _CHUNK]
        chunk = incidence[part]
        n = chunk.shape[0]
        patch = np.repeat(np.arange(n), np.diff(chunk.indptr))
        e = chunk.indices
        about = part[patch]
        scale = size[about, None]
        offset = points[:, e] - center[:, about, None]
        p = _powers(offset / scale, degree).transpose(1, 2, 0)  # (pairs, points, terms)
        total = np.bincount(patch, form.weight[e].sum(axis=1))
        w = form.weight[e] / total[patch][:, None]

        # Fit component by component without forces.
        products = np.einsum("pqa,pqb,pq->pab", p, p, w)
        M = _sum_of(patch, n, products)
        moments = np.einsum("cpq,pqa,pq->pca", values[:, e], p, w)
        r = _sum_of(patch, n, moments)
        if nc < len(values):
            fits[part, nc:] = r[:, nc:] @ _inverse(M)
        if not balanced:
            continue

        # Fit all stresses together with forces.
        scaled = w * scale
        of_elements = forces[e] * (scaled / form.weight[e])[:, :1]
        H, f = _balance(patch, cells[e], B[e], p, scaled, of_elements)
        M = np.einsum("cd,pab->pcadb", np.diag(metric), M)
        M = M.reshape(n, nc * m, nc * m)
        A = H.transpose(0, 2, 1) @ H + beta * M
        r = metric[:, None] * r[:, :nc]
        b = np.einsum("pra,pr->pa", H, f) + beta * r.reshape(n, -1)
        c = np.einsum("pab,pb->pa", _inverse(A), b)
        fits[part, :nc] = c.reshape(-1, nc, m)
    return _evaluated(fits, coordinates, center, size, sources, degree)


def _powers(x: ndarray, degree: int) -> ndarray:
    """Return the terms, (m, ...), of complete polynomials of coordinates (dim, ...)."""
    terms = [np.ones((1, *x.shape[1:])), x]
    if degree == 2:
        i, j = np.triu_indices(len(x))
        terms.append(x[i] * x[j])
    return np.concatenate(terms)


def _incidence(cells: ndarray, n: int) -> csr_matrix:
    """Return the incidence of nodes and elements, (n, n_elements)."""
    rows = cells.ravel()
    columns = np.repeat(np.arange(len(cells)), cells.shape[1])
    shape = (n, len(cells))
    ones = np.ones(len(rows))
    return coo_matrix((ones, (rows, columns)), shape=shape).tocsr()


def _balance(
    patch: ndarray,
    cells: ndarray,
    B: ndarray,
    p: ndarray,
    w: ndarray,
    forces: ndarray,
) -> tuple[ndarray, ndarray]:
    """Return nodal forces of fits, (patches, rows, nc m), and of elements, (patches, rows)."""
    dim = forces.shape[1] // cells.shape[1]
    H = np.einsum("pqci,pqa,pq->pica", B, p, w, optimize=True)  # (pairs, forces, nc, m)
    H = H.reshape(*H.shape[:2], -1)

    # Number the nodes of each patch from zero; the nodes of a patch follow each other.
    n_nodes = cells.max() + 1
    every = patch[:, None] * n_nodes + cells
    keys, number = np.unique(every, return_inverse=True)
    owner = keys // n_nodes
    n = owner[-1] + 1
    first = np.searchsorted(owner, np.arange(n + 1))
    in_patch = np.arange(len(keys)) - first[owner]
    position = in_patch[number.reshape(cells.shape)]

    # Sum the forces of the elements at each node.
    rows = int(np.diff(first).max()) * dim
    row = dim * position[:, :, None] + np.arange(dim)  # (pairs, nodes, dim)
    slots = row.reshape(len(cells), -1) + rows * patch[:, None]
    slot = slots.ravel()
    size = n * rows
    columns = []
    for part in np.moveaxis(H, 2, 0):
        columns.append(np.bincount(slot, part.ravel(), minlength=size))
    H = np.array(columns).T.reshape(n, rows, -1)
    f = np.bincount(slot, forces.ravel(), minlength=size)
    return H, f.reshape(n, rows)


def _sum_of(patch: ndarray, n: int, values: ndarray) -> ndarray:
    """Return sums over the elements of each patch."""
    pairs = len(patch)
    ones = np.ones(pairs)
    pick = csr_matrix((ones, (patch, np.arange(pairs))), shape=(n, pairs))
    sums = np.asarray(pick @ values.reshape(pairs, -1))
    return sums.reshape(n, *values.shape[1:])


def _inverse(A: ndarray) -> ndarray:
    """Return pseudoinverses: solutions have the least norm where a patch has too few points."""
    return np.linalg.pinv(A, rcond=1e-10, hermitian=True)


def _sources(
    form: SolidForm,
    mesh: RegionMesh,
    vertex: ndarray,
    incidence: csr_matrix,
) -> csr_matrix:
    """Return the shares of patches in the value at a node, (n_nodes, n_patches).

    A vertex inside a region has its own patch. Patches of boundary nodes are one-sided: these
    nodes, and those between vertices, use the patches of inner vertices of their elements, or the
    largest patches.
    """
    # Find the vertices inside of regions: sides on their boundaries belong to one element.
    grid = form.basis.mesh
    facets = grid.t2f[:, form.elements].T
    sides = mesh.region[:, None] * grid.nfacets + facets
    _, first, count = np.unique(sides, return_index=True, return_counts=True)
    element, side = np.divmod(first[count == 1], sides.shape[1])
    positions = np.array(grid.elem.refdom.facets)[side]
    boundary = mesh.cells[element[:, None], positions]
    inside = ~np.isin(vertex, boundary)

    # Find the best patches of the elements of each node: inside, or with most elements.
    score = np.where(inside, np.inf, incidence.getnnz(axis=1))
    n = len(mesh.nodes)
    near = (_incidence(mesh.cells, n) @ incidence.T).tocoo()
    node = near.row
    patch = near.col
    best = np.zeros(n)
    np.maximum.at(best, node, score[patch])

    # Take the own patch of a vertex if it is one of the best, otherwise all of the best.
    has_own = np.zeros(n, bool)
    has_own[vertex] = score == best[vertex]
    is_own = node == vertex[patch]
    is_best = score[patch] == best[node]
    chosen = np.where(has_own[node], is_own, is_best)
    rows = node[chosen]
    shares = 1.0 / np.bincount(rows)[rows]
    return coo_matrix((shares, (rows, patch[chosen])), shape=near.shape).tocsr()


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
    values = np.einsum("sca,as,s->sc", fits[share.col], _powers(x, degree), share.data)
    return _sum_of(share.row, coordinates.shape[1], values).T
