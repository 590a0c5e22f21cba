"""Regions of a basis: slices of elements of one material."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from skfem import CellBasis

from ..checks import check_no_mask, format_point, look_up, tags_with
from ..errors import InadmissibleStress, IncrementTooLarge
from ..layout import elements_of
from ..materials import Material, Update
from ..materials.base import as_material, bulk_modulus_of, updated
from .assembly import damped

#: Strains by which a law is tried: plastic if it has a strength at all.
_LARGE = 1.0
#: Shares of them by which it is tried again where it has no response to such large steps.
_SMALLER = 1.0, 0.1, 0.01
#: Round-off of mean stresses relative to the largest one.
_ROUND_OFF = 1e-9


class Region(NamedTuple):
    """Elements of one material: a subdomain, a slice of a basis ordered by regions.

    `given` is a material with functions of the coordinates, whose values at the points `material`
    has; None for a material without functions.
    """

    name: str
    material: Material
    elements: slice = slice(None)
    given: Material | None = None

    def with_material(self, material: Any, basis: CellBasis) -> Region:
        """Return the region with another material at a basis' points.

        The material need not derive from :class:`Material`.
        """
        try:
            given = as_material(material)
            if not given.functions:
                return Region(self.name, given, self.elements)
            return Region(self.name, given.at(self._points(basis)), self.elements, given)
        except ValueError as error:
            raise ValueError(f"material of '{self.name}': {error}") from error

    def initial_internal(self, stress: ndarray, basis: CellBasis) -> ndarray:
        """Return the memory of ground under stresses of a basis' points."""
        try:
            return self.material.initial_internal(stress[:, self.elements])
        except InadmissibleStress as error:
            points = self._points(basis).reshape(basis.mesh.dim(), -1)
            where = format_point(points[:, error.point])
            raise InadmissibleStress(
                f"{error}; that point lies at {where} in '{self.name}'", error.point
            ) from error

    def _points(self, basis: CellBasis) -> ndarray:
        """Return the integration points of the region, (dim, n_elements, n_points)."""
        return np.asarray(basis.global_coordinates())[:, self.elements]


def check_materials(
    regions: tuple[Region, ...], shape: tuple[int, ...], ncomp: int, coordinates: str | None
) -> None:
    """Try every material on unstrained points, (n_elements, n_points).

    Its parameters and its memory must fit.
    """
    for name, material, elements, _ in regions:
        n = len(range(shape[0])[elements]), shape[1]
        zero = np.zeros((ncomp, *n))
        try:
            if coordinates == "axisymmetric" and not material.axisymmetric:
                raise ValueError(
                    "planes that dip would be cones about the axis of symmetry: take level ones, "
                    "or a body in the plane"
                )
            # The memory has one shape, at the start and after a step.
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


def may_flow(region: Region, basis: CellBasis) -> bool:
    """Return True if a material may be plastic: with internal variables, or by large strains.

    A law without internal variables is tried: points of another tangent than the elastic one flow,
    unless the law gives its elastic strains.
    """
    law = region.material
    if law.n_internal:
        return True
    strain = _random_strain(region, basis)
    stress = np.zeros_like(strain)
    try:
        with np.errstate(all="ignore"):
            internal = law.initial_internal(stress)
            if law.elastic_strain(stress, internal) is not None:
                return False
            tried = updated(law, strain, stress, internal, 0.0)
    except (ValueError, ArithmeticError, IncrementTooLarge):
        return True
    return len(tried.plastic) > 0


def flows_at_constant_volume(region: Region, basis: CellBasis) -> bool:
    """Return True if mean stresses are the elastic ones of the change of volume, by large strains.

    They are in metals and in clay of undrained strength, not where pressure gives soil strength.
    """
    law = region.material
    strain = _random_strain(region, basis)
    stress = np.zeros_like(strain)
    bulk = bulk_modulus_of(law.elasticity(len(strain)))
    elastic = np.reshape(bulk, (-1, 1)) * strain[:3].sum(axis=0)
    limit = _ROUND_OFF * np.abs(elastic).max()
    for share in _SMALLER:
        try:
            with np.errstate(all="ignore"):
                internal = law.initial_internal(stress)
                tried = updated(law, share * strain, stress, internal, 0.0)
        except (ValueError, ArithmeticError, IncrementTooLarge):
            continue
        mean = tried.stress[:3].mean(axis=0)
        return bool((np.abs(mean - share * elastic) < share * limit).all())
    return False


def _random_strain(region: Region, basis: CellBasis) -> ndarray:
    """Return large strains of the points of a region, (n_components, n_elements, n_points)."""
    n = len(range(basis.nelems)[region.elements]), basis.X.shape[1]
    shape = (4 if basis.mesh.dim() == 2 else 6, *n)
    return np.asarray(np.random.default_rng(0).uniform(-_LARGE, _LARGE, shape))


def _check_memory(material: Material, call: str, internal: ndarray, n: tuple[int, int]) -> None:
    """Refuse internal variables that the material has not declared, or of a wrong shape."""
    shape = np.shape(internal)
    declared = (material.n_internal, *n)
    if shape != declared:
        names = ", ".join(variable.name for variable in material.internal) or "none"
        raise ValueError(
            f"{call} returns internal variables of shape {shape}, but {material.n_internal} "
            f"declared ({names}) make {declared}; declare all in `internal`"
        )


