"""From forms, supports and loads to a limit-analysis model; what has no bounds is refused by name."""
from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from skfem import Basis, CellBasis, ElementQuad1, ElementTriP1, Mesh

from ..collapse.reduction import reduced_parts
from ..contact.laws import Coulomb, Tied
from ..contact.pair import ContactPair
from ..errors import look_up
from ..solid import SolidForm
from ..stages.supports import as_unknowns
from .contact import Contact
from .geometry import Geometry, geometry
from .model import Model, Traction, Water
from .soils import Strengths, check_solids, dilates_less, strengths
from .triangles import Triangles

#: A traction: (t_x, t_y), or a function of places (2, n) with values (2, n).
TractionLike = ArrayLike | Callable[[ndarray], ndarray]
#: A pressure of water, positive: a function of places (2, n), or values at the nodes of the mesh.
PressureLike = Callable[[ndarray], ndarray] | ndarray


@dataclass(frozen=True)
class Loads:
    """Loads as they are given to :func:`~skfem_contact.bounds`."""

    weight: float | Mapping[str, float]
    seismic: float
    tractions: Mapping[str, TractionLike]
    water: PressureLike | None
    wetted: tuple[str, ...]
    live: tuple[str, ...]


@dataclass(frozen=True)
class Problem:
    """A model, the units it is in, and what was done to it.

    Attributes
    ----------
    model
        In units of its size and of a stress.
    davis
        The same with the associated soil of less strength after Davis, where the flow is not associated.
    mesh, geometry
        The mesh of the forms, and centre and size of the model's.
    stress
        Unit of stress.
    reduced
        Names of what is reduced.
    remarks
        What a reader of the bounds should know.
    """

    model: Model
    davis: Model | None
    mesh: Mesh
    geometry: Geometry
    stress: float
    reduced: tuple[str, ...]
    remarks: tuple[str, ...]


def read(forms: Mapping[str, Any], fixed: ndarray, loads: Loads, reduce: str | Collection[str] | None,
         exclude: str | Collection[str], associated: bool) -> Problem:
    """Check everything, then translate it."""
    solids, pairs = _by_kind(forms)
    check_solids(solids)
    basis = next(iter(solids.values())).basis
    targets = {} if loads.live else reduced_parts(forms, reduce, exclude)
    found = strengths(solids, targets, "associated")
    elements = np.sort(np.concatenate([form.elements for form in solids.values()]))
    if found.rigid[elements].all() and not pairs:
        raise ValueError("nothing can yield: all solids are elastic, which bounds take for rigid")
    shape = geometry(basis, elements, _unknowns(fixed, basis))
    units = shape.size, _unit_of_stress(found, loads, basis, shape)
    contacts = _contacts(pairs, targets, units[1])
    rigid = _rigid_bodies(shape.triangles, found.rigid)
    tractions, dead, live, water = _translated(loads, basis, shape, units, found.rigid)
    model = Model(shape.triangles, found.c / units[1], found.t, found.tension / units[1], found.reduced, rigid,
                  dead, live, tractions, contacts, water)
    davis = None
    if dilates_less(solids) and not associated:
        weaker = strengths(solids, targets, "davis_a")
        davis = replace(model, c=weaker.c / units[1], t=weaker.t)
    names = tuple(name if regions is None else f"{name}.{region}"
                  for name, regions in targets.items() for region in regions or ("",))
    return Problem(model, davis, basis.mesh, shape, units[1], names, _remarks(solids, shape, loads, found))


def _by_kind(forms: Mapping[str, Any]) -> tuple[dict[str, SolidForm], dict[str, ContactPair]]:
    """Solids and contact pairs; other forms are refused."""
    solids = {name: form for name, form in forms.items() if isinstance(form, SolidForm)}
    pairs = {name: form for name, form in forms.items() if isinstance(form, ContactPair)}
    for name in set(forms) - set(solids) - set(pairs):
        raise ValueError(f"there are no bounds with '{name}', a {type(forms[name]).__name__}: they know solids and "
                         "contact pairs")
    if not solids:
        raise ValueError("there is no solid among the forms")
    first = next(iter(solids.values())).basis.mesh
    if any(form.basis.mesh is not first and form.basis.mesh != first for form in solids.values()):
        raise ValueError("all solids must be parts of one mesh: join them with join_bodies")
    return solids, pairs


