"""Sections: names and measures of areas and lines, interfaces, refusals, random sections."""

from __future__ import annotations

import builtins
import os
import warnings

import numpy as np
import pytest
from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact as sc
from skfem_contact.section import Section, circle, rectangle
from skfem_contact.section.meshing import sharpest
from skfem_contact.section.outline import Outline

gmsh = pytest.importorskip(
    "gmsh",
    reason="gmsh is not installed, or a library of the system that it needs is missing",
    exc_type=(ImportError, OSError),
)

#: Random sections in every run; SECTIONS=200 tries as many.
RANDOM = int(os.environ.get("SECTIONS", "12"))
GROUND = {"clay": rectangle((-20.0, 20.0), (-15.0, 0.0))}


def area_of(mesh, name):
    """Area of a subdomain."""
    return float(Basis(mesh, mesh.elem(), elements=name, intorder=4).dx.sum())


def length_of(mesh, name):
    """Length of a boundary, whose facets may be of second order."""
    facets = np.asarray(mesh.boundaries[name])
    a, b = mesh.p[:, mesh.facets[:, facets]].transpose(1, 0, 2)
    m = (
        mesh.doflocs[:, mesh.nvertices + facets]
        if mesh.doflocs.shape[1] > mesh.nvertices
        else 0.5 * (a + b)
    )
    points, weights = np.polynomial.legendre.leggauss(5)
    along = 0.5 * (b - a)[..., None] + (a - 2.0 * m + b)[..., None] * points
    return float((np.linalg.norm(along, axis=0) @ weights).sum())


def test_pit_beside_a_wall_has_all_names() -> None:
    """[X] Areas, lifts, walls and the outside have their names and measures; the sides of the wall
    are double.
    """
    pit = Section(
        {"sand": rectangle((-10, 20), (-4, 0)), "clay": rectangle((-10, 20), (-15, -4))},
        size=3.0,
        lifts={"lift 1": rectangle((-10, 0), (-3, 0)), "lift 2": rectangle((-10, 0), (-6, -3))},
        lines={"wall": [(0, 0), (0, -9)], "drain": [(5, -1), (12, -1)], "load": [(3, 0), (6, 0)]},
        slits="wall",
    )
    assert pit.parts == {
        "remaining": ("sand", "clay"),
        "lift 1": ("sand",),
        "lift 2": ("sand", "clay"),
    }
    mesh = pit.mesh()
    sc.mesh.check_mesh(mesh)
    areas = {
        "sand": 120.0,
        "clay": 330.0,
        "lift 1": 30.0,
        "lift 2": 30.0,
        "remaining": 390.0,
        "ground": 450.0,
    }
    lengths = {
        "wall|left": 9.0,
        "wall|right": 9.0,
        "drain": 7.0,
        "load": 3.0,
        "left": 15.0,
        "right": 15.0,
        "bottom": 30.0,
        "surface": 30.0,
        "sand|clay": 30.0,
        "clay|sand": 30.0,
        "lift 1|lift 2": 10.0,
        "lift 2|remaining": 10.0,
        "remaining|lift 2": 10.0,
        "lift 1|wall": 3.0,
        "lift 2|wall": 3.0,
        "remaining|wall|left": 3.0,
        "remaining|wall|right": 9.0,
        "lift 1:surface": 10.0,
    }
    for name, value in areas.items():
        assert area_of(mesh, name) == pytest.approx(value, rel=1e-12)  # round-off
    for name, value in lengths.items():
        assert length_of(mesh, name) == pytest.approx(value, rel=1e-12)
    assert sorted(pit.sides("wall", mesh)) == [
        "lift 1|wall",
        "lift 2|wall",
        "remaining|wall|left",
        "remaining|wall|right",
    ]
    for name, above in (
        ("lift 1|lift 2", True),
        ("lift 2|lift 1", False),
    ):  # each is seen from its own lift
        facets = mesh.boundaries[name]
        owner = mesh.f2t[facets.ori, np.asarray(facets)]
        assert (mesh.p[1, mesh.t[:, owner]].mean(axis=0) > -3.0).all() == above


