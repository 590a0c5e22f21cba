"""Nodes of beams: their dofs for supports and bars, and loads on them."""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from ..checks import finite, format_point, vector
from ..forms.base import Form
from ..layout import Field, FieldDofs

#: Coordinates are those of a node if they are nearer than this share of the beam.
_AT = 1e-6
#: Names of the dofs of a node.
DofName = Literal["u^1", "u^2", "theta"]


class BeamNodes(Form):
    """Form of nodes with displacements and rotations, which are its own or, the displacements, those of the ground."""

    points: ndarray
    _shared: ndarray | None
    _displacement: Field
    _rotation: Field
    _dofs: ndarray | None = None

    def node(self, at: ArrayLike) -> int:
        """Return the number of the node at coordinates (2,)."""
        point = vector(at, 2, "at")
        distance, node = cKDTree(self.points).query(point)
        if distance > _AT * np.ptp(self.points, axis=0).max():
            raise ValueError(f"the beam has no node at {format_point(point)}; the nearest one is at "
                             f"{format_point(self.points[node])}")
        return int(node)

    def dofs(self, at: ArrayLike, names: Sequence[DofName] = ("u^1", "u^2", "theta")) -> list[Any]:
        """Return the dofs of the node at coordinates (2,), by default all, for the supports of a model.

        At a hinge ``"theta"`` is the rotation of the first element that meets there.

        """
        node = self.node(at)
        found: list[Any] = []
        for name in names:
            if name == "theta":
                found.append(FieldDofs(self._rotation, np.array([node])))
            elif self._shared is not None:
                found.append(self._shared[node, [("u^1", "u^2").index(name)]])
            else:
                found.append(FieldDofs(self._displacement, np.array([2 * node + ("u^1", "u^2").index(name)])))
        return found

    def at(self, points: ArrayLike) -> ndarray | FieldDofs:
        """Return nodes at coordinates (n, 2) or (2,) as ends of bars: ``Bar(basis, wall.at((0., -1.5)), ...)``.

        Examples
        --------
        >>> import skfem_contact as sc
        >>> wall = sc.Beam(None, [[0., 0.], [0., -4.]], EI=1e4, EA=1e6)
        >>> sc.Bar(None, wall.at((0., 0.)), (5., -5.), EA=1e5, fixed_end=True, spacing=2.)
        <Bar 1 bars, EA/L 1.414e+04 to 1.414e+04>
        """
        nodes = np.array([self.node(point) for point in np.atleast_2d(finite(points, "points"))])
        if self._shared is not None:
            return self.points[nodes]
        return FieldDofs(self._displacement, 2 * nodes[:, None] + np.arange(2))

    def numbers(self, at: ArrayLike) -> ndarray:
        """Return the numbers of the dofs (u^1, u^2, theta) of the node at coordinates (2,), of a model's beam."""
        node = self.node(at)
        return self._of_model()[[2 * node, 2 * node + 1, 2 * len(self.points) + node]]

    def load(self, force: ArrayLike, at: ArrayLike, moment: float = 0.0) -> ndarray:
        """Return the load vector of a force, (2,), and an anticlockwise moment at a node, of a model's beam."""
        load = np.zeros(self._of_model().max() + 1)
        load[self.numbers(at)] = [*vector(force, 2, "force"), moment]
        return load

    def _of_model(self) -> ndarray:
        if self._dofs is None:
            raise ValueError('the dofs of the beam are not numbered yet: take it from the model, model.forms["beam"]')
        return self._dofs
