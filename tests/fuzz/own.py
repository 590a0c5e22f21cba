"""Forms, laws and materials of a user's own beside a block: they must act as what they are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy import ndarray
from scipy.optimize import root
from scipy.sparse import csr_matrix
from skfem import (
    Basis,
    BilinearForm,
    ElementQuad1,
    ElementQuad2,
    ElementVector,
    FacetBasis,
    MeshQuad,
)
from skfem.models.elasticity import lame_parameters, linear_elasticity

import skfem_contact as sc
from skfem_contact.materials.base import Update

from .cases import Case, Check

E, NU, SIZE = 1e4, 0.3, 20.0


class Cushion(sc.Form):
    """Supports whose force grows with the cube of the displacement, with the largest one as their
    state.
    """

    symmetric = True

    def __init__(self, dofs: ndarray, size: int, linear: float, cubic: float) -> None:
        self.dofs, self.size, self.linear, self.cubic = dofs, size, linear, cubic

    def initial_state(self, x: ndarray | None = None) -> ndarray:
        return np.zeros(len(self.dofs))

    def assemble(self, x: ndarray, state: ndarray) -> sc.Response:
        u, force, slope = x[self.dofs], np.zeros(self.size), np.zeros(self.size)
        force[self.dofs] = self.linear * u + self.cubic * u**3
        slope[self.dofs] = self.linear + 3 * self.cubic * u**2
        at = np.arange(self.size)
        return sc.Response(
            force, lambda: np.maximum(state, abs(u)), lambda: csr_matrix((slope, (at, at)))
        )


class Average(sc.Form):
    """Mean displacement of dofs that a multiplier holds at a value: a field of its own."""

    symmetric = True

    def __init__(self, basis: Basis, dofs: ndarray, value: float) -> None:
        self.dofs, self.value = dofs, value
        self.fields = (sc.Field("mean", basis.mesh.p[:, :1], "multiplier", E),)

    def numbered(self, numbers):
        self.own = int(numbers[self.fields[0]][0])
        return self

    def assemble(self, x: ndarray, state: None) -> sc.Response:
        row = np.zeros(len(x))
        row[self.dofs] = 1.0 / len(self.dofs)
        force = row * x[self.own]
        force[self.own] = row @ x - self.value
        K = np.zeros((len(x), len(x)))
        K[self.own], K[:, self.own] = row, row
        return sc.Response(force, lambda: None, lambda: csr_matrix(K))


class Duck(sc.Form):
    """Linear supports without any role."""

    def __init__(self, K: csr_matrix) -> None:
        self.K = K

    def assemble(self, x: ndarray, state: None) -> sc.Response:
        return sc.Response(self.K @ x[: self.K.shape[0]], lambda: None, lambda: self.K)

    def initial_state(self, x: ndarray | None = None) -> None:
        return None


@dataclass(frozen=True, eq=False)
class Stiffening(sc.Material):
    """Elastic material written anew, to be compared with that of the package."""

    E: float
    nu: float

    def elasticity(self, ncomp: int) -> ndarray:
        mu, lam = (
            0.5 * self.E / (1 + self.nu),
            self.E * self.nu / ((1 + self.nu) * (1 - 2 * self.nu)),
        )
        D = np.zeros((ncomp, ncomp))
        D[:3, :3] = lam
        return D + np.diag([2 * mu] * 3 + [mu] * (ncomp - 3))

    def update(self, strain_increment: ndarray, stress: ndarray, internal: ndarray) -> Update:
        D = self.elasticity(len(stress))
        stress = stress + np.einsum("ij,j...->i...", D, strain_increment)
        return Update(stress, internal, np.zeros(0, int), lambda: np.zeros((0, len(D), len(D))))


def own(seed: int, rng: np.random.Generator) -> Case:
    """Block with supports of one's own."""
    look = [matrix, cushion, average, material][int(rng.integers(4))]
    return Case(seed, f"own form, {look.__name__}", partial(look, np.random.default_rng(seed)))


def _block(rng: np.random.Generator) -> Basis:
    x, y = (
        np.linspace(0, rng.uniform(1, 3), int(rng.integers(2, 7))),
        np.linspace(0, 1, int(rng.integers(2, 5))),
    )
    element = ElementQuad2() if rng.random() < 0.4 else ElementQuad1()
    return Basis(MeshQuad.init_tensor(x, y).with_defaults(), ElementVector(element), intorder=4)


def _elastic(basis: Basis) -> csr_matrix:
    return linear_elasticity(*lame_parameters(E, NU)).assemble(basis)


