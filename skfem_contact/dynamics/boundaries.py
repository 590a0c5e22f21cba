"""Boundaries that waves leave through, and rock from which they arrive."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from skfem import BilinearForm, FacetBasis
from typing_extensions import override

from ..checks import facets_of, format_point, number, positive
from ..forms.base import Form, Response
from ..forms.roles import Absorbing, Couples
from ..forms.solid import SolidForm
from ..layout import facet_corners
from .settings import Rayleigh


@dataclass(frozen=True)
class Bedrock:
    """Bedrock below a model: an elastic half-space.

    Parameters
    ----------
    unit_weight
        Weight per volume.
    vs, vp
        Velocities of shear waves and of pressure waves; by default vp is ``sqrt(3) * vs``, for
        nu = 0.25.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> round(sc.Bedrock(unit_weight=25., vs=1000.).vp, 1)
    1732.1
    """

    unit_weight: float
    vs: float
    vp: float = 0.0

    def __post_init__(self) -> None:
        positive(self.unit_weight, "unit_weight")
        positive(self.vs, "vs")
        if self.vp == 0.0:
            object.__setattr__(self, "vp", float(np.sqrt(3.0) * self.vs))
        number(self.vp, "vp, the velocity of pressure waves,", np.sqrt(4.0 / 3.0) * self.vs)


@dataclass(frozen=True)
class Masses:
    """Settings of a stage with inertia that boundaries need.

    Attributes
    ----------
    acceleration
        Acceleration of gravity.
    consistent
        False for lumped masses.
    damping
        Rayleigh damping by region.
    size
        Number of all dofs.
    """

    acceleration: float
    consistent: bool
    damping: Mapping[str, Rayleigh]
    size: int


class ViscousBoundary(Form, Couples, Absorbing):
    r"""Dashpots that take up waves that leave the ground (Lysmer and Kuhlemeyer 1969).

    .. math:: \sigma_n = \rho v_p \dot u_n, \qquad \tau = \rho v_s \dot u_t

    They act in stages with ``dynamic`` alone, and need supports in all others: such a stage takes
    these away, ``Stage(fixed=...)``, and keeps their reactions as loads. Waves normal to the
    boundary leave without reflection, others up to 30 degrees off leave by more than 95 % of their
    energy.

    Parameters
    ----------
    solid
        Solid form with a unit weight, on whose boundary the dashpots act.
    boundary
        Name of the boundary.
    rock
        Rock beyond the boundary, on which a record of ``Stage(base=...)`` is an outcrop motion: the
        force is ``rho vs`` times its velocity (Joyner and Chen 1975), and displacements are then
        absolute. By default the elastic ground at the boundary continues, and no motion arrives.

    Raises
    ------
    ValueError
        A boundary that does not exist or lies inside, or a solid without a unit weight.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(2).with_defaults(), ElementVector(ElementQuad1()))
    >>> ground = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=.3), unit_weight=20.)
    >>> sc.ViscousBoundary(ground, "bottom", rock=sc.Bedrock(unit_weight=24., vs=800.))
    <ViscousBoundary on 'bottom', 4 facets, rock>
    """

    symmetric = True

    def __init__(self, solid: SolidForm, boundary: str, rock: Bedrock | None = None) -> None:
        basis = solid.basis
        mesh = basis.mesh
        facets = facets_of(mesh, boundary)
        # Check that the boundary has the ground on one side.
        if solid.unit_weight is None:
            raise ValueError("the solid of a viscous boundary needs its unit_weight")
        inside = facets[mesh.f2t[1, facets] >= 0]
        if len(inside):
            middle = facet_corners(mesh, inside[0]).mean(axis=1)
            raise ValueError(
                f"boundary '{boundary}' lies inside of the mesh at {format_point(middle)}, where "
                "no wave leaves the ground"
            )
        beyond = ~np.isin(mesh.f2t[0, facets], solid.elements)
        if beyond.any():
            raise ValueError(
                f"{beyond.sum()} facets of boundary '{boundary}' belong to no element of the "
                "solid: there is no stiffness to take up waves of"
            )
        # Keep what the matrices are made of.
        self.size = int(basis.N)
        self.of_rock = rock is not None
        self.changing = np.zeros(0, int)
        self.joins = np.zeros(0, int)
        self._solid = solid
        self._boundary = boundary
        self._rock = rock
        self.absorbs_at = np.asarray(facets)
        self._facets = FacetBasis(mesh, basis.elem, facets=facets, intorder=4)
        self._empty = csr_matrix((self.size, self.size))

    def __repr__(self) -> str:
        rock = ""
        if self.of_rock:
            rock = ", rock"
        return f"<ViscousBoundary on '{self._boundary}', {len(self._facets.find)} facets{rock}>"

    @override
    def assemble(self, x: ndarray, state: Any) -> Response:
        return Response(np.zeros(len(x)), lambda: state, lambda: self._empty)

    @override
    def matrices(self, given: Masses) -> tuple[csr_matrix, csr_matrix]:
        normal, along = self._impedances(given.acceleration)
        facets = self._facets
        shape = facets.dx.shape
        radius = np.ones(shape)
        if self._solid.coordinates == "axisymmetric":
            radius = np.asarray(facets.global_coordinates())[0]
        dim = facets.mesh.dim()

        # rho (vp - vs) (v.n) (u.n) + rho vs v.u
        @BilinearForm
        def dashpots(u, v, w):  # type: ignore[no-untyped-def]
            un = sum(u[c] * w.n[c] for c in range(dim))
            vn = sum(v[c] * w.n[c] for c in range(dim))
            uv = sum(u[c] * v[c] for c in range(dim))
            return w.radius * ((w.normal - w.along) * un * vn + w.along * uv)

        fields = {
            "normal": np.broadcast_to(normal[:, None], shape),
            "along": np.broadcast_to(along[:, None], shape),
            "radius": radius,
        }
        return self._empty, csr_matrix(dashpots.assemble(facets, **fields))

    def _impedances(self, acceleration: float) -> tuple[ndarray, ndarray]:
        """Return rho vp and rho vs of the facets, (n_facets,)."""
        facets = self._facets.find
        if self._rock is not None:
            density = self._rock.unit_weight / acceleration
            one = np.ones(len(facets))
            return density * self._rock.vp * one, density * self._rock.vs * one
        solid = self._solid
        elements = solid.basis.mesh.f2t[0, facets]
        position = np.full(solid.basis.mesh.nelements, -1)
        position[solid.elements] = np.arange(len(solid.elements))
        own = position[elements]
        moduli = solid.elastic_moduli[own]
        density = solid.unit_weights[own] / acceleration
        # rho v = sqrt(rho M) with the modulus M of the wave
        along = np.sqrt(density * moduli[:, 0, 0])
        across = np.sqrt(density * moduli[:, -1, -1])
        return along, across
