"""Steady flow of water through the ground."""
from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy import ndarray
from skfem import CellBasis, FacetBasis, LinearForm

from ..errors import AnalysisWarning, look_up, place
from ..layout import elements_of
from .balance import WaterBalance
from .conditions import Given, check_connected, conditions, tied_heads
from .darcy import DarcyFlow, Permeability, head_basis, permeability_tensors, regions
from .places import Interpolation, zero_lines
from .retention import Ramp, Retention

_RAMP = Ramp()
#: Ground is dry below the first relative permeability and wet above the second one.
_DRY, _WET = 0.01, 0.5
#: Share of the flow through dry ground of which a warning is given.
_SHARE = 0.05


@dataclass(frozen=True, eq=False)
class Seepage:
    """Steady flow of water; printed as a table.

    Attributes
    ----------
    basis
        Basis of the heads: linear, on the porous elements.
    head
        Hydraulic head at the nodes of the mesh, (n_nodes,), a height; NaN where there is no porous ground.
    pressure
        Pore pressure there, the suction above the free surface taken for zero: for :func:`water_load`.
    inflow
        Water that enters the ground at the nodes, (n_nodes,): volume per time and unit of thickness (per radian in
        axial symmetry), negative where it leaves. These reactions balance to round-off.
    velocity
        Mean Darcy velocity of the elements of the basis, (dim, n_elements).
    iterations
        Of Newton's method, in the order of the widths of the transition between wet and dry.
    """

    basis: CellBasis
    head: ndarray
    pressure: ndarray
    inflow: ndarray
    velocity: ndarray
    iterations: tuple[int, ...]
    _passing: Mapping[str, ndarray] = field(repr=False)
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
        """Water that enters the ground through a boundary, per time; negative where it leaves.

        It is the sum of the nodes' reactions, not an integral of gradients, so that nothing is lost. Where boundaries
        through which water passes meet, the node between them counts for both in proportion to their sizes there.

        Parameters
        ----------
        boundary
            Name of a boundary of the mesh.
        of
            Name of a subdomain that the boundary bounds: the water that enters this part of the ground there, also
            from ground on the other side of the boundary.

        Raises
        ------
        ValueError
            Unknown names.
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
        return float(share @ self.inflow)

    def flux(self, boundary: str) -> tuple[ndarray, ndarray]:
        """Water that enters per area at the nodes of a boundary; negative where it leaves.

        Parameters
        ----------
        boundary
            Name of a boundary on which a head is given, or of a seepage face.

        Returns
        -------
        nodes, flux
            Numbers of the nodes and the flux, (n,) each. Over the permeability the flux is the hydraulic gradient at
            which water leaves, the exit gradient.

        Raises
        ------
        ValueError
            Unknown boundary, or one through which no water passes.

        Examples
        --------
        >>> import skfem_contact as sc
        >>> from skfem import Basis, ElementTriP1, MeshTri
        >>> column = Basis(MeshTri().refined(2).with_defaults(), ElementTriP1())
        >>> water = sc.seepage(column, permeability=1e-5, head={"bottom": 1.5, "top": 1.}, unit_weight=10.)
        >>> bool(abs(water.flux("top")[1] / 1e-5 + .5).max() < 1e-12)
        True
        """
        facets = look_up(boundary, self._passing, "boundary through which water passes")
        nodes = np.intersect1d(self.basis.mesh.facets[:, facets], self.basis.element_dofs)
        return nodes, self.inflow[nodes] / self._size(facets)[nodes]

    def head_at(self, x: ndarray) -> ndarray:
        """Head at places (dim, ...); linear between the corners of triangles and tetrahedra.

        Raises
        ------
        ValueError
            A place outside of the porous ground.
        """
        return Interpolation(self.basis.mesh, elements_of(self.basis), self.head)(np.asarray(x, dtype=float))

    def pressure_at(self, x: ndarray) -> ndarray:
        """Pore pressure at places (dim, ...): what takes a function such as :func:`hydrostatic` takes this too.

        Raises
        ------
        ValueError
            A place outside of the porous ground.
        """
        return self._unit_weight * np.maximum(self.head_at(x) - np.asarray(x)[-1], 0.0)

    @property
    def free_surface(self) -> list[ndarray]:
        """Lines on which the pressure is zero between wet and dry ground, (n, 2) each; for plane flow.

        Raises
        ------
        ValueError
            Flow in space.
        """
        return zero_lines(self.basis.mesh, elements_of(self.basis), self.head - self.basis.mesh.p[-1, :len(self.head)])

    def _size(self, facets: ndarray) -> ndarray:
        """Area of a boundary that belongs to each node, (n_nodes,)."""
        size, nodes = np.zeros(len(self.head)), np.unique(self.basis.mesh.facets[:, facets])
        if len(facets):
            around = FacetBasis(self.basis.mesh, self.basis.elem, facets=facets)
            part = LinearForm(lambda v, w: (w.x[0] if self._axisymmetric else 1.0) * v)
            size[nodes] = part.assemble(around)[nodes]
        return size


def seepage(basis: CellBasis, permeability: Permeability | Mapping[str, Permeability], head: Mapping[str, Given], *,
            unit_weight: float, seepage_face: str | Sequence[str] = (), connected: Sequence[tuple[str, str]] = (),
            retention: Retention | Mapping[str, Retention] = _RAMP, axisymmetric: bool = False) -> Seepage:
    """Steady flow of water through the ground, confined or with a free surface.

    The flow follows Darcy's law, v = -k grad h, with the head h at the corners of the elements. Where all ground
    turns out to be saturated the problem is linear. Otherwise the permeability falls with suction as `retention`
    tells, and the free surface comes out.

    Parameters
    ----------
    basis
        Basis of what is porous, of any element: ``basis.with_elements({"sand", "clay"})``, or the whole mesh. The last
        axis points up.
    permeability
        Permeability (length per time): a number, numbers along the axes, ``(kh, kv)``, or a tensor (dim, dim); one for
        all ground or by subdomain.
    head
        Hydraulic head, a height, by boundary: a number or a function of places (dim, ...). It is the level of the water
        that stands at the boundary and holds at and below that level; above it the boundary is tight, or a
        `seepage_face`.
    seepage_face
        Names of boundaries through which water may leave but not enter, at zero pressure. One may be named in `head`
        too. All other boundaries are tight.
    connected
        Pairs of boundaries of bodies that share no nodes, ``("core|shell", "shell|core")``, between which water passes
        freely: the nodes of the side with the smaller facets take the heads of the other. Other joints are tight.
    retention
        :class:`Ramp` or :class:`VanGenuchten`, for all ground or by subdomain.
    unit_weight
        Of water (force per volume), positive: the pressure is that of these units.
    axisymmetric
        Flow per radian towards or from the axis x = 0.

    Returns
    -------
    Seepage

    Raises
    ------
    ValueError
        Unknown names, permeabilities that are not positive, elements without permeability or with two, heads that are
        not finite, lie below their boundary or contradict each other, ground without any head.
    NotConverged
        The water does not balance: see the message.

    Warns
    -----
    AnalysisWarning
        The transition between wet and dry had to be wider than asked for; or water flows off through dry ground that
        conducts better than the wet ground it comes from, whose free surface is then drawn down.

    Examples
    --------
    A dam with vertical faces lets k (h1² - h2²) / 2L through (I. A. Charny 1951):

    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> from skfem import Basis, ElementTriP1, MeshTri
    >>> dam = MeshTri.init_tensor(np.linspace(0, 5, 11), np.linspace(0, 10, 21)).with_defaults()
    >>> water = sc.seepage(Basis(dam, ElementTriP1()), permeability=1., head={"left": 10., "right": 2.},
    ...                    seepage_face="right", unit_weight=10.)
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
    if not isinstance(basis, CellBasis):
        raise ValueError(f"a Basis of elements is needed, not {type(basis).__name__}")
    if not 0.0 < unit_weight < np.inf:
        raise ValueError(f"the unit weight of water must be positive, not {unit_weight!r}")
    porous = head_basis(basis)
    given = conditions(porous, head, seepage_face)
    tensors = permeability_tensors(porous, permeability)
    laws = regions(porous, retention, "retention")
    datum = float(np.nanmean(given.head))
    flow = DarcyFlow(porous, tensors, axisymmetric, datum)
    tie = tied_heads(porous, connected, given.held)
    check_connected(porous, given.held, tie)
    lowered = replace(given, head=given.head - datum)
    found = WaterBalance(flow, lowered, tie, porous.mesh.p[:, :porous.N]).solve(laws)
    velocity = flow.velocity(found.head, found.relative)
    _warn_of_dry_ground(porous, tensors, found.relative, velocity)
    heads = np.full(porous.N, np.nan)
    used = np.unique(porous.element_dofs)
    heads[used] = found.head[used] + datum
    pressure = unit_weight * np.maximum(heads - porous.mesh.p[-1, :porous.N], 0.0)
    return Seepage(porous, heads, pressure, found.inflow, velocity, found.iterations, given.passing,
                   flow.by_element(found.head, found.relative), unit_weight, axisymmetric)


