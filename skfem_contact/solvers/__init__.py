"""Linear solvers: direct ones, multigrid, elimination down to an interface; one thread for small dense blocks."""

from __future__ import annotations

from contextlib import ContextDecorator
from functools import cached_property
from threading import Lock
from typing import Any

from threadpoolctl import ThreadpoolController


class _OneThread(ContextDecorator):
    """One thread for BLAS, set by the first of several runs side by side and lifted by the last.

    Vectors of some thousand numbers and the supernodes of a sparse factor are too small for several threads: with four
    of them a contact analysis of 20,000 dofs takes twice the time.
    """

    def __init__(self) -> None:
        self._lock, self._runs = Lock(), 0
        self._context: Any = None

    @cached_property
    def _controller(self) -> ThreadpoolController:
        return ThreadpoolController()

    def __enter__(self) -> None:
        with self._lock:
            if self._runs == 0:
                self._context = self._controller.limit(limits=1, user_api="blas")
            self._runs += 1

    def __exit__(self, *error: object) -> None:
        with self._lock:
            self._runs -= 1
            if self._runs == 0:
                self._context.restore_original_limits()


#: Decorator of functions that run with one thread.
single_threaded = _OneThread()
