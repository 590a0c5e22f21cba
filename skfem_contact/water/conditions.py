"""Conditions of flow by boundary and subdomain, steady or in time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from numpy import ndarray
from skfem import CellBasis

from .boundary import (
    Given,
    NodalConditions,
    conditions,
    drained,
    pumped,
    with_suction,
)

#: Values by boundary or subdomain, or a function of time that returns them.
Varying = Mapping[str, Given] | Callable[[float], Mapping[str, Given]]


@dataclass(frozen=True, eq=False)
class Conditions:
    """Conditions of flow; boundaries without a condition are tight.

    For flow in time all but drains may be functions of the time that return such a mapping, with
    the same names at all times: ``flux=lambda t: {"surface": 1e-6 if t < 3600 else 0.}``.

    Parameters
    ----------
    head
        Hydraulic head, a height, by boundary: a number or a function of coordinates (dim, ...). The
        head is the level of the water at the boundary and holds at and below that level. Above it
        the boundary is tight, or a `seepage_face`.
    flux
        Water that enters by boundary, per time and area: a number or a function of coordinates
        (dim, ...). It is infiltration where it is positive, and the water that the ground does not
        take at zero pressure runs off; evaporation where it is negative.
    wells
        Water that is pumped by boundary, per time (and unit of thickness, or radian): the screen is
        a boundary under water, with one unknown head.
    drains
        Level and resistance, a time, by boundary: per area leaves the head above the level over the
        resistance. No water enters. A filter of thickness d and permeability k has the resistance d
        / k. For steady flow only.
    sources
        Water that enters by subdomain, per time and volume: a number or a function of coordinates
        (dim, ...).
    seepage_face
        Names of boundaries through which water may leave but not enter, at zero pressure; also of
        boundaries in `head`.
    suction
        Suction by boundary, a length: less the pressure head. It is kept like a head. For flow in
        time only.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.water.Conditions(head={"left": 10., "right": 2.}, seepage_face="right").head["left"]
    10.0
    """

    head: Varying = field(default_factory=dict)
    flux: Varying = field(default_factory=dict)
    wells: Varying = field(default_factory=dict)
    drains: Mapping[str, tuple[Given, float]] = field(default_factory=dict)
    sources: Varying = field(default_factory=dict)
    seepage_face: str | Sequence[str] = ()
    suction: Varying = field(default_factory=dict)

    def values(self, what: str, time: float | None) -> Mapping[str, Any]:
        """Return the values by name at a time, None for steady flow."""
        given = getattr(self, what)
        if callable(given) and time is None:
            raise ValueError(f"{what} is a function of time: steady flow has {{name: value}}")
        values = given
        if callable(given):
            values = given(time)
        if not isinstance(values, Mapping):
            raise ValueError(
                f"{what} at the time {time:g} is {values!r}: give {{name: value}}, or a function "
                "of time that returns it"
            )
        return values

    @property
    def constant(self) -> bool:
        """True if nothing is a function of time."""
        varying = (self.head, self.flux, self.wells, self.sources, self.suction)
        return not any(callable(each) for each in varying)

    def at_nodes(
        self,
        basis: CellBasis,
        axisymmetric: bool,
        time: float | None = None,
    ) -> tuple[NodalConditions, ndarray]:
        """Return the conditions at the nodes, and the first node of the well of each node, (N,)."""
        given = conditions(
            basis,
            self.values("head", time),
            seepage_face=self.seepage_face,
            flux=self.values("flux", time),
            sources=self.values("sources", time),
            axisymmetric=axisymmetric,
        )
        given = with_suction(basis, self.values("suction", time), given)
        given, first = pumped(basis, self.values("wells", time), given)
        if self.drains:
            given = drained(basis, self.drains, given, axisymmetric)
        return given, first
