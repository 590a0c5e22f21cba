"""Porous ground: coupling of pressures with displacements, storage and flow, element by element."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix, diags_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from skfem import CellBasis, FacetBasis

from ..beams import Beam
from ..checks import format_point
from ..errors import Remark
from ..forms.assembly import strain_operator
from ..forms.base import Coordinates, Form, solids_of
from ..layout import elements_of
from .darcy import radius

#: Name under which all ground shares the field of its pore pressures.
PRESSURE = "pore pressure"
#: Conductance of connected boundaries over that of the elements beside them: their pressures differ
#: by a thousandth of the drop in one element.
_OPEN = 1e3
#: A pressure of one everywhere that strains nothing beyond this share of its effect without
#: supports is undetermined.
_RIGID = 1e-12
#: Ground so many times as permeable drains its neighbours: a column on a drained layer of the same
#: stiffness has up to 1.26 q with 100, 1.0 q with 10, once c_v t of the layer passes a tenth of its
#: height squared, and 1.003 q before.
_DRAINS, _DRAINED = 100.0, 0.1
#: Time over h² / c_v from which on elements beside drains are fine enough: pressures in columns of
#: 2, 4 and 8 elements are up to 1.40 q at a tenth of 1 / 6, 1.15 q at 1 / 6 (P. A. Vermeer and A.
#: Verruijt 1981), 1.04 q from 1 / 3 on.
_RESOLVED = 1.0 / 3.0
#: Before, under a load that grows evenly to q, they are up to 1.46 q (5 % of that time), 1.41 q (10
#: %), 1.30 q (25 %), 1.18 q (50 %) and 1.10 q (75 %): q and q / 2 times this power of what is
#: missing of the time.
_POWER = 1.3
#: Share of the largest pressure up to which such an excess is not remarked on.
_EXCESS = 0.05
#: Pull on the ground under tight contact, as a share of what contact transfers, that is remarked
#: on.
_PULLED = 0.05
_ROUND_OFF = 1e-9  # distance of points that coincide, over the size of the mesh
#: Degrees of consolidation, T = c_v t / H², that no stage of an analysis has in any sensible units.
_LEAST, _MOST = 1e-10, 1e8
#: Water out of balance is measured by what nodes store in a step, or by this share of what flows in
#: and out of them: at the usual tolerance that is 1e-14, its round-off in ground a small part of
#: which is 1e8 times as permeable.
FLOWING = 1e-6
#: From here on round-off of the pressures moves as much water as the ground holds.
_LOST = 1e12


@dataclass(frozen=True, eq=False)
class Porous:
    """Matrices of the elements, with displacements and linear pressures at the same integration
    points.

    Attributes
    ----------
    coupling : ndarray, shape (n_elements, n_u, n_p)
        Volume strain weighted with the shape functions of the pressure.
    mass, spread, flow : ndarray, shape (n_elements, n_p, n_p)
        Products of these shape functions; of their differences from the mean over the element; and
        of their gradients with the permeability.
    conductance : ndarray, shape (N,)
        Water that leaves the nodes by a pressure of one there.
    across : coo_matrix, shape (N, N)
        Water that leaves the nodes through connected boundaries, by pressures.
    open
        Nodes of connected boundaries.
    """

    basis: CellBasis
    pressures: CellBasis
    coupling: ndarray
    mass: ndarray
    spread: ndarray
    flow: ndarray
    conductance: ndarray
    across: coo_matrix
    open: ndarray

    @classmethod
    def of(
        cls,
        basis: CellBasis,
        pressures: CellBasis,
        measure: tuple[str, Coordinates],
        mobility: ndarray,
        apart: csr_matrix,
        facets: ndarray,
    ) -> Porous:
        """Integrate the matrices.

        The mobility is the permeability over the unit weight of water, (n_elements, dim, dim).
        Water between connected boundaries, with the pressures `apart` and these facets, presses on
        both and fills the gap by which they open.
        """
        B, weight = strain_operator(basis, *measure)
        shapes = [pressures.basis[j][0] for j in range(pressures.Nbfun)]
        N = np.stack([np.broadcast_to(np.asarray(shape), weight.shape) for shape in shapes])
        gradients = np.stack([np.asarray(shape.grad) for shape in shapes])
        coupling = np.einsum("eqb,jeq,eq->ebj", B[:, :, :3].sum(axis=2), N, weight)
        mass = np.einsum("ieq,jeq,eq->eij", N, N, weight, optimize=True)
        mean = np.einsum("ieq,eq->ei", N, weight)
        spread = mass - mean[:, :, None] * mean[:, None, :] / weight.sum(axis=1)[:, None, None]
        flow = np.einsum(
            "ikeq,ekl,jleq,eq->eij", gradients, mobility, gradients, weight, optimize=True
        )
        conductance = _at_nodes(pressures, np.einsum("eii->ei", flow))
        across = coo_matrix(apart.T @ diags_array(_OPEN * conductance) @ apart)
        if len(facets):
            coupling = coupling - _swept(basis, pressures, facets, measure[1])
        return cls(
            basis,
            pressures,
            coupling,
            mass,
            spread,
            flow,
            conductance,
            across,
            np.unique(basis.mesh.facets[:, facets]),
        )

    @property
    def linear(self) -> bool:
        """True if displacements and pressures have the same nodes: such pairs are not stable by
        themselves.
        """
        return self.basis.Nbfun == self.basis.mesh.dim() * self.pressures.Nbfun

    def matrix(
        self,
        first: int,
        coupling: ndarray,
        water: ndarray,
        across: float = 0.0,
        squeezed: ndarray | None = None,
    ) -> csr_matrix:
        """Return the matrix of all dofs, of which the pressures begin at `first`, with one pattern
        for all values.

        The matrix contains `across` times the flow through connected boundaries. The water that
        displacements squeeze out is that of the coupling, or of another one.
        """
        u, p = self.basis.element_dofs.T, first + self.pressures.element_dofs.T
        squeezed = coupling if squeezed is None else squeezed
        blocks = ((u, p, coupling), (p, u, squeezed.transpose(0, 2, 1)), (p, p, water))
        rows = [np.broadcast_to(r[:, :, None], values.shape).ravel() for r, _, values in blocks]
        columns = [np.broadcast_to(c[:, None], values.shape).ravel() for _, c, values in blocks]
        data = np.concatenate(
            [*(values.ravel() for *_, values in blocks), across * self.across.data]
        )
        at = (
            np.concatenate([*rows, first + self.across.row]),
            np.concatenate([*columns, first + self.across.col]),
        )
        return csr_matrix(coo_matrix((data, at), 2 * (first + self.pressures.N,)))

    def at_nodes(self, density: ndarray) -> ndarray:
        """Integrate a density of the elements, (n_elements,), over the share of each node,
        (n_p,).
        """
        return _at_nodes(self.pressures, self.mass.sum(axis=2) * density[:, None])

    def strains(self, fixed: ndarray) -> bool:
        """Return True if a uniform pressure strains the ground with these fixed displacements."""
        thrust = np.abs(
            np.bincount(
                self.basis.element_dofs.T.ravel(),
                self.coupling.sum(axis=2).ravel(),
                minlength=self.basis.N,
            )
        )
        whole, by_element = thrust.max(), np.abs(self.coupling).max()
        thrust[fixed] = 0.0
        return bool(thrust.max() > _RIGID * max(whole, by_element))

    def check_step(
        self,
        drained: ndarray,
        leaks: ndarray,
        grounds: Sequence[Ground],
        duration: float,
        first: int,
    ) -> Iterator[Remark]:
        """Report ground without drains, and a duration too short for elements beside them, if their
        pressures differ.

        Drained nodes are those of held pressures and of seepage faces. The grounds are this one and
        other active ones. The pressures begin at the dof `first`.
        """
        own, ground = grounds[0], Ground(*map(np.hstack, zip(*grounds, strict=True)))
        if not (np.isin(drained, ground.corners).any() or len(leaks)):
            yield Remark("sealed", 0.0, "no pore pressure is held: no water can leave the ground")
        element, across = self._beside_drains(np.union1d(drained, leaks), ground, own, duration)
        times = across**2 * _RESOLVED / own.diffusivity[element]
        excess = 0.5 * np.clip(1.0 - duration / times, 0.0, None) ** _POWER

        def holds(x: ndarray) -> bool:
            p = x[first + own.corners]
            return float((excess * np.ptp(p[:, element], axis=0)).max()) > _EXCESS * np.abs(p).max()

        if duration < (shortest := float(times.max(initial=0.0))):
            yield Remark(
                "short",
                shortest / duration,
                f"it ends after {duration:.3g}, less than h² / 3 c_v = "
                f"{shortest:.3g} of the elements beside drains, where changes of pressure may be "
                f"up to "
                f"{excess.max():.0%} too large at its end: refine them, or let it last longer",
                holds,
            )

    def _beside_drains(
        self, drained: ndarray, ground: Ground, own: Ground, duration: float
    ) -> tuple[ndarray, ndarray]:
        """Return own elements that drain through a facet, also to permeable ground, and their
        sizes.
        """
        basis, mesh, corners = self.basis, self.basis.mesh, ground.corners
        sides, best = mesh.t2f[:, elements_of(basis)], np.zeros(self.pressures.N)
        np.maximum.at(best, corners.ravel(), np.tile(ground.mobility, len(corners)))
        best[drained] = np.inf
        beside = best[mesh.facets].min(axis=0)[sides]
        found = [np.nonzero(np.isinf(beside))]
        values = np.unique(
            own.mobility[(np.isfinite(beside) & (beside >= _DRAINS * own.mobility)).any(axis=0)]
        )
        distance = (
            cKDTree(mesh.p[:, drained].T).query(mesh.p[:, : self.pressures.N].T)[0]
            if len(values)
            else best
        )
        for value in values:
            drain = ground.mobility >= _DRAINS * value
            first, others = np.broadcast_arrays(corners[:1, drain], corners[:, drain])
            graph = coo_matrix(
                (np.ones(others.size), (first.ravel(), others.ravel())), 2 * (self.pressures.N,)
            )
            part = connected_components(graph, directed=False)[1]
            spread = ground.diffusivity[drain].max(initial=0.0) * duration
            open = np.isin(part, part[drained]) & (_DRAINED * distance**2 <= spread)
            found.append(np.nonzero(open[mesh.facets].all(axis=0)[sides] & (own.mobility == value)))
        side, element = np.hstack(found)
        p = mesh.p[:, mesh.facets[:, sides[side, element]]]
        area = np.linalg.norm(
            p[:, 1] - p[:, 0]
            if mesh.dim() == 2
            else 0.5 * np.cross(p[:, 2] - p[:, 0], p[:, -1] - p[:, 1], axis=0),
            axis=0,
        )
        simplex = len(mesh.t) == mesh.dim() + 1
        return element, (mesh.dim() if simplex else 1) * basis.dx.sum(axis=1)[element] / area


def _at_nodes(basis: CellBasis, values: ndarray) -> ndarray:
    """Sum values of the corners of the elements, (n_elements, n_corners), at the nodes."""
    return np.bincount(basis.element_dofs.T.ravel(), values.ravel(), minlength=basis.N)


def _swept(basis: CellBasis, pressures: CellBasis, facets: ndarray, coordinates: str) -> ndarray:
    """Return the volume that displacements sweep at facets, weighted as :attr:`Porous.coupling`."""
    result = np.zeros((basis.nelems, basis.Nbfun, pressures.Nbfun))
    sides = FacetBasis(basis.mesh, basis.elem, facets=facets)
    wet = FacetBasis(basis.mesh, pressures.elem, facets=facets, quadrature=sides.quadrature)
    weight = sides.dx * radius(sides, coordinates == "axisymmetric")
    swept = np.stack(
        [np.einsum("ifq,ifq->fq", sides.basis[b][0], sides.normals) for b in range(sides.Nbfun)]
    )
    shapes = np.stack([np.broadcast_to(wet.basis[j][0], weight.shape) for j in range(wet.Nbfun)])
    number = np.zeros(basis.mesh.nelements, int)
    number[elements_of(basis)] = np.arange(basis.nelems)
    np.add.at(
        result,
        number[basis.mesh.f2t[0, facets]],
        np.einsum("bfq,jfq,fq->fbj", swept, shapes, weight),
    )
    return result


class Ground(NamedTuple):
    """Corners of elements, (n_p, n), the largest permeability over the weight of water, and c_v,
    (n,).
    """

    corners: ndarray
    mobility: ndarray
    diffusivity: ndarray


class Surroundings(NamedTuple):
    """Stiffness of the ground in compression without lateral strain and in shear, (n_elements,),
    and other forms.

    These are: nodes of seepage faces, forms in contact, strain measure and coordinates of the
    solids; other waters with their dofs; remarks on beams through which water passes.
    """

    modulus: ndarray
    shear: ndarray
    leaks: ndarray
    touching: Mapping[str, Any]
    measure: tuple[str, Coordinates]
    waters: tuple[tuple[ndarray, Ground], ...]
    crossed: tuple[Remark, ...]

    @classmethod
    def of(cls, basis: CellBasis, forms: Mapping[str, Form], waters: Sequence[Any]) -> Surroundings:
        """Collect the forms around the ground of a basis, all of which must belong to solids."""
        mesh, here = basis.mesh, elements_of(basis)
        modulus, shear = np.full((2, mesh.nelements), np.nan)
        measures = set()
        for name, form in [
            (name, form) for name, form in solids_of(forms).items() if form.materials
        ]:
            for region in form.regions:
                elements = form.elements[region.elements]
                D = region.material.elasticity(4 if mesh.dim() == 2 else 6)
                modulus[elements], shear[elements] = D[..., 0, 0], D[..., 3, 3]
                if np.isin(elements, here).any():
                    assert form.coordinates is not None
                    measures.add((form.strain, form.coordinates))
                    if region.material.undrained:
                        raise ValueError(
                            f"region '{region.name}' of '{name}' is Undrained and has PoreWater "
                            f"too: its "
                            "water would count twice; give its soil alone"
                        )
        lost = here[np.isnan(modulus[here])]
        if len(lost):
            raise ValueError(
                f"there is PoreWater in {len(lost)} elements of no SolidForm, the first at "
                f"{format_point(mesh.p[:, mesh.t[:, lost[0]]].mean(axis=1))}"
            )
        if len(measures) > 1:
            raise ValueError(
                f"the solids of the porous ground have different strains, {sorted(measures)}: give "
                f"all of "
                "them the same `strain`"
            )
        touching = {
            name: form
            for name, form in forms.items()
            if form.joins is not None
            and form.unilateral
            and np.isin(form.joins, basis.element_dofs).any()
        }
        leaks = np.concatenate(
            [np.zeros(0, int), *(form.leaks for form in forms.values() if form.leaks is not None)]
        )
        others = tuple(
            (water.ground.element_dofs, water.drainage(modulus[water.elements])) for water in waters
        )
        return cls(
            modulus[here],
            shear[here],
            leaks,
            touching,
            measures.pop(),
            others,
            tuple(_crossed(basis, forms)),
        )


def _crossed(basis: CellBasis, forms: Mapping[str, Form]) -> Iterator[Remark]:
    """Yield remarks on plane beams along facets inside of porous ground, which are no boundary of
    its water.
    """
    mesh = basis.mesh
    inner = np.bincount(mesh.t2f[:, elements_of(basis)].ravel(), minlength=mesh.nfacets) == 2
    middles = cKDTree(mesh.p[:, mesh.facets[:, inner]].mean(axis=1).T)
    for name, form in forms.items():
        if isinstance(form, Beam) and form.coordinates != "space" and form.spacing == 1.0:
            at = form.points[form.cells].mean(
                axis=1
            )  # of quadratic lines: their middles, if they are straight
            if n := int((middles.query(at)[0] < _ROUND_OFF * np.ptp(mesh.p)).sum()):
                yield Remark(
                    f"{name} crossed",
                    n,
                    f"water passes through '{name}', which shares nodes with the ground "
                    "on both sides: a tight wall is a beam in a slit, bonded=False",
                )


def pulled(
    name: str, pair: Any, state: Any, coordinates: ndarray, pressure: ndarray
) -> Iterator[Remark]:
    """Report tight contact under which the excess pressure at some nodes, (n,), exceeds the contact
    pressure.
    """
    points, closed = pair.points(state), state.status > 0
    near = cKDTree(coordinates.T).query(points.positions(pair.slave.nodes)[closed])[1]
    total, weight = -state.traction[0, closed], pair.share * points.weight[closed]
    pull = np.clip(pressure[near] - total, 0.0, None)
    if weight @ pull > _PULLED * np.abs(weight @ total):
        yield Remark(
            f"{name} pulled",
            float(weight @ pull),
            f"under '{name}' the water presses with up to {pressure[near].max():.4g}, and contact "
            f"transfers "
            f"{total[pull.argmax()]:.4g} there in total: the ground is pulled, what lies on it "
            f"would be "
            "lifted; drain the joint, or let the pressure act on the body above as well",
        )


def check_units(basis: CellBasis, diffusivity: ndarray, duration: float) -> Iterator[Remark]:
    """Report a degree of consolidation that no analysis has; refuse it where round-off would hide
    the pressures.
    """
    used = basis.mesh.p[:, np.unique(basis.mesh.t[:, elements_of(basis)])]
    length = float(np.ptp(used, axis=1).max())
    time = (
        float(diffusivity.max()) * duration / length**2,
        float(diffusivity.min()) * duration / length**2,
    )
    if time[0] >= _LEAST and time[1] <= _MOST:
        return
    worst = time[0] if time[0] < _LEAST else time[1]
    text = (
        f"the stage ends after {worst:.1e} times H² / c_v, with c_v from {diffusivity.min():.3g} "
        f"to "
        f"{diffusivity.max():.3g}: are permeability, stiffness and duration in the same units?"
    )
    if worst > _LOST:
        raise ValueError(text)
    yield Remark("units", abs(np.log10(worst)), text)


@dataclass(frozen=True)
class PoreState:
    """State of the water around the nodes, (n_vertices,) each.

    Attributes
    ----------
    stored, first
        Volume of water, more than in undeformed ground; the same when the ground became active.
    entered
        Water that has entered since: not zero only where pressures are given, or other ground
        begins.
    pressure
        Excess pore pressure, positive in compression.
    """

    stored: ndarray
    first: ndarray
    entered: ndarray
    pressure: ndarray
