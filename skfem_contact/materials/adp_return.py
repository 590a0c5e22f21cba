"""Return mapping of NGI-ADP, see :mod:`.ngi_adp`, by Newton's method.

The variables are the stress and the root of w, the share of the shear strain at failure.
Engineering shear strains belong to the shear stresses: derivatives by stresses are strains. The
norm of a plastic strain is its engineering shear strain in plane strain, sqrt(2 e:e).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .base import Array
from .local_newton import damped_newton

# Residuals over the strength at which Newton's method ends, iterations and halvings of a step: 4 to
# 8 are needed.
_SOLVED = 1e-12
_ITERATIONS = 60
_HALVINGS = 10
# Deviators whose vertical component is at least 1 / _SIDE of the root of J2 are of the active or
# the passive side. In plane strain it is the whole root in the end, and less on the way from
# isotropic stress.
_SIDE = 1.25


class ADPConstants(NamedTuple):
    """Constants at points, (n,)."""

    lam: Array
    mu: Array
    radius: Array  # (A + P) / 2
    shift: Array  # A - P
    scale: Array  # of shear on horizontal planes
    rounding: Array  # of the corners
    active: Array  # strains at failure
    dss: Array
    passive: Array
    plastic: bool  # perfectly

    def stiffness(self, ncomp: int) -> Array:
        """Return the elastic moduli, (n, ncomp, ncomp)."""
        deviatoric = np.r_[2.0, 2.0, 2.0, np.ones(ncomp - 3)]
        D = self.mu[:, None, None] * np.diag(deviatoric)
        D[:, :3, :3] += self.lam[:, None, None]
        return D


def _vertical(ncomp: int) -> int:
    """Return the row of the vertical normal stress."""
    if ncomp == 4:
        return 1
    return 2


def _horizontal(ncomp: int) -> list[int]:
    """Return the rows of the shear stresses on horizontal planes."""
    if ncomp == 4:
        return [3]
    return [4, 5]


def _twice_shear(ncomp: int) -> Array:
    """Return the weights of the components in the product of two stresses."""
    return np.r_[1.0, 1.0, 1.0, np.full(ncomp - 3, 2.0)]


def _projection(k: ADPConstants, ncomp: int) -> Array:
    """Return the matrix from stresses to modified deviators, (n, ncomp, ncomp)."""
    result = np.zeros((k.scale.size, ncomp, ncomp))
    result[:] = np.eye(ncomp)
    result[:, :3, :3] -= 1 / 3
    for row in _horizontal(ncomp):
        result[:, row, row] = k.scale
    return result


def _offset(first: Array, k: ADPConstants) -> Array:
    """Return the way of the origin from the initial stress to the middle of the strengths."""
    result = -first
    result[:3] += k.shift / 3
    result[_vertical(len(first))] -= k.shift
    return result


def modified(stress: Array, first: Array, kappa: Array, k: ADPConstants) -> Array:
    """Return the modified deviator, (ncomp, n)."""
    moved = stress - first - kappa * _offset(first, k)
    return np.einsum("nij,jn->in", _projection(k, len(stress)), moved)


def mobilised_by(root: Array) -> tuple[Array, Array]:
    """Return the mobilisation kappa of the root of w, and its derivative."""
    u = np.minimum(root, 1.0)
    square = u * u
    return 2 * u / (1 + square), 2 * (1 - square) / (1 + square) ** 2


class _Measure(NamedTuple):
    """Measure of shear (n,); ``slopes()`` computes gradient and second derivative.

    They are derivatives by the deviator, (ncomp, n) and (ncomp, ncomp, n).
    """

    value: Array
    slopes: Callable[[], tuple[Array, Array]]


def measure(s: Array, k: ADPConstants) -> _Measure:
    """Return the largest shear stress of deviators, rounded.

    F^2 = h J2 with h = (1 + g(y)) / 2, g = cos(arccos(y) / 3) and y = 1 - 2 a 27/4 J3^2 / J2^3.
    """
    weight = _twice_shear(len(s))
    J2 = 0.5 * np.einsum("i,in->n", weight, s * s)
    safe = np.where(J2 > 0, J2, 1.0)
    unit = s / np.sqrt(safe)
    J3 = _third(unit)
    y = 1 - 13.5 * k.rounding * J3**2
    g, slope, bend = _cosine(y)
    h = 0.5 * (1 + g)

    def slopes() -> tuple[Array, Array]:
        # differentiate y at J2 = 1
        d2 = weight[:, None] * unit
        d22 = np.diag(weight)[:, :, None]
        d3 = _third_gradient(unit)
        d33 = _third_hessian(unit)
        dy = -13.5 * k.rounding * (2 * J3 * d3 - 3 * J3 * J3 * d2)
        mixed = _dyad(d3, d2)
        mixed = mixed + mixed.swapaxes(0, 1)
        ddy = 2 * _dyad(d3, d3) + 2 * J3 * d33 - 6 * J3 * mixed
        ddy = ddy - 3 * J3 * J3 * d22 + 12 * J3 * J3 * _dyad(d2, d2)
        ddy = -13.5 * k.rounding * ddy

        # differentiate F^2
        dh = 0.5 * slope
        ddh = 0.5 * bend
        first = h * d2 + dh * dy
        cross = _dyad(d2, dy)
        bent = cross + cross.swapaxes(0, 1) + ddy
        second = h * d22 + dh * bent + ddh * _dyad(dy, dy)

        # differentiate F
        F = np.sqrt(h)
        gradient = first / (2 * F)
        hessian = second / (2 * F) - _dyad(gradient, gradient) / F
        return gradient, hessian / np.sqrt(safe)

    return _Measure(np.sqrt(J2 * h), slopes)


def _dyad(a: Array, b: Array) -> Array:
    """Return the dyads of vectors, (ncomp, ncomp, n)."""
    return a[:, None] * b


def _cosine(y: Array) -> tuple[Array, Array, Array]:
    """Return cos(arccos(y) / 3) and its first two derivatives; near y = 1 by their series."""
    y = np.clip(y, -1.0, 1.0)
    angle = np.arccos(y)
    near = y > 1 - 1e-5
    gap = y - 1
    sine = np.where(near, 1.0, np.sin(angle))
    value = np.cos(angle / 3)
    series = 1 / 9 - 8 / 243 * gap + 28 / 2187 * gap**2
    slope = np.where(near, series, np.sin(angle / 3) / (3 * sine))
    bend_series = -8 / 243 + 56 / 2187 * gap
    bend = np.where(near, bend_series, (y * slope - value / 9) / sine**2)
    return value, slope, bend


def _third(s: Array) -> Array:
    """Return the determinant of deviators."""
    xx, yy, zz, xy, yz, zx = _six(s)
    return xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx)


def _six(s: Array) -> Array:
    """Return all six components."""
    if len(s) == 6:
        return s
    return np.concatenate((s, np.zeros((2, s.shape[1]))))


def _third_gradient(s: Array) -> Array:
    """Return the derivatives of the determinant by the components."""
    xx, yy, zz, xy, yz, zx = _six(s)
    return np.stack(
        (
            yy * zz - yz * yz,
            zz * xx - zx * zx,
            xx * yy - xy * xy,
            2 * (yz * zx - xy * zz),
            2 * (xy * zx - xx * yz),
            2 * (xy * yz - yy * zx),
        )
    )[: len(s)]


def _third_hessian(s: Array) -> Array:
    """Return the second derivatives of the determinant."""
    xx, yy, zz, xy, yz, zx = _six(s)
    n = 0 * xx
    rows = (
        (n, zz, yy, n, -2 * yz, n),
        (zz, n, xx, n, n, -2 * zx),
        (yy, xx, n, -2 * xy, n, n),
        (n, n, -2 * xy, -2 * zz, 2 * zx, 2 * yz),
        (-2 * yz, n, n, 2 * zx, -2 * xx, 2 * xy),
        (n, -2 * zx, n, 2 * yz, 2 * xy, -2 * yy),
    )
    hessian = np.array(rows)
    return hessian[: len(s), : len(s)]


class _Returned(NamedTuple):
    """Returned stresses (ncomp, n), plastic shear strains and shares of failure (n,).

    Points without a solution have `failed`. ``tangent()`` computes d stress / d strain, (n, ncomp,
    ncomp).
    """

    stress: Array
    strain: Array
    share: Array
    failed: NDArray[np.intp]
    tangent: Callable[[], Array]


class _System(NamedTuple):
    """Residuals of stress and yield over the strength, their Jacobian, and the plastic strain."""

    residual: Array  # (ncomp + 1, n)
    jacobian: Callable[[], Array]  # (n, ncomp + 1, ncomp + 1)
    strain: Array


def returned(trial: Array, first: Array, share: Array, k: ADPConstants) -> _Returned:
    """Return trial stresses (ncomp, n) outside of the yield surface, from shares of failure w."""
    # solve for stress and root of the share; the share is not negative
    ncomp, n = trial.shape
    size = np.maximum(np.abs(trial).max(axis=0) / k.radius, 1.0)
    least = np.r_[np.full(ncomp, -np.inf), 0.0][:, None]
    z, failed = damped_newton(
        _newton,
        _start(trial, first, share, k),
        data=(trial, first, share, k, size),
        last=_SOLVED,
        iterations=_ITERATIONS,
        halvings=_HALVINGS,
        least=least,
    )
    final = _system(z, trial, first, share, k)

    def tangent() -> Array:
        # solve J dz = (D, 0) de
        none = np.zeros((n, 1, ncomp))
        right = np.concatenate((k.stiffness(ncomp), none), axis=1)
        right /= k.radius[:, None, None]
        change = np.linalg.solve(final.jacobian(), right)
        return np.asarray(change, dtype=float)[:, :ncomp]

    return _Returned(z[:ncomp], final.strain, z[ncomp] ** 2, failed, tangent)


def _newton(
    z: Array,
    trial: Array,
    first: Array,
    share: Array,
    k: ADPConstants,
    size: Array,
) -> tuple[Array, Array]:
    """Return the step of Newton's method, none in solved points, and the size of the residual."""
    system = _system(z, trial, first, share, k)
    residual = system.residual
    error = np.abs(residual).max(axis=0) / size
    right = residual.T[:, :, None]
    step = np.linalg.solve(system.jacobian(), right)[:, :, 0]
    return np.where(error < _SOLVED, 0.0, -step.T), error


