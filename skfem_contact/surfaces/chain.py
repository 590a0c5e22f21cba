"""The chain of a surface in the plane: its facets one after the other, with an arc position along them."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import ndarray

from .material_points import MaterialPoints
from .surface import Surface

_GAUSS = np.polynomial.legendre.leggauss(5)


@dataclass(frozen=True, eq=False)
class Chain:
    """Arc positions along a surface in the plane, in the reference configuration.

    Attributes
    ----------
    surface
        Its facets follow each other, with the body to the right; a closed one ends where it begins.
    start
        Arc position of the facets' first ends, (n_facets,).

    Examples
    --------
    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> floor = Chain.of(sc.rigid_polyline([(0., 0.), (1., 0.), (4., 0.)]))
    >>> floor.arc(np.array([1]), np.array([[0.0]])).tolist()
    [2.5]
    """

    surface: Surface
    start: ndarray

    @classmethod
    def of(cls, surface: Surface) -> Chain:
        """The chain of a surface in the plane."""
        return cls(surface, np.concatenate(([0.0], np.cumsum(surface.area)[:-1])))

    @property
    def closed(self) -> bool:
        """Whether the last facet ends where the first begins."""
        return self.surface.closed

    def arc(self, facet: ndarray, xi: ndarray) -> ndarray:
        """Arc position of points, (n,)."""
        surface, first = self.surface, self.start[facet]
        half = 0.5 * (xi[:, 0] + 1.0)
        if surface.shape.affine:
            return np.asarray(first + half * surface.area[facet])
        nodes = surface.nodes - surface.nodes[0]  # large coordinates would cost digits
        t, w = _GAUSS
        inner = -1.0 + half[:, None] * (t + 1.0)  # five Gauss points on [-1, xi]
        tangent = surface.at(np.repeat(facet, len(t)), inner.reshape(-1, 1), nodes, 1).x[1][:, 0]
        return np.asarray(first + half * (np.linalg.norm(tangent, axis=1).reshape(-1, len(t)) @ w))

    def way(self, closest: MaterialPoints, before: MaterialPoints) -> ndarray:
        """Way from material points to others along the chain, (n,), the short way round a closed one; zero for none."""
        way = np.where(closest.exist & before.exist, self.arc(*closest) - self.arc(*before), 0.0)
        total = float(self.surface.area.sum())
        return (way + 0.5 * total) % total - 0.5 * total if self.closed else way
