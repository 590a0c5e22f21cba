"""Contact of surfaces whose nodes have dofs of their own: chains, beams, plates, rigid bodies; on
either side.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import block_diag, csr_matrix
from scipy.sparse.linalg import spsolve
from skfem import Basis, ElementHex1, ElementVector, MeshHex

import skfem_contact as sc
from skfem_contact.contact.compliance import _largest, on_round_off
from skfem_contact.contact.interface import ROUND_OFF
from skfem_contact.contact.laws import Status
from skfem_contact.contact.quadrature import _corners, _pairs
from skfem_contact.surfaces.surface import Surface
from tests.tools.helpers import grid, vector_basis

X = np.linspace(0.0, 1.0, 6)
LOW, UP = (
    grid("Q1", np.linspace(-0.5, 1.5, 9), np.linspace(-1, 0, 5)),
    grid("Q1", X, np.linspace(0, 0.6, 4)),
)
LAW = sc.Coulomb(0.3)


def solved(K, pair, free, prescribed) -> tuple[np.ndarray, object]:
    """Displacements and state of two increments, by Newton's method without any globalisation."""
    x, state = np.zeros(K.shape[0]), pair.initial_state()
    for share in (0.5, 1.0):
        x = np.where(free, x, share * prescribed)
        for _ in range(40):
            contact = pair.assemble(x[: pair.size], state)
            residual = (K @ x + np.pad(contact.force, (0, len(x) - pair.size)))[free]
            if np.abs(residual).max() < 1e-9:
                break
            stiffness = contact.stiffness.copy()
            stiffness.resize(K.shape)
            x[free] -= spsolve((K + stiffness)[free][:, free].tocsc(), residual)
        else:
            raise AssertionError("no equilibrium")
        state = contact.state
    return x, state


def elastic(basis) -> csr_matrix:
    return sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3)).elastic_stiffness


def pressed(basis, top, bottom) -> tuple[np.ndarray, np.ndarray]:
    """Free dofs, and the displacements of the others: the top goes down and aside."""
    free, prescribed = np.ones(basis.N, bool), basis.zeros()
    free[basis.get_dofs(bottom).all() if bottom else []] = False
    free[basis.get_dofs(top).all() if top else []] = False
    if top:
        prescribed[basis.get_dofs(top).all("u^1")], prescribed[basis.get_dofs(top).all("u^2")] = (
            0.02,
            -0.03,
        )
    return free, prescribed


@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize("quadrature", ["nodal", 2, "segments"])
def test_chain_with_dofs_of_its_own_is_the_boundary_of_a_solid(quadrature, swapped) -> None:
    """[X] The upper block's stiffness stands behind the dofs of the mesh, and its lower side is a
    chain of nodes.
    """
    both = vector_basis(sc.join_bodies({"low": LOW, "up": UP}), "Q1", intorder=2)
    names = ["low:top", "up:bottom"] if swapped else ["up:bottom", "low:top"]
    pair = sc.ContactPair(both, *names, LAW, quadrature, penalty=2e4)
    wanted, reference = solved(elastic(both), pair, *pressed(both, "up:top", "low:bottom"))

    low, up = vector_basis(LOW, "Q1", intorder=2), vector_basis(UP, "Q1", intorder=2)
    nodes = np.flatnonzero(UP.p[1] == 0.0)
    nodes = nodes[np.argsort(-UP.p[0, nodes])]  # from right to left the free side is below
    cells = np.column_stack((np.arange(5), np.arange(1, 6)))
    chain = sc.Surface.from_cells(
        UP.p[:, nodes].T, low.N + up.nodal_dofs[:, nodes].T, cells, "chain"
    )
    sides = ["top", chain] if swapped else [chain, "top"]
    pair = sc.ContactPair(low, *sides, LAW, quadrature, penalty=2e4)
    assert pair.size == low.N + up.nodal_dofs[:, nodes].max() + 1
    free, prescribed = (
        np.concatenate(part)
        for part in zip(pressed(low, None, "bottom"), pressed(up, "top", None), strict=True)
    )
    x, state = solved(block_diag((elastic(low), elastic(up))).tocsr(), pair, free, prescribed)
    order = [
        np.lexsort(np.round(places, 9))
        for places in (both.doflocs[:, ::2], np.hstack((LOW.p, UP.p)))
    ]
    one, other = wanted.reshape(-1, 2)[order[0]], x.reshape(-1, 2)[order[1]]
    np.testing.assert_allclose(np.sort(other, axis=0), np.sort(one, axis=0), atol=1e-11)
    np.testing.assert_allclose(
        np.sort(state.traction[0]), np.sort(reference.traction[0]), atol=1e-8
    )
    assert np.abs(state.traction).max() > 1.0


