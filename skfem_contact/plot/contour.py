"""Contour pictures by pyvista: of a stage, of several side by side, films, and bodies cut open."""

from __future__ import annotations

from collections.abc import Callable, Collection, Container, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy import ndarray

from ..checks import check_basis, check_plane, look_up, names_of
from ..forms.roles import materials_of
from ..results.fields import Shown, basis_of, quantities, region_field, solids
from ..results.result import Result
from ..results.stage import StageResult
from ..results.tables import located
from ..units import labelled
from .marks import Marks
from .scene import Cut, Cutaway, Scene
from .sheet import Frame, Scale, Window, can_draw, capitalised, finish, make_scale

#: Pictures a second, and width in pixels, of films.
_FRAMES_A_SECOND = 12
_WIDTH = 960


def contour(
    stage: StageResult,
    quantity: str,
    *,
    since: StageResult | None = None,
    deformed: float | Literal["auto"] | None = None,
    limits: tuple[float, float] | None = None,
    window: Window | None = None,
    levels: int = 10,
    colors: str | None = None,
    mesh: bool = True,
    bodies: str | Iterable[str] | None = None,
    water: Shown | None = None,
    supports: ndarray | None = None,
    loads: ndarray | None = None,
    vectors: bool = False,
    points: bool = False,
    contact: bool = False,
    file: str | Path | None = None,
    show: bool = False,
) -> Any:
    """Draw contours of a field on plane bodies.

    The scale has round levels and zero is one of them; fields of both signs have two colours. Where
    a few nodes would make it much longer, at a singular corner, it ends before them with an arrow.
    Nothing is smeared over a contact or a border between materials.

    Parameters
    ----------
    stage
        Stage of a result; its active solids are drawn.
    quantity
        Field of :meth:`~skfem_contact.results.StageResult.field`: ``"ux"``, ``"syy"``, ``"mises"``,
        ``"gamma"``, ...
    since
        Earlier stage: draw the change since then.
    deformed
        Factor of the displacements, or ``"auto"``; the undeformed outline is drawn too. By default
        bodies of finite kinematics are drawn as they are, others undeformed.
    limits
        Values at the ends of the colour scale; by default the rounded extremes of the field.
    window
        Part to show, ``(xmin, xmax, ymin, ymax)``; by default everything.
    levels
        Number of bands, about.
    colors
        Name of a matplotlib colour map; by default the map depends on the signs.
    mesh
        Draw the elements.
    bodies
        Names of the solids to draw; by default all.
    water
        Draw the water table of water as of a :class:`~skfem_contact.Stage`: a level, a line of
        points, water by region, the free surface of a :class:`~skfem_contact.Seepage`, or the line
        on which a pressure, a function of coordinates, falls to zero; True: the stage's own water;
        False: none.
    supports
        Fixed dofs, drawn as triangles.
    loads : ndarray, (N,)
        Load vector, drawn as arrows.
    vectors
        Draw the displacements as arrows.
    points
        Mark the integration points that yield or have reached the tensile strength.
    contact
        Mark the contact points by their status and draw the tractions between the bodies.
    file
        Name of a picture to write, ``.png``.
    show
        Open a window in which the picture can be moved; ``export_html`` of the plotter writes a
        page with such a picture.

    Returns
    -------
    pyvista.Plotter or None
        Plotter, which a notebook shows as a picture, or None with a warning where this machine
        cannot draw: VTK needs OpenGL.

    Raises
    ------
    ValueError
        Unknown quantity, no active solid in the stage, or bodies in space.

    Examples
    --------
    >>> from skfem_contact.demo import culvert
    >>> import skfem_contact.plot as plot
    >>> picture = plot.contour(culvert().result["surcharge"], "uy", deformed="auto", contact=True)
    """
    picture = contours(
        [stage],
        quantity,
        since=since,
        deformed=deformed,
        limits=limits,
        levels=levels,
        colors=colors,
        bodies=bodies,
        water=water,
        supports=supports,
        loads=loads,
        vectors=vectors,
        points=points,
        contact=contact,
        window=window,
    )
    return picture.draw(window, mesh, file, show)


