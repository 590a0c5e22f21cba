"""Contour pictures by pyvista."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy import ndarray

from ..errors import check_plane
from ..post.fields import Water, quantities, region_field, solids
from ..stages.result import Result, StageResult
from .marks import Marks
from .picture import FOOT, Frame, can_draw, finish
from .scales import Scale, bar_figure, make_scale
from .scene import Scene
from .units import labelled

Window = tuple[float, float, float, float]


class View(NamedTuple):
    """A stage that is drawn, the field on its nodes, and the name above it."""

    scene: Scene
    values: ndarray
    title: str


def contour(forms: Mapping[str, Any], step: StageResult, quantity: str, *, since: StageResult | None = None,
            deformed: float | Literal["auto"] = 0.0, limits: tuple[float, float] | None = None,
            window: Window | None = None, levels: int = 10, colors: str | None = None, mesh: bool = True,
            water: Water | None = None, supports: ndarray | None = None, loads: ndarray | None = None,
            vectors: bool = False, points: bool = False, contact: bool = False,
            file: str | Path | None = None, show: bool = False) -> Any:
    """Contour picture of a field on the bodies.

    The scale has round levels and zero is one of them; fields of both signs have two colours. Where a few nodes would
    make it much longer, at a singular corner, it ends before them with an arrow. Nothing is smeared over a contact or
    a border between materials.

    Parameters
    ----------
    forms
        Forms by name; the solids among them that are there in the stage are drawn.
    step
        A stage of the result of these forms.
    quantity
        A field of :func:`~skfem_contact.nodal_field`: ``"ux"``, ``"syy"``, ``"mises"``, ``"gamma"``, ...
    since
        An earlier stage: draw the change from there on.
    deformed
        Factor of the displacements, or ``"auto"``; the undeformed outline is drawn too.
    limits
        Values at the ends of the colour scale; by default those of the field, rounded.
    window
        Part to show, ``(xmin, xmax, ymin, ymax)``; by default everything.
    levels
        Number of bands, about.
    colors
        Name of a matplotlib colour map in place of ours.
    mesh
        Whether to draw the elements.
    water
        Draws the water table: the free surface of a :class:`~skfem_contact.Seepage`, or where the pore pressure, a
        function of places such as :func:`~skfem_contact.hydrostatic`, falls to zero.
    supports
        Fixed unknowns, as they were given to ``run``: drawn as triangles.
    loads
        A load vector (N,): its forces are drawn as arrows.
    vectors
        Whether to draw the displacements as arrows.
    points
        Whether to mark the integration points that yield, and those at their tensile strength.
    contact
        Whether to mark the contact points by their status and to draw the tractions between the bodies.
    file
        Name of a picture to write, ``.png``.
    show
        Open a window in which the picture can be moved; the plotter's ``export_html`` writes a page that can do so.

    Returns
    -------
    pyvista.Plotter or None
        The plotter, which a notebook shows as a picture, or None with a warning where this machine cannot draw:
        VTK needs OpenGL.

    Raises
    ------
    ValueError
        Unknown quantity, no solid among the forms is there in the stage, or bodies in three dimensions.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> import skfem_contact.plot as plot
    >>> basis = Basis(MeshQuad().refined(3).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> forms = {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=.3))}
    >>> stage = sc.Stage("weight", sc.weight(basis, 20.))
    >>> fixed = basis.get_dofs("bottom").all()
    >>> result = sc.run(forms, [stage], fixed)
    >>> picture = plot.contour(forms, result["weight"], "uy", deformed="auto", supports=fixed)
    """
    view = make_view(forms, step, quantity, since, deformed, water)
    marks = Marks(forms, step, since, water, supports, loads, vectors, points, contact)
    scale = make_scale(view.values, view.scene.area, limits, levels, colors)
    note = note_of(step, since, view.scene.factor)
    return draw([view], [marks], scale, headline(forms, quantity, since, water), note, window, mesh, file, show)


def stages(forms: Mapping[str, Any], result: Result | Sequence[StageResult], quantity: str, *,
           since: StageResult | None = None, deformed: float | Literal["auto"] = 0.0,
           limits: tuple[float, float] | None = None, window: Window | None = None, levels: int = 10,
           colors: str | None = None, mesh: bool = False, water: Water | None = None, points: bool = False,
           contact: bool = False, file: str | Path | None = None, show: bool = False) -> Any:
    """Contour pictures of several stages side by side on one scale; arguments as for :func:`contour`.

    Parameters
    ----------
    forms
        Forms by name; those that are there in a stage are drawn.
    result
        Result of these forms, or some stages of it: ``[result["dig"], result["filled"]]``.
    quantity, since, deformed, limits, window, levels, colors, mesh, water, points, contact, file, show
        As for :func:`contour`; an automatic factor of the displacements is that of the stage that has moved most.

    Examples
    --------
    >>> from skfem_contact.demo import culvert
    >>> import skfem_contact.plot as plot
    >>> model = culvert()
    >>> picture = plot.stages(model.forms, model.result, "syy", window=(-3., 3., -3., 2.))
    """
    chosen = list(result)
    if not chosen:
        raise ValueError("there is no stage to draw")
    views = [make_view(forms, step, quantity, since, deformed, water) for step in chosen]
    if deformed == "auto":
        factor = min(view.scene.factor for view in views)
        views = [make_view(forms, step, quantity, since, factor, water) for step in chosen]
    marks = [Marks(forms, step, since, water, points=points, contact=contact) for step in chosen]
    scale = make_scale(np.concatenate([view.values for view in views]), np.concatenate([v.scene.area for v in views]),
                       limits, levels, colors)
    note = _and_factor("", views[0].scene.factor)
    return draw(views, marks, scale, headline(forms, quantity, since, water), note, window, mesh, file, show)


def make_view(forms: Mapping[str, Any], step: StageResult, quantity: str, since: StageResult | None,
              deformed: float | Literal["auto"], water: Water | None) -> View:
    """The bodies of a stage and the field on their nodes."""
    check_plane(next(iter(solids(forms).values())).basis, "plot.contour")
    values = region_field(forms, step, quantity, since, water)
    return View(Scene(forms, step, deformed, since), values, _name(step, since))


def note_of(step: StageResult, since: StageResult | None, factor: float) -> str:
    """What stands on the right above the colour bar: the stage, and how much its displacements are enlarged."""
    return _and_factor(_name(step, since), factor)


def _name(step: StageResult, since: StageResult | None) -> str:
    return step.name if since is None else f"{step.name}, since {since.name}"


def headline(forms: Mapping[str, Any], quantity: str, since: StageResult | None, water: Water | None = None) -> str:
    """What the colour bar shows, with its unit."""
    what = quantities(solids(forms), water)[quantity]
    title = labelled(what.title, what.unit)
    return f"Change of {title}" if since is not None else title[0].upper() + title[1:]


def draw(views: Sequence[View], marks: Sequence[Marks], scale: Scale, title: str, note: str, window: Window | None,
         mesh: bool, file: str | Path | None, show: bool) -> Any:
    """Draw views on one sheet, with the colour bar below them, its title on the left and a note on the right."""
    able, show = can_draw(f"'{title}'", show)
    if not able:
        return None
    seen = np.concatenate([view.scene.seen for view in views])
    frame = Frame(seen, window, len(views), len(views) > 1, max(mark.room for mark in marks))
    plotter = frame.sheet(show)
    paint(plotter, frame, views, marks, scale, mesh)
    legend = {label: style for mark in marks for label, style in mark.legend()}
    frame.put_foot(plotter, bar_figure(scale, title, note, (frame.size[0], FOOT), legend))
    return finish(plotter, file, show)


def paint(plotter: Any, frame: Frame, views: Sequence[View], marks: Sequence[Marks], scale: Scale, mesh: bool) -> None:
    """Draw the bodies of all views and what is marked on them."""
    for number, (view, mark) in enumerate(zip(views, marks, strict=True)):
        frame.aim(plotter, number, view.title)
        view.scene.pixel = frame.pixel
        view.scene.draw_field(plotter, view.values, scale)
        view.scene.draw_lines(plotter, mesh, undeformed=view.scene.factor != 0.0)
        mark.draw(plotter, view.scene)
        plotter.renderer.ResetCameraClippingRange()


def _and_factor(note: str, factor: float) -> str:
    """The note with the factor of the displacements, where they are enlarged."""
    enlarged = f"displacements × {factor:g}" if factor not in (0.0, 1.0) else ""
    return ", ".join(text for text in (note, enlarged) if text)
