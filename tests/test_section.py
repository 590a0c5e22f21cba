"""Sections: names and measures of areas and lines, interfaces, refusals, random sections."""

from __future__ import annotations

import builtins
import os

import numpy as np
import pytest
from skfem import Basis

import skfem_contact as sc
from skfem_contact.section import Section, circle, rectangle
from skfem_contact.section.meshing import sharpest

gmsh = pytest.importorskip("gmsh", reason="gmsh is not installed, or a library of the system that it needs is missing",
                           exc_type=(ImportError, OSError))

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
    m = mesh.doflocs[:, mesh.nvertices + facets] if mesh.doflocs.shape[1] > mesh.nvertices else 0.5 * (a + b)
    points, weights = np.polynomial.legendre.leggauss(5)
    along = 0.5 * (b - a)[..., None] + (a - 2.0 * m + b)[..., None] * points
    return float((np.linalg.norm(along, axis=0) @ weights).sum())


def test_pit_beside_a_wall_has_all_names() -> None:
    """[X] Areas, lifts, walls and the outside have their names and measures; the sides of the wall are double."""
    pit = Section({"sand": rectangle((-10, 20), (-4, 0)), "clay": rectangle((-10, 20), (-15, -4))}, size=3.0,
                  lifts={"lift 1": rectangle((-10, 0), (-3, 0)), "lift 2": rectangle((-10, 0), (-6, -3))},
                  lines={"wall": [(0, 0), (0, -9)], "drain": [(5, -1), (12, -1)], "load": [(3, 0), (6, 0)]},
                  slits="wall")  # fmt: skip
    assert pit.parts == {"remaining": ("sand", "clay"), "lift 1": ("sand",), "lift 2": ("sand", "clay")}
    mesh = pit.mesh()
    sc.mesh.check_mesh(mesh)
    areas = {"sand": 120.0, "clay": 330.0, "lift 1": 30.0, "lift 2": 30.0, "remaining": 390.0, "ground": 450.0}
    lengths = {"wall|left": 9.0, "wall|right": 9.0, "drain": 7.0, "load": 3.0, "left": 15.0, "right": 15.0,
               "bottom": 30.0, "surface": 30.0, "sand|clay": 30.0, "clay|sand": 30.0, "lift 1|lift 2": 10.0,
               "lift 2|remaining": 10.0, "remaining|lift 2": 10.0, "lift 1|wall": 3.0, "lift 2|wall": 3.0,
               "remaining|wall|left": 3.0, "remaining|wall|right": 9.0, "lift 1:surface": 10.0}  # fmt: skip
    for name, value in areas.items():
        assert area_of(mesh, name) == pytest.approx(value, rel=1e-12)  # round-off
    for name, value in lengths.items():
        assert length_of(mesh, name) == pytest.approx(value, rel=1e-12)
    assert sorted(pit.sides("wall", mesh)) == ["lift 1|wall", "lift 2|wall", "remaining|wall|left",
                                               "remaining|wall|right"]
    for name, above in (("lift 1|lift 2", True), ("lift 2|lift 1", False)):  # each is seen from its own lift
        facets = mesh.boundaries[name]
        owner = mesh.f2t[facets.ori, np.asarray(facets)]
        assert (mesh.p[1, mesh.t[:, owner]].mean(axis=0) > -3.0).all() == above


def test_bodies_touch_by_contact_alone() -> None:
    """[X] A footing and a ring share no node with the ground; both sides of each interface have names."""
    section = Section({**GROUND, "footing": rectangle((-2, 2), (-1, 1)), "ring": circle((0.0, -8.0), 2.0)},
                      size=4.0, bodies=["footing", "ring"], replace=True, holes={"bore": circle((0.0, -8.0), 1.7)})
    mesh = section.mesh()
    assert set(sc.mesh.bodies(mesh)) == {"ground", "footing", "ring"}
    for one, two, length in (("ground", "footing", 6.0), ("ground", "ring", 4.0 * np.pi)):
        assert length_of(mesh, f"{one}|{two}") == pytest.approx(length, rel=5e-6)  # 24 sides of second order
        assert length_of(mesh, f"{two}|{one}") == pytest.approx(length_of(mesh, f"{one}|{two}"), rel=1e-14)
    assert length_of(mesh, "bore") == pytest.approx(3.4 * np.pi, rel=5e-6)
    assert area_of(mesh, "ring") == pytest.approx(np.pi * (4.0 - 1.7**2), rel=1e-5)  # the same
    assert length_of(mesh, "footing:surface") == pytest.approx(6.0, rel=1e-12)


