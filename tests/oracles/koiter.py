"""Return mapping to a polyhedron in principal stresses by trying all sets of active planes."""

from __future__ import annotations

import itertools

import numpy as np

PAIRS = tuple(itertools.permutations(range(3), 2))


def pyramid_planes(sine: float) -> np.ndarray:
    """Normals (6, 3) of the Mohr-Coulomb pyramid for sin(phi), or its flow directions for
    sin(psi).
    """
    unit = np.eye(3)
    return np.array([(1 + sine) * unit[i] - (1 - sine) * unit[j] for i, j in PAIRS])


def koiter_return(trial, stiffness, normals, flows, limits):
    """Stresses that satisfy Koiter's conditions for the planes ``normals @ stress <= limits``.

    Of all sets of up to three active planes the one is taken whose multipliers and yield functions
    violate the conditions least.

    Parameters
    ----------
    trial : ndarray, shape (n, 3)
    stiffness : ndarray, shape (3, 3)
    normals, flows : ndarray, shape (m, 3)
    limits : ndarray, shape (m,)

    Returns
    -------
    stress : ndarray, shape (n, 3)
    violation : ndarray, shape (n,)
        Largest violation as a stress, of the order of the round-off where a solution exists.
    active : ndarray of int, shape (n,)
        Number of active planes.
    """
    stress = trial.copy()
    violation = (trial @ normals.T - limits).max(axis=1)
    active = np.zeros(len(trial), dtype=int)
    for count in (1, 2, 3):
        for planes in map(list, itertools.combinations(range(len(limits)), count)):
            drops = flows[planes] @ stiffness
            matrix = normals[planes] @ drops.T
            if abs(np.linalg.det(matrix / np.abs(matrix).max())) < 1e-9:
                continue
            multipliers = np.linalg.solve(matrix, (trial @ normals[planes].T - limits[planes]).T).T
            candidate = trial - multipliers @ drops
            worst = np.maximum(
                (candidate @ normals.T - limits).max(axis=1),
                -(multipliers * np.diag(matrix)).min(axis=1),
            )
            better = worst < violation * (1 - 1e-9) - 1e-14 * np.abs(trial).max(axis=1)
            better &= violation > 1e-13 * np.abs(trial).max(axis=1)
            stress[better], violation[better], active[better] = (
                candidate[better],
                worst[better],
                count,
            )
    return stress, violation, active


def pyramid_return(trial, lam, mu, sin_phi, sin_psi, strength, tension=None):
    """Stresses on the Mohr-Coulomb pyramid, with a tension cut-off below its apex or without.

    Without cut-off and with psi < phi some trial stresses satisfy no set of planes; these belong to
    the apex.

    Returns
    -------
    stress : ndarray, shape (n, 3)
    region : ndarray of int, shape (n,)
        Number of active planes, 3 at the apex.
    """
    stiffness = lam * np.ones((3, 3)) + 2 * mu * np.eye(3)
    normals, flows, limits = pyramid_planes(sin_phi), pyramid_planes(sin_psi), np.full(6, strength)
    if tension is not None:
        normals, flows = np.vstack((normals, np.eye(3))), np.vstack((flows, np.eye(3)))
        limits = np.append(limits, [tension] * 3)
    stress, violation, region = koiter_return(trial, stiffness, normals, flows, limits)
    unsolved = violation > 1e-10 * (np.abs(trial).max(axis=1) + strength)
    assert not unsolved.any() or tension is None
    stress[unsolved], region[unsolved] = strength / (2 * sin_phi) if sin_phi > 0 else np.nan, 3
    return stress, region
