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
        Outward normals of the slave there, undeformed, (n, dim).
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
        """Displacements of the points, (n, dim), from those of all nodes, (n_nodes, dim)."""
        return np.einsum("nk,nkc->nc", self.shares, u[self.nodes])

    def on_facets(self) -> dict[str, ndarray]:
        """Means over the facets; the status is that of the point that carries most."""
        facet, point = self.members
        t = self.tractions
        weight = np.bincount(facet, t.weight[point])
        data = {}
        for name in ("pressure", "shear", "gap", "slip"):
            values = np.where(np.isfinite(v := getattr(t, name)), v, np.nan)
            total = np.zeros((len(self.facets), *values.shape[1:]))
            np.add.at(total, facet, (t.weight * values.T).T[point])
            data[name] = (total.T / weight).T
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
    node, normal = slave.dofs[:, 0] // slave.dim, slave.at(points.facet, points.xi, slave.nodes).normal
    members = np.stack((points.facet, np.arange(len(points.facet))))
    if points.nodes.shape[1] == 1:  # a node belongs to all of its facets
        number = np.full(len(node), -1)
        number[points.nodes[:, 0]] = np.arange(len(points.nodes))
        facet = np.repeat(np.arange(len(slave.facets)), slave.facets.shape[1])
        members = np.stack((facet, number[slave.facets.ravel()]))[:, number[slave.facets.ravel()] >= 0]
    return Interface(at, normal, node[points.nodes], points.values, node[slave.facets], members)
