"""Joints of beams: dofs that nodes of several beams have in common, and mechanisms."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from typing import Any

import numpy as np
import scipy
from numpy import ndarray
from scipy.sparse import coo_matrix, csc_matrix, eye_array
from scipy.sparse.linalg import splu

from ..arrays import row_norms
from ..checks import format_point
from ..errors import Remark
from ..forms.base import Form
from ..forms.roles import Body, Couples, Touching, borrowed_by
from ..layout import Field, FieldDofs, Layout
from .nodes import AT, Nodes

#: Squared strain of a motion without strain, relative to the largest one: a chain of n elements has
#: about n**-4, a mechanism 1e-16.
_NO_STRAIN = 1e-13
#: Shares of start, end and middle of an element in a uniform load.
_OF_LENGTH = np.array([1.0, 1.0, 4.0]) / 6.0
#: Largest line load on a node over the median that is not taken for a single force.
_SINGLE = 3.0
#: Share by which a beam bonded to a line in space may move more in the next mesh without a remark:
#: 2 % along the corner of a quarter of the ground, which moves four times as much as the ground all
#: around that the formula is for.
_TOLD = 0.005
#: Swing of normal forces without a remark, as a share of the section forces: up to .003 in drained
#: ground on coarse meshes, .09 and .38 along a wall in undrained clay of elements of 1 and 2.
_SWING = 0.1
#: Cosine of the angle between a beam and the direction in which a plane of symmetry fixes its end.
_ALONG = 0.99
#: Dofs that a field takes: pairs of indices and of the dofs that they are.
Taken = tuple[tuple[ndarray, Any], ...]


def rotations_of(points: ndarray, cells: ndarray, hinges: ndarray, joined: ndarray) -> ndarray:
    """Return numbers of the rotations of the elements' nodes, (m, 3): others beyond a hinge."""
    turn = cells.copy()
    count = len(points)
    for node in hinges:
        met = np.argwhere(cells[:, :2] == node)
        if len(met) < (1 if node in joined else 2):
            raise ValueError(f"no elements meet at the hinge at {format_point(points[node])}")
        for k, end in met[1:]:
            turn[k, end] = count
            count += 1
    return turn


def joined(given: Form | Sequence[Form], kind: str) -> tuple[Nodes, ...]:
    """Return the beams and shells that a structure is joined to; refuse other forms."""
    several = (given,) if isinstance(given, Form) else tuple(given)
    found = tuple(form for form in several if isinstance(form, Nodes) and form.turns)
    for form in several:
        if form not in found:
            raise ValueError(f"a {kind} may be joined_to beams and shells, not to {form!r}")
    return found


def taken_by(
    points: ndarray,
    bonded: bool,
    hinges: ndarray,
    others: Sequence[Any],
    kind: str = "beam",
) -> tuple[Taken, Taken, ndarray]:
    """Return displacements and rotations that nodes take from other structures, and these nodes.

    Nodes at hinges keep their rotations, and nodes of a bonded structure their displacements.
    """
    dim = points.shape[1]
    owners: dict[int, Any] = {}
    moves: list[tuple[ndarray, Any]] = []
    turned: list[tuple[ndarray, Any]] = []
    for other in others:
        if other.points.shape[1] != dim:
            raise ValueError(
                f"a {kind} with {dim} coordinates is joined to forms with as many, not to {other!r}"
            )
        if bonded and other.shared is None:
            raise ValueError(
                f"a bonded {kind} moves with the ground: join the other {other.kind} to it"
            )

        # Find the owners of common nodes, which other beams may have given before
        here, nodes = _common(points, other.points, kind, other.kind)
        new = np.array([k not in owners for k in here.tolist()])
        for k, node in zip(here.tolist(), nodes.tolist(), strict=True):
            owner = _owner(other, node)
            if owners.setdefault(k, owner) != owner:
                raise ValueError(
                    f"forms in `joined_to` meet at {format_point(points[k])}, but are not joined "
                    "to each other"
                )

        # Take the dofs of nodes without an owner before
        if not bonded:
            moved = _numbers(here[new], dim)
            if other.shared is None:
                moves.append((moved, FieldDofs(other.displacement, _numbers(nodes[new], dim))))
            else:
                moves.append((moved, other.shared[nodes[new]].ravel()))
        new &= ~np.isin(here, hinges)
        turns = 3
        if dim == 2:
            turns = 1
        rotations = FieldDofs(other.rotation, _numbers(nodes[new], turns))
        turned.append((_numbers(here[new], turns), rotations))
    return tuple(moves), tuple(turned), np.array(list(owners), int)