def _loads(rng: np.random.Generator, basis: Basis) -> list[ndarray]:
    return [
        SIZE * sc.traction(basis, "top", rng.uniform(-1, 1, 2))
        + sc.weight(basis, rng.uniform(0, 20))
        for _ in range(3)
    ]


def matrix(rng: np.random.Generator) -> Iterator[Check]:
    """Subgrade of scikit-fem below the block, as a matrix form and as a class that derives from
    nothing.
    """
    basis, k = _block(rng), E * 10 ** rng.uniform(-1, 1, 2)
    below = FacetBasis(basis.mesh, basis.elem, facets="bottom", intorder=4)
    K = BilinearForm(lambda u, v, w: k[0] * u[0] * v[0] + k[1] * u[1] * v[1]).assemble(below)
    form = sc.MatrixForm(K) if rng.random() < 0.5 else Duck(K)
    loads = _loads(rng, basis)
    model = sc.Model(
        {"block": sc.SolidForm(basis, sc.LinearElastic(E, NU)), "subgrade": form},
        newton=sc.Newton(tolerance=1e-11),
    )
    result = model.run([sc.Stage(str(i), load) for i, load in enumerate(loads)], progress=False)
    for stage, load in zip(result, loads):
        exact = np.linalg.solve((K + _elastic(basis)).toarray(), load)
        yield Check("subgrade", float(np.abs(stage.x - exact).max() / np.abs(exact).max()), 1e-8)


def cushion(rng: np.random.Generator) -> Iterator[Check]:
    """Supports with a cubic law: the equilibrium of scipy's root of the same equations."""
    basis = _block(rng)
    bottom = basis.get_dofs("bottom").all()
    form = Cushion(bottom, basis.N, 0.1 * E, E * 10 ** rng.uniform(1, 5))
    K, loads = _elastic(basis), _loads(rng, basis)
    model = sc.Model(
        {"block": sc.SolidForm(basis, sc.LinearElastic(E, NU)), "cushion": form},
        newton=sc.Newton(tolerance=1e-11),
    )
    result = model.run([sc.Stage(str(i), load) for i, load in enumerate(loads)], progress=False)
    largest = np.zeros(len(bottom))
    for stage, load in zip(result, loads):
        found = root(
            lambda x, f=load: K @ x + form.assemble(x, bottom).force - f,
            0.9 * stage.x,
            jac=lambda x: K.toarray() + form.assemble(x, bottom).stiffness.toarray(),
            tol=1e-12,
        )
        yield Check("cushion", float(np.abs(stage.x - found.x).max() / np.abs(found.x).max()), 1e-7)
        largest = np.maximum(largest, np.abs(stage.x[bottom]))
        if len(stage.iterations) == 1:
            yield Check("state", float(np.abs(stage.states["cushion"] - largest).max()), 1e-12)


def average(rng: np.random.Generator) -> Iterator[Check]:
    """Mean displacement of the top, held by a multiplier: it, and the force that does so."""
    basis, value = _block(rng), float(rng.uniform(-0.01, 0.01))
    top = basis.get_dofs("top").all("u^2")
    model = sc.Model(
        {"block": sc.SolidForm(basis, sc.LinearElastic(E, NU)), "mean": Average(basis, top, value)},
        basis.get_dofs("bottom").all(),
    )
    load = np.append(sc.weight(basis, 20.0), 0.0)
    stage = model.run([sc.Stage("held", load)], progress=False)["held"]
    x, force = stage.x[: basis.N], np.zeros(basis.N)
    force[top] = stage.x[basis.N] / len(top)
    left = (_elastic(basis) @ x + force - load[: basis.N])[
        np.setdiff1d(np.arange(basis.N), model.fixed)
    ]
    yield Check("mean", float(abs(x[top].mean() - value) / abs(value)), 1e-8)
    yield Check(
        "held", float(np.abs(left).max() / max(np.abs(force).max(), np.abs(load).max())), 1e-7
    )


def material(rng: np.random.Generator) -> Iterator[Check]:
    """Elastic material of one's own, in plane strain and in axial symmetry."""
    basis, found = _block(rng), []
    loads, coordinates = _loads(rng, basis), str(rng.choice(["plane", "axisymmetric"]))
    for law in (sc.LinearElastic(E, NU), Stiffening(E, NU)):
        solid = sc.SolidForm(basis, law, coordinates=coordinates)
        stages = [sc.Stage(str(i), np.asarray(load)) for i, load in enumerate(loads)]
        found.append(
            sc.Model({"block": solid}, basis.get_dofs("bottom").all()).run(stages, progress=False)
        )
    for one, other in zip(*found):
        yield Check("material", float(np.abs(one.x - other.x).max() / np.abs(one.x).max()), 1e-7)
