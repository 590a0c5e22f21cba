"""Return mapping of NGI-ADP, see :mod:`.ngi_adp`, by Newton's method for the stress and the root of
w.

Engineering shear strains belong to the shear stresses: derivatives by stresses are strains. The
norm of a plastic strain is its engineering shear strain in plane strain, sqrt(2 e:e).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .base import Array

# Residuals over the strength at which Newton's method ends, iterations and halvings of a step: 4 to
# 8 are needed.
_SOLVED, _ITERATIONS, _HALVINGS = 1e-12, 60, 10
# Deviators whose vertical component is at least 1 / _SIDE of the root of J2 are of the active or
# the passive side. In plane strain it is the whole root in the end, and less on the way from
# isotropic stress.
_SIDE = 1.25


class ADPConstants(NamedTuple):
    """Constants at points, (n,): moduli, (A + P) / 2, A - P, scale of horizontal shear, rounding,
    failure strains.
    """

    lam: Array
    mu: Array
    radius: Array
    shift: Array
    scale: Array
    rounding: Array
    active: Array
    dss: Array
    passive: Array
    plastic: bool  # perfectly

    def at(self, points: NDArray[np.intp]) -> ADPConstants:
        """Return the constants of some points."""
        return ADPConstants(*(v if isinstance(v, bool) else v[points] for v in self))  # type: ignore[arg-type]

    def stiffness(self, ncomp: int) -> Array:
        """Return the elastic moduli, (n, ncomp, ncomp)."""
        D = self.mu[:, None, None] * np.diag(np.r_[2.0, 2.0, 2.0, np.ones(ncomp - 3)])
        D[:, :3, :3] += self.lam[:, None, None]
        return D


def _vertical(ncomp: int) -> int:
    """Return the row of the vertical normal stress."""
    return 1 if ncomp == 4 else 2


def _twice_shear(ncomp: int) -> Array:
    """Return the weights of the components in the product of two stresses."""
    return np.r_[1.0, 1.0, 1.0, np.full(ncomp - 3, 2.0)]


def _projection(k: ADPConstants, ncomp: int) -> Array:
    """Return the matrix from stresses to modified deviators, (n, ncomp, ncomp)."""
    result = np.zeros((k.scale.size, ncomp, ncomp))
    result[:] = np.eye(ncomp)
    result[:, :3, :3] -= 1 / 3
    for row in (3,) if ncomp == 4 else (4, 5):
        result[:, row, row] = k.scale
    return result


def _offset(first: Array, k: ADPConstants) -> Array:
    """Return the change of the origin by the mobilisation, from the initial stress to the middle of
    the strengths.
    """
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
    at = np.minimum(root, 1.0)
    return 2 * at / (1 + at * at), 2 * (1 - at * at) / (1 + at * at) ** 2


class _Measure(NamedTuple):
    """Measure of shear (n,), its gradient (ncomp, n) and its second derivative (ncomp, ncomp, n) by
    the deviator.
    """

    value: Array
    gradient: Callable[[], Array]
    both: Callable[[], tuple[Array, Array]]


def measure(s: Array, k: ADPConstants) -> _Measure:
    """Return the largest shear stress of deviators, rounded."""
    weight = _twice_shear(len(s))
    J2 = 0.5 * np.einsum("i,in->n", weight, s * s)
    safe = np.where(J2 > 0, J2, 1.0)
    unit = s / np.sqrt(safe)
    third = _third(unit)
    y = 1 - 13.5 * k.rounding * third**2
    g, slope, bend = _cosine(y)
    h = 0.5 * (1 + g)
    value = np.sqrt(J2 * h)

    def both() -> tuple[Array, Array]:
        d2, d3, d33 = weight[:, None] * unit, _third_gradient(unit), _third_hessian(unit)
        q, dh, ddh = third, 0.5 * slope, 0.5 * bend  # at J2 = 1
        dy = -13.5 * k.rounding * (2 * q * d3 - 3 * q * q * d2)
        mixed = np.einsum("in,jn->ijn", d3, d2)
        ddy = (
            -13.5
            * k.rounding
            * (
                2 * np.einsum("in,jn->ijn", d3, d3)
                + 2 * q * d33
                - 6 * q * (mixed + mixed.swapaxes(0, 1))
                - 3 * q * q * np.diag(weight)[:, :, None]
                + 12 * q * q * np.einsum("in,jn->ijn", d2, d2)
            )
        )
        first = h * d2 + dh * dy
        cross = np.einsum("in,jn->ijn", d2, dy)
        second = (
            h * np.diag(weight)[:, :, None]
            + dh * (cross + cross.swapaxes(0, 1) + ddy)
            + ddh * np.einsum("in,jn->ijn", dy, dy)
        )
        root = np.sqrt(h)
        gradient = first / (2 * root)
        return gradient, (
            second / (2 * root) - np.einsum("in,jn->ijn", gradient, gradient) / root
        ) / np.sqrt(safe)

    return _Measure(value, lambda: both()[0], both)


def _cosine(y: Array) -> tuple[Array, Array, Array]:
    """Return cos(arccos(y) / 3) and its first two derivatives; near y = 1 by their series."""
    y = np.clip(y, -1.0, 1.0)
    angle = np.arccos(y)
    near, gap = y > 1 - 1e-5, y - 1
    sine = np.where(near, 1.0, np.sin(angle))
    value = np.cos(angle / 3)
    slope = np.where(
        near, 1 / 9 - 8 / 243 * gap + 28 / 2187 * gap**2, np.sin(angle / 3) / (3 * sine)
    )
    bend = np.where(
        near, -8 / 243 + 56 / 2187 * gap, (y * slope - value / 9) / np.where(near, 1.0, sine**2)
    )
    return value, slope, bend


def _third(s: Array) -> Array:
    """Return the determinant of deviators."""
    xx, yy, zz, xy, yz, zx = _six(s)
    return xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx)


def _six(s: Array) -> Array:
    """Return all six components."""
    return s if len(s) == 6 else np.concatenate((s, np.zeros((2, s.shape[1]))))


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
    return np.array(rows)[: len(s), : len(s)]


class _Returned(NamedTuple):
    """Returned stresses (ncomp, n), plastic shear strains and shares of failure (n,), points
    without a solution.

    ``tangent()`` computes d stress / d strain, (n, ncomp, ncomp).
    """

    stress: Array
    strain: Array
    share: Array
    lost: NDArray[np.intp]
    tangent: Callable[[], Array]


class _System(NamedTuple):
    """Residuals of stress and yield over the strength, (ncomp + 1, n), their Jacobian, and the
    plastic strain.
    """

    residual: Array
    jacobian: Callable[[], Array]
    strain: Array


def returned(trial: Array, first: Array, share: Array, k: ADPConstants) -> _Returned:
    """Return trial stresses (ncomp, n) outside of the yield surface, from shares of failure w."""
    ncomp, n = trial.shape
    z, open_ = _start(trial, first, share, k), np.arange(n)
    step, base, least, halved = np.zeros_like(z), z.copy(), np.full(n, np.inf), np.zeros(n, int)
    for _ in range(_ITERATIONS):
        here = k.at(open_)
        now = _system(z[:, open_], trial[:, open_], first[:, open_], share[open_], here)
        error = np.abs(now.residual).max(axis=0)
        size = np.abs(trial[:, open_]).max(axis=0) / here.radius
        done = error <= _SOLVED * np.maximum(size, 1.0)
        better = (error < least[open_]) | (halved[open_] >= _HALVINGS)
        change = -np.linalg.solve(now.jacobian(), now.residual.T[:, :, None])[:, :, 0].T
        step[:, open_] = np.where(better, change, 0.5 * step[:, open_])
        base[:, open_] = np.where(better, z[:, open_], base[:, open_])
        halved[open_] = np.where(better, 0, halved[open_] + 1)
        least[open_] = np.where(better, error, least[open_])
        z[:, open_] = np.where(done, z[:, open_], base[:, open_] + step[:, open_])
        z[ncomp] = np.maximum(z[ncomp], 0.0)
        open_ = open_[~done]
        if not open_.size:
            break
    final = _system(z, trial, first, share, k)

    def tangent() -> Array:
        right = (
            np.concatenate((k.stiffness(ncomp), np.zeros((n, 1, ncomp))), axis=1)
            / k.radius[:, None, None]
        )
        return np.asarray(np.linalg.solve(final.jacobian(), right), dtype=float)[:, :ncomp]

    return _Returned(z[:ncomp], final.strain, z[ncomp] ** 2, open_, tangent)


def _start(trial: Array, first: Array, share: Array, k: ADPConstants) -> Array:
    """Return stress and root of w from which Newton's method begins: the mobilisation of the
    elastic stress.
    """
    root = np.sqrt(share)
    kappa = np.ones_like(share) if k.plastic else mobilised_by(root)[0]
    shear = measure(modified(trial, first, kappa, k), k)
    reached = np.clip(shear.value / k.radius, kappa, 1.0)
    excess = np.maximum(shear.value - k.radius, 0.0) / k.mu
    failure = _at_failure(modified(trial, first, kappa, k), k)[0]
    if not k.plastic:
        root = np.maximum(root, reached / (1 + np.sqrt(1 - reached * reached)))
    back = np.minimum(1.0, reached * k.radius / np.maximum(shear.value, 1e-300))
    centre = first + reached * _offset(first, k)
    deviator = trial - centre
    deviator[:3] -= deviator[:3].mean(axis=0)
    return np.concatenate(
        (trial - (1 - back) * deviator, np.sqrt(root * root + excess / failure)[None])
    )


def _at_failure(s: Array, k: ADPConstants) -> tuple[Array, Array]:
    """Return the plastic shear strain at failure in the direction of a deviator, and its gradient
    by the deviator.

    That of direct simple shear counts by the share of shear on horizontal planes in J2. The rest is
    of the active side where the vertical axis is compressed, of the passive one where it is
    extended, between them where it is neither.
    """
    weight, rows = _twice_shear(len(s))[:, None], [3] if len(s) == 4 else [4, 5]
    J2 = np.maximum(0.5 * (weight * s * s).sum(axis=0), 1e-300)
    horizontal = (s[rows] ** 2).sum(axis=0)
    rest, up = np.maximum(J2 - horizontal, 1e-14 * J2), _vertical(len(s))
    flat, along = horizontal / J2, -_SIDE * s[up] / np.sqrt(rest)
    v, mean, half = (
        np.clip(along, -1, 1),
        0.5 * (k.active + k.passive),
        0.5 * (k.active - k.passive),
    )
    by_rest = weight * s
    by_flat = -flat * by_rest / J2
    by_flat[rows] += 2 * s[rows] / J2
    by_rest[rows] = 0.0
    by_v = -0.5 * along * by_rest / rest
    by_v[up] -= _SIDE / np.sqrt(rest)
    of_side = mean + half * v * (1.5 - 0.5 * v * v)
    failure: Array = k.dss * flat + of_side * (1 - flat)
    return failure, (k.dss - of_side) * by_flat + 1.5 * half * (1 - v * v) * (1 - flat) * by_v


def _system(z: Array, trial: Array, first: Array, share: Array, k: ADPConstants) -> _System:
    """Return the equations of the return: the elastic stress less that of the plastic strain, and
    the yield surface.
    """
    ncomp = len(trial)
    stress, root = z[:ncomp], z[ncomp]
    kappa, rate = (np.ones_like(root), np.zeros_like(root)) if k.plastic else mobilised_by(root)
    s, C, project = modified(stress, first, kappa, k), k.stiffness(ncomp), _projection(k, ncomp)
    shear = measure(s, k)
    by_s, second = shear.both()
    failure, by_direction = _at_failure(s, k)
    normal = np.einsum("nij,in->jn", project, by_s)
    metric = np.r_[2.0, 2.0, 2.0, np.ones(ncomp - 3)][:, None]
    length = np.sqrt((metric * normal * normal).sum(axis=0))
    flow, grown = normal / length, root * root - share
    strain = failure * grown
    relaxed = np.einsum("nij,jn->in", C, flow)
    residual = (
        np.concatenate((stress - trial + strain * relaxed, (shear.value - kappa * k.radius)[None]))
        / k.radius
    )

    def jacobian() -> Array:
        turned = np.einsum("nki,kln->nil", project, second) / length[:, None, None]
        turned -= flow.T[:, :, None] * np.einsum("in,nil->nl", metric * flow, turned)[:, None, :]
        to_s = np.matmul(
            C,
            strain[:, None, None] * turned
            + (grown * flow).T[:, :, None] * by_direction.T[:, None, :],
        )
        moved = -rate[:, None] * np.einsum("nij,jn->ni", project, _offset(first, k))
        result = np.zeros((root.size, ncomp + 1, ncomp + 1))
        result[:, :ncomp, :ncomp] = np.eye(ncomp) + np.matmul(to_s, project)
        result[:, :ncomp, ncomp] = (
            np.einsum("nij,nj->ni", to_s, moved) + (2 * root * failure * relaxed).T
        )
        result[:, ncomp, :ncomp] = normal.T
        result[:, ncomp, ncomp] = np.einsum("in,ni->n", by_s, moved) - rate * k.radius
        return result / k.radius[:, None, None]

    return _System(residual, jacobian, strain)
