"""Lines of beams, reinforcement and bars of a stage, for pictures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import scipy
from numpy import ndarray

from ..arrays import row_norms
from ..results.fields import basis_of, has_solids
from ..results.stage import StageResult

#: Colours of beams and of bars.
BEAM = "#22313f"
BAR = "#c0392b"
#: Distance of the end of a bar from the node that moves it, as a share of the bar's length.
_SAME = 1e-6
#: Prefixes of the coordinates of both ends of bars.
_ENDS = ("", "end ")


class Lines(NamedTuple):
    """Elements of a form as lines.

    Attributes
    ----------
    name, color
        Name of the form, and its colour.
    points
        Ends of each element, between them its middle, (n, 2 or 3, dim).
    displacement
        Displacements of the points, likewise.
    """

    name: str
    color: str
    points: ndarray
    displacement: ndarray


def structures(stage: StageResult) -> Iterator[Lines]:
    """Yield beams and reinforcement of a stage, then its bars, which move with nodes."""
    beams, bars = _beams_and_bars(stage)
    yield from beams
    if not bars:
        return

    # Bars have the displacements of the nodes at their ends, fixed ends none.
    nodes, moves = _nodes(stage, beams)
    for name, points in bars.items():
        displacement = np.zeros_like(points)
        if len(nodes):
            distance, nearest = scipy.spatial.cKDTree(nodes).query(points)
            length = row_norms(points[:, 1] - points[:, 0])
            held = distance < _SAME * length[:, None]
            displacement[held] = moves[np.asarray(nearest)[held]]
        yield Lines(name, BAR, points, displacement)


def _beams_and_bars(stage: StageResult) -> tuple[list[Lines], dict[str, ndarray]]:
    """Return beams, whose nodes are start, end and middle, and ends of bars, (n, 2, dim)."""
    beams = []
    bars = {}
    for name in stage.states:
        if name not in stage.forms:
            continue
        outputs = stage.outputs(name)
        if outputs.points is not None:
            points, values = outputs.points
            order = [0, 2, 1]
            corners = points.reshape(-1, 3, points.shape[1])[:, order]
            displacement = np.asarray(values["displacement"])
            moved = displacement.reshape(corners.shape[0], 3, -1)[:, order]
            beams.append(Lines(name, BEAM, corners, moved[:, :, : corners.shape[2]]))
            continue
        members = outputs.members
        if "end x" in members:
            axes = [axis for axis in "xyz" if axis in members]
            ends = [np.column_stack([members[f"{end}{axis}"] for axis in axes]) for end in _ENDS]
            bars[name] = np.stack(ends, axis=1)
    return beams, bars


def _nodes(stage: StageResult, beams: Sequence[Lines]) -> tuple[ndarray, ndarray]:
    """Return nodes of beams and solids, and their displacements, (n, dim) each."""
    nodes = [line.points.reshape(-1, line.points.shape[2]) for line in beams]
    moves = [line.displacement.reshape(-1, line.points.shape[2]) for line in beams]
    if has_solids(stage):
        basis = basis_of(stage)
        dim = basis.mesh.dim()
        nodes.append(basis.doflocs[:, ::dim].T)
        moves.append(stage.x[: basis.N].reshape(-1, dim))
    if not nodes:
        return np.zeros((0, 0)), np.zeros((0, 0))
    return np.concatenate(nodes), np.concatenate(moves)
