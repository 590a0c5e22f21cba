"""Round joints of facets that do not match: gaps count between the smooth curves, and pressures
that ripple all the same are told.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from skfem import Basis, MeshQuad, MeshQuad2

import skfem_contact as sc
from skfem_contact.contact import ripple
from skfem_contact.results.files import _state
from skfem_contact.surfaces.faceting import Faceting, alike, curvatures
from skfem_contact.surfaces.material_points import MaterialPoints
from skfem_contact.surfaces.surface import Surface
from tests.contact.test_overlaps import annulus
from tests.fuzz.frames import as_drawn
from tests.fuzz.model import build
from tests.fuzz.scenes import draw
from tests.tools import space
from tests.tools.helpers import body_along, vector_basis
from tests.tools.scenes import remarked

METHODS = [None, sc.AugmentedLagrangian(), sc.DualMultipliers()]
IDS = ["penalty", "augmented", "dual"]
A, B, C = 0.3, 0.6, 1.0
SMOOTH = sc.Coulomb()


def curved_annulus(inner: float, outer: float, n: int, layers: int) -> MeshQuad2:
    """A ring of quadratic elements whose middle nodes lie on circles."""
    flat = annulus(inner, outer, n, layers)
    mesh = MeshQuad2.from_mesh(flat)
    x = mesh.doflocs.copy()
    first = flat.nvertices
    radius = np.hypot(*flat.p[:, flat.facets])  # of both ends of all facets
    is_round = np.ptp(radius, axis=0) < 1e-9
    middle = x[:, first : first + flat.nfacets]
    middle[:, is_round] *= radius[0, is_round] / np.hypot(*middle[:, is_round])
    x[:, first : first + flat.nfacets] = middle
    return replace(mesh, doflocs=x).with_boundaries(flat.boundaries)


def pressed_rings(
    element: str, n: int, m: int, strain: float, law=SMOOTH, **options
) -> tuple[float, str]:
    """Error of the pressure between two rings, root mean square over Lame's, and remarks.

    The load is a strain times E.
    """
    E = 1e9
    kind = curved_annulus if element == "Q2" else annulus
    mesh = sc.join_bodies({"i": kind(A, B, n, 4), "o": kind(B, C, m, 4)})
    basis = vector_basis(mesh, element, intorder=4)
    joint = sc.ContactPair(basis, "o:inner", "i:outer", law, **options)
    forms = {"solid": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.25)), "joint": joint}
    held = []
    for radius in (A, C):
        for x, y, component in ((radius, 0, 1), (0, radius, 0), (-radius, 0, 1)):
            node = np.argmin(np.hypot(mesh.p[0] - x, mesh.p[1] - y))
            held.append(basis.nodal_dofs[component, node])
    p = strain * E
    model = sc.Model(forms, np.array(held))
    load = model.traction("o:outer", lambda x: -p * x / np.hypot(*x))
    stage, remarks = remarked(forms, sc.Stage("press", load), np.array(held))
    joint = stage.tractions("joint")
    exact = p * C**2 / (C**2 - A**2) * (1 - A**2 / B**2)
    squares = np.average((joint.pressure / exact - 1) ** 2, weights=joint.weight)
    return float(np.sqrt(squares)), remarks


@pytest.mark.parametrize("enforcement", METHODS, ids=IDS)
def test_curved_joint_that_does_not_match(enforcement) -> None:
    """[X] Uniform pressure between curved rings of 64 and 52 elements at a load of 1e-5 E; the
    gaps of their quadratic facets alone made it 0 to 2.7 times as large.
    """
    error, remarks = pressed_rings("Q2", 64, 52, 1e-5, enforcement=enforcement)
    assert error < 0.01 and "ripple" not in remarks  # the penalty makes .4 %


@pytest.mark.parametrize(("n", "m"), [(64, 52), (52, 64), (64, 40)])
def test_straight_facets_that_do_not_match(n: int, m: int) -> None:
    """[X] Likewise with straight facets, which lie up to 7e-4 inside of the circles, a load of
    1e-3 E: within 1 %, where the gaps of the mesh make 3 times the pressure.
    """
    error, remarks = pressed_rings("Q1", n, m, 1e-3)
    assert error < 0.015 and "overlap" not in remarks


@pytest.mark.parametrize("enforcement", METHODS[:2], ids=IDS[:2])
def test_ripple_is_told_by_its_size(enforcement) -> None:
    """[X] Loads of 1e-5 E are too small for straight facets: the remark names the ripple within a
    factor of two.
    """
    error, remarks = pressed_rings("Q1", 64, 52, 1e-5, enforcement=enforcement)
    told = float(remarks.partition("ripples by about ")[2].partition("%")[0]) / 100
    assert error > 0.5 and 0.5 < told / error < 2.0


@pytest.mark.parametrize("enforcement", METHODS, ids=IDS)
def test_bonded_rings_that_are_pulled(enforcement) -> None:
    """[X] Bonded rings that are pulled apart have Lame's stress between them, as pressed ones; the
    run ended with a division by zero.
    """
    bond = {"law": sc.Tied(), "enforcement": enforcement}
    pressed, _ = pressed_rings("Q1", 64, 52, 1e-5, **bond)
    pulled, remarks = pressed_rings("Q1", 64, 52, -1e-5, **bond)
    assert pulled < 0.012  # the compliance of the penalty makes 1.1 %
    assert abs(pulled - pressed) < 1e-6 and "ripple" not in remarks


def test_ripple_of_a_bond_in_tension_is_told() -> None:
    """[X] Gaps of facets count in a brittle bond: its tension ripples, within a fifth as told."""
    bond = sc.Coulomb(adhesion=1e9, tension=1e9)
    error, remarks = pressed_rings("Q1", 64, 52, -1e-5, law=bond)
    told = float(remarks.partition("ripples by about ")[2].partition("%")[0]) / 100
    assert error > 0.2 and abs(told / error - 1.0) < 0.2


def test_ripple_is_looked_for_on_all_facets_of_a_small_contact(monkeypatch) -> None:
    """Of more than 400 facets every second one is looked at, and of fewer each."""
    found = []
    compared = ripple._compared

    def noted(*arguments):
        found.append(compared(*arguments))
        return found[-1]

    monkeypatch.setattr(ripple, "_compared", noted)
    pressed_rings("Q1", 32, 40, 1e-5)
    loaded = found[-1].values[:, 0] != 0.0
    assert found[-1].inside[loaded].all()


def test_ripple_in_space_is_told() -> None:
    """[X] Slices of rings, whose facets in space count as they are: told within a factor of two of
    the pressure's deviation from its mean.
    """
    mesh = sc.join_bodies(
        {"i": space.sliced(annulus(A, B, 40, 2)), "o": space.sliced(annulus(B, C, 32, 2))}
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    joint = sc.ContactPair(basis, "o:inner", "i:outer", sc.Coulomb())
    forms = {"solid": sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=0.25)), "joint": joint}
    outer = basis.get_dofs("o:outer")
    x = basis.zeros()
    for component in (0, 1):
        dofs = outer.all(f"u^{component + 1}")
        x[dofs] = -2e-3 * basis.doflocs[component, dofs]
    fixed = np.unique(
        np.concatenate((basis.nodal_dofs[2], outer.all(), basis.get_dofs("i:inner").all()))
    )
    stage, remarks = remarked(forms, sc.Stage("press", prescribed=x), fixed)
    joint = stage.tractions("joint")
    mean = np.average(joint.pressure, weights=joint.weight)
    ripple = np.sqrt(np.average((joint.pressure / mean - 1) ** 2, weights=joint.weight))
    told = float(remarks.partition("ripples by about ")[2].partition("%")[0]) / 100
    assert 0.5 < told / ripple < 2.0


def half_ring(r: np.ndarray, n: int) -> MeshQuad:
    """Right half of a ring of straight facets, radii r, and n of them around."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, n + 1)
    flat = MeshQuad.init_tensor(r, angle)
    radius, phi = flat.doflocs
    return replace(flat, doflocs=np.array([radius * np.cos(phi), radius * np.sin(phi)]))


