"""Quarters of round piles and footings and of the ground around them, in layers of hexahedra."""

from __future__ import annotations

import meshio
import numpy as np
from numpy import ndarray
from skfem import MeshHex
from skfem.io.meshio import from_meshio

import skfem_contact as sc


def rings(m: int, radii: ndarray) -> tuple[ndarray, ndarray]:
    """Points (n, 2) and quadrilaterals (m, 4) of a quarter of rings, 2 m to the quarter."""
    angle = np.linspace(0, np.pi / 2, 2 * m + 1)
    points = radii[:, None, None] * np.stack((np.cos(angle), np.sin(angle)), axis=1)
    return points.reshape(-1, 2), _quads(len(radii), len(angle))


def disc(m: int, radius: float, inside: ndarray | None = None) -> tuple[ndarray, ndarray]:
    """The same of a disc: a square in the middle, and rings from there to the rim.

    The rings lie at shares of the way from the square to the rim, 0, 1/2 and 1 unless others are
    given.
    """
    share = np.array([0.0, 0.5, 1.0]) if inside is None else inside
    side = np.linspace(0, 0.6 * radius, m + 1)
    x, y = np.meshgrid(side, side, indexing="ij")
    end = np.full(m + 1, side[-1])
    edge = np.stack((np.append(end, side[-2::-1]), np.append(side, end[1:])), axis=1)
    angle = np.linspace(0, np.pi / 2, 2 * m + 1)
    rim = radius * np.stack((np.cos(angle), np.sin(angle)), axis=1)
    around = (edge + t * (rim - edge) for t in share)
    points = np.concatenate((np.stack((x.ravel(), y.ravel()), axis=1), *around))
    return points, np.concatenate((_quads(m + 1, m + 1), _quads(len(share), 2 * m + 1) + x.size))


def _quads(rows: int, columns: int) -> ndarray:
    k = np.arange(rows * columns).reshape(rows, columns)
    return np.stack((k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]), axis=-1).reshape(-1, 4)


def layers(section: tuple[ndarray, ndarray], z: ndarray) -> MeshHex:
    """A section drawn along z; coincident points become one."""
    points, quads = section
    _, first, inverse = np.unique(points.round(9), axis=0, return_index=True, return_inverse=True)
    points, quads, n = points[first], inverse.ravel()[quads], len(first)
    p = np.concatenate([np.column_stack((points, np.full(n, height))) for height in z])
    cells = np.concatenate(
        [np.hstack((quads + k * n, quads + (k + 1) * n)) for k in range(len(z) - 1)]
    )
    return from_meshio(meshio.Mesh(p, [("hexahedron", cells)]))


def pile_in_ground(
    m: int = 3, diameter: float = 0.6, length: float = 10.0, width: float = 6.0, n: int = 10
) -> MeshHex:
    """A quarter of a pile and of the ground around it, as deep as the pile is long: bodies ``pile``
    and ``soil``.
    """
    z = -length * np.linspace(1, 0, n + 1)
    radius = 0.5 * diameter
    soil = layers(rings(m, radius * (width / radius) ** np.linspace(0, 1, 8)), z)
    shaft = {"shaft": lambda x: np.isclose(np.hypot(*x[:2]), radius, rtol=0.05)}
    return sc.join_bodies(
        {
            "soil": soil.with_boundaries(shaft),
            "pile": layers(disc(m, radius), z).with_boundaries(shaft),
        }
    )


def ground_under_disc(m: int, size: float, growth: float, width: float) -> MeshHex:
    """A quarter of the ground under a disc of radius 1, with elements that grow away from its rim
    and the surface.
    """
    steps = size * growth ** np.arange(99)
    away = np.append(0.0, np.cumsum(steps))
    away = away[: np.searchsorted(away, width) + 1]
    inside = away[away < 0.35] / 0.4
    points, quads = disc(m, 1.0, np.append(1.0 - inside, 0.0)[::-1])
    more, others = rings(m, 1.0 + away)
    return layers(
        (np.concatenate((points, more)), np.concatenate((quads, others + len(points)))), -away[::-1]
    )


def short_pile_in_ground(
    m: int, first: float, growth: float, length: float, levels: int, width: float = 3.0
) -> MeshHex:
    """Half of a pile of diameter 1 and of the ground around and below it, on the side y > 0:
    ``pile``, ``soil``.

    The pile is a pipe of long facets that touch the nodes of the ground along their middles: there
    the ground slides around it as around a circle. Elements grow away from the shaft, and from its
    tip down.
    """
    steps = np.append(0.0, np.cumsum(first * growth ** np.arange(99)))
    away = steps[: np.searchsorted(steps, width - 0.5) + 1]
    below = -length - 2.0 * away[2.0 * away < width]
    along = -length * np.linspace(1, 0, levels + 1)
    quarter = layers(rings(m, 0.5 + away), np.append(below[:0:-1], along)) + layers(
        disc(m, 0.5, np.array([0.0, 1.0])), below[::-1]
    )
    soil = quarter + quarter.mirrored((1, 0, 0))
    faces = {
        "shaft": lambda x: (
            np.isclose(np.hypot(*x[:2]), 0.5, rtol=0.05) & (x[2] > -length) & (x[2] < -1e-9)
        ),
        "far": lambda x: (np.hypot(*x[:2]) > 0.95 * (0.5 + away[-1])) | np.isclose(x[2], below[-1]),
        "symmetry": lambda x: np.isclose(x[1], 0.0),
    }
    half = 0.25 * np.pi / m / 2
    angle = np.concatenate(([0.0], np.arange(half, np.pi, 2 * half), [np.pi]))
    rim = np.where((angle == 0.0) | (angle == np.pi), 0.5, 0.5 / np.cos(half))
    ring = rim[:, None] * np.stack((np.cos(angle), np.sin(angle)), axis=1)
    pipe = layers(
        (np.concatenate((0.7 * ring, ring)), _quads(2, len(angle))), np.array([-length, 0.2])
    )
    return sc.join_bodies(
        {
            "soil": soil.with_boundaries(faces),
            "pile": pipe.with_boundaries({"shaft": lambda x: np.hypot(*x[:2]) > 0.47}),
        }
    )
