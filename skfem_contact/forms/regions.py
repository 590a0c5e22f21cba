"""Regions of a basis: every element has one material, and the elements of a region follow each
other.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from skfem import CellBasis

from ..checks import format_point, look_up
from ..errors import InadmissibleStress
from ..layout import elements_of
from ..materials import Material, Update
from ..materials.base import as_material, updated
from .assembly import damped


class Region(NamedTuple):
    """Elements of one material: their subdomain, and their slice of a basis ordered by regions."""

    name: str
    material: Material
    elements: slice = slice(None)
    given: Material | None = (
        None  # with functions of the coordinates, whose values at the points `material` has
    )

    def with_material(self, material: Any, basis: CellBasis) -> Region:
        """Return the region with another material, which need not derive from :class:`Material`, at
        a basis' points.
        """
        try:
            given = as_material(material)
            here = (
                given.at(np.asarray(basis.global_coordinates())[:, self.elements])
                if given.functions
                else given
            )
        except ValueError as error:
            raise ValueError(f"material of '{self.name}': {error}") from error
        return Region(self.name, here, self.elements, given if given.functions else None)

    def initial_internal(self, stress: ndarray, basis: CellBasis) -> ndarray:
        """Return the memory of ground under stresses of a basis' points; say where they are not
        admissible.
        """
        try:
            return self.material.initial_internal(stress[:, self.elements])
        except InadmissibleStress as error:
            at = np.asarray(basis.global_coordinates())[:, self.elements].reshape(
                basis.mesh.dim(), -1
            )[:, error.point]
            raise InadmissibleStress(
                f"{error}; that point lies at {format_point(at)} in '{self.name}'", error.point
            ) from error


def check_materials(regions: tuple[Region, ...], shape: tuple[int, ...], ncomp: int) -> None:
    """Try every material on unstrained points, (n_elements, n_points): its parameters and its
    memory must fit.
    """
    for name, material, elements, _ in regions:
        n = len(range(shape[0])[elements]), shape[1]
        zero = np.zeros((ncomp, *n))
        try:
            internal = material.initial_internal(zero)
            _check_memory(material, "initial_internal", internal, n)
            update = updated(material, zero, zero, internal, 0.0)
            _check_memory(material, "update", update.internal, n)
            if np.shape(update.stress) != zero.shape:
                raise ValueError(
                    f"update returns a stress of shape {np.shape(update.stress)}, not {zero.shape}"
                )
        except ValueError as error:
            raise ValueError(f"material of '{name}', {material.label}: {error}") from error


def _check_memory(material: Material, call: str, internal: ndarray, n: tuple[int, int]) -> None:
    """Refuse internal variables that the material has not declared, and those of a wrong shape."""
    shape, declared = np.shape(internal), (material.n_internal, *n)
    if shape != declared:
        names = ", ".join(variable.name for variable in material.internal) or "none"
        raise ValueError(
            f"{call} returns internal variables of shape {shape}, but {material.n_internal} "
            f"declared "
            f"({names}) make {declared}; declare all in `internal`"
        )


def by_region(
    basis: CellBasis, materials: Material | Mapping[str, Material]
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
        elements = part[
            np.sort(np.unique(part, return_index=True)[1])
        ]  # each once, in the order of its parameters
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
        raise ValueError(
            f"{len(missing)} of {len(present)} elements have no material; "
            f"they lie in the subdomains {names}"
        )
    if count.max() > 1:
        raise ValueError(
            f"{(count > 1).sum()} elements have more than one material: the subdomains "
            f"{list(materials)} overlap"
        )
    return (basis if np.array_equal(tind, present) else basis.with_elements(tind)), tuple(regions)


def changed_moduli(
    material: Material, stress: ndarray, internal: ndarray, update: Update, damping: bool
) -> tuple[ndarray, ndarray]:
    """Return the points whose moduli are not those of the elastic stiffness, and their tangents (n,
    ncomp, ncomp).
    """
    if not (material.stress_dependent or len(update.plastic)):
        return update.plastic, np.zeros(0)
    n, ncomp = stress[0].size, len(stress)
    if not material.stress_dependent:
        tangent = update.tangent()
        if damping:
            elasticity = np.broadcast_to(
                material.elasticity(ncomp), (stress.shape[1], ncomp, ncomp)
            )
            tangent = damped(tangent, elasticity[update.plastic // stress[0, 0].size])
        return update.plastic, tangent
    moduli = material.elasticity(ncomp, stress, internal).reshape(n, ncomp, ncomp).copy()
    if len(update.plastic):
        tangent = update.tangent()
        moduli[update.plastic] = damped(tangent, moduli[update.plastic]) if damping else tangent
    return np.arange(n), moduli


def inherited(old: Region, new: Region, stress: ndarray, internal: ndarray) -> bool:
    """Change stresses and internal variables where a region gets another material; return True if
    any changes.

    Variables of the same name keep their values, others start from the stress. Ground that was
    undrained and is drained now loses its excess pore pressure.
    """
    ends = [range(stress.shape[1])[region.elements] for region in (old, new)]
    at = slice(max(end.start for end in ends), min(end.stop for end in ends))
    before, after = old.material, new.material
    names, known = (
        [variable.name for variable in material.internal] for material in (after, before)
    )
    drains = before.undrained and not after.undrained
    if at.start >= at.stop or before is after or (names == known[: len(names)] and not drains):
        return False
    if drains:
        stress[:, at], internal[:, at] = before.drained(stress[:, at], internal[:, at])
    memory = internal[:, at].copy()
    first = after.initial_internal(stress[:, at])
    for row, name in enumerate(names):
        kept = before.variable(name, memory)
        internal[row, at] = first[row] if kept is None else kept
    return True