@pytest.mark.slow
@pytest.mark.parametrize("enforcement", METHODS[:2], ids=IDS[:2])
def test_pin_of_straight_facets_in_a_hole(enforcement) -> None:
    """[X] Persson: the peak is .7117 Q / R where 60 degrees to each side touch. The pin moves by
    the clearance along facets that are .013 inclined, so that the gaps follow it.
    """
    pin = half_ring(np.linspace(0.02, 1.0, 17), 64).with_boundaries(
        {"rim": lambda x: np.hypot(*x) > 0.99, "sym": lambda x: np.abs(x[0]) < 1e-9}
    )
    plate = half_ring(1.001 * np.geomspace(1.0, 25.0, 27), 80).with_boundaries(
        {
            "hole": lambda x: np.hypot(*x) < 1.1,
            "far": lambda x: np.hypot(*x) > 24.0,
            "sym": lambda x: np.abs(x[0]) < 1e-9,
        }
    )
    basis = vector_basis(sc.join_bodies({"pin": pin, "plate": plate}), "Q1", intorder=2)
    E, nu, clearance = 1.0, 0.3, 1e-3
    Q = E / (2 * (1 - nu**2)) * clearance / 0.5336
    forms = {
        "solid": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=nu)),
        "joint": sc.ContactPair(
            basis, "pin:rim", "plate:hole", sc.Coulomb(), enforcement=enforcement
        ),
    }
    sides = [basis.get_dofs(f"{body}:sym").all("u^1") for body in ("pin", "plate")]
    fixed = np.unique(np.concatenate((*sides, basis.get_dofs("plate:far").all())))
    load = sc.Model(forms, fixed).weight({"pin": Q / np.pi, "plate": 0.0})
    stage, remarks = remarked(forms, sc.Stage("press", load), fixed)
    joint = stage.tractions("joint")
    assert joint.pressure.max() / Q == pytest.approx(
        0.7117, rel=0.06
    )  # multipliers ripple by 3 % of the pressure
    angle = np.degrees(np.arctan2(joint.x, -joint.y))
    around = np.abs(angle - 30.0) < 8.0
    assert joint.pressure[around].std() < 0.12 * joint.pressure[around].mean()  # it falls by .2
    assert "ripple" not in remarks


