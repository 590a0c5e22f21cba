r"""Bodies that contact alone holds: how much of a change of the load it can hold.

A body is in equilibrium only if its contact forces balance the others in each rigid motion
:math:`m` that supports and other forms leave free,

.. math:: m \cdot (f + s\, \Delta f) = m \cdot \sum_j a_j c_j, \qquad a_j \ge 0,

with the forces :math:`c_j` of pressures and friction, of which contact exerts the sums. The
largest :math:`s` is found by linear programming, which is the static theorem of limit analysis for
rigid blocks (R. K. Livesley 1978). Friction is no associated flow: bodies may slide under less, but
under more nothing holds them, elastic or not.
"""

from __future__ import annotations

import numpy as np
import scipy
from numpy import ndarray

from ..arrays import max_abs
from ..forms.base import Response
from ..forms.roles import Touching, having
from ..layout import rigid_modes
from ..sparse import Total, parts_of
from .step import Step
from .system import System

#: Forces of a motion that nothing but contact resists, as a share of the stiffness: round-off.
_NOTHING = 1e-10


def share_held(step: Step, load: ndarray, reached: ndarray | None) -> float:
    """Return the largest share of a step from a load that contact may hold, at most 1.

    It is 1 where bodies are held in another way, or nothing is known. Contact is that of the
    accepted displacements and of the last ones that were reached, which may hold more unless bodies
    have flown away.
    """
    solids = step.system.layout.n_displacements > 0
    if not (solids and having(step.system.forms, Touching)):
        return 1.0
    places = [step.x]
    if reached is not None:
        moved = (reached - step.x)[step.system.layout.parts[0]]
        if max_abs(moved) < np.ptp(step.system.layout.fields[0].coordinates):
            places.append(reached)
    return max(_share_held_at(x, step, load) for x in places)


def _share_held_at(x: ndarray, step: Step, load: ndarray) -> float:
    """Return the share where bodies are at displacements x."""
    system = step.system
    states = step.states
    change = step.load - load
    pairs = having(system.forms, Touching)
    responses = system.responses(x, states)
    motions = _free_motions(system, [r for name, r in responses.items() if name not in pairs])
    if motions.shape[1] == 0:
        return 1.0
    columns = []
    for name, pair in pairs.items():
        operator = pair.tractions_at(x, states[name])
        forces = None if operator is None else operator.reactions()
        if forces is None:
            return 1.0
        columns.append(motions[: forces.shape[0]].T @ forces)
    others = sum(r.force for name, r in responses.items() if name not in pairs)

    # Scale forces by the largest ones; contact acts on the bodies against its internal forces
    begun = motions.T @ (load - others)
    added = motions.T @ change
    size = max(np.abs(added).max(), np.abs(begun).max())
    if not np.abs(added).max() > _NOTHING * np.abs(change).sum():
        return 1.0
    reactions = np.hstack(columns)
    reactions = reactions / np.maximum(np.abs(reactions).max(axis=0), np.finfo(float).tiny)
    equations = np.column_stack((reactions, -added / size))
    n = equations.shape[1]
    found = scipy.optimize.linprog(
        -np.eye(n)[-1],
        A_eq=equations,
        b_eq=begun / size,
        bounds=[(0.0, None)] * (n - 1) + [(0.0, 1.0)],
    )
    if found.x is None or found.status != 0:
        return 1.0
    return float(found.x[-1])


def _free_motions(system: System, others: list[Response]) -> ndarray:
    """Return the rigid motions of bodies against which forms and supports do nothing, (N, m)."""
    n = system.size
    if not others:
        return np.zeros((n, 0))
    stiffness = Total().of([response.stiffness for response in others])
    links = stiffness.tocoo()
    part = parts_of(n, links.row, links.col)
    displacements = system.layout.parts[0]
    where = system.layout.fields[0].coordinates
    stiff = np.diff(stiffness.indptr[: displacements.stop + 1]) > 0
    is_fixed = np.zeros(n, bool)
    is_fixed[system.fixed] = True
    size = abs(stiffness).max()
    motions = [np.zeros((n, 0))]
    for number in np.unique(part[displacements][stiff]):
        dofs = np.flatnonzero(part == number)
        if dofs[-1] >= displacements.stop:
            continue
        modes = rigid_modes(where, dofs)
        resisted = np.vstack((modes[is_fixed[dofs]], stiffness[dofs][:, dofs] @ modes / size))
        _, values, right = np.linalg.svd(resisted, full_matrices=False)
        free = right[np.count_nonzero(values > _NOTHING) :].T
        moved = np.zeros((n, free.shape[1]))
        moved[dofs] = modes @ free
        motions.append(moved)
    return np.hstack(motions)