def test_bodies_touch_by_contact_alone() -> None:
    """[X] A footing and a ring share no node with the ground; both sides of each interface have
    names.
    """
    section = Section(
        {**GROUND, "footing": rectangle((-2, 2), (-1, 1)), "ring": circle((0.0, -8.0), 2.0)},
        size=4.0,
        bodies=["footing", "ring"],
        replace=True,
        holes={"bore": circle((0.0, -8.0), 1.7)},
    )
    mesh = section.mesh()
    assert set(sc.mesh.bodies(mesh)) == {"ground", "footing", "ring"}
    for one, two, length in (("ground", "footing", 6.0), ("ground", "ring", 4.0 * np.pi)):
        assert length_of(mesh, f"{one}|{two}") == pytest.approx(
            length, rel=5e-6
        )  # 24 sides of second order
        assert length_of(mesh, f"{two}|{one}") == pytest.approx(
            length_of(mesh, f"{one}|{two}"), rel=1e-14
        )
    assert length_of(mesh, "bore") == pytest.approx(3.4 * np.pi, rel=5e-6)
    assert area_of(mesh, "ring") == pytest.approx(np.pi * (4.0 - 1.7**2), rel=1e-5)  # the same
    assert length_of(mesh, "footing:surface") == pytest.approx(4.0, rel=1e-12)
    assert length_of(mesh, "footing:top") == pytest.approx(4.0, rel=1e-12)
    assert length_of(mesh, "footing:sides") == pytest.approx(2.0, rel=1e-12)


def test_second_order_follows_arcs() -> None:
    """[X] The error of the area of a circle falls with the fourth power of the size."""
    section = Section({"disc": circle((0.0, 0.0), 1.0)}, size=1.0)
    meshes = [section.mesh(scale=scale) for scale in (1.0, 0.125)]
    errors = [abs(area_of(mesh, "disc") - np.pi) for mesh in meshes]
    sides = [len(mesh.boundary_facets()) for mesh in meshes]
    assert errors[0] < 5e-5
    assert sides[1] > 1.5 * sides[0]
    assert errors[0] * sides[0] ** 4 == pytest.approx(
        errors[1] * sides[1] ** 4, rel=0.05
    )  # terms of sixth order
    assert section.mesh(order=1).p.shape[1] < section.mesh().doflocs.shape[1]


def test_a_hole_may_cut_the_outside() -> None:
    """[X] A bore through the bottom leaves a notch with its name; what is left of the bottom keeps
    its own.
    """
    mesh = Section(GROUND, size=4.0, holes={"bore": rectangle((-1, 1), (-16, -12))}).mesh()
    assert length_of(mesh, "bore") == pytest.approx(8.0, rel=1e-12)
    assert length_of(mesh, "bottom") == pytest.approx(38.0, rel=1e-12)


