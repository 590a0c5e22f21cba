"""Displacements counted anew: all that the bodies carry stays."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ..contact.pair import ContactPair
from ..contact.state import ContactState
from ..contact.transfer import interpolated
from ..errors import look_up
from ..forms import Form
from ..solid import SolidForm
from .result import Result


def reset_displacements(forms: Mapping[str, Form], result: Result) -> Result:
    """Count displacements from the end of a result on: they become zero, and all that is carried stays.

    Parameters
    ----------
    forms
        The forms of the analysis; those that the last stage does not hold are left out.
    result
        Its result.

    Returns
    -------
    Result
        The same stages; the last one has no displacements.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=.3))}
    >>> fixed = basis.get_dofs("bottom").all()
    >>> gravity = [sc.Stage("gravity", sc.weight(basis, 20.))]
    >>> start = sc.reset_displacements(forms, sc.run(forms, gravity, fixed))
    >>> bool(start["gravity"].x.any()), bool(start["gravity"].states["ground"].stress.any())
    (False, True)
    """
    last = result[-1]
    states: dict[str, Any] = {}
    for name, state in last.states.items():
        form = look_up(name, forms, "form")
        states[name] = state
        if isinstance(form, SolidForm):
            states[name] = replace(state, strain=np.zeros_like(state.strain))
        elif isinstance(form, ContactPair):
            states[name] = _moved_back(form, state)
    return Result((*result.stages[:-1], replace(last, x=np.zeros_like(last.x), states=states)))


def _moved_back(pair: ContactPair, state: ContactState) -> ContactState:
    """The state of a pair whose bodies are back in their places, with all it carries."""
    home = pair.initial_state()
    old, new = pair.points(state), pair.points(home)
    elastic = pair.elastic_slip(state)
    if pair.quadrature == "segments":
        excess = interpolated(pair.slave, old, new, np.where(np.isfinite(state.gap), state.gap - state.offset, 0.0))
        elastic = interpolated(pair.slave, old, new, elastic)
        state = replace(pair.transferred(state, home.cuts), offset=np.zeros(len(excess)), gap=excess)
    near = np.isfinite(home.gap) & np.isfinite(state.gap)
    offset = np.where(near, home.gap - (state.gap - state.offset), 0.0)
    state = replace(state, facet=home.facet, position=home.position, gap=home.gap, slip=np.zeros_like(state.slip),
                    offset=offset)
    return pair.with_elastic_slip(state.with_stick(home.stick), elastic)
