"""Check of a form."""

from __future__ import annotations

from itertools import combinations
from typing import Any, cast

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..errors import Remark
from ..forms.base import Form, Outputs, Response, as_forms
from ..forms.roles import Regularised, arrays_of
from .laws import EXACT, STEP, differences, largest_error, require, same_twice


def check_form(
    form: Any,
    x: ndarray,
    state: Any,
    locations: ndarray | None = None,
    tolerance: float = 1e-6,
    directions: int = 5,
    seed: int = 0,
) -> float:
    """Check a form at some displacements from an accepted state.

    A second call returns the same, and arguments do not change.  State and tangent are evaluated
    lazily.  The tangent agrees with central differences, and is symmetric if `form.symmetric` is
    True.  The candidate state gives the same force at the same displacements.  ``outer``,
    ``summary`` and ``remarks`` return the right types.  With `locations`, forces and moments
    balance and rigid motions meet no resistance.

    Parameters
    ----------
    form
        The form.
    x
        Displacements, (N,), best random ones.
    state
        An accepted state, such as ``form.initial_state()``.
    locations
        Coordinates of the dofs, ``basis.doflocs``, if action and reaction are both forces of this
        form: not for rigid obstacles and other supports.  Balance in either the undeformed or the
        displaced configuration is enough.
    tolerance
        Error of the tangent, relative to the largest difference.
    directions
        Number of random directions of the differences.
    seed
        Seed of the random numbers.

    Returns
    -------
    float
        Largest error of the tangent.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(2), ElementVector(ElementQuad1()), intorder=2)
    >>> form = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=.3))
    >>> x = 1e-3 * np.random.default_rng(0).standard_normal(basis.N)
    >>> sc.testing.check_form(form, x, form.initial_state(), basis.doflocs) < 1e-8
    True
    """
    rng = np.random.default_rng(seed)
    form = as_forms({"form": form})["form"]
    if directions < 1 or type(state) is not type(form.initial_state()):
        raise ValueError(
            f"directions must be at least 1, and the state one of the form's, not "
            f"{type(state).__name__}"
        )
    first = form.assemble(x, state)
    for name in ("state", "stiffness"):
        eager = isinstance(first, Response) and name in vars(first)
        require(not eager, f"the {name} is computed before its first access")

    def arrays() -> tuple[ndarray, ...]:
        response = _among_all(form, x, state)
        return (response.force, response.stiffness.data, *arrays_of(response.state).values())

    out = same_twice(arrays, (x, *arrays_of(state).values()), "form.assemble")
    force, K = np.asarray(out[0]), cast(Any, _among_all(form, x, state).stiffness)
    require(
        isinstance(K, csr_matrix) and K.shape == (len(x), len(x)),
        "the stiffness is no csr_matrix (N, N)",
    )
    require(
        force.shape == x.shape and np.isfinite(force).all() and np.isfinite(K.data).all(),
        "the force is no (N,), or not finite",
    )
    if form.symmetric:
        require(
            abs(K - K.T).max() <= EXACT * abs(K).max(),
            "`symmetric` is True, but the tangent is not symmetric",
        )
    scale = max(float(np.abs(force).max()), 1e-300)
    accepted = _among_all(form, x, first.state)
    require(
        np.abs(accepted.force - force).max() <= 1e-7 * scale,
        "the accepted candidate gives another force",
    )
    again = form.outer(x, state, first.state) if isinstance(form, Regularised) else None
    require(
        again is None
        or (isinstance(again, tuple) and len(again) == 2 and isinstance(again[1], type(state))),
        "`outer` returns neither a form with a state nor None",
    )
    outputs = form.outputs(x, first.state)
    require(isinstance(outputs, Outputs), "`outputs` returns no Outputs")
    require(isinstance(outputs.summary, str), "the summary of `outputs` is no text")
    require(
        all(isinstance(remark, Remark) for remark in outputs.remarks),
        "the remarks of `outputs` are no remarks",
    )
    error = _form_tangent(form, x, state, K, rng.standard_normal((directions, len(x))), tolerance)
    if locations is not None:
        _check_balance(force, K, x, np.asarray(locations))
    return error


def _among_all(form: Form, x: ndarray, state: Any) -> Response:
    """Return the response; a local one among all dofs."""
    response = form.assemble(x, state)
    return (
        response.padded(len(x)) if isinstance(response, Response) and response.local else response
    )


def _check_balance(force: ndarray, K: Any, x: ndarray, locations: ndarray) -> None:
    """Check that resultant, moment and stiffness of rigid motions vanish."""
    dim = len(locations)
    f, points = force.reshape(-1, dim), locations[:, ::dim].T
    arms = max(float(np.ptp(points)), 1e-300)
    require(np.abs(f.sum(axis=0)).max() <= 1e-8 * np.abs(f).sum(), "the forces do not balance")
    shift = np.tile(np.eye(dim), len(f))
    stiffness = max(float(abs(K).max()), 1e-300)
    require(np.abs(K @ shift.T).max() <= 1e-8 * stiffness, "a rigid shift meets resistance")
    moments, resistances = [], []
    turns = [np.outer(b, a) - np.outer(a, b) for a, b in combinations(np.eye(dim), 2)]
    for configuration, follows in ((points, 0.0), (points + x.reshape(-1, dim), 1.0)):
        p = configuration - configuration.mean(axis=0)
        spins = [p @ turn.T for turn in turns]
        moments.append(
            max(abs((spin * f).sum()) for spin in spins) / (np.abs(f).sum() * arms + 1e-300)
        )
        resistances.append(
            max(
                np.abs(K @ spin.ravel() - follows * (f @ turn.T).ravel()).max()
                for spin, turn in zip(spins, turns)
            )
            / (stiffness * arms)
        )
    require(min(moments) <= 1e-8, "the moments of the forces do not balance")
    require(
        min(resistances) <= 1e-8, "a rigid rotation changes more than the directions of the forces"
    )


def _form_tangent(
    form: Form, x: ndarray, state: Any, K: Any, directions: ndarray, tolerance: float
) -> float:
    size = max(float(np.abs(x).max()), 1e-6)
    errors, kinks = [], []
    for d in directions:

        def force(h: Any, d: ndarray = d) -> ndarray:
            return _among_all(form, x + h * d, state).force

        slope, kink = differences(force, STEP * size)
        largest = max(float(np.abs(K @ d).max()), float(np.abs(slope).max()), 1e-300)
        errors.append(np.abs(slope - K @ d) / largest)
        kinks.append(kink / largest)
    return largest_error(
        np.max(errors, axis=0),
        np.max(kinks, axis=0),
        tolerance,
        "the tangent differs from the differences of the force",
    )
