"""Contours of forces, moments and displacements on shells in space by pyvista."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy import ndarray
from typing_extensions import override

from ..arrays import row_norms
from ..checks import look_up, names_of
from ..results.on_shells import FIELDS, shells_of
from ..results.stage import StageResult
from ..shells.element import normals
from ..units import labelled
from .contour import Contours, View, extremes_of
from .marks import Marks
from .scene import EDGE, SpaceScene, banded, grid_of, surface_of
from .sheet import Scale, capitalised, make_scale
from .structures import Lines, structures

#: Least share of the area that is seen from above, for a view from there; other views.
_LEVEL = 0.9
_ABOVE = (0.0, 0.0, -1.0)
_ASLANT = (-1.0, 2.0, -1.0)


def shells(
    stage: StageResult,
    quantity: str,
    *,
    names: str | Iterable[str] | None = None,
    towards: Sequence[float] | None = None,
    deformed: float | Literal["auto"] | None = None,
    limits: tuple[float, float] | None = None,
    levels: int = 10,
    colors: str | None = None,
    file: str | Path | None = None,
    show: bool = False,
) -> Any:
    """Draw contours of a field on shells: moments of a raft, hoop forces of a tank.

    Forces and moments at a node are means of the triangles around it, without those beyond a fold.

    Parameters
    ----------
    stage
        Stage of a result; its active shells are drawn.
    quantity
        ``"n_1"``, ``"n_2"``, ``"n_12"``, ``"m_1"``, ``"m_2"`` or ``"m_12"`` per length, as of
        :class:`~skfem_contact.Shell`; ``"ux"``, ``"uy"``, ``"uz"`` or ``"u"``.
    names
        Names of the shells to draw; by default all.
    towards
        Direction of view; by default downwards on slabs, x to the right and y upwards, and aslant
        on others.
    deformed, limits, levels, colors, file, show
        As for :func:`contour`.

    Returns
    -------
    pyvista.Plotter or None
        As of :func:`contour`.

    Raises
    ------
    ValueError
        Unknown quantity or shell, or no active shell in the stage.

    Examples
    --------
    >>> from skfem import MeshQuad
    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> import skfem_contact.plot as plot
    >>> mesh = MeshQuad().refined(3)
    >>> points = np.column_stack((*mesh.p, 0 * mesh.p[0]))
    >>> slab = sc.Shell(None, points, cells=mesh.t.T[:, ::-1], E=3e7, nu=.2, thickness=.05)
    >>> rim = [dof for p in points if p[0] in (0., 1.) for dof in slab.dofs(p)]
    >>> model = sc.Model({"slab": slab}, rim)
    >>> load = model.forms["slab"].area_load((0., 0., -5.))
    >>> result = model.run([sc.Stage("load", load)], progress=False)
    >>> picture = plot.shells(result["load"], "m_1")
    """
    title = labelled(*look_up(quantity, FIELDS, "quantity of shells"))
    parts = _parts(stage, names)
    lines = list(structures(stage))
    scene = _ShellScene(list(parts.values()), lines, quantity, towards, deformed)
    scale = make_scale(*scene.samples, limits, levels, colors)
    note = stage.name
    if scene.factor != 0.0:
        note += f", displacements × {scene.factor:g}"
    view = View(scene, stage.name, Marks(stage))
    headline = capitalised(title)
    picture = Contours([view], scale, headline, note, extremes_of([view]))
    return picture.draw(None, False, file, show)


class _Part(NamedTuple):
    """Corners of the triangles of a shell, (3 m, 3), their displacements, and values by name."""

    points: ndarray
    displacement: ndarray
    values: Mapping[str, ndarray]


def _parts(stage: StageResult, names: str | Iterable[str] | None) -> dict[str, _Part]:
    """Return the shells of a stage by their names."""
    found = {}
    for name, (points, values) in shells_of(stage).items():
        found[name] = _Part(points, values["displacement"], values)
    if not found:
        raise ValueError(f"stage '{stage.name}' has no active shell to draw")
    if names is None:
        return found
    return {name: look_up(name, found, "shell") for name in names_of(names)}


class _ShellScene(SpaceScene):
    """Shells of a stage, seen in a direction, with a field at the corners of their triangles."""

    def __init__(
        self,
        parts: Sequence[_Part],
        lines: Sequence[Lines],
        quantity: str,
        towards: Sequence[float] | None,
        deformed: float | Literal["auto"] | None,
    ) -> None:
        self.coordinates = np.concatenate([part.points for part in parts])
        self.displacement = np.concatenate([part.displacement for part in parts])
        self.nodes = np.arange(len(self.coordinates))
        if quantity == "u":
            self.values = row_norms(self.displacement)
        elif quantity in ("ux", "uy", "uz"):
            self.values = self.displacement[:, "xyz".index(quantity[1])]
        else:
            self.values = np.concatenate([part.values[quantity] for part in parts])
        self.factor = self._factor(deformed)
        self.pixel = 1.0

        # A third of each triangle belongs to each of its corners
        normal = normals(self.coordinates.reshape(-1, 3, 3))
        area = 0.5 * row_norms(normal)
        self.area = np.repeat(area / 3.0, 3)
        if towards is None:
            from_above = 0.5 * np.abs(normal[:, 2]).sum() > _LEVEL * area.sum()
            towards = _ABOVE if from_above else _ASLANT

        # Look at the middle of the shells and of the beams and bars that are drawn with them
        ends = []
        for line in lines:
            ends.append((line.points + self.factor * line.displacement).reshape(-1, 3))
        self._look(towards, np.concatenate([self.moved, *ends]))

    @override
    def draw(self, plotter: Any, scale: Scale, mesh: bool) -> None:
        cells = self.nodes.reshape(-1, 3)
        grid = grid_of(self.coordinates, "triangle", cells, self.displacement)
        grid["values"] = self.values
        surface = surface_of(grid, self.factor, 0)
        bands, lines = banded(surface, scale)
        plotter.add_mesh(bands, scalars="colors", rgb=True, lighting=False, show_scalar_bar=False)
        if lines.n_cells:
            front = lines.translate(self._front)
            plotter.add_mesh(front, color="#333333", opacity=0.25, line_width=1, lighting=False)

        # Draw the ends of the shells and the folds between them
        edges = surface.clean().extract_feature_edges(EDGE)
        plotter.add_mesh(edges.translate(self._front), color="black", line_width=4, lighting=False)
