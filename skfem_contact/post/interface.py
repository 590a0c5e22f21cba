"""Contact on the slave's facets and at its points, for files and pictures: all that they need to know of pairs."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray

from ..contact import ContactPair
from ..stages.result import StageResult
from .tractions import Tractions, tractions


class Interface(NamedTuple):
    """A contact pair in a stage.

    Attributes
    ----------
    tractions
        At the points of the slave.
    normal
        Outward normals of the slave there, undeformed, (n, 2).
    nodes, shares
        Nodes that move each of them, and their shape functions, (n, k).
    facets
        Nodes of the slave's facets, (n_facets, k): ends, middle.
    members
        Facet and point of every pair of both, (2, m).
    """

    tractions: Tractions
    normal: ndarray
    nodes: ndarray
    shares: ndarray
    facets: ndarray
    members: ndarray

    def moved_by(self, u: ndarray) -> ndarray:
        """Displacements of the points, (n, 2), from those of all nodes, (n_nodes, 2)."""
        return np.einsum("nk,nkc->nc", self.shares, u[self.nodes])

    def on_facets(self) -> dict[str, ndarray]:
        """Means over the facets; the status is that of the point that carries most."""
        facet, point = self.members
        t = self.tractions
        weight = np.bincount(facet, t.weight[point])
        data = {}
        for name in ("pressure", "shear", "gap", "slip"):
            values = np.where(np.isfinite(v := getattr(t, name)), v, np.nan)
            data[name] = np.bincount(facet, (t.weight * values)[point]) / weight
        status = np.full(len(self.facets), -1)
        np.maximum.at(status, facet, np.asarray(t.status)[point])
        return data | {"status": status}


def interfaces(forms: Mapping[str, Any], step: StageResult) -> dict[str, Interface]:
    """The contact pairs that are there in a stage."""
    return {name: _interface(form, step, name) for name, form in forms.items()
            if isinstance(form, ContactPair) and name in step.states}


def _interface(pair: ContactPair, step: StageResult, name: str) -> Interface:
    state = step.states[name]
    points, slave = pair.points(state), pair.slave
    at = tractions(pair, state)
    end = slave.start + slave.length
    slack = 1e-6 * slave.length
    inside = (at.arc >= (slave.start - slack)[:, None]) & (at.arc <= (end + slack)[:, None])
    if slave.closed:  # its last facet ends where the first begins
        inside[-1] |= at.arc <= slack[-1]
    node = slave.dofs[:, 0] // 2
    return Interface(at, _normals(slave, at.arc), node[points.nodes], points.values, node[slave.segments],
                     np.array(np.nonzero(inside)))


def _normals(slave: Any, arc: ndarray) -> ndarray:
    """Outward normals of the slave's facets at arc positions: the chain has its body to the right."""
    facet = np.clip(np.searchsorted(slave.start, arc, side="right") - 1, 0, len(slave.segments) - 1)
    ends = slave.nodes[slave.segments[facet][:, :2]]
    along = (ends[:, 1] - ends[:, 0]) / np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)[:, None]
    return np.column_stack((-along[:, 1], along[:, 0]))
