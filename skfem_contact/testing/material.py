"""Check of a material."""
from __future__ import annotations

import numpy as np
from numpy import ndarray

from ..materials.base import Material, Update
from .tools import EXACT, STEP, differences, largest_error, require, require_all, same_twice


def check_material(material: Material, strain: float = 1e-3, shape: tuple[int, int] = (50, 4), ncomp: int = 4,
                   steps: int = 5, dissipation: bool = True, tolerance: float = 1e-5, seed: int = 0) -> float:
    """Check a material on random strain paths.

    In every step: the answer has the right shapes and is the same twice, the arguments are left alone; a stress that
    has been returned is admissible, which is to say that a zero increment leaves it where it is; points that are
    not named as plastic are elastic; the tangent is that of central differences wherever the step has no kink;
    plastic flow dissipates.

    Parameters
    ----------
    material
        The material.
    strain
        Size of the strain increments: large enough for all that the material can do, 1e-3 for stiff soil.
    shape
        Numbers of elements and of points in each; parameters that are arrays have one value an element.
    ncomp
        4 components (xx, yy, zz, xy) or 6.
    steps
        Length of the paths.
    dissipation
        Whether plastic strain must do work on the stress in every step.
    tolerance
        Error of the tangent, relative to the largest elastic modulus.
    seed
        Of the random numbers.

    Returns
    -------
    float
        Largest error of the tangent.

    Raises
    ------
    CheckFailed
        With what is violated, and at how many points.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.testing.check_material(sc.MohrCoulomb(E=1e4, nu=.3, c=5., phi=30., psi=10.)) < 1e-6
    True
    """
    rng = np.random.default_rng(seed)
    D = np.asarray(material.elasticity(ncomp))
    require(D.shape in ((ncomp, ncomp), (shape[0], ncomp, ncomp)), f"elasticity has the shape {D.shape}")
    require(np.abs(D - np.swapaxes(D, -1, -2)).max() <= EXACT * np.abs(D).max(), "the elasticity is not symmetric")
    require(np.linalg.eigvalsh(D).min() > 0, "the elasticity is not positive definite")
    D = np.broadcast_to(D, (shape[0], ncomp, ncomp))
    stress, internal = np.zeros((ncomp, *shape)), np.zeros((material.n_internal, *shape))
    worst = 0.0
    for _ in range(steps):
        increment = strain * rng.standard_normal((ncomp, *shape)) * rng.uniform(0, 1, shape)
        new = same_twice(lambda e=increment, s=stress, i=internal: material.update(e, s, i),  # type: ignore[misc]
                          (increment, stress, internal), "material.update")
        _check_update(new, internal.shape, stress.shape)
        again = material.update(np.zeros_like(increment), new.stress, new.internal)
        require_all(np.abs(again.stress - new.stress).max(axis=0) <= 1e-7 * np.abs(new.stress).max(),
                     "the stress is not admissible: a zero increment changes it")
        flow = increment - np.linalg.solve(D, (new.stress - stress).transpose(1, 0, 2)).transpose(1, 0, 2)
        plastic = np.zeros(shape, bool)
        plastic.ravel()[new.plastic] = True
        require_all(plastic | (np.abs(flow).max(axis=0) <= EXACT * strain),
                     "points that are not named in `plastic` do not answer elastically")
        if dissipation:
            require_all((new.stress * flow).sum(axis=0) >= -EXACT * np.abs(new.stress).max() * strain,
                         "plastic flow dissipates a negative work")
        worst = max(worst, _material_tangent(material, increment, stress, internal, new, D, strain, tolerance))
        stress, internal = new.stress, new.internal
    return worst


def _check_update(new: Update, internal: tuple[int, ...], stress: tuple[int, ...]) -> None:
    require(new.stress.shape == stress, f"the stress has the shape {new.stress.shape}, not {stress}")
    require(np.isfinite(new.stress).all() and np.isfinite(new.internal).all(), "the answer is not finite")
    n, points = len(new.plastic), int(np.prod(stress[1:]))
    require(new.internal.shape == internal,
            f"the internal variables have the shape {new.internal.shape}, not {internal}")
    require(n == len(np.unique(new.plastic)) and (n == 0 or 0 <= new.plastic.min() <= new.plastic.max() < points),
             "`plastic` must hold different indices of points")
    tangent = new.tangent()
    wanted = (n, stress[0], stress[0])
    require(n == 0 or tangent.shape == wanted, f"the tangent has the shape {tangent.shape}, not {wanted}")


def _material_tangent(material: Material, increment: ndarray, stress: ndarray, internal: ndarray, new: Update,
                      D: ndarray, strain: float, tolerance: float) -> float:
    """Largest error of the tangent where there is one."""
    ncomp, h, modulus = len(stress), STEP * strain, np.abs(D).max()
    tangent = np.repeat(D, stress.shape[2], axis=0)
    if len(new.plastic):
        tangent[new.plastic] = new.tangent()

    def answer(j: int, step: float) -> ndarray:
        moved = increment.copy()
        moved[j] += step
        return material.update(moved, stress, internal).stress

    slopes = [differences(lambda step, j=j: answer(j, step), h) for j in range(ncomp)]  # type: ignore[misc]
    slope = np.stack([s for s, _ in slopes]).reshape(ncomp, ncomp, -1).transpose(2, 1, 0)
    kinks = np.stack([k for _, k in slopes]).reshape(ncomp * ncomp, -1).max(axis=0)
    return largest_error(np.abs(slope - tangent).max(axis=(1, 2)) / modulus, kinks / modulus, tolerance,
                          "the tangent differs from the differences of the stress")
