"""Bounds on one mesh after the other, each refined where the bounds differ."""

from __future__ import annotations

import logging
from dataclasses import replace
from time import process_time
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from tqdm import tqdm

from ..layout import facet_corners
from .carried import carried
from .certify import UNBALANCED, Proof, dissipation, prove_lower, prove_upper
from .elements import Joint, Program, stress_elements, velocity_elements
from .interior_point import HIGHEST, MOST, Goal, Iterate, Solution, solve
from .model import LimitModel, discretise
from .reading import Problem
from .result import Certificate, relative_gap
from .triangles import Triangles, check_closed, matched, outward_normals, pairs

logger = logging.getLogger("skfem_contact")

#: Strength that the solver keeps in reserve where it is not reduced: its stresses violate it by
#: less.
_RESERVES = (1e-6, 2e-5, 2e-4, 2e-3)
#: Objective of the upper bound, in terms of the accuracy: the power of the loads then exceeds the
#: dissipation, which exceeds the objective by the gap.
_AIM = -1.2
#: The solver stops at this share of the gap between the bounds of the last mesh, but not above or
#: below these, for the lower bound, whose last iterations gain little, and for the upper one.
_ACCURACY = (0.1, 0.02)
_COARSE = (1e-2, 3e-3)
_FINE = 3e-6
#: Accuracy on the first mesh, which may be the last one, and while there is no gap.
_FIRST = 3e-4
#: Compliance to the mean stress of soil without friction, for the lower bound, whose stresses it
#: blurs, and for the upper one, whose velocities must be isochoric.
_VOLUME = (1e-6, 1e-10)
#: How often the number of triangles around singular points is doubled before the first bounds.
_FANS = 2
#: The lower bound is computed on a finer mesh when its last gain was more than this share of the
#: gap.
_GAIN = 0.4
#: ... or when the mesh has so many times the triangles: after a poor one the gain is no measure.
_GROWN = 3.0
#: Factors from which the solver starts, in turn: from 5 times the factor of a bank it does not come
#: back.
_STARTS = (1.0, 0.25, 0.06)
#: The factor from which the next mesh's solver starts, over the last one.
_ABOVE = 1.01
#: Share of the gap that lies in the triangles which are refined, at least and at most, and what an
#: upper bound on the next mesh removes of it, at least: 0.58 to 0.76 with slopes, a vertical cut
#: and a footing.
_SHARES = (0.1, 0.5)
_REMOVED = 0.55
#: Triangles around a singular point, at most: with 40 of them N_c comes to 0.2 % from below (4.50
#: of 5.14 with four).
_FAN = 40
#: Distance, of bodies of size one, below which nodes are at a singular point.
_HERE = 1e-9
#: Interior angle from which a corner of the ground is singular, in degrees, and at which loads and
#: supports may change.
_REENTRANT = 185.0
_LEVEL = 150.0


#: Share of the upper bound below which a lower one is nothing.
NOTHING = 1e-3
#: Power of the multiplied loads against a mechanism, as a share of its terms, that is round-off.
_OPPOSED = 1e-9
#: Meshes without a lower bound after which refinement ends once the upper bound has settled.
_TRIES = 2


class Bound(NamedTuple):
    """Bound on a mesh."""

    triangles: Triangles
    program: Program
    solution: Solution
    proof: Proof