def test_second_order_follows_arcs() -> None:
    """[X] The error of the area of a circle falls with the fourth power of the size."""
    section = Section({"disc": circle((0.0, 0.0), 1.0)}, size=1.0)
    meshes = [section.mesh(scale=scale) for scale in (1.0, 0.125)]
    errors = [abs(area_of(mesh, "disc") - np.pi) for mesh in meshes]
    sides = [len(mesh.boundary_facets()) for mesh in meshes]
    assert errors[0] < 5e-5
    assert sides[1] > 1.5 * sides[0]
    assert errors[0] * sides[0] ** 4 == pytest.approx(errors[1] * sides[1] ** 4, rel=0.05)  # terms of sixth order
    assert section.mesh(order=1).p.shape[1] < section.mesh().doflocs.shape[1]


def test_surface_cuts_off() -> None:
    """[X] Layers are cut off along the profile of the surface."""
    hill = Section({"clay": rectangle((0, 10), (-5, 20))}, size=2.0, surface=[(0, 0), (4, 0), (8, 4), (10, 4)])
    mesh = hill.mesh()
    assert area_of(mesh, "clay") == pytest.approx(66.0, rel=1e-12)
    assert length_of(mesh, "surface") == pytest.approx(6.0 + 32.0**0.5, rel=1e-12)


@pytest.mark.parametrize(("change", "message"), [
    ({"areas": {"bow": [(0, 0), (4, 4), (4, 0), (0, 3)]}}, "'bow' crosses or touches itself near \\(1.714, 1.714"),
    ({"areas": {**GROUND, "sand": rectangle((0, 5), (-3, -1))}}, "'clay' and 'sand' overlap by an area of 10 near"),
    ({"areas": {**GROUND, "sand": rectangle((0, 5), (-1e-3, 2))}}, "'clay' and 'sand' overlap by an area of 0.005"),
    ({"lines": {"wall": [(0, 2), (0, -4)]}}, "2 of the 6 of line 'wall' lie outside of the areas, near \\(0, 1\\)"),
    ({"lines": {"wall": [(30, 2), (30, -4)]}}, "6 of the 6 of line 'wall' lie outside"),
    ({"lifts": {"a": rectangle((0, 5), (-3, 0)), "b": rectangle((4, 8), (-3, 0))}}, "lifts 'a' and 'b' overlap by an"),
    ({"lifts": {"a": rectangle((15, 25), (-3, 0))}}, "the lift 'a' leaves the areas by an area of 15"),
    ({"holes": {"bore": rectangle((-30, 30), (-30, 10))}}, "nothing is left of the area 'clay'"),
    ({"areas": {**GROUND, "cap": [(-1, 0), (-1, 2), (1, 2), (1, 0), (0, 1)]}}, "enclose a gap near \\(0, 0.25"),
    ({"areas": {"clay": [(0, 0), (1, 1), (2, 2)]}}, "'clay' has no area"),
    ({"areas": {"clay": [(0, 0), (1, 1)]}}, "'clay' has 2 different points: an area needs three"),
    ({"areas": {"clay": [(0, 0), (1, np.nan), (2, 2)]}}, "points of 'clay' must be finite"),
    ({"areas": {}}, "at least one area"),
    ({"lines": {"clay": [(0, 0), (0, -4)]}}, "the name 'clay' is not unique"),
    ({"lines": {"surface": [(0, 0), (0, -4)]}}, "'surface' is the name of a part of every mesh"),
    ({"lines": {"a|b": [(0, 0), (0, -4)]}}, "names are texts without"),
    ({"lines": {"wall": [(0, 0), (0, -4), (1, -4), (-1, -1)]}}, "'wall' crosses or touches itself"),
    ({"slits": "wall"}, "there is no line 'wall'"),
    ({"sizes": {"wal": 1.0}}, "there is no area, lift, line or hole 'wal'; existing: clay"),
    ({"size": 0.0}, "size must be a finite number above 0"),
    ({"surface": [(0, 0), (5, 1)]}, "the surface reaches from x = 0 to 5, the areas from -20 to 20"),
    ({"coordinates": "axisymmetric"}, "'clay' reaches to x = -20"),
    ({"lines": {"a": [(0, 0), (0, -4)], "b": [(1e-6, -1), (1e-6, -3)]}}, "are 1e-06 apart near"),
    ({"holes": {"bore": circle((0.0, -5.0), 5.0)}}, "meet at an angle of 0.032 degrees near \\(0, "),
])  # fmt: skip
def test_wrong_sketches_are_refused_by_name(change, message) -> None:
    """One ValueError says what is wrong, by how much and where."""
    with pytest.raises(ValueError, match=message):
        Section(**{"areas": GROUND, "size": 5.0, **change}).mesh()


