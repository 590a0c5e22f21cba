"""Another program as a peer: run with one thread, its process time measured."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

TIMEOUT = 900  # seconds
#: Packages of Python that bring other programs.
PACKAGES = {"Kratos": "KratosMultiphysics", "OpenGeoSys": "ogs", "xslope": "xslope"}


def version_of(program: str) -> str:
    """Version of another program: that of its package, or what CalculiX says of itself."""
    if program in PACKAGES:
        return version(PACKAGES[program])
    said = subprocess.run(["ccx", "-v"], capture_output=True, text=True, check=False).stdout
    return next(iter(re.findall(r"[Vv]ersion (\S+)", said)), "")


def timed(
    command: Sequence[str | Path], folder: Path
) -> tuple[subprocess.CompletedProcess[str], float]:
    """Run a program in a folder: what it prints and returns, and its process time in seconds."""
    begin, environment = os.times(), {**os.environ, "OMP_NUM_THREADS": "1"}
    done = subprocess.run(
        command,
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=TIMEOUT,
        check=False,
    )
    end = os.times()
    return (
        done,
        end.children_user + end.children_system - begin.children_user - begin.children_system,
    )
