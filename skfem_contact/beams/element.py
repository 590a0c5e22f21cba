"""Three-node Timoshenko elements in the plane, of shells and in space; hinges at their ends.

Displacements and rotations are quadratic, and two Gauss points integrate all terms: no locking. The
dofs of an element are the displacements of its nodes (start, end, middle), then their rotations,
anticlockwise. Strains do not depend on the frame: with the tangent t, the normal n to its left and
the derivative ' by the arc length, eps = t . u', gamma = n . u' - theta, kappa = theta'.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import NamedTuple

import numpy as np
import scipy
from numpy import ndarray
from typing_extensions import override

from ..arrays import left_of, row_norms
from ..errors import Remark

GAUSS = np.array([-1.0, 1.0]) / np.sqrt(3.0)
#: Second derivatives of the functions of the nodes.
_CURVATURE = np.array([1.0, 1.0, -2.0])
#: Share of the force on the middle node that a uniform load on the element leaves at either end.
_AT_END = 0.25
#: Largest GA L**2 / EI: a cantilever then bends by the exact value up to 7e-9; with ten times as
#: much its system is singular.
_RIGID = 1e9
#: Largest length of an element without length, as a share of the size of the beam.
_NO_LENGTH = 1e-6
#: Share of the stiffness that a hinge keeps in the tangent, as it flows: a mechanism of beams is
#: singular to the last bit. The limit loads of a propped cantilever, a portal and a column end in a
#: stall with 0, on a plateau with 1e-6.
_KEPT = 1e-6
#: Strength by which the ends at a node differ, so that one of two equal ends flows: two leave the
#: node between loose.
_WEAKEST = 1e-7
#: Share of the largest singular value of the faces in force below which they depend on each other.
_DEPENDENT = 1e-8


def shapes(xi: float) -> tuple[ndarray, ndarray]:
    """Return the quadratic functions of the nodes (-1, 1, 0) at a point, and their derivatives."""
    N = np.array([0.5 * xi * (xi - 1.0), 0.5 * xi * (xi + 1.0), 1.0 - xi * xi])
    dN = np.array([xi - 0.5, xi + 0.5, -2.0 * xi])
    return N, dN


def across(t: ndarray) -> tuple[ndarray, ndarray]:
    """Return two unit vectors across unit tangents in space, (m, 3) each."""
    first = np.cross(t, np.eye(3)[np.abs(t).argmin(axis=1)])
    first /= row_norms(first)[:, None]
    return first, np.cross(t, first)


def _times(functions: ndarray, axis: ndarray) -> ndarray:
    """Return functions of the nodes, (3,) or (m, 3), times an axis, (m, dim), by dof."""
    return (functions[..., None] * axis[:, None]).reshape(len(axis), -1)


def _along(points: ndarray, xi: float) -> tuple[ndarray, ndarray, ndarray, ndarray]:
    """Return J, (m,), tangents, (m, dim), N, (3,), and its derivatives by length, (m, 3)."""
    N, dN = shapes(xi)
    along = np.einsum("k,mkc->mc", dN, points)
    # The axis must lead from the start to the end.
    chord = points[:, 1] - points[:, 0]
    least = _NO_LENGTH * np.ptp(points) * row_norms(chord)
    if not ((along * chord).sum(axis=1) > least).all():
        raise ValueError("an element of a beam has no length, or its middle lies beyond its ends")
    J = row_norms(along)[:, None]
    return J[:, 0], along / J, N, dN / J


@dataclass(frozen=True, eq=False)
class BeamElements:
    """Geometry of m elements.

    Attributes
    ----------
    points : ndarray, shape (m, 3, 2)
        Coordinates of start, end and middle.
    strains : ndarray, shape (m, 2 q, 9)
        Strains (eps, gamma, kappa) at both Gauss points by the dofs: q = 3.
    weights : ndarray, shape (m, 2)
        Lengths that the Gauss points stand for.
    """

    points: ndarray
    strains: ndarray
    weights: ndarray

    @classmethod
    def of(cls, points: ndarray) -> BeamElements:
        """Return the elements between nodes (m, 3, 2)."""
        # eps = t . u', gamma = n . u' - theta, kappa = theta'
        m = len(points)
        strains = np.zeros((m, 2, 3, 9))  # (elements, Gauss points, strains, dofs)
        weights = np.zeros((m, 2))
        for g, xi in enumerate(GAUSS):
            weights[:, g], t, N, slope = _along(points, xi)
            eps, gamma, kappa = strains[:, g].swapaxes(0, 1)
            eps[:, :6] = _times(slope, t)
            gamma[:, :6] = _times(slope, left_of(t))
            gamma[:, 6:] = -N
            kappa[:, 6:] = slope
        return cls(points, strains.reshape(m, 6, 9), weights)

    def root(self, EA: float, GA: float, EI: float, GJ: float = 0.0) -> ndarray:
        """Return the matrices R of the stiffness R R', (m, 9, 2 q)."""
        stiffness = np.array([EA, GA, EI])
        D = (self.weights[:, :, None] * stiffness).reshape(-1, 6)
        return np.asarray(np.einsum("abc,ab->acb", self.strains, np.sqrt(D)))

    def section(self, root: ndarray, EA: float, EI: float) -> ndarray:
        """Return the section forces at start and end by the forces on the nodes, (m, 2, q, 9)."""
        return self.resultants

    def remarks(self, shear: float) -> list[Remark]:
        """Return a remark on GA / EI that hides bending in round-off."""
        stiff = shear * float(self.weights.sum()) ** 2
        if stiff <= _RIGID:
            return []
        text = (
            f"GA is {stiff:.1e} EI / L**2: beyond {_RIGID:.0e} round-off may hide the bending, and "
            "the system be singular; deflections of less GA differ by 3 EI / GA / L**2 only"
        )
        return [Remark("shear", stiff, text)]

    @property
    def length(self) -> ndarray:
        """Lengths, (m,)."""
        return np.asarray(self.weights.sum(axis=1))

    def tangents(self) -> ndarray:
        """Return unit tangents at start and end, (m, 2, dim)."""
        dN = np.array([shapes(xi)[1] for xi in (-1.0, 1.0)])
        along = np.einsum("ek,mkc->mec", dN, self.points)
        return np.asarray(along / np.linalg.norm(along, axis=2, keepdims=True))

    @cached_property
    def rigid(self) -> ndarray:
        """Dofs in rigid motions of unit motions of the middle node, (m, 9, 3)."""
        motion = np.zeros((len(self.points), 9, 3))
        u = motion[:, 0:6:2]
        v = motion[:, 1:6:2]
        theta = motion[:, 6:]
        u[..., 0] = 1.0
        v[..., 1] = 1.0
        theta[..., 2] = 1.0
        arm = self.points - self.points[:, [2]]
        u[..., 2] = -arm[..., 1]
        v[..., 2] = arm[..., 0]
        return motion

    def gauss(self) -> tuple[ndarray, ndarray, ndarray]:
        """Return the n = 2 m Gauss points, (n, dim), their lengths, (n,), and N at them, (n, 3)."""
        N = np.array([shapes(xi)[0] for xi in GAUSS])
        points = np.einsum("gk,mkc->gmc", N, self.points)
        points = points.reshape(-1, self.points.shape[2])
        functions = np.repeat(N, len(self.points), axis=0)
        return points, self.weights.T.ravel(), functions

    def sides(self, half: float) -> tuple[ndarray, ...]:
        """Return both sides, half a thickness off the axis, at the Gauss points: n = 4 m.

        Points and outward normals, (n, 2) each, lengths, (n,), and the shares of the nodes in a
        force on them, (n, 3).
        """
        parts = []
        for g, xi in enumerate(GAUSS):
            # Axis x, its normal n and curvature
            N, dN = shapes(xi)
            J = self.weights[:, g]
            x = np.einsum("k,mkc->mc", N, self.points)
            along = np.einsum("k,mkc->mc", dN, self.points)
            turn = np.einsum("k,mkc->mc", _CURVATURE, self.points)
            n = left_of(along) / J[:, None]
            curvature = (turn * n).sum(axis=1) / J**2
            shares = np.tile(N, (len(J), 1))
            for sign in (1.0, -1.0):
                length = J * (1.0 - sign * half * curvature)
                parts.append((x + sign * half * n, sign * n, length, shares))
        return tuple(np.concatenate(part) for part in zip(*parts, strict=True))

    @property
    def resultants(self) -> ndarray:
        """N, V and M at start and end by the forces on the nodes, (m, 2, 3, 9).

        Signs are as in ``SectionForces``. On an end node the forces of the neighbour count
        alone: not the share of a load on the element, a quarter of the force on the middle node.
        """
        result = np.zeros((len(self.points), 2, 3, 9))
        tangents = self.tangents()
        for end, sign in ((0, -1.0), (1, 1.0)):
            t = tangents[:, end]
            N, V, M = result[:, end].swapaxes(0, 1)
            # Take off the share of a load on the element: that of the middle node.
            for node, share in ((end, sign), (2, -sign * _AT_END)):
                u = slice(2 * node, 2 * node + 2)
                N[:, u] = share * t
                V[:, u] = share * left_of(t)
                M[:, 6 + node] = -share
        return result


