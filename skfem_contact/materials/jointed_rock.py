r"""Elastic rock with sets of joints, planes along which it slips and opens.

Each set has a Mohr-Coulomb strength on its plane: with the normal stress :math:`\sigma_n`, tension
positive, and the shear stress :math:`\tau` there,

.. math:: f_\pm = \pm \tau + \sigma_n \tan\varphi - c \le 0 , \qquad f_t = \sigma_n - t \le 0 .

The surfaces are linear in the stress, so that the return is exact: the multipliers solve
:math:`f^{trial} - G \lambda \le 0`, :math:`\lambda \ge 0`, with :math:`G_{ij} = a_i : D : b_j` of
the gradients a of the surfaces and b of the potentials (J. C. Simo, J. G. Kennedy, S. Govindjee,
Int. J. Numer. Meth. Engng 26 (1988) 2161-2185).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import chain, combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from ..checks import is_number
from ..errors import IncrementTooLarge
from .base import (
    PLASTIC_STRAIN,
    Array,
    Flow,
    Internal,
    Material,
    Update,
    check_reduction,
    check_shapes,
    require,
    warn_of_radians,
)
from .elastic import LinearElastic, angle_over

#: Excess over a surface, as a share of the largest stress, that is round-off.
_ROUND_OFF = 1e-11
#: Most sets of joints, as each of them adds three surfaces.
_MOST = 3
#: Condition from which surfaces that act together count as dependent.
_SINGULAR = 1e10
#: Share of the elastic stiffness that the tangent keeps where joints act: elements of which two
#: sets have opened have none. Two of ten searches of a slope with crossed joints without tensile
#: strength stalled by singular systems, one at 1.17 for 1.37; none do with 1e-8, one with 1e-6.
_KEPT = 1e-8


@dataclass(frozen=True)
class Joint:
    """A set of joints.

    Parameters
    ----------
    dip
        Angle of the trace of the planes from the x axis, anticlockwise, in degrees.
    c, phi, psi
        Cohesion, friction angle and dilatancy angle in degrees.
    tension
        Tensile strength across the planes, at most c / tan(phi); by default zero.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.Joint(dip=30., c=10., phi=25.)
    Joint(dip=30.0, c=10.0, phi=25.0, psi=0.0, tension=0.0)
    """

    dip: float
    c: float
    phi: float
    psi: float = 0.0
    tension: float = 0.0

    def __post_init__(self) -> None:
        # Check the values one by one.
        for name in ("dip", "c", "phi", "psi", "tension"):
            value = getattr(self, name)
            if not is_number(value):
                raise ValueError(f"{name} of a joint must be a finite number, not {value!r}")
        for name in ("c", "phi", "psi", "tension"):
            require(f"{name} of a joint", getattr(self, name), getattr(self, name) >= 0.0, ">= 0")
        require("phi of a joint", self.phi, self.phi < 90.0, "lie in [0, 90) degrees")
        require("psi of a joint", self.psi, self.psi <= self.phi, "not exceed phi")
        most = self._apex
        low = self.tension <= most * (1.0 + 1e-12)
        require("tension of a joint", self.tension, low, f"be at most c / tan(phi), {most:g}")
        warn_of_radians(phi=self.phi, psi=self.psi)

    @property
    def _apex(self) -> float:
        """Tension at the apex of the cone, c / tan(phi), which stays where strength is reduced."""
        if self.phi == 0.0:
            return np.inf
        return float(self.c / np.tan(np.radians(self.phi)))

    def reduced(self, factor: float, associated: bool) -> Joint:
        """Return the joint with its strength over a factor."""
        phi = float(angle_over(self.phi, factor))
        if associated or self.psi == self.phi:
            psi = phi
        else:
            psi = min(self.psi, phi)
        tension = min(self.tension / factor, self._apex)
        return Joint(self.dip, self.c / factor, phi, psi, tension)


@dataclass(frozen=True, eq=False)
class JointedRock(Material):
    """Elastic rock with up to three sets of joints, in the plane.

    The rock between the joints does not yield. The joints are planes across the plane of the
    model: their traces are lines. In axial symmetry they are level.

    Parameters
    ----------
    E, nu : float
        Modulus and Poisson's ratio of the rock with its joints.
    joints : Joint, or several
        Sets of joints.

    Raises
    ------
    ValueError
        Parameters out of range, no joint, or more than three.

    Notes
    -----
    The rock does not stretch along its joints, so that few elements can slip as a whole: collapse
    loads and factors of safety converge slowly, and the error of their mesh is not known. Of a
    plane failure whose factor is 1.24 by hand 608 triangles found 1.58, 578 with sides along the
    plane 1.39, and 368 with a row of one thickness along it 1.23. A
    :class:`~skfem_contact.ContactPair` along a joint has no such error.

    Examples
    --------
    Rock whose joints dip by 60 degrees is crushed by 2 c / sin(120) along these:

    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> rock = sc.JointedRock(E=1e6, nu=.2, joints=sc.Joint(dip=60., c=50., phi=0.))
    >>> stress = np.zeros((4, 1))
    >>> strain = np.array([[.2e-3], [-1e-3], [0.], [0.]])
    >>> new = rock.update(strain, stress, np.zeros((1, 1))).stress[:, 0]
    >>> n = np.array([-np.sin(np.radians(60.)), np.cos(np.radians(60.))])
    >>> t = np.array([n[1], -n[0]])
    >>> sigma = np.array([[new[0], new[3]], [new[3], new[1]]])
    >>> f"{abs(t @ sigma @ n):.6f}"
    '50.000000'
    """

    E: float
    nu: float
    joints: Any

    internal = (Internal(PLASTIC_STRAIN),)

    def __post_init__(self) -> None:
        elastic = LinearElastic(self.E, self.nu)
        if isinstance(self.joints, Joint):
            given = (self.joints,)
        else:
            given = tuple(self.joints)
        if not 1 <= len(given) <= _MOST or not all(isinstance(one, Joint) for one in given):
            raise ValueError(
                f"JointedRock has one to {_MOST} sets of joints, sc.Joint(dip, c, phi), not "
                f"{self.joints!r}"
            )
        object.__setattr__(self, "joints", given)
        object.__setattr__(self, "E", float(elastic.E))
        object.__setattr__(self, "nu", float(elastic.nu))
        object.__setattr__(self, "_surfaces", _Surfaces.of(given, elastic.elasticity(4)))

    @property
    @override
    def symmetric(self) -> bool:
        return all(joint.psi == joint.phi for joint in self.joints)

    @property
    @override
    def slips_on_planes(self) -> bool:
        return True

    @property
    @override
    def axisymmetric(self) -> bool:
        return all(joint.dip % 180.0 == 0.0 for joint in self.joints)

    @property
    @override
    def dilates(self) -> bool:
        return any(joint.psi > 0.0 for joint in self.joints)

    @property
    @override
    def dilates_less(self) -> bool:
        return not self.symmetric

    @override
    def elasticity(
        self,
        ncomp: int,
        stress: Array | None = None,
        internal: Array | None = None,
    ) -> Array:
        return LinearElastic(self.E, self.nu).elasticity(ncomp)

    @override
    def reduced(self, factor: float, flow: Flow = "given") -> JointedRock:
        check_reduction(factor, flow, self)
        if flow not in ("given", "associated"):
            raise ValueError(f"flow '{flow}' is not for JointedRock: 'given' and 'associated' are")
        joints = tuple(joint.reduced(factor, flow == "associated") for joint in self.joints)
        return replace(self, joints=joints)

    @override
    def mobilised(self, stress: Array, internal: Array) -> tuple[Array, Array]:
        # shear and strength of the set that is nearest to its strength
        best: tuple[Array, Array] | None = None
        for joint in self.joints:
            normal, shear = _resolved(joint.dip)
            acts = np.abs(np.tensordot(shear, stress, 1))
            pressure = -np.tensordot(normal, stress, 1)
            limit = np.maximum(joint.c + pressure * np.tan(np.radians(joint.phi)), 0.0)
            if best is None:
                best = acts, limit
            else:
                more = acts * best[1] > best[0] * limit
                best = np.where(more, acts, best[0]), np.where(more, limit, best[1])
        assert best is not None
        return best

    @override
    def update(self, strain_increment: Array, stress: Array, internal: Array) -> Update:
        check_shapes(strain_increment, stress)
        if len(stress) != 4:
            raise ValueError("JointedRock is for plane bodies: its joints are lines in the plane")
        s: _Surfaces = self._surfaces  # type: ignore[attr-defined]
        trial = stress + np.tensordot(s.D, strain_increment, 1)
        flat = trial.reshape(4, -1)

        # Find the points outside of a surface, and their multipliers.
        excess = s.a @ flat - s.limit[:, None]  # (surfaces, points)
        scale = np.abs(flat).max(axis=0) + s.limit.max()
        tolerance = _ROUND_OFF * scale
        outside = (excess > tolerance).any(axis=0)
        points = np.flatnonzero(outside)
        new_internal = internal.copy()
        if not len(points):
            return Update(trial, new_internal, points, lambda: np.zeros((0, 4, 4)))
        active, multipliers = _solved(s.G, excess[:, points], tolerance[points])

        # Return the stresses, and add the plastic strains.
        flow = s.b.T @ multipliers  # (4, n)
        flat[:, points] -= s.D @ flow
        mean = flow[:3].mean(axis=0)
        normal = ((flow[:3] - mean) ** 2).sum(axis=0)
        deviator = normal + 0.5 * flow[3] ** 2
        new_internal.reshape(1, -1)[0, points] += np.sqrt(2.0 / 3.0 * deviator)

        def tangent() -> Array:
            result = np.tile((1.0 + _KEPT) * s.D, (len(points), 1, 1))
            for mask, where in _groups(active):
                # D - D b G^-1 a D with the active surfaces, and a little of D
                inverse = np.linalg.inv(s.G[np.ix_(mask, mask)])
                flow = s.D @ s.b[mask].T
                normals = s.a[mask] @ s.D
                result[where] -= flow @ inverse @ normals
            return result

        return Update(flat.reshape(trial.shape), new_internal, points, tangent)


@dataclass(frozen=True)
class _Surfaces:
    """Surfaces of all joints: a : sigma <= limit, with potentials b."""

    a: Array  # (m, 4)
    b: Array  # (m, 4)
    limit: Array  # (m,)
    D: Array  # (4, 4)
    G: Array  # (m, m)

    @classmethod
    def of(cls, joints: Iterable[Joint], D: Array) -> _Surfaces:
        """Return the surfaces of joints, three of each."""
        a = []
        b = []
        limit = []
        for joint in joints:
            normal, shear = _resolved(joint.dip)
            friction = np.tan(np.radians(joint.phi))
            dilatancy = np.tan(np.radians(joint.psi))
            a += [shear + friction * normal, -shear + friction * normal, normal]
            b += [shear + dilatancy * normal, -shear + dilatancy * normal, normal]
            limit += [joint.c, joint.c, joint.tension]
        normals = np.array(a)
        flows = np.array(b)
        return cls(normals, flows, np.array(limit), D, normals @ D @ flows.T)


def _resolved(dip: float) -> tuple[Array, Array]:
    """Return the factors of xx, yy, zz and xy in the normal and the shear stress of a plane."""
    s = np.sin(np.radians(dip))
    c = np.cos(np.radians(dip))
    normal = np.array([s * s, c * c, 0.0, -2.0 * s * c])
    shear = np.array([-s * c, s * c, 0.0, c * c - s * s])
    return normal, shear


def _groups(active: NDArray[np.bool_]) -> Iterable[tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """Yield the active surfaces and the points of each set, from masks (surfaces, points)."""
    masks, number = np.unique(active, axis=1, return_inverse=True)
    for k in range(masks.shape[1]):
        yield np.flatnonzero(masks[:, k]), np.flatnonzero(number.ravel() == k)


def _solved(G: Array, excess: Array, slack: Array) -> tuple[NDArray[np.bool_], Array]:
    """Return active surfaces and multipliers, (surfaces, points) each.

    At most three surfaces act at a point, for the plane has three stresses: all sets are tried,
    small ones first.
    """
    m, n = excess.shape
    active = np.zeros((m, n), bool)
    multipliers = np.zeros((m, n))
    left = np.arange(n)
    # Try one active surface first, then two, then three, at the points that are left.
    sets = chain.from_iterable(combinations(range(m), k) for k in (1, 2, 3))
    for chosen in sets:
        own = np.array(chosen)
        block = G[np.ix_(own, own)]
        # Parallel surfaces are active one at a time.
        if np.linalg.cond(block) > _SINGULAR:
            continue
        # Multipliers are positive, and other surfaces are not exceeded.
        found: Array = np.linalg.solve(block, excess[np.ix_(own, left)])
        rest = excess[:, left] - G[:, own] @ found
        fits = (found >= 0.0).all(axis=0) & (rest <= slack[left]).all(axis=0)
        points = left[fits]
        active[np.ix_(own, points)] = True
        multipliers[np.ix_(own, points)] = found[:, fits]
        left = left[~fits]
        if not len(left):
            return active, multipliers
    raise IncrementTooLarge(
        f"{len(left)} points of JointedRock have no admissible stress for this increment"
    )
