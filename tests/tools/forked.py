"""Server that runs pytest in processes of its own, for which libraries are imported once.

It reads one line of JSON per run: the arguments of pytest, the file for its output, and a limit of
the process time in seconds.  It answers with the exit status; minus the signal that ended the run.
"""

from __future__ import annotations

import importlib
import json
import os
import resource
import signal
import sys
from collections.abc import Sequence

import pytest

#: Libraries, and neither the package nor its tests.
IMPORTED_ONCE = (
    "matplotlib.pyplot",
    "scipy.interpolate",
    "scipy.optimize",
    "scipy.sparse.linalg",
    "scipy.spatial",
    "skfem",
)
#: Seconds after which a run ends even if it waits.
LONGEST = 3600


def run(arguments: Sequence[str], output: str, seconds: int) -> int:
    """Run pytest in another process; return its exit status."""
    process = os.fork()
    if process == 0:
        with open(output, "w", encoding="utf-8") as stream:
            os.dup2(stream.fileno(), 1)
            os.dup2(stream.fileno(), 2)
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
        signal.alarm(LONGEST)
        status = pytest.main([*arguments])
        sys.stdout.flush()
        os._exit(status)
    return os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])


if __name__ == "__main__":
    for library in IMPORTED_ONCE:
        try:
            importlib.import_module(library)
        except ImportError:
            continue
    for line in sys.stdin:
        print(run(**json.loads(line)), flush=True)
