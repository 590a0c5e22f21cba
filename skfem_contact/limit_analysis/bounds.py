"""Certified bounds of factors of safety and limit loads: alone, and beside what a search has found."""
from __future__ import annotations

import warnings
from collections.abc import Collection, Mapping
from typing import Any, Literal

import numpy as np
from numpy import ndarray
from skfem import MeshTri
from tqdm import tqdm

from ..errors import AnalysisWarning, names_of
from ..loads import Pressure
from ..solvers import single_threaded
from .certify import dissipation
from .loading import Loads, TractionLike, Vectors
from .reading import Problem, read
from .result import Bounds
from .search import Found, Search
from .triangles import Triangles

#: Share of the upper bound below which a lower one is none.
_NOTHING = 1e-3
#: What may be asked for beside a search: arguments of :func:`bounds`.
_OPTIONS: dict[str, Any] = {"water": None, "wetted": (), "gap": 0.01, "elements": 20_000, "seconds": np.inf}


@single_threaded
def bounds(forms: Mapping[str, Any], fixed: ndarray, weight: float | Mapping[str, float] = 0.0,
           tractions: Mapping[str, TractionLike] | None = None, water: Pressure | None = None,
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
        Layout that are held where they are, those of whole facets.
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
    >>> found = sc.Model({"soil": column}, fixed).bounds(tractions={"top": (0., -10.)})
    >>> print(f"{found.lower:.3f} {found.upper:.3f}")
    2.000 2.000
    """
    if flow not in ("given", "associated"):
        raise ValueError(f"flow must be 'given' or 'associated', not {flow!r}")
    loads = Loads(weight, seismic, dict(tractions or {}), water, names_of(wetted), names_of(live))
    return _bracket(forms, fixed, loads, reduce, exclude, flow, gap, elements, seconds, progress, stacklevel=5)


def beside(certify: bool | Mapping[str, Any], forms: Mapping[str, Any], fixed: ndarray, dead: ndarray,
           live: ndarray | None, reduce: str | Collection[str] | None = None, exclude: str | Collection[str] = (),
           flow: str = "given", progress: bool | None = None) -> Bounds | None:
    """Bounds of what a search looks for; None unless they are asked for.

    Parameters
    ----------
    certify
        Whether, or arguments of :func:`bounds`: water, wetted, gap, elements, seconds.
    forms, fixed, reduce, exclude, flow, progress
        As for the search.
    dead, live
        Load vectors, fixed and multiplied, (N,); live is None where the strength is reduced.

    Raises
    ------
    ValueError
        As :func:`bounds`; other arguments; loads that are not distributed, see :class:`Vectors`.
    """
    if certify is False:
        return None
    if certify is not True and (not isinstance(certify, Mapping) or set(certify) - set(_OPTIONS)):
        raise ValueError(f"certify must be True, or arguments of bounds among {', '.join(_OPTIONS)}, not {certify!r}")
    given = _OPTIONS | (dict(certify) if isinstance(certify, Mapping) else {})
    loads = Vectors(dead, live, given["water"], names_of(given["wetted"]))
    return _bracket(forms, fixed, loads, reduce, exclude, flow, given["gap"], given["elements"], given["seconds"],
                    progress, stacklevel=6)


def _bracket(forms: Mapping[str, Any], fixed: ndarray, loads: Loads | Vectors, reduce: str | Collection[str] | None,
             exclude: str | Collection[str], flow: str, gap: float, elements: int, seconds: float,
             progress: bool | None, stacklevel: int) -> Bounds:
    """Bounds of what is given; where they leave something open, a warning at the caller's level."""
    if not (0 < gap < np.inf) or not elements > 0 or not seconds > 0:
        raise ValueError(f"gap, elements and seconds must be positive, not {gap!r}, {elements!r} and {seconds!r}")
    problem = read(forms, fixed, loads, reduce, exclude, flow == "associated")
    with tqdm(desc="bounds", disable=None if progress is None else not progress,
              bar_format="{desc} {postfix} {elapsed}") as bar:
        search = Search(problem, bar)
        search.run(gap, elements, seconds)
        davis = None if problem.davis is None else search.estimate(problem.davis)
    _tell(search, gap, stacklevel)
    return _result(search, davis)


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


def _result(search: Search, davis: float | None) -> Bounds:
    """What was found, in the user's units; an estimate may take the place of the lower bound."""
    problem, low, high = search.problem, search.lower, search.upper
    velocity = (high.program.unknowns.matrix @ high.proof.field).reshape(-1, 2).T
    stress = np.full((3, low.triangles.mesh.nelements, 3), np.nan)
    stress[:, low.program.soft] = problem.stress * low.program.of_triangles(low.proof.field).transpose(2, 0, 1)
    return Bounds(
        lower=float(low.proof.value if davis is None else davis), upper=float(high.proof.value),
        estimate=davis is not None, what="limit load" if search.live else "factor of safety", reduced=problem.reduced,
        mesh=_named(problem, high.triangles), mechanism=velocity / (np.abs(velocity).max() or 1.0),
        dissipation=_shares(high, search.live), stress_mesh=_named(problem, low.triangles), stress=stress,
        history=tuple(search.history), remarks=problem.remarks)


def _named(problem: Problem, triangles: Triangles) -> MeshTri:
    """The mesh in the user's coordinates, with the names of the given one."""
    shape, given = problem.geometry, problem.mesh
    origin = triangles.origin
    subdomains = {name: np.flatnonzero(np.isin(origin, part)) for name, part in (given.subdomains or {}).items()}
    boundaries = {name: facets for name, facets in triangles.tags.items() if isinstance(name, str)}
    return MeshTri(shape.centre[:, None] + shape.size * triangles.mesh.p, triangles.mesh.t, validate=False,
                   _boundaries=boundaries, _subdomains=subdomains)


def _shares(high: Found, live: bool) -> ndarray:
    """Share of the dissipation in every triangle; the rest is in contacts."""
    factor = high.proof.value if np.isfinite(high.proof.value) and not live else 1.0
    spent = dissipation(high.program, high.program.strains(high.proof.field), factor)
    shares = np.zeros(high.triangles.mesh.nelements)
    shares[high.program.soft] = high.program.of_triangles(spent).sum(axis=1) / (spent.sum() or 1.0)
    return shares