@dataclass(frozen=True, eq=False)
class ShellElements(BeamElements):
    """Elements of shells of revolution about x = 0, per radian.

    They have q = 5 strains: the hoop strains u_x / x and theta t_x / x as well.

    Attributes
    ----------
    nu : float
        Poisson's ratio.
    radius : ndarray, shape (m, 2)
        Distances of the Gauss points from the axis.
    """

    nu: float
    radius: ndarray

    @classmethod
    def about_axis(cls, points: ndarray, nu: float) -> ShellElements:
        """Return the elements between nodes (m, 3, 2)."""
        if points[..., 0].min() <= _NO_LENGTH * np.ptp(points):
            raise ValueError("a shell of revolution lies at x > 0; at a pole leave a small hole")
        plane = BeamElements.of(points)
        m = len(points)
        x = points[:, :, 0]
        strains = np.zeros((m, 2, 5, 9))  # (elements, Gauss points, strains, dofs)
        strains[:, :, :3] = plane.strains.reshape(m, 2, 3, 9)
        # Hoop strain u_r / r, and hoop curvature theta t_r / r.
        radius = np.zeros((m, 2))
        for g, xi in enumerate(GAUSS):
            N, dN = shapes(xi)
            r = x @ N
            t_x = x @ dN / plane.weights[:, g]
            radius[:, g] = r
            strains[:, g, 3, 0:6:2] = N / r[:, None]
            strains[:, g, 4, 6:] = N * (t_x / r)[:, None]
        return cls(points, strains.reshape(m, 10, 9), plane.weights, nu, radius)

    @override
    def root(self, EA: float, GA: float, EI: float, GJ: float = 0.0) -> ndarray:
        # D couples eps with the hoop strain, and kappa with the hoop curvature, by nu
        D = np.diag([EA, GA, EI, EA, EI])
        D[[0, 3], [3, 0]] = self.nu * EA
        D[[2, 4], [4, 2]] = self.nu * EI
        # B^T L with D = L L^T: forces are B^T L times its transpose.
        area = np.sqrt(self.weights * self.radius)
        half = area[:, :, None, None] * np.linalg.cholesky(D)
        B = self.strains.reshape(-1, 2, 5, 9)
        return np.asarray(np.einsum("mgqj,mgqr->mjgr", B, half).reshape(-1, 9, 10))

    @override
    def section(self, root: ndarray, EA: float, EI: float) -> ndarray:
        """Return N, V and M per width at start and end, then N and M around the axis."""
        # Displacements by the forces, but for a rise along the axis
        stiffness = root @ root.transpose(0, 2, 1)
        moved = np.linalg.pinv(stiffness, hermitian=True)
        x = self.points[:, :2, 0]
        slope = self.tangents()[..., 0] / x
        turned = moved[:, 6:8] * slope[..., None]

        # N_h = nu N + (1 - nu**2) EA u_x / x, M_h = nu M - (1 - nu**2) EI theta t_x / x
        full = 1.0 - self.nu**2
        per_width = self.resultants / x[:, :, None, None]  # (elements, ends, 3, dofs)
        N, _, M = np.moveaxis(per_width, 2, 0)
        u_x = moved[:, [0, 2]]
        N_h = self.nu * N + full * EA * u_x / x[..., None]
        M_h = self.nu * M - full * EI * turned
        return np.concatenate((per_width, N_h[:, :, None], M_h[:, :, None]), axis=2)

    @cached_property
    @override
    def rigid(self) -> ndarray:
        motion = super().rigid
        motion[..., [0, 2]] = 0.0
        return motion

    @override
    def gauss(self) -> tuple[ndarray, ndarray, ndarray]:
        points, lengths, shares = super().gauss()
        return points, lengths, shares * points[:, [0]]

    @override
    def sides(self, half: float) -> tuple[ndarray, ...]:
        points, normals, lengths, shares = super().sides(half)
        return points, normals, lengths, shares * points[:, [0]]


