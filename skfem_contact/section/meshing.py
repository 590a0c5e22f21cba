"""Mesh of a section: Gmsh's triangles as a mesh of scikit-fem, with the names of areas, lines and
interfaces.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any, NamedTuple

import meshio
import numpy as np
from numpy import ndarray
from skfem import Mesh
from skfem.io.meshio import from_meshio

from ..checks import format_point
from ..errors import warn
from .kernel import gmsh_model
from .naming import name_outside, separate
from .pieces import Pieces, Plan, cut_up
from .sizes import Sizes

#: What no lift takes.
REMAINING = "remaining"
#: Smallest angle of triangles in degrees, and factors of all sizes that are tried until there is
#: none below it.
_SHARP, _TRIALS = 5.0, (1.0, 0.7, 0.5)
#: Angle in degrees that no element fits into; tangents of sides of second order are exact to a
#: tenth of it.
_TOUCH = 0.3


class Sizing(NamedTuple):
    """Size of elements, smaller sizes by name, and points with their sizes."""

    size: float
    sizes: Mapping[str, float]
    near: Sequence[tuple[ndarray, float]]


def meshed(plan: Plan, sizing: Sizing, slits: Collection[str], order: int, scale: float) -> Mesh:
    """Return the mesh of a section with all names."""
    for trial in _TRIALS:
        with gmsh_model() as gmsh:
            pieces = cut_up(gmsh, plan)
            sizes = Sizes(gmsh, plan, pieces, *sizing, trial * scale)
            gmsh.model.mesh.setSizeCallback(sizes.along)
            gmsh.model.mesh.generate(1)
            gmsh.model.mesh.setSizeCallback(sizes.inside(gmsh))
            gmsh.model.mesh.generate(2)
            gmsh.model.mesh.setOrder(order)
            mesh, faces, curves = _read(gmsh, pieces, order)
        angle, at = sharpest(mesh)
        if angle < _TOUCH:
            raise ValueError(
                f"outlines or lines meet at an angle of {angle:.2g} degrees near "
                f"{format_point(at + plan.shift)}: no element fits between them; move them apart, "
                f"or let "
                "them cross"
            )
        if angle >= _SHARP:
            break
    else:
        warn(
            f"the mesh has an angle of {angle:.2g} degrees near {format_point(at + plan.shift)}: "
            f"outlines or lines "
            "meet there at such an angle; move one of them"
        )
    return _named(
        mesh.translated(tuple(plan.shift)),
        plan,
        slits,
        [pieces.faces[face] for face in faces],
        curves,
    )


def _read(gmsh: Any, pieces: Pieces, order: int) -> tuple[Mesh, list[int], dict[str, ndarray]]:
    """Return the mesh in the current model, the face of each element, and facets of lines and holes
    by name.
    """
    tags, points, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(tags.max()) + 1, int)
    number[tags.astype(int)] = np.arange(len(tags))
    n = 3 if order == 1 else 6
    cells, owner = [], []
    for face in pieces.faces:
        nodes = np.reshape(gmsh.model.mesh.getElements(2, face)[2][0], (-1, n)).astype(int)
        cells.append(number[nodes])
        owner += [face] * len(nodes)
    t = np.vstack(cells)
    corners = np.unique(t[:, :3])
    kept = np.concatenate((corners, np.setdiff1d(t, corners)))  # scikit-fem wants corners first
    new = np.full(len(tags), -1)
    new[kept] = np.arange(len(kept))
    x = np.reshape(points, (-1, 3))[kept, :2]
    mesh = from_meshio(meshio.Mesh(x, [("triangle" if order == 1 else "triangle6", new[t])]))
    key = mesh.facets[0] * mesh.nvertices + mesh.facets[1]
    rank = np.argsort(key)

    def facets(curve: int) -> ndarray:
        nodes = gmsh.model.mesh.getElements(1, curve)[2]
        ends = np.sort(
            new[number[np.reshape(nodes[0], (-1, order + 1))[:, :2].astype(int)]].T, axis=0
        )
        return np.asarray(
            rank[np.searchsorted(key, ends[0] * mesh.nvertices + ends[1], sorter=rank)]
        )

    curves = {
        name: np.unique(np.concatenate([facets(curve) for curve in members]))
        for group in (pieces.lines, pieces.holes)
        for name, members in group.items()
    }
    return mesh, owner, curves


def sharpest(mesh: Mesh) -> tuple[float, ndarray]:
    """Return the smallest angle of all triangles, between the tangents of their sides, in degrees,
    and its corner.
    """
    x = mesh.doflocs[:, mesh.dofs.element_dofs]
    corners = x[:, :3]
    middles = x[:, 3:] if x.shape[1] == 6 else 0.5 * (corners + np.roll(corners, -1, axis=1))
    smallest, at = np.inf, corners[:, 0, 0]
    for k, (one, two) in enumerate(
        ((0, 2), (1, 0), (2, 1))
    ):  # sides that begin and end at the corner
        ends = corners[:, [(k + 1) % 3, (k + 2) % 3]]
        u, v = (
            4.0 * middles[:, [one, two]].transpose(1, 0, 2)
            - 3.0 * corners[:, k]
            - ends.transpose(1, 0, 2)
        )
        angle = np.arctan2(np.abs(u[0] * v[1] - u[1] * v[0]), (u * v).sum(axis=0))
        if angle.min() < smallest:
            smallest, at = float(angle.min()), corners[:, k, angle.argmin()]
    return float(np.degrees(smallest)), at


def _named(
    mesh: Mesh,
    plan: Plan,
    slits: Collection[str],
    labels: list[tuple[str, str]],
    curves: dict[str, ndarray],
) -> Mesh:
    """Return the mesh with its subdomains and boundaries, from area and lift of each element."""
    area, lift = np.array(labels).T
    holes = {name: facets for name, facets in curves.items() if name in plan.holes}
    lines = {name: facets for name, facets in curves.items() if name in plan.lines}
    ground = ~np.isin(area, list(plan.bodies))
    subdomains = {name: np.flatnonzero(area == name) for name in plan.areas}
    parts = {name: np.flatnonzero(lift == name) for name in plan.lifts}
    if parts:
        parts = {REMAINING: np.flatnonzero(ground & (lift == "")), **parts}
    boundaries = name_outside(mesh, holes, area) | lines
    bodies = {
        "ground": [name for name in plan.areas if name not in plan.bodies],
        **{name: [name] for name in plan.areas if name in plan.bodies},
    }
    bodies = {name: members for name, members in bodies.items() if members}
    mesh = mesh.with_subdomains(subdomains | parts).with_boundaries(boundaries)
    mesh = separate(mesh, bodies, slits, {name for name, part in parts.items() if len(part)})
    if "ground" in bodies and "ground" not in mesh.subdomains:
        mesh = mesh.with_subdomains({"ground": np.flatnonzero(ground)})
    return mesh