def test_surface_cuts_off() -> None:
    """[X] Layers are cut off along the profile of the surface."""
    hill = Section(
        {"clay": rectangle((0, 10), (-5, 20))}, size=2.0, surface=[(0, 0), (4, 0), (8, 4), (10, 4)]
    )
    mesh = hill.mesh()
    assert area_of(mesh, "clay") == pytest.approx(66.0, rel=1e-12)
    assert length_of(mesh, "surface") == pytest.approx(6.0 + 32.0**0.5, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"areas": {"bow": [(0, 0), (4, 4), (4, 0), (0, 3)]}},
            "'bow' crosses or touches itself near \\(1.714, 1.714",
        ),
        (
            {"areas": {**GROUND, "sand": rectangle((0, 5), (-3, -1))}},
            "'clay' and 'sand' overlap by an area of 10 near",
        ),
        (
            {"areas": {**GROUND, "sand": rectangle((0, 5), (-1e-3, 2))}},
            "'clay' and 'sand' overlap by an area of 0.005",
        ),
        (
            {"lines": {"wall": [(0, 2), (0, -4)]}},
            "2 of the 6 of line 'wall' lie outside of the areas, near \\(0, 1\\)",
        ),
        ({"lines": {"wall": [(30, 2), (30, -4)]}}, "6 of the 6 of line 'wall' lie outside"),
        (
            {"lifts": {"a": rectangle((0, 5), (-3, 0)), "b": rectangle((4, 8), (-3, 0))}},
            "lifts 'a' and 'b' overlap by an",
        ),
        (
            {"lifts": {"a": rectangle((15, 25), (-3, 0))}},
            "the lift 'a' leaves the areas by an area of 15",
        ),
        (
            {"holes": {"bore": rectangle((-30, 30), (-30, 10))}},
            "nothing is left of the area 'clay'",
        ),
        ({"holes": {"bore": rectangle((40, 50), (-30, 10))}}, "the hole 'bore' cuts nothing"),
        (
            {
                "areas": {
                    **GROUND,
                    "cap": [(-2, 0), (-2, 2), (2, 2), (2, 0), (1, 0), (0, 1), (-1, 0)],
                }
            },
            "enclose a gap near .*, 0.3174",
        ),
        (
            {"areas": {**GROUND, "cap": [(-1, 0), (-1, 2), (1, 2), (1, 0), (0, 1)]}},
            "they touch in a point near \\(-?1, 0",
        ),
        ({"areas": {"clay": [(0, 0), (1, 1), (2, 2)]}}, "'clay' has no area"),
        (
            {"areas": {"clay": [(0, 0), (1, 1)]}},
            "'clay' has 2 different points: an area needs three",
        ),
        ({"areas": {"clay": [(0, 0), (1, np.nan), (2, 2)]}}, "points of 'clay' must be finite"),
        ({"areas": {}}, "at least one area"),
        ({"lines": {"clay": [(0, 0), (0, -4)]}}, "the name 'clay' is not unique"),
        (
            {"lines": {"surface": [(0, 0), (0, -4)]}},
            "'surface' is the name of a part of every mesh",
        ),
        ({"lines": {"a|b": [(0, 0), (0, -4)]}}, "names are texts without"),
        (
            {"lines": {"wall": [(0, 0), (0, -4), (1, -4), (-1, -1)]}},
            "'wall' crosses or touches itself",
        ),
        ({"slits": "wall"}, "there is no line 'wall'"),
        ({"sizes": {"wal": 1.0}}, "there is no area, lift, line or hole 'wal'; existing: clay"),
        ({"size": 0.0}, "size must be a finite number above 0"),
        (
            {"surface": [(0, 0), (5, 1)]},
            "the surface reaches from x = 0 to 5, the areas from -20 to 20",
        ),
        ({"coordinates": "axisymmetric"}, "'clay' reaches to x = -20"),
        (
            {"lines": {"a": [(0, 0), (0, -4)], "b": [(1e-6, -1), (1e-6, -3)]}},
            "are 1e-06 apart near",
        ),
        (
            {"areas": {**GROUND, "fill": rectangle((-20, 20), (1e-4, 4))}, "bodies": "fill"},
            "are 0.0001 apart near .* takes 2.7e\\+05 sides",
        ),
        (
            {"areas": {**GROUND, "fill": rectangle((-20, 20), (1e-3, 4))}},
            "'clay' and 'fill' do not hang together: they are 0.001 apart near .*, 0\\): let them "
            "share a line",
        ),
        (
            {"areas": {"clay": [(0, 0), (4, 0), (4, 2), (4 - 9e-8, 2), (0, 2)]}},
            "two points of 'clay' near .* are 9e-08",
        ),
        (
            {"holes": {"bore": circle((0.0, -5.0), 5.0)}},
            "meet at an angle of 0.032 degrees near \\(0, ",
        ),
    ],
)
def test_wrong_sketches_are_refused_by_name(change, message) -> None:
    """One ValueError says what is wrong, by how much and where."""
    with pytest.raises(ValueError, match=message):
        Section(**{"areas": GROUND, "size": 5.0, **change}).mesh()


def test_parts_that_stand_apart_are_told(recwarn) -> None:
    """Fill half a metre above the ground is meshed with a warning, a body without."""
    areas = {**GROUND, "fill": rectangle((-20, 20), (0.5, 4))}
    mesh = Section(areas, size=5.0, bodies="fill").mesh()
    assert not recwarn and len(sc.mesh.bodies(mesh)) == 2
    with pytest.warns(
        sc.AnalysisWarning, match=r"'clay' and 'fill' do not hang together: they are 0.5 apart near"
    ):
        assert len(sc.mesh.bodies(Section(areas, size=5.0).mesh())) == 2


def test_without_gmsh_one_error_names_the_extra(monkeypatch) -> None:
    """An ImportError says what to install, for a missing package and for a missing library of the
    system.
    """
    real = builtins.__import__
    for error, words in (
        (ModuleNotFoundError("no"), r"skfem-contact\[mesh\]"),
        (OSError("libGLU.so.1"), "libGLU"),
    ):

        def fails(name, *args, error=error):
            if name == "gmsh":
                raise error
            return real(name, *args)

        monkeypatch.setattr(builtins, "__import__", fails)
        with pytest.raises(ImportError, match=words):
            Section(GROUND, size=5.0).mesh()


