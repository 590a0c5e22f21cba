"""Scenes from outside that contact once answered wrongly, or not at all, with what is known of
them.
"""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest
from skfem import Basis, ElementTriP2, ElementVector, FacetBasis, LinearForm, MeshQuad, MeshTri

import skfem_contact as sc
from skfem_contact.contact.penalty import choose_penalties
from skfem_contact.results import StageResult
from tests.tools import space
from tests.tools.helpers import grid, traction, unknowns_of, vector_basis


def kinked_blocks(phase: float, mu: float):
    """A block that overlaps a base by .01, both along a wave whose joints turn, pressed and then
    sheared.
    """

    def bent(bottom, x0, x1, low):
        mesh = grid("Q1", np.linspace(x0, x1, 5), np.array([bottom, bottom + 0.6]))
        share = (mesh.p[1] - bottom) / 0.6
        up = (share if low else 1 - share) * 0.05 * np.sin(5 * mesh.p[0] + phase)
        return replace(mesh, doflocs=mesh.p + np.stack((0 * up, up)))

    bodies = {"base": bent(-0.6, -0.5, 1.5, True), "block": bent(-0.01, 0.0, 1.0, False)}
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    forms = {
        "solid": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
        "joint": sc.ContactPair(
            basis,
            "block:bottom",
            "base:top",
            sc.Coulomb(mu),
            quadrature="nodal",
            initial="adjusted",
        ),
    }
    top, stages = basis.get_dofs("block:top"), []
    for name, along, down in (("press", 0.0, 0.0154), ("shear", 0.0055, 0.0092)):
        x = basis.zeros()
        x[top.all("u^1")], x[top.all("u^2")] = along, -down
        stages.append(sc.Stage(name, basis.zeros(), x))
    return forms, stages, np.union1d(basis.get_dofs("base:bottom").all(), top.all())


@pytest.mark.parametrize(("phase", "mu"), [(0.8, 1.0), (2.4, 0.6)])
@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
def test_what_is_accepted_balances(phase: float, mu: float) -> None:
    """[X] Equilibrium: forces assembled again at every accepted stage balance, and a run goes on
    from there.

    Locked to facets that they have left, points were in balance only until they were free.
    """
    forms, stages, fixed = kinked_blocks(phase, mu)
    try:
        # fewer iterations than by default: the stages that fail try hundreds of increments
        result = sc.Model(forms, fixed, newton=sc.Newton(max_iterations=8)).run(
            stages, progress=False
        )
    except sc.NotConverged as error:
        result = error.result
        assert phase != 0.8  # where points rest on facets
    assert len(result) >= 1
    for stage in result:
        left = stage.reactions()
        # ten times the tolerance of Newton's method, which the accepted increment met
        assert np.abs(np.delete(left, fixed)).max() <= 1e-7 * np.abs(left[fixed]).max()
        again = sc.Model(forms, fixed).run(
            [sc.Stage("nothing", stage.load, stage.x)], start=stage, progress=False
        )
        np.testing.assert_allclose(again[-1].x, stage.x, atol=1e-9)


@pytest.mark.parametrize(("element", "n"), [("Q1", 16), ("Q2", 10)])
@pytest.mark.parametrize("quadrature", [4, "segments"])
def test_receding_contact(quadrature, element: str, n: int) -> None:
    """[X] A layer lifts off where it is not loaded: in one increment, over a length that the load
    does not change.

    Newton's method needs more iterations than it is given, for almost each of them finds another
    active set.
    """
    steps = 1.15 ** np.arange(27)
    x = np.concatenate((np.linspace(0, 2, 2 * n + 1), 2 + 8 * np.cumsum(steps) / steps.sum()))
    mesh = grid(element, x, np.linspace(0, 1, n + 1))
    mesh = mesh.with_boundaries(
        {"strip": lambda p: (p[1] > 1 - 1e-9) & (p[0] < 0.25)}, boundaries_only=False
    )
    basis = vector_basis(mesh, element, intorder=4)
    floor = sc.rigid.line((-5.0, 0.0), (20.0, 0.0))
    forms = {
        "layer": sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.3)),
        "floor": sc.ContactPair(basis, "bottom", floor, sc.Coulomb(), quadrature),
    }
    ends = []
    for load in (1e-4, 1e-6):
        force = traction(basis, "strip", (0.0, -load))
        stage = sc.Model(forms, basis.get_dofs("left").all("u^1")).run(
            [sc.Stage("press", force)], progress=False
        )["press"]
        assert len(stage.iterations) == 1
        joint = stage.tractions("floor")
        ends.append(joint.x[joint.pressure > 1e-3 * joint.pressure.max()].max())
    assert ends[0] == pytest.approx(ends[1], abs=1e-9)  # the same points
    # the same end for all rules and elements to half an element
    assert ends[0] == pytest.approx(0.875, abs=0.5 / n)


