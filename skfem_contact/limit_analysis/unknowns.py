"""Velocities that are free: without those that are held, tied ones once, and rigid bodies with their motions."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from .elements import Elements
from .normal_matrix import Block

#: Of a rigid body's motions, those that its supports resist by less than this share are free.
_FREE = 1e-9


@dataclass(frozen=True)
class Unknowns:
    """Reduction of all velocities of the elements, (n,), to the free ones, (m,).

    Attributes
    ----------
    number
        Free unknown of each velocity; -1 where it is held, -2 - b in the rigid body b.
    motions
        Velocities (n, k) of the free motions of each rigid body.
    first
        Number of its first motion among the free unknowns.
    places
        Where the free unknowns live, (2, m).
    """

    number: ndarray
    motions: tuple[ndarray, ...]
    first: tuple[int, ...]
    places: ndarray

    @classmethod
    def of(cls, elements: Elements, used: ndarray, held: ndarray, tied: ndarray, rigid: list[ndarray]) -> Unknowns:
        """Number the free unknowns.

        Parameters
        ----------
        elements
            The elements of a bound.
        used, held
            Velocities that act on something, and those that are zero.
        tied
            Pairs of velocities that are equal, (2, n).
        rigid
            Velocities of every rigid body.
        """
        n = elements.n
        same = np.arange(n)
        for one, other in tied.T:  # few, and chains may occur
            same[same == same[one]] = same[other]
        number = np.full(n, -1)
        fixed = np.zeros(n, bool)
        fixed[held] = True
        fixed = np.isin(same, same[fixed])
        body = np.full(n, -1)
        for b, dofs in enumerate(rigid):
            body[np.isin(same, same[dofs])] = b
        plain = np.zeros(n, bool)
        plain[used] = True
        plain &= ~fixed & (body < 0)
        roots, which = np.unique(same[plain], return_inverse=True)
        number[plain] = which
        places, motions, first, m = [elements.places[:, roots]], [], [], len(roots)
        for b in range(len(rigid)):
            mine = np.flatnonzero(body == b)
            free = _free_motions(elements, mine, mine[fixed[mine]])
            number[mine] = -2 - b
            motions.append(free)
            first.append(m)
            places.append(np.repeat(elements.places[:, mine].mean(axis=1, keepdims=True), free.shape[1], 1))
            m += free.shape[1]
        return cls(number, tuple(motions), tuple(first), np.hstack(places))

    @property
    def size(self) -> int:
        """Number of free unknowns."""
        return self.places.shape[1]

    @property
    def matrix(self) -> csr_matrix:
        """All velocities from the free ones, (n, m)."""
        plain = np.flatnonzero(self.number >= 0)
        rows, columns, data = [plain], [self.number[plain]], [np.ones(len(plain))]
        for b, (motion, start) in enumerate(zip(self.motions, self.first)):
            mine = np.flatnonzero(self.number == -2 - b)
            k = motion.shape[1]
            rows.append(np.repeat(mine, k))
            columns.append(np.tile(start + np.arange(k), len(mine)))
            data.append(motion[mine].ravel())
        entries = np.concatenate(data), (np.concatenate(rows), np.concatenate(columns))
        return csr_matrix(entries, shape=(len(self.number), self.size))

    def reduced(self, B: ndarray, points: ndarray, dofs: ndarray) -> list[Block]:
        """Operators of the free unknowns; those at rigid bodies have more columns and are a block of their own."""
        number = self.number[dofs]
        touching = (number < -1).any(axis=1)
        blocks = [Block(B[~touching], points[~touching], number[~touching])]
        if touching.any():
            blocks.append(self._at_bodies(B[touching], points[touching], dofs[touching]))
        return [block for block in blocks if len(block.B)]

    def _at_bodies(self, B: ndarray, points: ndarray, dofs: ndarray) -> Block:
        number = self.number[dofs]
        columns, unknowns = [B * (number >= 0)[:, None, None]], [np.maximum(number, -1)]
        for b, (motion, start) in enumerate(zip(self.motions, self.first)):
            mine, k = number == -2 - b, motion.shape[1]
            columns.append(np.einsum("epsl,elk->epsk", B * mine[:, None, None], motion[dofs]))
            unknowns.append(np.where(mine.any(axis=1)[:, None], start + np.arange(k), -1))
        return Block(np.concatenate(columns, axis=3), points, np.hstack(unknowns))


def _free_motions(elements: Elements, mine: ndarray, held: ndarray) -> ndarray:
    """Motions of a rigid body, as columns over all velocities, that leave its held ones at rest."""
    whole = elements.rigid_motions(elements.places[:, mine].mean(axis=1))
    if not len(held):
        return whole
    _, size, modes = np.linalg.svd(whole[held])
    size = np.append(size, np.zeros(3 - len(size)))
    return whole @ modes[size <= _FREE * max(1.0, size[0])].T
