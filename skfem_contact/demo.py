"""Analyses that show the package.

Run them by ``python -m skfem_contact.demo --out culvert_out``, or ``... slope``.
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Sequence
from importlib.resources import as_file, files
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from skfem import Basis, ElementQuad1, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc


class Culvert(NamedTuple):
    """Basis, forms (ground, culvert and skin), weight, (N,), and result of two stages."""

    basis: Basis
    forms: dict[str, Any]
    gravity: ndarray
    result: sc.results.Result


def culvert() -> Culvert:
    """Run the analysis: gravity, then a one-sided surcharge on the surface of the ground.

    A concrete pipe lies in a soft layer of soil above a stiff one, example 1 of the paper. The
    values of the soils, the depth of cover and the position of the surcharge are not published;
    those here are a choice. Units are kN and m.

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
    ground = sc.SolidForm(
        basis.with_elements("ground"),
        {
            "soft": sc.MohrCoulomb(E=1e4, nu=0.40, c=5.0, phi=25.0),
            "stiff": sc.MohrCoulomb(E=5e4, nu=0.35, c=10.0, phi=35.0),
        },
        strain="b_bar",
        unit_weight={"soft": 18.0, "stiff": 20.0},
    )
    pipe = sc.SolidForm(
        basis.with_elements("culvert"),
        sc.LinearElastic(E=2.8e7, nu=0.2),
        strain="b_bar",
        unit_weight=25.0,
    )
    skin = sc.ContactPair(
        basis,
        slave="ground|culvert",
        master="culvert|ground",
        law=sc.Coulomb(mu=0.6),
        quadrature="nodal",
        smoothing=0.5,
        initial="adjusted",
    )
    forms = {"ground": ground, "culvert": pipe, "skin": skin}
    model = sc.Model(forms, sc.box_supports(basis))
    strip = sc.traction(
        basis, "surface", lambda x: (0.0 * x[0], -35.0 * (x[0] > 0.0) * (x[0] < 1.8))
    )
    result = model.run([sc.Stage("gravity"), sc.Stage("surcharge", strip)])
    return Culvert(basis, model.forms, result["gravity"].load, result)


def slope() -> tuple[sc.results.Result, Any]:
    """Run a slope of 10 m on 5 m of ground, 1 in 2; return the result and its factor of safety.

    It is example 2 of Griffiths and Lane (1999), whose factor is 1.4. Units are kN and m.

    Examples
    --------
    >>> from skfem_contact.demo import slope
    >>> f"{slope()[1].factor:.1f}"
    '1.4'
    """
    left = np.linspace(-20, 0, 9)
    middle = np.linspace(0, 20, 13)
    right = np.linspace(20, 32, 7)
    lines = np.concatenate((left, middle[1:], right[1:]))
    flat = MeshTri.init_tensor(lines, np.linspace(0, 1, 9))
    x, height = flat.p
    surface = 5.0 + np.clip(x / 2.0, 0.0, 10.0)
    mesh = MeshTri(np.stack((x, height * surface)), flat.t).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    soil = sc.MohrCoulomb(E=1e5, nu=0.3, c=10.0, phi=20.0)
    ground = sc.SolidForm(basis, soil, unit_weight=20.0)
    model = sc.Model({"ground": ground}, sc.box_supports(basis))
    result = model.run([sc.Stage("weight")])
    return result, model.strength_reduction(start=result, certify=False)


def _show_slope(out: Path) -> dict[str, str]:
    """Compute the slope, print its factor and write its files; return names and contents."""
    import matplotlib

    matplotlib.use("Agg")
    import skfem_contact.plot as plot

    result, safety = slope()
    print(f"{safety}\n")
    plot.set_units("kN", "m")
    result.report(out / "slope.html", title="A slope", searches={"weight": safety})
    plot.load_curve(safety, file=out / "curve.png")
    plot.set_units()
    return {
        "slope.html": "report with the mechanism, for a browser",
        "curve.png": "the way to the factor of safety",
    }


