"""Fields at nodes, region by region: displacements, strains, stresses and what follows from them."""
from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy import ndarray

from ..errors import look_up
from ..solid import SolidForm
from ..stages.result import StageResult
from ..water import PoreWater, Seepage
from .quantities import PLANE, SPACE, Quantity
from .recovery import RegionField, recovered, recovered_stress, regions_of
from .strength import mobilised
from .undrained import pore_pressure, soil_of

#: Pore pressure: seepage, or a function of places (2, n).
Water = Seepage | Callable[[ndarray], ndarray]


def nodal_field(forms: Mapping[str, Any], step: StageResult, quantity: str, since: StageResult | None = None,
                water: Water | None = None) -> ndarray:
    """A field at the nodes.

    Stresses are recovered at the nodes of every region of every body from the forces and the stresses of its elements
    (:doc:`theory </theory/recovery>`); nothing is taken across a contact or from another material. A node between two
    regions has the mean of theirs here, and both in pictures and files. Invariants are those of the recovered stress.

    Parameters
    ----------
    forms
        Forms by name; the solids among them that are there in the stage count.
    step
        A stage of the result of these forms.
    quantity
        ``"ux"``, ``"uy"``, ``"u"`` (length of the displacement); stresses ``"sxx"``, ``"syy"``, ``"szz"``, ``"sxy"``;
        principal stresses ``"s1"`` >= ``"s2"`` >= ``"s3"``; ``"mean"``, ``"mises"``; strains ``"exx"``, ``"eyy"``,
        ``"exy"`` (engineering shear), ``"gamma"`` (largest shear strain, in the plane), ``"ev"`` (volumetric);
        ``"plastic"``, the equivalent plastic strain (zero in elastic bodies); ``"mobilised"``, the share of the shear
        strength that is used; ``"pore"``, the excess pore pressure of :class:`PoreWater` or of undrained ground, and
        that of `water` with it. In three dimensions also ``"uz"``, ``"syz"``, ``"szx"``.
    since
        An earlier stage: the change from there on. Displacements and strains are those of the change; invariants of
        stresses are subtracted.
    water
        Pore pressure that was given: a :class:`Seepage`, or a function of places such as :func:`hydrostatic`.

    Returns
    -------
    ndarray
        Values at the nodes of the basis, (N/dim,), the mesh's vertices first; NaN where there is no solid.

    Raises
    ------
    ValueError
        Unknown quantity, or no solid among the forms is there in the stage.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(2).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> forms = {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.))}
    >>> fixed = np.hstack((basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1")))
    >>> result = sc.run(forms, [sc.Stage("weight", sc.weight(basis, 20.))], fixed=fixed)
    >>> stress = sc.nodal_field(forms, result["weight"], "syy")
    >>> stress[basis.mesh.p[0] == 0.][[0, 2, 1]].round(2) + 0.      # at the bottom, in the middle, at the top
    array([-20., -10.,   0.])
    """
    fields = region_fields(forms, step, quantity, since, water)
    basis = next(iter(solids(forms).values())).basis
    n = basis.N // basis.mesh.dim()
    total, count = np.zeros(n), np.zeros(n)
    for field in fields:
        total[field.nodes] += field.values[0]
        count[field.nodes] += 1
    return np.divide(total, count, out=np.full(n, np.nan), where=count > 0)


def region_fields(forms: Mapping[str, Any], step: StageResult, quantity: str, since: StageResult | None = None,
                  water: Water | None = None) -> list[RegionField]:
    """The field of every region of all solids that are there, values (1, n_nodes); arguments of :func:`nodal_field`."""
    found = solids_there(forms, step)
    what = look_up(quantity, quantities(found), "field")
    if quantity == "pore" and water is None and not has_excess(forms, found):
        raise ValueError("pore pressure where there is no PoreWater and no ground is Undrained: give water=, a Seepage "
                         "or a function of places such as hydrostatic(level)")
    fields: list[RegionField] = []
    for name, form in found.items():
        fields += _of_form(form, step, name, quantity, what, since, water)
    return fields


def has_excess(forms: Mapping[str, Any], there: Mapping[str, SolidForm]) -> bool:
    """Whether excess pore pressures are computed: water flows, or some ground is or was undrained."""
    grounds = [material for form in (*there.values(), *solids(forms).values()) for material in form.materials.values()]
    return any(isinstance(form, PoreWater) for form in forms.values()) or any(soil_of(m) is not m for m in grounds)


