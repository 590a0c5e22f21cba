"""Blocks of nodes of a matrix."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix, random

from skfem_contact.solvers.whole_nodes import WholeNodes
from skfem_contact.sparse import with_data


def test_blocks_of_matrices_on_one_pattern() -> None:
    """[X] Blocks hold the entries of each matrix, and zeros where the pattern has none; another
    pattern has its own.
    """
    locations = np.zeros((3, 12))
    nodes = WholeNodes(locations, np.arange(12))
    for seed in (1, 2):
        pattern = csr_matrix(random(12, 12, 0.3, random_state=seed) + np.eye(12))
        A = nodes.gather(pattern)
        for matrix in (A, with_data(A, 1.0 + A.data**2)):
            blocks = nodes.blocks(matrix)
            assert blocks.blocksize == (3, 3)
            np.testing.assert_array_equal(blocks.toarray(), matrix.toarray())
