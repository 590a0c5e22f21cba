"""Beams that are joined to each other, rigidly and by hinges, and beams along edges of the ground
in space.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from skfem import MeshHex, MeshQuad, MeshTri

import skfem_contact as sc
import skfem_contact.plot as plot
from skfem_contact.beams.joints import of_a_line
from tests.tools.helpers import grid, vector_basis

QUIET = {"progress": False}
STIFF = {"EI": 2.0, "EA": 1e4, "GA": 1e4}


def way(*corners, n=2):
    """Points along a polyline, n steps a side."""
    parts = [np.linspace(a, b, n + 1) for a, b in pairwise(corners)]
    return np.vstack([parts[0], *(part[1:] for part in parts[1:])])


def portal(whole, hinges=(), EI=2.0, **more):
    """A portal 3 high and 6 wide, in one piece or of three beams, whose feet are clamped: model."""
    more |= {**STIFF, "EI": EI}
    if whole:
        frame = sc.Beam(None, way((0, 0), (0, 3), (6, 3), (6, 0)), hinges=hinges, **more)
        return sc.Model({"left": frame}, [*frame.dofs((0, 0)), *frame.dofs((6, 0))])
    left = sc.Beam(None, way((0, 0), (0, 3)), **more)
    top = sc.Beam(None, way((0, 3), (6, 3)), joined_to=left, hinges=hinges, **more)
    right = sc.Beam(None, way((6, 3), (6, 0)), joined_to=[top], **more)
    return sc.Model(
        {"right": right, "left": left, "top": top}, [*left.dofs((0, 0)), *right.dofs((6, 0))]
    )


def loaded(model, force=(1.0, 0.0), at=(0.0, 3.0)):
    return model.run([sc.Stage("load", model.forms["left"].load(force, at))], **QUIET)["load"]


@pytest.mark.parametrize("hinges", [(), (0.0, 3.0)])
def test_three_beams_are_one_frame(hinges):
    """[N] The same displacements and section forces as of one beam, with and without a hinge in a
    corner.
    """
    one, three = (loaded(portal(whole, hinges, unit_weight=0.1)) for whole in (True, False))
    for name, at in (("left", (0.0, 3.0)), ("top", (6.0, 3.0)), ("right", (6.0, 1.5))):
        mine = three.x[three.forms[name].numbers(at)[:2]]
        np.testing.assert_allclose(mine, one.x[one.forms["left"].numbers(at)[:2]], rtol=1e-9)
    for quantity in "NVM":
        parts = [getattr(three.section_forces(name), quantity) for name in ("left", "top", "right")]
        np.testing.assert_allclose(
            np.concatenate(parts), getattr(one.section_forces("left"), quantity), atol=1e-8
        )
    if hinges:
        assert abs(three.section_forces("top").M[0]) < 1e-9
    assert len(three.x) == len(one.x)


def test_collapse_of_three_beams():
    """[X] The portal's side sways under 4 Mp / h with hinges at feet and heads, on a plateau."""
    model = portal(False, EI=100.0, Mp=3.0)
    model.newton = sc.Newton(tolerance=1e-9)
    limit = model.limit_load(model.forms["left"].load((1.0, 0.0), (0.0, 3.0)), **QUIET)
    assert limit.stop.kind in ("plateau", "mechanism", "collapse")
    assert limit.multiplier == pytest.approx(4 * 3.0 / 3.0, rel=1e-6)


def test_tee_of_a_wall_and_a_hinged_slab():
    """[X] A slab hinged to the middle of a cantilever bears as a strut; the wall stays continuous
    there.

    The wall's flexibility is that of two runs of the wall alone.
    """

    def wall_alone(force, at):
        wall = sc.Beam(None, way((0, 0), (0, 2), (0, 4)), **STIFF)
        stage = loaded(sc.Model({"left": wall}, wall.dofs((0, 0))), force, at)
        return stage.x[stage.forms["left"].numbers((0, 2))[0]]

    wall = sc.Beam(None, way((0, 0), (0, 2), (0, 4)), **STIFF)
    slab = sc.Beam(None, way((0, 2), (5, 2)), **STIFF, joined_to=wall, hinges=(0.0, 2.0))
    model = sc.Model({"left": wall, "slab": slab}, [*wall.dofs((0, 0)), *slab.dofs((5, 2))])
    stage = loaded(model, (1.0, 0.0), (0.0, 4.0))
    strut = wall_alone((1.0, 0.0), (0, 4)) / (wall_alone((1.0, 0.0), (0, 2)) + 5.0 / STIFF["EA"])
    np.testing.assert_allclose(stage.section_forces("slab").N, -strut, rtol=1e-7)
    np.testing.assert_allclose(stage.section_forces("slab").M, 0.0, atol=1e-7)
    M = stage.section_forces("left").M
    assert M[3] == pytest.approx(M[4], rel=1e-9)
    assert abs(M[3]) == pytest.approx(2.0, rel=1e-7)


