"""A boundary that moves as a rigid body: against the half-plane, in balance, guided, and at
collapse.
"""

from __future__ import annotations

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementQuad1,
    ElementQuad2,
    ElementTetP1,
    ElementTriP2,
    ElementVector,
    MeshQuad,
    MeshTet,
)

import skfem_contact as sc
from skfem_contact.results import Result
from tests.tools.footing_meshes import graded
from tests.tools.helpers import grid, vector_basis

E, NU, FORCE, LEVER = 1e4, 0.49, 100.0, 0.3


def ground(n: int, size: float) -> MeshQuad:
    """A half-plane of some size below a footing from -1 to 1, finest at its edges."""
    half = np.concatenate((1 - graded(1.0, n, 4.0)[::-1], 1 + graded(size - 1, n, 6.0)[1:]))
    mesh = MeshQuad.init_tensor(
        np.concatenate((-half[:0:-1], half)), -graded(size, 2 * n, 7.0)[::-1]
    )
    return mesh.with_boundaries({"footing": lambda p: (p[1] > -1e-9) & (abs(p[0]) < 1 + 1e-9)})


@pytest.fixture(scope="module", params=[True, False], ids=["turns", "guided"])
def elastic(request):
    basis = Basis(ground(8, 20.0), ElementVector(ElementQuad2()), intorder=4)
    footing = sc.RigidBoundary(basis, "footing", rotates=request.param)
    forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=NU)), "footing": footing}
    load = footing.load((0.0, -FORCE), at=(LEVER, 0.0))
    return (
        request.param,
        basis,
        footing,
        sc.Model(forms, sc.box_supports(basis)).run([sc.Stage("load", load)])["load"],
    )


def test_rotation_of_a_rigid_strip_on_the_half_plane(elastic):
    """[X] N. I. Muskhelishvili: 4 (1 - nu^2) M / (pi E b^2); the guided one does not turn."""
    turns, _, footing, stage = elastic
    left, right = (footing.motion(stage.x, (x, 0.0))[1] for x in (-1.0, 1.0))
    exact = -4 * (1 - NU**2) * FORCE * LEVER / (np.pi * E) if turns else 0.0
    assert (right - left) / 2 == pytest.approx(
        exact, rel=0.03, abs=1e-12
    )  # the mesh, and its end at 20 b


def test_it_stays_rigid_and_in_balance(elastic):
    """[X] Displacements of its nodes are those of a rigid body; the supports carry the force at its
    lever.
    """
    turns, basis, _, stage = elastic
    nodes = basis.get_dofs("footing")
    x, down = basis.doflocs[0, nodes.all("u^2")], stage.x[nodes.all("u^2")]
    assert np.ptp(stage.x[nodes.all("u^1")]) < 1e-12 * np.ptp(stage.x)
    assert np.abs(down - np.polyval(np.polyfit(x, down, 1), x)).max() < 1e-12 * np.ptp(stage.x)
    reactions = stage.reactions()[: basis.N].reshape(-1, 2)
    places = basis.doflocs[:, ::2]
    assert reactions[:, 1].sum() == pytest.approx(FORCE, rel=1e-6)  # Newton's tolerance is 1e-8
    if turns:
        moment = reactions[:, 1] @ places[0] - reactions[:, 0] @ places[1]
        assert moment == pytest.approx(FORCE * LEVER, rel=1e-6)


@pytest.mark.slow
def test_collapse_under_a_load_with_a_lever():
    """[X] (2 + pi) c in the middle; [B] above Meyerhof's effective width; [X] a circle's 0.69 c
    B^2.
    """
    c, width = 10.0, 2.0
    half = np.concatenate((1 - graded(1.0, 5, 2.0)[::-1], 1 + graded(3.0, 6, 3.0)[1:]))
    mesh = MeshQuad.init_tensor(np.concatenate((-half[:0:-1], half)), -graded(3.0, 9, 3.0)[::-1])
    mesh = mesh.to_meshtri(style="x").with_boundaries(
        {"footing": lambda p: (p[1] > -1e-9) & (abs(p[0]) < 1 + 1e-9)}
    )
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    footing = sc.RigidBoundary(basis, "footing")
    forms = {"clay": sc.SolidForm(basis, sc.Tresca(E=1e4, nu=0.45, c=c)), "footing": footing}

    def capacity(load):
        return (
            sc.Model(forms, sc.box_supports(basis))
            .limit_load(load, step=10.0, progress=False)
            .multiplier
        )

    def at(lever):
        return footing.load((0.0, -1.0), at=(lever, 0.0))

    central, inside, moment = (
        capacity(at(0.0)),
        capacity(at(0.25 * width)),
        capacity(at(1.0) - at(0.0)),
    )
    assert (
        1.0 < central / ((2 + np.pi) * c * width) < 1.04
    )  # from above, with quadratic triangles of this size
    assert inside > 0.5 * (2 + np.pi) * c * width
    assert 1.0 < moment / (0.6895 * c * width**2) < 1.08  # likewise, of first order at the edges


