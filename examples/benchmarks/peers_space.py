"""CalculiX and Kratos on the paraboloid in space, as peers to compare with: the same mesh, supports
and four steps.

CalculiX presses from surface to surface with a penalty of 50 E, Kratos by mortar elements with
augmented Lagrangian multipliers and a direct solver. Kratos runs in a process of its own, as this
module's main program, and counts its solution loop only.
"""

from __future__ import annotations

import importlib.util
import json
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from one_program import timed
from space_problems import MASTER, POISSON, SLAVE, YOUNG, Problem

STEPS = 4
#: From scikit-fem's numbers of the nodes of a brick to those around its bottom and its top.
AROUND = [0, 3, 6, 2, 1, 5, 7, 4]
#: CalculiX's numbers of the faces of a brick by their nodes there.
FACES = ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0))


class Run(NamedTuple):
    """Displacements at the end, (N,), or None where it failed; process time and number of linear
    systems.
    """

    x: ndarray | None
    cpu: float
    iterations: int


def available() -> list[str]:
    """Names of the peers that are there."""
    kratos = importlib.util.find_spec("KratosMultiphysics")  # to import it would print
    folder = (
        Path(kratos.origin).parent / "ContactStructuralMechanicsApplication"
        if kratos and kratos.origin
        else None
    )
    found = {
        "CalculiX": shutil.which("ccx") is not None,
        "Kratos": folder is not None and folder.is_dir(),
    }
    return [name for name, there in found.items() if there]


def run(name: str, problem: Problem) -> Run:
    """A peer with one thread, in a directory that is removed afterwards."""
    with tempfile.TemporaryDirectory() as folder:
        return {"CalculiX": _calculix, "Kratos": _kratos}[name](problem, Path(folder))


def _bricks(problem: Problem) -> ndarray:
    """Nodes of the elements, (n, 8), bottom before top."""
    return problem.basis.mesh.t.T[:, AROUND]


# -- CalculiX


def _calculix(problem: Problem, folder: Path) -> Run:
    (folder / "job.inp").write_text("\n".join(_deck(problem)) + "\n")
    done, cpu = timed(["ccx", "job"], folder)
    iterations = len(re.findall(r"^ *iteration +\d+", done.stdout, re.MULTILINE))
    if "Job finished" not in done.stdout or "*ERROR" in done.stdout:
        return Run(None, cpu, iterations)
    table = (
        line.split()
        for line in (folder / "job.dat").read_text().split("displacements")[-1].splitlines()
    )
    rows = np.array([row for row in table if len(row) == 4], dtype=float)
    x = problem.basis.zeros()
    x[problem.basis.nodal_dofs] = rows[np.argsort(rows[:, 0]), 1:].T
    return Run(x, cpu, iterations)


def _deck(problem: Problem) -> Iterator[str]:
    """Lines of CalculiX's input."""
    yield "*NODE,NSET=ALL"
    yield from (
        f"{i + 1},{x:.12g},{y:.12g},{z:.12g}" for i, (x, y, z) in enumerate(problem.basis.mesh.p.T)
    )
    yield "*ELEMENT,TYPE=C3D8,ELSET=BODIES"
    yield from (",".join(map(str, (e + 1, *nodes))) for e, nodes in enumerate(_bricks(problem) + 1))
    for name, boundary in (("SLAVE", SLAVE), ("MASTER", MASTER)):
        yield from (f"*SURFACE,NAME={name},TYPE=ELEMENT", *_faces(problem, boundary))
    yield from (
        "*MATERIAL,NAME=ELASTIC",
        "*ELASTIC",
        f"{YOUNG},{POISSON}",
        "*SOLID SECTION,ELSET=BODIES,MATERIAL=ELASTIC",
        "*SURFACE INTERACTION,NAME=CONTACT",
        "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR",
        f"{50 * YOUNG}",
        "*CONTACT PAIR,INTERACTION=CONTACT,TYPE=SURFACE TO SURFACE",
        "SLAVE,MASTER",
        "*STEP,INC=1000",
        "*STATIC",
        f"{1 / STEPS},1.,1e-6,{1 / STEPS}",
        "*BOUNDARY",
    )
    for dof in problem.fixed:
        yield f"{dof // 3 + 1},{dof % 3 + 1},{dof % 3 + 1},{problem.pressed[dof]:.12g}"
    yield from ("*NODE PRINT,NSET=ALL,FREQUENCY=1000", "U", "*END STEP")