def _show_culvert(out: Path) -> dict[str, str]:
    """Compute the culvert, print its stages and write its files; return names and contents."""
    result = culvert().result
    written = {}
    for stage in result:
        stage.to_vtu(out / f"{stage.name}.vtu")
        content = f"displacements, stresses and contact of '{stage.name}', for ParaView"
        written[f"{stage.name}.vtu"] = content
    result.save(out / "culvert.npz")
    written["culvert.npz"] = "the whole result, for load_result"
    print(f"{result}\n")
    written |= _draw(result, out)
    if "culvert.png" not in written:
        print("No culvert.png: VTK cannot draw on this machine, it needs OpenGL.")
    return written


#: Analyses by their names: what they show, and how.
_SHOWN = {
    "culvert": ("a buried culvert under its own weight and a one-sided surcharge", _show_culvert),
    "slope": ("the factor of safety of a slope, and a report", _show_slope),
}


def _draw(result: sc.results.Result, out: Path) -> dict[str, str]:
    """Draw the pictures into a folder; return names of the files and their contents."""
    import matplotlib

    matplotlib.use("Agg")
    import skfem_contact.plot as plot

    plot.set_units("kN", "m")
    gravity, surcharge = result
    written = {}

    def diagram(name: str, title: str, unit: str, angle: ndarray, series: dict[str, Any]) -> None:
        plot.diagram(series, plot.labelled(title, unit), angle=angle, file=out / f"{name}.png")
        written[f"{name}.png"] = f"{title} around the pipe in both stages"

    skin = {stage.name: stage.tractions("skin") for stage in result}
    angle = skin["gravity"].central_angle()
    pressure = {name: points.pressure for name, points in skin.items()}
    shear = {name: points.shear for name, points in skin.items()}
    diagram("pressure", "contact pressure", "stress", angle, pressure)
    diagram("friction", "friction", "stress", angle, shear)

    cuts = sc.Cuts.ring((0.0, 0.0), 0.72, 0.90, n=72)
    ring = {stage.name: stage.section_forces("culvert", cuts) for stage in result}
    moment = {name: forces.M for name, forces in ring.items()}
    thrust = {name: -forces.N for name, forces in ring.items()}
    diagram("moment", "moment", "moment", cuts.position, moment)
    diagram("thrust", "thrust", "line", cuts.position, thrust)

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it is said below the list of files
        drawn = plot.contour(
            surcharge,
            "uy",
            since=gravity,
            deformed="auto",
            contact=True,
            loads=surcharge.load - gravity.load,
            file=out / "culvert.png",
        )
    if drawn:
        content = "settlement that the surcharge adds, and what the ground exerts on the pipe"
        written["culvert.png"] = content
    plot.set_units()
    return written


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the demonstration from the command line."""
    begin = perf_counter()
    shown = "; ".join(f"{name}: {text}" for name, (text, _) in _SHOWN.items())
    parser = argparse.ArgumentParser(
        prog="python -m skfem_contact.demo",
        description=f"Compute an analysis: tables, pictures and files. It can show {shown}.",
    )
    parser.add_argument(
        "name", nargs="?", default="culvert", choices=_SHOWN, help="default: %(default)s"
    )
    parser.add_argument(
        "--out", type=Path, help="folder for pictures and files (default: NAME_out)"
    )
    given = parser.parse_args(arguments)
    out = given.out or Path(f"{given.name}_out")
    if out.exists() and not out.is_dir():
        parser.error(f"--out {out} is a file, not a folder")
    out.mkdir(parents=True, exist_ok=True)

    text, show = _SHOWN[given.name]
    print(f"{text[0].upper()}{text[1:]}\n", flush=True)
    written = show(out)
    print(f"Written to {out}:")
    for name, content in written.items():
        print(f"  {name:16}{content}")
    seconds = perf_counter() - begin
    print(f"\nDone in {seconds:.1f} s. `python -m skfem_contact.demo NAME` also shows:")
    for name, (text, _) in _SHOWN.items():
        if name != given.name:
            print(f"  {name:16}{text}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
