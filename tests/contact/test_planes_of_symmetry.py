"""Models that end in planes of symmetry; in space supports hold edges of the joint in one direction
and corners in two.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from skfem import Basis, ElementHex1, ElementVector, MeshHex

import skfem_contact as sc
from skfem_contact.contact.penalty import choose_penalties
from tests.fuzz.halves import SECOND_ORDER, Pressed, half_of
from tests.tools.helpers import counted


def punched(enforcement, planes: int) -> tuple[np.ndarray, float]:
    """Force, friction and largest pressure of a round punch on a block, counted for the whole, and
    the largest shear across the planes x = 0 near it.
    """

    def ticks(length: float, n: int, cut: bool) -> np.ndarray:
        return np.linspace(0.0 if cut else -length, length, (1 if cut else 2) * n + 1)

    low = MeshHex.init_tensor(
        ticks(4, 3, planes > 0), ticks(4, 3, planes > 1), np.linspace(0, 4, 4)
    ).with_boundaries({"bottom": lambda x: x[2] < 1e-9, "top": lambda x: x[2] > 4 - 1e-9})
    up = MeshHex.init_tensor(
        ticks(3, 4, planes > 0), ticks(3, 4, planes > 1), np.linspace(0, 1, 3)
    ).with_boundaries({"bottom": lambda x: x[2] < 1e-9, "top": lambda x: x[2] > 1 - 1e-9})
    x, y, z = up.doflocs
    up = replace(up, doflocs=np.array([x, y, 4 + 2 * z + (1 - z) * (x**2 + y**2) / 40]))
    basis = Basis(sc.join_bodies({"low": low, "up": up}), ElementVector(ElementHex1()), intorder=3)
    materials = {"low": sc.LinearElastic(E=1e4, nu=0.3), "up": sc.LinearElastic(E=2e5, nu=0.3)}
    forms = {
        "solid": sc.SolidForm(basis, materials),
        "joint": sc.ContactPair(
            basis, "up:bottom", "low:top", sc.Coulomb(0.4), enforcement=enforcement
        ),
    }

    # Hold the planes across, and other models at the ends of their axis
    p, top = basis.mesh.p, basis.get_dofs("up:top").all("u^3")
    fixed = [basis.get_dofs("low:bottom").all("u^3"), top]
    ends = (p[2] < 1e-9) | (p[2] > 6.0 - 1e-9)
    for component in (0, 1):
        held = np.abs(p[component]) < 1e-9
        fixed.append(basis.nodal_dofs[component, held if planes > component else held & ends])
    prescribed = basis.zeros()
    prescribed[top] = -0.15
    model = sc.Model(forms, np.unique(np.concatenate(fixed)))
    stage = model.run([sc.Stage("press", prescribed=prescribed, increments=2)], progress=False)[-1]
    joint, report = stage.tractions("joint"), stage.contact("joint")
    parts = 2**planes
    across = np.abs(joint.shear[np.abs(joint.x) < 0.2, 0]).max()
    found = np.array([parts * report.force[2], parts * report.friction, joint.pressure.max()])
    return found, float(across / np.abs(joint.shear).max())


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
@pytest.mark.parametrize(
    "enforcement",
    [None, sc.AugmentedLagrangian(), sc.DualMultipliers()],
    ids=["penalty", "augmented", "dual"],
)
def test_quarter_of_a_punch_with_friction(enforcement) -> None:
    """[X] A quarter between two planes has half of the force and of the friction of the half, the
    same pressure, and no more shear across the planes.
    """
    (half, across_half), (quarter, across) = (punched(enforcement, n) for n in (1, 2))
    assert quarter[0] == pytest.approx(half[0], rel=1e-3)
    assert quarter[1] == pytest.approx(half[1], rel=0.01)  # facets are cut otherwise; measured .5 %
    assert quarter[2] == pytest.approx(half[2], rel=0.05)
    assert across < across_half + 0.05


def round_body(element: str, method: str, stiffer: float, elements: tuple[int, int]) -> Pressed:
    """A round body that is pressed on a block, with friction."""
    return Pressed(
        element=element,
        method=method,
        mu=0.3,
        radius=30.0,
        stiffer=stiffer,
        depth=0.1,
        elements=elements,
    )


@pytest.mark.parametrize("element", ["Q1", "P2", "Q2"])
def test_half_models_have_the_tractions_of_whole_ones(element: str) -> None:
    """[N] A round body on a block, with friction and multipliers: a plane of symmetry is no edge,
    and tractions balance with their mirror images.
    """
    pressed = round_body(element, "multipliers", 10.0, (6, 5))
    tractions = []
    for is_whole in (False, True):
        _, stages = pressed.stages(is_whole)
        tractions.append(stages[0].tractions("joint"))
    half, whole = tractions
    right = np.flatnonzero(whole.x > 0.0)
    found = np.argsort(half.x)
    exact = right[np.argsort(whole.x[right])]
    largest = whole.pressure.max()

    # both models have the same cuts; Newton's tolerance is left
    assert half.x[found] == pytest.approx(whole.x[exact], abs=1e-7)
    assert half.pressure[found] == pytest.approx(whole.pressure[exact], abs=1e-5 * largest)
    shear, shear_of_whole = np.abs(half.shear[found]), np.abs(whole.shear[exact])
    assert shear == pytest.approx(shear_of_whole, abs=1e-5 * largest)


@pytest.mark.parametrize("element", ["Q1", "P2", "Hex8", "Tet4", "Tet10"])
@pytest.mark.parametrize("given", [None, 3e4])
@pytest.mark.one_in(2)
def test_default_penalties_of_half_models_are_those_of_whole_ones(
    element: str, given: float | None
) -> None:
    """[N] The nodes on a plane of symmetry have half of their stiffness; the other half counts.

    Two elements are too few for a facet without such nodes.  A given penalty stays, for either.
    """
    pressed = round_body(element, "penalty", 2.0, (2, 1))
    pairs = []
    for is_whole in (False, True):
        _, forms, fixed = pressed.model(is_whole)
        if given is not None:
            forms["joint"] = forms["joint"].with_penalty(given, given)
        pairs.append(sc.Model(forms, fixed).forms["joint"])
    half, whole = pairs
    assert half.stiffness == pytest.approx(whole.stiffness, rel=1e-12)
    assert half.penalty == pytest.approx(whole.penalty, rel=1e-12)
    # a penalty that is given to a completed pair stays as well
    _, forms, fixed = pressed.model(False)
    forms["joint"] = choose_penalties(forms)["joint"].with_penalty(5e4, 6e4)
    assert sc.Model(forms, fixed).forms["joint"].penalty == (5e4, 6e4)
    # without supports the plane is an end
    _, forms, _ = pressed.model(False)
    assert sc.Model(forms).forms["joint"].stiffness < 0.99 * whole.stiffness


@pytest.mark.parametrize("given", [None, 3e4])
def test_files_of_half_models_keep_their_penalties(tmp_path, given: float | None) -> None:
    """[X] Results that are read with bare forms, without supports, have the penalty of the run."""
    pressed = round_body("Q1", "penalty", 2.0, (2, 1))
    _, forms, fixed = pressed.model(False)
    if given is not None:
        forms["joint"] = forms["joint"].with_penalty(given, given)
    model = sc.Model(forms, fixed)
    result = model.run([sc.Stage("rest")], progress=False)
    result.save(tmp_path / "half.npz")
    joint = sc.load_result(tmp_path / "half.npz", forms)["rest"].forms["joint"]
    ran = model.forms["joint"]
    assert (joint.penalty, joint.stiffness) == (ran.penalty, ran.stiffness)


def test_stiffness_at_planes_of_symmetry_is_found_once(monkeypatch) -> None:
    """A model mirrors each of its contact pairs once."""
    _, forms, fixed = round_body("Q1", "penalty", 2.0, (2, 1)).model(False)
    calls = counted(monkeypatch, sc.ContactPair, "mirrored")
    sc.Model(forms, fixed)
    assert len(calls) == 1


@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
@pytest.mark.parametrize(
    ("element", "method", "stiffer"),
    [
        ("Hex8", "penalty", 1.0),
        pytest.param("Hex8", "augmented", 1.0, marks=pytest.mark.slow),
        ("Hex8", "multipliers", 10.0),
        pytest.param("Hex27", "multipliers", 1.0, marks=pytest.mark.slow),
        ("Tet4", "multipliers", 10.0),
        pytest.param("Tet10", "multipliers", 10.0, marks=pytest.mark.slow),
        ("Tet4", "penalty", 1.0),
        pytest.param("Tet4", "augmented", 10.0, marks=pytest.mark.slow),
        pytest.param("Hex27", "penalty", 1.0, marks=pytest.mark.slow),
        pytest.param("Tet10", "penalty", 10.0, marks=pytest.mark.slow),
        pytest.param("Tet10", "augmented", 1.0, marks=pytest.mark.slow),
    ],
)
def test_half_models_in_space_are_halves_of_whole_ones(
    element: str, method: str, stiffer: float
) -> None:
    """[N] A round body on a block, with friction: facets are cut into the same pieces, also at the
    plane, where inclined facets face a part of the mirror image; these slivers leave nothing to
    points of later cuts, of which a release has many.
    """
    pressed = round_body(element, method, stiffer, (3, 2) if element in SECOND_ORDER else (4, 3))
    (part, halves), (whole, wholes) = (pressed.stages(is_whole) for is_whole in (False, True))
    image = half_of(part, whole)

    # tolerances of Newton's method and of the cuts are left: at most 8e-9 of the force and 2e-5 of
    # the friction; other pieces changed these by up to 8e-5 and 1.3e-2, other penalties and slivers
    # by 9e-3 and 6e-2
    for one, both in zip(halves, wholes, strict=True):
        half, right = one.contact("joint"), both.contact("joint")
        moved = np.abs(one.x[: part.N] - both.x[image]).max()
        assert moved < 1e-5 * np.abs(both.x[: whole.N]).max()
        assert 2.0 * half.force[-1] == pytest.approx(right.force[-1], rel=1e-7)
        assert 2.0 * half.friction == pytest.approx(right.friction, rel=1e-4)
