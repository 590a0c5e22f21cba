"""Meshes of several bodies: set them side by side without welding, take welded ones apart, and name them.

A *body* is a group of elements that shares no node with the rest of the mesh, so that contact alone can hold it. All
bodies live in one scikit-fem mesh: one basis, one vector of unknowns.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from skfem import Mesh
from skfem.generic_utils import OrientedBoundary

from .mesh_check import check_mesh, check_topology

Indices = NDArray[np.integer]
Tags = dict[str, Indices]


def join_bodies(mesh: Mesh | Mapping[str, Mesh], bodies: Mapping[str, str | Collection[str]] | None = None) -> Mesh:
    """One mesh whose bodies share no node, with all tags kept and every body's side of an interface named.

    **From one mesh** (a Gmsh file, say) whose bodies are grown together along their interfaces, `bodies` says which
    subdomains make up a body. The nodes on the interfaces become double: one for each body that meets there. Then

    * every body is a subdomain of its own name, beside the subdomains that were there;
    * ``"a|b"`` is the side of body ``a`` that faces body ``b``, and ``"b|a"`` the opposite one;
    * a boundary of the file that lies, wholly or in part, on an interface is split by body: ``"skin"`` becomes
      ``"a:skin"`` and ``"b:skin"``. All other boundaries keep their names.

    Bodies that are meshed apart already, with matching nodes or without, stay as they are: nothing is welded, no
    coordinates are compared, and their boundaries keep their names. Elements keep their numbers.

    **From several meshes** of the same type, ``{"a": mesh, "b": mesh}``, all elements of a mesh become the subdomain
    of its name, and its own tags are prefixed with it: the boundary ``"top"`` of mesh ``a`` is ``"a:top"``, its
    subdomain ``"clay"`` is ``"a:clay"``.

    Nodes that belong to no element, like the centres of circles in a Gmsh file, are dropped; so are tags that begin
    with ``"gmsh:"``, which scikit-fem makes from Gmsh's bookkeeping.

    Parameters
    ----------
    mesh
        A mesh, or several by the names of their bodies: triangles or quadrilaterals, of first or second order.
    bodies
        For a single mesh: the name of every body, and the name or names of its subdomains. Without it the bodies are
        the connected parts of the mesh, named as by :func:`bodies`; there must be more than one.

    Returns
    -------
    Mesh
        A new mesh; nodes are numbered body by body. Use it like any other, but not with ``mesh1 + mesh2``,
        ``mesh1 @ mesh2`` or ``remove_duplicate_nodes``, which weld coincident nodes.

    Raises
    ------
    ValueError
        If the mesh is not fit for an analysis (see :func:`check_mesh`), a subdomain does not exist, an element
        belongs to no body or to two, or a name would stand for two things.

    Examples
    --------
    A plate of two layers, taken apart along its middle:

    >>> import numpy as np
    >>> from skfem import MeshQuad
    >>> grid = MeshQuad.init_tensor(np.linspace(0, 3, 4), np.linspace(0, 2, 3)).with_subdomains(
    ...     {"lower": lambda x: x[1] < 1, "upper": lambda x: x[1] > 1})
    >>> mesh = join_bodies(grid, bodies={"base": "lower", "cover": "upper"})
    >>> grid.p.shape[1], mesh.p.shape[1]
    (12, 16)
    >>> list(mesh.boundaries), len(mesh.boundaries["cover|base"])
    (['base|cover', 'cover|base'], 3)

    Two meshes that need not match:

    >>> block = MeshQuad.init_tensor(np.linspace(1, 2, 3), np.linspace(2, 3, 3)).with_defaults()
    >>> mesh = join_bodies({"base": grid, "block": block})
    >>> list(mesh.subdomains)
    ['base', 'base:lower', 'base:upper', 'block']
    >>> list(mesh.boundaries)
    ['block:left', 'block:bottom', 'block:right', 'block:top']
    """
    if isinstance(mesh, Mapping):
        if bodies is not None:
            raise ValueError("bodies= splits a single mesh; several meshes are one body each, named by their keys")
        joined = _side_by_side(mesh)
    else:
        joined = _taken_apart(mesh, bodies)
    check_mesh(joined)
    return joined


def bodies(mesh: Mesh) -> dict[str, Indices]:
    """The connected parts of a mesh: what shares a node, directly or through others, is one body.

    A body is named after the subdomain that consists of exactly its elements (the latest, if there are several), else
    after all subdomains that it contains elements of, joined by "+", else "body". Where bodies would have the same
    name they are numbered: "pile 1", "pile 2".

    Parameters
    ----------
    mesh
        Any scikit-fem mesh.

    Returns
    -------
    dict
        Name and element numbers of every body, in the order of their first elements.

    Examples
    --------
    >>> from skfem import MeshTri
    >>> mesh = join_bodies({"base": MeshTri(), "block": MeshTri().translated((0, 1))})
    >>> bodies(mesh)
    {'base': array([0, 1]), 'block': array([2, 3])}
    """
    n_corners, n_elements = mesh.t.shape
    element = np.tile(np.arange(n_elements), n_corners)
    incidence = coo_matrix((np.ones(mesh.t.size), (element, mesh.t.ravel()))).tocsr()
    _, label = connected_components(incidence @ incidence.T, directed=False)
    parts = [np.flatnonzero(label == k) for k in range(label.max() + 1)]
    names = [_name_of(part, mesh.subdomains or {}) for part in parts]
    repeated = {name for name, count in Counter(names).items() if count > 1}
    seen: Counter[str] = Counter()
    result = {}
    for name, part in zip(names, parts, strict=True):
        seen[name] += 1
        result[f"{name} {seen[name]}" if name in repeated else name] = part
    return result


def _name_of(elements: Indices, subdomains: Mapping[str, Indices]) -> str:
    """A name for some elements from the subdomains that cover them."""
    inside = {name: part for name, part in _own(subdomains).items() if np.isin(part, elements).any()}
    exact = [name for name, part in inside.items() if np.array_equal(np.unique(part), elements)]
    return exact[-1] if exact else "+".join(inside) or "body"


def _own(tags: Mapping[str, Indices] | None) -> Tags:
    """The user's tags, without Gmsh's bookkeeping that scikit-fem takes for a tag."""
    return {name: part for name, part in (tags or {}).items() if not name.startswith("gmsh:")}


def _side_by_side(meshes: Mapping[str, Mesh]) -> Mesh:
    """Several meshes in one, their tags prefixed with their names."""
    if not meshes:
        raise ValueError("join_bodies needs a mesh, or at least one in a dictionary of meshes")
    for part in meshes.values():
        check_topology(part)
    if len({type(part) for part in meshes.values()}) > 1:
        kinds = ", ".join(f"{name!r}: {type(part).__name__}" for name, part in meshes.items())
        raise ValueError(f"meshes of different types cannot be joined: {kinds}")

    counts = [part.nelements for part in meshes.values()]
    mesh = _renumbered(list(meshes.values()), np.repeat(np.arange(len(counts)), counts))
    subdomains: Tags = {}
    boundaries: Tags = {}
    first = 0
    for name, part in meshes.items():
        _add(subdomains, name, np.arange(first, first + part.nelements))
        for tag, elements in _own(part.subdomains).items():
            _add(subdomains, f"{name}:{tag}", elements + first)
        for tag, facets in _own(part.boundaries).items():
            _add(boundaries, f"{name}:{tag}", _moved(part, mesh, facets, _owners(part, facets), first))
        first += part.nelements
    return replace(mesh, _boundaries=boundaries, _subdomains=subdomains)


def _taken_apart(mesh: Mesh, groups: Mapping[str, str | Collection[str]] | None) -> Mesh:
    """A mesh without the nodes that its bodies share."""
    check_topology(mesh)
    parts = _connected(mesh) if groups is None else _grouped(mesh, groups)
    body = _body_of_elements(mesh, parts)
    apart = _renumbered([mesh], body)
    subdomains = _own(mesh.subdomains)
    for name, elements in parts.items():
        if name in subdomains and not np.array_equal(np.unique(subdomains[name]), np.unique(elements)):
            raise ValueError(f"body {name!r} would replace the subdomain {name!r}, which has other elements")
        subdomains[name] = elements
    return replace(apart, _boundaries=_split_boundaries(mesh, apart, body, list(parts)), _subdomains=subdomains)


def _connected(mesh: Mesh) -> Tags:
    """The connected parts as bodies."""
    parts = bodies(mesh)
    if len(parts) == 1:
        raise ValueError(
            "the mesh is one connected body: say which subdomains are to be taken apart, as in "
            f"bodies={{'name': ['subdomain', ...], ...}}; {_listing(mesh)}"
        )
    return parts


def _grouped(mesh: Mesh, groups: Mapping[str, str | Collection[str]]) -> Tags:
    """The subdomains of every body put together."""
    subdomains = _own(mesh.subdomains)
    parts = {}
    for body, members in groups.items():
        members = [members] if isinstance(members, str) else list(members)
        unknown = [name for name in members if name not in subdomains]
        if unknown or not members:
            what = f"unknown subdomain {unknown[0]!r}" if unknown else "no subdomain"
            raise ValueError(f"{what} in body {body!r}; {_listing(mesh)}")
        parts[body] = np.unique(np.concatenate([subdomains[name] for name in members]))
    return parts


def _listing(mesh: Mesh) -> str:
    return "the mesh has the subdomains " + (", ".join(map(repr, _own(mesh.subdomains))) or "(none)")


def _body_of_elements(mesh: Mesh, parts: Mapping[str, Indices]) -> Indices:
    """The number of the body of every element; every element must have exactly one."""
    names = list(parts)
    body = np.full(mesh.nelements, -1)
    for k, elements in enumerate(parts.values()):
        taken = elements[body[elements] >= 0]
        if len(taken):
            raise ValueError(f"element {taken[0]} belongs to two bodies, {names[body[taken[0]]]!r} and {names[k]!r}")
        body[elements] = k
    if (body < 0).any():
        raise ValueError(
            f"{np.sum(body < 0)} elements belong to no body (the first is element {np.argmax(body < 0)}); "
            f"bodies= must cover the whole mesh; {_listing(mesh)}"
        )
    return body


def _renumbered(parts: list[Mesh], body: Indices) -> Mesh:
    """All elements of meshes of one type in one mesh, with nodes of their own for every body, and no tags.

    Nodes are sorted by body and keep their order within, so an element's corners keep their order even where
    scikit-fem sorts them: side `k` of an element remains its side `k`.
    """
    first = np.cumsum([0] + [part.nvertices for part in parts])
    corners = np.hstack([part.t + shift for part, shift in zip(parts, first, strict=False)])
    _, t = np.unique(body * first[-1] + corners, return_inverse=True)
    t = t.reshape(corners.shape)
    mesh = replace(
        parts[0],
        doflocs=np.zeros((2, t.max() + 1)),
        t=t,
        sort_t=all(part.sort_t for part in parts),
        validate=False,  # scikit-fem's validation takes double nodes for a mistake
        _boundaries=None,
        _subdomains=None,
    )
    doflocs = np.zeros((2, mesh.dofs.N))
    doflocs[:, mesh.dofs.element_dofs] = np.concatenate(
        [part.doflocs[:, part.dofs.element_dofs] for part in parts], axis=2
    )
    return replace(mesh, doflocs=doflocs)


def _split_boundaries(mesh: Mesh, apart: Mesh, body: Indices, names: list[str]) -> Tags:
    """The boundaries of a mesh whose bodies have been taken apart, and both sides of every interface."""
    body = np.append(body, -1)  # f2t has -1 where there is no second element
    sides = body[mesh.f2t]
    interface = (sides >= 0).all(axis=0) & (sides[0] != sides[1])
    result: Tags = {}
    for name, facets in _own(mesh.boundaries).items():
        owners = _owners(mesh, facets)
        if not interface[facets].any():
            _add(result, name, _moved(mesh, apart, facets, owners))
            continue
        for k in np.unique(sides[:, facets][sides[:, facets] >= 0]):
            mine = (sides[:, facets] == k).any(axis=0)
            inner = np.where(body[mesh.f2t[0, facets]] == k, *mesh.f2t[:, facets])
            owner = np.where(interface[facets], inner, owners)
            _add(result, f"{names[k]}:{name}", _moved(mesh, apart, facets, owner, keep=mine))
    found = np.flatnonzero(interface)
    for a, b in np.unique(np.hstack((sides[:, found], sides[::-1, found])), axis=1).T:
        here = found[((sides[:, found] == [[a], [b]]) | (sides[:, found] == [[b], [a]])).all(axis=0)]
        owner = np.where(sides[0, here] == a, *mesh.f2t[:, here])
        _add(result, f"{names[a]}|{names[b]}", _moved(mesh, apart, here, owner))
    return result


def _owners(mesh: Mesh, facets: Indices) -> Indices:
    """The element that a boundary's facets are seen from."""
    side = facets.ori if isinstance(facets, OrientedBoundary) else 0
    return mesh.f2t[side, np.asarray(facets)]


def _moved(
    old: Mesh, new: Mesh, facets: Indices, owners: Indices, first: int = 0, keep: NDArray[np.bool_] | None = None
) -> Indices:
    """A boundary's facets in the new mesh, whose element `first + n` has the corners of the old element n."""
    keep = np.ones(len(facets), dtype=bool) if keep is None else keep
    chosen, owners = np.asarray(facets)[keep], owners[keep]
    side = np.argmax(old.t2f[:, owners] == chosen, axis=0)
    moved = new.t2f[side, owners + first]
    if isinstance(facets, OrientedBoundary):
        return OrientedBoundary(moved, new.f2t[0, moved] != owners + first)
    return moved


def _add(tags: Tags, name: str, part: Indices) -> None:
    """Put a tag under a name that must be new."""
    if name in tags:
        raise ValueError(f"the name {name!r} would stand for two things; rename a body or a tag of the mesh")
    tags[name] = part