def test_displacements_are_counted_anew(elastic):
    """[X] The same load once more on the footing that has been reset: the same motion, and no jump
    in between.
    """
    _, basis, footing, stage = elastic
    forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=NU)), "footing": footing}
    reset = Result((stage,)).reset()
    stages = [sc.Stage("still", stage.load), sc.Stage("twice", 2.0 * stage.load)]
    still, twice = list(sc.Model(forms, sc.box_supports(basis)).run(stages, start=reset))[-2:]
    size = np.abs(stage.x[: basis.N]).max()
    assert np.abs(still.x[: basis.N]).max() < 1e-7 * size
    assert np.abs(twice.x - stage.x)[: basis.N].max() < 1e-7 * size


def test_a_cap_in_space():
    """[X] A block between rigid platens: nothing but what is asked of it, with all six motions
    free.
    """
    basis = Basis(MeshTet().refined(2).with_defaults(), ElementVector(ElementTetP1()), intorder=2)
    cap = sc.RigidBoundary(basis, "top")
    at = np.array([0.5, 1.0, 0.5])
    forms = {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.0)), "cap": cap}
    x = (
        sc.Model(forms, basis.get_dofs("bottom").all())
        .run([sc.Stage("pull", cap.load((0.0, 10.0, 0.0), at))])["pull"]
        .x
    )
    assert cap.motion(x, at) == pytest.approx((0.0, 0.01, 0.0), abs=1e-9)


def clay_under(footing_options, left=0.0, support=None):
    """Clay under a rigid strip from -1 to 1 or its right half: model, strip and their basis."""
    half = np.append(np.linspace(0, 1, 5), np.linspace(1, 5, 6)[1:])
    x = half if left == 0.0 else np.append(-half[:0:-1], half)
    mesh = MeshQuad.init_tensor(x, np.linspace(-3, 0, 7)).with_defaults()
    mesh = mesh.with_boundaries({"footing": lambda p: (p[1] > -1e-9) & (abs(p[0]) < 1 + 1e-9)})
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    footing = sc.RigidBoundary(basis, "footing", **footing_options)
    forms = {"ground": sc.SolidForm(basis, sc.Tresca(E=1e4, nu=0.45, c=20.0)), "footing": footing}
    fixed = sc.box_supports(basis) if support is None else support(basis)
    return sc.Model(forms, fixed), footing


@pytest.mark.parametrize("search", [False, True], ids=["stage", "search"])
def test_half_of_a_rigid_strip(search, recwarn):
    """[X] Symmetry: the half that is guided moves as the whole; one that may turn there is told."""

    def found(options, left, share):
        model, footing = clay_under(options, left)
        load = footing.load((0.0, -share), at=(0.0, 0.0))
        if search:
            limit = model.limit_load(load, step=20.0, tolerance=0.01, progress=False)
            return limit.multiplier
        end = model.run([sc.Stage("load", 10.0 * load)], progress=False)["load"]
        return footing.motion(end.x, (0.0, 0.0))[1]

    whole = found({}, -5.0, 2.0)
    half = found({"rotates": False}, 0.0, 1.0)
    assert half == pytest.approx(whole, rel=0.01 if search else 1e-9)
    assert not [text for text in recwarn if "rotates" in str(text.message)]
    with pytest.warns(sc.AnalysisWarning, match="ends at x = 0, .* rotates=False"):
        turned = found({}, 0.0, 1.0)
    assert abs(turned / whole - 1.0) > 0.2


def test_rigid_strip_that_is_held_at_one_node(recwarn):
    """A strip that supports keep from sliding, at one of its nodes, has no remark."""

    def one_node(basis):
        bottom = basis.get_dofs("bottom").all()
        corner = basis.get_dofs(lambda x: (x[0] < 1e-9) & (x[1] > -1e-9)).all("u^1")
        return np.append(bottom, corner)

    model, footing = clay_under({}, support=one_node)
    load = footing.load((0.0, -1.0), at=(0.5, 0.0))
    model.run([sc.Stage("load", load)], progress=False)
    assert not [text for text in recwarn if "rotates" in str(text.message)]


