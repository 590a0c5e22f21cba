"""Consolidation: ground that deforms with the water in its pores (M. A. Biot 1941)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, diags_array
from skfem import CellBasis
from typing_extensions import override

from ..checks import check_basis, check_quadrature, positive
from ..errors import Remark
from ..forms.base import Form, Forms, Outputs, Response, States
from ..forms.roles import Couples, Dissipating, Staged, Timed, Wet
from ..layout import Field, FieldDofs, elements_of, linear_element, nodes
from ..loads import weight_of_water
from ..sparse import constant, with_data
from .boundary import Given, exchange, nodes_on, values_at
from .conductivity import Conductivity, Permeability
from .darcy import Tensor, laws_with_content, permeability_tensors, regions
from .drainage import check_step, check_units, pulled
from .flow_scheme import FlowScheme
from .moisture import Moisture
from .pore_storage import FullPores, PartlyFilledPores, Storage
from .porous import CompactedState, PoreState, Porous
from .retention import Laws, Retention
from .seepage import Seepage
from .surroundings import Ground, Surroundings

#: Name under which all ground shares the field of its pore pressures.
PRESSURE = "pore pressure"
#: Water out of balance is measured by the water that nodes store in a step, or by this share of the
#: water that flows in and out of them: at the usual tolerance that is 1e-14, its round-off in
#: ground a small part of which is 1e8 times as permeable.
_FLOWING = 1e-6


class PoreWater(Form, Couples, Dissipating, Staged, Timed, Wet):
    r"""Water in the pores of ground, which consolidates by Darcy's law.

    The form goes with solids, whose stresses are effective. With the excess pore pressure p,
    positive in compression,

    .. math:: \operatorname{div}(\sigma' - p\, I) + b = 0, \qquad
              \operatorname{div} \dot u + S\, \dot p =
              \operatorname{div}\left(\frac{k}{\gamma_w} \nabla p\right) .

    The excess is counted from the pressure at the beginning, hydrostatic or of steady seepage,
    which is part of the load (:func:`water_load`). It is a field of dofs, linear between the
    vertices of the mesh. Fixed :meth:`dofs` are drained, and :meth:`prescribed` changes a level
    with a stage. Every stage needs a ``duration``; its steps are of second order in time, and as
    short as `time_error` requires. Searches for a collapse keep the pressures.

    With a `retention` the ground is saturated below the water table and holds air above it. The
    pressure of the water is :math:`u = u_0 + p`, the pressure of the air is zero, and

    .. math:: \operatorname{div}(\sigma' - S_e\, u\, I) + b = 0, \qquad
              \frac{\partial}{\partial t} \bigl(S_w (n + \operatorname{div} u_s + S p)\bigr) =
              \operatorname{div}\left(\frac{k k_r}{\gamma_w} \nabla (u + \gamma_w z)\right) .

    The factor of Bishop's effective stress is the effective saturation :math:`S_e`, and the
    relative permeability is :math:`k_r`. The content of water gives the porosity n and the
    saturation :math:`S_w`. Steps balance differences of contents, so that no water is lost. Water
    that enters or leaves pores changes the weight b. Suction is a part of the strength, also in
    searches for a collapse.

    Parameters
    ----------
    basis
        ``Basis`` of the displacements, whole or restricted to the porous ground.
    permeability
        Permeability (length per time): a number, numbers along the axes, ``(kh, kv)``, or a tensor
        (dim, dim); one for all ground or by subdomain. A :class:`~skfem_contact.water.Permeability`
        changes with the void ratio.
    unit_weight
        Unit weight of water (force per volume).
    storage
        Compressibility of the water, its porosity over its bulk modulus (1 / stress), not negative;
        one for all ground or by subdomain.
    time_error
        Allowed error of a step in time, estimated by a method of first order, as a share of the
        water that the pressures can press out. Terzaghi's settlement is then wrong by 0.13 % at
        most.
    connected
        Pairs of boundaries of bodies that share no nodes, closed or open, between which water
        passes freely: their contact transfers the effective stress. Contact of other boundaries is
        tight and transfers the total stress.
    retention
        :class:`~skfem_contact.water.VanGenuchten`, :class:`~skfem_contact.water.BrooksCorey` or
        :class:`~skfem_contact.water.Ramp` with a `content`, for all ground or by subdomain; without
        it the ground is saturated.
    start
        Heads at the start of ground with a retention: a :class:`~skfem_contact.water.Seepage`, a
        number, or a function of the coordinates (dim, ...). Ground under a suction s has the head
        z - s. Water that is not at rest then flows; boundaries without a condition are tight.

    Notes
    -----
    Strain measure and coordinates are those of the solids. Methods that read a vector of all dofs
    belong to the form of a model or a stage, ``stage.forms["water"]``, which knows its numbers.

    Quadratic displacements with these pressures are stable (Taylor and Hood). Linear ones are
    stabilised: changes of pressure that differ from their mean over an element store water, 1 / 2G
    a unit (P. B. Bochev and C. R. Dohrmann 2006).

    In stages with ``dynamic`` the solids have the unit weight of saturated ground, and the water
    flows by Darcy's law without inertia of its own. That needs ``omega k rho / gamma_w`` below 0.1,
    with the density rho of the ground and the angular frequency of the motion.

    With a retention the load contains the weight of the water at the start, and its pressures:
    ``water_load(basis, water.initial)`` of the form of a model. The flow is then the whole one, not
    the flow by the excess alone.

    Examples
    --------
    A column drains at its top: after T = c_v t / H² = 0.197 half of its settlement has happened (K.
    Terzaghi).

    >>> import numpy as np
    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> mesh = MeshTri.init_tensor(np.array([0., .1]), np.linspace(0, 1, 11)).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    >>> forms = {"clay": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.)),
    ...          "water": sc.PoreWater(basis, permeability=1e-4, unit_weight=10.)}      # c_v = 0.1
    >>> fixed = [sc.box_supports(basis, base="rollers"), forms["water"].dofs("top")]
    >>> load = sc.traction(basis, "top", (0., -100.))
    >>> stages = [sc.Stage("load", load, duration=.02), sc.Stage("wait", load, duration=1.96)]
    >>> result = sc.Model(forms, fixed).run(stages)
    >>> settlement = -result["wait"].x[basis.get_dofs("top").all("u^2")] / .01
    >>> bool(abs(settlement - .5).max() < .003)
    True

    A column of silt loses its water: it settles because suction compresses it.

    >>> silt = sc.water.VanGenuchten(alpha=1., n=3., content=(.05, .4))
    >>> water = sc.PoreWater(basis, 1e-2, retention=silt, start=1., unit_weight=10.)
    >>> forms = {"silt": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.)), "water": water}
    >>> model = sc.Model(forms, [sc.box_supports(basis, base="rollers"), water.dofs("bottom")])
    >>> lower = model.forms["water"].prescribed({"bottom": -10.})
    >>> stages = [sc.Stage("lower", prescribed=lower, duration=1e5)]
    >>> stage = model.run(stages, progress=False)["lower"]
    >>> round(float(-1e3 * stage.x[basis.get_dofs("top").all("u^2")].mean()), 2)
    8.77
    >>> round(10 * water.volume(stage.states["water"]), 3)
    -0.049
    """

    kinematics = "small"

    second_order = True
    size: int
    carries: ndarray
    porous: Porous
    around: Surroundings | None = None
    #: Water that deforming ground holds, and the flow through it.
    storage: Storage
    conductivity: Conductivity
    _moisture: Moisture | None
    _capacity: ndarray
    _numbers: ndarray | None = None
    _duration: float | None = None
    _step: csr_matrix
    _steps: dict[float, PoreWater]
    _scheme: FlowScheme = FlowScheme()

    def __init__(
        self,
        basis: CellBasis,
        permeability: Tensor | Mapping[str, Tensor] | Permeability,
        *,
        unit_weight: float,
        storage: float | Mapping[str, float] = 0.0,
        time_error: float = 0.01,
        connected: Sequence[tuple[str, str]] = (),
        retention: Retention | Mapping[str, Retention] | None = None,
        start: Seepage | Given | None = None,
    ) -> None:
        check_basis(basis)
        check_quadrature(basis)
        self.unit_weight = weight_of_water(unit_weight)
        self._time_error = positive(time_error, "time_error")
        # Permeability
        self._rate: ndarray | None = None
        tensors: Any = permeability
        if isinstance(permeability, Permeability):
            tensors = permeability.start
            self._rate = permeability.rate(basis)
            if connected:
                raise ValueError(
                    "a Permeability that depends on the void ratio needs ground without "
                    "`connected` boundaries"
                )
        self.mobility = permeability_tensors(basis, tensors) / unit_weight
        # Compressibility of the water
        self._specific = np.zeros(basis.nelems)
        for part, value in regions(basis, storage, "storage"):
            if not 0.0 <= value < np.inf:
                raise ValueError(f"the storage must be finite and not negative, not {value!r}")
            self._specific[part] = value
        # Dofs
        self.ground = basis
        self.pressures = basis.with_element(linear_element(basis.mesh))
        self.nodes = (np.arange(basis.N), basis.doflocs)
        self.joins = np.zeros(0, int)
        self._exchange = exchange(self.pressures, connected)
        self._vertices = np.unique(self.pressures.element_dofs)
        coordinates = np.asarray(basis.mesh.p)[:, : self.pressures.N]
        self.size = int(basis.N)
        self.fields = (Field(PRESSURE, coordinates, "pressure", shared=PRESSURE),)
        # Retention
        self._laws: Laws | None = None
        #: Pressure from which the excess counts, (n_vertices,), where the form knows it.
        self.start: ndarray | float = 0.0
        if (retention is None) != (start is None):
            raise ValueError("partly saturated ground needs both `retention` and `start`")
        if retention is not None and start is not None:
            self._laws = laws_with_content(basis, retention)
            self.start = self._pressure_of(start)
        self.symmetric = self._rate is None and self._laws is None

    def _pressure_of(self, start: Seepage | Given) -> ndarray:
        """Return the pressure of heads at the vertices, (n_vertices,), zero outside."""
        x = self.fields[0].coordinates
        if isinstance(start, Seepage):
            head = start.head
        else:
            head = values_at(start, x, "start")
        if np.shape(head) != x.shape[1:] or not np.isfinite(head[self._vertices]).all():
            raise ValueError("the start is a seepage of another mesh, or of other ground")
        known = np.where(np.isfinite(head), head, x[-1])
        return self.unit_weight * (known - x[-1])

    def __repr__(self) -> str:
        return f"<PoreWater {self.ground.nelems} elements, {len(self._vertices)} pressures>"

    @property
    @override
    def elements(self) -> ndarray:
        return elements_of(self.ground)

    @property
    def first(self) -> int:
        """First dof of the pressures."""
        if self._numbers is None:
            raise ValueError(
                "the model numbers the pressures: take the water from model.forms or stage.forms"
            )
        return int(self._numbers[0])

    @property
    def initial(self) -> ndarray:
        """Bishop's pressure at the start at the vertices, (n_vertices,), as part of the load."""
        if self.around is None:
            raise ValueError(
                "the model completes the water: take it from model.forms or stage.forms"
            )
        if self._moisture is None:
            raise ValueError("saturated PoreWater counts from any pressure: it has no initial one")
        return self._moisture.initial()

    def dofs(self, *boundaries: str) -> FieldDofs:
        """Return the pressures at the nodes of some boundaries, to be held, by default all.

        Drains inside of the ground are boundaries too: facets of the mesh with a name.
        """
        indices = [nodes_on(self.pressures, name) for name in boundaries] or [self._vertices]
        return FieldDofs(self.fields[0], np.unique(np.concatenate(indices)))

    def prescribed(self, pressures: Mapping[str, Given]) -> ndarray:
        """Return excess pressures on boundaries, for ``Stage.prescribed``, (N,), zero elsewhere.

        They are numbers or functions of coordinates (dim, ...): unit_weight * dh where a level
        changes by dh.
        """
        values = np.zeros(self.size)
        values[self.first :] = self.at_boundaries(pressures)
        return values

    def at_boundaries(self, pressures: Mapping[str, Given]) -> ndarray:
        """Return pressures on boundaries at the vertices, (n_vertices,), zero elsewhere."""
        coordinates = self.fields[0].coordinates
        values = np.zeros(coordinates.shape[1])
        for name, given in pressures.items():
            indices = nodes_on(self.pressures, name)
            what = f"pressure of boundary '{name}'"
            values[indices] = values_at(given, coordinates[:, indices], what)
        return values

    def pressure(self, x: ndarray) -> ndarray:
        """Return the excess pore pressure at the vertices, (n_vertices,), NaN outside."""
        if np.ndim(x) != 1 or len(x) < self.first + self.fields[0].n:
            raise ValueError(f"x has the shape {np.shape(x)}, and not that of a stage's x")
        values = np.full(self.fields[0].n, np.nan)
        values[self._vertices] = x[self.first + self._vertices]
        return values

    @override
    def pressure_at_nodes(self, x: ndarray) -> ndarray:
        basis = self.ground
        parts = self.pressures
        local = np.asarray(basis.elem.elem.doflocs).T
        values = [parts.elem.lbasis(local, j)[0] for j in range(parts.Nbfun)]
        shapes = np.stack([np.broadcast_to(each, local.shape[1]) for each in values])
        pressure = np.zeros(basis.N // basis.mesh.dim())
        pressure[nodes(basis)] = x[self.first + parts.element_dofs.T] @ shapes
        return pressure

    def inflow(self, state: PoreState, boundary: str | None = None) -> float:
        """Return the water that has entered since the ground became active, also on a boundary.

        Water that an :class:`Inflow` brings to the nodes of the boundary counts as well: a part of
        the sources in the elements beside it.
        """
        if boundary is None:
            return float(state.entered.sum())
        return float(state.entered[nodes_on(self.pressures, boundary)].sum())

    def volume(self, state: PoreState) -> float:
        """Return the growth of the stored water since the ground became active."""
        return float((state.stored - state.first).sum())

    @override
    def completed(self, forms: Forms) -> PoreWater:
        if self.around is not None:
            return self
        others = []
        for name, form in forms.items():
            if not isinstance(form, PoreWater) or form is self:
                continue
            n = len(np.intersect1d(form.elements, self.elements))
            if n:
                raise ValueError(
                    f"'{name}' is PoreWater of {n} of the same elements: their water would count "
                    "twice; replace water by Stage(change=...)"
                )
            others.append(form)
        return self._in(Surroundings.of(self.ground, forms, others))

    def drainage(self, modulus: ndarray) -> Ground:
        """Return the ground of elements with their oedometric moduli, (n_elements,)."""
        mobility = np.linalg.eigvalsh(self.mobility)[:, -1]
        return Ground(self.pressures.element_dofs, mobility, modulus * mobility)

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> PoreWater:
        new = copy(self)
        own = numbers[self.fields[0]]
        new._numbers = own
        new._steps = {}
        new.storage = self.storage.numbered(int(own[0]))
        new.conductivity = self.conductivity.numbered(int(own[0]))
        new.size = int(own[-1]) + 1
        new.carries = own[self._vertices]
        return new

    @override
    def continues(self, old: Form) -> PoreWater:
        super().continues(old)
        assert isinstance(old, PoreWater)
        if not np.array_equal(old._vertices, self._vertices):
            raise ValueError("its elements are others")
        if not _same(old._rate, self._rate):
            raise ValueError("its void ratio or the change is another")
        if not _same_laws(old._laws, self._laws) or not _same(old.start, self.start):
            raise ValueError("its retention or its start is another")
        if old.around is None:
            return self
        return self._in(old.around)

    def _in(self, around: Surroundings) -> PoreWater:
        """Return the water in ground of known stiffness."""
        # The ground gives stiffness, coordinates and the measure of its strains.
        new = copy(self)
        basis = self.ground
        coordinates = around.measure[1]
        axisymmetric = coordinates == "axisymmetric"
        new.around = around
        new.coordinates = coordinates
        new._steps = {}
        # Integrate the matrices.
        porous = Porous.of(basis, self.pressures, around.measure, self.mobility, *self._exchange)
        softness = 1.0 / around.modulus + self._specific
        new.porous = porous
        new._capacity = porous.at_nodes(softness)
        size = basis.dx.sum(axis=1) ** (1.0 / basis.mesh.dim())
        scale = float(around.modulus.mean() / size.mean())
        new.fields = (replace(self.fields[0], scale=scale),)
        # Store the water, and let it flow.
        new._moisture = None
        if self._laws is None:
            new.storage = FullPores(porous, self._specific, around.shear, new._capacity)
        else:
            assert isinstance(self.start, np.ndarray)
            new._moisture = Moisture(
                self.pressures,
                self.mobility,
                laws=self._laws,
                start=self.start,
                unit_weight=self.unit_weight,
                axisymmetric=axisymmetric,
            )
            new.suction = max(-float(new.initial.min()), 0.0)
            new.storage = PartlyFilledPores(
                porous,
                self._specific,
                shear=around.shear,
                softness=softness,
                moisture=new._moisture,
                unit_weight=self.unit_weight,
                axisymmetric=axisymmetric,
            )
        new.conductivity = Conductivity(porous, self._rate, new._moisture)
        return new

    @override
    def check_stage(self, fixed: ndarray, held: ndarray, duration: float) -> Iterator[Remark]:
        # Check that the ground is active, and that time passes.
        if not duration > 0.0:
            raise ValueError(
                "PoreWater needs time: give Stage(duration=...), a short one for an instantaneous "
                "change, or activate the water in a later stage"
            )
        if np.isin(self.ground.element_dofs, held).any():
            raise ValueError(f"PoreWater is active in inactive ground: {self!r}")
        # Refuse pressures that nothing determines.
        around = self.around
        assert around is not None
        drained = fixed[(fixed >= self.first) & (fixed < self.size)] - self.first
        determined = np.isin(drained, self._vertices).any() or self._specific.any()
        if not determined and not self.porous.strains(fixed[fixed < self.ground.N]):
            raise ValueError(
                "the pore pressure is not determined: nothing is drained, the water cannot be "
                "compressed, and the ground can neither grow nor shrink; hold a pressure, `fixed` "
                "with water.dofs(...), or give a storage"
            )
        # Report steps that are too short, and friction of undrained ground.
        own = self.drainage(around.modulus)
        yield from check_units(self.ground, own.diffusivity, duration)
        yield from self._undrained_friction(around, drained)
        yield from around.crossed
        others = []
        for dofs, ground in around.waters:
            if not np.isin(dofs, held).any():
                others.append(ground)
        grounds = [own, *others]
        yield from check_step(self.ground, grounds, drained, around.leaks, duration, self.first)

    def _undrained_friction(self, around: Surroundings, drained: ndarray) -> Iterator[Remark]:
        """Report friction of contact at nodes that are not drained."""
        dofs = self.ground.nodal_dofs[0, self._vertices]
        for name, form in around.touching.items():
            touched = self._vertices[np.isin(dofs, form.joins)]
            pressed = np.setdiff1d(touched, np.append(drained, self.porous.open))
            if len(pressed) and form.has_friction:
                yield Remark(
                    "friction",
                    len(pressed),
                    f"'{name}' transfers the pressure of the water as well, at {len(pressed)} "
                    "nodes that are not drained: friction there counts the total stress, not the "
                    "effective one",
                )

    @override
    def remarks_on(self, x: ndarray, states: States) -> Iterator[Remark]:
        dim = self.ground.mesh.dim()
        dofs = nodes(self.ground) * dim
        connected = self.ground.nodal_dofs[0, self.porous.open]
        for name, pair in (self.around.touching if self.around else {}).items():
            touched = np.intersect1d(dofs, pair.joins)
            tight = not pair.law.bonds and not np.isin(connected, touched).any()
            if name in states and tight:
                coordinates = self.ground.doflocs[:, touched]
                pressure = self.pressure_at_nodes(x)[touched // dim]
                yield from pulled(name, pair, states[name], coordinates, pressure)

    @override
    def over(self, duration: float) -> PoreWater:
        if duration > 0.0:
            return self._over(duration)
        return self

    @override
    def undrained(self) -> PoreWater:
        return self._over(0.0)

    def _over(self, duration: float) -> PoreWater:
        if duration not in self._steps:  # equal steps share their matrix
            new = copy(self)
            new._duration = duration
            if isinstance(self.storage, FullPores) and self.conductivity.linear:
                kept = self.storage.matrix
                flowing = self._scheme.implicit(duration)
                data = kept.data + flowing * self.conductivity.saturated.data
                new._step = constant(with_data(kept, data))
            self._steps.clear()
            self._steps[duration] = new
        return self._steps[duration]

    @override
    def initial_state(self, x: ndarray | None = None) -> PoreState:
        zero = np.zeros(self.fields[0].n)
        if x is None:
            state = PoreState(zero, zero, zero, zero)
        else:
            stored = self.storage.held(x).volume
            state = PoreState(stored, stored, zero, x[self.first :].copy())
        if self._rate is None:
            return state
        if x is None:
            strain = np.zeros(self.ground.nelems)
        else:
            strain = self._grown(x)
        return CompactedState(**vars(state), strain=0.0 * strain, before=-strain)

    def _grown(self, x: ndarray) -> ndarray:
        """Return the mean volume strain of the elements by displacements, (n_elements,)."""
        moves = x[self.ground.element_dofs.T]
        return np.asarray(np.einsum("eb,eb->e", self.porous.growth, moves))

    def assemble(self, x: ndarray, state: PoreState) -> Response:
        """Return forces on the ground and the water that leaves the nodes.

        Without time pressures stay.
        """
        if self._duration is None:
            return self._standing(x, state)
        # Pressures follow the displacements among the dofs.
        first = self.first
        duration = self._duration
        pressure = x[first:]
        strain = None
        changed: dict[str, ndarray] = {}
        if isinstance(state, CompactedState):
            strain = self._grown(x) + state.before
            changed["strain"] = strain
        # Balance stored and leaving water at the nodes.
        water = self.storage.held(x)
        leaving = self.conductivity.leaving(pressure, strain)
        before = leaving
        if self._scheme.gamma < 1.0:
            before = self.conductivity.leaving(state.pressure, strain)
        left, rate = self._scheme.step(duration, state.rate, before, leaving)
        gained = state.stored - water.volume
        entering = gained - left
        # Measure round-off by the water that nodes store and that flows in and out.
        through = _FLOWING * duration * self.conductivity.gross(self.start + pressure)
        round_off = duration * self.conductivity.round_off(pressure)
        round_off = round_off + self.storage.round_off(water)

        def after() -> PoreState:
            return replace(
                state,
                stored=water.volume,
                entered=state.entered - entering,
                pressure=pressure,
                rate=rate,
                **changed,
            )

        def tangent() -> csr_matrix:
            if self.symmetric:
                return self._step
            slopes = self.conductivity.slopes(pressure, strain)
            return self.storage.tangent(x, water, slopes, duration)

        return Response(
            np.append(water.force, entering),
            after,
            tangent,
            measure=np.append(water.force, np.abs(gained) + through),
            round_off=np.append(np.zeros(first), round_off) if np.ndim(round_off) else 0.0,
        )

    def _standing(self, x: ndarray, state: PoreState) -> Response:
        """Return the response of ground whose pressures stay."""
        off = self._capacity * (x[self.first :] - state.pressure)
        stiffness = np.append(np.zeros(self.first), self._capacity)
        return Response(
            np.append(self.storage.thrust(state.pressure), off),
            lambda: replace(state, stored=self.storage.held(x).volume),
            lambda: csr_matrix(diags_array(stiffness)),
        )

    @override
    def extrapolated(self, before: PoreState, found: PoreState, ratio: float) -> PoreState:
        return replace(
            found,
            stored=before.stored + ratio * (found.stored - before.stored),
            entered=before.entered + ratio * (found.entered - before.entered),
        )

    @override
    def time_error(self, middle: PoreState, after: PoreState) -> tuple[float, float]:
        assert self._duration is not None
        flowed = 0.5 * float(np.abs(after.entered - middle.entered).sum())
        movable = [self.storage.movable(state.pressure) for state in (middle, after)]
        change = self.conductivity.change(
            middle.pressure, after.pressure, _strain_of(middle), _strain_of(after)
        )
        return 0.5 * self._duration * change / self._time_error, max(flowed, *movable)

    @override
    def with_inertia(self, rho_inf: float, density: ndarray) -> tuple[PoreWater, float]:
        if not self.conductivity.linear:
            raise ValueError(
                "inertia needs saturated ground of constant permeability, without `retention` and "
                "without Permeability(change=...)"
            )
        new = copy(self)
        new._steps = {}
        new._scheme = FlowScheme.of(rho_inf)
        mobility = np.linalg.eigvalsh(self.mobility)[:, -1]
        return new, float((mobility * density[self.elements]).max())

    @override
    def dissipated(self, before: PoreState, after: PoreState, work: float) -> float:
        # What water neither stores nor takes along through boundaries is lost in its flow.
        mean = 0.5 * (before.pressure + after.pressure)
        return -float(mean @ (after.stored - before.stored))

    @override
    def rebased(self, x: ndarray, state: PoreState) -> PoreState:
        room = self.storage.by_displacements(x[: self.size])
        new = replace(state, stored=state.stored - room, first=state.first - room)
        if isinstance(new, CompactedState):
            return replace(new, before=new.before + self._grown(x))
        return new

    @override
    def outputs(self, x: ndarray, state: PoreState) -> Outputs:
        p = state.pressure[self._vertices]
        pressed_out = -self.volume(state)
        return Outputs(
            f"excess pressure {p.min():.4g} to {p.max():.4g}, "
            f"{pressed_out:.4g} of water pressed out"
        )


def _strain_of(state: PoreState) -> ndarray | None:
    if isinstance(state, CompactedState):
        return state.strain
    return None


def _same(first: ndarray | float | None, second: ndarray | float | None) -> bool:
    if first is None or second is None:
        return first is second
    return np.array_equal(first, second)


def _same_laws(first: Laws | None, second: Laws | None) -> bool:
    if first is None or second is None:
        return first is second
    return [(part.tolist(), law) for part, law in first] == [
        (part.tolist(), law) for part, law in second
    ]