def test_a_session_of_gmsh_stays() -> None:
    """A model of the user's own survives, and so do the options."""
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.model.add("mine")
        gmsh.option.setNumber("Mesh.ElementOrder", 2)
        Section(GROUND, size=5.0).mesh()
        assert gmsh.model.getCurrent() == "mine"
        assert gmsh.option.getNumber("Mesh.ElementOrder") == 2
    finally:
        gmsh.finalize()


def random_section(rng: np.random.Generator) -> tuple[Section, dict[str, float], dict[str, float]]:
    """Return a section of layers, lifts, walls and bores with its areas and lengths.

    Ends of walls and edges of lifts and bores touch a border of layers, cross it or end before it
    by 1e-3, or are anywhere.
    """
    n, x = int(rng.integers(1, 5)), np.linspace(-20.0, 20.0, 5)
    waves = [
        float(rng.choice([0.0, 1.0])) * rng.uniform(0.6, 1.2) * np.array([1, -1, 1, -1, 1])
        for _ in range(n - 1)
    ]
    tops = [
        np.zeros(5),
        *(-4.5 * (k + 1) + wave for k, wave in enumerate(waves)),
        np.full(5, -20.0),
    ]
    areas, sizes = {}, {}
    for k in range(n):
        areas[f"layer {k}"] = [*zip(x, tops[k + 1]), *zip(x[::-1], tops[k][::-1])]
        sizes[f"layer {k}"] = float(np.trapezoid(tops[k] - tops[k + 1], x))

    def border(at: float, wide: bool = False) -> float:
        """Return a height at which something happens: on a border, by 1e-3 beside it, or
        anywhere.
        """
        k = int(rng.integers(1, n + 1))
        free, there = rng.uniform(-12.0, -2.0), float(np.interp(at, x, tops[k]))
        if k == n:
            return free
        beside = (
            0.0 if wide and tops[k][0] == tops[k][1] else 1e-3
        )  # 20 m of 1e-3 are 30,000 triangles
        return float(rng.choice([there, there - beside, there + beside, free]))

    wall, lifts, lines, lengths, holes = float(rng.uniform(-6.0, 6.0)), {}, {}, {}, {}
    level = 0.0
    for k in range(rng.integers(0, 4)):
        bottom = min(border(wall, wide=True), level - 0.5)
        if bottom < -16.0:
            break
        lifts[f"lift {k}"] = rectangle((-20.0, wall), (bottom, level))
        sizes[f"lift {k}"] = (wall + 20.0) * (level - bottom)
        level = bottom
    toe = min(border(wall), -1.0)
    lines["wall"], lengths["wall"] = [(wall, 0.0), (wall, toe)], -toe
    begin, end = wall + rng.choice([0.0, 1e-3, 1.0]), float(rng.uniform(wall + 3.0, 19.0))
    height = float(rng.uniform(-3.0, -1.0))
    lines["grid"], lengths["grid"] = [(begin, height), (end, height)], end - begin
    if (
        rng.random() < 0.6 and n > 1
    ):  # a bore that leaves a border by 1e-3, touches it with its side, or crosses it
        radius, at = float(rng.uniform(0.5, 1.5)), 12.0
        top, bottom = (float(np.interp(at, x, tops[k])) for k in (1, 2))
        level = waves[0][0] == 0.0 and (n == 2 or waves[1][0] == 0.0)
        centre = rng.choice(
            [top - radius - 1e-3, bottom + radius + 1e-3, top + 0.3 * radius, top]
            if level
            else [top + 0.3 * radius, max(bottom - 0.2 * radius, -18.0), top]
        )
        holes["bore"] = circle((at, centre), radius)
        lengths["bore"] = 2.0 * np.pi * radius
    slits = ["wall"] if rng.random() < 0.5 and begin != wall else []
    section = Section(
        areas, size=float(rng.uniform(2.0, 4.0)), lifts=lifts, lines=lines, holes=holes, slits=slits
    )
    return section, sizes, lengths


