"""Does a structure stand?  One equilibrium or one collapse: a yes or a no costs far less than a factor of safety."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy import ndarray

from ..errors import NoEquilibrium, NotConverged
from ..forms.base import Form
from ..nonlinear.newton import Newton
from ..results.result import Result, StageResult
from ..solvers.threads import single_threaded
from .continuation import as_collapse, loaded_start


@single_threaded
def stands(forms: Mapping[str, Form], fixed: ndarray, load: ndarray | None = None,
           start: Result | StageResult | None = None, newton: Newton | None = None, solver: Any = None) -> bool:
    """Whether a structure carries its load: a factor of safety above 1, asked in one step.

    An equilibrium is a yes; displacements that run away along a mechanism, see :class:`NoEquilibrium`, are a no.
    Iterations that end in neither are no answer: they raise.

    Parameters
    ----------
    forms, fixed, load, start, solver
        As for :func:`strength_reduction`.
    newton
        Settings of Newton's method; by default the residual is at most 3e-4 of the load, as in a search with a
        tolerance of 0.01 of the factor.

    Raises
    ------
    ValueError
        No load, or bad input.
    NotConverged
        Neither an equilibrium nor a collapse was found; :func:`limit_load` goes there step by step: is its multiplier
        above 1?

    Examples
    --------
    A column of clay that can spread carries 2 c:

    >>> import numpy as np
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> column = sc.SolidForm(basis, sc.Tresca(E=1e3, nu=.3, c=10.), strain="b_bar")
    >>> fixed = np.hstack([basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")])
    >>> [sc.Model({"clay": column}, fixed).is_stable(sc.traction(basis, "top", (0., -q))) for q in (19.9, 40.)]
    [True, False]
    """
    _, system, origin, load = loaded_start(forms, fixed, load, start, solver)
    try:
        system.equilibrium(origin.x, origin.states, load, origin.x[system.fixed],
                           newton or Newton(tolerance=3e-4, max_iterations=60), ("energy", "residual"), at_least=1,
                           damp=True)
    except NotConverged as error:
        if isinstance(as_collapse(error, system), NoEquilibrium):
            return False
        raise
    return True
