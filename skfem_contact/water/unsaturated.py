"""Consolidation of partly saturated ground: suction, and air in its pores."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from skfem import CellBasis
from typing_extensions import Self, override

from ..forms.base import Form, Response
from .boundary import Given, values_at
from .consolidation import PoreWater
from .darcy import DarcyFlow, Permeability, radius, regions
from .porous import FLOWING, PoreState, Surroundings
from .retention import Retention
from .seepage import Seepage
from .storage import StoringFlow

#: Round-off of the water in an element, as a share of what its pores hold.
_ROUND_OFF = 4 * np.finfo(float).eps


class _Filling(NamedTuple):
    """Water at the corners of the elements, with slopes over the pressure, (n_elements, n_corners)
    each.

    These are Bishop's pressure, the content of undeformed ground, and the content over that of full
    pores.
    """

    bishop: ndarray
    content: ndarray
    share: ndarray
    bishop_slope: ndarray
    content_slope: ndarray
    share_slope: ndarray


class UnsaturatedPoreWater(PoreWater):
    r"""Water in the pores of ground that is saturated below the water table and holds air above it.

    :class:`PoreWater` with Bishop's effective stress, whose factor is the effective saturation
    :math:`S_e` of a retention curve, and with a relative permeability :math:`k_r`. The pressure of
    the water is
    :math:`u = u_0 + p`, with the excess p of the dofs, the pressure of the air is zero:

    .. math:: \operatorname{div}(\sigma' - S_e\, u\, I) + b = 0, \qquad
              \frac{\partial}{\partial t} \bigl(S_w (n + \operatorname{div} u_s + S p)\bigr) =
              \operatorname{div}\left(\frac{k k_r}{\gamma_w} \nabla (u + \gamma_w z)\right) .

    The content of water gives the porosity n and the saturation :math:`S_w`. Steps balance
    differences of contents, so that no water is lost. Water that enters or leaves pores changes the
    weight b. Saturated ground has the equations of :class:`PoreWater`. Suction is a part of the
    strength, also in searches for a collapse.

    Parameters
    ----------
    basis, permeability, unit_weight, storage, time_error, connected
        As for :class:`PoreWater`.
    retention
        :class:`VanGenuchten`, :class:`BrooksCorey` or :class:`Ramp` with a `content`, for all
        ground or by subdomain.
    start
        Heads at the start: a :class:`Seepage`, a number, or a function of the coordinates (dim,
        ...). Ground under a suction s has the head z - s. Water that is not at rest then flows;
        boundaries without a condition are tight.

    Notes
    -----
    The load contains the weight of the water at the start, and its pressures: ``water_load(basis,
    water.initial)`` of the form of a model. Unlike that of :class:`PoreWater` the flow is the whole
    one, not that by the excess alone.

    Examples
    --------
    A column of silt loses its water: it settles because suction compresses it.

    >>> import numpy as np
    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> mesh = MeshTri.init_tensor(np.array([0., .1]), np.linspace(0, 1, 11)).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    >>> silt = sc.water.VanGenuchten(alpha=1., n=3., content=(.05, .4))
    >>> water = sc.water.UnsaturatedPoreWater(basis, 1e-2, retention=silt, start=1., unit_weight=10.)
    >>> forms = {"silt": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.)), "water": water}
    >>> model = sc.Model(forms, [sc.box_supports(basis, base="rollers"), water.dofs("bottom")])
    >>> lower = model.forms["water"].prescribed({"bottom": -10.})
    >>> stage = model.run([sc.Stage("lower", prescribed=lower, duration=1e5)], progress=False)["lower"]
    >>> round(float(-1e3 * stage.x[basis.get_dofs("top").all("u^2")].mean()), 2)
    8.77
    >>> round(10 * water.volume(stage.states["water"]), 3)
    -0.049
    """

    symmetric = False
    _flow_of: StoringFlow
    _before: _Filling
    _weight: ndarray

    def __init__(
        self,
        basis: CellBasis,
        permeability: Permeability | Mapping[str, Permeability],
        *,
        retention: Retention | Mapping[str, Retention],
        start: Seepage | Given,
        unit_weight: float,
        storage: float | Mapping[str, float] = 0.0,
        time_error: float = 0.01,
        connected: Sequence[tuple[str, str]] = (),
    ) -> None:
        super().__init__(
            basis,
            permeability,
            unit_weight=unit_weight,
            storage=storage,
            time_error=time_error,
            connected=connected,
        )
        self._laws = regions(basis, retention, "retention")
        if any(law.content is None for _, law in self._laws):
            raise ValueError(
                "retention has no content: give the residual and the saturated content of water, "
                "content=(0.05, 0.4)"
            )
        x = self.fields[0].coordinates
        head = start.head if isinstance(start, Seepage) else values_at(start, x, "start")
        if np.shape(head) != x.shape[1:] or not np.isfinite(head[self._vertices]).all():
            raise ValueError("the start is a seepage of another mesh, or of other ground")
        self._start = unit_weight * (np.where(np.isfinite(head), head, x[-1]) - x[-1])
        least, most = np.zeros((2, basis.nelems, 1))
        for part, law in self._laws:
            least[part], most[part] = law.content or (0.0, 0.0)
        self._content = least, most

    @property
    def initial(self) -> ndarray:
        """Bishop's pressure at the start at the vertices, (n_vertices,), as part of the load."""
        if self.around is None:
            raise ValueError(
                "the model completes the water: take it from model.forms or stage.forms"
            )
        flow = self._flow_of
        return flow.gathered(self._before.bishop) / flow.volume

    @override
    def continues(self, old: Form) -> Self:
        new = super().continues(old)
        assert isinstance(new, type(self)) and isinstance(old, UnsaturatedPoreWater)
        laws, before = ([(part.tolist(), law) for part, law in form._laws] for form in (self, old))
        if laws != before or not np.array_equal(old._start, self._start):
            raise ValueError("its retention or its start is another")
        return new

    @override
    def _in(self, around: Surroundings) -> PoreWater:
        new = super()._in(around)
        assert isinstance(new, UnsaturatedPoreWater)
        tensors, datum = (
            self.mobility * self.unit_weight,
            float(self.fields[0].coordinates[-1].mean()),
        )
        new._flow_of = StoringFlow(
            self.pressures,
            tensors,
            self._laws,
            np.zeros(self.ground.nelems),
            around.measure[1] == "axisymmetric",
            datum,
        )
        new._before, most = new._filling(np.zeros(self.fields[0].n)), self._content[1]
        if not ((new._before.content >= 0.0) & (new._before.content <= most)).all():
            raise ValueError(
                f"the contents of water at the start, from {new._before.content.min():.3g} to "
                f"{new._before.content.max():.3g}, are not between 0 and the saturated one"
            )
        new.suction = max(-float(new.initial.min()), 0.0)
        new._weight = self.unit_weight * _upward(
            self.ground, self.pressures, new._flow_of.axisymmetric
        )
        return new

    def _filling(self, pressure: ndarray) -> _Filling:
        """Return the water of the elements under an excess pressure at the vertices."""
        flow, (least, most) = self._flow_of, self._content
        filled, falling = flow.filled(self._head(pressure), self._laws)
        slope, total = -falling / self.unit_weight, (self._start + pressure)[flow.dofs]
        content, content_slope = least + (most - least) * filled, (most - least) * slope
        return _Filling(
            filled * total,
            content,
            content / most,
            filled + slope * total,
            content_slope,
            content_slope / most,
        )

    @property
    def _spread(self) -> ndarray:
        assert self.around is not None
        return self.porous.spread / (2.0 * self.around.shear)[:, None, None]

    def _head(self, pressure: ndarray) -> ndarray:
        return np.asarray(self._flow_of.elevation + (self._start + pressure) / self.unit_weight)

    def _thrust(self, water: _Filling) -> ndarray:
        """Return the force of the water on the ground, beyond that at the start, among all dofs,
        (N,).
        """
        before, force, dofs = self._before, np.zeros(self.size), self.ground.element_dofs.T
        by_element = np.einsum(
            "ebj,ej->eb", self._weight, water.content - before.content
        ) - np.einsum("ebj,ej->eb", self.porous.coupling, water.bishop - before.bishop)
        force[: self.ground.N] = np.bincount(
            dofs.ravel(), by_element.ravel(), minlength=self.ground.N
        )
        return force

    def _pores(self, x: ndarray) -> ndarray:
        """Return the growth of the pores, and of the water in them by compression, (n_elements,
        n_corners).
        """
        pressed = self.storage[:, None] * np.einsum(
            "eij,ej->ei", self.porous.mass, x[self.first :][self._flow_of.dofs]
        )
        return np.asarray(
            np.einsum("ebj,eb->ej", self.porous.coupling, x[self.ground.element_dofs.T]) + pressed
        )

    def _water(self, x: ndarray, water: _Filling) -> ndarray:
        """Return the water at the nodes, beyond that of undeformed ground at the start,
        (n_vertices,).
        """
        flow, before, growth = self._flow_of, self._before, self._pores(x)
        corners = flow.corners * (water.content - before.content) + water.share * growth
        if self.porous.linear:
            corners += np.einsum("eij,ej->ei", self._spread, water.bishop - before.bishop)
        return np.bincount(flow.dofs.ravel(), corners.ravel(), minlength=self.fields[0].n)

    @override
    def _stored(self, x: ndarray) -> ndarray:
        return self._water(x, self._filling(x[self.first :]))

    def _leaving(self, pressure: ndarray) -> ndarray:
        """Return the water that leaves the nodes in a unit of time, (n_vertices,)."""
        flow, head = self._flow_of, self._head(pressure)
        return (
            DarcyFlow.inflow(flow, head, flow.relative(head, self._laws)[0])
            + self.porous.across @ pressure
        )

    @override
    def assemble(self, x: ndarray, state: PoreState) -> Response:
        if self._duration is None:
            return self._standing(x, state)
        first, flow, pressure, duration = self.first, self._flow_of, x[self.first :], self._duration
        water, leaving = self._filling(pressure), duration * self._leaving(pressure)
        stored, force = self._water(x, water), self._thrust(water)
        force[first:], measure, lost = (
            state.stored - stored - leaving,
            force.copy(),
            np.zeros(self.size),
        )
        head, one = self._head(pressure), np.ones((1, flow.basis.dx.shape[1]))
        gross = self._flow[1] @ np.abs(self._start + pressure)
        measure[first:] = np.abs(stored - state.stored) + FLOWING * duration * gross
        lost[first:] = duration * DarcyFlow.round_off(flow, head, one) + _ROUND_OFF * flow.gathered(
            water.content
        )
        return Response(
            force,
            lambda: PoreState(stored, state.first, state.entered - force[first:], pressure),
            lambda: self._tangent(x, water),
            measure=measure,
            round_off=lost,
        )

    def _tangent(self, x: ndarray, water: _Filling) -> csr_matrix:
        assert self._duration is not None
        parts, flow, head = self.porous, self._flow_of, self._head(x[self.first :])
        kept = (water.share * self.storage[:, None])[:, :, None] * parts.mass
        if parts.linear:
            kept = kept + self._spread * water.bishop_slope[:, None, :]
        at = np.arange(kept.shape[1])
        kept[:, at, at] += flow.corners * water.content_slope + water.share_slope * self._pores(x)
        passing = flow.by_corner(*flow.relative(head, self._laws), head) / self.unit_weight
        thrust = (
            self._weight * water.content_slope[:, None, :]
            - parts.coupling * water.bishop_slope[:, None, :]
        )
        return parts.matrix(
            self.first,
            thrust,
            -kept - self._duration * passing,
            -self._duration,
            -parts.coupling * water.share[:, None, :],
        )

    @override
    def _standing(self, x: ndarray, state: PoreState) -> Response:
        response, held = super()._standing(x, state), self._thrust(self._filling(state.pressure))
        held[self.first :] = response.force[self.first :]
        return Response(held, lambda: response.state, lambda: response.stiffness)

    @override
    def time_error(self, middle: PoreState, after: PoreState) -> tuple[float, float]:
        assert self._duration is not None
        change = np.abs(self._leaving(after.pressure) - self._leaving(middle.pressure)).sum()
        flowed = 0.5 * float(np.abs(after.entered - middle.entered).sum())
        water = max(flowed, self._moved(middle.pressure), self._moved(after.pressure))
        return 0.5 * self._duration * float(change) / self._time_error, water

    def _moved(self, pressure: ndarray) -> float:
        """Return the water that an excess pressure can move, by saturation and by the stiffness of
        the ground.
        """
        assert self.around is not None
        water, before, softness = (
            self._filling(pressure),
            self._before,
            1.0 / self.around.modulus + self.storage,
        )
        by_corner = np.abs(water.content - before.content) + softness[:, None] * np.abs(
            water.bishop - before.bishop
        )
        return float((self._flow_of.corners * by_corner).sum())

    @override
    def rebased(self, x: ndarray, state: PoreState) -> PoreState:
        still = x[: self.size].copy()
        still[: self.first] = 0.0
        less = self._stored(still) - self._stored(x[: self.size])
        return replace(state, stored=state.stored + less, first=state.first + less)


def _upward(basis: CellBasis, pressures: CellBasis, axisymmetric: bool) -> ndarray:
    """Return the forces on the ground by a unit weight 1 that acts upward, by corner, (n_elements,
    n_u, n_corners).
    """
    weight = np.asarray(basis.dx * radius(basis, axisymmetric))
    up = np.stack(
        [
            np.broadcast_to(np.asarray(basis.basis[b][0])[-1], weight.shape)
            for b in range(basis.Nbfun)
        ]
    )
    corner = np.stack(
        [np.broadcast_to(pressures.basis[j][0], weight.shape) for j in range(pressures.Nbfun)]
    )
    return np.asarray(np.einsum("beq,jeq,eq->ebj", up, corner, weight, optimize=True))
