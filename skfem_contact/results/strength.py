"""Strength of the ground: mobilised share, status of points, undrained pressure and strength."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from enum import IntEnum
from itertools import product
from typing import Any

import numpy as np
import scipy
from numpy import ndarray

from ..arrays import max_abs, quotient
from ..checks import finite, look_up
from ..errors import Remark
from ..forms.base import Forms, States, solids_of
from ..forms.roles import Touching, having
from ..forms.solid import SolidForm, SolidState
from ..layout import linear_element
from ..materials import spectral
from ..materials.base import EXCESS_PRESSURE, PLASTIC_STRAIN
from .patch_recovery import projected, recovered, region_mesh, within_points

#: Points this close to their strength count as yielding: stresses return to it up to round-off.
_AT_YIELD = 1e-6
#: Elements whose displacement is above this share of the largest belong to a mechanism.
_MOVES = 0.05
#: Mean excess pressure at a contact, as a share of its mean pressure, that is remarked on.
_IN_FRICTION = 0.05


class PointStatus(IntEnum):
    """Status of an integration point."""

    ELASTIC = 0
    YIELDS = 1
    TENSION = 2


def mises(stress: ndarray) -> ndarray:
    """Return von Mises' equivalent of stresses (4 or 6, ...)."""
    return np.sqrt(3.0) * spectral.mean_and_shear(stress)[1]


def plastic_strain(form: SolidForm, state: SolidState) -> ndarray:
    """Return the equivalent plastic strain of a solid's points, (n_elements, n_points)."""
    return form.variable(PLASTIC_STRAIN, state)


def mobilised(form: SolidForm, state: SolidState) -> ndarray:
    """Return the mobilised share of the strength at points, 0 to 1, (n_elements, n_points).

    For cohesion and friction it is the radius of Mohr's circle over the distance of its centre from
    the yield line. The share is zero where a material cannot fail, and NaN where the law does not
    define it.
    """
    share = np.full(form.weight.shape, np.nan)
    for region, stress, internal in form.at_regions(state):
        measured = region.material.mobilised(stress, internal)
        if measured is not None:
            measure, limit = np.broadcast_arrays(*measured)
            # Points without a strength have no share.
            used = np.clip(quotient(measure, limit, 1.0), 0.0, 1.0)
            share[region.elements] = np.where(np.isfinite(limit), used, 0.0)
    return share


def point_status(form: SolidForm, state: SolidState) -> ndarray:
    """Return the :class:`PointStatus` of the points of a solid, (n_elements, n_points)."""
    # Points at their strength yield.
    yields = mobilised(form, state) > 1.0 - _AT_YIELD
    status = np.where(yields, PointStatus.YIELDS, PointStatus.ELASTIC)
    for region, stress, internal in form.at_regions(state):
        limit = region.material.tensile_strength
        if limit is None:
            continue
        if isinstance(limit, ndarray):
            limit = limit.reshape(len(limit), -1)
        # Those whose largest principal stress is the tensile strength are torn.
        effective, _ = region.material.drained(stress, internal)
        scale = max_abs(effective[:3])
        largest = spectral.principal_stresses(effective)[0]
        torn = largest >= limit - _AT_YIELD * (scale + limit)
        status[region.elements][torn] = PointStatus.TENSION
    return status


def pore_pressure(form: SolidForm, state: SolidState) -> ndarray:
    """Return the excess pressure of :class:`Undrained` ground, (n_elements, n_points).

    In elements of second order the volume of nearly incompressible ground is right in the mean with
    every linear function only, so pressures are projected on linear functions: under a strip load
    q, at nodes, an error of .33 q becomes .02 q. The pressure is zero in other regions.
    """
    values = form.variable(EXCESS_PRESSURE, state)
    if not values.any() or not _has_midside_nodes(form):
        return values
    N, _, pressure = projected(form, values[None])
    return (N @ pressure).reshape(values.shape)


