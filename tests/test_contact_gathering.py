"""Sums of what contact points contribute to the unknowns."""

from __future__ import annotations

import numpy as np

from skfem_contact.sparse import Gathering


def test_more_unknowns_than_a_short_integer_squares() -> None:
    """[X] Row times number of unknowns exceeds 2^31 from 46,341 unknowns on; scikit-fem counts in 32 bits."""
    n = 200_000
    dofs = np.array([[0, n - 2], [n - 1, 1]], dtype=np.int32)
    K = Gathering(n).matrix(dofs, np.arange(8.0).reshape(2, 2, 2)).tocoo()
    exact = {(0, 0): 0.0, (0, n - 2): 1.0, (n - 2, 0): 2.0, (n - 2, n - 2): 3.0}
    exact |= {(n - 1, n - 1): 4.0, (n - 1, 1): 5.0, (1, n - 1): 6.0, (1, 1): 7.0}
    assert {(int(i), int(j)): v for i, j, v in zip(K.row, K.col, K.data, strict=True)} == exact


def test_points_share_dofs_and_a_rigid_obstacle_has_none() -> None:
    two_points, gathering = np.array([[0, 1], [1, -1]]), Gathering(3)
    assert gathering.force(two_points, np.ones((2, 2))).tolist() == [1.0, 2.0, 0.0]
    assert gathering.matrix(two_points, np.ones((2, 2, 2))).toarray().tolist() == [[1, 1, 0], [1, 2, 0], [0, 0, 0]]
