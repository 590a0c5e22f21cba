"""Check of an interface law."""
from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy import ndarray

from ..contact.laws import InterfaceLaw, Status, Update
from .tools import EXACT, STEP, differences, largest_error, require, require_all, same_twice


def check_interface_law(law: InterfaceLaw, penalties: tuple[float, float] = (1e4, 1e4), size: float = 1e-3,
                        n: int = 500, tolerance: float = 1e-6, seed: int = 0, dimensions: tuple[int, ...] = (2, 3)
                        ) -> float:
    """Check an interface law on random gaps and slips, in the plane and in space.

    The answer has the right shapes and is the same twice, the arguments are left alone; open points are out of
    reach, and closed ones that just touch resist pressure; the derivatives are those of differences; a traction that
    has been returned is admissible, which is to say that the elastic slip alone, with the new internal variables, gives
    it again; what slides dissipates; opposite directions are alike; more penetration does not mean less pressure. All
    of this holds for points as they are at first, and for those that the law has led to other internal variables.

    Parameters
    ----------
    law
        The interface law; its parameters are numbers.
    penalties
        Normal and tangential penalty.
    size
        Size of gaps and slips; with the penalty it gives the size of the tractions.
    n
        Number of random points.
    tolerance
        Error of the derivatives, relative to the larger penalty.
    seed
        Of the random numbers.
    dimensions
        Dimensions in which the law is to be used: in 3 the slip has two components.

    Returns
    -------
    float
        Largest error of the derivatives.

    Raises
    ------
    CheckFailed
        With what is violated, and at how many points.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.testing.check_interface_law(sc.Coulomb(mu=.3, adhesion=2.)) < 1e-8
    True
    """
    require(isinstance(law, InterfaceLaw), "the law is no InterfaceLaw")
    require(isinstance(law.bonds, bool), "`bonds` must say, True or False, whether the law ties")
    rng, worst = np.random.default_rng(seed), 0.0
    for dim in dimensions:
        internal = np.zeros((law.n_internal, n))
        for _ in range(3):  # as at first, and twice from where the law has led the points
            jump = size * np.concatenate((rng.uniform(-1, 1, (1, n)), rng.standard_normal((dim - 1, n))))
            jump[1:, : n // 10] = 0.0
            reached = _check_reach(law, jump[0], internal, rng.random(n) < 0.5)
            new = _check_update(law, jump[:, reached], internal[:, reached], penalties, size)
            worst = max(worst, _check_tangent(law, jump[:, reached], internal[:, reached], penalties, size, tolerance))
            internal[:, reached] = new.internal
        _check_touching(law, penalties, dim)
    return worst


def _check_reach(law: InterfaceLaw, gap: ndarray, internal: ndarray, closed: ndarray) -> ndarray:
    """Points that the law reaches; none that was open and still is, unless its internal variables say so."""
    reached = same_twice(lambda: law.reaches(gap, internal, closed), (gap, internal, closed), "law.reaches")
    require(np.shape(reached) == gap.shape and np.asarray(reached).dtype == bool,
            "`reaches` must return (n,) booleans")
    untouched = (internal == 0.0).all(axis=0)
    require_all(~(reached & ~closed & (gap > 0.0) & untouched), "`reaches` names points that were open and still are")
    return np.asarray(reached)


def _check_update(law: InterfaceLaw, jump: ndarray, internal: ndarray, penalties: tuple[float, float], size: float
                  ) -> Update:
    """The answer, whose shapes, signs and admissibility are right."""
    def answer(slip: ndarray, before: ndarray) -> Update:
        return law.update(np.concatenate((jump[:1], slip)), before, penalties)

    new = same_twice(lambda: law.update(jump, internal, penalties), (jump, internal), "law.update")
    dim, n = jump.shape
    shapes = {"traction": (dim, n), "internal": (law.n_internal, n), "tangent": (dim, dim, n),
              "elastic_slip": (dim - 1, n), "status": (n,)}
    for name, shape in shapes.items():
        value = getattr(new, name)
        require(np.shape(value) == shape, f"{name} has the shape {np.shape(value)}, not {shape}")
        require(np.isfinite(value).all(), f"{name} is not finite")
    require_all(np.isin(new.status, [int(s) for s in Status]), "`status` holds what is no Status")
    force = max(float(np.abs(new.traction).max(initial=0.0)), 1e-300)
    again = answer(new.elastic_slip, new.internal).traction
    require_all((np.abs(again - new.traction) <= EXACT * force).all(axis=0),
                "the traction is not admissible: the elastic slip does not give it again")
    opposite = answer(-jump[1:], internal).traction
    require_all((np.abs(opposite[1:] + new.traction[1:]) <= EXACT * force).all(axis=0),
                "the opposite slip gives no opposite traction")
    work = (new.traction[1:] * (jump[1:] - new.elastic_slip)).sum(axis=0)
    require_all(work >= -EXACT * force * size, "sliding dissipates negative work")
    require_all((new.tangent[0, 0] >= 0) | (jump[0] > 0), "the pressure falls with the penetration")
    return new


def _check_tangent(law: InterfaceLaw, jump: ndarray, internal: ndarray, penalties: tuple[float, float], size: float,
                   tolerance: float) -> float:
    """Largest error of the tangent beside differences, component by component."""
    def moved(by: int) -> Callable[[float], ndarray]:
        unit = np.eye(len(jump))[by][:, None]
        return lambda d: law.update(jump + d * unit, internal, penalties).traction

    tangent, scale, worst = law.update(jump, internal, penalties).tangent, max(penalties), 0.0
    for by in range(len(jump)):
        slope, kink = differences(moved(by), STEP * size)
        for of in range(len(jump)):
            worst = max(worst, largest_error(np.abs(slope[of] - tangent[of, by]) / scale, kink[of] / scale, tolerance,
                                             f"tangent[{of}, {by}] differs from the differences", kinks=0.5))
    return worst


def _check_touching(law: InterfaceLaw, penalties: tuple[float, float], dim: int) -> None:
    """Bodies that touch as meshed are held by points whose gap is zero."""
    jump, internal = np.zeros((dim, 1)), np.zeros((law.n_internal, 1))
    require(np.all(law.reaches(jump[0], internal, np.ones(1, bool))), "closed points whose gap is zero are out of "
            "reach: bodies that touch as meshed would be loose")
    require(np.all(law.update(jump, internal, penalties).tangent[0, 0] > 0),
            "closed points whose gap is zero meet no resistance: bodies that touch as meshed would be loose")
