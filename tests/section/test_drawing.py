"""Sections from drawings: a staged pit, and drawings with faults that are read right or refused by
name.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from skfem import Basis

import skfem_contact as sc

ezdxf = pytest.importorskip("ezdxf")
pytest.importorskip(
    "gmsh",
    reason="gmsh is not installed, or a library of the system that it needs is missing",
    exc_type=(ImportError, OSError),
)

SHIPPED = Path(__file__).parents[2] / "examples" / "1_first_steps" / "pit.dxf"
RULES = {
    "soil*": "area",
    "dig *": "lift",
    "wall": "slit",
    "grid": "line",
    "bore": "hole",
    "gwl": "water",
    "load": "load",
    "frame": "ignore",
}
BOX = [(0, 0), (20, 0), (20, 10), (0, 10)]


def draw_pit(file: Path) -> None:
    """Draw the staged pit that is shipped with the examples, in millimetres."""
    document = ezdxf.new("R2010", units=ezdxf.units.MM)
    space = document.modelspace()

    def draw(layer: str, points, close: bool = False) -> None:
        space.add_lwpolyline(
            1e3 * np.array(points, float), close=close, dxfattribs={"layer": layer}
        )

    draw("FILL", [(-12, 0), (30, 0)])
    draw("SAND", [(-12, -2.5), (30, -2.5)])
    draw("CLAY", [(-12, -8), (30, -8)])
    for k, (top, bottom) in enumerate(((0, -2), (-2, -4.5), (-4.5, -6.5)), 1):
        draw(f"DIG {k}", [(-12, bottom), (0, bottom), (0, top), (-12, top)], close=True)
    draw("WALL", [(0, 0), (0, -1), (0, -11)])
    draw("LOAD", [(2, 0), (7, 0)])
    draw("WATER", [(-12, -8), (30, -8)])
    space.add_text("pit, 1 : 100", dxfattribs={"layer": "NOTES", "insert": (0, 2e3), "height": 500})
    document.saveas(file)


def drawn(tmp_path, draw, units=6):
    """Return the file of a drawing."""
    document = ezdxf.new("R2010", units=units)
    draw(document.modelspace(), document)
    document.saveas(tmp_path / "a.dxf")
    return tmp_path / "a.dxf"


def areas_of(drawing):
    """Areas of all subdomains of the mesh of a drawing."""
    mesh = drawing.section.mesh()
    sc.mesh.check_mesh(mesh)
    return {
        name: float(Basis(mesh, mesh.elem(), elements=name, intorder=4).dx.sum())
        for name in mesh.subdomains
    }


def test_shipped_drawing_is_the_one_that_is_drawn_here(tmp_path) -> None:
    """[X] The entities of both files are the same, and make a staged pit."""
    draw_pit(tmp_path / "pit.dxf")
    one, two = (
        [
            (
                e.dxf.layer,
                e.dxftype(),
                [tuple(p) for p in e.get_points()] if e.dxftype() == "LWPOLYLINE" else None,
            )
            for e in ezdxf.readfile(file).modelspace()
        ]
        for file in (tmp_path / "pit.dxf", SHIPPED)
    )
    assert one == two
    rules = {
        "fill": "top",
        "sand": "top",
        "clay": "top",
        "dig *": "lift",
        "wall": "slit",
        "load": "load",
        "water": "water",
    }
    drawing = sc.section.from_dxf(SHIPPED, rules, size=4.0, bottom=-20.0)
    assert drawing.stages == {1: ("DIG 1",), 2: ("DIG 2",), 3: ("DIG 3",)}
    assert drawing.loads == ("LOAD",)
    assert np.allclose(drawing.water["WATER"], [(-12, -8), (30, -8)])
    assert drawing.remarks == ("layer 'NOTES': 1 TEXT without a rule",)
    assert drawing.section.parts == {
        "remaining": ("FILL", "SAND", "CLAY"),
        "DIG 1": ("FILL",),
        "DIG 2": ("FILL", "SAND"),
        "DIG 3": ("SAND",),
    }
    found = areas_of(drawing)
    for name, value in {"FILL": 105.0, "SAND": 231.0, "CLAY": 504.0, "DIG 2": 30.0}.items():
        assert found[name] == pytest.approx(value, rel=1e-9)


def polyline(layer, points, close=True, scale=1.0, shift=(0.0, 0.0)):
    """Return a function that draws a polyline."""
    return lambda space, _=None: space.add_lwpolyline(
        scale * np.array(points, float) + shift, close=close, dxfattribs={"layer": layer}
    )


def lines(layer, points, order=None, turned=(), gap=0.0):
    """Return a function that draws the sides of a polygon one by one, in any order and
    direction.
    """

    def draw(space, _=None):
        sides = [[a, b] for a, b in zip(points, [*points[1:], points[0]])]
        for k in order or range(len(sides)):
            a, b = sides[k][::-1] if k in turned else sides[k]
            space.add_line(a, (b[0] + gap, b[1]) if k == 0 else b, dxfattribs={"layer": layer})

    return draw


def both(*draws):
    """Return a function that draws several things."""
    return lambda space, document: [draw(space, document) for draw in draws]


def arc_with_lines(space, _):
    """Draw a half disc of a line and an arc, and a spline and an ellipse as lines inside of it."""
    space.add_line((-5, 0), (5, 0), dxfattribs={"layer": "soil"})
    space.add_arc((0, 0), 5, 180, 360, dxfattribs={"layer": "soil"})
    space.add_spline([(-2, -1), (0, -1.5), (2, -1)], dxfattribs={"layer": "grid"})
    space.add_ellipse((0, -3), major_axis=(1, 0), ratio=0.5, dxfattribs={"layer": "bore"})


def block(space, document):
    """Draw the ground in a block that is inserted with a scale."""
    made = document.blocks.new("ground")
    made.add_lwpolyline(
        [(0, 0), (10, 0), (10, 5), (0, 5)], close=True, dxfattribs={"layer": "soil"}
    )
    space.add_blockref("ground", (0, 0), dxfattribs={"xscale": 2.0, "yscale": 2.0})


def old_polyline(space, _):
    """Draw an old polyline with a bulge, mirrored lines in another plane beside it."""
    space.add_polyline2d(
        [(0, 0, 0), (20, 0, 0), (20, 10, 0), (0, 10, 0)],
        format="xyb",
        close=True,
        dxfattribs={"layer": "soil"},
    )


def labelled(space, _, texts=(("sand", (1, 7)), ("clay", (1, 2)))):
    """Draw two outlines on one layer, named by texts."""
    space.add_lwpolyline(
        [(0, 0), (20, 0), (20, 5), (0, 5)], close=True, dxfattribs={"layer": "soil"}
    )
    space.add_lwpolyline(
        [(0, 5), (20, 5), (20, 10), (0, 10)], close=True, dxfattribs={"layer": "soil"}
    )
    for text, at in texts:
        space.add_text(text, dxfattribs={"layer": "soil", "insert": at})


WHOLE = 200.0
READ = {
    "sides one by one, mixed": (lines("soil", BOX, (2, 0, 3, 1), (0, 3)), 6, {"soil": WHOLE}, ""),
    "doubled lines": (
        both(lines("soil", BOX), lines("soil", BOX, (3, 1), (1,))),
        6,
        {"soil": WHOLE},
        "2 doubles left",
    ),
    "doubled outline": (
        both(polyline("soil", BOX), polyline("soil", BOX[2:] + BOX[:2])),
        6,
        {"soil": WHOLE},
        "1 doubles",
    ),
    "gap of 0.1 mm": (lines("soil", BOX, gap=1e-4), 6, {"soil": WHOLE}, ""),
    "not closed, but ends meet": (
        polyline("soil", [*BOX, BOX[0]], close=False),
        6,
        {"soil": WHOLE},
        "",
    ),
    "millimetres": (polyline("soil", BOX, scale=1e3), 4, {"soil": WHOLE}, ""),
    "feet": (polyline("soil", BOX), 2, {"soil": WHOLE * 0.3048**2}, ""),
    "survey coordinates": (
        polyline("soil", BOX, shift=(3_456_789.123, 5_412_345.678)),
        6,
        {"soil": WHOLE},
        "moved",
    ),
    "arc, spline, ellipse": (arc_with_lines, 6, {"soil": 12.5 * np.pi - 0.5 * np.pi}, ""),
    "block with a scale": (block, 6, {"soil": WHOLE}, ""),
    "old polyline": (old_polyline, 6, {"soil": WHOLE}, ""),
    "names by texts": (labelled, 6, {"sand": 100.0, "clay": 100.0}, ""),
    "capitals": (polyline("SOIL", BOX), 6, {"SOIL": WHOLE}, ""),
    "layer without a rule": (
        both(polyline("soil", BOX), polyline("trees", BOX)),
        6,
        {"soil": WHOLE},
        "layer 'trees': 1 LWPOLYLINE without a rule",
    ),
    "corner by 0.05 mm beside": (
        both(
            polyline("soil 1", [(0, 0), (20, 0), (20, 5), (0, 5)]),
            polyline("soil 2", [(0, 5 - 5e-5), (20, 5 + 5e-5), (20, 10), (0, 10)]),
        ),
        6,
        {"soil 1": 100.0, "soil 2": 100.0},
        "",
    ),
}


@pytest.mark.parametrize("case", READ)
def test_hostile_drawings_are_read_right(case, tmp_path) -> None:
    """[X] Areas in metres; what was left out is listed."""
    draw, units, areas, remark = READ[case]
    drawing = sc.section.from_dxf(drawn(tmp_path, draw, units), RULES, size=5.0)
    found = areas_of(drawing)
    for name, value in areas.items():
        assert found[name] == pytest.approx(
            value, rel=2e-5 if "gap" in case or "arc" in case or "beside" in case else 1e-9
        )  # gaps, chords
    assert remark in "; ".join(drawing.remarks)
    assert bool(remark) == bool(drawing.remarks)
    if case == "survey coordinates":
        assert drawing.origin == (3_456_789.0, 5_412_346.0)


REFUSED = {
    "open outline": (
        polyline("soil", BOX, close=False),
        6,
        "1 of 1 outlines of layer 'soil' are open, one open by 10",
    ),
    "gap of 1 cm": (
        lines("soil", BOX, gap=0.01),
        6,
        "outlines of layer 'soil' are open, one open by 0.01 between",
    ),
    "no unit": (polyline("soil", BOX), 0, "the drawing has no unit: give one, unit='m'"),
    "missing text": (
        lambda s, d: labelled(s, d, [("sand", (1, 7))]),
        6,
        "near \\(10, 2.5\\) has 0 texts",
    ),
    "two texts": (
        lambda s, d: labelled(s, d, [("a", (1, 7)), ("b", (9, 7)), ("c", (1, 2))]),
        6,
        "has 2 texts",
    ),
    "no layer with a rule": (
        polyline("0", BOX),
        6,
        "no curve of the drawing has a rule; its layers are \\['0'\\]",
    ),
    "crosses itself": (
        polyline("soil", [(0, 0), (4, 4), (4, 0), (0, 3)]),
        6,
        "'soil' crosses or touches itself near",
    ),
    "overlap": (
        both(polyline("soil 1", BOX), polyline("soil 2", [(0, 9), (20, 9), (20, 12), (0, 12)])),
        6,
        "areas 'soil 1' and 'soil 2' overlap by an area of 20",
    ),
    "wall outside": (
        both(polyline("soil", BOX), polyline("wall", [(5, 12), (5, 3)], close=False)),
        6,
        "2 of the 9 of line 'wall' lie outside",
    ),
    "lift outside": (
        both(polyline("soil", BOX), polyline("dig 1", [(5, 9), (8, 9), (8, 11), (5, 11)])),
        6,
        "the lift 'dig 1' leaves the areas by an area of 3",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_hostile_drawings_are_refused_by_name(case, tmp_path) -> None:
    """One ValueError names the layer, the size of the fault and its coordinates."""
    draw, units, message = REFUSED[case]
    with pytest.raises(ValueError, match=message):
        sc.section.from_dxf(drawn(tmp_path, draw, units), RULES, size=5.0).section.mesh()


def test_wrong_calls_of_drawings(tmp_path) -> None:
    """Rules, units and files that do not exist; upper edges without a bottom."""
    file = drawn(tmp_path, polyline("soil", [(0, 0), (20, 0)], close=False))
    for rules, more, message in (
        ({"soil": "aera"}, {}, "the rule of 'soil' is 'aera'; there are area, body"),
        ({"soil": "area"}, {"unit": "ell"}, "unit must be one of in, ft, mm"),
        ({"soil": "top"}, {}, r"\['soil'\] have an upper edge only: give their bottom="),
    ):
        with pytest.raises(ValueError, match=message):
            sc.section.from_dxf(file, rules, size=1.0, **more)
    (tmp_path / "no.dxf").write_text("no drawing")
    with pytest.raises(ValueError, match=r"no.dxf is not a DXF file"):
        sc.section.from_dxf(tmp_path / "no.dxf", {}, size=1.0)


def test_curves_on_layer_0_of_a_block_have_the_layer_of_its_insert(tmp_path) -> None:
    """[X] A rectangle of 20 x 10 on layer 0 of a block that is inserted on layer clay."""

    def draw(space, document):
        document.blocks.new("box").add_lwpolyline(BOX, close=True)
        space.add_blockref("box", (0, 0), dxfattribs={"layer": "clay"})

    drawing = sc.section.from_dxf(drawn(tmp_path, draw), {"clay": "area"}, size=4.0)
    assert areas_of(drawing)["clay"] == pytest.approx(200.0, rel=1e-12)


def test_all_copies_of_an_array_of_blocks_are_read(tmp_path) -> None:
    """[X] Four drains at x = 4, 8, 12 and 16 are the array of one block."""

    def draw(space, document):
        polyline("clay", BOX)(space)
        document.blocks.new("drain").add_line((0, 0), (0, -5), dxfattribs={"layer": "drain"})
        array = {"layer": "drain", "column_count": 4, "column_spacing": 4.0}
        space.add_blockref("drain", (4, 8), dxfattribs=array)

    drawing = sc.section.from_dxf(
        drawn(tmp_path, draw), {"clay": "area", "drain": "line"}, size=3.0
    )
    x = sorted(outline.points[0, 0] for outline in drawing.section.outlines["drain"])
    assert np.allclose(x, [4.0, 8.0, 12.0, 16.0])


def test_a_justified_text_lies_at_the_point_it_is_aligned_with(tmp_path) -> None:
    """[X] Group 11 counts, not group 10, which may be anything; justified to the left, group 10."""
    from ezdxf.enums import TextEntityAlignment as Alignment

    for align, inside, outside in (
        (Alignment.MIDDLE_CENTER, "align_point", "insert"),
        (Alignment.LEFT, "insert", "align_point"),
    ):

        def draw(space, _, align=align, inside=inside, outside=outside):
            polyline("soil", BOX)(space)
            text = space.add_text("stiff clay", dxfattribs={"layer": "soil"})
            text.set_placement((10, 5), align=align)
            text.dxf.set(inside, (10, 5))
            text.dxf.set(outside, (90, 90))

        drawing = sc.section.from_dxf(drawn(tmp_path, draw), {"soil": "area"}, size=4.0)
        assert list(drawing.section.areas) == ["stiff clay"]


def test_mirrored_arcs_stay_arcs(tmp_path) -> None:
    """[X] Arcs, circles and bulges of a mirrored block have the points and bulges of the mirror."""

    def draw(space, document):
        block = document.blocks.new("curves")
        block.add_lwpolyline(
            [(1, 0, 0.4), (3, 0, 0), (3, 2, 0)], "xyb", close=True, dxfattribs={"layer": "bow"}
        )
        block.add_arc((6, 0), 1.0, 0.0, 90.0, dxfattribs={"layer": "arc"})
        block.add_circle((9, 0), 0.5, dxfattribs={"layer": "bore"})
        block.add_text("bow", dxfattribs={"layer": "bow", "insert": (2.8, 1.0)})
        polyline("ground", [(-20, -9), (20, -9), (20, 9), (-20, 9)])(space)
        space.add_blockref("curves", (0, 0), dxfattribs={"xscale": -1.0})

    rules = {"ground": "area", "bow": "lift", "arc": "line", "bore": "hole"}
    section = sc.section.from_dxf(drawn(tmp_path, draw), rules, size=4.0).section
    (bow,), (arc,), (bore,) = (section.outlines[name] for name in ("bow", "arc", "bore"))
    assert np.allclose(bow.points, [(-1, 0), (-3, 0), (-3, 2)]) and np.allclose(
        bow.bulges, [-0.4, 0.0, 0.0]
    )
    assert np.allclose(arc.points[[0, -1]], [(-7, 0), (-6, 1)])
    assert np.allclose(arc.centres, (-6, 0)) and arc.length == pytest.approx(0.5 * np.pi)
    assert abs(bore.area) == pytest.approx(0.25 * np.pi) and np.allclose(bore.centres, (-9, 0))


@pytest.mark.parametrize("mirrored", [False, True])
def test_ellipses_become_few_arcs(mirrored, tmp_path) -> None:
    """[X] An ellipse has the area pi a b within 2e-5 of its size, and refines no mesh by itself."""
    document = ezdxf.new(units=ezdxf.units.M)
    block = document.blocks.new("tunnel")
    block.add_ellipse((1, 0), (4, 0), 0.5, dxfattribs={"layer": "clay"})
    scale = -1.0 if mirrored else 1.0
    document.modelspace().add_blockref("tunnel", (7, 0), {"xscale": scale, "rotation": 30.0})
    document.saveas(file := tmp_path / "ellipse.dxf")
    mesh = sc.section.from_dxf(file, {"clay": "area"}, size=1.0).section.mesh()
    assert Basis(mesh, mesh.elem()).dx.sum() == pytest.approx(8.0 * np.pi, rel=1e-5)
    assert mesh.nelements < 1500


def test_hatches_alone_are_refused_with_a_remedy(tmp_path) -> None:
    document = ezdxf.new(units=ezdxf.units.M)
    hatch = document.modelspace().add_hatch(dxfattribs={"layer": "clay"})
    hatch.paths.add_polyline_path([(0, 0), (1, 0), (1, 1)], is_closed=True)
    document.saveas(file := tmp_path / "hatch.dxf")
    with pytest.raises(ValueError, match="'clay': 1 HATCH not understood: draw outlines by lines,"):
        sc.section.from_dxf(file, {"clay": "area"}, size=1.0)


def test_splines_become_arcs_but_at_corners(tmp_path) -> None:
    """[X] A parabola as a spline of degree 2, and a rectangle as one of degree 1."""
    document = ezdxf.new(units=ezdxf.units.M)
    space = document.modelspace()
    curve = space.add_open_spline([(0, 0), (2, 4), (4, 0)], 2, dxfattribs={"layer": "hill"})
    assert curve.dxf.degree == 2
    space.add_line((0, 0), (4, 0), dxfattribs={"layer": "hill"})
    space.add_open_spline([(5, 0), (7, 0), (7, 1), (5, 1), (5, 0)], 1, dxfattribs={"layer": "box"})
    document.saveas(file := tmp_path / "spline.dxf")
    mesh = sc.section.from_dxf(file, {"hill": "area", "box": "area"}, size=0.5).section.mesh()
    for name, area in (("hill", 16.0 / 3.0), ("box", 2.0)):
        part = Basis(mesh, mesh.elem(), elements=name)
        assert part.dx.sum() == pytest.approx(area, rel=1e-5)
    assert mesh.nelements < 2000
