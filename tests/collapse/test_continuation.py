"""Limit loads by indirect continuation: closed forms, curves and bad input."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from skfem import (
    Basis,
    ElementQuad1,
    ElementQuad2,
    ElementTriP2,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshQuad,
    MeshQuad2,
    MeshTri,
)

import skfem_contact as sc
from skfem_contact.collapse import continuation
from skfem_contact.collapse.limit_load import _Load
from skfem_contact.collapse.result import Point, SearchResult, Stop
from skfem_contact.errors import NotConverged
from tests.tools.helpers import analysis


def column(phi=0.0, psi=0.0, n=2):
    """A square (c = 10) that can spread, under pressure on its top."""
    basis = Basis(MeshQuad().refined(n).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    form = sc.SolidForm(
        basis, sc.MohrCoulomb(E=1e3, nu=0.3, c=10.0, phi=phi, psi=psi), strain="b_bar"
    )
    fixed = np.hstack([basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")])
    top = FacetBasis(basis.mesh, basis.elem, facets="top")
    return {"soil": form}, fixed, LinearForm(lambda v, w: -v[1]).assemble(top)


@pytest.mark.parametrize(("phi", "psi"), [(0.0, 0.0), (30.0, 30.0), (30.0, 0.0)])
def test_column(phi, psi):
    """G8 [X]: q = 2 c tan(45 + phi/2); uniform stress, so that the residual's tolerance is the only
    error.
    """
    exact = 20.0 * np.tan(np.radians(45.0 + phi / 2))
    result = analysis("limit_load", *column(phi, psi), progress=False)
    assert result.multiplier == pytest.approx(exact, rel=1e-3)
    assert np.all(np.diff(result.curve[:, 0]) > 0)


def test_loads_scale():
    """[X] Ten times the reference load, a tenth of the multiplier."""
    forms, fixed, load = column(30.0, 30.0)
    one, ten = (
        sc.Model(forms, fixed).limit_load(load, progress=False),
        sc.Model(forms, fixed).limit_load(10 * load, progress=False),
    )
    assert ten.multiplier == pytest.approx(
        0.1 * one.multiplier, rel=5e-3
    )  # both brackets are so wide


def test_start_keeps_its_load():
    """[X] What is carried already is missing at the end."""
    forms, fixed, load = column()
    start = sc.Model(forms, fixed).run([sc.Stage("half", 10.0 * load)], progress=False)
    result = sc.Model(forms, fixed).limit_load(load, start=start, progress=False)
    assert result.multiplier == pytest.approx(10.0, rel=1e-3)  # tolerance of the residual
    np.testing.assert_allclose(result.load, 20.0 * load, rtol=1e-3, atol=1e-9)


def test_collapse_of_a_thick_cylinder():
    """[X] Radii 1 and 4, c = 10, phi = 30: the whole wall yields at 26.324437; to 0.5 %."""
    flat = MeshQuad2.from_mesh(
        MeshQuad.init_tensor(4.0 ** np.linspace(0, 1, 7), np.linspace(0, np.pi / 2, 4))
    )
    r, angle = flat.doflocs
    mesh = MeshQuad2(np.array([r * np.cos(angle), r * np.sin(angle)]), flat.t).with_boundaries(
        {
            "inner": lambda p: np.hypot(*p) < 1.05,
            "x": lambda p: p[1] < 1e-9,
            "y": lambda p: p[0] < 1e-9,
        }
    )
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=5)
    side = FacetBasis(mesh, basis.elem, facets="inner", intorder=6)
    load = LinearForm(lambda v, w: -(w.n[0] * v[0] + w.n[1] * v[1])).assemble(side)
    fixed = np.hstack([basis.get_dofs("x").all("u^2"), basis.get_dofs("y").all("u^1")])
    for psi in (30.0, 0.0):
        form = sc.SolidForm(basis, sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=30.0, psi=psi))
        result = sc.Model({"soil": form}, fixed).limit_load(load, step=10.0, progress=False)
        assert result.multiplier == pytest.approx(26.324437, rel=5e-3)
        assert result.iterations <= 30


def footing(element, strain, intorder, triangles):
    """A smooth footing of half width 1 on c = 1, phi = 0."""
    mesh = MeshQuad.init_tensor(np.linspace(0, 6, 19), np.linspace(-3, 0, 10))
    mesh = mesh.to_meshtri(style="x") if triangles else mesh
    mesh = mesh.with_boundaries(
        {
            "footing": lambda p: (p[1] > -1e-9) & (p[0] < 1 + 1e-9),
            "bottom": lambda p: p[1] < -3 + 1e-9,
            "sides": lambda p: (p[0] < 1e-9) | (p[0] > 6 - 1e-9),
        }
    )
    basis = Basis(mesh, ElementVector(element), intorder=intorder)
    form = sc.SolidForm(basis, sc.MohrCoulomb(E=1e3, nu=0.3, c=1.0, phi=0.0), strain=strain)
    fixed = np.hstack([basis.get_dofs("bottom").all(), basis.get_dofs("sides").all("u^1")])
    facets = FacetBasis(mesh, basis.elem, facets="footing", intorder=4)
    return {"soil": form}, fixed, LinearForm(lambda v, w: -v[1]).assemble(facets)


@pytest.mark.slow
def test_footing_locks_with_full_integration_only():
    """G1 [X]: N_c = 5.1416; coarse meshes read up to 15 % more, and full integration never reaches
    a plateau.
    """
    p2 = analysis("limit_load", *footing(ElementTriP2(), "full", 2, True), progress=False)
    b_bar = analysis("limit_load", *footing(ElementQuad1(), "b_bar", 2, False), progress=False)
    for result in (p2, b_bar):
        assert 2 + np.pi < result.multiplier < 1.15 * (2 + np.pi)
    with pytest.warns(
        sc.AnalysisWarning,
        match="no collapse was shown: .* max_value: there is no collapse below 30",
    ):
        locked = analysis(
            "limit_load", *footing(ElementQuad1(), "full", 2, False), max_value=30.0, progress=False
        )
    assert locked.multiplier > 30.0
    assert locked.stop.kind == "max_value"


@pytest.mark.slow
def test_curve_is_followed_beyond_its_plateau():
    """[X] Tresca: the load stays what it is while the footing sinks, and from there no more can be
    carried.
    """
    problem = footing(ElementTriP2(), "full", 2, True)
    usual = analysis("limit_load", *problem, progress=False)
    far = 4.0 * usual.curve[-1, 2]
    long = analysis("limit_load", *problem, min_displacement=far, progress=False)
    assert usual.curve[-1, 2] < far <= long.curve[-1, 2]
    # the tolerance of a plateau, 0.5 %, here and below
    assert long.multiplier == pytest.approx(usual.multiplier, rel=0.005)
    more = analysis("limit_load", *problem, start=long.end, step=0.1, progress=False)
    assert abs(more.multiplier) < 0.005 * long.multiplier


def test_result_prints_its_steps():
    """One line a step."""
    result = analysis("limit_load", *column(), progress=False)
    assert str(result).count("equilibrium") == len(result.curve)
    assert result.mechanism.shape == result.x.shape


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"tolerance": 0.0}, "positive"),
        ({"step": 0.0}, "positive"),
        ({"max_step": 0.0}, "positive"),
    ],
)
def test_bad_settings(settings, message):
    with pytest.raises(ValueError, match=message):
        analysis("limit_load", *column(), **settings)


def test_no_load():
    forms, fixed, load = column()
    with pytest.raises(ValueError, match="zero"):
        sc.Model(forms, fixed).limit_load(0.0 * load)


@pytest.mark.parametrize(
    ("slides", "second", "ends"),
    [(True, "plateau", "plateau"), (True, "peak", "stall"), (False, "plateau", "stall")],
)
def test_a_search_that_stalls_tries_again_with_resistance(monkeypatch, slides, second, ends):
    """Once, where anything slides; an end that shows no limit does not replace the first one."""
    tried = [SearchResult([], Stop(kind, "")) for kind in ("stall", second)]
    monkeypatch.setattr(continuation, "_follow", lambda *given, **settings: tried.pop(0))
    branch = SimpleNamespace(search="step", with_contact=False, resist=lambda: slides)
    found = continuation.follow(branch, np.zeros(1), [], sc.Newton(), 0.01, None)
    assert found.stop.kind == ends
    assert len(tried) == (0 if slides else 1)


@pytest.mark.parametrize(
    ("straight", "slope", "beyond", "level"),
    [
        (True, 1e-3, 1e-3, False),  # goes on, and may rise by any amount
        (True, 1e-3, 4e-4, True),  # most of it was the end of a curve
        (True, 1e-3, None, True),  # nothing carries more
        (True, 1e-6, 1e-6, True),  # too flat to matter
        (False, 1e-3, 1e-3, True),  # soil flows
    ],
)
@pytest.mark.parametrize("reaches", [512.0, 32.0, 2.0])
def test_a_straight_piece_is_level_if_it_ends(monkeypatch, straight, slope, beyond, level, reaches):
    """[X] A curve of straight pieces ends where it rises by less than half of its slope beyond its
    end, as far as there is an equilibrium.
    """
    points = [Point(np.zeros(1), {}, 100.0 + slope * work, work) for work in (0.0, 1.0, 2.0)]
    tried = []

    def correct(branch, control, points, work, newton):
        times = work - 2.0
        tried.append(times)
        if beyond is None or times > reaches:
            raise NotConverged("no equilibrium")
        return Point(np.zeros(1), {}, points[-1].parameter + beyond * times, work)

    monkeypatch.setattr(continuation, "correct", correct)
    log = SimpleNamespace(straight=straight, moved=lambda x: 1.0)
    course = continuation.Course(tolerance=0.01)
    assert continuation._is_level(None, None, points, sc.Newton(), course, log) is level
    assert bool(tried) is (straight and slope == 1e-3)
    # Not at all before it has moved, or with a slope that rises by more than the tolerance
    course = continuation.Course(tolerance=0.01, min_displacement=2.0)
    assert not continuation._is_level(None, None, points, sc.Newton(), course, log)
    course = continuation.Course(tolerance=1e-9)
    assert not continuation._is_level(None, None, points, sc.Newton(), course, log)


class Leaning(sc.Form):
    """A strut of stiffness 1, which pushes a weak spring aside by the square of what is above 1."""

    size = 2

    def __init__(self, weak):
        self.weak = weak

    def assemble(self, x, state):
        above = max(x[0] - 1.0, 0.0)
        force = np.array([x[0], self.weak * x[1] + above**2])
        tangent = csr_matrix([[1.0, 0.0], [2.0 * above, self.weak]])
        return sc.Response(force, lambda: state, lambda: tangent)


@pytest.mark.parametrize(("weak", "fails"), [(0.02, False), (0.005, True)])
def test_a_step_ends_where_its_tangent_leads_far_beyond_it(weak, fails):
    """[X] The first correction is 1 / weak times as long as the step: fifty times it is followed
    to equilibrium, two hundred times it ends the step at once.
    """
    model = sc.Model({"strut": Leaning(weak)})
    system = model.checked_system(model.forms, model.fixed)
    pull = np.array([1.0, 0.0])
    branch = _Load(system, np.zeros(2), pull)
    # the work of the pull is the displacement of its dof
    points = [Point(work * pull, {"strut": None}, work, work) for work in (0.0, 1.0)]
    if fails:
        with pytest.raises(NotConverged, match="200 times as far") as error:
            continuation.correct(branch, pull, points, 2.0, sc.Newton())
        assert len(error.value.residuals) == 1  # no line search follows the mechanism
    else:
        found = continuation.correct(branch, pull, points, 2.0, sc.Newton())
        assert found.parameter == pytest.approx(2.0)
        assert found.x == pytest.approx([2.0, -1.0 / weak])


@pytest.mark.parametrize("unit_weight", [0.0, 20.0])
def test_weights_that_move_against_the_load(unit_weight):
    """A pile that is pulled out of ground that settles: the first step did negative work, and the
    search ended at once with displacements that are no numbers.
    """
    line = np.linspace(0.0, 2.0, 5)
    mesh = MeshTri.init_tensor(line, line[:3]).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    pile = sc.Beam(None, [(1.0, 0.9), (1.0, 0.6), (1.0, 0.3)], EI=1.0, EA=1e4)
    forms = {
        "ground": sc.SolidForm(basis, sc.LinearElastic(1e4, 0.3), unit_weight=unit_weight),
        "pile": pile,
        "skin": sc.Embedded(basis, pile, T_max=5.0),
    }
    model = sc.Model(forms, basis.get_dofs("bottom").all())
    pull = model.forms["pile"].load((0.0, 1.0), at=(1.0, 0.9))
    found = model.limit_load(pull, progress=False)
    assert found.stop.kind == "plateau"
    assert found.multiplier == pytest.approx(5.0 * 0.6, rel=1e-3)
