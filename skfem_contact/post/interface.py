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
    displacement
        Of these points, (n, 2).
    facets
        Nodes of the slave's facets, (n_facets, k): ends, middle.
    members
        Facet and point of every pair of both, (2, m).
    """

    tractions: Tractions
    normal: ndarray
    displacement: ndarray
    facets: ndarray
    members: ndarray

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
    moved = points.positions(slave.positions(step.x)) - points.positions(slave.nodes)
    at = tractions(pair, state)
    end = slave.start + slave.length
    slack = 1e-6 * slave.length
    inside = (at.arc >= (slave.start - slack)[:, None]) & (at.arc <= (end + slack)[:, None])
    if slave.closed:  # its last facet ends where the first begins
        inside[-1] |= at.arc <= slack[-1]
    return Interface(at, _normals(slave, at.arc), moved, slave.dofs[slave.segments, 0] // 2,
                     np.array(np.nonzero(inside)))


def _normals(slave: Any, arc: ndarray) -> ndarray:
    """Outward normals of the slave's facets at arc positions: the chain has its body to the right."""
    facet = np.clip(np.searchsorted(slave.start, arc, side="right") - 1, 0, len(slave.segments) - 1)
    ends = slave.nodes[slave.segments[facet][:, :2]]
    along = (ends[:, 1] - ends[:, 0]) / np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)[:, None]
    return np.column_stack((-along[:, 1], along[:, 0]))