def stages(
    result: Result | Sequence[StageResult],
    quantity: str,
    *,
    window: Window | None = None,
    mesh: bool = False,
    file: str | Path | None = None,
    show: bool = False,
    **style: Any,
) -> Any:
    """Draw contours of several stages side by side on one scale.

    Parameters
    ----------
    result
        Result, or some stages of it: ``[result["dig"], result["filled"]]``.
    quantity, window, mesh, file, show, style
        As for :func:`contour`; the stage that has moved most determines an automatic factor of the
        displacements.

    Examples
    --------
    >>> from skfem_contact.demo import culvert
    >>> import skfem_contact.plot as plot
    >>> picture = plot.stages(culvert().result, "syy", window=(-3., 3., -3., 2.))
    """
    picture = contours(list(result), quantity, window=window, **style)
    return picture.draw(window, mesh, file, show)


def cutaway(
    stage: StageResult,
    quantity: str,
    *,
    cuts: Sequence[Cut] = (),
    towards: Sequence[float] = (-1.0, 2.0, -1.0),
    mesh: bool = True,
    file: str | Path | None = None,
    show: bool = False,
    **style: Any,
) -> Any:
    """Draw contours of a field on bodies in space, of which parts are cut away.

    Parameters
    ----------
    stage, quantity, file, show, style
        As for :func:`contour`; style is ``since``, ``deformed``, ``limits``, ``levels``,
        ``colors``, ``bodies``.
    cuts
        Planes, each by its normal, which points to the part that is cut away, and a point on it in
        the undeformed bodies.
    towards
        Direction of view; the last axis is upright, or seen along it y.
    mesh
        Draw the elements, also where the cuts go through them.

    Examples
    --------
    >>> from skfem import Basis, ElementHex1, ElementVector, MeshHex
    >>> import skfem_contact as sc
    >>> import skfem_contact.plot as plot
    >>> basis = Basis(MeshHex().refined(2), ElementVector(ElementHex1()), intorder=2)
    >>> forms = {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=.3), strain="full")}
    >>> model = sc.Model(forms, sc.box_supports(basis))
    >>> result = model.run([sc.Stage("weight", sc.weight(basis, 20.))])
    >>> picture = plot.cutaway(result["weight"], "szz", cuts=[((0, -1, 0), (0, .4, 0))])
    """
    scene = partial(Cutaway, cuts=cuts, towards=towards)
    picture = contours([stage], quantity, scene=scene, **style)
    return picture.draw(None, mesh, file, show)


