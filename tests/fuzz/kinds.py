"""Which kind of scene belongs to a seed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from . import arches, bars, blocks, halves, held, joints, large, own, staged, wet
from .cases import Case
from .scenes import Scene, draw

#: Of 25 scenes, those that are not pressed blocks; 40 of a thousand are of each that stands once.
OTHERS: tuple[Callable[[int, np.random.Generator], Case], ...] = (
    arches.arch,
    *(blocks.stack,) * 2,
    *(wet.wet,) * 2,
    *(staged.staged,) * 2,
    *(bars.bars,) * 2,
    *(own.own,) * 2,
    joints.joints,
    halves.half,
    held.held,
    large.large,
)
OF = 25


def drawn(seed: int, kind: str | None = None) -> Scene | Case:
    """The scene of a seed, of any kind or of one."""
    if kind is not None:
        (one,) = {each for each in OTHERS if each.__name__ == kind}
        return one(seed, np.random.default_rng(seed))
    if (seed % OF) >= len(OTHERS):
        return draw(seed)
    return OTHERS[seed % OF](seed, np.random.default_rng(seed))