class Search:
    """Meshes, their bounds and the best of them, with a progress bar."""

    def __init__(self, problem: Problem, bar: tqdm[Any]) -> None:
        self.problem = problem
        self.model = problem.model
        self.live = problem.live
        self._bar = bar
        self._moving = self.model  # model of the mechanisms

        # mesh with many triangles around singular points
        self.triangles = matched(self.model.contacts, self.model.triangles)
        check_closed(self.model.contacts, self.triangles)
        self._singular = _singular_points(self.model, self.triangles)
        for _ in range(_FANS):
            self.triangles = self._fanned(self.triangles)

        # first bounds; mechanisms that leave strong bodies rigid are kept where they are better
        self.history: list[Certificate] = []
        self._began = process_time()
        self._seconds = np.inf
        self._factor = 1.0
        self._gain = np.inf
        self._accuracy = np.full(2, _FIRST)  # of the lower and of the upper bound
        #: Last bounds by kind before the present mesh, and the triangles of their meshes that its
        #: triangles are parts of.
        self._parents: dict[str, ndarray] = {}
        self._before: dict[str, Bound] = {}
        self.lower = self._first_lower()
        self.upper = self._solve_upper()
        if problem.stiff is not None:
            self._moving = problem.stiff
            stiff = self._solve_upper()
            if stiff.proof.value <= self.upper.proof.value:
                self.upper = stiff
            else:
                self._moving = self.model
        #: Largest factor by which all strength may be divided under the fixed loads, and the least
        #: multiplier that holds them; inf and -inf where they are admissible.
        self.fixed_factor, self.least = self._fixed_loads()
        self.last = self.lower, self.upper

    @property
    def gap(self) -> float:
        """Difference of the best bounds as a share of their mean."""
        return relative_gap(self.lower.proof.value, self.upper.proof.value)

    @property
    def overloaded(self) -> bool:
        """True if the fixed loads are proven to be too much at any multiplier from zero."""
        high = self.upper.proof.value
        return self.live and (high < 0 or self.least > high or self.least == np.inf)

    @property
    def late(self) -> bool:
        """True after the time that the search may take."""
        return process_time() - self._began > self._seconds

    def run(self, gap: float, elements: int, seconds: float) -> None:
        """Refine until the gap is small."""
        self._seconds = seconds
        while self.gap > gap and not self.overloaded:
            # Refine where the gap arises, within the limits of elements and time.
            share = float(np.clip((1.0 - gap / self.gap) / _REMOVED, *_SHARES))
            finer = self.triangles.rooted().refined(_marked(self._gap_of_elements(), share))
            finer = self._fanned(matched(self.model.contacts, finer))
            if finer.mesh.nelements > elements or self.late:
                break
            self._take(finer)
            # The upper bound is cheap, and follows every mesh.
            known = self.upper.proof.value
            self._note(upper=self._solve_upper())
            if self.gap <= gap or self.late or self._futile(known, gap):
                break
            # The lower bound follows when it may gain enough.
            before = self.last[0].triangles.mesh
            grown = finer.mesh.nelements > _GROWN * before.nelements
            if grown or self._gain > _GAIN * self.gap or self.gap < gap + 2 * self._gain:
                self._note(lower=self._solve_lower(self.model))
        # Close the gap on the last mesh.
        behind = self.last[0].triangles.mesh is not self.triangles.mesh
        if self.gap > gap and behind and not self.late:
            self._note(lower=self._solve_lower(self.model))

    def _take(self, finer: Triangles) -> None:
        """Continue on a refined mesh, whose bounds begin from the last ones."""
        self.triangles = finer
        self._before = dict(zip(("lower", "upper"), self.last))
        self._parents = {kind: of[finer.parent] for kind, of in self._parents.items()}

    @property
    def has_lower(self) -> bool:
        """True if a lower bound is proven that is more than nothing."""
        return self.lower.proof.value > NOTHING * self.upper.proof.value

    def _futile(self, known: float, gap: float) -> bool:
        """Return True if no mesh gives a lower bound, and the upper one has come to its end.

        Without tensile strength a fine mesh may give one, so that refinement continues.
        """
        tried = sum(each.kind == "lower" for each in self.history)
        if self.has_lower or tried <= _TRIES:
            return False
        n = self.triangles.mesh.nelements
        logger.info(
            "no lower bound could be proven on %d meshes, the last of %d triangles", tried, n
        )
        settled = self.upper.proof.value > (1.0 - gap) * known
        return settled and self.problem.missing == "cohesion"

    def _note(self, lower: Bound | None = None, upper: Bound | None = None) -> None:
        """Keep the last bounds, and the best."""
        self.last = lower or self.last[0], upper or self.last[1]
        if lower is not None:
            gain = max(lower.proof.value - self.lower.proof.value, 0.0)
            self._gain = gain / max(self.upper.proof.value, 1e-300)
            if lower.proof.value > self.lower.proof.value:
                self.lower = lower
        if upper is not None and upper.proof.value < self.upper.proof.value:
            self.upper = upper
        if np.isfinite(self.gap):
            self._accuracy = np.clip(np.multiply(_ACCURACY, self.gap), _FINE, _COARSE)

    def _first_lower(self) -> Bound:
        """Return the first lower bound, from smaller factors where the iteration does not end."""
        for self._factor in _STARTS:
            lower = self._solve_lower(self.model)
            if self.live or lower.solution.iterations < MOST:
                return lower
        self._factor = _STARTS[0]
        return lower

    def _solve_lower(self, model: LimitModel) -> Bound:
        """Return the lower bound on the present triangles."""
        program = discretise(model, self.triangles, stress_elements(self.triangles.mesh))
        start = None
        if model is self.model:
            start = self._start("lower", program)
        factor = self._factor
        if self.live:
            factor = 1.0
        nothing = 0.0
        if self.live:
            nothing = -np.inf
        reserves = _RESERVES[:1] if program.cones.reduced.all() else _RESERVES
        results: list[tuple[Solution, Proof]] = []
        for reserve in reserves:
            goal = Goal(
                factor, aim=0.0, moving=not self.live, volume=_VOLUME[0], fixed=1.0 + reserve
            )
            solution = solve(program, goal, float(self._accuracy[0]), start)
            start = None
            proof = prove_lower(program, solution, self.live)
            if solution.factor > HIGHEST:
                _refuse_highest(proof)
            results.append((solution, proof))
            if proof.value > nothing or proof.residual > UNBALANCED:  # which no reserve mends
                return self._found("lower", program, solution, proof)
        return self._found("lower", program, *results[0])  # reserves did not help

    def _solve_upper(self) -> Bound:
        """Return the upper bound on the present triangles."""
        program = discretise(self._moving, self.triangles, velocity_elements(self.triangles.mesh))
        start = self._start("upper", program)
        return self._found("upper", program, *self._refuted(program, self.live, start))

    def _start(self, kind: str, program: Program) -> Iterate | None:
        """Return an iterate of the last bound of a kind on the points of a program; None: none."""
        before = self._before.get(kind)
        if before is None or before.solution.early is None:
            return None
        return carried(
            before.solution.early,
            (before.triangles, before.program),
            (self.triangles, program),
            self._parents[kind],
        )

    def _refuted(
        self,
        program: Program,
        live: bool,
        start: Iterate | None = None,
    ) -> tuple[Solution, Proof]:
        """Solve a program of the upper bound and prove it."""
        factor = 1.0 if self.live else self._factor * _ABOVE
        accuracy = float(self._accuracy[1])
        goal = Goal(factor, aim=_AIM * accuracy, moving=not live, volume=_VOLUME[1])
        for far in (True, False):  # sand obeys its flow rule to round-off from a near start only
            solution = solve(program, replace(goal, far=far), accuracy, start)
            start = None
            proof = prove_upper(program, solution, live)
            if np.isfinite(proof.value) or not live or not program.dead.any():
                break
        return solution, proof

    def _fixed_loads(self) -> tuple[float, float]:
        r"""Return an upper bound of the fixed loads' factor, and the least multiplier they need.

        Both are inf and -inf where a multiplier is proven. A mechanism v of the fixed loads
        :math:`f_0` that the multiplied ones :math:`f_1` oppose, as the thrust on a wall does,
        demands :math:`\theta \ge (f_0 v - D(v)) / (-f_1 v)`. Another one continues under any
        multiplied load: its multiplier has no optimum, and round-off decides where that iteration
        ends. No multiplier holds the fixed loads either where those at the least one drive a
        mechanism that collapses: every smaller multiplier is too small, every larger one too large.
        """
        program = self.upper.program
        if not self.live or np.isfinite(self.lower.proof.value) or not np.any(program.dead):
            return np.inf, -np.inf
        fixed = program.of_fixed_loads()
        proof = self._refuted(fixed, False)[1]
        if not proof.value < 1:
            return proof.value, -np.inf

        # compare the power that is left with the power of the multiplied loads
        velocity = proof.field
        spent = dissipation(fixed, fixed.strains(velocity), 1.0).sum()
        left = float(program.dead @ velocity - spent)
        opposed = -_power(program.live, velocity)
        if opposed <= 0.0:
            return proof.value, np.inf

        # without an upper bound, try the loads at the multiplier that this mechanism demands
        least = left / opposed
        if np.isfinite(self.upper.proof.value):
            return proof.value, least
        held = replace(fixed, dead=program.dead + least * program.live)
        other = self._refuted(held, False)[1]
        if other.value < 1 and _power(program.live, other.field) >= 0.0:
            return proof.value, np.inf
        return proof.value, least

    def _found(self, kind: str, program: Program, solution: Solution, proof: Proof) -> Bound:
        """Record a bound on the present triangles."""
        # The next solution begins from this factor.
        if not self.live:
            self._factor = float(np.clip(solution.factor, 1.0 / HIGHEST, HIGHEST))
        # Write down the bound with its proof.
        n = self.triangles.mesh.nelements
        certificate = Certificate(
            kind,
            n,
            unknowns=program.size,
            value=proof.value,
            solver=float(solution.theta if self.live else solution.factor),
            residual=proof.residual,
            iterations=solution.iterations,
            cpu=process_time() - self._began,
        )
        self.history.append(certificate)
        self._parents[kind] = np.arange(n)
        self._bar.set_postfix_str(f"{kind} bound {proof.value:.5g}, {n} triangles")
        return Bound(self.triangles, program, solution, proof)

    def estimate(self, weaker: LimitModel | None) -> float | None:
        """Return the lower bound of a weaker model on the last triangles, or of no strength.

        Where time is over, the triangles are those of the best lower bound.
        """
        if weaker is None:
            return None
        nothing = 0.0
        if self.live:
            nothing = -np.inf
        if not self.lower.proof.value > nothing:
            return nothing
        if self.late:
            self.triangles = self.lower.triangles
        try:
            return float(self._solve_lower(weaker).proof.value)
        except ValueError:
            return nothing

    def _fanned(self, triangles: Triangles) -> Triangles:
        """Double the triangles around singular points, and match contacts again."""
        return matched(self.model.contacts, _fanned(triangles, self._singular))

    def _gap_of_elements(self) -> ndarray:
        """Return the share of every triangle in the gap between the last bounds.

        Contacts count for both sides.
        """
        # dissipation and strains of the upper bound, stresses of the lower one
        below, (_, program, solution, proof) = self.last
        factor = 1.0
        if not self.live:
            factor = solution.factor
            if np.isfinite(proof.value):
                factor = proof.value
        strain = program.strains(proof.field)
        spent = dissipation(program, strain, factor)
        stress = _interpolated(below, self.triangles, self._parents["lower"])

        # gap of the triangles that can yield
        soft = program.soft
        gap = np.zeros(self.triangles.mesh.nelements)
        gap[soft] = _gap_of_elements(
            program.of_triangles(spent), stress[soft], program.of_triangles(strain)
        )

        # gap of the joints
        first = 3 * len(soft)
        for joint in program.joints:
            last = first + 3 * len(joint.slave)
            spent_there = spent[first:last].reshape(-1, 3)
            jump = strain[first:last].reshape(-1, 3, 3)  # (n, 3 points, 3)
            first = last
            for facets in (joint.slave, joint.master):
                owner = self.triangles.mesh.f2t[0, facets]
                tractions = _tractions(self.triangles, joint, facets, stress)
                values = _gap_of_facets(spent_there, tractions, jump)
                at_soft = np.isin(owner, soft)
                gap[owner[at_soft]] += values[at_soft]
        return gap


