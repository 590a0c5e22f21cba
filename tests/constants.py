"""Effect of the numbers that steer convergence: each is halved and doubled, and the iterations are
counted again.

Run from the root of the repository; it prints the table of docs/theory/constants.md::

    python -m tests.constants > docs/theory/constants.md
"""

from __future__ import annotations

import importlib
import math
import pkgutil
import re
import sys
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

import skfem_contact as sc
from skfem_contact.results import Result
from tests.nonlinear.test_iterations_on_record import SCENES as RECORD
from tests.nonlinear.test_iterations_on_record import ring
from tests.tools.helpers import grid, traction, vector_basis

ROOMS = ("nonlinear", "contact", "collapse", "solvers")
NAME = re.compile(r"_?[A-Z][A-Z_0-9]*$")


def limit() -> int:
    """A strip load on soil without dilation, to its limit."""
    basis = vector_basis(
        grid("Q1", np.linspace(0, 6, 19), np.linspace(-3, 0, 10)), "Q1", intorder=2
    )
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=20.0, psi=0.0)
    top, load = basis.get_dofs("top").all("u^2"), basis.zeros()
    load[top[basis.doflocs[0, top] < 1.1]] = -1.0
    fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    return (
        sc.Model({"soil": sc.SolidForm(basis, soil, strain="b_bar")}, fixed, solver="superlu")
        .limit_load(load)
        .iterations
    )


def two_bodies(
    gap: float, mu: float, penalty: float | None = None, **options: Any
) -> tuple[Any, ...]:
    base = grid("Q1", np.linspace(0, 4, 13), np.linspace(0, 1, 4))
    block = grid("Q1", np.linspace(1, 2.5, 8), np.linspace(1 + gap, 2 + gap, 6))
    basis = vector_basis(sc.join_bodies({"base": base, "block": block}), "Q1", intorder=2)
    forms = {
        "blocks": sc.SolidForm(basis, sc.LinearElastic(E=1e5, nu=0.3)),
        "joint": sc.ContactPair(
            basis,
            "block:bottom",
            "base:top",
            sc.Coulomb(mu),
            quadrature=2,
            penalty=penalty,
            **options,
        ),
    }
    return basis, forms, basis.get_dofs("base:bottom").all()


def count(result: Result) -> int:
    return sum(sum(stage.iterations) for stage in result)


def dropped() -> int:
    """A block that nothing but contact holds, above a gap, then pushed aside."""
    basis, forms, fixed = two_bodies(0.02, 0.4)
    weight, push = (
        sc.weight(basis, {"base": 0.0, "block": 20.0}),
        traction(basis, "block:left", (4.0, 0.0)),
    )
    return count(
        sc.Model(forms, fixed).run(
            [sc.Stage("weight", weight), sc.Stage("push", weight + push, increments=3)]
        )
    )


def hard() -> int:
    """Friction with a penalty a million times the stiffness."""
    basis, forms, fixed = two_bodies(0.0, 0.3, penalty=1e11)
    weight, push = (
        sc.weight(basis, {"base": 0.0, "block": 200.0}),
        traction(basis, "block:left", (60.0, 0.0)),
    )
    return count(
        sc.Model(forms, fixed).run(
            [sc.Stage("weight", weight), sc.Stage("push", weight + push, increments=2)]
        )
    )


def augmented() -> int:
    """The augmented method, pressed and unloaded."""
    basis, forms, fixed = two_bodies(0.0, 0.3, enforcement=sc.AugmentedLagrangian())
    weight = sc.weight(basis, {"base": 0.0, "block": 200.0})
    return count(
        sc.Model(forms, fixed).run([sc.Stage("weight", weight), sc.Stage("less", 0.3 * weight)])
    )


