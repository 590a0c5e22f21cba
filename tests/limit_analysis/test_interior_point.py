"""Parts of the steps of the interior points of bounds."""

from __future__ import annotations

import numpy as np

from skfem_contact.limit_analysis import interior_point


def test_inverses_of_stiff_and_soft_directions(rng: np.random.Generator) -> None:
    """[N] Inverses of 1,000 matrices, of conditions up to 1e8, are those of numpy."""
    axes = np.linalg.qr(rng.standard_normal((1000, 3, 3)))[0]
    stiffness = 10.0 ** rng.uniform(-4, 4, (1000, 1, 3))
    H = np.matmul(axes * stiffness, axes.transpose(0, 2, 1))
    exact = np.matmul(axes / stiffness, axes.transpose(0, 2, 1))
    error = np.abs(interior_point._inverse(H) - exact).max(axis=(1, 2))
    size = np.abs(exact).max(axis=(1, 2))
    assert (error / size).max() < 1e-7  # round-off times the condition
