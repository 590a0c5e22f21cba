"""What the bounds are, and how they were found."""
from __future__ import annotations

from dataclasses import dataclass, field

from numpy import ndarray
from skfem import MeshTri


def relative_gap(lower: float, upper: float) -> float:
    """Difference of two bounds as a share of their mean; inf where one is not proven."""
    mean = 0.5 * (abs(lower) + abs(upper))
    return (upper - lower) / mean if 0 < mean < float("inf") else float("inf") if mean else 0.0


@dataclass(frozen=True)
class Certificate:
    """What was checked after the solver, on one mesh.

    Attributes
    ----------
    kind
        ``"lower"`` or ``"upper"``.
    elements, unknowns
        Size of the mesh, and velocities of the program.
    value
        The bound that was proven; -inf or inf: none was.
    solver
        What the solver believes.
    residual
        Largest violation of equilibrium, as a share of the forces that meet there; of the upper bound that of the
        volume of soil without friction, as a share of the largest strain.
    iterations
        Systems that were factored.
    cpu
        Processor time since the beginning, seconds.
    """

    kind: str
    elements: int
    unknowns: int
    value: float
    solver: float
    residual: float
    iterations: int
    cpu: float


@dataclass(frozen=True)
class Bounds:
    """Two numbers between which the factor of safety, or the limit load, lies; printed as a table.

    Attributes
    ----------
    lower, upper
        The bounds; -inf or inf where none was proven.
    estimate
        Whether ``lower`` is no bound but the estimate of Davis: the flow is not associated.
    what
        ``"factor of safety"`` or ``"limit load"``.
    reduced
        Names of forms and regions whose strength is reduced.
    mesh
        Mesh of the upper bound, with the names of the given one.
    mechanism
        Quadratic velocities at its nodes and at the middles of its facets, (2, n_nodes + n_facets); the largest
        component is 1.
    dissipation
        Share of the dissipation in every triangle, (n_elements,).
    stress_mesh
        Mesh of the lower bound.
    stress
        Stresses xx, yy, xy at the corners of its triangles, (3, n_elements, 3).
    history
        Certificates of all meshes.
    remarks
        What was simplified.
    """

    lower: float
    upper: float
    estimate: bool
    what: str
    reduced: tuple[str, ...]
    mesh: MeshTri = field(repr=False)
    mechanism: ndarray = field(repr=False)
    dissipation: ndarray = field(repr=False)
    stress_mesh: MeshTri = field(repr=False)
    stress: ndarray = field(repr=False)
    history: tuple[Certificate, ...] = field(repr=False)
    remarks: tuple[str, ...] = ()

    @property
    def gap(self) -> float:
        """Difference of the bounds as a share of their mean."""
        return relative_gap(self.lower, self.upper)

    @property
    def certificates(self) -> tuple[Certificate, Certificate]:
        """Those of the lower and of the upper bound."""
        lower, upper = ([c for c in self.history if c.kind == kind] for kind in ("lower", "upper"))
        return max(lower, key=lambda c: c.value), min(upper, key=lambda c: c.value)

    def __str__(self) -> str:
        kind = "estimate after Davis (no bound), upper bound" if self.estimate else "gap"
        head = f"{self.what} in [{self.lower:.5g}, {self.upper:.5g}], {kind} {self.gap:.2%}"
        lines = [head, f"reduced: {', '.join(self.reduced)}"] if self.reduced else [head]
        lines.append("bound  triangles  unknowns      value  residual  iterations   cpu s")
        lines += [f"{c.kind:5}  {c.elements:9d}  {c.unknowns:8d}  {c.value:9.5g}  {c.residual:8.1e}  "
                  f"{c.iterations:10d}  {c.cpu:6.1f}" for c in self.history]
        return "\n".join([*lines, *self.remarks])

    __repr__ = __str__  # a notebook would show the arrays
