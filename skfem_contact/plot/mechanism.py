"""The mechanism of a collapse: bands of shear strain, arrows, and the factor."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy import ndarray
from skfem import Basis, ElementTriP2, ElementVector

from ..errors import check_plane
from ..forms.solid import SolidForm
from ..limit_analysis import Bounds
from ..materials import LinearElastic
from ..results.fields import Water, basis_of, solids
from ..results.patch_recovery import recovered
from ..results.result import StageResult
from .contours import View, Window, draw
from .marks import Marks
from .scales import make_scale
from .scene import Scene

#: Largest displacement of the drawn mechanism, as a share of the bodies' size, where bodies are drawn deformed.
_MOVED = 0.05


def mechanism(forms: Mapping[str, Any], found: Any, *, deformed: bool = False, vectors: bool = True,
              window: Window | None = None, levels: int = 8, mesh: bool = False, water: Water | None = None,
              file: str | Path | None = None, show: bool = False) -> Any:
    """How a structure collapses: bands of shear strain, arrows of the displacement increment, the factor in the title.

    Parameters
    ----------
    forms
        Forms by name.
    found
        What :func:`~skfem_contact.strength_reduction`, :func:`~skfem_contact.limit_load` or
        :func:`~skfem_contact.bounds` has found; of bounds it is the mechanism of the upper one, on its own mesh.  The
        title holds the bounds where they are known (``certify=True``).
    deformed
        Whether to draw the bodies as the mechanism moves them.
    vectors
        Whether to draw arrows.
    window, levels, mesh, water, file, show
        As for :func:`contour`.

    Returns
    -------
    pyvista.Plotter or None
        As for :func:`contour`.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> import skfem_contact.plot as plot
    >>> basis = Basis(MeshTri.init_tensor(*2 * [np.linspace(0, 5, 7)]).with_defaults(), ElementVector(ElementTriP2()),
    ...               intorder=2)
    >>> forms = {"cut": sc.SolidForm(basis, sc.Tresca(E=1e4, nu=.3, c=10.))}
    >>> fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs("right").all("u^1"))
    >>> found = sc.Model(forms, fixed).limit_load(sc.weight(basis, 5.), progress=False)
    >>> picture = plot.mechanism(forms, found)
    """
    there, stage, bands = _of_bounds(found) if isinstance(found, Bounds) else _of_search(forms, found)
    basis = basis_of(stage)
    check_plane(basis, "plot.mechanism")
    moved = stage.x[:basis.N]
    strain = np.concatenate([recovered(form, bands[name][None], limited=True)[0] for name, form in there.items()])
    scene = Scene(there, stage, 0.0)
    if deformed:
        size = np.ptp(scene.places[scene.nodes], axis=0).max()
        scene = Scene(there, stage, _MOVED * size / float(np.abs(moved).max()))
    strain = strain / _most(strain, scene.area)
    scale = make_scale(strain, scene.area, (0.0, 1.0), levels, "YlOrRd")
    marks = Marks(there, stage, water=water, vectors=vectors)
    title = f"{found.what[0].upper()}{found.what[1:]} {_value(found)}: shear strain of the mechanism, relative"
    return draw([View(scene, strain, "", marks)], scale, title, "", window, mesh, file, show)


def _value(found: Any) -> str:
    """What was found, and the bounds that are known."""
    proven = found if isinstance(found, Bounds) else found.proven
    value = "" if isinstance(found, Bounds) else f"{found.value:.4g}"
    return value if proven is None else f"{value} in [{proven.lower:.4g}, {proven.upper:.4g}]".strip()


def _of_search(forms: Mapping[str, Any], found: Any) -> tuple[dict[str, SolidForm], StageResult, Mapping[str, ndarray]]:
    """Solids, the mechanism as a stage, and shear strains at the points of the solids."""
    there = {name: form for name, form in solids(found.end).items() if name in found.bands}
    return there, replace(found.end, x=found.mechanism), found.bands


def _of_bounds(found: Bounds) -> tuple[dict[str, SolidForm], StageResult, Mapping[str, ndarray]]:
    """The same of an upper bound, whose quadratic velocities live on a mesh of their own."""
    basis = Basis(found.mesh, ElementVector(ElementTriP2()), intorder=2)
    x, n = basis.zeros(), found.mesh.nvertices
    x[basis.nodal_dofs], x[basis.facet_dofs] = found.mechanism[:, :n], found.mechanism[:, n:]
    form = SolidForm(basis, LinearElastic(E=1.0, nu=0.0))  # any law: strains are asked for
    stage = StageResult("upper bound", x, 0.0 * x, {"mechanism": form.initial_state()}, (), 0.0,
                        forms={"mechanism": form})
    return {"mechanism": form}, stage, {"mechanism": form.shear_strain(x)}


def _most(strain: ndarray, area: ndarray) -> float:
    """What 1 % of the area exceeds."""
    order = np.argsort(strain)
    share = np.cumsum(area[order]) / area.sum()
    return float(np.interp(0.99, share, strain[order])) or float(strain.max()) or 1.0