def beam_on_ground(thickness=0.2, first=None, **options):
    """A bent beam with three dofs a node behind those of the ground, its lower side just in the
    ground.
    """
    basis = vector_basis(LOW, "Q1", intorder=2)
    first = basis.N if first is None else first
    numbers = first + np.arange(18).reshape(6, 3)
    axis = np.column_stack((X, 0.5 * thickness - 0.02 + 0.01 * X**2))
    cells = np.column_stack((np.arange(5, 0, -1), np.arange(4, -1, -1)))
    beam = sc.Surface.from_cells(
        axis, numbers[:, :2], cells, "beam", rotations=numbers[:, 2], thickness=thickness, **options
    )
    return basis, beam, numbers


def plate_on_ground():
    """A plate with six dofs a node, half of its thickness above the ground."""
    mesh = MeshHex.init_tensor(
        np.linspace(0, 1, 3), np.linspace(0, 1, 3), np.linspace(-1, 0, 2)
    ).with_defaults()
    basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2)
    top = next(
        name
        for name, facets in mesh.boundaries.items()
        if np.allclose(mesh.p[2, mesh.facets[:, facets]], 0)
    )
    xy = np.array([(0.1, 0.15), (0.8, 0.1), (0.9, 0.85), (0.15, 0.8)])
    numbers = basis.N + np.arange(24).reshape(4, 6)
    middle = np.column_stack((xy, [0.08, 0.09, 0.1, 0.085]))
    plate = sc.Surface.from_cells(
        middle, numbers[:, :3], [[0, 3, 2, 1]], "plate", rotations=numbers[:, 3:], thickness=0.2
    )
    return basis, top, plate, numbers


def scene(kind, swapped, quadrature, tangent="exact"):
    if kind == "beam":
        (basis, surface, numbers), top = beam_on_ground(), "top"
    else:
        basis, top, surface, numbers = plate_on_ground()
    sides = [top, surface] if swapped else [surface, top]
    return sc.ContactPair(basis, *sides, LAW, quadrature, penalty=1e4, tangent=tangent), numbers


@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize(
    ("kind", "quadrature"), [("beam", "nodal"), ("beam", 3), ("plate", "nodal"), ("plate", 2)]
)
@pytest.mark.one_in(3)
def test_tangent_with_rotations(kind, quadrature, swapped, rng) -> None:
    """[X] Central differences of the forces by all dofs, rotations among them."""
    pair, numbers = scene(kind, swapped, quadrature)
    x = 1e-3 * rng.standard_normal(pair.size)
    state = pair.assemble(0.3 * x, pair.initial_state()).state
    response, step = pair.assemble(x, state), 1e-7
    K, moving = response.stiffness.toarray(), numbers.ravel()
    assert (response.force[numbers[:, -1]] != 0.0).any()
    for k in np.concatenate((moving, pair.changing[::7])):
        ahead, back = x.copy(), x.copy()
        ahead[k] += step
        back[k] -= step
        slope = (pair.assemble(ahead, state).force - pair.assemble(back, state).force) / (2 * step)
        np.testing.assert_allclose(K[:, k], slope, atol=2e-5 * np.abs(K).max())


