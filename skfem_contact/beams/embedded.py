"""Beams embedded in the ground: nails, rows of piles, and the grouted bodies of anchors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from copy import copy
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.sparse import bsr_matrix, coo_matrix, csr_matrix, hstack, kron
from skfem import CellBasis, Mesh, MeshQuad1, MeshQuad2, MeshTri1, MeshTri2
from typing_extensions import override

from ..arrays import left_of, quotient, row_norms
from ..checks import check_basis, finite, format_point, is_number, positive
from ..forms.base import Form, Forms, Outputs, Response, counted
from ..forms.roles import Couples, Regularised, Staged
from ..layout import Field
from ..sparse import constant
from .element import across, shapes
from .nodes import BeamNodes, stiffest

#: Points of an element where the skin acts, and their weights: Gauss points of beams.
_GAUSS = np.polynomial.legendre.leggauss(3)
#: ... nodes of reinforcement, which then moves across with the ground: at Gauss points springs
#: across resisted without limit where a slope slid past a nail.
_NODES = (np.array([-1.0, 0.0, 1.0]), np.array([1.0, 4.0, 1.0]) / 3.0)
#: Values of a function in the length of a point: a jump between them errs by .5 % of this length.
_SAMPLES = 100
#: Stiffness of the skin by default, over the shear modulus of the ground and the length of the
#: beam's elements: the settlement of a pile of 10 m under 0.4 of its limit falls by 3 % from 10 to
#: 87.
_STIFF = 10.0
#: ... in space, over the shear modulus. A pile of 25 diameters settles by 9.04 and 9.05 mm in
#: elements of 4 and 2 diameters, a solid one by 9.32 mm; at a line 10.6 and 12.2 mm.
_STIFF_IN_SPACE = 1e3
#: Number of points on the circle about a beam in space.
_ON_CIRCLE = 16
#: Share of its stiffness that a slipping skin keeps in the tangent, as the only support of a beam
#: that is pulled out.
_KEPT = 1e-6
#: ... and in the damped tangent: with 1e-6 nails of 1 kN/m in a slope of 8 m find no equilibrium,
#: with 1e-4 a search takes 267 iterations, with 1e-3 122, with 1e-2 167.
_DAMPED = 1e-3
#: Share of a node in the displacement of a point up to which it lies on a side without this node.
_ON_SIDE = 1e-9


@dataclass(frozen=True)
class EmbeddedState:
    """State of an embedded beam, of one member.

    Attributes
    ----------
    skin
        Force per length along the beam that the ground exerts on it at the points, (n,).
    free
        Displacements of the ground against the beam without force, (n, dim).
    foot
        Force on the foot, negative in compression, and displacement without force, (2,).
    """

    skin: ndarray
    free: ndarray
    foot: ndarray


class Embedded(Form, Couples, Staged, Regularised):
    """Skin and foot of a beam inside the elements of the ground, whose mesh does not know the beam.

    Springs join the beam to the ground at three points of each of its elements. Along the beam they
    yield at ``T_max``, across a beam at ``p_max``: by default they are elastic across, so that no
    ground flows between the members of a row. Across :class:`~skfem_contact.Reinforcement` they
    have no force.

    Parameters
    ----------
    basis
        ``Basis`` of the ground.
    beam
        Beam or :class:`~skfem_contact.Reinforcement` with nodes of its own; its `spacing` is the
        distance of the members.
    T_max
        Skin resistance of one member per length: a number, or a function of the distances from the
        start of the beam, (n,), which may jump anywhere.
    F_max
        Resistance of the foot, the end of the beam, against compression; by default none.
    stiffness
        Stiffness of the skin of one member: force per length and displacement. By default 10 times
        the shear modulus of the stiffest ground, times `spacing`, over the length of the beam's
        elements.
    radius
        Radius of a beam in space. The ground moves with the beam on the mean over a circle: the
        shaft, or half an element wide where this is more; springs stand for the ground in
        between. The beam replaces ground: take ``EA = (E_beam - E_soil) * area``. A mesh that is
        cut along the axis has a half or a quarter of the beam, whose stiffnesses and resistances
        are given.
    p_max
        Largest lateral resistance of the ground on one member per length, in space of the
        resultant: a number, or a function of the distances from the start of the beam. By default
        none is reached.

    Raises
    ------
    ValueError
        A beam that is bonded or leaves the mesh, resistances or a stiffness that are negative, a
        beam in space without radius, a lateral resistance of reinforcement.

    Notes
    -----
    Where the ground of a point is deactivated, as in a pit, the beam is free: the point has no
    force from then on.

    ``stage.table(name)`` has the columns of :class:`~skfem_contact.PileSprings`: deflections of the
    beam and resistances of the ground, positive with the deflection, of one member per length, and
    the `share` of the limit. The kinds are "p" to the left of the beam's direction, in space "px",
    "py" and "pz", "t" along the beam, and "q", the force on the foot.

    Strength reduction leaves `T_max`, `p_max` and `F_max` as they are; `bounds` refuses embedded
    beams. In
    the plane the settlement grows with the logarithm of the mesh size, as under a line load. In
    space it is too small: by 3 % beside a solid pile of 25 diameters, and by 5 % beside Mindlin's
    solution for forces in a half-space, on coarse and fine meshes alike.

    Examples
    --------
    A nail of 4 m with a skin resistance of 15 kN/m is pulled out by 60 kN:

    >>> import numpy as np
    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> mesh = MeshTri.init_tensor(np.linspace(0, 6, 7), np.linspace(0, 3, 4)).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    >>> nail = sc.Beam(None, np.linspace((.3, 1.6), (4.3, 1.6), 5), EI=10., EA=1e5)
    >>> forms = {"soil": sc.SolidForm(basis, sc.LinearElastic(E=3e4, nu=.3)), "nail": nail}
    >>> forms["skin"] = sc.Embedded(basis, nail, T_max=15.)
    >>> model = sc.Model(forms, basis.get_dofs("bottom").all())
    >>> pull = model.forms["nail"].load((-1., 0.), at=(.3, 1.6))
    >>> f"{model.limit_load(pull, step=20., progress=False).multiplier:.2f}"
    '60.00'
    """

    kinematics = "small"

    symmetric = unilateral = True
    _k: ndarray
    _across: ndarray
    _at_foot: float
    _dofs: ndarray
    #: Active set and stiffness of the last iteration, by the share that slipping points keep.
    _known: dict[float, tuple[bytes, csr_matrix]]
    _same = ("_where", "_given", "radius")
    _brought = ("parameters", "T_max", "F_max", "p_max")

    def __init__(
        self,
        basis: CellBasis,
        beam: BeamNodes,
        T_max: float | Callable[[ndarray], ArrayLike],
        F_max: float = 0.0,
        stiffness: float | None = None,
        radius: float | None = None,
        p_max: float | Callable[[ndarray], ArrayLike] | None = None,
    ) -> None:
        # Check the input
        check_basis(basis)
        dim = beam.dim
        if dim != basis.mesh.dim():
            raise ValueError(f"the beam has {dim} coordinates, the ground {basis.mesh.dim()}")
        if dim == 2:
            known = radius is None
        else:
            known = is_number(radius, 0.0, np.inf)
        if not known:
            raise ValueError(
                f"a beam in space, and no other, has a radius, not {radius!r}: beside a line the "
                f"ground moves without bounds as the mesh becomes finer"
            )
        if beam.shared is not None:
            raise ValueError(
                "the beam is bonded to the ground along a line: embed one with nodes of its own"
            )
        if not is_number(F_max, -1e-300, np.inf):
            raise ValueError(f"F_max must not be negative, not {F_max!r}")
        # The beam must be stiffer than the ground inside of it, which `completed` checks.
        self.coordinates = "plane" if dim == 2 else "space"
        self.radius = radius
        self.borrowed = (beam.displacement,)
        self._spacing = beam.spacing
        self._replacing = beam.parameters["EA"]
        self._given = None
        if stiffness is not None:
            self._given = positive(stiffness, "stiffness")

        # Find the points and the resistances at each of them
        self.positions, points, self._along, self._weight, of_beam = _points(beam)
        self._points = points
        self._where = points[:-1]
        self._lengths = self._weight.reshape(len(beam.cells), -1).sum(axis=1)
        self._bends = _has_rotations(beam)
        skin = _limit(T_max, self._weight, "T_max", "a skin resistance")
        lateral = np.array(np.inf)
        if p_max is not None:
            lateral = _limit(p_max, self._weight, "p_max", "a lateral resistance")
            if not self._bends:
                raise ValueError("reinforcement has no lateral resistance: leave out p_max")
        self.T_max = np.broadcast_to(skin, len(self.positions))
        self.p_max = np.broadcast_to(lateral, len(self.positions))
        self.F_max = float(F_max)
        self.parameters = {
            "T_max": skin[()],
            "F_max": float(F_max),
            "radius": radius,
            "p_max": lateral[()],
        }

        # Displacements of the ground less displacements of the beam at the points and the foot
        if radius is None:
            of_ground, elements = _values_at(basis, points)
            self._within = _Within(np.arange(len(points)), elements)
        else:
            self._wide = np.maximum(radius, 0.5 * _sizes(basis, points, self._along))
            of_ground, self._part, self._within = _around(basis, points, self._along, self._wide)
        self._ground = np.unique(of_ground.indices)
        self._jump = csr_matrix(hstack((of_ground[:, self._ground], -of_beam)))
        self._away = np.zeros(len(points), bool)
        self._transposed = csr_matrix(self._jump.T)  # of forces at points
        self._magnitudes = abs(self._transposed)
        self.joins = np.zeros(0, int)
        self.acts_on = self.changing = self._ground

    @override
    def completed(self, forms: Forms) -> Embedded:
        C = stiffest(forms)
        if C is None and (self._given is None or self.radius is not None):
            raise ValueError("an embedded beam needs ground: a SolidForm among the forms")
        # In the plane the springs are stiff beside the ground.
        new = copy(self)
        new._known = {}
        if C is None or self.radius is None:
            G = 0.0 if C is None else C[-1, -1]
            length = float(np.median(self._lengths))
            k = self._given or _STIFF * G * self._spacing / length
            new._k = new._across = np.full(len(self.positions), k)
            new._at_foot = k * self._lengths[-1]
            return new

        # In space the ground between the shaft and the circle acts as springs in series
        G = C[-1, -1]
        nu = C[0, 1] / (C[0, 0] + C[0, 1])
        k = self._given or _STIFF_IN_SPACE * G
        between = np.log(self._wide[:-1] / self.radius) / (2.0 * np.pi * G)
        across = (3.0 - 4.0 * nu) / (4.0 - 4.0 * nu)
        new._k = self._part[:-1] / (1.0 / k + between)
        new._across = self._part[:-1] / (1.0 / k + across * between)
        nearer = 1.0 / self.radius - 1.0 / self._wide[-1]
        base = (1.0 - nu) / (4.0 * G) * nearer
        tip = 1.0 / (k * self._lengths[-1])
        new._at_foot = self._part[-1] / (tip + base)

        # The beam must be stiffer than the ground that it replaces
        E = 2.0 * (1.0 + nu) * G
        own = E * np.pi * self.radius**2 * float(self._part.mean())
        if own > self._replacing:
            raise ValueError(
                f"EA={self._replacing:g} of the embedded beam is less than that of the ground it "
                f"replaces, {own:g}: check units, and that `radius` is that of the shaft"
            )
        return new

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> Embedded:
        new = copy(self)
        new._dofs = np.concatenate((self._ground, numbers[self.borrowed[0]]))
        new.acts_on = new.changing = new._dofs
        return new

    @override
    def let_go(self, inactive: ndarray, gone: ndarray) -> Embedded:
        # Find the points, and the foot, with a probe all of whose elements are gone.
        point, elements = self._within
        remains = np.ones(elements.shape[1])
        remains[gone] = 0.0
        away = np.bincount(point, elements @ remains == 0.0, len(self._along)) > 0.0
        back = self._away & ~away
        if back.any():
            raise ValueError(
                f"ground returns to the beam at {format_point(self._points[back][0])}: deactivate "
                "this form, and activate another Embedded of the same beam, which begins without "
                "force"
            )
        without = np.intersect1d(self._ground, inactive)
        if not away.any() and not len(without):
            return self

        # Points without ground have no force.
        new = copy(self)
        new._known = {}
        new._away = away
        new.T_max = np.where(away[:-1], 0.0, self.T_max)
        new.p_max = np.where(away[:-1], 0.0, self.p_max)
        new._weight = np.where(away[:-1], 0.0, self._weight)
        new.F_max = 0.0 if away[-1] else self.F_max
        new.acts_on = np.setdiff1d(self._dofs, without)
        return new

    def __repr__(self) -> str:
        low = self.T_max.min()
        high = self.T_max.max()
        return f"<Embedded {self._lengths.sum():.4g} long, T_max {low:.4g} to {high:.4g}>"

    def _jumps(self, x: ndarray) -> tuple[ndarray, float]:
        """Return ground less beam displacements, (n, dim), and along it at the foot."""
        jump = (self._jump @ x[self._dofs]).reshape(len(self._along), -1)
        return jump[:-1], float(jump[-1] @ self._along[-1])

    @override
    def initial_state(self, x: ndarray | None = None) -> EmbeddedState:
        n = len(self.positions)
        if x is None:
            return EmbeddedState(np.zeros(n), np.zeros(self._where.shape), np.zeros(2))
        jump, foot = self._jumps(x)
        return EmbeddedState(np.zeros(n), jump, np.array([0.0, foot]))

    @override
    def assemble(self, x: ndarray, state: EmbeddedState) -> Response:
        # Skin: a spring k along the beam, which slips at T_max
        jump, foot = self._jumps(x)
        t = self._along[:-1]
        moved = jump - state.free
        slip = (moved * t).sum(axis=1)
        elastic = self._k * slip
        skin = np.clip(elastic, -self.T_max, self.T_max)
        slips = skin != elastic

        # Springs across, p = k u, in the direction of u where they flow at p_max
        lateral = moved - slip[:, None] * t
        trial = self._across[:, None] * lateral
        size = row_norms(trial)
        flows = size > self.p_max
        share = np.where(flows, self.p_max / np.where(flows, size, 1.0), 1.0)
        across = share[:, None] * trial
        pushes = trial / np.where(size > 0.0, size, 1.0)[:, None]

        # Foot: a spring in compression alone, which is crushed at F_max
        t_foot = self._along[-1]
        thrust = self._at_foot * (foot - state.foot[1])
        force = np.clip(thrust, -self.F_max, 0.0)
        stands = thrust == force and self.F_max > 0.0
        crushed = thrust < force

        # Forces on the ground, and opposite ones on the beam.
        q = (across + skin[:, None] * t) * self._weight[:, None]
        forces = np.append(q, force * t_foot) / self._spacing

        def after() -> EmbeddedState:
            free = state.free + (slip - skin / self._k)[:, None] * t
            free += (1.0 - share)[:, None] * lateral
            free_foot = state.foot[1]
            if crushed:
                free_foot = foot - force / self._at_foot
            return EmbeddedState(skin, free, np.array([force, free_foot]))

        limits = _AtLimit(slips, flows, stands, share, pushes)
        return Response(
            self._transposed @ forces,
            after,
            lambda: self._tangent(limits, _KEPT),
            lambda: self._tangent(limits, _DAMPED),
            active=limits.key,
            measure=self._magnitudes @ abs(forces),
            dofs=self._dofs,
        )

    def _tangent(self, limits: _AtLimit, kept: float) -> csr_matrix:
        """Return the stiffness, of which points at a limit or a foot without force keep a share.

        It is known where the last iteration had the same ones. In space lateral resistances at
        their limit turn with the displacement.
        """
        turns = len(self._along[0]) == 3 and bool(limits.flows.any())
        known = self._known.get(kept)
        if not turns and known is not None and known[0] == limits.key:
            return known[1]

        # Springs along the beam and across it, and of the foot
        t = self._along[:-1]
        t_foot = self._along[-1]
        tt = t[:, :, None] * t[:, None]  # (n, dim, dim)
        along = np.where(limits.slips, kept, 1.0) * self._k
        m = limits.pushes
        flows = np.where(limits.flows, 1.0, 0.0)
        mm = flows[:, None, None] * m[:, :, None] * m[:, None]
        turned = (limits.share * self._across)[:, None, None]
        pushed = (kept * self._across)[:, None, None]
        beside = np.eye(t.shape[1]) - tt - mm
        skin = turned * beside + pushed * mm + along[:, None, None] * tt
        skin = self._weight[:, None, None] * skin
        at_foot = self._at_foot * (1.0 if limits.stands else kept)
        foot = at_foot * np.outer(t_foot, t_foot)
        blocks = np.concatenate((skin, foot[None])) / self._spacing

        # K = J' D J with the jumps J
        n = np.arange(len(blocks))
        D = bsr_matrix((blocks, n, np.append(n, len(n)))).tocsr()
        K = csr_matrix(self._transposed @ D @ self._jump)
        K.sum_duplicates()
        self._known[kept] = limits.key, constant(K)
        return K

    @override
    def rebased(self, x: ndarray, state: EmbeddedState) -> EmbeddedState:
        jump, foot = self._jumps(x)
        return EmbeddedState(state.skin, state.free - jump, state.foot - [0.0, foot])

    @override
    def outputs(self, x: ndarray, state: EmbeddedState) -> Outputs:
        def summary() -> str:
            text = f"skin up to {self._used(state).max():.0%} of its resistance"
            if np.isfinite(self.p_max).any():
                size = row_norms(self._lateral(x, state))
                text += f", ground across up to {quotient(size, self.p_max).max():.0%}"
            return f"{text}, foot {state.foot[0]:.4g}"

        return Outputs(
            summary=summary,
            parameters=self.parameters,
            members=lambda: self._members(x, state),
            yielding=lambda before: counted((before.free != state.free).any(axis=1)),
        )

    def _used(self, state: EmbeddedState) -> ndarray:
        return quotient(abs(state.skin), self.T_max)

    def _lateral(self, x: ndarray, state: EmbeddedState) -> ndarray:
        """Return the forces across the beam that the ground exerts on it, (n, dim)."""
        t = self._along[:-1]
        moved = self._jumps(x)[0] - state.free
        along = (moved * t).sum(axis=1)
        return np.asarray(self._across[:, None] * (moved - along[:, None] * t))

    def _members(self, x: ndarray, state: EmbeddedState) -> dict[str, ndarray]:
        # Displacements of the beam at the points and the foot
        beam = len(self._ground)
        of_beam = x[self._dofs[beam:]]
        moved = -(self._jump[:, beam:] @ of_beam)
        moved = moved.reshape(self._along.shape)
        along = (moved * self._along).sum(axis=1)
        n = len(self.positions)
        points = np.arange(n)

        # Rows of each kind: points, deflections, resistances and shares of the limit
        rows = [("t", points, along[:-1], -state.skin, self._used(state))]
        if self._bends:
            forces = self._lateral(x, state)
            used = quotient(row_norms(forces), self.p_max)
            lateral = (moved - along[:, None] * self._along)[:-1]
            directions = {f"p{axis}": direction for axis, direction in zip("xyz", np.eye(3))}
            if self._along.shape[1] == 2:
                left = left_of(self._along[:-1])
                directions = {"p": left}
            across = []
            for kind, to in directions.items():
                deflection = (lateral * to).sum(axis=1)
                resistance = -(forces * to).sum(axis=1)
                across.append((kind, points, deflection, resistance, used))
            rows = across + rows
        if self.F_max > 0.0:
            bears = -state.foot[:1]
            rows.append(("q", np.array([n]), along[-1:], bears, bears / self.F_max))

        kinds, numbers, deflections, resistances, shares = zip(*rows)
        at = np.concatenate(numbers)
        counts = [len(part) for part in numbers]
        positions = np.append(self.positions, self._lengths.sum())
        return {
            "kind": np.repeat(kinds, counts),
            "position": positions[at],
            **dict(zip("xyz", self._points[at].T)),
            "deflection": np.concatenate(deflections),
            "resistance": np.concatenate(resistances),
            "share": np.concatenate(shares),
        }


class _AtLimit(NamedTuple):
    """Points of an iteration whose springs are at their limits.

    Attributes
    ----------
    slips, flows
        Points that slip along the beam and flow across it, (n,).
    stands
        True if the foot is elastic.
    share
        Lateral forces over elastic ones, (n,).
    pushes
        Directions of the lateral forces, (n, dim).
    """

    slips: ndarray
    flows: ndarray
    stands: bool
    share: ndarray
    pushes: ndarray

    @property
    def key(self) -> bytes:
        """The points as bytes."""
        return self.slips.tobytes() + self.flows.tobytes() + bytes([int(self.stands)])


def _limit(
    values: float | Callable[[ndarray], ArrayLike], lengths: ndarray, name: str, what: str
) -> ndarray:
    """Return a resistance at points that stand for lengths one after the other, () or (n,).

    A function counts with its mean over each length, wherever it jumps.
    """
    if callable(values):
        within = (np.arange(_SAMPLES) + 0.5) / _SAMPLES - 1.0
        distances = np.cumsum(lengths)[:, None] + within * lengths[:, None]
        given = values(distances.ravel())
    else:
        given = values
    limit = finite(given, name)
    if limit.shape not in ((), (lengths.size * _SAMPLES,)) or not (limit >= 0.0).all():
        raise ValueError(
            f"{name} must be {what} that is finite and not negative, or a function of the "
            f"distances, (n,), not {values!r}"
        )
    if limit.ndim == 0:
        return limit
    return np.asarray(limit.reshape(-1, _SAMPLES).mean(axis=1))


def _has_rotations(beam: BeamNodes) -> bool:
    """Return whether a beam bends."""
    return any(field.kind == "rotation" for field in beam.fields)


def _points(beam: BeamNodes) -> tuple[ndarray, ndarray, ndarray, ndarray, csr_matrix]:
    """Return distances and lengths at the points, (n,), and for these and the foot the rest.

    The rest are coordinates and tangents, (n + 1, dim), and displacements by the dofs of the beam.
    """
    # Interpolate at the points of all elements, (m, points, ...), and at the foot
    corners = beam.points[beam.cells]
    xi, weight = _NODES
    if _has_rotations(beam):
        xi, weight = _GAUSS
    # Points of contact with the ground, and the foot.
    N = np.array([shapes(point)[0] for point in xi])
    dN = np.array([shapes(point)[1] for point in xi])
    N_foot, dN_foot = shapes(1.0)
    tangents = np.einsum("qk,mkc->mqc", dN, corners)
    at_foot = np.einsum("k,kc->c", dN_foot, corners[-1])
    t = np.vstack((tangents.reshape(-1, beam.dim), at_foot))
    t /= row_norms(t)[:, None]
    along = np.tile(N, (len(corners), 1))
    values = np.vstack((along, N_foot))
    cells = np.repeat(beam.cells, len(xi), axis=0)
    cells = np.vstack((cells, beam.cells[-1]))
    points = np.einsum("pk,pkc->pc", values, beam.points[cells])

    # Measure lengths along the beam
    weights = weight * np.linalg.norm(tangents, axis=2)
    lengths = weights.sum(axis=1)
    begin = np.cumsum(lengths) - lengths
    share = 0.5 * (1.0 + xi)
    s = begin[:, None] + share * lengths[:, None]

    # Interpolate the displacements of the beam
    rows = np.arange(len(values))
    row = np.repeat(rows, values.shape[1])
    shape = (len(values), len(beam.points))
    of_beam = coo_matrix((values.ravel(), (row, cells.ravel())), shape)
    return s.ravel(), points, t, weights.ravel(), _by_component(of_beam, beam.dim)


def _by_component(matrix: coo_matrix, dim: int) -> csr_matrix:
    """Return the matrix that acts on each component of vectors as this one on scalars."""
    return csr_matrix(kron(matrix, np.eye(dim)))


class _Within(NamedTuple):
    """Points of the beam of probes, (n,), and True for the elements at them, (n, n_elements)."""

    point: ndarray
    elements: csr_matrix


def _values_at(basis: CellBasis, probes: ndarray) -> tuple[csr_matrix, csr_matrix]:
    """Return displacements of the ground at probes, (dim n, N), and elements, (n, n_elements)."""
    scalar = basis.with_element(basis.elem.elem)
    try:
        values = _probes(scalar, probes)
    except ValueError:
        outside = _elements_at(basis.mesh, probes) < 0
        if outside.any():
            raise _leaving(probes[outside]) from None
        raise
    # Elements have all nodes that move a probe: on their sides those of the side alone.
    moving = csr_matrix(abs(values.tocsr()) > _ON_SIDE, dtype=float)
    nodes = scalar.dofs.element_dofs
    number = np.tile(np.arange(nodes.shape[1]), len(nodes))
    shape = (scalar.N, nodes.shape[1])
    of_elements = csr_matrix((np.ones(nodes.size), (nodes.ravel(), number)), shape)
    common = (moving @ of_elements).tocoo()
    whole = common.data == np.diff(moving.indptr)[common.row]
    there = csr_matrix((whole, common.coords), common.shape)
    return _by_component(values, basis.mesh.dim()), there


def _leaving(points: ndarray) -> ValueError:
    return ValueError(
        f"the embedded beam leaves the mesh at {format_point(points[0])}: make the part outside a "
        "beam of its own, which this one is joined_to"
    )


def _probes(basis: CellBasis, points: ndarray) -> coo_matrix:
    """Return the values of a scalar field at points, (n, N), also in elements of second order.

    Elements with a curved side are found by its chord: between the two their values continue.
    """
    # Local coordinates of the points in their elements.
    cells = _finder(basis.mesh)(*points.T)
    local = basis.mapping.invF(points.T[:, :, None], tind=cells)
    # Values of the shape functions there.
    values = []
    for k in range(basis.Nbfun):
        field = basis.elem.gbasis(basis.mapping, local, k, tind=cells)[0]
        values.append(field.value.ravel())
    row = np.tile(np.arange(len(points)), basis.Nbfun)
    column = basis.dofs.element_dofs[:, cells].ravel()
    shape = (len(points), basis.N)
    return coo_matrix((np.concatenate(values), (row, column)), shape)


def _finder(mesh: Mesh) -> Callable[..., ndarray]:
    """Return the function that finds the elements at coordinates, by the chords of curved sides."""
    if isinstance(mesh, MeshTri2):
        mesh = MeshTri1.from_mesh(mesh)
    elif isinstance(mesh, MeshQuad2):
        mesh = MeshQuad1.from_mesh(mesh)
    return mesh.element_finder()


def _elements_at(mesh: Mesh, points: ndarray) -> ndarray:
    """Return the numbers of the elements at points, (n,); -1 outside of the mesh."""
    finder = _finder(mesh)
    elements = np.full(len(points), -1)
    for k, point in enumerate(points):
        with suppress(ValueError):
            elements[k] = finder(*point[:, None])[0]
    return elements


def _sizes(basis: CellBasis, points: ndarray, along: ndarray) -> ndarray:
    """Return the sizes across the beam of the elements at points, (n,)."""
    mesh = basis.mesh
    elements = _elements_at(mesh, points)
    if (elements < 0).any():
        raise _leaving(points[elements < 0])
    # The scatter of their corners across the beam: of a box twice that is its longer side.
    corners = mesh.p[:, mesh.t[:, elements]].transpose(2, 1, 0)  # (n, corners, 3)
    axes = np.stack(across(along), axis=1)
    away = corners - corners.mean(axis=1, keepdims=True)
    away = np.einsum("nkc,nac->nka", away, axes)
    scatter = np.einsum("nka,nkb->nab", away, away) / corners.shape[1]
    return 2.0 * np.sqrt(np.linalg.eigvalsh(scatter)[:, -1])


def _around(
    basis: CellBasis,
    points: ndarray,
    along: ndarray,
    radius: ndarray,
) -> tuple[csr_matrix, ndarray, _Within]:
    """Return mean displacements over circles about points, (3 n, N), their parts, and elements.

    Points of a circle that lie outside of the mesh are left out: it is then cut along a plane of
    symmetry.
    """
    # Take points on the circles
    first, second = across(along)
    angle = 2.0 * np.pi * (np.arange(_ON_CIRCLE) + 0.5) / _ON_CIRCLE
    cos = np.cos(angle)[:, None]
    sin = np.sin(angle)[:, None]
    arm = cos * first[:, None] + sin * second[:, None]  # (n, points, 3)
    rim = points[:, None] + radius[:, None, None] * arm
    elements = _elements_at(basis.mesh, rim.reshape(-1, 3))
    inside = elements.reshape(rim.shape[:2]) >= 0
    outside = ~inside.any(axis=1)
    if outside.any():
        raise _leaving(points[outside])

    # Average the displacements of the points inside
    share = (inside / inside.sum(axis=1, keepdims=True))[inside]
    row = np.nonzero(inside)[0]
    column = np.arange(len(share))
    mean = coo_matrix((share, (row, column)), shape=(len(points), len(share)))
    values, there = _values_at(basis, rim[inside])
    means = csr_matrix(_by_component(mean, 3) @ values)
    return means, inside.mean(axis=1), _Within(row, there)
