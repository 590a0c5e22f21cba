"""Factor of safety by trials at fixed factors: no work is prescribed and no curve is followed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy import ndarray

import skfem_contact as sc


def enclosed_factor(
    forms: Mapping[str, Any], fixed: Any, load: ndarray, tolerance: float = 0.01
) -> tuple[float, float]:
    """Return a factor at which a structure stands, and one at which it was not found to stand.

    Without dilatancy an iteration from the unstrained bodies may end without a collapse.
    """

    def stands(factor: float) -> bool:
        weaker = {
            name: form.reduced(factor, "given", form.strengths) if form.strengths else form
            for name, form in forms.items()
        }
        try:
            return bool(sc.Model(weaker, fixed).is_stable(load))
        except sc.NotConverged:
            return False

    low, high = 0.25, 0.5
    assert stands(low)
    while stands(high):
        low, high = high, 2.0 * high
        assert high < 100.0
    while high - low > tolerance:
        middle = 0.5 * (low + high)
        if stands(middle):
            low = middle
        else:
            high = middle
    return low, high
