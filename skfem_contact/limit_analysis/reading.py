"""Translation of forms, supports and loads to a model; forms without bounds are refused by name."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain
from typing import Any

import numpy as np
from numpy import ndarray
from skfem import CellBasis, Mesh

from ..arrays import max_abs
from ..checks import format_point
from ..contact.laws import Coulomb, Tied
from ..contact.pair import ContactPair
from ..forms.base import as_forms, dilate_less, part_names, reduced_parts
from ..forms.regions import Region
from ..forms.roles import Touching, having, materials_of
from ..forms.solid import SolidForm
from ..layout import elements_in
from ..materials.base import Flow, Material
from ..sparse import parts_of
from .model import LimitModel, Loads, Site
from .strength import FLAT, Profile, Strength
from .triangles import Contact, Geometry, Tag, Triangles, geometry

#: Strength of a body, over the least one, from which mechanisms are tried that leave it rigid: its
#: strains are of the solver's accuracy, but dissipate. A wall of 500 times the clay's strength has
#: no upper bound without.
_STRONG = 30.0
#: Cohesion below zero at a corner, as a share of the largest, that is round-off.
_ROUND_OFF = 1e-12


@dataclass(frozen=True)
class Problem:
    """LimitModel, its units, and the simplifications that led to it."""

    model: LimitModel  # in units of its size and of a stress
    # with the associated soil of less strength after Davis, where the flow is not associated
    davis: LimitModel | None
    # whose strong bodies are rigid: its mechanisms are some of all
    stiff: LimitModel | None
    # with the adhesion of joints alone, where they do not open by their slip
    smooth: LimitModel | None
    mesh: Mesh
    geometry: Geometry
    stress: float  # unit of stress
    live: bool  # a load is multiplied; otherwise the strength is reduced
    missing: str  # "cohesion" or "tension" where some soil has none
    reduced: tuple[str, ...]
    strong: tuple[str, ...]  # names of parts with much more strength than others
    remarks: tuple[str, ...]


def read(
    forms: Mapping[str, Any],
    fixed: ndarray,
    loads: Callable[[Site], Loads],
    multiplied: bool,
    reduce: str | Collection[str] | None,
    exclude: str | Collection[str],
    associated: bool,
) -> Problem:
    """Check forms, supports and loads, then translate them.

    Without a multiplied load the strength is reduced.
    """
    # check the bodies, their supports and their loads
    solids, pairs = by_kind(forms)
    basis = next(iter(solids.values())).basis
    if multiplied:
        targets = {}
    else:
        targets = reduced_parts(forms, reduce, exclude)
    elements = np.sort(elements_in(solids.values()))
    rigid = _strengths(solids, targets, "associated", 1.0).rigid
    if rigid[elements].all() and not pairs:
        raise ValueError("nothing can yield: all solids are elastic, which bounds take for rigid")
    fixed = _checked_fixed(fixed, basis)
    shape = geometry(basis, elements, fixed)
    triangles = shape.triangles
    given = loads(Site(basis, elements, elements[~rigid[elements]], fixed))
    for tag in (*(traction.tag for traction in given.tractions), *given.submerged):
        _check_boundary(tag, triangles)

    # scale the model to its size and to a stress
    carried = given.largest_stress(triangles, shape.centre, shape.size)
    soil = _strengths(solids, targets, "associated", carried)
    unit = _unit_of_stress(soil, given, shape)
    outer = None
    if soil.lines is not None:
        outer = _strengths(solids, targets, "associated", carried, inner=False).over(unit)
    model = LimitModel(
        triangles,
        soil.over(unit),
        rigid=_rigid_bodies(triangles, soil.rigid),
        loads=given.scaled(shape.centre, shape.size, unit),
        contacts=tuple(_contact(pair, unit, name in targets) for name, pair in pairs.items()),
        profiles=_profiles(solids, "associated", shape, unit),
        outer=outer,
    )

    # list the simplifications
    missing = _missing(model)
    remarks = _remarks(solids, shape, given, soil, missing == "cohesion")

    # derive a model of rigid strong bodies, and weaker ones without associated flow
    strong = _strong(soil, carried, elements)
    davis = smooth = None
    if not associated:
        davis = _davis(model, solids, targets, carried, shape, unit)
        smooth = _without_friction(davis or model)
        remarks += _slipping(pairs)
    return Problem(
        model,
        davis,
        stiff=_stiff(model, soil.rigid | strong) if strong.any() else None,
        smooth=smooth,
        mesh=basis.mesh,
        geometry=shape,
        stress=unit,
        live=multiplied,
        missing=missing,
        reduced=part_names(targets),
        strong=tuple(_names(solids, strong)),
        remarks=remarks,
    )


def _davis(
    model: LimitModel,
    solids: Mapping[str, SolidForm],
    targets: Mapping[str, Collection[str]],
    stress: float,
    shape: Geometry,
    unit: float,
) -> LimitModel | None:
    """Return the model with associated soil after Davis, where soil dilates less."""
    if not dilate_less(solids):
        return None
    weaker = _strengths(solids, targets, "davis_a", stress).over(unit)
    return replace(model, soil=weaker, profiles=_profiles(solids, "davis_a", shape, unit))


def _without_friction(model: LimitModel) -> LimitModel | None:
    """Return the model without friction in joints, where some have it."""
    if not any(contact.mu for contact in model.contacts):
        return None
    contacts = tuple(replace(contact, mu=0.0) for contact in model.contacts)
    return replace(model, contacts=contacts)


def _missing(model: LimitModel) -> str:
    """Return the strength that some soil has not: "cohesion", "tension" or ""."""
    if model.soil.resists_nothing.any():
        return "cohesion"
    if any(profile.vanishes(model.triangles) for profile in model.profiles):
        return "cohesion"
    if (model.soil.tension == 0).any():
        return "tension"
    return ""


def by_kind(forms: Mapping[str, Any]) -> tuple[dict[str, SolidForm], dict[str, ContactPair]]:
    """Return solids and contact pairs; refuse other forms."""
    # Sort the forms by kind.
    forms = as_forms(forms)
    solids: dict[str, Any] = {name: form for name, form in forms.items() if materials_of(form)}
    pairs: dict[str, Any] = having(forms, Touching)
    for name in set(forms) - set(solids) - set(pairs):
        raise ValueError(
            f"there are no bounds with '{name}', a {type(forms[name]).__name__}: they know solids "
            "and contact pairs"
        )
    # All solids are parts of one mesh.
    if not solids:
        raise ValueError("there is no solid among the forms")
    meshes = [form.basis.mesh for form in solids.values()]
    if any(mesh is not meshes[0] and mesh != meshes[0] for mesh in meshes):
        raise ValueError("all solids must be parts of one mesh: join them with join_bodies")
    _check_solids(solids)
    _check_contacts(pairs)
    return solids, pairs


def _check_solids(solids: Mapping[str, SolidForm]) -> None:
    """Refuse space, axial symmetry, materials without a cone and shared elements."""
    for name, form in solids.items():
        if form.kinematics == "finite":
            raise ValueError(
                f"bounds are of the undeformed mesh, but '{name}' has finite kinematics"
            )
        if form.basis.mesh.dim() != 2 or form.coordinates == "axisymmetric":
            kind = "in three dimensions"
            if form.basis.mesh.dim() == 2:
                kind = "axially symmetric"
            raise ValueError(f"bounds are for plane strain, but '{name}' is {kind}")
        for region, material in form.materials.items():
            if material.cone() is None and material.lines(1.0) is None:
                raise ValueError(
                    f"there are no bounds for {material.label}, the material of '{region}' in "
                    f"'{name}', which has no cone(flow); MohrCoulomb, Tresca, VonMises, HoekBrown "
                    "and, rigid, LinearElastic have bounds"
                )

    # compare the elements of all solids
    elements = elements_in(solids.values())
    if len(np.unique(elements)) < len(elements):
        raise ValueError(
            f"the solids {', '.join(solids)} share elements: each must belong to one of them"
        )


def _strengths(
    solids: Mapping[str, SolidForm],
    targets: Mapping[str, Collection[str]],
    flow: Flow,
    stress: float,
    inner: bool = True,
) -> Strength:
    """Return the strength of all elements of the mesh; without a yielding solid they are rigid.

    Lines inside or outside of a curved strength replace it, for compression up to about a stress.
    """
    # Begin without strength limits, as of rigid bodies.
    n = next(iter(solids.values())).basis.mesh.nelements
    unlimited = np.full(n, np.inf)
    soil = Strength(unlimited, np.zeros(n), unlimited.copy(), np.zeros(n, bool))
    for name, form in solids.items():
        # Set the strengths by region, from the criterion of the material.
        for region in form.regions:
            where = form.elements[region.elements]
            soil.reduced[where] = region.name in targets.get(name, ())
            lines = region.material.lines(stress, inner, flow)
            if lines is None:
                c, t, tension = _parameters(region, flow, f"{name}.{region.name}")
                soil.c[where] = c
                soil.t[where] = t
                soil.tension[where] = tension
            else:
                soil = _with_lines(soil, where, *lines)
    return soil


def _with_lines(soil: Strength, where: ndarray, lines: ndarray, most: ndarray) -> Strength:
    """Return the strength with lines, (n_lines, 2, n or 1), at some elements.

    The line in the middle becomes the first.
    """
    n = len(soil.c)
    count = len(lines) - 1
    middle = count // 2
    soil.c[where], soil.t[where] = lines[middle]
    if soil.lines is None:
        every = np.full((n, count, 2), np.inf)
    else:
        every = soil.lines
    every[where] = np.delete(lines, middle, axis=0).transpose(2, 0, 1)
    limit = np.full(n, np.inf) if soil.most is None else soil.most
    limit[where] = most
    return replace(soil, lines=every, most=limit)


def _parameters(region: Region, flow: Flow, name: str) -> tuple[Any, Any, Any]:
    """Return cohesion, tan phi and tensile strength in plane strain, one value an element or one.

    A cohesion that varies within elements has its mean.
    """
    # check that the values are known where bounds need them
    material = region.material
    cone = material.cone(flow)
    if cone is None:
        raise ValueError(f"there are no bounds for {material.label} with the flow '{flow}'")
    if any(np.ndim(value) == 2 and np.ptp(value, axis=1).any() for value in cone[1:]):
        raise ValueError(
            f"friction or tensile strength of '{name}' vary within elements: bounds know a "
            "cohesion that does; give one value an element"
        )
    if np.ndim(cone[0]) == 2 and region.given is None:
        raise ValueError(
            f"the cohesion of '{name}' is known at integration points alone, as after a reduction "
            "of its strength: give the body with the function of the coordinates"
        )

    # check the values: friction that is not nearly zero, and a strength
    c, t, tension = map(_mean, cone)
    friction = np.asarray(t)
    if ((friction > 0) & (friction < FLAT)).any():
        raise ValueError(
            f"a friction angle of '{name}' lies between 0 and {np.degrees(FLAT):.2f} degrees; make "
            "it 0"
        )
    if ((np.asarray(c) == 0) & (friction == 0)).any():
        raise ValueError(f"'{name}' has neither cohesion nor friction")
    return c, t, tension


def _mean(value: Any) -> Any:
    """Return the mean of a value at points by element, (n,); others as they are."""
    if np.ndim(value) == 2:
        return np.mean(value, axis=1)
    return value


def _profiles(
    solids: Mapping[str, SolidForm],
    flow: Flow,
    shape: Geometry,
    unit: float,
) -> tuple[Profile, ...]:
    """Return the cohesions that vary with the coordinates, in units of the model."""
    n = next(iter(solids.values())).basis.mesh.nelements
    profiles = []
    for name, form in solids.items():
        for region in form.regions:
            given = region.given
            if given is None or given.cohesion_at(shape.centre[:, None, None]) is None:
                continue
            where = form.elements[region.elements]
            c = _parameters(region, flow, name)[0]
            full = _parameters(region, "associated", name)[0]
            share = np.zeros(n)  # of the function's values, in units of the model
            ones = np.ones(len(where))
            share[where] = np.divide(c, full, out=ones, where=full > 0) / unit
            profiles.append(Profile(share > 0, partial(_cohesion, given, shape, share)))
    return tuple(profiles)


def _cohesion(
    material: Material,
    shape: Geometry,
    share: ndarray,
    x: ndarray,
    elements: ndarray,
) -> ndarray:
    """Return a share of the cohesion at coordinates (2, n, 3), by elements of the mesh, (n, 3)."""
    points = shape.centre[:, None, None] + shape.size * x  # (2, n, 3)
    values = np.asarray(material.cohesion_at(points))

    # refuse negative values, but not round-off
    largest = max_abs(values)
    if (values < -_ROUND_OFF * largest).any():
        least = points.reshape(2, -1)[:, values.argmin()]
        where = format_point(least)
        raise ValueError(f"the cohesion must not be negative, got {values.min():.4g} at {where}")
    return np.maximum(values, 0.0) * share[elements][:, None]


def _checked_fixed(fixed: ndarray, basis: CellBasis) -> ndarray:
    """Return fixed dofs, checked."""
    fixed = np.unique(fixed)
    message = f"fixed must hold dofs from 0 to {basis.N - 1}"
    if len(fixed) == 0:
        raise ValueError(f"{message}: without supports there are no bounds")
    if fixed[0] < 0 or fixed[-1] >= basis.N:
        raise ValueError(message)
    return fixed


def _unit_of_stress(soil: Strength, given: Loads, shape: Geometry) -> float:
    """Return a typical strength: the unit of stress."""
    c = soil.c[np.isfinite(soil.c) & (soil.c > 0)]
    if len(c):
        return float(np.median(c))
    heaviest = max_abs(given.dead + given.live)
    return heaviest * shape.size or 1.0


def _check_boundary(name: Tag, triangles: Triangles) -> None:
    """Refuse a load that acts inside the bodies, or nowhere."""
    facets = triangles.tags[name]
    if len(facets) == 0:
        raise ValueError(f"boundary '{name}' is empty")
    if (triangles.mesh.f2t[1, facets] >= 0).any():
        raise ValueError(f"boundary '{name}' lies inside the bodies: loads act on their surface")


def _check_contacts(pairs: Mapping[str, ContactPair]) -> None:
    """Refuse rigid obstacles, sides that two pairs share, and laws without bounds."""
    seen: set[str] = set()
    for name, pair in pairs.items():
        if pair.master.rigid:
            raise ValueError(
                f"contact '{name}' is with the rigid obstacle '{pair.master.name}': bounds know "
                "contact between bodies; make the obstacle an elastic body, which they take for "
                "rigid"
            )
        sides = pair.slave.name, pair.master.name
        if seen.intersection(sides):
            raise ValueError(f"contact '{name}' has a side that another pair has as well")
        seen.update(sides)
        law = pair.law
        if isinstance(law, Tied):
            continue
        if not isinstance(law, Coulomb):
            raise ValueError(
                f"there are no bounds for {type(law).__name__}, the law of '{name}'; there are for "
                "Coulomb and Tied"
            )
        if np.ndim(law.mu) or np.ndim(law.adhesion) or np.ndim(law.tension):
            raise ValueError(
                f"contact '{name}' has another strength at every point: bounds know one for a "
                "contact"
            )


def _contact(pair: ContactPair, stress: float, reduced: bool) -> Contact:
    """Return a contact in units of the model; a tied one has no limit."""
    law = pair.law
    if isinstance(law, Tied):
        return Contact(pair.slave.name, pair.master.name, tied=True)
    return Contact(
        pair.slave.name,
        pair.master.name,
        a=float(law.adhesion) / stress,
        mu=float(law.mu),
        tension=float(law.tension) / stress,
        reduced=reduced,
    )


def _slipping(pairs: Mapping[str, ContactPair]) -> tuple[str, ...]:
    """Return a remark on joints whose friction is not associated."""
    names = []
    for name, pair in pairs.items():
        if isinstance(pair.law, Coulomb) and pair.law.mu > 0:
            names.append(name)
    if not names:
        return ()
    return (
        f"the joints {', '.join(names)} open by mu times their slip here (associated flow) but not "
        "in ContactPair: for joints without dilation `lower` is an estimate, `safe` a bound",
    )


def _rigid_bodies(triangles: Triangles, rigid: ndarray) -> ndarray:
    """Return the number of the rigid body of every element of the mesh, -1 for none."""
    # number the rigid triangles that facets connect
    mesh = triangles.mesh
    stiff = rigid[triangles.origin]
    first, second = mesh.f2t[:, mesh.f2t[1] >= 0]
    both = stiff[first] & stiff[second]
    n = mesh.nelements
    label = parts_of(n, first[both], second[both])
    number = np.full(n, -1)
    number[stiff] = np.unique(label[stiff], return_inverse=True)[1]

    # refuse bodies that share a node
    nodes = [np.unique(mesh.t[:, number == body]) for body in range(number.max() + 1)]
    if nodes and np.bincount(np.concatenate(nodes)).max() > 1:
        raise ValueError(
            "two elastic bodies, which bounds take for rigid, meet in a node: separate or join them"
        )
    bodies = np.full(len(rigid), -1)
    bodies[triangles.origin] = number
    return bodies


def _strong(soil: Strength, carried: float, elements: ndarray) -> ndarray:
    """Return a mask of the elements that can yield, but have much more strength than others."""
    strength = soil.c + soil.t * carried
    return np.asarray((strength > _STRONG * strength[elements].min()) & ~soil.rigid)


def _stiff(model: LimitModel, rigid: ndarray) -> LimitModel | None:
    """Return the model with other rigid elements, or None where two such bodies meet in a node."""
    try:
        return replace(model, rigid=_rigid_bodies(model.triangles, rigid))
    except ValueError:
        return None


def _names(solids: Mapping[str, SolidForm], where: ndarray) -> list[str]:
    """Return the names of solids, or of their regions, in which some elements lie."""
    names = []
    for name, form in solids.items():
        for region in form.regions:
            if where[form.elements[region.elements]].any():
                names.append(name if len(form.regions) == 1 else region.name)
    return names


def _remarks(
    solids: Mapping[str, SolidForm],
    shape: Geometry,
    given: Loads,
    soil: Strength,
    cohesionless: bool,
) -> tuple[str, ...]:
    """Return the simplifications."""
    remarks = []
    # Report elastic bodies and ground without cohesion.
    if elastic := _names(solids, soil.rigid):
        remarks.append(f"elastic bodies have no limit and count as rigid: {', '.join(elastic)}")
    if cohesionless:
        remarks.append(
            "soil without cohesion: at a free surface the lower bound is zero; a small cohesion "
            "mends it"
        )
    # Report what is simplified between nodes.
    if shape.curved:
        remarks.append("curved sides are straight between the nodes at their ends")
    regions = chain.from_iterable(form.regions for form in solids.values())
    if any(region.given is not None for region in regions):
        remarks.append("a cohesion that varies is linear in every triangle")
    if given.water:
        remarks.append("the pressure of water is linear in every triangle")
    return (*remarks, *given.remarks)
