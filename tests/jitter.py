"""Pytest plugin that perturbs every linear system by noise of the size of round-off.

    python -m pytest -p tests.jitter --jitter 1

Another processor, another BLAS or another order of elimination changes solutions in their last
digits.  Relative noise of 1e-14 on all right-hand sides has the same effect on one machine.  Equal
right-hand sides get equal noise, so runs repeat.  A test that fails under one seed asserts a result
that round-off decides: the code needs a criterion, or the test a derived tolerance.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

SIZE = 1e-14


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the seed of the noise."""
    parser.addoption(
        "--jitter",
        type=int,
        default=None,
        help="seed of relative noise of 1e-14 on right-hand sides",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Perturb the solutions of all systems from here on."""
    seed = config.getoption("--jitter")
    if seed is None:
        return
    from skfem_contact.nonlinear.system import System

    factor = System.factor

    def factor_with_noise(self: System, K: Any) -> Callable[..., np.ndarray]:
        solve = factor(self, K)
        return lambda b, *rtol: solve(b * (1.0 + SIZE * noise(b, seed)), *rtol)

    System.factor = factor_with_noise  # type: ignore[method-assign]


def noise(b: np.ndarray, seed: int) -> np.ndarray:
    """Draw normal numbers that depend on the vector and the seed alone."""
    digest = hashlib.blake2b(np.ascontiguousarray(b).tobytes(), digest_size=8).digest()
    return np.random.default_rng((seed, int.from_bytes(digest, "little"))).standard_normal(
        np.shape(b)
    )
