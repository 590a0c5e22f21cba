"""One cone program for both bounds."""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from .normal_matrix import Block, NormalMatrix
from .strength import Cones, Strength


class Program:
    r"""Stresses in equilibrium with loads, within the strength.

    .. math:: A \sigma = f_0 + \theta f_1, \qquad h - G \sigma \in Q

    with :math:`A = \sum B^T` over all points and a product Q of second-order cones.  Of the lower bound
    :math:`\sigma` is the solution and of the upper one the dual, the velocities.

    Parameters
    ----------
    blocks
        Operators of triangles and interfaces.
    strengths
        Strength of the points in the order of their numbers.
    places
        Where the free velocities live, (2, m).
    dead, live
        Loads that are fixed, and multiplied, (m,).
    """

    def __init__(self, blocks: list[Block], strengths: list[Strength], places: ndarray, dead: ndarray,
                 live: ndarray) -> None:
        self.blocks, self.strengths, self.dead, self.live = blocks, strengths, dead, live
        self.starts = np.cumsum([0, *(len(s.reduced) for s in strengths)])
        self.n_points, self.size = int(self.starts[-1]), places.shape[1]
        cones = [strength.cones(int(first)) for strength, first in zip(strengths, self.starts)]
        self.cones = Cones.join([one for one, _ in cones] + [two for _, two in cones])
        self.places = places
        self.matrix = self._assembled()
        self.transposed = self.matrix.T.tocsr()

    def of_fixed_loads(self) -> Program:
        """The fixed loads alone, where all strength is reduced: its factor says whether anything stands at all."""
        strengths = [replace(s, reduced=np.ones(len(s.reduced), bool)) for s in self.strengths]
        return Program(self.blocks, strengths, self.places, self.dead, np.zeros(self.size))

    @cached_property
    def normal(self) -> NormalMatrix:
        """The matrix of the normal equations."""
        return NormalMatrix(self.blocks, self.places)

    def _assembled(self) -> csr_matrix:
        """The matrix A."""
        rows, columns, data = [], [], []
        for B, points, dofs in self.blocks:
            column = 3 * points[:, :, None, None] + np.arange(3)[:, None]
            row = np.broadcast_to(dofs[:, None, None], B.shape)
            used = (row >= 0) & (B != 0)
            rows.append(row[used])
            columns.append(np.broadcast_to(column, B.shape)[used])
            data.append(B[used])
        place = np.concatenate(rows), np.concatenate(columns)
        return csr_matrix((np.concatenate(data), place), shape=(self.size, 3 * self.n_points))

    def forces(self, stress: ndarray) -> ndarray:
        """A times stresses (n_points, 3), (m,)."""
        return self.matrix @ stress.ravel()

    def strains(self, velocity: ndarray) -> ndarray:
        """Strains times weight of velocities (m,), (n_points, 3)."""
        return (self.transposed @ velocity).reshape(-1, 3)

    def round_off(self, velocity: ndarray) -> ndarray:
        """Round-off of the strains at every point, (n_points,)."""
        size = (abs(self.transposed) @ np.abs(velocity)).reshape(-1, 3)
        return 8 * np.finfo(float).eps * size.max(axis=1)

    def of_points(self, function: Callable[[Strength, slice], ndarray]) -> ndarray:
        """What a function of strength and its points gives, for all points."""
        parts = [function(s, slice(a, b)) for s, a, b in zip(self.strengths, self.starts, self.starts[1:])]
        return np.concatenate(parts)

    @cached_property
    def volume(self) -> ndarray:
        """Component of strain that is the change of volume or the opening, (n_points, 3)."""
        return self.of_points(lambda s, points: np.broadcast_to(s.volume, (points.stop - points.start, 3)))
