"""Facets that overlap in the mesh, and nodes at joints of the master."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest
from skfem import FacetBasis, LinearForm, MeshQuad

import skfem_contact as sc
from skfem_contact.checks import format_point
from skfem_contact.contact.diagnosis import _on_distance
from skfem_contact.contact.laws import Status
from skfem_contact.contact.penalty import choose_penalties
from tests.tools import space
from tests.tools.helpers import grid, moved_rigidly, vector_basis
from tests.tools.scenes import remarked

AUGMENTED = sc.AugmentedLagrangian()


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
@pytest.mark.one_in(2)
def test_overlaps_of_straight_facets_are_warned_of(rule, disc: int, ring: int) -> None:
    """[X] Facets of round meshes that do not match overlap by more than the load presses, where
    gaps count as rounded corners have them; as smooth curves and adjusted they do not.
    """
    mean, _, remarks = fitted(disc, ring, rule, smoothing=0.1)
    assert mean > 3.0 and "overlap" in remarks
    for initial in ("as meshed", "adjusted"):
        mean, _, remarks = fitted(disc, ring, rule, initial=initial)
        assert mean == pytest.approx(
            1.0, abs=0.01
        )  # polygons of 100 sides, elements of 1/4; measured -0.5 %
        assert "do not match overlap" not in remarks


def test_facets_that_slide_after_they_were_adjusted_get_another_advice() -> None:
    """[X] A polygon of 24 sides in one of 18 touches it as adjusted, and overlaps when it turns."""
    mesh = sc.join_bodies({"disc": annulus(0.5, 1.0, 24, 2), "ring": annulus(1.0, 2.0, 18, 2)})
    basis = vector_basis(mesh, "Q1", intorder=2)
    body = sc.SolidForm(basis, sc.LinearElastic(E=100.0, nu=0.3), kinematics="finite")
    pair = sc.ContactPair(basis, "disc:outer", "ring:inner", sc.Coulomb(), initial="adjusted")
    inner = basis.get_dofs("disc:inner").all()
    fixed = [inner, basis.get_dofs("ring:outer").all()]
    u = basis.zeros()
    u[inner] = moved_rigidly(basis, np.degrees(0.5), (0.0, 0.0))[inner]
    stage = sc.Stage("turned", prescribed=u, increments=4)
    _, told = remarked({"body": body, "pair": pair}, stage, np.concatenate(fixed))
    assert "do not match overlap by up to" in told
    assert "slid from where they were adjusted" in told
    assert 'initial="adjusted"' not in told


def fitted_along(overlap, nodes: tuple[int, int], initial: str, aside: float = 0.0) -> str:
    """Warnings of two blocks whose upper one lies inside the lower one by a function of x."""
    low = MeshQuad.init_tensor(np.linspace(0, 1, nodes[0] + 1) + aside, np.linspace(0, 1, 4))
    up = MeshQuad.init_tensor(np.linspace(0, 1, nodes[1] + 1), np.linspace(1, 2, 4))
    x, y = up.p
    up = replace(up, doflocs=np.stack((x, y - overlap(x) * (2.0 - y))))
    bodies = {
        "low": low.with_boundaries({"joint": lambda x: x[1] > 0.99, "end": lambda x: x[1] < 0.01}),
        "up": up.with_boundaries({"joint": lambda x: x[1] < 1.1, "end": lambda x: x[1] > 1.99}),
    }
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    forms = {
        "solid": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
        "joint": sc.ContactPair(basis, "up:joint", "low:joint", sc.Coulomb(0.3), initial=initial),
    }
    fixed = [basis.get_dofs(side).all() for side in ("low:end", "up:end")]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = sc.Model(forms, fixed).run([sc.Stage("fit", increments=4)], progress=False)
    assert result["fit"].tractions("joint").pressure.max() > 10.0
    return "; ".join(str(warning.message) for warning in caught)


@pytest.mark.parametrize("initial", ["ramped", "as meshed"])
@pytest.mark.parametrize("nodes", [(4, 4), (4, 5)])
@pytest.mark.parametrize("deeper", [0.0, 0.01, -0.005])
def test_overlaps_like_a_wedge_are_no_ripple(initial: str, nodes: tuple[int, int], deeper) -> None:
    """[X] Straight sides at an angle overlap evenly, whether their facets match or not."""
    told = fitted_along(lambda x: deeper + 0.01 * x, nodes, initial)
    assert "do not match" not in told


@pytest.mark.parametrize(
    "overlap",
    [
        lambda x: 0.04 * x * (1.0 - x),
        lambda x: 0.04 * (x - 0.5) ** 2,
        lambda x: 0.005 + 0.005 * np.sin(2.0 * np.pi * x),
    ],
)
def test_facets_that_match_are_not_called_others(overlap) -> None:
    """[X] Round overlaps of facets with the same nodes, with others, or half a facet aside."""
    matching = fitted_along(overlap, (8, 8), "as meshed")
    assert "overlap by up to" in matching and "match" not in matching
    others = [fitted_along(overlap, (4, 5), "as meshed")]
    others.append(fitted_along(overlap, (8, 8), "as meshed", aside=1 / 16))  # half of a facet
    assert all("do not match overlap by up to" in told for told in others)


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


def test_points_that_are_too_deep_or_touch_nothing_are_told() -> None:
    """[X] Some points deeper than an element, with the deepest of them; or no point that touches,
    with the smallest gap beyond the clearance.
    """
    low, up = grid("Q1", np.linspace(0, 4, 9), [0, 1]), grid("Q1", np.linspace(1, 2, 4), [1, 2])
    mesh = sc.join_bodies({"low": low, "up": up})
    basis = vector_basis(mesh, "Q1")
    pair = sc.ContactPair(basis, "up:bottom", "low:top", sc.Coulomb(), "nodal", penalty=1e4)
    state = pair.initial_state()
    points = pair.points(state)
    deep = pair.interface.depth(points)
    place = points.positions(pair.slave.nodes)

    def told(gap, status):
        now = replace(state, gap=gap, status=np.full(len(gap), status), clearance=np.full(4, 0.02))
        return [(remark.kind, remark.figure, remark.text) for remark in _on_distance(pair, now)]

    # Two of four points lie behind the surface
    ((kind, figure, text),) = told(-deep * [0.5, 1.5, 1.1, 0.0], Status.STICK)
    assert (kind, figure) == ("too deep", pytest.approx(1.5 * deep[1], rel=1e-12))
    assert (
        f"2 of 4 points of 'up:bottom' lie deeper in 'low:top' than an element, up to {figure:.3g}"
        in text
    )
    assert f"deepest is at {format_point(place[1])} of the mesh" in text
    # None does, and none or all of them are open
    gap = np.array([0.3, 0.1, 0.2, np.inf])
    assert told(-0.9 * deep, Status.OPEN)[0][0] == "open"
    assert not told(-0.9 * deep, Status.STICK)
    ((kind, figure, text),) = told(gap, Status.OPEN)
    assert (kind, figure) == ("open", pytest.approx(0.08, rel=1e-12))
    assert (
        f"gap is 0.08 between 'up:bottom' and 'low:top', smallest at {format_point(place[1])}"
        in text
    )
    ((_, _, text),) = told(np.full(4, np.inf), Status.OPEN)
    assert "nothing of 'low:top' lies opposite 'up:bottom'" in text
