"""Distance of facets in the plane from the smooth curve through their nodes.

Facets of a round boundary lie inside or outside of it: by ``h^2 / 8 R`` if they are straight.  The
curve is the polynomial ``X(t)`` through the nodes of a facet and of its neighbours, whose parameter
is the length of the chords between them; it ends at corners.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from numpy import ndarray

from ..arrays import row_norms
from .material_points import MaterialPoints
from .surface import Surface
from .vectors import dot, unit

#: Cosine of the angle between facets above which the curve continues.
_SMOOTH = np.cos(np.radians(30.0))
#: Distance of a middle node from the chord, as a share of it, below which the facet is straight.
_STRAIGHT = 1e-6
#: Neighbours on each side whose nodes count: of straight facets, and of curved ones.
_NEIGHBOURS = (2, 1)
#: Degree of the distance as a polynomial of the local coordinate.
_DEGREE = 8
#: Difference of the curvatures of two surfaces, as a share of the larger one, below which they are
#: alike; and turn of a facet below which it is none.
_ALIKE = 0.25
_FLAT = 1e-6


def alike(slave: Surface, master: Surface) -> bool:
    """Return True if most of the slave is round, and the master opposite it as round.

    Facets must be mapped from their own nodes, in the plane.
    """
    for surface in (slave, master):
        if surface.dim == 3 or len(surface.shape.coefficients) > 1:
            return False
    # Compare with the curvature of the nearest facet of the master.
    own = curvatures(slave)
    tree = scipy.spatial.cKDTree(master.centres.x[0])
    opposite = tree.query(slave.centres.x[0])[1]
    other = curvatures(master)[opposite]
    largest = np.maximum(np.abs(own), np.abs(other))
    # Round facets fit where the curvatures cancel.
    is_round = largest * slave.size > _FLAT
    fits = np.abs(own + other) < _ALIKE * largest
    fitting = slave.area[fits & is_round].sum()
    return bool(fitting > 0.5 * slave.area[is_round].sum())


def curvatures(surface: Surface) -> ndarray:
    """Return curvatures of the facets, (n_facets,), positive where the body is convex.

    Facets at a corner have none.
    """
    first = surface.facets[:, 0]
    last = surface.facets[:, 1]
    # The turn of the normal over the length of the chord.
    chord = surface.nodes[last] - surface.nodes[first]
    turn = surface.normals[last] - surface.normals[first]
    # A corner has no curvature.
    after = ~_continues(surface)
    after[-1] &= surface.closed
    at_corner = after | np.roll(after, 1)
    return np.where(at_corner, 0.0, dot(turn, chord) / dot(chord, chord))


@dataclass(frozen=True, eq=False)
class Faceting:
    """Distances by which a smooth curve lies outside of facets, as polynomials.

    Attributes
    ----------
    coefficients : ndarray, shape (n_facets, degree + 1)
        Coefficients of the powers of the local coordinate.
    """

    coefficients: ndarray

    @classmethod
    def of(cls, surface: Surface) -> Faceting:
        """Return the distances of the facets of a chain."""
        n = len(surface.facets)
        # Points of Chebyshev and Lobatto on each facet.
        xi = np.cos(np.pi * np.arange(_DEGREE + 1) / _DEGREE)
        mapping = surface.at(
            np.repeat(np.arange(n), len(xi)), np.tile(xi, n)[:, None], surface.nodes
        )
        curve = np.concatenate([_curve(surface, stencil, xi) for stencil in _stencils(surface)])
        # Distances along the normal, as polynomials of the local coordinate.
        outside = dot(curve - mapping.x[0], mapping.normal).reshape(n, -1)
        powers = np.polynomial.polynomial.polyvander(xi, _DEGREE)
        return cls(np.linalg.solve(powers, outside.T).T)

    def at(self, points: MaterialPoints) -> ndarray:
        """Return the distances at points, (n,); or zero."""
        facet, xi = points
        inside = np.clip(xi[:, 0], -1.0, 1.0)
        powers = np.polynomial.polynomial.polyvander(inside, _DEGREE)
        distance = np.einsum("np,np->n", powers, self.coefficients[facet])
        return np.where(facet >= 0, distance, 0.0)


@dataclass(frozen=True, eq=False)
class _Stencil:
    """Nodes along a chain, of which some belong to one facet, in the order of their coordinates."""

    nodes: list[int]
    own: slice


def _continues(surface: Surface) -> ndarray:
    """Return True for facets from which the surface continues to the next without a corner."""
    m = len(surface.facets)
    tangents = []
    for end in (-1.0, 1.0):
        mapping = surface.at(np.arange(m), np.full((m, 1), end), surface.nodes)
        tangents.append(unit(mapping.x[1][:, 0]))
    following = np.roll(tangents[0], -1, axis=0)
    return np.asarray(dot(tangents[1], following) > _SMOOTH)


def _stencils(surface: Surface) -> list[_Stencil]:
    """Return the nodes of all facets and of their neighbours."""
    m = len(surface.facets)
    continues = _continues(surface)
    continues[-1] &= surface.closed

    # Middle nodes count where they do not just halve the chord
    curved = np.zeros(m, bool)
    if surface.facets.shape[1] == 3:
        start, end, middle = surface.nodes[surface.facets.T]
        off = row_norms(middle - 0.5 * (start + end))
        curved = off > _STRAIGHT * row_norms(end - start)
    return [_around(surface, facet, continues, curved) for facet in range(m)]


def _around(surface: Surface, facet: int, continues: ndarray, curved: ndarray) -> _Stencil:
    """Return the nodes of a facet and of the neighbours to which the curve continues."""
    m = len(continues)
    most = min(_NEIGHBOURS[int(curved[facet])], (m - 1) // 2)
    # Take neighbours on both sides, as far as a corner.
    first = last = facet
    while facet - first < most and continues[(first - 1) % m]:
        first -= 1
    while last - facet < most and continues[last % m]:
        last += 1

    # Collect the nodes in the order of the chain, and which are those of the facet.
    nodes = [int(surface.facets[first % m, 0])]
    for each in range(first, last + 1):
        start = len(nodes) - 1
        _, end, *middle = surface.facets[each % m]
        if curved[each % m]:
            nodes.append(int(middle[0]))
        nodes.append(int(end))
        if each == facet:
            own = slice(start, len(nodes))
    return _Stencil(nodes, own)


def _curve(surface: Surface, stencil: _Stencil, xi: ndarray) -> ndarray:
    """Return points of the curve at local coordinates, (n,), of a facet: shape (n, 2)."""
    x = surface.nodes[stencil.nodes]
    chords = row_norms(np.diff(x, axis=0))
    # The length along the chords is the parameter of the curve.
    t = np.concatenate(([0.0], np.cumsum(chords)))
    own = t[stencil.own]
    knots = np.linspace(-1.0, 1.0, len(own))
    here = _interpolated(knots, own[:, None], xi)[:, 0]
    return _interpolated(t, x, here)


def _interpolated(t: ndarray, values: ndarray, at: ndarray) -> ndarray:
    """Return the polynomial of Lagrange through values (n, m) at t (n,): shape (k, m)."""
    factors = np.ones((len(at), len(t)))
    for i, own in enumerate(t):
        for other in np.delete(t, i):
            factors[:, i] *= (at - other) / (own - other)
    return np.asarray(factors @ values)
