"""One thread for the small dense blocks that an analysis works on."""
from __future__ import annotations

from collections.abc import Callable
from functools import cache, wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import ThreadpoolController

P = ParamSpec("P")
R = TypeVar("R")


@cache
def _controller() -> ThreadpoolController:
    return ThreadpoolController()


def single_threaded(function: Callable[P, R]) -> Callable[P, R]:
    """The same function, with one thread for BLAS while it runs.

    Vectors of some thousand numbers and the supernodes of a sparse factor are so small that threads wait for each
    other: with four of them a contact analysis of 20,000 unknowns takes twice the time and five times the processor.

    Examples
    --------
    >>> import numpy as np
    >>> float(single_threaded(np.linalg.norm)(np.array([3., 4.])))
    5.0
    """

    @wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> R:
        with _controller().limit(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return limited