def interference() -> int:
    """A ring pressed into another one, its overlap resolved in steps, and turned."""
    mesh = sc.join_bodies({"pin": ring(0.5, 1.004, 48), "plate": ring(1.0, 2.0, 60)})
    around = {"skin": (1.001, 1.003), "hole": (0.997, 1.0), "rim": (1.9, 2.1), "bore": (0.4, 0.6)}
    mesh = mesh.with_boundaries(
        {
            name: lambda x, a=a, b=b: (a < np.hypot(*x)) & (np.hypot(*x) < b)
            for name, (a, b) in around.items()
        }
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    forms = {
        "steel": sc.SolidForm(basis, sc.LinearElastic(E=2e5, nu=0.3), strain="b_bar"),
        "joint": sc.ContactPair(
            basis, "skin", "hole", sc.Coulomb(mu=0.2), quadrature=2, initial="ramped"
        ),
    }
    bore = basis.get_dofs("bore").all()
    turned, x, y = basis.zeros(), basis.doflocs[0, bore], basis.doflocs[1, bore]
    turned[bore] = 0.01 * np.where(bore % 2 == 0, -y, x)
    fixed = np.append(basis.get_dofs("rim").all(), bore)
    stages = [
        sc.Stage("fit", basis.zeros()),
        sc.Stage("turn", basis.zeros(), prescribed=turned, increments=3),
    ]
    return count(sc.Model(forms, fixed).run(stages))


SCENES: dict[str, Callable[[], int]] = {
    **RECORD,
    "limit load": limit,
    "dropped": dropped,
    "hard penalty": hard,
    "augmented": augmented,
    "interference": interference,
}


def constants() -> Iterator[tuple[Any, str, float]]:
    """Modules, names and values of all numbers in capitals."""
    for room in ROOMS:
        package = importlib.import_module(f"skfem_contact.{room}")
        for found in pkgutil.walk_packages(package.__path__, f"skfem_contact.{room}."):
            module = importlib.import_module(found.name)
            text = Path(str(module.__file__)).read_text(encoding="utf-8")
            own = set(re.findall(r"^([^\n=#]*?)(?:: [\w\[\], .]+)? = ", text, re.MULTILINE))
            names = {name.strip() for line in own for name in line.split(",")}
            for name in sorted(vars(module)):
                value = getattr(module, name)
                if NAME.match(name) and name in names and isinstance(value, (int, float)):
                    yield module, name, value


def outcome(scene: Callable[[], int]) -> int | None:
    """Iterations, or None where it fails."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return scene()
        except (sc.NotConverged, ValueError):
            return None


def changed(new: dict[str, int | None], old: dict[str, int | None]) -> str:
    """What differs, for the table."""
    cells = {
        name: "fails" if n is None else f"{n - (old[name] or 0):+d}"
        for name, n in new.items()
        if n != old[name]
    }
    return "; ".join(f"{name}: {cell}" for name, cell in cells.items()) or "–"


def row(
    module: Any, name: str, value: float, old: dict[str, int | None]
) -> tuple[str, str, str, str]:
    """Name, value, and what changes where the number is halved and doubled."""
    cells = []
    for factor in (0.5, 2.0):
        new = factor * value
        setattr(module, name, type(value)(math.ceil(new)) if isinstance(value, int) else new)
        cells.append(changed({n: outcome(scene) for n, scene in SCENES.items()}, old))
        setattr(module, name, value)
    return (
        f"`{module.__name__.removeprefix('skfem_contact.')}.{name}`",
        f"{value:g}",
        cells[0],
        cells[1],
    )


HEAD = """# Numbers that steer convergence

The table lists how the iterations of small analyses change when a number is halved or doubled.
The analyses take these iterations with the numbers as they are:

| analysis | iterations |
|---|---|
{counts}

A dash means no change. In these analyses the numbers change the cost only. The exception is the
share of an interference that a step leaves: doubled it is one, and the analysis fails. The
analysis with the hard penalty alternates between states: 13 iterations fewer are one attempt
fewer. [Newton's method](newton.md) and [contact](contact.md) explain the numbers.
"""
REST = """
## Numbers without influence here

These numbers bound round-off, end attempts that fail, or choose a method by size. Halved and
doubled they change no iteration in these analyses.

| number | value |
|---|---|
"""


def main() -> None:
    """Print the page."""
    old = {name: outcome(scene) for name, scene in SCENES.items()}
    rows = [row(*constant, old) for constant in constants()]
    print(HEAD.format(counts="\n".join(f"| {name} | {n} |" for name, n in old.items())))
    print("| number | value | halved | doubled |\n|---|---|---|---|")
    for cells in rows:
        if cells[2:] != ("–", "–"):
            print("| " + " | ".join(cells) + " |")
    print(
        REST
        + "\n".join(f"| {name} | {value} |" for name, value, *cells in rows if cells == ["–", "–"])
    )


if __name__ == "__main__":
    sys.exit(main())
