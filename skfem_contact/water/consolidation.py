"""Consolidation: ground that deforms with the water in its pores (M. A. Biot 1941)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, diags_array
from skfem import CellBasis
from typing_extensions import override

from ..checks import check_basis, check_quadrature, positive
from ..errors import Remark
from ..forms.base import Form, Response, pairs_of
from ..layout import Field, FieldDofs, elements_of, linear_element, nodes
from ..loads import weight_of_water
from ..sparse import constant, with_data
from .boundary import Given, exchange, nodes_on, values_at
from .darcy import Permeability, permeability_tensors, regions
from .porous import FLOWING, PRESSURE, Ground, PoreState, Porous, Surroundings, check_units, pulled


class PoreWater(Form):
    r"""Water in the pores of saturated ground, which consolidates by Darcy's law.

    The form goes with solids, whose stresses are effective. With the excess pore pressure p,
    positive in compression,

    .. math:: \operatorname{div}(\sigma' - p\, I) + b = 0, \qquad
              \operatorname{div} \dot u + S\, \dot p = \operatorname{div}\left(\frac{k}{\gamma_w} \nabla p\right) .

    The excess is counted from the pressure at the beginning, hydrostatic or of steady seepage,
    which is part of the load (:func:`water_load`). It is a field of dofs, linear between the
    vertices of the mesh. Fixed :meth:`dofs` are drained, and :meth:`prescribed` changes a level
    with a stage. Every stage needs a ``duration``; its steps are of second order in time, and as
    short as `time_error` requires. Searches for a collapse keep the pressures.

    Parameters
    ----------
    basis
        ``Basis`` of the displacements, whole or restricted to the porous ground.
    permeability
        Permeability (length per time): a number, numbers along the axes, ``(kh, kv)``, or a tensor
        (dim, dim); one for all ground or by subdomain.
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

    Notes
    -----
    Strain measure and coordinates are those of the solids. Methods that read a vector of all dofs
    belong to the form of a model or a stage, ``stage.forms["water"]``, which knows its numbers.

    Quadratic displacements with these pressures are stable (Taylor and Hood). Linear ones are
    stabilised: changes of pressure that differ from their mean over an element store water, 1 / 2G
    a unit (P. B. Bochev and C. R. Dohrmann 2006).

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
    """

    symmetric, second_order = True, True
    size: int
    carries: ndarray
    porous: Porous
    capacity: ndarray
    around: Surroundings | None = None
    _start: ndarray | float = 0.0  # pressure from which the excess counts, where the form knows it
    _numbers: ndarray | None = None
    _duration: float | None = None
    _step: csr_matrix
    _steps: dict[float, PoreWater]

    def __init__(
        self,
        basis: CellBasis,
        permeability: Permeability | Mapping[str, Permeability],
        *,
        unit_weight: float,
        storage: float | Mapping[str, float] = 0.0,
        time_error: float = 0.01,
        connected: Sequence[tuple[str, str]] = (),
    ) -> None:
        check_basis(basis)
        check_quadrature(basis)
        self.unit_weight, self._time_error = (
            weight_of_water(unit_weight),
            positive(time_error, "time_error"),
        )
        self.mobility = permeability_tensors(basis, permeability) / unit_weight
        self.storage = np.zeros(basis.nelems)
        for part, value in regions(basis, storage, "storage"):
            if not 0.0 <= value < np.inf:
                raise ValueError(f"the storage must be finite and not negative, not {value!r}")
            self.storage[part] = value
        self.ground, self.pressures = basis, basis.with_element(linear_element(basis.mesh))
        self.nodes, self.joins = (np.arange(basis.N), basis.doflocs), np.zeros(0, int)
        self._exchange, self._vertices = (
            exchange(self.pressures, connected),
            np.unique(self.pressures.element_dofs),
        )
        coordinates = np.asarray(basis.mesh.p)[:, : self.pressures.N]
        self.size, self.fields = (
            int(basis.N),
            (Field(PRESSURE, coordinates, "pressure", shared=PRESSURE),),
        )

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

    def dofs(self, *boundaries: str) -> FieldDofs:
        """Return the pressures at the nodes of some boundaries, to be held; without any, all of
        them.

        Drains inside of the ground are boundaries too: facets of the mesh with a name.
        """
        at = [nodes_on(self.pressures, name) for name in boundaries] or [self._vertices]
        return FieldDofs(self.fields[0], np.unique(np.concatenate(at)))

    def prescribed(self, pressures: Mapping[str, Given]) -> ndarray:
        """Return excess pressures on boundaries, for ``Stage.prescribed``, (N,), with zeros for all
        other dofs.

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
            at = nodes_on(self.pressures, name)
            values[at] = values_at(given, coordinates[:, at], f"pressure of boundary '{name}'")
        return values

    def pressure(self, x: ndarray) -> ndarray:
        """Return the excess pore pressure at the vertices of the mesh, (n_vertices,); NaN without
        porous ground.
        """
        values = np.full(self.fields[0].n, np.nan)
        values[self._vertices] = x[self.first + self._vertices]
        return values

    @override
    def pressure_at_nodes(self, x: ndarray) -> ndarray:
        basis, parts = self.ground, self.pressures
        corners, local = nodes(basis), np.asarray(basis.elem.elem.doflocs).T
        values = np.zeros(basis.N // basis.mesh.dim())
        shapes = np.stack(
            [
                np.broadcast_to(parts.elem.lbasis(local, j)[0], local.shape[1])
                for j in range(parts.Nbfun)
            ]
        )
        values[corners] = x[self.first + parts.element_dofs.T] @ shapes
        return values

    def inflow(self, state: PoreState, boundary: str | None = None) -> float:
        """Return the water that has entered since the ground became active, on one boundary or in
        all.
        """
        return float(
            (
                state.entered
                if boundary is None
                else state.entered[nodes_on(self.pressures, boundary)]
            ).sum()
        )

    def volume(self, state: PoreState) -> float:
        """Return the growth of the stored water since the ground became active."""
        return float((state.stored - state.first).sum())

    @override
    def completed(self, forms: Mapping[str, Form]) -> PoreWater:
        if self.around is not None:
            return self
        waters = {
            name: form
            for name, form in forms.items()
            if isinstance(form, PoreWater) and form is not self
        }
        for name, other in waters.items():
            if n := len(np.intersect1d(other.elements, self.elements)):
                raise ValueError(
                    f"'{name}' is PoreWater of {n} of the same elements: their water would count "
                    f"twice; "
                    "replace water by Stage(change=...)"
                )
        return self._in(Surroundings.of(self.ground, forms, list(waters.values())))

    def drainage(self, modulus: ndarray) -> Ground:
        """Return permeabilities and c_v of the elements with their oedometric moduli,
        (n_elements,).
        """
        mobility = np.linalg.eigvalsh(self.mobility)[:, -1]
        return Ground(self.pressures.element_dofs, mobility, modulus * mobility)

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> PoreWater:
        new = copy(self)
        new._numbers, new._steps = numbers[self.fields[0]], {}
        new.size, new.carries = int(new._numbers[-1]) + 1, new._numbers[self._vertices]
        return new

    @override
    def continues(self, old: Form) -> PoreWater:
        super().continues(old)
        assert isinstance(old, PoreWater)
        if not np.array_equal(old._vertices, self._vertices):
            raise ValueError("its elements are others")
        return self if old.around is None else self._in(old.around)

    def _in(self, around: Surroundings) -> PoreWater:
        new, basis = copy(self), self.ground
        new.around, new.coordinates, new._steps = around, around.measure[1], {}
        new.porous = Porous.of(
            basis, self.pressures, around.measure, self.mobility, *self._exchange
        )
        new.capacity = new.porous.at_nodes(1.0 / around.modulus + self.storage)
        size = basis.dx.sum(axis=1) ** (1.0 / basis.mesh.dim())
        new.fields = (replace(self.fields[0], scale=float(around.modulus.mean() / size.mean())),)
        return new

    @cached_property
    def _kept(self) -> csr_matrix:
        """Negative storage, with the coupling between pressures and displacements: symmetric."""
        assert self.around is not None
        parts = self.porous
        kept = self.storage[:, None, None] * parts.mass
        if parts.linear:
            kept = kept + parts.spread / (2.0 * self.around.shear)[:, None, None]
        return parts.matrix(self.first, -parts.coupling, -kept)

    @cached_property
    def _passing(self) -> csr_matrix:
        """Negative flow, on the same pattern."""
        return self.porous.matrix(self.first, 0.0 * self.porous.coupling, -self.porous.flow, -1.0)

    @cached_property
    def _flow(self) -> tuple[csr_matrix, csr_matrix]:
        """Negative flow among the pressures, and its absolute values."""
        flow = self._passing[self.first :, self.first :]
        return flow, abs(flow)

    @override
    def check_stage(self, fixed: ndarray, held: ndarray, duration: float) -> Iterator[Remark]:
        if not duration > 0.0:
            raise ValueError(
                "PoreWater needs time: give Stage(duration=...), a short one for an instantaneous "
                "change, "
                "or activate the water in a later stage"
            )
        if np.isin(self.ground.element_dofs, held).any():
            raise ValueError(f"PoreWater is active in inactive ground: {self!r}")
        around, drained = (
            self.around,
            fixed[(fixed >= self.first) & (fixed < self.size)] - self.first,
        )
        assert around is not None
        if not (
            np.isin(drained, self._vertices).any()
            or self.storage.any()
            or self.porous.strains(fixed[fixed < self.ground.N])
        ):
            raise ValueError(
                "the pore pressure is not determined: nothing is drained, the water cannot be "
                "compressed, "
                "and the ground can neither grow nor shrink; hold a pressure, `fixed` with "
                "water.dofs(...), or give a storage"
            )
        yield from check_units(
            self.ground, (own := self.drainage(around.modulus)).diffusivity, duration
        )
        for name, form in around.touching.items():
            touched = self._vertices[np.isin(self.ground.nodal_dofs[0, self._vertices], form.joins)]
            pressed = np.setdiff1d(touched, np.append(drained, self.porous.open))
            if len(pressed) and form.has_friction:
                yield Remark(
                    "friction",
                    len(pressed),
                    f"'{name}' transfers the pressure of the water as well, at {len(pressed)} "
                    f"nodes that are "
                    "not drained: friction there counts the total stress, not the effective one",
                )
        yield from around.crossed
        others = [ground for dofs, ground in around.waters if not np.isin(dofs, held).any()]
        yield from self.porous.check_step(
            drained, around.leaks, [own, *others], duration, self.first
        )

    @override
    def remarks_on(self, x: ndarray, states: Mapping[str, Any]) -> Iterator[Remark]:
        for name, pair in pairs_of(self.around.touching if self.around else {}).items():
            at = np.intersect1d(nodes(self.ground) * self.ground.mesh.dim(), pair.joins)
            open = pair.law.bonds or np.isin(self.ground.nodal_dofs[0, self.porous.open], at).any()
            if name in states and not open:
                yield from pulled(
                    name,
                    pair,
                    states[name],
                    self.ground.doflocs[:, at],
                    self.pressure_at_nodes(x)[at // self.ground.mesh.dim()],
                )

    @override
    def over(self, duration: float) -> PoreWater:
        return self._over(duration) if duration > 0.0 else self

    @override
    def undrained(self) -> PoreWater:
        return self._over(0.0)

    def _over(self, duration: float) -> PoreWater:
        if duration not in self._steps:  # equal steps share their matrix
            kept, passing, _ = (
                self._kept,
                self._passing,
                self._flow,
            )  # computed once, for the forms of all steps
            new = copy(self)
            new._duration, new._step = (
                duration,
                constant(with_data(kept, kept.data + duration * passing.data)),
            )
            self._steps.clear()
            self._steps[duration] = new
        return self._steps[duration]

    @override
    def initial_state(self, x: ndarray | None = None) -> PoreState:
        zero = np.zeros(self.fields[0].n)
        if x is None:
            return PoreState(zero, zero, zero, zero)
        stored = self._stored(x)
        return PoreState(stored, stored, zero, x[self.first :].copy())

    def _stored(self, x: ndarray) -> ndarray:
        return np.asarray(-(self._kept @ x)[self.first :])

    def assemble(self, x: ndarray, state: PoreState) -> Response:
        """Return forces on the ground and the water that leaves the nodes; without time pressures
        stay.
        """
        first = self.first
        if self._duration is None:
            return self._standing(x, state)
        (flow, gross), pressure = self._flow, x[first:]
        kept = self._kept @ x
        gained, force, measure = kept[first:] + state.stored, kept.copy(), kept.copy()
        force[first:] = gained + self._duration * (flow @ pressure)
        measure[first:] = np.abs(gained) + FLOWING * self._duration * (gross @ np.abs(pressure))
        return Response(
            force,
            lambda: PoreState(-kept[first:], state.first, state.entered - force[first:], pressure),
            lambda: self._step,
            measure=measure,
        )

    def _standing(self, x: ndarray, state: PoreState) -> Response:
        held = np.append(np.zeros(self.first), state.pressure)
        force = self._kept @ held
        force[self.first :] = self.capacity * (x - held)[self.first :]
        return Response(
            force,
            lambda: replace(state, stored=self._stored(x)),
            lambda: csr_matrix(diags_array(np.append(np.zeros(self.first), self.capacity))),
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
        water = max(
            flowed, *(float(self.capacity @ np.abs(state.pressure)) for state in (middle, after))
        )
        change = float(np.abs(self._flow[0] @ (after.pressure - middle.pressure)).sum())
        return 0.5 * self._duration * change / self._time_error, water

    @override
    def rebased(self, x: ndarray, state: PoreState) -> PoreState:
        moved = x[: self.size].copy()
        moved[self.first :] = 0.0
        less = (self._kept @ moved)[self.first :]
        return replace(state, stored=state.stored + less, first=state.first + less)

    @override
    def summary(self, state: PoreState) -> str:
        p = state.pressure[self._vertices]
        return f"excess pressure {p.min():.4g} to {p.max():.4g}, {-self.volume(state):.4g} of water pressed out"
