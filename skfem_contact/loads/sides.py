"""Sides of bodies, walls and beams, and the facets of the ground that they face."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy
from numpy import ndarray
from skfem import FacetBasis

from ..arrays import row_norms

#: Number of near facets that are tried first as the one that another facet faces.
_NEAR = 16
#: Distance from the plane of a facet that touches it, over its size: the rise of an arc of 16
#: chords is .05 of a chord.
_OFF = 0.1
#: Distance of the middles of facets that touch, over the sum of their sizes: nearly a half.
_TOUCHING = 0.495
#: Cosine between the normals of facets that touch, and of facets that are apart, at most.
_OPPOSITE = -0.5
_TURNED = 0.5


class Sides(NamedTuple):
    """Middles and outward normals of flat sides, (n, dim) each, and their sizes, (n,)."""

    middle: ndarray
    normal: ndarray
    size: ndarray

    @classmethod
    def of(cls, outside: FacetBasis) -> Sides:
        """Return the sides of the facets of a basis."""
        middle = np.asarray(outside.global_coordinates()).mean(axis=2).T
        normal = np.asarray(outside.normals).mean(axis=2).T
        size = outside.dx.sum(axis=1) ** (1.0 / (outside.mesh.dim() - 1))
        return cls(middle, normal, size)

    def followed_by(self, further: Sides) -> Sides:
        """Return these sides, then the further ones."""
        return Sides(*(np.concatenate(parts) for parts in zip(self, further, strict=True)))


def facing(sides: Sides, porous: ndarray) -> ndarray:
    """Return each porous facet itself, for others the nearest porous facet that they face, (n,).

    Ground on the opposite side of a wall is not faced: it lies behind the facet, or its normal has
    the same direction. A facet that faces none is its own.
    """
    faced = np.arange(len(porous))
    candidates = np.flatnonzero(porous)
    if len(candidates) == 0:
        return faced
    tree = scipy.spatial.cKDTree(sides.middle[candidates])
    few = min(_NEAR, len(candidates))
    for facet in np.flatnonzero(~porous):
        # Try the nearest facets first, then all of them.
        for tried in (few, len(candidates)):
            near = candidates[np.atleast_1d(tree.query(sides.middle[facet], tried)[1])]
            faces = _faces(sides, facet, near)
            if faces.any():
                faced[facet] = near[faces.argmax()]
                break
    return faced


def _faces(sides: Sides, facet: Any, near: ndarray) -> ndarray:
    """Return which of the near facets a facet faces, (n,)."""
    offset = sides.middle[near] - sides.middle[facet]
    distance = row_norms(offset)
    ahead = offset @ sides.normal[facet]
    cosine = sides.normal[near] @ sides.normal[facet]
    # Facets that touch lie in one plane and look at each other.
    close = distance < _TOUCHING * (sides.size[facet] + sides.size[near])
    in_plane = abs(ahead) < _OFF * sides.size[facet]
    touching = close & (cosine < _OPPOSITE) & in_plane
    # Facets that are apart lie in front.
    in_front = (cosine < _TURNED) & (ahead > _OFF**2 * distance)
    return np.asarray(touching | in_front)