def _start(trial: Array, first: Array, share: Array, k: ADPConstants) -> Array:
    """Return the stress and the root of w from which Newton's method begins.

    The elastic stress gives the mobilisation; its excess over the strength becomes strain.
    """
    # find the mobilisation by the elastic stress
    root = np.sqrt(share)
    kappa = _mobilisation(root, k)[0]
    s = modified(trial, first, kappa, k)
    shear = measure(s, k).value
    reached = np.clip(shear / k.radius, kappa, 1.0)
    if not k.plastic:
        root = np.maximum(root, reached / (1 + np.sqrt(1 - reached * reached)))

    # add the strain of the excess over the strength
    excess = np.maximum(shear - k.radius, 0.0) / k.mu
    root = np.sqrt(root * root + excess / _at_failure(s, k)[0])

    # shrink the deviator to the mobilised strength
    centre = first + reached * _offset(first, k)
    deviator = trial - centre
    deviator[:3] -= deviator[:3].mean(axis=0)
    back = np.minimum(1.0, reached * k.radius / np.maximum(shear, 1e-300))
    return np.concatenate((trial - (1 - back) * deviator, root[None]))


def _at_failure(s: Array, k: ADPConstants) -> tuple[Array, Array]:
    """Return the plastic shear strain at failure along a deviator, and its gradient.

    The strain of direct simple shear counts by the share of shear on horizontal planes in J2. The
    rest is of the active side where the vertical axis is compressed, of the passive one where it is
    extended, between them where it is neither.
    """
    weight = _twice_shear(len(s))[:, None]
    rows = _horizontal(len(s))
    up = _vertical(len(s))

    # find the share of horizontal shear, and the side v from -1, passive, to 1, active
    J2 = np.maximum(0.5 * (weight * s * s).sum(axis=0), 1e-300)
    horizontal = (s[rows] ** 2).sum(axis=0)
    flat = horizontal / J2
    rest = np.maximum(J2 - horizontal, 1e-14 * J2)
    along = -_SIDE * s[up] / np.sqrt(rest)
    v = np.clip(along, -1, 1)

    # differentiate them
    by_rest = weight * s
    by_flat = -flat * by_rest / J2
    by_flat[rows] += 2 * s[rows] / J2
    by_rest[rows] = 0.0
    by_v = -0.5 * along * by_rest / rest
    by_v[up] -= _SIDE / np.sqrt(rest)

    # mix the strains
    mean = 0.5 * (k.active + k.passive)
    half = 0.5 * (k.active - k.passive)
    of_side = mean + half * v * (1.5 - 0.5 * v * v)
    failure: Array = k.dss * flat + of_side * (1 - flat)
    side_by_v = 1.5 * half * (1 - v * v)
    gradient = (k.dss - of_side) * by_flat + side_by_v * (1 - flat) * by_v
    return failure, gradient


