r"""Stretch of a slave's area, by which strengths count the present area of bodies that strain.

Tractions are per undeformed area, so that their work is that of the nodes. A strength per present
area is j times as large per undeformed area, with

.. math::

    j = \frac{|a_1 \times a_2|}{|A_1 \times A_2|}

and the tangents a of the deformed facet, A of the undeformed one; in axial symmetry times the ratio
of the radii.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix

from ..arrays import row_norms
from ..surfaces.surface import Surface
from ..surfaces.vectors import across, cross
from .laws import InterfaceLaw, LawUpdate

#: Relative change of the stretch in differences of laws: strengths are linear in it.
_STEP = 1e-5


class Stretch(NamedTuple):
    """Stretch of a surface's area at points, and the nodes that change it.

    Attributes
    ----------
    values : ndarray, shape (n,)
        Present area over the undeformed one.
    slopes : ndarray, shape (n, k * dim)
        Derivatives by the displacements of the facet's nodes.
    dofs : ndarray, shape (n, k * dim)
        Dofs of these displacements, or -1.
    """

    values: ndarray
    slopes: ndarray
    dofs: ndarray

    @classmethod
    def of(cls, surface: Surface, nodes: ndarray, facet: ndarray, xi: ndarray) -> Stretch:
        """Return the stretch at present coordinates of the nodes, (n_nodes, dim)."""
        before = surface.at(facet, xi, surface.nodes)
        now = surface.at(facet, xi, nodes)
        area = row_norms(across(before.x[1]))
        normal = across(now.x[1])
        size = row_norms(normal)
        values = size / area

        # Differentiate the length of the normal by the tangents.
        tangents = now.x[1]
        derivatives = now.shapes[1]
        derivatives = np.broadcast_to(derivatives, (len(facet), *derivatives.shape[1:]))
        if surface.dim == 2:
            factors = tangents / (size * area)[:, None, None]
        else:
            unit = normal / size[:, None]
            by_first = cross(tangents[:, 1], unit)
            by_second = cross(unit, tangents[:, 0])
            factors = np.stack((by_first, by_second), axis=1) / area[:, None, None]
        slopes = np.einsum("nak,nac->nkc", derivatives, factors)

        # Circles about the axis grow with their radius.
        if surface.axisymmetric:
            radius = before.x[0][:, 0]
            shapes = np.broadcast_to(now.shapes[0], (len(facet), slopes.shape[1]))
            off_axis = radius > 0.0
            inverse = np.divide(1.0, radius, out=np.zeros_like(radius), where=off_axis)
            ratio = np.where(off_axis, now.x[0][:, 0] * inverse, 1.0)
            slopes = slopes * ratio[:, None, None]
            slopes[:, :, 0] += (values * inverse)[:, None] * shapes
            values = values * ratio
        dofs = surface.dofs_of(surface.facets[facet])
        n_dofs = int(np.prod(dofs.shape[1:]))
        dofs = dofs.reshape(len(facet), n_dofs)
        return cls(values, slopes.reshape(dofs.shape), dofs)

    def by_stretch(
        self,
        update: LawUpdate,
        again: Callable[[InterfaceLaw], LawUpdate],
        law: InterfaceLaw,
    ) -> ndarray:
        """Return the derivatives of tractions by the stretch, (dim, n).

        `again` evaluates another law at the points, and `law` is the law per present area.
        """
        larger = again(law.on_area(self.values * (1.0 + _STEP)))
        change = (larger.traction - update.traction) / (_STEP * self.values)
        return np.where(larger.status == update.status, change, 0.0)

    def tangent(self, dofs: ndarray, forces: ndarray, size: int) -> csr_matrix:
        """Return the tangent of forces by the stretch, (n, m), at the dofs of points, (n, m)."""
        rows = np.repeat(dofs, self.dofs.shape[1], axis=1).ravel()
        columns = np.tile(self.dofs, (1, dofs.shape[1])).ravel()
        data = (forces[:, :, None] * self.slopes[:, None]).ravel()
        known = (rows >= 0) & (columns >= 0)
        entries = (data[known], (rows[known], columns[known]))
        return csr_matrix(coo_matrix(entries, shape=(size, size)))
