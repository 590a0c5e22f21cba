"""OpenGeoSys on the consolidation of this chapter, as a peer to compare with.

Quadratic displacements, linear pressures, Euler's backward method, its direct solver, and one
iteration a step, as many as a linear problem needs.
"""

from __future__ import annotations

import sys
import tempfile
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import meshio
import numpy as np
from numpy import ndarray
from one_program import timed
from skfem import CellBasis


@dataclass(frozen=True)
class Layer:
    """Elastic ground and its water.

    Attributes
    ----------
    basis
        Six-node triangles with their boundaries.
    E, nu
        Elasticity of the ground.
    mobility
        Permeability over the unit weight of water.
    held
        Components of the displacement that boundaries hold.
    drained
        Boundary without pressure.
    loaded, load
        Boundary under a vertical load, and this, negative downwards.
    """

    basis: CellBasis
    E: float
    nu: float
    mobility: float
    held: Mapping[str, Sequence[int]]
    drained: str
    loaded: str
    load: float


def available() -> bool:
    """Whether OpenGeoSys is installed beside this Python."""
    return _program().exists()


def consolidate(
    layer: Layer, steps: Sequence[float], counts: Sequence[int]
) -> tuple[list[ndarray], float]:
    """Displacements and, behind them, pressures after each number of equal steps but the first; its
    process time.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        _write_meshes(layer, folder)
        ET.ElementTree(_project(layer, steps, counts)).write(folder / "job.prj")
        done, cpu = timed([_program(), "-o", ".", "-l", "error", "job.prj"], folder)
        if done.returncode:
            raise RuntimeError(f"OpenGeoSys failed: {(done.stdout + done.stderr)[:500]}")
        found = [meshio.read(folder / f"job_{k}.vtu").point_data for k in np.cumsum(counts)[1:]]
    vertices = layer.basis.mesh.p.shape[1]
    return [
        np.append(data["displacement"][:, :2], data["pressure"].ravel()[:vertices])
        for data in found
    ], cpu


def _program() -> Path:
    return Path(sys.executable).with_name("ogs")


def _write_meshes(layer: Layer, folder: Path) -> None:
    """The ground, and its boundaries with the numbers of their nodes in it."""
    basis, mesh = layer.basis, layer.basis.mesh
    middles = mesh.p.shape[1] + np.arange(mesh.facets.shape[1])
    points = np.vstack(
        (np.hstack((mesh.p, mesh.p[:, mesh.facets].mean(axis=1))), np.zeros(basis.N // 2))
    )
    triangles = np.vstack((mesh.t, middles[mesh.t2f])).T
    clockwise = np.linalg.det(mesh.p[:, mesh.t[1:]].T - mesh.p[:, mesh.t[:1]].T) < 0
    triangles[clockwise] = triangles[clockwise][:, [0, 2, 1, 5, 4, 3]]
    meshio.Mesh(
        points.T,
        {"triangle6": triangles},
        cell_data={"MaterialIDs": [np.zeros(len(triangles), np.int32)]},
    ).write(folder / "ground.vtu")
    for name in {*layer.held, layer.drained, layer.loaded}:
        facets = np.asarray(mesh.boundaries[name])
        nodes, lines = np.unique(
            np.vstack((mesh.facets[:, facets], middles[facets])).T, return_inverse=True
        )
        meshio.Mesh(
            points.T[nodes],
            {"line3": lines.reshape(-1, 3)},
            point_data={"bulk_node_ids": nodes.astype(np.uint64)},
        ).write(folder / f"{name}.vtu")


def _project(layer: Layer, steps: Sequence[float], counts: Sequence[int]) -> ET.Element:
    """OpenGeoSys' input; names of parameters tell their values."""
    held = [
        {"mesh": name, "type": "Dirichlet", "component": c, "parameter": "zero"}
        for name, components in layer.held.items()
        for c in components
    ]
    load = {"mesh": layer.loaded, "type": "Neumann", "component": 1, "parameter": "load"}
    drained = {"mesh": layer.drained, "type": "Dirichlet", "component": 0, "parameter": "zero"}
    constants = {"E": layer.E, "nu": layer.nu, "zero": 0.0, "load": layer.load}
    fluid, solid = {"viscosity": 1.0, "density": 1.0}, {"density": 1.0}
    medium = {
        "porosity": 0.5,
        "biot_coefficient": 1.0,
        "reference_temperature": 293.15,
        "permeability": layer.mobility,
    }
    process = {
        "name": "HM",
        "type": "HYDRO_MECHANICS",
        "integration_order": 2,
        "constitutive_relation": {
            "type": "LinearElasticIsotropic",
            "youngs_modulus": "E",
            "poissons_ratio": "nu",
        },
        "process_variables": {"displacement": "displacement", "pressure": "pressure"},
        "specific_body_force": "0 0",
    }
    in_time = {
        "nonlinear_solver": "newton",
        "convergence_criterion": {
            "type": "PerComponentDeltaX",
            "norm_type": "NORM2",
            "reltols": "1e9 1e9 1e9",
        },
        "time_discretization": {"type": "BackwardEuler"},
        "time_stepping": {
            "type": "FixedTimeStepping",
            "t_initial": 0.0,
            "t_end": float(np.dot(steps, counts)),
            "timesteps": {
                "pair": [
                    {"repeat": k, "delta_t": float(step)}
                    for k, step in zip(counts, steps, strict=True)
                ]
            },
        },
    }
    output = {
        "type": "VTK",
        "prefix": "job",
        "suffix": "_{:timestep}",
        "data_mode": "Ascii",
        "timesteps": {"pair": [{"repeat": 1, "each_steps": k} for k in counts]},
        "variables": {"variable": ["displacement", "pressure"]},
    }
    variables = [
        {
            "name": "displacement",
            "components": 2,
            "order": 2,
            "initial_condition": "still",
            "boundary_conditions": {"boundary_condition": [*held, load]},
        },
        {
            "name": "pressure",
            "components": 1,
            "order": 1,
            "initial_condition": "zero",
            "boundary_conditions": {"boundary_condition": drained},
        },
    ]
    loop = ET.Element("time_loop")
    _add(ET.SubElement(loop, "processes"), "process", in_time).set("ref", "HM")
    _add(loop, "output", output)
    root = ET.Element("OpenGeoSysProject")
    _add(
        root,
        "meshes",
        {
            "mesh": [
                f"{name}.vtu" for name in ("ground", *{*layer.held, layer.drained, layer.loaded})
            ]
        },
    )
    _add(root, "processes", {"process": process})
    _add(
        root,
        "media",
        {
            "medium": {
                "phases": {
                    "phase": [
                        {"type": "AqueousLiquid", "properties": _properties(fluid)},
                        {"type": "Solid", "properties": _properties(solid)},
                    ]
                },
                "properties": _properties(medium),
            }
        },
    )
    root.append(loop)
    _add(
        root,
        "parameters",
        {
            "parameter": [
                {"name": name, "type": "Constant", "value": value}
                for name, value in constants.items()
            ]
            + [{"name": "still", "type": "Constant", "values": "0 0"}]
        },
    )
    _add(root, "process_variables", {"process_variable": variables})
    _add(
        root,
        "nonlinear_solvers",
        {
            "nonlinear_solver": {
                "name": "newton",
                "type": "Newton",
                "max_iter": 4,
                "linear_solver": "direct",
            }
        },
    )
    _add(
        root,
        "linear_solvers",
        {"linear_solver": {"name": "direct", "eigen": {"solver_type": "SparseLU"}}},
    )
    return root


def _properties(values: Mapping[str, float]) -> dict:
    return {
        "property": [
            {"name": name, "type": "Constant", "value": value} for name, value in values.items()
        ]
    }


def _add(parent: ET.Element, name: str, value: object) -> ET.Element:
    """Elements of this name with a text, with elements of their own, or one for each item of a
    list.
    """
    for item in value if isinstance(value, list) else [value]:
        element = ET.SubElement(parent, name)
        if isinstance(item, Mapping):
            for key, inner in item.items():
                _add(element, key, inner)
        else:
            element.text = str(item)
    return element
