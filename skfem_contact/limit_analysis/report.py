"""From what was found to the result, in the user's units."""
from __future__ import annotations

import numpy as np
from numpy import ndarray
from skfem import MeshTri

from .certify import dissipation
from .reading import Problem
from .result import Bounds
from .search import Found, Search
from .triangles import Triangles


def report(search: Search, davis: float | None) -> Bounds:
    """The result of a search.

    Parameters
    ----------
    search
        Where the bounds are.
    davis
        The estimate that takes the place of the lower bound.
    """
    problem, low, high = search.problem, search.lower, search.upper
    return Bounds(
        lower=float(low.proof.value if davis is None else davis), upper=float(high.proof.value),
        estimate=davis is not None, what="limit load" if search.live else "factor of safety", reduced=problem.reduced,
        mesh=_named(problem, high.triangles), mechanism=_mechanism(high), dissipation=_shares(high, search.live),
        stress_mesh=_named(problem, low.triangles), stress=problem.stress * _stresses(low),
        history=tuple(search.history), remarks=problem.remarks)


def _named(problem: Problem, triangles: Triangles) -> MeshTri:
    """The mesh in the user's coordinates, with the names of the given one."""
    shape, given = problem.geometry, problem.mesh
    origin = triangles.origin
    subdomains = {name: np.flatnonzero(np.isin(origin, part)) for name, part in (given.subdomains or {}).items()}
    boundaries = {name: facets for name, facets in triangles.tags.items() if isinstance(name, str)}
    return MeshTri(shape.centre[:, None] + shape.size * triangles.mesh.p, triangles.mesh.t, validate=False,
                   _boundaries=boundaries, _subdomains=subdomains)


def _mechanism(high: Found) -> ndarray:
    """Velocities at nodes and middles of facets."""
    velocity = (high.parts.unknowns.matrix @ high.proof.field).reshape(-1, 2).T
    return velocity / (np.abs(velocity).max() or 1.0)


def _shares(high: Found, live: bool) -> ndarray:
    """Share of the dissipation in every triangle; the rest is in contacts."""
    program, soft = high.parts.program, high.parts.soft
    factor = high.proof.value if np.isfinite(high.proof.value) and not live else 1.0
    spent = dissipation(program, program.strains(high.proof.field), factor)
    shares = np.zeros(high.triangles.mesh.nelements)
    shares[soft] = spent[:3 * len(soft)].reshape(-1, 3).sum(axis=1) / (spent.sum() or 1.0)
    return shares


def _stresses(low: Found) -> ndarray:
    """Stresses at the corners; NaN in rigid bodies."""
    soft = low.parts.soft
    stress = np.full((3, low.triangles.mesh.nelements, 3), np.nan)
    stress[:, soft] = low.proof.field[:3 * len(soft)].reshape(-1, 3, 3).transpose(2, 0, 1)
    return stress