def _faces(problem: Problem, boundary: str) -> list[str]:
    """Faces of the bricks on a boundary, as element and number of the face."""
    mesh = problem.basis.mesh
    facets = np.asarray(mesh.boundaries[boundary])
    nodes, elements = np.sort(mesh.facets[:, facets], axis=0).T, mesh.f2t[0, facets]
    own = np.sort(_bricks(problem)[elements][:, FACES], axis=2)
    return [
        f"{e + 1},S{i + 1}"
        for e, i in zip(elements, (own == nodes[:, None]).all(axis=2).argmax(axis=1), strict=True)
    ]


# -- Kratos


def _kratos(problem: Problem, folder: Path) -> Run:
    (folder / "model.mdpa").write_text("\n".join(_model(problem)) + "\n")
    (folder / "materials.json").write_text(
        json.dumps({"properties": [_elastic(body) for body in ("Lower", "Upper")]})
    )
    (folder / "parameters.json").write_text(json.dumps(_parameters(problem)))
    timed([sys.executable, str(Path(__file__).resolve())], folder)
    try:
        found = np.load(folder / "found.npz")
    except FileNotFoundError:
        return Run(None, 0.0, 0)
    x = problem.basis.zeros()
    x[problem.basis.nodal_dofs] = found["u"].T
    return Run(x, float(found["cpu"]), int(found["iterations"]))


def _supports(problem: Problem) -> dict[str, tuple[ndarray, list[bool], list[Any]]]:
    """Parts of the model by name: nodes, which of their displacements are held, and at what."""
    p, depth = problem.basis.mesh.p, -problem.pressed.min()
    sides = {
        "Left": (np.isclose(p[0], 0.0), [True, False, False]),
        "Front": (np.isclose(p[1], 0.0), [False, True, False]),
    }
    parts: dict[str, Any] = {
        name: (np.flatnonzero(on), held, [0.0 if h else None for h in held])
        for name, (on, held) in sides.items()
    }
    for name, height, value in (
        ("Bottom", p[2].min(), 0.0),
        ("Top", p[2].max(), f"{-depth:.12g}*t"),
    ):
        parts[name] = np.flatnonzero(np.isclose(p[2], height)), [True] * 3, [0.0, 0.0, value]
    return parts


def _model(problem: Problem) -> Iterator[str]:
    """Lines of Kratos' input."""
    mesh = problem.basis.mesh
    yield from (
        "Begin ModelPartData",
        "End ModelPartData",
        "Begin Properties 0",
        "End Properties",
        "Begin Properties 1",
        "End Properties",
        "Begin Nodes",
    )
    yield from (f"{i + 1} {x:.12g} {y:.12g} {z:.12g}" for i, (x, y, z) in enumerate(mesh.p.T))
    yield from ("End Nodes", "Begin Elements SmallDisplacementElement3D8N")
    yield from (
        " ".join(map(str, (e + 1, 1, *nodes))) for e, nodes in enumerate(_bricks(problem) + 1)
    )
    yield "End Elements"
    bodies = {name: mesh.subdomains[name.lower()] for name in ("Lower", "Upper")}
    touching = np.unique(
        np.concatenate([mesh.facets[:, mesh.boundaries[name]].ravel() for name in (MASTER, SLAVE)])
    )
    parts = {name: (np.unique(mesh.t[:, elements]), elements) for name, elements in bodies.items()}
    parts |= {name: (nodes, np.zeros(0, int)) for name, (nodes, _, _) in _supports(problem).items()}
    for name, (nodes, elements) in {**parts, "Touching": (touching, np.zeros(0, int))}.items():
        yield from (
            f"Begin SubModelPart {name}",
            "Begin SubModelPartNodes",
            *map(str, nodes + 1),
            "End SubModelPartNodes",
            "Begin SubModelPartElements",
            *map(str, elements + 1),
            "End SubModelPartElements",
            "End SubModelPart",
        )


