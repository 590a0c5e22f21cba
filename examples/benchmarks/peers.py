"""CalculiX on the problems of this chapter, as a peer to compare with.

Its elements of plane strain do not come with its best contact, so that one layer of bricks is
computed whose nodes do not move across the plane: the same displacements with three times the
unknowns.
"""

from __future__ import annotations

import re
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from contact_problems import LOWER, NU, UPPER, E, Problem
from numpy import ndarray
from one_program import timed

import skfem_contact as sc

SURFACE_TO_SURFACE, NODE_TO_SURFACE = "SURFACE TO SURFACE", "NODE TO SURFACE"
PENALTY = 50 * E  # CalculiX's manual: 5 to 50 times E


@dataclass(frozen=True)
class Run:
    """What CalculiX reached.

    Attributes
    ----------
    steps
        Displacements at the end of each stage, (N,) each; none where it failed.
    cpu
        Its process time in seconds.
    iterations
        Number of linear systems.
    """

    steps: tuple[ndarray, ...]
    cpu: float
    iterations: int

    @property
    def x(self) -> ndarray | None:
        """Displacements at the end, or None where it failed."""
        return self.steps[-1] if self.steps else None


def available() -> bool:
    """Whether there is a CalculiX on the path."""
    return shutil.which("ccx") is not None


def calculix(
    problem: Problem, stages: Sequence[sc.Stage], mu: float, method: str = SURFACE_TO_SURFACE
) -> Run:
    """Run stages with one thread in a directory that is removed afterwards.

    Parameters
    ----------
    problem
        Bodies of four-node quadrilaterals with their supports.
    stages
        Stages, of which increments and prescribed displacements count.
    mu
        Coefficient of friction.
    method
        :data:`SURFACE_TO_SURFACE` or :data:`NODE_TO_SURFACE`.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "job.inp").write_text("\n".join(_deck(problem, stages, mu, method)) + "\n")
        done, cpu = timed(["ccx", "job"], folder)
        good = "Job finished" in done.stdout and "*ERROR" not in done.stdout
        printed = (folder / "job.dat").read_text().split("displacements")[1:] if good else ()
    steps = tuple(_displacements(problem, table) for table in printed)
    return Run(steps, cpu, len(re.findall(r"^ *iteration +\d+", done.stdout, re.MULTILINE)))


def _deck(problem: Problem, stages: Sequence[sc.Stage], mu: float, method: str) -> Iterator[str]:
    """Lines of CalculiX's input."""
    mesh = problem.basis.mesh
    n, quads = mesh.p.shape[1], _counterclockwise(mesh.p, mesh.t)
    yield "*NODE,NSET=ALL"
    for layer in (0, 1):
        yield from (
            f"{i + 1 + layer * n},{x:.12g},{y:.12g},{layer}" for i, (x, y) in enumerate(mesh.p.T)
        )
    yield "*ELEMENT,TYPE=C3D8,ELSET=BODIES"
    for e, nodes in enumerate(quads.T + 1):
        yield ",".join(map(str, (e + 1, *nodes, *(nodes + n))))
    slave = _faces(mesh, quads, UPPER)
    if method == NODE_TO_SURFACE:
        yield "*NSET,NSET=FACE"
        yield from (
            f"{i + 1}" for i in np.unique(mesh.facets[:, mesh.boundaries[UPPER]] + [[[0]], [[n]]])
        )
        yield from ("*SURFACE,NAME=SLAVE,TYPE=NODE", "FACE")
    else:
        yield from ("*SURFACE,NAME=SLAVE,TYPE=ELEMENT", *slave)
    yield from ("*SURFACE,NAME=MASTER,TYPE=ELEMENT", *_faces(mesh, quads, LOWER))
    yield from ("*MATERIAL,NAME=ELASTIC", "*ELASTIC", f"{E},{NU}")
    yield "*SOLID SECTION,ELSET=BODIES,MATERIAL=ELASTIC"
    yield from (
        "*SURFACE INTERACTION,NAME=CONTACT",
        "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR",
    )
    yield f"{PENALTY}" + (",0." if method == NODE_TO_SURFACE else "")
    if mu:
        yield from ("*FRICTION", f"{mu},{PENALTY}")
    yield from (
        f"*CONTACT PAIR,INTERACTION=CONTACT,TYPE={method}",
        "SLAVE,MASTER",
        "*BOUNDARY",
        "ALL,3,3,0.",
    )
    for stage in stages:
        size = 1 / stage.increments
        yield from ("*STEP,INC=1000", "*STATIC", f"{size},1.,1e-6,{size}", "*BOUNDARY")
        for dof in problem.fixed:
            for layer in (0, n):
                component = dof % 2 + 1
                yield f"{dof // 2 + 1 + layer},{component},{component},{stage.prescribed[dof]:.12g}"
        yield from ("*NODE PRINT,NSET=ALL,FREQUENCY=1000", "U", "*END STEP")


def _counterclockwise(p: ndarray, t: ndarray) -> ndarray:
    """Quadrilaterals turned the way CalculiX wants them."""
    a, b = p[:, t[2]] - p[:, t[0]], p[:, t[3]] - p[:, t[1]]
    return np.where(a[0] * b[1] - a[1] * b[0] > 0, t, t[::-1])


def _faces(mesh, quads: ndarray, boundary: str) -> list[str]:
    """Faces of the bricks along a boundary; the one from a brick's node i to the next has the
    number 3 + i.
    """
    facets = mesh.boundaries[boundary]
    elements = mesh.f2t[0, facets]
    ends = np.sort(np.stack((quads[:, elements], np.roll(quads[:, elements], -1, axis=0))), axis=0)
    side = (ends == np.sort(mesh.facets[:, facets], axis=0)[:, None]).all(axis=0).argmax(axis=0)
    return [f"{e + 1},S{3 + i}" for e, i in zip(elements, side)]


def _displacements(problem: Problem, printed: str) -> ndarray:
    """Displacements of the first layer from one of CalculiX's tables."""
    n = problem.basis.mesh.p.shape[1]
    table = [line.split() for line in printed.splitlines()]
    rows = np.array([row for row in table if len(row) == 4], dtype=float)
    rows = rows[np.argsort(rows[:, 0])][:n]
    x = problem.basis.zeros()
    x[problem.basis.nodal_dofs] = rows[:, 1:3].T
    return x
