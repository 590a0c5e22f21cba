"""Analyses that show what the package does: ``python -m skfem_contact.demo --out culvert_out``, and
``... slope``.
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
    """Basis, forms (ground, culvert and the skin between them), weight (N,) and result of two
    stages.
    """

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
    soils = {
        "soft": sc.MohrCoulomb(E=1e4, nu=0.40, c=5.0, phi=25.0),
        "stiff": sc.MohrCoulomb(E=5e4, nu=0.35, c=10.0, phi=35.0),
    }
    concrete = sc.LinearElastic(E=2.8e7, nu=0.2)
    weights = {"soft": 18.0, "stiff": 20.0}
    model = sc.Model(
        {
            "ground": sc.SolidForm(
                basis.with_elements("ground"), soils, strain="b_bar", unit_weight=weights
            ),
            "culvert": sc.SolidForm(
                basis.with_elements("culvert"), concrete, strain="b_bar", unit_weight=25.0
            ),
            "skin": sc.ContactPair(
                basis,
                slave="ground|culvert",
                master="culvert|ground",
                law=sc.Coulomb(mu=0.6),
                quadrature="nodal",
                smoothing=0.5,
                initial="adjusted",
            ),
        },
        sc.box_supports(basis),
    )
    strip = sc.traction(
        basis, "surface", lambda x: (0.0 * x[0], -35.0 * (x[0] > 0.0) * (x[0] < 1.8))
    )
    result = model.run([sc.Stage("gravity"), sc.Stage("surcharge", strip)])
    return Culvert(basis, model.forms, result["gravity"].load, result)


def slope() -> tuple[sc.results.Result, Any]:
    """Run a slope of 10 m on 5 m of ground, 1 in 2, and return its weight's stage and its factor of
    safety.

    It is example 2 of Griffiths and Lane (1999), whose factor is 1.4. Units are kN and m.

    Examples
    --------
    >>> from skfem_contact.demo import slope
    >>> f"{slope()[1].factor:.1f}"
    '1.4'
    """
    x = np.concatenate(
        (np.linspace(-20, 0, 9), np.linspace(0, 20, 13)[1:], np.linspace(20, 32, 7)[1:])
    )
    mesh = MeshTri.init_tensor(x, np.linspace(0, 1, 9))
    surface = 5.0 + np.clip(mesh.p[0] / 2.0, 0.0, 10.0)
    mesh = MeshTri(np.stack((mesh.p[0], mesh.p[1] * surface)), mesh.t).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    soil = sc.MohrCoulomb(E=1e5, nu=0.3, c=10.0, phi=20.0)
    model = sc.Model(
        {"ground": sc.SolidForm(basis, soil, unit_weight=20.0)}, sc.box_supports(basis)
    )
    result = model.run([sc.Stage("weight")])
    return result, model.strength_reduction(start=result, certify=False)


def _show_slope(out: Path) -> dict[str, str]:
    """Compute the slope, print its factor and write its files; return their names and contents."""
    import matplotlib

    matplotlib.use("Agg")
    import skfem_contact.plot as plot

    result, found = slope()
    print(f"{found}\n")
    plot.set_units("kN", "m")
    result.report(out / "slope.html", title="A slope", searches={"weight": found})
    plot.load_curve(found, file=out / "curve.png")
    plot.set_units()
    return {
        "slope.html": "report with the mechanism, for a browser",
        "curve.png": "the way to the factor of safety",
    }


def _show_culvert(out: Path) -> dict[str, str]:
    """Compute the culvert, print its stages and write its files; return their names and
    contents.
    """
    result = culvert().result
    for stage in result:
        stage.to_vtu(out / f"{stage.name}.vtu")
    result.save(out / "culvert.npz")
    print(f"{result}\n")
    written = (
        {
            f"{stage.name}.vtu": f"displacements, stresses and contact of '{stage.name}', for "
            f"ParaView"
            for stage in result
        }
        | {"culvert.npz": "the whole result, for load_result"}
        | _draw(result, out)
    )
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
    cuts = sc.Sections.ring((0.0, 0.0), 0.72, 0.90, n=72)
    skin = {stage.name: stage.tractions("skin") for stage in result}
    ring = {stage.name: stage.section_forces("culvert", cuts) for stage in result}
    angle = skin["gravity"].central_angle()
    diagrams = {
        "pressure": (
            "contact pressure",
            "stress",
            angle,
            {name: points.pressure for name, points in skin.items()},
        ),
        "friction": (
            "friction",
            "stress",
            angle,
            {name: points.shear for name, points in skin.items()},
        ),
        "moment": (
            "moment",
            "moment",
            cuts.position,
            {name: forces.M for name, forces in ring.items()},
        ),
        "thrust": (
            "thrust",
            "line",
            cuts.position,
            {name: -forces.N for name, forces in ring.items()},
        ),
    }
    written = {}
    for name, (title, unit, position, series) in diagrams.items():
        plot.diagram(series, plot.labelled(title, unit), angle=position, file=out / f"{name}.png")
        written[f"{name}.png"] = f"{title} around the pipe in both stages"
    gravity, surcharge = result["gravity"], result["surcharge"]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it is said below the list of files
        if plot.contour(
            surcharge,
            "uy",
            since=gravity,
            deformed="auto",
            contact=True,
            loads=surcharge.load - gravity.load,
            file=out / "culvert.png",
        ):
            written["culvert.png"] = (
                "settlement that the surcharge adds, and what the ground exerts on the pipe"
            )
    plot.set_units()
    return written


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the demonstration from the command line."""
    begin = perf_counter()
    parser = argparse.ArgumentParser(
        prog="python -m skfem_contact.demo",
        description="Compute an analysis: tables, pictures and files. It can show "
        + "; ".join(f"{name}: {text}" for name, (text, _) in _SHOWN.items())
        + ".",
    )
    parser.add_argument(
        "name", nargs="?", default="culvert", choices=_SHOWN, help="default: %(default)s"
    )
    parser.add_argument(
        "--out", type=Path, help="folder for pictures and files (default: NAME_out)"
    )
    given = parser.parse_args(arguments)
    out, (text, show) = given.out or Path(f"{given.name}_out"), _SHOWN[given.name]
    if out.exists() and not out.is_dir():
        parser.error(f"--out {out} is a file, not a folder")
    out.mkdir(parents=True, exist_ok=True)

    print(f"{text[0].upper()}{text[1:]}\n", flush=True)
    written = show(out)
    print(f"Written to {out}:")
    for name, content in written.items():
        print(f"  {name:16}{content}")
    print(
        f"\nDone in {perf_counter() - begin:.1f} s. `python -m skfem_contact.demo NAME` also shows:"
    )
    for name, (text, _) in _SHOWN.items():
        if name != given.name:
            print(f"  {name:16}{text}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
