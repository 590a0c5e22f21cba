"""Plane cases of the stress tests once more in space, as slices one element thick: the same
displacements to 1e-8.

Left out are rules that sample a slice otherwise: "segments" where points stick and slip within a
piece, and Gauss points where the master's facets are shorter than the slave's, which are divided by
the sides of squares.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.stability import setups
from tests.stability import test_meshes as meshes
from tests.stability import test_motion as motion
from tests.stability import test_penalties_and_stiffness as penalties
from tests.stability import test_startup as startup
from tests.tools import space

#: Functions of plane tests, and what they are asked for.
CASES = [
    *((penalties.test_tangential_penalty, given) for given in ((1.0, 2, "nodal"), (1e2, 2, 2))),
    *((penalties.test_friction, (mu, rule)) for mu in (0.3, 2.0) for rule in ("nodal", 2)),
    *(
        (penalties.test_stiffness_contrast, ((1e3, 1e9), rule, 2))
        for rule in ("nodal", 2, "segments")
    ),
    (penalties.test_limits_of_friction, ()),
    (motion.test_off_the_edge_and_back, (2, 2)),
    (motion.test_fast_reversal, (2, "nodal")),
    *((motion.test_overlap, (0.5, rule, 2)) for rule in ("nodal", 2, "segments")),
    (motion.test_deep_overlap_on_the_way, ("nodal",)),
    (motion.test_dissipation_over_facets, ()),
    (meshes.test_sizes_across_the_interface, (2, (40, 2), "nodal")),
    *((meshes.test_sizes_across_the_interface, (2, (2, 40), rule)) for rule in ("nodal", 2)),
    *((meshes.test_corner_on_corner, (2, False, 0.3, rule)) for rule in ("nodal", 2)),
    *((meshes.test_distorted_elements, (2, element, "nodal", 1)) for element in ("Q1", "Q2")),
    (meshes.test_distorted_elements, (2, "Q1", 2, 1)),
    *((meshes.test_needles, (rule,)) for rule in ("nodal", 2, "segments")),
    *((startup.test_opens_completely_and_closes_again, (rule, 2)) for rule in ("nodal", 2)),
]


@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
@pytest.mark.parametrize(
    ("case", "given"), CASES, ids=lambda value: getattr(value, "__name__", None)
)
@pytest.mark.one_in(3)
def test_plane_case_as_a_slice(case, given, monkeypatch):
    """Every analysis of a plane test is run again as a slice."""
    seen = []

    def again(forms, stages, fixed, options, result):
        twin = space.Slice(result[-1].forms)  # with the penalties of the model
        twin.compare(result, twin.run(stages, fixed, **options), 1e-8)
        seen.append(len(result))

    monkeypatch.setattr(setups, "afterwards", [again])
    case(
        *(
            np.random.default_rng(value)
            if case is meshes.test_distorted_elements and k == 3
            else value
            for k, value in enumerate(given)
        )
    )
    assert seen