def _power(loads: ndarray, velocity: ndarray) -> float:
    """Return the power of loads, zero where it is round-off of its terms."""
    power = float(loads @ velocity)
    if abs(power) <= _OPPOSED * float(np.abs(loads) @ np.abs(velocity)):
        return 0.0
    return power


def _refuse_highest(proof: Proof) -> None:
    """Raise an error for a factor beyond the largest of the search."""
    if proof.value > 1.0:
        raise ValueError(f"the factor exceeds {HIGHEST:g}: there is no collapse")
    raise ValueError(
        f"no factor up to {HIGHEST:g} was proven or refuted: at any strength the loads exceed what "
        "soil or joint resists (tension beyond c cot(phi), no friction), or it ends in the air"
    )


def _tractions(triangles: Triangles, joint: Joint, facets: ndarray, stress: ndarray) -> ndarray:
    """Return normal and tangential tractions at ends of the slave's facets, (n, 2, 2).

    The stresses belong to the triangles at the facets of one side.
    """
    mesh = triangles.mesh
    owner = mesh.f2t[0, facets]
    normal = outward_normals(mesh, joint.slave, mesh.f2t[0, joint.slave])

    # find the corner of the triangle at each end
    ends = facet_corners(mesh, joint.slave)  # (2, 2 ends, n)
    corners = mesh.p[:, mesh.t[:, owner]]  # (2, 3, n)
    away = ends[:, :, None] - corners[:, None]  # (2, 2 ends, 3, n)
    corner = np.linalg.norm(away, axis=0).argmin(axis=1)  # (2 ends, n)

    # t = sigma n, along the normal and along the tangent
    xx, yy, xy = stress[owner, corner].transpose(2, 1, 0)  # (n, 2 ends) each
    nx, ny = normal[:, :, None]
    tx = xx * nx + xy * ny
    ty = xy * nx + yy * ny
    along_normal = tx * nx + ty * ny
    along_tangent = -tx * ny + ty * nx
    return np.stack([along_normal, along_tangent], axis=2)


