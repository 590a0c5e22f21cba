"""The buried culvert from a mesh file to a report: ``python -m skfem_contact.demo --out culvert_out``."""
from __future__ import annotations

import argparse
import warnings
from collections.abc import Sequence
from dataclasses import replace
from importlib.resources import as_file, files
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from skfem import Basis, ElementQuad1, ElementVector, FacetBasis, LinearForm

import skfem_contact as sc
from skfem_contact.contact.laws import Status
from skfem_contact.contact.penalty import choose_penalties

_INNER, _OUTER = 0.72, 0.90  # radii of the pipe
_PICTURE = "culvert.png"  # the one that needs OpenGL


class Culvert(NamedTuple):
    """The analysis of the culvert: of ground, culvert and the skin between them, its weight, (N,), and two stages."""

    basis: Basis
    forms: dict[str, Any]
    gravity: ndarray
    result: sc.results.Result


class Check(NamedTuple):
    """A statement about the result: what it is about, what came out, what is expected, whether it holds."""

    what: str
    ours: str
    expected: str
    holds: bool


def culvert() -> Culvert:
    """Run the analysis: gravity, then a one-sided surcharge on the surface of the ground.

    A concrete pipe lies in a soft layer of soil above a stiff one, example 1 of the paper.  The values of the
    soils, the depth of cover and the place of the surcharge are not handed down; those here are our choice.
    Units are kN and m.

    Examples
    --------
    >>> from skfem_contact.demo import culvert
    >>> culvert().result["surcharge"].summary["skin"]
    '72 stick, 0 slip, 0 open'
    """
    with as_file(files("skfem_contact") / "data" / "culvert.msh") as file:
        welded = sc.load_mesh(file)
    mesh = sc.join_bodies(welded, bodies={"ground": ["soft", "stiff"], "culvert": "culvert"})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    soils = {"soft": sc.MohrCoulomb(E=1e4, nu=0.40, c=5.0, phi=25.0),
             "stiff": sc.MohrCoulomb(E=5e4, nu=0.35, c=10.0, phi=35.0)}
    concrete = sc.LinearElastic(E=2.8e7, nu=0.2)
    forms = choose_penalties({
        "ground": sc.SolidForm(basis.with_elements("ground"), soils, strain="b_bar"),
        "culvert": sc.SolidForm(basis.with_elements("culvert"), concrete, strain="b_bar"),
        "skin": sc.ContactPair(basis, slave="ground|culvert", master="culvert|ground", law=sc.Coulomb(mu=0.6),
                               quadrature="nodal", smoothing=0.5, initial="adjusted"),
    })
    gravity = sc.weight(basis, {"soft": 18.0, "stiff": 20.0, "culvert": 25.0})
    surface = FacetBasis(mesh, basis.elem, facets="surface")
    strip = LinearForm(lambda v, w: -35.0 * v[1] * (w.x[0] > 0.0) * (w.x[0] < 1.8)).assemble(surface)
    fixed = np.concatenate((basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1")))
    stages = [sc.Stage("gravity", gravity), sc.Stage("surcharge", gravity + strip)]
    return Culvert(basis, forms, gravity, sc.Model(forms, fixed).run(stages))


def checks(model: Culvert) -> list[Check]:
    """What the paper says of its example, and what equilibrium and symmetry demand.

    Examples
    --------
    >>> from skfem_contact.demo import checks, culvert
    >>> all(check.holds for check in checks(culvert()))
    True
    """
    stages = list(model.result)
    skin = [_clockwise(model, stage) for stage in stages]
    points = len(skin[0].pressure)
    weight = abs(model.gravity[_pipe(model)].sum())
    lifted = max(np.abs(_carried(model, stage) - (0.0, weight)).max() / weight for stage in stages)
    missing = max(_out_of_balance(model, stage) for stage in stages)
    uneven = [np.abs(p.pressure[1:] - p.pressure[:0:-1]).max() / p.pressure.max() for p in skin]
    stick = [np.count_nonzero(p.status == Status.STICK) for p in skin]
    opened = [np.count_nonzero(p.status == Status.OPEN) for p in skin]
    lowest = skin[1].central_angle()[skin[1].pressure.argmin()]
    waves = [np.fft.rfft(_section_forces(model, stage).M) for stage in stages]
    rhythm = [int(np.abs(wave[1:]).argmax()) + 1 for wave in waves]
    turned = float(np.degrees(np.angle(waves[0][2] / waves[1][2]))) / 2.0
    return [Check(what, ours, expected, bool(holds)) for what, ours, expected, holds in (
        ("contact forces on the pipe less its weight", f"{lifted:.0e}", "< 1e-6 of it", lifted < 1e-6),
        ("section forces against the tractions", f"{missing:.2%}", "< 1 %", missing < 0.01),
        ("gravity: asymmetry of the pressure", f"{uneven[0]:.0e}", "< 1e-6", uneven[0] < 1e-6),
        ("surcharge: asymmetry of the pressure", f"{uneven[1]:.0%}", "not symmetric", uneven[1] > 0.05),
        ("points that stick, in both stages", f"{stick[0]}, {stick[1]}", f"{points}", min(stick) == points),
        ("points that are open, in both stages", f"{opened[0]}, {opened[1]}", "none", max(opened) == 0),
        ("surcharge: smallest pressure at", f"{lowest:.0f} degrees", "90 degrees", abs(lowest - 90) < 6),
        ("waves of the moment in both stages", f"{rhythm[0]}, {rhythm[1]}", "same", rhythm[0] == rhythm[1]),
        ("surcharge: shift of the moment", f"{turned:.1f} degrees", "shifted", abs(turned) > 1.0),
    )]


def _section_forces(model: Culvert, stage: sc.results.StageResult) -> sc.results.SectionForces:
    """Section forces of the pipe at cuts through its nodes, from the crown clockwise."""
    cuts = sc.Sections.ring((0.0, 0.0), _INNER, _OUTER, n=72)
    return stage.section_forces("culvert", cuts)


def _carried(model: Culvert, stage: sc.results.StageResult) -> ndarray:
    """Sum of the contact forces on the pipe's nodes, (2,); a form's force is what the nodes must hold."""
    force = model.forms["skin"].assemble(stage.x, stage.states["skin"]).force
    return -force[_pipe(model)].reshape(-1, 2).sum(axis=0)


def _out_of_balance(model: Culvert, stage: sc.results.StageResult) -> float:
    """Equilibrium of the parts of the ring from the crown to every cut: tractions, weight and section forces.

    The largest missing force as a share of the largest thrust, or the largest missing moment as a share of
    the largest moment, whichever is greater.
    """
    points, ring = _clockwise(model, stage), _section_forces(model, stage)
    weight = abs(model.gravity[_pipe(model)].sum()) / len(points.pressure)
    angle = np.radians(ring.position)
    out = np.stack((np.sin(angle), np.cos(angle)))
    along = np.stack((np.cos(angle), -np.sin(angle)))
    middle = 0.5 * (_INNER + _OUTER)

    # what acts at a point; a point on the cut counts by half
    load = points.weight * (points.shear * along - points.pressure * out) - weight * np.array([[0.0], [1.0]])
    moment = points.weight * points.shear * _OUTER + weight * middle * out[0]  # about the centre, clockwise
    section = np.vstack((ring.N * along + ring.V * out, ring.M + middle * ring.N))
    acting = np.vstack((load, moment))
    between = np.cumsum(acting, axis=1) - 0.5 * (acting + acting[:, :1])
    missing = np.abs(section - section[:, :1] + between).max(axis=1)
    return float(max(missing[:2].max() / np.abs(ring.N).max(), missing[2] / np.abs(ring.M).max()))


def _pipe(model: Culvert) -> ndarray:
    """Layout of the pipe."""
    return np.unique(model.forms["culvert"].basis.element_dofs)


def _clockwise(model: Culvert, stage: sc.results.StageResult) -> sc.results.Tractions:
    """Tractions on the pipe from the crown clockwise."""
    points = stage.tractions("skin")
    order = np.argsort(points.central_angle())
    return replace(points, **{name: values[order] for name, values in vars(points).items()})


def _draw(model: Culvert, out: Path) -> dict[str, str]:
    """Draw the pictures into a folder; names of the files and what they show."""
    import matplotlib

    matplotlib.use("Agg")
    import skfem_contact.plot as plot

    plot.set_units("kN", "m")
    gravity, surcharge = model.result["gravity"], model.result["surcharge"]
    skin = {stage.name: _clockwise(model, stage) for stage in model.result}
    ring = {stage.name: _section_forces(model, stage) for stage in model.result}
    angle, cuts = skin["gravity"].central_angle(), ring["gravity"].position
    diagrams = {
        "pressure": (angle, {k: p.pressure for k, p in skin.items()}, "contact pressure", "stress"),
        "friction": (angle, {k: p.shear for k, p in skin.items()}, "friction", "stress"),
        "moment": (cuts, {k: forces.M for k, forces in ring.items()}, "moment", "moment"),
        "thrust": (cuts, {k: -forces.N for k, forces in ring.items()}, "thrust", "line"),
    }
    written = {}
    for name, (position, series, quantity, unit) in diagrams.items():
        plot.ring_diagram(position, series, plot.labelled(quantity, unit), file=out / f"{name}.png")
        written[f"{name}.png"] = f"{quantity} around the pipe in both stages"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it is said below the list of files
        if plot.contour(model.forms, surcharge, "uy", since=gravity, deformed="auto", contact=True,
                        loads=surcharge.load - gravity.load, file=out / _PICTURE):
            written[_PICTURE] = "settlement that the surcharge adds, and what the ground exerts on the pipe"
    plot.set_units()
    return written


def _save(model: Culvert, out: Path) -> dict[str, str]:
    """Write the result and a VTU file of every stage into a folder; names of the files and what they hold."""
    written = {}
    for stage in model.result:
        stage.to_vtu(out / f"{stage.name}.vtu")
        written[f"{stage.name}.vtu"] = f"displacements, stresses and contact of '{stage.name}', for ParaView"
    model.result.save(out / "culvert.npz")
    written["culvert.npz"] = "the whole result, for load_result"
    return written


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the demonstration from the command line; 0, or 1 if a check fails.

    Examples
    --------
    >>> import tempfile
    >>> from skfem_contact.demo import main
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     status = main(["--out", folder])    # doctest: +ELLIPSIS
    A buried culvert ...
    >>> status
    0
    """
    begin = perf_counter()
    parser = argparse.ArgumentParser(
        prog="python -m skfem_contact.demo",
        description="Compute a buried culvert: tables, pictures and files for ParaView.")
    parser.add_argument("--out", type=Path, default=Path("culvert_out"),
                        help="folder for pictures and files (default: %(default)s)")
    out = parser.parse_args(arguments).out
    if out.exists() and not out.is_dir():
        parser.error(f"--out {out} is a file, not a folder")
    out.mkdir(parents=True, exist_ok=True)

    print("A buried culvert under its own weight and a one-sided surcharge\n", flush=True)
    model = culvert()
    found = checks(model)
    print(f"{model.result}\n\n{'check':48}{'ours':>14}  expected")
    for check in found:
        print(f"{check.what:48}{check.ours:>14}  {check.expected}{'' if check.holds else '   FAILED'}")
    written = _save(model, out) | _draw(model, out)
    print(f"\nWritten to {out}:")
    for name, what in written.items():
        print(f"  {name:16}{what}")
    if _PICTURE not in written:
        print(f"No {_PICTURE}: VTK cannot draw on this machine, it needs OpenGL.")
    print(f"\nDone in {perf_counter() - begin:.1f} s.")
    return 0 if all(check.holds for check in found) else 1


if __name__ == "__main__":
    raise SystemExit(main())
