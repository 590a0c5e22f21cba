"""Results of an analysis: its stages in their order."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import Mesh

from ..arrays import max_abs
from ..checks import finite, look_up, nearest
from ..display import Table
from ..forms.base import States, as_forms
from ..forms.roles import Staged, fits, having
from . import export, fields, files, tables
from .cuts import Cuts
from .points import PointValues, through_stages
from .stage import StageResult

#: Change of a form's internal force at a reset, as a share of all forces, that is more than
#: round-off.
_SAME_FORCE = 1e-9
#: Columns of the table of a result.
COLUMNS = ("stage", "increments", "iterations", "residual", "load", "state")


@dataclass(frozen=True)
class Result:
    """Results of stages in their order.

    ``result["gravity"]`` is one of them, ``print(result)`` prints a table.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> mesh = MeshQuad().refined(1).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=.3))}
    >>> model = sc.Model(forms, basis.get_dofs("bottom").all())
    >>> result = model.run([sc.Stage("gravity", sc.weight(basis, 20.))])
    >>> print(result)
    stage            increments  iterations  residual  load    state
    gravity                   1           1   ...  100%
    >>> start = result.reset()["gravity"]
    >>> bool(start.x.any()), bool(start.states["ground"].stress.any())
    (False, True)
    """

    stages: tuple[StageResult, ...]

    def __getitem__(self, key: str | int) -> StageResult:
        if isinstance(key, int):
            return self.stages[key]
        names = [stage.name for stage in self.stages]
        if key not in names:
            raise KeyError(f"there is no stage '{key}'; existing: {names}{nearest(key, names)}")
        return self.stages[names.index(key)]

    def __iter__(self) -> Iterator[StageResult]:
        return iter(self.stages)

    def __len__(self) -> int:
        return len(self.stages)

    def __str__(self) -> str:
        row = "{:16} {:>10}  {:>10}  {:>8}  {:>4}    {}"
        return "\n".join(row.format(*cells) for cells in (COLUMNS, *rows_of(self)))

    __repr__ = __str__  # the arrays of all stages would fill a notebook

    def _repr_html_(self) -> str:
        return Table(COLUMNS, rows_of(self))._repr_html_()

    def completed(self) -> Result:
        """Return the result without a last stage that ended early: an interrupted run is resumed.

        Examples
        --------
        >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
        >>> import skfem_contact as sc
        >>> basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
        >>> block = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.), unit_weight=20.)
        >>> model = sc.Model({"block": block}, basis.get_dofs("bottom").all())
        >>> def stop(increment):
        ...     if increment.fraction == .5 and increment.name == "load":
        ...         raise KeyboardInterrupt
        >>> load = model.traction("top", (0., -1.))
        >>> stages = [sc.Stage("weight"), sc.Stage("load", load, increments=2)]
        >>> try:
        ...     result = model.run(stages, on_increment=stop)
        ... except KeyboardInterrupt as error:
        ...     result = error.result
        >>> [stage.name for stage in result], [stage.name for stage in result.completed()]
        (['weight', 'load'], ['weight'])
        >>> model.run(stages[1:], start=result.completed())["load"].fraction
        1.0
        """
        if self.stages and self.stages[-1].fraction < 1.0:
            return Result(self.stages[:-1])
        return self

    def envelope(self, body: str, sections: Cuts | None = None) -> tables.Envelope:
        """Return the extreme section forces over the ends of all stages, without increments."""
        stages = [stage for stage in self if body in stage.states]
        if not stages:
            stages = [self[-1]]  # its error names the body
        forces = {stage.name: stage.section_forces(body, sections) for stage in stages}
        return tables.Envelope.of(forces)

    def table(
        self,
        *names: str,
        sections: Mapping[str, Cuts] | None = None,
        searches: Mapping[str, Any] | None = None,
    ) -> Table:
        """Return one row for each stage: largest displacements and forces, and their coordinates.

        Parameters
        ----------
        names
            Names of beams, bars, embedded beams and contact pairs; by default all but contact
            pairs. Columns of zeros are left out.
        sections
            Cuts through solids by their names, such as ``{"lining": Cuts.ring(...)}``.
        searches
            Strength reductions or limit loads by the stages from which they start, such as ``{"dig
            4": found}``. A value that is not shown to be the limit has ``>=`` before it.

        Raises
        ------
        ValueError
            A form or stage that does not exist.

        Examples
        --------
        >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
        >>> import skfem_contact as sc
        >>> basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
        >>> block = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.), unit_weight=20.)
        >>> rope = sc.Bar(basis, (0., 1.), (0., 3.), EA=1e3, fixed_end=True)
        >>> bottom = basis.get_dofs("bottom").all()
        >>> result = sc.Model({"block": block, "rope": rope}, bottom).run([sc.Stage("weight")])
        >>> print(result.table().to_markdown())
        | stage | displacement | displacement at | rope | rope at |
        |:--|--:|:--|--:|:--|
        | weight | 0.01265 | (1, 1) | 2 | (0, 1) |
        """
        return tables.of_stages(self.stages, names, sections or {}, searches or {})

    def at(
        self,
        points: Mapping[str, ArrayLike] | ArrayLike,
        *quantity: str,
        water: fields.Shown | None = None,
        of: str | None = None,
        increments: bool = False,
    ) -> PointValues:
        """Return fields at points through all stages: histories.

        Parameters
        ----------
        points, quantity, water, of
            As of :meth:`StageResult.at`. Points that are dug away, or filled later, have NaN where
            no active body holds them, with a warning.
        increments
            With all increments that the stages keep, ``Stage(keep="all")``.

        Examples
        --------
        >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
        >>> import skfem_contact as sc
        >>> basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
        >>> block = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.), unit_weight=20.)
        >>> model = sc.Model({"block": block}, basis.get_dofs("bottom").all())
        >>> load = model.traction("top", (0., -10.))
        >>> result = model.run([sc.Stage("weight"), sc.Stage("load", load)])
        >>> print(result.at({"top": (.5, 1.)}, "uy"))
        histories
        stage   point    x  y     uy
        weight  top    0.5  1  -0.01
        load    top    0.5  1  -0.02
        """
        return through_stages(self.stages, points, quantity, water, of, increments)

    def report(self, file: str | Path, **options: Any) -> Path:
        """Write a report as one HTML file, see :func:`~skfem_contact.plot.report`."""
        from ..plot import report

        return report(self, file, **options)

    def save(self, file: str | Path) -> None:
        """Write all stages to one compressed file, from which :func:`load_result` resumes.

        The file gets the end ``.npz``. An older file is replaced once the new one is complete.
        """
        files.write(file, self.stages)

    def to_pvd(self, file: str | Path) -> list[Path]:
        """Write a ``.pvd`` series for ParaView and a ``.vtu`` file for each stage or increment.

        ``"dig.pvd"`` has the parts ``dig_0.vtu``, ``dig_1.vtu``, ... Its time is the time of the
        analysis where stages have a duration, otherwise a number. The names of the written files
        are returned, the series first.
        """
        parts: list[StageResult] = []
        for stage in self:
            parts += stage.increments or (stage,)
        return export.series(file, parts)

    def reset(self) -> Result:
        """Return the result with displacements counted from its end on; all forces stay.

        Contact has followed the bodies and comes back with them: under the same load the end is an
        equilibrium of the next stage.

        Raises
        ------
        ValueError
            A form without a ``rebased`` of its own changes its internal force.
        """
        # Set the displacements to zero, but at supports that are not solved for.
        last = self[-1]
        x = np.zeros_like(last.x)
        if last.layout is not None:
            x[last.layout.still] = last.x[last.layout.still]
        # Forms say how their states look without displacements.
        states = dict(last.states)
        for name, form in having(last.forms, Staged).items():
            states[name] = form.rebased(last.x, states[name])

        # Check that forms without a rule of their own keep their forces.
        scale = max_abs(last.load)
        for name, form in last.forms.items():
            if isinstance(form, Staged) and type(form).rebased is not Staged.rebased:
                continue
            before = form.assemble(last.x[: form.size], last.states[name]).force
            after = form.assemble(x[: form.size], states[name]).force
            change = max_abs(after - before)
            scale = max(scale, max_abs(before))
            if change > _SAME_FORCE * scale:
                raise ValueError(
                    f"the force of '{name}' changes by {change:.3g} when displacements are reset: "
                    f"give it "
                    "a method rebased(x, state) whose state has that force at zero displacements"
                )
        end = replace(last, x=x, states=states, placed={}, before=None)
        return Result((*self.stages[:-1], end))


def rows_of(result: Result) -> tuple[tuple[Any, ...], ...]:
    """Return the table of a result: name, figures and summary of each stage."""
    rows = []
    for stage in result:
        summary = []
        for name, text in stage.summary.items():
            if text:
                summary.append(f"{name}: {text}")
        rows.append(
            (
                stage.name,
                len(stage.iterations),
                sum(stage.iterations),
                f"{stage.residual:.1e}",
                f"{stage.fraction:.0%}",
                "; ".join(summary),
            )
        )
    return tuple(rows)


def load_result(
    file: str | Path, forms: Any, model_of: Callable[[Mesh], Any] | None = None
) -> Result:
    """Read a saved result, or increments that :class:`~skfem_contact.results.Append` has written.

    Parameters
    ----------
    file
        Name of the file, with or without the end ``.npz`` of :meth:`Result.save`.
    forms
        The model, or the forms of the analysis by the same names.
    model_of
        Function of a mesh that returns the model on it, as for
        :class:`~skfem_contact.Remeshing`: for files of runs with new meshes, which hold these.

    Raises
    ------
    ValueError
        The file is no result or damaged, another version of this library wrote it, or it holds
        other forms or meshes; it has new meshes, and `model_of` is missing.

    Examples
    --------
    >>> import os, tempfile
    >>> import skfem_contact as sc
    >>> file = os.path.join(tempfile.mkdtemp(), "empty.npz")
    >>> sc.results.Result(()).save(file)
    >>> len(sc.load_result(file, {}))
    0
    """
    return Result(files.read(file, forms, StageResult, model_of))


def of(
    model: Any,
    x: ndarray,
    states: States,
    *,
    load: ndarray | None = None,
) -> StageResult:
    """Return the result of an iteration of your own.

    Parameters
    ----------
    model
        The model, or its forms by name; those without a state are inactive.
    x : ndarray, shape (N,)
        Displacements.
    states
        States of the forms by name.
    load : ndarray, shape (N,), optional
        External forces, by default none.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> line = sc.rigid.line((-1., 0.), (2., 0.))
    >>> floor = sc.ContactPair(basis, "bottom", line, sc.Coulomb(mu=.3), "nodal", penalty=1e4)
    >>> x = basis.zeros()
    >>> x[basis.nodal_dofs[1]] = -1e-3
    >>> state = floor.assemble(x, floor.initial_state()).state
    >>> stage = sc.results.of({"floor": floor}, x, {"floor": state})
    >>> print(stage.contact("floor"))
    contact of bottom on obstacle: 2 stick, 0 slip, 0 open
      pressure           10   resultant on the slave (0, 10)
      friction            0   resultant on the slave (0, 0)
      friction over pressure at most 0.000, penetration at most 0.10% of a segment
    """
    given = as_forms(getattr(model, "forms", model))
    forms = {name: look_up(name, given, "form") for name in states}
    # Check numbers, sizes and states.
    x = np.array(finite(x, "the displacements"))
    if load is None:
        load = np.zeros_like(x)
    else:
        load = np.array(finite(load, "the load"))
    for name, form in forms.items():
        if np.ndim(x) != 1 or len(x) < (form.size or 0):
            raise ValueError(
                f"displacements of '{name}' have shape {np.shape(x)}, not ({form.size or 'N'},)"
            )
        if not fits(form, states[name]):
            raise ValueError(
                f"the state of '{name}' belongs to another form: {type(states[name]).__name__}"
            )
    return StageResult(
        name="state",
        x=x,
        load=load,
        states=states,
        iterations=(),
        residual=0.0,
        forms=forms,
        layout=getattr(model, "layout", None),
    )
