"""Runs that continue by themselves with new meshes of bodies that flow."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import MISSING, Field, dataclass, fields, replace
from typing import Any, Literal

import numpy as np
import scipy
from numpy import ndarray
from skfem import Mesh

from ..arrays import max_abs
from ..errors import NotConverged, Remarks
from ..forms.base import solids_of
from ..forms.solid import sharpened
from ..results.result import Result
from ..results.stage import StageResult
from . import run as one_mesh
from .remeshing import check_memory, mesh_of, remeshed, size_field
from .run import Observer
from .setup import Setup
from .stage import Stage, checked

#: Corners within these degrees of a straight line ask for a new mesh, twice those of the remark on
#: them.
_CORNER = 20.0
#: What a stage may give beside a new mesh: all else belongs to the nodes or elements of one mesh.
_ALLOWED = ("name", "prescribed", "increments", "duration", "keep")
#: Difference of displacements along a boundary that is round-off, as a share of the largest one.
_EVEN = 1e-12


@dataclass(frozen=True)
class Remeshing:
    """New meshes for a run, ``model.run(stages, remesh=Remeshing(model_of, size))``.

    Before a stage the deformed bodies get a new mesh by :func:`~skfem_contact.remeshed`, and the
    run continues on its model. A stage that fails on a mesh that has been deformed begins anew on a
    new one.

    Parameters
    ----------
    model_of
        Function of a mesh that returns the :class:`~skfem_contact.Model` on it, with forms of the
        same names and the same supports.
    size
        Size of the elements: a number, or a function of coordinates (2, n) that returns (n,).
    every
        New mesh after so many stages; by default where corners of elements are within 20 degrees
        of a straight line.
    order
        2: curved triangles; 1: straight ones.

    Notes
    -----
    The stages give displacements of supports on the mesh of the model that runs, from its start
    on. New supports take them over along each boundary. ``stage.x`` counts from the last
    new mesh, whose stage ``"mesh 1"``, ``"mesh 2"``, ... is among the stages of the result, with
    the shares of volume, stress and balance that are lost in its ``series["loss"]``, see
    :meth:`Remeshed.loss <skfem_contact.stages.remeshing.Remeshed.loss>`.
    Files of such results hold the meshes: ``load_result(file, model, model_of)`` reads them, and
    ``model.run(left, start=result, remesh=remesh)`` continues with the stages that are left.

    Examples
    --------
    A block is sheared twice as far, with a new mesh on half of the way:

    >>> import numpy as np
    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> def model_of(mesh):
    ...     basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
    ...     clay = sc.Tresca(E=100., nu=.49, c=1.)
    ...     forms = {"block": sc.SolidForm(basis, clay, kinematics="finite")}
    ...     return sc.Model(forms, basis.get_dofs(["bottom", "top"]).all())
    >>> model = model_of(MeshTri().refined(2).with_defaults())
    >>> stages = []
    >>> for way in (.25, .5):
    ...     u = np.zeros(model.layout.size)
    ...     u[model.forms["block"].basis.get_dofs("top").all("u^1")] = way
    ...     stages.append(sc.Stage(f"{way}", prescribed=u, increments=2))
    >>> result = model.run(stages, remesh=sc.Remeshing(model_of, size=.25, every=1))
    >>> [stage.name for stage in result]
    ['0.25', 'mesh 1', '0.5']
    >>> round(float(result["0.5"].x.max()), 3)
    0.25
    """

    model_of: Callable[[Mesh], Setup]
    size: float | Callable[[ndarray], ndarray]
    every: int | None = None
    order: Literal[1, 2] = 2

    def __post_init__(self) -> None:
        whole = isinstance(self.every, (int, np.integer)) and self.every >= 1
        if self.every is not None and not whole:
            raise ValueError(f"every must be a whole number of stages, not {self.every!r}")
        size_field(self.size)

    def due(self, last: StageResult, n_stages: int) -> bool:
        """Return True if the bodies need a new mesh, n_stages after the last one."""
        if self.every is not None:
            return n_stages >= self.every
        sharpest = [sharpened(form, last.x).min() for form in solids_of(last.forms).values()]
        return bool(np.min(sharpest) < np.sin(np.radians(_CORNER)))


def run(
    setup: Setup,
    stages: Sequence[Stage],
    *,
    start: Result | StageResult | None = None,
    on_increment: Observer | None = None,
    progress: bool | None = None,
    remesh: Remeshing | None = None,
) -> Result:
    """Run stages one after the other.

    Parameters
    ----------
    stages
        Stages in their order.
    start
        Result, or one stage, to continue from, with the changes by its stages; forms it lacks
        are inactive.
    on_increment
        Function of every accepted increment, a :class:`StageResult`, such as
        ``sc.results.Append(file)``; of the first state on a new mesh, too.
    progress
        Show a progress bar; by default where the output is a terminal.
    remesh
        New meshes of the deformed bodies between stages, see :class:`~skfem_contact.Remeshing`.

    Returns
    -------
    Result
        The stages of ``start``, if any, and the new ones.

    Raises
    ------
    ValueError
        Bad input, before anything is computed: sizes, NaN, unknown or repeated names, a body
        that nothing holds.
    NotConverged
        With the partial result, whose last entry is the last increment that was accepted. So has
        every error that ends a run, as its attribute ``result``: of an observer, a law or a
        solver, and the ``KeyboardInterrupt`` of a run that is stopped by hand.

    Warns
    -----
    AnalysisWarning
        Remarks of the forms on their states, each kind once; stages and supports that change
        nothing.
    """
    if remesh is None:
        return one_mesh.run(
            setup, stages, start=start, on_increment=on_increment, progress=progress
        )
    # Check all stages before the first one.
    _check(setup, stages)
    done = [start] if isinstance(start, StageResult) else list(start or ())
    checked(stages, [stage.name for stage in done])
    way = _Way(remesh, setup, list(stages), done, on_increment, progress)
    try:
        with Remarks() as remarks:
            way.follow(remarks)
    except BaseException as error:
        if getattr(error, "result", None) is None:
            error.result = Result(tuple(way.done))  # type: ignore[attr-defined]
        raise
    return Result(tuple(way.done))


class _Way:
    """Stages that are done and left, with the model on the present mesh.

    Attributes
    ----------
    used
        Number of stages on the present mesh.
    """

    def __init__(
        self,
        remesh: Remeshing,
        model: Setup,
        stages: list[Stage],
        done: list[StageResult],
        on_increment: Observer | None,
        progress: bool | None,
    ) -> None:
        self.model = model
        self.left = stages
        self.done = done
        self.used = 0
        self._remesh = remesh
        self._on_increment = on_increment
        self._progress = progress
        self._n_meshes = 0
        # Follow the new meshes of a run that continues: the model is on the mesh that it began with
        for number, stage in enumerate(done):
            self.used += bool(stage.iterations)
            if stage.new_mesh is not None:
                self._n_meshes += 1
                if number:
                    self._go_on(self._model_on(stage.new_mesh), done[number - 1])
        if done and len(done[-1].x) != self.model.layout.size:
            raise ValueError(
                f"the start '{done[-1].name}' has {len(done[-1].x)} dofs, the model "
                f"{self.model.layout.size}: give the whole result, whose stages hold the meshes, "
                "and the model of the first one"
            )

    def add(self, result: Result) -> None:
        """Take the stages that are done so far."""
        self.done = list(result)
        self.left = self.left[1:]
        self.used += 1

    def follow(self, remarks: Remarks) -> None:
        """Run the stages that are left."""
        while self.left:
            if self.used and self._remesh.due(self.done[-1], self.used):
                self.renew()
            try:
                part = one_mesh.run(
                    self.model,
                    self.left[:1],
                    start=Result(tuple(self.done)),
                    on_increment=self._on_increment,
                    progress=self._progress,
                    remarks=remarks,
                )
                self.add(part)
            except NotConverged:
                # Begin anew on a new mesh, if the elements have been deformed.
                if not self.used:
                    raise
                self.renew()

    def renew(self) -> None:
        """Continue on a new mesh of the deformed bodies."""
        last = self.done[-1]
        self._n_meshes += 1
        new = remeshed(last, self._remesh.size, order=self._remesh.order)
        model = self._model_on(new.mesh)
        start = new.start(model, name=f"mesh {self._n_meshes}")
        self._go_on(model, last)
        self.done.extend(start)
        if self._on_increment is not None:
            self._on_increment(start[-1])

    def _model_on(self, mesh: Mesh) -> Setup:
        """Return the model on a new mesh."""
        return _checked(self._remesh.model_of(mesh), self.model)

    def _go_on(self, model: Setup, last: StageResult) -> None:
        """Continue on the model of a new mesh of a stage."""
        self.left = _carried(self.model, model, self.left, last)
        self.model = model
        self.used = 0


def _check(model: Setup, stages: Sequence[Stage]) -> None:
    """Refuse stages that give more than another mesh can take over."""
    for stage in stages:
        given = []
        for part in fields(stage):
            value = getattr(stage, part.name)
            if part.name not in _ALLOWED and not _is_default(value, part):
                given.append(part.name)
        if callable(stage.prescribed):
            given.append("prescribed as a function")
        if given:
            raise ValueError(
                f"stage '{stage.name}' gives {', '.join(given)}, which new meshes do not take "
                "over: give displacements as vectors and increments alone beside remesh=, or "
                "continue by remeshed(stage, size)"
            )
        if stage.prescribed is not None:
            model.vector(stage.prescribed, f"stage '{stage.name}': the prescribed displacement")
        if re.fullmatch(r"mesh \d+", stage.name):
            raise ValueError(f"stage '{stage.name}' has the name of a new mesh: take another one")
    _check_fields(model)
    check_memory(model.forms, {key: form.initial_state() for key, form in model.forms.items()})
    mesh_of(solids_of(model.forms), "the model")
    _Supports.of(model, np.zeros(model.layout.size)).check()


def _is_default(value: Any, part: Field[Any]) -> bool:
    """Return True if a part of a stage is not given."""
    default = part.default
    if part.default_factory is not MISSING:
        default = part.default_factory()
    plain = isinstance(value, (bool, int, float, str, tuple, dict, type(None)))
    return plain and bool(value == default)


def _check_fields(model: Setup) -> None:
    """Refuse dofs besides displacements."""
    if len(model.layout.fields) > 1:
        names = [str(one.name) for one in model.layout.fields[1:]]
        raise ValueError(f"new meshes do not take over dofs besides displacements: {names}")


def _checked(after: Any, before: Setup) -> Setup:
    """Return the model on a new mesh, if its forms have the names of the old one."""
    if not isinstance(after, Setup):
        raise ValueError(f"model_of must return a Model, not {type(after).__name__}")
    if set(after.forms) != set(before.forms):
        raise ValueError(
            f"model_of returns a model of the forms {sorted(after.forms)}, unlike "
            f"{sorted(before.forms)} before"
        )
    _check_fields(after)
    return after


def _carried(
    before: Setup, after: Setup, stages: Sequence[Stage], last: StageResult
) -> list[Stage]:
    """Return stages with displacements of the supports of a new mesh, counted from now on."""
    old = _Supports.of(before, last.x)
    new = _Supports.of(after, np.zeros(after.layout.size))
    result = []
    for stage in stages:
        given = stage.prescribed
        if given is not None:
            way = np.asarray(given, float) - last.x
            given = new.along(old, way)
        result.append(replace(stage, prescribed=given))
    return result


@dataclass
class _Supports:
    """Fixed dofs by boundary and axis, and where their nodes are.

    Attributes
    ----------
    groups
        Dofs of boundaries that are held, and the positions of their nodes, (n, 2), by boundary and
        axis.
    size
        Number of dofs.
    fixed
        All fixed dofs.
    """

    groups: dict[tuple[str, int], tuple[ndarray, ndarray]]
    size: int
    fixed: ndarray

    @classmethod
    def of(cls, model: Setup, x: ndarray) -> _Supports:
        """Return the supports of a model that is displaced by x, (N,)."""
        basis = next(iter(solids_of(model.forms).values())).basis
        groups = {}
        for name in basis.mesh.boundaries or {}:
            found = basis.get_dofs(name)
            axes = np.array([found.all("u^1"), found.all("u^2")])  # (2, n)
            places = basis.doflocs[:, axes[0]] + x[axes]
            for axis in (0, 1):
                if np.isin(axes[axis], model.fixed).all():
                    groups[name, axis] = axes[axis], places.T
        return cls(groups, model.layout.size, np.asarray(model.fixed))

    def along(self, old: _Supports, way: ndarray) -> ndarray:
        """Return displacements, (N,), that follow the ways of old supports along boundaries."""
        result = np.zeros(self.size)
        known = np.zeros(self.size, bool)
        for key, (dofs, places) in self.groups.items():
            if key in old.groups:
                before, at = old.groups[key]
                result[dofs] = _between(at, way[before], places)
                known[dofs] = True
        self._check_known(known)
        return result

    def check(self) -> None:
        """Refuse supports that are not whole boundaries."""
        known = np.zeros(self.size, bool)
        for dofs, _ in self.groups.values():
            known[dofs] = True
        self._check_known(known)

    def _check_known(self, known: ndarray) -> None:
        unknown = int((~known[self.fixed]).sum())
        if unknown:
            raise ValueError(
                f"{unknown} supported dofs lie on no boundary that is held as a whole before and "
                "after a new mesh: hold named boundaries"
            )


def _between(at: ndarray, values: ndarray, places: ndarray) -> ndarray:
    """Return values at points (n, 2), linear between the two nearest points of a boundary."""
    spread = float(np.ptp(values))
    if len(values) < 2 or spread <= _EVEN * max_abs(values):
        return np.full(len(places), values[0])
    nearest = np.asarray(scipy.spatial.cKDTree(at).query(places, 2)[1])
    first, second = at[nearest[:, 0]], at[nearest[:, 1]]
    along = second - first
    share = ((places - first) * along).sum(axis=1) / (along**2).sum(axis=1)
    return np.asarray((1.0 - share) * values[nearest[:, 0]] + share * values[nearest[:, 1]])
