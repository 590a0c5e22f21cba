"""Mechanisms: motions that bars, blocks in contact and points that flow do not resist."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, diags

from ..errors import NoEquilibrium, NotConverged, warn
from ..forms.base import Form, Response
from ..nonlinear.newton import Newton
from ..nonlinear.system import System
from ..results.stage import StageResult
from ..solvers.direct import SingularSystem

#: Stiffnesses of the springs, relative to the largest entry of each row of the tangent.
_SOFT = (1e-7, 1e-9)
#: Least share of the load that springs resist in a mechanism, and its ratio for the two stiffnesses: 1 in a mechanism,
#: 0.01 where something else resists.
_SHARE, _SAME = 1e-3, 0.5
#: Share of the forces out of balance that may remain: a push of 1 % of the weight is within the tolerance of a search.
_BALANCE = 0.1
#: Displacement up to which displacements count as small, over the extent of the model. Five nails as elastic beams in a
#: slope of 8 m led a search to 193 m and a factor of 1.61, for 1.575 at a tenth of the extent, 2.4 m.
_FAR = 0.1

#: Kinds of remarks on what changes a collapse load.
_TOLD = ("pivot", "locking")


class _Springs(Form):
    """Springs that hold all motions at a configuration."""

    symmetric = True

    def __init__(self, stiffness: ndarray, x: ndarray) -> None:
        self._stiffness, self._x = stiffness, x

    def assemble(self, x: ndarray, state: Any) -> Response:
        return Response(self._stiffness * (x - self._x), lambda: state, lambda: csr_matrix(diags(self._stiffness)))


def as_collapse(error: NotConverged, system: System, x: ndarray, states: Mapping[str, Any], load: ndarray,
                newton: Newton) -> NotConverged:
    """Return the error, or :class:`NoEquilibrium` if only springs hold the structure, however soft they are.

    The tangent of a mechanism is singular, but so is that of single points without pressure beside an equilibrium.
    """
    begun = system.evaluate(x, states, load)
    rows = abs(system.tangent(begun)).max(axis=1).toarray().ravel()
    rows[system.layout.still] = 0.0
    exact = replace(newton, tolerance=min(newton.tolerance, _BALANCE * begun.norm))
    now, shares, name = x, [], " ".join([*system.forms, "springs"])  # longer than every other name
    for soft in _SOFT:
        springs = _Springs(soft * rows, x)
        held = system.with_forms({**system.forms, name: springs})
        try:
            now = held.equilibrium(x, {**states, name: None}, load, x[system.fixed], exact, at_least=1,
                                   damp=True, start=now).x
        except NotConverged:
            return error
        work = float(begun.residual @ (now - x))
        shares.append(float(springs.assemble(now, None).force @ (now - x)) / work if work > 0.0 else 0.0)
    if shares[-1] < max(_SHARE, _SAME * shares[0]):
        return error
    return NoEquilibrium(f"nothing resists a motion: only springs would resist {shares[-1]:.1%} of the load",
                         now, error.residuals, int(np.argmax(np.abs(now - x))))


def warn_of_errors(system: System, x: ndarray, states: Mapping[str, Any]) -> None:
    """Raise warnings of what changes a collapse load: joints that turn inside of their ends, elements that lock."""
    for name, form in system.forms.items():
        for remark in form.remarks(x[:form.size], states[name]):
            if remark.kind in _TOLD:
                warn(f"{name}: {remark.text}")


def warn_of_motion(what: str, value: float, curve: ndarray, tolerance: float, end: StageResult) -> None:
    """Raise a warning if a value needs displacements that are not small: the curve, (n, 3), still rises there."""
    places = end.layout.coordinates if end.layout else np.zeros((2, 1))
    moved, near = np.maximum.accumulate(curve[1:, 2]), _FAR * np.ptp(places, axis=1).max()
    if len(moved) and moved[-1] > near > 0.0:
        reached = max(np.interp(near, moved, curve[1:, 1]), curve[curve[:, 2] <= near, 1].max(initial=-np.inf))
        if value - reached > tolerance:
            warn(f"the {what} {value:.4g} belongs to displacements of {moved[-1]:.3g}, and those up to {near:.3g}, a "
                 f"tenth of the model, give {reached:.4g}: parts such as elastic beams resist without limit, or bodies "
                 "are soft")


def is_singular(error: NotConverged) -> bool:
    """Return True if a tangent was singular."""
    return isinstance(error.__cause__, SingularSystem)