def pore_pressure_at_nodes(form: SolidForm, state: SolidState) -> ndarray:
    """Return the excess pore pressure at the nodes of the :func:`region_mesh` of a solid, (n,)."""
    values = form.variable(EXCESS_PRESSURE, state)
    if not values.any() or not _has_midside_nodes(form):
        return recovered(form, values[None], limited=True)[0]
    N, vertex, pressure = projected(form, values[None])

    # Evaluate the linear functions at all nodes: every element of a node has the same value.
    mesh = region_mesh(form)
    linear = linear_element(form.basis.mesh)
    locations = form.basis.elem.elem.doflocs.T
    corners = range(vertex.shape[1])
    shapes = np.array([linear.lbasis(locations, j)[0] for j in corners])  # (corners, nodes)
    nodal = np.zeros(len(mesh.nodes))
    nodal[mesh.cells] = pressure[vertex, 0] @ shapes
    at_points = (N @ pressure).reshape(1, *values.shape)
    return within_points(nodal[None], at_points, mesh)[0]


def _has_midside_nodes(form: SolidForm) -> bool:
    return form.basis.elem.elem.doflocs.shape[0] > len(form.basis.mesh.t)


def total_stress(form: SolidForm, state: SolidState) -> ndarray:
    """Return Cauchy stresses with the :func:`pore_pressure`, (n_components, n_elements, ...)."""
    at_points = form.variable(EXCESS_PRESSURE, state)
    stress = form.cauchy(state)
    if not at_points.any():
        return stress
    stress = stress.copy()
    stress[:3] += at_points - pore_pressure(form, state)
    return stress


def undrained_friction(forms: Forms, states: States) -> Iterator[tuple[str, Remark]]:
    """Yield contact pairs with friction and remarks on the excess pressure of undrained ground."""
    pairs = {name: pair for name, pair in having(forms, Touching).items() if pair.has_friction}
    if not pairs:
        return

    # Collect dofs and pressures of the elements of undrained regions.
    grounds = []
    for name, form in solids_of(forms).items():
        for region in form.regions:
            if region.material.undrained:
                dofs = form.basis.element_dofs[:, region.elements]
                grounds.append((dofs, pore_pressure(form, states[name])[region.elements]))

    # Compare the pressure next to each pair with its traction.
    for (name, pair), (dofs, pressure) in product(pairs.items(), grounds):
        adjacent = np.isin(dofs, pair.joins).any(axis=0)
        normal = states[name].traction[0]
        if not adjacent.any() or not (normal < 0.0).any():
            continue
        excess = float(pressure[adjacent].mean())
        total = -float(normal[normal < 0.0].mean())
        if abs(excess) > _IN_FRICTION * total:
            text = (
                f"the ground beside it is undrained, with an excess pressure of {excess:.3g} on "
                f"average: friction counts the total stress, {total:.3g}, not the effective one"
            )
            yield name, Remark("undrained", abs(excess) / total, text)


def undrained_strength(form: SolidForm, state: SolidState) -> dict[str, ndarray]:
    """Return the undrained shear strength of a plane solid by region, (n_elements,) each."""
    if form.coordinates != "plane":
        where = "axisymmetric"
        if form.coordinates == "space":
            where = "in space"
        raise ValueError(f"the undrained strength is that of plane strain; this solid is {where}")
    # Take means of the effective stress s' over the elements: water in the pores takes its part.
    excess = form.variable(EXCESS_PRESSURE, state)
    in_plane = -0.5 * (state.stress[0] + state.stress[1]) + excess
    mean = (in_plane * form.weight).sum(axis=1) / form.weight.sum(axis=1)

    # Ask the materials.
    strength = {}
    for region, _, internal in form.at_regions(state):
        internal = internal.mean(axis=2)
        of_region = region.material.undrained_strength(mean[region.elements], internal)
        if of_region is not None:
            strength[region.name] = of_region
    if not strength:
        raise ValueError(
            f"no region has an undrained strength; the regions are {list(form.materials)}"
        )
    return strength


