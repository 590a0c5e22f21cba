"""Forces of the supports."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy import ndarray

from ..forms import carried
from ..stages.result import StageResult
from ..stages.setup import forms_there


def reactions(forms: Mapping[str, Any], step: StageResult) -> ndarray:
    """Forces that the supports exert on the bodies: what the bodies carry, less the load.

    Parameters
    ----------
    forms
        All forms of the analysis by name, with the materials and laws that they have in the stage.
    step
        A stage of its result.

    Returns
    -------
    ndarray
        Forces in the directions of the unknowns, (N,); at those that are not fixed the residual is left.

    Raises
    ------
    ValueError
        The stage holds forms that are not given.

    Examples
    --------
    The ground under a square bears its weight:

    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(2).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> forms = {"square": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=.3))}
    >>> bottom = basis.get_dofs("bottom")
    >>> result = sc.run(forms, [sc.Stage("weight", sc.weight(basis, 20.))], fixed=bottom.all())
    >>> round(float(sc.reactions(forms, result["weight"])[bottom.all("u^2")].sum()), 9)
    20.0
    """
    return carried(forms_there(step, forms), step.x, step.states) - step.load
