r"""Flat triangles of thin shells: constant membrane strains and discrete Kirchhoff bending.

In the axes 1 and 2 of a triangle a node has the displacements (u_1, u_2, w) and the rotations
(theta_1, theta_2, theta_3) about the axes 1, 2 and the normal 3. A fibre across the shell leans by
:math:`\beta_1 = \theta_2, \beta_2 = -\theta_1`. The slopes are quadratic. In the middle of the side
from node i to node j, with the unit vector s along it, the length l and n across it, Kirchhoff's
:math:`\beta = -\nabla w` for a cubic w along the side and a linear slope across it gives (J. L.
Batoz, K. J. Bathe, L. W. Ho, Int. J. Numer. Meth. Engng. 15 (1980) 1771-1812)

.. math::

    \beta = -\frac{3}{2 l} (w_j - w_i)\, s + \left(\tfrac12 n n^T - \tfrac14 s s^T\right)
    (\beta_i + \beta_j)

Rotations about the normal have no stiffness in a thin shell. They are held weakly to the rotation
of the triangle in its plane, :math:`\tfrac12 (u_{2,1} - u_{1,2})`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy import ndarray

from ..arrays import row_norms
from ..checks import format_point
from ..surfaces.vectors import across, cross, unit

#: Corners of the triangles of a facet of k nodes, and the share of its area that each stands for.
#: Quadrilaterals are divided along both diagonals, each for a half.
_BOTH = np.array([[0, 1, 2], [0, 2, 3], [0, 1, 3], [1, 2, 3]])
_CORNERS_8 = np.array([[0, 4, 7], [1, 5, 4], [2, 6, 5], [3, 7, 6]])
_QUARTERS = np.array([[0, 4, 8, 7], [4, 1, 5, 8], [8, 5, 2, 6], [7, 8, 6, 3]])
#: Middles of the sides, by the nodes at their ends.
_SIDES = ((0, 1), (1, 2), (2, 0))
#: Stiffness of rotations about the normal, over G t: a hundredth changes nothing but 1e-4 of the
#: membrane of a folded plate.
_DRILLING = 1e-3
#: Least sine between the axis and the normal of a triangle.
_ACROSS = 0.1
#: Least cosine of the angle between neighbours without a fold: 30 degrees.
SMOOTH = np.cos(np.pi / 6.0)
#: Strains of a triangle: membrane, curvatures at the middles of the sides, drilling rotations.
MEMBRANE = slice(0, 3)
BENDING = slice(3, 12)
DRILLING = slice(12, 15)


def divided(cells: ndarray) -> tuple[ndarray, ndarray, ndarray]:
    """Return the triangles, (m, 3), of facets, (n, k), and the shares of their areas, (m,).

    The last array is true for triangles that cover the facets once, along one diagonal, (m,).
    """
    k = cells.shape[1]
    if k == 3:
        parts = np.array([[0, 1, 2]])
        shares = np.ones(1)
    elif k == 6:
        parts = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])
        shares = np.ones(4)
    elif k == 4:
        parts = _BOTH
        shares = np.full(4, 0.5)
    elif k == 8:
        parts = np.vstack((_CORNERS_8, 4 + _BOTH))
        shares = np.repeat((1.0, 0.5), 4)
    else:
        parts = _QUARTERS[:, _BOTH].reshape(-1, 3)
        shares = np.full(16, 0.5)
    # The first two of the four halves of a quadrilateral are those of one diagonal
    halves = np.flatnonzero(shares < 1.0)
    covering = np.ones(len(parts), bool)
    covering[halves.reshape(-1, 4)[:, 2:]] = False
    n = len(cells)
    return cells[:, parts].reshape(-1, 3), np.tile(shares, n), np.tile(covering, n)


def n_corners(cells: ndarray) -> int:
    """Return the number of corners of facets, (m, k), whose corners come first."""
    return 3 if cells.shape[1] in (3, 6) else 4


def normals(corners: ndarray) -> ndarray:
    """Return normals of triangles, (m, 3), twice as long as their areas."""
    return across(corners[:, 1:] - corners[:, :1])


@dataclass(frozen=True, eq=False)
class Triangles:
    """Geometry of m triangles.

    Attributes
    ----------
    points : ndarray, shape (m, 3, 3)
        Coordinates of the corners, anticlockwise seen from the side of the normal.
    shares : ndarray, shape (m,)
        Shares of the areas that the triangles stand for.
    axis : ndarray, shape (3,)
        Direction whose part in the plane of a triangle is its axis 1.
    """

    points: ndarray
    shares: ndarray
    axis: ndarray

    @cached_property
    def _normal(self) -> ndarray:
        """Normals, (m, 3), twice as long as the areas."""
        return normals(self.points)

    @cached_property
    def areas(self) -> ndarray:
        """Areas that the triangles stand for, (m,)."""
        return np.asarray(0.5 * row_norms(self._normal) * self.shares)

    @cached_property
    def centres(self) -> ndarray:
        """Centres, (m, 3)."""
        return np.asarray(self.points.mean(axis=1))

    @cached_property
    def axes(self) -> ndarray:
        """Axes 1 and 2 and the normal of each triangle, (m, 3, 3)."""
        normal = unit(self._normal)
        first = self.axis - (normal @ self.axis)[:, None] * normal
        size = row_norms(first)
        if (size < _ACROSS).any():
            where = format_point(self.centres[size < _ACROSS][0])
            raise ValueError(
                f"the axis {self.axis.tolist()} is normal to the shell at {where}: give another one"
            )
        first = first / size[:, None]
        return np.stack((first, cross(normal, first), normal), axis=1)

    @cached_property
    def _local(self) -> ndarray:
        """Coordinates of the corners along the axes 1 and 2 from the first one, (m, 3, 2)."""
        from_first = self.points - self.points[:, :1]
        return np.asarray(np.einsum("mac,mic->mia", self.axes[:, :2], from_first))

    @cached_property
    def gradients(self) -> ndarray:
        """Derivatives of the linear functions of the corners along the axes 1 and 2, (m, 2, 3)."""
        inverse = np.linalg.inv(self._local[:, 1:])  # columns: gradients of corners 1 and 2
        return np.concatenate((-inverse.sum(axis=2, keepdims=True), inverse), axis=2)

    @cached_property
    def strains(self) -> ndarray:
        """Strains by the dofs of the nodes in space, (m, 15, 18); see the names of the module.

        The dofs are the displacements of the three nodes, then their rotations.
        """
        # Strains by the dofs in the axes of the triangle, then by those in space
        m = len(self.points)
        found = np.zeros((m, 15, 2, 3, 3))  # strains, displacements or rotations, nodes, axes
        _membrane(found, self.gradients)
        _bending(found, self.gradients, self._local)
        in_space = np.einsum("msknb,mbc->msknc", found, self.axes)
        return np.asarray(in_space.reshape(m, 15, 18))


def _membrane(strains: ndarray, gradients: ndarray) -> None:
    """Set eps_1, eps_2 and gamma_12, and the rotations about the normal."""
    u = strains[:, :, 0]
    u[:, 0, :, 0] = gradients[:, 0]
    u[:, 1, :, 1] = gradients[:, 1]
    u[:, 2, :, 0] = gradients[:, 1]
    u[:, 2, :, 1] = gradients[:, 0]
    # theta_3 - (u_2,1 - u_1,2) / 2 at each node
    for node in range(3):
        u[:, 12 + node, :, 0] = 0.5 * gradients[:, 1]
        u[:, 12 + node, :, 1] = -0.5 * gradients[:, 0]
        strains[:, 12 + node, 1, node, 2] = 1.0


def _bending(strains: ndarray, gradients: ndarray, local: ndarray) -> None:
    """Set kappa_1, kappa_2 and 2 kappa_12 at the middles of the sides."""
    # Slopes at corners and middles of sides by the dofs
    m = len(local)
    slopes = np.zeros((m, 6, 2, 2, 3, 3))  # six nodes, components; displacements or rotations, ...
    for node in range(3):
        slopes[:, node, 0, 1, node, 1] = 1.0
        slopes[:, node, 1, 1, node, 0] = -1.0
    for k, (i, j) in enumerate(_SIDES):
        side = local[:, j] - local[:, i]
        length = row_norms(side)
        s = side / length[:, None]
        n = np.stack((-s[:, 1], s[:, 0]), axis=1)
        across = n[:, :, None] * n[:, None]
        along = s[:, :, None] * s[:, None]
        turn = 0.5 * across - 0.25 * along
        both = (slopes[:, i] + slopes[:, j]).reshape(m, 2, -1)
        slopes[:, 3 + k] = (turn @ both).reshape(slopes[:, 0].shape)
        lean = 1.5 * s / length[:, None]
        slopes[:, 3 + k, :, 0, j, 2] -= lean
        slopes[:, 3 + k, :, 0, i, 2] += lean

    # Derivatives of the quadratic functions L (2 L - 1) and 4 L_i L_j at the middles of the sides
    for point, ends in enumerate(_SIDES):
        L = np.zeros(3)
        L[list(ends)] = 0.5
        corners = (4.0 * L - 1.0) * gradients  # (m, 2, 3)
        middles = []
        for i, j in _SIDES:
            middles.append(4.0 * (L[i] * gradients[..., j] + L[j] * gradients[..., i]))
        derivatives = np.concatenate((corners, np.stack(middles, axis=2)), axis=2)  # (m, 2, 6)
        # rates[a, b] = d beta_b / d axis a
        rates = np.einsum("man,mnbkij->mabkij", derivatives, slopes)
        row = 3 + 3 * point
        strains[:, row] = rates[:, 0, 0]
        strains[:, row + 1] = rates[:, 1, 1]
        strains[:, row + 2] = rates[:, 1, 0] + rates[:, 0, 1]


def elasticity(E: float, nu: float, thickness: float) -> ndarray:
    """Return forces and moments per length by strains, at unit weight of the area, (15, 15).

    The curvatures of a point stand for a third of the area, and so do drilling rotations.
    """
    plane = np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu)]])
    membrane = E * thickness / (1.0 - nu**2) * plane
    found = np.zeros((15, 15))
    found[MEMBRANE, MEMBRANE] = membrane
    found[BENDING, BENDING] = np.kron(np.eye(3), membrane * thickness**2 / 36.0)
    found[DRILLING, DRILLING] = _DRILLING * E / (2.0 + 2.0 * nu) * thickness / 3.0 * np.eye(3)
    return found


def lost_stiffness(triangles: Triangles, n: ndarray) -> ndarray:
    """Return the stiffness that forces n_1, n_2, n_12, (m, 3), take away, (m, 18, 18).

    It is the integral of -n_ab u,a u,b of linear displacements u over the triangles, with forces
    per length positive in tension (R. D. Cook et al., Concepts and Applications of Finite Element
    Analysis, 2002, section 18.2).
    """
    forces = n[:, [[0, 2], [2, 1]]]  # (m, 2, 2)
    g = triangles.gradients
    slopes = -triangles.areas[:, None, None] * (g.transpose(0, 2, 1) @ forces @ g)
    lost = np.zeros((len(n), 18, 18))
    lost[:, :9, :9] = np.einsum("mij,cd->micjd", slopes, np.eye(3)).reshape(-1, 9, 9)
    return lost