@pytest.mark.parametrize("seed", range(RANDOM))
@pytest.mark.one_in(3)
def test_random_sections(seed, recwarn) -> None:
    """[X] Every area and line has its measure, no body overlaps, no angle is sharp, interfaces have
    both sides.
    """
    section, sizes, lengths = random_section(np.random.default_rng(seed))
    mesh = section.mesh()
    round_ = bool(section.holes)
    for name, value in sizes.items():
        if not round_:
            assert area_of(mesh, name) == pytest.approx(value, rel=1e-9)
    total = sum(value for name, value in sizes.items() if name.startswith("layer"))
    if round_:
        total -= np.pi * (lengths["bore"] / 2.0 / np.pi) ** 2
    everything = sum(area_of(mesh, name) for name in section.areas)
    assert everything == pytest.approx(
        total, rel=5e-6 if round_ else 1e-9
    )  # second order of an arc
    assert everything == pytest.approx(
        float(Basis(mesh, mesh.elem(), intorder=4).dx.sum()), rel=1e-12
    )  # no overlap
    for name, value in lengths.items():
        for side in (f"{name}|left", f"{name}|right") if name in section.slits else (name,):
            assert length_of(mesh, side) == pytest.approx(
                value, rel=5e-6 if name == "bore" else 1e-9
            )
    assert sharpest(mesh)[0] >= 5.0
    assert not recwarn
    sc.mesh.check_mesh(mesh)
    for name in mesh.boundaries:
        one, _, two = name.partition("|")
        if two in mesh.subdomains:
            assert length_of(mesh, f"{two}|{one}") == pytest.approx(
                length_of(mesh, name), rel=1e-12
            )
    assert {f"layer {k}|layer {k + 1}" for k in range(len(section.areas) - 1)} <= set(
        mesh.boundaries
    )


@pytest.mark.parametrize(
    ("section", "areas", "lengths"),
    [
        (
            lambda s: s.slope(10.0, 45.0, {"fill": 0.0, "clay": -5.0}, 3.0),
            {"fill": 250.0, "clay": 250.0},
            {"surface": 40.0 + 200.0**0.5, "fill|clay": 30.0},
        ),
        (
            lambda s: s.embankment(4.0, 5.0, 2.0, {"clay": -8.0}, 2.0, lifts=2),
            {"fill": 36.0, "lift 1": 22.0, "lift 2": 14.0, "clay": 39.0 * 8},
            {"lift 1|lift 2": 9.0},
        ),
        (
            lambda s: s.pit(10.0, [-2, -5], (-1, -8), {"sand": -4, "clay": -12}, 3.0, beyond=20.0),
            {"lift 1": 20.0, "lift 2": 30.0, "sand": 120.0},
            {"lift 2|wall": 3.0, "wall|right": 8.0},
        ),
        (
            lambda s: s.trench(
                2.0, 3.0, {"clay": -6.0}, 1.5, outer=(1.2, 1.0), thickness=0.2, bedding=0.5
            ),
            {"pipe": 1.2 - 0.8 * 0.6, "backfill": 6.0 - 1.2, "clay": 120.0 - 6.0},
            {"inside": 2.8, "pipe|ground": 4.4},
        ),
        (
            lambda s: s.trench(2.0, 3.0, {"clay": -6.0}, 1.5, outer=1.2, thickness=0.1),
            {"pipe": np.pi * (0.36 - 0.25)},
            {"inside": np.pi, "pipe|ground": 1.2 * np.pi},
        ),
        (
            lambda s: s.tunnel(s.circle((0, -9), 3.0), {"clay": -20.0}, 4.0, width=40.0),
            {"core": 9 * np.pi, "clay": 800.0},
            {"lining": 6 * np.pi},
        ),
        (
            lambda s: s.footing(2.0, 0.5, {"clay": -6.0}, 2.0, depth=0.2),
            {"footing": 1.0, "clay": 84.0 - 0.4},
            {"footing|ground": 2.4},
        ),
        (
            lambda s: s.retaining_wall(
                4.0, 3.0, {"sand": -6.0}, 2.0, stem=0.4, slab=0.5, toe=0.6, depth=1.0
            ),
            {"wall": 1.5 + 0.4 * 4.5, "backfill": 5.0 * 17.4 - 0.4 * 4.5 - 0.5 * 2.4},
            {"wall|ground": 16.0 - 4.0 - 0.4},
        ),
        (
            lambda s: s.pile(0.6, 10.0, {"clay": -15.0}, 3.0),
            {"pile": 3.0, "clay": 147.0},
            {"pile|ground": 10.3},
        ),
    ],
)
def test_ready_sections(section, areas, lengths) -> None:
    """[X] Sections from a few numbers have the areas and interfaces of these."""
    mesh = section(sc.section).mesh()
    sc.mesh.check_mesh(mesh)
    for name, value in areas.items():
        assert area_of(mesh, name) == pytest.approx(
            value, rel=1e-4
        )  # arcs of second order, thin rings most
    for name, value in lengths.items():
        assert length_of(mesh, name) == pytest.approx(value, rel=1e-5)  # the same
    assert sharpest(mesh)[0] > 15.0


