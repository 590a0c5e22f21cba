"""Dual Lagrange multipliers as a method of enforcement."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy import ndarray
from typing_extensions import override

from ..errors import Remark
from ..forms.base import Response
from ..layout import Field
from ..surfaces.surface import Surface
from .compliance import on_gaps_between_nodes
from .enforcement import Enforcement, check_corners
from .interface import ContactState
from .laws import InterfaceLaw, Status
from .multipliers import balanced, foreseen, nodal_forces, respond
from .transfer import Transfer


@dataclass(frozen=True)
class DualMultipliers(Enforcement):
    """Lagrange multipliers that Newton's method finds together with the displacements.

    The method has no penalty and no tolerance.  Tractions at the slave's nodes are dofs of a model,
    after the displacements in the vectors of its results. Nothing penetrates in the mean around a
    node, and sticking nodes do not slip.  One equilibrium is enough for an increment.  Elastic
    bodies take about 40 % of the iterations of :class:`AugmentedLagrangian`.  A penalty is neither
    needed nor used.

    Between nodes facets that do not match gape and overlap.  Searches for a collapse, initial
    states of the ground, two passes and slaves that are rigid need one of the other methods.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> block = MeshQuad().refined(1).with_defaults()
    >>> mesh = sc.join_bodies({"lower": block, "upper": block.translated((0., 1.))})
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> method = sc.DualMultipliers()
    >>> pair = sc.ContactPair(basis, "upper:bottom", "lower:top", sc.Coulomb(), enforcement=method)
    >>> forms = {"blocks": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.)), "contact": pair}
    >>> x, top = basis.zeros(), basis.get_dofs("upper:top")
    >>> x[top.all("u^2")] = -0.02                                      # 1 % of the height
    >>> fixed = sorted({*top.all(), *basis.get_dofs("lower:bottom").all()})
    >>> result = sc.Model(forms, fixed).run([sc.Stage("press", prescribed=x)], progress=False)
    >>> float(result["press"].tractions("contact").pressure.max().round(6))
    10.0
    """

    saddle = True

    @override
    def check(self, slave: Surface, law: InterfaceLaw, quadrature: Any, share: float) -> None:
        """Refuse more multipliers than motions, and directions of slip that differ at a node."""
        # Count the multipliers: one for each node that deforms.
        check_corners(slave)
        if slave.rigid:
            raise ValueError(
                f"DualMultipliers are dofs of a slave that deforms: '{slave.name}' is rigid, make "
                "it the master"
            )
        if share != 1.0:
            raise ValueError(
                "DualMultipliers hold both surfaces in one pass: share must be 1, and no second "
                "pair"
            )
        # Dual shape functions need enough points on each facet.
        order = slave.shape.exponents.max()
        if not isinstance(quadrature, str) and quadrature <= order:
            raise ValueError(
                f'DualMultipliers need quadrature="segments", or at least {order + 1} points along '
                f"a facet, not {quadrature}"
            )
        # Slip is counted from an axis along all facets.
        if slave.dim == 3 and not law.symmetric and (slave.directions != slave.directions[0]).any():
            raise ValueError(
                f"DualMultipliers with friction: the facets of '{slave.name}' have no axis that "
                "lies along all of them, from which slip is counted; split the boundary, or take "
                "AugmentedLagrangian()"
            )

    @override
    def check_collapse(self, slave: Surface) -> None:
        raise ValueError(
            f"contact of '{slave.name}' has DualMultipliers: searches for a collapse are for the "
            "penalty method and AugmentedLagrangian()"
        )

    @override
    def fields(self, slave: Surface) -> tuple[Field, ...]:
        nodes = np.repeat(slave.nodes.T, slave.dim, axis=1)
        return (Field(f"contact traction of '{slave.name}'", nodes, "multiplier"),)

    @override
    def penalties(self, pair: Any, state: ContactState) -> tuple[float, float]:
        """Return the parameter of the equations, which does not change their solution."""
        if pair.stiffness is None:
            return super().penalties(pair, state)
        return pair.stiffness, pair.stiffness

    @override
    def start(self, pair: Any, state: ContactState) -> ContactState:
        nearest = pair.nodes_at(state).point
        return replace(state, closed=state.status[nearest] != Status.OPEN)

    @override
    def start_with(
        self,
        pair: Any,
        state: ContactState,
        tractions: ndarray,
    ) -> tuple[ContactState, ndarray]:
        raise ValueError(
            f"contact of '{pair.slave.name}' has DualMultipliers, and cannot start with given "
            "tractions: take the penalty method or AugmentedLagrangian()"
        )

    @override
    def respond(self, pair: Any, x: ndarray, accepted: ContactState) -> Response:
        if len(pair.multipliers) == 0:
            raise ValueError(
                "the multipliers are dofs of a model: take the pair from Model(forms).forms"
            )
        return respond(pair, x, accepted)

    @override
    def after_equilibrium(
        self,
        pair: Any,
        accepted: ContactState,
        found: ContactState,
    ) -> tuple[ContactState, dict[str, Any]]:
        # Let points take part that have come under a rim, where bodies slide far. In the iterations
        # they would go back and forth, and the areas of their nodes with them.
        new = (found.facet >= 0) & (accepted.facet < 0)
        if not pair.holds_points or not new.any():
            return accepted, {}
        facet = np.where(new, found.facet, accepted.facet)
        position = np.where(new, found.position, accepted.position)
        state = replace(accepted, facet=facet, position=position)

        # They have slipped as far as the points beside them.
        interface = pair.interface
        slip = interface.elastic_slip(accepted, found)
        known = np.flatnonzero((found.facet >= 0) & (accepted.facet >= 0))
        beside = np.zeros_like(slip)
        if len(known):
            points = pair.points(accepted)
            to_new = Transfer(pair.slave, points.take(known), points.take(np.flatnonzero(new)))
            beside[:, new] = slip[:, known[to_new.at]]
        stick = interface.with_elastic_slip(state, beside)
        state = replace(
            state,
            stick_facet=np.where(new, stick.stick_facet, accepted.stick_facet),
            stick_point=np.where(new, stick.stick_point, accepted.stick_point),
        )
        return state, {}

    @override
    def remarks(
        self,
        pair: Any,
        x: ndarray,
        state: ContactState,
        meshed: ndarray,
    ) -> Iterator[Remark]:
        return on_gaps_between_nodes(pair, x, state, meshed)

    @override
    def tractions(self, pair: Any, state: ContactState) -> ndarray:
        return balanced(pair, state)

    @override
    def nodal_forces(self, pair: Any, x: ndarray, state: ContactState) -> list[ndarray]:
        return nodal_forces(pair, x, state)

    @override
    def foreseen(
        self,
        pair: Any,
        start: ndarray,
        x: ndarray,
        before: ndarray | None,
        accepted: ContactState,
    ) -> ndarray:
        return foreseen(pair, start, x, before, accepted)
