"""What is known at the boundaries of ground through which water flows: heads, and faces where it may leave."""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components
from skfem import CellBasis

from ..errors import look_up, place

#: Head or pressure on a boundary: a number, or a function of places (dim, ...).
Given = float | Callable[[ndarray], ndarray]

#: Heads and heights that differ by less than this part of the model's size are the same.
_SAME = 1e-9


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
    mesh, faces = basis.mesh, (face,) if isinstance(face, str) else tuple(face)
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
                         f"{x[-1].min():.4g} up: no water stands there; name it in face= if water may leave")
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
                         f"{len(lost)} nodes: bodies that share no node need joints= or a head each")
