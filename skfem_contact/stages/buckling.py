"""Buckling of members at the end of a stage: how near their thrusts are to it."""

from __future__ import annotations

from functools import reduce
from operator import add

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..errors import NotConverged, Remark
from ..forms.roles import Slender, having
from ..nonlinear.system import System
from ..results.stage import StageResult
from ..solvers.direct import SingularSystem, Solve
from ..sparse import scattered

#: Vectors of the Krylov space: the first mode of a column needs 4, of a frame of ten members 8.
_VECTORS = 12
#: Share of the largest energy of a vector below which it depends on the others.
_DEPENDENT = 1e-12
#: Share of the buckling load from which second-order effects are reported.
_TOLD = 0.1


def buckling(system: System, last: StageResult) -> tuple[str, Remark] | None:
    """Return the form whose thrust is nearest to buckling, and a remark, or None.

    The structure buckles under the thrust over mu, the largest eigenvalue of G v = mu K v with its
    tangent K and the stiffness G that thrusts take away. Moments of second order are larger by
    about 1 / (1 - mu).
    """
    # Stiffness that thrusts take away: (K - a G) mode = 0 at buckling.
    lost = {}
    for name, form in having(system.forms, Slender).items():
        found = form.lost_by_thrust(last.states[name])
        if found is not None:
            dofs, matrix = found
            lost[name] = scattered(matrix, dofs, system.size)
    if not lost:
        return None
    G = reduce(add, lost.values())
    try:
        now = system.evaluate(last.x, last.states, last.load)
        solve = system.factor(system.tangent(now))
        share, mode = _first_mode(solve, G)
    except (SingularSystem, NotConverged, np.linalg.LinAlgError):
        return None
    if not share > _TOLD:
        return None

    # name the member of the largest share in the mode
    parts = {name: float(mode @ (matrix @ mode)) for name, matrix in lost.items()}
    name = max(parts, key=lambda key: parts[key])
    # Moments grow by 1 / (1 - share).
    if share < 1.0:
        text = (
            f"its thrust is {share:.0%} of the load at which the structure buckles: moments of "
            f"second order, which are left out, add about {1.0 / (1.0 - share) - 1.0:.0%}"
        )
    else:
        text = f"its thrust is {share:.3g} times the load at which the structure buckles"
    advice = "; hold the member, stiffen it, or check it by a theory of second order"
    return name, Remark("buckling", share, text + advice)


def _first_mode(solve: Solve, G: csr_matrix) -> tuple[float, ndarray]:
    """Return the largest eigenvalue of G v = mu K v, and its vector, from a Krylov space."""
    # build vectors w = K^-1 r, r = G w of the last one
    size = G.shape[0]
    r = np.where(G.diagonal() != 0.0, np.cos(np.arange(size) ** 2.0), 0.0)
    vectors, forces = [], []
    for _ in range(_VECTORS):
        w = solve(r)
        length = np.linalg.norm(w)
        if not length > 0.0:
            break
        vectors.append(w / length)
        forces.append(r / length)
        r = G @ vectors[-1]

    # solve the small problem in a basis that is orthogonal in K
    W = np.array(vectors).T
    K_small = W.T @ np.array(forces).T
    energy, basis = np.linalg.eigh(0.5 * (K_small + K_small.T))
    kept = energy > _DEPENDENT * energy.max()
    basis = basis[:, kept] / np.sqrt(energy[kept])
    Q = W @ basis
    values, modes = np.linalg.eigh(Q.T @ (G @ Q))
    return float(values[-1]), Q @ modes[:, -1]
