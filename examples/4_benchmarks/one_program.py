"""Another program as a peer: run with one thread, its process time measured."""
from __future__ import annotations

import os
import subprocess
from collections.abc import Sequence
from pathlib import Path

TIMEOUT = 900  # seconds


def timed(command: Sequence[str | Path], folder: Path) -> tuple[subprocess.CompletedProcess[str], float]:
    """Run a program in a folder: what it prints and returns, and its process time in seconds."""
    begin, environment = os.times(), {**os.environ, "OMP_NUM_THREADS": "1"}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=TIMEOUT,
                          check=False)
    end = os.times()
    return done, end.children_user + end.children_system - begin.children_user - begin.children_system
