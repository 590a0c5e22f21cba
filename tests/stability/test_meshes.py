"""Meshes that fit badly: sizes, shapes, corners, few points and many."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest
from skfem import MeshHex, MeshQuad

import skfem_contact as sc
from skfem_contact.contact.neighbours import neighbours
from skfem_contact.contact.search import project
from tests.stability.setups import (
    blocks,
    displaced,
    force_on,
    guided,
    held,
    in_contact,
    loaded,
    run,
    vector,
)
from tests.tools import space
from tests.tools.helpers import distorted, grid, traction, vector_basis

QUADRATURES = ["nodal", 2, "segments"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("dim", "sizes", "quadrature"),
    [
        *(
            (2, sizes, rule)
            for sizes in [(2, 40), (40, 2), (1, 50), (100, 2)]
            for rule in QUADRATURES
        ),
        (3, (1, 20), "nodal"),
        (3, (20, 1), 2),
    ],
    ids=str,
)
def test_sizes_across_the_interface(dim, sizes, quadrature):
    """[X] Case S7: elements 20 and 50 times larger on either side: resultant and its lever are
    those of the load.
    """
    basis = blocks(*sizes, overhang=0.0, dim=dim)
    forms = in_contact(basis, sc.Coulomb(0.3), quadrature)
    load = loaded(basis, "upper:top", (0.5, -5.0))
    with warnings.catch_warnings():
        warnings.simplefilter(
            "ignore", sc.AnalysisWarning
        )  # the small segments are shorter than the penetration
        stage = run(forms, [sc.Stage("press", load)], held(basis, "lower:bottom"))["press"]
    np.testing.assert_allclose(force_on(forms, stage), vector(basis, [-0.5, 5.0]), atol=1e-8)
    joint = stage.tractions("joint")
    force = joint.weight * joint.pressure
    # T acts at the height 1 above the interface; the settlement shifts the levers by some per cent
    assert (force @ joint.x) / force.sum() == pytest.approx(0.5 + 0.5 / 5.0, abs=0.02)


def test_edge_under_one_element():
    """[X] A node of a coarse slave at the corner of a fine master tilts the facet there beyond the
    friction angle.

    Both nodes of the slave then slide at less than the load of
    :func:`test_sizes_across_the_interface`.
    """
    basis = blocks(50, 1, overhang=0.0)
    ends = {}
    for mu, share in ((0.3, 0.8), (0.6, 1.0)):
        forms = in_contact(
            basis, sc.Coulomb(mu), "nodal", penalty=3400.0
        )  # a harder one tilts it more
        load = traction(basis, "upper:top", (0.5 * share, -5.0 * share))
        stages = [sc.Stage("half", 0.5 * load), sc.Stage("load", load)]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", sc.AnalysisWarning)
            stage = run(forms, stages, basis.get_dofs("lower:bottom").all(), newton=sc.Newton())[
                "load"
            ]
        np.testing.assert_allclose(force_on(forms, stage), [-0.5 * share, 5.0 * share], atol=1e-6)
        along = np.diff(forms["joint"].master.positions(stage.x)[-2:], axis=0)[0]
        ends[mu] = -along[1] / along[0]
    assert ends[0.3] > 0.3  # friction alone does not hold the node there
    assert ends[0.6] < 0.6


@pytest.mark.parametrize(
    ("dim", "sizes"),
    [(2, (2, 40)), (2, (40, 2)), (2, (1, 50)), (2, (50, 1)), (3, (1, 20)), (3, (20, 1))],
    ids=str,
)
@pytest.mark.one_in(3)
def test_patch_test_at_any_ratio(dim, sizes):
    """[X] Cases A9, S7: integration over common segments passes the patch test from 1:50 to
    50:1.
    """
    basis = blocks(*sizes, overhang=0.0, dim=dim)
    forms = in_contact(basis, sc.Coulomb(), "segments", nu=0.0, penalty=1e5)
    fixed = guided(basis, "lower:bottom")
    stage = run(forms, [sc.Stage("press", loaded(basis, "upper:top", (0.0, -5.0)))], fixed)["press"]
    stress = stage.states["blocks"].stress
    np.testing.assert_allclose(stress[dim - 1], -5, rtol=1e-8)
    assert np.abs(np.delete(stress, dim - 1, axis=0)).max() < 1e-7


@pytest.mark.parametrize("quadrature", QUADRATURES)
@pytest.mark.parametrize(
    ("dim", "element"), [(2, "Q1"), (2, "P1"), (2, "Q2"), (3, "Q1"), (3, "P1"), (3, "Q2")]
)
@pytest.mark.one_in(3)
def test_distorted_elements(dim, element, quadrature, rng):
    """[X] Case S8: nodes moved at random by a quarter of the size, interface included: forces
    balance.
    """
    basis = blocks(element=element, mapped=lambda mesh: _jagged(mesh, rng), dim=dim)
    forms = in_contact(basis, sc.Coulomb(0.5), quadrature)
    fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
    target = displaced(basis, "upper:top", (0.01, -0.05))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sc.AnalysisWarning)
        stage = run(forms, [sc.Stage("press", basis.zeros(), target)], fixed)["press"]
    upper, lower = force_on(forms, stage), force_on(forms, stage, "lower")
    np.testing.assert_allclose(upper, -lower, atol=1e-10 * np.abs(upper).max())
    internal = forms["blocks"].assemble(stage.x, stage.states["blocks"]).force
    reaction = internal[basis.get_dofs("upper:top").all()].reshape(-1, dim).sum(axis=0)
    # evaluated again, the elastic slip on curved facets in space is the same to second order
    np.testing.assert_allclose(
        reaction, -upper, atol=(1e-8 if dim == 2 else 1e-6) * np.abs(upper).max()
    )
    assert upper[-1] > 0


def _jagged(mesh, rng):
    """Inner nodes moved in both directions, those of the interface by a few per cent of their
    height.
    """
    moved = distorted(mesh, rng, 0.05).doflocs
    inner = ((mesh.p > mesh.p.min(axis=1)[:, None]) & (mesh.p < mesh.p.max(axis=1)[:, None])).all(
        axis=0
    )
    interface = np.abs(mesh.p[-1]) < 1e-9
    p = np.where(inner, moved, mesh.p)
    p[-1, interface] = 0.2 * moved[-1, interface]
    return replace(mesh, doflocs=p)


@pytest.mark.parametrize("quadrature", QUADRATURES)
def test_needles(quadrature):
    """[X] Case S8: elements a thousand times longer than high beside the interface carry a uniform
    pressure.
    """
    heights = np.concatenate((np.linspace(0, 0.999, 4), [1.0]))
    meshes = {}
    for name, y in (("lower", heights - 1.0), ("upper", 1.0 - heights[::-1])):
        ends = {
            "bottom": (1, y[0]),
            "top": (1, y[-1]),
            "left": (0, 0.0),
        }  # the default ones take 1e-3 for nothing
        meshes[name] = MeshQuad.init_tensor(np.linspace(0, 1, 2), y).with_boundaries(
            {side: lambda x, c=c, at=at: np.abs(x[c] - at) < 1e-9 for side, (c, at) in ends.items()}
        )
    basis = vector_basis(sc.join_bodies(meshes), "Q1", intorder=2)
    forms = in_contact(basis, sc.Coulomb(), quadrature, nu=0.0)
    fixed = np.union1d(
        basis.get_dofs("lower:bottom").all(),
        basis.get_dofs({"lower:left", "upper:left"}).all("u^1"),
    )
    stage = run(forms, [sc.Stage("press", traction(basis, "upper:top", (0.0, -5.0)))], fixed)[
        "press"
    ]
    np.testing.assert_allclose(stage.states["joint"].traction[0], -5, rtol=1e-7)
    np.testing.assert_allclose(stage.states["blocks"].stress[1], -5, rtol=1e-7)


@pytest.mark.parametrize("shift", [-1e-16, 0.0, 1e-16, 1e-12, -1e-12])
@pytest.mark.parametrize("quadrature", QUADRATURES)
@pytest.mark.one_in(3)
def test_nodes_at_joints(quadrature, shift):
    """[X] Case S12: each slave node at a joint of the master, up to round-off: the same force, in
    balance to 1e-12.
    """
    forces = []
    for s in (0.0, shift):
        meshes = {
            "lower": grid("Q1", np.linspace(-1, 2, 13), np.linspace(-1, 0, 5)),
            "upper": grid("Q1", np.linspace(0, 1, 5) + s, np.linspace(0, 1, 5)),
        }
        basis = vector_basis(sc.join_bodies(meshes), "Q1", intorder=2)
        forms = in_contact(basis, quadrature=quadrature)
        fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
        target = displaced(basis, "upper:top", (0.0, -0.01))
        stage = run(forms, [sc.Stage("press", basis.zeros(), target)], fixed)["press"]
        forces.append(force_on(forms, stage))
        np.testing.assert_allclose(
            forces[-1], -force_on(forms, stage, "lower"), atol=1e-12 * forces[-1][1]
        )
    # which side of a joint a node falls to turns its force by the kink there
    assert forces[1][1] == pytest.approx(forces[0][1], rel=1e-4)


def corners(dim: int, overlap: float, along_edges: bool):
    """Blocks that overlap by a corner or, in space, along an edge."""
    low, high = (
        np.linspace(-1, 0, 5 if dim == 2 else 3),
        np.linspace(-overlap, 1 - overlap, 6 if dim == 2 else 4),
    )
    if dim == 2:
        meshes = {"lower": grid("Q1", low, low), "upper": grid("Q1", high, np.linspace(0, 1, 5))}
        return vector_basis(sc.join_bodies(meshes), "Q1", intorder=2)
    other = high - 0.5 if along_edges else high
    meshes = {
        "lower": space.block("Q1", low, low, low),
        "upper": space.block("Q1", high, other, [0.0, 0.5, 1.0]),
    }
    return vector_basis(sc.join_bodies(meshes), "Q1", intorder=2)


@pytest.mark.parametrize("quadrature", QUADRATURES)
@pytest.mark.parametrize("overlap", [0.0, 1e-12, 0.05, 0.3])
@pytest.mark.parametrize(
    ("dim", "along_edges"), [(2, False), (3, True), (3, False)], ids=["plane", "edges", "corners"]
)
@pytest.mark.one_in(3)
def test_corner_on_corner(dim, along_edges, overlap, quadrature):
    """[X] Case S12: blocks that meet at a corner, or by a part of an element: the force is finite
    and balances.
    """
    basis = corners(dim, overlap, along_edges)
    forms = in_contact(basis, quadrature=quadrature)
    fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
    target = displaced(basis, "upper:top", (0.0, -0.005))
    with warnings.catch_warnings():
        warnings.simplefilter(
            "ignore", sc.AnalysisWarning
        )  # Gauss points of a corner may see nothing, and say so
        stage = run(forms, [sc.Stage("press", basis.zeros(), target)], fixed)["press"]
    upper = force_on(forms, stage)
    np.testing.assert_allclose(upper, -force_on(forms, stage, "lower"), atol=1e-12)
    # two columns of unit width in series would carry 1e3 * 0.005 / 2 = 2.5, and the corner less
    # than these
    assert 0.0 <= upper[-1] < 2.5
    if overlap == 0.3:
        assert upper[-1] > (0.3 if dim == 2 else 0.1 if along_edges else 0.05)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("quadrature", [1, "nodal"])
def test_one_segment(quadrature, dim):
    """[X] A slave of one element, with one Gauss point or with its two or four nodes, carries its
    load.
    """
    basis = blocks(1, 1, dim=dim)
    forms = in_contact(basis, quadrature=quadrature)
    fixed = np.union1d(held(basis, "lower:bottom"), basis.get_dofs("upper:left").all("u^1"))
    if dim == 3:
        fixed = np.union1d(fixed, basis.get_dofs("upper:front").all("u^2"))
    stage = run(forms, [sc.Stage("press", loaded(basis, "upper:top", (0.0, -5.0)))], fixed)["press"]
    assert force_on(forms, stage)[-1] == pytest.approx(5.0, rel=1e-8)
    assert len(stage.states["joint"].gap) == (1 if quadrature == 1 else 2 ** (dim - 1))


@pytest.mark.parametrize("dim", [2, 3])
def test_one_point_carries_a_body(dim):
    """[X] One Gauss point under a block that is guided upright: the pressure is the load over the
    length.
    """
    basis = blocks(1, 1, overhang=0.0, dim=dim)
    forms = in_contact(basis, sc.Coulomb(), 1)
    level = basis.get_dofs("upper:top").all(f"u^{dim}")
    target = basis.zeros()
    target[level] = -0.01
    fixed = np.union1d(guided(basis, "lower:bottom"), level)
    stage = run(forms, [sc.Stage("press", basis.zeros(), target)], fixed)["press"]
    internal = forms["blocks"].assemble(stage.x, stage.states["blocks"]).force
    assert -stage.states["joint"].traction[0][0] == pytest.approx(-internal[level].sum(), rel=1e-9)


def test_five_thousand_points():
    """[X] Uniform pressure on 5,000 slave segments; the search does not grow with the square of
    their number.
    """
    n = 5000
    meshes = {
        "lower": MeshQuad.init_tensor(
            np.linspace(0, 10, n // 2 + 1), np.array([-0.01, 0.0])
        ).with_defaults(),
        "upper": MeshQuad.init_tensor(
            np.linspace(0, 10, n + 1), np.array([0.0, 0.01])
        ).with_defaults(),
    }
    basis = vector_basis(sc.join_bodies(meshes), "Q1", intorder=2)
    forms = in_contact(basis, sc.Coulomb(), nu=0.0)
    fixed = np.union1d(
        basis.get_dofs("lower:bottom").all(),
        basis.get_dofs({"lower:left", "upper:left"}).all("u^1"),
    )
    stage = run(forms, [sc.Stage("press", traction(basis, "upper:top", (0.0, -5.0)))], fixed)[
        "press"
    ]
    normal = stage.states["joint"].traction[0]
    assert len(normal) == n + 1
    weight = forms["joint"].points(stage.states["joint"]).weight
    assert (weight * normal).sum() == pytest.approx(-50)
    np.testing.assert_allclose(
        normal[5:-5], -5, rtol=0.3
    )  # each second node faces the middle of a segment


@pytest.mark.slow
@pytest.mark.parametrize("n", [14, 141])
def test_search_in_space(n):
    """[X] Case S20: 200 and 20,000 points over a wavy surface: a few facets for each, and Gauss
    points as well.
    """
    line = np.linspace(0, 10, n + 1)
    mesh = MeshHex.init_tensor(line, line, np.array([-1.0, 0.0])).with_boundaries(
        {"top": lambda x: x[2] > -0.1}
    )
    x, y, z = mesh.p
    surface = sc.rigid.mesh(
        replace(mesh, doflocs=np.stack((x, y, z + 0.1 * np.sin(x) * np.cos(y)))), "top"
    )
    at = np.stack(np.meshgrid(line[:-1], line[:-1]), axis=-1).reshape(-1, 2) + 5.0 / n
    points = np.column_stack((at, 0.1 * np.sin(at[:, 0]) * np.cos(at[:, 1]) + 0.1 / n))
    near, _ = neighbours(surface, surface.nodes, points)
    assert len(near.pairs.point) <= 20 * n**2
    some = np.arange(n**2) % 10 == 0
    found = project(surface, surface.nodes, points, np.full(n**2, 1.0), among=near.of(some)).found
    assert np.array_equal(found, some)


def test_search_grows_like_the_number_of_segments():
    """[X] Case S20: a point is projected on a few segments, however many there are."""
    for n in (200, 20000):
        t = np.linspace(0, 10, n + 1)
        surface = sc.rigid.polyline(np.stack((t, 0.1 * np.sin(t)), axis=1))
        points = np.stack((t[:-1] + 5.0 / n, 0.1 * np.sin(t[:-1]) + 0.1 / n), axis=1)
        near, _ = neighbours(surface, surface.nodes, points)
        assert (
            len(near.pairs.point) <= 8 * n
        )  # a sphere about the nearest sample meets a few segments
        assert project(surface, surface.nodes, points, np.full(n, 1.0)).found.all()


@pytest.mark.parametrize("fault", ["duplicate", "hanging", "flat", "nan"])
def test_faulty_meshes(fault):
    """[X] Cases S8, S16: doubled nodes, a node that belongs to nothing, an element without area,
    NaN: named errors.
    """
    mesh = grid("Q1", np.linspace(0, 1, 3), np.linspace(0, 1, 3))
    p, t = mesh.p.copy(), mesh.t.copy()
    if (
        fault == "duplicate"
    ):  # an element hangs on copies of the nodes that it should share: a body of its own
        copies = p[:, t[:, -1]]
        t[:, -1] = p.shape[1] + np.arange(4)
        p = np.hstack((p, copies))
    if fault == "hanging":
        p = np.hstack((p, [[3.0], [3.0]]))
    if fault == "flat":
        p[:, t[0, 0]] = p[:, t[1, 0]]
    if fault == "nan":
        p[0, 0] = np.nan
    with pytest.raises(ValueError, match=r"held|no element|belong|flat|finite|NaN"):
        basis = vector_basis(
            MeshQuad(p, t).with_boundaries({"low": lambda x: x[1] < 0.01}), "Q1", intorder=2
        )
        forms = {"body": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.2))}
        run(forms, [sc.Stage("weight", sc.weight(basis, 1.0))], basis.get_dofs("low").all())