@pytest.mark.parametrize("element", ["Q1", "Q2", "P2"])
@pytest.mark.parametrize(("lower", "upper"), [(2, 3), (3, 2), (5, 7)])
def test_default_passes_the_patch_test(element: str, lower: int, upper: int) -> None:
    """[X] A uniform pressure passes through meshes that do not match, by the rule that nobody has
    to ask for.
    """
    bodies = {
        "low": grid(element, np.linspace(0, 1, lower + 1), np.linspace(-1, 0, lower + 1)),
        "up": grid(element, np.linspace(0, 1, upper + 1), np.linspace(0, 1, upper + 1)),
    }
    basis = vector_basis(sc.join_bodies(bodies), element, intorder=4)
    forms = {
        "blocks": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3)),
        "joint": sc.ContactPair(basis, "up:bottom", "low:top", sc.Coulomb()),
    }
    guided = basis.get_dofs({"low:left", "up:left"}).all("u^1")
    stage = sc.Stage("press", traction(basis, "up:top", (0.0, -1.0)))
    result = sc.Model(forms, np.union1d(basis.get_dofs("low:bottom").all("u^2"), guided)).run(
        [stage], progress=False
    )
    # round-off: both meshes' shape functions are integrated exactly
    np.testing.assert_allclose(result["press"].states["blocks"].stress[1], -1.0, atol=1e-11)


@pytest.mark.parametrize(("given", "warned"), [(1.0, True), (0.2, True), (1e3, False)])
def test_penalty_in_a_wrong_unit(given: float, warned: bool) -> None:
    """[X] A modulus in the place of a stress per length: blocks in metres shorten by half as much
    again: a warning.

    Two blocks, each 1 high and free to spread, shorten by 2 p (1 - nu^2) / E.
    """
    E, nu, pressure = 30e6, 0.3, 1e3
    bodies = {
        "low": grid("Q1", np.linspace(0, 1, 17), np.linspace(-1, 0, 17)),
        "up": grid("Q1", np.linspace(0, 1, 21), np.linspace(0, 1, 21)),
    }
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    forms = {
        "blocks": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=nu)),
        "joint": sc.ContactPair(basis, "up:bottom", "low:top", sc.Coulomb(), penalty=given * E),
    }
    guided = basis.get_dofs({"low:left", "up:left"}).all("u^1")
    fixed = np.union1d(basis.get_dofs("low:bottom").all("u^2"), guided)
    stage = sc.Stage("press", traction(basis, "up:top", (0.0, -pressure)))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        x = sc.Model(forms, fixed).run([stage], progress=False)["press"].x
    assert any("softer than the surfaces" in str(warning.message) for warning in caught) == warned
    short = -x[basis.get_dofs("up:top").all("u^2")].mean()
    # the blocks, and the penalty in series
    assert short == pytest.approx(2 * pressure * (1 - nu**2) / E + pressure / (given * E), rel=1e-6)


@pytest.mark.parametrize(
    ("initial", "gap"), [("as meshed", 0.0), ("adjusted", 0.01), ("adjusted", -0.01)]
)
@pytest.mark.parametrize("quadrature", ["nodal", "segments"])
@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
def test_resultant_of_the_report_is_that_of_nodal_forces(
    quadrature, initial: str, gap: float
) -> None:
    """[X] On a coarse bent floor that is smoothed, where gaps lengthen the arm of friction."""

    def bent(bottom, x0, x1, low):
        mesh = grid("Q1", np.linspace(x0, x1, 4), np.array([bottom, bottom + 0.6]))
        share = (mesh.p[1] - bottom) / 0.6
        up = (share if low else 1 - share) * 0.08 * np.sin(6 * mesh.p[0] + 5)
        return replace(mesh, doflocs=mesh.p + np.stack((0 * up, up)))

    bodies = {"base": bent(-0.6, -0.5, 1.5, True), "block": bent(gap, 0.0, 1.0, False)}
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    forms = choose_penalties(
        {
            "solid": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
            "joint": sc.ContactPair(
                basis,
                "block:bottom",
                "base:top",
                sc.Coulomb(0.6),
                quadrature,
                smoothing=0.3,
                initial=initial,
            ),
        }
    )
    top, x = basis.get_dofs("block:top"), basis.zeros()
    x[top.all("u^1")], x[top.all("u^2")] = -0.045, -0.026
    fixed = np.union1d(basis.get_dofs("base:bottom").all(), top.all())
    stage = sc.Model(forms, fixed).run([sc.Stage("pressed", basis.zeros(), x)], progress=False)[
        "pressed"
    ]
    nodal = (
        -forms["joint"]
        .assemble(stage.x, stage.states["joint"])
        .force[unknowns_of(basis, "block")]
        .sum(axis=0)
    )
    report = stage.report("joint")
    np.testing.assert_allclose(report.force, nodal, rtol=1e-12)


