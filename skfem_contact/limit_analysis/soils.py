"""Strength of every element, from the materials of the solids."""
from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from ..materials import LinearElastic, MohrCoulomb, Tresca, VonMises
from ..materials.reduction import Flow
from ..solid import SolidForm
from ..strain import axisymmetric
from .strength import FLAT, Soil


def strengths(solids: Mapping[str, SolidForm], targets: Mapping[str, Collection[str]], flow: Flow) -> Soil:
    """Strength of all elements of the mesh; elastic ones and those of no solid are rigid.

    Parameters
    ----------
    solids
        Solids by name.
    targets
        Regions that are reduced, by solid.
    flow
        ``"associated"``, or ``"davis_a"`` for the associated soil of less strength.
    """
    n = next(iter(solids.values())).basis.mesh.nelements
    found = Soil(np.full(n, np.inf), np.zeros(n), np.full(n, np.inf), np.zeros(n, bool))
    for name, form in solids.items():
        for region in form.regions:
            where = form.elements[region.elements]
            c, t, tension = _parameters(region.material, flow, f"{name}.{region.name}")
            found.c[where], found.t[where], found.tension[where] = c, t, tension
            found.reduced[where] = region.name in targets.get(name, ())
    return found


def check_solids(solids: Mapping[str, SolidForm]) -> None:
    """Refuse what has no bounds: space, axial symmetry, other materials, overlapping solids."""
    for name, form in solids.items():
        if form.basis.mesh.dim() != 2 or form.strain is axisymmetric:
            kind = "axially symmetric" if form.basis.mesh.dim() == 2 else "in three dimensions"
            raise ValueError(f"bounds are for plane strain, but '{name}' is {kind}")
        for region, material in form.materials.items():
            if not isinstance(material, (LinearElastic, MohrCoulomb, Tresca, VonMises)):
                raise ValueError(f"there are no bounds for {type(material).__name__}, the material of '{region}' in "
                                 f"'{name}'; there are for MohrCoulomb, Tresca, VonMises and, rigid, LinearElastic")
    elements = np.concatenate([form.elements for form in solids.values()])
    if len(np.unique(elements)) < len(elements):
        raise ValueError(f"the solids {', '.join(solids)} share elements: each must belong to one of them")


def _parameters(material: Any, flow: Flow, name: str) -> tuple[Any, Any, Any]:
    """Cohesion, tan phi and tensile strength in plane strain."""
    if isinstance(material, LinearElastic):
        return np.inf, 0.0, np.inf
    if isinstance(material, VonMises):  # what flows in plane strain has the mean of the others as third stress
        c, t, tension = material.strength / np.sqrt(3), 0.0, np.inf
    elif isinstance(material, Tresca):
        c, t, tension = material.c, 0.0, np.inf
    else:
        if flow != "associated":
            material = material.reduced(1.0, flow)
        c, t = material.c, np.tan(np.radians(material.phi))
        tension = np.inf if material.tension is None else material.tension
    if np.any((np.asarray(t) > 0) & (np.asarray(t) < FLAT)):
        raise ValueError(f"a friction angle of '{name}' lies between 0 and {np.degrees(FLAT):.2f} degrees; make it 0")
    if np.any((np.asarray(c) == 0) & (np.asarray(t) == 0)):
        raise ValueError(f"'{name}' has neither cohesion nor friction")
    return c, t, tension
