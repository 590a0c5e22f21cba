"""Buried culvert from a mesh file to pictures: ``python -m skfem_contact.demo --out culvert_out``."""
from __future__ import annotations

import argparse
import warnings
from collections.abc import Sequence
from importlib.resources import as_file, files
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

from numpy import ndarray
from skfem import Basis, ElementQuad1, ElementVector

import skfem_contact as sc


class Culvert(NamedTuple):
    """Basis, forms (ground, culvert and the skin between them), weight (N,) and result of two stages."""

    basis: Basis
    forms: dict[str, Any]
    gravity: ndarray
    result: sc.results.Result


def culvert() -> Culvert:
    """Run the analysis: gravity, then a one-sided surcharge on the surface of the ground.

    A concrete pipe lies in a soft layer of soil above a stiff one, example 1 of the paper. The values of the soils, the
    depth of cover and the position of the surcharge are not published; those here are a choice. Units are kN and m.

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
    weights = {"soft": 18.0, "stiff": 20.0}
    model = sc.Model({
        "ground": sc.SolidForm(basis.with_elements("ground"), soils, strain="b_bar", unit_weight=weights),
        "culvert": sc.SolidForm(basis.with_elements("culvert"), concrete, strain="b_bar", unit_weight=25.0),
        "skin": sc.ContactPair(basis, slave="ground|culvert", master="culvert|ground", law=sc.Coulomb(mu=0.6),
                               quadrature="nodal", smoothing=0.5, initial="adjusted"),
    }, sc.box_supports(basis))
    strip = sc.traction(basis, "surface", lambda x: (0.0 * x[0], -35.0 * (x[0] > 0.0) * (x[0] < 1.8)))
    result = model.run([sc.Stage("gravity"), sc.Stage("surcharge", strip)])
    return Culvert(basis, model.forms, result["gravity"].load, result)


def _draw(result: sc.results.Result, out: Path) -> dict[str, str]:
    """Draw the pictures into a folder; return names of the files and their contents."""
    import matplotlib

    matplotlib.use("Agg")
    import skfem_contact.plot as plot

    plot.set_units("kN", "m")
    cuts = sc.Sections.ring((0.0, 0.0), 0.72, 0.90, n=72)
    skin = {stage.name: stage.tractions("skin") for stage in result}
    ring = {stage.name: stage.section_forces("culvert", cuts) for stage in result}
    angle = skin["gravity"].central_angle()
    diagrams = {
        "pressure": ("contact pressure", "stress", angle, {name: points.pressure for name, points in skin.items()}),
        "friction": ("friction", "stress", angle, {name: points.shear for name, points in skin.items()}),
        "moment": ("moment", "moment", cuts.position, {name: forces.M for name, forces in ring.items()}),
        "thrust": ("thrust", "line", cuts.position, {name: -forces.N for name, forces in ring.items()}),
    }
    written = {}
    for name, (title, unit, position, series) in diagrams.items():
        plot.diagram(series, plot.labelled(title, unit), angle=position, file=out / f"{name}.png")
        written[f"{name}.png"] = f"{title} around the pipe in both stages"
    gravity, surcharge = result["gravity"], result["surcharge"]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it is said below the list of files
        if plot.contour(surcharge, "uy", since=gravity, deformed="auto", contact=True,
                        loads=surcharge.load - gravity.load, file=out / "culvert.png"):
            written["culvert.png"] = "settlement that the surcharge adds, and what the ground exerts on the pipe"
    plot.set_units()
    return written


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the demonstration from the command line."""
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
    result = culvert().result
    for stage in result:
        stage.to_vtu(out / f"{stage.name}.vtu")
    result.save(out / "culvert.npz")
    written = {f"{stage.name}.vtu": f"displacements, stresses and contact of '{stage.name}', for ParaView"
               for stage in result} | {"culvert.npz": "the whole result, for load_result"} | _draw(result, out)
    print(f"{result}\n\nWritten to {out}:")
    for name, text in written.items():
        print(f"  {name:16}{text}")
    if "culvert.png" not in written:
        print("No culvert.png: VTK cannot draw on this machine, it needs OpenGL.")
    print(f"\nDone in {perf_counter() - begin:.1f} s.")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