@pytest.mark.parametrize("hinged", [False, True])
def test_corner_in_space(hinged):
    """[X] A bent cantilever under a force across its plane: bending of both legs and twist of the
    first one.

    Its second leg, hinged to the first and clamped at the far end, bears half of a force at the
    hinge.
    """
    EI, EA, GA, GJ = 3.0, 1e6, 1e6, 2.0
    first = sc.Beam(None, way((0, 0, 0), (2, 0, 0)), EI=EI, EA=EA, GA=GA, GJ=GJ)
    corner, tip = (2.0, 0.0, 0.0), ((4.0, 0.0, 0.0) if hinged else (2.0, 1.0, 0.0))
    second = sc.Beam(
        None,
        way(corner, tip),
        EI=EI,
        EA=EA,
        GA=GA,
        GJ=GJ,
        joined_to=first,
        hinges=corner if hinged else (),
    )
    model = sc.Model(
        {"first": first, "second": second},
        [*first.dofs((0, 0, 0)), *(second.dofs(tip) if hinged else [])],
    )
    at = corner if hinged else tip
    stage = model.run([sc.Stage("load", model.forms["second"].load((0.0, 0.0, 1.0), at))], **QUIET)[
        "load"
    ]
    w = stage.x[stage.forms["second"].numbers(at)[2]]
    if hinged:
        assert w == pytest.approx(0.5 * (8 / 3 / EI + 2 / GA), rel=1e-7)
        np.testing.assert_allclose(stage.section_forces("second").M[0], 0.0, atol=1e-8)
    else:
        assert w == pytest.approx(8 / 3 / EI + 1 / 3 / EI + 2 / GJ + 3 / GA, rel=1e-7)
        assert abs(stage.section_forces("first").T) == pytest.approx(1.0, rel=1e-7)


@pytest.mark.parametrize("several", [False, True])
def test_load_of_a_beam_that_takes_nodes_of_a_later_one(several):
    """[N] A wall that is joined to a later slab moves as the wall that this slab is joined to."""
    found = []
    for later in (False, True):
        wall = sc.Beam(None, way((0, 0), (0, 2), (0, 4)), **STIFF)
        slab = sc.Beam(None, way((0, 2), (5, 2)), **STIFF, joined_to=() if later else wall)
        if later:
            wall = sc.Beam(None, way((0, 0), (0, 2), (0, 4)), **STIFF, joined_to=slab)
        fixed = [*wall.dofs((0, 0)), *slab.dofs((5, 2))]
        model = sc.Model({"wall": wall, "slab": slab}, fixed)
        load = model.forms["wall"].load((1.0, 0.0), (0.0, 4.0))
        assert len(load) < model.layout.size
        stage = model.run([sc.Stage("push", [load] if several else load)], **QUIET)["push"]
        found.append(stage.x[model.forms["wall"].numbers((0, 4))])
    np.testing.assert_allclose(found[1], found[0], rtol=1e-9)


