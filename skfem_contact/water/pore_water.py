"""Consolidation: ground that deforms with the water in its pores (M. A. Biot 1941)."""
from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, diags_array
from skfem import CellBasis
from typing_extensions import override

from ..errors import Remark, check_basis, check_quadrature
from ..forms.base import Form, Response
from ..layout import Field, FieldDofs, elements_of, nodes
from ..sparse import with_data
from .conditions import Given, nodes_on, values_at
from .darcy import Permeability, permeability_tensors, regions
from .drainage import drainage_remarks
from .porous import PRESSURE, PoreState, Porous, Surroundings

#: Water out of balance is measured by what nodes store in a step, or by this share of what flows in and out of them: at
#: the usual tolerance that is 1e-14, its round-off in ground a small part of which is 1e8 times as permeable.
_FLOWING = 1e-6


class PoreWater(Form):
    r"""Water in the pores of saturated ground: pressed out where this is compressed, it flows by Darcy's law.

    It stands beside the solids, whose stresses are effective. With the excess pore pressure p, positive in compression,

    .. math:: \operatorname{div}(\sigma' - p\, I) + b = 0, \qquad
              \operatorname{div} \dot u + S\, \dot p = \operatorname{div}\left(\frac{k}{\gamma_w} \nabla p\right) .

    The pressure counts from that of the water at the beginning, which is part of the load (:func:`water_load`): from
    hydrostatic pressure or steady seepage. It is a field of dofs besides the displacements, linear between the
    vertices of the mesh, and held like a displacement: fixed :meth:`dofs` are drained, and :meth:`prescribed` changes
    a level with a stage. Every stage needs a ``duration``; its steps are of second order in
    time, and as short as `time_error` asks for. In a search for a collapse the pressures stay as they are.

    Parameters
    ----------
    basis
        ``Basis`` of the displacements, whole or restricted to what is porous.
    permeability
        Permeability (length per time): a number, numbers along the axes, ``(kh, kv)``, or a tensor (dim, dim); one for
        all ground or by subdomain.
    unit_weight
        Of water (force per volume).
    storage
        Compressibility of the water, its porosity over its bulk modulus (1 / stress), not negative; one for all ground
        or by subdomain.
    time_error
        Error of a step in time that is allowed, estimated by a method of first order, as a share of the water that the
        pressures can press out. Of Terzaghi's settlement 0.13 % is then wrong at most.
    connected
        Pairs of boundaries of bodies that share no nodes, closed or open, through which water passes freely, as in
        :func:`seepage`. It presses on both sides, so that contact there carries the effective stress. Other joints are
        tight, and contact there carries the water's pressure as well.

    Raises
    ------
    ValueError
        Permeabilities that are not positive and finite, a negative storage, unknown subdomains; when an analysis
        begins: a stage without duration, ground without a solid or with an :class:`Undrained` one, pressures that
        nothing determines.

    Notes
    -----
    Strain measure and coordinates are those of the solids. Methods that read a vector of all dofs belong to the form of
    a model or a stage, ``stage.forms["water"]``, which knows its numbers.

    Quadratic displacements with these pressures are stable (Taylor and Hood). Linear ones are stabilised: changes of
    pressure that differ from their mean over an element store water, 1 / 2G a unit (P. B. Bochev and C. R. Dohrmann
    2006).

    Examples
    --------
    A column drains at its top: after T = c_v t / H² = 0.197 half of its settlement has happened (K. Terzaghi).

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
    _numbers: ndarray | None = None
    capacity: ndarray
    _step: csr_matrix

    def __init__(self, basis: CellBasis, permeability: Permeability | Mapping[str, Permeability], *,
                 unit_weight: float, storage: float | Mapping[str, float] = 0.0,
                 time_error: float = 0.01, connected: Sequence[tuple[str, str]] = ()) -> None:
        check_basis(basis)
        check_quadrature(basis)
        for what, value in (("unit weight of water", unit_weight), ("error in time", time_error)):
            if not 0.0 < value < np.inf:
                raise ValueError(f"the {what} must be positive, not {value!r}")
        self.mobility = permeability_tensors(basis, permeability) / unit_weight
        self.storage = np.zeros(basis.nelems)
        for part, value in regions(basis, storage, "storage"):
            if not 0.0 <= value < np.inf:
                raise ValueError(f"the storage must be finite and not negative, not {value!r}")
            self.storage[part] = value
        self._connected, usual = tuple(connected), ("full", "plane" if basis.mesh.dim() == 2 else "space")
        self.porous = Porous.of(basis, usual, self.mobility, connected)
        self.unit_weight, self._time_error = unit_weight, time_error
        self.nodes, self.joins = (np.arange(basis.N), basis.doflocs), np.zeros(0, int)
        self._vertices = np.unique(self.porous.pressures.element_dofs)
        coordinates = np.asarray(basis.mesh.p)[:, :self.porous.pressures.N]
        self.size, self.fields = int(basis.N), (Field(PRESSURE, coordinates, "pressure", shared=PRESSURE),)
        self.around: Surroundings | None = None
        self._duration: float | None = None

    def __repr__(self) -> str:
        return f"<PoreWater {self.porous.basis.nelems} elements, {len(self._vertices)} pressures>"

    @property
    def elements(self) -> ndarray:
        """Numbers of the porous elements in the mesh, (n_elements,)."""
        return elements_of(self.porous.basis)

    @property
    def first(self) -> int:
        """First dof of the pressures."""
        if self._numbers is None:
            raise ValueError("the model numbers the pressures: take the water from model.forms or stage.forms")
        return int(self._numbers[0])

    # -- questions of a user ---------------------------------------------------------------------------------

    def dofs(self, *boundaries: str) -> FieldDofs:
        """Return the pressures at the nodes of some boundaries, to be held; without any, all of them.

        A boundary may be drains inside of the ground, facets of the mesh by any name.

        Raises
        ------
        ValueError
            A boundary that does not exist, or without porous ground.
        """
        at = [self._at(name) for name in boundaries] or [self._vertices]
        return FieldDofs(self.fields[0], np.unique(np.concatenate(at)))

    def prescribed(self, pressures: Mapping[str, Given]) -> ndarray:
        """Return excess pressures on boundaries, for ``Stage.prescribed``, (N,), with zeros for all other dofs.

        Parameters
        ----------
        pressures
            By boundary, a number or a function of coordinates (dim, ...): where a level changes by dh,
            unit_weight * dh.

        Raises
        ------
        ValueError
            As :meth:`dofs`; values that are not finite; water that no model has numbered.
        """
        values = np.zeros(self.size)
        values[self.first:] = self.at_boundaries(pressures)
        return values

    def at_boundaries(self, pressures: Mapping[str, Given]) -> ndarray:
        """Return pressures on boundaries at the vertices, (n_vertices,), zero elsewhere."""
        coordinates = self.fields[0].coordinates
        values = np.zeros(coordinates.shape[1])
        for name, given in pressures.items():
            at = self._at(name)
            values[at] = values_at(given, coordinates[:, at], f"pressure of boundary '{name}'")
        return values

    def pressure(self, x: ndarray) -> ndarray:
        """Return the excess pore pressure at the vertices of the mesh, (n_vertices,); NaN without porous ground."""
        values = np.full(self.fields[0].n, np.nan)
        values[self._vertices] = x[self.first + self._vertices]
        return values

    def pressure_at_nodes(self, x: ndarray) -> ndarray:
        """The same at the nodes of the displacements, middles of edges among them, (N/dim,); zero elsewhere."""
        basis, parts = self.porous.basis, self.porous.pressures
        corners, local = nodes(basis), np.asarray(basis.elem.elem.doflocs).T
        values = np.zeros(basis.N // basis.mesh.dim())
        shapes = np.stack([np.broadcast_to(parts.elem.lbasis(local, j)[0], local.shape[1]) for j in range(parts.Nbfun)])
        values[corners] = x[self.first + parts.element_dofs.T] @ shapes
        return values

    def inflow(self, state: PoreState, boundary: str | None = None) -> float:
        """Water that has entered the ground since it became active; negative what has left it.

        Parameters
        ----------
        state
            A state of this form.
        boundary
            Where; by default everywhere.
        """
        return float((state.entered if boundary is None else state.entered[self._at(boundary)]).sum())

    def volume(self, state: PoreState) -> float:
        """Water that the ground has more than when it became active: the growth of its pores, if water is rigid."""
        return float((state.stored - state.first).sum())

    def _at(self, boundary: str) -> ndarray:
        return nodes_on(self.porous.pressures, boundary)

    # -- questions of an analysis ----------------------------------------------------------------------------

    def completed(self, forms: Mapping[str, Form]) -> PoreWater:
        """Return the form with the stiffness of the ground, by which pressures are scaled and stabilised."""
        return self if self.around is not None else self._among(Surroundings.of(self.porous.basis, forms))

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> PoreWater:
        new = copy(self)
        new._numbers = numbers[self.fields[0]]
        new.size, new.carries = int(new._numbers[-1]) + 1, new._numbers[self._vertices]
        return new

    def continues(self, old: Form) -> PoreWater:
        """The form in the place of one of the same ground, from whose pressures it goes on."""
        if not isinstance(old, PoreWater) or not np.array_equal(old._vertices, self._vertices):
            raise ValueError("its elements are others")
        return self if old.around is None else self._among(old.around)

    def _among(self, around: Surroundings) -> PoreWater:
        """The form, complete."""
        new, basis = copy(self), self.porous.basis
        new.around, new.coordinates = around, around.measure[1]  # type: ignore[assignment]
        new.porous = Porous.of(basis, around.measure, self.mobility, self._connected)
        new.capacity = new.porous.at_nodes(1.0 / around.modulus + self.storage)
        size = basis.dx.sum(axis=1) ** (1.0 / basis.mesh.dim())
        new.fields = (replace(self.fields[0], scale=float(around.modulus.mean() / size.mean())),)
        return new

    @cached_property
    def _kept(self) -> csr_matrix:
        """Less what the ground and the water store, symmetric with what the pressures do to the ground."""
        assert self.around is not None
        parts = self.porous
        kept = self.storage[:, None, None] * parts.mass
        if parts.linear:
            kept = kept + parts.spread / (2.0 * self.around.shear)[:, None, None]
        return parts.symmetric(self.first, -parts.coupling, -kept)

    @cached_property
    def _passing(self) -> csr_matrix:
        """Less what flows, on the same pattern."""
        return self.porous.symmetric(self.first, 0.0 * self.porous.coupling, -self.porous.flow, -1.0)

    @cached_property
    def _gross(self) -> csr_matrix:
        """Sizes of what flows."""
        return abs(self._passing)

    def check_stage(self, fixed: ndarray, held: ndarray, duration: float) -> Iterator[Remark]:
        """Drainage and the time that it takes; see :func:`~skfem_contact.water.drainage.drainage_remarks`."""
        return drainage_remarks(self, fixed, held, duration)

    def over(self, duration: float) -> PoreWater:
        """The form of a step in time."""
        if not duration > 0.0:
            return self
        kept, passing, _ = self._kept, self._passing, self._gross  # found once: the forms of all steps have them
        new = copy(self)
        new._duration, new._step = duration, with_data(kept, kept.data + duration * passing.data)
        return new

    def initial_state(self, x: ndarray | None = None) -> PoreState:
        """Undeformed ground without excess pressure, or ground that becomes active at some displacements."""
        zero = np.zeros(self.fields[0].n)
        if x is None:
            return PoreState(zero, zero, zero, zero)
        stored = -(self._kept @ x)[self.first:]
        return PoreState(stored, stored, zero, x[self.first:].copy())

    def assemble(self, x: ndarray, state: PoreState) -> Response:
        """Forces of the pressures on the ground, and the water that leaves the nodes beyond what they have.

        Without a duration the pressures stay as they are.
        """
        if self._duration is None:
            return self._standing(x, state)
        first = self.first
        kept, flow = self._kept @ x, self._duration * (self._passing @ x)
        force = kept + flow
        force[first:] += state.stored
        measure = _FLOWING * self._duration * (self._gross @ np.abs(x))
        measure[:first] = kept[:first]
        measure[first:] += np.abs(kept[first:] + state.stored)
        pressure = x[first:]
        return Response(force, lambda: PoreState(-kept[first:], state.first, state.entered - force[first:], pressure),
                        lambda: self._step, measure=measure)

    def _standing(self, x: ndarray, state: PoreState) -> Response:
        """Pressures that stay."""
        held = np.zeros(self.size)
        held[self.first:] = state.pressure
        force = self._kept @ held
        force[self.first:] = self.capacity * (x[self.first:] - state.pressure)
        return Response(force, lambda: replace(state, stored=-(self._kept @ x)[self.first:]),
                        lambda: csr_matrix(diags_array(np.append(np.zeros(self.first), self.capacity))))

    def extrapolated(self, before: PoreState, found: PoreState, ratio: float) -> PoreState:
        """Water `ratio` times as far from an earlier state as what was found."""
        return replace(found, stored=before.stored + ratio * (found.stored - before.stored),
                       entered=before.entered + ratio * (found.entered - before.entered))

    def time_error(self, middle: PoreState, after: PoreState) -> tuple[float, float]:
        """Water that a method of first order would have let flow besides; what flows or may yet be pressed out."""
        assert self._duration is not None
        change = np.append(np.zeros(self.first), after.pressure - middle.pressure)
        flowed = 0.5 * float(np.abs(after.entered - middle.entered).sum())
        water = max(flowed, *(float(self.capacity @ np.abs(state.pressure)) for state in (middle, after)))
        return 0.5 * self._duration * float(np.abs(self._passing @ change).sum()) / self._time_error, water

    def rebased(self, x: ndarray, state: PoreState) -> PoreState:
        """The state with its pressures, of ground that counts as undeformed from here on."""
        moved = x[:self.size].copy()
        moved[self.first:] = 0.0
        less = (self._kept @ moved)[self.first:]
        return replace(state, stored=state.stored + less, first=state.first + less)

    def summary(self, state: PoreState) -> str:
        """Range of the pressures, and water that has left the ground, for the table of a result."""
        p = state.pressure[self._vertices]
        return f"excess pressure {p.min():.4g} to {p.max():.4g}, {-self.volume(state):.4g} of water pressed out"
