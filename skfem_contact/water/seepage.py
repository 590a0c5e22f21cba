"""Steady flow of water through the ground."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from scipy.spatial import cKDTree
from skfem import CellBasis, FacetBasis, LinearForm, Mesh

from ..checks import format_point, look_up, positive
from ..errors import warn
from ..forms.assembly import strain_of
from ..forms.base import Coordinates
from ..layout import elements_of
from .balance import WaterBalance
from .boundary import Given, check_heads, conditions, nodes_on, pumped, sourced, through, tied_heads
from .darcy import DarcyFlow, Permeability, Ramp, Retention, head_basis, permeability_tensors, radius, regions

_RAMP = Ramp()
_NOTHING: Mapping[str, float] = MappingProxyType({})
#: Ground is dry below the first relative permeability and wet above the second one.
_DRY, _WET = 0.01, 0.5
#: Share of the flow through dry ground from which a warning is given.
_SHARE = 0.05
#: Corners of the triangles of a quadrilateral and of the tetrahedra of a hexahedron, as in scikit-fem.
_PARTS = {(2, 3): ((0, 1, 2),), (2, 4): ((0, 1, 3), (1, 2, 3)), (3, 4): ((0, 1, 2, 3),),
          (3, 8): ((0, 1, 3, 4), (0, 3, 2, 4), (2, 3, 4, 6), (3, 4, 6, 7), (3, 4, 5, 7), (1, 3, 4, 5))}
#: A point is inside of an element if it lies outside by less than this, in sizes of the element: round-off, and the
#: distance of curved sides from straight ones. The finder of scikit-fem accepts one unit of round-off only.
_ROUND_OFF, _CURVED = 1e-9, 0.1
#: Numbers of elements that are tried, the nearest centres first: graded meshes have many near ones.
_TRIED = (8, 64, 512)


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
        Pore pressure, zero above the free surface: for :func:`water_load`.
    inflow : ndarray, shape (n_nodes,)
        Water that enters the ground at the nodes: volume per time and unit of thickness (per radian in axial
        symmetry), negative where it leaves. These reactions balance to round-off.
    velocity : ndarray, shape (dim, n_elements)
        Mean Darcy velocity of the elements of the basis.
    iterations
        Iterations of Newton's method for every width of the transition between wet and dry, the widest first.
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
    _unit_weight: float = field(repr=False)
    _axisymmetric: bool = field(repr=False)

    def __str__(self) -> str:
        head = (f"seepage through {self.basis.nelems} elements, {np.isfinite(self.head).sum()} nodes, "
                f"{np.sum(self.pressure > 0.0)} of them below the free surface\n"
                f"{sum(self.iterations)} Newton iterations\n{'boundary':<24} {'inflow':>12}")
        return "\n".join((head, *(f"{name:<24} {self.discharge(name):>12.5g}" for name in self._passing)))

    __repr__ = __str__  # a notebook would show the arrays

    def discharge(self, boundary: str, of: str | None = None) -> float:
        """Return the water that enters the ground through a boundary, per time; negative where it leaves.

        The discharge is the sum of the nodes' reactions, so that nothing is lost. A node between two boundaries
        through which water passes counts for both in proportion to their sizes; rain that runs off does not count.
        With the subdomain `of` it is the water that enters this part of the ground there, also from ground on the other
        side of the boundary.
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
        mine, rates = (sum((through(self.basis, np.intersect1d(self._passing[name], part), rate, self._axisymmetric)
                            for name, rate in self._flux.items()), np.zeros(len(own))) for part in (facets, passing))
        taken = np.where(rates > 0.0, np.clip(entering, 0.0, rates), rates)  # the rest runs off
        by_rate = np.divide(mine, rates, out=np.zeros_like(own), where=rates != 0.0)
        return float(by_rate @ taken + share @ (entering - taken))

    def flux(self, boundary: str) -> tuple[ndarray, ndarray]:
        """Return the nodes of a boundary and the water that enters there per area; negative where it leaves.

        The boundary has a head or is a seepage face. The flux over the permeability is the hydraulic gradient at which
        water leaves, the exit gradient.

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

    def head_at(self, x: ndarray, outside: ndarray | None = None) -> ndarray:
        """Return the head at coordinates (dim, ...), linear in triangles and tetrahedra.

        Points outside of the ground are refused unless their head is given, (...).
        """
        x = np.asarray(x, dtype=float)
        points = x.reshape(len(x), -1)
        head = _interpolated(self.basis.mesh, elements_of(self.basis), self.head, points,
                             None if outside is None else np.broadcast_to(outside, x.shape[1:]).ravel())
        return head.reshape(x.shape[1:])

    def pressure_at(self, x: ndarray, head: ndarray | None = None) -> ndarray:
        """Return the pressure at coordinates (dim, ...), as a function like :func:`hydrostatic`, or under a head."""
        return self._unit_weight * np.maximum((self.head_at(x) if head is None else head) - np.asarray(x)[-1], 0.0)

    @property
    def free_surface(self) -> list[ndarray]:
        """Lines of zero pressure between wet and dry ground, (n, 2) each, the longest first; for plane flow."""
        return _zero_lines(self.basis.mesh, elements_of(self.basis), self.head - self.basis.mesh.p[-1, :len(self.head)])

    def _size(self, facets: ndarray) -> ndarray:
        """Return the area of a boundary that belongs to each node, (n_nodes,)."""
        size, nodes = np.zeros(len(self.head)), np.unique(self.basis.mesh.facets[:, facets])
        if len(facets):
            around = FacetBasis(self.basis.mesh, self.basis.elem, facets=facets)
            per_radian = radius(around, self._axisymmetric)
            size[nodes] = LinearForm(lambda v, w: per_radian * v).assemble(around)[nodes]
        return size


def seepage(basis: CellBasis, permeability: Permeability | Mapping[str, Permeability], head: Mapping[str, Given], *,
            unit_weight: float, seepage_face: str | Sequence[str] = (),
            flux: Mapping[str, Given] = _NOTHING, wells: Mapping[str, float] = _NOTHING,
            sources: Mapping[str, Given] = _NOTHING, connected: Sequence[tuple[str, str]] = (),
            retention: Retention | Mapping[str, Retention] = _RAMP, coordinates: Coordinates | None = None) -> Seepage:
    """Solve the steady flow of water through the ground, confined or with a free surface.

    The flow follows Darcy's law, v = -k grad h, with the head h at the corners of the elements. The problem is linear
    if all ground is saturated. Otherwise the permeability falls with suction by `retention`, and the free surface is
    part of the solution.

    Parameters
    ----------
    basis
        Basis of the porous ground, of any element: ``basis.with_elements({"sand", "clay"})``, or the whole mesh. The
        last axis points up.
    permeability
        Permeability (length per time): a number, numbers along the axes, ``(kh, kv)``, or a tensor (dim, dim); one for
        all ground or by subdomain.
    head
        Hydraulic head, a height, by boundary: a number or a function of coordinates (dim, ...). The head is the level
        of the water at the boundary and holds at and below that level. Above it the boundary is tight, or a
        `seepage_face`.
    unit_weight
        Unit weight of water (force per volume), in the units of the pressure.
    seepage_face
        Names of boundaries through which water may leave but not enter, at zero pressure; also of those in `head`. All
        other boundaries are tight.
    flux
        Water that enters by boundary, per time and area: a number or a function of coordinates (dim, ...). It is
        infiltration where it is positive, and what the ground does not take at zero pressure runs off; evaporation
        where it is negative.
    wells
        Water that is pumped by boundary, per time (and unit of thickness, or radian): the screen is a boundary under
        water, with one unknown head.
    sources
        Water that enters by subdomain, per time and volume: a number or a function of coordinates (dim, ...).
    connected
        Pairs of boundaries of bodies that share no nodes, ``("core|shell", "shell|core")``, between which water passes
        freely: the nodes of the side with the smaller facets take the heads of the other. Other joints are tight.
    retention
        :class:`Ramp` or :class:`VanGenuchten`, for all ground or by subdomain.
    coordinates
        ``"axisymmetric"`` for flow per radian towards or from the axis x = 0. By default ``"plane"`` or ``"space"``, as
        the mesh.

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
        A well falls dry; the transition between wet and dry is wider than requested; or water flows off through dry
        ground that conducts better than the wet ground from which it comes, so that the free surface is inaccurate.

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
    positive(unit_weight, "unit_weight")
    axisymmetric = strain_of(basis, None, coordinates, False)[1] == "axisymmetric"
    porous = head_basis(basis)
    given, first = pumped(porous, wells, conditions(porous, head, seepage_face, flux, sources, axisymmetric))
    tensors = permeability_tensors(porous, permeability)
    laws = regions(porous, retention, "retention")
    datum = float(np.nanmean(given.head))
    flow = DarcyFlow(porous, tensors, axisymmetric, datum)
    screened = first != np.arange(porous.N)
    screened[first[screened]] = True
    tie = tied_heads(porous, connected, given.held | screened)
    tie = csr_matrix(tie @ csr_matrix((np.ones(porous.N), (np.arange(porous.N), first)), shape=tie.shape))
    check_heads(porous, given.held, tie)
    lowered = replace(given, head=given.head - datum)
    found = WaterBalance(flow, lowered, tie, porous.mesh.p[:, :porous.N]).solve(laws)
    velocity = flow.velocity(found.head, found.relative)
    _warn_of_dry_ground(porous, tensors, found.relative, velocity)
    heads = np.full(porous.N, np.nan)
    used = np.unique(porous.element_dofs)
    heads[used] = found.head[used] + datum
    _warn_of_dry_wells(porous, wells, heads)
    pressure = unit_weight * np.maximum(heads - porous.mesh.p[-1, :porous.N], 0.0)
    return Seepage(porous, heads, pressure, found.inflow, velocity, found.iterations, given.passing, flux,
                   sourced(porous, sources, axisymmetric),
                   flow.by_element(found.head, found.relative), unit_weight, axisymmetric)


