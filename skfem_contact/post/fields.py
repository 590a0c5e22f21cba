"""Fields for pictures: displacements and nodal averages of stresses and plastic strain."""
from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy import ndarray

from ..analysis.result import StageResult
from ..checks import look_up
from ..solid import SolidForm
from .undrained import pore_pressure


def _principal(stress: ndarray) -> ndarray:
    """Principal stresses of (4 or 6, ...) in ascending order along the last axis."""
    xx, yy, zz, xy, *out_of_plane = stress
    if out_of_plane:
        yz, zx = out_of_plane
        tensors = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
        return np.linalg.eigvalsh(np.moveaxis(tensors, (0, 1), (-2, -1)))
    center, radius = 0.5 * (xx + yy), np.hypot(0.5 * (xx - yy), xy)
    return np.sort(np.stack((center - radius, center + radius, zz), axis=-1), axis=-1)


def _mises(stress: ndarray) -> ndarray:
    xx, yy, zz = stress[:3]
    return np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * (stress[3:] ** 2).sum(axis=0))


#: Fields of plane bodies and what a legend calls them.
QUANTITIES = {
    "ux": "horizontal displacement", "uy": "vertical displacement", "u": "displacement",
    "sxx": "horizontal stress", "syy": "vertical stress", "szz": "out-of-plane stress", "sxy": "shear stress",
    "s1": "largest principal stress", "s2": "middle principal stress", "s3": "smallest principal stress",
    "mean": "mean stress", "mises": "von Mises stress", "plastic": "equivalent plastic strain",
    "pore": "excess pore pressure"}

_IN_SPACE = {"uz": "displacement along z", "syz": "shear stress", "szx": "shear stress"}

_OF_DISPLACEMENT: dict[str, Callable[[ndarray], ndarray]] = {
    "ux": lambda u: u[0], "uy": lambda u: u[1], "uz": lambda u: u[2], "u": lambda u: np.hypot.reduce(u, axis=0)}
_OF_STRESS: dict[str, Callable[[ndarray], ndarray]] = {
    "sxx": lambda s: s[0], "syy": lambda s: s[1], "szz": lambda s: s[2], "sxy": lambda s: s[3],
    "syz": lambda s: s[4], "szx": lambda s: s[5],
    "s1": lambda s: _principal(s)[..., 2], "s2": lambda s: _principal(s)[..., 1],
    "s3": lambda s: _principal(s)[..., 0], "mean": lambda s: s[:3].mean(axis=0), "mises": _mises}


def nodal_field(forms: Mapping[str, Any], step: StageResult, quantity: str) -> ndarray:
    """A field at the nodes, for contour pictures.

    Stresses are averaged over the elements at a node, weighted by their volumes; bodies do not share nodes,
    so nothing is averaged across a contact.  Invariants are those of the averaged stress.

    Parameters
    ----------
    forms
        Forms by name; the solids among them that are there in the stage count.
    step
        A stage of the result of these forms.
    quantity
        ``"ux"``, ``"uy"``, ``"u"`` (length of the displacement); ``"sxx"``, ``"syy"``, ``"szz"``, ``"sxy"``; in three
        dimensions also ``"uz"``, ``"syz"``, ``"szx"``;
        principal stresses ``"s1"`` >= ``"s2"`` >= ``"s3"``; ``"mean"``, ``"mises"``; ``"plastic"``, the
        equivalent plastic strain (zero in elastic bodies); ``"pore"``, the excess pore pressure of undrained ground.

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
    >>> basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> forms = {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.))}
    >>> fixed = np.hstack((basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1")))
    >>> result = sc.run(forms, [sc.Stage("weight", sc.weight(basis, 20.))], fixed=fixed)
    >>> sc.nodal_field(forms, result["weight"], "syy").round(6).tolist()
    [-10.0, -10.0, -10.0, -10.0]
    """
    forms = solids_there(forms, step)
    dim = next(iter(forms.values())).basis.mesh.dim()
    look_up(quantity, QUANTITIES if dim == 2 else QUANTITIES | _IN_SPACE, "field")
    used = np.unique(np.concatenate([element_nodes(form).ravel() for form in forms.values()]))
    field = np.full(len(step.x) // dim, np.nan)
    if quantity in _OF_DISPLACEMENT:
        field[used] = _OF_DISPLACEMENT[quantity](step.x.reshape(-1, dim)[used].T)
    elif quantity == "plastic":
        field[used] = _average(forms, {name: plastic_strain(step.states[name]) for name in forms})[0, used]
    elif quantity == "pore":
        field[used] = _average(forms, {name: pore_pressure(form, step.states[name])[None]
                                       for name, form in forms.items()})[0, used]
    else:
        stress = _average(forms, {name: step.states[name].stress for name in forms})
        field[used] = _OF_STRESS[quantity](stress[:, used])
    return field


def solids(forms: Mapping[str, Any]) -> dict[str, SolidForm]:
    """The solids among the forms."""
    found = {name: form for name, form in forms.items() if isinstance(form, SolidForm)}
    if not found:
        raise ValueError(f"there is no SolidForm among the forms {list(forms)}")
    return found


def solids_there(forms: Mapping[str, Any], step: StageResult) -> dict[str, SolidForm]:
    """The solids among the forms that are there in a stage: neither taken away nor still to come."""
    if not hasattr(step, "states"):
        raise ValueError(f"one stage is needed, result[name of the stage], not {type(step).__name__}")
    given = solids(forms)
    found = {name: form for name, form in given.items() if name in step.states}
    if not found:
        raise ValueError(f"none of the solids {list(given)} is there in stage '{step.name}', which holds "
                         f"{list(step.states)}")
    return found


def element_nodes(form: SolidForm) -> ndarray:
    """Nodes of all elements, (n_elements, n_nodes): corners, middles of edges and faces, centre."""
    dim = form.basis.mesh.dim()
    return np.asarray(form.basis.element_dofs[0::dim].T) // dim


def plastic_strain(state: Any) -> ndarray:
    """Equivalent plastic strain of a solid's state, (1, n_elements, n_points)."""
    return state.internal[:1] if len(state.internal) else np.zeros((1, *state.stress.shape[1:]))


def _average(forms: Mapping[str, SolidForm], values: Mapping[str, ndarray]) -> ndarray:
    """Averages of (components, n_elements, n_points) at the nodes, weighted by the elements' volumes."""
    first = next(iter(forms.values())).basis
    n_nodes = first.N // first.mesh.dim()
    components = len(next(iter(values.values())))
    volume, total = np.zeros(n_nodes), np.zeros((components, n_nodes))
    for name, form in forms.items():
        nodes = element_nodes(form)
        flat, k = nodes.ravel(), nodes.shape[1]
        volume += np.bincount(flat, np.repeat(form.weight.sum(axis=1), k), minlength=n_nodes)
        integral = np.einsum("ceq,eq->ce", values[name], form.weight)
        total += [np.bincount(flat, np.repeat(c, k), minlength=n_nodes) for c in integral]
    return np.divide(total, volume, out=np.full_like(total, np.nan), where=volume > 0)
