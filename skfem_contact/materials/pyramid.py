"""Return mapping to the pyramid of Mohr and Coulomb with its tension cut-off, and its limit, the
prism of Tresca.

In principal stresses s1 >= s2 >= s3 the yield function is (1 + sin phi) s1 - (1 - sin phi) s3 -
strength, and the plastic potential is the same with psi. Trial stresses return by Koiter's rule to
a face, an edge or the apex.

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
    """Floats, or arrays over elements or points; ``strength`` is 2 c cos(phi), ``tension`` the
    cut-off or None.
    """

    lam: Parameter
    mu: Parameter
    sin_phi: Parameter
    sin_psi: Parameter
    strength: Parameter
    tension: Parameter | None = None


def cut_off_excess(largest: Array, smallest: Array, k: PyramidConstants) -> Array:
    """Return the yield function of the pyramid with its cut-off."""
    excess = pyramid_excess(largest, smallest, k)
    return excess if k.tension is None else np.maximum(excess, largest - k.tension, out=excess)


def return_with_cut_off(trial: Array, k: PyramidConstants) -> Return:
    """Return trial stresses to the pyramid, and to the cut-off where the result exceeds it."""
    if k.tension is None:
        return pyramid_return(trial, k)
    values = trial.copy()
    sheared = np.flatnonzero(pyramid_excess(trial[0], trial[2], k) > 0)
    shear = pyramid_return(trial[:, sheared], chosen(k, sheared))
    values[:, sheared] = shear.values

    torn = np.flatnonzero(values[0] > k.tension)
    at = chosen(k, torn)
    cut_off = _to_cut_off(trial[:, torn], at, at.tension)
    values[:, torn] = cut_off.values

    def moduli() -> Array:
        result = np.empty((3, *trial.shape))
        result[:, :, sheared] = shear.moduli()
        result[:, :, torn] = cut_off.moduli()
        return result

    return Return(values, moduli)


def _to_cut_off(trial: Array, k: PyramidConstants, tension: Parameter) -> Return:
    """Return principal trial stresses (3, n) whose return to the pyramid alone exceeds the tensile
    strength.

    The three planes s_i = tension have associated flow and are combined with the faces of the
    pyramid by Koiter's rule. The returned stress lies on one, two or three of the planes, or where
    they cut the pyramid; there s1 and s3 = lateral are given, and s2 is free, or equals one of them
    at the end of that line.
    """
    s1, s2, s3 = trial
    lam, mu = k.lam, k.mu
    lateral = ((1 + k.sin_phi) * tension - k.strength) / (1 - k.sin_phi)
    poisson = lam / (2 * (lam + mu))
    constrained = lam / (lam + 2 * mu)

    middle = s2 - constrained * (s1 - tension)
    two_planes = middle > tension
    smallest = np.where(
        two_planes, s3 - poisson * (s1 + s2 - 2 * tension), s3 - constrained * (s1 - tension)
    )
    sheared = smallest < lateral
    between = s2 - poisson * (s1 - tension + s3 - lateral)
    middle = np.where(sheared, np.maximum(between, lateral), middle)
    first = np.broadcast_to(tension, s1.shape)
    values = np.stack((first, np.minimum(middle, tension), np.clip(smallest, lateral, tension)))

    def moduli() -> Array:
        result = np.zeros((3, *trial.shape))
        one_plane = ~two_planes & ~sheared
        result[1, 1] = result[2, 2] = np.where(one_plane, lam + 2 * mu - lam * constrained, 0)
        result[1, 2] = result[2, 1] = np.where(one_plane, lam - lam * constrained, 0)
        young = 2 * mu * (1 + poisson)
        result[2, 2] += np.where(two_planes & ~sheared & (smallest < tension), young, 0)
        result[1, 1] += np.where(sheared & (lateral < between) & (between < tension), young, 0)
        return result

    return Return(values, moduli)


def pyramid_return(trial: Array, k: PyramidConstants) -> Return:
    """Return descending principal trial stresses (3, n), all of them outside, to the pyramid."""
    values = _to_plane(trial, _FACE, k)
    tolerance = ROUND_OFF * np.maximum(trial[0], -trial[2])
    edge = np.flatnonzero(np.minimum(values[0] - values[1], values[1] - values[2]) < tolerance)
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
    """Return the averaged gradient of the yield function (sine of phi) or of the potential (sine of
    psi).
    """
    w1, w3 = weights
    return (1 + sine) * w1, (1 + sine) * (1 - w1) - (1 - sine) * (1 - w3), -(1 - sine) * w3


def _averaging(weights: _Weights) -> tuple[tuple[Parameter, ...], ...]:
    """Return the matrix that averages the meeting principal stresses."""
    w1, w3 = weights
    return (w1, 1 - w1, 0.0), (1 - w1, w1 + w3 - 1, 1 - w3), (0.0, 1 - w3, w3)


def _step(weights: _Weights, k: PyramidConstants) -> tuple[Parameter, ...]:
    """Return the drop of the averaged stresses that lowers the yield function by one."""
    normal, flow = _normal(k.sin_phi, weights), _normal(k.sin_psi, weights)
    product: Parameter = sum(n * r for n, r in zip(normal, flow))
    resistance = 2 * k.lam * k.sin_phi * k.sin_psi + k.mu * product
    return tuple((k.lam * k.sin_psi + k.mu * r) / resistance for r in flow)


def _to_plane(averaged: Array, weights: _Weights, k: PyramidConstants) -> Array:
    """Return averaged trial stresses along the averaged flow direction to the zero of the yield
    function.
    """
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
    minor_pair = (trial[1] - trial[2]) * (1 + k.sin_psi) <= (trial[0] - trial[1]) * (1 - k.sin_psi)
    weights = np.where(minor_pair, 1.0, 0.5), np.where(minor_pair, 0.5, 1.0)
    averaged = np.stack([sum(w * s for w, s in zip(row, trial)) for row in _averaging(weights)])
    values = _to_plane(averaged, weights, k)
    values[1] = np.where(minor_pair, values[2], values[0])

    apex = np.flatnonzero(values[0] < values[2])
    if apex.size:
        at_apex = chosen(k, apex)
        values[:, apex] = at_apex.strength / (2 * at_apex.sin_phi)
    return values, weights, apex


def _moduli(weights: _Weights, k: PyramidConstants, n: int) -> Array:
    """Return d principal stress / d principal strain on a face or an edge, shape (3, 3, n)."""
    steps, normal, averaging = _step(weights, k), _normal(k.sin_phi, weights), _averaging(weights)
    result = np.empty((3, 3, n))
    for i in range(3):
        for j in range(3):
            gradient = 2 * (k.lam * k.sin_phi + k.mu * normal[j])
            result[i, j] = k.lam + 2 * k.mu * averaging[i][j] - steps[i] * gradient
    return result


def _filled(rows: tuple[Parameter, ...], shape: tuple[int, ...]) -> Array:
    """Return an array whose rows are floats or arrays."""
    result = np.empty(shape)
    for row, value in zip(result, rows):
        row[...] = value
    return result
