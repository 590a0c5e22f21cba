"""Plastic hinges at the ends of elements: moment and thrust within ``|M| / Mp + |N| / Np <= 1``."""
from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.optimize import nnls

#: Share of the stiffness that a hinge keeps in the tangent, as it flows: a mechanism of beams is singular to the last
#: bit. The limit loads of a propped cantilever, a portal and a column end in a stall with 0, on a plateau with 1e-6.
_KEPT = 1e-6
#: Strength by which the ends at a node differ, so that one of two equal ends flows: two leave the node between loose.
_WEAKEST = 1e-7
#: Share of the largest singular value of the faces in force below which they depend on each other.
_DEPENDENT = 1e-8


class Flow(NamedTuple):
    """Flow of one element: its number, change of its dofs without force, and the faces in force, (k, 9)."""

    element: int
    free: ndarray
    faces: ndarray


class Hinges:
    """Hinges at both ends of m elements.

    The plastic flow is associated: of all forces within the strength those are taken that are nearest to the elastic
    ones in complementary energy, by least distance programming (C. L. Lawson and R. J. Hanson, Solving Least Squares
    Problems, 1974, chapter 23).

    Parameters
    ----------
    resultants : ndarray, shape (m, 2, 3, 9)
        N, V and M at both ends by the forces on the nodes.
    root : ndarray, shape (m, 9, 6)
        Matrices R of the elastic stiffness R R'.
    nodes : ndarray, shape (m, 2)
        Nodes at the ends.
    Mp, Np : float
        Plastic moment and plastic normal force.
    """

    def __init__(self, resultants: ndarray, root: ndarray, nodes: ndarray, Mp: float, Np: float) -> None:
        signs = np.array([(a, b) for a in (-1.0, 1.0) for b in (-1.0, 1.0)] if np.isfinite(Np) else [(0, -1), (0, 1)])
        faces = np.einsum("fr,merj->mefj", signs / [Np, Mp], resultants[:, :, [0, 2]])
        later = _ranks(nodes.ravel()).reshape(nodes.shape)
        self._faces = (faces / (1.0 + _WEAKEST * later)[:, :, None, None]).reshape(len(nodes), -1, 9)
        self._root = root

    def flows(self, force: ndarray) -> Iterator[Flow]:
        """Yield the flow of every element whose forces on the nodes, (m, 9), exceed its strength."""
        excess = np.einsum("mfj,mj->mf", self._faces, force) - 1.0
        for e in np.flatnonzero((excess > 0.0).any(axis=1)):
            faces = self._faces[e]
            way = faces @ self._root[e]
            size = np.linalg.norm(way, axis=1)
            far = (excess[e] / size).max()
            beyond = excess[e] / size / far  # all of them in units of the largest: the solution is of order one
            multiplier, _ = nnls(np.vstack((way.T / size, beyond)), np.append(np.zeros(way.shape[1]), 1.0))
            multiplier *= far / size / (1.0 - beyond @ multiplier)
            yield Flow(int(e), faces.T @ multiplier, faces[multiplier > 0.0])

    def tangent(self, stiffness: ndarray, flows: list[Flow]) -> ndarray:
        """Return the tangents of all elements, (m, 9, 9), some of which flow, from the elastic ones."""
        tangent = stiffness.copy() if flows else stiffness
        for e, _, faces in flows:
            root = self._root[e]
            across = np.linalg.svd((faces @ root).T, full_matrices=False)
            lost = root @ across.U[:, _DEPENDENT * across.S[0] < across.S]
            tangent[e] -= (1.0 - _KEPT) * lost @ lost.T
        return tangent


def _ranks(nodes: ndarray) -> ndarray:
    """Return how many earlier entries are the same, of each entry."""
    order = np.argsort(nodes, kind="stable")
    first = np.searchsorted(nodes[order], nodes[order])
    ranks = np.empty(len(nodes), int)
    ranks[order] = np.arange(len(nodes)) - first
    return ranks
