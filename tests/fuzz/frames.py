"""The same scene seen otherwise: mirrored, turned, shifted, or in other units."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy import ndarray


@dataclass(frozen=True)
class Frame:
    """How places, displacements, forces and stresses of a scene are written down.

    Attributes
    ----------
    matrix
        Orthogonal matrix that turns or mirrors vectors, (dim, dim).
    shift
        Of the origin, in lengths of the scene, (dim,).
    length, stress
        One unit of the scene in the units of the frame.
    """

    matrix: ndarray
    shift: ndarray = field(default_factory=lambda: np.zeros(1))
    length: float = 1.0
    stress: float = 1.0

    def places(self, points: ndarray) -> ndarray:
        """Coordinates, (dim, n), of points (dim, n)."""
        return self.length * (self.matrix @ points + self.shift[:, None])

    def displacements(self, x: ndarray) -> ndarray:
        """Displacements (N,) of the scene in the frame."""
        return self.length * self._turned(x, self.matrix)

    def forces(self, f: ndarray, power: int) -> ndarray:
        """Nodal forces (N,) of the scene in the frame; they are stresses times a power of the
        length.
        """
        return self.stress * self.length**power * self._turned(f, self.matrix)

    def back(self, x: ndarray) -> ndarray:
        """Displacements (N,) in the frame as they are in the scene."""
        return self._turned(x, self.matrix.T) / self.length

    @staticmethod
    def _turned(vectors: ndarray, matrix: ndarray) -> ndarray:
        return (vectors.reshape(-1, len(matrix)) @ matrix.T).ravel()


def as_drawn(dim: int) -> Frame:
    """The frame of the scene itself."""
    return Frame(np.eye(dim))


def mirrored(dim: int, axis: int) -> Frame:
    """One coordinate with the other sign."""
    return Frame(np.diag(np.where(np.arange(dim) == axis, -1.0, 1.0)))


def turned(dim: int, angle: float) -> Frame:
    """Turned in the plane of the first two coordinates, in space in that of the last two as
    well.
    """
    c, s = np.cos(angle), np.sin(angle)
    matrix = np.eye(dim)
    matrix[:2, :2] = [[c, -s], [s, c]]
    if dim == 3:
        again = np.eye(3)
        again[1:, 1:] = [[c, -s], [s, c]]
        matrix = again @ matrix
    return Frame(matrix)


def shifted(dim: int, shift: ndarray) -> Frame:
    """Far from the origin."""
    return Frame(np.eye(dim), shift)


def in_units(dim: int, length: float, stress: float) -> Frame:
    """In other units."""
    return Frame(np.eye(dim), length=length, stress=stress)
