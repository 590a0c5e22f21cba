"""Velocities that are free: without those that are held, tied ones once, and rigid bodies with their motions."""
from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.linalg import null_space
from scipy.sparse import coo_matrix, csr_matrix, hstack
from scipy.sparse.csgraph import connected_components

from ..unknowns import rigid_modes
from .elements import Elements

#: Of a rigid body's motions, those that its supports resist by less than this share are free.
_FREE = 1e-9


class Block(NamedTuple):
    """Operators of equal shape: B (n, n_points, 3, n_local), its points (n, n_points) and unknowns (n, n_local).

    An unknown of -1 is none.
    """

    B: ndarray
    points: ndarray
    dofs: ndarray

    def stiffness(self, D: ndarray) -> ndarray:
        """Sum of B^T D B over the points of each, (n, n_local, n_local), with D (n_points, 3, 3) of all points."""
        n, width = self.dofs.shape
        DB = np.matmul(D[self.points], self.B).reshape(n, -1, width)
        return np.matmul(self.B.reshape(n, -1, width).transpose(0, 2, 1), DB)


class Unknowns(NamedTuple):
    """Reduction of all velocities of the elements, (n,), to the free ones, (m,), of which the motions are the last.

    Attributes
    ----------
    number
        Free unknown of each velocity, (n,); -1 where it is held or in a rigid body.
    motions
        Velocities of the free motions of the rigid bodies, (n, n_motions).
    places
        Where the free unknowns live, (2, m).
    """

    number: ndarray
    motions: ndarray
    places: ndarray

    @classmethod
    def of(cls, elements: Elements, used: ndarray, held: ndarray, tied: ndarray, rigid: ndarray) -> Unknowns:
        """Free are those that are used and not held; pairs (2, n) are tied, triangles of rigid >= 0 bodies."""
        n = elements.n
        same = connected_components(coo_matrix((np.ones(tied.shape[1]), tuple(tied)), shape=(n, n)), directed=False)[1]
        fixed, body = np.isin(same, same[held]), np.full(n, -1)
        for b in range(rigid.max() + 1):
            body[np.isin(same, same[elements.dofs[rigid == b]])] = b
        plain = np.zeros(n, bool)
        plain[used] = True
        plain = np.flatnonzero(plain & ~fixed & (body < 0))
        number = np.full(n, -1)
        _, first, number[plain] = np.unique(same[plain], return_index=True, return_inverse=True)
        motions, places = [np.zeros((n, 0))], [elements.places[:, plain[first]]]
        for b in range(rigid.max() + 1):
            mine = np.flatnonzero(body == b)
            whole = rigid_modes(elements.places, mine)
            free = whole @ null_space(whole[fixed[mine]], rcond=_FREE) if fixed[mine].any() else whole
            motions.append(np.zeros((n, free.shape[1])))
            motions[-1][mine] = free
            places.append(np.repeat(elements.places[:, mine].mean(axis=1, keepdims=True), free.shape[1], 1))
        return cls(number, np.hstack(motions), np.hstack(places))

    @property
    def size(self) -> int:
        """Number of free unknowns."""
        return self.places.shape[1]

    @property
    def matrix(self) -> csr_matrix:
        """All velocities from the free ones, (n, m)."""
        plain = np.flatnonzero(self.number >= 0)
        shape = len(self.number), self.size - self.motions.shape[1]
        single = csr_matrix((np.ones(len(plain)), (plain, self.number[plain])), shape=shape)
        return csr_matrix(hstack([single, csr_matrix(self.motions)]))

    def reduced(self, B: ndarray, points: ndarray, dofs: ndarray) -> list[Block]:
        """Operators of the free unknowns; those at rigid bodies have more columns and are a block of their own."""
        touching = np.isin(dofs, np.flatnonzero(self.motions.any(axis=1))).any(axis=1)
        blocks = [Block(B[~touching], points[~touching], self.number[dofs[~touching]])]
        B, points, dofs = B[touching], points[touching], dofs[touching]
        motion = self.motions[dofs]  # (n, n_local, n_motions)
        last = np.arange(self.size - motion.shape[2], self.size)
        unknowns = np.hstack([self.number[dofs], np.where(motion.any(axis=1), last, -1)])
        blocks.append(Block(np.concatenate([B, np.einsum("epsl,elk->epsk", B, motion)], axis=3), points, unknowns))
        return [block for block in blocks if len(block.B)]
