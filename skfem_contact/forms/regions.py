"""Regions of a basis: every element has one material, and the elements of a region follow each other."""
from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from skfem import CellBasis

from ..errors import look_up
from ..layout import elements_of
from ..materials import Material


class Region(NamedTuple):
    """Elements of one material: their subdomain, and their slice of a basis ordered by regions."""

    name: str
    material: Material
    elements: slice = slice(None)


def check_materials(regions: tuple[Region, ...], n_elements: int, ncomp: int) -> None:
    """Try every material on unstrained elements: parameter arrays must fit their region."""
    for region in regions:
        if isinstance(region.material, type) or not hasattr(region.material, "update"):
            raise ValueError(f"material of '{region.name}': {region.material!r} is no material")
        n = len(range(n_elements)[region.elements])
        zero = np.zeros((ncomp, n, 1))
        try:
            region.material.update(zero, zero, np.zeros((region.material.n_internal, n, 1)))
        except ValueError as error:
            raise ValueError(f"material of '{region.name}': {error}") from error


def by_region(basis: CellBasis, materials: Material | Mapping[str, Material]
              ) -> tuple[CellBasis, tuple[Region, ...]]:
    """Order the elements of a basis region by region, so that every region is a slice."""
    if not isinstance(materials, Mapping):
        return basis, (Region("all", materials),)
    if not materials:
        raise ValueError("there is no material: give one, or {subdomain: material}")
    present = elements_of(basis)
    order, regions, start = [], [], 0
    for name, material in materials.items():
        part = np.asarray(look_up(name, basis.mesh.subdomains or {}, "subdomain"))
        elements = part[np.sort(np.unique(part, return_index=True)[1])]  # each once, in the order of its parameters
        elements = elements[np.isin(elements, present)]
        if len(elements) == 0:
            raise ValueError(f"subdomain '{name}' holds no element of this basis")
        order.append(elements)
        regions.append(Region(name, material, slice(start, start + len(elements))))
        start += len(elements)
    tind = np.concatenate(order)
    unique, count = np.unique(tind, return_counts=True)
    if len(unique) < len(present):
        missing = np.setdiff1d(present, unique)
        names = [k for k, v in (basis.mesh.subdomains or {}).items() if np.isin(missing, v).any()]
        raise ValueError(f"{len(missing)} of {len(present)} elements have no material; "
                         f"they lie in the subdomains {names}")
    if count.max() > 1:
        raise ValueError(f"{(count > 1).sum()} elements have more than one material: the subdomains "
                         f"{list(materials)} overlap")
    return (basis if np.array_equal(tind, present) else basis.with_elements(tind)), tuple(regions)