@pytest.mark.parametrize("element", ["Q1", "Q2", "P2"])
@pytest.mark.parametrize("augmented", [False, True])
@pytest.mark.parametrize(("quadrature", "upper"), [("segments", 5), ("segments", 2), ("nodal", 3)])
def test_patch_in_axial_symmetry(quadrature, upper: int, augmented: bool, element: str) -> None:
    """[X] A uniform pressure passes from cylinder to cylinder: contact counts its forces per radian
    as solids do.
    """
    bodies = {
        "low": grid(element, np.linspace(0, 1, 4), np.linspace(-1, 0, 3)),
        "up": grid(element, np.linspace(0, 1, upper + 1), np.linspace(0, 1, 3)),
    }
    basis = vector_basis(sc.join_bodies(bodies), element, intorder=4)
    enforcement = sc.AugmentedLagrangian() if augmented else None
    options = {"quadrature": quadrature, "enforcement": enforcement}
    forms = {
        "solids": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3), coordinates="axisymmetric"),
        "joint": sc.ContactPair(basis, "up:bottom", "low:top", sc.Coulomb(), **options),
    }
    axis = basis.get_dofs({"low:left", "up:left"}).all("u^1")
    fixed = np.union1d(basis.get_dofs("low:bottom").all("u^2"), axis)
    load = sc.traction(forms["solids"], "up:top", (0.0, -1.0))
    stage = sc.Model(forms, fixed).run([sc.Stage("press", load)], progress=False)["press"]
    # round-off: shape functions and radius are integrated exactly
    np.testing.assert_allclose(stage.states["solids"].stress[1], -1.0, atol=1e-10)
    np.testing.assert_allclose(stage.states["joint"].traction[0], -1.0, atol=1e-10)
    joint = stage.tractions("joint")
    assert (joint.pressure * joint.weight).sum() == pytest.approx(
        0.5
    )  # of a circle of radius 1, per radian


@pytest.mark.parametrize("quadrature", [1, 2, 3])
def test_fewer_points_than_multipliers(quadrature: int) -> None:
    """[X] One or two Gauss points on a quadratic facet: the blocks shorten as if they were one, and
    nothing is NaN.
    """
    bodies = {"low": grid("Q2", [0, 0.5, 1], [-1, 0]), "up": grid("Q2", [0, 0.5, 1], [0, 1])}
    basis = vector_basis(sc.join_bodies(bodies), "Q2")
    enforcement = sc.AugmentedLagrangian(tolerance=1e-6)
    forms = {
        "blocks": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3)),
        "joint": sc.ContactPair(
            basis, "up:bottom", "low:top", sc.Coulomb(), quadrature, enforcement=enforcement
        ),
    }
    guided = basis.get_dofs({"low:left", "up:left"}).all("u^1")
    stage = sc.Stage("press", traction(basis, "up:top", (0.0, -1.0)))
    result = sc.Model(forms, np.union1d(basis.get_dofs("low:bottom").all("u^2"), guided)).run(
        [stage], progress=False
    )
    assert np.isfinite(result["press"].states["joint"].multiplier).all()
    short = -result["press"].x[basis.get_dofs("up:top").all("u^2")].mean()
    # ten times the tolerance; one point leaves the ends of the facets free to part, by less than
    # they are strained
    assert short == pytest.approx(2 * (1 - 0.3**2) / 1e3, rel=1e-5 if quadrature > 1 else 0.1)