def test_a_slab_is_joined_to_a_wall_that_has_moved(tmp_path):
    """[X] A strut of a later stage is born without force; then both share the load; saved and
    resumed in between.
    """
    wall = sc.Beam(None, way((0, 0), (0, 2), (0, 4)), **STIFF)
    slab = sc.Beam(None, way((0, 4), (5, 4)), **STIFF, joined_to=wall, hinges=[(0.0, 4.0)])
    model = sc.Model({"left": wall, "slab": slab}, [*wall.dofs((0, 0)), *slab.dofs((5, 4))])
    force = model.forms["left"].load((1.0, 0.0), (0.0, 4.0))
    stages = [
        sc.Stage("alone", force),
        sc.Stage("slab", force, activate="slab"),
        sc.Stage("more", 2.0 * force),
    ]
    result = model.run(stages, **QUIET)
    np.testing.assert_allclose(
        result["slab"].x[model.forms["left"].numbers((0, 4))],
        result["alone"].x[model.forms["left"].numbers((0, 4))],
        rtol=1e-12,
    )
    assert abs(result["slab"].section_forces("slab").N).max() < 1e-12
    head = 64 / 3 / 2.0 + 4 / 1e4
    np.testing.assert_allclose(
        result["more"].section_forces("slab").N, -head / (head + 5 / 1e4), rtol=1e-7
    )
    model.run(stages[:2], **QUIET).save(tmp_path / "half.npz")
    again = model.run(stages[2:], start=sc.load_result(tmp_path / "half.npz", model), **QUIET)[
        "more"
    ]
    np.testing.assert_allclose(again.x, result["more"].x, rtol=1e-10, atol=1e-14)
    changed = model.run(
        [*stages, sc.Stage("warm", 2.0 * force, change={"slab": slab.heated(1e-4)})], **QUIET
    )["warm"]
    np.testing.assert_allclose(
        changed.section_forces("slab").N - result["more"].section_forces("slab").N,
        -5e-4 / (head + 5 / 1e4),
        rtol=1e-6,
    )


def block(n=(4, 2, 2), size=(2.0, 1.0, 1.0), E=1e3):
    """A block of Hex elements of second order and its form."""
    mesh = MeshHex.init_tensor(
        *(np.linspace(0.0, length, k + 1) for length, k in zip(size, n, strict=True))
    )
    basis = vector_basis(mesh.with_defaults(), "Q2", intorder=4)
    return basis, sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.0))


@pytest.mark.parametrize("kind", ["beam", "reinforcement"])
def test_bar_bonded_in_space(kind):
    """[X] In a block that is stretched by 1 % the beam has N = .01 EA."""
    basis, solid = block()
    line = [(0.0, 0.5, 0.5), (2.0, 0.5, 0.5)]
    bar = (
        sc.Beam(basis, line, EI=1.0, EA=500.0, bonded=True)
        if kind == "beam"
        else sc.Reinforcement(basis, line, EA=500.0, bonded=True)
    )
    left, right = (basis.get_dofs(side).all("u^1") for side in ("left", "right"))
    ends = [
        basis.get_dofs(lambda x: x[1] == 0.0).all("u^2"),
        basis.get_dofs(lambda x: x[2] == 0.0).all("u^3"),
    ]
    turned = bar.dofs((0.0, 0.5, 0.5), ["theta^1"]) if kind == "beam" else []
    stretch = basis.zeros()
    stretch[right] = 0.02
    model = sc.Model({"block": solid, "bar": bar}, [left, right, *ends, *turned])
    stage = model.run([sc.Stage("stretch", prescribed=stretch)], **QUIET)["stretch"]
    forces = stage.section_forces("bar")
    np.testing.assert_allclose(forces.N, 5.0, rtol=1e-9)
    assert len(forces.N) == 8


def test_beam_bonded_in_space_bends():
    """[X] A cantilever in a block that is 1e7 times as soft: P L^3 / 3 EI + P L / GA, and the
    moment P L.

    The block stiffens it by less than its own share, E I of the block over E I of the beam, 8e-7.
    """
    basis, solid = block(E=1e-4)
    beam = sc.Beam(
        basis,
        [(0.0, 0.5, 0.5), (1.0, 0.5, 0.5), (2.0, 0.5, 0.5)],
        EI=10.0,
        EA=1e4,
        GA=1e3,
        bonded=True,
    )
    model = sc.Model(
        {"block": solid, "beam": beam},
        [
            basis.get_dofs("left").all(),
            *beam.dofs((0, 0.5, 0.5), ["theta^1", "theta^2", "theta^3"]),
        ],
    )
    tip = (2.0, 0.5, 0.5)
    stage = model.run(
        [sc.Stage("load", model.forms["beam"].load((0.0, 0.0, -0.03), tip))], **QUIET
    )["load"]
    assert stage.x[sc.dofs_at(basis, tip)[0, 2]] == pytest.approx(
        -0.03 * 8 / 3 / 10.0 - 0.06 / 1e3, rel=1e-4
    )
    M = stage.section_forces("beam").towards((0.0, 0.0, 1.0)).M
    assert M[0] == pytest.approx(0.06, rel=1e-4)


