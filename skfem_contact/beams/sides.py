"""Sides of walls and beams, and the facets of the ground that they face, whose water presses on
them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree
from skfem import FacetBasis

from ..checks import format_point
from ..layout import elements_of

#: Facets that are tried first as the one that another faces, and how far off one that touches may
#: lie, over its size: the rise of an arc of 16 chords is .05 of a chord.
_NEAR, _OFF = 16, 0.1


def surroundings(outside: FacetBasis) -> list[ndarray]:
    """Return middles, normals, (n, dim) each, and sizes of facets, (n,)."""
    middle, normal = (
        np.asarray(values).mean(axis=2).T
        for values in (outside.global_coordinates(), outside.normals)
    )
    return [middle, normal, outside.dx.sum(axis=1) ** (1.0 / (outside.mesh.dim() - 1))]


def pressure_beside(
    outside: FacetBasis, porous: ndarray, pressure: Any, sides: Sequence[ndarray]
) -> ndarray:
    """Return the pressure at points in the plane of other sides, given by points, normals and
    sizes.

    Facets outside of the bodies, some of which have porous elements, are those that the sides may
    face.
    """
    if callable(pressure):
        return np.asarray(pressure(sides[0].T))
    around = [np.concatenate(parts) for parts in zip(surroundings(outside), sides)]
    facets = facing(around, np.append(porous, np.zeros(len(sides[0]), bool)))[len(porous) :]
    faces, values = facets < len(porous), np.zeros(len(facets))
    values[faces] = _opposite(outside, pressure, facets[faces], sides[0][faces])
    return values


def _opposite(outside: FacetBasis, pressure: Any, facets: ndarray, points: ndarray) -> ndarray:
    """Return the pressure at points (n, 2) by the head, level or pressure at the nearest points of
    facets (n,).
    """
    mesh, owner, values = outside.mesh, outside.tind[facets], np.zeros(len(points))
    ends = mesh.facets[:, outside.find[facets]]
    a, b = mesh.p[:, ends].transpose(1, 2, 0)
    share = np.clip(((points - a) * (b - a)).sum(axis=1) / ((b - a) ** 2).sum(axis=1), 0.0, 1.0)
    weights = np.stack((1.0 - share, share))
    if (porous := getattr(pressure, "basis", None)) is not None:
        wet = np.isin(owner, elements_of(porous))
        values[wet] = pressure.pressure_at(
            points[wet].T, (weights * pressure.head[ends]).sum(axis=0)[wet]
        )
        return values
    for name, given in (pressure if isinstance(pressure, Mapping) else {"": pressure}).items():
        here = np.isin(owner, mesh.subdomains[name]) if name else np.full(len(points), True)
        values[here] = (
            given(points[here].T) if callable(given) else (weights * given[ends]).sum(axis=0)[here]
        )
        off = np.linalg.norm(a + share[:, None] * (b - a) - points, axis=1) > _OFF * np.linalg.norm(
            b - a, axis=1
        )
        if not callable(given) and (lost := here & off & (values > 0.0)).any():
            raise ValueError(
                "pressures at the vertices do not say what presses on a beam above the ground, at "
                f"{format_point(points[lost][0])}: give water levels or a seepage"
            )
    return values


def facing(sides: Sequence[ndarray], porous: ndarray) -> ndarray:
    """Return for each facet itself where its element is porous, else the nearest porous facet that
    it faces.

    Ground on the other side of a wall is not faced: it lies behind, or its normal has the same
    direction.
    """
    middle, normal, size = sides
    wet, faced = np.flatnonzero(porous), np.arange(len(middle))
    if len(wet):
        tree = cKDTree(middle[wet])
        for facet in np.setdiff1d(faced, wet):
            for n in (min(_NEAR, len(wet)), len(wet)):
                near = wet[np.atleast_1d(tree.query(middle[facet], n)[1])]
                distance = middle[near] - middle[facet]
                ahead, turned = distance @ normal[facet], normal[near] @ normal[facet]
                apart = np.linalg.norm(distance, axis=1)
                close = apart < 0.495 * (size[facet] + size[near])
                touching = close & (turned < -0.5) & (abs(ahead) < _OFF * size[facet])
                facing = touching | ((turned < 0.5) & (ahead > _OFF**2 * apart))
                if facing.any():
                    faced[facet] = near[facing.argmax()]
                    break
    return faced
