"""Wrong calls of public functions, one argument at a time, and how each ends: ``python -m
tests.fuzz --calls``.
"""

from __future__ import annotations

import collections
import itertools
import os
import random
import signal
import tempfile
import traceback
import warnings
from pathlib import Path

import numpy as np
from skfem import Basis, ElementQuad2, ElementVector, MeshHex, MeshQuad

import skfem_contact as sc

from . import doors as more_doors

PACKAGE = str(Path(sc.__file__).parent)
#: Values that no argument of these doors takes, besides those that its annotation excludes.
WRONG = {
    "object": object(),
    "complex": 1j,
    "complex array": np.array([1j, 2.0]),
    "nan": np.nan,
    "inf": np.inf,
    "-inf": -np.inf,
    "negative": -3.7,
    "zero": 0,
    "one float": 7.0,
    "true": True,
    "none": None,
    "empty text": "",
    "unknown": "no such name",
    "number as text": "3.0",
    "empty list": [],
    "empty dict": {},
    "set": {1.5},
    "nested": [[1.0, 2.0], [3.0]],
    "text list": ["a", "b"],
    "nan list": [np.nan, 1.0],
    "long": np.ones(77),
    "cube": np.ones((2, 3, 4)),
    "dict": {"no such name": 1.0},
    "function": lambda *a: None,
    "class": sc.SolidForm,
    "law": sc.Tied(),
    "stage": sc.Stage("x"),
    "bytes": b"top",
}
#: Wrong for every numeric argument: accepting one of them is silence.
NEVER = (
    "object",
    "complex",
    "complex array",
    "set",
    "nested",
    "text list",
    "class",
    "bytes",
    "stage",
)