def _mobilisation(root: Array, k: ADPConstants) -> tuple[Array, Array]:
    """Return kappa, all of it in perfect plasticity, and its derivative by the root of w."""
    if k.plastic:
        return (np.ones_like(root), np.zeros_like(root))
    return mobilised_by(root)


def _system(z: Array, trial: Array, first: Array, share: Array, k: ADPConstants) -> _System:
    """Return the equations of the return, over the strength r = (A + P) / 2.

    With the flow m = dF / d stress, of length 1, and the strain at failure f the equations are

        stress - trial + f (w - w_0) C m = 0,    F - kappa r = 0
    """
    ncomp = len(trial)
    stress = z[:ncomp]
    root = z[ncomp]
    kappa, rate = _mobilisation(root, k)
    s = modified(stress, first, kappa, k)
    C = k.stiffness(ncomp)
    project = _projection(k, ncomp)

    # compute flow and plastic strain
    F, slopes = measure(s, k)
    by_s, second = slopes()
    failure, by_direction = _at_failure(s, k)
    normal = np.einsum("nij,in->jn", project, by_s)
    metric = np.r_[2.0, 2.0, 2.0, np.ones(ncomp - 3)][:, None]
    length = np.sqrt((metric * normal * normal).sum(axis=0))
    flow = normal / length
    grown = root * root - share
    strain = failure * grown
    relaxed = np.einsum("nij,jn->in", C, flow)
    excess = F - kappa * k.radius
    unbalanced = stress - trial + strain * relaxed
    residual = np.concatenate((unbalanced, excess[None])) / k.radius

    def jacobian() -> Array:
        # differentiate C times the plastic strain by the modified deviator
        turned = np.einsum("nki,kln->nil", project, second)
        turned = turned / length[:, None, None]
        longer = np.einsum("in,nil->nl", metric * flow, turned)
        turned -= flow.T[:, :, None] * longer[:, None, :]
        increased = grown * flow
        changed = increased.T[:, :, None] * by_direction.T[:, None, :]
        changed = strain[:, None, None] * turned + changed
        to_s = np.matmul(C, changed)  # (n, ncomp, ncomp)

        # collect the derivatives by stress and root
        offset = _offset(first, k)
        moved = np.einsum("nij,jn->ni", project, offset)
        moved = -rate[:, None] * moved
        by_root = np.einsum("nij,nj->ni", to_s, moved)
        by_root = by_root + (2 * root * failure * relaxed).T
        by_excess = np.einsum("in,ni->n", by_s, moved) - rate * k.radius
        size = ncomp + 1
        result = np.zeros((root.size, size, size))
        result[:, :ncomp, :ncomp] = np.eye(ncomp) + np.matmul(to_s, project)
        result[:, :ncomp, ncomp] = by_root
        result[:, ncomp, :ncomp] = normal.T
        result[:, ncomp, ncomp] = by_excess
        return result / k.radius[:, None, None]

    return _System(residual, jacobian, strain)
