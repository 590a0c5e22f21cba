"""Shape functions of facets as polynomials, whose derivatives of any order are polynomials too."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import product

import numpy as np
from numpy import ndarray
from skfem import (
    Element,
    ElementHex1,
    ElementHex2,
    ElementHexS2,
    ElementLineP1,
    ElementLineP2,
    ElementQuad1,
    ElementQuad2,
    ElementQuadS2,
    ElementTetP1,
    ElementTetP2,
    ElementTriP1,
    ElementTriP2,
)
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTri

_BILINEAR = ((0, 0), (1, 0), (0, 1), (1, 1))
#: scikit-fem's element of the facets of an element, and the exponents of its monomials.
_FACETS: dict[type[Element], tuple[type[Element], Sequence[tuple[int, ...]]]] = {
    ElementTriP1: (ElementLineP1, ((0,), (1,))),
    ElementQuad1: (ElementLineP1, ((0,), (1,))),
    ElementTriP2: (ElementLineP2, ((0,), (1,), (2,))),
    ElementQuad2: (ElementLineP2, ((0,), (1,), (2,))),
    ElementQuadS2: (ElementLineP2, ((0,), (1,), (2,))),
    ElementTetP1: (ElementTriP1, ((0, 0), (1, 0), (0, 1))),
    ElementTetP2: (ElementTriP2, ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))),
    ElementHex1: (ElementQuad1, _BILINEAR),
    ElementHexS2: (ElementQuadS2, (*_BILINEAR, (2, 0), (0, 2), (2, 1), (1, 2))),
    ElementHex2: (ElementQuad2, tuple(product(range(3), repeat=2))),
}


@dataclass(frozen=True, eq=False)
class Shape:
    """Polynomial shape functions.

    Lines and quadrilaterals span -1 to 1, as in the paper, triangles 0 to 1.

    Attributes
    ----------
    exponents : ndarray, shape (p, dim - 1)
        Exponents of the monomials.
    coefficients : ndarray, shape (1, k, p) or (n_facets, k, p)
        Coefficients of the shape functions, the latter where facets differ.
    corners : ndarray, shape (n_corners, dim - 1)
        Local coordinates of the corners, anticlockwise if more than two.
    nodes : ndarray, shape (k, dim - 1)
        Local coordinates of the nodes, before smoothing.
    """

    exponents: ndarray
    coefficients: ndarray
    corners: ndarray
    nodes: ndarray

    @classmethod
    def of_facets(cls, element: Element) -> Shape:
        """Return the shape functions of an element's facets."""
        facet, exponents = _FACETS[type(element)]
        powers = np.array(exponents)
        nodes = facet.doflocs
        if facet.refdom.nnodes != 3:
            nodes = 2.0 * nodes - 1.0
        corners = nodes[: facet.refdom.nnodes]
        monomials = np.prod(nodes[:, None, :] ** powers, axis=2)
        coefficients = np.round(np.linalg.inv(monomials).T, 12)  # halves and quarters
        return cls(powers, coefficients[None], corners, nodes)

    @classmethod
    def of_cells(cls, dim: int, k: int) -> Shape:
        """Return the shape functions of facets with k nodes; a KeyError if none has."""
        kinds = {facet.doflocs.shape: element for element, (facet, _) in _FACETS.items()}
        return cls.of_facets(kinds[k, dim - 1]())

    def of(self, coefficients: ndarray, exponents: ndarray) -> Shape:
        """Return other polynomials on the same domain."""
        return replace(self, coefficients=coefficients, exponents=exponents)

    @property
    def dim(self) -> int:
        """Number of local coordinates."""
        return self.exponents.shape[1]

    @property
    def triangular(self) -> bool:
        """True if facets are triangles."""
        return len(self.corners) == 3

    @cached_property
    def affine(self) -> bool:
        """True if the map from local coordinates is affine."""
        return not self.coefficients[:, :, self.exponents.sum(axis=1) > 1].any()

    @cached_property
    def centre(self) -> ndarray:
        """Local coordinates of the centre."""
        return np.asarray(self.corners.mean(axis=0))

    @cached_property
    def at_centre(self) -> list[ndarray]:
        """Values, (1 or n_facets, k), and first derivatives, (..., dim - 1, k), at the centre."""
        facet = np.arange(len(self.coefficients))
        return self.at(facet, np.tile(self.centre, (len(facet), 1)), 1)

    @cached_property
    def side_corners(self) -> ndarray:
        """Corners of every side, in the order round the facet, shape (n_sides, 1 or 2)."""
        n = np.arange(len(self.corners))
        if self.dim == 1:
            return n[:, None]
        return np.column_stack((n, np.roll(n, -1)))

    @cached_property
    def along(self) -> ndarray:
        """Vectors along the sides from their first corner, (n_sides, dim - 1); zero on a line."""
        start = self.corners[self.side_corners[:, 0]]
        end = self.corners[self.side_corners[:, -1]]
        return np.asarray(end - start)

    @cached_property
    def side_middles(self) -> ndarray:
        """Local coordinates of the middles of the sides, shape (n_sides, dim - 1)."""
        return np.asarray(self.corners[self.side_corners[:, 0]] + 0.5 * self.along)

    @cached_property
    def outward(self) -> ndarray:
        """Normals c of the sides with c . (xi - corner) = 2 at a full width beyond the side."""
        if self.dim == 1:
            normal = self.corners - self.centre
        else:
            normal = np.column_stack((self.along[:, 1], -self.along[:, 0]))
        start = self.corners[self.side_corners[:, 0]]
        width = -np.einsum("sc,sjc->sj", normal, self.corners - start[:, None]).min(axis=1)
        return np.asarray(2.0 * normal / width[:, None])

    def beyond(self, xi: ndarray) -> ndarray:
        """Return distances beyond the sides, (n, n_sides): 0 at the side, -2 at the far end."""
        return np.asarray(xi @ self.outward.T - self._level)

    @cached_property
    def _level(self) -> ndarray:
        return np.einsum("sc,sc->s", self.outward, self.corners[self.side_corners[:, 0]])

    def at(self, facet: ndarray, xi: ndarray, derivatives: int = 3) -> list[ndarray]:
        """Return values, shape (n, k), first derivatives, (n, dim - 1, k), second ones, and so on.

        The facets have the shape (n,), local coordinates (n, dim - 1); these may be complex.
        """
        # Each monomial is a lower one times a coordinate.
        monomials = np.ones((len(xi), len(self.exponents)), xi.dtype)
        for monomial, lower, axis in self._factors:
            np.multiply(monomials[:, lower], xi[:, axis], out=monomials[:, monomial])
        result = []
        for order, coefficients in enumerate(self._derivatives[: derivatives + 1]):
            if len(coefficients) == 1:
                values = monomials @ coefficients.reshape(-1, len(self.exponents)).T
            else:
                values = np.einsum("n...p,np->n...", coefficients[facet], monomials)
            result.append(values.reshape(len(xi), *(self.dim,) * order, coefficients.shape[-2]))
        return result

    @cached_property
    def _factors(self) -> list[tuple[int, int, int]]:
        """Monomials by their degree, each a lower monomial times a local coordinate."""
        # Lower the power of one coordinate by one.
        number = {tuple(powers): n for n, powers in enumerate(self.exponents.tolist())}
        result = []
        for powers in sorted(number, key=sum)[1:]:
            axis = max(i for i in range(self.dim) if powers[i])
            lower = (*powers[:axis], powers[axis] - 1, *powers[axis + 1 :])
            result.append((number[powers], number[lower], axis))
        return result

    @cached_property
    def _derivatives(self) -> list[ndarray]:
        """Coefficients of the derivatives to the third, (1 or n_facets, dim - 1, ..., k, p)."""
        p = len(self.exponents)
        steps = np.zeros((self.dim, p, p))  # derivative along an axis of the monomials
        for axis, j in product(range(self.dim), range(p)):
            power = self.exponents[j, axis]
            if power:
                lower = self.exponents[j] - np.eye(self.dim, dtype=int)[axis]
                steps[axis, j, (self.exponents == lower).all(axis=1)] = power
        # Apply the steps once more for each order.
        result = [self.coefficients]
        for _ in range(3):
            result.append(np.stack([result[-1] @ step for step in steps], axis=1))
        return result