def _common(points: ndarray, others: ndarray, kind: str, other: str) -> tuple[ndarray, ndarray]:
    """Return the numbers of points that lie on other ones, and the numbers of these, (n,) each."""
    distance, nearest = map(np.asarray, scipy.spatial.cKDTree(others).query(points))
    size = max(np.ptp(points, axis=0).max(), np.ptp(others, axis=0).max())
    here = np.flatnonzero(distance <= AT * size)
    if not len(here):
        k = int(np.argmin(distance))
        raise ValueError(
            f"the {kind} has no node in common with a {other} that it is joined to; the nearest "
            f"ones are at {format_point(points[k])} and {format_point(others[nearest[k]])}"
        )
    return here, nearest[here]


def _owner(beam: Any, node: int) -> Any:
    """Return the field and index, or the number in the basis, of a node's first displacement."""
    if beam.shared is not None:
        return int(beam.shared[node, 0])
    field = beam.displacement
    index = beam.points.shape[1] * node
    # Another beam may have given the node before: follow it to its first owner.
    while taken := [(own, others) for own, others in field.taken if index in own]:
        own, others = taken[0]
        position = own.tolist().index(index)
        if not isinstance(others, FieldDofs):
            return int(others[position])
        field = others.field
        index = int(others.indices[position])
    return field.key, index


def _numbers(nodes: ndarray, k: int) -> ndarray:
    """Return the indices of k dofs of each node."""
    return (k * nodes[:, None] + np.arange(k)).ravel()


def _joined_to(beam: Any, beams: Sequence[Any]) -> list[Any]:
    """Return a beam, the beams joined to it, the beams joined to these, and so on."""
    frame: list[Any] = []
    more = [beam]
    while more:
        frame += more
        others = [other for other in beams if other not in frame]
        more = []
        for other in others:
            if any(_linked(member, other) for member in frame):
                more.append(other)
    return frame


def frame_of(beam: Any, forms: Mapping[str, Any]) -> tuple[list[Any], list[Field]]:
    """Return a beam with the beams joined to it, and their fields that other forms act on.

    No beams are returned where a form may act on any dof, whose supports are unknown.
    """
    beams = []
    touched: set[Field] = set()
    for form in forms.values():
        if isinstance(form, type(beam)):
            beams.append(form)
        elif _acts_anywhere(form):
            return [], []
        else:
            touched.update(borrowed_by(form))
    frame = _joined_to(beam, beams)
    fields = chain.from_iterable(member.fields for member in frame)
    return frame, [field for field in fields if field in touched]


def taken_elsewhere(beam: Any, frame: Sequence[Any]) -> Iterator[tuple[Field, ndarray]]:
    """Yield the dofs that a beam takes from outside of its frame: from shells, or the ground."""
    fields = list(chain.from_iterable(member.fields for member in frame))
    for field in beam.fields:
        for indices, other in field.taken:
            if not isinstance(other, FieldDofs) or other.field not in fields:
                yield field, indices


def _acts_anywhere(form: Any) -> bool:
    """Return True if a form does not name the dofs that it acts on."""
    known = isinstance(form, Body | Touching) or form.size is not None
    return not (known or borrowed_by(form) or form.fields)


def _linked(first: Any, second: Any) -> bool:
    """Return True if one of two beams takes dofs of the other."""
    return _takes(first, second) or _takes(second, first)


