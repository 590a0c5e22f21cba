"""Strains that round-off hides."""

from __future__ import annotations

import pytest

import skfem_contact as sc
from tests.tools.scenes import block_on_base


def test_strains_that_round_off_hides():
    """They converge, or the message says why not."""
    _, forms, load, fixed = block_on_base()
    with pytest.raises(sc.NotConverged, match="round-off alone may leave"):
        sc.Model(forms, fixed, newton=sc.Newton(max_iterations=8)).run(
            [sc.Stage("a", 1e-8 * load)], progress=False
        )