class SpaceElements(BeamElements):
    """Elements in space, of round sections.

    They have q = 6 strains: stretching, two shear strains, two curvatures and the twist.
    """

    @classmethod
    @override
    def of(cls, points: ndarray) -> SpaceElements:
        m = len(points)
        strains = np.zeros((m, 2, 6, 18))  # (elements, Gauss points, strains, dofs)
        weights = np.zeros((m, 2))
        for g, xi in enumerate(GAUSS):
            weights[:, g], t, N, slope = _along(points, xi)
            # Strains along the axis; shears; bending and torsion.
            first, second = across(t)
            for row, axis, turned in ((0, t, 5), (1, first, 3), (2, second, 4)):
                along = _times(slope, axis)
                strains[:, g, row, :9] = along
                strains[:, g, turned, 9:] = along
            strains[:, g, 1, 9:] = -_times(N, second)
            strains[:, g, 2, 9:] = _times(N, first)
        return cls(points, strains.reshape(m, 12, 18), weights)

    @override
    def root(self, EA: float, GA: float, EI: float, GJ: float = 0.0) -> ndarray:
        stiffness = np.array([EA, GA, GA, EI, EI, GJ])
        D = (self.weights[:, :, None] * stiffness).reshape(-1, 12)
        return np.asarray(np.einsum("abc,ab->acb", self.strains, np.sqrt(D)))

    @cached_property
    @override
    def rigid(self) -> ndarray:
        motion = np.zeros((len(self.points), 6, 3, 6))
        u = motion[:, :3]
        theta = motion[:, 3:]
        # Three translations, then three rotations: u = e x arm.
        arm = self.points - self.points[:, [2]]
        for c, axis in enumerate(np.eye(3)):
            u[:, :, c, c] = 1.0
            u[..., 3 + c] = np.cross(axis, arm)
            theta[:, :, c, 3 + c] = 1.0
        return motion.reshape(-1, 18, 6)

    @property
    @override
    def resultants(self) -> ndarray:
        """Force and moment at start and end by the forces on the nodes, (m, 2, 6, 18)."""
        unit = np.eye(6)
        result = np.zeros((len(self.points), 2, 6, 6, 3))  # displacements of nodes, then rotations
        for end, sign in ((0, -1.0), (1, 1.0)):
            for node, share in ((end, sign), (2, -sign * _AT_END)):
                result[:, end, :, node] = share * unit[:, :3]
                result[:, end, :, 3 + node] = share * unit[:, 3:]
        return result.reshape(-1, 2, 6, 18)


