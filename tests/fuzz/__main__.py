"""``python -m tests.fuzz --scenes 500 --seed 1``, in pieces with ``--start 100``, or
``--scene 1000042`` for a single one; ``--kind large`` for one kind; ``--calls``: wrong calls.
"""

from __future__ import annotations

import argparse
import sys
import time

from tqdm import tqdm

from . import calls
from .comparisons import COMPARISONS
from .kinds import OTHERS
from .report import details, table, verdict
from .scenes import seeds
from .trial import trial


def main() -> int:
    """Trials as asked for; 0 only if all that must hold does."""
    parser = argparse.ArgumentParser(prog="tests.fuzz", description=__doc__)
    parser.add_argument("--scenes", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--start", type=int, default=0, help="number of the first scene")
    kinds = sorted({kind.__name__ for kind in OTHERS})
    parser.add_argument("--kind", choices=kinds, help="scenes of one kind alone")
    parser.add_argument("--scene", type=int, help="seed of a single scene")
    parser.add_argument(
        "--calls", action="store_true", help="wrong calls of public functions, 3 minutes"
    )
    given, began = parser.parse_args(), time.process_time()
    if given.calls:
        return calls.main(seed=given.seed)
    if given.scene is not None:
        trials = [trial(given.scene, len(COMPARISONS), given.kind)]
    else:
        trials = [
            trial(seed, kind=given.kind)
            for seed in tqdm(seeds(given.seed, given.scenes, given.start), disable=None)
        ]
    violations, silent = verdict(trials)
    if violations:
        print(details(trials), end="\n\n")
    print(table(trials))
    print(f"{time.process_time() - began:.0f} s of CPU time")
    print(f"{violations} violations, {silent} silent")
    return int(violations > 0)


if __name__ == "__main__":
    sys.exit(main())
