"""Material points for the tests of the plastic laws, and the checks that every law passes."""

from __future__ import annotations

import numpy as np


def rotations(n: int, ncomp: int, rng: np.random.Generator) -> np.ndarray:
    """Random rotations (n, 3, 3), about z for 4 components."""
    matrices = np.linalg.qr(rng.normal(size=(n, 3, 3)))[0]
    if ncomp == 4:
        angle = rng.uniform(0, 2 * np.pi, n)
        matrices[...] = np.eye(3)
        matrices[:, 0, 0] = matrices[:, 1, 1] = np.cos(angle)
        matrices[:, 1, 0] = np.sin(angle)
        matrices[:, 0, 1] = -np.sin(angle)
    return matrices


def components(
    principal: np.ndarray, rotation: np.ndarray, ncomp: int, shear: float = 1.0
) -> np.ndarray:
    """Components (ncomp, n) of Q diag(principal) Q^T; ``shear`` is 2 for engineering shear
    strains.
    """
    tensor = np.einsum("nij,nj,nkj->nik", rotation, principal, rotation)
    rows, columns = np.array([0, 1, 2, 0, 1, 2]), np.array([0, 1, 2, 1, 2, 0])
    return (tensor[:, rows, columns] * np.array([1, 1, 1, shear, shear, shear]))[:, :ncomp].T.copy()


def principal_stresses(stress: np.ndarray) -> np.ndarray:
    """Ascending eigenvalues (..., 3) of the components (4 or 6, ...)."""
    six = np.vstack((stress, np.zeros((6 - len(stress), *stress.shape[1:]))))
    tensor = six[[[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
    return np.linalg.eigvalsh(np.moveaxis(tensor, (0, 1), (-2, -1)))


def random_strains(n: int, rng: np.random.Generator, size: float = 4e-3) -> np.ndarray:
    """Principal strains (n, 3) in all directions; a tenth has two equal values, some have three."""
    strain = (
        rng.normal(size=(n, 3)) * size * rng.uniform(0, 1, (n, 1))
        + rng.normal(size=(n, 1)) * size / 3
    )
    strain[: n // 20, 1] = strain[: n // 20, 0]
    strain[n // 20 : n // 10, 2] = strain[n // 20 : n // 10, 1]
    strain[: n // 100] = strain[: n // 100, :1]
    return strain


def random_points(n: int, ncomp: int, rng: np.random.Generator, size: float = 4e-3) -> np.ndarray:
    """Random strains in random directions, shape (ncomp, n)."""
    return components(random_strains(n, rng, size), rotations(n, ncomp, rng), ncomp, shear=2)


def update(material, strain: np.ndarray, stress: np.ndarray | None = None):
    """The material's answer from rest."""
    stress = np.zeros_like(strain) if stress is None else stress
    return material.update(strain, stress, np.zeros((1, *strain.shape[1:])))


def assert_tangent(material, strain: np.ndarray, stress: np.ndarray | None = None) -> None:
    """The tangent is that of central differences wherever the step has no kink, and kinks are
    rare.
    """
    ncomp, n = strain.shape
    step = 1e-9
    result = update(material, strain, stress)
    tangent = np.broadcast_to(material.elasticity(ncomp), (n, ncomp, ncomp)).copy()
    tangent[result.plastic] = result.tangent()

    kinked = np.zeros(n, dtype=bool)
    error = np.zeros(n)
    for j, direction in enumerate(np.eye(ncomp)):
        forward = update(material, strain + step * direction[:, None], stress).stress
        backward = update(material, strain - step * direction[:, None], stress).stress
        kinked |= (
            np.abs(forward - 2 * result.stress + backward).max(axis=0) > 1e-3 * step * material.E
        )
        slope = ((forward - backward) / (2 * step)).T
        error = np.maximum(error, np.abs(slope - tangent[:, :, j]).max(axis=1))
    # Round-off of the differences: 1e-13 in the stress over a step of 2e-9, against E = 2e4, is
    # 3e-9.
    assert error[~kinked].max() <= 1e-6 * np.max(material.E)
    assert kinked.mean() < 0.01


def assert_history(
    material, excess, ncomp: int, steps: int = 60, points: int = 300, size: float = 1e-3
) -> None:
    """Random increments dissipate, stay on the surface without drift, and add up the plastic shear
    strain.

    ``excess`` is the yield function of the Cartesian components and the internal variable.
    """
    rng = np.random.default_rng(5)
    stress, internal = np.zeros((ncomp, points)), np.zeros((1, points))
    compliance = np.linalg.inv(material.elasticity(ncomp))
    weights = np.array([1, 1, 1, 0.5, 0.5, 0.5])[:ncomp, None]
    equivalent = np.zeros(points)
    for _ in range(steps):
        increment = rng.normal(size=(ncomp, points)) * size
        result = material.update(increment, stress, internal)
        plastic_strain = increment - compliance @ (result.stress - stress)
        # round-off of the stress times the strain
        scale = (np.abs(result.stress).max(axis=0) + 1) * size
        assert ((result.stress * plastic_strain).sum(axis=0) >= -1e-13 * scale).all()
        deviator = plastic_strain.copy()
        deviator[:3] -= plastic_strain[:3].mean(axis=0)
        equivalent += np.sqrt(2 / 3 * (weights * deviator**2).sum(axis=0))
        stress, internal = result.stress, result.internal
        assert (excess(stress, internal[0]) <= 1e-12 * (np.abs(stress).max(axis=0) + 1)).all()
    assert (equivalent > 0).all()
    # every increment to the round-off of its stress over E
    np.testing.assert_allclose(internal[0], equivalent, rtol=1e-11, atol=1e-13)


class Specimen:
    """One point under mixed control: given strain increments, and given stresses at the free
    components.

    On an edge the tangent leaves the difference of two strains open, hence the least-squares
    solution.
    """

    def __init__(self, material, stress: list[float], ncomp: int = 4) -> None:
        self.material = material
        self.stress = np.zeros((ncomp, 1))
        self.stress[:4, 0] = stress
        self.internal = np.zeros((1, 1))
        self.strain = np.zeros((ncomp, 1))
        self.plastic_strain = np.zeros(ncomp)

    def step(self, strain: dict[int, float], stress: dict[int, float]) -> None:
        """Load by strain increments; the strains of the components in ``stress`` give these
        stresses.
        """
        increment = np.zeros_like(self.stress)
        for i, value in strain.items():
            increment[i] = value
        free, target = list(stress), np.array(list(stress.values()))
        for _ in range(12):
            result = self.material.update(increment, self.stress, self.internal)
            residual = target - result.stress[free, 0]
            if np.abs(residual).max(initial=0) <= 1e-12 * np.abs(result.stress).max():
                break
            tangent = (
                result.tangent()[0]
                if result.plastic.size
                else self.material.elasticity(len(increment))
            )
            increment[free, 0] += np.linalg.lstsq(tangent[np.ix_(free, free)], residual)[0]
        else:
            raise AssertionError(f"no equilibrium, residual {residual}")
        elastic = np.linalg.solve(
            self.material.elasticity(len(increment)), result.stress - self.stress
        )
        self.plastic_strain += (increment - elastic)[:, 0]
        self.strain += increment
        self.stress, self.internal = result.stress, result.internal