class Flow(NamedTuple):
    """Flow of one element: its number, change of dofs without force, and faces in force, (k, 9)."""

    element: int
    free: ndarray
    faces: ndarray


class Hinges:
    """Hinges at both ends of m elements.

    The plastic flow is associated: of all forces within the strength those are taken that are
    nearest to the elastic ones in complementary energy, by least distance programming (C. L. Lawson
    and R. J. Hanson, Solving Least Squares Problems, 1974, chapter 23).

    Parameters
    ----------
    resultants : ndarray, shape (m, 2, 3, 9)
        N, V and M at both ends by the forces on the nodes.
    root : ndarray, shape (m, 9, 6)
        Matrices R of the elastic stiffness R R'.
    nodes : ndarray, shape (m, 2)
        Nodes at the ends.
    joined : ndarray
        Nodes at which an earlier beam ends, which flows first.
    Mp, Np : float
        Plastic moment and plastic normal force.
    """

    def __init__(
        self,
        resultants: ndarray,
        root: ndarray,
        nodes: ndarray,
        joined: ndarray,
        Mp: float,
        Np: float,
    ) -> None:
        # Faces f of the strength, f . force <= 1: (+-N / Np +- M / Mp), or +-M / Mp alone
        normal = (-1.0, 1.0) if np.isfinite(Np) else (0.0,)
        signs = np.array(list(product(normal, (-1.0, 1.0))))
        faces = np.einsum("fr,merj->mefj", signs / [Np, Mp], resultants[:, :, [0, 2]])
        later = _ranks(nodes.ravel()).reshape(nodes.shape) + np.isin(nodes, joined)
        faces /= (1.0 + _WEAKEST * later)[:, :, None, None]
        self._faces = faces.reshape(len(nodes), -1, 9)
        self._root = root

    def flows(self, force: ndarray) -> Iterator[Flow]:
        """Yield the flow of every element whose forces, (m, 9), exceed its strength."""
        # Faces of the yield surface that forces exceed.
        excess = np.einsum("mfj,mj->mf", self._faces, force) - 1.0
        for e in np.flatnonzero((excess > 0.0).any(axis=1)):
            faces = self._faces[e]
            # Return to the nearest point of the surface, in the norm of the energy.
            way = faces @ self._root[e]
            size = row_norms(way)

            # Solve in units of the largest distance: the solution is of order one
            far = (excess[e] / size).max()
            beyond = excess[e] / size / far
            A = np.vstack((way.T / size, beyond))
            b = np.append(np.zeros(way.shape[1]), 1.0)
            multiplier, _ = scipy.optimize.nnls(A, b)
            multiplier *= far / size / (1.0 - beyond @ multiplier)
            yield Flow(int(e), faces.T @ multiplier, faces[multiplier > 0.0])

    def tangent(self, stiffness: ndarray, flows: list[Flow]) -> ndarray:
        """Return the tangents, (m, 9, 9), of elastic elements and of elements that flow."""
        tangent = stiffness
        if flows:
            tangent = stiffness.copy()
        for e, _, faces in flows:
            root = self._root[e]
            modes = np.linalg.svd((faces @ root).T, full_matrices=False)
            independent = modes.U[:, modes.S / modes.S[0] > _DEPENDENT]
            released = root @ independent
            tangent[e] -= (1.0 - _KEPT) * released @ released.T
        return tangent


def _ranks(nodes: ndarray) -> ndarray:
    """Return how many earlier entries are the same, of each entry."""
    order = np.argsort(nodes, kind="stable")
    first = np.searchsorted(nodes[order], nodes[order])
    ranks = np.empty(len(nodes), int)
    ranks[order] = np.arange(len(nodes)) - first
    return ranks
