"""Stages of an analysis, as a user gives them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike

from ..checks import is_number
from ..dynamics.record import Record
from ..dynamics.settings import Dynamic
from ..forms.base import Forms
from ..results.fields import Water

#: Load on top of the weights: a vector, several of them, or a function of the share of the stage.
Force = ndarray | Sequence[ndarray] | None
LoadLike = Force | Callable[[float], ndarray]
#: Water at rest: see :class:`Stage`.
AtRest = Water | ArrayLike | Mapping[str, Any] | Literal[False] | None


@dataclass(frozen=True)
class Stage:
    """A stage of the analysis.

    Parameters
    ----------
    name
        Its name in the result.
    load
        External forces at its end, (N,), or several such vectors: the whole load, not the
        increment. The weight of active bodies with a ``unit_weight`` and the pressure of `water`
        come on top. A function of the share of the stage, 0 to 1, that returns a vector, gives the
        load on the way as well. Where its first load is not the load before, the difference is a
        jump at the start, with a warning. The jump takes increments of its own, in hardly any time,
        and `keep` leaves them out.
        In a stage with `dynamic` a function is of the time since its start, and a vector acts from
        its start on.
    prescribed
        Displacements at its end, (N,), of which the values at the fixed dofs count. By default they
        stay as they are. A function of the share of the stage, 0 to 1, gives them on the way as
        well, as for a body that is turned; in a stage with `dynamic` it is of the time since its
        start. It begins with the displacements before.
    increments
        Number of increments to begin with; they are cut where Newton fails and grow where it is
        easy.
    activate
        Names of forms that become active; they are inactive before. Solids start stress-free in the
        deformed ground: nodes that they share with it are where it has brought them, the others
        follow. Water starts without excess pressure where none was active. Contact starts without
        traction, with the gaps of the mesh; but where it replaces a pair between the same surfaces
        that is deactivated in this stage, it takes over its tractions.
    deactivate
        Names of forms that become inactive. Their forces are released in proportion over the stage.
    change
        Forms that are replaced from this stage on, with other materials (``form.with_materials``)
        or another law (``pair.with_law``). They continue the states of the old ones.
    fixed
        Supported dofs from this stage on; by default those of the stage before. Reactions that are
        lost are released in proportion over the stage. Where it opens a drain the excess pressure
        falls to zero at once, unless `prescribed` is given.
    duration
        Time that the stage takes, for forms to which it matters (:meth:`Form.over`); load and
        prescribed displacements go from their last values to those of the stage in proportion to
        it. Beside :class:`PoreWater` increments are cut and grow with their estimated error in
        time, too.
    water
        Water at rest from this stage on: its level, points of it (x, height), levels by region, a
        seepage, pressures at the vertices, or a function of the coordinates. Below a level or a
        line the pressure is hydrostatic, the unit weight times the vertical depth. It acts in the
        pores of all active bodies and presses on all of their boundaries, both sides of contacts
        included. By default that of the stage before; ``False``: none.
    release
        Share of the forces of deactivated bodies and lost supports that is released in this stage,
        0 to 1; a later stage releases the rest. By default 1, in a stage with `dynamic` 0: supports
        that waves are to pass are taken away, and their reactions stay as loads.
    keep
        Increments that the result keeps besides the end: ``"last"``: none; ``"all"``; n: every n-th
        one.
    dynamic
        Inertia and damping in the stage, and its step in time, see :class:`Dynamic`. It starts from
        the state of any stage. A stage without it starts from rest.
    base
        :class:`Record` of the motion of the supports in a stage with `dynamic`, along x, or records
        by axis, ``{"x": record, "y": other}``. Displacements are then relative to the supports, and
        every mass feels the acceleration of the base with the opposite sign. The base is at rest
        after the end of a record.
    arc_length
        True for a path that is followed beyond limit points, where the load falls and rises again:
        increments have a length along the path and change the load by a share of ``1 / increments``
        at most. The stage ends where its whole load is first reached; ``keep="all"`` keeps the
        path, with the share of the load of each increment as its `fraction`. For vectors `load` and
        `prescribed` in stages without time, `dynamic` and pore water.

    Notes
    -----
    Nodes of inactive bodies stay where they are, and no load may act on them.

    Examples
    --------
    A column on which a layer is placed, and from which it is taken away again:

    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> mesh = MeshQuad().refined(1).with_defaults().with_subdomains({
    ...     "ground": lambda x: x[1] < .5, "fill": lambda x: x[1] > .5})
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> soil = sc.LinearElastic(E=1e3, nu=0.)
    >>> forms = {name: sc.SolidForm(basis.with_elements(name), soil, unit_weight=20.)
    ...          for name in ("ground", "fill")}
    >>> stages = [sc.Stage("ground"), sc.Stage("filled", activate="fill"),
    ...           sc.Stage("cleared", deactivate="fill")]
    >>> result = sc.Model(forms, basis.get_dofs("bottom").all()).run(stages)
    >>> surface = basis.nodal_dofs[1, mesh.p[1] == .5]
    >>> [float(f"{stage.x[surface][0]:.6f}") for stage in result]
    [-0.0025, -0.0075, -0.0025]
    """

    name: str
    load: LoadLike = None
    prescribed: ndarray | Callable[[float], ndarray] | None = None
    increments: int = 1
    activate: str | Sequence[str] = ()
    deactivate: str | Sequence[str] = ()
    change: Forms = field(default_factory=dict)
    fixed: ndarray | Sequence[Any] | None = None
    duration: float = 0.0
    water: AtRest = None
    release: float | None = None
    keep: Literal["last", "all"] | int = "last"
    dynamic: Dynamic | None = None
    base: Record | Mapping[str, Record] | None = None
    arc_length: bool = False

    @property
    def released(self) -> float:
        """Share of lost forces that is released in the stage."""
        if self.release is None:
            if self.dynamic is None:
                return 1.0
            return 0.0
        return self.release


def checked(stages: Sequence[Stage], before: Sequence[str]) -> Sequence[Stage]:
    """Return the stages; refuse stages without names of their own or proper numbers."""
    if not stages:
        raise ValueError("there is no stage to run")
    known = set(before)
    for stage in stages:
        if stage.name in known:
            which = "two stages are named"
            if stage.name in before:
                which = "the start has a stage of the name"
            raise ValueError(f"{which} '{stage.name}'")
        known.add(stage.name)
        _check_numbers(stage)
    return stages


def _check_numbers(stage: Stage) -> None:
    """Check increments, duration, release and keep of a stage."""
    # Check each number.
    where = f"stage '{stage.name}'"
    if not isinstance(stage.increments, (int, np.integer)) or stage.increments < 1:
        raise ValueError(
            f"{where}: increments must be at least 1 and whole, not {stage.increments!r}"
        )
    if stage.duration != 0.0 and not is_number(stage.duration, 0.0, np.inf):
        raise ValueError(
            f"{where}: the duration must not be negative, but finite, unlike {stage.duration!r}"
        )
    if stage.release not in (None, 0.0, 1.0) and not is_number(stage.release, 0.0, 1.0):
        raise ValueError(f"{where}: release must be a share between 0 and 1, not {stage.release!r}")
    # Keep the last increment, all, or each of a number.
    every = isinstance(stage.keep, (int, np.integer)) and stage.keep >= 1
    if stage.keep not in ("last", "all") and not every:
        raise ValueError(
            f"{where}: keep must be 'last', 'all' or a whole number, not {stage.keep!r}"
        )
    if stage.dynamic is None:
        _check_static(stage, where)
    else:
        _check_time(stage, stage.dynamic, where)


def _check_static(stage: Stage, where: str) -> None:
    """Refuse motion in a stage without inertia, and paths of given times."""
    if stage.base is not None:
        raise ValueError(f"{where}: a base moves in a stage with `dynamic` alone")
    if not stage.arc_length:
        return
    if stage.duration:
        raise ValueError(
            f"{where}: a path along which the load falls has no duration: give no `duration`, or "
            "no `arc_length`"
        )
    for what, given in (("load", stage.load), ("prescribed", stage.prescribed)):
        if callable(given):
            raise ValueError(
                f"{where}: with `arc_length` the load follows from the path: give `{what}` as a "
                "vector, not as a function"
            )


def _check_time(stage: Stage, dynamic: Dynamic, where: str) -> None:
    """Check the duration and the step of a stage with inertia."""
    if not stage.duration > 0.0:
        raise ValueError(f"{where}: a dynamic stage takes time: give it a duration")
    if dynamic.step is not None and dynamic.step > stage.duration * (1.0 + 1e-9):
        raise ValueError(
            f"{where}: the step in time, {dynamic.step:g}, is longer than the stage, "
            f"{stage.duration:g}"
        )
    if stage.arc_length:
        raise ValueError(
            f"{where}: bodies with inertia pass a limit point in time: give `dynamic` or "
            "`arc_length`, not both"
        )
    if stage.increments != 1:
        raise ValueError(
            f"{where}: give no increments: the steps of a dynamic stage follow from "
            "Dynamic(step=...)"
        )
