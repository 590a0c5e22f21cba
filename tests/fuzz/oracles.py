"""What must hold in every accepted stage, told by other means than those that found it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from numpy import ndarray

import skfem_contact as sc
from skfem_contact.contact.laws import Status
from skfem_contact.results import Result, StageResult

from .model import HEIGHT, Model
from .scenes import Scene


class Finding(NamedTuple):
    """By how much something does not hold, and by how much it may not."""

    oracle: str
    stage: str
    error: float
    tolerance: float

    def __str__(self) -> str:
        return f"{self.oracle} in stage '{self.stage}': {self.error:.1e} > {self.tolerance:.1e}"

    @property
    def holds(self) -> bool:
        """NaN does not."""
        return bool(self.error <= self.tolerance)


#: Round-off of what is computed twice in the same way.
SAME = 1e-9
#: Share of a facet by which a point may lie beyond its end: it keeps the facet that it had up to a
#: share of .01, and surfaces go on beyond their rim for a share of .05.
_BEYOND = 0.06
#: Residual of forces that are assembled again: ten times what Newton's method was asked for.
BALANCE = 1e-9


def of_stage(scene: Scene, model: Model, result: Result, k: int) -> Iterator[Finding]:
    """Everything that must hold in a stage of a result by itself."""
    stage = result[k]
    for oracle in ORACLES:
        for error, tolerance in oracle(scene, model, stage, result[k - 1] if k else None):
            yield Finding(oracle.__name__, stage.name, float(error), tolerance)


Errors = Iterator[tuple[float, float]]


def equilibrium(
    scene: Scene, model: Model, stage: StageResult, before: StageResult | None
) -> Errors:
    """Forces that are assembled again from the accepted states balance."""
    forces = [form.assemble(stage.x, stage.states[name]) for name, form in stage.forms.items()]
    left = stage.load - sum(answer.force for answer in forces)
    there = [
        form.basis.element_dofs.ravel()
        for form in stage.forms.values()
        if isinstance(form, sc.SolidForm)
    ]
    # a stage that stops while a body is dug out goes on releasing it, at nodes of that body alone,
    # too
    left[np.union1d(model.fixed, np.setdiff1d(np.arange(len(left)), np.concatenate(there)))] = 0.0
    largest = max(np.linalg.norm(stage.load), *(np.linalg.norm(answer.force) for answer in forces))
    # contact says how much its coordinates' round-off leaves
    yield (
        np.linalg.norm(left) / largest,
        BALANCE + sum(answer.round_off for answer in forces) / largest,
    )


def stresses(scene: Scene, model: Model, stage: StageResult, before: StageResult | None) -> Errors:
    """Internal forces are the integral of the stresses over the gradients of scikit-fem's shape
    functions.
    """
    for name, form in stage.forms.items():
        if isinstance(form, sc.SolidForm) and not scene.b_bar:
            force = form.assemble(stage.x, stage.states[name]).force
            other = _internal(scene, form, stage.states[name].stress)
            yield np.abs(force - other).max() / (np.abs(force).max() or 1.0), SAME


def _internal(scene: Scene, form: sc.SolidForm, stress: ndarray) -> ndarray:
    basis, dim = form.basis, scene.dim
    places = (
        [(0, 0), (1, 1), (0, 1)] if dim == 2 else [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)]
    )
    rows = [0, 1, 3] if dim == 2 else range(6)
    sigma = np.zeros((dim, dim, *stress.shape[1:]))
    for (i, j), row in zip(places, rows, strict=True):
        sigma[i, j] = sigma[j, i] = stress[row]
    radius = np.asarray(basis.global_coordinates())[0] if scene.kind == "axisymmetric" else None
    force = np.zeros(basis.N)
    for b in range(basis.Nbfun):
        shape = basis.basis[b][0]
        density = np.einsum(
            "ijeq,ijeq->eq", sigma, np.broadcast_to(np.asarray(shape.grad), sigma.shape)
        )
        if radius is not None:
            density = density * radius + stress[2] * np.asarray(shape)[0]
        np.add.at(force, basis.element_dofs[b], (density * basis.dx).sum(axis=1))
    return force


def action(scene: Scene, model: Model, stage: StageResult, before: StageResult | None) -> Errors:
    """Forces of contact between two bodies have no resultant, and no moment where the bodies
    are.
    """
    for name, pair in _pairs(stage):
        if (pair.facets.dofs < 0).any():
            continue  # a rigid obstacle's share is not among the forces
        f = pair.assemble(stage.x, stage.states[name]).force.reshape(-1, scene.dim)
        total = np.abs(f).sum() or 1.0
        yield np.abs(f.sum(axis=0)).max() / total, SAME
        places = _places(pair.size, pair, stage.x, scene.dim)
        arm = np.abs(places).max()
        moment = np.einsum("ni,nj->ij", places, f)
        yield np.abs(moment - moment.T).max() / (arm * total), SAME


def _places(n: int, pair: sc.ContactPair, x: ndarray, dim: int) -> ndarray:
    """Where the nodes of both surfaces are, from the middle of the slave, (n / dim, dim); others at
    zero.
    """
    places, middle = np.zeros((n // dim, dim)), pair.slave.nodes.mean(axis=0)
    for surface in (pair.slave, pair.facets):
        at = surface.dofs[:, 0] // dim
        places[at] = surface.nodes + x.reshape(-1, dim)[at] - middle
    return places


def friction(scene: Scene, model: Model, stage: StageResult, before: StageResult | None) -> Errors:
    """Shear lies within Coulomb's cone, and points that slip lie on it."""
    for name, pair in _pairs(stage):
        if not isinstance(pair.law, sc.Coulomb):
            continue
        state = stage.states[name]
        shear = np.linalg.norm(state.traction[1:], axis=0)
        broken = (state.internal[0] if len(state.internal) else 0.0) != 0.0
        bears = np.where(broken, 0.0, pair.law.adhesion) + pair.law.mu * np.maximum(
            -state.traction[0], 0.0
        )
        closed, largest = (
            state.status != Status.OPEN,
            np.abs(state.traction).max(initial=0.0) or 1.0,
        )
        yield (shear - bears)[closed].max(initial=0.0) / largest, SAME
        sliding = state.status == Status.SLIP
        yield np.abs(shear - bears)[sliding].max(initial=0.0) / largest, SAME