def _interpolated(below: Bound, triangles: Triangles, parent: ndarray) -> ndarray:
    """Return stresses of a coarser mesh at corners of the triangles, (n_elements, 3 corners, 3)."""
    coarse = below.triangles.mesh
    stress = np.zeros((coarse.nelements, 3, 3))
    stress[below.program.soft] = below.program.of_triangles(below.proof.field)
    shares = triangles.within(coarse, parent)
    return np.einsum("evi,eis->evs", shares, stress[parent])


def _gap_of_elements(dissipation: ndarray, stress: ndarray, strain: ndarray) -> ndarray:
    """Return dissipation less the power of stresses by triangle: the sum is the gap.

    All are values at the corners, (n, 3, ...); dissipation and strain times weight.
    """
    mass = (np.ones((3, 3)) + np.eye(3)) / 4  # of linear functions, over a third of the area
    power = np.einsum("evc,ewc,vw->e", stress, strain, mass)
    return np.abs(dissipation.sum(axis=1) - power)


def _gap_of_facets(dissipation: ndarray, tractions: ndarray, jump: ndarray) -> ndarray:
    """Return dissipation less the power of tractions (normal, tangential) at ends, (n, 2, 2).

    Quadratic jumps are given, times weight, by their Bernstein coefficients, (n, 3, 3).
    """
    mass = np.array([[0.75, 0.25, 0.5], [0.25, 0.75, 0.5]])
    power = np.einsum("fsc,fpc,sp->f", tractions, jump[..., :2], mass)
    return np.abs(dissipation.sum(axis=1) - power)