def quantities(forms: Mapping[str, SolidForm], water: Water | None = None) -> dict[str, Quantity]:
    """The fields that there are of these solids."""
    fields = PLANE if next(iter(forms.values())).basis.mesh.dim() == 2 else SPACE
    return fields if water is None else fields | {"pore": fields["pore"]._replace(title="pore pressure")}


def solids(forms: Mapping[str, Any]) -> dict[str, SolidForm]:
    """The solids among the forms."""
    found = {name: form for name, form in forms.items() if isinstance(form, SolidForm)}
    if not found:
        raise ValueError(f"there is no SolidForm among the forms {list(forms)}")
    return found


def solids_there(forms: Mapping[str, Any], step: StageResult) -> dict[str, SolidForm]:
    """The solids among the forms that are there in a stage, with the materials that they have there."""
    if not hasattr(step, "states"):
        raise ValueError(f"one stage is needed, result[name of the stage], not {type(step).__name__}")
    given = solids(forms)
    found = {name: form for name, form in given.items() if name in step.states}
    if not found:
        raise ValueError(f"none of the solids {list(given)} is there in stage '{step.name}', which holds "
                         f"{list(step.states)}")
    return solids({name: step.forms.get(name, form) for name, form in found.items()})


def plastic_strain(state: Any) -> ndarray:
    """Equivalent plastic strain of a solid's state, (1, n_elements, n_points)."""
    return state.internal[:1] if len(state.internal) else np.zeros((1, *state.stress.shape[1:]))


def _of_form(form: SolidForm, step: StageResult, name: str, quantity: str, what: Quantity,
             since: StageResult | None, water: Water | None) -> list[RegionField]:
    """The field of the regions of one solid."""
    state, before = step.states[name], None if since is None else since.states.get(name)
    if what.source == "displacement":
        x = step.x if since is None else step.x - since.x
        return _valued(what, _displaced(form, x))
    if what.source == "strain":
        return _valued(what, recovered(form, state.strain if before is None else state.strain - before.strain))
    at = _at_points if what.source == "points" else _stress
    now = _valued(what, at(form, state, quantity))
    if quantity == "pore":
        n = form.basis.N // form.basis.mesh.dim()
        excess = _excess(step, n) - (0.0 if since is None else _excess(since, n))
        now = [field._replace(values=field.values + excess[field.nodes]) for field in now]
    if quantity == "pore" and water is not None and since is None:
        pressure = water.pressure_at if isinstance(water, Seepage) else water
        places = form.basis.doflocs[:, ::form.basis.mesh.dim()]
        return [field._replace(values=field.values + pressure(places[:, field.nodes])) for field in now]
    if before is None:
        return now
    return [a._replace(values=a.values - b.values)
            for a, b in zip(now, _valued(what, at(form, before, quantity)), strict=True)]


def _excess(step: StageResult, n: int) -> ndarray:
    """Excess pressure of consolidating ground at the n nodes; zero where there is none."""
    pressure = np.zeros(n)
    for form in step.forms.values():
        if isinstance(form, PoreWater):
            own = form.pressure_at_nodes(step.x)
            pressure = np.where(pressure == 0.0, own, pressure)  # parts of the ground share nodes, and their pressures
    return pressure


def _valued(what: Quantity, fields: list[RegionField]) -> list[RegionField]:
    return [field._replace(values=what.value(field.values)[None]) for field in fields]


def _displaced(form: SolidForm, x: ndarray) -> list[RegionField]:
    """Displacements at the nodes of the regions."""
    u = x[:form.basis.N].reshape(-1, form.basis.mesh.dim()).T
    return [field._replace(values=u[:, field.nodes]) for field in regions_of(form)]


def _stress(form: SolidForm, state: Any, quantity: str) -> list[RegionField]:
    return recovered_stress(form, state.stress)


def _at_points(form: SolidForm, state: Any, quantity: str) -> list[RegionField]:
    """What points have, within their range: plastic strain, mobilised strength, or excess pore pressure."""
    if quantity == "plastic":
        return recovered(form, plastic_strain(state), limited=True)
    values = mobilised if quantity == "mobilised" else pore_pressure
    return recovered(form, values(form, state)[None], limited=True)