@pytest.mark.parametrize("augmented", [False, True])
@pytest.mark.parametrize("quadrature", ["nodal", 2, "segments"])
def test_an_interference_that_is_resolved_does_not_come_back(quadrature, augmented: bool) -> None:
    """[X] After displacements are counted anew, a stage without load moves nothing: the fit was
    made before.
    """
    bodies = {
        "low": grid("Q1", np.linspace(-0.5, 1.5, 7), [-1.0, -0.5, 0.0]),
        "up": grid("Q1", np.linspace(0, 1, 6), [-0.01, 0.5, 1.0]),
    }
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    enforcement = sc.AugmentedLagrangian() if augmented else None
    options = {"quadrature": quadrature, "enforcement": enforcement, "initial": "ramped"}
    forms = {
        "solid": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3)),
        "joint": sc.ContactPair(basis, "up:bottom", "low:top", sc.Coulomb(0.3), **options),
    }
    fixed, none = basis.get_dofs({"low:bottom", "up:top"}).all(), basis.zeros()
    fit = sc.Model(forms, fixed).run([sc.Stage("fit", none)], progress=False)
    start = fit.reset()
    new = sc.Model(forms, fixed).run(
        [sc.Stage("nothing", none, none)], start=start, progress=False
    )["nothing"]
    # the strain of the fit, 1 %, is gone from the places where contact acts: this turns and moves
    # its forces
    assert np.abs(new.x).max() < 0.01 * np.abs(fit["fit"].x).max()


# -- augmented Lagrangian: its tolerance is that of the result
# ------------------------------------------------------

AUGMENTED = sc.AugmentedLagrangian()


def inclined(n_base: int, n_block: int, stiffer: float):
    """A block on a base along a slope of 1 : 10, pressed and dragged to either side by its top."""

    def body(x, bottom, low):
        mesh = grid("Q1", x, bottom + np.linspace(0.0, 0.6, 3))
        share = (mesh.p[1] - bottom) / 0.6
        up = (share if low else 1 - share) * 0.1 * mesh.p[0]
        return replace(mesh, doflocs=mesh.p + np.stack((0 * up, up)))

    bodies = {
        "base": body(np.linspace(-0.3, 1.3, n_base + 1), -0.6, True),
        "block": body(np.linspace(0, 1, n_block + 1), 0.0, False),
    }
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=4)
    soft, stiff = sc.LinearElastic(E=1e4, nu=0.3), sc.LinearElastic(E=1e4 * stiffer, nu=0.3)
    solid = sc.SolidForm(basis, {"base": soft, "block": stiff})
    top, dragged = basis.get_dofs("block:top"), []
    for along in (0.004, -0.004):
        dragged.append(basis.zeros())
        dragged[-1][top.all("u^1")], dragged[-1][top.all("u^2")] = along, -0.01
    return basis, solid, dragged, np.union1d(basis.get_dofs("base:bottom").all(), top.all())


@pytest.mark.parametrize("passes", [1, 2])
@pytest.mark.parametrize(("meshes", "stiffer"), [((3, 5), 2e4), ((7, 4), 1.0)])
@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
def test_null_stage_moves_nothing(meshes, stiffer: float, passes: int) -> None:
    """[X] What multipliers leave at the end of a stage is not taken up again where nothing
    changes.
    """
    basis, solid, (there, back), fixed = inclined(*meshes, stiffer)
    names, rule = ("block:bottom", "base:top"), {"quadrature": 2, "enforcement": AUGMENTED}
    pairs = {"joint": sc.ContactPair(basis, *names, sc.Coulomb(0.3), **rule)}
    if passes == 2:
        pairs = dict(sc.ContactPair.two_pass(basis, *names, sc.Coulomb(0.3), **rule))
    stages = [
        sc.Stage(name, basis.zeros(), x)
        for name, x in (("there", there), ("back", back), ("again", back))
    ]
    result = sc.Model({"solid": solid, **pairs}, fixed).run(stages, progress=False)
    # twice the tolerance of Newton's method, which may improve what it has accepted
    np.testing.assert_allclose(result[2].x, result[1].x, atol=2e-8 * np.abs(back).max())


@pytest.mark.parametrize("quadrature", [2, "segments"])
def test_tie_of_unlike_bodies_by_multipliers(quadrature) -> None:
    """[X] 7 elements of a stiff block tied to 3 of a soft cap: the penalty's tractions within 1 %,
    no 30 rounds.
    """
    bodies = {
        "block": grid("Q1", np.linspace(0, 1, 8), np.linspace(0, 0.6, 3)),
        "cap": grid("Q1", np.linspace(0, 1, 4), np.linspace(0.6, 1.2, 2)),
    }
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    materials = {"block": sc.LinearElastic(E=1.4e5, nu=0.1), "cap": sc.LinearElastic(E=1e4, nu=0.3)}
    top, down, forces = basis.get_dofs("cap:top"), basis.zeros(), []
    down[top.all("u^2")] = -0.016
    fixed = np.union1d(basis.get_dofs("block:bottom").all(), top.all())
    for rule in ({"enforcement": AUGMENTED}, {"penalty": 1e7}):
        forms = {
            "solid": sc.SolidForm(basis, materials, strain="b_bar"),
            "tie": sc.ContactPair(basis, "block:top", "cap:bottom", sc.Tied(), quadrature, **rule),
        }
        stage = sc.Model(forms, fixed).run(
            [sc.Stage("press", basis.zeros(), down)], progress=False
        )["press"]
        assert len(stage.iterations) == 1
        assert stage.iterations[0] <= 40  # measured 20 to 26
        forces.append(stage.report("tie").force[1])
    assert forces[0] == pytest.approx(forces[1], rel=0.01)


