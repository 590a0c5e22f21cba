"""Surfaces of bodies: named boundaries as chains of facets that know their outward side.

The curve of a facet is ``rho(xi) = sum_b M_b(xi) x_b`` with polynomials ``M_b`` and ``-1 <= xi <= 1`` (eq. 18 of
the paper, with the orientation of eq. 17: ``xi = -1`` at the first node).  A chain is ordered so that the
body lies to the right; the outward normal is the tangent turned by +90 degrees.
"""
from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy import ndarray
from skfem import CellBasis

from ..errors import check_plane, look_up

#: Coefficients of the shape functions of a facet in the powers 1, xi, xi^2, xi^3.
LINEAR = np.array([[.5, -.5, 0, 0], [.5, .5, 0, 0]])
QUADRATIC = np.array([[0, -.5, .5, 0], [0, .5, .5, 0], [1, 0, -1, 0]])
_GAUSS = np.polynomial.legendre.leggauss(5)
#: An open chain goes on straight for this share of its last segment: a slave corner that starts flush with
#: the master's end must not lose contact to the lateral strain of the bodies.
EXTENSION = 0.05


def powers(xi: ndarray, derivatives: int = 3) -> ndarray:
    """Powers 0 to 3 of the local coordinate and their first derivatives, (derivatives + 1, n, 4)."""
    result = np.zeros((derivatives + 1, 4, len(xi)))
    square = xi**2
    result[0, 0], result[0, 1], result[0, 2], result[0, 3] = 1.0, xi, square, square * xi
    if derivatives > 0:
        result[1, 1], result[1, 2], result[1, 3] = 1.0, 2 * xi, 3 * square
    if derivatives > 1:
        result[2, 2], result[2, 3] = 2.0, 6 * xi
    if derivatives > 2:
        result[3, 3] = 6.0
    return result.transpose(0, 2, 1)