def complementarity(
    scene: Scene, model: Model, stage: StageResult, before: StageResult | None
) -> Errors:
    """Open points carry nothing; closed ones carry no more tension than they may; nothing is deep
    inside.
    """
    for name, pair in _pairs(stage):
        state = stage.states[name]
        is_open = state.status == Status.OPEN
        largest = np.abs(state.traction).max(initial=0.0) or 1.0
        yield np.abs(state.traction[:, is_open]).max(initial=0.0) / largest, 0.0
        if isinstance(pair.law, sc.Coulomb):
            yield (state.traction[0] - pair.law.tension)[~is_open].max(initial=0.0) / largest, SAME
            near = (
                is_open
                & np.isfinite(state.gap)
                & (state.gap > -pair.interface.depth(pair.points(state)))
            )
            closing = pair.points(state).at(state.multiplier[0]) / pair.penalties(state)[0]
            inside = (state.clearance - closing - state.gap)[near].max(initial=0.0)
            yield inside / (HEIGHT * model.frame.length), 1e-9  # beyond the coordinates' round-off


def closest(scene: Scene, model: Model, stage: StageResult, before: StageResult | None) -> Errors:
    """Gaps of closed points are distances from the displaced master, by trying every facet."""
    for name, pair in _pairs(stage):
        if scene.smoothing is not None or scene.element in ("Q2", "P2"):
            continue
        if scene.dim == 3 and scene.quadrature == "segments":
            continue  # points on pieces stay on the facet that their piece faces
        state, x = stage.states[name], stage.x
        points = pair.points(state).positions(pair.slave.positions(x))
        corners = pair.facets.positions(x)[pair.facets.facets]
        distance = _distance if scene.dim == 2 else _distance_in_space
        nearest, beyond = (distance(points, corners, by) for by in (0.0, _BEYOND))
        gap, closed = np.abs(state.gap), state.status != Status.OPEN
        error = np.maximum(gap - nearest, beyond - gap)[closed].max(initial=0.0)
        # at joints that turn by less than a degree it keeps its facet though the next one is
        # nearer, by this
        yield error / pair.facets.size.max(), 0.01 * np.sin(np.radians(1.0))


def _distance(points: ndarray, corners: ndarray, beyond: float) -> ndarray:
    """Distance from the nearest facet, each longer by a share of it at both ends."""
    a, along = corners[:, 0], corners[:, 1] - corners[:, 0]
    share = np.einsum("nfc,fc->nf", points[:, None] - a, along) / (along**2).sum(axis=1)
    foot = a + np.clip(share, -beyond, 1.0 + beyond)[..., None] * along
    return np.linalg.norm(points[:, None] - foot, axis=2).min(axis=1)


