"""Values at points and along lines, of one stage or through all of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike

from ..arrays import row_norms
from ..checks import finite, format_point, look_up, names
from ..display import Table
from ..errors import warn
from ..layout import elements_in
from ..mesh.locate import locate, outside
from .fields import Shown, basis_of, quantities, region_field, solids
from .files import StageData
from .on_shells import FIELDS, on_shell, shell_of
from .patch_recovery import element_regions, region_mesh

#: Points of a line by default.
N_LINE = 101
#: Points on a line closer than this share of its length are the same.
_SAME = 1e-9


@dataclass(frozen=True)
class PointValues:
    """Values at points; printed as a table.

    ``values["uy"]`` is one of them as an array.

    Attributes
    ----------
    columns
        Labels, coordinates and values by their names, (n,) each. Values along a line have their
        ``position``, the distance along it; values through several stages have the ``stage`` and
        the ``time``.
    titles
        Titles and kinds of units of the values by their names.
    caption
        Title of the table.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> mesh = MeshQuad().refined(2).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> block = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.), unit_weight=20.)
    >>> fixed = basis.get_dofs("bottom").all()
    >>> stage = sc.Model({"block": block}, fixed).run([sc.Stage("weight")])["weight"]
    >>> values = stage.along([(.5, 0.), (.5, .5)], "syy", n=3)
    >>> values["syy"].round(2).tolist()
    [-19.99, -15.0, -10.0]
    >>> print(values)
    weight
    position    x     y     syy
           0  0.5     0  -19.99
        0.25  0.5  0.25     -15
         0.5  0.5   0.5     -10
    """

    columns: Mapping[str, Any]
    titles: Mapping[str, tuple[str, str]] = field(repr=False)
    caption: str = ""

    def __getitem__(self, name: str) -> ndarray:
        return look_up(name, self.columns, "column of these values")

    def __len__(self) -> int:
        return len(next(iter(self.columns.values())))

    @property
    def table(self) -> Table:
        """Table with the units of :func:`~skfem_contact.set_units`."""
        kinds = {name: kind for name, (_, kind) in self.titles.items()}
        kinds |= dict.fromkeys(("x", "y", "z", "position"), "length")
        return Table.of(self.columns, self.caption, kinds)

    def __str__(self) -> str:
        return str(self.table)

    __repr__ = __str__  # arrays would fill a notebook

    def _repr_html_(self) -> str:
        return self.table._repr_html_()

    def to_markdown(self) -> str:
        """Return the table in Markdown."""
        return self.table.to_markdown()

    def to_csv(self, file: str | Path | None = None) -> str:
        """Return comma-separated values with all digits, and write them to a given file."""
        return self.table.to_csv(file)

    def to_frame(self) -> Any:
        """Return the table as a data frame of pandas, which must be installed."""
        return self.table.to_frame()

    def plot(self, **options: Any) -> Any:
        """Draw the values, see :func:`~skfem_contact.plot.values`."""
        from ..plot import values

        return values(self, **options)


def at_points(
    stage: StageData,
    points: Mapping[str, ArrayLike] | ArrayLike,
    *quantity: str,
    since: StageData | None = None,
    water: Shown | None = None,
    of: str | None = None,
) -> PointValues:
    """Return fields at points of the bodies as a table, also within elements.

    Fields are interpolated between their values at the nodes of a region, see :meth:`field`.
    Points that lie on a boundary between regions or bodies have the values of the first one.

    Parameters
    ----------
    points
        Coordinates of one point, of several, (n, dim), or of points by their labels.
    quantity
        Names of fields, as of :meth:`field`.
    since, water
        Earlier stage from which changes are returned, and further pore pressure, as of
        :meth:`field`.
    of
        Solid, region or subdomain to which the values belong; by default any. Or a shell, with the
        fields of :func:`~skfem_contact.plot.shells`; by default the only one of a stage without
        solids.

    Raises
    ------
    ValueError
        Points outside of the active bodies: their number, and the distance of the first one.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> block = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.), unit_weight=20.)
    >>> fixed = basis.get_dofs("bottom").all()
    >>> stage = sc.Model({"block": block}, fixed).run([sc.Stage("weight")])["weight"]
    >>> print(stage.at({"top": (.3, 1.), "middle": (.3, .5)}, "uy", "syy"))
    weight
    point     x    y     uy  syy
    top     0.3    1  -0.01  -10
    middle  0.3  0.5 -0.005  -10
    >>> stage.at((2., 1.), "uy")
    Traceback (most recent call last):
        ...
    ValueError: 1 of 1 points lie outside of the bodies of stage 'weight': the first is ...
    """
    return _at(stage, points, quantity, since, water, of)[0]


def _at(
    stage: StageData,
    points: Mapping[str, ArrayLike] | ArrayLike,
    quantity: Sequence[str],
    since: StageData | None,
    water: Shown | None,
    of: str | None,
    gaps: bool = False,
) -> tuple[PointValues, ndarray]:
    """Return values at points, and those outside of the bodies, which have NaN with `gaps`."""
    shell = shell_of(stage, of)
    titles = _titles(stage, quantity, water, shell)
    labels, coordinates = _points(stage, points, shell)
    columns: dict[str, ndarray] = {}
    if labels:
        columns["point"] = np.array(labels)
    columns |= zip("xyz", coordinates.T)
    missing = np.zeros(len(coordinates), bool)
    if shell:
        columns |= on_shell(stage, shell, coordinates, quantity, since)
    else:
        values, missing = _values(stage, coordinates, quantity, since, water, of, gaps)
        columns |= values
    return PointValues(columns, titles, stage.name), missing


def along_line(
    stage: StageData,
    line: ArrayLike,
    *quantity: str,
    n: int = N_LINE,
    since: StageData | None = None,
    water: Shown | None = None,
    of: str | None = None,
) -> PointValues:
    """Return fields along a line through the bodies: a settlement trough, stresses in a cut.

    Parameters
    ----------
    line
        Ends of the line, and corners between them, (m, dim).
    quantity, since, water, of
        As of :meth:`at`.
    n
        Number of points at equal distances; corners are added.

    Examples
    --------
    See :class:`PointValues`.
    """
    shell = shell_of(stage, of)
    titles = _titles(stage, quantity, water, shell)
    position, coordinates = _line(stage, line, n, shell)
    columns = {"position": position} | dict(zip("xyz", coordinates.T))
    if shell:
        columns |= on_shell(stage, shell, coordinates, quantity, since)
    else:
        columns |= _values(stage, coordinates, quantity, since, water, of)[0]
    return PointValues(columns, titles, stage.name)


def through_stages(
    stages: Iterable[StageData],
    points: Mapping[str, ArrayLike] | ArrayLike,
    quantity: Sequence[str],
    water: Shown | None,
    of: str | None,
    increments: bool,
) -> PointValues:
    """Return values at points in all stages, see :meth:`~skfem_contact.results.Result.at`."""
    parts: list[StageData] = []
    for stage in stages:
        parts += (increments and stage.increments) or (stage,)
    each = [_at(part, points, quantity, None, water, of, gaps=True) for part in parts]
    found = [values for values, _ in each]
    _check_gaps(parts, found[0], np.array([missing for _, missing in each]))

    # Put the stage and its time before the columns of every part.
    counts = [len(values) for values in found]
    heads = zip(*[(part.name, part.time, part.fraction) for part in parts], strict=True)
    columns = {}
    for title, values_of_parts in zip(("stage", "time", "load"), heads, strict=True):
        columns[title] = np.repeat(values_of_parts, counts)
    if not columns["time"].any():
        columns.pop("time")
    if (columns["load"] == 1.0).all():
        columns.pop("load")
    for name in found[0].columns:
        columns[name] = np.concatenate([values.columns[name] for values in found])
    return PointValues(columns, found[0].titles, "histories")


def _titles(
    stage: StageData, quantity: Sequence[str], water: Shown | None, shell: str | None
) -> dict[str, tuple[str, str]]:
    """Return titles and kinds of units of fields by their names, which must exist."""
    if not quantity:
        raise ValueError("name at least one field, such as 'uy'")
    if shell:
        names(quantity, FIELDS, "field of shells")
        return {name: FIELDS[name] for name in quantity}
    existing = quantities(stage, water)
    names(quantity, existing, "field")
    return {name: (existing[name].title, existing[name].unit) for name in quantity}


def _points(
    stage: StageData, points: Mapping[str, ArrayLike] | ArrayLike, shell: str | None
) -> tuple[list[str], ndarray]:
    """Return labels or None, and coordinates, (n, dim), of points."""
    # Take labels from the keys.
    dim = 3 if shell else basis_of(stage).mesh.dim()
    labels: list[str] = []
    given: Any = points
    if isinstance(points, Mapping):
        labels = list(points)
        given = list(points.values())
    # Check the coordinates.
    coordinates = np.atleast_2d(finite(given, "points"))
    if coordinates.ndim != 2 or coordinates.shape[1] != dim or not len(coordinates):
        axes = "(x, y, z)"
        if dim == 2:
            axes = "(x, y)"
        raise ValueError(
            f"points are {axes} or several of them, (n, {dim}), not of the shape {np.shape(given)}"
        )
    return labels, coordinates


def _line(stage: StageData, line: ArrayLike, n: int, shell: str | None) -> tuple[ndarray, ndarray]:
    """Return distances along a line, (m,), and coordinates, (m, dim), its corners among them."""
    _, corners = _points(stage, line, shell)
    length = row_norms(np.diff(corners, axis=0))
    if len(corners) < 2 or not (length > 0.0).all():
        raise ValueError("a line has two or more corners, each different from the one before")
    if n < 2:
        raise ValueError(f"a line needs at least two points, not n={n}")
    # Equal distances, and the corners.
    knots = np.concatenate(([0.0], np.cumsum(length)))
    evenly = np.linspace(0.0, knots[-1], n)
    position = np.sort(np.concatenate((evenly, knots[1:-1])))
    # Drop points that coincide with a corner.
    apart = np.diff(position, prepend=-1.0) > _SAME * knots[-1]
    position = position[apart]
    coordinates = [np.interp(position, knots, axis) for axis in corners.T]
    return position, np.column_stack(coordinates)


def _values(
    stage: StageData,
    points: ndarray,
    quantity: Sequence[str],
    since: StageData | None,
    water: Shown | None,
    of: str | None,
    gaps: bool = False,
) -> tuple[dict[str, ndarray], ndarray]:
    """Return fields at points by their names, (n,) each, and a mask of points outside.

    These have NaN with `gaps`, and are refused without.
    """
    # Collect the elements of all solids, or of one solid or region.
    bodies = solids(stage)
    forms = list(bodies.values())
    mesh = region_mesh(*forms)
    numbers = elements_in(forms)
    allowed = _allowed(stage, bodies, numbers, mesh.region, of)
    if not len(allowed):
        raise ValueError(f"'{of}' has no active elements in stage '{stage.name}'")

    # Find the elements of the points.
    basis = basis_of(stage)
    located = locate(basis.mesh, numbers[allowed], points, mesh.region[allowed])
    missing = located.elements < 0
    if missing.any() and not gaps:
        if of is not None:
            where = f"'{of}'"
        else:
            where = f"the bodies of stage '{stage.name}'"
        far = outside(basis.mesh, numbers[allowed], points[missing])
        raise ValueError(
            f"{missing.sum()} of {len(points)} points lie outside of {where}: the first is {far}"
        )
    found = {name: np.full(len(points), np.nan) for name in quantity}
    if missing.all():
        return found, missing
    cell = allowed[located.elements[~missing]]

    # Interpolate the values at the nodes of the elements.
    shapes = _shape_functions(basis, located.local[..., ~missing])
    of_form = _by_form(bodies, np.unique(cell))
    for name in quantity:
        nodal = region_field(stage, name, since, water, of_form)
        found[name][~missing] = np.einsum("kn,nk->n", shapes, nodal[mesh.cells[cell]])
    return found, missing


def _check_gaps(parts: Sequence[StageData], values: PointValues, missing: ndarray) -> None:
    """Refuse points outside of the bodies in all parts, (parts, n), and warn of those in some."""
    n = missing.shape[1]
    never = np.flatnonzero(missing.all(axis=0))
    if len(never):
        first = np.array([values[axis][never[0]] for axis in "xyz" if axis in values.columns])
        raise ValueError(
            f"{len(never)} of {n} points lie outside of the bodies of all stages: the first is "
            f"{format_point(first)}"
        )
    if missing.any():
        k = int(missing.any(axis=1).argmax())
        warn(
            f"{missing[k].sum()} of {n} points lie outside of the active bodies in stage "
            f"'{parts[k].name}': they have NaN where no body holds them"
        )


def _allowed(
    stage: StageData,
    bodies: Mapping[str, Any],
    numbers: ndarray,
    region: ndarray,
    of: str | None,
) -> ndarray:
    """Return the positions of the elements of a solid, region or subdomain among all elements."""
    if of is None:
        return np.arange(len(region))
    # Collect the elements of regions, solids and subdomains by name.
    chosen: dict[str, ndarray] = {}
    count = 0
    for name, form in bodies.items():
        own = np.zeros(len(region), bool)
        for part in form.regions:
            inside = region == count
            chosen[part.name] = chosen.get(part.name, False) | inside
            own |= inside
            count += 1
        chosen[name] = own
    for name, elements in (basis_of(stage).mesh.subdomains or {}).items():
        chosen.setdefault(name, np.isin(numbers, elements))
    mask = look_up(of, chosen, f"solid, region or subdomain in stage '{stage.name}'")
    return np.flatnonzero(mask)


def _by_form(bodies: Mapping[str, Any], cells: ndarray) -> dict[str, ndarray]:
    """Return the elements of each solid among some of all elements."""
    result = {}
    start = 0
    for name, form in bodies.items():
        stop = start + len(element_regions(form))
        result[name] = cells[(cells >= start) & (cells < stop)] - start
        start = stop
    return result


def _shape_functions(basis: Any, local: ndarray) -> ndarray:
    """Return shape functions of the displacements at reference points (dim, n), (k, n)."""
    element = basis.elem.elem
    values = [element.lbasis(local, i)[0] for i in range(len(element.doflocs))]
    return np.array([np.broadcast_to(value, local.shape[1:]) for value in values])
