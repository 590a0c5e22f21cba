"""Bounds on one mesh after the other, each refined where the bounds differ."""

from __future__ import annotations

from dataclasses import replace
from time import process_time
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from tqdm import tqdm

from .certify import UNBALANCED, Proof, dissipation, prove_lower, prove_upper
from .elements import Joint, Program, stress_elements, velocity_elements
from .interior_point import HIGHEST, MOST, Goal, Solution, solve
from .model import LimitModel, discretise
from .reading import Problem
from .result import Certificate, relative_gap
from .triangles import Triangles, check_closed, gradients, matched, outward_normals, pairs

#: Strength that the solver keeps in reserve where it is not reduced: its stresses violate it by
#: less.
_RESERVES = (1e-6, 2e-5, 2e-4, 2e-3)
#: Objective of the upper bound, in terms of the accuracy: the power of the loads then exceeds the
#: dissipation, which exceeds the objective by the gap.
_AIM = -1.2
#: The solver stops at this share of the gap between the bounds of the last mesh, but not above or
#: below these.
_ACCURACY, _COARSE, _FINE = 0.003, 3e-4, 3e-6
#: Compliance to the mean stress of soil without friction, for the lower bound, whose stresses it
#: blurs, and for the upper one, whose velocities must keep the volume.
_VOLUME = (1e-6, 1e-10)
#: How often the number of triangles around singular points is doubled before the first bounds.
_FANS = 2
#: The lower bound is computed on a finer mesh when its last gain was more than this share of the
#: gap.
_GAIN = 0.2
#: ... or when the mesh has so many times the triangles: after a poor one the gain is no measure.
_GROWN = 3.0
#: Factors from which the solver starts, in turn: from 5 times the factor of a bank it does not come
#: back.
_STARTS = (1.0, 0.25, 0.06)
#: The factor from which the next mesh's solver starts, over the last one.
_ABOVE = 1.01
#: Share of the gap that lies in the triangles which are refined.
_SHARE = 0.5
#: Triangles around a singular point, at most: with 40 of them N_c comes to 0.2 % from below (4.50
#: of 5.14 with four).
_FAN = 40
#: Distance, of bodies of size one, below which nodes are at a singular point.
_HERE = 1e-9
#: Interior angle from which a corner of the ground is singular, in degrees, and at which loads and
#: supports may change.
_REENTRANT, _LEVEL = 185.0, 150.0


class Bound(NamedTuple):
    """Bound on a mesh."""

    triangles: Triangles
    program: Program
    solution: Solution
    proof: Proof


