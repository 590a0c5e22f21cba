"""Linear solvers: direct ones, multigrid, elimination down to an interface; threads."""

from .threads import single_threaded

__all__ = ["single_threaded"]
