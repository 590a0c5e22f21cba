"""Meshes of several bodies, side by side without welding.

A *body* is a group of elements that shares no node with the rest of the mesh, so that contact alone
connects it with other bodies.  All bodies belong to one scikit-fem mesh, with one basis and one
vector of dofs.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from skfem import Mesh
from skfem.generic_utils import OrientedBoundary

from ..checks import look_up, names_of, tags_with
from .check import check_elements, check_topology, own_tags
from .connections import components

Indices = NDArray[np.integer]
Tags = dict[str, Indices]


def join_bodies(
    mesh: Mesh | Mapping[str, Mesh], bodies: Mapping[str, str | Collection[str]] | None = None
) -> Mesh:
    """Join bodies in one mesh without common nodes, with all tags and both sides of interfaces.

    **One mesh**, whose bodies share the nodes of their interfaces, as from Gmsh: `bodies` names the
    subdomains of every body.  Nodes on an interface are doubled, and elements keep their numbers.

    * Every body becomes a subdomain.
    * ``"a|b"`` is the side of body ``a`` that faces body ``b``, and ``"b|a"`` is the opposite one.
      Where body ``a`` consists of several subdomains, ``"clay|b"`` is the part that belongs to
      ``"clay"``.
    * A boundary on an interface is split by body: ``"skin"`` becomes ``"a:skin"`` and ``"b:skin"``.
       Other boundaries keep their names.

    Bodies that share no nodes remain unchanged: coordinates are never compared.

    **Several meshes** of one type: each becomes a subdomain of its name, which is the prefix of its
    own tags.  The boundary ``"top"`` of mesh ``a`` is then ``"a:top"``, its subdomain ``"clay"`` is
    ``"a:clay"``.

    Nodes without elements, such as centres of circles in a Gmsh file, and tags that begin with
    ``"gmsh:"`` are dropped.

    Parameters
    ----------
    mesh
        A mesh, or meshes by the names of their bodies: triangles, quadrilaterals, tetrahedra or
        hexahedra of first or second order.
    bodies
        For a single mesh: the name of every body, with the name or names of its subdomains.  By
        default the bodies are the connected parts of the mesh, named as by :func:`bodies`.

    Returns
    -------
    Mesh
        New mesh, with its nodes numbered body by body.  ``mesh1 + mesh2``, ``mesh1 @ mesh2`` and
        ``remove_duplicate_nodes`` would weld coincident nodes.

    Raises
    ------
    ValueError
        If the mesh is not fit for an analysis (see :func:`check_mesh`), a subdomain does not exist,
        an element belongs to no body or to two, or a name is not unique.

    Warnings
    --------
    Save the mesh with :func:`save_mesh` and load it with :func:`load_mesh`, also from files of
    ``Mesh.save``.  ``Mesh.load`` cuts names at their first colon, so that ``"a:left"`` and
    ``"a:top"`` become one boundary ``"a"``, without a message.

    See Also
    --------
    save_mesh : Save the mesh with all names.
    load_mesh : Load the mesh of a file with all names.

    Examples
    --------
    A plate of two layers, separated along its middle:

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
        wrong = [name for name in mesh if not isinstance(name, str)]
        if wrong:
            raise ValueError(f"bodies have names, not {wrong}")
        if bodies is not None:
            raise ValueError("bodies= is for a single mesh; of several meshes, each is one body")
        joined = _side_by_side(mesh)
    else:
        joined = _taken_apart(mesh, bodies)
    check_elements(joined)
    return joined


def bodies(mesh: Mesh) -> Tags:
    """Return names and elements of the bodies of a mesh, in the order of their first elements.

    A body has the name of the subdomain that consists of exactly its elements (the last of
    several), else the names of all subdomains with elements of the body, joined by "+", else
    "body".  Bodies of one name are numbered: "pile 1", "pile 2".

    Examples
    --------
    >>> from skfem import MeshTri
    >>> mesh = join_bodies({"base": MeshTri(), "block": MeshTri().translated((0, 1))})
    >>> bodies(mesh)
    {'base': array([0, 1]), 'block': array([2, 3])}
    """
    parts = _connected_elements(mesh)
    subdomains = own_tags(mesh.subdomains)
    names = [_name_of(part, subdomains) for part in parts]
    result: Tags = {}
    for k, (name, part) in enumerate(zip(names, parts, strict=True)):
        if names.count(name) > 1:
            name = f"{name} {names[:k].count(name) + 1}"
        result[name] = part
    return result


