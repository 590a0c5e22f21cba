"""What is refused before the analysis, and what is warned of after it: nothing is silently wrong
(case S16).
"""

from __future__ import annotations

import re
import warnings
from dataclasses import replace

import numpy as np
import pytest
from skfem import Basis, ElementTriCR, ElementVector, MeshQuad, MeshTri

import skfem_contact as sc
from skfem_contact.contact.penalty import choose_penalties
from tests.stability.setups import blocks, displaced, force_on, in_contact, run
from tests.tools.helpers import grid, traction, vector_basis

#: Relative noise of `tests/jitter.py`, 45 times round-off.
NOISE = 1e-14

QUADRATURES = ["nodal", 2, "segments"]
ELASTIC = sc.LinearElastic(E=1e3, nu=0.0)


def remarks_of(forms, stages, fixed, **options):
    """The analysis and its warnings."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", sc.AnalysisWarning)
        result = run(forms, stages, fixed, **options)
    return result, [str(warning.message) for warning in caught]


def pressed(basis, down=-0.01):
    """One stage that presses the upper block down by its top, and the supports."""
    fixed = basis.get_dofs({"lower:bottom", "upper:top"}).all()
    return [sc.Stage("press", basis.zeros(), displaced(basis, "upper:top", (0.0, down)))], fixed


def with_load(value):
    """An analysis whose load holds a value that is none."""
    basis = blocks()
    stages, fixed = pressed(basis)
    load = basis.zeros()
    load[0] = value
    return run(in_contact(basis), [replace(stages[0], load=load)], fixed)


def with_node(value):
    """Bodies one of which has a node at a place that is none."""
    mesh = grid("Q1", np.linspace(0, 1, 3), np.linspace(0, 1, 3))
    p = mesh.p.copy()
    p[0, 4] = value
    return in_contact(blocks(mapped=lambda _: replace(mesh, doflocs=p)))


def squeezed(degenerate):
    """An analysis of a triangle whose third corner lies on, or beyond, the opposite side."""
    mesh = MeshTri(
        np.array([[0.0, 1.0, 0.5, 0.5], [0.0, 0.0, degenerate, -1.0]]),
        np.array([[0, 1, 2], [0, 3, 1]]).T,
    )
    basis = vector_basis(mesh, "P1")
    form = sc.SolidForm(basis, ELASTIC)
    return run({"body": form}, [sc.Stage("rest", basis.zeros())], np.arange(4))


#: What is done, and what the error says.
REFUSED = {
    "negative friction": (
        lambda: sc.Coulomb(-0.1),
        r"mu must be a non-negative number, .* not -0\.1",
    ),
    "friction NaN": (lambda: sc.Coulomb(np.nan), "mu must be a finite number"),
    "negative adhesion": (
        lambda: sc.Coulomb(0.3, adhesion=-1.0),
        "adhesion must be a non-negative",
    ),
    "alpha too large": (
        lambda: in_contact(blocks(), smoothing=0.51),
        r"alpha must lie in \(0, 0\.5\], not 0\.51",
    ),
    "alpha zero": (lambda: in_contact(blocks(), smoothing=0.0), "alpha must lie in"),
    "alpha NaN": (
        lambda: in_contact(blocks(), smoothing=np.nan),
        "smoothing must be a finite number",
    ),
    "penalty zero": (lambda: in_contact(blocks(), penalty=0.0), "penalties must be positive"),
    "penalty NaN": (
        lambda: in_contact(blocks(), penalty=np.nan),
        "penalty must be a finite number",
    ),
    "half a point": (lambda: in_contact(blocks(), quadrature=2.5), "quadrature must be one of"),
    "master is slave": (
        lambda: sc.ContactPair(blocks(), "upper:top", "upper:top", sc.Coulomb()),
        "face the same way: it cannot touch itself",
    ),
    "no such boundary": (
        lambda: sc.ContactPair(blocks(), "uper:top", "lower:top", sc.Coulomb()),
        "existing: .*upper",
    ),
    "element without nodes": (
        lambda: sc.SolidForm(Basis(MeshTri(), ElementVector(ElementTriCR())), ELASTIC),
        "unsupported element .*ElementTriCR.*supported are",
    ),
    "stiffness negative": (lambda: sc.LinearElastic(E=-1.0, nu=0.3), "E must be positive"),
    "incompressible": (lambda: sc.LinearElastic(E=1.0, nu=0.5), "nu must lie between"),
    "load NaN": (lambda: with_load(np.nan), "the load holds NaN"),
    "load infinite": (lambda: with_load(np.inf), "the load holds NaN or infinite"),
    "node NaN": (lambda: with_node(np.nan), r"NaN|finite"),
    "node infinite": (lambda: with_node(np.inf), r"infinite|finite"),
    "flat element": (lambda: squeezed(0.0), "flat elements, 1 in all: element 0"),
    "inverted element": (lambda: squeezed(-0.5), "elements folded over their neighbours"),
}


@pytest.mark.filterwarnings(
    "ignore:.*divide:RuntimeWarning"
)  # the basis of a flat element, before we see it
@pytest.mark.parametrize("name", REFUSED)
def test_refused(name):
    """[X] Case S16: one ValueError that says what is wrong with it."""
    mistake, message = REFUSED[name]
    with pytest.raises(ValueError, match=message):
        mistake()


@pytest.mark.parametrize("quadrature", QUADRATURES)
def test_no_master_within_reach(quadrature):
    """[X] Case S16: empty after the first step, contact is warned of with its gap; contact that
    closes is not.
    """
    basis = blocks(gap=0.02)
    forms = in_contact(basis, quadrature=quadrature)
    stages, fixed = pressed(basis, -0.005)
    _, remarks = remarks_of(forms, stages, fixed)
    assert len(remarks) == 1
    assert (
        "stage 'press', joint: no slave point found a master within reach: gap is 0.015"
        in remarks[0]
    )
    stages, fixed = pressed(basis, -0.021)
    assert remarks_of(forms, stages, fixed)[1] == []


@pytest.mark.parametrize("quadrature", QUADRATURES)
def test_penalty_that_is_too_soft(quadrature):
    """[X] Case A1: a penalty of E/h / 100 lets the columns sink in by more than they give way: a
    warning.
    """
    basis = blocks(overhang=0.0)
    penalty = 0.01 * 1e3 / 0.2
    forms = in_contact(basis, sc.Coulomb(), quadrature, nu=0.0, penalty=penalty)
    sides = basis.get_dofs({"lower:left", "lower:right", "upper:left", "upper:right"}).all("u^1")
    stages, fixed = pressed(basis)
    result, remarks = remarks_of(forms, stages, np.union1d(fixed, sides))
    # springs in series: 0.01 is shared between two columns of 1e3 each and the penalty
    share = 0.01 * (1 / penalty) / (2 / 1e3 + 1 / penalty) / 0.2
    assert forms["joint"].penetration(result[-1].states["joint"]) == pytest.approx(share, rel=0.05)
    message = (
        r"stage 'press', joint: the slave penetrates by (\S+)% of its segment .* "
        r"penalty, 50, is too soft .*"
    )
    found = re.fullmatch(message, *remarks)
    assert float(found[1]) == pytest.approx(100 * share, rel=0.05)


@pytest.mark.parametrize("quadrature", QUADRATURES)
@pytest.mark.parametrize("decade", range(0, 13, 2))
def test_penalty_from_soft_to_round_off(decade, quadrature, request):
    """[X] Case S1: 1 to 1e12 times E/h: three springs in series, then round-off, which is warned of
    beforehand.
    """
    penalty = 10.0**decade * 1e3 / 0.2
    basis = blocks(overhang=0.0)
    forms = in_contact(basis, sc.Coulomb(), quadrature, nu=0.0, penalty=penalty)
    sides = basis.get_dofs({"lower:left", "lower:right", "upper:left", "upper:right"}).all("u^1")
    stages, fixed = pressed(basis)
    try:
        result, remarks = remarks_of(forms, stages, np.union1d(fixed, sides), newton=sc.Newton())
    except sc.NotConverged as error:
        assert decade >= 12  # the bodies' own stiffness is round-off beside the penalty
        assert "singular" in str(error) or "no equilibrium" in str(error)
        return
    assert any("round-off hides the penetration" in remark for remark in remarks) == (decade >= 10)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sc.AnalysisWarning)
        force = force_on(forms, result["press"])[1]
    # nodes and Gauss points carry a uniform pressure to 2 % only; where round-off is warned of, it
    # costs a thousandth
    rel = 0.02 if quadrature != "segments" else 1e-4 if decade < 10 else 2e-3
    if decade >= 10 and request.config.getoption("--jitter", default=None) is not None:
        rel += (
            penalty * 0.01 * NOISE / 5.0
        )  # noise of displacements of 0.01 is that of the penetration; the force is 5
    assert force == pytest.approx(0.01 / (2 / 1e3 + 1 / penalty), rel=rel)


def test_penalty_that_round_off_hides():
    """[X] Case S1: at 1e12 E/h the user hears of it before the analysis, whatever comes of that."""
    basis = blocks()
    forms = in_contact(basis, penalty=1e12 * 1e3 / 0.2)
    with pytest.warns(
        sc.AnalysisWarning, match=r"'upper:bottom' on 'lower:top': the penalty, 5e\+15, is .* times"
    ):
        choose_penalties(forms)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        choose_penalties(in_contact(basis, penalty=1e6 * 1e3 / 0.2))
        # the augmented method chooses its own
        choose_penalties(
            in_contact(basis, penalty=1e12 * 1e3 / 0.2, enforcement=sc.AugmentedLagrangian())
        )


def test_isolated_element():
    """[X] Case S8: an element that nothing holds is a body of its own, which the message names with
    its place.
    """
    mesh = grid("Q1", np.linspace(0, 1, 3), np.linspace(0, 1, 3))
    p = np.hstack((mesh.p, [[3.0, 4.0, 4.0, 3.0], [0.0, 0.0, 1.0, 1.0]]))
    t = np.hstack((mesh.t, [[9], [10], [11], [12]]))
    basis = vector_basis(MeshQuad(p, t), "Q1", intorder=2)
    forms = {"body": sc.SolidForm(basis, ELASTIC)}
    held = basis.nodal_dofs[:, np.isclose(p[1], 0) & (p[0] < 2)].ravel()
    with pytest.raises(ValueError, match=r"not held.* 3 of 3 rigid motions free"):
        run(forms, [sc.Stage("weight", sc.weight(basis, 1.0))], held)


@pytest.mark.parametrize("angle", [1.0, 0.1])
def test_sharp_triangles(angle):
    """[X] Case S8: triangles with an angle of a degree and less beside the interface carry a
    uniform pressure.
    """
    flat = np.tan(np.radians(angle))
    base = MeshTri(
        np.array([[0, 1, 0.5, 0, 1.0], [0, 0, -flat / 2, -1, -1]]),
        np.array([[0, 2, 1], [0, 3, 2], [2, 3, 4], [2, 4, 1]]).T,
    )
    roof = MeshTri(base.p * [[1], [-1]], base.t[[0, 2, 1]])
    sides = {
        "left": lambda x: np.isclose(x[0], 0),
        "face": lambda x: np.isclose(x[1], 0, atol=1e-12),
    }
    sides |= {"far": lambda x: np.isclose(np.abs(x[1]), 1)}
    bodies = {"lower": base.with_boundaries(sides), "upper": roof.with_boundaries(sides)}
    basis = vector_basis(sc.join_bodies(bodies), "P1")
    forms = {
        "blocks": sc.SolidForm(basis, ELASTIC),
        "joint": sc.ContactPair(
            basis, "upper:face", "lower:face", sc.Coulomb(), quadrature="nodal", penalty=1e5
        ),
    }
    fixed = np.union1d(
        basis.get_dofs("lower:far").all(), basis.get_dofs({"lower:left", "upper:left"}).all("u^1")
    )
    stage = run(forms, [sc.Stage("press", traction(basis, "upper:far", (0.0, -5.0)))], fixed)[
        "press"
    ]
    np.testing.assert_allclose(stage.states["joint"].traction[0], -5.0, rtol=1e-6)
    np.testing.assert_allclose(stage.states["blocks"].stress[1], -5.0, rtol=1e-6)


def test_remarks_are_given_once():
    """A penalty that is too soft in every stage is warned of once, for the stage with the deepest
    penetration.
    """
    basis = blocks()
    forms = in_contact(basis, penalty=1e3)
    _, fixed = pressed(basis)
    stages = [
        sc.Stage(f"down {down:g}", basis.zeros(), displaced(basis, "upper:top", (0.0, -down)))
        for down in (0.01, 0.02, 0.04, 0.03)
    ]
    _, remarks = remarks_of(forms, stages, fixed)
    assert len(remarks) == 1
    assert remarks[0].startswith("stage 'down 0.04', joint: the slave penetrates by")


@pytest.mark.parametrize("ratio", [1e4, 1e10])
def test_stick_that_round_off_hides(ratio):
    """[X] Case S2: at 1e10 times E/h the shear of sticking points is round-off, 5 % here, and the
    user is warned.
    """
    basis = blocks()
    _, fixed = pressed(basis)
    stages = [
        sc.Stage(f"{way:g}", basis.zeros(), displaced(basis, "upper:top", (way, -0.01)))
        for way in (0.0, 0.001, 0.002)
    ]
    forms = in_contact(basis, penalty=ratio * 1e3 / 0.2)
    result, remarks = remarks_of(forms, stages, fixed, newton=sc.Newton())
    assert any("round-off of the slip" in remark for remark in remarks) == (ratio == 1e10)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sc.AnalysisWarning)
        drag = -force_on(forms, result[-1])[0]
    # from 1e2 to 1e8 times E/h it is 0.3131 to 0.3132
    assert drag == pytest.approx(0.3132, rel=0.1 if ratio == 1e10 else 1e-3)
