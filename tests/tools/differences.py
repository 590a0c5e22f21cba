"""The tangent of a contact pair beside differences of its force, row by row."""

from __future__ import annotations

import numpy as np
from numpy import ndarray

import skfem_contact as sc
from skfem_contact.contact.interface import ContactState
from tests.tools.helpers import closest

#: Step of the differences; lengths are of the order 1, penetrations of the order 0.03.
STEP = 1e-5
#: Plain central differences do not reach this: they carry h^2 / 6 of a third derivative, which
#: beside a vertex is 1/g^2 = 1e3 and more of the tangent, and round-off of the force over h.  With
#: four points h^4 / 30 of a fifth derivative is left, 1e-14 of the tangent, and 1e-16 of the
#: coordinates over h and the penetration: 1e-9.
TOLERANCE = 1e-7
#: Fourth-order central difference: steps and weights.
_ENDS = ((1, 8 / 12), (-1, -8 / 12), (2, -1 / 12), (-2, 1 / 12))


def difference(
    pair: sc.ContactPair, state: ContactState, x: ndarray, direction: ndarray
) -> tuple[ndarray, ndarray]:
    """Fourth-order difference of the force along a direction, and which points are smooth.

    Returns
    -------
    tuple
        The difference, (N,), NaN at unknowns of points that pass a kink on the way: of status,
        segment or vertex; and the points that have no such unknown, (n_points,).
    """
    ends = [_at(pair, state, x + k * STEP * direction) for k, _ in _ENDS]
    kinked = np.any([kind != ends[0][1] for _, kind, _ in ends[1:]], axis=(0, 2))
    touched = np.unique([unknowns[kinked] for *_, unknowns in ends])
    numeric = (
        sum(weight * force for (_, weight), (force, *_) in zip(_ENDS, ends, strict=True)) / STEP
    )
    numeric[touched[touched >= 0]] = np.nan
    return numeric, ~np.isin(ends[0][2], touched[touched >= 0]).any(axis=1)


def _at(pair: sc.ContactPair, state: ContactState, x: ndarray) -> tuple[ndarray, ndarray, ndarray]:
    """The force; status, segment and vertex of every point; the unknowns that move the point and
    what it faces.
    """
    where, out = closest(pair, state, x), pair.assemble(x, state)
    points, facing = pair.points(state), pair.master.facets[where.facet]
    stick = pair.master.dofs[pair.master.facets[state.stick_facet]]
    dofs = np.concatenate((pair.slave.dofs[points.nodes], pair.master.dofs[facing], stick), axis=1)
    kind = np.stack((out.state.status, where.facet, where.feature), axis=1)
    return out.force, kind, dofs.reshape(len(dofs), -1)


def tangent_error(
    pair: sc.ContactPair, state: ContactState, x: ndarray, directions: ndarray
) -> tuple[float, ndarray]:
    """Largest error of the tangent over the size of its row, and the status of the points that it
    covers.

    The size of a row is ``|K| |d|``: terms that cancel do not make the error look small, nor do
    other rows. Rows below a thousandth of the largest, where only open points and round-off are,
    count as a thousandth.
    """
    out = pair.assemble(x, state)
    K, error, smooth = out.stiffness, 0.0, np.ones(len(state.gap), bool)
    for d in directions:
        numeric, at = difference(pair, state, x, d)
        size = abs(K) @ np.abs(d)
        error = max(
            error, float(np.nanmax(np.abs(K @ d - numeric) / np.maximum(size, 1e-3 * size.max())))
        )
        smooth &= at
    return error, out.state.status[smooth]
