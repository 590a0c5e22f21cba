"""Former names of water, which warn and build :class:`PoreWater`."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence

from skfem import CellBasis

from .boundary import Given
from .conductivity import Permeability
from .darcy import Tensor
from .pore_water import PoreWater
from .retention import Retention
from .seepage import Seepage


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