def animate(
    result: Result | Sequence[StageResult],
    quantity: str,
    file: str | Path,
    *,
    window: Window | None = None,
    mesh: bool = False,
    frames: int = 16,
    **style: Any,
) -> Path | None:
    """Write a film of the stages, ``.gif`` or ``.mp4``, all of them on one scale.

    Between stages that hold the same bodies, displacements and the field are interpolated linearly.

    Parameters
    ----------
    result, quantity, window, mesh, style
        As for :func:`stages`.
    file
        Name of the film; MP4 needs ``imageio-ffmpeg``, GIF ``imageio``.
    frames
        Pictures for each stage, twelve a second; in the first half of them the bodies move.

    Returns
    -------
    Path or None
        File, or None with a warning where this machine cannot draw.
    """
    file = Path(file)
    ending = file.suffix.lower()
    if ending not in (".gif", ".mp4"):
        raise ValueError(f"a film is a .gif or an .mp4 file, not '{file.name}'")
    picture = contours(list(result), quantity, window=window, **style)
    able, _ = can_draw(picture.title)
    if not able:
        return None

    # Open the file of the film.
    frame = picture.frame(window, views=1, titled=True, width=_WIDTH)
    frame.make_even()
    plotter = frame.sheet(False)
    if ending == ".gif":
        plotter.open_gif(str(file), fps=_FRAMES_A_SECOND)
    else:
        plotter.open_movie(str(file), framerate=_FRAMES_A_SECOND)

    # Draw the way to each stage, then the stage for the other half of its pictures.
    picture.put_foot(plotter, frame, note="")
    for first, last in zip([picture.views[0], *picture.views], picture.views):
        moving = _between(first, last, frames // 2)
        for view in moving:
            plotter.suppress_rendering = True  # of every part that is added
            plotter.renderer.clear_actors()
            view.paint(plotter, frame, 0, picture.scale, mesh)
            plotter.suppress_rendering = False
            plotter.write_frame()
        plotter.suppress_rendering = True  # the picture stays
        for _ in range(frames - len(moving)):
            plotter.write_frame()
    plotter.close()
    return file


class View(NamedTuple):
    """Bodies of a stage with a field, the title above them, and marks on them."""

    scene: Scene
    title: str
    marks: Marks

    def paint(self, plotter: Any, frame: Frame, number: int, scale: Scale, mesh: bool) -> None:
        """Draw the bodies and their marks in one of the views of a frame."""
        frame.aim(plotter, number, self.title, *self.scene.view)
        self.scene.pixel = frame.pixel
        self.scene.draw(plotter, scale, mesh)
        self.marks.draw(plotter, self.scene)
        plotter.renderer.ResetCameraClippingRange()


@dataclass(frozen=True)
class Contours:
    """Views on one scale.

    Attributes
    ----------
    views, scale
        Views in their order, and the colour scale that they share.
    title, note, extremes
        Texts above the colour bar: title on the left, note on the right, extremes below.
    """

    views: Sequence[View]
    scale: Scale
    title: str
    note: str = ""
    extremes: str = ""

    def frame(self, window: Window | None, views: int, **size: Any) -> Frame:
        """Return a frame around the bodies of all stages."""
        seen = np.concatenate([view.scene.seen for view in self.views])
        margin = max(max(view.scene.room, view.marks.room) for view in self.views)
        return Frame(seen, window, views, margin=margin, **size)

    def put_foot(self, plotter: Any, frame: Frame, note: str) -> None:
        """Put the colour bar and the legend of all marks below the views."""
        legend: dict[str, dict[str, Any]] = {}
        for view in self.views:
            legend.update(view.marks.legend())
        frame.put_foot(plotter, self.scale, self.title, note, self.extremes, legend)

    def draw(self, window: Window | None, mesh: bool, file: Any, show: bool, **size: Any) -> Any:
        """Draw all views on one sheet, whose width in pixels may be given."""
        able, show = can_draw(self.title, show)
        if not able:
            return None
        frame = self.frame(window, len(self.views), titled=len(self.views) > 1, **size)
        plotter = frame.sheet(show)
        for number, view in enumerate(self.views):
            view.paint(plotter, frame, number, self.scale, mesh)
        self.put_foot(plotter, frame, self.note)
        return finish(plotter, file, show)


def contours(
    steps: Sequence[StageResult],
    quantity: str,
    *,
    since: StageResult | None = None,
    deformed: float | Literal["auto"] | None = None,
    limits: tuple[float, float] | None = None,
    levels: int = 10,
    colors: str | None = None,
    bodies: str | Iterable[str] | None = None,
    water: Shown | None = None,
    scene: Callable[..., Scene] = Scene,
    window: Window | None = None,
    **marks: Any,
) -> Contours:
    """Return views of all stages; the stage that has moved most determines an automatic factor."""
    # Select the stages, with the chosen bodies, and check them.
    if not steps:
        raise ValueError("there is no stage to draw")
    if bodies is not None:
        steps = _with_bodies(steps, names_of(bodies))
    _check_dimension(basis_of(steps[0]), scene is not Scene, {**marks, "water": water})

    # Make a view of each stage.
    views = []
    for stage in steps:
        values = region_field(stage, quantity, since, water)
        bodies_of_stage = scene(stage, deformed, since, values)
        if since is None:
            title = stage.name
        else:
            title = f"{stage.name}, since {since.name}"
        views.append(View(bodies_of_stage, title, Marks(stage, water, **marks)))
    factor = _common_factor(views)

    # Make the scale of all stages and its texts.
    samples = [_samples(view.scene, window) for view in views]
    all_values, area = (np.concatenate(parts) for parts in zip(*samples))
    scale = make_scale(all_values, area, limits, levels, colors)
    notes = [views[0].title] if len(views) == 1 else []
    if factor not in (0.0, 1.0):
        notes.append(f"displacements × {factor:g}")
    headline = _headline(steps[0], quantity, since, water)
    return Contours(views, scale, headline, ", ".join(notes), extremes_of(views))


def _samples(scene: Scene, window: Window | None) -> tuple[ndarray, ndarray]:
    """Return values of the field and the areas of their nodes, in a window only visible ones."""
    values, area = scene.samples
    if window is None:
        return values, area
    x, y = scene.moved[scene.nodes].T
    west, east, south, north = window
    seen = (x >= west) & (x <= east) & (y >= south) & (y <= north)
    if not seen.any():
        return values, area
    return values[seen], area[seen]


def _with_bodies(steps: Sequence[StageResult], bodies: Collection[str]) -> list[StageResult]:
    """Return stages with some of their solids, each of which exists in one of them."""
    existing: dict[str, Any] = {}
    for stage in steps:
        existing |= solids(stage)
    for name in bodies:
        look_up(name, existing, "solid")
    return [only(stage, bodies) for stage in steps]


def _common_factor(views: Sequence[View]) -> float:
    """Give all views the smallest factor of the stages that have moved, and return it."""
    scenes = [view.scene for view in views]
    factors = [scene.factor for scene in scenes if scene.displacement[scene.nodes].any()]
    factor = min(factors, default=scenes[0].factor)
    for scene in scenes:
        scene.factor = factor
    return factor


def extremes_of(views: Sequence[View]) -> str:
    """Return the extremes at nodes with their coordinates before deformation and their stages."""
    values = np.concatenate([view.scene.values for view in views])
    points = np.concatenate([view.scene.coordinates[view.scene.nodes] for view in views])
    if np.nanmin(values) == np.nanmax(values):
        return _with_minus(f"{values[np.isfinite(values)][0]:.4g} everywhere")
    # Name the stage of an extreme where there are several.
    owner = np.repeat(np.arange(len(views)), [len(view.scene.values) for view in views])
    texts = []
    for word, sign in (("smallest", -1.0), ("largest", 1.0)):
        index, where = located(sign * values, points)
        if len(views) > 1:
            when = f" in {views[owner[index]].title}"
        else:
            when = ""
        texts.append(_with_minus(f"{word} {values[index]:.4g} at {where}") + when)
    return ", ".join(texts)


def _with_minus(text: str) -> str:
    """Return a text of figures with true minus signs."""
    return text.replace("-", "−")


def _check_dimension(basis: Any, space: bool, marks: dict[str, Any]) -> None:
    """Refuse bodies in space in plane pictures, and the reverse, where marks are not drawn."""
    check_basis(basis)
    if not space:
        check_plane(basis, "plot.contour")
        return
    if basis.mesh.dim() != 3:
        raise ValueError(
            "plot.cutaway is for bodies in space; plane ones are drawn by plot.contour"
        )
    given = []
    for name, value in marks.items():
        if value is not None and value is not False:
            given.append(name)
    if given:
        raise ValueError(
            f"plot.cutaway does not draw {', '.join(given)}: these are for plane bodies"
        )


def only(stage: StageResult, bodies: Container[str]) -> StageResult:
    """Return a stage with some of its solids."""
    forms = {}
    for name, form in stage.forms.items():
        if name in bodies or not materials_of(form):
            forms[name] = form
    return replace(stage, forms=forms)


def _headline(
    stage: StageResult,
    quantity: str,
    since: StageResult | None,
    water: Shown | None = None,
) -> str:
    """Return the title of the colour bar, with its unit."""
    field = quantities(stage, water)[quantity]
    title = labelled(field.title, field.unit)
    if since is not None:
        return f"Change of {title}"
    return capitalised(title)


def _between(first: View, last: View, n: int) -> list[View]:
    """Return views on the way from one stage to the next; one where the bodies are others."""
    if first is last or not np.array_equal(first.scene.nodes, last.scene.nodes):
        return [last]
    shares = np.arange(1, n + 1) / n
    return [last._replace(scene=last.scene.between(first.scene, share)) for share in shares]
