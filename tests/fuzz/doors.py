"""Sound calls of sections, water, results, pictures, dynamics, design, ground and files of meshes,
to which wrong arguments are given.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from skfem import Basis, ElementQuad2, ElementTriP2, ElementVector, MeshQuad, MeshTri

import skfem_contact as sc
from skfem_contact import design, ground, plot, section, water

Door = tuple[str, Callable[..., Any], dict[str, Any]]
QUIET = {"progress": False}


class Analysed(NamedTuple):
    """A model, its result, and a folder for files."""

    basis: Basis
    model: sc.Model
    result: sc.results.Result
    folder: Path


def analysed() -> Analysed:
    """A block of ground under its weight, above the water table."""
    mesh = MeshQuad.init_tensor(np.linspace(0, 2, 4), np.linspace(0, 1, 3)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=30.0)
    solid = sc.SolidForm(basis, soil, unit_weight=20.0)
    fixed = sc.box_supports(basis)
    model = sc.Model({"soil": solid}, fixed, water_unit_weight=10.0, gravity_acceleration=9.81)
    result = model.run([sc.Stage("weight"), sc.Stage("again")], **QUIET)
    return Analysed(basis, model, result, Path(tempfile.mkdtemp()))


def doors() -> Iterator[Door]:
    """Yield the name of a call, the function, and sound keyword arguments."""
    given = analysed()
    for room in (of_sections, of_water, of_results, of_pictures, of_dynamics, of_design):
        yield from room(given)
    for room in (of_ground, of_meshes):
        yield from room(given)


def of_sections(given: Analysed) -> Iterator[Door]:
    """Outlines, sections, and recipes."""
    bottoms = {"sand": -1.0, "clay": -3.0}
    more: dict[str, Any] = {"bottoms": bottoms, "size": 2.0}
    yield (
        "Outline",
        section.Outline,
        {"points": [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], "bulges": 0.0},
    )
    yield "section.circle", section.circle, {"centre": (0.0, 0.0), "radius": 1.0}
    yield "section.rectangle", section.rectangle, {"x": (0.0, 2.0), "y": (0.0, 1.0)}
    yield (
        "section.three_centres",
        section.three_centres,
        {"crown": 2.0, "side": 1.0, "angles": (60.0, 60.0), "centre": (0.0, 0.0)},
    )
    yield "section.layers", section.layers, {"x": (0.0, 5.0), "top": 0.0, "bottoms": bottoms}
    yield (
        "section.slope",
        section.slope,
        {"height": 1.0, "angle": 30.0, **more, "crest": 2.0, "toe": 2.0},
    )
    yield (
        "section.embankment",
        section.embankment,
        {"height": 1.0, "crest": 2.0, "run": 2.0, **more},
    )
    yield (
        "section.footing",
        section.footing,
        {"width": 1.0, "thickness": 0.5, **more, "depth": 0.0, "beyond": 3.0, "fine": 0.5},
    )
    yield "section.pile", section.pile, {"diameter": 1.0, "length": 2.0, **more, "radius": 4.0}
    yield (
        "section.pit",
        section.pit,
        {"width": 2.0, "floors": [-0.5, -1.0], "wall": -2.0, **more, "beyond": 3.0},
    )
    yield (
        "section.retaining_wall",
        section.retaining_wall,
        {"height": 2.0, "base": 1.5, **more, "stem": 0.3, "slab": 0.3, "toe": 0.4, "depth": 0.5},
    )
    yield (
        "section.trench",
        section.trench,
        {"width": 2.0, "depth": 1.5, **more, "outer": 0.8, "thickness": 0.1},
    )
    yield (
        "section.tunnel",
        section.tunnel,
        {"outline": section.circle((0.0, -2.0), 0.5), **more, "width": 8.0},
    )
    areas = {"clay": section.rectangle((0.0, 2.0), (-1.0, 0.0))}
    sketched = section.Section(areas, size=1.0)
    yield (
        "Section",
        section.Section,
        {
            "areas": areas,
            "size": 1.0,
            "lifts": {},
            "lines": {"wall": [[1.0, 0.0], [1.0, -0.5]]},
            "holes": {},
            "surface": None,
            "replace": (),
            "bodies": (),
            "slits": (),
            "sizes": {"clay": 1.0},
            "near": [((1.0, 0.0), 0.5)],
            "coordinates": "plane",
        },
    )
    mesh = sketched.mesh()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
    elastic = sc.LinearElastic(E=1e4, nu=0.3)
    yield "Section.mesh", sketched.mesh, {"order": 2, "scale": 1.0}
    yield (
        "Section.solids",
        sketched.solids,
        {"basis": basis, "materials": elastic, "unit_weight": 20.0, "porous": True},
    )
    yield (
        "Section.extruded",
        sketched.extruded,
        {"levels": [0.0, 1.0], "upright": False, "order": 1},
    )
    yield "Section.plot", sketched.plot, {"file": given.folder / "section.png", "show": False}
    csv = given.folder / "borehole.csv"
    csv.write_text("layer,bottom,E\nsand,2.0,1e4\nclay,5.0,5e3\n")
    yield "section.borehole", section.borehole, {"file": csv, "surface": 0.0}


def of_water(given: Analysed) -> Iterator[Door]:
    """Seepage, and pore water with all that it may have."""
    basis = given.basis
    flow = water.Flow(basis, 1e-4, unit_weight=10.0)
    conditions = {"head": {"left": 2.0, "right": 1.5}, "flux": {}, "wells": {}, "drains": {}}
    conditions |= {"sources": {}, "seepage_face": (), "suction": {}}
    yield (
        "water.Conditions",
        lambda **changed: flow.steady(water.Conditions(**changed)),
        conditions,
    )
    steady = flow.steady(water.Conditions({"left": 2.0, "right": 1.5}))
    yield "Flow.steady", flow.steady, {"conditions": water.Conditions({"left": 2.0, "right": 1.5})}
    retention = water.VanGenuchten(1.0, 2.0, content=(0.1, 0.4))
    wet = water.Flow(basis, 1e-4, unit_weight=10.0, retention=retention)
    yield (
        "Flow.in_time",
        wet.in_time,
        {
            "conditions": water.Conditions({"left": 2.0, "right": 1.5}),
            "times": [0.0, 10.0],
            "start": steady,
            "error": 0.05,
        },
    )
    yield "Seepage.discharge", steady.discharge, {"boundary": "left"}
    yield "Seepage.flux", steady.flux, {"boundary": "left"}
    yield "Seepage.head_at", steady.head_at, {"x": np.array([[1.0], [0.5]])}
    yield "Seepage.pressure_at", steady.pressure_at, {"x": np.array([[1.0], [0.5]])}
    pore = water.PoreWater(basis, 1e-4, unit_weight=10.0)
    forms = {"soil": given.model.forms["soil"], "water": pore}
    numbered = sc.Model(forms, given.model.fixed)
    inside = numbered.forms["water"]
    yield "PoreWater.prescribed", inside.prescribed, {"pressures": {"top": 0.0}}
    yield "PoreWater.at_boundaries", inside.at_boundaries, {"pressures": {"top": 0.0}}
    yield "PoreWater.pressure", inside.pressure, {"x": np.zeros(numbered.layout.size)}
    yield "Inflow", water.Inflow, {"water": pore, "flux": {"top": 1e-6}, "sources": None}
    yield (
        "water.Permeability",
        water.Permeability,
        {"start": 1e-4, "void_ratio": 0.8, "change": 0.5},
    )
    yield (
        "PoreWater, partly saturated",
        water.PoreWater,
        {
            "basis": basis,
            "permeability": 1e-4,
            "retention": retention,
            "start": steady,
            "unit_weight": 10.0,
            "storage": 0.0,
            "time_error": 0.01,
        },
    )


def of_results(given: Analysed) -> Iterator[Door]:
    """Values, tables and files of results."""
    result, last, folder = given.result, given.result[-1], given.folder
    points = {"A": [1.0, 0.5]}
    cuts = sc.Cuts.line([0.1, 0.5], [1.9, 0.5], depth=0.8, n=3)
    yield (
        "Result.at",
        lambda points, quantity: result.at(points, quantity),
        {
            "points": points,
            "quantity": "uy",
        },
    )
    yield "Result.envelope", result.envelope, {"body": "soil", "sections": cuts}
    yield (
        "Result.table",
        lambda sections: result.table(sections=sections),
        {"sections": {"soil": cuts}},
    )
    yield "Result.to_pvd", result.to_pvd, {"file": folder / "result.pvd"}
    yield "Result.save", result.save, {"file": folder / "result.npz"}
    result.save(folder / "sound.npz")
    yield "load_result", sc.load_result, {"file": folder / "sound.npz", "forms": given.model}
    yield "Append", sc.results.Append, {"file": folder / "appended.npz"}
    yield (
        "StageResult.at",
        lambda points, quantity, **more: last.at(points, quantity, **more),
        {"points": points, "quantity": "syy", "since": None, "water": None, "of": "soil"},
    )
    yield (
        "StageResult.along",
        lambda line, quantity, **more: last.along(line, quantity, **more),
        {"line": [[0.1, 0.5], [1.9, 0.5]], "quantity": "syy", "n": 5, "since": None, "of": "soil"},
    )
    yield "StageResult.table", last.table, {"name": "soil", "sections": cuts}
    yield "StageResult.field", last.field, {"name": "uy", "since": result[0], "water": None}
    yield "StageResult.to_vtu", last.to_vtu, {"file": folder / "stage.vtu"}
    yield "undrained_strength", last.undrained_strength, {"solid": "soil"}
    yield "shansep", last.shansep, {"solid": "soil", "S": 0.25, "m": 0.8, "OCR": 1.0, "POP": 0.0}
    yield (
        "drawdown_strength",
        last.drawdown_strength,
        {"solid": "soil", "c": 0.0, "phi": 30.0, "c_R": 10.0, "phi_R": 15.0, "region": None},
    )
    table = result.table(sections={"soil": cuts})
    yield "Table.to_csv", table.to_csv, {"file": folder / "table.csv"}
    yield (
        "Table.of",
        sc.results.Table.of,
        {"columns": {"depth": [1.0, 2.0]}, "caption": "Depths", "kinds": {"depth": "length"}},
    )
    modes = given.model.modes(2)
    yield "Model.modes", given.model.modes, {"n": 2, "start": None, "mass": "lumped"}
    yield "Model.frequencies", given.model.frequencies, {"n": 2, "start": None, "mass": "lumped"}
    yield "Modes.stage", modes.stage, {"number": 1}


def of_pictures(given: Analysed) -> Iterator[Door]:
    """Diagrams, which need no screen."""
    result, last, folder = given.result, given.result[-1], given.folder
    flow = water.Flow(given.basis, 1e-4, unit_weight=10.0)
    steady = flow.steady(water.Conditions({"left": 2.0, "right": 1.5}))
    found = last.along([[0.1, 0.5], [1.9, 0.5]], "syy", n=5)
    file = folder / "picture.png"
    cuts = sc.Cuts.line([0.1, 0.5], [1.9, 0.5], depth=0.8, n=3)
    forces = last.section_forces("soil", cuts)
    yield (
        "plot.diagram",
        plot.diagram,
        {
            "values": forces,
            "quantity": "M",
            "on": None,
            "along": "arc",
            "upright": None,
            "scale": None,
            "window": None,
            "file": file,
        },
    )
    yield (
        "plot.flow_diagram",
        plot.flow_diagram,
        {"water": steady, "quantity": "head", "arrows": True, "ax": None, "file": file},
    )
    yield (
        "plot.history",
        plot.history,
        {
            "result": result,
            "quantity": "uy",
            "points": {"A": [1.0, 0.5]},
            "time": False,
            "water": None,
            "file": file,
        },
    )
    yield "plot.model", plot.model, {"stage": last, "window": None, "file": file}
    yield "plot.values", plot.values, {"found": found, "upright": None, "file": file}
    yield "plot.live", plot.live, {"quantity": "u", "seconds": 1.0, "file": file}
    yield "plot.set_units", plot.set_units, {"force": "kN", "length": "m", "stress": None}
    plot.set_units()
    yield (
        "plot.sketch",
        plot.sketch,
        {
            "section": section.Section({"a": section.rectangle((0, 2), (0, 1))}, size=1.0),
            "file": file,
        },
    )


def of_dynamics(given: Analysed) -> Iterator[Door]:
    """Motion, records, and boundaries that absorb waves."""
    solid = given.model.forms["soil"]
    record = sc.Record(0.1, np.sin(np.arange(40)), "sine")
    yield "Record", sc.Record, {"step": 0.1, "values": np.sin(np.arange(40)), "name": "sine"}
    yield (
        "Record.synthetic",
        sc.Record.synthetic,
        {"peak": 1.0, "duration": 2.0, "step": 0.05, "seed": 0},
    )
    file = given.folder / "record.csv"
    file.write_text("".join(f"{0.1 * k:.1f},{np.sin(k):.6f}\n" for k in range(40)))
    yield "Record.read", sc.Record.read, {"file": file, "scale": 1.0}
    yield "Record.at", record.at, {"time": 0.15}
    yield "Record.scaled", record.scaled, {"factor": 2.0}
    yield "Record.corrected", record.corrected, {"order": 1}
    yield "Record.resampled", record.resampled, {"step": 0.05}
    yield "Record.filtered", record.filtered, {"low": 0.5, "high": 2.0, "order": 4}
    yield "Record.arias", record.arias, {"gravity_acceleration": 9.81}
    yield "Record.significant_duration", record.significant_duration, {"begin": 0.05, "end": 0.95}
    yield "Record.spectrum", record.spectrum, {"periods": [0.1, 1.0], "ratio": 0.05}
    yield "Rayleigh", sc.Rayleigh, {"ratio": 0.05, "f": (1.0, 10.0)}
    yield "Bedrock", sc.Bedrock, {"unit_weight": 25.0, "vs": 800.0, "vp": 1600.0}
    rock = sc.Bedrock(25.0, 800.0, 1600.0)
    yield (
        "ViscousBoundary",
        sc.ViscousBoundary,
        {"solid": solid, "boundary": "bottom", "rock": rock},
    )
    yield "FreeField", sc.FreeField, {"solid": solid, "boundary": "left", "rock": rock}
    dynamic: dict[str, Any] = {"step": 0.05, "rho_inf": 0.8, "mass": "lumped"}
    dynamic |= {"contact_mass": None, "damping": sc.Rayleigh(0.05, (1.0, 10.0)), "velocity": None}
    dynamic |= {"points": (), "explicit": False}

    def shaken(**changed: Any) -> Any:
        stage = sc.Stage("shaken", duration=0.1, dynamic=sc.Dynamic(**changed))
        return given.model.run([stage], start=given.result, **QUIET)

    yield "Dynamic", shaken, dynamic
    moved = shaken(step=0.05, points=[[1.0, 1.0]])[-1]
    yield (
        "StageResult.history",
        moved.history,
        {"point": [1.0, 1.0], "quantity": "displacement", "absolute": False},
    )


def of_design(given: Analysed) -> Iterator[Door]:
    """Partial factors, bearing resistance, and checks."""
    yield (
        "bearing_resistance",
        design.bearing_resistance,
        {
            "width": 2.0,
            "vertical": 100.0,
            "horizontal": 10.0,
            "length": 4.0,
            "c": 5.0,
            "phi": 30.0,
            "unit_weight": 18.0,
            "surcharge": 10.0,
        },
    )
    factors = design.PartialFactors("own", permanent=1.35, variable=1.5, phi=1.25)
    yield (
        "PartialFactors",
        design.PartialFactors,
        {
            "name": "own",
            "permanent": 1.35,
            "favourable": 1.0,
            "variable": 1.5,
            "phi": 1.25,
            "cohesion": 1.25,
            "on": "actions",
        },
    )
    force = np.zeros(given.basis.N)
    yield "PartialFactors.load", factors.load, {"permanent": force, "variable": force}
    yield "PartialFactors.friction_angle", factors.friction_angle, {"phi": 30.0}
    yield "PartialFactors.effect", factors.effect, {"value": 10.0}
    yield (
        "design.factored",
        design.factored,
        {"model": given.model, "factors": factors, "exclude": ()},
    )


def of_ground(given: Analysed) -> Iterator[Door]:
    """Soundings, columns, and sections between them."""
    depth = np.linspace(0.1, 10.0, 50)
    sounding = ground.Sounding(
        name="CPT1",
        position=(0.0, 0.0),
        level=0.0,
        depth=depth,
        cone=np.full(50, 5e3),
        sleeve=np.full(50, 50.0),
        pore=np.full(50, 10.0),
    )
    yield (
        "Sounding",
        ground.Sounding,
        {
            "name": "CPT1",
            "position": (0.0, 0.0),
            "level": 0.0,
            "depth": depth,
            "cone": np.full(50, 5e3),
            "sleeve": np.full(50, 50.0),
            "pore": np.full(50, 10.0),
            "area_ratio": 0.8,
            "water": 2.0,
        },
    )
    yield "Sounding.behaviour", sounding.behaviour, {"unit_weight": 18.0, "water": 2.0}
    yield (
        "Sounding.profile",
        sounding.profile,
        {"parameter": "phi", "unit_weight": 18.0, "water": 2.0},
    )
    yield "Sounding.column", sounding.column, {"unit_weight": 18.0, "water": 2.0, "thinnest": 0.5}
    profile = sounding.profile("phi", 18.0, 2.0)
    yield "Profile.between", profile.between, {"upper": 1.0, "lower": 5.0}
    columns = [
        ground.Column(name, (x, 0.0), 0.0, (("sand", -2.0), ("clay", -5.0)))
        for name, x in (("A", 0.0), ("B", 10.0))
    ]
    yield (
        "Column",
        ground.Column,
        {"name": "A", "position": (0.0, 0.0), "level": 0.0, "layers": (("sand", -2.0),)},
    )
    yield (
        "ground.section",
        ground.section,
        {"columns": columns, "size": 2.0, "along": None, "width": 0.0, "bottom": -6.0},
    )


def of_meshes(given: Analysed) -> Iterator[Door]:
    """Files of meshes."""
    mesh, folder = given.basis.mesh, given.folder
    for ending in (".msh", ".inp", ".vtu", ".med"):
        yield f"save_mesh {ending}", sc.save_mesh, {"mesh": mesh, "path": folder / f"mesh{ending}"}
        sc.save_mesh(mesh, folder / f"sound{ending}")
        yield (
            f"load_mesh {ending}",
            sc.load_mesh,
            {
                "path": folder / f"sound{ending}",
                "plane": "xy",
                "factor": 1.0,
                "split": False,
                "name": None,
            },
        )
    yield "check_mesh", sc.mesh.check_mesh, {"mesh": mesh, "joined": None}
    triangles = MeshTri().refined(1).with_defaults()
    yield (
        "join_bodies",
        sc.join_bodies,
        {"mesh": {"a": triangles, "b": triangles.translated((0.0, 1.0))}},
    )
