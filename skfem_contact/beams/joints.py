"""Joints of beams: dofs that the nodes of several beams have in common, and mechanisms that are
left.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csc_matrix, eye_array
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

from ..checks import format_point
from ..errors import Remark
from ..layout import Field, FieldDofs
from .nodes import AT

#: Squared strain of a motion, relative to the largest one, below which it is none: that of a chain
#: of n elements is about n**-4, that of a mechanism 1e-16.
_NO_STRAIN = 1e-13

#: Shares of start, end and middle of an element in a uniform load, and how many times the median of
#: the line load that on a node may be without being that of a single force.
_OF_LENGTH, _SINGLE = np.array([1.0, 1.0, 4.0]) / 6.0, 3.0
#: Share by which a beam bonded to a line in space may move more in the next mesh without a remark:
#: 2 % along the corner of a quarter of the ground, which moves four times as much as the ground all
#: around that the formula is for.
_TOLD = 0.005
#: Cosine of the angle between a beam and the direction in which its end is held, in a plane of
#: symmetry.
_ALONG = 0.99
#: Dofs that a field takes: pairs of indices and of what they are.
Taken = tuple[tuple[ndarray, Any], ...]


def rotations_of(points: ndarray, cells: ndarray, hinges: ndarray, joined: ndarray) -> ndarray:
    """Return numbers of the rotations of the elements' nodes, (m, 3): beyond a hinge another
    one.
    """
    turn, last = cells.copy(), len(points)
    for node in hinges:
        met = np.argwhere(cells[:, :2] == node)
        if len(met) < (1 if node in joined else 2):
            raise ValueError(f"no elements meet at the hinge at {format_point(points[node])}")
        for k, end in met[1:]:
            turn[k, end], last = last, last + 1
    return turn


def taken_by(
    points: ndarray, bonded: bool, hinges: ndarray, others: Sequence[Any]
) -> tuple[Taken, Taken, ndarray]:
    """Return the displacements and the rotations that nodes (n, dim) take from other beams, and
    these nodes.

    Nodes at hinges keep their rotations, and those of a bonded beam their displacements.
    """
    dim = points.shape[1]
    owners: dict[int, Any] = {}
    moves: list[tuple[ndarray, Any]] = []
    turned: list[tuple[ndarray, Any]] = []
    for other in others:
        if other.points.shape[1] != dim:
            raise ValueError(
                f"a beam with {dim} coordinates is joined to beams with as many, not to {other!r}"
            )
        if bonded and other._shared is None:
            raise ValueError("a bonded beam moves with the ground: join the other beam to it")
        here, there = _common(points, other.points)
        known = [_owner(other, int(node)) for node in there]
        wrong = [
            k
            for k, owner in zip(here.tolist(), known, strict=True)
            if owners.get(k, owner) != owner
        ]
        if wrong:
            raise ValueError(
                f"beams in `joined_to` meet at {format_point(points[wrong[0]])}, but are not "
                f"joined to "
                "each other"
            )
        new = np.array([k not in owners for k in here.tolist()])
        owners.update(zip(here.tolist(), known, strict=True))
        if not bonded:
            moves.append(_pair(here[new], there[new], dim, other._displacement, other._shared))
        new &= ~np.isin(here, hinges)
        turned.append(_pair(here[new], there[new], 1 if dim == 2 else 3, other._rotation, None))
    return tuple(moves), tuple(turned), np.array(list(owners), int)


def _common(points: ndarray, others: ndarray) -> tuple[ndarray, ndarray]:
    """Return the numbers of points that lie on other ones, and the numbers of these, (n,) each."""
    distance, there = map(np.asarray, cKDTree(others).query(points))
    here = np.flatnonzero(
        distance <= AT * max(np.ptp(points, axis=0).max(), np.ptp(others, axis=0).max())
    )
    if not len(here):
        k = int(np.argmin(distance))
        raise ValueError(
            "the beam has no node in common with a beam that it is joined to; the nearest ones are "
            "at "
            f"{format_point(points[k])} and {format_point(others[there[k]])}"
        )
    return here, there[here]


def _owner(beam: Any, node: int) -> Any:
    """Return the field and the index, or the number in the basis, of a node's first
    displacement.
    """
    if beam._shared is not None:
        return int(beam._shared[node, 0])
    field, index = beam._displacement, beam.points.shape[1] * node
    while found := [(at.tolist().index(index), other) for at, other in field.taken if index in at]:
        here, other = found[0]
        if not isinstance(other, FieldDofs):
            return int(other[here])
        field, index = other.field, int(other.indices[here])
    return field.key, index


def _pair(
    here: ndarray, there: ndarray, k: int, field: Field, ground: ndarray | None
) -> tuple[ndarray, Any]:
    """Return the indices of k dofs of nodes, and the dofs of the nodes of another beam that they
    are.
    """
    at, dofs = ((k * nodes[:, None] + np.arange(k)).ravel() for nodes in (here, there))
    return at, FieldDofs(field, dofs) if ground is None else ground[there].ravel()


def frame_of(beam: Any, forms: Mapping[str, Any]) -> tuple[list[Any], list[Field]]:
    """Return a beam with those among the forms that are joined to it, and fields of theirs that
    other forms act on.

    There are no beams where a form may act on any dof: nobody knows what it holds.
    """
    beams = [form for form in forms.values() if isinstance(form, type(beam))]
    others = [form for form in forms.values() if form not in beams]
    if any(
        f.basis is None and f.law is None and f.size is None and not (f.borrowed or f.fields)
        for f in others
    ):
        return [], []
    frame = [beam]
    while more := [b for b in beams if b not in frame and any(_linked(a, b) for a in frame)]:
        frame += more
    touched = {field for form in others for field in form.borrowed}
    return frame, [field for b in frame for field in b.fields if field in touched]


def _linked(a: Any, b: Any) -> bool:
    """Return True if one of two beams takes dofs of the other."""
    return any(
        other.field in two.fields
        for one, two in ((a, b), (b, a))
        for field in one.fields
        for _, other in field.taken
        if isinstance(other, FieldDofs)
    )


def loose_dof(parts: Sequence[tuple[ndarray, ndarray]], stiff: ndarray) -> int | None:
    """Return the dof that moves most in a motion without strain, or None if there is none.

    Parts are strains of elements, (m, q, n), and their dofs, (m, n); dofs that are stiff do not
    move.
    """
    dofs, rows = np.unique(np.concatenate([rows for _, rows in parts]), return_inverse=True)
    strains = np.concatenate([strains for strains, _ in parts])
    size = np.linalg.norm(strains, axis=2, keepdims=True)
    blocks = strains / np.where(size > 0.0, size, 1.0)
    row = np.broadcast_to(
        np.arange(blocks[..., 0].size).reshape(*blocks.shape[:2], 1), blocks.shape
    )
    column = np.broadcast_to(rows.reshape(len(strains), 1, -1), blocks.shape)
    free = np.flatnonzero(~np.isin(dofs, stiff))
    B = coo_matrix(
        (blocks.ravel(), (row.ravel(), column.ravel())), shape=(row.max() + 1, len(dofs))
    ).tocsc()[:, free]
    if not len(free):
        return None
    K = csc_matrix(B.T @ B)
    solve = splu(csc_matrix(K + _NO_STRAIN * eye_array(K.shape[0])), permc_spec="MMD_AT_PLUS_A")
    motion = np.random.default_rng(0).standard_normal(K.shape[0])
    for _ in range(3):
        motion = solve.solve(motion)
        motion /= np.linalg.norm(motion)
    if motion @ (K @ motion) > 2.0 * _NO_STRAIN:
        return None
    return int(dofs[free[np.argmax(np.abs(motion))]])


def of_a_line(
    length: ndarray, cells: ndarray, force: ndarray, moved: ndarray, G: float
) -> Iterator[Remark]:
    """Yield a remark where a beam bonded to a line in space would move more in elements half as
    large.

    Beside a line load q the ground of shear modulus G moves by q log(2) / (2 pi G) more. The work
    of that, over that of all forces, is the share by which the beam moves more. Forces on single
    nodes, of loads and supports, do not count.
    """
    nodes, share = cells.ravel(), np.outer(length, _OF_LENGTH).ravel()
    f = np.column_stack([np.bincount(nodes, force[:, c::3].ravel()) for c in range(3)])
    u = np.zeros_like(f)
    u[nodes] = moved.reshape(-1, 3)
    part = np.bincount(nodes, share)
    q = np.linalg.norm(f, axis=1) / part
    q = np.minimum(q, _SINGLE * np.median(q))
    work = part @ (q * np.linalg.norm(u, axis=1)) + abs((f * u).sum())
    more = float(np.log(2.0) / (2.0 * np.pi * G) * (part @ q**2) / (work or 1.0))
    if more > _TOLD:
        yield Remark(
            "line",
            more,
            f"in elements half as large the beam moves by {more:.1%} more or worse: it is "
            "bonded to a line of a solid, which has no stiffness in space; take Embedded(..., "
            "radius=...)",
        )


def turning_ends(beam: Any, fixed: ndarray) -> Iterator[Remark]:
    """Yield a remark on an end in the ground that supports hold along the beam alone, as in a plane
    of symmetry.

    Supports of the ground do not hold its rotation there, which makes it a hinge.
    """
    if not beam._parts or beam._shared is None or beam.coordinates != "plane":
        return
    corners, rows = beam.points[beam.cells], beam._parts[0][1]
    met = np.concatenate([dofs[:, 6:8].ravel() for _, dofs in beam._parts])
    for end in (0, 1):
        tangent = 3.0 * corners[:, end] - 4.0 * corners[:, 2] + corners[:, 1 - end]
        along = np.abs(tangent) / np.linalg.norm(tangent, axis=1)[:, None]
        held, theta = np.isin(rows[:, 2 * end : 2 * end + 2], fixed), rows[:, 6 + end]
        cut = (
            ~np.isin(theta, fixed) & (held.sum(axis=1) == 1) & ((held * along).sum(axis=1) > _ALONG)
        )
        cut &= (theta[:, None] == met).sum(axis=1) == 1  # no other element meets there
        if cut.any():
            at = format_point(corners[cut, end][0])
            yield Remark(
                "turns",
                0.0,
                f"its end at {at} is held along the beam and may turn, as at a hinge: in a "
                f"plane of symmetry hold beam.dofs({at}, ['theta']) as well",
            )