def _marked(gap: ndarray, share: float) -> ndarray:
    """Return the triangles with the most of the gap, which together hold a given share."""
    order = np.argsort(-gap, kind="stable")
    count = np.searchsorted(np.cumsum(gap[order]), share * gap.sum()) + 1
    return np.sort(order[:count])


def _fanned(triangles: Triangles, points: ndarray) -> Triangles:
    """Double the triangles around singular points, (2, n), until they are enough."""
    mesh = triangles.mesh
    count = np.bincount(mesh.t.ravel(), minlength=mesh.nvertices)
    away = np.linalg.norm(mesh.p[:, None] - points[:, :, None], axis=0)  # (n_points, n_nodes)
    few = np.flatnonzero((away < _HERE).any(axis=0) & (count < _FAN))
    if len(few):
        return triangles.fanned(few)
    return triangles


def _singular_points(model: LimitModel, triangles: Triangles) -> ndarray:
    """Return corners into the ground, and changes of loads or supports at its surface, (2, n)."""
    # facets around the ground that can yield, in pairs that meet at a vertex
    mesh = triangles.mesh
    rigid = model.rigid[triangles.origin]
    soft = np.where(mesh.f2t >= 0, rigid[mesh.f2t] < 0, False)
    edge = np.flatnonzero(soft[0] != soft[1])
    nodes = mesh.facets[:, edge].ravel()
    order = np.argsort(nodes, kind="stable")
    facet = np.tile(np.arange(len(edge)), 2)[order]
    nodes = nodes[order]
    same = np.flatnonzero(nodes[1:] == nodes[:-1])
    vertex = nodes[same]
    first = facet[same]
    second = facet[same + 1]

    # compare the angle at the vertex, and the kinds of both facets
    angle = _interior_angles(triangles, rigid)[vertex]
    kind = _kinds(model, triangles)[edge]
    differ = kind[first] != kind[second]
    pushed = differ[:, 2:-1].any(axis=1)  # a load or a contact ends
    level = angle > _LEVEL
    changes = pushed | (differ.any(axis=1) & level)
    singular = vertex[changes | (angle > _REENTRANT)]
    return mesh.p[:, np.unique(singular)]


def _kinds(model: LimitModel, triangles: Triangles) -> ndarray:
    """Return the supports, loads, contacts and rigid bodies on every facet, (n_facets, n_kinds)."""
    mesh = triangles.mesh
    tags = triangles.tags
    parts = [tags["held", 0], tags["held", 1]]
    parts += [tags[load.tag] for load in model.loads.tractions]
    for contact in model.contacts:
        parts += pairs(contact, triangles)[:2]  # where both sides meet
    kinds = np.zeros((mesh.nfacets, len(parts) + 1), bool)
    for i, part in enumerate(parts):
        kinds[part, i] = True
    body = np.where(mesh.f2t >= 0, model.rigid[triangles.origin][mesh.f2t], -1)
    kinds[:, -1] = (body >= 0).any(axis=0)
    return kinds


def _interior_angles(triangles: Triangles, rigid: ndarray) -> ndarray:
    """Return the sum of the angles of all triangles that can yield at every vertex, in degrees."""
    t = triangles.mesh.t[:, rigid < 0]
    corner = triangles.mesh.p[:, t]
    (ax, ay), (bx, by) = (np.roll(corner, -k, axis=1) - corner for k in (1, 2))
    angle = np.degrees(np.arctan2(np.abs(ax * by - ay * bx), ax * bx + ay * by))
    return np.bincount(t.ravel(), angle.ravel(), minlength=triangles.mesh.nvertices)
