"""Meshes of several bodies: set them side by side without welding, take welded ones apart, and name them.

A *body* is a group of elements that shares no node with the rest of the mesh, so that only contact can hold
it. All bodies live in one scikit-fem mesh: one basis, one vector of unknowns.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from skfem import Mesh
from skfem.generic_utils import OrientedBoundary

from ..errors import look_up
from .check import check_mesh, check_topology, own_tags

Indices = NDArray[np.integer]
Tags = dict[str, Indices]


def join_bodies(
    mesh: Mesh | Mapping[str, Mesh], bodies: Mapping[str, str | Collection[str]] | None = None
) -> Mesh:
    """One mesh whose bodies share no node, with all tags kept and both sides of every interface named.

    **From one mesh** whose bodies are grown together along their interfaces, as Gmsh makes them: `bodies`
    says which subdomains make up a body. The nodes on an interface become double, one for each body that
    meets there.

    * Every body becomes a subdomain, beside the subdomains that are there.
    * ``"a|b"`` is the side of body ``a`` that faces body ``b``, and ``"b|a"`` is the opposite one.
    * A boundary that lies on an interface, wholly or in part, is split by body: ``"skin"`` becomes
      ``"a:skin"`` and ``"b:skin"``. All other boundaries keep their names.

    Bodies that are meshed apart already, with matching nodes or without, stay as they are: coordinates are
    never compared, nothing is welded, boundaries keep their names. Elements keep their numbers.

    **From several meshes** of the same type: a mesh becomes a subdomain of its name, and its own tags are
    prefixed with it. The boundary ``"top"`` of mesh ``a`` is then ``"a:top"``, its subdomain ``"clay"`` is
    ``"a:clay"``.

    Nodes that belong to no element, such as centres of circles in a Gmsh file, are dropped, and so are tags
    that begin with ``"gmsh:"``, Gmsh's bookkeeping that scikit-fem takes for a tag.

    Parameters
    ----------
    mesh
        A mesh, or meshes by the names of their bodies: triangles, quadrilaterals, tetrahedra or hexahedra of first or
        second order.
    bodies
        For a single mesh: the name of every body, and the name or names of its subdomains. Without it the
        bodies are the connected parts of the mesh, named as by :func:`bodies`; there must be more than one.

    Returns
    -------
    Mesh
        A new mesh, its nodes numbered body by body. Of scikit-fem's functions only those that weld coincident
        nodes must not be used on it: ``mesh1 + mesh2``, ``mesh1 @ mesh2`` and ``remove_duplicate_nodes``.
        Keep it with ``save_npz``: names that went through ``save`` and ``load`` end at their first colon.

    Raises
    ------
    ValueError
        If the mesh is not fit for an analysis (see :func:`check_mesh`), a subdomain does not exist, an
        element belongs to no body or to two, or a name would stand for two things.

    See Also
    --------
    load_mesh : Read a Gmsh file.

    Examples
    --------
    A plate of two layers, taken apart along its middle:

    >>> import numpy as np
    >>> from skfem import MeshQuad
    >>> plate = MeshQuad.init_tensor(np.linspace(0, 3, 4), np.linspace(0, 2, 3)).with_subdomains(
    ...     {"lower": lambda x: x[1] < 1, "upper": lambda x: x[1] > 1})
    >>> mesh = join_bodies(plate, bodies={"base": "lower", "cover": "upper"})
    >>> plate.p.shape[1], mesh.p.shape[1]
    (12, 16)
    >>> list(mesh.boundaries), len(mesh.boundaries["cover|base"])
    (['base|cover', 'cover|base'], 3)

    Two meshes that need not match:

    >>> block = MeshQuad.init_tensor(np.linspace(1, 2, 3), np.linspace(2, 3, 3)).with_defaults()
    >>> mesh = join_bodies({"base": plate, "block": block})
    >>> list(mesh.subdomains)
    ['base', 'base:lower', 'base:upper', 'block']
    >>> list(mesh.boundaries)
    ['block:left', 'block:bottom', 'block:right', 'block:top']
    """
    if isinstance(mesh, Mapping):
        if wrong := [name for name in mesh if not isinstance(name, str)]:
            raise ValueError(f"bodies have names, not {wrong}")
        if bodies is not None:
            raise ValueError("bodies= is for a single mesh; of several meshes, each is one body")
        joined = _side_by_side(mesh)
    else:
        joined = _taken_apart(mesh, bodies)
    check_mesh(joined)
    return joined


def bodies(mesh: Mesh) -> Tags:
    """The connected parts of a mesh: elements that share nodes, directly or through others, are one body.

    A body is named after the subdomain that consists of exactly its elements (the last, if there are
    several), else after all subdomains that it has elements of, joined by "+", else "body". If several bodies
    would get the same name, they are numbered: "pile 1", "pile 2".

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
    parts = _connected_elements(mesh)
    names = [_name_of(part, own_tags(mesh.subdomains)) for part in parts]
    count, seen = Counter(names), Counter[str]()
    result: Tags = {}
    for name, part in zip(names, parts):
        seen[name] += 1
        result[name if count[name] == 1 else f"{name} {seen[name]}"] = part
    return result