def _distance_in_space(points: ndarray, corners: ndarray, beyond: float) -> ndarray:
    """The same of triangles and bilinear facets: places around the best one so far are tried, ever
    closer to it.
    """
    step = np.stack(np.meshgrid(*[np.arange(-2.0, 3.0)] * 2), axis=-1).reshape(-1, 2) / 4
    best, size = (
        np.full((len(points), len(corners), 2), 1 / 3 if corners.shape[1] == 3 else 0.5),
        1.0,
    )
    for _ in range(40):
        u = np.clip(best[:, :, None] + size * step, -beyond, 1.0 + beyond)
        if corners.shape[1] == 3:  # back onto the third side
            over = np.maximum(u.sum(axis=-1, keepdims=True) - 1.0 - beyond, 0.0)
            u = np.clip(u - 0.5 * over, -beyond, 1.0 + beyond)
            shapes = np.stack((1 - u.sum(axis=-1), u[..., 0], u[..., 1]), axis=-1)
        else:
            low, high = 1 - u, u
            shapes = np.stack(
                (
                    low[..., 0] * low[..., 1],
                    high[..., 0] * low[..., 1],
                    high[..., 0] * high[..., 1],
                    low[..., 0] * high[..., 1],
                ),
                axis=-1,
            )
        distance = np.linalg.norm(
            points[:, None, None] - np.einsum("nfsk,fkc->nfsc", shapes, corners), axis=-1
        )
        at = distance.argmin(axis=-1)[..., None, None]
        best, size = np.take_along_axis(u, at, axis=2)[:, :, 0], 0.6 * size
    return distance.min(axis=(1, 2))


def yielding(scene: Scene, model: Model, stage: StageResult, before: StageResult | None) -> Errors:
    """Stresses do not lie beyond the yield function."""
    for name, form in stage.forms.items():
        if not isinstance(form, sc.SolidForm):
            continue
        for region in form.regions:
            stress = stage.states[name].stress[:, region.elements]
            beyond = _beyond(region.material)
            if beyond is not None:
                yield (
                    beyond(stress).max() / np.abs(stress).max(),
                    1e-8,
                )  # of the return to an apex or an edge


def _beyond(material: object) -> Callable[[ndarray], ndarray] | None:
    """Yield function, in stresses."""

    def principal(stress: ndarray) -> ndarray:
        sigma = np.zeros((*stress.shape[1:], 3, 3))
        for i, j, row in ((0, 0, 0), (1, 1, 1), (2, 2, 2), (0, 1, 3), (1, 2, 4), (0, 2, 5))[
            : len(stress)
        ]:
            sigma[..., i, j] = sigma[..., j, i] = stress[row]
        return np.linalg.eigvalsh(sigma)

    if isinstance(material, sc.MohrCoulomb):
        phi = np.radians(material.phi)
        return lambda s: (
            (p := principal(s))[..., 2]
            - p[..., 0]
            + (p[..., 2] + p[..., 0]) * np.sin(phi)
            - 2.0 * material.c * np.cos(phi)
        )
    if isinstance(material, sc.Tresca):
        return lambda s: (p := principal(s))[..., 2] - p[..., 0] - 2.0 * material.c
    if isinstance(material, sc.DruckerPrager):
        return lambda s: (
            (np.sqrt(0.5 * (principal(s - s[:3].mean(axis=0) * _unit(s)) ** 2).sum(axis=-1)))
            + material.alpha * s[:3].sum(axis=0)
            - material.k
        )
    return None


def dissipation(
    scene: Scene, model: Model, stage: StageResult, before: StageResult | None
) -> Errors:
    """Plastic strain does work on the stress; a step of one increment tells."""
    if before is None or len(stage.iterations) != 1 or stage.fraction < 1.0:
        return
    for name, form in stage.forms.items():
        if not isinstance(form, sc.SolidForm) or name not in before.states:
            continue
        new, old = stage.states[name], before.states[name]
        for region in form.regions:
            at = (slice(None), region.elements)
            D = np.asarray(region.material.elasticity(len(new.stress)))
            elastic = np.linalg.solve(D, (new.stress - old.stress)[at].reshape(len(D), -1))
            flow = (new.strain - old.strain)[at].reshape(len(D), -1) - elastic
            work = (new.stress[at].reshape(len(D), -1) * flow).sum(axis=0)
            energy = np.abs(new.stress[at]).max() * np.abs(new.strain[at]).max()
            yield -work.min() / energy, SAME


def _unit(stress: ndarray) -> ndarray:
    """The unit tensor beside an array of stresses."""
    return np.array([1.0, 1.0, 1.0, *[0.0] * (len(stress) - 3)])[:, None, None]


def _pairs(stage: StageResult) -> Iterator[tuple[str, sc.ContactPair]]:
    for name, form in stage.forms.items():
        if isinstance(form, sc.ContactPair):
            yield name, form


ORACLES = (equilibrium, stresses, action, friction, complementarity, closest, yielding, dissipation)
