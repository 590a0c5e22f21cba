"""Setup of an analysis: completed and numbered forms, supports, gravity and the solver."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from typing_extensions import Self

from .. import loads
from ..arrays import left_of, max_abs
from ..beams.joints import refuse_loose
from ..beams.nodes import BeamNodes
from ..checks import check_upright, is_number, positive, unit_vector
from ..errors import Remark, warn
from ..forms.base import Form, Forms, as_forms, solids_of
from ..forms.roles import (
    Couples,
    Loaded,
    Slender,
    Staged,
    Wet,
    borrowed_by,
    continued,
    having,
    joined_by,
)
from ..layout import Field, FieldDofs, Layout, different, elements_in, others
from ..loads.water_at_rest import loads_at_rest, one_pressure
from ..mesh.check import check_connections, check_elements
from ..nonlinear.newton import Newton
from ..nonlinear.system import System
from ..results.files import StageData
from ..shells.hinges import hinged
from ..solvers.choice import linear_solver
from ..solvers.petsc import Petsc
from .supports import check_supports

#: Horizontal acceleration over that of gravity beyond which its unit cannot be meant.
_STRONGEST = 2.0

#: Component of a direction along an axis below which it lies across: the limit of unit vectors.
_ALONG = 1e-6


class Setup:
    """Forms, supports and settings of all analyses, see :class:`~skfem_contact.Model`."""

    def __init__(
        self,
        forms: Mapping[str, Any],
        fixed: Any = (),
        *,
        solver: str | Petsc | Callable[..., Any] | None = None,
        newton: Newton | None = None,
        gravity: Sequence[float] | None = None,
        seismic: float | Sequence[float] = 0.0,
        water_unit_weight: float | None = None,
        gravity_acceleration: float | None = None,
    ) -> None:
        # Check the forms together.
        given = as_forms(forms)
        self.solver = solver
        self.newton = newton
        self.coordinates = _coordinates_of(given)
        self.finite = _is_finite(given)
        _check_different(given)
        _check_bases(given)
        # Complete each form by the others, and number their dofs.
        self._completed = {name: _completed(name, form, given) for name, form in given.items()}
        _check_fields(self._completed)
        self.layout = _layout_of(self._completed)
        self.fixed = self.layout.dofs(fixed)
        # Forms at planes of symmetry know their other halves.
        for name, form in having(self._completed, Couples).items():
            self._completed[name] = form.mirrored(self._completed, self.fixed)
        self.forms = self.own = {
            name: self._numbered(form) for name, form in self._completed.items()
        }
        # Check what needs numbers.
        _check_joints(self.forms)
        self.water_unit_weight = water_unit_weight
        if water_unit_weight is not None and not is_number(water_unit_weight, 0.0, np.inf):
            raise ValueError(f"water_unit_weight must be positive, not {water_unit_weight!r}")
        self.gravity = self._acceleration(gravity, seismic)
        self._check_materials(self.forms)
        self.gravity_acceleration = gravity_acceleration
        if gravity_acceleration is not None:
            positive(gravity_acceleration, "gravity_acceleration")
        self._change: Callable[[str, Form], Form] | None = None

    def acceleration_of_gravity(self) -> float:
        """Return the acceleration of gravity; a ``ValueError`` where it was not given."""
        if self.gravity_acceleration is None:
            raise ValueError(
                "masses are unit weights over the acceleration of gravity: give "
                "Model(gravity_acceleration=9.81), in the units of the model (9.81 for kN and m)"
            )
        return self.gravity_acceleration

    def with_each(self, change: Callable[[str, Form], Form]) -> Self:
        """Return the set-up with a change of all forms, those that stages will bring included.

        The forms keep their dofs.
        """
        new = copy(self)
        vars(new).pop("solids", None)
        new._completed = {name: change(name, form) for name, form in self._completed.items()}
        new.forms = new.own = {name: change(name, form) for name, form in self.forms.items()}
        new._change = change
        return new

    def weight(
        self, unit_weights: float | Mapping[str, float], direction: Sequence[float] | None = None
    ) -> ndarray:
        """Return the load vector of the weight of all solids, see :func:`weight`."""
        for name, form in self.solids.items():
            missing = loads.weightless(form, unit_weights)
            if missing:
                warn(
                    f"{missing} of '{name}' are weightless: name them too, with 0 if they are "
                    "meant to be"
                )
        total = np.zeros(self.layout.n_displacements)
        for form in self.solids.values():
            total = total + loads.weight(form, unit_weights, direction)
        return total

    def traction(
        self, boundary: str, force: Sequence[float] | Callable[[ndarray], ArrayLike]
    ) -> ndarray:
        """Return the load vector of forces per area on a boundary, see :func:`traction`."""
        return loads.traction(next(iter(self.solids.values())), boundary, force)

    def water_load(self, pressure: loads.Pressure, boundaries: str | Sequence[str] = ()) -> ndarray:
        """Return the load vector of water in all porous solids and on boundaries.

        See :func:`water_load`. ``Stage(water=...)`` finds these boundaries by itself.
        """
        self.refuse_finite("water acts on undeformed boundaries: give total stresses and loads")
        porous = [form for form in self.solids.values() if form.porous]
        elements = elements_in(porous)
        ground = loads.Domain(porous[0].basis.with_elements(elements), self.coordinates)
        return loads.water_load(ground, pressure, boundaries)

    def refuse_finite(self, why: str) -> None:
        """Refuse forms that bodies of finite kinematics do not admit."""
        if self.finite:
            raise ValueError(f"{why} (kinematics='finite' here, 'small' would do)")

    def _acceleration(
        self, gravity: Sequence[float] | None, seismic: float | Sequence[float]
    ) -> ndarray:
        """Return the acceleration of all weights over that of gravity, (dim,)."""
        # Add horizontal parts to the direction of gravity.
        dim = len(self.layout.coordinates)
        # Weights act along the last axis, or along the given one.
        if gravity is None:
            down = -np.eye(dim)[-1]
        else:
            down = unit_vector(gravity, dim, "gravity")
        if np.size(seismic) > max(dim - 1, 1) or not np.isfinite(seismic).all():
            raise ValueError(
                f"seismic must be finite, with at most {max(dim - 1, 1)} components, not "
                f"{seismic!r}"
            )
        horizontal = _across(down, np.atleast_1d(seismic))
        if self.coordinates == "axisymmetric" and (down + horizontal)[0] != 0.0:
            raise ValueError(
                "in axial symmetry weights act along the axis: gravity or seismic across it needs "
                "a model in space"
            )
        if max_abs(horizontal) > _STRONGEST:
            warn(
                f"seismic is {seismic}: it is the acceleration over that of gravity, neither in "
                f"per cent nor in m/s²"
            )
        return down + horizontal

    def _check_materials(self, forms: Forms) -> None:
        """Refuse materials of which the last axis is the vertical one where gravity differs."""
        for name, form in solids_of(forms).items():
            for region, material in form.materials.items():
                if material.upright:
                    self.check_upright(f"the material of '{region}' in '{name}' needs")

    def check_upright(self, what: str, otherwise: str = "") -> None:
        """Refuse what needs gravity against the last axis where it acts otherwise."""
        check_upright(self.gravity, what, otherwise)

    @property
    def seismic(self) -> float | ndarray:
        """Horizontal acceleration over the one of gravity, which is against the last axis."""
        self.check_upright("bounds need")
        if len(self.gravity) == 2:
            return float(self.gravity[0])
        return self.gravity[:-1]

    def _numbered(self, form: Form) -> Form:
        return form.numbered(self.layout.numbers((*form.fields, *borrowed_by(form))))

    def restricted(self, names: Sequence[str]) -> tuple[Self, ndarray]:
        """Return the set-up of some of the forms, numbered anew, and its dofs in this one."""
        new = copy(self)
        vars(new).pop("solids", None)
        new._completed = {name: self._completed[name] for name in names}
        # Keep the displacements, and the fields that these forms bring.
        fields = [field for form in new._completed.values() for field in form.fields]
        brought = np.concatenate([np.zeros(0, int), *self.layout.numbers(fields).values()])
        kept = np.union1d(np.arange(self.layout.n_displacements), brought)
        # Hold the displacements that no form of these moves.
        away = np.setdiff1d(kept, dofs_of({name: self.forms[name] for name in names}, self.layout))
        new.fixed = np.flatnonzero(np.isin(kept, np.union1d(self.fixed, away)))
        if len(kept) < self.layout.size:
            new.layout = _layout_of(new._completed)
            new.forms = new.own = {
                name: new._numbered(form) for name, form in new._completed.items()
            }
        return new, kept

    def after(self, start: StageData | None) -> Self:
        """Return the set-up with the forms and supports that stages of its own have changed."""
        if start is None:
            return self
        new = copy(self)
        vars(new).pop("solids", None)
        if start.layout is self.layout:
            changed = dict(start.changed)
            if self._change is not None:
                changed = {name: self._change(name, form) for name, form in changed.items()}
            new.forms = {**self.forms, **changed}
        # What was read for the forms alone has no layout.
        is_own = start.layout is None or start.layout is self.layout
        if start.supports is not None and start.supports_given and is_own:
            new.fixed = start.supports
        # Active forms have let go of inactive bodies, which files do not hold.
        active = {name: new.forms[name] for name in start.states if name in new.forms}
        new.forms = {**new.forms, **let_go(active, self.inactive(active), self.gone(active))}
        return new

    def adopted(self, new: Mapping[str, Any], now: Forms) -> dict[str, Form]:
        """Return forms that replace present ones, completed and numbered like these."""
        # Complete the new form.
        found = {}
        for name, form in as_forms(new).items():
            old = now[name]
            if self._change is not None:
                form = self._change(name, form)
            form = continued(form, old)
            # It takes over the dofs of the old one.
            if form is not old and (form.fields or borrowed_by(form)):
                numbers = dict(self.layout.numbers(borrowed_by(form)))
                taken = self.layout.numbers(old.fields)
                for own, other in zip(form.fields, old.fields, strict=True):
                    numbers[own] = taken[other]
                form = form.numbered(numbers)
                form.fields = old.fields
            found[name] = form
        self._check_materials(found)
        return found

    @cached_property
    def solids(self) -> dict[str, Any]:
        """Forms that give stiffness to elements; a ``ValueError`` where there is none."""
        found = solids_of(self.forms)
        if not found:
            raise ValueError("there is no SolidForm among the forms: nothing resists load")
        return found

    def weights(self, forms: Forms) -> ndarray:
        """Return the load vector of the weight of some forms, (N,)."""
        total = np.zeros(self.layout.size)
        for form in having(forms, Loaded).values():
            weight = form.own_weight(self.gravity)
            if weight is not None:
                total[: len(weight)] += weight
        return total

    def water_on(self, forms: Forms, water: Any) -> ndarray:
        """Return the load of water at rest in and on some forms, (N,); zero for None and False."""
        total = np.zeros(self.layout.size)
        if water is None or water is False:
            return total
        self.refuse_finite("water acts on undeformed boundaries: give total stresses and loads")
        solids = solids_of(forms)
        if not solids:
            raise ValueError(
                "water at rest acts on solids and on beams that touch them, and no solid is "
                "active: give structures alone a load of their own, such as beam.line_load"
            )
        is_level = not callable(water) and np.ndim(water) != 1
        if is_level:
            self.check_upright("levels need", ", or give water as a function of the coordinates")
        loaded = having(forms, Loaded).values()
        for wet in loads_at_rest(solids, loaded, water, self.water_unit_weight):
            total[: len(wet)] += wet
        return total

    def at_rest(self, forms: Forms, water: Any) -> tuple[Any, ndarray] | None:
        """Return the pressure of water at rest and its load on some forms, (N,), for bounds."""
        if water is None or water is False:
            return None
        solids = solids_of(forms)
        dry = []
        for name, form in solids.items():
            if not form.porous and form.strengths:
                dry.append(name)
        if dry:
            raise ValueError(
                "bounds beside a search know water with pores in all that yields, but "
                f"'{dry[0]}' has none: leave out `certify`"
            )
        return self.one_pressure(water), self.water_on(forms, water)

    def one_pressure(self, water: Any) -> Any:
        """Return water at rest as a function of coordinates or values at vertices, for bounds."""
        mesh = next(iter(self.solids.values())).basis.mesh
        return one_pressure(water, mesh, self.water_unit_weight)

    def vector(self, values: Any, what: str) -> ndarray:
        """Return values of all dofs, given up to the end of any field.

        Raises
        ------
        ValueError
            Another shape, other coordinates, or values that are not finite.
        """
        # Vectors of a form know their coordinate system.
        n = self.layout.size
        n_first = self.layout.n_displacements
        given = getattr(values, "coordinates", None)
        if given is not None and (given == "axisymmetric") != (self.coordinates == "axisymmetric"):
            raise ValueError(
                f"{what} was integrated in {given} coordinates, but the model is "
                f"{self.coordinates}: make loads by the model, or from a solid form instead of a "
                "basis"
            )
        # Check numbers and shape; missing fields are zero.
        if np.ma.isMaskedArray(values) or np.iscomplexobj(values):
            raise ValueError(f"{what} must be an array of real numbers, not masked and not complex")
        values = np.array(values, dtype=float, subok=False)
        if values.ndim != 1 or (len(values) != n and len(values) not in self._ends()):
            if n == n_first:
                either = f"({n_first},)"
            else:
                either = f"({n_first},) or ({n},)"
            raise ValueError(f"{what} has shape {values.shape}, not {either}")
        if not np.isfinite(values).all():
            raise ValueError(f"{what} holds NaN or infinite values")
        if len(values) == n:
            return values
        return np.pad(values, (0, n - len(values)))

    def _ends(self) -> set[int]:
        """Return the numbers of dofs up to the end of each field, and up to the last of a form.

        A form that takes dofs of a later one has its last dof inside of a field.
        """
        ends = {part.stop for part in self.layout.parts}
        for form in having(self.forms, Couples).values():
            if form.acts_on is not None and len(form.acts_on):
                ends.add(int(form.acts_on.max()) + 1)
        return ends

    def load(self, given: Any, what: str = "the load") -> ndarray:
        """Return a load vector, or the sum of several, (N,); zero for None."""
        if given is None:
            return np.zeros(self.layout.size)
        several = isinstance(given, list | tuple) and len(given) > 0 and np.ndim(given[0]) == 1
        if not several:
            return self.vector(given, what)
        return sum((self.vector(one, what) for one in given), start=np.zeros(self.layout.size))

    def inactive(self, active: Forms) -> ndarray:
        """Return the dofs that forms or fields have, but no active form."""
        brought = np.arange(self.layout.n_displacements, self.layout.size)
        of_none = others(self.layout.size, dofs_of(self.forms, self.layout), brought)
        return others(self.layout.size, of_none, dofs_of(active, self.layout))

    def gone(self, active: Forms) -> ndarray:
        """Return the elements that bodies have, but no active one."""
        known = elements_in(solids_of(self.forms).values())
        return np.setdiff1d(known, elements_in(solids_of(active).values()))

    def supported(self, forms: Forms, fixed: ndarray) -> dict[str, Form]:
        """Return forms that know the supported dofs, as their states begin."""
        known = dict(forms)
        for name, form in having(forms, Staged).items():
            known[name] = form.supported(fixed)[0]
        return known

    def remarks_on(
        self,
        active: Forms,
        fixed: ndarray,
        inactive: ndarray,
        duration: float = 0.0,
        moving: bool = False,
    ) -> Iterator[Remark]:
        """Yield remarks of active forms on their supports, and refuse mechanisms.

        Parameters
        ----------
        active, fixed, inactive
            Active forms, supported dofs, and dofs that no active form has.
        duration
            Time from the last change to the end of a stage.
        moving
            True where inertia holds mechanisms of beams.
        """
        for name, form in having(active, Staged).items():
            held = inactive
            if moving and isinstance(form, Slender):
                held = np.arange(self.layout.size)
            for remark in form.check_stage(fixed, held, duration):
                yield replace(remark, text=f"{name}: {remark.text}")
            if isinstance(form, BeamNodes):
                refuse_loose(name, active, self.layout, np.union1d(fixed, held))
        yield from hinged(active, fixed)

    def system(self, forms: Forms, fixed: ndarray) -> System:
        """Return the system of some forms whose supports have been checked."""
        idle = []
        for name, form in having(forms, Staged).items():
            supported, dofs = form.supported(fixed)
            forms = {**forms, name: supported}
            idle.append(dofs)
        fixed = different(self.layout.size, fixed, *idle)
        free = others(self.layout.size, fixed)
        solver = linear_solver(forms, self.solver, self.layout.coordinates, free)
        return System(forms, self.layout, fixed, solver)

    def checked_system(self, forms: Forms, fixed: ndarray) -> System:
        """Return the system of some forms, once their supports are checked."""
        check_supports(forms, fixed)
        return self.system(forms, fixed)


def _across(down: ndarray, parts: ndarray) -> ndarray:
    """Return the vector across gravity with some components along its horizontal axes, (dim,)."""
    dim = len(down)
    horizontal = np.zeros(dim)
    if not parts.any():
        return horizontal
    axes = np.flatnonzero(abs(down) < _ALONG)
    if len(axes) == max(dim - 1, 1):  # gravity acts along one of the axes
        horizontal[axes[: len(parts)]] = parts
        return horizontal
    if dim != 2:
        raise ValueError(
            f"seismic needs gravity along one of the axes in space, not {down.tolist()}: rotate "
            "the mesh"
        )
    # The horizontal direction of inclined gravity is the one towards x.
    towards = left_of(down)
    return np.asarray(parts[0] * np.copysign(1.0, towards[0]) * towards)


def let_go(forms: Forms, inactive: ndarray, gone: ndarray) -> dict[str, Form]:
    """Return forms without their parts on inactive dofs and on elements that are gone."""
    found = dict(forms)
    for name, form in having(forms, Couples).items():
        try:
            found[name] = form.let_go(inactive, gone)
        except ValueError as error:
            raise ValueError(f"'{name}': {error}") from None
    return found


def dofs_of(forms: Forms, layout: Layout) -> ndarray:
    """Return the dofs of the solids, and those that other forms bring."""
    found = [form.basis.element_dofs for form in solids_of(forms).values()]
    for form in forms.values():
        carried = form.carries if isinstance(form, Wet) else None
        found += layout.numbers(form.fields).values() if carried is None else [carried]
    return different(layout.size, *found)


def _completed(name: str, form: Form, forms: Forms) -> Form:
    """Return a form with the properties of other forms; errors name it."""
    try:
        return form.completed(forms)
    except ValueError as error:
        raise ValueError(f"'{name}': {error}") from None


def _coordinates_of(forms: Forms) -> str | None:
    """Return the coordinate system of the forms, which must be the same."""
    given = {}
    for name, form in forms.items():
        if form.coordinates is not None:
            given[name] = form.coordinates
    if len(set(given.values())) > 1:
        raise ValueError(
            f"the forms have different coordinate systems, {given}: give all the same "
            "`coordinates`; embedded beams, reinforcement and curves along piles have no other"
        )
    return next(iter(given.values()), None)


def _is_finite(forms: Forms) -> bool:
    """Return True if bodies have finite kinematics, which do not combine with small ones."""
    kinds = {}
    for name, form in forms.items():
        if form.kinematics:
            kinds[name] = form.kinematics
    finite = [name for name, kind in kinds.items() if kind == "finite"]
    small = [name for name, kind in kinds.items() if kind == "small"]
    if finite and small:
        label = type(forms[small[0]]).__name__
        raise ValueError(
            f"'{small[0]}', a {label}, is of small rotations and strains, but '{finite[0]}' has "
            "kinematics='finite': give all solids the same, without water and structural elements"
        )
    return bool(finite)


def _check_fields(forms: Forms) -> None:
    """Refuse a field that two forms bring without sharing it, and a field that no form brings."""
    owner: dict[Field, str] = {}
    for name, form in forms.items():
        for field in form.fields:
            if owner.setdefault(field, name) != name and not field.shared:
                raise ValueError(
                    f"'{owner[field]}' and '{name}' bring the same field '{field.name}': build two "
                    "forms, or share it by Field(..., shared=...)"
                )
    for name, form in forms.items():
        _check_borrowed(name, form, owner)


def _check_borrowed(name: str, form: Form, owner: Mapping[Field, str]) -> None:
    """Refuse a form that acts on a field, or takes dofs of one, that no form brings."""
    for field in borrowed_by(form):
        if field not in owner:
            raise ValueError(
                f"'{name}' acts on the field '{field.name}', which no form of the model brings"
            )
    taken = [other for field in form.fields for _, other in field.taken]
    for other in taken:
        if isinstance(other, FieldDofs) and other.field not in owner:
            raise ValueError(
                f"'{name}' is joined to a form that is not in the model: it takes dofs of the "
                f"field '{other.field.name}'"
            )


def _check_different(forms: Forms) -> None:
    """Refuse a form under two names, which would act twice."""
    names: dict[int, str] = {}
    for name, form in forms.items():
        if id(form) in names:
            raise ValueError(f"'{names[id(form)]}' and '{name}' are the same form: it acts twice")
        names[id(form)] = name


def _check_sizes(forms: Forms) -> None:
    """Refuse forms with different numbers of dofs, and forms without any."""
    sizes = {}
    for name, form in forms.items():
        if form.size is not None:
            sizes[name] = form.size
    if not sizes and not any(form.fields for form in forms.values()):
        raise ValueError("no form knows how many dofs there are: give one of them a `size`")
    if len(set(sizes.values())) > 1:
        raise ValueError(
            f"the forms belong to different bases; their numbers of dofs are {sizes}; they "
            f"are {', '.join(map(repr, forms.values()))}"
        )


def _check_bases(forms: Forms) -> None:
    """Refuse bad meshes, forms of different bases, and forms without a number of dofs."""
    if not forms:
        raise ValueError("there is no SolidForm among the forms: nothing resists load")
    _check_sizes(forms)
    # All solids share one basis.
    bases = {name: form.basis for name, form in solids_of(forms).items()}
    if not bases:
        return
    owner, basis = next(iter(bases.items()))
    check_elements(basis.mesh)

    # Compare coordinates: different meshes may have as many dofs as each other.
    known = {name: (np.arange(other.N), other.doflocs) for name, other in bases.items()}
    for name, form in having(forms, Couples).items():
        if form.nodes is not None:
            known[name] = form.nodes
    for name, (numbers, coordinates) in known.items():
        if not np.array_equal(coordinates, basis.doflocs[:, numbers]):
            raise ValueError(f"'{name}' belongs to another mesh or another element than '{owner}'")


def _check_joints(forms: Forms) -> None:
    """Check how elements are connected, where no form joins the displacements of their corners."""
    solids = solids_of(forms)
    if not solids:
        return
    basis = next(iter(solids.values())).basis
    # Nodes whose displacements forms join.
    joined = np.zeros(basis.N, dtype=bool)
    for form in forms.values():
        dofs = joined_by(form)
        if dofs is None:  # it may join any of them
            joined[:] = True
        else:
            joined[dofs[(dofs >= 0) & (dofs < basis.N)]] = True
    # Bodies that meet at other nodes alone are hinged by mistake.
    nodes = np.flatnonzero(joined[basis.nodal_dofs].any(axis=0))
    elements = elements_in(solids.values())
    check_connections(basis.mesh, nodes, elements)


def _layout_of(forms: Forms) -> Layout:
    """Give numbers to the dofs of all forms of an analysis, also of inactive ones."""
    fields = [field for form in forms.values() for field in form.fields]
    for form in solids_of(forms).values():
        return Layout.of(np.asarray(form.basis.doflocs), fields)
    # Without a solid the dofs have no coordinates: number them in a row.
    n = next((form.size for form in forms.values() if form.size is not None), 0)
    dim = 1
    if fields:
        dim = len(fields[0].coordinates)
    return Layout.of(np.tile(np.arange(n, dtype=float), (dim, 1)), fields)