def _elastic(body: str) -> dict[str, Any]:
    return {
        "model_part_name": f"Structure.{body}",
        "properties_id": 1,
        "Material": {
            "constitutive_law": {"name": "LinearElastic3DLaw"},
            "Tables": {},
            "Variables": {"DENSITY": 1.0, "YOUNG_MODULUS": YOUNG, "POISSON_RATIO": POISSON},
        },
    }


def _parameters(problem: Problem) -> dict[str, Any]:
    """Kratos' parameters: static, four steps, mortar contact with augmented Lagrangian
    multipliers.
    """
    supports = [
        {
            "python_module": "assign_vector_variable_process",
            "kratos_module": "KratosMultiphysics",
            "Parameters": {
                "model_part_name": f"Structure.{name}",
                "variable_name": "DISPLACEMENT",
                "constrained": held,
                "value": values,
                "interval": [0.0, "End"],
            },
        }
        for name, (_, held, values) in _supports(problem).items()
    ]
    contact = {
        "python_module": "alm_contact_process",
        "kratos_module": "KratosMultiphysics.ContactStructuralMechanicsApplication",
        "Parameters": {
            "model_part_name": "Structure",
            "assume_master_slave": {"0": ["Upper"]},
            "contact_model_part": {"0": ["Touching"]},
            "contact_type": "Frictionless",
        },
    }
    solver = {
        "solver_type": "Static",
        "model_part_name": "Structure",
        "domain_size": 3,
        "echo_level": 0,
        "analysis_type": "non_linear",
        "buffer_size": 3,
        "max_iteration": 30,
        "model_import_settings": {"input_type": "mdpa", "input_filename": "model"},
        "material_import_settings": {"materials_filename": "materials.json"},
        "contact_settings": {"mortar_type": "ALMContactFrictionless"},
        "convergence_criterion": "contact_residual_criterion",
        "time_stepping": {"time_step": 1 / STEPS},
        "displacement_relative_tolerance": 1e-4,
        "displacement_absolute_tolerance": 1e-9,
        "residual_relative_tolerance": 1e-5,
        "residual_absolute_tolerance": 1e-8,
        "linear_solver_settings": {"solver_type": "LinearSolversApplication.sparse_lu"},
    }
    return {
        "problem_data": {
            "problem_name": "job",
            "parallel_type": "OpenMP",
            "start_time": 0.0,
            "end_time": 1.0 - 1e-6,
            "echo_level": 0,
        },
        "solver_settings": solver,
        "processes": {"constraints_process_list": supports, "contact_process_list": [contact]},
    }


def _main() -> None:
    """Kratos in the current directory."""
    from time import process_time

    import KratosMultiphysics as kratos
    import KratosMultiphysics.ContactStructuralMechanicsApplication
    from KratosMultiphysics.StructuralMechanicsApplication.structural_mechanics_analysis import (
        StructuralMechanicsAnalysis,
    )

    iterations = []

    class Analysis(StructuralMechanicsAnalysis):  # type: ignore[misc]
        def FinalizeSolutionStep(self) -> None:
            super().FinalizeSolutionStep()
            iterations.append(
                self._GetSolver().GetComputingModelPart().ProcessInfo[kratos.NL_ITERATION_NUMBER]
            )

    model = kratos.Model()
    analysis = Analysis(model, kratos.Parameters(Path("parameters.json").read_text()))
    analysis.Initialize()
    begin = process_time()
    analysis.RunSolutionLoop()
    nodes = sorted(model["Structure"].Nodes, key=lambda node: node.Id)
    u = [
        [
            node.GetSolutionStepValue(kratos.KratosGlobals.GetVariable(f"DISPLACEMENT_{axis}"))
            for axis in "XYZ"
        ]
        for node in nodes
    ]
    np.savez("found.npz", u=u, cpu=process_time() - begin, iterations=sum(iterations))


if __name__ == "__main__":
    _main()
