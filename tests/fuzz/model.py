"""From a scene to what `run` takes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy import ndarray
from skfem import (
    Basis,
    ElementHex1,
    ElementQuad1,
    ElementQuad2,
    ElementTetP1,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
    Mesh,
    MeshHex,
    MeshQuad,
    MeshTet,
    MeshTri,
)

import skfem_contact as sc
from skfem_contact.loads import Domain
from skfem_contact.results import Result

from .frames import Frame
from .scenes import STRAIN, Scene

#: Height of a body, and modulus of the base.
HEIGHT, MODULUS = 0.6, 1e4
#: Weight of a body's volume, small beside what the path does.
WEIGHT = 0.1 * STRAIN * MODULUS
_PLANE = {
    "Q1": (MeshQuad, ElementQuad1),
    "Q2": (MeshQuad, ElementQuad2),
    "P1": (MeshTri, ElementTriP1),
    "P2": (MeshTri, ElementTriP2),
}
_SPACE = {"Q1": (MeshHex, ElementHex1), "P1": (MeshTet, ElementTetP1)}


@dataclass(frozen=True)
class Model:
    """A scene in a frame, ready to be analysed."""

    forms: dict[str, sc.Form]
    stages: list[sc.Stage]
    fixed: ndarray
    frame: Frame

    def run(self, stages: Sequence[sc.Stage] | None = None, start: Result | None = None) -> Result:
        """The analysis, to a residual that the comparisons do not see."""
        newton = sc.Newton(tolerance=1e-10, max_iterations=25)
        return sc.Model(self.forms, self.fixed, newton=newton).run(
            list(stages or self.stages), start=start, progress=False
        )


def build(scene: Scene, frame: Frame) -> Model:
    """The model of a scene as it is written down in a frame."""
    drawn = _basis(scene, _mesh(scene))
    basis = _basis(scene, _in_frame(drawn.mesh, frame))
    held = drawn.get_dofs("block:top" if scene.rigid else "base:bottom").all()
    if scene.displaced:
        held = np.union1d(held, drawn.get_dofs("block:top").all())
    elif scene.rigid:
        held = np.zeros(0, int)
    if scene.kind == "axisymmetric":
        held = np.union1d(held, drawn.get_dofs(lambda p: p[0] < 1e-9).all("u^1"))
    forms = _solids(scene, basis, frame) | _contact(scene, basis, frame)
    return Model(forms, _stages(scene, drawn, frame), held, frame)


# -- meshes


def _mesh(scene: Scene) -> Mesh:
    """The bodies, apart: y, or z, is up, and the interface is near zero."""
    axial = scene.kind == "axisymmetric"
    left, right = (0.0, 1.5) if axial else (-0.4, 1.4)
    bodies = (
        {} if scene.rigid else {"base": _body(scene, scene.lower, (left, right), -HEIGHT, 2, True)}
    )
    bodies["block"] = _body(
        scene, scene.upper, (0.0, 1.0), scene.fit, 1 if scene.dim == 3 else 2, False
    )
    if scene.built == "cap":
        bodies["cap"] = _grid(scene, scene.upper + 1, (0.0, 1.0), scene.fit + HEIGHT, 1)
    mesh = sc.join_bodies(bodies)
    if scene.built == "pit":
        middle = mesh.p[:, mesh.t].mean(axis=1)
        base = np.isin(np.arange(mesh.nelements), mesh.subdomains["base"])
        pit = base & (middle[0] > 0.9) & (middle[1] < -0.5 * HEIGHT)
        mesh = mesh.with_subdomains(
            {"pit": np.flatnonzero(pit), "rest": np.flatnonzero(base & ~pit)}
        )
    return mesh


def _body(
    scene: Scene, n: int, ends: tuple[float, float], bottom: float, layers: int, low: bool
) -> Mesh:
    """A block whose upper, or lower, side is the interface."""
    mesh = _grid(scene, n, ends, bottom, layers)
    share = (mesh.p[-1] - bottom) / HEIGHT
    p = mesh.p.copy()
    p[-1] += (share if low else 1.0 - share) * interface(scene, p)
    return replace(mesh, doflocs=p)


def interface(scene: Scene, p: ndarray) -> ndarray:
    """Height of the interface above places."""
    height, waves, phase = scene.wave
    across = 0.5 * p[1] if scene.dim == 3 else 0.0
    return height * np.sin(waves * (p[0] + across) + phase) + scene.slope * (p[0] - across)


def _grid(scene: Scene, n: int, ends: tuple[float, float], bottom: float, layers: int) -> Mesh:
    """A tensor grid with named sides."""
    lines = [np.linspace(*ends, n + 1)] * (scene.dim - 1) + [
        np.linspace(bottom, bottom + HEIGHT, layers + 1)
    ]
    mesh = (_SPACE if scene.dim == 3 else _PLANE)[scene.element][0].init_tensor(*lines)
    sides = {"bottom": bottom, "top": bottom + HEIGHT}
    return mesh.with_boundaries(
        {name: lambda p, z=z: np.isclose(p[-1], z) for name, z in sides.items()}
    )


def _in_frame(mesh: Mesh, frame: Frame) -> Mesh:
    return replace(mesh, doflocs=frame.places(mesh.doflocs))


def _basis(scene: Scene, mesh: Mesh) -> Basis:
    element = (_SPACE if scene.dim == 3 else _PLANE)[scene.element][1]
    return Basis(mesh, ElementVector(element()), intorder=4 if scene.element in ("Q2", "P2") else 2)


# -- forms


def _solids(scene: Scene, basis: Basis, frame: Frame) -> dict[str, sc.Form]:
    solid = partial(sc.SolidForm, strain="b_bar" if scene.b_bar else "full", coordinates=scene.kind)
    stiff = sc.LinearElastic(E=scene.stiffer * MODULUS * frame.stress, nu=0.25)
    soil = _soil(scene, frame)
    parts = {"base": soil, "block": stiff, "cap": stiff, "pit": soil, "rest": soil}
    there = [
        name
        for name in basis.mesh.subdomains
        if name in parts and not (name == "base" and scene.built == "pit")
    ]
    return {name: solid(basis.with_elements(name), parts[name]) for name in there}


def _soil(
    scene: Scene, frame: Frame
) -> sc.LinearElastic | sc.MohrCoulomb | sc.Tresca | sc.DruckerPrager:
    """The base's material; its strength is near what the path asks for."""
    E, nu, c = MODULUS * frame.stress, 0.3, 0.3 * STRAIN * MODULUS * frame.stress
    if scene.soil == "MohrCoulomb":
        return sc.MohrCoulomb(E=E, nu=nu, c=c, phi=30.0, psi=10.0)
    if scene.soil == "Tresca":
        return sc.Tresca(E=E, nu=nu, c=2.0 * c)
    if scene.soil == "DruckerPrager":
        return sc.DruckerPrager(E=E, nu=nu, k=c, alpha=0.15, beta=0.05)
    return sc.LinearElastic(E=E, nu=nu)