def doors():
    """Return (name, function, sound keyword arguments) of the public calls."""
    mesh = sc.join_bodies(
        {
            "base": MeshQuad.init_tensor(
                np.linspace(0, 3, 4), np.linspace(0, 1, 3)
            ).with_defaults(),
            "block": MeshQuad.init_tensor(
                np.linspace(1, 2, 3), np.linspace(1, 2, 3)
            ).with_defaults(),
        }
    )
    two = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    plain = MeshQuad.init_tensor(np.linspace(0, 2, 4), np.linspace(0, 1, 3)).with_defaults()
    basis = Basis(plain, ElementVector(ElementQuad2()), intorder=4)
    elastic, clay = sc.LinearElastic(E=1e4, nu=0.3), sc.Tresca(E=1e4, nu=0.3, c=10.0)
    solid = sc.SolidForm(basis, clay, unit_weight=20.0)
    fixed, folder = sc.box_supports(basis), Path(tempfile.mkdtemp())
    model = sc.Model({"soil": solid}, fixed, water_unit_weight=10.0)
    result = model.run([sc.Stage("weight")], progress=False)
    both = sc.SolidForm(two, elastic, unit_weight=20.0)
    pair = {"basis": two, "slave": "block:bottom", "master": "base:top", "law": sc.Coulomb(mu=0.4)}
    contact = sc.Model(
        {"bodies": both, "joint": sc.ContactPair(**pair)}, two.get_dofs("base:bottom").all()
    )
    pressed = contact.run([sc.Stage("weight")], progress=False)["weight"]
    water = sc.PoreWater(basis, permeability=1e-4, unit_weight=10.0)
    rigid = sc.RigidBoundary(basis, "top")
    head = {"left": 2.0, "right": 1.0}
    soil = {"E": 1e4, "nu": 0.3, "c": 10.0, "phi": 30.0}
    quiet = {"progress": False}
    sections = sc.Cuts.line([0.1, 0.5], [1.9, 0.5], depth=1.0, n=3)
    bar = sc.Bar(basis, start=[0.0, 1.0], end=[2.0, 1.0], EA=100.0)
    r = sc.rigid
    beam = sc.Beam(None, [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], EI=1.0, EA=1.0)
    frame = sc.Model({"beam": beam}, beam.dofs((0.0, 0.0))).forms["beam"]
    yield (
        "Beam",
        sc.Beam,
        {
            "basis": None,
            "line": [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]],
            "EI": 1.0,
            "EA": 1.0,
            "GA": 1.0,
            "spacing": 2.0,
            "cells": [[0, 1], [1, 2]],
            "hinges": [1.0, 0.0],
            "Mp": 1.0,
            "Np": 1.0,
            "unit_weight": 1.0,
            "bonded": False,
            "thickness": 0.1,
        },
    )
    nail = sc.Beam(None, [[0.2, 0.5], [1.2, 0.5]], EI=1.0, EA=1.0)
    yield (
        "Embedded",
        sc.Embedded,
        {
            "basis": basis,
            "beam": nail,
            "T_max": 5.0,
            "F_max": 1.0,
            "stiffness": 100.0,
            "p_max": 3.0,
        },
    )
    yield (
        "Reinforcement",
        sc.Reinforcement,
        {
            "basis": None,
            "line": [[0.0, 0.0], [1.0, 0.0]],
            "EA": 1.0,
            "Np": 1.0,
            "spacing": 2.0,
            "cells": [[0, 1]],
        },
    )
    yield "Beam.at", beam.at, {"points": (0.0, 0.0)}
    yield "Beam.dofs", beam.dofs, {"at": (0.0, 0.0), "names": ["u^1"]}
    yield "Beam.load", frame.load, {"force": (0.0, 1.0), "at": (1.0, 0.0), "moment": 1.0}
    yield "Beam.heated", frame.heated, {"strain": 1e-4, "curvature": 1e-3}
    yield "Beam.line_load", frame.line_load, {"force": (0.0, 1.0)}
    yield "Coulomb.from_soil", sc.Coulomb.from_soil, {"soil": clay, "ratio": 0.5}
    inner = plain.with_boundaries({"wall": lambda x: abs(x[1] - 0.5) < 1e-9}, boundaries_only=False)
    yield "split_along", sc.split_along, {"mesh": inner, "name": "wall"}
    yield "LinearElastic", sc.LinearElastic, {"E": 1e4, "nu": 0.3}
    yield "MohrCoulomb", sc.MohrCoulomb, {**soil, "psi": 0.0, "tension": 1.0}
    yield (
        "HardeningMohrCoulomb",
        sc.HardeningMohrCoulomb,
        {**soil, "c_end": 5.0, "phi_end": 25.0, "strain_end": 0.1},
    )
    yield "Tresca", sc.Tresca, {"E": 1e4, "nu": 0.3, "c": 10.0}
    yield "VonMises", sc.VonMises, {"E": 1e4, "nu": 0.3, "strength": 10.0}
    yield (
        "DruckerPrager",
        sc.DruckerPrager,
        {"E": 1e4, "nu": 0.3, "k": 1.0, "alpha": 0.1, "beta": 0.0},
    )
    yield "Undrained", sc.Undrained, {"soil": sc.MohrCoulomb(**soil), "bulk_modulus_water": 1e6}
    yield "Coulomb", sc.Coulomb, {"mu": 0.4, "adhesion": 0.0, "tension": 0.0}
    yield "AugmentedLagrangian", sc.AugmentedLagrangian, {"tolerance": 1e-4}
    yield "Newton", sc.Newton, {"tolerance": 1e-8, "max_iterations": 25}
    yield (
        "SolidForm",
        sc.SolidForm,
        {
            "basis": basis,
            "materials": elastic,
            "strain": None,
            "coordinates": "plane",
            "unit_weight": 20.0,
            "porous": True,
        },
    )
    yield (
        "ContactPair",
        sc.ContactPair,
        {
            **pair,
            "quadrature": "segments",
            "penalty": 1e5,
            "smoothing": None,
            "enforcement": None,
            "initial": "as meshed",
            "share": 1.0,
            "tangent": "exact",
        },
    )
    yield (
        "two_pass",
        sc.ContactPair.two_pass,
        {"basis": two, "a": "block:bottom", "b": "base:top", "law": sc.Tied()},
    )
    yield (
        "Bar",
        sc.Bar,
        {
            "basis": basis,
            "start": [0.0, 1.0],
            "end": [2.0, 1.0],
            "EA": 100.0,
            "fixed_end": False,
            "yield_force": 9.0,
            "tension_only": False,
            "part": None,
            "end_part": None,
        },
    )
    yield "Bar.prestressed", bar.prestressed, {"force": 5.0}
    yield (
        "Spring",
        sc.Spring,
        {
            "basis": basis,
            "coordinates": [0.0, 1.0],
            "stiffness": 10.0,
            "to": None,
            "part": None,
            "to_part": None,
        },
    )
    yield "MatrixForm", sc.MatrixForm, {"K": np.eye(basis.N)}
    yield "RigidBoundary", sc.RigidBoundary, {"basis": basis, "boundary": "top", "rotates": True}
    yield "RigidBoundary.load", rigid.load, {"force": (0.0, -1.0), "at": (1.0, 1.0)}
    yield (
        "PoreWater",
        sc.PoreWater,
        {
            "basis": basis,
            "permeability": 1e-4,
            "unit_weight": 10.0,
            "storage": 0.0,
            "time_error": 0.01,
            "connected": (),
        },
    )
    yield "PoreWater.dofs", lambda boundary: water.dofs(boundary), {"boundary": "top"}
    yield (
        "SeepageFace",
        sc.water.SeepageFace,
        {"water": water, "boundaries": "top", "pressure": 0.0},
    )
    yield "Ramp", sc.water.Ramp, {"width": 0.5, "least": 1e-3}
    yield "VanGenuchten", sc.water.VanGenuchten, {"alpha": 1.0, "n": 2.0, "least": 1e-6}
    yield "BrooksCorey", sc.water.BrooksCorey, {"entry": 1.0, "index": 2.0, "least": 1e-6}
    yield (
        "Flow",
        sc.water.Flow,
        {
            "basis": basis,
            "permeability": 1e-4,
            "unit_weight": 10.0,
            "connected": (),
            "retention": sc.water.Ramp(),
            "storage": 0.0,
            "coordinates": "plane",
        },
    )
    flow = sc.water.Flow(basis, 1e-4, unit_weight=10.0)
    yield (
        "Conditions",
        lambda head, seepage_face: flow.steady(
            sc.water.Conditions(head, seepage_face=seepage_face)
        ),
        {"head": head, "seepage_face": ()},
    )
    flow = sc.water.Flow(basis, 1e-4, unit_weight=10.0)
    yield (
        "Flow.steady",
        lambda head: flow.steady(sc.water.Conditions(head)),
        {"head": head},
    )
    yield "Surface.from_boundary", sc.Surface.from_boundary, {"basis": basis, "name": "top"}
    yield (
        "Surface.from_cells",
        sc.Surface.from_cells,
        {
            "coordinates": np.array([[0.0, 1.0], [0.0, 0.0]]),
            "dofs": np.array([[0, 2], [1, 3]]),
            "cells": np.array([[0, 1]]),
            "name": "beam",
            "thickness": 0.0,
            "stiffness": 1.0,
        },
    )
    yield "box_supports", sc.box_supports, {"basis": basis, "part": None, "base": "fixed"}
    yield "dofs_at", sc.dofs_at, {"basis": basis, "coordinates": [0.0, 1.0], "part": None}
    yield "hydrostatic", sc.hydrostatic, {"table": 1.0, "unit_weight": 9.81}
    yield "traction", sc.traction, {"body": basis, "boundary": "top", "force": (0.0, -1.0)}
    yield "weight", sc.weight, {"body": basis, "unit_weights": 20.0, "direction": (0.0, -1.0)}
    yield (
        "water_load",
        sc.water_load,
        {"body": basis, "pressure": sc.hydrostatic(1.0), "boundaries": ()},
    )
    yield "join_bodies", sc.join_bodies, {"mesh": {"a": plain}, "bodies": None}
    yield "mesh.bodies", sc.mesh.bodies, {"mesh": mesh}
    yield "check_mesh", sc.mesh.check_mesh, {"mesh": plain}
    yield (
        "Cuts.line",
        sc.Cuts.line,
        {"start": [0.0, 0.5], "end": [2.0, 0.5], "depth": 1.0, "n": 3},
    )
    yield (
        "Cuts.ring",
        sc.Cuts.ring,
        {"center": [0.0, 0.0], "inner": 1.0, "outer": 2.0, "n": 8},
    )
    yield (
        "rigid.circle",
        r.circle,
        {"center": (0.0, 0.0), "radius": 1.0, "hole": False, "name": "o"},
    )
    yield (
        "rigid.cone",
        r.cone,
        {"apex": (0, 0, 0.0), "axis": (0, 0, 1.0), "slope": 0.5, "radius": 1.0, "name": "o"},
    )
    yield (
        "rigid.cylinder",
        r.cylinder,
        {"start": (0, 0, 0.0), "end": (0, 0, 1.0), "radius": 1.0, "hole": False},
    )
    yield (
        "rigid.level_set",
        r.level_set,
        {
            "function": lambda x, y: x * x + y * y - 1.0,
            "bounds": (-2.0, 2.0, -2.0, 2.0),
            "resolution": 20,
            "name": "o",
        },
    )
    yield "rigid.line", r.line, {"start": (0.0, 0.0), "end": (1.0, 0.0), "name": "o"}
    yield "rigid.mesh", r.mesh, {"mesh": MeshHex().with_defaults(), "boundary": "top", "name": None}
    yield (
        "rigid.plane",
        r.plane,
        {"point": (0, 0, 0.0), "normal": (0, 0, 1.0), "width": 2.0, "name": "o"},
    )
    yield (
        "rigid.polyline",
        r.polyline,
        {"points": np.array([[0.0, 0.0], [1.0, 0.1], [2.0, 0.0]]), "closed": False},
    )
    yield (
        "rigid.sphere",
        r.sphere,
        {"center": (0, 0, 0.0), "radius": 1.0, "hole": False, "name": "o"},
    )
    yield (
        "Model",
        sc.Model,
        {
            "forms": {"soil": solid},
            "fixed": fixed,
            "solver": None,
            "newton": None,
            "gravity": None,
            "seismic": 0.0,
            "water_unit_weight": 10.0,
        },
    )
    stage = {
        "load": None,
        "prescribed": None,
        "increments": 1,
        "activate": (),
        "deactivate": (),
        "change": {},
        "fixed": None,
        "duration": 0.0,
        "water": None,
        "release": 1.0,
        "keep": "last",
        "name": "s",
    }
    yield "Stage", lambda **given: model.run([sc.Stage(**given)], **quiet), stage
    yield (
        "Model.run",
        model.run,
        {"stages": [sc.Stage("s")], "start": None, "on_increment": None, **quiet},
    )
    yield (
        "Model.initial_state",
        model.initial_state,
        {"load": None, "water": None, "name": "i", "stress": lambda x: np.zeros((4, *x.shape[1:]))},
    )
    yield (
        "Model.k0_state",
        model.k0_state,
        {"load": None, "K0": 0.5, "unit_weights": None, "surcharge": 0.0, "water": None},
    )
    yield (
        "Model.gravity_state",
        model.gravity_state,
        {"load": None, "K0": 0.8, "water": None, "increments": 1},
    )
    yield "Model.is_stable", model.is_stable, {"load": None, "start": None, "water": None}
    top = model.traction("top", (0.0, -1.0))
    yield (
        "Model.limit_load",
        model.limit_load,
        {
            "load": top,
            "start": None,
            "tolerance": 0.1,
            "step": 10.0,
            "max_value": 20.0,
            "flow": "given",
            "max_step": 50.0,
            "min_displacement": 0.0,
            "certify": False,
            **quiet,
        },
    )
    yield (
        "Model.strength_reduction",
        model.strength_reduction,
        {
            "load": None,
            "start": None,
            "water": None,
            "reduce": None,
            "exclude": (),
            "flow": "given",
            "tolerance": 0.1,
            "step": 0.1,
            "max_value": 1.2,
            "certify": False,
            **quiet,
        },
    )
    yield "Model.traction", model.traction, {"boundary": "top", "force": (0.0, -1.0)}
    yield "Model.water_load", model.water_load, {"pressure": sc.hydrostatic(1.0), "boundaries": ()}
    yield "Model.weight", model.weight, {"unit_weights": 20.0, "direction": None}
    last = result["weight"]
    yield "Result.getitem", lambda name: result[name], {"name": "weight"}
    yield "Result.save", result.save, {"file": folder / "r.npz"}
    yield "field", last.field, {"name": "syy", "since": None, "water": None}
    yield "section_forces", last.section_forces, {"body": "soil", "sections": sections}
    undrained = sc.Undrained(sc.MohrCoulomb(**soil), bulk_modulus_water=1e6)
    wet = sc.Model({"soil": sc.SolidForm(basis, undrained, unit_weight=20.0)}, fixed)
    excess = wet.run([sc.Stage("weight")], **quiet)[-1]
    yield "pore_pressure", excess.pore_pressure, {"solid": "soil"}
    yield "tractions", pressed.tractions, {"pair": "joint"}
    yield "report", pressed.report, {"pair": "joint"}
    yield (
        "results.of",
        sc.results.of,
        {"model": model, "x": last.x, "states": last.states, "load": None},
    )
    yield (
        "check_material",
        sc.testing.check_material,
        {
            "material": clay,
            "strain": 1e-3,
            "shape": (5, 4),
            "ncomp": 4,
            "steps": 2,
            "dissipation": True,
            "tolerance": 1e-5,
            "seed": 0,
        },
    )
    yield (
        "check_interface_law",
        sc.testing.check_interface_law,
        {
            "law": sc.Coulomb(mu=0.4),
            "penalties": (1e4, 1e4),
            "size": 1e-3,
            "n": 50,
            "tolerance": 1e-6,
            "seed": 0,
            "dimensions": (2, 3),
        },
    )
    yield (
        "check_form",
        sc.testing.check_form,
        {
            "form": solid,
            "x": last.x,
            "state": last.states["soil"],
            "tolerance": 1e-6,
            "directions": 2,
            "seed": 0,
        },
    )


