"""Bounds, and their certificates mesh by mesh."""

from __future__ import annotations

from dataclasses import dataclass

from numpy import ndarray
from skfem import MeshTri


def relative_gap(lower: float, upper: float) -> float:
    """Return the difference of two bounds as a share of their mean; inf where one is not proven."""
    mean = 0.5 * (abs(lower) + abs(upper))
    if mean == 0.0:
        return 0.0
    if mean < float("inf"):
        return (upper - lower) / mean
    return float("inf")


@dataclass(frozen=True)
class Certificate:
    """Check of a bound after the solver, on one mesh."""

    kind: str  # "lower" or "upper"
    elements: int  # of the mesh
    unknowns: int  # velocities of the program
    value: float  # proven bound; -inf or inf: none
    solver: float  # value of the solver
    # largest violation of equilibrium, or of incompressibility, relative to its largest terms
    residual: float
    iterations: int  # number of systems that were factored
    cpu: float  # processor time since the beginning, seconds


@dataclass(frozen=True)
class Bounds:
    """Lower and upper bound of the factor of safety, or of the limit load; printed as a table.

    Attributes
    ----------
    lower, upper
        The bounds; -inf or inf where none was proven.
    estimate
        True if ``lower`` is no bound but an estimate: the flow of the soil (Davis) or of joints is
        not associated.
    safe
        Lower bound by the adhesion of joints alone, for joints that slip without opening; None
        without their friction.
    what
        ``"factor of safety"`` or ``"limit load"``.
    reduced
        Names of forms and regions whose strength is reduced.
    mesh
        Mesh of the upper bound, with the names of the given one.
    mechanism
        Quadratic velocities at its nodes and at the middles of its facets, (2, n_nodes + n_facets);
        the largest component is 1.
    dissipation
        Share of the dissipation in every triangle, (n_elements,).
    stress_mesh
        Mesh of the lower bound.
    stress
        Stresses xx, yy, xy at the corners of its triangles, (3, n_elements, 3).
    history
        Certificates of all meshes.
    remarks
        Simplifications.
    """

    lower: float
    upper: float
    estimate: bool
    safe: float | None
    what: str
    reduced: tuple[str, ...]
    mesh: MeshTri
    mechanism: ndarray
    dissipation: ndarray
    stress_mesh: MeshTri
    stress: ndarray
    history: tuple[Certificate, ...]
    remarks: tuple[str, ...] = ()

    @property
    def gap(self) -> float:
        """Difference of the bounds as a share of their mean."""
        return relative_gap(self.lower, self.upper)

    @property
    def certificates(self) -> tuple[Certificate, Certificate]:
        """Certificates of the lower and of the upper bound."""
        lower = [each for each in self.history if each.kind == "lower"]
        upper = [each for each in self.history if each.kind == "upper"]
        return max(lower, key=lambda each: each.value), min(upper, key=lambda each: each.value)

    def __str__(self) -> str:
        kind = "gap"
        if self.estimate:
            kind = "estimate (no bound), upper bound"
        if self.safe is not None:
            kind = f"safe {self.safe:.5g}, {kind}"
        lines = [f"{self.what} in [{self.lower:.5g}, {self.upper:.5g}], {kind} {self.gap:.2%}"]
        if self.reduced:
            lines.append(f"reduced: {', '.join(self.reduced)}")
        lines.append("bound  triangles      dofs      value  residual  iterations   cpu s")
        lines += [
            f"{c.kind:5}  {c.elements:9d}  {c.unknowns:8d}  {c.value:9.5g}  {c.residual:8.1e}  "
            f"{c.iterations:10d}  {c.cpu:6.1f}"
            for c in self.history
        ]
        return "\n".join([*lines, *self.remarks])

    __repr__ = __str__  # a notebook would show the arrays
