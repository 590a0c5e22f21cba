"""Return mapping to the pyramid of Mohr and Coulomb with its tension cut-off.

Its limit without friction is the prism of Tresca. In principal stresses s1 >= s2 >= s3 the yield
function is (1 + sin phi) s1 - (1 - sin phi) s3 - strength, and the plastic potential is the same
with psi. Trial stresses return by Koiter's rule to a face, an edge or the apex.

An edge is a face whose two meeting principal stresses are averaged: the difference of the
multipliers of its two faces makes these stresses equal, and their sum follows from the mean of both
yield functions. The averaging is given by the weights (w1, w3) of s1 and s3 in their own means: (1,
1) on a face, (1, 1/2) on the edge s2 = s3 and (1/2, 1) on the edge s1 = s2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .base import Array, Parameter
from .plastic import ROUND_OFF, Return, chosen

_Weights = tuple[Parameter, Parameter]
_FACE: _Weights = (1.0, 1.0)


class PyramidConstants(NamedTuple):
    """Constants of the pyramid: floats, or arrays over elements or points."""

    lam: Parameter
    mu: Parameter
    sin_phi: Parameter
    sin_psi: Parameter
    strength: Parameter  # 2 c cos(phi)
    tension: Parameter | None = None  # cut-off


def cut_off_excess(largest: Array, smallest: Array, k: PyramidConstants) -> Array:
    """Return the yield function of the pyramid with its cut-off."""
    excess = pyramid_excess(largest, smallest, k)
    if k.tension is not None:
        np.maximum(excess, largest - k.tension, out=excess)
    return excess


def return_with_cut_off(trial: Array, k: PyramidConstants) -> Return:
    """Return trial stresses to the pyramid, and to the cut-off where the result exceeds it."""
    if k.tension is None:
        return pyramid_return(trial, k)

    # Return the points outside of the pyramid to it.
    values = trial.copy()
    sheared = np.flatnonzero(pyramid_excess(trial[0], trial[2], k) > 0)
    shear = pyramid_return(trial[:, sheared], chosen(k, sheared))
    values[:, sheared] = shear.values

    # Return the points beyond the cut-off anew, from their trial stresses.
    torn = np.flatnonzero(values[0] > k.tension)
    cut_off = _to_cut_off(trial[:, torn], chosen(k, torn))
    values[:, torn] = cut_off.values

    def moduli() -> Array:
        result = np.empty((3, *trial.shape))  # (3, 3, n)
        result[:, :, sheared] = shear.moduli()
        result[:, :, torn] = cut_off.moduli()
        return result

    return Return(values, moduli)


def _to_cut_off(trial: Array, k: PyramidConstants) -> Return:
    """Return principal trial stresses (3, n) that exceed the tensile strength to the cut-off.

    The three planes s_i = tension have associated flow and are combined with the faces of the
    pyramid by Koiter's rule. The returned stress lies on one, two or three of the planes, or where
    they cut the pyramid; on this line s1 and s3 = lateral are given, and s2 is free, or equals one
    of them at an end of the line.
    """
    s1, s2, s3 = trial
    tension: Parameter = k.tension  # type: ignore[assignment]
    lateral = ((1 + k.sin_phi) * tension - k.strength) / (1 - k.sin_phi)
    poisson = k.lam / (2 * (k.lam + k.mu))
    constrained = k.lam / (k.lam + 2 * k.mu)

    # Return to one plane, or to the line of two planes.
    relaxed = constrained * (s1 - tension)
    middle = s2 - relaxed
    two_planes = middle > tension
    on_line = s3 - poisson * (s1 + s2 - 2 * tension)
    smallest = np.where(two_planes, on_line, s3 - relaxed)

    # Return to the line where the first plane cuts the pyramid.
    sheared = smallest < lateral
    between = s2 - poisson * (s1 - tension + s3 - lateral)
    middle = np.where(sheared, np.maximum(between, lateral), middle)

    values = np.empty_like(trial)
    values[0] = tension
    values[1] = np.minimum(middle, tension)
    values[2] = np.clip(smallest, lateral, tension)

    def moduli() -> Array:
        result = np.zeros((3, *trial.shape))  # (3, 3, n)
        # Plane stress on one plane: s2 and s3 are free.
        one_plane = ~two_planes & ~sheared
        direct = k.lam + 2 * k.mu - k.lam * constrained
        across = k.lam - k.lam * constrained
        result[1, 1] = np.where(one_plane, direct, 0)
        result[2, 2] = result[1, 1]
        result[1, 2] = np.where(one_plane, across, 0)
        result[2, 1] = result[1, 2]
        # Young's modulus on a line: s3 or s2 is free.
        young = 2 * k.mu * (1 + poisson)
        third_free = two_planes & ~sheared & (smallest < tension)
        second_free = sheared & (lateral < between) & (between < tension)
        result[2, 2] += np.where(third_free, young, 0)
        result[1, 1] += np.where(second_free, young, 0)
        return result

    return Return(values, moduli)


def pyramid_return(trial: Array, k: PyramidConstants) -> Return:
    """Return descending principal trial stresses (3, n), all of them outside, to the pyramid."""
    # Return to the face, then the points whose order changes to an edge or the apex.
    values = _to_plane(trial, _FACE, k)
    tolerance = ROUND_OFF * np.maximum(trial[0], -trial[2])
    gap = np.minimum(values[0] - values[1], values[1] - values[2])
    edge = np.flatnonzero(gap < tolerance)
    at_edge = chosen(k, edge)
    values[:, edge], weights, apex = _to_edge_or_apex(trial[:, edge], at_edge)

    def moduli() -> Array:
        result = _moduli(_FACE, k, trial.shape[1])
        at_edges = _moduli(weights, at_edge, edge.size)
        at_edges[:, :, apex] = 0
        result[:, :, edge] = at_edges
        return result

    def relief() -> Array:
        result = _filled(_step(_FACE, k), trial.shape)
        at_edges = _filled(_step(weights, at_edge), (3, edge.size))
        if apex.size:
            at_edges[:, apex] = 1 / (2 * chosen(at_edge, apex).sin_phi)
        result[:, edge] = at_edges
        return result

    return Return(values, moduli, relief=relief)


def pyramid_excess(largest: Array, smallest: Array, k: PyramidConstants) -> Array:
    """Return the yield function of the extreme principal stresses."""
    excess = (1 + k.sin_phi) * largest
    excess -= (1 - k.sin_phi) * smallest
    excess -= k.strength
    return excess


def _normal(sine: Parameter, weights: _Weights) -> tuple[Parameter, Parameter, Parameter]:
    """Return the averaged gradient of the yield function (sin phi) or the potential (sin psi)."""
    w1, w3 = weights
    first = (1 + sine) * w1
    second = (1 + sine) * (1 - w1) - (1 - sine) * (1 - w3)
    third = -(1 - sine) * w3
    return first, second, third


def _averaging(weights: _Weights) -> tuple[tuple[Parameter, ...], ...]:
    """Return the matrix that averages the meeting principal stresses."""
    w1, w3 = weights
    return (
        (w1, 1 - w1, 0.0),
        (1 - w1, w1 + w3 - 1, 1 - w3),
        (0.0, 1 - w3, w3),
    )


def _step(weights: _Weights, k: PyramidConstants) -> tuple[Parameter, ...]:
    """Return the drop of the averaged stresses that lowers the yield function by one.

    With the averaged gradients n of the yield function and r of the potential the drop is
    (lam sin(psi) + mu r) / (2 lam sin(phi) sin(psi) + mu n . r).
    """
    n = _normal(k.sin_phi, weights)
    r = _normal(k.sin_psi, weights)
    product = n[0] * r[0] + n[1] * r[1] + n[2] * r[2]
    resistance = 2 * k.lam * k.sin_phi * k.sin_psi + k.mu * product
    volume = k.lam * k.sin_psi
    return tuple((volume + k.mu * flow) / resistance for flow in r)


def _to_plane(averaged: Array, weights: _Weights, k: PyramidConstants) -> Array:
    """Return averaged trial stresses along the averaged flow to the zero of the yield function."""
    excess = pyramid_excess(averaged[0], averaged[2], k)
    values = np.empty_like(averaged)
    for value, stress, step in zip(values, averaged, _step(weights, k)):
        np.multiply(excess, step, out=value)
        np.subtract(stress, value, out=value)
    # from the yield condition, which then holds to the round-off of the returned stress
    values[0] = (k.strength + (1 - k.sin_phi) * values[2]) / (1 + k.sin_phi)
    return values


def _to_edge_or_apex(trial: Array, k: PyramidConstants) -> tuple[Array, _Weights, NDArray[np.intp]]:
    """Return trial stresses whose return to the face would change their order.

    Along the flow direction of the face one pair of principal stresses meets first, and the return
    continues along that edge; the multipliers of both its faces grow all the way. The other pair
    can meet at the apex only, which the return reaches if it would change the order of the largest
    and the smallest stress. The result holds the stresses, the weights of the edges, and the points
    at the apex.
    """
    # Find the pair of principal stresses that meets first.
    weights = edge_weights(trial, k.sin_psi)

    # Return their mean and the third stress.
    s1, s2, s3 = trial
    averaged = np.stack([a * s1 + b * s2 + c * s3 for a, b, c in _averaging(weights)])
    values = _to_plane(averaged, weights, k)
    values[1] = np.where(weights[0] == 1, values[2], values[0])

    # Put stresses beyond the apex on it.
    apex = np.flatnonzero(values[0] < values[2])
    if apex.size:
        at_apex = chosen(k, apex)
        values[:, apex] = at_apex.strength / (2 * at_apex.sin_phi)
    return values, weights, apex


def edge_weights(trial: Array, sin_psi: Parameter) -> tuple[Array, Array]:
    """Return the weights of the edge where the return along the flow of the face arrives first."""
    s1, s2, s3 = trial
    minor_pair = (s2 - s3) * (1 + sin_psi) <= (s1 - s2) * (1 - sin_psi)
    return np.where(minor_pair, 1.0, 0.5), np.where(minor_pair, 0.5, 1.0)


def _moduli(weights: _Weights, k: PyramidConstants, n: int) -> Array:
    """Return d principal stress / d principal strain on a face or an edge, shape (3, 3, n)."""
    step = _step(weights, k)
    normal = _normal(k.sin_phi, weights)
    averaging = _averaging(weights)
    result = np.empty((3, 3, n))
    for i in range(3):
        for j in range(3):
            gradient = 2 * (k.lam * k.sin_phi + k.mu * normal[j])
            result[i, j] = k.lam + 2 * k.mu * averaging[i][j] - step[i] * gradient
    return result


def _filled(rows: tuple[Parameter, ...], shape: tuple[int, ...]) -> Array:
    """Return an array whose rows are floats or arrays."""
    result = np.empty(shape)
    for row, value in zip(result, rows):
        row[...] = value
    return result
