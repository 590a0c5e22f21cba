"""Curves over stages and on the way to a collapse."""
from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from ..post.fields import nodal_field, quantities, solids
from ..stages.result import Result
from .diagrams import saved, styles, tidy
from .units import labelled


def history(forms: Mapping[str, Any], result: Result, quantity: str, at: Mapping[str, ArrayLike], *,
            time: bool = False, file: str | Path | None = None) -> Figure:
    """A field at some points through all stages.

    Parameters
    ----------
    forms, result
        Forms by name and the result of their analysis.
    quantity
        A field of :func:`~skfem_contact.nodal_field`.
    at
        Places (x, y) by their labels; the nearest nodes are taken. Stages in which no solid is there have no value.
    time
        Over the times at which the stages end, which have durations, in place of their names.
    file
        Name of a picture to write.

    Examples
    --------
    >>> from skfem_contact.demo import culvert
    >>> import skfem_contact.plot as plot
    >>> model = culvert()
    >>> figure = plot.history(model.forms, model.result, "uy", {"crown": (0., .9), "surface": (.9, 3.5)})
    """
    bodies = solids(forms)
    basis = next(iter(bodies.values())).basis
    what = quantities(bodies)
    dim = basis.mesh.dim()
    tree = cKDTree(basis.doflocs[:, 0::dim].T)
    nodes = {label: int(tree.query(np.asarray(place, float))[1]) for label, place in at.items()}
    fields = [nodal_field(forms, stage, quantity) for stage in result]
    names = [stage.name for stage in result]
    figure, ax = plt.subplots(figsize=(8.0, 4.2), layout="constrained")
    for given, (label, node) in zip(styles(len(nodes)), nodes.items()):
        style = {**given, "linestyle": "-", "marker": "o", "markersize": 5}
        places = [stage.time for stage in result] if time else range(len(names))
        ax.plot(places, [field[node] for field in fields], label=label, **style)
    if time:
        ax.set_xlabel("time")
    else:
        ax.set_xticks(range(len(names)), names)
    ax.set_ylabel(labelled(what[quantity].title, what[quantity].unit))
    tidy(ax, len(nodes))
    return saved(figure, file)


def load_curve(found: Any, *, file: str | Path | None = None) -> Figure:
    """Factor, or load multiplier, against the largest displacement on the way to a collapse.

    Parameters
    ----------
    found
        What :func:`~skfem_contact.strength_reduction` or :func:`~skfem_contact.limit_load` has found.
    file
        Name of a picture to write.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> import skfem_contact.plot as plot
    >>> basis = Basis(MeshTri.init_tensor(*2 * [np.linspace(0, 5, 5)]).with_defaults(), ElementVector(ElementTriP2()),
    ...               intorder=2)
    >>> forms = {"cut": sc.SolidForm(basis, sc.Tresca(E=1e4, nu=.3, c=10.))}
    >>> fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs("right").all("u^1"))
    >>> figure = plot.load_curve(sc.limit_load(forms, fixed, sc.weight(basis, 5.), progress=False))
    """
    _, parameter, displacement = np.asarray(found.curve).T
    begin = int(np.argmin(displacement))  # what is before has moved the structure to where the search starts
    figure, ax = plt.subplots(figsize=(7.0, 4.5), layout="constrained")
    (style,) = styles(1)
    ax.plot(displacement[begin:], parameter[begin:], marker="o", markersize=4, **style)
    ax.axhline(found.value, color="#888888", linewidth=1.0, linestyle=":")
    ax.annotate(f"{found.value:.4g}", (0.0, found.value), xycoords=("axes fraction", "data"), xytext=(6, 4),
                textcoords="offset points", fontsize=11)
    ax.set(xlabel=labelled("largest displacement", "length"), ylabel=found.what)
    ax.set_xlim(left=0.0)
    tidy(ax, 1)
    return saved(figure, file)
