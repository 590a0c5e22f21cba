"""Iterates of a mesh on a refinement of it, from which its interior points begin.

Averages of values within a cone are within it: stresses and multipliers are linear in every
triangle, and those of joints the ones of the nearest facet.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy import ndarray

from .elements import Program
from .interior_point import Iterate
from .triangles import Triangles, closest, facet_lengths, gradients, middles


def carried(
    iterate: Iterate,
    coarse: tuple[Triangles, Program],
    fine: tuple[Triangles, Program],
    parent: ndarray,
) -> Iterate | None:
    """Return an iterate at the points of a refinement whose triangles have parents, (n_elements,).

    None where a joint has no points on the coarse mesh.
    """
    before = coarse[1]
    after = fine[1]
    if len(before.joints) != len(after.joints):
        return None
    averages = [_in_soil(coarse, fine, parent), *_in_joints(coarse, fine)]
    points, shares, sizes = (np.concatenate(parts) for parts in zip(*averages))

    # second cones of points take the values of second cones, where there are some
    second = np.arange(before.n_points)
    second[before.cones.at[before.n_points :]] = np.arange(before.n_points, len(before.cones.at))
    at = after.cones.at
    cones = points[at]
    cones[after.n_points :] = second[cones[after.n_points :]]

    # multipliers contain the weight of their points
    size = sizes[at, None]
    return Iterate(
        iterate.theta,
        iterate.factor,
        stress=_average(shares, iterate.stress[points]),
        s=_average(shares[at], iterate.s[cones]),
        z=size * _average(shares[at], iterate.z[cones]),
    )


def _average(shares: ndarray, values: ndarray) -> ndarray:
    """Return averages of three values, (n, 3, ...), with their shares, (n, 3)."""
    return np.einsum("pk,pks->ps", shares, values)


class _Averages(NamedTuple):
    """Averages of three points of the coarse mesh for every point of the fine one."""

    points: ndarray  # numbers on the coarse mesh, (n, 3)
    shares: ndarray  # (n, 3)
    sizes: ndarray  # weight of the point over that of the coarse points, (n,)


def _in_soil(
    coarse: tuple[Triangles, Program],
    fine: tuple[Triangles, Program],
    parent: ndarray,
) -> _Averages:
    """Return the averages at the corners of triangles that can yield."""
    mesh = coarse[0].mesh
    soft = fine[1].soft
    owner = parent[soft]
    area = gradients(mesh)[1]
    new_area = gradients(fine[0].mesh)[1]

    # linear functions of the parent at the corners of its parts
    shares = fine[0].within(mesh, parent)[soft].reshape(-1, 3)
    corners = 3 * np.searchsorted(coarse[1].soft, owner)[:, None] + np.arange(3)
    points = np.repeat(corners, 3, axis=0)
    return _Averages(points, np.maximum(shares, 0.0), np.repeat(new_area[soft] / area[owner], 3))


def _in_joints(
    coarse: tuple[Triangles, Program],
    fine: tuple[Triangles, Program],
) -> list[_Averages]:
    """Return the averages of joints: the points of the nearest facet."""
    averages = []
    first = 3 * len(coarse[1].soft)
    for before, after in zip(coarse[1].joints, fine[1].joints):
        old = coarse[0].mesh
        new = fine[0].mesh
        near = closest(middles(old, before.slave), middles(new, after.slave))[1]
        n_at_each = after.B.shape[1]
        numbers = first + n_at_each * near[:, None] + np.arange(n_at_each)
        points = np.repeat(numbers.reshape(-1, 1), 3, axis=1)
        length = facet_lengths(new)[after.slave] / facet_lengths(old)[before.slave[near]]
        averages.append(
            _Averages(points, np.full(points.shape, 1 / 3), np.repeat(length, n_at_each))
        )
        first += before.B.shape[1] * len(before.slave)
    return averages