def test_three_centres_meet_without_kinks() -> None:
    """[X] Tangents of neighbouring arcs are the same, the outline is symmetric and as wide as its
    sides.
    """
    outline = sc.section.three_centres(3.0, 2.0, (50.0, 70.0), (0.0, -10.0))
    (a, b), centres = outline.ends, outline.centres
    for k in range(4):
        one, two = b[k] - centres[k], a[(k + 1) % 4] - centres[(k + 1) % 4]
        assert abs(one[0] * two[1] - one[1] * two[0]) < 1e-12  # round-off
    assert np.abs(centres[[0, 2], 0]).max() < 1e-12  # the same
    assert outline.area > 0.0
    with pytest.raises(ValueError, match="below 180 degrees together"):
        sc.section.three_centres(3.0, 2.0, (100.0, 90.0))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "depth,soil\n2,sand\n1,clay",
            "line 3 of the borehole: the depth '1' of 'clay' is not below",
        ),
        ("depth,soil,E\n2,sand,x", "line 2 of the borehole: 'E' must be a number, not 'x'"),
        ("depth,E\n2,3", "needs one column soil or layer or name"),
        (
            "depth,soil,E\n2,sand,1\n4,clay,2\n6,sand,3",
            "line 4 of the borehole: 'sand' has the parameters {'E': 3.0}, but",
        ),
        ("depth,soil,E\n2,sand", "line 2 of the borehole has 2 cells, not 3"),
        ("depth,soil\n\n", "has no layers"),
        ("depth,soil,E\n,sand,1", "the depth '' of 'sand'"),
    ],
)
def test_wrong_boreholes(text, message) -> None:
    """One ValueError names the line."""
    with pytest.raises(ValueError, match=message):
        sc.section.borehole(text)


def test_borehole_of_a_file(tmp_path) -> None:
    """[X] Semicolons, a byte order mark, and a soil that comes twice."""
    (tmp_path / "b1.csv").write_text(
        "Depth;Soil;phi;c\n2;sand;34;\n5;clay;;12\n8;sand;34;\n", encoding="utf-8-sig"
    )
    bore = sc.section.borehole(tmp_path / "b1.csv", surface=100.0)
    assert bore.layers == (("sand", 98.0), ("clay", 95.0), ("sand", 92.0))
    assert bore.parameters == {"sand": {"phi": 34.0}, "clay": {"c": 12.0}}
    mesh = Section(sc.section.layers((0, 10), 100.0, bore.layers), size=5.0).mesh()
    assert area_of(mesh, "sand") == pytest.approx(50.0, rel=1e-12)
    assert length_of(mesh, "sand|clay") == pytest.approx(20.0, rel=1e-12)


def test_solids_and_sketch(tmp_path) -> None:
    """[N] Forms of an axisymmetric pile weigh what their volumes do; a sketch is drawn."""
    pile = sc.section.pile(0.6, 4.0, {"sand": -3.0, "clay": -6.0}, 2.0)
    basis = Basis(pile.mesh(), ElementVector(ElementTriP2()), intorder=2)
    soils = {
        "sand": sc.MohrCoulomb(E=1e4, nu=0.3, c=1.0, phi=30.0),
        "clay": sc.Tresca(E=1e4, nu=0.4, c=20.0),
        "pile": sc.LinearElastic(E=3e7, nu=0.2),
    }
    forms = pile.solids(basis, soils, {"sand": 18.0, "clay": 20.0, "pile": 25.0})
    assert {name: form.coordinates for name, form in forms.items()} == dict.fromkeys(
        ("ground", "pile"), "axisymmetric"
    )
    model = sc.Model(forms, sc.box_supports(basis))
    weight = model.weights(model.forms).sum()
    volumes = 0.5 * np.array([16.0 - 0.09, 16.0, 0.09]) * [3.0, 3.0, 4.0] - [
        0.0,
        0.045,
        0.0,
    ]  # per radian
    assert weight == pytest.approx(-(volumes @ [18.0, 20.0, 25.0]), rel=1e-9)
    with pytest.raises(ValueError, match="no material for the areas \\['pile'\\]"):
        pile.solids(basis, {name: soils[name] for name in ("sand", "clay")})
    pile.plot(tmp_path / "pile.png")
    assert (tmp_path / "pile.png").stat().st_size > 5_000