def _connected_elements(mesh: Mesh) -> list[Indices]:
    """Return the elements of every connected part."""
    label = components(mesh.t, mesh.nvertices)
    return [np.flatnonzero(label == k) for k in range(label.max() + 1)]


def _name_of(elements: Indices, subdomains: Tags) -> str:
    """Return the name of a body from the subdomains of its elements."""
    exact = ""
    for name, part in subdomains.items():
        if np.array_equal(np.unique(part), elements):
            exact = name
    return exact or "+".join(tags_with(elements, subdomains)) or "body"


def _side_by_side(meshes: Mapping[str, Mesh]) -> Mesh:
    """Join several meshes and prefix their tags with their names."""
    if not meshes:
        raise ValueError("there is no mesh to join")
    for part in meshes.values():
        check_topology(part)
    if len({type(part) for part in meshes.values()}) > 1:
        kinds = ", ".join(f"'{name}': {type(part).__name__}" for name, part in meshes.items())
        raise ValueError(f"meshes of different types cannot be joined ({kinds})")

    # Number the nodes of one mesh after those of another.
    counts = [part.nelements for part in meshes.values()]
    owner = np.repeat(np.arange(len(counts)), counts)
    mesh = renumbered(list(meshes.values()), owner)
    subdomains: Tags = {}
    boundaries: Tags = {}
    first = 0
    # Move the tags, with the name of the mesh before them.
    for name, part in meshes.items():
        _add(subdomains, name, np.arange(first, first + part.nelements))
        for tag, elements in own_tags(part.subdomains).items():
            _add(subdomains, f"{name}:{tag}", elements + first)
        for tag, facets in own_tags(part.boundaries).items():
            new = moved(part, mesh, facets, owners_of(part, facets), first)
            _add(boundaries, f"{name}:{tag}", new)
        first += part.nelements
    return replace(mesh, _boundaries=boundaries, _subdomains=subdomains)


def _taken_apart(mesh: Mesh, groups: Mapping[str, str | Collection[str]] | None) -> Mesh:
    """Separate the bodies of a mesh."""
    check_topology(mesh)
    if groups is None:
        parts = _separate_parts(mesh)
    else:
        parts = _grouped(mesh, groups)
    body = _body_of_elements(mesh, parts)
    apart = renumbered([mesh], body)
    subdomains = own_tags(mesh.subdomains)
    for name, elements in parts.items():
        if name in subdomains and not np.array_equal(np.unique(subdomains[name]), elements):
            raise ValueError(
                f"body '{name}' is not the subdomain '{name}'; choose another name for it"
            )
        subdomains[name] = elements
    boundaries = _split_boundaries(mesh, apart, body, list(parts))
    return replace(apart, _boundaries=boundaries, _subdomains=subdomains)


def _separate_parts(mesh: Mesh) -> Tags:
    """Return the connected parts, which must be more than one."""
    parts = bodies(mesh)
    if len(parts) == 1:
        raise ValueError(
            "the mesh is one connected body; name the subdomains of every body, bodies={'name': "
            f"[...]}}; existing: {', '.join(own_tags(mesh.subdomains)) or 'none at all'}"
        )
    return parts


def _grouped(mesh: Mesh, groups: Mapping[str, str | Collection[str]]) -> Tags:
    """Return the elements of every body from the names of its subdomains."""
    subdomains = own_tags(mesh.subdomains)
    parts = {}
    for name, members in groups.items():
        elements = [look_up(member, subdomains, "subdomain") for member in names_of(members)]
        if sum(map(len, elements)) == 0:
            raise ValueError(f"body '{name}' has no elements")
        parts[name] = np.unique(np.concatenate(elements))
    return parts


def _body_of_elements(mesh: Mesh, parts: Tags) -> Indices:
    """Return the number of the one body of every element."""
    names = list(parts)
    body = np.full(mesh.nelements, -1)
    # Give each element its body.
    for k, elements in enumerate(parts.values()):
        twice = elements[body[elements] >= 0]
        if len(twice):
            raise ValueError(
                f"{len(twice)} elements belong both to '{names[body[twice[0]]]}' and to "
                f"'{names[k]}' (element {twice[0]} is the first)"
            )
        body[elements] = k
    # Refuse elements without a body.
    missing = np.flatnonzero(body < 0)
    if len(missing):
        touched = tags_with(missing, own_tags(mesh.subdomains))
        raise ValueError(
            f"{len(missing)} elements belong to no body (element {missing[0]} is the first); add "
            f"their subdomains to bodies=: {', '.join(touched) or 'none, name them first'}"
        )
    return body


