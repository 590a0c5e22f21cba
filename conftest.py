"""Doctests that need Gmsh are left out where it cannot be imported."""

try:
    import gmsh  # noqa: F401
except (ImportError, OSError):  # the latter: a library of the system is missing
    collect_ignore_glob = ["skfem_contact/section/*"]
