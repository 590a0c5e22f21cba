"""The mechanism of a collapse: bands of shear strain, arrows, and the factor."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import check_plane
from ..post.fields import Water, solids
from ..post.recovery import recovered
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
        What :func:`~skfem_contact.strength_reduction` or :func:`~skfem_contact.limit_load` has found; anything with
        a ``mechanism`` (N,), its shear strains ``bands`` by solid, and what it is and its ``value``.
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
    >>> found = sc.limit_load(forms, fixed, sc.weight(basis, 5.), progress=False)
    >>> picture = plot.mechanism(forms, found)
    """
    check_plane(next(iter(solids(forms).values())).basis, "plot.mechanism")
    moved = found.mechanism
    stage = replace(found.end, x=moved)
    there = {name: form for name, form in solids(forms).items() if name in found.bands}
    fields = [field for name, form in there.items() for field in recovered(form, found.bands[name][None], limited=True)]
    strain = np.concatenate([field.values[0] for field in fields])
    scene = Scene(there, stage, 0.0)
    if deformed:
        size = np.ptp(scene.places[scene.nodes], axis=0).max()
        scene = Scene(there, stage, _MOVED * size / float(np.abs(moved).max()))
    strain = strain / _most(strain, scene.area)
    scale = make_scale(strain, scene.area, (0.0, 1.0), levels, "YlOrRd")
    marks = Marks(there, stage, water=water, vectors=vectors)
    title = f"{found.what[0].upper()}{found.what[1:]} {found.value:.4g}: shear strain of the mechanism, relative"
    return draw([View(scene, strain, "")], [marks], scale, title, "", window, mesh, file, show)


def _most(strain: np.ndarray, area: np.ndarray) -> float:
    """What 1 % of the area exceeds."""
    order = np.argsort(strain)
    share = np.cumsum(area[order]) / area.sum()
    return float(np.interp(0.99, share, strain[order])) or float(strain.max()) or 1.0