def test_without_gmsh_one_error_names_the_extra(monkeypatch) -> None:
    """An ImportError says what to install, for a missing package and for a missing library of the system."""
    real = builtins.__import__
    for error, words in ((ModuleNotFoundError("no"), r"skfem-contact\[mesh\]"), (OSError("libGLU.so.1"), "libGLU")):
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

    Ends of walls and edges of lifts and bores touch a border of layers, cross it or end before it by 1e-3, or are
    anywhere.
    """
    n, x = int(rng.integers(1, 5)), np.linspace(-20.0, 20.0, 5)
    waves = [float(rng.choice([0.0, 1.0])) * rng.uniform(0.6, 1.2) * np.array([1, -1, 1, -1, 1]) for _ in range(n - 1)]
    tops = [np.zeros(5), *(-4.5 * (k + 1) + wave for k, wave in enumerate(waves)), np.full(5, -20.0)]
    areas, sizes = {}, {}
    for k in range(n):
        areas[f"layer {k}"] = [*zip(x, tops[k + 1]), *zip(x[::-1], tops[k][::-1])]
        sizes[f"layer {k}"] = float(np.trapezoid(tops[k] - tops[k + 1], x))

    def border(at: float, wide: bool = False) -> float:
        """Return a height at which something happens: on a border, by 1e-3 beside it, or anywhere."""
        k = int(rng.integers(1, n + 1))
        free, there = rng.uniform(-12.0, -2.0), float(np.interp(at, x, tops[k]))
        if k == n:
            return free
        beside = 0.0 if wide and tops[k][0] == tops[k][1] else 1e-3  # 20 m of 1e-3 are 30,000 triangles
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
    if rng.random() < 0.6 and n > 1:  # a bore that leaves a border by 1e-3, touches it with its side, or crosses it
        radius, at = float(rng.uniform(0.5, 1.5)), 12.0
        top, bottom = (float(np.interp(at, x, tops[k])) for k in (1, 2))
        level = waves[0][0] == 0.0 and (n == 2 or waves[1][0] == 0.0)
        centre = rng.choice([top - radius - 1e-3, bottom + radius + 1e-3, top + 0.3 * radius, top] if level else
                            [top + 0.3 * radius, bottom - 0.2 * radius, top])
        holes["bore"] = circle((at, centre), radius)
        lengths["bore"] = 2.0 * np.pi * radius
    slits = ["wall"] if rng.random() < 0.5 and begin != wall else []
    section = Section(areas, size=float(rng.uniform(2.0, 4.0)), lifts=lifts, lines=lines, holes=holes, slits=slits)
    return section, sizes, lengths


@pytest.mark.parametrize("seed", range(RANDOM))
def test_random_sections(seed, recwarn) -> None:
    """[X] Every area and line has its measure, no body overlaps, no angle is sharp, interfaces have both sides."""
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
    assert everything == pytest.approx(total, rel=5e-6 if round_ else 1e-9)  # second order of an arc
    assert everything == pytest.approx(float(Basis(mesh, mesh.elem(), intorder=4).dx.sum()), rel=1e-12)  # no overlap
    for name, value in lengths.items():
        for side in (f"{name}|left", f"{name}|right") if name in section.slits else (name,):
            assert length_of(mesh, side) == pytest.approx(value, rel=5e-6 if name == "bore" else 1e-9)
    assert sharpest(mesh)[0] >= 5.0
    assert not recwarn
    sc.mesh.check_mesh(mesh)
    for name in mesh.boundaries:
        one, _, two = name.partition("|")
        if two in mesh.subdomains:
            assert length_of(mesh, f"{two}|{one}") == pytest.approx(length_of(mesh, name), rel=1e-12)
    assert {f"layer {k}|layer {k + 1}" for k in range(len(section.areas) - 1)} <= set(mesh.boundaries)
