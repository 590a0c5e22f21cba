"""Check of an interface law."""
from __future__ import annotations

import numpy as np

from ..contact.laws import InterfaceLaw, Status, Traction
from .tools import EXACT, STEP, differences, largest_error, require, require_all, same_twice


def check_interface_law(law: InterfaceLaw, penalties: tuple[float, float] = (1e4, 1e4), size: float = 1e-3,
                        n: int = 500, tolerance: float = 1e-6, seed: int = 0) -> float:
    """Check an interface law on random gaps and slips.

    The answer has the right shapes and is the same twice, the arguments are left alone; open points are out of
    reach, and closed ones that just touch resist pressure; the derivatives are those of differences; a traction that
    has been returned is admissible, which is to say that the elastic slip alone gives it again; what slides
    dissipates; both directions are alike; more penetration does not mean less pressure.

    Parameters
    ----------
    law
        The interface law.
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
    >>> sc.check_interface_law(sc.Coulomb(mu=.3, adhesion=2.)) < 1e-8
    True
    """
    require(isinstance(getattr(law, "bonds", None), bool), "`bonds` must say, True or False, whether the law ties")
    rng = np.random.default_rng(seed)
    gap, slip = size * rng.uniform(-1, 1, n), size * rng.standard_normal(n)
    slip[: n // 10] = 0.0
    closed = rng.random(n) < 0.5
    reached = same_twice(lambda: law.reaches(gap, penalties[0], closed), (gap, closed), "law.reaches")
    require(np.shape(reached) == (n,) and np.asarray(reached).dtype == bool, "`reaches` must return (n,) booleans")
    require_all(~(reached & ~closed & (gap > 0.0)), "`reaches` names points that were open and still are")
    gap, slip = gap[reached], slip[reached]

    def answer(dg: float = 0.0, ds: float = 0.0) -> Traction:
        return law.update(gap + dg, slip + ds, *penalties)

    new = same_twice(answer, (gap, slip), "law.update")
    for name, value in zip(Traction._fields, new, strict=True):
        require(np.shape(value) == gap.shape, f"{name} has the shape {np.shape(value)}, not {gap.shape}")
        require(np.isfinite(value).all(), f"{name} is not finite")
    require_all(np.isin(new.status, [int(s) for s in Status]), "`status` holds what is no Status")
    force = np.abs(np.concatenate((new.normal, new.tangential))).max()
    again = law.update(gap, new.elastic_slip, *penalties).tangential
    require_all(np.abs(again - new.tangential) <= EXACT * force,
                "the traction is not admissible: the elastic slip does not give it again")
    opposite = law.update(gap, -slip, *penalties).tangential
    require_all(np.abs(opposite + new.tangential) <= EXACT * force, "the opposite slip gives no opposite traction")
    require_all(new.tangential * (slip - new.elastic_slip) >= -EXACT * force * size, "sliding dissipates negative work")
    require_all(new.normal_by_gap >= 0, "the pressure falls with the penetration")
    _check_touching(law, penalties)

    worst, h = 0.0, STEP * size
    for name, derivative, part in (("normal_by_gap", new.normal_by_gap, lambda d: answer(dg=d).normal),
                                   ("tangential_by_gap", new.tangential_by_gap, lambda d: answer(dg=d).tangential),
                                   ("tangential_by_slip", new.tangential_by_slip, lambda d: answer(ds=d).tangential)):
        slope, kink = differences(part, h)
        worst = max(worst, largest_error(np.abs(slope - derivative) / max(penalties), kink / max(penalties), tolerance,
                                          f"{name} differs from the differences", kinks=0.5))
    return worst


def _check_touching(law: InterfaceLaw, penalties: tuple[float, float]) -> None:
    """Bodies that touch as meshed are held by points whose gap is zero."""
    zero, closed = np.zeros(1), np.ones(1, bool)
    require(np.all(law.reaches(zero, penalties[0], closed)), "closed points whose gap is zero are out of reach: bodies "
            "that touch as meshed would be loose")
    require(np.all(law.update(zero, zero, *penalties).normal_by_gap > 0),
            "closed points whose gap is zero meet no resistance: bodies that touch as meshed would be loose")
