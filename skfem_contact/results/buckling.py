"""Loads at which a structure buckles, and its modes."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy import ndarray
from typing_extensions import override

from ..display import Table
from .modes import Shapes
from .stage import StageResult


@dataclass(frozen=True)
class Buckling(Shapes):
    """Factors of the thrusts at which a structure buckles, the lowest first, and its modes.

    Attributes
    ----------
    factors : ndarray, shape (n,)
        Thrusts of buckling over those of the start.
    shapes : ndarray, shape (N, n)
        Displacements of the modes, the largest component 1.
    start
        Equilibrium whose thrusts grow.

    Examples
    --------
    A column of length 2 that is held at its foot, ``P = pi**2 EI / (2 L)**2``:

    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> column = sc.Beam(None, [[0., y] for y in np.linspace(0., 2., 9)], EI=100., EA=1e6)
    >>> model = sc.Model({"column": column}, column.dofs((0., 0.)))
    >>> load = model.forms["column"].load((0., -1.), at=(0., 2.))
    >>> found = model.buckling(2, start=model.run([sc.Stage("load", load)]))
    >>> found.factors.round(1), round(np.pi**2 * 100. / 4.**2, 1)
    (array([ 61.7, 554.4]), 61.7)
    """

    factors: ndarray
    shapes: ndarray = field(repr=False)
    start: StageResult = field(repr=False)

    @override
    def _title(self, number: int) -> str:
        return f"at {self.factors[number]:.4g} times the thrust"

    @override
    def table(self) -> Table:
        """Return the factors as a table."""
        columns: dict[str, Any] = {"mode": np.arange(1, len(self) + 1), "factor": self.factors}
        return Table.of(columns, "buckling")