def _connected_elements(mesh: Mesh) -> list[Indices]:
    """The elements of every connected part."""
    n_corners, n_elements = mesh.t.shape
    element = np.tile(np.arange(n_elements), n_corners)
    size = n_elements + mesh.nvertices
    links = coo_matrix((np.ones(mesh.t.size), (element, n_elements + mesh.t.ravel())), shape=(size, size))
    label = connected_components(links, directed=False)[1][:n_elements]
    return [np.flatnonzero(label == k) for k in np.unique(label)]


def _name_of(elements: Indices, subdomains: Tags) -> str:
    """A name for some elements, from the subdomains that they are part of."""
    touched = {name: part for name, part in subdomains.items() if np.isin(part, elements).any()}
    exact = [name for name, part in touched.items() if np.array_equal(np.unique(part), elements)]
    return exact[-1] if exact else "+".join(touched) or "body"


def _side_by_side(meshes: Mapping[str, Mesh]) -> Mesh:
    """Several meshes in one, their tags prefixed with their names."""
    if not meshes:
        raise ValueError("there is no mesh to join")
    for part in meshes.values():
        check_topology(part)
    if len({type(part) for part in meshes.values()}) > 1:
        kinds = ", ".join(f"'{name}': {type(part).__name__}" for name, part in meshes.items())
        raise ValueError(f"meshes of different types cannot be joined ({kinds})")

    counts = [part.nelements for part in meshes.values()]
    mesh = _renumbered(list(meshes.values()), np.repeat(np.arange(len(counts)), counts))
    subdomains: Tags = {}
    boundaries: Tags = {}
    first = 0
    for name, part in meshes.items():
        _add(subdomains, name, np.arange(first, first + part.nelements))
        for tag, elements in own_tags(part.subdomains).items():
            _add(subdomains, f"{name}:{tag}", elements + first)
        for tag, facets in own_tags(part.boundaries).items():
            _add(boundaries, f"{name}:{tag}", _moved(part, mesh, facets, _owners(part, facets), first))
        first += part.nelements
    return replace(mesh, _boundaries=boundaries, _subdomains=subdomains)


def _taken_apart(mesh: Mesh, groups: Mapping[str, str | Collection[str]] | None) -> Mesh:
    """A mesh whose bodies have nodes of their own."""
    check_topology(mesh)
    parts = _separate_parts(mesh) if groups is None else _grouped(mesh, groups)
    body = _body_of_elements(mesh, parts)
    apart = _renumbered([mesh], body)
    subdomains = own_tags(mesh.subdomains)
    for name, elements in parts.items():
        if name in subdomains and not np.array_equal(np.unique(subdomains[name]), elements):
            raise ValueError(f"body '{name}' is not the subdomain '{name}'; choose another name for it")
        subdomains[name] = elements
    boundaries = _split_boundaries(mesh, apart, body, list(parts))
    return replace(apart, _boundaries=boundaries, _subdomains=subdomains)


def _separate_parts(mesh: Mesh) -> Tags:
    """The connected parts as bodies, if there is more than one."""
    parts = bodies(mesh)
    if len(parts) == 1:
        raise ValueError(
            "the mesh is one connected body; name the subdomains of every body, bodies={'name': [...]}; "
            f"existing: {', '.join(own_tags(mesh.subdomains)) or 'none at all'}"
        )
    return parts


def _grouped(mesh: Mesh, groups: Mapping[str, str | Collection[str]]) -> Tags:
    """The elements of every body from the names of its subdomains."""
    subdomains = own_tags(mesh.subdomains)
    parts = {}
    for name, members in groups.items():
        members = [members] if isinstance(members, str) else members
        elements = [look_up(member, subdomains, "subdomain") for member in members]
        if sum(map(len, elements)) == 0:
            raise ValueError(f"body '{name}' has no elements")
        parts[name] = np.unique(np.concatenate(elements))
    return parts


