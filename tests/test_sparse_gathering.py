"""Sums of what contact points contribute to the unknowns."""

from __future__ import annotations

import numpy as np

from skfem_contact.sparse import Gathering


def test_more_unknowns_than_a_short_integer_squares() -> None:
    """[X] Row times number of unknowns exceeds 2^31 from 46,341 unknowns on; scikit-fem counts in
    32 bits.
    """
    n = 200_000
    dofs = np.array([[0, n - 2], [n - 1, 1]], dtype=np.int32)
    K = Gathering(n).matrix(dofs, np.arange(8.0).reshape(2, 2, 2)).tocoo()
    exact = {(0, 0): 0.0, (0, n - 2): 1.0, (n - 2, 0): 2.0, (n - 2, n - 2): 3.0}
    exact |= {(n - 1, n - 1): 4.0, (n - 1, 1): 5.0, (1, n - 1): 6.0, (1, 1): 7.0}
    assert {(int(i), int(j)): v for i, j, v in zip(K.row, K.col, K.data, strict=True)} == exact


def test_points_share_dofs_and_a_rigid_obstacle_has_none() -> None:
    two_points, gathering = np.array([[0, 1], [1, -1]]), Gathering(3)
    assert gathering.force(two_points, np.ones((2, 2))).tolist() == [1.0, 2.0, 0.0]
    assert gathering.matrix(two_points, np.ones((2, 2, 2))).toarray().tolist() == [
        [1, 1, 0],
        [1, 2, 0],
        [0, 0, 0],
    ]


def test_points_that_follow_each_other_on_the_same_dofs(rng: np.random.Generator) -> None:
    """[N] Those of pieces; the same dofs come again later, and others in between."""
    dofs = np.array([[0, 1], [0, 1], [2, 1], [0, 1], [-1, 2], [-1, 2], [-1, 2]])
    matrices, expected = rng.standard_normal((7, 2, 2)), np.zeros((3, 3))
    for at, K in zip(dofs, matrices, strict=True):
        on = at >= 0
        expected[np.ix_(at[on], at[on])] += K[np.ix_(on, on)]
    np.testing.assert_allclose(Gathering(3).matrix(dofs, matrices).toarray(), expected, atol=1e-15)