def test_two_footings_one_after_the_other():
    """[X] Two footings on one body, whose dofs the model numbers: both stay straight."""
    mesh = MeshQuad.init_tensor(np.linspace(0, 8, 17), np.linspace(0, 2, 5)).with_boundaries(
        {
            "left": lambda p: (p[1] > 2 - 1e-9) & (abs(p[0] - 2) < 1 + 1e-9),
            "right": lambda p: (p[1] > 2 - 1e-9) & (abs(p[0] - 6) < 1 + 1e-9),
        }
    )
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    left = sc.RigidBoundary(basis, "left")
    right = sc.RigidBoundary(basis, "right")
    forms = {
        "soil": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
        "left": left,
        "right": right,
    }
    load = left.load((0.0, -10.0), at=(2.3, 2.0)) + right.load((0.0, -10.0), at=(5.7, 2.0))
    stage = sc.Model(forms, sc.box_supports(basis)).run([sc.Stage("load", load)])["load"]
    sunk = []
    for name, footing in (("left", left), ("right", right)):
        down = basis.get_dofs(name).all("u^2")
        x = basis.doflocs[0, down]
        assert np.abs(
            stage.x[down] - np.polyval(np.polyfit(x, stage.x[down], 1), x)
        ).max() < 1e-10 * np.ptp(stage.x)
        sunk.append(
            [
                footing.motion(stage.x, (at, 2.0))[1]
                for at in ((1.0, 3.0) if name == "left" else (7.0, 5.0))
            ]
        )
    assert sunk[0] == pytest.approx(sunk[1], rel=1e-6)  # mirror images


def test_bad_input():
    basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad2()), intorder=4)
    with pytest.raises(ValueError, match=r"no boundary 'tip'; existing: bottom"):
        sc.RigidBoundary(basis, "tip")
    with pytest.raises(ValueError, match="belongs to no solid"):
        sc.Model({"cap": sc.RigidBoundary(basis, "top")}).run([sc.Stage("load", basis.zeros())])
    with pytest.raises(ValueError, match="force must be finite"):
        sc.RigidBoundary(basis, "top").load((0.0, np.nan), at=(0.0, 1.0))


def test_a_footing_that_is_held_besides(recwarn):
    """A single node that is held leads the others; so do several, but where they are moved apart,
    which is told.
    """
    basis = Basis(ground(4, 5.0), ElementVector(ElementQuad2()), intorder=4)
    footing = sc.RigidBoundary(basis, "footing", rotates=False)
    forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=NU)), "footing": footing}
    across, moved = basis.get_dofs("footing").all("u^1"), basis.zeros()
    moved[across] = 0.1
    stage, fixed = sc.Stage("push", basis.zeros(), prescribed=moved), sc.box_supports(basis)
    pushed = []
    for held in (across[:1], across):
        model = sc.Model(forms, np.append(fixed, held))
        pushed.append(model.run([stage], progress=False)["push"].x[: basis.N])
    assert not [text for text in recwarn if "stay rigid" in str(text.message)]
    assert pushed[0][across] == pytest.approx(0.1)
    assert pushed[1] == pytest.approx(pushed[0], abs=1e-10)  # round-off
    moved[across[0]] = 0.2
    with pytest.warns(sc.AnalysisWarning, match="push', footing: it does not stay rigid, by 4"):
        sc.Model(forms, np.append(fixed, across)).run([stage], progress=False)


def test_platen_between_smooth_walls():
    """[X] Supports hold both ends of the platen across: ground below half of a load settles as in
    an oedometer. Supports that come later move nothing.
    """
    mesh = MeshQuad.init_tensor(np.linspace(0, 2, 5), np.linspace(0, 1, 4)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    platen = sc.RigidBoundary(basis, "top", rotates=False)
    forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.3)), "platen": platen}
    model = sc.Model(forms, sc.box_supports(basis))
    load = platen.load((0.0, -FORCE), at=(0.5, 1.0))
    held = np.append(model.fixed, basis.get_dofs("top").all("u^1"))
    stages = [sc.Stage("load", load), sc.Stage("held", load, fixed=held)]
    result = model.run(stages, progress=False)
    modulus = E * (1 - 0.3) / (1 + 0.3) / (1 - 2 * 0.3)
    for stage in result:
        sunk = stage.x[basis.get_dofs("top").all("u^2")]
        assert sunk == pytest.approx(-FORCE / 2 / modulus, rel=1e-9)  # round-off


