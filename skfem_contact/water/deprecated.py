"""Former names of water, which warn and call their successors."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

from numpy import ndarray
from skfem import CellBasis

from ..forms.base import Coordinates
from .boundary import Given
from .conditions import Conditions, Varying
from .conductivity import Permeability
from .darcy import Tensor
from .flow import Flow
from .pore_water import PoreWater
from .retention import Ramp, Retention
from .seepage import Seepage
from .transient import TransientSeepage

_RAMP = Ramp()
_NOTHING: Mapping[str, Any] = MappingProxyType({})


def deprecated(old: str, new: str) -> None:
    """Warn that a name has a successor."""
    warnings.warn(f"{old} is deprecated: use {new}", DeprecationWarning, stacklevel=4)


class CompactingPoreWater(PoreWater):
    """Deprecated: :class:`PoreWater` with a :class:`Permeability`."""

    def __init__(
        self,
        basis: CellBasis,
        permeability: Tensor | Mapping[str, Tensor],
        *,
        void_ratio: float | Mapping[str, float],
        change: float | Mapping[str, float],
        unit_weight: float,
        storage: float | Mapping[str, float] = 0.0,
        time_error: float = 0.01,
    ) -> None:
        deprecated("CompactingPoreWater", "PoreWater(basis, Permeability(...), ...)")
        super().__init__(
            basis,
            Permeability(permeability, void_ratio, change),
            unit_weight=unit_weight,
            storage=storage,
            time_error=time_error,
        )


class UnsaturatedPoreWater(PoreWater):
    """Deprecated: :class:`PoreWater` with a `retention` and a `start`."""

    def __init__(
        self,
        basis: CellBasis,
        permeability: Tensor | Mapping[str, Tensor],
        *,
        retention: Retention | Mapping[str, Retention],
        start: Seepage | Given,
        unit_weight: float,
        storage: float | Mapping[str, float] = 0.0,
        time_error: float = 0.01,
        connected: Sequence[tuple[str, str]] = (),
    ) -> None:
        deprecated("UnsaturatedPoreWater", "PoreWater(basis, ..., retention=..., start=...)")
        super().__init__(
            basis,
            permeability,
            unit_weight=unit_weight,
            storage=storage,
            time_error=time_error,
            connected=connected,
            retention=retention,
            start=start,
        )


def seepage(
    basis: CellBasis,
    permeability: Tensor | Mapping[str, Tensor],
    head: Mapping[str, Given],
    *,
    unit_weight: float,
    seepage_face: str | Sequence[str] = (),
    flux: Mapping[str, Given] = _NOTHING,
    wells: Mapping[str, float] = _NOTHING,
    sources: Mapping[str, Given] = _NOTHING,
    drains: Mapping[str, tuple[Given, float]] = _NOTHING,
    connected: Sequence[tuple[str, str]] = (),
    retention: Retention | Mapping[str, Retention] = _RAMP,
    coordinates: Coordinates | None = None,
) -> Seepage:
    """Solve the steady flow: deprecated, see :meth:`Flow.steady`."""
    deprecated("seepage", "Flow(...).steady(Conditions(...))")
    flow = Flow(
        basis,
        permeability,
        unit_weight=unit_weight,
        retention=retention,
        connected=connected,
        coordinates=coordinates,
    )
    return flow.steady(Conditions(head, flux, wells, drains, sources, seepage_face))


def transient_seepage(
    basis: CellBasis,
    permeability: Tensor | Mapping[str, Tensor],
    head: Varying = _NOTHING,
    *,
    retention: Retention | Mapping[str, Retention],
    times: Sequence[float] | ndarray,
    start: Seepage | Given,
    unit_weight: float,
    seepage_face: str | Sequence[str] = (),
    flux: Varying = _NOTHING,
    suction: Varying = _NOTHING,
    wells: Varying = _NOTHING,
    sources: Varying = _NOTHING,
    connected: Sequence[tuple[str, str]] = (),
    storage: float | Mapping[str, float] = 0.0,
    coordinates: Coordinates | None = None,
    error: float = 1e-2,
) -> TransientSeepage:
    """Solve the flow in time: deprecated, see :meth:`Flow.in_time`."""
    deprecated("transient_seepage", "Flow(...).in_time(Conditions(...), times, start)")
    flow = Flow(
        basis,
        permeability,
        unit_weight=unit_weight,
        retention=retention,
        connected=connected,
        storage=storage,
        coordinates=coordinates,
    )
    given = Conditions(
        head,
        flux,
        wells,
        _NOTHING,
        sources,
        seepage_face,
        suction,
    )
    return flow.in_time(given, times, start, error)
