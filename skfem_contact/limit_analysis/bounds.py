"""Certified bounds of factors of safety and limit loads, on meshes refined where they differ."""
from __future__ import annotations

import warnings
from collections.abc import Collection, Mapping
from typing import Any, Literal

import numpy as np
from numpy import ndarray
from tqdm import tqdm

from ..errors import AnalysisWarning
from ..solvers.threads import single_threaded
from .loading import Loads, PressureLike, TractionLike
from .reading import Problem, read
from .report import report
from .result import Bounds
from .search import Search

#: Share of the upper bound below which a lower one is none.
_NOTHING = 1e-3


@single_threaded
def bounds(forms: Mapping[str, Any], fixed: ndarray, weight: float | Mapping[str, float] = 0.0,
           tractions: Mapping[str, TractionLike] | None = None, water: PressureLike | None = None,
           wetted: str | Collection[str] = (), seismic: float = 0.0, reduce: str | Collection[str] | None = None,
           exclude: str | Collection[str] = (), live: str | Collection[str] = (),
           flow: Literal["given", "associated"] = "given", gap: float = 0.01, elements: int = 20_000,
           seconds: float = np.inf, progress: bool | None = None) -> Bounds:
    """Two numbers between which the factor of safety, or the limit load, lies, each with its proof.

    Below, stresses in equilibrium with the loads that no point yields under; above, velocities that obey the flow rule
    and whose dissipation the power of the loads exceeds (the theorems of limit analysis, see the theory pages).  Both
    are checked after the solver, to round-off.  What is proven holds for associated flow, and the upper bound for any
    other as well.  Elastic moduli, initial stresses and K0 do not matter.

    Parameters
    ----------
    forms
        Solids and contact pairs by name, in plane strain: Mohr-Coulomb, Tresca and von Mises materials; elastic bodies
        have no limit and count as rigid.  Contact is that of the boundaries as they are meshed, closed where they meet.
    fixed
        Unknowns that are held where they are, those of whole facets.
    weight
        Weight per volume: one number, or by subdomain.
    tractions
        Forces per area on boundaries, (t_x, t_y) or a function of places (2, n) with values (2, n).
    water
        Pressure of water in the pores, positive: a function of places, or values at the nodes.  Everything but rigid
        bodies has pores.
    wetted
        Boundaries on which the water presses from outside, see :func:`water_load`.
    seismic
        Horizontal acceleration, towards positive x, over that of gravity.
    reduce, exclude
        Names of forms and regions whose strength is reduced, and that keep it, as in :func:`strength_reduction`.
    live
        Names of the boundaries in ``tractions`` whose forces are multiplied, or ``"weight"``: the bounds are those of
        the multiplier at collapse, the strength is not reduced.
    flow
        ``"given"``: where the dilation of a soil is less than its friction, ``lower`` is an estimate, with the soil of
        less strength after Davis; ``"associated"``: it is taken to be the friction.
    gap
        Difference of the bounds, as a share of their mean, at which the refinement ends.
    elements
        Triangles, at most.
    seconds
        Processor time after which no finer mesh is begun.
    progress
        Show a progress bar; by default where the output is a terminal.

    Raises
    ------
    ValueError
        Bodies in space or axial symmetry, other materials or forms, nodes that are held alone, unknown names, no load,
        nothing to reduce, no collapse.

    Warns
    -----
    AnalysisWarning
        The gap was not reached, a bound could not be proven (it is then infinite), there is no lower one for want
        of cohesion, or the fixed loads alone cause a collapse.

    Examples
    --------
    A square of cohesive soil (c = 10) that can spread collapses at ``q = 2 c / F``:

    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshTri().refined(1).with_defaults(), ElementVector(ElementTriP2()), intorder=2)
    >>> column = sc.SolidForm(basis, sc.Tresca(E=1e3, nu=.3, c=10.))
    >>> fixed = np.hstack([basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")])
    >>> found = sc.bounds({"soil": column}, fixed, tractions={"top": (0., -10.)})
    >>> print(f"{found.lower:.3f} {found.upper:.3f}")
    2.000 2.000
    """
    check_settings(gap, elements, seconds)
    if flow not in ("given", "associated"):
        raise ValueError(f"flow must be 'given' or 'associated', not {flow!r}")
    loads = Loads(weight, seismic, dict(tractions or {}), water, names_of(wetted), names_of(live))
    problem = read(forms, fixed, loads, reduce, exclude, flow == "associated")
    return bracket(problem, gap, elements, seconds, progress, stacklevel=5)


def check_settings(gap: float, elements: int, seconds: float) -> None:
    """Refuse limits that nothing can keep."""
    if not (0 < gap < np.inf) or not elements > 0 or not seconds > 0:
        raise ValueError(f"gap, elements and seconds must be positive, not {gap!r}, {elements!r} and {seconds!r}")


def names_of(names: str | Collection[str]) -> tuple[str, ...]:
    """One name, or several."""
    return (names,) if isinstance(names, str) else tuple(names)


def bracket(problem: Problem, gap: float, elements: int, seconds: float, progress: bool | None, stacklevel: int
            ) -> Bounds:
    """Bounds of a problem; where they leave something open, a warning at the caller's level."""
    with tqdm(desc="bounds", disable=None if progress is None else not progress,
              bar_format="{desc} {postfix} {elapsed}") as bar:
        search = Search(problem, bar)
        search.run(gap, elements, seconds)
        davis = None if problem.davis is None else search.estimate(problem.davis)
    _tell(search, gap, stacklevel)
    return report(search, davis)


def _tell(search: Search, gap: float, stacklevel: int) -> None:
    """Warnings of a search that did not reach its end."""
    low, high = search.lower.proof.value, search.upper.proof.value
    unproven = [kind for kind, value in (("lower", low), ("upper", high)) if not np.isfinite(value)]
    if search.overloaded:
        why = f"the multiplier is at most {high:.5g}" if high < 0 else \
              f"they need {1 / search.fixed_factor:.4g} times the strength"
        warnings.warn(f"the fixed loads alone cause a collapse: {why}", AnalysisWarning, stacklevel=stacklevel)
    elif search.problem.cohesionless and not low > _NOTHING * high:
        warnings.warn("soil without cohesion bears nothing at a free surface, so that there is no lower bound: give it "
                      f"a small cohesion, whose bounds these then are; the upper bound is {high:.5g}", AnalysisWarning,
                      stacklevel=stacklevel)
    elif unproven:
        warnings.warn(f"no {' and no '.join(unproven)} bound could be proven", AnalysisWarning, stacklevel=stacklevel)
    elif search.gap > gap:
        warnings.warn(f"the bounds [{low:.5g}, {high:.5g}] differ by {search.gap:.2%}, more than the {gap:.2%} that "
                      "were asked for: allow more `elements` or `seconds`", AnalysisWarning, stacklevel=stacklevel)