def shansep(
    form: SolidForm,
    state: SolidState,
    S: float,
    m: float,
    OCR: float | Callable[[ndarray], Any],
    POP: float | Callable[[ndarray], Any],
) -> dict[str, ndarray]:
    r"""Return undrained strengths by region, (n_elements,) each.

    .. math:: s_u = S \, \sigma_v' \, (\sigma_p' / \sigma_v')^m , \qquad
              \sigma_p' = {\rm OCR} \, \sigma_v' + {\rm POP}
    """
    # Find the vertical effective stress at points, compression positive.
    dim = form.basis.mesh.dim()
    axis = dim - 1
    x = np.asarray(form.basis.global_coordinates())
    ratio = _at(OCR, x, "OCR", 1.0)
    excess = _at(POP, x, "POP", 0.0)
    strength = {}
    for region, stress, internal in form.at_regions(state):
        effective, _ = region.material.drained(stress, internal)
        # s_u = S sigma_v' OCR^m
        vertical = np.maximum(-effective[axis], 0.0)
        part = region.elements
        largest = ratio[part] * vertical + excess[part]
        over = quotient(largest, vertical, 1.0)
        values = S * vertical * over**m
        weight = form.weight[part]
        strength[region.name] = (values * weight).sum(axis=1) / weight.sum(axis=1)
    return strength


def drawdown(
    form: SolidForm,
    state: SolidState,
    after: SolidState | None,
    region: str | None,
    drained: tuple[float, float],
    total: tuple[float, float],
    mechanism: ndarray | None,
) -> dict[str, ndarray]:
    """Return strengths after a rapid drawdown by region, (n_elements,) each.

    See :meth:`~skfem_contact.results.StageResult.drawdown_strength`.
    """
    # Check the region, and find the planes of slip.
    names = [one.name for one in form.regions]
    if region is not None and region not in names:
        look_up(region, dict.fromkeys(names), "region")
    c = drained[0]
    phi = np.radians(drained[1])
    if mechanism is None:
        planes = None
    else:
        planes = slip_planes(form, mechanism)
    strength = {}
    for one, stress, internal in form.at_regions(state):
        if region not in (None, one.name):
            continue
        # Consolidation is that of the effective stress before the drawdown.
        effective, _ = one.material.drained(stress, internal)
        plane = None if planes is None else planes[:, one.elements]
        values = _undrained(effective, c, phi, total, plane)
        # Drained strength counts where it is smaller afterwards.
        if after is not None:
            part = after.stress[:, one.elements]
            normal, _ = _consolidation(part, phi, plane)
            values = np.minimum(values, np.maximum(c + normal * np.tan(phi), 0.0))
        weight = form.weight[one.elements]
        strength[one.name] = (values * weight).sum(axis=1) / weight.sum(axis=1)
    return strength


def slip_planes(form: SolidForm, mechanism: ndarray) -> ndarray:
    """Return unit vectors along the displacements of a mechanism in elements, (2, n_elements, 1).

    A mass slides along its slip surface. Elements that hardly move take the direction of the
    nearest one that does.
    """
    # Mean displacements of the elements.
    field = np.asarray(form.basis.interpolate(mechanism[: form.basis.N]))
    middle = np.asarray(form.basis.global_coordinates()).mean(axis=-1)
    moved = field.mean(axis=-1)
    size = np.linalg.norm(moved, axis=0)
    moves = size > _MOVES * size.max()
    # Elements that stay take the direction of the nearest that moves.
    nearest = scipy.spatial.cKDTree(middle[:, moves].T).query(middle.T)[1]
    along = moved[:, moves] / size[moves]
    return along[:, nearest, None]