@dataclass(frozen=True)
class Surface:
    """A chain of curve segments on the boundary of a body.

    Attributes
    ----------
    name
        Name of the boundary, for messages.
    dofs
        Displacement unknowns of its nodes, (n_nodes, 2).
    nodes
        Reference coordinates of its nodes, (n_nodes, 2).
    segments
        Node numbers of every segment in the order of the chain, (n_segments, k).
    coefficients
        Polynomial coefficients of the shape functions, (n_segments, k, 4).
    closed
        Whether the last segment ends where the first begins.
    start, length
        Arc position of the segments' first ends and their lengths in the reference configuration.
    extension
        Share of the last segments by which an open chain goes on beyond its ends.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> from skfem_contact import Surface
    >>> basis = Basis(MeshQuad().refined(2).with_defaults(), ElementVector(ElementQuad1()))
    >>> top = Surface.from_boundary(basis, "top")
    >>> len(top.segments), top.closed, round(float(top.length.sum()), 12)
    (4, False, 1.0)
    """

    name: str
    dofs: ndarray
    nodes: ndarray
    segments: ndarray
    coefficients: ndarray
    closed: bool
    start: ndarray
    length: ndarray
    extension: float = EXTENSION

    @classmethod
    def from_boundary(cls, basis: CellBasis, name: str) -> Surface:
        """The chain of a named boundary of the basis' mesh.

        Raises
        ------
        ValueError
            Unknown or empty boundary, facets inside the mesh, or a boundary that is no single chain; a basis in three
            dimensions.
        """
        check_plane(basis, "contact")
        mesh = basis.mesh
        facets = np.unique(look_up(name, mesh.boundaries or {}, "boundary"))
        if len(facets) == 0:
            raise ValueError(f"boundary '{name}' is empty")
        if (mesh.f2t[1, facets] >= 0).any():
            raise ValueError(f"boundary '{name}' lies inside the mesh: its facets have elements on both sides; "
                             "separate the bodies with join_bodies")
        ends = _outward(mesh.p, mesh.t, mesh.facets[:, facets], mesh.f2t[0, facets])
        order, closed = _chain(ends, name)
        facets, ends = facets[order], ends[:, order]

        dofs = basis.nodal_dofs[:, ends].transpose(1, 2, 0)  # (2 ends, n, 2 components)
        coefficients = LINEAR
        if basis.facet_dofs is not None and len(basis.facet_dofs):
            dofs = np.concatenate((dofs, basis.facet_dofs[:2, facets].T[None]))
            coefficients = QUADRATIC
        dofs = dofs.transpose(1, 0, 2)  # (n, k, 2)
        unique, segments = np.unique(dofs[..., 0], return_inverse=True)
        dofs = np.stack((unique, unique + 1), axis=1)
        nodes = np.stack((basis.doflocs[0, dofs[:, 0]], basis.doflocs[1, dofs[:, 0]]), axis=1)
        segments = segments.reshape(len(facets), -1)
        coefficients = np.broadcast_to(coefficients, (len(facets), *coefficients.shape))
        return cls.of(name, dofs, nodes, segments, coefficients, closed)

    @classmethod
    def of(cls, name: str, dofs: ndarray, nodes: ndarray, segments: ndarray, coefficients: ndarray,
           closed: bool) -> Surface:
        """A surface from its chain of segments; arc positions are computed."""
        xi, weights = _GAUSS
        tangent = np.einsum("mkp,qp,mkc->mqc", coefficients, powers(xi)[1], (nodes - nodes[0])[segments])
        length = np.linalg.norm(tangent, axis=-1) @ weights
        start = np.concatenate(([0.0], np.cumsum(length)[:-1]))
        return cls(name, dofs, nodes, segments, coefficients, closed, start, length)

    @property
    def total_length(self) -> float:
        """Length of the whole chain in the reference configuration."""
        return float(self.length.sum())

    def facing(self, slave: Surface) -> Surface:
        """The surface as a slave meets it: off an end it goes on for a share of the slave's segments, if shorter.

        The table of a single line does not reach farther beyond its edge than one of many facets.
        """
        last = float(max(self.length[0], self.length[-1]))
        return replace(self, extension=EXTENSION * min(1.0, slave.spacing / last))

    def positions(self, x: ndarray, origin: ndarray | float = 0.0) -> ndarray:
        """Current coordinates of the nodes at the displacements x, seen from an origin, (n_nodes, 2)."""
        return self.nodes - origin + np.where(self.dofs >= 0, x[self.dofs], 0.0)

    @cached_property
    def middle(self) -> ndarray:
        """Mean of the nodes in the reference configuration, (2,)."""
        return self.nodes.mean(axis=0)

    @cached_property
    def spacing(self) -> float:
        """Length of a typical segment, the median of all."""
        return float(np.median(self.length))

    @cached_property
    def straight(self) -> bool:
        """Whether all segments are straight."""
        return not self.coefficients[:, :, 2:].any()

    def curve(self, segment: ndarray, xi: ndarray, nodes: ndarray, derivatives: int = 3) -> tuple[ndarray, ndarray]:
        """Shape functions and curve with their derivatives at points given by segment and xi.

        Parameters
        ----------
        segment, xi
            Segment number and local coordinate of every point, (n,).
        nodes
            Coordinates of the nodes, (n_nodes, 2).
        derivatives
            Highest derivative that is asked for.

        Returns
        -------
        tuple
            ``M`` (derivatives + 1, n, k) and ``rho`` (derivatives + 1, n, 2): values and derivatives.
        """
        coefficients, power = self.coefficients[segment], powers(xi, derivatives)[..., None]
        M = coefficients[:, :, 0] * power[:, :, 0] + coefficients[:, :, 1] * power[:, :, 1]
        if not self.straight:
            M += coefficients[:, :, 2] * power[:, :, 2]
            M += coefficients[:, :, 3] * power[:, :, 3]
        places = nodes[self.segments[segment]]
        rho = M[:, :, 0, None] * places[:, 0]
        for b in range(1, M.shape[2]):
            rho += M[:, :, b, None] * places[:, b]
        return M, rho

    def ends(self, nodes: ndarray) -> ndarray:
        """Ends of all segments and the derivatives of the curves there, (2, 2 ends, n_segments, 2)."""
        return np.einsum("demk,mkc->demc", self._at_ends, nodes[self.segments])

    @cached_property
    def _at_ends(self) -> ndarray:
        """Shape functions at the ends of all segments, and their derivatives."""
        return np.einsum("mkp,dep->demk", self.coefficients, powers(np.array([-1.0, 1.0]), 1))

    def along(self, difference: ndarray) -> ndarray:
        """Differences of arc positions; on a closed chain the short way round."""
        if not self.closed:
            return difference
        total = self.total_length
        return (difference + 0.5 * total) % total - 0.5 * total

    def arc(self, segment: ndarray, xi: ndarray) -> tuple[ndarray, ndarray, ndarray]:
        """Reference arc position S along the chain, dS/dxi and d2S/dxi2 at points given by segment and xi.

        The slip is measured in this coordinate: it belongs to the master's material, runs on across
        the segments and is not changed by rigid motion.
        """
        if self.straight:
            metric = 0.5 * self.length[segment]
            return self.start[segment] + (xi + 1.0) * metric, metric, np.zeros_like(metric)
        nodes = self.nodes - self.nodes[0]  # large coordinates would cost digits
        rho = self.curve(segment, xi, nodes, 2)[1]
        metric = np.linalg.norm(rho[1], axis=-1)
        t, w = _GAUSS
        half = 0.5 * (xi + 1.0)
        inner = -1.0 + half[:, None] * (t + 1.0)  # five Gauss points on [-1, xi]
        tangent = self.curve(np.repeat(segment, 5), inner.ravel(), nodes, 1)[1][1]
        arc = self.start[segment] + half * (np.linalg.norm(tangent, axis=-1).reshape(-1, 5) @ w)
        return arc, metric, np.einsum("nc,nc->n", rho[1], rho[2]) / metric


def _outward(p: ndarray, t: ndarray, ends: ndarray, element: ndarray) -> ndarray:
    """Turn every facet so that its element's centroid lies to the right (nothing else tells its side)."""
    a, b = p[:, ends[0]], p[:, ends[1]]
    centroid = p[:, t[:, element]].mean(axis=1)
    along, inward = b - a, centroid - a
    left = along[0] * inward[1] - along[1] * inward[0] > 0
    return np.where(left, ends[::-1], ends)


def _chain(ends: ndarray, name: str) -> tuple[ndarray, bool]:
    """Order oriented facets into one chain; the order and whether it is closed."""
    n = ends.shape[1]
    following = {int(node): k for k, node in enumerate(ends[0])}
    arriving = set(ends[1].tolist())
    if len(following) < n or len(arriving) < n:
        raise ValueError(f"boundary '{name}' is no single chain: it branches")
    first = [k for k in range(n) if int(ends[0, k]) not in arriving]
    if len(first) > 1:
        raise ValueError(f"boundary '{name}' is no single chain: it consists of {len(first)} pieces")
    order = [first[0] if first else 0]
    while (k := following.get(int(ends[1, order[-1]]))) is not None and k != order[0]:
        order.append(k)
    if len(order) < n:
        raise ValueError(f"boundary '{name}' is no single chain: {n - len(order)} of {n} facets are "
                         "not connected to the others")
    return np.array(order), not first
