"""Forces, moments and displacements at points of shells in space."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy import ndarray

from ..arrays import row_norms
from ..checks import format_point
from ..surfaces.vectors import dot
from .fields import has_solids
from .files import StageData

#: Titles of the fields of shells, and the kinds of their units.
FIELDS = {
    "ux": ("displacement along x", "length"),
    "uy": ("displacement along y", "length"),
    "uz": ("displacement along z", "length"),
    "u": ("displacement", "length"),
    "n_1": ("force n_1", "line"),
    "n_2": ("force n_2", "line"),
    "n_12": ("shear force n_12", "line"),
    "m_1": ("moment m_1", "moment"),
    "m_2": ("moment m_2", "moment"),
    "m_12": ("twisting moment m_12", "moment"),
}
#: Distance of a point from flat triangles, as a share of their size, up to which it lies on the
#: shell: a cylinder of square facets, 8 around it, is .14 of it away.
_NEAR = 0.15
#: Pairs of points and triangles that are compared at once: 200 bytes each.
_PAIRS = 250_000


def shells_of(stage: StageData) -> dict[str, tuple[ndarray, dict[str, ndarray]]]:
    """Return corners of triangles, (3 m, 3), and values there of the active shells by name."""
    found = {}
    for name in stage.states:
        triangles = stage.outputs(name).triangles if name in stage.forms else None
        if triangles is not None:
            found[name] = triangles
    return found


def shell_of(stage: StageData, of: str | None) -> str | None:
    """Return the active shell of a name, or the only one of a stage without solids, or None."""
    if of is None and has_solids(stage):
        return None
    shells = shells_of(stage)
    if of is None and len(shells) == 1:
        return next(iter(shells))
    if of is None and shells:
        listed = " or ".join(f"'{name}'" for name in shells)
        raise ValueError(f"stage '{stage.name}' has shells and no solids: name one, of={listed}")
    return of if of in shells else None


def on_shell(
    stage: StageData,
    name: str,
    points: ndarray,
    quantity: Sequence[str],
    since: StageData | None,
) -> dict[str, ndarray]:
    """Return fields at points of a shell, (n, 3), interpolated between corners of triangles."""
    corners, fields = _at_corners(stage, name)
    triangles = corners.reshape(-1, 3, 3)
    # Find the nearest triangles, of some points at once
    blocks = np.array_split(points, 1 + points.shape[0] * len(triangles) // _PAIRS)
    found = [_nearest(triangles, block) for block in blocks]
    cells, shares, distance = (np.concatenate(values) for values in zip(*found, strict=True))
    away = distance > _NEAR
    if away.any():
        raise ValueError(
            f"{away.sum()} of {len(points)} points lie outside of the shell '{name}': the first is "
            f"{format_point(points[away][0])}"
        )

    # Interpolate, without the values of the earlier stage
    if since is not None:
        earlier = _at_corners(since, name)[1]
        fields = {key: values - earlier[key] for key, values in fields.items()}
    return {key: (shares * fields[key].reshape(-1, 3)[cells]).sum(axis=1) for key in quantity}


def _at_corners(stage: StageData, name: str) -> tuple[ndarray, dict[str, ndarray]]:
    """Return the corners of the triangles of a shell, (3 m, 3), and their fields, (3 m,) each."""
    shells = shells_of(stage)
    if name not in shells:
        raise ValueError(f"the shell '{name}' is not active in stage '{stage.name}'")
    points, values = shells[name]
    u = values["displacement"]
    moved = dict(zip(("ux", "uy", "uz"), u.T, strict=True))
    return points, {**values, **moved, "u": row_norms(u)}


def _nearest(triangles: ndarray, points: ndarray) -> tuple[ndarray, ndarray, ndarray]:
    """Return the triangles nearest to points, the shares of their corners, (n, 3), and distances.

    The distance is a share of the size of the triangle.
    """
    # Barycentric coordinates of the projections onto the planes, (n, m, 3)
    a = triangles[:, 0]
    along = triangles[:, 1] - a
    across = triangles[:, 2] - a
    normal = np.cross(along, across)
    double = dot(normal, normal)
    slope = np.stack((np.cross(across, normal), np.cross(normal, along))) / double[:, None]
    off = points[:, None] - a
    second, third = np.einsum("nmc,kmc->knm", off, slope)
    shares = np.stack((1.0 - second - third, second, third), axis=2)

    # Points beyond a side are moved onto the triangle.
    shares = np.maximum(shares, 0.0)
    shares /= shares.sum(axis=2, keepdims=True)
    from_point = np.einsum("nmk,mkc->nmc", shares, triangles) - points[:, None]
    distance = np.linalg.norm(from_point, axis=2) / double**0.25
    cells = distance.argmin(axis=1)
    each = np.arange(len(points))
    return cells, shares[each, cells], distance[each, cells]