@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize("quadrature", ["nodal", 2, "segments"])
def test_forces_and_moments_balance(quadrature, swapped, rng) -> None:
    """[X] Nodal forces and moments of beam and ground together are none, where the beam is
    displaced but not turned.
    """
    pair, numbers = scene("beam", swapped, quadrature)
    x = 1e-3 * rng.standard_normal(pair.size)
    x[numbers[:, 2]] = 0.0
    force = pair.assemble(x, pair.initial_state()).force
    axis = np.column_stack((X, 0.08 + 0.01 * X**2)) + x[numbers[:, :2]]
    ground = (LOW.p + x[: 2 * LOW.p.shape[1]].reshape(-1, 2).T).T
    parts = [(ground, force[: 2 * len(ground)].reshape(-1, 2)), (axis, force[numbers[:, :2]])]
    total = sum(f.sum(axis=0) for _, f in parts)
    moment = (
        sum((p[:, 0] * f[:, 1] - p[:, 1] * f[:, 0]).sum() for p, f in parts)
        + force[numbers[:, 2]].sum()
    )
    size = np.abs(force).max()
    assert np.abs(total).max() < 1e-12 * size and abs(moment) < 1e-12 * size and size > 1.0


def test_rigid_body_with_dofs_is_an_obstacle_where_it_is() -> None:
    """[X] All nodes share two displacements and a rotation; force and moment on them are those of
    the ground.
    """
    basis = vector_basis(LOW, "Q1", intorder=2)
    shared = np.tile(basis.N + np.arange(3), (2, 1))
    ends = np.array([(0.9, 0.05), (0.1, 0.0)])
    body = sc.Surface.from_cells(
        ends, shared[:, :2], [[0, 1]], "body", rotations=shared[:, 2], about=(0.5, 1.0)
    )
    pair = sc.ContactPair(basis, "top", body, LAW, 3, penalty=1e4)
    x = np.zeros(pair.size)
    x[basis.N :] = 0.01, -0.05, 0.02
    force = pair.assemble(x, pair.initial_state()).force
    arm = ends - (0.5, 1.0)
    moved = ends + (0.01, -0.05) + 0.02 * np.column_stack((-arm[:, 1], arm[:, 0]))
    obstacle = sc.ContactPair(basis, "top", sc.rigid.line(*moved), LAW, 3, penalty=1e4)
    fixed = obstacle.initial_state(x[: basis.N])
    same = obstacle.assemble(x[: basis.N], fixed).force
    # the obstacle has been there from the start: pressure is the same, and there is no friction yet
    frictionless = pair.with_law(sc.Coulomb()).assemble(x, pair.initial_state()).force
    np.testing.assert_allclose(
        frictionless[: basis.N],
        obstacle.with_law(sc.Coulomb()).assemble(x[: basis.N], fixed).force,
        atol=1e-9,
    )
    assert np.abs(force[: basis.N]).max() > 1.0 and np.abs(same).max() > 1.0
    np.testing.assert_allclose(
        force[basis.N : basis.N + 2], -force[: basis.N].reshape(-1, 2).sum(axis=0), atol=1e-9
    )


def test_dofs_of_fields_are_numbered_later(rng) -> None:
    """[X] A surface in numbers of fields is the one of global dofs once these are numbered; before,
    it cannot move.
    """
    basis, beam, numbers = beam_on_ground()
    axis = np.column_stack((X, 0.08 + 0.01 * X**2))
    cells = np.column_stack((np.arange(5, 0, -1), np.arange(4, -1, -1)))
    later = sc.Surface.from_cells(
        axis,
        ("displacement", np.arange(12).reshape(6, 2)),
        cells,
        "beam",
        rotations=("rotation", np.arange(6)),
        thickness=0.2,
    )
    pair, given = (
        sc.ContactPair(basis, surface, "top", LAW, penalty=1e4) for surface in (later, beam)
    )
    assert (
        pair.borrowed == ("displacement", "rotation")
        and given.borrowed == ()
        and given.numbered({}) is given
    )
    with pytest.raises(ValueError, match="the dofs of 'beam' are not numbered yet"):
        pair.assemble(basis.zeros(), pair.initial_state())
    after = pair.numbered({"displacement": numbers[:, :2].ravel(), "rotation": numbers[:, 2]})
    x = 1e-3 * rng.standard_normal(given.size)
    one, other = (p.assemble(x, p.initial_state()) for p in (after, given))
    np.testing.assert_array_equal(one.force, other.force)
    np.testing.assert_array_equal(one.stiffness.toarray(), other.stiffness.toarray())
    np.testing.assert_array_equal(after.joins, given.joins)


