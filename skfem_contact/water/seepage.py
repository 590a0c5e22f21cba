"""Steady flow of water through the ground."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np
from numpy import ndarray
from skfem import CellBasis, FacetBasis, LinearForm

from ..checks import facets_of, look_up, number, positive
from ..errors import NotConverged
from ..forms.assembly import strain_of
from ..forms.base import Coordinates
from ..layout import elements_of
from ..loads import weight_of_water
from .balance import Balance, WaterBalance, warn_of_dry_wells
from .boundary import (
    Conditions,
    Given,
    check_heads,
    conditions,
    drained,
    pumped,
    screens_and_ties,
    sourced,
    through,
)
from .darcy import (
    DarcyFlow,
    Tensor,
    head_basis,
    permeability_tensors,
    radius,
    regions,
    warn_of_dry_ground,
)
from .points import interpolated, zero_lines
from .retention import Laws, Ramp, Retention

_RAMP = Ramp()
_NOTHING: Mapping[str, float] = MappingProxyType({})
#: Order of the integration: of 100 flows with rain, wells and drains through two layers all balance
#: with 10, 15 only with a wider transition with 2. In space it is the one with points enough for a
#: transition in few elements.
_ORDER = {2: 10, 3: 4}
#: Head below the surface, as a share of the height of the mesh, that is round-off.
_DRIP = 1e-6


@dataclass(frozen=True, eq=False)
class Seepage:
    """Steady flow of water; printed as a table.

    Attributes
    ----------
    basis
        Basis of the heads: linear, on the porous elements.
    head : ndarray, shape (n_nodes,)
        Hydraulic head at the nodes of the mesh, a height; NaN outside of the porous ground.
    pressure : ndarray, shape (n_nodes,)
        Pore pressure, zero above the free surface unless :meth:`with_suction`: for
        :func:`water_load`.
    inflow : ndarray, shape (n_nodes,)
        Water that enters the ground at the nodes: volume per time and unit of thickness (per radian
        in axial symmetry), negative where it leaves. These reactions balance to round-off.
    velocity : ndarray, shape (dim, n_elements)
        Mean Darcy velocity of the elements of the basis.
    iterations
        Iterations of Newton's method for every width of the transition between wet and dry, the
        widest first.
    """

    basis: CellBasis
    head: ndarray
    pressure: ndarray
    inflow: ndarray
    velocity: ndarray
    iterations: tuple[int, ...]
    _passing: Mapping[str, ndarray] = field(repr=False)
    _flux: Mapping[str, Given] = field(repr=False)
    _from_sources: ndarray = field(repr=False)
    _by_element: ndarray = field(repr=False)
    _saturation: ndarray = field(repr=False)
    _unit_weight: float = field(repr=False)
    _axisymmetric: bool = field(repr=False)

    def __str__(self) -> str:
        head = (
            f"seepage through {self.basis.nelems} elements, {np.isfinite(self.head).sum()} nodes, "
            f"{np.sum(self.pressure > 0.0)} of them below the free surface\n"
            f"{sum(self.iterations)} Newton iterations\n{'boundary':<24} {'inflow':>12}"
        )
        return "\n".join(
            (head, *(f"{name:<24} {self.discharge(name):>12.5g}" for name in self._passing))
        )

    __repr__ = __str__  # a notebook would show the arrays

    def discharge(self, boundary: str, of: str | None = None) -> float:
        """Return the water that enters the ground through a boundary, per time; negative where it
        leaves.

        The discharge is the sum of the nodes' reactions, so that nothing is lost. A node between
        two boundaries through which water passes counts for both in proportion to their sizes; rain
        that runs off does not count. With the subdomain `of` it is the water that enters this part
        of the ground there, also from ground on the other side of the boundary.
        """
        mesh = self.basis.mesh
        facets = np.asarray(look_up(boundary, mesh.boundaries or {}, "boundary"))
        if of is not None:
            part = np.isin(elements_of(self.basis), look_up(of, mesh.subdomains or {}, "subdomain"))
            on = np.isin(self.basis.element_dofs.T[part], mesh.facets[:, facets])
            return float(self._by_element[part][on].sum())
        passing = np.unique(np.concatenate(list(self._passing.values())))
        own, whole = self._size(np.intersect1d(facets, passing)), self._size(passing)
        share = np.divide(own, whole, out=np.zeros_like(own), where=whole > 0.0)
        entering = self.inflow - self._from_sources
        mine, rates = (
            sum(
                (
                    through(
                        self.basis,
                        np.intersect1d(self._passing[name], part),
                        rate,
                        self._axisymmetric,
                    )
                    for name, rate in self._flux.items()
                ),
                np.zeros(len(own)),
            )
            for part in (facets, passing)
        )
        taken = np.where(rates > 0.0, np.clip(entering, 0.0, rates), rates)  # the rest runs off
        by_rate = np.divide(mine, rates, out=np.zeros_like(own), where=rates != 0.0)
        return float(by_rate @ taken + share @ (entering - taken))

    def flux(self, boundary: str) -> tuple[ndarray, ndarray]:
        """Return the nodes of a boundary and the water that enters there per area; negative where
        it leaves.

        The boundary has a head or is a seepage face. The flux over the permeability is the
        hydraulic gradient at which water leaves, the exit gradient.

        Examples
        --------
        >>> import skfem_contact as sc
        >>> from skfem import Basis, ElementTriP1, MeshTri
        >>> column = Basis(MeshTri().refined(2).with_defaults(), ElementTriP1())
        >>> water = sc.water.seepage(column, permeability=1e-5, head={"bottom": 1.5, "top": 1.}, unit_weight=10.)
        >>> bool(abs(water.flux("top")[1] / 1e-5 + .5).max() < 1e-12)
        True
        """
        facets = look_up(boundary, self._passing, "boundary through which water passes")
        nodes = np.intersect1d(self.basis.mesh.facets[:, facets], self.basis.element_dofs)
        return nodes, self.inflow[nodes] / self._size(facets)[nodes]

    def heave_factor(self, part: str, unit_weight: float) -> float:
        """Return the factor of safety of a subdomain against heave: its buoyant weight over the
        upward seepage force.

        The subdomain is K. Terzaghi's prism: as deep as the foot of a wall beside it, and half as
        wide. The unit weight is that of saturated ground. The factor is infinite where the water
        does not flow upwards.
        """
        here = np.isin(
            elements_of(self.basis), look_up(part, self.basis.mesh.subdomains or {}, "subdomain")
        )
        if not here.any():
            raise ValueError(f"subdomain '{part}' has no element of the porous ground")
        if not number(unit_weight, "unit_weight") > self._unit_weight:
            raise ValueError(
                f"unit_weight is that of saturated ground, more than {self._unit_weight:g} of the "
                f"water, "
                f"not {unit_weight:g}"
            )
        corners = self.basis.element_dofs[:, here]
        if (
            self.head[corners]
            < self.basis.mesh.p[-1, corners] - _DRIP * np.ptp(self.basis.mesh.p[-1])
        ).any():
            raise ValueError(
                f"subdomain '{part}' lies above the free surface in part: heave is of ground below "
                f"water"
            )
        rise = np.asarray(self.basis.interpolate(np.nan_to_num(self.head)).grad)[-1][here]
        volume = (self.basis.dx * radius(self.basis, self._axisymmetric))[here]
        upward = -self._unit_weight * float((rise * volume).sum())
        weight = (unit_weight - self._unit_weight) * float(volume.sum())
        return weight / upward if upward > 0.0 else np.inf

    def uplift_factor(
        self, bottom: str, unit_weight: Mapping[str, float], load: float = 0.0
    ) -> float:
        """Return the factor of safety of a tight layer or slab against uplift: the weight above
        over the water force.

        The water presses on the boundary `bottom` of the porous ground with its full head. Facets
        with ground above them count negative: the force on the whole outline of a tunnel is its
        buoyancy. `unit_weight` is by subdomain, of all that lies above the bottom: saturated
        ground, also elements outside of the porous ground. `load` is a further downward force, of
        anchors or water above: per unit of thickness, per radian in axial symmetry.

        Examples
        --------
        Two metres of clay above sand, in which the water would rise 4.2 m above the base of the
        clay:

        >>> import skfem_contact as sc
        >>> from skfem import Basis, ElementQuad1, MeshQuad
        >>> mesh = MeshQuad.init_tensor([0., 1., 2.], [0., 1., 2., 3., 4.]).with_defaults()
        >>> mesh = mesh.with_subdomains({"sand": lambda x: x[1] < 2, "clay": lambda x: x[1] > 2})
        >>> mesh = mesh.with_boundaries({"base": lambda x: x[1] == 2}, boundaries_only=False)
        >>> sand = Basis(mesh, ElementQuad1()).with_elements("sand")
        >>> water = sc.water.seepage(sand, permeability=1e-5, head={"left": 6.2}, unit_weight=10.)
        >>> round(water.uplift_factor("base", unit_weight={"clay": 20.}), 6)  # 2 * 20 / (4.2 * 10)
        0.952381
        """
        mesh, facets = self.basis.mesh, facets_of(self.basis.mesh, bottom)
        below, above = np.isin(mesh.f2t[:, facets], elements_of(self.basis))
        if not (below | above).all():
            raise ValueError(
                f"boundary '{bottom}' has facets without porous ground, where no pressure is "
                f"known; of "
                "bodies that share no nodes name the side of the ground"
            )
        around = FacetBasis(mesh, self.basis.elem, facets=facets)
        force = (
            around.interpolate(np.nan_to_num(np.maximum(self.pressure, 0.0)))
            * around.dx
            * radius(around, self._axisymmetric)
        )
        up = around.normals[-1] * np.where(below, 1.0, -1.0)[:, None]
        upward = float((force * np.where((below & above)[:, None], np.abs(up), up)).sum())
        if not upward > _DRIP * float(force.sum()):
            raise ValueError(f"no water presses upwards on boundary '{bottom}'")
        if not isinstance(unit_weight, Mapping) or not unit_weight:
            raise ValueError(
                f"unit_weight is {{subdomain: unit weight}} of what lies above, not {unit_weight!r}"
            )
        weights = {name: positive(each, "unit_weight") for name, each in unit_weight.items()}
        parts = [look_up(name, mesh.subdomains or {}, "subdomain") for name in weights]
        body = CellBasis(mesh, self.basis.elem, elements=np.unique(np.concatenate(parts)))
        volume = body.dx * radius(body, self._axisymmetric)
        regional: list[tuple[ndarray, float]] = regions(body, weights, "unit weight")
        return (
            number(load, "load") + sum(each * float(volume[part].sum()) for part, each in regional)
        ) / upward

    def head_at(self, x: ndarray, outside: ndarray | None = None) -> ndarray:
        """Return the head at coordinates (dim, ...), linear in triangles and tetrahedra.

        Points outside of the ground are refused unless their head is given, (...).
        """
        x = np.asarray(x, dtype=float)
        points = x.reshape(len(x), -1)
        head = interpolated(
            self.basis.mesh,
            elements_of(self.basis),
            self.head,
            points,
            None if outside is None else np.broadcast_to(outside, x.shape[1:]).ravel(),
        )
        return head.reshape(x.shape[1:])

    def pressure_at(self, x: ndarray, head: ndarray | None = None) -> ndarray:
        """Return the pressure at coordinates (dim, ...), as a function like :func:`hydrostatic`, or
        under a head.
        """
        wet = self._unit_weight * np.maximum(
            (self.head_at(x) if head is None else head) - np.asarray(x)[-1], 0.0
        )
        if head is not None or not (self.pressure < 0.0).any():
            return wet
        return wet + replace(self, head=np.minimum(self.pressure, 0.0)).head_at(x) * (wet == 0.0)

    def with_suction(self) -> Seepage:
        """Return the flow with the suction that dry ground has, times its effective saturation: A.
        W. Bishop's stress.

        The `pressure` is negative above the free surface then, and the ground is stronger by the
        suction stress.
        """
        head = self.head - self.basis.mesh.p[-1, : len(self.head)]
        return replace(
            self, pressure=self._unit_weight * np.where(head > 0.0, 1.0, self._saturation) * head
        )

    @property
    def free_surface(self) -> list[ndarray]:
        """Lines of zero pressure between wet and dry ground, (n, 2) each, the longest first; for
        plane flow.
        """
        return zero_lines(
            self.basis.mesh,
            elements_of(self.basis),
            self.head - self.basis.mesh.p[-1, : len(self.head)],
        )

    def _size(self, facets: ndarray) -> ndarray:
        """Return the area of a boundary that belongs to each node, (n_nodes,)."""
        size, nodes = np.zeros(len(self.head)), np.unique(self.basis.mesh.facets[:, facets])
        if len(facets):
            around = FacetBasis(self.basis.mesh, self.basis.elem, facets=facets)
            per_radian = radius(around, self._axisymmetric)
            size[nodes] = LinearForm(lambda v, w: per_radian * v).assemble(around)[nodes]
        return size


def seepage(
    basis: CellBasis,
    permeability: Tensor | Mapping[str, Tensor],
    head: Mapping[str, Given],
    *,
    unit_weight: float,
    seepage_face: str | Sequence[str] = (),
    flux: Mapping[str, Given] = _NOTHING,
    wells: Mapping[str, float] = _NOTHING,
    sources: Mapping[str, Given] = _NOTHING,
    drains: Mapping[str, tuple[Given, float]] = MappingProxyType({}),
    connected: Sequence[tuple[str, str]] = (),
    retention: Retention | Mapping[str, Retention] = _RAMP,
    coordinates: Coordinates | None = None,
) -> Seepage:
    """Solve the steady flow of water through the ground, confined or with a free surface.

    The flow follows Darcy's law, v = -k grad h, with the head h at the corners of the elements. The
    problem is linear if all ground is saturated. Otherwise the permeability falls with suction by
    `retention`, and the free surface is part of the solution.

    Parameters
    ----------
    basis
        Basis of the porous ground, of any element: ``basis.with_elements({"sand", "clay"})``, or
        the whole mesh. The last axis points up.
    permeability
        Permeability (length per time): a number, numbers along the axes, ``(kh, kv)``, or a tensor
        (dim, dim); one for all ground or by subdomain.
    head
        Hydraulic head, a height, by boundary: a number or a function of coordinates (dim, ...). The
        head is the level of the water at the boundary and holds at and below that level. Above it
        the boundary is tight, or a `seepage_face`.
    unit_weight
        Unit weight of water (force per volume), in the units of the pressure.
    seepage_face
        Names of boundaries through which water may leave but not enter, at zero pressure; also of
        those in `head`. All other boundaries are tight.
    flux
        Water that enters by boundary, per time and area: a number or a function of coordinates
        (dim, ...). It is infiltration where it is positive, and what the ground does not take at
        zero pressure runs off; evaporation where it is negative.
    wells
        Water that is pumped by boundary, per time (and unit of thickness, or radian): the screen is
        a boundary under water, with one unknown head.
    sources
        Water that enters by subdomain, per time and volume: a number or a function of coordinates
        (dim, ...).
    drains
        Level and resistance, a time, by boundary: per area leaves the head above the level over the
        resistance. No water enters. A filter of thickness d and permeability k has the resistance d
        / k.
    connected
        Pairs of boundaries of bodies that share no nodes, ``("core|shell", "shell|core")``, between
        which water passes freely: the nodes of the side with the smaller facets take the heads of
        the other. Other joints are tight.
    retention
        :class:`Ramp`, :class:`VanGenuchten` or :class:`BrooksCorey`, for all ground or by
        subdomain.
    coordinates
        ``"axisymmetric"`` for flow per radian towards or from the axis x = 0. By default
        ``"plane"`` or ``"space"``, as the mesh.

    Returns
    -------
    Seepage

    Raises
    ------
    NotConverged
        The water does not balance.

    Warns
    -----
    AnalysisWarning
        A well falls dry; the transition between wet and dry is wider than requested; or water flows
        off through dry ground that conducts better than the wet ground from which it comes, so that
        the free surface is inaccurate.

    Examples
    --------
    The discharge of a dam with vertical faces is k (h1² - h2²) / 2L (I. A. Charny 1951):

    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> from skfem import Basis, ElementTriP1, MeshTri
    >>> dam = MeshTri.init_tensor(np.linspace(0, 5, 11), np.linspace(0, 10, 21)).with_defaults()
    >>> water = sc.water.seepage(Basis(dam, ElementTriP1()), permeability=1., head={"left": 10., "right": 2.},
    ...                          seepage_face="right", unit_weight=10.)
    >>> print(water)
    seepage through 400 elements, 231 nodes, ... of them below the free surface
    ... Newton iterations
    boundary                       inflow
    left                            9.59...
    right                          -9.59...
    >>> end = water.free_surface[0][-1]  # where the free surface meets the downstream face
    >>> bool(abs(end[0] - 5.) < 1e-9 and 6. < end[1] < 7.)
    True
    """
    weight_of_water(unit_weight)
    axisymmetric = strain_of(basis, None, coordinates, False)[1] == "axisymmetric"
    porous = head_basis(basis)
    if not isinstance(head, Mapping) or not (head or drains):
        raise ValueError(
            "there is no head: give {boundary: head} for the boundaries that are under water"
        )
    given, first = pumped(
        porous, wells, conditions(porous, head, seepage_face, flux, sources, axisymmetric)
    )
    given = drained(porous, drains, given, axisymmetric)
    tensors = permeability_tensors(porous, permeability)
    laws = regions(porous, retention, "retention")
    datum = float(np.nanmean(given.known))
    flow = DarcyFlow(porous, tensors, axisymmetric, datum)
    tie = screens_and_ties(porous, connected, given.held, first)
    check_heads(porous, ~np.isnan(given.known), tie)
    from_datum = replace(given, head=given.head - datum, level=given.level - datum)
    balance = WaterBalance(flow, from_datum, tie, porous.mesh.p[:, : porous.N])
    try:
        found = balance.solve(
            laws,
            lambda: DarcyFlow(
                head_basis(basis, _ORDER[basis.mesh.dim()]), tensors, axisymmetric, datum
            ),
        )
    except NotConverged as failed:
        assert failed.x is not None
        warn_of_dry_wells(porous, wells, failed.x + datum)
        raise
    from_sources = tie.T @ sourced(porous, sources, axisymmetric)
    result = described(balance.flow, found, given, laws, flux, from_sources, unit_weight)
    warn_of_dry_ground(porous, tensors, found.relative, result.velocity)
    warn_of_dry_wells(porous, wells, result.head)
    return result


def described(
    flow: DarcyFlow,
    found: Balance,
    given: Conditions,
    laws: Laws,
    flux: Mapping[str, Given],
    from_sources: ndarray,
    unit_weight: float,
) -> Seepage:
    """Return the flow of heads that count from the datum."""
    porous = flow.basis
    heads, used = np.full(porous.N, np.nan), np.unique(porous.element_dofs)
    heads[used] = found.head[used] + flow.datum
    full, filled = (
        flow.gathered(each) for each in (np.ones((1, 1)), flow.filled(found.head, laws)[0])
    )
    pressure = unit_weight * np.maximum(heads - porous.mesh.p[-1, : porous.N], 0.0)
    return Seepage(
        porous,
        heads,
        pressure,
        found.inflow,
        flow.velocity(found.head, found.relative),
        found.iterations,
        given.passing,
        flux,
        from_sources,
        flow.by_element(found.head, found.relative),
        filled / np.where(full > 0.0, full, 1.0),
        unit_weight,
        flow.axisymmetric,
    )
