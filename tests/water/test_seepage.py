"""Steady seepage: dams, layers, wells and joints with closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementHex1,
    ElementQuad1,
    ElementQuad2,
    ElementTetP1,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
    MeshHex,
    MeshQuad,
    MeshTet,
    MeshTri,
    MeshTri2,
)

import skfem_contact as sc
from skfem_contact.water.darcy import warn_of_dry_ground
from tests.tools.flows import steady
from tests.tools.helpers import distorted

ELEMENTS = {
    MeshTri: ElementTriP1,
    MeshQuad: ElementQuad1,
    MeshTet: ElementTetP1,
    MeshHex: ElementHex1,
}


def box(kind, *sides: np.ndarray):
    """A box with boundaries left, right, bottom and top: the last axis points up."""
    low, high = [s[0] + 1e-9 for s in sides], [s[-1] - 1e-9 for s in sides]
    return kind.init_tensor(*sides).with_boundaries(
        {
            "left": lambda x: x[0] < low[0],
            "right": lambda x: x[0] > high[0],
            "bottom": lambda x: x[-1] < low[-1],
            "top": lambda x: x[-1] > high[-1],
        }
    )


def dam(n: int, length: float, kind=MeshTri, height: float = 10.0, depth: float = 0.0):
    """A dam with n elements over its height."""
    x = np.linspace(0, length, int(n * length / height) + 1)
    width = () if kind in (MeshTri, MeshQuad) else (np.linspace(0, 1, 3),)
    return box(kind, x, *width, depth + np.linspace(0, height, n + 1))


def flow_through(
    mesh, up: float, down: float, k=1.0, unit_weight=9.81, **options
) -> sc.water.Seepage:
    """Flow from left to right with a seepage face."""
    heads = {"left": up} | ({"right": down} if down > 0 else {})
    return steady(
        Basis(mesh, ELEMENTS[type(mesh)]()),
        k,
        heads,
        seepage_face="right",
        unit_weight=unit_weight,
        **options,
    )


# -- the dam


@pytest.mark.parametrize("kind", [MeshTri, MeshQuad])
@pytest.mark.parametrize(("up", "down", "length"), [(10.0, 2.0, 5.0), (10.0, 0.0, 10.0)])
def test_discharge_of_a_dam(up, down, length, kind):
    """[X] Charny: k (h1² - h2²) / 2L within .15 %, better on finer meshes, in few iterations;
    nothing is lost.
    """
    exact, errors = (up**2 - down**2) / 2 / length, []
    for n in (10, 20, 40):
        water = flow_through(dam(n, length, kind), up, down)
        errors.append(abs(water.discharge("left") / exact - 1))
        assert sum(water.iterations) <= 40
        assert water.discharge("left") == pytest.approx(-water.discharge("right"), rel=1e-8)
    assert errors[0] < 1.5e-3
    assert errors[2] < errors[1] < errors[0]


@pytest.mark.parametrize("k", [(10.0, 1.0), (1.0, 10.0), [[5.0, 0.0], [0.0, 1.0]]], ids=str)
def test_discharge_does_not_depend_on_the_vertical_permeability(k):
    """[X] Charny's argument integrates over the height: only the horizontal permeability counts.

    Of first order in the elements: .54, .26, .13 and .06 % with 10, 20, 40 and 80 over the height
    and kh = 10 kv.
    """
    water = flow_through(dam(20, 10.0), 10.0, 2.0, k)
    assert water.discharge("left") == pytest.approx(np.ravel(k)[0] * 4.8, rel=3e-3)


@pytest.mark.parametrize("contrast", [3.0, 0.1])
def test_dam_with_a_core(contrast):
    """[X] Zones side by side: q = (h1² - h2²) / (2 sum of L / k), by the same argument."""
    mesh = dam(20, 10.0).with_subdomains(
        {"core": lambda x: abs(x[0] - 5) < 1, "shell": lambda x: abs(x[0] - 5) > 1}
    )
    water = flow_through(mesh, 10.0, 2.0, {"core": contrast, "shell": 1.0})
    assert water.discharge("left") == pytest.approx(48 / (8 + 2 / contrast), rel=1e-3)


def test_thrust_of_the_water_in_a_dam():
    """[X] The integral of the pressure over the height falls in proportion to the distance from the
    water.
    """
    water = flow_through(dam(40, 10.0), 10.0, 2.0, unit_weight=9.81)
    for x in (2.5, 5.0, 7.5):
        y = (np.arange(4000) + 0.5) / 400
        thrust = water.pressure_at(np.stack((0 * y + x, y))).mean() * 10.0
        assert thrust == pytest.approx(9.81 / 2 * (100 - 9.6 * x), rel=2e-3)


def test_free_surface():
    """It begins where the water stands and ends above the lower water; the head on it is its
    height.
    """
    water = flow_through(dam(40, 5.0), 10.0, 2.0)
    (surface,) = water.free_surface
    np.testing.assert_allclose(surface[0], [0.0, 10.0], atol=1e-9)
    assert surface[-1] == pytest.approx([5.0, 6.2], abs=0.3)
    assert (np.diff(surface[:, 0]) > -1e-9).all() and (np.diff(surface[:, 1]) < 1e-9).all()
    np.testing.assert_allclose(water.head_at(surface.T), surface[:, 1], atol=1e-9)


def test_dam_in_space():
    """[X] A slice of the dam in tetrahedra and hexahedra, 1 thick."""
    for kind in (MeshTet, MeshHex):
        water = flow_through(dam(10, 5.0, kind), 10.0, 2.0)
        assert water.discharge("left") == pytest.approx(9.6, rel=5e-3)
        with pytest.raises(ValueError, match="plane flow only"):
            water.free_surface  # noqa: B018


def test_retention_of_the_soil():
    """[X] A capillary fringe carries water too; without one the discharge is that of a free
    surface.
    """
    fringe = [
        flow_through(
            dam(20, 5.0), 10.0, 2.0, retention=sc.water.VanGenuchten(alpha, 3.0)
        ).discharge("left")
        for alpha in (1.0, 4.0, 16.0)
    ]
    assert fringe[0] > fringe[1] > fringe[2] > 0.99 * 9.6
    # the fringe is about 1 / (3 alpha) high, below the size of the elements
    assert fringe[2] == pytest.approx(9.6, rel=0.01)


def test_retention_by_subdomain():
    """A core that sucks water more than its shell; one law for all is the law of every
    subdomain.
    """
    mesh = dam(20, 10.0).with_subdomains(
        {"core": lambda x: abs(x[0] - 5) < 1, "shell": lambda x: abs(x[0] - 5) > 1}
    )
    laws = {"core": sc.water.VanGenuchten(0.5, 2.0), "shell": sc.water.Ramp()}
    mixed = flow_through(mesh, 10.0, 2.0, retention=laws).discharge("left")
    ramps = {"core": sc.water.Ramp(), "shell": sc.water.Ramp()}
    same = flow_through(mesh, 10.0, 2.0, retention=ramps).discharge("left")
    assert same == pytest.approx(flow_through(mesh, 10.0, 2.0).discharge("left"), rel=1e-9)
    assert mixed > 1.001 * same


@pytest.mark.parametrize(
    "law",
    [
        sc.water.Ramp(0.5),
        sc.water.Ramp(2.0, 0.1),
        sc.water.VanGenuchten(2.0, 3.0),
        sc.water.VanGenuchten(0.3, 1.5),
    ],
    ids=repr,
)
def test_slope_of_the_relative_permeability(law):
    """[N] Slopes against central differences; the permeability falls from 1 with suction."""
    suction, size, step = np.linspace(-2.0, 4.0, 301) + 0.0037, np.full(301, 0.8), 1e-6
    value, slope = law.relative(suction, size)
    up, down = (law.relative(suction + s, size)[0] for s in (step, -step))
    smooth = np.abs(suction) > 0.01  # van Genuchten's curve has a kink at 0
    # differences of numbers near 1 over 2e-6: 1e-10 of round-off, and the curvature of the steepest
    # part
    np.testing.assert_allclose(slope[smooth], ((up - down) / 2 / step)[smooth], atol=1e-7)
    assert (np.diff(value) <= 0).all() and value[0] == 1.0 and value[-1] > 0.0
    np.testing.assert_allclose(law.softer(2.0).relative(2 * suction, size)[0], value, rtol=1e-12)


# -- layers, directions, wells


@pytest.mark.parametrize("kind", ELEMENTS, ids=lambda kind: kind.__name__)
def test_layers(kind):
    """[X] Flow across layers and along them, in every kind of element; any basis of the mesh will
    do.
    """
    g = np.linspace(0, 1, 5)
    mesh = box(kind, *(g for _ in range(2 if kind in (MeshTri, MeshQuad) else 3))).with_subdomains(
        {"clay": lambda x: x[-1] < 0.5, "sand": lambda x: x[-1] > 0.5}
    )
    k = {"clay": 1e-7, "sand": 1e-5}
    for element in (ELEMENTS[kind](), ElementVector(ELEMENTS[kind]())):
        up = sc.water.Flow(Basis(mesh, element), k, unit_weight=9.81).steady(
            sc.water.Conditions(head={"bottom": 3.0, "top": 2.0})
        )
        q = 1.0 / (0.5 / 1e-7 + 0.5 / 1e-5)
        assert up.iterations == (1,)
        assert up.discharge("bottom") == pytest.approx(q, rel=1e-9) == -up.discharge("top")
        np.testing.assert_allclose(up.velocity[-1], q, rtol=1e-9)
    along = sc.water.Flow(Basis(mesh, element), k, unit_weight=9.81).steady(
        sc.water.Conditions(head={"left": 3.0, "right": 2.0})
    )
    assert along.discharge("left") == pytest.approx(0.5 * (1e-7 + 1e-5), rel=1e-9)


def test_quadratic_meshes():
    """[X] Pressures are at the vertices of quadratic meshes: straight ones by P2 and Q2, curved
    ones by MeshTri2.
    """
    for mesh, element in (
        (dam(4, 10.0), ElementTriP2()),
        (dam(4, 10.0, MeshQuad), ElementQuad2()),
        (MeshTri2.from_mesh(dam(4, 10.0)).with_boundaries(dam(4, 10.0).boundaries), ElementTriP2()),
    ):
        water = sc.water.Flow(Basis(mesh, ElementVector(element)), 1.0, unit_weight=9.81).steady(
            sc.water.Conditions(head={"left": 12.0, "right": 11.0})
        )
        np.testing.assert_allclose(
            water.head[: mesh.nvertices], 12.0 - mesh.p[0, : mesh.nvertices] / 10, rtol=1e-12
        )
        assert len(water.pressure) == mesh.nvertices


@pytest.mark.parametrize("kind", [MeshTri, MeshQuad, MeshTet])
def test_any_direction(kind, rng):
    """[X] Patch test: with a full tensor a linear head on all sides is linear inside, on a
    distorted mesh.
    """
    dim = 3 if kind is MeshTet else 2
    mesh = box(kind, *(np.linspace(0, 1, 5) for _ in range(dim)))
    inner = ~np.isin(np.arange(mesh.nvertices), mesh.facets[:, mesh.boundary_facets()])
    moved = distorted(mesh, rng, 0.05).p
    mesh = type(mesh)(np.where(inner, moved, mesh.p), mesh.t).with_boundaries(
        {"all": lambda x: x[0] < np.inf}
    )
    tensor = np.diag([3.0, 1.0, 2.0][:dim]) + 0.5
    slope = np.array([0.5, -0.3, 0.2][:dim])
    water = sc.water.Flow(Basis(mesh, ELEMENTS[kind]()), tensor, unit_weight=9.81).steady(
        sc.water.Conditions(head={"all": lambda x: 9 + slope @ x})
    )
    np.testing.assert_allclose(water.head, 9 + slope @ mesh.p, rtol=1e-12)
    np.testing.assert_allclose(
        water.velocity, np.tile(-(tensor @ slope)[:, None], mesh.nelements), rtol=1e-9
    )


@pytest.mark.parametrize(
    "kind, coordinates", [(MeshTri, "axial"), (MeshTri, "space"), (MeshTet, "axisymmetric")]
)
def test_coordinates_that_do_not_suit_the_mesh(kind, coordinates):
    with pytest.raises(ValueError, match=rf"coordinates .*must be .*, not '{coordinates}'"):
        sc.water.Flow(
            Basis(kind(), ELEMENTS[kind]()), 1.0, unit_weight=9.81, coordinates=coordinates
        ).steady(sc.water.Conditions(head={}))


@pytest.mark.parametrize("confined", [True, False])
def test_well(confined):
    """[X] Thiem's well in a confined layer and Dupuit's discharge of a well with a free surface
    (exact by Charny).
    """
    radius, far, n = 0.5, 20.0, 30
    r = radius * (far / radius) ** np.linspace(0, 1, 2 * n + 1)
    mesh = box(MeshQuad, r, np.linspace(0, 10, n + 1))
    high, low = (15.0, 12.0) if confined else (10.0, 3.0)
    water = sc.water.Flow(
        Basis(mesh, ElementQuad1()), 1e-4, unit_weight=9.81, coordinates="axisymmetric"
    ).steady(sc.water.Conditions(head={"right": high, "left": low}, seepage_face="left"))
    depth = 10 * (high - low) if confined else (high**2 - low**2) / 2
    assert water.discharge("left") == pytest.approx(-1e-4 * depth / np.log(far / radius), rel=3e-3)
    if confined:
        assert water.flux("right")[1] == pytest.approx(
            1e-4 * 3 / np.log(far / radius) / far, rel=3e-3
        )


# -- several bodies, parts of the ground


@pytest.mark.parametrize("matching", [True, False])
def test_joint(matching):
    """[X] Water passes a joint between bodies that share no node: the discharge is that of the
    welded dam.
    """
    y = np.linspace(0, 10, 21)
    left = MeshTri.init_tensor(np.linspace(0, 4, 9), y).with_defaults()
    right = MeshTri.init_tensor(
        np.linspace(4, 10, 13), y if matching else np.linspace(0, 10, 25)
    ).with_defaults()
    basis = Basis(sc.join_bodies({"a": left, "b": right}), ElementTriP1())
    water = sc.water.Flow(basis, 1.0, unit_weight=9.81, connected=[("a:right", "b:left")]).steady(
        sc.water.Conditions(head={"a:left": 10.0}, seepage_face="b:right")
    )
    assert water.discharge("a:left") == pytest.approx(5.0, rel=2e-3)
    assert water.discharge("b:right") == pytest.approx(-water.discharge("a:left"), rel=1e-8)
    assert water.discharge("b:left", of="b") == pytest.approx(water.discharge("a:left"), rel=1e-8)
    assert water.discharge("a:right", of="a") == pytest.approx(-water.discharge("a:left"), rel=1e-8)
    if matching:
        whole = sc.water.Flow(Basis(dam(20, 10.0), ElementTriP1()), 1.0, unit_weight=9.81).steady(
            sc.water.Conditions(head={"left": 10.0}, seepage_face="right")
        )
        assert water.discharge("a:left") == pytest.approx(whole.discharge("left"), rel=1e-9)


@pytest.mark.parametrize(("middle", "error"), [(5, 1e-9), (9, 1e-9), (6, 0.01)])
def test_joints_of_three_bodies_in_space(middle, error):
    """[X] A stack of three cubes, the middle one tied to both others: flow in series.

    Each node of the finer side passes its water on to the corners of the facet that it meets. The
    sums at these are even only if all nodes of one side are among those of the other: the rest is
    an error that goes with the mesh.
    """
    cubes = {
        name: box(MeshTet, *(np.linspace(0, 1, n) for _ in range(2)), z + np.linspace(0, 1, n))
        for name, n, z in (("low", 5, 0), ("mid", middle, 1), ("top", 5, 2))
    }
    basis = Basis(sc.join_bodies(cubes), ElementTetP1())
    joints = [("low:top", "mid:bottom"), ("mid:top", "top:bottom")]
    k = {"low": 1.0, "mid": 0.5, "top": 1.0}
    water = sc.water.Flow(basis, k, unit_weight=9.81, connected=joints).steady(
        sc.water.Conditions(head={"low:bottom": 7.0, "top:top": 3.0})
    )
    assert water.discharge("low:bottom") == pytest.approx(4 / (1 + 2 + 1), rel=error)


def test_cut_through_the_ground():
    """Through any line that bounds a subdomain the same water passes, from either side."""
    mesh = dam(20, 10.0).with_subdomains({"near": lambda x: x[0] < 5, "far": lambda x: x[0] > 5})
    mesh = mesh.with_boundaries({"middle": mesh.facets_satisfying(lambda x: np.isclose(x[0], 5))})
    water = flow_through(mesh, 10.0, 2.0)
    assert water.discharge("middle", of="far") == pytest.approx(water.discharge("left"), rel=1e-8)
    assert water.discharge("middle", of="near") == pytest.approx(-water.discharge("left"), rel=1e-8)


def test_part_of_the_mesh_is_porous():
    """Concrete on the ground: elements outside of the basis carry no water, their nodes have no
    head.
    """
    mesh = box(MeshQuad, np.linspace(0, 8, 17), np.linspace(0, 4, 9)).with_subdomains(
        {
            "ground": lambda x: x[1] < 3,
            "wall": lambda x: (x[1] > 3) & (abs(x[0] - 4) < 1),
            "air": lambda x: (x[1] > 3) & (abs(x[0] - 4) > 1),
        }
    )
    surface = mesh.facets_satisfying(lambda x: np.isclose(x[1], 3))
    middle = mesh.p[0][mesh.facets[:, surface]].mean(axis=0)
    mesh = mesh.with_boundaries({"up": surface[middle < 3], "down": surface[middle > 5]})
    basis = Basis(mesh, ElementVector(ElementQuad1())).with_elements("ground")
    water = sc.water.Flow(basis, 1e-5, unit_weight=9.81).steady(
        sc.water.Conditions(head={"up": 4.0, "down": 3.0})
    )
    assert (
        np.isnan(water.head[mesh.p[1] > 3.01]).all()
        and np.isfinite(water.head[mesh.p[1] < 3.01]).all()
    )
    assert water.head[np.isclose(mesh.p[0], 4) & np.isclose(mesh.p[1], 0)] == pytest.approx(3.5)
    with pytest.raises(
        ValueError, match=r"points lie outside of the porous ground, the first is \(4, 3.5\)"
    ):
        water.pressure_at(np.array([[4.0, 1.0], [3.5, 1.0]]))


def test_boundaries_that_meet_share_their_node():
    """The sum over all boundaries is zero although two of them hold the node of the corner."""
    mesh = dam(10, 10.0)
    heads = {"left": 12.0, "right": 11.0, "bottom": lambda x: 12.0 - 0.1 * x[0]}
    water = sc.water.Flow(Basis(mesh, ElementTriP1()), 1.0, unit_weight=9.81).steady(
        sc.water.Conditions(head=heads)
    )
    parts = [water.discharge(name) for name in ("left", "right", "bottom")]
    assert sum(parts) == pytest.approx(0.0, abs=1e-12)
    assert water.discharge("top") == 0.0
    nodes, flux = water.flux("left")
    assert set(nodes) == set(mesh.facets[:, mesh.boundaries["left"]].ravel())
    assert flux.shape == nodes.shape


def test_values_at_places(rng):
    """[X] Interpolation is exact for a linear head, in thin elements too, at nodes and on sides."""
    for kind in (MeshTri, MeshQuad, MeshTet):
        x = np.concatenate(([0.0], np.geomspace(1e-3, 1, 12)))
        mesh = box(kind, x, *(np.linspace(0, 1, 3) for _ in range(1 if kind is not MeshTet else 2)))
        water = sc.water.Flow(Basis(mesh, ELEMENTS[kind]()), 1.0, unit_weight=10.0).steady(
            sc.water.Conditions(head={"left": 3.0, "right": 2.0})
        )
        places = np.hstack((rng.uniform(size=(mesh.dim(), 500)), mesh.p))
        np.testing.assert_allclose(water.head_at(places), 3.0 - places[0], rtol=1e-9)
        pressure = 10 * (3 - places[0] - places[-1])
        np.testing.assert_allclose(water.pressure_at(places[:, None]), pressure[None], rtol=1e-9)


def test_dry_ground_below_a_slab_does_not_lift_it():
    """[X] The pressure 10 (1 - x) along a sole of 2 m lifts with 5 in its first half alone."""
    mesh = box(MeshQuad, np.linspace(0, 2, 5), np.linspace(0, 2, 3)).with_subdomains(
        {"ground": lambda x: x[1] < 1, "slab": lambda x: x[1] > 1}
    )
    mesh = mesh.with_boundaries({"sole": lambda x: x[1] == 1.0}, boundaries_only=False)
    ground = Basis(mesh, ElementQuad1()).with_elements("ground")
    flow = sc.water.Flow(ground, 1.0, unit_weight=10.0)
    confined = replace(
        flow.steady(sc.water.Conditions({"left": 2.0})),
        head=2.0 - mesh.p[0],
        pressure=10.0 * (2.0 - mesh.p[0] - mesh.p[1]),
    )
    assert confined.uplift_factor("sole", {"slab": 20.0}) == pytest.approx(40.0 / 5.0, rel=1e-12)


@pytest.mark.parametrize(("share", "told"), [(0.048, False), (0.052, True)])
def test_a_twentieth_of_the_flow_through_dry_ground_is_told(share, told, recwarn):
    """[X] One of two elements is wet, the other dry and ten times as permeable, with a share of the
    flow.
    """
    basis = Basis(box(MeshQuad, np.linspace(0, 2, 3), np.linspace(0, 1, 2)), ElementQuad1())
    left = basis.mesh.p[0, basis.mesh.t].mean(axis=0) < 1.0
    k = np.where(left, 1.0, 1e4)[:, None, None] * np.eye(2)
    relative = np.where(left, 1.0, 1e-3)[:, None] * np.ones((2, basis.X.shape[1]))
    velocity = np.stack((np.where(left, 1.0 - share, share), np.zeros(2)))
    warn_of_dry_ground(basis, k, relative, velocity)
    assert bool(recwarn) == told


@pytest.mark.parametrize(("coordinates", "area"), [("plane", 2.0), ("axisymmetric", 4.0)])
def test_flow_through_a_boundary_of_one_facet(coordinates, area):
    """[X] Darcy's flow down a column of one element, from 1 to 3: in axial symmetry by radian."""
    mesh = MeshQuad.init_tensor([1.0, 3.0], [0.0, 0.5, 2.0]).with_defaults()
    flow = sc.water.Flow(
        Basis(mesh, ElementQuad1()), permeability=2e-3, unit_weight=10.0, coordinates=coordinates
    )
    water = flow.steady(sc.water.Conditions(head={"bottom": 3.0, "top": 4.0}))
    for side, sign in (("top", 1.0), ("bottom", -1.0)):
        np.testing.assert_allclose(water.flux(side)[1], sign * 1e-3, rtol=1e-12)
        assert water.discharge(side) == pytest.approx(sign * 1e-3 * area, rel=1e-12)
