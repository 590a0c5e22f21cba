"""Water that enters or leaves consolidating ground: rain, wells, leaks and seepage faces."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Collection, Iterator, Mapping
from copy import copy
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from skfem import FacetBasis
from typing_extensions import Self, override

from ..checks import facets_of, format_point, names_of
from ..errors import Remark
from ..forms.base import Form, Forms, Outputs, Response
from ..forms.roles import Couples, Draining, Regularised, Staged, Timed
from ..layout import Field
from .boundary import Given, sourced, through
from .pore_water import PoreWater

#: Conductance of the face over the conductance of the ground at it: pressures exceed zero by a
#: hundredth of the drop in an element. By 1e4, and steps of 1e4 h² / c_v, SuperLU has been seen to
#: pass LAPACK illegal sizes.
_OPEN = 1e2
#: Share of a rate where the pressure is held that is remarked on, and what is less than all of it.
_IDLE = 0.2
_ALL = 1e-9
#: Depth of ponded water that is remarked on, as a share of that of the mesh, and slope of facets
#: that look up.
_PONDS = 0.01
_UPWARDS = 0.01


class AtNodes(Form, Couples, Staged, Timed):
    """Water that enters or leaves consolidating ground at nodes."""

    kinematics = "small"

    symmetric = True
    second_order = True
    #: Water of the ground, and dofs of its pressures at the nodes.
    water: PoreWater
    _dofs: ndarray
    _duration = 0.0

    @override
    def completed(self, forms: Forms) -> Self:
        return self._in(self.water.completed(forms))

    @override
    def continues(self, old: Form) -> Self:
        super().continues(old)
        assert isinstance(old, AtNodes)
        return self._in(old.water)

    @abstractmethod
    def _in(self, water: PoreWater) -> Self:
        """Return the form with the properties of its ground."""

    @override
    def over(self, duration: float) -> Self:
        new = copy(self)
        new._duration = duration
        return new


class Inflow(AtNodes):
    r"""Water that enters ground with :class:`PoreWater` at given rates, while the form is active.

    Rates are changed by stages, with ``Stage(change=...)`` or ``deactivate``. Water that the
    ground does not take leaves it at a :class:`SeepageFace` on the same boundary.

    Parameters
    ----------
    water
        Water of the ground.
    flux
        Rates per area by boundary: numbers or functions of coordinates (dim, ...). A well of
        discharge Q has -Q over the area of its screen, :math:`2 \pi r` a unit of depth.
    sources
        Rates per volume by subdomain, likewise.

    Examples
    --------
    Water that is pressed into a closed layer lifts it by its volume:

    >>> import numpy as np
    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> mesh = MeshTri.init_tensor(np.array([0., .1]), np.linspace(0, 1, 6)).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    >>> pores = sc.PoreWater(basis, permeability=1e-4, unit_weight=10.)
    >>> forms = {"clay": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.)), "water": pores,
    ...          "well": sc.water.Inflow(pores, {"bottom": 1e-6})}
    >>> stage = sc.Stage("pressed in", duration=100.)
    >>> result = sc.Model(forms, sc.box_supports(basis, base="rollers")).run([stage])
    >>> round(float(result[-1].x[basis.get_dofs("top").all("u^2")].mean()), 9)
    0.0001
    """

    def __init__(
        self,
        water: PoreWater,
        flux: Mapping[str, Given] | None = None,
        sources: Mapping[str, Given] | None = None,
    ) -> None:
        if not flux and not sources:
            raise ValueError(
                "Inflow has neither flux nor sources: give a rate by boundary or by subdomain"
            )
        self.water = water
        self._flux = dict(flux or {})
        self._sources = dict(sources or {})
        self.size = water.ground.N
        self.borrowed = water.fields
        self._rates = self._entering(False)

    def __repr__(self) -> str:
        return f"<Inflow {self._rates.sum():.4g} per time>"

    def _entering(self, axisymmetric: bool) -> ndarray:
        """Return the water that enters the nodes in a unit of time, (N,)."""
        basis = self.water.pressures
        rates = sourced(basis, self._sources, axisymmetric)
        for name, rate in self._flux.items():
            facets = facets_of(basis.mesh, name)
            rates = rates + through(basis, facets, rate, axisymmetric)
        return rates

    @override
    def _in(self, water: PoreWater) -> Self:
        new = copy(self)
        new.water = water
        new._rates = new._entering(water.coordinates == "axisymmetric")
        return new

    @override
    def check_stage(self, fixed: ndarray, held: ndarray, duration: float) -> Iterator[Remark]:
        # A rate where the pressure is held does nothing.
        rate = np.abs(self._rates)
        around = self.water.around
        at_fixed = np.isin(self._dofs, fixed)
        idle = float(rate[at_fixed].sum()) / max(float(rate.sum()), 1e-300)
        if idle > 1.0 - _ALL:
            raise ValueError(
                "the pressure is held at all nodes where water enters or leaves at a rate, which "
                "does nothing there: give either the pressure or the rate"
            )
        if idle > _IDLE:
            yield Remark(
                "held",
                idle,
                f"{idle:.0%} of the rate acts where the pressure is held, and does nothing",
            )
        # Water that enters sealed ground can only make it grow.
        total = float(self._rates.sum())
        sealed = around is not None and not len(around.leaks) and not at_fixed.any()
        if sealed and total != 0.0:
            yield Remark(
                "no way out",
                abs(total),
                f"{total:.4g} enter per time in ground that no water can leave: "
                "only its growth makes room",
            )

    @override
    def outputs(self, x: ndarray, state: Any) -> Outputs:
        return Outputs(remarks=lambda: self._ponds(x))

    def _ponds(self, x: ndarray) -> Iterator[Remark]:
        """Report water that ponds on a surface, because the ground does not take it."""
        water = self.water
        p = water.fields[0].coordinates
        leaks = water.around.leaks if water.around else ()
        surface = np.setdiff1d(self._surface(), leaks)
        level = (x[self._dofs] + water.start)[surface] / water.unit_weight
        if level.max(initial=0.0) > _PONDS * np.ptp(p[-1]):
            highest = p[:, surface[level.argmax()]]
            yield Remark(
                "ponds",
                level.max(),
                f"water that the ground does not take ponds, {level.max():.3g} deep at "
                f"{format_point(highest)}: let it leave by a SeepageFace of the same boundary",
            )

    def _surface(self) -> ndarray:
        """Return the nodes of facets that look up, at which water enters."""
        pressures = self.water.pressures
        mesh = pressures.mesh
        nodes = [np.zeros(0, int)]
        for name in self._flux:
            facets = facets_of(mesh, name)
            sides = FacetBasis(mesh, pressures.elem, facets=facets)
            up = np.asarray(sides.normals)[-1].min(axis=1) > _UPWARDS
            nodes.append(np.unique(mesh.facets[:, np.asarray(sides.find)[up]]))
        surface = np.concatenate(nodes)
        return surface[self._rates[surface] > 0.0]

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> Inflow:
        new = copy(self)
        new._dofs = numbers[self.borrowed[0]]
        new.size = None
        return new

    @override
    def assemble(self, x: ndarray, state: Any) -> Response:
        n = len(x)
        force = np.zeros(n)
        force[self._dofs] = self._duration * self._rates
        return Response(force, lambda: None, lambda: csr_matrix((n, n)))


class SeepageFace(AtNodes, Regularised, Draining):
    r"""Boundary that water leaves if its pressure would be positive, and does not enter.

    The condition resembles contact, with the pressure for the gap: the outflow at the nodes is
    :math:`c \langle p_0 + p \rangle`, with the pressure :math:`p_0` at the beginning and the excess
    p of :class:`PoreWater`. Fixed dofs, such as dofs under a level, are not affected.

    Parameters
    ----------
    water
        Water of the ground.
    boundaries
        Names of boundaries.
    pressure
        Their pore pressure at the beginning, a number or a function of coordinates (dim, n):
        :func:`hydrostatic`.

    Examples
    --------
    Water leaves a layer under load, and none returns after the load: the ground keeps its
    settlement.

    >>> import numpy as np
    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> mesh = MeshTri.init_tensor(np.array([0., .1]), np.linspace(0, 1, 6)).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    >>> pores = sc.PoreWater(basis, permeability=1e-4, unit_weight=10.)
    >>> forms = {"clay": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.)), "water": pores,
    ...          "face": sc.water.SeepageFace(pores, "top", 0.)}
    >>> load = sc.traction(basis, "top", (0., -100.))
    >>> stages = [sc.Stage("load", load, duration=100.),
    ...           sc.Stage("unload", 0 * load, duration=100.)]
    >>> result = sc.Model(forms, sc.box_supports(basis, base="rollers")).run(stages)
    >>> top = basis.get_dofs("top").all("u^2")
    >>> [round(float(stage.x[top].mean()), 4) for stage in result]
    [-0.01, -0.01]
    """

    unilateral = True
    leaks: ndarray
    _conductance: ndarray

    def __init__(
        self,
        water: PoreWater,
        boundaries: str | Collection[str],
        pressure: Given = 0.0,
    ) -> None:
        names = names_of(boundaries)
        self.water = water
        self.size = water.ground.N
        self.borrowed = water.fields
        if names:
            self.leaks = water.dofs(*names).indices
        else:
            self.leaks = np.zeros(0, int)
        # The excess pressure is -p_0 where the pressure is zero.
        self._limit = -water.at_boundaries(dict.fromkeys(names, pressure))[self.leaks]

    def __repr__(self) -> str:
        return f"<SeepageFace {len(self.leaks)} nodes>"

    @override
    def _in(self, water: PoreWater) -> Self:
        new = copy(self)
        new.water = water
        new._conductance = _OPEN * water.porous.conductance[self.leaks]
        return new

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> SeepageFace:
        new = copy(self)
        new._dofs = numbers[self.borrowed[0]][self.leaks]
        new.joins = new._dofs
        new.size = None
        return new

    @override
    def assemble(self, x: ndarray, state: Any) -> Response:
        n = len(x)
        above = x[self._dofs] - self._limit
        leaking = above > 0.0
        slope = np.where(leaking, -self._duration * self._conductance, 0.0)
        force = np.zeros(n)
        force[self._dofs] = slope * above
        stiffness = csr_matrix((slope, (self._dofs, self._dofs)), shape=(n, n))
        return Response(force, lambda: None, lambda: stiffness, active=leaking.tobytes())
