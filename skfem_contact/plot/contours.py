"""Contour pictures by pyvista: of a stage, of several side by side, and films of them."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy import ndarray

from ..errors import check_plane
from ..results.fields import Water, basis_of, quantities, region_field
from ..results.result import Result, StageResult
from .marks import Marks
from .picture import Frame, can_draw, finish
from .scales import Scale, make_scale
from .scene import Scene
from .units import labelled

Window = tuple[float, float, float, float]

_FRAMES_A_SECOND, _WIDTH = 12, 960  # of films


class View(NamedTuple):
    """The bodies of a stage, the field on their nodes, the name above them, and what is marked on them."""

    scene: Scene
    values: ndarray
    title: str
    marks: Marks


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
        A field of :meth:`~skfem_contact.results.StageResult.field`: ``"ux"``, ``"syy"``, ``"mises"``, ``"gamma"``, ...
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
    >>> result = sc.Model(forms, fixed).run([stage])
    >>> picture = plot.contour(forms, result["weight"], "uy", deformed="auto", supports=fixed)
    """
    views = _views(forms, [step], quantity, since, deformed, water, supports=supports, loads=loads, vectors=vectors,
                   points=points, contact=contact)
    scale, title = _scale(views, limits, levels, colors), headline(step, quantity, since, water)
    return draw(views, scale, title, note_of(views[0].title, views[0].scene.factor), window, mesh, file, show)


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
    views = _views(forms, list(result), quantity, since, deformed, water, points=points, contact=contact)
    scale, title = _scale(views, limits, levels, colors), headline(result[-1], quantity, since, water)
    return draw(views, scale, title, note_of("", views[0].scene.factor), window, mesh, file, show)


def animate(forms: Mapping[str, Any], result: Result | Sequence[StageResult], quantity: str, file: str | Path, *,
            since: StageResult | None = None, deformed: float | Literal["auto"] = 0.0,
            limits: tuple[float, float] | None = None, window: Window | None = None, levels: int = 10,
            colors: str | None = None, mesh: bool = False, frames: int = 16) -> Path | None:
    """Write a film of the stages, ``.gif`` or ``.mp4``, all of them on one scale.

    Between stages that hold the same bodies, displacements and the field go over linearly.

    Parameters
    ----------
    forms, result, quantity
        As for :func:`stages`.
    file
        Name of the film; MP4 needs ``imageio-ffmpeg``, GIF ``imageio``.
    since, deformed, limits, window, levels, colors, mesh
        As for :func:`contour`.
    frames
        Pictures for each stage, twelve a second; in the first half of them the bodies move.

    Returns
    -------
    Path or None
        The file, or None with a warning where this machine cannot draw.
    """
    file = Path(file)
    if file.suffix not in (".gif", ".mp4"):
        raise ValueError(f"a film is a .gif or an .mp4 file, not '{file.name}'")
    views = _views(forms, list(result), quantity, since, deformed)
    scale = _scale(views, limits, levels, colors)
    if not can_draw(f"'{quantity}'")[0]:
        return None
    frame = Frame(np.concatenate([view.scene.seen for view in views]), window, titled=True, width=_WIDTH)
    frame.make_even()
    plotter = frame.sheet(False)
    if file.suffix == ".gif":
        plotter.open_gif(str(file), fps=_FRAMES_A_SECOND)
    else:
        plotter.open_movie(str(file), framerate=_FRAMES_A_SECOND)
    frame.put_foot(plotter, scale, headline(result[-1], quantity, since))
    for first, last in zip([views[0], *views], views):
        moving = _between(first, last, frames // 2)
        for view in moving:
            plotter.renderer.clear_actors()
            _paint(plotter, frame, [view], scale, mesh)
            plotter.write_frame()
        for _ in range(frames - len(moving)):
            plotter.write_frame()
    plotter.close()
    return file


def _between(first: View, last: View, n: int) -> list[View]:
    """Views on the way from one stage to the next; one where the bodies are others."""
    if first is last or not np.array_equal(first.scene.nodes, last.scene.nodes):
        return [last]
    return [last._replace(scene=last.scene.between(first.scene, share),
                          values=(1.0 - share) * first.values + share * last.values)
            for share in np.arange(1, n + 1) / n]


def _views(forms: Mapping[str, Any], steps: Sequence[StageResult], quantity: str, since: StageResult | None,
           deformed: float | Literal["auto"], water: Water | None = None, **marks: Any) -> list[View]:
    """The bodies and the field of every stage; an automatic factor is that of the stage that has moved most."""
    if not steps:
        raise ValueError("there is no stage to draw")
    check_plane(basis_of(steps[0]), "plot.contour")
    views = [View(Scene(forms, step, deformed, since), region_field(step, quantity, since, water),
                  name_of(step, since), Marks(forms, step, water, **marks)) for step in steps]
    factors = [view.scene.factor for view in views if view.scene.displacement[view.scene.nodes].any()]
    for view in views:
        view.scene.factor = min(factors, default=view.scene.factor)
    return views


def _scale(views: Sequence[View], limits: tuple[float, float] | None, levels: int, colors: str | None) -> Scale:
    """One scale for all views."""
    return make_scale(np.concatenate([view.values for view in views]), np.concatenate([v.scene.area for v in views]),
                      limits, levels, colors)


def name_of(step: StageResult, since: StageResult | None) -> str:
    """The name of a stage, or of what has changed until then."""
    return step.name if since is None else f"{step.name}, since {since.name}"


def note_of(name: str, factor: float) -> str:
    """What stands on the right above the colour bar: a stage, and how much its displacements are enlarged."""
    enlarged = f"displacements × {factor:g}" if factor not in (0.0, 1.0) else ""
    return ", ".join(text for text in (name, enlarged) if text)


def headline(step: StageResult, quantity: str, since: StageResult | None, water: Water | None = None) -> str:
    """What the colour bar shows, with its unit."""
    what = quantities(step, water)[quantity]
    title = labelled(what.title, what.unit)
    return f"Change of {title}" if since is not None else title[0].upper() + title[1:]


def draw(views: Sequence[View], scale: Scale, title: str, note: str, window: Window | None, mesh: bool,
         file: str | Path | None, show: bool) -> Any:
    """Draw views on one sheet, with the colour bar below them, its title on the left and a note on the right."""
    able, show = can_draw(f"'{title}'", show)
    if not able:
        return None
    seen = np.concatenate([view.scene.seen for view in views])
    frame = Frame(seen, window, len(views), len(views) > 1, max(view.marks.room for view in views))
    plotter = frame.sheet(show)
    _paint(plotter, frame, views, scale, mesh)
    legend = {label: style for view in views for label, style in view.marks.legend()}
    frame.put_foot(plotter, scale, title, note, legend)
    return finish(plotter, file, show)


def _paint(plotter: Any, frame: Frame, views: Sequence[View], scale: Scale, mesh: bool) -> None:
    """Draw the bodies of all views and what is marked on them."""
    for number, view in enumerate(views):
        frame.aim(plotter, number, view.title)
        view.scene.pixel = frame.pixel
        view.scene.draw_field(plotter, view.values, scale)
        view.scene.draw_lines(plotter, mesh, undeformed=view.scene.factor != 0.0)
        view.marks.draw(plotter, view.scene)
        plotter.renderer.ResetCameraClippingRange()