def _takes(beam: Any, other: Any) -> bool:
    """Return True if a beam takes dofs of another one."""
    for field in beam.fields:
        for _, dofs in field.taken:
            if isinstance(dofs, FieldDofs) and dofs.field in other.fields:
                return True
    return False


def loose_motion(
    parts: Sequence[tuple[ndarray, ndarray]], stiff: ndarray
) -> tuple[ndarray, ndarray] | None:
    """Return dofs and their displacements in a motion without strain, or None if none exists.

    Parts are strains of elements, (m, q, n), and their dofs, (m, n); stiff dofs do not move.
    """
    # Assemble the strains, each of unit size, of all free dofs
    every = np.concatenate([rows for _, rows in parts])
    dofs, columns = np.unique(every, return_inverse=True)
    strains = np.concatenate([strains for strains, _ in parts])
    size = np.linalg.norm(strains, axis=2, keepdims=True)
    blocks = strains / np.where(size > 0.0, size, 1.0)  # (m, q, n)
    m, q, n = blocks.shape
    row = np.repeat(np.arange(m * q), n)
    column = np.repeat(columns.reshape(m, 1, n), q, axis=1).ravel()
    free = np.flatnonzero(~np.isin(dofs, stiff))
    if not len(free):
        return None
    whole = coo_matrix((blocks.ravel(), (row, column)), shape=(m * q, len(dofs)))
    B = whole.tocsc()[:, free]

    # Find the motion with the smallest strain by inverse iteration
    K = csc_matrix(B.T @ B)
    n_free = len(free)
    shifted = csc_matrix(K + _NO_STRAIN * eye_array(n_free))
    factors = splu(shifted, permc_spec="MMD_AT_PLUS_A")
    motion = np.random.default_rng(0).standard_normal(n_free)
    for _ in range(3):
        motion = factors.solve(motion)
        motion /= np.linalg.norm(motion)
    if motion @ (K @ motion) > 2.0 * _NO_STRAIN:
        return None
    return dofs[free], motion


def refuse_loose(name: str, forms: Mapping[str, Any], layout: Layout, held: ndarray) -> None:
    """Refuse a numbered beam or reinforcement that moves freely: no other form acts on it."""
    form = forms[name]
    strains, dofs = form.strains
    others = [other for other in forms.values() if other is not form]
    if form.shared is not None or any(_acts_on(other, form.displacement, dofs) for other in others):
        return
    loose = loose_motion([(strains, dofs)], held)
    if loose is None:
        return
    moving, motion = loose
    point = format_point(layout.coordinates[:, moving[np.argmax(np.abs(motion))]])
    raise ValueError(
        f"the {form.kind} '{name}' moves freely at {point}, for nothing acts on its nodes: bond it "
        "to a line of the mesh, or give it supports, `contact` or Embedded that is active with it"
    )


def _acts_on(form: Any, field: Field, dofs: ndarray) -> bool:
    """Return True if a numbered form may act on a field with some dofs."""
    if isinstance(form, Couples) and form.acts_on is not None:
        return bool(np.isin(dofs, form.acts_on).any())
    return field in borrowed_by(form) or _acts_anywhere(form)


def of_a_line(
    length: ndarray,
    cells: ndarray,
    force: ndarray,
    moved: ndarray,
    G: float,
) -> Iterator[Remark]:
    """Yield a remark where a beam bonded to a line in space moves more in elements half as large.

    Near a line load q the ground of shear modulus G moves by q log(2) / (2 pi G) more. Its work
    over the work of all forces is the share by which the beam moves more. Forces on single nodes,
    of loads and supports, do not count.
    """
    # Sum forces f, displacements u and lengths of the nodes
    nodes = cells.ravel()
    components = [np.bincount(nodes, force[:, c::3].ravel()) for c in range(3)]
    f = np.column_stack(components)
    u = np.zeros_like(f)
    u[nodes] = moved.reshape(-1, 3)
    part = np.bincount(nodes, np.outer(length, _OF_LENGTH).ravel())

    # Compare the works of the line load q
    q = row_norms(f) / part
    q = np.minimum(q, _SINGLE * np.median(q))
    work = part @ (q * row_norms(u)) + abs((f * u).sum())
    compliance = np.log(2.0) / (2.0 * np.pi * G)
    more = float(compliance * (part @ q**2) / (work or 1.0))
    if more > _TOLD:
        yield Remark(
            "line",
            more,
            f"in elements half as large the beam moves by {more:.1%} more or worse: it is bonded "
            "to a line of a solid, which has no stiffness in space; take Embedded(..., radius=...)",
        )