def pile_on_a_line(h):
    """Settlement of a pile of 4 m along an edge inside a block, with elements h wide beside it."""
    x = np.concatenate((np.arange(0.0, 1.0, h), [1.0, 2.0, 4.0, 8.0]))
    x = np.concatenate((-x[:0:-1], x))
    mesh = MeshHex.init_tensor(
        x, x, np.array([-8.0, -6.0, -4.0, -3.0, -2.0, -1.0, 0.0])
    ).with_defaults()
    basis = vector_basis(mesh, "S2", intorder=4)
    pile = sc.Beam(basis, [(0.0, 0.0, 0.0), (0.0, 0.0, -4.0)], EI=1e6, EA=1e9, bonded=True)
    model = sc.Model(
        {"ground": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)), "pile": pile},
        [sc.box_supports(basis), *pile.dofs((0, 0, 0), ["theta^3"])],
    )
    stage = model.run(
        [sc.Stage("load", model.forms["pile"].load((0.0, 0.0, -10.0), (0, 0, 0)))], **QUIET
    )["load"]
    return stage.x[sc.dofs_at(basis, (0.0, 0.0, 0.0))[0, 2]]


@pytest.mark.slow
def test_a_line_in_space_has_no_stiffness():
    """[N] The warning tells how much more the next mesh gives, to a third of it: the foot's share
    is not counted.
    """
    with pytest.warns(sc.AnalysisWarning, match="bonded to a line of a solid") as caught:
        coarse = pile_on_a_line(1.0)
        fine = pile_on_a_line(0.5)
    told = float(str(caught[0].message).split("moves by ")[1].split("%")[0]) / 100.0
    assert told == pytest.approx(fine / coarse - 1.0, rel=0.33)
    assert len(caught) == 2


def test_share_of_a_line_under_a_uniform_load():
    """[X] A load q and its reaction move a line by u, with the same work: q log(2) / (4 pi G u)."""
    length, cells = np.array([1.0, 2.0]), np.array([[0, 1, 3], [1, 2, 4]])
    q, u, G = 5.0, 0.02, 100.0
    force, moved = np.zeros((2, 3, 3)), np.zeros((2, 3, 3))
    force[..., 2] = q * np.outer(length, [1.0, 1.0, 4.0]) / 6.0
    moved[..., 2] = u
    [remark] = of_a_line(length, cells, force.reshape(2, 9), moved.reshape(2, 9), G)
    assert remark.figure == pytest.approx(q * np.log(2.0) / (4.0 * np.pi * G * u), rel=1e-12)


@pytest.mark.parametrize(
    ("kind", "options", "wanted"),
    [
        (MeshHex, {"bonded": True}, 1e4 / 2.6),
        (MeshHex, {}, None),
        (MeshQuad, {"bonded": True}, None),
        (MeshQuad, {}, None),
    ],
)
def test_lines_in_space_that_are_bonded_know_the_shear_modulus(kind, options, wanted):
    """[X] E / (2 + 2 nu) of the stiffest ground; beams in the plane, and with nodes of their own,
    are no lines without stiffness.
    """
    dim = 3 if kind is MeshHex else 2
    mesh = kind.init_tensor(*[np.array([-1.0, 0.0, 1.0])] * dim).with_defaults()
    mesh = mesh.with_subdomains({"soft": lambda x: x[0] < 0, "stiff": lambda x: x[0] > 0})
    basis = vector_basis(mesh, "S2" if dim == 3 else "Q2", intorder=4)
    line = [(0.0,) * dim, (0.0,) * (dim - 1) + (-1.0,)]
    beam = sc.Beam(basis if options else None, line, EI=1.0, EA=1.0, **options)
    laws = {"soft": sc.LinearElastic(E=1e3, nu=0.3), "stiff": sc.LinearElastic(E=1e4, nu=0.3)}
    solid = sc.SolidForm(basis, laws)
    found = sc.Model({"ground": solid, "beam": beam}, np.arange(basis.N)).forms["beam"]._ground
    assert found == (wanted and pytest.approx(wanted, rel=1e-12))