def by_region(
    basis: CellBasis, materials: Material | Mapping[str, Material]
) -> tuple[CellBasis, tuple[Region, ...]]:
    """Order the elements of a basis region by region, so that every region is a slice."""
    if not isinstance(materials, Mapping):
        return basis, (Region("all", materials),)
    if not materials:
        raise ValueError("there is no material: give one, or {subdomain: material}")
    subdomains = basis.mesh.subdomains or {}
    present = elements_of(basis)
    order = []
    regions = []
    start = 0
    for name, material in materials.items():
        # The elements of the subdomain that belong to the basis.
        part = np.asarray(look_up(name, subdomains, "subdomain"))
        check_no_mask(part, f"subdomain '{name}'")
        # each element once, in the order of its parameters
        _, first = np.unique(part, return_index=True)
        elements = part[np.sort(first)]
        elements = elements[np.isin(elements, present)]
        if len(elements) == 0:
            raise ValueError(f"subdomain '{name}' holds no element of this basis")
        stop = start + len(elements)
        order.append(elements)
        regions.append(Region(name, material, slice(start, stop)))
        start = stop
    # Every element must have one material.
    tind = np.concatenate(order)
    _check_cover(tind, present, materials, subdomains)
    if not np.array_equal(tind, present):
        basis = basis.with_elements(tind)
    return basis, tuple(regions)


def _check_cover(
    tind: ndarray,
    present: ndarray,
    materials: Mapping[str, Material],
    subdomains: Mapping[str, ndarray],
) -> None:
    """Refuse elements that have no material, or more than one."""
    unique, count = np.unique(tind, return_counts=True)
    if len(unique) < len(present):
        missing = np.setdiff1d(present, unique)
        raise ValueError(
            f"{len(missing)} of {len(present)} elements have no material; "
            f"they lie in the subdomains {tags_with(missing, subdomains)}"
        )
    if count.max() > 1:
        raise ValueError(
            f"{(count > 1).sum()} elements have more than one material: the subdomains "
            f"{list(materials)} overlap"
        )


def changed_moduli(
    material: Material,
    stress: ndarray,
    internal: ndarray,
    update: Update,
    damping: bool,
) -> tuple[ndarray, ndarray]:
    """Return points of other moduli than the elastic stiffness, and tangents, (n, ncomp, ncomp)."""
    plastic = update.plastic
    ncomp, n_elements, n_points = stress.shape
    if material.stress_dependent:
        # all points: elastic moduli of their stress, and tangents where they are plastic
        points = np.arange(n_elements * n_points)
        if len(plastic) == len(points) and not damping:  # no elastic moduli are needed
            return plastic, update.tangent()
        elasticity = material.elasticity(ncomp, stress, internal)
        moduli = elasticity.reshape(len(points), ncomp, ncomp).copy()
        if len(plastic):
            tangent = update.tangent()
            moduli[plastic] = damped(tangent, moduli[plastic]) if damping else tangent
        return points, moduli
    if not len(plastic):
        return plastic, np.zeros(0)
    tangent = update.tangent()
    if damping:
        elasticity = np.broadcast_to(material.elasticity(ncomp), (n_elements, ncomp, ncomp))
        tangent = damped(tangent, elasticity[plastic // n_points])
    return plastic, tangent


def elastic_strain(material: Material, stress: ndarray, internal: ndarray) -> ndarray:
    """Return elastic strains of stresses, (ncomp, n_elements, n_points), engineering shear."""
    known = material.elastic_strain(stress, internal)
    if known is not None:
        return known
    return by_elasticity(material, stress, stress, internal)


def by_elasticity(
    material: Material,
    change: ndarray,
    stress: ndarray,
    internal: ndarray,
) -> ndarray:
    """Return the strains of a change of stresses, with the elasticity of a state."""
    ncomp = len(stress)
    if material.stress_dependent:
        moduli = material.elasticity(ncomp, stress, internal)
    else:
        # One matrix for all points, or one for each element.
        moduli = np.asarray(material.elasticity(ncomp))
        if moduli.ndim == 2:
            return np.linalg.solve(moduli, change.reshape(ncomp, -1)).reshape(change.shape)
        moduli = moduli[:, None]
    by_point = np.moveaxis(change, 0, -1)
    strain = np.linalg.solve(moduli, by_point[..., None])[..., 0]
    return np.moveaxis(strain, -1, 0)


def inherited(old: Region, new: Region, stress: ndarray, internal: ndarray) -> bool:
    """Change stresses and memory where a region gets another material; return True if any changes.

    Variables of the same name keep their values, others start from the stress. Ground that was
    undrained and is drained now loses its excess pore pressure.
    """
    # Find the elements that both regions have.
    every = range(stress.shape[1])
    before = every[old.elements]
    after = every[new.elements]
    common = slice(max(before.start, after.start), min(before.stop, after.stop))
    if common.start >= common.stop or old.material is new.material:
        return False
    # Memory of the same variables stays.
    names = [variable.name for variable in new.material.internal]
    known = [variable.name for variable in old.material.internal]
    drains = old.material.undrained and not new.material.undrained
    if names == known[: len(names)] and not drains:
        return False
    # Effective stresses replace those of undrained ground.
    if drains:
        drained = old.material.drained(stress[:, common], internal[:, common])
        stress[:, common], internal[:, common] = drained
    # Keep the variables that both laws know, and begin the others.
    memory = internal[:, common].copy()
    first = new.material.initial_internal(stress[:, common])
    for row, name in enumerate(names):
        kept = old.material.variable(name, memory)
        internal[row, common] = first[row] if kept is None else kept
    return True
