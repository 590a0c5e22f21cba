"""Displacements counted anew: all that the bodies carry stays."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..errors import look_up
from ..forms import Form, as_forms
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
    given = as_forms(forms)
    states = {name: look_up(name, given, "form").completed(given).moved_back(last.x, state)
              for name, state in last.states.items()}
    x = np.zeros_like(last.x)
    for form in given.values():
        for field in (field for field in form.fields if not field.moves):
            x[field.first:field.end] = last.x[field.first:field.end]
    return Result((*result.stages[:-1], replace(last, x=x, states=states)))