def same_kind(sound, wrong) -> bool:
    """Return True where the wrong value may be meant: the same kind of thing, or a number for a
    number.
    """

    def number(v):
        return isinstance(v, (int, float)) and not isinstance(v, bool)

    if number(sound) and number(wrong):
        return True
    return type(sound) is type(wrong)


def ends(function, sound, name, key) -> tuple[str, str]:
    """Return how a call with one wrong argument ends, and its message."""
    signal.alarm(20)
    try:
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            function(**{**sound, name: WRONG[key]})
    except TimeoutError:
        return "no end in 20 s", ""
    except (ValueError, TypeError) as error:
        signal.alarm(0)
        frames = traceback.extract_tb(error.__traceback__)
        inside = frames[-1].filename.startswith(PACKAGE) or (
            isinstance(error, TypeError) and len(frames) == 1
        )
        raised = inside and (frames[-1].line or "").lstrip().startswith(
            ("raise", "return number", "return _error")
        )
        known = type(error) in (ValueError, TypeError) or type(error).__module__.startswith(
            "skfem_contact"
        )
        if known and (raised or len(frames) == 1):
            return "refused", str(error)
        return "deep " + type(
            error
        ).__name__, f"{Path(frames[-1].filename).name}:{frames[-1].lineno} {error}"
    except (OSError, sc.testing.CheckFailed, sc.NoEquilibrium) as error:
        return "answered", str(error)  # a file that cannot be read, a law that fails its check
    except Exception as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        if isinstance(error, KeyError) and "there is no" in str(
            error
        ):  # as documented by __getitem__
            return "refused", str(error)
        return "deep " + type(error).__name__, f"{Path(last.filename).name}:{last.lineno} {error}"
    finally:
        signal.alarm(0)
    if told:
        return "told", ""
    wrong = key in NEVER and not same_kind(sound[name], WRONG[key])
    return ("silent" if wrong else "accepted"), ""


