"""Mohr-Coulomb plasticity with an exact return mapping."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .base import Array, Parameter, require
from .plastic import ROUND_OFF, IsotropicPlasticity, Return, chosen
from .spectral import extremes


class _Constants(NamedTuple):
    lam: Parameter
    mu: Parameter
    sin_phi: Parameter
    sin_psi: Parameter
    strength: Parameter  # 2 c cos(phi)


@dataclass(frozen=True, eq=False)
class MohrCoulomb(IsotropicPlasticity):
    """Linear elasticity, perfect plasticity on the Mohr-Coulomb surface, non-associated flow.

    With principal stresses s1 >= s2 >= s3 (tension positive) the yield function is
    ``(1 + sin phi) s1 - (1 - sin phi) s3 - 2 c cos phi``, and the plastic potential is the same with psi.
    Trial stresses return exactly to a face, an edge (s1 = s2 or s2 = s3) or the apex. phi = 0 is the Tresca
    surface.

    Parameters
    ----------
    E : float or ndarray
        Young's modulus (stress), positive; a float or one value an element.
    nu : float or ndarray
        Poisson's ratio, -1 < nu < 0.5; a float or one value an element.
    c : float or ndarray
        Cohesion (stress), not negative; a float or one value an element.
    phi : float or ndarray
        Friction angle in degrees, 0 <= phi < 90; a float or one value an element.
    psi : float or ndarray, optional
        Dilatancy angle in degrees, 0 <= psi <= phi; a float or one value an element.

    Raises
    ------
    ValueError
        If a parameter is out of its range, not finite, or arrays differ in length.

    Notes
    -----
    The return mapping follows Koiter's rule in principal stresses: W. T. Koiter, Quart. Appl. Math. 11 (1953)
    350-354; J. Clausen, L. Damkilde, L. Andersen, Computers & Structures 85 (2007) 1795-1807.

    Examples
    --------
    >>> sand = MohrCoulomb(E=1000.0, nu=0.25, c=0.0, phi=30.0)
    >>> strain = np.array([[0.001], [-0.01], [-0.001], [0.0]])
    >>> sand.update(strain, np.zeros((4, 1)), np.zeros((1, 1))).stress.ravel().round(3)
    array([ -3.8, -11.4,  -4.8,   0. ])
    """

    c: Parameter
    phi: Parameter
    psi: Parameter = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        require("c", self.c, np.greater_equal(self.c, 0), "not be negative")
        in_range = np.greater_equal(self.phi, 0) & np.less(self.phi, 90)
        require("phi", self.phi, in_range, "lie in [0, 90) degrees")
        require("psi", self.psi, np.greater_equal(self.psi, 0), "not be negative")
        require("psi", self.psi, np.less_equal(self.psi, self.phi), "not exceed phi")

    def reduced(self, factor: float) -> MohrCoulomb:
        """The material with its strength c and tan(phi) divided by a factor.

        An associated material (psi = phi everywhere) stays associated; otherwise the new psi is the smaller
        of psi and the new phi.

        Parameters
        ----------
        factor : float
            Positive.

        Returns
        -------
        MohrCoulomb

        Raises
        ------
        ValueError
            If the factor is not positive.

        Examples
        --------
        >>> soil = MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=45.0, psi=30.0).reduced(2.0)
        >>> print(f"{soil.c:.3f} {soil.phi:.3f} {soil.psi:.3f}")
        5.000 26.565 26.565
        """
        require("factor", factor, np.isfinite(factor) and factor > 0, "be positive")
        phi = np.degrees(np.arctan(np.tan(np.radians(self.phi)) / factor))
        psi = phi if np.all(np.equal(self.psi, self.phi)) else np.minimum(self.psi, phi)
        return replace(self, c=self.c / factor, phi=phi, psi=psi)

    def _constants(self) -> _Constants:
        phi = np.radians(self.phi)
        return _Constants(*self.lame, np.sin(phi), np.sin(np.radians(self.psi)), 2 * self.c * np.cos(phi))

    def _yield_bound(self, stress: Array, constants: _Constants) -> Array:
        return _excess(*extremes(stress), constants)

    def _yield_function(self, values: Array, constants: _Constants) -> Array:
        return _excess(values[0], values[2], constants)

    def _return_map(self, trial: Array, constants: _Constants) -> Return:
        values = _to_plane(trial, _FACE, constants)
        tolerance = ROUND_OFF * np.maximum(trial[0], -trial[2])
        edge = np.flatnonzero(np.minimum(values[0] - values[1], values[1] - values[2]) < tolerance)
        at_edge = chosen(constants, edge)
        values[:, edge], weights, apex = _to_edge_or_apex(trial[:, edge], at_edge)

        def moduli() -> Array:
            result = np.empty((3, *trial.shape))
            _fill_moduli(result, _FACE, constants)
            at_edges = np.empty((3, 3, edge.size))
            _fill_moduli(at_edges, weights, at_edge)
            at_edges[:, :, apex] = 0
            result[:, :, edge] = at_edges
            return result

        return Return(values, moduli)


# An edge is a face whose two meeting principal stresses are averaged: the multipliers of the edge's two faces
# differ by what makes these stresses equal, and their sum follows from the mean of both yield functions. The
# averaging is given by the weights (w1, w3) of s1 and s3 in their own means: (1, 1) on a face, (1, 1/2) on
# the edge s2 = s3 and (1/2, 1) on the edge s1 = s2.
_Weights = tuple[Parameter, Parameter]
_FACE: _Weights = (1.0, 1.0)


def _excess(largest: Array, smallest: Array, k: _Constants) -> Array:
    """Yield function of the extreme principal stresses."""
    excess = (1 + k.sin_phi) * largest
    excess -= (1 - k.sin_phi) * smallest
    excess -= k.strength
    return excess


def _normal(sine: Parameter, weights: _Weights) -> tuple[Parameter, Parameter, Parameter]:
    """Averaged gradient of the yield function (sine of phi) or of the potential (sine of psi)."""
    w1, w3 = weights
    return (1 + sine) * w1, (1 + sine) * (1 - w1) - (1 - sine) * (1 - w3), -(1 - sine) * w3


def _averaging(weights: _Weights) -> tuple[tuple[Parameter, ...], ...]:
    """Matrix that averages the meeting principal stresses."""
    w1, w3 = weights
    return (w1, 1 - w1, 0.0), (1 - w1, w1 + w3 - 1, 1 - w3), (0.0, 1 - w3, w3)


def _resistance(weights: _Weights, k: _Constants) -> Parameter:
    """Drop of the yield function with the multiplier."""
    product: Parameter = sum(n * r for n, r in zip(_normal(k.sin_phi, weights), _normal(k.sin_psi, weights)))
    return 4 * k.lam * k.sin_phi * k.sin_psi + 2 * k.mu * product


def _to_plane(averaged: Array, weights: _Weights, k: _Constants) -> Array:
    """Return averaged trial stresses along the averaged flow direction to where the yield function vanishes.

    The largest stress follows from the yield condition in the end, so that this holds to the round-off of the
    returned stress, however large the trial stress was.
    """
    multiplier = _excess(averaged[0], averaged[2], k)
    multiplier /= _resistance(weights, k)
    values = np.empty_like(averaged)
    for row, flow in zip(values, _normal(k.sin_psi, weights)):
        np.multiply(multiplier, -2 * (k.lam * k.sin_psi + k.mu * flow), out=row)
    values += averaged
    values[0] = (k.strength + (1 - k.sin_phi) * values[2]) / (1 + k.sin_phi)
    return values


def _to_edge_or_apex(trial: Array, k: _Constants) -> tuple[Array, _Weights, NDArray[np.intp]]:
    """Return trial stresses whose return to the face would change their order.

    Along the flow direction of the face one pair of principal stresses meets first, and the return goes on
    along that edge; the multipliers of both its faces grow all the way. The other pair can meet at the apex
    only, which the return reaches if it would change the order of the largest and the smallest stress.

    Returns
    -------
    values : ndarray, shape (3, n)
    weights : tuple of ndarray
        Of the edges.
    apex : ndarray of int
        The points at the apex.
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


def _fill_moduli(moduli: Array, weights: _Weights, k: _Constants) -> None:
    """Write d principal stress / d principal strain on a face or an edge into an array (3, 3, n)."""
    resistance = _resistance(weights, k)
    normal, flow, averaging = _normal(k.sin_phi, weights), _normal(k.sin_psi, weights), _averaging(weights)
    for i in range(3):
        drop = 4 * (k.lam * k.sin_psi + k.mu * flow[i]) / resistance
        for j in range(3):
            gradient = k.lam * k.sin_phi + k.mu * normal[j]
            moduli[i, j] = k.lam + 2 * k.mu * averaging[i][j] - drop * gradient
