"""Steady flow of water: heads, pressures, discharges, exit gradients, heave and uplift."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy import ndarray
from skfem import CellBasis, FacetBasis, LinearForm

from ..arrays import quotient
from ..checks import facets_of, look_up, number, positive
from ..layout import elements_of
from .balance import Balance
from .boundary import Given, NodalConditions, through
from .darcy import DarcyFlow, radius, regions
from .points import interpolated, zero_lines
from .retention import Laws

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
    _passing: Mapping[str, ndarray]
    _flux: Mapping[str, Given]
    _from_sources: ndarray
    _by_element: ndarray
    _saturation: ndarray
    _unit_weight: float
    _axisymmetric: bool

    def __str__(self) -> str:
        rows = [
            f"seepage through {self.basis.nelems} elements, {np.isfinite(self.head).sum()} nodes, "
            f"{np.sum(self.pressure > 0.0)} of them below the free surface",
            f"{sum(self.iterations)} Newton iterations",
            f"{'boundary':<24} {'inflow':>12}",
        ]
        for name in self._passing:
            rows.append(f"{name:<24} {self.discharge(name):>12.5g}")
        return "\n".join(rows)

    __repr__ = __str__  # a notebook would show the arrays

    def discharge(self, boundary: str, of: str | None = None) -> float:
        """Return the water that enters the ground through a boundary; negative where it leaves.

        The discharge is the sum of the nodes' reactions, so that nothing is lost. A node between
        two boundaries through which water passes counts for both in proportion to their sizes; rain
        that runs off does not count. With the subdomain `of` it is the water that enters this part
        of the ground there, also from ground on the opposite side of the boundary.
        """
        mesh = self.basis.mesh
        facets = facets_of(mesh, boundary)
        if of is not None:
            elements = look_up(of, mesh.subdomains or {}, "subdomain")
            part = np.isin(elements_of(self.basis), elements)
            nodes = self.basis.element_dofs.T[part]
            on = np.isin(nodes, mesh.facets[:, facets])
            return float(self._by_element[part][on].sum())
        # Share the nodes among the boundaries by their size.
        passing = np.unique(np.concatenate(list(self._passing.values())))
        own_size = self._size(np.intersect1d(facets, passing))
        size = self._size(passing)
        share = quotient(own_size, size)
        # Take given rates by boundary; rain that the ground does not take runs off.
        entering = self.inflow - self._from_sources
        own_rates = self._rates(facets)
        rates = self._rates(passing)
        limited = np.clip(entering, 0.0, rates)
        taken = np.where(rates > 0.0, limited, rates)
        by_rate = np.divide(own_rates, rates, out=np.zeros_like(size), where=rates != 0.0)
        return float(by_rate @ taken + share @ (entering - taken))

    def _rates(self, facets: ndarray) -> ndarray:
        """Return the water that enters the nodes through facets by given rates, (n_nodes,)."""
        rates = np.zeros(len(self.head))
        for name, rate in self._flux.items():
            part = np.intersect1d(self._passing[name], facets)
            rates = rates + through(self.basis, part, rate, self._axisymmetric)
        return rates

    def flux(self, boundary: str) -> tuple[ndarray, ndarray]:
        """Return the nodes of a boundary and the water that enters it per area.

        The flux is negative where water leaves.
        The boundary has a head or is a seepage face. The flux over the permeability is the
        hydraulic gradient at which water leaves, the exit gradient.

        Examples
        --------
        >>> import skfem_contact as sc
        >>> from skfem import Basis, ElementTriP1, MeshTri
        >>> column = Basis(MeshTri().refined(2).with_defaults(), ElementTriP1())
        >>> flow = sc.water.Flow(column, permeability=1e-5, unit_weight=10.)
        >>> water = flow.steady(sc.water.Conditions(head={"bottom": 1.5, "top": 1.}))
        >>> bool(abs(water.flux("top")[1] / 1e-5 + .5).max() < 1e-12)
        True
        """
        facets = look_up(boundary, self._passing, "boundary through which water passes")
        nodes = np.intersect1d(self.basis.mesh.facets[:, facets], self.basis.element_dofs)
        return nodes, self.inflow[nodes] / self._size(facets)[nodes]

    def heave_factor(self, part: str, unit_weight: float) -> float:
        """Return the factor of safety of a subdomain against heave.

        It is the buoyant weight over the upward seepage force. The subdomain is K. Terzaghi's
        prism: as deep as the foot of a wall at it, and half as wide. The unit weight is the one of
        saturated ground. The factor is infinite where the water does not flow upwards.
        """
        # Check the part: porous, heavier than water, and below the free surface.
        mesh = self.basis.mesh
        subdomain = look_up(part, mesh.subdomains or {}, "subdomain")
        here = np.isin(elements_of(self.basis), subdomain)
        if not here.any():
            raise ValueError(f"subdomain '{part}' has no element of the porous ground")
        if not number(unit_weight, "unit_weight") > self._unit_weight:
            raise ValueError(
                f"unit_weight is that of saturated ground, more than {self._unit_weight:g} of the "
                f"water, not {unit_weight:g}"
            )
        corners = self.basis.element_dofs[:, here]
        surface = mesh.p[-1, corners] - _DRIP * np.ptp(mesh.p[-1])
        if (self.head[corners] < surface).any():
            raise ValueError(
                f"subdomain '{part}' lies above the free surface in part: heave is of ground below "
                "water"
            )
        # Compare the submerged weight with the seepage force upwards, γ_w ∂h/∂y dV.
        head = self.basis.interpolate(np.nan_to_num(self.head))
        rise = np.asarray(head.grad)[-1][here]
        volume = (self.basis.dx * radius(self.basis, self._axisymmetric))[here]
        upward = -self._unit_weight * float((rise * volume).sum())
        weight = (unit_weight - self._unit_weight) * float(volume.sum())
        if upward > 0.0:
            return weight / upward
        return np.inf

    def uplift_factor(
        self,
        bottom: str,
        unit_weight: Mapping[str, float],
        load: float = 0.0,
    ) -> float:
        """Return the factor of safety of a tight layer or slab against uplift.

        It is the weight above over the force of the water, which presses on the boundary
        `bottom` of the porous ground with its full head. Facets with ground above them count
        negative: the force on the whole outline of a tunnel is its buoyancy. `unit_weight` is by
        subdomain, of all that lies above the bottom: saturated ground, also elements outside of the
        porous ground. `load` is a further downward force, of
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
        >>> flow = sc.water.Flow(sand, permeability=1e-5, unit_weight=10.)
        >>> water = flow.steady(sc.water.Conditions(head={"left": 6.2}))
        >>> round(water.uplift_factor("base", unit_weight={"clay": 20.}), 6)  # 2 * 20 / (4.2 * 10)
        0.952381
        """
        mesh = self.basis.mesh
        facets = facets_of(mesh, bottom)
        # The ground lies on one side of the boundary, or on both.
        below, above = np.isin(mesh.f2t[:, facets], elements_of(self.basis))
        if not (below | above).all():
            raise ValueError(
                f"boundary '{bottom}' has facets without porous ground, where no pressure is "
                "known; of bodies that share no nodes name the side of the ground"
            )
        # Integrate the vertical force of the water.
        around = FacetBasis(mesh, self.basis.elem, facets=facets)
        compressive = np.nan_to_num(np.maximum(self.pressure, 0.0))
        pressure = around.interpolate(compressive)
        force = pressure * around.dx * radius(around, self._axisymmetric)
        up = around.normals[-1] * np.where(below, 1.0, -1.0)[:, None]
        inside = (below & above)[:, None]
        up = np.where(inside, np.abs(up), up)
        upward = float((force * up).sum())
        if not upward > _DRIP * float(force.sum()):
            raise ValueError(f"no water presses upwards on boundary '{bottom}'")
        # Weigh the subdomains above.
        if not isinstance(unit_weight, Mapping) or not unit_weight:
            raise ValueError(
                f"unit_weight is {{subdomain: unit weight}} of what lies above, not {unit_weight!r}"
            )
        weights = {name: positive(each, "unit_weight") for name, each in unit_weight.items()}
        parts = [look_up(name, mesh.subdomains or {}, "subdomain") for name in weights]
        elements = np.unique(np.concatenate(parts))
        body = CellBasis(mesh, self.basis.elem, elements=elements)
        volume = body.dx * radius(body, self._axisymmetric)
        regional: list[tuple[ndarray, float]] = regions(body, weights, "unit weight")
        weight = sum(each * float(volume[part].sum()) for part, each in regional)
        return (number(load, "load") + weight) / upward

    def head_at(self, x: ndarray, outside: ndarray | None = None) -> ndarray:
        """Return the head at coordinates (dim, ...), linear in triangles and tetrahedra.

        Points outside of the ground are refused unless their head is given, (...).
        """
        return self._at(x, self.head, outside)

    def _at(self, x: ndarray, nodal: ndarray, outside: ndarray | None = None) -> ndarray:
        """Return nodal values at coordinates (dim, ...)."""
        x = np.asarray(x, dtype=float)
        dim = self.basis.mesh.dim()
        if x.ndim == 0 or len(x) != dim:
            raise ValueError(f"coordinates have the shape ({dim}, ...), not {x.shape}")
        points = x.reshape(dim, -1)
        beyond = None
        if outside is not None:
            beyond = np.broadcast_to(outside, x.shape[1:]).ravel()
        elements = elements_of(self.basis)
        values = interpolated(self.basis.mesh, elements, nodal, points, beyond)
        return values.reshape(x.shape[1:])

    def pressure_at(self, x: ndarray, head: ndarray | None = None) -> ndarray:
        """Return the pressure at coordinates (dim, ...), by default under the head there."""
        given = self.head_at(x) if head is None else head
        pressure = self._unit_weight * np.maximum(given - np.asarray(x)[-1], 0.0)
        if head is not None or not (self.pressure < 0.0).any():
            return pressure
        suction = self._at(x, np.minimum(self.pressure, 0.0))
        return pressure + suction * (pressure == 0.0)

    def with_suction(self) -> Seepage:
        """Return the flow with the suction of dry ground times its effective saturation.

        This is A. W. Bishop's stress. The `pressure` is negative above the free surface then, and
        the ground is stronger by the suction stress.
        """
        depth = self._depth
        filled = np.where(depth > 0.0, 1.0, self._saturation)
        return replace(self, pressure=self._unit_weight * filled * depth)

    @property
    def _depth(self) -> ndarray:
        """Pressure head at the nodes, (n_nodes,)."""
        return np.asarray(self.head - self.basis.mesh.p[-1, : len(self.head)])

    @property
    def free_surface(self) -> list[ndarray]:
        """Lines of zero pressure in plane flow, (n, 2) each, the longest first."""
        return zero_lines(self.basis.mesh, elements_of(self.basis), self._depth)

    def _size(self, facets: ndarray) -> ndarray:
        """Return the area of a boundary that belongs to each node, (n_nodes,)."""
        size = np.zeros(len(self.head))
        if len(facets) == 0:
            return size
        nodes = np.unique(self.basis.mesh.facets[:, facets])
        around = FacetBasis(self.basis.mesh, self.basis.elem, facets=facets)
        per_radian = radius(around, self._axisymmetric)
        size[nodes] = LinearForm(lambda v, w: per_radian * v).assemble(around)[nodes]
        return size


def described(
    flow: DarcyFlow,
    result: Balance,
    *,
    given: NodalConditions,
    laws: Laws,
    flux: Mapping[str, Given],
    from_sources: ndarray,
    unit_weight: float,
) -> Seepage:
    """Return the flow of heads that count from the datum."""
    porous = flow.basis
    used = np.unique(porous.element_dofs)
    # Nodes without porous ground have no head.
    head = np.full(porous.N, np.nan)
    head[used] = result.head[used] + flow.datum
    pressure = unit_weight * np.maximum(head - porous.mesh.p[-1, : porous.N], 0.0)
    # Average the saturation around the nodes.
    volume = flow.gathered(np.ones((1, 1)))
    filled = flow.gathered(flow.filled(result.head, laws)[0])
    return Seepage(
        basis=porous,
        head=head,
        pressure=pressure,
        inflow=result.inflow,
        velocity=flow.velocity(result.head, result.relative),
        iterations=result.iterations,
        _passing=given.passing,
        _flux=flux,
        _from_sources=from_sources,
        _by_element=flow.by_element(result.head, result.relative),
        _saturation=filled / np.where(volume > 0.0, volume, 1.0),
        _unit_weight=unit_weight,
        _axisymmetric=flow.axisymmetric,
    )
