"""Modes of a model: their shapes, natural frequencies and factors of buckling."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy import ndarray
from typing_extensions import override

from ..display import Table
from .stage import StageResult


class Shapes:
    """Shapes of modes, which are drawn as stages.

    Attributes
    ----------
    shapes : ndarray, shape (N, n)
        Displacements of the modes, the largest component 1.
    start
        Equilibrium from which the modes move.
    """

    shapes: ndarray
    start: StageResult

    def __len__(self) -> int:
        return self.shapes.shape[1]

    def stage(self, number: int) -> StageResult:
        """Return a mode, counted from 0, as a stage to draw: its displacements alone.

        Raises
        ------
        ValueError
            The mode was not computed.
        """
        if not 0 <= number < len(self):
            raise ValueError(f"there are {len(self)} modes, numbers 0 to {len(self) - 1}")
        name = f"mode {number + 1}, {self._title(number)}"
        return replace(self.start, name=name, x=self.shapes[:, number].copy())

    def table(self) -> Table:
        """Return the modes as a table."""
        raise NotImplementedError

    def __str__(self) -> str:
        return str(self.table())

    def _title(self, number: int) -> str:
        """Return the value of a mode in words."""
        raise NotImplementedError


@dataclass(frozen=True)
class Modes(Shapes):
    """Natural frequencies and modes, the lowest first.

    Attributes
    ----------
    frequencies : ndarray, shape (n,)
        Frequencies in cycles per time (Hz); zero for bodies that move freely.
    shapes : ndarray, shape (N, n)
        Displacements of the modes, the largest component 1.
    masses : ndarray, shape (n,)
        Generalised masses ``x @ M @ x``.
    participation : ndarray, shape (n, dim)
        Factors ``x @ M @ r`` over the generalised mass, of a base that moves along each axis.
    effective : ndarray, shape (n, dim)
        Share of the mass that is free to move that each mode takes along each axis: they add up to
        1.
    start
        Equilibrium of which these are the small vibrations.

    Examples
    --------
    A layer on rock, whose frequencies are ``(2 k - 1) c / 4 H``:

    >>> import numpy as np
    >>> from skfem import Basis, ElementQuad2, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> mesh = MeshQuad.init_tensor([0., 1.], np.linspace(0., 20., 11)).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    >>> soil = sc.SolidForm(basis, sc.LinearElastic(E=2e5, nu=.25), unit_weight=20.)
    >>> fixed = [basis.get_dofs("bottom").all(), np.arange(1, basis.N, 2)]
    >>> model = sc.Model({"soil": soil}, fixed, gravity_acceleration=10.)
    >>> model.frequencies(3).round(2)                                  # c = 200
    array([ 2.5,  7.5, 12.5])
    """

    frequencies: ndarray
    shapes: ndarray = field(repr=False)
    masses: ndarray = field(repr=False)
    participation: ndarray = field(repr=False)
    effective: ndarray = field(repr=False)
    start: StageResult = field(repr=False)

    @override
    def _title(self, number: int) -> str:
        return f"{self.frequencies[number]:.4g} Hz"

    def swing(self, number: int, parts: int = 8) -> list[StageResult]:
        """Return a period of a mode, counted from 0, as stages to animate.

        Parameters
        ----------
        number
            The mode.
        parts
            Stages of the period, at least 2, and one more that closes it.

        Raises
        ------
        ValueError
            The mode was not computed, or fewer than two parts.

        Examples
        --------
        >>> import numpy as np
        >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
        >>> import skfem_contact as sc
        >>> basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
        >>> column = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.), unit_weight=20.)
        >>> fixed = [basis.get_dofs("bottom").all(), basis.get_dofs().all("u^1")]
        >>> modes = sc.Model({"column": column}, fixed, gravity_acceleration=10.).modes(1)
        >>> largest = np.abs(modes.shapes[:, 0]).argmax()
        >>> [round(float(stage.x[largest])) for stage in modes.swing(0, 4)]
        [1, 0, -1, 0, 1]

        ``plot.animate(modes.swing(0), "uy", "mode.gif", deformed="auto")`` writes a film.
        """
        if parts < 2:
            raise ValueError(f"a period has at least 2 parts, not {parts}")
        mode = self.stage(number)
        phases = np.cos(2.0 * np.pi * np.arange(parts + 1) / parts)
        return [replace(mode, x=phase * mode.x) for phase in phases]

    @override
    def table(self) -> Table:
        """Return frequencies, periods and shares of the mass as a table."""
        n = len(self)
        with np.errstate(divide="ignore"):
            periods = 1.0 / self.frequencies
        columns: dict[str, Any] = {"mode": np.arange(1, n + 1)}
        columns |= {"frequency": self.frequencies, "period": periods}
        axes = "xyz"[: self.effective.shape[1]]
        for axis, share in zip(axes, self.effective.T, strict=True):
            columns[f"mass {axis}"] = share
        return Table.of(columns, "natural frequencies")


def modes(
    squares: ndarray,
    shapes: ndarray,
    M: Any,
    moves: Mapping[int, ndarray],
    start: StageResult,
) -> Modes:
    """Return modes from squares of angular frequencies and shapes with unit generalised mass.

    Parameters
    ----------
    squares, shapes
        As of the dynamics room, (n,) and (N, n).
    M
        Mass that is free to move, (N, N).
    moves
        Rigid translations by axis, (N,) each.
    start
        The equilibrium.
    """
    # x^T M r / x^T M x, and the share (x^T M r)^2 / (x^T M x r^T M r)
    along = np.array([shapes.T @ (M @ r) for r in moves.values()]).T
    total = np.array([r @ (M @ r) for r in moves.values()])
    effective = along**2 / np.where(total > 0.0, total, 1.0)
    largest = np.abs(shapes).argmax(axis=0)
    size = shapes[largest, np.arange(shapes.shape[1])]
    return Modes(
        frequencies=np.sqrt(np.maximum(squares, 0.0)) / (2.0 * np.pi),
        shapes=shapes / size,
        masses=1.0 / size**2,
        participation=along * size[:, None],
        effective=effective,
        start=start,
    )


@dataclass(frozen=True)
class Buckling(Shapes):
    """Factors of the thrusts at which a structure buckles, the lowest first, and its modes.

    Attributes
    ----------
    factors : ndarray, shape (n,)
        Thrusts of buckling over the thrusts at the start.
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