@lru_cache
def gauss_points(n: int) -> tuple[ndarray, ndarray]:
    """Return Gauss points from -1 to 1 and their weights, read-only."""
    t, w = np.polynomial.legendre.leggauss(n)
    t.flags.writeable = False
    w.flags.writeable = False
    return t, w


def rule(shape: Shape, n: int) -> tuple[ndarray, ndarray]:
    """Return points, shape (q, dim - 1), and weights of a rule with n Gauss points a direction.

    The rule is exact to the degree 2n - 1; on triangles to 2n - 2, the degree of two shape
    functions' product. All weights are positive.
    """
    t, w = gauss_points(n)
    if shape.dim == 1:
        return t[:, None], w
    if shape.triangular:
        points, weights = get_quadrature(RefTri, max(1, 2 * n - 2))
        return points.T, weights
    return _grid(t, 2), np.outer(w, w).ravel()


def divided_rule(shape: Shape, n: int, pieces: int) -> tuple[ndarray, ndarray]:
    """Return points and weights of the rule on so many pieces a direction."""
    xi, w = rule(shape, n)
    low = shape.corners.min(axis=0)
    share = 1.0 / pieces
    shift = np.ptp(shape.corners, axis=0) * share
    steps = _grid(np.arange(pieces), shape.dim)
    local = (xi - low) * share
    weight = w * share**shape.dim
    points = low + steps[:, None] * shift + local  # (n_pieces, q, dim - 1)
    if shape.triangular:
        # fill the triangle with upright pieces and with pieces turned by 180 degrees
        turned = low + (steps[:, None] + 1) * shift - local
        total = steps.sum(axis=1)
        upright = points[total < pieces]
        points = np.concatenate((upright, turned[total < pieces - 1]))
    return points.reshape(-1, shape.dim), np.tile(weight, len(points))


def _grid(values: ndarray, dim: int) -> ndarray:
    """Return the points of a grid with the same values along each axis, shape (n^dim, dim)."""
    return np.stack(np.meshgrid(*[values] * dim, indexing="ij"), axis=-1).reshape(-1, dim)