def test_turned_ring_keeps_its_pressure() -> None:
    """[X] The outer ring turns by half a facet without friction: the pressure stays uniform."""
    mesh = sc.join_bodies({"i": annulus(A, B, 64, 3), "o": annulus(B, C, 52, 3)})
    basis = vector_basis(mesh, "Q1", intorder=4)
    joint = sc.ContactPair(basis, "o:inner", "i:outer", sc.Coulomb(), enforcement=METHODS[2])
    forms = {
        "solid": sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=0.25)),
        "joint": joint,
    }
    outer, inner = basis.get_dofs("o:outer"), basis.get_dofs("i:inner")
    stages = []
    for turn in (0.0, 0.02):
        x = basis.zeros()
        dofs = np.unique(outer.all()).reshape(-1, 2)
        points = basis.doflocs[:, dofs[:, 0]]
        x[dofs[:, 0]] = -1e-3 * points[0] - turn * points[1]
        x[dofs[:, 1]] = -1e-3 * points[1] + turn * points[0]
        stages.append(sc.Stage(f"{turn}", prescribed=x, increments=3))
    fixed = np.union1d(outer.all(), inner.all())
    for stage in sc.Model(forms, fixed).run(stages, progress=False):
        joint = stage.tractions("joint")
        assert joint.pressure.std() < 0.02 * joint.pressure.mean()


def test_wavy_joint_without_friction_does_not_depend_on_increments() -> None:
    """[X] Displacements belong to the last position, however it is reached.

    The clearance between the curves follows the slip up to 5e-4 of the largest pressure; four times
    that opens or closes a point here, and displacements differ by 2.5e-3.
    """
    found = draw(645000872)  # 4 facets on 6, pressed together in axial symmetry
    model = build(found, as_drawn(2))
    with pytest.warns(sc.AnalysisWarning, match="compliance"):
        one, six = (model.run([replace(model.stages[0], increments=n)])[-1].x for n in (1, 6))
    assert np.abs(six - one).max() < 1.5e-3 * np.abs(one).max()


@pytest.mark.parametrize("n", [24, 48])
def test_distance_of_facets_from_a_circle(n: int) -> None:
    """[X] The sagitta R (1 - cos(pi / n)) in the middle of a straight facet, nothing at its ends;
    outside of the body on a convex side, inside on a concave one.
    """
    ring = annulus(1.0, 2.0, n, 1)
    basis = vector_basis(ring, "Q1")
    for name, radius, sign in (("outer", 2.0, 1.0), ("inner", 1.0, -1.0)):
        surface = Surface.from_boundary(basis, name)
        faceting = Faceting.of(surface)
        facet = np.repeat(np.arange(n), 3)
        xi = np.tile([-1.0, 0.0, 1.0], n)[:, None]
        exact = np.tile([0.0, sign * radius * (1 - np.cos(np.pi / n)), 0.0], n)
        found = faceting.at(MaterialPoints(facet, xi))
        # An interpolation through six nodes errs by the sixth power of their distance
        np.testing.assert_allclose(found, exact, atol=0.01 * radius * (2 * np.pi / n) ** 6 + 1e-12)
        np.testing.assert_allclose(curvatures(surface), sign / radius, rtol=0.01)
    assert faceting.at(MaterialPoints(np.array([-1]), np.zeros((1, 1)))) == 0.0


def test_curves_end_at_corners() -> None:
    """[X] Sides of a square have no distance from themselves, nor do straight parts of quadratic
    elements, and flat joints are no round ones.
    """
    t = np.linspace(0, 1, 4)
    line = np.vstack([np.column_stack(p) for p in ((t, 0 * t + 1), (0 * t[1:] + 1, 1 - t[1:]))])
    for element in ("Q1", "Q2"):
        basis = vector_basis(body_along(line, element, 0.2), element)
        surface = Surface.from_boundary(basis, "face")
        np.testing.assert_allclose(Faceting.of(surface).coefficients, 0.0, atol=1e-12)
        assert not alike(surface, surface)


