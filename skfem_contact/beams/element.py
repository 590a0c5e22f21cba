"""Three-node Timoshenko elements, straight or curved, in the plane, of shells and in space; hinges
at their ends.

Displacements and rotations are quadratic, and two Gauss points integrate all terms: no locking. The
dofs of an element are the displacements of its nodes (start, end, middle), then their rotations,
anticlockwise. Strains do not depend on the frame: with the tangent t, the normal n to its left and
the derivative ' by the arc length, eps = t . u', gamma = n . u' - theta, kappa = theta'.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.optimize import nnls
from typing_extensions import override

from ..errors import Remark

GAUSS = np.array([-1.0, 1.0]) / np.sqrt(3.0)
#: Second derivatives of the functions of the nodes.
_CURVATURE = np.array([1.0, 1.0, -2.0])
#: Share of the force on the middle node that a uniform load on the element leaves at either end.
_AT_END = 0.25
#: Stiffness against shear, times the squared length of the beam and over that against bending, up
#: to which a cantilever bends by 7e-9 of the exact value; with ten times as much its system is
#: singular.
_RIGID = 1e9
#: Length of an element, as a share of the size of the beam, that is none.
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
    return (
        np.array([0.5 * xi * (xi - 1.0), 0.5 * xi * (xi + 1.0), 1.0 - xi * xi]),
        np.array([xi - 0.5, xi + 0.5, -2.0 * xi]),
    )


def _along(points: ndarray, xi: float) -> tuple[ndarray, ndarray, ndarray, ndarray]:
    """Return lengths, (m,), tangents, (m, dim), functions and their derivatives by the arc length,
    (3,) and (m, 3).
    """
    N, dN = shapes(xi)
    along, chord = np.einsum("k,mkc->mc", dN, points), points[:, 1] - points[:, 0]
    if not (
        (along * chord).sum(axis=1) > _NO_LENGTH * np.ptp(points) * np.linalg.norm(chord, axis=1)
    ).all():
        raise ValueError("an element of a beam has no length, or its middle lies beyond its ends")
    J = np.linalg.norm(along, axis=1)[:, None]
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
        strains, weights = np.zeros((len(points), 6, 9)), np.zeros((len(points), 2))
        for g, xi in enumerate(GAUSS):
            weights[:, g], t, N, slope = _along(points, xi)
            n = np.column_stack((-t[:, 1], t[:, 0]))
            for row, direction in enumerate((t, n)):
                strains[:, 3 * g + row, :6] = (slope[:, :, None] * direction[:, None]).reshape(
                    -1, 6
                )
            strains[:, 3 * g + 1, 6:] = -N
            strains[:, 3 * g + 2, 6:] = slope
        return cls(points, strains, weights)

    def root(self, EA: float, GA: float, EI: float, GJ: float = 0.0) -> ndarray:
        """Return the matrices R of the stiffness R R', (m, 9, 2 q)."""
        D = (self.weights[:, :, None] * np.array([EA, GA, EI])).reshape(-1, 6)
        return np.asarray(np.einsum("abc,ab->acb", self.strains, np.sqrt(D)))

    def section(self, root: ndarray, EA: float, EI: float) -> ndarray:
        """Return the section forces at start and end by the forces on the nodes, (m, 2, q, 9)."""
        return self.resultants

    def remarks(self, shear: float) -> list[Remark]:
        """Return a remark on a stiffness against shear, over that against bending, that hides
        bending in round-off.
        """
        stiff = shear * float(self.weights.sum()) ** 2
        return (
            []
            if stiff <= _RIGID
            else [
                Remark(
                    "shear",
                    stiff,
                    f"GA is {stiff:.1e} EI / L**2: beyond {_RIGID:.0e} round-off may hide the "
                    f"bending, and the "
                    "system be singular; deflections of less GA differ by 3 EI / GA / L**2 only",
                )
            ]
        )

    @property
    def length(self) -> ndarray:
        """Lengths, (m,)."""
        return np.asarray(self.weights.sum(axis=1))

    def tangents(self) -> ndarray:
        """Return unit tangents at start and end, (m, 2, dim)."""
        along = np.stack(
            [np.einsum("k,mkc->mc", shapes(xi)[1], self.points) for xi in (-1.0, 1.0)], axis=1
        )
        return np.asarray(along / np.linalg.norm(along, axis=2, keepdims=True))

    @property
    def rigid(self) -> ndarray:
        """Dofs in rigid motions of unit motions of the middle node, (m, 9, 3)."""
        motion = np.zeros((len(self.points), 9, 3))
        arm = self.points - self.points[:, [2]]
        motion[:, 0:6:2, 0] = motion[:, 1:6:2, 1] = motion[:, 6:, 2] = 1.0
        motion[:, 0:6:2, 2], motion[:, 1:6:2, 2] = -arm[:, :, 1], arm[:, :, 0]
        return motion

    def gauss(self) -> tuple[ndarray, ndarray, ndarray]:
        """Return points, (n, dim), lengths, (n,), and the shares of the nodes in a force, (n, 3),
        at n = 2 m points.
        """
        values = np.array([shapes(xi)[0] for xi in GAUSS])
        points = np.einsum("gk,mkc->gmc", values, self.points).reshape(-1, self.points.shape[2])
        return points, self.weights.T.ravel(), np.repeat(values, len(self.points), axis=0)

    def sides(self, half: float) -> tuple[ndarray, ...]:
        """Return both sides, half a thickness off the axis, at the Gauss points: n = 4 m.

        Points and outward normals, (n, 2) each, lengths, (n,), and the shares of the nodes in a
        force there, (n, 3).
        """
        found = []
        for g, xi in enumerate(GAUSS):
            N, dN = shapes(xi)
            x, along, turn = (
                np.einsum("k,mkc->mc", part, self.points) for part in (N, dN, _CURVATURE)
            )
            J = self.weights[:, [g]]
            left = np.column_stack((-along[:, 1], along[:, 0])) / J
            bend = (turn * left).sum(axis=1) / J[:, 0] ** 2
            found += [
                (
                    x + sign * half * left,
                    sign * left,
                    J[:, 0] * (1.0 - sign * half * bend),
                    np.tile(N, (len(J), 1)),
                )
                for sign in (1.0, -1.0)
            ]
        return tuple(np.concatenate(parts) for parts in zip(*found, strict=True))

    @property
    def resultants(self) -> ndarray:
        """N, V and M at start and end by the forces on the nodes, (m, 2, 3, 9); signs of
        ``SectionForces``.

        Of the forces on an end node, those count that the neighbour exerts: not the share of a load
        on the element, a quarter of the force on the middle node.
        """
        found = np.zeros((len(self.points), 2, 3, 9))
        for end, sign in ((0, -1.0), (1, 1.0)):
            t = self.tangents()[:, end]
            n = np.column_stack((-t[:, 1], t[:, 0]))
            for node, share in ((end, sign), (2, -sign * _AT_END)):
                found[:, end, 0, 2 * node : 2 * node + 2] = share * t
                found[:, end, 1, 2 * node : 2 * node + 2] = share * n
                found[:, end, 2, 6 + node] = -share
        return found


