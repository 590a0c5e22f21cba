"""Hinges between bonded shells: nodes that two of them have, each with rotations of its own."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np
from numpy import ndarray

from ..checks import format_point
from ..errors import Remark
from ..forms.base import Forms
from .shell import Shell


def hinged(forms: Forms, fixed: ndarray) -> Iterator[Remark]:
    """Yield a remark on each pair of numbered shells that are hinged where they meet.

    Shells on facets of one mesh have the displacements of its nodes in common, but rotations by
    `joined_to` alone. Supports, of the dofs `fixed`, that hold both rotations leave no hinge.
    """
    bonded = []
    for name, form in forms.items():
        if isinstance(form, Shell) and form.shared is not None:
            bonded.append((name, form.shared[:, 0], form))
    for (first, nodes, one), (second, others, other) in combinations(bonded, 2):
        # Compare the rotations of common nodes
        _, here, there = np.intersect1d(nodes, others, return_indices=True)
        turn = one.rotations[here]
        turn_of_other = other.rotations[there]
        held = np.isin(turn, fixed) & np.isin(turn_of_other, fixed)
        apart = ((turn != turn_of_other) & ~held).any(axis=1)

        if apart.any():
            point = format_point(one.points[here[apart]][0])
            yield Remark(
                f"hinge of '{first}' and '{second}'",
                float(apart.sum()),
                f"the shells '{first}' and '{second}' are hinged at {apart.sum()} nodes where they "
                f"meet, as at {point}; Shell(..., joined_to=...) of one joins it to the other",
            )
