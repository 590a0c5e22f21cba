"""Which kind of scene belongs to a seed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from . import arches, bars, blocks, halves, held, joints, own, staged, wet
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
)
OF = 25


def drawn(seed: int) -> Scene | Case:
    """The scene of a seed."""
    if (seed % OF) >= len(OTHERS):
        return draw(seed)
    return OTHERS[seed % OF](seed, np.random.default_rng(seed))