class Search:
    """Meshes, their bounds and the best of them, with a progress bar."""

    def __init__(self, problem: Problem, bar: tqdm[Any]) -> None:
        self.problem, self.model, self.live, self._bar = problem, problem.model, problem.live, bar
        self._moving = self.model  # model of the mechanisms
        self.triangles = matched(self.model.contacts, self.model.triangles)
        check_closed(self.model.contacts, self.triangles)
        self._singular = _singular_points(self.model, self.triangles)
        for _ in range(_FANS):
            self.triangles = self._fanned(self.triangles)
        self.history: list[Certificate] = []
        self._began, self._factor, self._gain, self._accuracy = process_time(), 1.0, np.inf, _COARSE
        self.lower = self._first_lower()
        self.upper = self._solve_upper()
        if (stiff := problem.stiff) is not None:
            self._moving = stiff
            if (other := self._solve_upper()).proof.value <= self.upper.proof.value:
                self.upper = other
            else:
                self._moving = self.model
        #: Largest factor by which all strength may be divided under the fixed loads; inf where they
        #: are admissible.
        self.fixed_factor = self._factor_of_fixed_loads()
        self.last = self.lower, self.upper

    @property
    def gap(self) -> float:
        """Difference of the best bounds as a share of their mean."""
        return relative_gap(self.lower.proof.value, self.upper.proof.value)

    @property
    def overloaded(self) -> bool:
        """True if the fixed loads alone are proven to be too much."""
        return self.live and (self.upper.proof.value < 0 or self.fixed_factor < 1)

    def run(self, gap: float, elements: int, seconds: float) -> None:
        """Refine until the gap is small."""
        while self.gap > gap and not self.overloaded:
            finer = self.triangles.refined(_marked(self._gap_of_elements()))
            finer = self._fanned(matched(self.model.contacts, finer))
            if finer.mesh.nelements > elements or process_time() - self._began > seconds:
                break
            self.triangles = finer
            self._note(upper=self._solve_upper())
            grown = finer.mesh.nelements > _GROWN * self.last[0].triangles.mesh.nelements
            if grown or self._gain > _GAIN * self.gap or self.gap < gap + 2 * self._gain:
                self._note(lower=self._solve_lower(self.model))
        if self.gap > gap and self.last[0].triangles.mesh is not self.triangles.mesh:
            self._note(lower=self._solve_lower(self.model))

    def _note(self, lower: Bound | None = None, upper: Bound | None = None) -> None:
        """Keep the last bounds, and the best."""
        self.last = lower or self.last[0], upper or self.last[1]
        if lower is not None:
            self._gain = max(lower.proof.value - self.lower.proof.value, 0.0) / max(
                self.upper.proof.value, 1e-300
            )
            self.lower = max(self.lower, lower, key=lambda found: found.proof.value)
        if upper is not None:
            self.upper = min(self.upper, upper, key=lambda found: found.proof.value)
        self._accuracy = float(np.clip(_ACCURACY * self.gap, _FINE, _COARSE))

    def _first_lower(self) -> Bound:
        """Return the first lower bound, from starts at smaller factors where the iteration does not
        end.
        """
        for self._factor in _STARTS:
            found = self._solve_lower(self.model)
            if self.live or found.solution.iterations < MOST:
                return found
        self._factor = _STARTS[0]
        return found

    def _solve_lower(self, model: LimitModel) -> Bound:
        """Return the lower bound on the present triangles, which become the parents of later
        ones.
        """
        self.triangles = replace(self.triangles, parent=np.arange(len(self.triangles.origin)))
        program = discretise(model, self.triangles, stress_elements(self.triangles.mesh))
        tried: list[tuple[Solution, Proof]] = []
        for reserve in _RESERVES[: 1 if program.cones.reduced.all() else None]:
            goal = Goal(
                1.0 if self.live else self._factor, 0.0, not self.live, _VOLUME[0], 1.0 + reserve
            )
            found = solve(program, goal, self._accuracy)
            proof = prove_lower(program, found, self.live)
            if found.factor > HIGHEST:
                raise ValueError(
                    f"the factor exceeds {HIGHEST:g}: there is no collapse"
                    if proof.value > 1.0
                    else f"no factor up to {HIGHEST:g} was proven or refuted: at any strength the "
                    f"loads exceed "
                    "what soil or joint resists (tension beyond c cot(phi), no friction), or it "
                    "ends in "
                    "the air"
                )
            tried.append((found, proof))
            if (
                proof.value > (-np.inf if self.live else 0.0) or proof.residual > UNBALANCED
            ):  # which no reserve mends
                break
        else:
            del tried[1:]  # reserves did not help
        return self._found("lower", program, *tried[-1])

    def _solve_upper(self) -> Bound:
        """Return the upper bound on the present triangles."""
        program = discretise(self._moving, self.triangles, velocity_elements(self.triangles.mesh))
        return self._found("upper", program, *self._refuted(program, self.live))

    def _refuted(self, program: Program, live: bool) -> tuple[Solution, Proof]:
        """Solve a program of the upper bound and prove it."""
        factor = 1.0 if self.live else self._factor * _ABOVE
        goal = Goal(factor, _AIM * self._accuracy, not live, _VOLUME[1])
        for far in (True, False):  # sand obeys its flow rule to round-off from a near start only
            found = solve(program, replace(goal, far=far), self._accuracy)
            proof = prove_upper(program, found, live)
            if np.isfinite(proof.value) or not live or not program.dead.any():
                break
        return found, proof

    def _factor_of_fixed_loads(self) -> float:
        """Return the upper bound of the fixed loads' factor of safety; inf where a multiplier is
        proven.

        The mechanism of fixed loads that are too much continues under any live load: its multiplier
        has no optimum, and round-off decides where that iteration ends.
        """
        program = self.upper.program
        if not self.live or np.isfinite(self.lower.proof.value) or not np.any(program.dead):
            return np.inf
        return self._refuted(program.of_fixed_loads(), False)[1].value

    def _found(self, kind: str, program: Program, solution: Solution, proof: Proof) -> Bound:
        """Record a bound on the present triangles."""
        if not self.live:
            self._factor = float(np.clip(solution.factor, 1.0 / HIGHEST, HIGHEST))
        believed, n = (
            float(solution.theta if self.live else solution.factor),
            self.triangles.mesh.nelements,
        )
        self.history.append(
            Certificate(
                kind,
                n,
                program.size,
                proof.value,
                believed,
                proof.residual,
                solution.iterations,
                process_time() - self._began,
            )
        )
        self._bar.set_postfix_str(f"{kind} bound {proof.value:.5g}, {n} triangles")
        return Bound(self.triangles, program, solution, proof)

    def estimate(self, weaker: LimitModel) -> float:
        """Return the lower bound of a weaker model on the last triangles, which may resist
        nothing.
        """
        nothing = -np.inf if self.live else 0.0
        if not self.lower.proof.value > nothing:
            return nothing
        try:
            return self._solve_lower(weaker).proof.value
        except ValueError:
            return nothing

    def _fanned(self, triangles: Triangles) -> Triangles:
        return matched(self.model.contacts, _fanned(triangles, self._singular))

    def _gap_of_elements(self) -> ndarray:
        """Return the share of every triangle in the gap between the last bounds; contacts count for
        both sides.
        """
        below, (_, program, found, proof) = self.last
        strain = program.strains(proof.field)
        factor = 1.0 if self.live else proof.value if np.isfinite(proof.value) else found.factor
        spent = dissipation(program, strain, factor)
        stress = _interpolated(below, self.triangles)
        gap, soft = np.zeros(self.triangles.mesh.nelements), program.soft
        gap[soft] = _gap_of_elements(
            program.of_triangles(spent), stress[soft], program.of_triangles(strain)
        )
        n = 3 * len(soft)
        for joint in program.joints:
            at = slice(n, n + 3 * len(joint.slave))
            n = at.stop
            for facets in (joint.slave, joint.master):
                owner = self.triangles.mesh.f2t[0, facets]
                values = _gap_of_facets(
                    spent[at].reshape(-1, 3),
                    _tractions(self.triangles, joint, facets, stress),
                    strain[at].reshape(-1, 3, 3),
                )
                gap[owner] += np.where(np.isin(owner, soft), values, 0.0)
        return gap


