r"""Elements of beams that turn: the strains are those seen from a frame that follows the element.

The frame turns with the chord r from the start to the end of an element, by the angle
:math:`\alpha`. With nodes i at distances :math:`x_i` from the start, :math:`X_i` before
deformation, and the rotation matrix R, displacements and rotations in the frame are

.. math::

    \bar u_i = R^T x_i - X_i, \qquad \bar\theta_i = \theta_i - \alpha

which the linear element takes. Its energy gives forces :math:`q_i = R \bar f_i` at the nodes but
the start, which balances them, and a moment on the frame (M. A. Crisfield, Non-linear Finite
Element Analysis of Solids and Structures, volume 1, 1991, chapter 7):

.. math::

    f = \sum_i q_i + M_\alpha g, \qquad M_\alpha = -\sum_i (q_i \cdot J x_i + \bar m_i), \qquad
    g = \frac{d\alpha}{dr} = \frac{J r}{r \cdot r}

with the quarter turn J. Strains are small in the frame: elements are short enough that each bends
little.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy import ndarray

from ..arrays import left_of
from ..errors import IncrementTooLarge
from ..surfaces.vectors import dot

#: Dofs of displacements and of rotations of start, end and middle.
_MOVES = 6
_TURNS = 3
#: Length of a chord, as a share of the one before deformation, below which an element has folded.
_FOLDED = 1e-3


class Turned:
    """Elements at displacements and rotations of their nodes.

    Parameters
    ----------
    points : ndarray, shape (m, 3, 2)
        Coordinates of start, end and middle before deformation.
    u : ndarray, shape (m, 9)
        Displacements of the three nodes, then their rotations.

    Raises
    ------
    IncrementTooLarge
        Start and end of an element nearly coincide.
    """

    def __init__(self, points: ndarray, u: ndarray) -> None:
        moves = u[:, :_MOVES].reshape(-1, 3, 2)
        theta = u[:, _MOVES:]
        self._moves = moves
        # Distances from the start, before and after.
        self._before = points - points[:, :1]
        self._moved = moves - moves[:, :1]
        self.arms = self._before + self._moved
        self.chord = self.arms[:, 1]
        chord = self._before[:, 1]
        self.square = dot(self.chord, self.chord)
        if not (self.square > _FOLDED**2 * dot(chord, chord)).all():
            raise IncrementTooLarge("an element of a beam folds: its ends meet")

        # Angle between the chords, with the whole turns of the nodes.
        sine = dot(left_of(chord), self._moved[:, 1])
        angle = np.arctan2(sine, dot(chord, self.chord))
        turns = np.round((theta.mean(axis=1) - angle) / (2.0 * np.pi))
        self.angle = angle + 2.0 * np.pi * turns
        self._theta = theta

    @cached_property
    def _axes(self) -> tuple[ndarray, ndarray]:
        """Cosine and sine of the angle, (m, 1)."""
        return np.cos(self.angle)[:, None], np.sin(self.angle)[:, None]

    @property
    def motions(self) -> ndarray:
        """Displacements and rotations in the frame, (m, 9)."""
        # R^T x - X = R^T (x - X) + (R^T - 1) X, without differences of close numbers
        less = -2.0 * np.sin(0.5 * self.angle)[:, None, None] ** 2
        s = self._axes[1][:, None]
        change = less * self._before - s * left_of(self._before)
        local = self._back(self._moved) + change
        turned = self._theta - self.angle[:, None]
        return np.hstack((local.reshape(-1, _MOVES), turned))

    @property
    def sizes(self) -> ndarray:
        """Sizes of the terms of the motions, (m, 9), whose round-off these have."""
        first = np.abs(self._moves[:, :1])
        moves = np.abs(self._moves) + first + np.abs(self.arms)
        return np.hstack((moves.reshape(-1, _MOVES), np.abs(self._theta)))

    def _back(self, vectors: ndarray) -> ndarray:
        """Return ``R^T v`` of vectors, (m, n, 2)."""
        c, s = (part[:, None] for part in self._axes)
        return np.asarray(c * vectors - s * left_of(vectors))

    def _forward(self, vectors: ndarray) -> ndarray:
        """Return ``R v`` of vectors, (m, n, 2)."""
        c, s = (part[:, None] for part in self._axes)
        return np.asarray(c * vectors + s * left_of(vectors))

    @cached_property
    def _turn(self) -> ndarray:
        """Derivatives g of the angle, (m, 9)."""
        g = np.zeros((len(self.angle), _MOVES + _TURNS))
        g[:, 2:4] = left_of(self.chord) / self.square[:, None]
        g[:, :2] = -g[:, 2:4]
        return g

    def _moment(self, q: ndarray, force: ndarray) -> ndarray:
        """Return the moment on the frame, (m,)."""
        turning = (q * left_of(self.arms)).sum(axis=(1, 2))
        return np.asarray(-turning - force[:, _MOVES:].sum(axis=1))

    def force(self, force: ndarray) -> ndarray:
        """Return forces on the nodes, (m, 9), of forces in the frame, (m, 9)."""
        q = self._forward(force[:, :_MOVES].reshape(-1, 3, 2))
        result = np.hstack((_balanced(q), force[:, _MOVES:]))
        result += self._moment(q, force)[:, None] * self._turn
        return result

    def tangent(self, stiffness: ndarray, force: ndarray) -> ndarray:
        """Return tangents, (m, 9, 9), of stiffnesses, (m, 9, 9), and forces in the frame."""
        # Material part: B^T K B with the motions in the frame, d (motions) = B du.
        B = self._variations()
        K = B.transpose(0, 2, 1) @ stiffness @ B

        # The frame turns the forces: Q g^T + g Q^T - (sum q . x) g g^T, with Q = J q.
        q = self._forward(force[:, :_MOVES].reshape(-1, 3, 2))
        turned = _balanced(left_of(q))
        Q = np.hstack((turned, np.zeros((len(q), _TURNS))))
        g = self._turn
        both = Q[:, :, None] * g[:, None]
        K += both + both.transpose(0, 2, 1)
        pull = (q * self.arms).sum(axis=(1, 2))
        K -= pull[:, None, None] * g[:, :, None] * g[:, None]

        # The moment on the frame times the second derivatives of the angle.
        H = self._second() * self._moment(q, force)[:, None, None]
        K[:, :2, :2] += H
        K[:, 2:4, 2:4] += H
        K[:, :2, 2:4] -= H
        K[:, 2:4, :2] -= H
        return np.asarray(K)

    def _variations(self) -> ndarray:
        """Return the variations of the motions in the frame, (m, 9, 9)."""
        m = len(self.angle)
        c, s = (part[:, 0] for part in self._axes)
        R = np.array([[c, s], [-s, c]]).transpose(2, 0, 1)  # R^T, (m, 2, 2)
        B = np.zeros((m, _MOVES + _TURNS, _MOVES + _TURNS))
        # d(R^T x) = R^T (du - du_start) - R^T J x d(angle)
        arms = self._back(left_of(self.arms))
        for i in range(3):
            rows = slice(2 * i, 2 * i + 2)
            B[:, rows, rows] += R
            B[:, rows, :2] -= R
            B[:, rows] -= arms[:, i, :, None] * self._turn[:, None]
        B[:, _MOVES:, _MOVES:] = np.eye(_TURNS)
        B[:, _MOVES:] -= self._turn[:, None]
        return B

    def _second(self) -> ndarray:
        """Return second derivatives of the angle by the chord, (m, 2, 2)."""
        # -(n e^T + e n^T) / r^2 with unit vectors along the chord and to its left
        e = self.chord / np.sqrt(self.square)[:, None]
        n = left_of(e)
        H = n[:, :, None] * e[:, None]
        return -(H + H.transpose(0, 2, 1)) / self.square[:, None, None]


def _balanced(forces: ndarray) -> ndarray:
    """Return forces, (m, 6), of nodes with the start's in balance with the others, (m, 3, 2)."""
    result = forces.copy()
    result[:, 0] = -forces[:, 1:].sum(axis=1)
    return result.reshape(-1, _MOVES)
