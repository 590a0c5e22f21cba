"""Reinforcement of the ground by geogrids, strips and nails: normal force only."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.sparse import csr_matrix
from skfem import CellBasis
from typing_extensions import override

from ..checks import is_number
from ..forms.base import Outputs, Response, counted
from ..forms.roles import Regularised
from ..layout import Field
from ..sparse import Gathering
from .element import GAUSS, BeamElements, SpaceElements
from .lines import nodes_of
from .nodes import BeamNodes, DofName

#: Share of its stiffness that slack or yielding reinforcement keeps in the tangent, as the only
#: support of its nodes.
_KEPT = 1e-6


@dataclass(frozen=True)
class ReinforcementState:
    """State of reinforcement, arrays (m, 2) at both Gauss points of the m elements.

    Attributes
    ----------
    force
        Normal force, tension positive.
    free
        Strain without force.
    """

    force: ndarray
    free: ndarray


class Reinforcement(BeamNodes, Regularised):
    """Reinforcement that transfers normal force only: a geogrid, a strip, or a row of nails.

    Small displacements: it resists no displacement across its line. It has three-node elements
    without rotations, with nodes of its own, or bonded to the nodes of a line of the mesh.
    Nodes of its own need contact on both sides, :meth:`contact`, or
    :class:`~skfem_contact.Embedded`.

    Parameters
    ----------
    basis, line, cells, bonded
        Basis, line, elements and bond, see :class:`~skfem_contact.Beam`.
    EA
        Stiffness against stretching, of a geogrid its stiffness J: force per strain, in the plane
        per unit of length out of it.
    Np
        Largest normal force, beyond which reinforcement flows.
    tension_only
        True for a geogrid, which falls slack where it would be compressed.
    spacing
        Distance of the members of a row in the plane: EA and Np belong to one member. Section
        forces are per unit of length.

    Raises
    ------
    ValueError
        EA, Np or a spacing that is not positive, a line that is no chain, elements without length.

    Notes
    -----
    Section forces are given at the Gauss points, two an element. `Np` holds at them: a head that is
    pulled has the skin of a tenth of its element more. Strength reduction leaves `Np` as it is;
    `bounds` refuses reinforcement.

    Examples
    --------
    A geogrid with a stiffness of 500 kN/m across a block that is stretched by 1 %:

    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> middle = {"grid": lambda x: x[1] == .5}
    >>> mesh = MeshTri().refined(1).with_defaults().with_boundaries(middle, False)
    >>> basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    >>> grid = sc.Reinforcement(basis, "grid", EA=500., tension_only=True)
    >>> forms = {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.)), "grid": grid}
    >>> sides = [basis.get_dofs(side).all("u^1") for side in ("left", "right")]
    >>> model = sc.Model(forms, [*sides, basis.get_dofs("bottom").all("u^2")])
    >>> stretched = basis.zeros()
    >>> stretched[sides[1]] = .01
    >>> result = model.run([sc.Stage("stretch", prescribed=stretched)])
    >>> result["stretch"].section_forces("grid").N.round(9).tolist()
    [5.0, 5.0, 5.0, 5.0]
    """

    kind = "reinforcement"
    symmetric = True
    thickness = 0.0
    _brought = ("parameters", "spacing", "_EA", "_most", "_least", "unilateral")

    def __init__(
        self,
        basis: CellBasis | None,
        line: Any,
        EA: float,
        *,
        Np: float = np.inf,
        tension_only: bool = False,
        spacing: float | None = None,
        cells: ArrayLike | None = None,
        bonded: bool | None = None,
    ) -> None:
        self.spacing = 1.0 if spacing is None else spacing
        _check_rows(EA=EA, Np=Np, spacing=self.spacing)
        self.parameters = {"EA": EA, "Np": Np, "spacing": spacing, "tension_only": tension_only}
        self.shared, self.points, self.cells = nodes_of(basis, line, cells, bonded)
        dim = self.dim
        if dim == 3 and spacing is not None:
            raise ValueError("reinforcement in space has no spacing")
        self.coordinates = "plane"
        kind: type[BeamElements] = BeamElements
        if dim == 3:
            self.coordinates = "space"
            kind = SpaceElements

        # Axial strains of both Gauss points by the displacements, lengths and coordinates
        elements = kind.of(self.points[self.cells])
        per_point = elements.strains.shape[1] // 2
        self._strain = elements.strains[:, ::per_point, : 3 * dim]
        self._length = elements.weights
        self._where = elements.gauss()[0].reshape(2, -1, dim).transpose(1, 0, 2)

        # Dofs of the elements
        self.displacement = Field(
            "displacement of reinforcement", np.repeat(self.points, dim, axis=0).T
        )
        self._rows = (dim * self.cells[:, :, None] + np.arange(dim)).reshape(len(self.cells), -1)
        self._gathering = Gathering(self.points.size)
        self.fields = (self.displacement,)
        if self.shared is not None:
            self.fields = ()
            self._connect(self.shared.ravel())

        # Stiffness and strength of a row per unit of length
        self._EA = EA / self.spacing
        self._most = Np / self.spacing
        self._least = 0.0 if tension_only else -self._most
        self.unilateral = tension_only

    def _connect(self, dofs: ndarray) -> None:
        self._dofs = self.acts_on = self.changing = dofs

    @property
    @override
    def _names(self) -> tuple[DofName, ...]:
        return super()._names[: self.dim]

    def __repr__(self) -> str:
        return f"<Reinforcement {len(self.cells)} elements, {self._length.sum():.4g} long>"

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> Reinforcement:
        new = copy(self)
        if self.shared is None:
            new._connect(numbers[self.displacement])
        return new

    @property
    @override
    def strains(self) -> tuple[ndarray, ndarray]:
        assert self._dofs is not None  # of a model
        return self._strain, self._dofs[self._rows]

    def _strains(self, x: ndarray) -> ndarray:
        return np.einsum("mgj,mj->mg", self._strain, x[self._of_model()][self._rows])

    @override
    def initial_state(self, x: ndarray | None = None) -> ReinforcementState:
        zero = np.zeros(self._length.shape)
        if x is None:
            return ReinforcementState(zero, zero)
        return ReinforcementState(zero, self._strains(x))

    @override
    def assemble(self, x: ndarray, state: ReinforcementState) -> Response:
        # N = EA (eps - eps_free), between the strengths
        strain = self._strains(x)
        elastic = self._EA * (strain - state.free)
        force = np.clip(elastic, self._least, self._most)
        changed = force != elastic
        flows = changed & (abs(force) == self._most)

        def after() -> ReinforcementState:
            return ReinforcementState(force, np.where(flows, strain - force / self._EA, state.free))

        def stiffness() -> csr_matrix:
            share = np.where(changed, _KEPT, 1.0) * self._EA * self._length
            blocks = np.einsum("mg,mgi,mgj->mij", share, self._strain, self._strain)
            return self._gathering.matrix(self._rows, blocks)

        def gathered(N: ndarray, B: ndarray) -> ndarray:
            forces = np.einsum("mg,mgj->mj", self._length * N, B)
            return self._gathering.force(self._rows, forces)

        return Response(
            gathered(force, self._strain),
            after,
            stiffness,
            active=changed.tobytes(),
            measure=gathered(abs(force), abs(self._strain)),
            dofs=self._dofs,
        )

    @override
    def stretched_by(self, state: ReinforcementState) -> ndarray:
        return state.force / self._EA

    @override
    def rebased(self, x: ndarray, state: ReinforcementState) -> ReinforcementState:
        return ReinforcementState(state.force, state.free - self._strains(x))

    @override
    def outputs(self, x: ndarray, state: ReinforcementState) -> Outputs:
        return Outputs(
            summary=f"N {state.force.min():.4g} to {state.force.max():.4g}",
            parameters=self.parameters,
            lines=lambda: self._lines(state),
            points=lambda: self._line_points(x, state),
            yielding=lambda before: counted(before.free != state.free),
        )

    def _lines(self, state: ReinforcementState) -> tuple[Any, ...]:
        # Positions of the Gauss points along the line.
        lengths = self._length.sum(axis=1)
        begin = np.cumsum(lengths) - lengths
        position = begin[:, None] + lengths[:, None] * (0.5 + 0.5 * GAUSS)
        x, y, *z = self._where.reshape(-1, self.dim).T
        N = state.force.ravel()
        nothing = np.zeros((len(N), 3) if z else len(N))
        return position.ravel(), x, y, N, nothing, nothing, *z

    def _line_points(
        self, x: ndarray, state: ReinforcementState
    ) -> tuple[ndarray, dict[str, ndarray]]:
        # Forces are not extrapolated to the nodes: a geogrid would have a thrust
        N = np.column_stack((state.force, state.force.mean(axis=1)))
        displacement = x[self._of_model()][self._rows].reshape(-1, self.dim)
        values = {"N": N.ravel(), "displacement": displacement}
        points = self.points[self.cells].reshape(-1, self.dim)
        return points, values


def _check_rows(**values: float) -> None:
    """Refuse values that are not positive; the strength alone may be infinite."""
    for name, value in values.items():
        without_limit = name == "Np" and value == np.inf
        if not without_limit and not is_number(value, 0.0, np.inf):
            raise ValueError(f"{name} of reinforcement must be positive, not {value!r}")
