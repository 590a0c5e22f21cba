"""Motions and energies in time: histories at nodes, and the balance of energy."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, overload

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from typing_extensions import override

from ..arrays import row_norms
from ..checks import format_point
from ..display import Table
from ..forms.base import solids_of
from ..layout import FieldDofs

#: Quantities of a history, in the order in which they are recorded.
Quantity = Literal["displacement", "velocity", "acceleration"]
_QUANTITIES = ("displacement", "velocity", "acceleration")
#: Columns of the recorded energies.
_ENERGIES = ("time", "kinetic", "elastic", "plastic", "friction", "damping", "work")


class Lazy(Mapping[str, Any]):
    """Values by name that are computed together where somebody asks for one of them.

    Parameters
    ----------
    names
        The names.
    compute
        Function that returns the values by name.
    """

    def __init__(self, names: Iterable[str], compute: Callable[[], Mapping[str, Any]]) -> None:
        self._names = tuple(names)
        self._compute = compute

    @cached_property
    def _values(self) -> Mapping[str, Any]:
        return self._compute()

    def __getitem__(self, name: str) -> Any:
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


class Counts(Sequence[int]):
    """Whole numbers of all steps so far, which the steps of a stage share.

    A step adds its number to the shared array, so that many steps take neither a copy each nor the
    memory of their square.

    Parameters
    ----------
    values
        The first numbers.
    """

    def __init__(self, values: Iterable[int] = ()) -> None:
        self._shared = array("q", values)
        self._n = len(self._shared)

    def followed_by(self, value: int) -> Counts:
        """Return these numbers and one more."""
        new = Counts.__new__(Counts)
        new._shared = self._shared
        if len(self._shared) > self._n:  # another step has followed these numbers already
            new._shared = self._shared[: self._n]
        new._shared.append(value)
        new._n = self._n + 1
        return new

    @override
    def __len__(self) -> int:
        return self._n

    @overload
    def __getitem__(self, index: int) -> int: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[int, ...]: ...
    @override
    def __getitem__(self, index: int | slice) -> int | tuple[int, ...]:
        if isinstance(index, slice):
            return tuple(self._shared[i] for i in range(*index.indices(self._n)))
        return self._shared[range(self._n)[index]]

    @override
    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and self[:] == tuple(other)

    @override
    def __hash__(self) -> int:
        return hash(self[:])

    @override
    def __repr__(self) -> str:
        return repr(self[:])


@dataclass(frozen=True)
class History:
    """Motion of a node in time.

    Attributes
    ----------
    quantity
        ``"displacement"``, ``"velocity"`` or ``"acceleration"``.
    point : ndarray, shape (dim,)
        Coordinates of the node.
    time : ndarray, shape (n,)
        Times, the start of the stage first.
    values : ndarray, shape (n, dim)
        Components of the motion.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact.results import History
    >>> motion = History("velocity", np.zeros(2), np.arange(3.), np.array([[0, 0], [1, 0], [3, 4]]))
    >>> motion.largest
    5.0
    """

    quantity: Quantity
    point: ndarray
    time: ndarray
    values: ndarray

    @property
    def largest(self) -> float:
        """Largest length of the vector."""
        return float(row_norms(self.values).max())

    def table(self) -> Table:
        """Return the history as a table, with the time in its first column."""
        names = "xyz"[: self.values.shape[1]]
        columns = {"time": self.time}
        columns |= {f"{self.quantity} {name}": v for name, v in zip(names, self.values.T)}
        return Table.of(columns, f"{self.quantity} at {format_point(self.point)}")


def _check_inertia(series: Mapping[str, ndarray], name: str, records: str) -> None:
    """Refuse a stage without inertia, which has no records."""
    if "energy" not in series:
        raise ValueError(
            f"stage '{name}' has no inertia: only stages with `dynamic` have {records}"
        )


def energy_table(series: Mapping[str, ndarray], name: str) -> Table:
    """Return the energies of a stage and their balance as a table.

    Raises
    ------
    ValueError
        The stage has no inertia.
    """
    _check_inertia(series, name, "energies")
    values = series["energy"].T
    columns = dict(zip(_ENERGIES, values, strict=True))
    _, kinetic, *spent, work = values
    columns["missing"] = kinetic[0] + work - kinetic - sum(spent)
    return Table.of(columns, f"energies, {name}")


def history(
    stage: Any,
    point: ArrayLike | FieldDofs,
    quantity: Quantity = "displacement",
    *,
    absolute: bool = False,
) -> History:
    """Return the motion of a node in a stage with ``dynamic``.

    Parameters
    ----------
    point : array_like, shape (dim,)
        Coordinates of the node in the mesh; or the node of a beam, :meth:`Beam.at`.
    quantity
        ``"displacement"``, ``"velocity"`` or ``"acceleration"``.
    absolute
        True for the motion with the motion of the base, ``Stage(base=...)``; only of recorded
        nodes.

    Raises
    ------
    ValueError
        No node at these coordinates, a stage without inertia, or a node that is not among
        ``Dynamic(points=...)`` in a stage that keeps no steps.
    """
    # Find the node
    if quantity not in _QUANTITIES:
        raise ValueError(f"quantity must be one of {', '.join(_QUANTITIES)}, not {quantity!r}")
    _check_inertia(stage.series, stage.name, "histories")
    bases = [solid.basis for solid in solids_of(stage.forms).values()]
    dofs = stage.layout.moves_of(bases[0] if bases else None, point)[0]
    if isinstance(point, FieldDofs):
        where = point.field.coordinates[:, point.indices[0, 0]]
    else:
        where = np.asarray(bases[0].doflocs[:, dofs[0]])
    k = _QUANTITIES.index(quantity)

    # Take its records
    found = _recorded(stage.series, dofs, k, absolute)
    if found is not None:
        return History(quantity, where, stage.series["energy"][:, 0], found)
    if absolute:
        raise ValueError("absolute motions are of recorded nodes alone: give Dynamic(points=...)")

    # Take kept steps
    if not stage.increments:
        node = format_point(where)
        if isinstance(point, FieldDofs):
            node = f"beam.at({node})"
        raise ValueError(
            f"the motion at {format_point(where)} was not recorded: give Dynamic(points=[{node}]), "
            "or keep steps by Stage(keep=...)"
        )
    times = np.array([part.time for part in stage.increments])
    values = []
    for part in stage.increments:
        vector = (part.x, part.velocity, part.acceleration)[k]
        values.append(vector[dofs])
    return History(quantity, where, times, np.array(values))


def _recorded(
    series: Mapping[str, ndarray],
    dofs: ndarray,
    k: int,
    absolute: bool,
) -> ndarray | None:
    """Return the recorded motion of dofs, (n_steps, n_dofs), or None without records."""
    points = series.get("points", np.zeros((0, len(dofs)), int))
    for row, recorded in enumerate(points):
        if np.array_equal(recorded, dofs):
            values = series["motion"][:, k, row]
            if absolute and "base" in series:
                values = values + series["base"][:, k]
            return np.asarray(values)
    return None
