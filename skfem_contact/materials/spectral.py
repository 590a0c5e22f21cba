"""Principal stresses, and the rotation from principal to Cartesian components.

Isotropic laws are written once, in principal stresses. Only this file distinguishes 4 components
(plane strain, axisymmetry) from 6 components (three dimensions).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .base import Array, Parameter

# Principal stresses nearer than this fraction of the largest are treated as one in divided
# differences: the error of either branch is then the square root of the machine precision.
_COINCIDENT = 1e-8
# Outward margin of the trigonometric formula for 6 components, whose error is the square root of
# the machine precision where two principal stresses coincide.
_MARGIN = 1e-7
# Component of each entry of a symmetric tensor; rows and columns of the 6 components.
TENSOR = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
ROW = np.array([0, 1, 2, 0, 1, 2])
COLUMN = np.array([0, 1, 2, 1, 2, 0])


def rotation(vectors: Array) -> Array:
    """Return the map of tensorial components to the principal axes, (..., 6, 6)."""
    # N^T T N: component (a, b) takes N_ia N_jb T_ij
    first = np.swapaxes(vectors[..., ROW], -1, -2)
    second = np.swapaxes(vectors[..., COLUMN], -1, -2)
    R = first[..., ROW] * second[..., COLUMN]
    R[..., 3:] += first[..., COLUMN[3:]] * second[..., ROW[3:]]
    return np.asarray(R)


def extremes(stress: Array) -> tuple[Array, Array]:
    """Return bounds of the largest and the smallest principal stress, shape (...).

    The upper and the lower bound are sharp for 4 components; for 6 they lie outside by 1e-7 of the
    deviatoric stress.
    """
    if stress.shape[0] == 4:
        centre, _, radius = _mohr_circle(stress)
        return np.maximum(centre + radius, stress[2]), np.minimum(centre - radius, stress[2])

    # Divide the deviator by r = 2 sqrt(J2 / 3): iterations far beyond a collapse reach 1e103.
    mean, shear = mean_and_shear(stress)
    radius = 2 / np.sqrt(3) * shear
    inverse = 1 / np.where(radius > 0, radius, 1)
    xx, yy, zz = (stress[:3] - mean) * inverse
    xy, yz, zx = stress[3:] * inverse

    # Compute its third invariant J3 / r^3, the determinant.
    first_minor = yy * zz - yz * yz
    second_minor = xy * zz - yz * zx
    third_minor = xy * yz - yy * zx
    j3 = xx * first_minor - xy * second_minor + zx * third_minor

    # s_i = mean + r cos(lode + 2 pi i / 3) with cos(3 lode) = 4 J3 / r^3
    lode = np.arccos(np.clip(4 * j3, -1, 1)) / 3
    largest = np.cos(lode) + _MARGIN
    smallest = np.cos(lode + 2 * np.pi / 3) - _MARGIN
    return mean + radius * largest, mean + radius * smallest


def mean_and_shear(stress: Array) -> tuple[Array, Array]:
    """Return mean stress and sqrt(J2) of Cartesian (4 or 6, ...) or principal stresses (3, ...)."""
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
    """Return centre, half difference of the normal stresses and radius of the in-plane circle."""
    centre = stress[0] + stress[1]
    centre *= 0.5
    half = stress[0] - stress[1]
    half *= 0.5
    radius = half * half
    radius += stress[3] * stress[3]
    return centre, half, np.sqrt(radius, out=radius)


def _shear_modulus(
    trial: Array,
    values: Array,
    moduli: Array,
    shear: Parameter,
    i: int,
    j: int,
) -> Array:
    """Return the modulus of the shear strain between the principal directions i and j.

    Rotating the trial directions turns the returned stress along, so that it is the elastic modulus
    times the divided difference of the returned over the trial stresses; where these coincide, its
    limit by the moduli.
    """
    gap = trial[i] - trial[j]
    largest = np.maximum(trial[0], -trial[2])
    close = np.flatnonzero(np.abs(gap) <= _COINCIDENT * largest)
    gap[close] = 1
    modulus = shear * (values[i] - values[j]) / gap
    own = moduli[i, i, close] - moduli[i, j, close]
    modulus[close] = (own - moduli[j, i, close] + moduli[j, j, close]) / 4
    return modulus


class _PlaneFrame(NamedTuple):
    """Principal stresses (3, n) in descending order with their directions, of 4 components."""

    values: Array
    cos: Array  # of the double angle from x to the major in-plane direction
    sin: Array
    rank: NDArray[np.int8]  # position of zz among the sorted principal stresses

    def take(self, points: NDArray[np.intp]) -> _PlaneFrame:
        """Return the frame at some of the points."""
        return _PlaneFrame(
            self.values[:, points], self.cos[points], self.sin[points], self.rank[points]
        )

    def stress(self, values: Array) -> Array:
        """Return the Cartesian components (ncomp, n) of principal stresses (3, n)."""
        s1, s2, s3 = values
        major = np.where(self.rank == 0, s2, s1)
        minor = np.where(self.rank == 2, s2, s3)
        zz = np.where(self.rank == 0, s1, s3)
        zz = np.where(self.rank == 1, s2, zz)
        centre = (major + minor) / 2
        radius = (major - minor) / 2
        normal = radius * self.cos
        return np.array((centre + normal, centre - normal, zz, radius * self.sin))

    def along(self, tensor: Array) -> Array:
        """Return the normal components (3, n) of a symmetric tensor (ncomp, n)."""
        xx, yy, zz, xy = tensor
        centre = (xx + yy) / 2
        radial = (xx - yy) / 2 * self.cos + xy * self.sin
        major = centre + radial
        minor = centre - radial
        first = np.where(self.rank == 0, zz, major)
        second = np.where(self.rank == 0, major, minor)
        second = np.where(self.rank == 1, zz, second)
        third = np.where(self.rank == 2, zz, minor)
        return np.array((first, second, third))

    def tangent(self, moduli: Array, values: Array, shear: Parameter) -> Array:
        """Return the Cartesian tangent (n, ncomp, ncomp) of a return mapping from this frame.

        The arguments are d principal stress / d principal strain, (3, 3, n), the principal stresses
        after the return, (3, n), and the elastic shear modulus.
        """
        # rotate the points in groups by the rank of the stress out of the plane
        result = np.empty((self.cos.size, 4, 4))
        for rank, (major, minor) in enumerate(((1, 2), (0, 2), (0, 1))):
            chosen = self.rank == rank
            if not chosen.any():
                continue
            # A slice copies nothing where all points have one rank.
            points = slice(None) if chosen.all() else np.flatnonzero(chosen)
            local = moduli[:, :, points]
            modulus = _shear_modulus(
                self.values[:, points],
                values[:, points],
                moduli=local,
                shear=shear[points] if isinstance(shear, np.ndarray) else shear,
                i=major,
                j=minor,
            )
            order = major, minor, rank
            result[points] = _rotate_plane(
                local, order, modulus, self.cos[points], self.sin[points]
            )
        return result


def _plane_frame(stress: Array) -> _PlaneFrame:
    """Return the frame of stresses (4, n)."""
    centre, half, radius = _mohr_circle(stress)
    major = centre + radius
    minor = centre - radius
    zz = stress[2]
    middle = np.maximum(minor, np.minimum(major, zz))
    values = np.array((np.maximum(major, zz), middle, np.minimum(minor, zz)))
    rank = (zz <= major).astype(np.int8) + (zz < minor)
    # Let the major direction be x where the stress in the plane is isotropic.
    isotropic = radius == 0
    radius[isotropic] = 1
    half[isotropic] = 1
    return _PlaneFrame(values, half / radius, stress[3] / radius, rank)


def _rotate_plane(
    moduli: Array,
    order: tuple[int, int, int],
    shear: Array,
    cos: Array,
    sin: Array,
) -> Array:
    """Return the tangent (n, 4, 4) of moduli (3, 3, n).

    With p and q the half sum and the half difference of the major and minor in-plane stresses, the
    normal stresses are p + q cos, p - q cos and zz, and the shear stress is q sin. The positions of
    major, minor and zz among the principal stresses are `order`.
    """
    # Transform the moduli to p, q and zz.
    major, minor, third = order
    p_row = (moduli[major] + moduli[minor]) / 2
    q_row = (moduli[major] - moduli[minor]) / 2

    def columns(row: Array) -> tuple[Array, Array, Array]:
        by_p = (row[major] + row[minor]) / 2
        by_q = (row[major] - row[minor]) / 2
        return by_p, by_q, row[third]

    pp, pq, pz = columns(p_row)
    qp, qq, qz = columns(q_row)
    zp, zq, zz = columns(moduli[third])

    # Rotate them to x and y.
    even = cos * cos * qq + sin * sin * shear
    odd = cos * sin * (qq - shear)
    result = np.empty((4, 4, cos.size))
    result[0, 0] = pp + cos * (pq + qp) + even
    result[0, 1] = pp - cos * (pq - qp) - even
    result[1, 0] = pp + cos * (pq - qp) - even
    result[1, 1] = pp - cos * (pq + qp) + even
    result[0, 2] = pz + cos * qz
    result[1, 2] = pz - cos * qz
    result[3, 2] = sin * qz
    result[2, 0] = zp + cos * zq
    result[2, 1] = zp - cos * zq
    result[2, 3] = sin * zq
    result[0, 3] = sin * pq + odd
    result[1, 3] = sin * pq - odd
    result[3, 0] = sin * qp + odd
    result[3, 1] = sin * qp - odd
    result[2, 2] = zz
    result[3, 3] = sin * sin * qq + cos * cos * shear
    return result.transpose(2, 0, 1)


class _SpaceFrame(NamedTuple):
    """Principal stresses (3, n) in descending order with their directions, of 6 components."""

    values: Array
    directions: Array  # (n, 3, 3), [:, :, i] is the unit vector of the i-th largest stress

    def take(self, points: NDArray[np.intp]) -> _SpaceFrame:
        """Return the frame at some of the points."""
        return _SpaceFrame(self.values[:, points], self.directions[points])

    def stress(self, values: Array) -> Array:
        """Return the Cartesian components (ncomp, n) of principal stresses (3, n)."""
        dyads = self._dyads(ROW[:3], ROW[:3])
        return np.einsum("nci,in->cn", dyads, values)

    def along(self, tensor: Array) -> Array:
        """Return the normal components (3, n) of a symmetric tensor (ncomp, n)."""
        return np.einsum("nik,ijn,njk->kn", self.directions, tensor[TENSOR], self.directions)

    def tangent(self, moduli: Array, values: Array, shear: Parameter) -> Array:
        """Return the Cartesian tangent (n, ncomp, ncomp), see :meth:`_PlaneFrame.tangent`."""
        n = values.shape[1]
        local = np.zeros((n, 6, 6))
        local[:, :3, :3] = moduli.transpose(2, 0, 1)
        for k in range(3, 6):
            i = ROW[k]
            j = COLUMN[k]
            local[:, k, k] = _shear_modulus(self.values, values, moduli, shear, i, j)
        dyads = self._dyads(ROW, COLUMN)
        return dyads @ local @ dyads.transpose(0, 2, 1)

    def _dyads(self, i: NDArray[np.intp], j: NDArray[np.intp]) -> Array:
        """Return (n, 6, len(i)) components of n_i n_i, or of n_i n_j + n_j n_i if i is not j."""
        left = self.directions[:, :, i]
        right = self.directions[:, :, j]
        dyads = left[:, ROW] * right[:, COLUMN]
        return np.where(i == j, dyads, dyads + left[:, COLUMN] * right[:, ROW])


Frame = _PlaneFrame | _SpaceFrame


def principal(stress: Array) -> Frame:
    """Return principal values and directions of stresses (4, n) or (6, n)."""
    if stress.shape[0] == 4:
        return _plane_frame(stress)
    values, directions = np.linalg.eigh(stress[TENSOR].transpose(2, 0, 1))
    falling = np.ascontiguousarray(values[:, ::-1].T)
    return _SpaceFrame(falling, directions[:, :, ::-1])


def principal_stresses(stress: Array) -> Array:
    """Return principal stresses (3, ...) of stresses (4 or 6, ...) in descending order."""
    frame = principal(stress.reshape(len(stress), -1))
    return frame.values.reshape(3, *stress.shape[1:])


def largest_shear(strain: Array) -> Array:
    """Return the largest shear strain of engineering strains (4 or 6, ...); of 4 in their plane."""
    if len(strain) == 4:
        return np.hypot(strain[0] - strain[1], strain[3])
    largest, smallest = extremes(np.concatenate((strain[:3], 0.5 * strain[3:])))
    return largest - smallest


def square(e: Array) -> Array:
    """Return e:e of a deviator with tensor shears."""
    normal = np.square(e[:3]).sum(axis=0)
    shear = np.square(e[3:]).sum(axis=0)
    return normal + 2 * shear


def product(e: Array, f: Array) -> Array:
    """Return e:f of two deviators with tensor shears."""
    normal = (e[:3] * f[:3]).sum(axis=0)
    shear = (e[3:] * f[3:]).sum(axis=0)
    return normal + 2 * shear


def deviator(ncomp: int) -> Array:
    """Return the matrix from engineering strains to their deviator with tensor shears."""
    unit = np.diag(np.r_[1.0, 1.0, 1.0, np.full(ncomp - 3, 0.5)])
    unit[:3, :3] -= 1 / 3
    return unit