def _consolidation(stress: ndarray, phi: float, plane: ndarray | None) -> tuple[ndarray, ndarray]:
    r"""Return normal stress on a failure plane, and the ratio of principal stresses.

    On planes at :math:`45 + \varphi' / 2` degrees to the largest principal stress, or on given ones
    with the ratio that follows if failure would occur on them (Duncan, Wright and Wong),

    .. math:: K_c = \frac{\sigma_{fc} + \tau_{fc} (\sin\varphi' + 1) / \cos\varphi'}
                        {\sigma_{fc} + \tau_{fc} (\sin\varphi' - 1) / \cos\varphi'} .
    """
    if plane is None:
        return _on_failure_plane(stress, phi)
    # Resolve the stresses, compression positive, along the plane t and across it.
    x, y = plane
    normal = -(stress[0] * y**2 + stress[1] * x**2 - 2.0 * stress[3] * x * y)
    shear = np.abs((stress[1] - stress[0]) * x * y + stress[3] * (x**2 - y**2))
    largest = normal + shear * (np.sin(phi) + 1.0) / np.cos(phi)
    smallest = normal + shear * (np.sin(phi) - 1.0) / np.cos(phi)
    return normal, quotient(largest, smallest, np.inf)


def _on_failure_plane(stress: ndarray, phi: float) -> tuple[ndarray, ndarray]:
    """Return normal stress on the failure plane, and the ratio of the principal stresses.

    Compression is positive, and principal stresses are those in the plane:
    sigma_fc = ((s1 + s3) - (s1 - s3) sin(phi)) / 2.
    """
    centre = -0.5 * (stress[0] + stress[1])
    radius = np.hypot(0.5 * (stress[0] - stress[1]), stress[3])
    normal = centre - radius * np.sin(phi)
    smallest = centre - radius
    return normal, quotient(centre + radius, smallest, np.inf)


def _undrained(
    stress: ndarray,
    c: float,
    phi: float,
    total: tuple[float, float],
    plane: ndarray | None = None,
) -> ndarray:
    r"""Return the undrained strength on the failure plane from stresses of consolidation.

    With the line of isotropic consolidation :math:`d + \sigma_{fc}' \tan\psi`,
    :math:`d = c_R \cos\varphi_R \cos\varphi' / (1 - \sin\varphi_R)` and
    :math:`\tan\psi = \sin\varphi_R \cos\varphi' / (1 - \sin\varphi_R)`, and the drained line, the
    strength is interpolated by the ratio of the principal stresses between 1 and that of failure.
    """
    c_R = total[0]
    phi_R = np.radians(total[1])
    normal, ratio = _consolidation(stress, phi, plane)
    normal = np.maximum(normal, 0.0)
    # The line of isotropic consolidation, and the drained line.
    share = np.cos(phi) / (1.0 - np.sin(phi_R))
    isotropic = share * (c_R * np.cos(phi_R) + normal * np.sin(phi_R))
    drained = c + normal * np.tan(phi)
    # Between both by the ratio of principal stresses over that at failure.
    sine = np.sin(phi)
    held = c * np.cos(phi)
    below = (normal - held) * (1.0 - sine)
    at_failure = quotient((normal + held) * (1.0 + sine), below, np.inf)
    usual = np.isfinite(at_failure) & np.isfinite(ratio) & (at_failure > 1.0)
    way = np.clip(
        np.divide(ratio - 1.0, at_failure - 1.0, out=np.ones_like(normal), where=usual), 0.0, 1.0
    )
    between = (1.0 - way) * isotropic + way * drained
    # close to zero or negative stresses the lower line counts
    return np.where(usual, between, np.minimum(isotropic, drained))


def _at(value: Any, x: ndarray, name: str, least: float) -> ndarray:
    """Return a number or a function of the coordinates (dim, n_elements, n_points) at points."""
    given = value(x) if callable(value) else value
    values = np.broadcast_to(finite(given, name), x.shape[1:])
    if (values < least).any():
        raise ValueError(f"{name} must be at least {least:g}, but is {values.min():g} somewhere")
    return values
