"""Partial factors on actions, strengths and resistances, as named sets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy import ndarray

from ..checks import is_number
from ..materials.elastic import angle_over


@dataclass(frozen=True)
class PartialFactors:
    r"""A set of partial factors.

    Actions and effects of actions are multiplied, strengths and resistances divided. The weight of
    the ground and the pressure of water are never factored in a model: where factors act on
    effects, as in the design approaches 1-1 and 2* of Eurocode 7, loads stay characteristic, but
    variable ones are multiplied by the ratio variable / permanent, and forces and moments
    of the analysis by `permanent`.

    Parameters
    ----------
    name
        Name of the set.
    permanent, favourable, variable
        Factors on unfavourable permanent, favourable permanent and unfavourable variable actions.
    phi, cohesion, undrained
        Factors on :math:`\tan\varphi'`, on the effective cohesion, and on the undrained strength.
    bearing, sliding, passive
        Factors on resistances of bearing, sliding and earth in front.
    on
        ``"actions"`` or ``"effects"``.

    Raises
    ------
    ValueError
        A factor that is no positive number.

    Examples
    --------
    A set of one's own, from an existing one:

    >>> from dataclasses import replace
    >>> import skfem_contact as sc
    >>> own = replace(sc.design.EC7["DA1-2"], name="own", undrained=1.5)
    >>> own.undrained, own.phi
    (1.5, 1.25)
    >>> sc.design.EC7["DA2*"].effect(100.)
    135.0
    """

    name: str = "own"
    permanent: float = 1.0
    favourable: float = 1.0
    variable: float = 1.0
    phi: float = 1.0
    cohesion: float = 1.0
    undrained: float = 1.0
    bearing: float = 1.0
    sliding: float = 1.0
    passive: float = 1.0
    on: Literal["actions", "effects"] = "actions"

    def __post_init__(self) -> None:
        for part in fields(self):
            value = getattr(self, part.name)
            if part.name not in ("name", "on") and not is_number(value, 0.0, np.inf):
                raise ValueError(
                    f"the factor '{part.name}' of set '{self.name}' must be positive, not {value!r}"
                )

    def load(
        self,
        permanent: ndarray | None = None,
        variable: ndarray | None = None,
        favourable: ndarray | None = None,
    ) -> ndarray:
        """Return the sum of design loads, (N,), for a stage.

        Parameters
        ----------
        permanent, variable, favourable
            Characteristic load vectors, (N,).
        """
        # Factors of loads, or of their effects relative to permanent ones.
        shares = {
            "permanent": (permanent, self.permanent),
            "variable": (variable, self.variable),
            "favourable": (favourable, self.favourable),
        }
        total: ndarray | None = None
        for kind, (load, factor) in shares.items():
            if load is None:
                continue
            if self.on == "effects":
                factor = 1.0
                if kind == "variable":
                    factor = self.variable / self.permanent
            part = factor * np.asarray(load, float)
            if total is not None and part.shape != total.shape:
                raise ValueError(
                    f"the {kind} load has the shape {part.shape}, the others {total.shape}"
                )
            total = part if total is None else total + part
        if total is None:
            raise ValueError("give a load: permanent=, variable= or favourable=")
        return total

    def friction_angle(self, phi: float) -> float:
        """Return the design value of a friction angle, in degrees."""
        return float(angle_over(phi, self.phi))

    def effect(self, value: float) -> float:
        """Return the design effect of a force or moment of the analysis."""
        if self.on == "effects":
            return value * self.permanent
        return value


def _sets(*factors: PartialFactors) -> Mapping[str, PartialFactors]:
    return MappingProxyType({one.name: one for one in factors})


#: Sets of EN 1997-1:2004, annex A, with the recommended values, by name: ``"characteristic"``,
#: ``"DA1-1"``, ``"DA1-2"``, ``"DA2"``, ``"DA2*"``, ``"DA3"`` (geotechnical actions), ``"EQU"`` and
#: ``"UPL"``. National annexes have others.
EC7: Mapping[str, PartialFactors] = _sets(
    PartialFactors("characteristic"),
    PartialFactors("DA1-1", permanent=1.35, variable=1.5, on="effects"),
    PartialFactors("DA1-2", variable=1.3, phi=1.25, cohesion=1.25, undrained=1.4),
    PartialFactors(
        "DA2",
        permanent=1.35,
        variable=1.5,
        bearing=1.4,
        sliding=1.1,
        passive=1.4,
        on="actions",
    ),
    PartialFactors(
        "DA2*",
        permanent=1.35,
        variable=1.5,
        bearing=1.4,
        sliding=1.1,
        passive=1.4,
        on="effects",
    ),
    PartialFactors("DA3", variable=1.3, phi=1.25, cohesion=1.25, undrained=1.4),
    PartialFactors(
        "EQU",
        permanent=1.1,
        favourable=0.9,
        variable=1.5,
        phi=1.25,
        cohesion=1.25,
        undrained=1.4,
    ),
    PartialFactors("UPL", favourable=0.9, variable=1.5, phi=1.25, cohesion=1.25, undrained=1.4),
)