def renumbered(parts: Sequence[Mesh], body: Indices, copy: Indices | int = 0) -> Mesh:
    """Join meshes of one type without tags; every body and every copy of a node has own nodes.

    Nodes are sorted by body and keep their order within.  The corners of an element therefore keep
    their order, also where scikit-fem sorts them, and side `k` of an element remains its side `k`.
    """
    count = 0
    cells = []
    for part in parts:
        cells.append(part.t + count)
        count += part.nvertices
    corners = np.hstack(cells)
    key = (body * count + corners) * (np.max(copy) + 1) + copy
    t = np.unique(key, return_inverse=True)[1].reshape(corners.shape)
    # scikit-fem's validation refuses double nodes
    mesh = replace(
        parts[0],
        doflocs=np.zeros((parts[0].dim(), t.max() + 1)),
        t=t,
        validate=False,
        sort_t=all(part.sort_t for part in parts),
        _boundaries=None,
        _subdomains=None,
    )
    coordinates = [part.doflocs[:, part.dofs.element_dofs] for part in parts]
    doflocs = np.zeros((mesh.dim(), mesh.dofs.N))
    doflocs[:, mesh.dofs.element_dofs] = np.dstack(coordinates)
    return replace(mesh, doflocs=doflocs)


def _split_boundaries(mesh: Mesh, apart: Mesh, body: Indices, names: Sequence[str]) -> Tags:
    """Return the boundaries of a mesh with separated bodies, and both sides of every interface."""
    sides = np.append(body, -1)[mesh.f2t]  # the bodies on both sides of a facet; -1 is the outside
    between = np.flatnonzero((sides[0] != sides[1]) & (sides[1] >= 0))
    result: Tags = {}
    for tag, facets in own_tags(mesh.boundaries).items():
        owners = owners_of(mesh, facets)
        if not np.isin(facets, between).any():
            _add(result, tag, moved(mesh, apart, facets, owners))
            continue
        # Split a boundary on an interface by body
        numbers = np.asarray(facets)
        others = mesh.f2t[:, numbers].sum(axis=0) - owners
        for k, name in enumerate(names):
            part = (sides[:, numbers] == k).any(axis=0)
            if part.any():
                mine = np.where(body[owners] == k, owners, others)[part]
                _add(result, f"{name}:{tag}", moved(mesh, apart, facets[part], mine))

    # Name the sides of interfaces by bodies, and by subdomains of bodies that have several
    facets = np.tile(between, 2)
    owners = mesh.f2t[:, between].ravel()
    pairs = np.hstack((sides[:, between], sides[::-1, between]))
    for a, b in np.unique(pairs, axis=1).T:
        other = names[b]
        side = (pairs == [[a], [b]]).all(axis=0)
        _add(result, f"{names[a]}|{other}", moved(mesh, apart, facets[side], owners[side]))
        for tag, elements in own_tags(mesh.subdomains).items():
            part = side & np.isin(owners, elements)
            if part.any() and (part != side).any() and f"{tag}|{other}" not in result:
                _add(result, f"{tag}|{other}", moved(mesh, apart, facets[part], owners[part]))
    return result


def owners_of(mesh: Mesh, facets: Indices) -> Indices:
    """Return the elements from which the facets of a boundary are seen."""
    numbers = np.asarray(facets)
    first, second = mesh.f2t[:, numbers]
    if not isinstance(facets, OrientedBoundary):
        return first
    return np.where((second < 0) | (facets.ori == 0), first, second)


def moved(old: Mesh, new: Mesh, facets: Indices, owners: Indices, first: int = 0) -> Indices:
    """Return a boundary of a new mesh, whose elements `first + n` are the old elements `n`."""
    side = np.argmax(old.t2f[:, owners] == np.asarray(facets), axis=0)
    moved = new.t2f[side, owners + first]
    if isinstance(facets, OrientedBoundary):
        return OrientedBoundary(moved, new.f2t[0, moved] != owners + first)
    return moved


def _add(tags: Tags, name: str, part: Indices) -> None:
    """Add a tag under a new name."""
    if name in tags:
        raise ValueError(f"the name '{name}' is not unique; rename a body or a tag")
    tags[name] = part
