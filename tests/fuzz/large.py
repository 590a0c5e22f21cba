"""Bodies of finite kinematics that are turned, pushed, drawn, folded, or squeezed and let go."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy import ndarray
from skfem import (
    Basis,
    ElementQuad1,
    ElementQuad2,
    ElementTriP2,
    ElementVector,
    Mesh,
    MeshQuad,
    MeshTri,
)

import skfem_contact as sc
from skfem_contact.results import Result, StageResult

from .cases import Case, Check
from .oracles import BALANCE

E = 1e3
#: Inner radius of a strip that is folded.
INNER = 0.3
KINDS = {"Q1": (MeshQuad, ElementQuad1), "Q2": (MeshQuad, ElementQuad2)}
KINDS["P2"] = (MeshTri, ElementTriP2)
LAWS = {
    "elastic": sc.LinearElastic(E, 0.3),
    "rubber": sc.NeoHooke(E, 0.45),
    "clay": sc.Tresca(E, 0.45, c=20.0),
    "sand": sc.MohrCoulomb(E, 0.3, c=5.0, phi=30.0, psi=5.0),
}
TASKS = ("turn", "push", "draw", "squeeze", "fold")


@dataclass(frozen=True)
class Body:
    """A block of width and height, with its mesh and its law, and what is done to it."""

    task: str
    element: str
    law: str
    width: float
    height: float
    n: int
    seed: int
    angle: float
    strain: float
    mu: float

    def __str__(self) -> str:
        return (
            f"{self.task} a block {self.width:.2f} by {self.height:.2f} of {self.law}, "
            f"{self.element}, {self.n} elements, angle {self.angle:.2f}, strain {self.strain:.2f}, "
            f"mu {self.mu:.2f}"
        )

    def mesh(self) -> Mesh:
        """Grid whose inner nodes are moved at random."""
        lines = np.linspace(0.0, self.width, self.n + 1), np.linspace(0.0, self.height, self.n + 1)
        grid = KINDS[self.element][0].init_tensor(*lines)
        inner = np.setdiff1d(np.arange(grid.nvertices), grid.boundary_nodes())
        p = grid.p.copy()
        size = min(self.width, self.height) / self.n
        shift = np.random.default_rng(self.seed).uniform(-0.15, 0.15, (2, len(inner)))
        p[:, inner] += size * shift
        return type(grid)(p, grid.t).with_defaults()

    def solid(self) -> sc.SolidForm:
        """Body of finite kinematics."""
        basis = Basis(self.mesh(), ElementVector(KINDS[self.element][1]()), intorder=4)
        return sc.SolidForm(basis, LAWS[self.law], kinematics="finite")


def large(seed: int, rng: np.random.Generator) -> Case:
    """Draw a body and what is done to it."""
    body = Body(
        task=TASKS[int(rng.integers(len(TASKS)))],
        element=str(rng.choice(list(KINDS))),
        law=str(rng.choice(list(LAWS))),
        width=float(rng.uniform(0.7, 2.0)),
        height=float(rng.uniform(0.7, 1.5)),
        n=int(rng.integers(2, 5)),
        seed=seed,
        angle=float(rng.uniform(-2.0, 2.0) * np.pi),
        strain=float(rng.uniform(0.05, 0.3)),
        mu=float(rng.uniform(0.05, 0.4)),
    )
    tasks = {"turn": _turned, "fold": _folded}
    return Case(seed, str(body), partial(tasks.get(body.task, _pressed), body))


def _common(stage: StageResult, fixed: ndarray, least: float = 0.0) -> Iterator[Check]:
    """Forces that are assembled again balance, and no element has turned inside out.

    They are compared to themselves, and to the least force that counts.
    """
    answers = [form.assemble(stage.x, stage.states[name]) for name, form in stage.forms.items()]
    left = stage.load - sum(answer.force for answer in answers)
    left[fixed] = 0.0
    largest = max(least, *(np.linalg.norm(answer.force) for answer in answers))
    round_off = sum(np.linalg.norm(answer.round_off) for answer in answers)
    yield Check("large balance", np.linalg.norm(left) / largest, BALANCE + round_off / largest)
    basis = stage.forms["body"].basis
    gradient = np.asarray(basis.interpolate(stage.x[: basis.N]).grad)
    F = gradient + np.eye(2)[:, :, None, None]
    least = (F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0]).min()
    yield Check("large inversion", max(-least, 0.0), 0.0)


def _turned(body: Body) -> Iterator[Check]:
    """A strained block that its sides turn has the turned stresses."""
    solid = body.solid()
    basis = solid.basis
    fixed = basis.get_dofs().all()
    x = basis.doflocs
    strain = body.strain * np.array([[1.0, 0.5], [0.0, -0.6]])

    def moved(angle: float) -> ndarray:
        c, s = np.cos(angle), np.sin(angle)
        place = np.array([[c, -s], [s, c]]) @ (np.eye(2) + strain)
        u = basis.zeros()
        for i in range(2):
            there = place[i, 0] * x[0, i::2] + place[i, 1] * x[1, i::2]
            u[i::2] = there - x[i, i::2]
        return u

    stages = [
        sc.Stage("strain", prescribed=moved(0.0), increments=4),
        sc.Stage("turn", prescribed=lambda share: moved(share * body.angle), increments=12),
    ]
    newton = sc.Newton(tolerance=1e-10, max_iterations=25)
    result = sc.Model({"body": solid}, fixed, newton=newton).run(stages, progress=False)
    for stage in result:
        yield from _common(stage, fixed)
    before, after = (solid.cauchy(stage.states["body"]) for stage in result)
    c, s = np.cos(body.angle), np.sin(body.angle)
    xx, yy, zz, xy = before
    right = np.stack(
        (
            c * c * xx + s * s * yy - 2 * c * s * xy,
            s * s * xx + c * c * yy + 2 * c * s * xy,
            zz,
            c * s * (xx - yy) + (c * c - s * s) * xy,
        )
    )
    # laws that flow see round-off of the turned strains as strain
    yield Check("large turn", np.abs(after - right).max() / np.abs(before).max(), 1e-7)


def _pressed(body: Body) -> Iterator[Check]:
    """A block is pressed on rigid ground, drawn along it, and let go."""
    solid = body.solid()
    basis = solid.basis
    ground = sc.rigid.polyline([(-20.0, 0.0), (20.0, 0.0)])
    law = sc.Coulomb(body.mu if body.task == "draw" else 0.0)
    pair = sc.ContactPair(basis, "bottom", ground, law, penalty=20.0 * E * body.n)
    top = basis.get_dofs("top").all()
    down = basis.zeros()
    down[basis.get_dofs("top").all("u^2")] = -body.strain * body.height
    along = down.copy()
    along[basis.get_dofs("top").all("u^1")] = body.width * body.angle / np.pi
    stages = [sc.Stage("press", prescribed=down, increments=6, keep="all")]
    if body.task == "draw":
        stages.append(sc.Stage("draw", prescribed=along, increments=16))
    if body.task == "squeeze":
        stages.append(sc.Stage("back", prescribed=basis.zeros(), increments=6, keep="all"))
    newton = sc.Newton(tolerance=1e-10, max_iterations=25)
    model = sc.Model({"body": solid, "ground": pair}, top, newton=newton)
    result = model.run(stages, progress=False)
    for stage in result:
        yield from _common(stage, top)
        yield from _on_ground(body, stage, top)
    yield from _energy(body, result, top)


def _hairpin(body: Body) -> Mesh:
    """Strip of two arms along x and a half circle between them; its chain is anticlockwise."""
    bend, n_arm = 12, 4 + 2 * body.n
    n = 2 * n_arm + bend
    grid = MeshQuad.init_tensor(np.linspace(0.0, 1.0, n + 1), np.linspace(0.0, 1.0, 3))
    k = np.rint(grid.p[0] * n)
    radius = INNER + 0.2 * body.height * grid.p[1]
    angle = 0.5 * np.pi + np.pi * np.clip((k - n_arm) / bend, 0.0, 1.0)
    along = np.maximum(1.0 - k / n_arm, 0.0) + np.maximum((k - n + n_arm) / n_arm, 0.0)
    x = radius * np.cos(angle) * (along == 0.0) + 1.5 * body.width * along
    mesh = MeshQuad(np.stack((x, radius * np.sin(angle))), grid.t[[0, 3, 2, 1]])
    if body.element == "P2":
        mesh = mesh.to_meshtri()
    outer = INNER + 0.2 * body.height - 1e-6
    far = 1.2 * body.width
    mesh = mesh.with_boundaries(
        {
            "upper": lambda x: (x[0] > far) & (x[1] > outer),
            "lower": lambda x: (x[0] > far) & (x[1] < -outer),
        }
    )
    return mesh.with_boundaries({"skin": mesh.boundary_facets()})


def _folded(body: Body) -> Iterator[Check]:
    """A hairpin is pinched until its arms touch each other, and opened again."""
    basis = Basis(_hairpin(body), ElementVector(KINDS[body.element][1]()), intorder=4)
    mu = body.mu if body.law in ("clay", "sand") else 0.0
    forms = {
        "body": sc.SolidForm(basis, LAWS[body.law], kinematics="finite"),
        "fold": sc.ContactPair(basis, "skin", "skin", sc.Coulomb(mu)),
    }
    ends = np.concatenate([basis.get_dofs(name).all() for name in ("upper", "lower")])
    up, down = (basis.get_dofs(name).all("u^2") for name in ("upper", "lower"))
    stages = []
    for gap in (0.3, 0.1, 0.01, -0.1 * body.strain, 0.02, 0.2, 2.0 * INNER):
        u = basis.zeros()
        u[up], u[down] = 0.5 * gap - INNER, INNER - 0.5 * gap
        stages.append(sc.Stage(f"{gap:.3f}", prescribed=u, increments=2))
    newton = sc.Newton(tolerance=1e-10, max_iterations=25)
    result = sc.Model(forms, ends, newton=newton).run(stages, progress=False)
    reactions = [stage.reactions()[ends] for stage in result]
    largest = max(np.abs(reaction).max() for reaction in reactions)
    for stage, reaction in zip(result, reactions, strict=True):
        yield from _common(stage, ends, 1e-3 * largest)
        left = np.abs(reaction.reshape(-1, 2).sum(axis=0)).max()
        yield Check("large fold", left / largest, 1e-7)
    if body.law in ("elastic", "rubber"):
        yield Check("large unfolded", np.abs(reactions[-1]).max() / largest, 1e-7)


def _on_ground(body: Body, stage: StageResult, top: ndarray) -> Iterator[Check]:
    """The ground resists what the top presses, and no more shear than friction."""
    reactions = stage.reactions()
    shear, normal = stage.contact("ground").force
    size = max(np.abs(reactions[top]).sum(), 1e-2 * E * body.width)
    left = reactions[top].reshape(-1, 2).sum(axis=0) + np.array([shear, normal])
    yield Check("large action", np.abs(left).max() / size, 1e-7)
    if normal > 1e-6 * E:
        yield Check("large friction", max(abs(shear) / normal - body.mu, 0.0), 1e-6)


def _energy(body: Body, result: Result, top: ndarray) -> Iterator[Check]:
    """What is elastic comes back without stress; a cycle takes work or leaves none."""
    if body.task != "squeeze":
        return
    largest = np.abs(result["press"].states["body"].stress).max()
    if body.law in ("elastic", "rubber"):
        left = np.abs(result["back"].states["body"].stress).max()
        # the tolerance of the balance over the stiffness of a block that hangs at its top
        yield Check("large cycle", left / largest, 1e-7)
    # Work of the top by the trapezoidal rule, which errs by a hundredth of the work there.
    work = [0.0]
    x, force = np.zeros(len(top)), np.zeros(len(top))
    for stage in result:
        for part in stage.increments:
            reaction = part.reactions()[top]
            work.append(work[-1] + 0.5 * float((reaction + force) @ (part.x[top] - x)))
            x, force = part.x[top], reaction
    yield Check("large work", -work[-1] / max(work), 0.02)