@pytest.mark.parametrize("inner", [0.0, 1.0], ids=["disc", "ring"])
@pytest.mark.parametrize("rotates", [True, False])
def test_rigid_rings_move_along_the_axis(inner, rotates):
    """[X] A rigid body about an axis neither turns nor grows: it sinks as nodes that are held
    across and moved down.
    """
    mesh = MeshQuad.init_tensor(np.linspace(0, 6, 13), np.linspace(-4, 0, 9)).with_defaults()
    mesh = mesh.with_boundaries({"ring": lambda x: (x[1] > -1e-9) & (x[0] > inner) & (x[0] < 2)})
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    soil = sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.3), coordinates="axisymmetric")
    ring = sc.RigidBoundary(basis, "ring", rotates=rotates)
    model = sc.Model({"soil": soil, "ring": ring}, sc.box_supports(basis))
    stage = sc.Stage("load", ring.load((0.0, -FORCE), at=(1.9, 0.0)))
    end = model.run([stage], progress=False)["load"]
    moved = basis.zeros()
    down = basis.get_dofs("ring").all("u^2")
    moved[down] = ring.motion(end.x, (1.5, 0.0))[1]
    held = sc.Model({"soil": soil}, np.append(model.fixed, basis.get_dofs("ring").all()))
    pressed = held.run([sc.Stage("press", prescribed=moved)], progress=False)["press"]
    assert end.x[: basis.N] == pytest.approx(pressed.x, abs=1e-12)  # round-off
    assert pressed.reactions()[down].sum() == pytest.approx(-FORCE, rel=1e-9)


def test_a_footing_on_contact_goes_on_from_a_start():
    """Its multipliers stand behind the displacements that the contact knows."""
    meshes = {
        name: grid("Q1", np.linspace(0, 1, 4), np.linspace(k, k + 1, 4))
        for k, name in enumerate("ab")
    }
    basis = vector_basis(sc.join_bodies(meshes), "Q1", intorder=2)
    forms = {
        "bodies": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.3)),
        "joint": sc.ContactPair(basis, "b:bottom", "a:top", sc.Coulomb(0.3)),
        "footing": (footing := sc.RigidBoundary(basis, "b:top")),
    }
    down, fixed = footing.load((0.0, -FORCE), at=(0.6, 2.0)), basis.get_dofs("a:bottom").all()
    stages = [sc.Stage("half", 0.5 * down), sc.Stage("whole", down)]
    both = sc.Model(forms, fixed).run(stages, progress=False)
    start = sc.Model(forms, fixed).run(stages[:1], progress=False)
    again = sc.Model(forms, fixed).run(stages[1:], start=start, progress=False)
    assert again["whole"].x == pytest.approx(both["whole"].x, abs=1e-12)


def test_displacements_of_a_limit_load():
    """Those of the ground and the footing, in metres: multipliers, which are forces, do not
    count.
    """
    basis = Basis(ground(4, 5.0), ElementVector(ElementQuad2()), intorder=4)
    footing = sc.RigidBoundary(basis, "footing")
    clay = sc.SolidForm(basis, sc.Tresca(E=1e5, nu=0.45, c=20.0))
    found = sc.Model({"clay": clay, "footing": footing}, sc.box_supports(basis)).limit_load(
        footing.load((0.0, -1.0), at=(LEVER, 0.0)), step=20.0, progress=False
    )
    assert found.curve[-1, 2] == pytest.approx(np.abs(found.end.x[: basis.N]).max(), rel=1e-12)


QUIET = {"progress": False}


def test_two_rigid_boundaries():
    """[X] Two equal footings share no dofs: the loaded one stays straight."""
    mesh = MeshQuad.init_tensor(np.linspace(0, 4, 17), np.linspace(0, 2, 9)).with_boundaries(
        {
            "bottom": lambda x: x[1] < 1e-9,
            "left footing": lambda x: (x[1] > 2 - 1e-9) & (x[0] < 1 + 1e-9),
            "right footing": lambda x: (x[1] > 2 - 1e-9) & (x[0] > 3 - 1e-9),
        }
    )
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    left, right = (sc.RigidBoundary(basis, f"{side} footing") for side in ("left", "right"))
    forms = {
        "soil": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3)),
        "left": left,
        "right": right,
    }
    stage = sc.Stage("load", left.load((0.0, -10.0), at=(0.5, 2.0)))
    x = sc.Model(forms, basis.get_dofs("bottom").all()).run([stage], **QUIET)["load"].x
    dofs = basis.get_dofs("left footing").all("u^2")
    at, down = basis.doflocs[0, dofs], x[dofs]
    assert np.abs(down - np.polyval(np.polyfit(at, down, 1), at)).max() < 1e-9 * np.abs(down).max()