def test_dofs_that_a_pair_acts_on() -> None:
    """[X] Those of both surfaces, rotations too: a model without any of them can refuse the
    pair.
    """
    basis, beam, numbers = beam_on_ground()
    for sides in ((beam, "top"), ("top", beam)):
        pair = sc.ContactPair(basis, *sides, LAW)
        assert set(numbers.ravel()) < set(pair.acts_on) and set(pair.acts_on) == set(pair.joins)
    pair = sc.ContactPair(None, beam, sc.rigid.line((-1.0, 0.0), (2.0, 0.0)), LAW)
    assert set(pair.acts_on) == set(numbers.ravel()) and -1 in pair.joins


def test_penalties_of_surfaces_without_elements() -> None:
    """[X] The other side decides alone, unless the surface says its stiffness: both act in
    series.
    """
    basis, beam, _ = beam_on_ground()
    ground = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3))}
    obstacle = sc.ContactPair(basis, "top", sc.rigid.line((2.0, 0.0), (-1.0, 0.0)), LAW).completed(
        ground
    )
    soft = beam_on_ground(stiffness=500.0)[1]
    for sides in ((0, "top"), ("top", 0)):
        alone, series = (
            sc.ContactPair(
                basis, *(surface if side == 0 else side for side in sides), LAW
            ).completed(ground)
            for surface in (beam, soft)
        )
        assert alone.stiffness == obstacle.stiffness
        assert alone.penalty == pytest.approx(
            (obstacle.penalty[0], 0.1 * obstacle.penalty[1]), rel=1e-12
        )  # it slips
        assert series.stiffness == pytest.approx(
            1 / (1 / obstacle.stiffness + 1 / 500.0), rel=1e-12
        )
    floor = sc.rigid.line((-1.0, 0.0), (2.0, 0.0))
    with pytest.raises(
        ValueError, match="have no elements: give `penalty=` to ContactPair, or `stiffness=`"
    ):
        sc.ContactPair(None, beam, floor, LAW).completed({})
    assert sc.ContactPair(None, beam, floor, LAW, penalty=3.0).completed({}).penalty == (3.0, 3.0)
    assert sc.ContactPair(None, soft, floor, LAW).completed({}).stiffness == 500.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"cells": [[0, 1, 2, 3]]}, "cells must be numbers of 2 or 3 of the 3 nodes"),
        ({"cells": [[0, 7]]}, "cells must be numbers"),
        ({"cells": [[0, 3]]}, "cells must be numbers"),
        ({"cells": [[-1, 0], [0, 1]]}, "cells must be numbers"),
        ({"dofs": np.zeros((3, 2))}, "'beam': dofs must be whole numbers"),
        ({"dofs": [[0, 1]]}, "of shape"),
        ({"rotations": [1, 2]}, "'beam': rotations must be whole numbers"),
        ({"cells": [[0, 1], [2, 1]]}, "no single chain"),
        ({"coordinates": [(0.0, 0.0), (0.0, 0.0), (1.0, 0.0)]}, "facets without area"),
    ],
)
def test_bad_cells(options, message) -> None:
    given = {
        "coordinates": [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)],
        "dofs": np.arange(6).reshape(3, 2),
        "cells": [[0, 1], [1, 2]],
        "name": "beam",
    }
    with pytest.raises(ValueError, match=message):
        sc.Surface.from_cells(**(given | options))


def test_two_rigid_surfaces_are_refused() -> None:
    lines = sc.rigid.line((0.0, 0.0), (1.0, 0.0)), sc.rigid.line((1.0, 0.0), (0.0, 0.0))
    with pytest.raises(ValueError, match="both 'obstacle' and 'obstacle' are rigid"):
        sc.ContactPair(None, *lines, LAW)
    with pytest.raises(ValueError):
        sc.ContactPair(None, "top", lines[0], LAW)


