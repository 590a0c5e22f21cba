"""Analyses in processes of their own, and their peak memory."""

from __future__ import annotations

import json
import os
import resource
import sys
from collections.abc import Callable
from typing import Any


def peak() -> float:
    """Peak memory of the process, MB."""
    return (
        resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        / 1024
        / (1024 if sys.platform == "darwin" else 1)
    )


def apart(function: Callable[..., Any], *args: Any) -> Any:
    """Answer of a function in a process of its own, whose peak memory is its own too."""
    sys.stdout.flush()
    reading, writing = os.pipe()
    if os.fork() == 0:
        try:
            os.write(writing, json.dumps(function(*args)).encode())
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as answer:
        text = answer.read()
    os.wait()
    return json.loads(text)