def test_extruded_sections_keep_names() -> None:
    """[X] Volumes and interfaces of a ring in space; both sides have the same triangles."""
    section = Section(
        {"clay": rectangle((-6, 6), (-12, 0)), "ring": circle((0.0, -6.0), 2.0)},
        size=4.0,
        replace=True,
        bodies="ring",
        holes={"bore": circle((0.0, -6.0), 1.6)},
    )
    mesh = section.extruded([0.0, 1.0, 3.0], order=2)
    sc.mesh.check_mesh(mesh)
    assert area_of(mesh, "ring") == pytest.approx(
        3.0 * np.pi * (4.0 - 1.6**2), rel=1e-4
    )  # arcs of second order
    assert len(mesh.boundaries["ring|ground"]) == len(mesh.boundaries["ground|ring"])
    sides = [
        np.sort(mesh.p[:, mesh.facets[:, np.asarray(mesh.boundaries[name])]].mean(axis=1)[1])
        for name in ("ring|ground", "ground|ring")
    ]
    assert np.allclose(*sides, atol=1e-12)
    upright = section.extruded([0.0, 1.0], upright=True)
    assert np.ptp(upright.p[2]) == 1.0
    assert {"base", "top", "left", "bore"} <= set(upright.boundaries)


def test_area_of_outlines():
    """[X] A circle of four arcs, and a segment of a right angle."""
    assert sc.section.circle((1.0, 2.0), 3.0).area == pytest.approx(9.0 * np.pi, rel=1e-12)
    chord = Outline([(1.0, 0.0), (0.0, 1.0)], [np.tan(np.pi / 8.0), 0.0])
    assert chord.area == pytest.approx(0.25 * np.pi - 0.5, rel=1e-12)


def test_elements_grow_with_the_distance_from_a_fine_line():
    """Longest edges at most 1.5 times the size beside a wall plus .4 of the distance: 1.43
    measured.
    """
    soil = {"sand": sc.section.rectangle((-10.0, 10.0), (-10.0, 0.0))}
    mesh = sc.section.Section(
        soil, size=4.0, lines={"wall": [(0.0, 0.0), (0.0, -4.0)]}, sizes={"wall": 0.2}
    ).mesh()
    x, y = mesh.p[:, mesh.t].mean(axis=1)
    edges = np.linalg.norm(mesh.p[:, mesh.t] - np.roll(mesh.p[:, mesh.t], 1, axis=1), axis=0).max(
        axis=0
    )
    assert (edges < 1.6 * (0.2 + 0.4 * np.hypot(x, y - np.clip(y, -4.0, 0.0)))).all()


def test_unit_weights_of_a_section_name_its_areas():
    """[X] 10 m x 5 m x 18 and the rest named as weightless; a misspelt or a missing one is told."""
    box = sc.section.rectangle
    areas = {"clay": box((0, 10), (-5, 0)), "plate": box((2, 4), (0, 1))}
    section = sc.section.Section(areas, size=5.0, bodies="plate")
    basis = Basis(section.mesh(), ElementVector(ElementTriP2()), intorder=2)
    soil = sc.MohrCoulomb(E=2e4, nu=0.3, c=10.0, phi=25.0)
    with pytest.raises(ValueError, match="no area with a unit weight 'cley'; existing: clay"):
        section.solids(basis, soil, unit_weight={"cley": 18.0, "plate": 0.0})
    with pytest.warns(sc.AnalysisWarning, match=r"\['plate'\] are weightless: name them too"):
        section.solids(basis, soil, unit_weight={"clay": 18.0})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        forms = section.solids(basis, soil, unit_weight={"clay": 18.0, "plate": 0.0})
    assert -forms["ground"].own_weight(np.array([0.0, -1.0])).sum() == pytest.approx(900.0)