def test_facets_of_any_size_that_may_face_each_other_are_paired() -> None:
    """[X] All pairs whose spheres touch, by brute force; the master's facets are 1 to 1.9 wide."""
    lines = np.linspace(0, 12, 13), np.linspace(0, 12, 13)
    steps = np.concatenate(([0.0], np.cumsum(np.tile([1.0, 1.9], 4))))
    bodies = {
        "low": MeshHex.init_tensor(steps, steps, [-1.0, 0.0]).with_defaults(),
        "up": MeshHex.init_tensor(*lines, [0.0, 1.0]).with_defaults(),
    }
    basis = Basis(sc.join_bodies(bodies), ElementVector(ElementHex1()), intorder=2)
    slave, master = (Surface.from_boundary(basis, name) for name in ("up:front", "low:back"))
    own, facing = _pairs(_corners(slave, slave.nodes), slave.size, _corners(master, master.nodes))
    found = set(zip(own.tolist(), facing.tolist(), strict=True))

    def spheres(surface):
        corners = surface.nodes[surface.facets[:, :4]]
        centre = corners.mean(axis=1)
        return centre, np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)

    (x, r), (y, s) = spheres(slave), spheres(master)
    apart = np.linalg.norm(x[:, None] - y, axis=2)
    near = np.argwhere(apart < r[:, None] + slave.size[:, None] + s - 1e-9)
    assert set(map(tuple, near.tolist())) <= found


def test_largest_displacement_is_that_of_the_surfaces_and_their_mesh():
    """[X] Dofs of other fields do not count, and none of a mesh that a pair does not have."""
    ends = np.array([[1.0, 0.0], [0.0, 0.0]])
    cells = np.array([[0, 1]])
    upper = sc.Surface.from_cells(ends, np.array([[3, 4], [5, 6]]), cells, "upper")
    lower = sc.Surface.from_cells(ends[::-1], np.array([[7, 8], [9, 10]]), cells, "lower")
    pair = sc.ContactPair(None, upper, lower, LAW, penalty=1.0)
    x = np.zeros(12)
    x[[0, 2, 11]] = 9.0
    x[[4, 9]] = 0.5, -2.0
    assert _largest(pair, x) == 2.0
    basis = vector_basis(UP, "Q1", intorder=2)
    other = sc.Surface.from_cells(ends[::-1], basis.N + np.arange(4).reshape(2, 2), cells, "other")
    pair = sc.ContactPair(basis, "bottom", other, LAW, penalty=1.0)
    x = np.zeros(basis.N + 5)
    x[[0, -2, -1]] = 3.0, -4.0, 9.0
    assert _largest(pair, x) == 4.0


@pytest.mark.parametrize("unit", [1.0, 1e-6])
def test_remark_on_round_off_of_a_slip_is_a_share_of_the_largest_traction(unit):
    """[X] Round-off of coordinates up to L times the penalty, in any unit of force, from a
    thousandth of the traction to ten times it, where points stick.
    """
    L = 1e3
    ends = np.array([[L + 1.0, 0.0], [L, 0.0]])
    cells = np.array([[0, 1]])
    upper = sc.Surface.from_cells(ends, np.arange(4).reshape(2, 2), cells, "upper")
    away = np.array([[0.0, 0.0], [2.0 * L, 0.0]])
    lower = sc.Surface.from_cells(away, 4 + np.arange(4).reshape(2, 2), cells, "lower")
    penalty = 1e6 * unit
    pair = sc.ContactPair(None, upper, lower, LAW, "nodal", penalty=penalty)
    lost = penalty * ROUND_OFF * (L + 0.5)
    sticks = replace(pair.initial_state(), status=np.full(2, Status.STICK))
    for share, told in ((5e-4, False), (2e-3, True), (5.0, True), (20.0, False)):
        traction = np.array([[-lost / share, 0.0], [0.0, 0.3 * lost / share]])
        state = replace(sticks, traction=traction)
        remarks = list(on_round_off(pair, state))
        assert [remark.figure for remark in remarks] == pytest.approx([share] * told, rel=1e-12)
        slips = replace(state, status=np.full(2, Status.SLIP))
        assert not list(on_round_off(pair, slips))