def _unknowns(fixed: ndarray, basis: CellBasis) -> ndarray:
    """Fixed unknowns, checked."""
    fixed = as_unknowns(fixed)
    if len(fixed) == 0 or fixed[0] < 0 or fixed[-1] >= basis.N:
        raise ValueError(f"fixed must hold numbers of unknowns from 0 to {basis.N - 1}"
                         + (": without supports there are no bounds" if len(fixed) == 0 else ""))
    return fixed


def _unit_of_stress(found: Strengths, loads: Loads, basis: CellBasis, shape: Geometry) -> float:
    """A typical strength: what all stresses are divided by."""
    c = found.c[np.isfinite(found.c) & (found.c > 0)]
    if len(c):
        return float(np.median(c))
    heaviest = float(np.abs(_unit_weights(loads.weight, basis)).max())
    return heaviest * shape.size or 1.0


def _unit_weights(weight: float | Mapping[str, float], basis: CellBasis) -> ndarray:
    """Weight per volume of every element of the mesh."""
    gamma = np.zeros(basis.mesh.nelements)
    for name, value in weight.items() if isinstance(weight, Mapping) else ():
        elements = look_up(name, basis.mesh.subdomains or {}, "subdomain")
        if gamma[elements].any():
            raise ValueError(f"elements of '{name}' get their weight twice")
        gamma[elements] = value
    if not isinstance(weight, Mapping):
        gamma[:] = weight
    if not np.isfinite(gamma).all():
        raise ValueError(f"unit weights must be finite numbers, not {weight!r}")
    return gamma


def _translated(loads: Loads, basis: CellBasis, shape: Geometry, units: tuple[float, float], rigid: ndarray
                ) -> tuple[tuple[Traction, ...], ndarray, ndarray, Water | None]:
    """Tractions, body forces, fixed and multiplied, and water."""
    size, stress = units
    known = {"weight", *loads.tractions}
    for name in loads.live:
        if name not in known:
            raise ValueError(f"there is no load '{name}' to multiply; existing: {', '.join(sorted(known))}")
    body = np.zeros((basis.mesh.nelements, 2))
    body += _unit_weights(loads.weight, basis)[:, None] * [loads.seismic, -1.0] * size / stress
    nothing = np.zeros_like(body)
    dead, live = (nothing, body) if "weight" in loads.live else (body, nothing)

    def place(x: ndarray) -> ndarray:
        return shape.centre[:, None] + size * x

    tractions = []
    for name, value in loads.tractions.items():
        _check_boundary(name, shape.triangles)
        tractions.append(Traction(name, _traction(name, value, place, stress), name in loads.live))
    water = None
    if loads.water is not None:
        for name in loads.wetted:
            _check_boundary(name, shape.triangles)
        pressure = _pressure(loads.water, basis)
        water = Water(lambda x: pressure(place(x)) / stress, ~rigid, loads.wetted)
    if not body.any() and not tractions and water is None:
        raise ValueError("there is no load: give `weight`, `tractions` or `water`")
    return tuple(tractions), dead, live, water


def _check_boundary(name: str, triangles: Triangles) -> None:
    """A load acts on facets of the boundary."""
    boundaries = {tag: facets for tag, facets in triangles.tags.items() if isinstance(tag, str)}
    facets = look_up(name, boundaries, "boundary")
    if len(facets) == 0:
        raise ValueError(f"boundary '{name}' is empty")
    if (triangles.mesh.f2t[1, facets] >= 0).any():
        raise ValueError(f"boundary '{name}' lies inside the bodies: loads act on their surface")


def _traction(name: str, value: TractionLike, place: Callable[[ndarray], ndarray], stress: float
              ) -> Callable[[ndarray], ndarray]:
    """A traction in units of the model."""
    if callable(value):
        def field(x: ndarray) -> ndarray:
            result = np.asarray(value(place(x)), dtype=float)
            if result.shape != x.shape or not np.isfinite(result).all():
                raise ValueError(f"the traction on '{name}' must be finite and of shape {x.shape}, like the places")
            return result / stress
        return field
    constant = np.asarray(value, dtype=float)
    if constant.shape != (2,) or not np.isfinite(constant).all():
        raise ValueError(f"the traction on '{name}' must be (t_x, t_y) or a function of places, not {value!r}")
    return lambda x: np.broadcast_to(constant[:, None] / stress, x.shape)


