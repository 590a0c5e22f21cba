"""Solids: a basis, a strain measure and the materials of regions."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from copy import copy
from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import product
from typing import ClassVar, cast

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from skfem import CellBasis
from typing_extensions import override

from ..arrays import max_abs
from ..checks import (
    check_basis,
    check_quadrature,
    check_size,
    format_point,
    names,
    positive_order,
)
from ..errors import Remark, warn
from ..loads import by_element, weight, weight_matrix, weightless
from ..materials import LinearElastic, Material, Update
from ..materials.base import PLASTIC_STRAIN, Flow, bulk_modulus_of
from ..materials.spectral import largest_shear
from .assembly import (
    SWING,
    Measure,
    Pattern,
    element_stiffness,
    force_matrix,
    has_corners_only,
    locked,
    locking,
    strain_of,
    strain_operator,
    swing,
)
from .base import Coordinates, Form, Kinematics, Later, Outputs, Response
from .finite import Deformation, FiniteKinematics
from .law_calls import LawCall
from .predicted_stress import MeanStress, PredictedStress, WholeStress
from .regions import (
    Region,
    by_elasticity,
    by_region,
    changed_moduli,
    check_materials,
    elastic_strain,
    flows_at_constant_volume,
    inherited,
    may_flow,
)
from .roles import Body, Dissipating, Reducible, Staged, Timed

#: Bulk modulus over shear modulus from which on mean stresses are predicted: Poisson's ratio .41.
_STIFF = 5.0
#: Round-off of forces relative to the forces of single displacements.
_ROUND_OFF = 8 * np.finfo(float).eps
#: Share of the last stresses or forces below which new ones are differences of nearly equal ones.
_UNLOADED = 1e-9
#: Share of the volume that yields and may lock by itself: of a cone that begins to touch the ground
#: it is 1e-5, and mean stresses swing in the few elements at its tip by 7 times the shear stress.
_FEW = 0.01
#: Rotation (radians) that is remarked on: lengths are then off by 1 %.
_TURN = 0.14
#: Sine of an angle at a corner that is remarked on: about 10 degrees.
_SHARP = 0.17
#: Strain that is remarked on: it is off by a fifth of itself.
_STRAIN = 0.2

#: Change of volume of a body at its activation that is warned of.
_GROWN = 0.02

#: Radius over the largest one up to which a node lies on the axis of symmetry, by round-off.
_ON_AXIS = 1e-9

#: Regions with the stresses and internal variables of an accepted state.
_Given = list[tuple[Region, ndarray, ndarray]]
#: Moduli at the points of some elements, (m, n, n).
_Moduli = Callable[[slice], ndarray]


@dataclass(frozen=True)
class SolidState:
    """State of a solid at its points: arrays (components, n_elements, n_points).

    Attributes
    ----------
    strain
        Strain of the accepted configuration: xx, yy, zz, xy (engineering shear), in space also yz
        and zx.
    stress
        Stress of these components, tension positive.
    internal
        Internal variables of the materials, in the order in which each of them declares its own.
    """

    strain: ndarray
    stress: ndarray
    internal: ndarray

    _at: ClassVar[_Displaced | None] = None

    def __getattr__(self, name: str) -> ndarray:
        # The strains and stresses of linear laws are computed when they are first asked for
        if self._at is None or name not in ("strain", "stress"):
            raise AttributeError(f"{type(self).__name__} has no attribute {name!r}")
        strain, stress = self._at.start.body.stresses(self._at.x, self._at.start.state)
        vars(self).update(strain=strain, stress=stress)
        return {"strain": strain, "stress": stress}[name]


@dataclass(frozen=True)
class _Start:
    """State in which a body of linear laws began, and its forces.

    Attributes
    ----------
    body, state
        The body, and the state.
    force : ndarray, shape (N,)
        Internal force of this state at displacements of zero.
    size
        Norm of the internal force of its stresses.
    """

    body: SolidForm
    state: SolidState
    force: ndarray
    size: float


@dataclass(frozen=True)
class _Displaced:
    """Displacements from which strains and stresses of linear laws follow.

    Attributes
    ----------
    start
        Beginning of the body.
    x : ndarray, shape (N,)
        The displacements.
    size
        Norm of the internal force.
    """

    start: _Start
    x: ndarray
    size: float

    def state(self) -> SolidState:
        """Return the state, whose strains and stresses are computed when they are asked for."""
        state = SolidState.__new__(SolidState)
        vars(state).update(internal=self.start.state.internal, _at=self)
        return state


@dataclass(frozen=True)
class FiniteState(SolidState):
    """State of a solid of finite kinematics at its points.

    Attributes
    ----------
    strain
        Sum of the increments of logarithmic strain that the law got, in the frame of the stretch.
    stress
        Kirchhoff stress in this frame, see :meth:`SolidForm.cauchy` for stresses in space axes.
    gradient
        Displacement gradient: xx, yy, zz, xy, yx, in space the nine components row by row.
    """

    gradient: ndarray


class SolidForm(Form, Body, Staged, Timed, Reducible, Dissipating):
    """Internal force and tangent of a body or of several, of small or of finite strains.

    Parameters
    ----------
    basis
        ``Basis`` of an ``ElementVector`` on triangles, quadrilaterals, tetrahedra or hexahedra,
        whole or restricted (``basis.with_elements``). Elements of four and eight corners need
        ``intorder=2`` for two points per direction.
    materials
        One material, or ``{subdomain: material}`` that covers every element of the basis once.
        Arrays of parameters have one value per element, in the order of
        ``mesh.subdomains[subdomain]``; functions count at the points.
    strain
        ``"full"``, or ``"b_bar"``: volumetric strains averaged over each element; with finite
        kinematics ``"f_bar"``, the volume of its centre. By default one of the latter for elements
        of four and eight corners with a material that may yield, where full strains lock.
    coordinates
        ``"axisymmetric"`` for axial symmetry about x = 0: forces are per radian, and the radial
        displacement on the axis must be fixed. By default ``"plane"`` or ``"space"``, as the mesh.
    unit_weight
        Weight per volume of every element: one number, or by subdomain. Loads of a :class:`Model`
        then include the weight of the active bodies. By default the body is weightless.
    porous
        True if water at rest (``Stage(water=...)``) acts in its pores; False for concrete and
        steel.
    kinematics
        ``"small"``: rotations and strains are small. ``"finite"``: they may be large; loads and
        weights count undeformed areas and volumes, laws get logarithmic strains, and their strength
        limits Kirchhoff stresses, Cauchy stresses times the change of volume.

    Attributes
    ----------
    basis
        Basis with elements ordered region by region; state arrays follow this order.
    regions
        Names of the subdomains and their materials.

    Raises
    ------
    ValueError
        Unsupported element or mesh, unknown subdomain, elements without or with two materials, a
        parameter array of another length than its region.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> mesh = MeshQuad().refined(2).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> form = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.))
    >>> x = basis.zeros()
    >>> x[0::2] = 1e-3 * basis.doflocs[0, 0::2]
    >>> f"{form.assemble(x, form.initial_state()).state.stress[0].max():.6f}"
    '1.000000'
    """

    def __init__(
        self,
        basis: CellBasis,
        materials: Material | Mapping[str, Material],
        strain: Measure | None = None,
        *,
        coordinates: Coordinates | None = None,
        unit_weight: float | Mapping[str, float] | None = None,
        porous: bool = True,
        kinematics: Kinematics = "small",
    ) -> None:
        check_basis(basis)
        check_quadrature(basis)
        # order the elements by regions
        self.basis, regions = by_region(basis, materials)
        self.regions = tuple(r.with_material(r.material, self.basis) for r in regions)
        self.size = int(self.basis.N)
        self._duration = 0.0
        self.kinematics: Kinematics = kinematics
        measured = strain_of(self.basis, strain, coordinates, not self._elastic, kinematics)
        self.strain, self.coordinates = measured
        self.unit_weight = unit_weight
        self.porous = porous
        missing = [] if unit_weight is None else weightless(self, unit_weight)
        if missing:
            raise ValueError(
                f"{missing} have no unit weight: give one for each subdomain, 0 for a weightless "
                "one"
            )
        B, self.weight = strain_operator(self.basis, self.strain, self.coordinates)
        self._ncomp = B.shape[2]
        self._finite: FiniteKinematics | None = None
        if kinematics == "finite":
            f_bar = self.strain == "f_bar"
            self._finite = FiniteKinematics(self.basis, self.weight, self.coordinates, f_bar)
        check_materials(self.regions, self.weight.shape, self._ncomp, self.coordinates)
        self._set(self.regions)

        # compute what does not change in Newton's iterations
        self._pattern = Pattern.of(self.basis)
        self._element_dofs = np.ascontiguousarray(self.basis.element_dofs.T)
        # rows of B that never act (zz in plane strain) need not be multiplied
        self._rows = np.flatnonzero(B.any(axis=(0, 1, 3)))
        self._B = B
        if len(self._rows) < self._ncomp:
            self._B = np.ascontiguousarray(B[:, :, self._rows])

    def __repr__(self) -> str:
        regions = ", ".join(f"{r.name}: {r.material!r}" for r in self.regions)
        return f"<SolidForm {self.basis.nelems} elements, {regions}>"

    def _set(self, regions: tuple[Region, ...]) -> None:
        """Set the regions, and the attributes that follow from their materials."""
        self.regions = regions
        self.materials = {region.name: region.material for region in regions}
        laws = self.materials.values()
        self.symmetric = all(law.symmetric for law in laws) and self.strain != "f_bar"
        self._n_internal = max(law.n_internal for law in laws)
        # A linear law under small strains has a constant tangent; other laws may have any.
        changing = self._finite is not None or not all(map(_is_constant, laws))
        self._linear = self._finite is None and _linear(self.materials)
        self._hyperelastic = all(law.hyperelastic for law in self.materials.values())
        self._start: _Start | None = None
        self._accepted: tuple[SolidState, ndarray, ndarray] | None = None
        self.changing = None if changing else np.zeros(0, int)
        self.strengths = tuple(name for name, law in self.materials.items() if law.reducible)

    @property
    def given_materials(self) -> dict[str, Material]:
        """Materials by region as they were given, with functions of the coordinates."""
        return {region.name: region.given or region.material for region in self.regions}

    def with_materials(self, materials: Mapping[str, Material]) -> SolidForm:
        """Return the body with other materials, ``{subdomain: material}``.

        Matrices that do not change are shared.
        """
        names(materials, self.materials, "region of this solid")
        new = self._of(materials)
        check_materials(new.regions, self.weight.shape, self._ncomp, self.coordinates)
        return new

    def _of(self, materials: Mapping[str, Material]) -> SolidForm:
        """Return the body with some other materials, unchecked."""
        regions = []
        same = True
        for old in self.regions:
            new = old
            if old.name in materials:
                new = old.with_material(materials[old.name], self.basis)
                moduli = new.material.elasticity(self._ncomp)
                same &= np.array_equal(moduli, old.material.elasticity(self._ncomp))
            regions.append(new)
        if same:
            _ = self._diagonal  # with the stiffness: computed once, for the bodies of all strengths
        if not self._linear:
            _ = self._force_matrix
        body = copy(self)
        if not same:
            for name in ("_elasticity", "elastic_stiffness", "_diagonal"):
                vars(body).pop(name, None)
        for name in ("_predicted_bulk", "_flows"):
            vars(body).pop(name, None)
        body._set(tuple(regions))
        return body

    @override
    def on(self, basis: CellBasis) -> SolidForm:
        materials: Material | dict[str, Material]
        materials = self.given_materials
        names = basis.mesh.subdomains or {}
        if list(materials) == ["all"] and "all" not in names:
            materials = materials["all"]
        return SolidForm(
            basis,
            materials,
            self.strain,
            coordinates=self.coordinates,
            unit_weight=self.unit_weight,
            porous=self.porous,
            kinematics=self.kinematics,
        )

    @override
    def own_weight(self, acceleration: ndarray) -> ndarray | None:
        if self.unit_weight is None:
            return None
        size = float(np.linalg.norm(acceleration))
        if size == 0.0:
            return np.zeros(self.basis.N)
        return size * weight(self, self.unit_weight, acceleration / size)

    @override
    def weight_matrix(
        self, consistent: bool, factors: Mapping[str, float] | None = None
    ) -> csr_matrix | None:
        if self.unit_weight is None:
            return None
        return weight_matrix(self, self._by_region(factors), consistent)

    @property
    def unit_weights(self) -> ndarray:
        """Weight per volume of the elements, (n_elements,)."""
        given = 0.0 if self.unit_weight is None else self.unit_weight
        return by_element(self.basis.mesh, given)[self.elements]

    @property
    @override
    def elastic_moduli(self) -> ndarray:
        return self._elasticity

    @override
    def scaled_stiffness(self, factors: Mapping[str, float]) -> csr_matrix:
        scale = self.weight * self._by_region(factors)[:, None]
        D = self._elasticity[:, None] * scale[..., None, None]
        return self._pattern.matrix(self._pattern.scatter(element_stiffness(self._B, D)))

    def _by_region(self, factors: Mapping[str, float] | None) -> ndarray:
        """Return factors of all elements, zero in regions without one, (n_elements,)."""
        if factors is None:
            return np.ones(self.basis.nelems)
        result = np.zeros(self.basis.nelems)
        for region in self.regions:
            result[region.elements] = factors.get(region.name, 0.0)
        return result

    @override
    def reduced(self, factor: float, flow: str, names: Collection[str]) -> SolidForm:
        return self._of({n: self.materials[n].reduced(factor, cast(Flow, flow)) for n in names})

    @override
    def over(self, duration: float) -> SolidForm:
        if duration == self._duration or not any(m.time_dependent for m in self.materials.values()):
            return self
        new = copy(self)
        new._duration = duration
        return new

    @override
    def outputs(self, x: ndarray, state: SolidState) -> Outputs:
        return Outputs(
            summary=lambda: self._summary(state),
            remarks=lambda: self._remarks(x, state),
            yielding=lambda before: self._yielding(before, state),
        )

    def _yielding(self, before: SolidState, after: SolidState) -> tuple[int, int]:
        """Return the number of points that have flowed between two states, and of all points."""
        flowed = 0
        for old, new in zip(self._memories(before), self._memories(after), strict=True):
            region, internal = old
            flowed += int(region.material.yielding(internal, new[1]).sum())
        return flowed, self.weight.size

    @override
    def shear_strain(self, x: ndarray) -> ndarray:
        return largest_shear(self.strains(x))

    @override
    def initial_state(self, x: ndarray | None = None, stress: ndarray | None = None) -> SolidState:
        """Return the state without strain at the displacements x, (N,), stress-free or given."""
        if stress is None:
            stress = np.zeros((self._ncomp, *self.weight.shape))
        internal = self._initial_internal(stress)
        if self._finite is not None:
            # The reference of finite kinematics is the mesh: warn if the body has grown since.
            gradient = self._finite.gradient(np.zeros(self.basis.N) if x is None else x)
            growth = max_abs(self._finite.growth(gradient))
            if growth > _GROWN:
                warn(
                    f"a body is activated where displacements have changed its volume by up to "
                    f"{growth:.0%}: its stresses and weight count the volume of the mesh"
                )
            return FiniteState(np.zeros(stress.shape), stress, internal, gradient)
        if x is None:
            strain = np.zeros(stress.shape)
        else:
            strain = self.strains(x)
        return SolidState(strain, stress, internal)

    def _initial_internal(self, stress: ndarray) -> ndarray:
        """Return the internal variables with which the materials start under a stress."""
        internal = np.zeros((self._n_internal, *self.weight.shape))
        for region in self.regions:
            n = region.material.n_internal
            internal[:n, region.elements] = region.initial_internal(stress, self.basis)
        return internal

    def strains(self, x: ndarray) -> ndarray:
        """Return strains, (n_components, n_elements, n_points), at displacements x, (N,).

        Shear strains are engineering ones.
        """
        n_elements, n_points, n_acting, _ = self._B.shape
        B = self._B.reshape(n_elements, n_points * n_acting, -1)
        # Strains that act, B u, one batch of elements at once.
        u = x.take(self._element_dofs)
        acting = np.matmul(B, u[:, :, None]).reshape(n_elements, n_points, n_acting)
        # Rows that never act stay zero.
        strain = np.zeros((self._ncomp, n_elements, n_points))
        strain[self._rows] = acting.transpose(2, 0, 1)
        return strain

    def _remembered(self, state: SolidState) -> ndarray:
        """Return the internal variables, with new ones after a change of materials."""
        known = state.internal
        if len(known) >= self._n_internal:
            return known
        return np.concatenate((known, self._initial_internal(state.stress)[len(known) :]))

    def at_regions(self, state: SolidState) -> _Given:
        """Return the regions with the stresses and internal variables of their materials."""
        result = []
        for region, own in self._memories(state):
            result.append((region, state.stress[:, region.elements], own))
        return result

    def _memories(self, state: SolidState) -> Iterator[tuple[Region, ndarray]]:
        """Yield the regions with the internal variables of their materials."""
        internal = self._remembered(state)
        for region in self.regions:
            yield region, internal[: region.material.n_internal, region.elements]

    @override
    def assemble(self, x: ndarray, state: SolidState) -> Response:
        check_size(x, self.basis.N)
        if isinstance(state, FiniteState):
            return self._assemble_finite(x, state)
        if self._linear:
            return self._assemble_linear(x, state)
        strain = self.strains(x)
        given = self.at_regions(state)
        calls = self._calls(given, strain - state.strain)
        if any(call.waits for call in calls):
            return Later(lambda: self._response(x, state, strain, given, calls))
        return self._response(x, state, strain, given, calls)

    def _response(
        self,
        x: ndarray,
        state: SolidState,
        strain: ndarray,
        given: _Given,
        calls: list[LawCall],
    ) -> Response:
        """Return the response at displacements x with their strains."""
        # update the stresses region by region
        updates, stress = _updates(calls)
        force = self._force_matrix @ stress.ravel()

        return Response(
            force,
            lambda: SolidState(strain, stress, self._internal(state, given, updates)),
            stiffness=lambda: self._tangent(given, updates),
            damped=lambda: self._tangent(given, updates, damping=True),
            round_off=self._lost(x, stress, state.stress, self._force_of),
        )

    def _lost(
        self,
        x: ndarray,
        stress: ndarray,
        before: ndarray,
        force_of: Callable[[ndarray], ndarray],
    ) -> float:
        """Return the round-off; stresses that vanish are differences of the ones before."""
        summed = float(np.linalg.norm(self._diagonal * x))
        if max_abs(stress) < _UNLOADED * max_abs(before):
            summed += float(np.linalg.norm(force_of(before)))
        return _ROUND_OFF * summed

    def _assemble_linear(self, x: ndarray, state: SolidState) -> Response:
        """Return the response of linear laws, ``f = K x + f_0``.

        The force f_0 of initial strains and stresses, ``B^T (stress_0 - D strain_0)``, stays the
        same in all states of a body.
        """
        # Compute the force
        at = state._at
        if at is not None and at.start.body is self:
            start = at.start
            last = at.size
        else:
            start = self._begun(state)
            last = start.size
        K = self.elastic_stiffness
        force = K @ x + start.force

        # estimate round-off; forces that vanish are differences of the last ones
        summed = float(np.linalg.norm(self._diagonal * x))
        size = float(np.linalg.norm(force))
        last = max(last, float(np.linalg.norm(start.force)))
        if size < _UNLOADED * last:
            summed += last
        displaced = _Displaced(start, x.copy(), size)
        return Response(force, displaced.state, lambda: K, round_off=_ROUND_OFF * summed)

    def _begun(self, state: SolidState) -> _Start:
        """Return the beginning of linear laws in an accepted state, once for each state."""
        if self._start is None or self._start.state is not state:
            # The response to the opposite of the strains is stress - D strain.
            stress = _updates(self._calls(self.at_regions(state), -state.strain))[1]
            last = float(np.linalg.norm(self._force_of(state.stress)))
            self._start = _Start(self, state, self._force_of(stress), last)
        return self._start

    def _force_of(self, stress: ndarray) -> ndarray:
        """Return the internal force of stresses, (N,)."""
        if not stress.any():
            return np.zeros(self.basis.N)
        return np.asarray(self._force_matrix @ stress.ravel())

    def stresses(self, x: ndarray, state: SolidState) -> tuple[ndarray, ndarray]:
        """Return strains and stresses at displacements x, (N,), from an accepted state.

        Both are (n_components, n_elements, n_points).
        """
        strain = self.strains(x)
        calls = self._calls(self.at_regions(state), strain - state.strain)
        return strain, _updates(calls)[1]

    def _calls(
        self, given: _Given, increment: ndarray, elastic: ndarray | None = None
    ) -> list[LawCall]:
        """Return the calls of the materials for an increment of strain.

        Where elastic strains are known, hyperelastic laws get these.
        """
        calls = []
        for region, old, internal in given:
            part = increment[:, region.elements]
            known = None
            if elastic is not None and region.material.hyperelastic:
                known = elastic[:, region.elements]
            calls.append(LawCall(region.material, part, old, internal, self._duration, known))
        return calls

    def _assemble_finite(self, x: ndarray, state: FiniteState) -> Response:
        """Return the response of finite kinematics, see :mod:`skfem_contact.forms.finite`."""
        assert self._finite is not None
        # update the stresses
        elastic, plastic = self._elastic_part(state)
        deformation = self._finite.at(x)
        strain = deformation.strain(plastic)
        increment = strain - elastic
        given = self.at_regions(state)
        updates, stress = _updates(self._calls(given, increment, strain))
        force = deformation.force(stress)
        moduli = cache(lambda: self._moduli(given, updates))
        predicted = self._prediction(deformation, strain, stress, state, moduli)

        def accepted() -> FiniteState:
            internal = self._internal(state, given, updates)
            total = state.strain + increment
            new = FiniteState(total, stress, internal, deformation.gradient)
            if self._hyperelastic:  # the strain is elastic, and nothing flows
                self._accepted = new, strain, plastic
            return new

        def stiffness(damping: bool = False) -> csr_matrix:
            used = stress if predicted is None else predicted.stress
            found = self._moduli(given, updates, damping=True) if damping else moduli()
            return self._pattern.matrix(deformation.stiffness(used, found, self._pattern))

        response = Response(
            force,
            accepted,
            stiffness=stiffness,
            damped=lambda: stiffness(damping=True),
            round_off=self._lost(x, stress, state.stress, deformation.force),
        )
        response.prediction = predicted
        return response

    def _elastic_part(self, state: FiniteState) -> tuple[ndarray, ndarray]:
        """Return elastic strains of an accepted state and ``Cp^-1 - 1``, once a step."""
        known = self._accepted
        if known is None or known[0] is not state:
            assert self._finite is not None
            # The law keeps elastic strains; they fix Cp^-1 with the stretch.
            elastic = np.empty_like(state.stress)
            for region, stress, internal in self.at_regions(state):
                material = region.material
                elastic[:, region.elements] = elastic_strain(material, stress, internal)
            plastic = self._finite.inverse_plastic(state.gradient, elastic)
            known = (state, elastic, plastic)
            self._accepted = known
        return known[1], known[2]

    def _prediction(
        self,
        deformation: Deformation,
        strain: ndarray,
        stress: ndarray,
        state: FiniteState,
        moduli: Callable[[], _Moduli],
    ) -> PredictedStress | None:
        """Return the stresses that iterations may predict."""
        finite = self._finite
        assert finite is not None
        if self._predicted_bulk.any():
            bulk = self._predicted_bulk
            known = strain if self._elastic else None
            return MeanStress(deformation, known, stress, state.stress, bulk)
        if self._elastic:
            plastic = self._elastic_part(state)[1]
            return WholeStress(
                deformation,
                strain,
                stress,
                state.stress,
                moduli=moduli,
                strain_at=lambda x: finite.at(x).strain(plastic),
            )
        return None

    def _moduli(self, given: _Given, updates: list[Update], damping: bool = False) -> _Moduli:
        """Return the function of the moduli at the points of some elements, in acting rows."""
        assert self._finite is not None
        # find the points of other moduli than the elastic ones
        n_points = self.weight.shape[1]
        which = np.full(self.weight.size, -1)
        tangents = [np.zeros((0, self._ncomp, self._ncomp))]
        known = 0
        for (region, old, internal), update in zip(given, updates, strict=True):
            changed, tangent = changed_moduli(region.material, old, internal, update, damping)
            if len(changed):
                points = changed + n_points * (region.elements.start or 0)
                which[points] = known + np.arange(len(points))
                tangents.append(tangent)
                known += len(points)
        # Keep the rows and columns that act.
        acting = np.asarray(self._finite.acting)
        D = np.concatenate(tangents)
        elastic = self._elasticity
        if len(acting) < self._ncomp:
            D = D[:, acting[:, None], acting]

        def moduli(part: slice) -> ndarray:
            found = np.repeat(elastic[part], n_points, axis=0)
            own = which[part.start * n_points : part.stop * n_points]
            others = np.flatnonzero(own >= 0)
            found[others] = D[own[others]]
            return found

        return moduli

    def cauchy(self, state: SolidState) -> ndarray:
        """Return Cauchy stresses in space axes, (n_components, n_elements, n_points).

        With small kinematics they are the stresses of the state.

        Examples
        --------
        A sheet under uniaxial tension that has turned by 90 degrees:

        >>> import numpy as np
        >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
        >>> import skfem_contact as sc
        >>> basis = Basis(MeshQuad(), ElementVector(ElementQuad1()), intorder=2)
        >>> law = sc.LinearElastic(E=100., nu=0.)
        >>> form = sc.SolidForm(basis, law, kinematics="finite")
        >>> X, Y = basis.doflocs[:, 0::2]
        >>> x = np.column_stack((-Y - X, 1.01 * X - Y)).ravel()
        >>> state = form.assemble(x, form.initial_state()).state
        >>> form.cauchy(state)[:, 0, 0].round(3) + 0.
        array([0.   , 0.985, 0.   , 0.   ])
        """
        if isinstance(state, FiniteState):
            assert self._finite is not None
            return self._finite.cauchy(state.gradient, state.stress)
        return state.stress

    def total_strain(self, state: SolidState) -> ndarray:
        """Return strains in space axes, (n_components, n_elements, n_points), engineering shear.

        With finite kinematics they are logarithmic, ``ln V``.
        """
        if isinstance(state, FiniteState):
            assert self._finite is not None
            return self._finite.log_strain(state.gradient)
        return state.strain

    def _internal(self, state: SolidState, given: _Given, updates: list[Update]) -> ndarray:
        """Return internal variables after the updates, copied only where one of them changes."""
        before = self._remembered(state)
        after = before
        for (region, _, old), update in zip(given, updates, strict=True):
            # a material that returns its argument has changed nothing
            if update.internal is not old:
                if after is before:
                    after = before.copy()
                after[: region.material.n_internal, region.elements] = update.internal
        return after

    @override
    def dissipated(self, before: SolidState, after: SolidState, work: float) -> float:
        # mean stress times the strain that the elasticity of the mean state does not explain
        mean = 0.5 * (before.stress + after.stress)
        increment = after.strain - before.strain
        change = after.stress - before.stress
        lost = 0.0
        for region, _, internal in self.at_regions(before):
            law = region.material
            if not law.n_internal and not law.time_dependent:
                continue
            part = region.elements
            at = mean[:, part]
            # Plastic strain: increment of strain without D_e^-1 times the change of stress.
            plastic = increment[:, part] - by_elasticity(law, change[:, part], at, internal)
            work = (at * plastic).sum(axis=0)
            lost += float((self.weight[part] * work).sum())
        return lost

    def _summary(self, state: SolidState) -> str:
        yielded = self.variable(PLASTIC_STRAIN, state) > 0
        if yielded.any():
            return f"{yielded.mean():.1%} yielded"
        return ""

    def variable(self, name: str, state: SolidState) -> ndarray:
        """Return an internal variable, (n_elements, n_points); zero where it is not declared."""
        values = np.zeros(self.weight.shape)
        for region, internal in self._memories(state):
            own = region.material.variable(name, internal)
            if own is not None:
                values[region.elements] = own
        return values

    @override
    def continues(self, old: Form) -> SolidForm:
        if not isinstance(old, SolidForm) or old.weight.shape != self.weight.shape:
            raise ValueError("its elements are others")
        if not np.array_equal(old.basis.element_dofs, self.basis.element_dofs):
            raise ValueError("its elements are others")
        if old.kinematics != self.kinematics:
            raise ValueError(f"its kinematics are {self.kinematics}, not {old.kinematics}")
        return self

    @override
    def inherits(self, old: Form, state: SolidState) -> SolidState:
        if not isinstance(old, SolidForm):
            return state
        # A law with more memory begins with zeros.
        stress = state.stress.copy()
        internal = old._remembered(state)
        missing = max(0, self._n_internal - len(internal))
        internal = np.pad(internal, ((0, missing), (0, 0), (0, 0)))
        changed = False
        for region, successor in product(old.regions, self.regions):
            changed |= inherited(region, successor, stress, internal)
        if changed:
            return replace(state, stress=stress, internal=internal)
        return state

    @override
    def fits(self, state: SolidState) -> bool:
        # internal variables may be others than at first
        if isinstance(state, FiniteState) != (self._finite is not None):
            return False
        return np.shape(state.stress) == (self._ncomp, *self.weight.shape)

    @override
    def rebased(self, x: ndarray, state: SolidState) -> SolidState:
        if isinstance(state, FiniteState):
            return self.initial_state(stress=self.cauchy(state))
        return replace(state, strain=np.zeros_like(state.strain))

    @override
    def check_stage(self, fixed: ndarray, held: ndarray, duration: float) -> Iterator[Remark]:
        if self.coordinates != "axisymmetric":
            return
        # Find radial displacements on the axis that supports leave free.
        radial = np.intersect1d(self.basis.element_dofs, np.arange(0, self.size, 2))
        radius = self.basis.doflocs[0, radial]
        on_axis = radial[np.abs(radius) <= _ON_AXIS * max_abs(radius)]
        free = np.setdiff1d(on_axis, fixed)
        if len(free):
            yield Remark(
                "axis",
                len(free),
                f"{len(free)} nodes on the axis of symmetry are free to move off it, the first at "
                f"{format_point(self.basis.doflocs[:, free[0]])}: hold their radial displacements, "
                "such as basis.get_dofs('left').all('u^1')",
            )

    def _remarks(self, x: ndarray, state: SolidState) -> Iterator[Remark]:
        """Yield remarks on large rotations and strains, and on elements that lock."""
        if self._finite is None:
            yield from self._remarks_on_size(x, state)
        elif self.basis.mesh.dim() == 2:
            yield from self._remarks_on_shape(x)
        yield from self._remarks_on_weights(state)
        if self.strain == "full" and state.strain.any():
            yielded = float((self.variable(PLASTIC_STRAIN, state) > 0).mean())
            finite = self._finite is not None
            yield from locking(self.basis, self.coordinates, yielded, self._elasticity, finite)
        yield from self._remarks_on_swing(state)

    @property
    def quadrature_advice(self) -> str:
        """Advice on a rule of quadrature with a negative weight, for a message; "" without one."""
        if self.weight.min() > 0.0:
            return ""
        return (
            "its rule of quadrature has a negative weight, by which points that yield add "
            "stiffness instead of taking it, and searches stall: take Basis(..., intorder="
            f"{positive_order(self.basis)})"
        )

    def _remarks_on_weights(self, state: SolidState) -> Iterator[Remark]:
        """Yield a remark on points that yield in a rule with a negative weight."""
        advice = self.quadrature_advice
        if advice:
            yielded = float((self.variable(PLASTIC_STRAIN, state) > 0).mean())
            if yielded:
                yield Remark("quadrature", yielded, advice)

    def _remarks_on_swing(self, state: SolidState) -> Iterator[Remark]:
        """Yield a remark on elements with nodes besides corners that lock."""
        if has_corners_only(self.basis):
            return
        # Points that yield count, if they are more than a few.
        weight = self.weight
        yielded = weight * (self.variable(PLASTIC_STRAIN, state) > 0)
        yields = bool(yielded.sum() > _FEW * weight.sum())
        if yields:
            weight = yielded
        times = swing(self.basis, state.stress, weight, yields)
        if times > SWING:
            yield Remark(
                "swing",
                times,
                f"volumes hardly change in {locked(self.basis, times)}, and forces may be too "
                "high: take ElementTriP2 or ElementQuadS2 with intorder=2",
            )

    def _remarks_on_shape(self, x: ndarray) -> Iterator[Remark]:
        """Yield a remark on corners of elements in the plane that strains have made sharp."""
        now = sharpened(self, x)
        sharp = now < _SHARP
        if sharp.any():
            # Name the sharpest.
            k = int(np.argmin(now.min(axis=0)))
            vertices = self.basis.mesh.t[:, self.elements][:, k]
            nodes = self.basis.nodal_dofs[:, vertices]
            corners = self.basis.doflocs[:, nodes[0]] + x[nodes]
            where = format_point(corners.mean(axis=1))
            angle = float(np.degrees(np.arcsin(max(now[sharp].min(), 0.0))))
            yield Remark(
                "shape",
                1.0 - angle / 90.0,
                f"{sharp.any(axis=0).sum()} elements have corners within {angle:.0f} degrees of a "
                f"straight line, the worst at {where}: take a new mesh, remeshed(stage, size)",
            )

    def _remarks_on_size(self, x: ndarray, state: SolidState) -> Iterator[Remark]:
        """Yield remarks on large rotations and strains that are taken for small."""
        # Half the skew part of the gradient is the rotation.
        moved = zip(x[self.basis.element_dofs], self.basis.basis)
        gradient = np.asarray(sum(u[:, None] * np.asarray(shape.grad) for u, (shape,) in moved))
        skew = np.abs(gradient - gradient.swapaxes(0, 1))
        turn = float(skew.max(initial=0.0)) / 2.0
        if turn > _TURN:
            yield Remark(
                "rotation",
                turn,
                f"elements rotate by up to {np.degrees(turn):.0f} degrees: rotations are "
                f"taken for small, which lets lengths grow by {turn**2 / 2.0:.0%}: take finite "
                "kinematics",
            )
        # Large strains may be an error of units.
        strain = max_abs(state.strain)
        if strain > _STRAIN:
            advice = ": take finite kinematics"
            if strain > 1.0:
                advice = "; are E and the loads in the same units?"
            yield Remark(
                "strain", strain, f"strains of up to {strain:.0%} are taken for small{advice}"
            )

    def element_forces(self, stress: ndarray, elements: ndarray) -> ndarray:
        """Return internal forces of the nodes on some elements, (n_local_dofs, n_elements)."""
        acting = stress[self._rows[:, None], elements]
        return np.einsum("eqcb,ceq,eq->be", self._B[elements], acting, self.weight[elements])

    @cached_property
    def _force_matrix(self) -> csr_matrix:
        """Matrix from stresses to internal forces; linear laws without initial stress need none."""
        B = self._B
        if len(self._rows) < self._ncomp:
            B = np.zeros((*self.weight.shape, self._ncomp, B.shape[3]))
            B[:, :, self._rows] = self._B
        return force_matrix(B, self.weight, self.basis.element_dofs, self.basis.N)

    @cached_property
    def _elasticity(self) -> ndarray:
        """Elastic moduli of every element in the rows of B that act, (n_elements, r, r)."""
        moduli = np.empty((self.basis.nelems, self._ncomp, self._ncomp))
        for region in self.regions:
            moduli[region.elements] = region.material.elasticity(self._ncomp)
        return self._acting(moduli)

    @cached_property
    def _flows(self) -> tuple[bool, ...]:
        """True for the regions whose material may flow."""
        return tuple(may_flow(region, self.basis) for region in self.regions)

    @property
    def _elastic(self) -> bool:
        """True if no material may flow."""
        return not any(self._flows)

    @cached_property
    def _predicted_bulk(self) -> ndarray:
        """Elastic bulk modulus of every element whose mean stresses are predicted, (n_elements, 1).

        It is zero in the other elements.
        """
        bulk = np.zeros((self.basis.nelems, 1))
        for region, flows in zip(self.regions, self._flows, strict=True):
            moduli = region.material.elasticity(self._ncomp)
            of_region = bulk_modulus_of(moduli)
            predicted = of_region > _STIFF * moduli[..., 3, 3]
            if flows:
                predicted = np.asarray(flows_at_constant_volume(region, self.basis))
            bulk[region.elements, 0] = np.where(predicted, of_region, 0.0)
        return bulk

    def _acting(self, moduli: ndarray) -> ndarray:
        """Return the part of some moduli, (n, ncomp, ncomp), in the rows of B that act."""
        if len(self._rows) == self._ncomp:
            return moduli
        return moduli[:, self._rows[:, None], self._rows]

    @cached_property
    def elastic_stiffness(self) -> csr_matrix:
        """Stiffness of the unyielded body, a ``csr_matrix`` of shape (N, N): assembled once."""
        D = self._elasticity[:, None] * self.weight[..., None, None]
        return self._pattern.matrix(self._pattern.scatter(element_stiffness(self._B, D)))

    @cached_property
    def _diagonal(self) -> ndarray:
        """Diagonal of the elastic stiffness, (N,)."""
        return self.elastic_stiffness.diagonal()

    def _tangent(self, given: _Given, updates: list[Update], damping: bool = False) -> csr_matrix:
        """Correct the elastic stiffness in the elements that hold a point of another tangent."""
        n_points = self.weight.shape[1]
        # Collect the points whose tangent is not elastic.
        points = []
        tangents = []
        for (region, stress, internal), update in zip(given, updates, strict=True):
            changed, tangent = changed_moduli(region.material, stress, internal, update, damping)
            if len(changed):
                points.append(changed + n_points * (region.elements.start or 0))
                tangents.append(tangent)
        if not points:
            return self.elastic_stiffness

        # number the elements that change; the points of an element follow each other
        point = np.concatenate(points)
        element, q = np.divmod(point, n_points)
        first = np.ones(len(point), bool)
        first[1:] = element[1:] != element[:-1]
        elements = element[first]
        position = np.cumsum(first) - 1

        # integrate the difference to the elastic moduli
        D = self._acting(np.concatenate(tangents))
        D -= self._elasticity[element]
        D *= self.weight.take(point)[:, None, None]
        n_rows = len(self._rows)
        change = np.zeros((len(elements), n_points, n_rows, n_rows))
        change[position, q] = D
        correction = self._pattern.scatter(element_stiffness(self._B[elements], change), elements)
        correction += self.elastic_stiffness.data
        return self._pattern.matrix(correction)


def _linear(laws: Mapping[str, Material]) -> bool:
    """Return True if all laws are linear elasticity: classes that derive from it may be any."""
    return all(type(law) is LinearElastic for law in laws.values())


def _is_constant(law: Material) -> bool:
    """Return True if the tangent is constant, by the update of linear elasticity."""
    varies = law.n_internal or law.stress_dependent or law.time_dependent
    return not varies and type(law).update is LinearElastic.update


def _updates(calls: list[LawCall]) -> tuple[list[Update], ndarray]:
    """Return the responses of the materials of a body, and its stresses."""
    updates = [call.update for call in calls]
    stress = updates[0].stress  # the stress of a single region is not copied
    if len(updates) > 1:
        stress = np.concatenate([update.stress for update in updates], axis=1)
    return updates, stress


def sharpened(form: SolidForm, x: ndarray) -> ndarray:
    """Return sines of the corners of elements in the plane, (n_corners, n_elements).

    They are 1 for corners that were sharp before, and negative for corners that are turned over.
    """
    nodes = form.basis.nodal_dofs[:, form.basis.mesh.t[:, form.elements]]
    coordinates = form.basis.doflocs[:, nodes[0]]
    before = _sines(coordinates)
    now = _sines(coordinates + x[nodes])
    return np.where(before > 2.0 * _SHARP, now, 1.0)


def _sines(corners: ndarray) -> ndarray:
    """Return sines of the angles at corners (2, k, n) of elements, negative if turned over."""
    # sin = (a x b) / (|a| |b|), by the edges a and b that leave a corner
    after = np.roll(corners, -1, axis=1) - corners
    before = np.roll(corners, 1, axis=1) - corners
    cross = after[0] * before[1] - after[1] * before[0]
    lengths = np.sqrt((after**2).sum(axis=0) * (before**2).sum(axis=0))
    sine = cross / lengths
    return np.asarray(sine * np.sign(sine.sum(axis=0)))
