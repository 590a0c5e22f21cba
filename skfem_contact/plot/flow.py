"""Pictures of seepage by matplotlib."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation
from numpy import ndarray

from ..layout import centroids, elements_of, facet_corners
from ..units import labelled
from ..water import Seepage
from ..water.points import simplices
from .diagram import saved
from .marks import WATER

#: Most bands of the head or pressure.
_LEVELS = 14
#: Arrows along the longer side of the picture.
_ARROWS = 24
#: Size of a picture at most, in inches.
_WIDTH = 9.0
_HEIGHT = 5.0
_FLOW = {"head": ("hydraulic head", "length"), "pressure": ("pore pressure", "stress")}


def flow_diagram(
    water: Seepage,
    quantity: Literal["head", "pressure"] = "head",
    arrows: bool = True,
    ax: Axes | None = None,
    file: str | Path | None = None,
) -> Figure:
    """Draw contours of the head or pore pressure in wet ground, free surface and flow.

    Parameters
    ----------
    water
        Plane seepage.
    quantity
        ``"head"`` or ``"pressure"``.
    arrows
        Draw the velocities of the elements nearest to the points of a grid. The lengths of arrows
        are proportional to the velocity, except for the largest twentieth of them.
    ax
        Axes to draw in; by default axes of a new figure.
    file
        Name of a picture to write.

    Examples
    --------
    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> import skfem_contact.plot as plot
    >>> from skfem import Basis, ElementTriP1, MeshTri
    >>> dam = MeshTri.init_tensor(np.linspace(0, 5, 6), np.linspace(0, 5, 6)).with_defaults()
    >>> flow = sc.water.Flow(Basis(dam, ElementTriP1()), permeability=1., unit_weight=10.)
    >>> levels = sc.water.Conditions(head={"left": 5., "right": 1.}, seepage_face="right")
    >>> water = flow.steady(levels)
    >>> figure = plot.flow_diagram(water, "pressure")
    """
    # The size of the figure follows the section.
    mesh = water.basis.mesh
    if mesh.dim() != 2:
        raise ValueError("plot.flow_diagram is for plane seepage")
    elements = elements_of(water.basis)
    corners = simplices(mesh, elements).T
    if ax is None:
        width, height = np.ptp(mesh.p[:, corners.ravel()], axis=1)
        scale = min((_WIDTH - 2.0) / width, _HEIGHT / height)
        size = (scale * width + 2.0, scale * height + 0.5)
        _, ax = plt.subplots(figsize=size, layout="constrained")

    # Draw contours in wet triangles, or in all if none is wet.
    x, y = mesh.p[:, : len(water.head)]
    wet = (water.head >= y)[corners].any(axis=1)
    if wet.any():
        corners = corners[wet]
    triangles = Triangulation(x, y, corners)
    values = np.nan_to_num(getattr(water, quantity))
    shown = values[triangles.triangles]
    levels = MaxNLocator(_LEVELS).tick_values(shown.min(), shown.max())
    filled = ax.tricontourf(triangles, values, levels, cmap="Blues")
    ax.tricontour(triangles, values, levels, colors="white", linewidths=0.5)
    ax.figure.colorbar(filled, ax=ax, label=labelled(*_FLOW[quantity]), shrink=0.8)

    # Draw the outline, the free surface and the flow.
    sides = mesh.t2f[:, elements].ravel()
    is_outline = np.bincount(sides, minlength=mesh.nfacets) == 1
    outline = facet_corners(mesh, is_outline).transpose(2, 1, 0)  # (n, 2, 2)
    ax.add_collection(LineCollection(list(outline), colors="black"))
    for line in water.free_surface:
        ax.plot(*line.T, color=WATER, linewidth=2.0)
    if arrows:
        centres = centroids(mesh, elements)
        _draw_arrows(ax, centres, water.velocity)
    ax.set(aspect="equal")
    figure = ax.get_figure()
    assert isinstance(figure, Figure)
    return saved(figure, file)


def _draw_arrows(ax: Axes, centres: ndarray, velocity: ndarray) -> None:
    """Draw velocities (2, n) of the elements nearest to the points of a regular grid."""
    # Take the element nearest to the middle of each cell of the grid.
    low = centres.min(axis=1, keepdims=True)
    step = float(np.ptp(centres, axis=1).max()) / _ARROWS
    position = (centres - low) / step
    cell = np.floor(position).astype(int)
    off = np.linalg.norm(position - cell - 0.5, axis=0)
    order = np.lexsort((off, *cell))
    differs = (np.diff(cell[:, order]) != 0).any(axis=0)
    is_first = np.append(True, differs)
    first = order[is_first]

    # Scale the velocities, and leave out small ones.
    flow = velocity[:, first]
    speed = np.linalg.norm(flow, axis=0)
    longest = float(np.quantile(speed, 0.95)) or 1.0
    flow = flow / np.maximum(speed, longest) * 0.9 * step
    shown = np.linalg.norm(flow, axis=0) > 0.05 * step
    ax.quiver(
        *centres[:, first[shown]],
        *flow[:, shown],
        angles="xy",
        scale_units="xy",
        scale=1.0,
        width=0.002,
        color="#333333",
    )
