"""Pictures of collapses: mechanism and load curve."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from numpy import ndarray
from skfem import Basis, ElementTriP2, ElementVector

from ..arrays import max_abs
from ..checks import check_plane
from ..collapse.mechanism import LOAD
from ..forms.solid import SolidForm
from ..limit_analysis import Bounds
from ..materials import LinearElastic
from ..results.fields import Shown, basis_of, solids
from ..results.patch_recovery import recovered
from ..results.stage import StageResult
from ..units import labelled
from .contour import Contours, View, only
from .diagram import saved, styles, tidy
from .marks import Marks
from .scene import Scene
from .sheet import Window, capitalised, make_scale, quantile

#: Largest displacement of bodies that are drawn deformed, as a share of their size.
_MOVED = 0.05


def mechanism(
    result: Any,
    *,
    deformed: bool = False,
    vectors: bool = True,
    window: Window | None = None,
    levels: int = 8,
    mesh: bool = False,
    water: Shown | None = None,
    file: str | Path | None = None,
    show: bool = False,
) -> Any:
    """Draw the mechanism of a collapse: bands of shear strain, arrows, and the factor in the title.

    Parameters
    ----------
    result
        Result of :func:`~skfem_contact.strength_reduction`, :func:`~skfem_contact.limit_load` or
        :func:`~skfem_contact.bounds`, whose upper bound has a mechanism on its own mesh. The title
        holds the bounds where they are known (``certify=True``).
    deformed
        Draw the bodies as the mechanism moves them.
    vectors
        Draw arrows of the displacement increment.
    window, levels, mesh, water, file, show
        As for :func:`contour`.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> import skfem_contact.plot as plot
    >>> mesh = MeshTri().refined(2).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    >>> forms = {"cut": sc.SolidForm(basis, sc.Tresca(E=1e4, nu=.3, c=10.))}
    >>> fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs("right").all("u^1"))
    >>> result = sc.Model(forms, fixed).limit_load(sc.weight(basis, 5.), progress=False)
    >>> picture = plot.mechanism(result)
    """
    # Take the strains of the mechanism, and bring them to the nodes.
    if isinstance(result, Bounds):
        stage, bands = _upper_bound(result)
    else:
        _check_search(result)
        stage = replace(result.end, x=result.mechanism)
        bands = result.bands
    check_plane(basis_of(stage), "plot.mechanism")
    stage = only(stage, bands)
    parts = []
    for name, form in solids(stage).items():
        parts.append(recovered(form, bands[name][None], limited=True)[0])
    strain = np.concatenate(parts)

    # Scale displacements to the size of the bodies, strains to their largest value or nearly so.
    scene = Scene(stage)
    if deformed:
        size = np.ptp(scene.coordinates[scene.nodes], axis=0).max()
        scene.factor = _MOVED * size / max_abs(scene.displacement)
    largest = quantile(strain, scene.area, 0.99) or float(strain.max())
    scene.values = strain / (largest or 1.0)
    scale = make_scale(*scene.samples, (0.0, 1.0), levels, "YlOrRd")

    title = f"{_title(result)}: shear strain of the mechanism, relative"
    view = View(scene, "", Marks(stage, water=water, vectors=vectors))
    return Contours([view], scale, title).draw(window, mesh, file, show)


def _title(result: Any) -> str:
    """Return the name of a factor with its value and its bounds, as far as they are known."""
    title = capitalised(result.what)
    bounds = result
    if not isinstance(result, Bounds):
        title += f" {result.value:.4g}"
        if result.error and result.proven is None:  # bounds say more than an estimate
            title += f", {result.error} too high"
        bounds = result.proven
    if bounds is None:
        return title
    return f"{title} in [{bounds.lower:.4g}, {bounds.upper:.4g}]"


def _check_search(result: Any) -> None:
    """Refuse results of other analyses than searches."""
    if getattr(result, "curve", None) is None:
        raise ValueError(
            "a result of strength_reduction or limit_load is drawn, or by plot.mechanism of "
            f"bounds, not a {type(result).__name__}"
        )


def _upper_bound(bounds: Bounds) -> tuple[StageResult, dict[str, ndarray]]:
    """Return the mechanism of an upper bound as a stage, and its shear strains."""
    basis = Basis(bounds.mesh, ElementVector(ElementTriP2()), intorder=2)
    n = bounds.mesh.nvertices
    x = basis.zeros()
    x[basis.nodal_dofs] = bounds.mechanism[:, :n]
    x[basis.facet_dofs] = bounds.mechanism[:, n:]
    form = SolidForm(basis, LinearElastic(E=1.0, nu=0.0))  # the law does not change strains
    stage = StageResult(
        name="upper bound",
        x=x,
        load=0.0 * x,
        states={"mechanism": form.initial_state()},
        iterations=(),
        residual=0.0,
        forms={"mechanism": form},
    )
    return stage, {"mechanism": form.shear_strain(x)}


def load_curve(result: Any, *, file: str | Path | None = None) -> Figure:
    """Draw the factor or load multiplier against the largest displacement up to collapse.

    Parameters
    ----------
    result
        Result of :func:`~skfem_contact.strength_reduction` or :func:`~skfem_contact.limit_load`.
    file
        Name of a picture to write.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> import skfem_contact.plot as plot
    >>> mesh = MeshTri().refined(2).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    >>> forms = {"cut": sc.SolidForm(basis, sc.Tresca(E=1e4, nu=.3, c=10.))}
    >>> fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs("right").all("u^1"))
    >>> result = sc.Model(forms, fixed).limit_load(sc.weight(basis, 5.), progress=False)
    >>> figure = plot.load_curve(result)
    """
    # Draw the equilibria from the least displacement, where the search starts.
    _check_search(result)
    _, parameter, displacement = np.asarray(result.curve).T
    begin = int(np.argmin(displacement))
    figure, ax = plt.subplots(figsize=(7.0, 4.5), layout="constrained")
    (style,) = styles(1)
    if result.what == LOAD:  # without load nothing has moved
        displacement = np.insert(displacement, begin, 0.0)
        parameter = np.insert(parameter, begin, 0.0)
    ax.plot(displacement[begin:], parameter[begin:], marker="o", markersize=4, **style)

    # Draw and write the limit.
    ax.axhline(result.value, color="#888888", linewidth=1.0, linestyle=":")
    ax.annotate(
        f"{result.value:.4g}",
        (0.0, result.value),
        xycoords=("axes fraction", "data"),
        xytext=(6, 4),
        textcoords="offset points",
        fontsize=11,
    )
    ax.set(xlabel=labelled("largest displacement", "length"), ylabel=result.what)
    ax.set_xlim(left=0.0)
    if result.what == LOAD:
        ax.set_ylim(bottom=0.0)
    tidy(ax, 1)
    return saved(figure, file)