def swinging(cells: ndarray, N: ndarray, V: ndarray, round_off: float) -> Iterator[Remark]:
    """Yield a remark on normal forces that swing within the elements of a bonded beam.

    Where the ground hardly changes its volume, its pressures swing within elements and pull at
    middle nodes against end nodes. The smaller of a jump between two elements and of their mean
    slope against it is the swing: single forces make jumps without slopes, friction of the ground
    slopes without jumps.

    Parameters
    ----------
    cells
        Nodes of the elements, (m, 3).
    N, V
        Normal and shear forces at start and end, (m, 2).
    round_off
        Round-off of normal forces.
    """
    # Pair each element with the only one that begins at its end.
    start, end = cells[:, :2].T
    count = np.bincount(cells[:, :2].ravel())
    begins = np.full(len(count), -1)
    begins[start] = np.arange(len(cells))
    first = np.flatnonzero((count[end] == 2) & (begins[end] >= 0))
    second = begins[end[first]]
    if not len(first):
        return

    # Compare the jumps between them with their slopes.
    rise = N[:, 1] - N[:, 0]
    jump = N[second, 0] - N[first, 1]
    against = -0.5 * (rise[first] + rise[second]) * np.sign(jump)
    swing = np.clip(against, 0.0, np.abs(jump)).mean()
    size = np.hypot(np.abs(N.mean(axis=1)).mean(), np.abs(V).mean())
    if swing > max(_SWING * size, round_off):
        share = float(swing / size)
        yield Remark(
            "swing",
            share,
            f"its normal forces swing by {share:.0%} of the section forces within elements, as "
            "where ground hardly changes its volume: the mean of both ends of an element is "
            "nearer; take smaller elements of ElementTriP2 along the beam",
        )


def turning_ends(corners: ndarray, rows: ndarray, met: ndarray, fixed: ndarray) -> Iterator[Remark]:
    """Yield a remark on an end in the ground that supports fix along the beam alone.

    Supports of the ground in a plane of symmetry do not fix its rotation, which makes it a hinge.

    Parameters
    ----------
    corners, rows
        Coordinates, (m, 3, 2), and dofs, (m, 9), of the elements.
    met
        Rotations at the ends of all elements that are joined.
    fixed
        Dofs with supports.
    """
    for end in (0, 1):
        # The direction of the axis at the end, by the quadratic shape functions.
        tangent = 3.0 * corners[:, end] - 4.0 * corners[:, 2] + corners[:, 1 - end]
        along = np.abs(tangent) / row_norms(tangent)[:, None]
        held = np.isin(rows[:, 2 * end : 2 * end + 2], fixed)
        theta = rows[:, 6 + end]
        # Held in one direction, along the beam, and free to turn.
        once = held.sum(axis=1) == 1
        cut = once & ((held * along).sum(axis=1) > _ALONG)
        alone = (theta[:, None] == met).sum(axis=1) == 1  # no other element meets it
        cut &= alone & ~np.isin(theta, fixed)
        if cut.any():
            point = format_point(corners[cut, end][0])
            yield Remark(
                "turns",
                0.0,
                f"its end at {point} is held along the beam and may turn, as at a hinge: in a "
                f"plane of symmetry hold beam.dofs({point}, ['theta']) as well",
            )
