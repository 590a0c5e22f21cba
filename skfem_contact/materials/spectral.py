"""Principal stresses, and the way back from principal to Cartesian components.

Isotropic laws are written once, in principal stresses; what differs between 4 components (plane strain,
axisymmetry) and 6 components (three dimensions) is all in this file.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from .base import Array, Parameter

# Principal stresses nearer than this fraction of the largest are treated as one in divided differences: the
# error of either branch is then the square root of the machine precision.
_COINCIDENT = 1e-8
# Outward margin of the trigonometric formula for 6 components, whose error is the square root of the machine
# precision where two principal stresses coincide.
_MARGIN = 1e-7
# Rows of the 6 components in the tensor.
_TENSOR = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
_ROW, _COLUMN = np.array([0, 1, 2, 0, 1, 2]), np.array([0, 1, 2, 1, 2, 0])


class Frame(Protocol):
    """Principal stresses of n points with their directions."""

    @property
    def values(self) -> Array:
        """Principal stresses in descending order, shape (3, n)."""

    def take(self, points: NDArray[np.intp]) -> Frame:
        """The same at a subset of the points."""

    def stress(self, values: Array) -> Array:
        """Cartesian components, shape (ncomp, n), of principal stresses (3, n) in these directions."""

    def tangent(self, moduli: Array, values: Array, shear: Parameter) -> Array:
        """Cartesian tangent, shape (n, ncomp, ncomp), of a return mapping from this (trial) frame.

        Parameters
        ----------
        moduli : ndarray, shape (3, 3, n)
            d principal stress / d principal strain.
        values : ndarray, shape (3, n)
            Principal stresses after the return.
        shear : float or ndarray, shape (n,)
            Elastic shear modulus.
        """


def principal(stress: Array) -> Frame:
    """Principal stresses and directions of stresses (4, n) or (6, n).

    Examples
    --------
    >>> principal(np.array([[3.0], [1.0], [9.0], [0.0]])).values.ravel()
    array([9., 3., 1.])
    """
    return _plane_frame(stress) if stress.shape[0] == 4 else _space_frame(stress)


def extremes(stress: Array) -> tuple[Array, Array]:
    """Upper bound of the largest and lower bound of the smallest principal stress, shape (...).

    The bounds are sharp for 4 components; for 6 they lie outside by 1e-7 of the deviatoric stress.

    Examples
    --------
    >>> largest, smallest = extremes(np.array([[3.0], [1.0], [9.0], [0.0]]))
    >>> float(largest[0]), float(smallest[0])
    (9.0, 1.0)
    """
    if stress.shape[0] == 4:
        centre, _, radius = _mohr_circle(stress)
        return np.maximum(centre + radius, stress[2]), np.minimum(centre - radius, stress[2])
    mean, shear = mean_and_shear(stress)
    xx, yy, zz = stress[:3] - mean
    xy, yz, zx = stress[3:]
    j3 = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx)
    radius = 2 / np.sqrt(3) * shear
    lode = np.arccos(np.clip(4 * j3 / np.where(radius > 0, radius, 1) ** 3, -1, 1)) / 3
    return (
        mean + radius * (np.cos(lode) + _MARGIN),
        mean + radius * (np.cos(lode + 2 * np.pi / 3) - _MARGIN),
    )


def mean_and_shear(stress: Array) -> tuple[Array, Array]:
    """Mean stress and sqrt(J2) of Cartesian components (4 or 6, ...) or of principal stresses (3, ...).

    Examples
    --------
    >>> mean, shear = mean_and_shear(np.array([[3.0], [1.0], [2.0]]))
    >>> float(mean[0]), float(shear[0])
    (2.0, 1.0)
    """
    mean = stress[0] + stress[1] + stress[2]
    mean /= 3
    squares = np.square(stress[0] - mean)
    squares += np.square(stress[1] - mean)
    squares += np.square(stress[2] - mean)
    squares /= 2
    for shear in stress[3:]:
        squares += shear * shear
    return mean, np.sqrt(squares, out=squares)


def _mohr_circle(stress: Array) -> tuple[Array, Array, Array]:
    """Centre, half the difference of the normal stresses, and radius of the in-plane Mohr circle."""
    centre = stress[0] + stress[1]
    centre *= 0.5
    half = stress[0] - stress[1]
    half *= 0.5
    radius = half * half
    radius += stress[3] * stress[3]
    return centre, half, np.sqrt(radius, out=radius)


def _shear_modulus(trial: Array, values: Array, moduli: Array, shear: Parameter, i: int, j: int) -> Array:
    """Modulus of the shear strain between the principal directions i and j.

    Rotating the trial directions turns the returned stress along, so that it is the elastic modulus times the
    divided difference of the returned over the trial stresses; where these coincide, its limit by the moduli.
    """
    gap = trial[i] - trial[j]
    close = np.flatnonzero(np.abs(gap) <= _COINCIDENT * np.maximum(trial[0], -trial[2]))
    gap[close] = 1
    modulus = shear * (values[i] - values[j]) / gap
    at = moduli[:, :, close]
    modulus[close] = (at[i, i] - at[i, j] - at[j, i] + at[j, j]) / 4
    return modulus


class _PlaneFrame(NamedTuple):
    """4 components.

    Cosine and sine are those of the double angle from x to the major in-plane direction; ``place`` is that of
    zz among the sorted principal stresses.
    """

    values: Array
    cos: Array
    sin: Array
    place: NDArray[np.int8]

    def take(self, points: NDArray[np.intp]) -> _PlaneFrame:
        return _PlaneFrame(self.values[:, points], self.cos[points], self.sin[points], self.place[points])

    def stress(self, values: Array) -> Array:
        major = np.where(self.place == 0, values[1], values[0])
        minor = np.where(self.place == 2, values[1], values[2])
        centre, radius = (major + minor) / 2, (major - minor) / 2
        normal, tangential = radius * self.cos, radius * self.sin
        zz = np.where(self.place == 1, values[1], np.where(self.place == 0, values[0], values[2]))
        return np.stack((centre + normal, centre - normal, zz, tangential))

    def tangent(self, moduli: Array, values: Array, shear: Parameter) -> Array:
        result = np.empty((self.cos.size, 4, 4))
        for place, (major, minor) in enumerate(((1, 2), (0, 2), (0, 1))):
            at = self.place == place
            if at.any():
                here = slice(None) if at.all() else np.flatnonzero(at)  # one place for all: nothing is picked out
                local = moduli[:, :, here]
                shear_here = shear[here] if isinstance(shear, np.ndarray) else shear
                modulus = _shear_modulus(
                    self.values[:, here], values[:, here], local, shear_here, major, minor
                )
                order = major, minor, place
                result[here] = _rotate_plane(local, order, modulus, self.cos[here], self.sin[here])
        return result


def _plane_frame(stress: Array) -> _PlaneFrame:
    centre, half, radius = _mohr_circle(stress)
    major, minor, zz = centre + radius, centre - radius, stress[2]
    middle = np.maximum(minor, np.minimum(major, zz))
    values = np.stack((np.maximum(major, zz), middle, np.minimum(minor, zz)))
    place = (zz <= major).astype(np.int8) + (zz < minor)
    round_ = radius == 0
    radius[round_], half[round_] = 1, 1
    return _PlaneFrame(values, half / radius, stress[3] / radius, place)


def _rotate_plane(moduli: Array, order: tuple[int, int, int], shear: Array, cos: Array, sin: Array) -> Array:
    """Tangent (n, 4, 4) from the moduli (3, 3, n), where ``order`` are the places of major, minor and zz."""
    i, j, k = order
    mean, half = (moduli[i] + moduli[j]) / 2, (moduli[i] - moduli[j]) / 2
    result = np.empty((4, 4, cos.size))
    (pp, pq, pz), (qp, qq, qz), (zp, zq, zz) = (
        ((row[i] + row[j]) / 2, (row[i] - row[j]) / 2, row[k]) for row in (mean, half, moduli[k])
    )
    even, odd = cos * cos * qq + sin * sin * shear, cos * sin * (qq - shear)
    result[0, 0], result[0, 1] = pp + cos * (pq + qp) + even, pp - cos * (pq - qp) - even
    result[1, 0], result[1, 1] = pp + cos * (pq - qp) - even, pp - cos * (pq + qp) + even
    result[0, 2], result[1, 2], result[3, 2] = pz + cos * qz, pz - cos * qz, sin * qz
    result[2, 0], result[2, 1], result[2, 3] = zp + cos * zq, zp - cos * zq, sin * zq
    result[0, 3], result[1, 3] = sin * pq + odd, sin * pq - odd
    result[3, 0], result[3, 1] = sin * qp + odd, sin * qp - odd
    result[2, 2], result[3, 3] = zz, sin * sin * qq + cos * cos * shear
    return result.transpose(2, 0, 1)


class _SpaceFrame(NamedTuple):
    """6 components: ``directions[:, :, i]`` is the unit vector of the i-th largest principal stress."""

    values: Array
    directions: Array

    def take(self, points: NDArray[np.intp]) -> _SpaceFrame:
        return _SpaceFrame(self.values[:, points], self.directions[points])

    def stress(self, values: Array) -> Array:
        return np.einsum("nci,in->cn", self._dyads(_ROW[:3], _ROW[:3]), values)

    def tangent(self, moduli: Array, values: Array, shear: Parameter) -> Array:
        local = np.zeros((values.shape[1], 6, 6))
        local[:, :3, :3] = moduli.transpose(2, 0, 1)
        for k in range(3, 6):
            local[:, k, k] = _shear_modulus(self.values, values, moduli, shear, _ROW[k], _COLUMN[k])
        dyads = self._dyads(_ROW, _COLUMN)
        return dyads @ local @ dyads.transpose(0, 2, 1)

    def _dyads(self, i: NDArray[np.intp], j: NDArray[np.intp]) -> Array:
        """Components (n, 6, len(i)) of the dyads n_i n_i, or n_i n_j + n_j n_i where i differs from j."""
        left, right = self.directions[:, :, i], self.directions[:, :, j]
        dyads = left[:, _ROW] * right[:, _COLUMN]
        return np.where(i == j, dyads, dyads + left[:, _COLUMN] * right[:, _ROW])


def _space_frame(stress: Array) -> _SpaceFrame:
    values, directions = np.linalg.eigh(stress[_TENSOR].transpose(2, 0, 1))
    return _SpaceFrame(np.ascontiguousarray(values[:, ::-1].T), directions[:, :, ::-1])


def largest_shear(strain: Array) -> Array:
    """Largest shear strain of engineering strains (4 or 6, ...); of plane ones that in their plane.

    Examples
    --------
    >>> largest_shear(np.array([[3.0], [0.0], [9.0], [4.0]]))
    array([5.])
    """
    if len(strain) == 4:
        return np.hypot(strain[0] - strain[1], strain[3])
    largest, smallest = extremes(np.concatenate((strain[:3], 0.5 * strain[3:])))
    return largest - smallest