def _warn_of_dry_ground(basis: CellBasis, tensors: ndarray, relative: ndarray, velocity: ndarray) -> None:
    """Tell of water that flows off through dry ground which conducts better than wet ground elsewhere.

    A dam whose core is 1e-2, 1e-3, 1e-4 and 1e-6 times as permeable as its shell leaks .6, .7, -5 and -7 % too much
    with 20 elements over the height if dry ground keeps 1e-3 of its permeability. In the last two cases .26 of the flow
    is of this kind; where the discharge is right to 1 % less than .005 is.
    """
    k = np.trace(tensors, axis1=1, axis2=2) / basis.mesh.dim()
    wet, left = (relative >= _WET).any(axis=1), relative.min(axis=1) * k
    draining = (relative < _DRY).all(axis=1) & (left > 1.5 * k[wet].min(initial=np.inf))
    flow = np.linalg.norm(velocity, axis=0) * basis.dx.sum(axis=1)
    if flow[draining].sum() > _SHARE * flow.sum():
        x = np.asarray(basis.global_coordinates())[:, np.where(draining, flow, 0.0).argmax()].mean(axis=1)
        warnings.warn(f"water flows off through dry ground at {place(x)}, which conducts better than the wet ground "
                      "that it comes from: the free surface there is several per cent off; leave drained ground out of "
                      "the basis and name the boundary towards it in seepage_face=, or give a smaller `least` in "
                      "retention=",
                      AnalysisWarning, stacklevel=3)
