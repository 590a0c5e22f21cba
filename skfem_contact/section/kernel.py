"""Gmsh: its import, a model of its own for each section, and curves of outlines."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy import ndarray

from ..arrays import row_norms
from ..checks import format_point
from .outline import Outline

#: Points that are nearer to each other are one point to Gmsh's geometry.
ONE_POINT = 1e-7


def load_gmsh() -> Any:
    """Import Gmsh, or say how to install it.

    Raises
    ------
    ImportError
        Gmsh is not installed, or a library of the system that it needs is missing.
    """
    try:
        import gmsh
    except ModuleNotFoundError as error:
        raise ImportError(
            'sections are meshed by Gmsh, which is not installed: pip install "skfem-contact[mesh]"'
        ) from error
    except OSError as error:  # its wheel links libraries of OpenGL and X that a server may lack
        raise ImportError(
            f"Gmsh is installed, but a library of the system is missing ({error}): install it, "
            "on Debian and Ubuntu with: apt install libglu1-mesa libxft2 libxinerama1 libxcursor1"
        ) from error
    return gmsh


@contextmanager
def gmsh_model() -> Iterator[Any]:
    """Yield Gmsh with an empty model, which is removed at the end; a user's session remains."""
    gmsh = load_gmsh()
    # Keep the state of a Gmsh that is in use.
    began = bool(gmsh.isInitialized())
    if not began:
        gmsh.initialize(readConfigFiles=False, interruptible=False)
    before = ""
    if began:
        before = gmsh.model.getCurrent()
    options = {name: gmsh.option.getNumber(name) for name in _OPTIONS}
    # Set our options in a model of our own.
    try:
        for name, value in _OPTIONS.items():
            gmsh.option.setNumber(name, value)
        gmsh.model.add("skfem_contact section")
        yield gmsh
    finally:
        gmsh.model.remove()
        for name, value in options.items():
            gmsh.option.setNumber(name, value)
        if began:
            gmsh.model.mesh.removeSizeCallback()
            gmsh.model.setCurrent(before)
        else:
            gmsh.finalize()


#: One thread and a fixed seed, so that a section has the same mesh in every run; sizes come from
#: the section alone.
_OPTIONS = {
    "General.Terminal": 0,
    "General.NumThreads": 1,
    "Mesh.RandomSeed": 1,
    "Mesh.Algorithm": 5,
    "Mesh.MeshSizeExtendFromBoundary": 1,
    "Mesh.MeshSizeFromPoints": 0,
    "Mesh.MeshSizeFromCurvature": 0,
    "Mesh.LcIntegrationPrecision": 1e-3,
    "Mesh.MeshSizeMin": 0.0,
    "Mesh.MeshSizeMax": 1e22,
    "Mesh.MeshSizeFactor": 1.0,
    "Mesh.ElementOrder": 1,
    "Mesh.SecondOrderIncomplete": 0,
    "Mesh.HighOrderOptimize": 0,
    "Mesh.RecombineAll": 0,
    "Mesh.SubdivisionAlgorithm": 0,
    "Mesh.SaveAll": 0,
}


def nodes_of(gmsh: Any) -> tuple[ndarray, ndarray]:
    """Return the coordinates of the nodes of the current mesh, (n, 2), and their rows by tag."""
    tags, x, _ = gmsh.model.mesh.getNodes()
    row = np.zeros(int(tags.max()) + 1, int)
    row[tags.astype(int)] = np.arange(len(tags))
    return np.reshape(x, (-1, 3))[:, :2], row


def add_curves(occ: Any, outline: Outline, shift: Any) -> list[int]:
    """Add the segments and arcs of an outline, moved by a shift, and return their numbers."""
    lengths = row_norms(np.subtract(*outline.ends))
    for point, length in zip(outline.points, lengths):
        if length <= ONE_POINT:
            raise ValueError(
                f"two points of '{outline.name}' near {format_point(point)} are {length:.2g} "
                f"apart: let them be one, or keep a distance of more than {ONE_POINT:.2g}"
            )
    corners = [occ.addPoint(*(point - shift), 0.0) for point in outline.points]
    curves = []
    for k, (t, centre) in enumerate(zip(outline.bulges, outline.centres - shift)):
        a = corners[k]
        b = corners[(k + 1) % len(corners)]
        if not t:
            curves.append(occ.addLine(a, b))
            continue
        # Turn the first point about the centre to the middle of the arc, by half of its angle
        arm = complex(*(outline.points[k] - shift - centre))
        half = np.exp(2j * np.arctan(t)) * arm
        middle = occ.addPoint(*np.add(centre, (half.real, half.imag)), 0.0)
        curves.append(occ.addCircleArc(a, middle, b, center=False))
        occ.remove([(0, middle)])
    return curves


def add_face(occ: Any, outline: Outline, shift: Any) -> int:
    """Add the face that an outline encloses, moved by a shift, and return its number."""
    return int(occ.addPlaneSurface([occ.addCurveLoop(add_curves(occ, outline, shift))]))