# -- warnings: the penalty's share, facets that overlap, joints of the master
# ---------------------------------------


def remarked(forms, stage, fixed) -> tuple[StageResult, str]:
    """A stage, and what is warned of of it."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = sc.Model(forms, fixed).run([stage], progress=False)
    return result[0], "; ".join(str(warning.message) for warning in caught)


@pytest.mark.parametrize(("n", "share"), [(3, 0.044), (7, 0.018), (20, None)])
def test_share_of_the_default_penalty(n: int, share: float | None) -> None:
    """[X] Two blocks shorten by 2 p (1 - nu^2) / E, and by what the penalty gives way, which is
    warned of above 1 %.
    """
    E, nu, pressure = 30e6, 0.3, 1e3
    bodies = {
        "low": grid("Q1", np.linspace(0, 1, n + 1), np.linspace(-1, 0, n + 1)),
        "up": grid("Q1", np.linspace(0, 1, n + 2), np.linspace(0, 1, n + 2)),
    }
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    forms = choose_penalties(
        {
            "blocks": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=nu)),
            "joint": sc.ContactPair(basis, "up:bottom", "low:top", sc.Coulomb()),
        }
    )
    guided = basis.get_dofs({"low:left", "up:left"}).all("u^1")
    fixed = np.union1d(basis.get_dofs("low:bottom").all("u^2"), guided)
    stage, remarks = remarked(
        forms, sc.Stage("press", traction(basis, "up:top", (0.0, -pressure))), fixed
    )
    short, way = (
        -stage.x[basis.get_dofs("up:top").all("u^2")].mean(),
        pressure / forms["joint"].penalty[0],
    )
    assert short == pytest.approx(2 * pressure * (1 - nu**2) / E + way, rel=1e-6)
    assert ("of the largest displacement" in remarks) == (share is not None)
    if share is not None:
        assert way / short == pytest.approx(share, abs=0.003)
        assert f"penalty compliance is {way / short:.1%} of" in remarks


@pytest.mark.parametrize("n", [3, 20])
def test_share_of_the_tangential_penalty(n: int) -> None:
    """[X] Two stuck blocks in pure shear move by 2 t / G, and by what the penalty gives way, warned
    of above 1 %.
    """
    E, nu, shear, mu, depth = 30e6, 0.3, 1e3, 100.0, 1e-7
    bodies = {
        name: grid("Q1", np.linspace(0, 1, m + 1), np.linspace(y, y + 1, m + 1))
        for name, m, y in (("low", n, -1), ("up", n + 1, 0))
    }
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    forms = choose_penalties(
        {
            "blocks": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=nu)),
            "joint": sc.ContactPair(
                basis, "up:bottom", "low:top", sc.Coulomb(mu=mu), initial="adjusted"
            ),
        }
    )
    pressed = basis.zeros()
    pressed[basis.get_dofs(elements="up").all("u^2")] = -depth
    fixed = np.union1d(basis.get_dofs("low:bottom").all(), np.unique(basis.dofs.element_dofs[1::2]))
    stage, remarks = remarked(
        forms, sc.Stage("shear", traction(basis, "up:top", (shear, 0.0)), pressed), fixed
    )
    moved, way = (
        stage.x[basis.get_dofs("up:top").all("u^1")].mean(),
        shear / forms["joint"].penalty[1],
    )
    assert moved == pytest.approx(4 * shear * (1 + nu) / E + way, rel=1e-6)
    assert ("of the largest displacement" in remarks) == (n == 3)
    if n == 3:
        assert f"tangential penalty compliance is {way / moved:.1%} of" in remarks


def annulus(inner: float, outer: float, n: int, layers: int):
    """A ring of straight facets; "inner" and "outer" are its faces."""
    radii, angles = np.linspace(inner, outer, layers + 1), 2 * np.pi * np.arange(n) / n
    p = np.array([np.outer(radii, f(angles)).ravel() for f in (np.cos, np.sin)])
    i, j = (k.ravel() for k in np.indices((layers, n)))
    t = np.array([i * n + j, (i + 1) * n + j, (i + 1) * n + (j + 1) % n, i * n + (j + 1) % n])
    middle = 0.5 * (inner + outer)
    faces = {"inner": lambda x: np.hypot(*x) < middle, "outer": lambda x: np.hypot(*x) > middle}
    return MeshQuad(p, t).with_boundaries(faces)


def fitted(disc: int, ring: int, *rule, **options):
    """A ring pressed onto a disc: mean pressure over Lame's, torque over the sum of all pressure,
    what is warned of.
    """
    a, b, c, pressure = 0.3, 1.0, 1.5, 10.0
    mesh = sc.join_bodies({"disc": annulus(a, b, disc, 5), "ring": annulus(b, c, ring, 4)})
    basis = vector_basis(mesh, "Q1", intorder=4)
    pair = sc.ContactPair(basis, "ring:inner", "disc:outer", sc.Coulomb(), *rule, **options)
    forms = choose_penalties(
        {"bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=0.25)), "joint": pair}
    )
    load = LinearForm(lambda v, w: -pressure * (w.x[0] * v[0] + w.x[1] * v[1]) / np.hypot(*w.x))
    load = load.assemble(FacetBasis(mesh, basis.elem, facets="ring:outer", intorder=4))
    held = [
        basis.nodal_dofs[component, np.argmin(np.hypot(mesh.p[0] - x, mesh.p[1] - y))]
        for r in (a, c)
        for x, y, component in ((r, 0, 1), (0, r, 0), (-r, 0, 1))
    ]
    stage, remarks = remarked(forms, sc.Stage("press", load), np.array(held))
    x, y = basis.doflocs[:, 0::2] + stage.x.reshape(-1, 2).T
    force = forms["joint"].assemble(stage.x, stage.states["joint"]).force.reshape(-1, 2)
    on = np.unique(mesh.t[:, mesh.subdomains["ring"]])
    joint = forms["joint"].points(stage.states["joint"]).weight * -stage.states["joint"].traction[0]
    length = forms["joint"].slave.area.sum()
    exact = pressure * c**2 / (c**2 - a**2) * (1 - a**2 / b**2)
    return (
        joint.sum() / length / exact,
        (x * force[:, 1] - y * force[:, 0])[on].sum() / joint.sum(),
        remarks,
    )


@pytest.mark.parametrize("rule", [2, "segments"])
@pytest.mark.parametrize(("disc", "ring"), [(128, 100), (100, 128)])
def test_overlaps_of_straight_facets_are_warned_of(rule, disc: int, ring: int) -> None:
    """[X] Facets of round meshes that do not match overlap by more than the load presses; adjusted
    they do not.
    """
    mean, _, remarks = fitted(disc, ring, rule)
    assert mean > 3.0 and "overlap" in remarks
    mean, _, remarks = fitted(disc, ring, rule, initial="adjusted")
    assert mean == pytest.approx(
        1.0, abs=0.01
    )  # polygons of 100 sides, elements of 1/4; measured -0.5 %
    assert "overlap" not in remarks


def test_a_pressure_at_the_start_is_no_overlap() -> None:
    """[X] Ground at rest beside a wall, facet on facet: its pressure grows along each of them, and
    nothing overlaps.
    """
    depths = np.linspace(0, 4, 4)
    bodies = {"soil": grid("Q1", np.linspace(0, 4, 4), depths), "wall": grid("Q1", [4, 5], depths)}
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    ground = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3))
    joint = sc.ContactPair(basis, "soil:right", "wall:left", sc.Coulomb(), penalty=5e3)
    forms, load = {"ground": ground, "joint": joint}, sc.weight(basis, 20.0)
    fixed = np.append(
        basis.get_dofs({"soil:bottom", "wall:bottom", "wall:right"}).all(), sc.box_supports(basis)
    )
    start = sc.Model(forms, fixed).k0_state(load, unit_weights=20.0, K0=0.5)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        sc.Model(forms, fixed).run([sc.Stage("more", 1.01 * load)], start=start, progress=False)
    assert "overlap" not in "; ".join(str(warning.message) for warning in caught)


@pytest.mark.parametrize(("factor", "told"), [(1.0 + 1e-5, False), (2.0, True)])
def test_share_of_the_penalty_in_ground_at_rest(factor: float, told: bool) -> None:
    """[X] Where nothing moves the penalty has a share of nothing: no remark, as there is of the
    load's double.
    """
    levels = np.linspace(0, 1, 4)
    bodies = {name: grid("Q1", levels, levels + y) for name, y in (("low", -1), ("up", 0))}
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    joint = sc.ContactPair(basis, "up:bottom", "low:top", sc.Coulomb())
    forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)), "joint": joint}
    guided = basis.get_dofs({"low:left", "up:left", "low:right", "up:right"}).all("u^1")
    model, load = (
        sc.Model(forms, [basis.get_dofs("low:bottom").all(), guided]),
        sc.weight(basis, 20.0),
    )
    start = model.k0_state(load, unit_weights=20.0, K0=0.5)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model.run([sc.Stage("more", factor * load)], start=start, progress=False)
    assert ("penalty compliance" in "; ".join(str(warning.message) for warning in caught)) == told


@pytest.mark.parametrize("n", [40, 128])
def test_nodes_at_joints_are_warned_of(n: int) -> None:
    """[X] Nodes that face joints belong to the facet before: a torque without friction, of
    sin(pi/n): a warning.
    """
    _, torque, remarks = fitted(n, n, "nodal")
    assert abs(torque) == pytest.approx(np.sin(np.pi / n), rel=0.01)
    assert f"{abs(np.sin(np.pi / n)):.1%} of their pressure acts along the surface" in remarks
    for rule in (
        {"quadrature": "nodal", "smoothing": 0.1, "initial": "adjusted"},
        {},
        {"enforcement": AUGMENTED},
    ):
        _, torque, remarks = fitted(n, n, **rule)
        assert abs(torque) < 1e-10 and "torque" not in remarks  # round-off


def fitted_in_space(disc: int, ring: int, *rule, **options) -> str:
    """Warnings of a slice of the ring on the disc."""
    a, b, c, pressure = 0.3, 1.0, 1.5, 10.0
    mesh = sc.join_bodies(
        {"disc": space.sliced(annulus(a, b, disc, 2)), "ring": space.sliced(annulus(b, c, ring, 2))}
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    forms = {
        "bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=0.25), "full"),
        "joint": sc.ContactPair(basis, "ring:inner", "disc:outer", sc.Coulomb(), *rule, **options),
    }
    load = LinearForm(
        lambda v, w: -pressure * (w.x[0] * v[0] + w.x[1] * v[1]) / np.hypot(w.x[0], w.x[1])
    )
    load = load.assemble(FacetBasis(mesh, basis.elem, facets="ring:outer", intorder=4))
    held = [
        basis.nodal_dofs[component, np.hypot(mesh.p[0] - x, mesh.p[1] - y) < 1e-9]
        for r in (a, c)
        for x, y, component in ((r, 0, 1), (0, r, 0), (-r, 0, 1))
    ]
    return remarked(forms, sc.Stage("press", load), np.concatenate((basis.nodal_dofs[2], *held)))[1]


def test_facets_in_space_are_warned_of() -> None:
    """[X] In space as in the plane: facets that overlap, and nodes at joints, which belong to one
    of two facets.
    """
    assert "do not match overlap" in fitted_in_space(64, 50, 2)
    assert "overlap" not in fitted_in_space(64, 50, 2, initial="adjusted")
    remarks = fitted_in_space(40, 40, "nodal")
    assert f"{np.sin(np.pi / 40):.1%} of their pressure acts along the surface" in remarks
    assert "smoothing" not in remarks
    assert "torque" not in fitted_in_space(40, 40)


# -- bodies that only soft springs hold
# -----------------------------------------------------------------------------


def test_a_disc_that_springs_hold_does_not_fall_through() -> None:
    """[X] Without contact it would sink by 4 radii, where nothing of its round side lies opposite
    the base any more.
    """
    disc = grid("Q1", np.linspace(-np.pi / 2, np.pi / 2, 25), np.linspace(0.5, 1.0, 4))
    angle, radius = disc.p
    disc = replace(disc, doflocs=np.stack((radius * np.sin(angle), 1.0 - radius * np.cos(angle))))
    disc = disc.with_boundaries({"round": disc.boundaries["top"]})
    base = grid("Q1", np.linspace(-2, 2, 41), np.linspace(-2, 0, 11))
    basis = vector_basis(sc.join_bodies({"disc": disc, "base": base}), "Q1", intorder=2)
    forms = {
        "bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
        "joint": sc.ContactPair(basis, "base:top", "disc:round", sc.Coulomb()),
        "held": sc.Spring(basis, [(-1.0, 1.0), (1.0, 1.0)], stiffness=1.0),
    }
    load = sc.weight(basis, {"base": 0.0, "disc": 7.0})
    stage = sc.Model(forms, basis.get_dofs("base:bottom").all()).run(
        [sc.Stage("weight", load)], progress=False
    )["weight"]
    assert abs(stage.report("joint").force[1]) == pytest.approx(
        -load.sum(), rel=0.01
    )  # the springs carry a little


@pytest.mark.parametrize("quadrature", ["nodal", 2, "segments"])
def test_friction_of_points_that_have_just_closed(quadrature) -> None:
    """[X] mu N = 12 on the sliding block's points; those of the base close ahead of it, which is
    told.
    """
    bodies = {
        "base": grid("Q1", np.linspace(0, 4, 17), [-0.5, -0.25, 0.0]),
        "block": grid("Q1", np.linspace(1, 2, 6), [0.0, 0.25, 0.5]),
    }
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    top = basis.get_dofs("block:top").all("u^1")
    fixed, load, moved = (
        np.append(basis.get_dofs("base:bottom").all(), top),
        basis.zeros(),
        basis.zeros(),
    )
    load[basis.get_dofs("block:top").all("u^2")] = -40.0 / 6
    moved[top] = 0.8
    pulls = []
    for sides in (("block:bottom", "base:top"), ("base:top", "block:bottom")):
        solid = sc.SolidForm(basis, sc.LinearElastic(E=1e5, nu=0.2))
        forms = {
            "solid": solid,
            "joint": sc.ContactPair(basis, *sides, sc.Coulomb(0.3), quadrature),
        }
        held = sc.Model(forms, fixed).run([sc.Stage("press", load)], progress=False)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            slid = sc.Model(forms, fixed).run(
                [sc.Stage("pull", load, moved, 2)], start=held, progress=False
            )["pull"]
        told = any("have only just closed" in str(warning.message) for warning in caught)
        pulls.append((abs(slid.report("joint").force[0]), told))
    assert pulls[0][0] == pytest.approx(12.0, rel=1e-3) and not pulls[0][1]
    assert pulls[1][0] < 11.0 and pulls[1][1]


@pytest.mark.parametrize("unit", [1.0, 1e-6])
@pytest.mark.parametrize(
    ("by", "share"), [(sc.AugmentedLagrangian, "1.2%"), (sc.DualMultipliers, "9.9%")]
)
def test_gaps_between_nodes_beside_multipliers(by, share: str, unit: float) -> None:
    """[N] Multipliers are no displacements: gaps between nodes are the same share of these in MPa
    and in Pa.
    """
    lower, upper = (
        grid("Q1", np.linspace(0, 2, n), y) for n, y in ((6, [-1.0, 0.0]), (7, [0.0, 1.0]))
    )
    bent = replace(
        upper, doflocs=upper.p + np.stack((0 * upper.p[0], 0.05 * (upper.p[0] - 1) ** 2))
    )
    basis = vector_basis(sc.join_bodies({"low": lower, "up": bent}), "Q1", intorder=2)
    forms = {
        "solid": sc.SolidForm(basis, sc.LinearElastic(E=1e9 * unit, nu=0.3)),
        "joint": sc.ContactPair(basis, "up:bottom", "low:top", sc.Coulomb(0.3), enforcement=by()),
    }
    top, pressed = basis.get_dofs("up:top"), basis.zeros()
    pressed[top.all("u^2")] = -0.02
    fixed = np.union1d(basis.get_dofs("low:bottom").all(), top.all())
    _, remarks = remarked(forms, sc.Stage("press", None, pressed, increments=2), fixed)
    assert f"gapes or penetrates by {share} of the largest displacement" in remarks


@pytest.mark.parametrize("pressure", [0.0, 10.0])
def test_share_of_the_penalty_beside_water(pressure: float) -> None:
    """[X] Pressures in the ground are no displacements: a wall that is pushed moves mostly by its
    penalty, as told.
    """
    mesh = MeshTri.init_tensor(np.linspace(0, 1, 5), np.linspace(0, 1, 5)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    water = sc.PoreWater(basis, 1.0, unit_weight=10.0)
    wall = sc.Beam(basis, "right", EI=1e6, EA=1e8, bonded=False)
    forms = {
        "ground": sc.SolidForm(basis, sc.LinearElastic(E=1e5, nu=0.0)),
        "water": water,
        "wall": wall,
        **wall.contact(basis, sc.Coulomb(), penalty=2e6),
    }
    model = sc.Model(
        forms,
        [
            basis.get_dofs("left").all("u^1"),
            basis.get_dofs("bottom").all("u^2"),
            *wall.dofs((1.0, 0.0), ["u^2"]),
            water.dofs("left", "right", "top", "bottom"),
        ],
    )
    held = model.forms["water"].prescribed(
        {"left": pressure, "right": pressure, "top": pressure, "bottom": pressure}
    )
    push = [model.forms["wall"].load((-50.0, 0.0), at=(1.0, y)) for y in (0.0, 1.0)]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model.run([sc.Stage("push", push, prescribed=held, duration=1e3)], progress=False)
    assert "penalty compliance is " in "; ".join(str(warning.message) for warning in caught)