def test_points_and_names_of_a_line_are_the_same():
    """[N] A beam bonded along points is that along the named line."""
    mesh = MeshTri.init_tensor(np.linspace(-1, 1, 9), np.linspace(-1, 0, 5)).with_defaults()
    basis = vector_basis(
        mesh.with_boundaries({"wall": lambda x: (x[0] == 0.0) & (x[1] > -0.6)}, False), "P2"
    )
    moved = []
    for line, more in (("wall", {}), ([(0.0, 0.0), (0.0, -0.5)], {"bonded": True})):
        wall = sc.Beam(basis, line, EI=1.0, EA=1e3, **more)
        forms = {"soil": sc.SolidForm(basis, sc.LinearElastic(E=10.0, nu=0.3)), "wall": wall}
        model = sc.Model(forms, sc.box_supports(basis))
        load = model.forms["wall"].load((0.01, 0.0), (0.0, 0.0))
        moved.append(model.run([sc.Stage("push", load)], **QUIET)["push"].section_forces("wall").M)
    np.testing.assert_allclose(moved[1], moved[0], rtol=1e-9, atol=1e-11)


def test_pile_joined_to_a_bonded_raft():
    """[X] A raft on the ground and an embedded pile under it: together they bear the load."""
    mesh = (
        MeshTri.init_tensor(np.linspace(-6, 6, 25), np.linspace(-8, 0, 17))
        .with_defaults()
        .with_boundaries({"raft": lambda x: (x[1] == 0.0) & (abs(x[0]) < 2.1)})
    )
    basis = vector_basis(mesh, "P2", intorder=2)
    raft = sc.Beam(basis, "raft", EI=1e5, EA=1e6)
    pile = sc.Beam(None, way((0.0, 0.0), (0.0, -5.0), n=5), EI=1e4, EA=1e6, joined_to=raft)
    forms = {
        "soil": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
        "raft": raft,
        "pile": pile,
        "skin": sc.Embedded(basis, pile, T_max=1e9),
    }
    model = sc.Model(forms, sc.box_supports(basis))
    load = sum(model.forms["raft"].load((0.0, -50.0), (x, 0.0)) for x in (-1.0, 1.0))
    stage = model.run([sc.Stage("load", load)], **QUIET)["load"]
    head = -stage.section_forces("pile").N[0]
    assert 20.0 < head < 90.0
    assert model.forms["pile"].numbers((0.0, 0.0))[1] == sc.dofs_at(basis, (0.0, 0.0))[0, 1]
    V = stage.section_forces("raft").V  # jumps where the pile is
    x = stage.section_forces("raft").x
    assert np.ptp(V[abs(x) < 1e-9]) == pytest.approx(head, rel=0.2)


LEG = sc.Beam(None, way((0, 0), (0, 3)), **STIFF)


@pytest.mark.parametrize(
    ("message", "call"),
    [
        (
            r"no node in common .* at \(1, 3\) and \(0, 3\)",
            lambda: sc.Beam(None, way((1, 3), (6, 3)), **STIFF, joined_to=LEG),
        ),
        (
            "joined to forms with as many",
            lambda: sc.Beam(None, way((0, 3, 0), (6, 3, 0)), **STIFF, joined_to=LEG),
        ),
        (
            "joined_to beams and shells, not to <Reinforcement",
            lambda: sc.Beam(
                None,
                way((0, 3), (6, 3)),
                **STIFF,
                joined_to=sc.Reinforcement(None, way((0, 0), (0, 3)), EA=1.0),
            ),
        ),
        (
            r"meet at \(0, 3\), but are not joined",
            lambda: sc.Beam(
                None,
                way((0, 3), (6, 3)),
                **STIFF,
                joined_to=[LEG, sc.Beam(None, way((0, 3), (0, 6)), **STIFF)],
            ),
        ),
        (
            "no elements meet at the hinge",
            lambda: sc.Beam(None, way((0, 3), (6, 3)), **STIFF, joined_to=LEG, hinges=(6.0, 3.0)),
        ),
        (
            r"join the other beam to it",
            lambda: sc.Beam(
                vector_basis(MeshTri().refined(1).with_defaults(), "P2"),
                "left",
                **STIFF,
                joined_to=sc.Beam(None, way((0, 0), (0, 1)), **STIFF),
            ),
        ),
        (
            r"0 vertices of the mesh lie at \(2, 0.5, 0.6\).* nearest is at \(2, 0.5, 0.5\)",
            lambda: sc.Beam(block()[0], [(0, 0.5, 0.5), (2, 0.5, 0.6)], **STIFF, bonded=True),
        ),
        (
            r"no edge between \(0, 0, 0\) and \(1, 0.5, 0.5\)",
            lambda: sc.Beam(block()[0], [(0, 0, 0), (2, 1, 1)], **STIFF, bonded=True),
        ),
        (
            "needs the basis of the ground",
            lambda: sc.Beam(None, way((0, 3), (6, 3)), **STIFF, bonded=True),
        ),
        (
            "take a basis of second order",
            lambda: sc.Beam(
                vector_basis(MeshHex().with_defaults(), "Q1"),
                [(0, 0, 0), (1, 0, 0)],
                **STIFF,
                bonded=True,
            ),
        ),
        (
            "joined to a form that is not in the model",
            lambda: sc.Model({"top": sc.Beam(None, way((0, 3), (6, 3)), **STIFF, joined_to=LEG)}),
        ),
    ],
)
def test_bad_input(message, call):
    with pytest.raises(ValueError, match=message):
        call()


