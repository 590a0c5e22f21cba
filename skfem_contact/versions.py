"""Versions of the package, of the packages in use and of the machine, for reports."""

from __future__ import annotations

import platform
import sys
from importlib.metadata import PackageNotFoundError, version

from threadpoolctl import threadpool_info

#: What the package uses, by the names of the distributions.
_USED = ("scikit-fem", "numpy", "scipy", "meshio", "pyvista", "vtk", "matplotlib", "tqdm")
#: What it uses where it is installed, and what for.
_OPTIONAL = {
    "pypardiso": "fast direct solver",
    "pyamg": "multigrid",
    "gmsh": "meshes",
    "pandas": "data frames",
    "ipywidgets": "bars in notebooks",
    "dask": "many runs",
}


def own_version() -> str:
    """Return the version of the package, also where it is not installed but found in a folder."""
    return str(sys.modules[__name__.partition(".")[0]].__version__)


def versions() -> dict[str, str]:
    """Return the versions of the package, Python, the machine and all packages, and the threads."""
    result = {
        "skfem_contact": own_version(),
        "Python": platform.python_version(),
        "platform": f"{platform.system()} {platform.release()}, {platform.machine()}",
    }
    for name in _USED:
        result[name] = _of(name) or "missing"
    for name, purpose in _OPTIONAL.items():
        result[name] = _of(name) or f"not installed: {purpose}"
    threads = {}
    for pool in threadpool_info():
        threads[f"{pool.get('user_api')} ({pool.get('internal_api')})"] = pool.get("num_threads")
    listed = ", ".join(f"{kind}: {number}" for kind, number in threads.items())
    result["threads"] = listed or "unknown"
    return result


def show_versions() -> None:
    """Print versions of the package, Python, the machine and all packages, and the threads.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.show_versions()
    skfem_contact  ...
    Python         ...
    """
    lines = versions()
    width = max(map(len, lines))
    for name, text in lines.items():
        print(f"{name:{width}}  {text}")


def _of(name: str) -> str | None:
    """Return the version of a package, None where it is not installed."""
    try:
        return version(name)
    except PackageNotFoundError:
        return None
