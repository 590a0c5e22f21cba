"""Progress bars: in terminals and in notebooks."""
from __future__ import annotations

import sys
from typing import Any

from tqdm.auto import tqdm


def progress_bar(show: bool | None, **options: Any) -> Any:
    """A bar of tqdm, as a widget in a notebook; by default where somebody looks on: in a terminal or a notebook."""
    if show is None:
        show = sys.stderr.isatty() or any(cls.__module__ == "tqdm.notebook" for cls in tqdm.__mro__)
    return tqdm(disable=not show, **options)
