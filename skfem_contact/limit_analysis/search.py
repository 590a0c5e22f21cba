"""Both bounds on one mesh after the other, each refined where the bounds differ."""
from __future__ import annotations

from time import process_time
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from tqdm import tqdm

from .certify import UNBALANCED, Proof, dissipation, prove_lower, prove_upper
from .contact import Joint, matched
from .elements import gradients, stress_elements, velocity_elements
from .interior_point import HIGHEST, Goal, Solution, solve
from .model import Model, discretise
from .program import Program
from .reading import Problem
from .refine import fanned, gap_of_elements, gap_of_facets, marked, singular_points
from .result import Certificate, relative_gap
from .triangles import Triangles, outward_normals

#: Strength that the solver keeps in reserve where it is not reduced: its stresses violate it by less.
_RESERVES = (1e-6, 2e-5, 2e-4, 2e-3)
#: Objective of the upper bound, in terms of the accuracy: the power of the loads then exceeds the dissipation, which
#: exceeds the objective by the gap.
_AIM = -1.2
#: The solver stops at this share of the gap between the bounds of the last mesh, but not above or below these.
_ACCURACY, _COARSE, _FINE = 0.003, 3e-4, 3e-6
#: Compliance to the mean stress of soil without friction, for the lower bound, whose stresses it blurs, and for the
#: upper one, whose velocities must keep the volume.
_VOLUME = (1e-6, 1e-10)
#: How often the number of triangles around singular points is doubled before the first bounds.
_FANS = 2
#: The lower bound is computed on a finer mesh when its last gain was more than this share of the gap.
_GAIN = 0.2
#: ... or when the mesh has so many times the triangles: after a poor one the gain is no measure.
_GROWN = 3.0
#: The factor from which the next mesh's solver starts, over the last one.
_ABOVE = 1.01


class Found(NamedTuple):
    """A bound on a mesh."""

    triangles: Triangles
    program: Program
    solution: Solution
    proof: Proof