def _contact(scene: Scene, basis: Basis, frame: Frame) -> dict[str, sc.Form]:
    strength = STRAIN * MODULUS * frame.stress
    law = (
        sc.Tied()
        if scene.law is None
        else sc.Coulomb(scene.law[0], *(strength * v for v in scene.law[1:]))
    )
    options = {
        "quadrature": scene.quadrature,
        "initial": scene.initial,
        "smoothing": scene.smoothing,
        "enforcement": sc.AugmentedLagrangian() if scene.augmented else None,
        "penalty": None
        if scene.penalty is None
        else scene.penalty * MODULUS * frame.stress / (HEIGHT * frame.length),
    }
    names = ("base:top", "block:bottom") if scene.swapped else ("block:bottom", "base:top")
    if scene.both_ways:
        forms = dict(sc.ContactPair.two_pass(basis, *names, law, **options))
    else:
        master = _floor(scene, frame) if scene.rigid else names[1]
        forms = {"joint": sc.ContactPair(basis, names[0], master, law, **options)}
    if scene.built == "cap":
        forms["seat"] = sc.ContactPair(
            basis, "cap:bottom", "block:top", sc.Coulomb(0.5), scene.quadrature
        )
    return forms


def _floor(scene: Scene, frame: Frame):
    """A rigid floor of the interface's form; its free side stays the same in the mirror."""
    x = np.linspace(-0.5, 1.5, 6)
    points = frame.places(np.stack((x, interface(scene, x[None]))))
    mirror = np.linalg.det(frame.matrix) < 0.0
    return sc.rigid.polyline((points[:, ::-1] if mirror else points).T)


# -- stages


def _stages(scene: Scene, drawn: Basis, frame: Frame) -> list[sc.Stage]:
    """The path, and what is built or dug at its end."""
    forces = partial(frame.forces, power=2 if scene.kind != "plane" else 1)
    domain = Domain(drawn, scene.kind)
    bodies = [name for name in ("base", "block") if name in drawn.mesh.subdomains]
    own = sc.weight(domain, dict.fromkeys(bodies, WEIGHT))
    stages = []
    for k, (at, increments) in enumerate(zip(scene.path, scene.increments, strict=True)):
        load, x = own, None
        if scene.displaced:
            x = frame.displacements(_led(drawn, HEIGHT * STRAIN * np.array(at)))
        else:
            load = own + sc.traction(domain, "block:top", STRAIN * MODULUS * np.array(at))
        stages.append(sc.Stage(str(k), forces(load), x, increments))
    if scene.built == "cap":
        load = load + sc.weight(domain, {"cap": WEIGHT})
        stages.append(sc.Stage("cap", forces(load), None, 1, activate=("cap", "seat")))
    if scene.built == "pit":
        load = load - sc.weight(domain, {"pit": WEIGHT})
        stages.append(sc.Stage("pit", forces(load), None, 2, deactivate="pit"))
    return stages


def _led(basis: Basis, to: ndarray) -> ndarray:
    """Displacements that are given at the top of the block."""
    x = basis.zeros().reshape(-1, len(to))
    x[basis.get_dofs("block:top").all("u^1") // len(to)] = to
    return x.ravel()