def _warn_of_dry_wells(basis: CellBasis, wells: Mapping[str, float], head: ndarray) -> None:
    """Report wells whose level lies below the top of their screen."""
    for name in wells:
        at = nodes_on(basis, name)
        if head[at[0]] < (top := basis.mesh.p[-1, at].max()):
            warn(f"well '{name}' falls dry: its level, {head[at[0]]:.4g}, lies below the top of its screen, {top:.4g}, "
                 "where water would flow freely; pump less, or give the level as its head with seepage_face=")


def _warn_of_dry_ground(basis: CellBasis, tensors: ndarray, relative: ndarray, velocity: ndarray) -> None:
    """Report water that flows off through dry ground that conducts better than wet ground elsewhere."""
    # A dam whose core is 1e-2, 1e-3, 1e-4 and 1e-6 times as permeable as its shell leaks .6, .7, -5 and -7 % too much
    # with 20 elements over the height if dry ground keeps 1e-3 of its permeability. In the last two cases .26 of the
    # flow is of this kind; where the discharge is right to 1 % less than .005 is.
    k = np.trace(tensors, axis1=1, axis2=2) / basis.mesh.dim()
    wet, left = (relative >= _WET).any(axis=1), relative.min(axis=1) * k
    draining = (relative < _DRY).all(axis=1) & (left > 1.5 * k[wet].min(initial=np.inf))
    flow = np.linalg.norm(velocity, axis=0) * basis.dx.sum(axis=1)
    if flow[draining].sum() > _SHARE * flow.sum():
        x = np.asarray(basis.global_coordinates())[:, np.where(draining, flow, 0.0).argmax()].mean(axis=1)
        warn(f"water flows off through dry ground at {format_point(x)}, which conducts better than the wet ground "
             "from which it comes: the free surface there is several per cent off; leave drained ground out "
             "of the basis and name the boundary towards it in seepage_face=, or give a smaller `least` in "
             "retention=")


