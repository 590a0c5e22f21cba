"""Stages as a film."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np

from ..stages.result import Result, StageResult
from .contours import View, Window, headline, make_view, paint
from .marks import Marks
from .picture import FOOT, Frame, can_draw
from .scales import bar_figure, make_scale

_FRAMES_A_SECOND, _WIDTH = 12, 960


def animate(forms: Mapping[str, Any], result: Result | Sequence[StageResult], quantity: str, file: str | Path, *,
            since: StageResult | None = None, deformed: float | Literal["auto"] = 0.0,
            limits: tuple[float, float] | None = None, window: Window | None = None, levels: int = 10,
            colors: str | None = None, mesh: bool = False, frames: int = 16) -> Path | None:
    """Write a film of the stages, ``.gif`` or ``.mp4``, all of them on one scale.

    Between stages that hold the same bodies, displacements and the field go over linearly.

    Parameters
    ----------
    forms, result, quantity
        As for :func:`stages`.
    file
        Name of the film; MP4 needs ``imageio-ffmpeg``, GIF ``imageio``.
    since, deformed, limits, window, levels, colors, mesh
        As for :func:`contour`.
    frames
        Pictures for each stage, twelve a second; in the first half of them the bodies move.

    Returns
    -------
    Path or None
        The file, or None with a warning where this machine cannot draw.
    """
    file, chosen = Path(file), list(result)
    if file.suffix not in (".gif", ".mp4"):
        raise ValueError(f"a film is a .gif or an .mp4 file, not '{file.name}'")
    if not chosen:
        raise ValueError("there is no stage to draw")
    if not can_draw(f"'{quantity}'")[0]:
        return None
    factors = [make_view(forms, step, quantity, since, deformed, None).scene.factor for step in chosen]
    views = [make_view(forms, step, quantity, since, min(factors), None) for step in chosen]
    scale = make_scale(np.concatenate([v.values for v in views]), np.concatenate([v.scene.area for v in views]),
                       limits, levels, colors)
    frame = Frame(np.concatenate([view.scene.seen for view in views]), window, titled=True,
                  width=_WIDTH)
    frame.make_even()
    plotter = frame.sheet(False)
    if file.suffix == ".gif":
        plotter.open_gif(str(file), fps=_FRAMES_A_SECOND)
    else:
        plotter.open_movie(str(file), framerate=_FRAMES_A_SECOND)
    frame.put_foot(plotter, bar_figure(scale, headline(forms, quantity, since), "", (frame.size[0], FOOT), {}))
    for first, last in zip([views[0], *views], views):
        moving = _between(first, last, frames // 2)
        for view in moving:
            plotter.renderer.clear_actors()
            paint(plotter, frame, [view], [Marks(forms, chosen[0])], scale, mesh)
            plotter.write_frame()
        for _ in range(frames - len(moving)):
            plotter.write_frame()
    plotter.close()
    return file


def _between(first: View, last: View, n: int) -> list[View]:
    """Views on the way from one stage to the next; one where the bodies are others."""
    if first is last or not np.array_equal(first.scene.nodes, last.scene.nodes):
        return [last]
    return [View(last.scene.between(first.scene, share), (1.0 - share) * first.values + share * last.values, last.title)
            for share in np.arange(1, n + 1) / n]
