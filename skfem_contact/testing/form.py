"""Check of a form."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..arrays import max_abs
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
    True.  The candidate state gives the same force at the same displacements.  ``outer`` and
    ``outputs`` return the right types.  With `locations`, forces and moments balance and rigid
    motions meet no resistance.

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
    form = as_forms({"form": form})["form"]
    if directions < 1 or type(state) is not type(form.initial_state()):
        raise ValueError(
            f"directions must be at least 1, and the state one of the form's, not "
            f"{type(state).__name__}"
        )

    # Check that state and tangent are lazy.
    first = form.assemble(x, state)
    for name in ("state", "stiffness"):
        eager = isinstance(first, Response) and name in vars(first)
        require(not eager, f"the {name} is computed before its first access")

    # Check force, candidate state, tangent and balance.
    force, K = _checked_arrays(form, x, state)
    _check_candidate(form, x, state, first.state, force)
    samples = np.random.default_rng(seed).standard_normal((directions, len(x)))
    error = _form_tangent(form, x, state, K, samples, tolerance)
    if locations is not None:
        _check_balance(force, K, x, np.asarray(locations))
    return error


def _checked_arrays(form: Form, x: ndarray, state: Any) -> tuple[ndarray, Any]:
    """Return force and stiffness among all dofs, after a check that both are right."""

    def arrays() -> tuple[ndarray, ...]:
        response = _among_all(form, x, state)
        return (response.force, response.stiffness.data, *arrays_of(response.state).values())

    # Check the types, the shapes and the values.
    given = (x, *arrays_of(state).values())
    force = np.asarray(same_twice(arrays, given, "form.assemble")[0])
    K: Any = _among_all(form, x, state).stiffness
    square = isinstance(K, csr_matrix) and K.shape == (len(x), len(x))
    require(square, "the stiffness is no csr_matrix (N, N)")
    finite = np.isfinite(force).all() and np.isfinite(K.data).all()
    require(force.shape == x.shape and finite, "the force is no (N,), or not finite")

    # Check the symmetry.
    if form.symmetric:
        skew = abs(K - K.T).max()
        message = "`symmetric` is True, but the tangent is not symmetric"
        require(skew <= EXACT * abs(K).max(), message)
    return force, K


def _check_candidate(form: Form, x: ndarray, state: Any, candidate: Any, force: ndarray) -> None:
    """Check the force of the candidate state, and the types that depend on it."""
    # Check the force of the candidate.
    scale = max(max_abs(force), 1e-300)
    drift = max_abs(_among_all(form, x, candidate).force - force)
    require(drift <= 1e-7 * scale, "the accepted candidate gives another force")

    # Check the types of the outer loop and of the outputs.
    again = None
    if isinstance(form, Regularised):
        again = form.outer(x, state, candidate)
    if again is not None:
        pair = isinstance(again, tuple) and len(again) == 2
        same_type = pair and isinstance(again[1], type(state))
        require(same_type, "`outer` returns neither a form with a state nor None")
    outputs = form.outputs(x, candidate)
    require(isinstance(outputs, Outputs), "`outputs` returns no Outputs")
    require(isinstance(outputs.summary, str), "the summary of `outputs` is no text")
    known = all(isinstance(remark, Remark) for remark in outputs.remarks)
    require(known, "the remarks of `outputs` are no remarks")


def _among_all(form: Form, x: ndarray, state: Any) -> Response:
    """Return the response; a local one among all dofs."""
    response = form.assemble(x, state)
    if isinstance(response, Response) and response.local:
        return response.padded(len(x))
    return response


def _check_balance(force: ndarray, K: Any, x: ndarray, locations: ndarray) -> None:
    """Check that resultant, moment and stiffness of rigid motions vanish."""
    dim = len(locations)
    f = force.reshape(-1, dim)
    total = np.abs(f).sum()
    stiffness = max(float(abs(K).max()), 1e-300)

    # Check resultant and rigid shifts.
    require(max_abs(f.sum(axis=0)) <= 1e-8 * total, "the forces do not balance")
    shifts = np.tile(np.eye(dim), len(f)).T
    require(max_abs(K @ shifts) <= 1e-8 * stiffness, "a rigid shift meets resistance")

    # Compute moments and resistances to rigid rotations in both configurations.
    points = locations[:, ::dim].T
    arms = max(float(np.ptp(points)), 1e-300)
    turns = [np.outer(b, a) - np.outer(a, b) for a, b in combinations(np.eye(dim), 2)]
    moments = []
    resistances = []
    for configuration, follows in ((points, 0.0), (points + x.reshape(-1, dim), 1.0)):
        p = configuration - configuration.mean(axis=0)
        moment = 0.0
        resistance = 0.0
        for turn in turns:
            spin = p @ turn.T
            moment = max(moment, abs((spin * f).sum()))
            turned_force = (f @ turn.T).ravel()
            change = K @ spin.ravel() - follows * turned_force
            resistance = max(resistance, max_abs(change))
        moments.append(moment / (total * arms + 1e-300))
        resistances.append(resistance / (stiffness * arms))

    # Require balance in either of them.
    require(min(moments) <= 1e-8, "the moments of the forces do not balance")
    require(
        min(resistances) <= 1e-8, "a rigid rotation changes more than the directions of the forces"
    )


def _form_tangent(
    form: Form,
    x: ndarray,
    state: Any,
    K: Any,
    directions: ndarray,
    tolerance: float,
) -> float:
    """Return the largest error of the tangent in all directions, at smooth points."""
    size = max(max_abs(x), 1e-6)
    error = np.zeros(len(x))
    kink = np.zeros(len(x))
    for d in directions:

        def force(h: float, d: ndarray = d) -> ndarray:
            return _among_all(form, x + h * d, state).force

        # Compare K d with the differences along d.
        slope, gap = differences(force, STEP * size)
        tangent = K @ d
        largest = max(max_abs(tangent), max_abs(slope), 1e-300)
        error = np.maximum(error, np.abs(slope - tangent) / largest)
        kink = np.maximum(kink, gap / largest)
    message = "the tangent differs from the differences of the force"
    return largest_error(error, kink, tolerance, message)