def _tractions(triangles: Triangles, joint: Joint, facets: ndarray, stress: ndarray) -> ndarray:
    """Return normal and tangential tractions at the ends of the slave's facets, by stresses of one
    side, (n, 2, 2).
    """
    mesh = triangles.mesh
    owner = mesh.f2t[0, facets]
    normal = outward_normals(mesh, joint.slave, mesh.f2t[0, joint.slave])
    ends = mesh.p[:, mesh.facets[:, joint.slave]]  # (2, 2 ends, n)
    away = ends[:, :, None] - mesh.p[:, mesh.t[:, owner]][:, None]
    corner = np.linalg.norm(away, axis=0).argmin(axis=1)  # (2 ends, n)
    xx, yy, xy = stress[owner, corner].transpose(2, 1, 0)  # (n, 2 ends) each
    (nx, ny) = normal[:, :, None]
    t = np.stack([xx * nx + xy * ny, xy * nx + yy * ny])
    return np.stack([t[0] * nx + t[1] * ny, -t[0] * ny + t[1] * nx], axis=2)


def _interpolated(below: Bound, triangles: Triangles) -> ndarray:
    """Return stresses of a coarser mesh at the corners of the triangles, (n_elements, 3 corners,
    3).
    """
    coarse, parent = below.triangles.mesh, triangles.parent
    stress = np.zeros((coarse.nelements, 3, 3))
    stress[below.program.soft] = below.program.of_triangles(below.proof.field)
    gradient = gradients(coarse)[0][parent]  # (n, 3 corners, 2)
    away = (
        triangles.mesh.p[:, triangles.mesh.t] - coarse.p[:, coarse.t[0, parent]][:, None]
    )  # from the first corner
    shares = np.einsum("eic,cve->evi", gradient, away)
    shares[..., 0] += 1.0
    return np.einsum("evi,eis->evs", shares, stress[parent])


def _gap_of_elements(dissipation: ndarray, stress: ndarray, strain: ndarray) -> ndarray:
    """Return dissipation less the power of the lower bound's stresses, by triangle: their sum is
    the gap.

    All are values at the corners, (n, 3, ...); dissipation and strain times weight.
    """
    mass = (np.ones((3, 3)) + np.eye(3)) / 4  # of linear functions, over a third of the area
    return np.abs(dissipation.sum(axis=1) - np.einsum("evc,ewc,vw->e", stress, strain, mass))


