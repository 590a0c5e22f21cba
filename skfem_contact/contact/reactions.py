"""Forces that dry contact can exert: cones of pressure and friction."""

from __future__ import annotations

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix, diags_array, hstack

from .base import ContactBase
from .interface import ContactState
from .kinematics import Kinematics
from .laws import Coulomb
from .quadrature import SlavePoints

#: Corners of the pyramid around a cone of friction in space; it exceeds the cone by .5 %.
_CORNERS = 32
#: ... and more friction than there is, so that no round-off decides whether forces balance.
_MARGIN = 1.005


def nodal_forces(
    pair: ContactBase, points: SlavePoints, at: ndarray, frame: Kinematics
) -> csr_matrix:
    """Return the map (size, dim n_points) from tractions, normal ones first, to nodal forces.

    Points other than those `at` which `frame` has the kinematics exert none.
    """
    n = len(points.weight)
    dim = pair.slave.dim
    weight = pair.share * points.weight[at]
    values = weight[:, None, None] * frame.expanded(frame.work)  # (n_at, dim, m)
    component = at[:, None] + n * np.arange(dim)
    rows = np.broadcast_to(frame.dofs[:, None], values.shape)
    columns = np.broadcast_to(component[:, :, None], values.shape)
    moving = rows >= 0
    entries = (values[moving], (rows[moving], columns[moving]))
    return coo_matrix(entries, shape=(pair.size, dim * n)).tocsr()


def reactions(pair: ContactBase, x: ndarray, state: ContactState) -> csr_matrix | None:
    """Return nodal forces (size, n) whose sums with factors >= 0 are all that contact can exert.

    They are those of a unit pressure with friction to each side, at all points that face the
    master, open ones as well: a body may turn until they touch. None stands for laws that are not
    Coulomb's without a bond.
    """
    points = pair.points(state)
    law = pair.law.take(points)
    if type(law) is not Coulomb or law.per_area:
        return None
    found = pair.interface.closest(x, state.cuts, state.facet)
    at = np.flatnonzero(found.found)
    frame = pair.interface.variations(x, state, found, at)
    forces = nodal_forces(pair, points, at, frame)
    n = len(points.weight)
    normal, *shear = (forces[:, at + c * n] for c in range(pair.slave.dim))

    # Pressure is negative; friction points to the corners of a pyramid around the cone
    mu = np.broadcast_to(law.mu, n)
    friction = _MARGIN * mu[at]
    if pair.slave.dim == 2:
        corners = np.array([[-1.0], [1.0]])
    else:
        angle = 2.0 * np.pi * np.arange(_CORNERS) / _CORNERS
        corners = np.stack((np.cos(angle), np.sin(angle)), axis=1) / np.cos(np.pi / _CORNERS)
    sides = []
    for corner in corners:
        along = sum(c * one for c, one in zip(corner, shear, strict=True))
        sides.append(along @ diags_array(friction) - normal)
    return csr_matrix(hstack(sides))