def test_gaps_of_the_mesh_count_where_they_are_meant() -> None:
    """[X] A round body on a flat one, and a polygon of eight sides in another one, keep their
    gaps.
    """
    for inner, outer, rounds in (
        (annulus(A, B, 64, 1), annulus(B, C, 52, 1), True),
        (annulus(A, B, 8, 1), annulus(B, C, 6, 1), False),
    ):
        basis = vector_basis(sc.join_bodies({"i": inner, "o": outer}), "Q1")
        pair = sc.ContactPair(basis, "o:inner", "i:outer", sc.Coulomb())
        state = pair.initial_state()
        assert pair.interface.smooth == rounds
        largest = np.abs(state.gap - state.clearance).max()
        assert (largest < 1e-3 * np.ptp(state.gap)) == rounds
    plate = MeshQuad.init_tensor(np.linspace(-1, 1, 9), [-2.0, -1.0]).with_defaults()
    basis = vector_basis(sc.join_bodies({"disc": annulus(A, C, 64, 2), "plate": plate}), "Q1")
    pair = sc.ContactPair(basis, "disc:outer", "plate:top", sc.Coulomb())
    assert not pair.interface.smooth and not np.any(pair.initial_state().clearance)
    adjusted = sc.ContactPair(basis, "disc:outer", "plate:top", sc.Coulomb(), initial="adjusted")
    assert not adjusted.interface.smooth


def test_file_of_an_earlier_version(tmp_path) -> None:
    """[X] States without the part of round facets are read as states that have none."""
    mesh = sc.join_bodies({"i": annulus(A, B, 24, 1), "o": annulus(B, C, 20, 1)})
    basis = Basis(mesh, vector_basis(mesh, "Q1").elem, intorder=2)
    forms = {
        "solid": sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=0.25)),
        "joint": sc.ContactPair(basis, "o:inner", "i:outer", sc.Coulomb()),
    }
    fixed = basis.get_dofs({"i:inner", "o:outer"}).all()
    model = sc.Model(forms, fixed)
    result = model.run([sc.Stage("rest")], progress=False)
    state = result["rest"].states["joint"]
    result.save(tmp_path / "rings.npz")
    again = sc.load_result(tmp_path / "rings.npz", model)["rest"].states["joint"]
    np.testing.assert_array_equal(again.rounded, state.rounded)
    assert np.any(state.rounded)

    arrays = {f"0/joint/{part}": np.asarray(values) for part, values in vars(state).items()}
    joint = model.forms["joint"]
    del arrays["0/joint/rounded"]
    assert _state("joint", joint, arrays, "0/joint").rounded == 0.0
    del arrays["0/joint/gap"]
    with pytest.raises(ValueError, match="another form"):
        _state("joint", joint, arrays, "0/joint")


@pytest.mark.parametrize(
    ("n", "quadrature", "peak", "is_told"),
    [
        (10, "segments", (2.0, 4.0), True),
        (10, 2, (0.95, 1.05), False),
        (40, "segments", (0.95, 1.05), False),
        (40, 2, (0.95, 1.05), False),
    ],
)
def test_facets_that_a_circle_touches_in_parts(n, quadrature, peak, is_told) -> None:
    """[X] H. Hertz: a rigid circle on the half-plane. Where straight facets touch it with their
    middles alone, peaks of the pressure are several times too high, and told.
    """
    radius, sunk = 10.0, 0.02
    x = np.append(np.linspace(0, 1, n + 1), 1 + 14 * np.linspace(0, 1, 13)[1:] ** 1.8)
    y = -15 * np.linspace(1, 0, 24) ** 2.5
    basis = vector_basis(MeshQuad.init_tensor(x, y).with_defaults(), "Q1", intorder=2)
    circle = sc.rigid.circle((0.0, radius), radius)
    forms = {
        "solid": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
        "joint": sc.ContactPair(basis, "top", circle, sc.Coulomb(), quadrature),
    }
    base = basis.get_dofs("bottom").all("u^2")
    moved = basis.zeros()
    moved[base] = sunk
    fixed = np.append(base, basis.get_dofs("left").all("u^1"))
    stage, remarks = remarked(forms, sc.Stage("press", prescribed=moved, increments=2), fixed)
    force = 2.0 * stage.reactions()[base].sum()  # of both halves
    highest = np.sqrt(force * 1e4 / (1 - 0.3**2) / np.pi / radius)
    assert peak[0] < stage.tractions("joint").pressure.max() / highest < peak[1]  # the mesh
    assert ("in parts alone" in remarks) == is_told