class Search:
    """Meshes, their bounds and the best of them; a bar shows how far it is."""

    def __init__(self, problem: Problem, bar: tqdm[Any]) -> None:
        self.problem, self.model, self.live, self._bar = problem, problem.model, problem.live, bar
        self.triangles = matched(self.model.contacts, self.model.triangles)
        self._singular = singular_points(self.model, self.triangles)
        for _ in range(_FANS):
            self.triangles = self._fanned(self.triangles)
        self.history: list[Certificate] = []
        self._began, self._factor, self._gain = process_time(), 1.0, np.inf
        self.lower = self._solve_lower(self.model)
        self.upper = self._solve_upper()
        #: By what all strength must be divided that the fixed loads are borne, at most; inf where they are.
        self.fixed_factor = self._factor_of_fixed_loads()
        self.last = self.lower, self.upper

    @property
    def gap(self) -> float:
        """Difference of the best bounds as a share of their mean."""
        return relative_gap(self.lower.proof.value, self.upper.proof.value)

    @property
    def overloaded(self) -> bool:
        """Whether it is proven that the fixed loads alone are too much."""
        return self.live and (self.upper.proof.value < 0 or self.fixed_factor < 1)

    def run(self, gap: float, elements: int, seconds: float) -> None:
        """Refine until the gap is small."""
        while self.gap > gap and not self.overloaded:
            finer = self._refined()
            if finer.mesh.nelements > elements or process_time() - self._began > seconds:
                break
            self.triangles = finer
            self._note(upper=self._solve_upper())
            grown = finer.mesh.nelements > _GROWN * self.last[0].triangles.mesh.nelements
            if grown or self._gain > _GAIN * self.gap or self.gap < gap + 2 * self._gain:
                self._note(lower=self._solve_lower(self.model))
        if self.gap > gap and self.last[0].triangles.mesh is not self.triangles.mesh:
            self._note(lower=self._solve_lower(self.model))

    def _note(self, lower: Found | None = None, upper: Found | None = None) -> None:
        """Keep the last bounds, and the best."""
        self.last = lower or self.last[0], upper or self.last[1]
        if lower is not None:
            self._gain = max(lower.proof.value - self.lower.proof.value, 0.0) / max(self.upper.proof.value, 1e-300)
            self.lower = max(self.lower, lower, key=lambda found: found.proof.value)
        if upper is not None:
            self.upper = min(self.upper, upper, key=lambda found: found.proof.value)

    @property
    def _accuracy(self) -> float:
        return float(np.clip(_ACCURACY * self.gap, _FINE, _COARSE)) if self.history[2:] else _COARSE

    def _solve_lower(self, model: Model) -> Found:
        """Lower bound on the present triangles, which become those whose parts later ones are."""
        self.triangles = self.triangles.rooted
        program = discretise(model, self.triangles, stress_elements(self.triangles.mesh))
        tried: list[tuple[Solution, Proof]] = []
        for reserve in _RESERVES:
            goal = Goal(1.0 if self.live else self._factor, 0.0, not self.live, _VOLUME[0], 1.0 + reserve)
            found = solve(program, goal, self._accuracy)
            if found.factor > HIGHEST:
                raise ValueError(f"the factor exceeds {HIGHEST:g}: there is no collapse")
            proof = prove_lower(program, found, self.live)
            tried.append((found, proof))
            if proof.value > (-np.inf if self.live else 0.0) or proof.residual > UNBALANCED:  # which no reserve mends
                break
        else:
            del tried[1:]  # in vain
        return self._found("lower", program, *tried[-1])

    def _solve_upper(self) -> Found:
        """Upper bound on the present triangles."""
        program = discretise(self.model, self.triangles, velocity_elements(self.triangles.mesh))
        factor = 1.0 if self.live else self._factor * _ABOVE
        goal = Goal(factor, _AIM * self._accuracy, not self.live, _VOLUME[1])
        found = solve(program, goal, self._accuracy)
        return self._found("upper", program, found, prove_upper(program, found, self.live))

    def _factor_of_fixed_loads(self) -> float:
        """Upper bound of their factor of safety, where no multiplier was shown to be borne.

        Whatever the live load, the mechanism of fixed loads that are too much goes on: its multiplier has no optimum,
        and where the iteration for it ends is left to round-off.
        """
        program = self.upper.program
        if not self.live or np.isfinite(self.lower.proof.value) or not np.any(program.dead):
            return np.inf
        fixed = program.of_fixed_loads()
        goal = Goal(1.0, _AIM * self._accuracy, True, _VOLUME[1])
        return prove_upper(fixed, solve(fixed, goal, self._accuracy), False).value

    def _found(self, kind: str, program: Program, solution: Solution, proof: Proof) -> Found:
        """A bound on the present triangles, noted."""
        if not self.live:
            self._factor = float(np.clip(solution.factor, 1.0 / HIGHEST, HIGHEST))
        believed, n = float(solution.theta if self.live else solution.factor), self.triangles.mesh.nelements
        self.history.append(Certificate(kind, n, program.size, proof.value, believed, proof.residual,
                                        solution.iterations, process_time() - self._began))
        self._bar.set_postfix_str(f"{kind} bound {proof.value:.5g}, {n} triangles")
        return Found(self.triangles, program, solution, proof)

    def estimate(self, weaker: Model) -> float:
        """What another, weaker model bears on the last triangles."""
        return self._solve_lower(weaker).proof.value

    def _refined(self) -> Triangles:
        """More triangles where the last bounds differ, and around singular points."""
        finer = self.triangles.refined(marked(self._gap_of_elements()))
        return self._fanned(matched(self.model.contacts, finer))

    def _fanned(self, triangles: Triangles) -> Triangles:
        return matched(self.model.contacts, fanned(triangles, self._singular))

    def _gap_of_elements(self) -> ndarray:
        """Contributions of all triangles to the gap between the last bounds; those of contacts count for both sides."""
        below, (_, program, found, proof) = self.last
        strain = program.strains(proof.field)
        factor = 1.0 if self.live else proof.value if np.isfinite(proof.value) else found.factor
        spent = dissipation(program, strain, factor)
        stress = _interpolated(below, self.triangles)
        gap, soft = np.zeros(self.triangles.mesh.nelements), program.soft
        gap[soft] = gap_of_elements(program.of_triangles(spent), stress[soft], program.of_triangles(strain))
        n = 3 * len(soft)
        for joint in program.joints:
            at = slice(n, n + 3 * len(joint.slave))
            n = at.stop
            for facets in (joint.slave, joint.master):
                owner = self.triangles.mesh.f2t[0, facets]
                values = gap_of_facets(spent[at].reshape(-1, 3), _tractions(self.triangles, joint, facets, stress),
                                       strain[at].reshape(-1, 3, 3))
                gap[owner] += np.where(np.isin(owner, soft), values, 0.0)
        return gap


def _tractions(triangles: Triangles, joint: Joint, facets: ndarray, stress: ndarray) -> ndarray:
    """Normal and tangential tractions at the ends of the slave's facets, from the stresses of one side, (n, 2, 2)."""
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


def _interpolated(below: Found, triangles: Triangles) -> ndarray:
    """Stresses of a coarser mesh at the corners of the triangles, (n_elements, 3 corners, 3)."""
    coarse, parent = below.triangles.mesh, triangles.parent
    stress = np.zeros((coarse.nelements, 3, 3))
    stress[below.program.soft] = below.program.of_triangles(below.proof.field)
    gradient = gradients(coarse)[0][parent]  # (n, 3 corners, 2)
    away = triangles.mesh.p[:, triangles.mesh.t] - coarse.p[:, coarse.t[0, parent]][:, None]  # from the first corner
    shares = np.einsum("eic,cve->evi", gradient, away)
    shares[..., 0] += 1.0
    return np.einsum("evi,eis->evs", shares, stress[parent])
