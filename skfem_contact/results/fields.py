"""Fields at nodes, region by region: displacements, strains, stresses and derived quantities."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from operator import itemgetter
from typing import Any, Literal, NamedTuple, Protocol

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import CellBasis

from ..arrays import quotient
from ..checks import look_up
from ..forms.base import solids_of
from ..forms.roles import Wet, having
from ..forms.solid import SolidForm
from ..layout import Layout
from ..loads.water_at_rest import at_nodes
from ..materials.spectral import largest_shear, principal_stresses
from .files import StageData
from .patch_recovery import recovered, region_mesh
from .strength import mises, mobilised, plastic_strain, pore_pressure_at_nodes, total_stress


class _PressureField(Protocol):
    def pressure_at(self, x: ndarray) -> ndarray: ...


#: Given pore pressure: seepage, or a function of coordinates (dim, n).
Water = _PressureField | Callable[[ndarray], ndarray]
#: Pressure that a picture or a field adds: a given one, a level, a line of points (n, 2) or water
#: by region as of a stage; True, the stage's own water; False, none. ``ArrayLike`` may hold `bool`.
Shown = Water | ArrayLike | Mapping[str, Any] | Literal[True, False]


class Quantity(NamedTuple):
    """Field with its title, kind of unit, source at the nodes, and function of the source.

    The functions of ``"points"``, values at integration points that limit those at the nodes, and
    of ``"nodes"`` take a solid and a state.
    """

    title: str
    unit: Literal["length", "stress", ""]
    source: Literal["displacement", "strain", "stress", "points", "nodes"]
    value: Callable[..., ndarray]


#: Fields of plane bodies.
PLANE = {
    "ux": Quantity("horizontal displacement", "length", "displacement", itemgetter(0)),
    "uy": Quantity("vertical displacement", "length", "displacement", itemgetter(1)),
    "u": Quantity("displacement", "length", "displacement", lambda u: np.hypot.reduce(u, axis=0)),
    "sxx": Quantity("horizontal stress", "stress", "stress", itemgetter(0)),
    "syy": Quantity("vertical stress", "stress", "stress", itemgetter(1)),
    "szz": Quantity("out-of-plane stress", "stress", "stress", itemgetter(2)),
    "sxy": Quantity("shear stress", "stress", "stress", itemgetter(3)),
    "s1": Quantity(
        "largest principal stress", "stress", "stress", lambda s: principal_stresses(s)[0]
    ),
    "s2": Quantity(
        "middle principal stress", "stress", "stress", lambda s: principal_stresses(s)[1]
    ),
    "s3": Quantity(
        "smallest principal stress", "stress", "stress", lambda s: principal_stresses(s)[2]
    ),
    "mean": Quantity("mean stress", "stress", "stress", lambda s: s[:3].mean(axis=0)),
    "mises": Quantity("von Mises stress", "stress", "stress", mises),
    "exx": Quantity("horizontal strain", "", "strain", itemgetter(0)),
    "eyy": Quantity("vertical strain", "", "strain", itemgetter(1)),
    "exy": Quantity("engineering shear strain", "", "strain", itemgetter(3)),
    "gamma": Quantity("largest shear strain", "", "strain", largest_shear),
    "ev": Quantity("volumetric strain", "", "strain", lambda e: e[:3].sum(axis=0)),
    "plastic": Quantity("equivalent plastic strain", "", "points", plastic_strain),
    "mobilised": Quantity("mobilised strength", "", "points", mobilised),
    "pore": Quantity("excess pore pressure", "stress", "nodes", pore_pressure_at_nodes),
}

#: Fields of bodies in space.
SPACE = PLANE | {
    "ux": Quantity("displacement along x", "length", "displacement", itemgetter(0)),
    "uy": Quantity("displacement along y", "length", "displacement", itemgetter(1)),
    "uz": Quantity("displacement along z", "length", "displacement", itemgetter(2)),
    "sxx": Quantity("stress along x", "stress", "stress", itemgetter(0)),
    "syy": Quantity("stress along y", "stress", "stress", itemgetter(1)),
    "szz": Quantity("stress along z", "stress", "stress", itemgetter(2)),
    "syz": Quantity("shear stress yz", "stress", "stress", itemgetter(4)),
    "szx": Quantity("shear stress zx", "stress", "stress", itemgetter(5)),
}


def nodal_field(
    stage: StageData,
    name: str,
    since: StageData | None = None,
    *,
    water: Shown | None = None,
) -> ndarray:
    """Return a field at the nodes, shape (N / dim,), the mesh's vertices first.

    Nodes of no solid have NaN. Stresses are recovered at the nodes of every region from its
    elements' forces and stresses (:doc:`theory </theory/recovery>`), invariants follow from
    these. A node between regions has the mean of their values. Stresses are effective where
    water acts, but contain the excess pressure of :class:`Undrained` ground.

    Parameters
    ----------
    name
        ``"ux"``, ``"uy"``, ``"u"`` (length of the displacement); stresses ``"sxx"``, ``"syy"``,
        ``"szz"``, ``"sxy"``; principal stresses ``"s1"`` >= ``"s2"`` >= ``"s3"``; ``"mean"``,
        ``"mises"``; strains ``"exx"``, ``"eyy"``, ``"exy"`` (engineering shear), ``"gamma"``
        (largest shear strain, in the plane), ``"ev"`` (volumetric); ``"plastic"``, the
        equivalent plastic strain (zero in elastic bodies); ``"mobilised"``, the share of the
        shear strength that is used; ``"pore"``, the excess pore pressure of :class:`PoreWater`
        or of undrained ground, with the pressure of `water`. In three dimensions also ``"uz"``,
        ``"syz"``, ``"szx"``.
    since
        Earlier stage from which the change is returned; displacements of bodies that it does
        not hold count from their activation. Invariants of strains follow from the change of
        the strains; invariants of stresses are subtracted.
    water
        Further pore pressure: a level, a line or water by region, a
        :class:`~skfem_contact.water.Seepage`, a function of coordinates such as
        :func:`hydrostatic`, or True, the stage's own water; False: none.
    """
    values = region_field(stage, name, since, water)
    bodies = solids(stage)
    nodes = region_mesh(*bodies.values()).nodes
    basis = basis_of(stage)
    n = basis.N // basis.mesh.dim()
    total = np.bincount(nodes, values, n)
    count = np.bincount(nodes, minlength=n)
    return quotient(total, count, np.nan)


def region_field(
    stage: StageData,
    name: str,
    since: StageData | None,
    water: Shown | None,
    elements: Mapping[str, ndarray] | None = None,
) -> ndarray:
    """Return a field as :func:`nodal_field` does, at the nodes of the :func:`region_mesh`.

    Where some elements of each solid are given by its name, only their nodes have values.
    """
    # Check what is asked for.
    quantity = look_up(name, quantities(stage), "field")
    if water is False:
        water = None
    if name == "pore" and water is None and not has_excess(stage):
        raise ValueError(
            "pore pressure where there is no PoreWater and no ground is Undrained: give water=True "
            "for the water of the stage, a level, a line, a Seepage, or a function of coordinates"
        )
    bodies = solids(stage)
    if since is not None:
        _check_same_mesh(stage, since, bodies)
    # Evaluate the field of each solid, at its own nodes.
    parts = []
    for key, form in bodies.items():
        own = None if elements is None else elements[key]
        parts.append(_of_form(form, stage, key, quantity, since, own))
    values = np.concatenate(parts)
    if name == "pore":
        values = values + _of_water(stage, bodies, since, water)
    return values


def _of_water(
    stage: StageData,
    bodies: Mapping[str, SolidForm],
    since: StageData | None,
    water: Shown | None,
) -> ndarray:
    """Return the pore pressure that is no state of the solids, at the nodes of their mesh."""
    # Add the excess pressure of flowing water, and the pressure of the stage's water.
    basis = basis_of(stage)
    nodes = region_mesh(*bodies.values()).nodes
    values = _excess(stage, nodes)
    if water is True:
        values = values + _at_rest(stage, bodies, stage.water)
        if since is not None:
            values = values - _at_rest(since, bodies, since.water)
    if since is not None:
        return values - _excess(since, nodes)
    if water is None or water is True:
        return values

    # Add a given pressure, everywhere, or the pressure of a level in the pores.
    pressure: Any = getattr(water, "pressure_at", water)
    if callable(pressure):
        return np.asarray(values + pressure(basis.doflocs[:, basis.mesh.dim() * nodes]))
    return values + _at_rest(stage, bodies, water)


def _at_rest(stage: StageData, bodies: Mapping[str, SolidForm], water: Any) -> ndarray:
    """Return the pressure of water in the pores at the nodes of the :func:`region_mesh`, (n,)."""
    if water is None or isinstance(water, str):
        raise ValueError(
            f"the water of stage '{stage.name}' is {water or 'not given'}: give water= a level, a "
            "line, a Seepage, or a function of coordinates"
        )
    parts = []
    for name, form in bodies.items():
        mesh = region_mesh(form)
        pressure = np.zeros(len(mesh.nodes))
        if form.porous and name in stage.states and water is not False:
            pressure[mesh.cells] = at_nodes(form, water, stage.water_unit_weight)
        parts.append(pressure)
    return np.concatenate(parts)


def has_excess(stage: StageData) -> bool:
    """Return True if water flows, or some ground is or was undrained."""
    for form in solids(stage).values():
        if any(material.undrained for material in form.materials.values()):
            return True
    return any(True for _ in _pressures(stage))


def undrained_elements(forms: Mapping[str, Any]) -> ndarray:
    """Return the elements whose ground is Undrained."""
    parts = [np.zeros(0, int)]
    for form in solids_of(forms).values():
        for region in form.regions:
            if region.material.undrained:
                parts.append(form.elements[region.elements])
    return np.concatenate(parts)


def undrained_excess(stage: StageData, layout: Layout, elements: ndarray) -> ndarray:
    """Return all dofs, (N,), with the pressures of some elements that were Undrained, else zero."""
    values = np.zeros(layout.size)
    undrained = np.intersect1d(undrained_elements(stage.forms), elements)
    if not len(undrained):
        return values
    nodal = nodal_field(stage, "pore")
    vertices = np.unique(basis_of(stage).mesh.t[:, undrained])
    for field, part in zip(layout.fields, layout.parts, strict=True):
        if field.kind == "pressure":
            # Pressures are at vertices only, also in meshes of second order.
            own = vertices[vertices < field.n]
            values[part.start + own] = nodal[own]
    return values


def quantities(stage: StageData, water: Shown | None = None) -> dict[str, Quantity]:
    """Return the fields of a stage, in the plane or in space."""
    fields = SPACE
    if basis_of(stage).mesh.dim() == 2:
        fields = PLANE
    if water is None or water is False:
        return fields
    return fields | {"pore": fields["pore"]._replace(title="pore pressure")}


def solids(stage: StageData) -> dict[str, SolidForm]:
    """Return the solids of a stage."""
    if not isinstance(stage, StageData):
        raise ValueError(
            f"one stage is needed, result[name of the stage], not {type(stage).__name__}"
        )
    found = {}
    for name, form in solids_of(stage.forms).items():
        if form.materials and name in stage.states:
            found[name] = form
    if not found:
        raise ValueError(
            f"there is no SolidForm in stage '{stage.name}', which holds {list(stage.states)}"
        )
    return found


def has_solids(stage: StageData) -> bool:
    """Return True if a stage holds a solid."""
    return any(form.materials for form in solids_of(stage.forms).values())


def basis_of(stage: StageData) -> CellBasis:
    """Return the basis of the displacements."""
    return next(iter(solids(stage).values())).basis


def _check_same_mesh(stage: StageData, since: StageData, bodies: Mapping[str, SolidForm]) -> None:
    """Refuse an earlier stage of another mesh."""
    for name in bodies:
        if name not in since.states:
            continue
        now = stage.x.shape, stage.states[name].stress.shape
        before = since.x.shape, since.states[name].stress.shape
        if now != before:
            raise ValueError(
                f"since: stage '{since.name}' is of another mesh than stage '{stage.name}': "
                f"{before[0][0]} dofs and {before[1][1]} elements of '{name}', not {now[0][0]} "
                f"and {now[1][1]}"
            )


def _of_form(
    form: SolidForm,
    stage: StageData,
    name: str,
    quantity: Quantity,
    since: StageData | None,
    elements: ndarray | None,
) -> ndarray:
    """Return the field of one solid, without pressures of flowing and of given water."""
    state = stage.states[name]
    before = None if since is None else since.states.get(name)
    # Displacements and strains are those of the body.
    if quantity.source == "displacement":
        x = (stage.x - reference(stage, since, name))[: form.basis.N]
        u = x.reshape(-1, form.basis.mesh.dim()).T
        return quantity.value(u[:, region_mesh(form).nodes])
    if quantity.source == "strain":
        strain = form.total_strain(state)
        if before is not None:
            strain = strain - form.total_strain(before)
        return quantity.value(recovered(form, strain, elements=elements))
    # Other fields follow from the state, or from its change.
    values = _of_state(form, state, quantity, elements)
    if before is None:
        return values
    return values - _of_state(form, before, quantity, elements)


def _of_state(form: SolidForm, state: Any, quantity: Quantity, elements: ndarray | None) -> ndarray:
    """Return the field of one solid that follows from its stress or memory in a state."""
    if quantity.source == "stress":
        balanced = form.kinematics != "finite"  # forces are of the undeformed body
        total = total_stress(form, state)
        return quantity.value(recovered(form, total, balanced=balanced, elements=elements))
    values = quantity.value(form, state)
    if quantity.source == "nodes":
        return values
    return recovered(form, values[None], limited=True, elements=elements)[0]


def reference(stage: StageData, since: StageData | None, name: str) -> ndarray:
    """Return the displacements at an earlier stage that holds a solid, or at its activation."""
    if since is not None and name in since.states:
        return since.x
    return stage.placed.get(name, np.zeros_like(stage.x))


def _pressures(stage: StageData) -> Iterator[ndarray]:
    """Yield the excess pressures of flowing water at all nodes, (N/dim,)."""
    for water in having(stage.forms, Wet).values():
        yield water.pressure_at_nodes(stage.x)


def _excess(stage: StageData, nodes: ndarray) -> ndarray:
    """Return the excess pressure of consolidating ground at some nodes, zero elsewhere."""
    pressure = np.zeros(len(nodes))
    for own in _pressures(stage):
        # Parts of the ground share nodes and their pressures.
        pressure = np.where(pressure == 0.0, own[nodes], pressure)
    return pressure