def _gap_of_facets(dissipation: ndarray, tractions: ndarray, jump: ndarray) -> ndarray:
    """Return dissipation less the power of tractions (normal, tangential) at facets' ends, (n, 2,
    2).

    Quadratic jumps are given, times weight, by their Bernstein coefficients, (n, 3, 3).
    """
    mass = np.array([[0.75, 0.25, 0.5], [0.25, 0.75, 0.5]])
    return np.abs(
        dissipation.sum(axis=1) - np.einsum("fsc,fpc,sp->f", tractions, jump[..., :2], mass)
    )


def _marked(gap: ndarray) -> ndarray:
    """Return the triangles with the largest shares of the gap, which together hold a given
    share.
    """
    order = np.argsort(-gap, kind="stable")
    count = np.searchsorted(np.cumsum(gap[order]), _SHARE * gap.sum()) + 1
    return np.sort(order[:count])


def _fanned(triangles: Triangles, points: ndarray) -> Triangles:
    """Double the triangles around singular points, (2, n), until there are enough."""
    mesh = triangles.mesh
    count = np.bincount(mesh.t.ravel(), minlength=mesh.nvertices)
    away = np.linalg.norm(
        mesh.p[:, None] - points[:, :, None], axis=0
    )  # (n_points, n_nodes); bodies have one each
    few = np.flatnonzero((away < _HERE).any(axis=0) & (count < _FAN))
    return triangles.fanned(few) if len(few) else triangles


def _singular_points(model: LimitModel, triangles: Triangles) -> ndarray:
    """Return corners that point into the ground, and changes of loads or supports at its surface,
    (2, n).
    """
    mesh, rigid = triangles.mesh, model.rigid[triangles.origin]
    soft = np.where(mesh.f2t >= 0, rigid[mesh.f2t] < 0, False)
    edge = np.flatnonzero(soft[0] != soft[1])  # of what can yield
    kind = _kinds(model, triangles)[edge]
    order = np.argsort(mesh.facets[:, edge].ravel(), kind="stable")
    nodes, facet = mesh.facets[:, edge].ravel()[order], np.tile(np.arange(len(edge)), 2)[order]
    same = np.flatnonzero(nodes[1:] == nodes[:-1])
    vertex, one, other = nodes[same], facet[same], facet[same + 1]
    angle = _interior_angles(triangles, rigid)[vertex]
    differ = kind[one] != kind[other]
    pushed = differ[:, 2:-1].any(axis=1)  # a load or a contact ends
    changes = pushed | (differ.any(axis=1) & (angle > _LEVEL))
    return mesh.p[:, np.unique(vertex[changes | (angle > _REENTRANT)])]


def _kinds(model: LimitModel, triangles: Triangles) -> ndarray:
    """Return the supports, loads, contacts and rigid bodies on every facet, (n_facets, n_kinds)."""
    mesh, tags = triangles.mesh, triangles.tags
    parts = [
        tags[tag]
        for tag in (("held", 0), ("held", 1), *(load.tag for load in model.loads.tractions))
    ]
    parts += [
        side for contact in model.contacts for side in pairs(contact, triangles)[:2]
    ]  # where both sides meet
    kinds = np.zeros((mesh.nfacets, len(parts) + 1), bool)
    for i, part in enumerate(parts):
        kinds[part, i] = True
    kinds[:, -1] = (np.where(mesh.f2t >= 0, model.rigid[triangles.origin][mesh.f2t], -1) >= 0).any(
        axis=0
    )
    return kinds


def _interior_angles(triangles: Triangles, rigid: ndarray) -> ndarray:
    """Return the sum of the angles of all triangles that can yield at every vertex, in degrees."""
    t = triangles.mesh.t[:, rigid < 0]
    corner = triangles.mesh.p[:, t]
    (ax, ay), (bx, by) = (np.roll(corner, -k, axis=1) - corner for k in (1, 2))
    angle = np.degrees(np.arctan2(np.abs(ax * by - ay * bx), ax * bx + ay * by))
    return np.bincount(t.ravel(), angle.ravel(), minlength=triangles.mesh.nvertices)