def test_where_bodies_touch_the_basis_says_which():
    two = sc.join_bodies(
        {"low": grid("Q2", [0.0, 1.0], [0.0, 1.0]), "high": grid("Q2", [0.0, 1.0], [1.0, 2.0])}
    )
    basis = vector_basis(two, "Q2", intorder=4)
    with pytest.raises(ValueError, match="2 vertices of the mesh lie"):
        sc.Beam(basis, [(0.0, 1.0), (1.0, 1.0)], **STIFF, bonded=True)
    beam = sc.Beam(basis.with_elements("high"), [(0.0, 1.0), (1.0, 1.0)], **STIFF, bonded=True)
    assert np.isin(beam.shared, np.unique(basis.dofs.element_dofs[:, two.subdomains["high"]])).all()


@pytest.mark.parametrize("ground", [False, True])
def test_hinges_that_make_a_mechanism_of_joined_beams(ground):
    """A frame on four hinges sways, alone or beside ground that does not touch it; one clamped foot
    holds it.
    """
    left = sc.Beam(None, way((0, 0), (0, 3)), **STIFF)
    top = sc.Beam(None, way((0, 3), (6, 3)), **STIFF, joined_to=left, hinges=[(0, 3)])
    right = sc.Beam(None, way((6, 3), (6, 0)), **STIFF, joined_to=top, hinges=[(6, 3)])
    forms, fixed = {"left": left, "top": top, "right": right}, []
    for foot, beam in (((0, 0), left), ((6, 0), right)):
        fixed += beam.dofs(foot, ["u^1", "u^2"])
    if ground:
        basis = vector_basis(MeshTri().refined(1).with_defaults(), "P2", intorder=2)
        forms["ground"] = sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.3))
        fixed.append(sc.box_supports(basis))
    model = sc.Model(forms, fixed)
    with pytest.raises(ValueError, match=r"mechanism: .* the largest at "):
        model.run([sc.Stage("rest")], **QUIET)
    clamped = sc.Model(forms, [*fixed, *left.dofs((0, 0), ["theta"])])
    assert clamped.run([sc.Stage("load", clamped.forms["left"].load((1.0, 0.0), (0, 3)))], **QUIET)[
        "load"
    ].x.any()


def test_moments_of_all_members_in_one_picture():
    """Ordinates of one scale across the members, on the side in tension, also where there are no
    bodies.
    """
    stage = loaded(portal(False))
    forces = {name: stage.section_forces(name) for name in stage.forms}
    (axes,) = plot.diagram(forces, "M", on=stage, scale=2.0).axes
    lines = [line.get_xydata() for line in axes.lines]  # tips, then axes, of each member
    assert len(lines) == 6
    for (tips, axis), part in zip(
        zip(lines[::2], lines[1::2], strict=True), forces.values(), strict=True
    ):
        np.testing.assert_allclose(
            np.linalg.norm(tips - axis, axis=1), 2.0 * abs(part.M), atol=1e-12
        )
    left, M = lines[2] - lines[3], forces["left"].M  # upwards: positive moments to the left
    np.testing.assert_allclose(left[:, 0], -2.0 * M, atol=1e-12)
    assert len(axes.texts) == 6
    with pytest.raises(ValueError, match="quantity"):
        plot.diagram(forces, "pressure", on=stage)
