"""Flow of water through ground that does not deform, steady or in time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy import ndarray
from skfem import CellBasis

from ..checks import finite, number
from ..errors import NotConverged
from ..forms.assembly import strain_of
from ..forms.base import Coordinates
from ..loads import weight_of_water
from ..mesh.check import check_ends, check_tags
from .balance import WaterBalance, warn_of_dry_wells
from .boundary import Given, check_heads, screens_and_ties, sourced, values_at
from .conditions import Conditions
from .darcy import (
    DarcyFlow,
    Tensor,
    head_basis,
    laws_with_content,
    permeability_tensors,
    regions,
    warn_of_dry_ground,
)
from .retention import Ramp, Retention
from .seepage import Seepage, described
from .storage import StoringFlow
from .transient import March, TransientSeepage

_RAMP = Ramp()
#: Order of the integration: of 100 flows with rain, wells and drains through two layers all balance
#: with 10, 15 only with a wider transition with 2. In space it is the one with points enough for a
#: transition in few elements.
_ORDER = {2: 10, 3: 4}


class Flow:
    r"""Flow of water through ground that does not deform.

    The flow follows Darcy's law, v = -k grad h, with the head h at the corners of the elements. The
    permeability falls with suction by `retention`, and a free surface is part of the solution.

    Parameters
    ----------
    basis
        Basis of the porous ground, of any element: ``basis.with_elements({"sand", "clay"})``, or
        the whole mesh. The last axis points up.
    permeability
        Permeability (length per time): a number, numbers along the axes, ``(kh, kv)``, or a tensor
        (dim, dim); one for all ground or by subdomain.
    unit_weight
        Unit weight of water (force per volume), in the units of the pressure.
    retention
        :class:`Ramp`, :class:`VanGenuchten` or :class:`BrooksCorey`, for all ground or by
        subdomain; for flow in time with a `content`.
    connected
        Pairs of boundaries of bodies that share no nodes, ``("core|shell", "shell|core")``, between
        which water passes freely: the nodes of the side with the smaller facets take the heads of
        the opposite side. Other joints are tight.
    storage
        Specific storage (1 / length) of saturated ground, by subdomain too: water per volume and
        head that compresses. For flow in time.
    coordinates
        ``"axisymmetric"`` for flow per radian towards or from the axis x = 0. By default
        ``"plane"`` or ``"space"``, as the mesh.

    Examples
    --------
    The discharge of a dam with vertical faces is k (h1² - h2²) / 2L (I. A. Charny 1951):

    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> from skfem import Basis, ElementTriP1, MeshTri
    >>> dam = MeshTri.init_tensor(np.linspace(0, 5, 11), np.linspace(0, 10, 21)).with_defaults()
    >>> flow = sc.water.Flow(Basis(dam, ElementTriP1()), permeability=1., unit_weight=10.)
    >>> levels = sc.water.Conditions(head={"left": 10., "right": 2.}, seepage_face="right")
    >>> water = flow.steady(levels)
    >>> print(water)
    seepage through 400 elements, 231 nodes, ... of them below the free surface
    ... Newton iterations
    boundary                       inflow
    left                            9.59...
    right                          -9.59...
    >>> end = water.free_surface[0][-1]  # where the free surface meets the downstream face
    >>> bool(abs(end[0] - 5.) < 1e-9 and 6. < end[1] < 7.)
    True

    Rain on a column of sand. Nothing is lost:

    >>> from skfem import ElementQuad1, MeshQuad
    >>> mesh = MeshQuad.init_tensor(np.array([0., 1.]), np.linspace(0, 2, 21)).with_defaults()
    >>> sand = sc.water.VanGenuchten(alpha=2., n=3., content=(.05, .4))
    >>> flow = sc.water.Flow(Basis(mesh, ElementQuad1()), 1e-4, retention=sand, unit_weight=9.81)
    >>> rain = sc.water.Conditions(head={"bottom": 0.}, flux={"top": 1e-5})
    >>> water = flow.in_time(rain, times=[0., 3600.], start=0.)
    >>> round(float(water.entered[-1]), 6), bool(water.balance_error < 1e-9)
    (0.036, True)
    """

    def __init__(
        self,
        basis: CellBasis,
        permeability: Tensor | Mapping[str, Tensor],
        *,
        unit_weight: float,
        retention: Retention | Mapping[str, Retention] = _RAMP,
        connected: Sequence[tuple[str, str]] = (),
        storage: float | Mapping[str, float] = 0.0,
        coordinates: Coordinates | None = None,
    ) -> None:
        self._unit_weight = weight_of_water(unit_weight)
        self._axisymmetric = strain_of(basis, None, coordinates, False)[1] == "axisymmetric"
        self._porous = head_basis(basis)
        check_tags(basis.mesh)
        check_ends(basis.mesh)
        self._tensors = permeability_tensors(self._porous, permeability)
        self._retention = retention
        self._connected = connected
        self._storage = np.zeros(self._porous.nelems)
        for part, value in regions(self._porous, storage, "storage"):
            self._storage[part] = number(value, "storage", -1e-300)

    def __repr__(self) -> str:
        return f"<Flow through {self._porous.nelems} elements>"

    def steady(self, conditions: Conditions) -> Seepage:
        """Solve the steady flow, confined or with a free surface.

        The problem is linear if all ground is saturated.

        Raises
        ------
        NotConverged
            The water does not balance.

        Warns
        -----
        AnalysisWarning
            A well falls dry; the transition between wet and dry is wider than requested; or water
            flows off through dry ground that conducts better than the wet ground from which it
            comes, so that the free surface is inaccurate.
        """
        porous = self._porous
        if not isinstance(conditions.head, Mapping) or not (conditions.head or conditions.drains):
            raise ValueError(
                "there is no head: give {boundary: head} for the boundaries that are under water"
            )
        if conditions.suction:
            raise ValueError("suction is a condition of flow in time")
        # Conditions at nodes, laws of retention by region, and ties between bodies.
        given, first = conditions.at_nodes(porous, self._axisymmetric)
        laws = regions(porous, self._retention, "retention")
        tie = screens_and_ties(porous, self._connected, given.held, first)
        check_heads(porous, ~np.isnan(given.known), tie)
        # Count heads from their mean, for the sake of round-off.
        datum = float(np.nanmean(given.known))
        balance = WaterBalance(
            DarcyFlow(porous, self._tensors, self._axisymmetric, datum),
            given.above(datum),
            tie,
            porous.mesh.p[:, : porous.N],
        )
        wells = conditions.values("wells", None)
        try:
            result = balance.solve(laws, lambda: self._finer(datum))
        except NotConverged as failed:
            assert failed.x is not None
            warn_of_dry_wells(porous, wells, failed.x + datum)
            raise
        from_sources = tie.T @ sourced(
            porous, conditions.values("sources", None), self._axisymmetric
        )
        # Describe the flow, and warn of what is dry.
        water = described(
            balance.flow,
            result,
            given=given,
            laws=laws,
            flux=conditions.values("flux", None),
            from_sources=from_sources,
            unit_weight=self._unit_weight,
        )
        warn_of_dry_ground(porous, self._tensors, result.relative, water.velocity)
        warn_of_dry_wells(porous, wells, water.head)
        return water

    def _finer(self, datum: float) -> DarcyFlow:
        """Return the flow integrated with more points."""
        basis = head_basis(self._porous, _ORDER[self._porous.mesh.dim()])
        return DarcyFlow(basis, self._tensors, self._axisymmetric, datum)

    def in_time(
        self,
        conditions: Conditions,
        times: Sequence[float] | ndarray,
        start: Seepage | Given,
        error: float = 1e-2,
    ) -> TransientSeepage:
        """Solve the flow through saturated and unsaturated ground in time (L. A. Richards 1931).

        Parameters
        ----------
        conditions
            Conditions of the flow; no head is needed.
        times
            Increasing times for the result. The first is the time of the start.
        start
            Heads at the start: a :class:`Seepage`, also one of an earlier result, a number, or a
            function of the coordinates (dim, ...). Ground under a suction s has the head z - s.
        error
            Limit of the error of a step in the content of any node, over its range, and in the
            water that compressible ground takes, over the largest change. The steps, of second
            order, are cut and grow with its estimate.

        Raises
        ------
        NotConverged
            The water does not balance in the shortest step.
        """
        # Check the times and the conditions.
        porous = self._porous
        number(error, "error", 0.0, 1.0)
        at = finite(times, "times")
        if at.ndim != 1 or len(at) < 2 or (np.diff(at) <= 0.0).any():
            raise ValueError(
                f"times must increase, from that of the start to at least one more, not {times!r}"
            )
        if conditions.drains:
            raise ValueError("drains are a condition of steady flow")
        # Begin from the head of the start, measured from the middle height.
        laws = laws_with_content(porous, self._retention)
        head = self._head(start)
        datum = float(porous.mesh.p[-1].mean())
        flow = StoringFlow(porous, self._tensors, laws, self._storage, self._axisymmetric, datum)
        above = np.nan_to_num(head, nan=datum) - datum
        march = March(
            flow,
            conditions,
            laws,
            self._connected,
            above,
            at,
            error,
        )
        return march.run(self._unit_weight)

    def _head(self, start: Seepage | Given) -> ndarray:
        """Return the heads at the start, (N,)."""
        porous = self._porous
        if isinstance(start, Seepage):
            head = np.asarray(start.head)
        else:
            head = values_at(start, porous.mesh.p[:, : porous.N], "start")
        used = np.unique(porous.element_dofs)
        if np.shape(head) != (porous.N,) or not np.isfinite(head[used]).all():
            raise ValueError("the start is a seepage of another mesh, or of other ground")
        return head
