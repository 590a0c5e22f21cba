"""Threads of dense blocks and of PARDISO."""

from __future__ import annotations

import os
import sys
from contextlib import ContextDecorator
from functools import cached_property
from threading import Lock
from typing import Any

from threadpoolctl import ThreadpoolController


class _OneThread(ContextDecorator):
    """One thread for BLAS, set by the first of several runs side by side and lifted by the last.

    Vectors of some thousand numbers and the supernodes of a sparse factor are too small for several
    threads: with four of them a contact analysis of 20,000 dofs takes twice the time.
    """

    def __init__(self) -> None:
        self._lock = Lock()
        self.runs = 0
        self._context: Any = None

    @cached_property
    def _controller(self) -> ThreadpoolController:
        return ThreadpoolController()

    def __enter__(self) -> None:
        with self._lock:
            if self.runs == 0:
                self._context = self._controller.limit(limits=1, user_api="blas")
            self.runs += 1

    def __exit__(self, *error: object) -> None:
        with self._lock:
            self.runs -= 1
            if self.runs == 0:
                self._context.restore_original_limits()


#: Decorator of functions that run with one thread.
single_threaded = _OneThread()


def allowed() -> int:
    """Return the number of threads for a large factor: cores, at most ``OMP_NUM_THREADS``.

    Analyses side by side in one process have one each.
    """
    if single_threaded.runs > 1:
        return 1
    if sys.platform == "linux":
        cores = len(os.sched_getaffinity(0))
    else:
        cores = os.cpu_count() or 1
    given = os.environ.get("OMP_NUM_THREADS", "").split(",")[0].strip()
    limit = 0
    if given.isdigit():
        limit = int(given)
    if limit > 0:
        return min(cores, limit)
    return cores