def _pressure(water: PressureLike, basis: CellBasis) -> Callable[[ndarray], ndarray]:
    """Pressure of water as a function of places."""
    if callable(water):
        return lambda x: np.asarray(water(x), dtype=float)
    mesh = basis.mesh
    if np.shape(water) != (mesh.nvertices,):
        raise ValueError(f"the water has shape {np.shape(water)}; the mesh has {mesh.nvertices} nodes")
    linear = Basis(mesh, ElementTriP1() if len(mesh.t) == 3 else ElementQuad1())
    return linear.interpolator(np.asarray(water, dtype=float))


def _contacts(pairs: Mapping[str, ContactPair], targets: Mapping[str, Any], stress: float) -> tuple[Contact, ...]:
    """Contacts in units of the model."""
    contacts: list[Contact] = []
    seen: set[str] = set()
    for name, pair in pairs.items():
        if (pair.master.dofs < 0).any():
            raise ValueError(f"contact '{name}' is with the rigid obstacle '{pair.master.name}': bounds know contact "
                             "between bodies; make the obstacle an elastic body, which they take for rigid")
        sides = pair.slave.name, pair.master.name
        if seen.intersection(sides):
            raise ValueError(f"contact '{name}' has a side that another pair has as well")
        seen.update(sides)
        law = pair.law
        if isinstance(law, Tied):
            contacts.append(Contact(name, *sides, tied=True))
        elif isinstance(law, Coulomb):
            if np.ndim(law.mu) or np.ndim(law.adhesion) or np.ndim(law.tension):
                raise ValueError(f"contact '{name}' has another strength at every point: bounds know one for a contact")
            strength = float(law.adhesion) / stress, float(law.mu), float(law.tension) / stress
            contacts.append(Contact(name, *sides, *strength, name in targets))
        else:
            raise ValueError(f"there are no bounds for {type(law).__name__}, the law of '{name}'; there are for "
                             "Coulomb and Tied")
    return tuple(contacts)


def _rigid_bodies(triangles: Triangles, rigid: ndarray) -> ndarray:
    """Number of the rigid body that every element of the mesh belongs to, -1 for none."""
    mesh, stiff = triangles.mesh, rigid[triangles.origin]
    one, other = mesh.f2t[:, mesh.f2t[1] >= 0]
    both = stiff[one] & stiff[other]
    n = mesh.nelements
    links = coo_matrix((np.ones(both.sum()), (one[both], other[both])), shape=(n, n))
    label = connected_components(links, directed=False)[1]
    number = np.full(n, -1)
    number[stiff] = np.unique(label[stiff], return_inverse=True)[1]
    nodes = [np.unique(mesh.t[:, number == b]) for b in range(number.max() + 1)]
    if nodes and np.bincount(np.concatenate(nodes)).max() > 1:
        raise ValueError("two elastic bodies, which bounds take for rigid, meet in a node: separate or join them")
    result = np.full(len(rigid), -1)
    result[triangles.origin] = number
    return result


def _remarks(solids: Mapping[str, SolidForm], shape: Geometry, loads: Loads, found: Strengths) -> tuple[str, ...]:
    """What was simplified."""
    remarks = []
    elastic = [name for name, form in solids.items() if found.rigid[form.elements].any()]
    if elastic:
        remarks.append(f"elastic bodies have no limit and count as rigid: {', '.join(elastic)}")
    if (found.c == 0).any():
        remarks.append("soil without cohesion: at a free surface the lower bound is zero; a small cohesion mends it")
    if shape.curved:
        remarks.append("curved sides are straight between the nodes at their ends")
    if loads.water is not None:
        remarks.append("the pressure of water is linear in every triangle")
    if any(callable(value) for value in loads.tractions.values()):
        remarks.append("tractions are linear along every facet")
    return tuple(remarks)