def _body_of_elements(mesh: Mesh, parts: Tags) -> Indices:
    """The number of every element's body; it must have exactly one."""
    names = list(parts)
    body = np.full(mesh.nelements, -1)
    for k, elements in enumerate(parts.values()):
        twice = elements[body[elements] >= 0]
        if len(twice):
            raise ValueError(
                f"{len(twice)} elements belong both to '{names[body[twice[0]]]}' and to '{names[k]}' "
                f"(element {twice[0]} is the first)"
            )
        body[elements] = k
    left = np.flatnonzero(body < 0)
    if len(left):
        tags = own_tags(mesh.subdomains)
        among = [name for name, elements in tags.items() if np.isin(elements, left).any()]
        raise ValueError(
            f"{len(left)} elements belong to no body (element {left[0]} is the first); add to bodies= the "
            f"subdomains they are in: {', '.join(among) or 'none, name them first'}"
        )
    return body


def _renumbered(parts: Sequence[Mesh], body: Indices) -> Mesh:
    """All elements of meshes of one type in one mesh, every body with nodes of its own, without tags.

    Nodes are sorted by body and keep their order within, so the corners of an element remain in the same
    order even in meshes where scikit-fem sorts them, and side `k` of an element remains its side `k`.
    """
    offset = np.cumsum([0] + [part.nvertices for part in parts])
    corners = np.hstack([part.t + start for part, start in zip(parts, offset)])
    t = np.unique(body * offset[-1] + corners, return_inverse=True)[1].reshape(corners.shape)
    mesh = replace(
        parts[0],
        doflocs=np.zeros((parts[0].dim(), t.max() + 1)),
        t=t,
        sort_t=all(part.sort_t for part in parts),
        validate=False,  # scikit-fem's validation takes double nodes for a mistake
        _boundaries=None,
        _subdomains=None,
    )
    doflocs = np.zeros((mesh.dim(), mesh.dofs.N))
    doflocs[:, mesh.dofs.element_dofs] = np.concatenate(
        [part.doflocs[:, part.dofs.element_dofs] for part in parts], axis=2
    )
    return replace(mesh, doflocs=doflocs)


def _split_boundaries(mesh: Mesh, apart: Mesh, body: Indices, names: Sequence[str]) -> Tags:
    """The boundaries of a mesh that was taken apart, and both sides of every interface."""
    sides = np.append(body, -1)[mesh.f2t]  # the bodies on both sides of a facet; -1 is the outside
    between = np.flatnonzero((sides[0] != sides[1]) & (sides[1] >= 0))
    result: Tags = {}
    for tag, facets in own_tags(mesh.boundaries).items():
        owners = _owners(mesh, facets)
        if not np.isin(facets, between).any():
            _add(result, tag, _moved(mesh, apart, facets, owners))
            continue
        others = mesh.f2t[:, np.asarray(facets)].sum(axis=0) - owners
        for k, name in enumerate(names):
            here = (sides[:, np.asarray(facets)] == k).any(axis=0)
            if here.any():
                mine = np.where(body[owners] == k, owners, others)[here]
                _add(result, f"{name}:{tag}", _moved(mesh, apart, facets[here], mine))

    facets, owners = np.tile(between, 2), mesh.f2t[:, between].ravel()
    pairs = np.hstack((sides[:, between], sides[::-1, between]))
    for a, b in np.unique(pairs, axis=1).T:
        here = (pairs == [[a], [b]]).all(axis=0)
        _add(result, f"{names[a]}|{names[b]}", _moved(mesh, apart, facets[here], owners[here]))
    return result


def _owners(mesh: Mesh, facets: Indices) -> Indices:
    """The elements that a boundary's facets are seen from: on the outer boundary, the only ones there are."""
    side = facets.ori if isinstance(facets, OrientedBoundary) else 0
    facets = np.asarray(facets)
    return np.where(mesh.f2t[1, facets] < 0, mesh.f2t[0, facets], mesh.f2t[side, facets])


def _moved(old: Mesh, new: Mesh, facets: Indices, owners: Indices, first: int = 0) -> Indices:
    """A boundary in the new mesh, whose element `first + n` has the corners of the old element `n`."""
    side = np.argmax(old.t2f[:, owners] == np.asarray(facets), axis=0)
    moved = new.t2f[side, owners + first]
    if isinstance(facets, OrientedBoundary):
        return OrientedBoundary(moved, new.f2t[0, moved] != owners + first)
    return moved


def _add(tags: Tags, name: str, part: Indices) -> None:
    """Put a tag under a name that must be new."""
    if name in tags:
        raise ValueError(f"the name '{name}' would stand for two things; rename a body or a tag")
    tags[name] = part
