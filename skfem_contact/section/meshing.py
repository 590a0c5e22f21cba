"""Mesh of a section: triangles of Gmsh with the names of areas, lines and interfaces."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from skfem import Mesh

from ..checks import format_point
from ..errors import warn
from .kernel import gmsh_model, nodes_of
from .naming import name_outside, separate
from .pieces import Pieces, Plan, cut_up
from .sizes import Sizes

#: Name of the ground outside of all lifts.
REMAINING = "remaining"
#: Smallest angle of triangles in degrees without a warning.
_SHARP = 5.0
#: Factors of all sizes that are tried until all angles are larger.
_TRIALS = (1.0, 0.7, 0.5)
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
        # Mesh curves first, then faces, with sizes that follow the outlines.
        with gmsh_model() as gmsh:
            pieces = cut_up(gmsh, plan)
            sizes = Sizes(gmsh, plan, pieces, *sizing, trial * scale)
            gmsh.model.mesh.setSizeCallback(sizes.along)
            gmsh.model.mesh.generate(1)
            gmsh.model.mesh.setSizeCallback(sizes.inside(gmsh))
            gmsh.model.mesh.generate(2)
            gmsh.model.mesh.setOrder(order)
            mesh, faces, curves = _read(gmsh, pieces, order)
        # Refuse angles that no element fits into, and try another size for sharp ones.
        angle, corner = sharpest(mesh)
        place = format_point(corner + plan.shift)
        if angle < _TOUCH:
            raise ValueError(
                f"outlines or lines meet at an angle of {angle:.2g} degrees near {place}: no "
                "element fits between them; move them apart, or let them cross"
            )
        if angle >= _SHARP:
            break
    else:
        warn(
            f"the mesh has an angle of {angle:.2g} degrees near {place}: outlines or lines meet "
            "there at such an angle; move one of them"
        )
    mesh = mesh.translated(tuple(plan.shift))
    area, lift = np.array([pieces.faces[face] for face in faces]).T
    return _named(mesh, plan, slits, area, lift, curves)


def _read(gmsh: Any, pieces: Pieces, order: int) -> tuple[Mesh, list[int], dict[str, ndarray]]:
    """Return the current mesh, the face of each element, and facets of lines and holes."""
    import meshio
    from skfem.io.meshio import from_meshio

    # Read the elements face by face
    points, row = nodes_of(gmsh)
    kind = "triangle"
    nodes_of_element = 3
    if order == 2:
        kind = "triangle6"
        nodes_of_element = 6
    cells = []
    owners = []
    for face in pieces.faces:
        nodes = gmsh.model.mesh.getElements(2, face)[2][0]
        cells.append(np.reshape(nodes, (-1, nodes_of_element)).astype(int))
        owners += [face] * len(cells[-1])
    t = np.vstack(cells)

    # Number the corners in the order of Gmsh, then the other nodes, as scikit-fem wants it
    corners = np.unique(row[t[:, :3]])
    others = np.setdiff1d(row[t], corners)
    kept = np.concatenate((corners, others))
    number = np.full(len(points), -1)
    number[kept] = np.arange(len(kept))
    number = number[row]
    x = points[kept]
    mesh = from_meshio(meshio.Mesh(x, [(kind, number[t])]))

    # Find the facets of curves by their ends
    key = mesh.facets[0] * mesh.nvertices + mesh.facets[1]
    rank = np.argsort(key)
    curves = {}
    for group in (pieces.lines, pieces.holes):
        for name, members in group.items():
            nodes = [gmsh.model.mesh.getElements(1, curve)[2][0] for curve in members]
            lines = np.reshape(np.concatenate(nodes), (-1, order + 1))
            ends = number[lines[:, :2].astype(int)]
            first, second = np.sort(ends.T, axis=0)
            wanted = first * mesh.nvertices + second
            position = np.searchsorted(key, wanted, sorter=rank)
            curves[name] = np.unique(rank[position])
    return mesh, owners, curves


def sharpest(mesh: Mesh) -> tuple[float, ndarray]:
    """Return the smallest angle between tangents of sides, in degrees, and its corner."""
    x = mesh.doflocs[:, mesh.dofs.element_dofs]  # (2, nodes, elements)
    corners = x[:, :3]
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
    if x.shape[1] == 6:
        middles = x[:, 3:]
    smallest = np.inf
    place = corners[:, 0, 0]
    for k in range(3):
        # Tangents at corner k of the sides to the next corner and to the one before
        corner = corners[:, k]
        u, v = (
            4.0 * middles[:, side] - 3.0 * corner - corners[:, end]
            for side, end in ((k, (k + 1) % 3), ((k + 2) % 3, (k + 2) % 3))
        )
        area = u[0] * v[1] - u[1] * v[0]
        angle = np.arctan2(np.abs(area), (u * v).sum(axis=0))
        if angle.min() < smallest:
            smallest = float(angle.min())
            place = corner[:, angle.argmin()]
    return float(np.degrees(smallest)), place


def _named(
    mesh: Mesh,
    plan: Plan,
    slits: Collection[str],
    area: ndarray,
    lift: ndarray,
    curves: dict[str, ndarray],
) -> Mesh:
    """Return the mesh with its names, from area and lift of each element and facets of curves."""
    # Name areas and lifts
    soils = []
    bodies = {}
    subdomains = {}
    for name in plan.areas:
        subdomains[name] = np.flatnonzero(area == name)
        if name in plan.bodies:
            bodies[name] = [name]
        else:
            soils.append(name)
    ground = np.flatnonzero(np.isin(area, soils))
    parts = {}
    if plan.lifts:
        parts[REMAINING] = np.flatnonzero(np.isin(area, soils) & (lift == ""))
        parts |= {name: np.flatnonzero(lift == name) for name in plan.lifts}

    # Name the outer boundary, holes and lines
    boundaries = name_outside(mesh, {name: curves[name] for name in plan.holes}, area)
    boundaries |= {name: curves[name] for name in plan.lines}
    mesh = mesh.with_subdomains(subdomains | parts).with_boundaries(boundaries)

    # Separate bodies and the sides of slits
    if soils:
        bodies = {"ground": soils, **bodies}
    mesh = separate(mesh, bodies, slits, [name for name, part in parts.items() if len(part)])
    if soils and "ground" not in mesh.subdomains:
        mesh = mesh.with_subdomains({"ground": ground})
    return mesh