def simplices(mesh: Mesh, elements: ndarray) -> ndarray:
    """Return the triangles or tetrahedra of elements, (dim + 1, n)."""
    t = mesh.t[:, elements]
    return np.hstack([t[list(part)] for part in _PARTS[mesh.dim(), len(t)]])


def _interpolated(mesh: Mesh, elements: ndarray, nodal: ndarray, points: ndarray, beyond: ndarray | None) -> ndarray:
    """Return nodal values at points (dim, n), linear on the simplices of elements; at points beyond them given ones."""
    corners = simplices(mesh, elements)
    p = mesh.p[:, corners]
    inverse = np.linalg.inv((p[:, 1:] - p[:, :1]).transpose(2, 0, 1))
    tree = cKDTree(p.mean(axis=1).T)
    result, lost = np.empty(points.shape[1]), np.arange(points.shape[1])
    for tried in (*(n for n in _TRIED if n < len(inverse)), len(inverse)):
        near = tree.query(points[:, lost].T, tried)[1].reshape(len(lost), -1)
        outside = np.full(len(lost), np.inf)
        for candidate in near.T:
            local = np.einsum("nij,jn->in", inverse[candidate], points[:, lost] - p[:, 0, candidate])
            weights = np.vstack((1.0 - local.sum(axis=0), local))
            better = -weights.min(axis=0) < outside
            outside[better] = -weights.min(axis=0)[better]
            result[lost[better]] = (weights * nodal[corners[:, candidate]]).sum(axis=0)[better]
        lost = lost[outside > (_ROUND_OFF if tried < min(_TRIED[-1], len(inverse)) else _CURVED)]
        if len(lost) == 0:
            return result
    if beyond is not None:
        result[lost] = beyond[lost]
        return result
    raise ValueError(f"{len(lost)} points lie outside of the porous ground, the first is "
                     f"{format_point(points[:, lost[0]])}")


def _zero_lines(mesh: Mesh, elements: ndarray, values: ndarray) -> list[ndarray]:
    """Return polylines between nodes of negative and of other values, (n, 2) each, from left to right."""
    from matplotlib.figure import Figure  # half a second, for pictures only
    from matplotlib.tri import Triangulation

    if mesh.dim() != 2:
        raise ValueError("a free surface is a line in plane flow only")
    corners = simplices(mesh, elements).T
    negative = values[corners] < 0.0
    if negative.all() or not negative.any():
        return []
    x, y = mesh.p[:, :len(values)]
    lines = Figure().add_subplot().tricontour(Triangulation(x, y, corners), np.nan_to_num(values), [0.0]).allsegs[0]
    return sorted(map(_cleaned, lines), key=lambda line: -np.linalg.norm(np.diff(line, axis=0), axis=1).sum())


def _cleaned(line: ndarray) -> ndarray:
    """Return a line from left to right, or from below, without points that coincide with the one before."""
    if tuple(line[-1]) < tuple(line[0]):
        line = line[::-1]
    kept = np.ones(len(line), dtype=bool)
    kept[1:] = np.linalg.norm(np.diff(line, axis=0), axis=1) > 1e-12 * np.ptp(line, axis=0).max()
    return line[kept] if kept.sum() > 1 else line
