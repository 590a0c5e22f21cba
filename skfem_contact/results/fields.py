"""Fields at nodes, region by region: displacements, strains, stresses and what follows from them."""
from __future__ import annotations

from collections.abc import Callable, Mapping
from operator import itemgetter
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy import ndarray
from skfem import CellBasis

from ..errors import look_up
from ..forms.solid import SolidForm
from ..materials.spectral import largest_shear
from ..stages.result import StageResult
from ..water import PoreWater, Seepage
from .recovery import recovered, region_mesh
from .strength import mises, mobilised, plastic_strain, pore_pressure, principal, soil_of

#: Pore pressure: seepage, or a function of places (2, n).
Water = Seepage | Callable[[ndarray], ndarray]


class Quantity(NamedTuple):
    """A field that can be drawn.

    Attributes
    ----------
    title
        What a legend calls it.
    unit
        Kind of unit: ``"length"``, ``"stress"``, or none.
    source
        What it follows from at the nodes: ``"displacement"`` (dim, n), ``"strain"`` or ``"stress"`` (ncomp, n); or
        ``"points"``, what the integration points of a solid have, limited by it.
    value
        Function of the source; of points, of a solid and its state.
    """

    title: str
    unit: Literal["length", "stress", ""]
    source: Literal["displacement", "strain", "stress", "points"]
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
    "s1": Quantity("largest principal stress", "stress", "stress", lambda s: principal(s)[0]),
    "s2": Quantity("middle principal stress", "stress", "stress", lambda s: principal(s)[1]),
    "s3": Quantity("smallest principal stress", "stress", "stress", lambda s: principal(s)[2]),
    "mean": Quantity("mean stress", "stress", "stress", lambda s: s[:3].mean(axis=0)),
    "mises": Quantity("von Mises stress", "stress", "stress", mises),
    "exx": Quantity("horizontal strain", "", "strain", itemgetter(0)),
    "eyy": Quantity("vertical strain", "", "strain", itemgetter(1)),
    "exy": Quantity("engineering shear strain", "", "strain", itemgetter(3)),
    "gamma": Quantity("largest shear strain", "", "strain", largest_shear),
    "ev": Quantity("volumetric strain", "", "strain", lambda e: e[:3].sum(axis=0)),
    "plastic": Quantity("equivalent plastic strain", "", "points", plastic_strain),
    "mobilised": Quantity("mobilised strength", "", "points", mobilised),
    "pore": Quantity("excess pore pressure", "stress", "points", pore_pressure),
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
    values = region_field(forms, step, quantity, since, water)
    found = list(solids_there(forms, step).values())
    nodes, n = region_mesh(*found).nodes, found[0].basis.N // found[0].basis.mesh.dim()
    total, count = np.bincount(nodes, values, n), np.bincount(nodes, minlength=n)
    return np.divide(total, count, out=np.full(n, np.nan), where=count > 0)


def region_field(forms: Mapping[str, Any], step: StageResult, quantity: str, since: StageResult | None = None,
                 water: Water | None = None) -> ndarray:
    """The field at the nodes of the :func:`region_mesh` of all solids that are there; arguments of `nodal_field`."""
    found = solids_there(forms, step)
    what = look_up(quantity, quantities(found), "field")
    if quantity == "pore" and water is None and not has_excess(forms, found):
        raise ValueError("pore pressure where there is no PoreWater and no ground is Undrained: give water=, a Seepage "
                         "or a function of places such as hydrostatic(level)")
    values = np.concatenate([_of_form(form, step, name, what, since) for name, form in found.items()])
    if quantity != "pore":
        return values
    basis, nodes = next(iter(found.values())).basis, region_mesh(*found.values()).nodes
    values = values + _excess(step, nodes)
    if since is not None:
        return values - _excess(since, nodes)
    if water is None:
        return values
    pressure = water.pressure_at if isinstance(water, Seepage) else water
    return values + pressure(basis.doflocs[:, basis.mesh.dim() * nodes])


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


def basis_of(forms: Mapping[str, Any]) -> CellBasis:
    """The basis of the displacements, that of one solid or another."""
    return next(iter(solids(forms).values())).basis


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


def _of_form(form: SolidForm, step: StageResult, name: str, what: Quantity, since: StageResult | None
             ) -> ndarray:
    """The field of one solid, without pressures of flowing and of given water."""
    state, before = step.states[name], None if since is None else since.states.get(name)
    if what.source == "displacement":
        x = (step.x if since is None else step.x - since.x)[:form.basis.N]
        return what.value(x.reshape(-1, form.basis.mesh.dim()).T[:, region_mesh(form).nodes])
    if what.source == "strain":
        return what.value(recovered(form, state.strain if before is None else state.strain - before.strain))

    def at_nodes(state: Any) -> ndarray:
        if what.source == "stress":
            return what.value(recovered(form, state.stress, balanced=True))
        return recovered(form, what.value(form, state)[None], limited=True)[0]

    return at_nodes(state) if before is None else at_nodes(state) - at_nodes(before)


def _excess(step: StageResult, nodes: ndarray) -> ndarray:
    """Excess pressure of consolidating ground at some nodes; zero where there is none."""
    pressure = np.zeros(len(nodes))
    for form in step.forms.values():
        if isinstance(form, PoreWater):
            own = form.pressure_at_nodes(step.x)[nodes]
            pressure = np.where(pressure == 0.0, own, pressure)  # parts of the ground share nodes, and their pressures
    return pressure