def timeout(*_):
    raise TimeoutError


def calls(share: float, seed: int) -> list[tuple[str, str]]:
    """Make a share of the calls; return how each ends, and a line on it."""
    chance, before, found = random.Random(seed), signal.signal(signal.SIGALRM, timeout), []
    for door, function, sound in itertools.chain(doors(), more_doors.doors()):
        try:
            function(**sound)
        except Exception as error:
            found.append(("unsound", f"{'sound call fails':22} {door} {error!r}"))
        for name, key in ((name, key) for name in sound for key in WRONG):
            lengthy = name == "certify" and key in (
                "true",
                "empty dict",
            )  # means yes, and takes a minute
            if not lengthy and chance.random() < share:
                end, message = ends(function, sound, name, key)
                found.append((end, f"{end:22} {door}({name}={key}) {message}"))
    signal.signal(signal.SIGALRM, before)
    return found


def main(share: float = 1.0, seed: int = 1) -> int:
    """Print how the calls end; return 1 if more than .5 % end deep inside, one passes in silence,
    or a sound one fails.
    """
    os.chdir(tempfile.mkdtemp())  # Result.save writes whatever it is given
    found = calls(share, seed)
    count = collections.Counter(end for end, _ in found)
    told = ("deep", "no end", "silent", "unsound")
    print(*sorted(line for end, line in found if end.startswith(told)), sep="\n")
    for end, n in count.most_common():
        print(f"{end:28}{n:7}{n / len(found):8.1%}")
    deep = sum(n for end, n in count.items() if end.startswith(("deep", "no end")))
    print(
        f"{len(found)} calls, {deep} end deep inside ({deep / len(found):.1%}), {count['silent']} "
        f"silent, {count['unsound']} sound ones fail"
    )
    return int(deep > 0.005 * len(found) or count["silent"] + count["unsound"] > 0)
