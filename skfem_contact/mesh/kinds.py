"""Kinds of elements by meshio's names, with their nodes in the order of VTK."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import skfem
from numpy.typing import NDArray

from ..arrays import cross_in_plane

Integers = NDArray[np.integer]
Floats = NDArray[np.float64]


class Kind(NamedTuple):
    """Shape of an element.

    Attributes
    ----------
    dim
        Number of dimensions.
    corners
        Number of corners, which come first among the nodes.
    order
        Order of the shape functions.
    mirrored
        Order of the nodes in which the element has the opposite sign.
    sides
        Corners of the sides.
    mesh
        Class of scikit-fem for meshes of such elements, or None.
    """

    dim: int
    corners: int
    order: int
    mirrored: tuple[int, ...] = ()
    sides: tuple[tuple[int, ...], ...] = ()
    mesh: type | None = None


_TRIANGLE = ((0, 1), (1, 2), (2, 0))
_QUAD = ((0, 1), (1, 2), (2, 3), (3, 0))
_TETRA = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3))
_PYRAMID = ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4))
_WEDGE = ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5))
_HEXAHEDRON = (
    (0, 3, 2, 1),
    (4, 5, 6, 7),
    (0, 1, 5, 4),
    (1, 2, 6, 5),
    (2, 3, 7, 6),
    (3, 0, 4, 7),
)
_UPPER_FIRST = (4, 5, 6, 7, 0, 1, 2, 3)
_UPPER_EDGES_FIRST = (12, 13, 14, 15, 8, 9, 10, 11, 16, 17, 18, 19)

#: Nodes of hexahedra of scikit-fem in the order of VTK, as `skfem.io.meshio` has them.
HEXAHEDRON = (
    *(0, 3, 6, 2, 1, 5, 7, 4),
    *(10, 16, 14, 9, 12, 18, 17, 11, 8, 15, 19, 13),
    *(20, 25, 22, 23, 21, 24, 26),
)


def from_vtk(n_nodes: int) -> list[int]:
    """Return the order of VTK's nodes of a hexahedron in scikit-fem."""
    return np.argsort(HEXAHEDRON[:n_nodes]).tolist()


#: All kinds that files may hold.
KINDS = {
    "vertex": Kind(0, 1, 1, (0,)),
    "line": Kind(1, 2, 1, (1, 0)),
    "line3": Kind(1, 2, 2, (1, 0, 2)),
    "triangle": Kind(2, 3, 1, (0, 2, 1), _TRIANGLE, skfem.MeshTri1),
    "triangle6": Kind(2, 3, 2, (0, 2, 1, 5, 4, 3), _TRIANGLE, skfem.MeshTri2),
    "quad": Kind(2, 4, 1, (0, 3, 2, 1), _QUAD, skfem.MeshQuad1),
    "quad8": Kind(2, 4, 2, (0, 3, 2, 1, 7, 6, 5, 4), _QUAD),
    "quad9": Kind(2, 4, 2, (0, 3, 2, 1, 7, 6, 5, 4, 8), _QUAD, skfem.MeshQuad2),
    "tetra": Kind(3, 4, 1, (0, 2, 1, 3), _TETRA, skfem.MeshTet1),
    "tetra10": Kind(3, 4, 2, (0, 2, 1, 3, 6, 5, 4, 7, 9, 8), _TETRA, skfem.MeshTet2),
    "pyramid": Kind(3, 5, 1, (0, 3, 2, 1, 4), _PYRAMID),
    "pyramid13": Kind(3, 5, 2, (), _PYRAMID),
    "pyramid14": Kind(3, 5, 2, (), _PYRAMID),
    "wedge": Kind(3, 6, 1, (3, 4, 5, 0, 1, 2), _WEDGE),
    "wedge15": Kind(3, 6, 2, (), _WEDGE),
    "wedge18": Kind(3, 6, 2, (), _WEDGE),
    "hexahedron": Kind(3, 8, 1, _UPPER_FIRST, _HEXAHEDRON, skfem.MeshHex1),
    "hexahedron20": Kind(3, 8, 2, (*_UPPER_FIRST, *_UPPER_EDGES_FIRST), _HEXAHEDRON),
    "hexahedron27": Kind(
        3,
        8,
        2,
        (*_UPPER_FIRST, *_UPPER_EDGES_FIRST, 20, 21, 22, 23, 25, 24, 26),
        _HEXAHEDRON,
        skfem.MeshHex2,
    ),
}

#: Kinds by the dimension of the element and its number of nodes.
BY_NODES = {
    (1, 2): "line",
    (1, 3): "line3",
    (2, 3): "triangle",
    (2, 6): "triangle6",
    (2, 4): "quad",
    (2, 8): "quad8",
    (2, 9): "quad9",
    (3, 4): "tetra",
    (3, 10): "tetra10",
    (3, 5): "pyramid",
    (3, 13): "pyramid13",
    (3, 6): "wedge",
    (3, 15): "wedge15",
    (3, 8): "hexahedron",
    (3, 20): "hexahedron20",
    (3, 27): "hexahedron27",
}
#: Numbers of nodes of the kinds, also of those that are not read by their number.
N_NODES = {kind: n for (_, n), kind in BY_NODES.items()}
N_NODES |= {"vertex": 1, "pyramid14": 14, "wedge18": 18}


#: Nodes in the order of VTK of formats that have the middles of upright edges before upper ones.
UPRIGHT_FIRST = {
    "hexahedron20": [*range(12), 16, 17, 18, 19, 12, 13, 14, 15],
    "wedge15": [*range(9), 12, 13, 14, 9, 10, 11],
}


def signed_size(points: Floats, cells: Integers, kind: str) -> Floats:
    """Return the area or volume of the corners of elements, (n,), negative where mirrored.

    Points are (n_points, 2) in the plane or (n_points, 3). The value is exact for triangles,
    quadrilaterals and tetrahedra; of other elements its sign alone is meant.
    """
    shape = KINDS[kind]
    x = points[cells[:, : shape.corners]]  # (n, corners, dim)
    if shape.dim == 2:
        after = np.roll(x, -1, axis=1)
        return 0.5 * cross_in_plane(x, after).sum(axis=1)

    # Add the volumes of the pyramids between the sides and the middle of each element
    middle = x.mean(axis=1)
    volume = np.zeros(len(x))
    for side in shape.sides:
        corners = x[:, list(side)] - middle[:, None]
        for a, b in zip(range(1, len(side) - 1), range(2, len(side))):
            normal = np.cross(corners[:, a], corners[:, b])
            volume += (corners[:, 0] * normal).sum(axis=1) / 6.0
    return volume


def oriented(points: Floats, cells: Integers, kind: str) -> Integers:
    """Return elements whose nodes go round as VTK wants it, with a positive area or volume."""
    mirrored = list(KINDS[kind].mirrored)
    if KINDS[kind].dim < 2 or not mirrored:
        return cells
    negative = signed_size(points, cells, kind) < 0.0
    if not negative.any():
        return cells
    return np.where(negative[:, None], cells[:, mirrored], cells)
