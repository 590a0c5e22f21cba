"""Doctests that need Gmsh are left out where it cannot be imported; workers do not share cores."""

import os

if "PYTEST_XDIST_WORKER" in os.environ:  # before numpy is imported, which then has one thread
    os.environ.setdefault("OMP_NUM_THREADS", "1")

try:
    import gmsh  # noqa: F401
except (ImportError, OSError):  # the latter: a library of the system is missing
    collect_ignore_glob = ["skfem_contact/section/*"]