@dataclass(frozen=True, eq=False)
class ShellElements(BeamElements):
    """Elements of shells of revolution about x = 0, per radian: q = 5 with the hoop strains u_x / x
    and theta t_x / x.

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
        strains, radius = np.zeros((len(points), 2, 5, 9)), np.zeros((len(points), 2))
        strains[:, :, :3] = plane.strains.reshape(-1, 2, 3, 9)
        for g, xi in enumerate(GAUSS):
            N, dN = shapes(xi)
            radius[:, g] = points[:, :, 0] @ N
            strains[:, g, 3, 0:6:2] = N / radius[:, [g]]
            strains[:, g, 4, 6:] = (
                N * (points[:, :, 0] @ dN / plane.weights[:, g] / radius[:, g])[:, None]
            )
        return cls(points, strains.reshape(-1, 10, 9), plane.weights, nu, radius)

    @override
    def root(self, EA: float, GA: float, EI: float, GJ: float = 0.0) -> ndarray:
        D = np.diag([EA, GA, EI, EA, EI])
        D[[0, 3, 2, 4], [3, 0, 4, 2]] = self.nu * np.array([EA, EA, EI, EI])
        half = np.sqrt(self.weights * self.radius)[:, :, None, None] * np.linalg.cholesky(D)
        return np.asarray(
            np.einsum("mgqj,mgqr->mjgr", self.strains.reshape(-1, 2, 5, 9), half).reshape(-1, 9, 10)
        )

    @override
    def section(self, root: ndarray, EA: float, EI: float) -> ndarray:
        """Return N, V and M per width at start and end, then N and M around the axis, by strains
        from the forces.
        """
        moved = np.linalg.pinv(
            root @ root.transpose(0, 2, 1), hermitian=True
        )  # but for a rise along the axis
        at, full = self.points[:, :2, 0], 1.0 - self.nu**2
        found = np.zeros((len(self.points), 2, 5, 9))
        found[:, :, :3] = self.resultants / at[:, :, None, None]
        found[:, :, 3] = self.nu * found[:, :, 0] + full * EA * moved[:, [0, 2]] / at[..., None]
        turned = moved[:, 6:8] * (self.tangents()[..., 0] / at)[..., None]
        found[:, :, 4] = self.nu * found[:, :, 2] - full * EI * turned
        return found

    @property
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
    """Elements in space, of round sections: q = 6 with two shear strains, two curvatures and the
    twist.
    """

    @classmethod
    @override
    def of(cls, points: ndarray) -> SpaceElements:
        m = len(points)
        strains, weights = np.zeros((m, 2, 6, 18)), np.zeros((m, 2))
        for g, xi in enumerate(GAUSS):
            weights[:, g], t, N, slope = _along(points, xi)
            first = np.cross(t, np.eye(3)[np.abs(t).argmin(axis=1)])
            first /= np.linalg.norm(first, axis=1)[:, None]
            second = np.cross(t, first)
            for row, axis in enumerate((t, first, second)):
                strains[:, g, row, :9] = (slope[:, :, None] * axis[:, None]).reshape(m, 9)
                strains[:, g, (5, 3, 4)[row], 9:] = strains[:, g, row, :9]
            strains[:, g, 1, 9:] = -(N[:, None] * second[:, None]).reshape(m, 9)
            strains[:, g, 2, 9:] = (N[:, None] * first[:, None]).reshape(m, 9)
        return cls(points, strains.reshape(m, 12, 18), weights)

    @override
    def root(self, EA: float, GA: float, EI: float, GJ: float = 0.0) -> ndarray:
        D = (self.weights[:, :, None] * np.array([EA, GA, GA, EI, EI, GJ])).reshape(-1, 12)
        return np.asarray(np.einsum("abc,ab->acb", self.strains, np.sqrt(D)))

    @property
    @override
    def rigid(self) -> ndarray:
        motion, arm = np.zeros((len(self.points), 18, 6)), self.points - self.points[:, [2]]
        for c in range(3):
            motion[:, c:9:3, c] = motion[:, 9 + c :: 3, 3 + c] = 1.0
            motion[:, :9, 3 + c] = np.cross(np.eye(3)[c], arm).reshape(-1, 9)
        return motion

    @property
    @override
    def resultants(self) -> ndarray:
        """Force and moment at start and end by the forces on the nodes, (m, 2, 6, 18)."""
        found = np.zeros((len(self.points), 2, 6, 18))
        for end, sign in ((0, -1.0), (1, 1.0)):
            for node, share in ((end, sign), (2, -sign * _AT_END)):
                for c in range(3):
                    found[:, end, c, 3 * node + c] = found[:, end, 3 + c, 9 + 3 * node + c] = share
        return found


class Flow(NamedTuple):
    """Flow of one element: its number, change of its dofs without force, and the faces in force,
    (k, 9).
    """

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
        signs = np.array(
            [(a, b) for a in (-1.0, 1.0) for b in (-1.0, 1.0)]
            if np.isfinite(Np)
            else [(0, -1), (0, 1)]
        )
        faces = np.einsum("fr,merj->mefj", signs / [Np, Mp], resultants[:, :, [0, 2]])
        later = _ranks(nodes.ravel()).reshape(nodes.shape) + np.isin(nodes, joined)
        self._faces = (faces / (1.0 + _WEAKEST * later)[:, :, None, None]).reshape(
            len(nodes), -1, 9
        )
        self._root = root

    def flows(self, force: ndarray) -> Iterator[Flow]:
        """Yield the flow of every element whose forces on the nodes, (m, 9), exceed its
        strength.
        """
        excess = np.einsum("mfj,mj->mf", self._faces, force) - 1.0
        for e in np.flatnonzero((excess > 0.0).any(axis=1)):
            faces = self._faces[e]
            way = faces @ self._root[e]
            size = np.linalg.norm(way, axis=1)
            far = (excess[e] / size).max()
            beyond = (
                excess[e] / size / far
            )  # all of them in units of the largest: the solution is of order one
            multiplier, _ = nnls(
                np.vstack((way.T / size, beyond)), np.append(np.zeros(way.shape[1]), 1.0)
            )
            multiplier *= far / size / (1.0 - beyond @ multiplier)
            yield Flow(int(e), faces.T @ multiplier, faces[multiplier > 0.0])

    def tangent(self, stiffness: ndarray, flows: list[Flow]) -> ndarray:
        """Return the tangents of all elements, (m, 9, 9), some of which flow, from the elastic
        ones.
        """
        tangent = stiffness.copy() if flows else stiffness
        for e, _, faces in flows:
            root = self._root[e]
            across = np.linalg.svd((faces @ root).T, full_matrices=False)
            lost = root @ across.U[:, _DEPENDENT * across.S[0] < across.S]
            tangent[e] -= (1.0 - _KEPT) * lost @ lost.T
        return tangent


def _ranks(nodes: ndarray) -> ndarray:
    """Return how many earlier entries are the same, of each entry."""
    order = np.argsort(nodes, kind="stable")
    first = np.searchsorted(nodes[order], nodes[order])
    ranks = np.empty(len(nodes), int)
    ranks[order] = np.arange(len(nodes)) - first
    return ranks
