"""Buckling of members: its loads, and how near the thrusts of a stage are to them."""

from __future__ import annotations

from functools import reduce
from operator import add

import numpy as np
from numpy import ndarray
from scipy.linalg import eigh
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import LinearOperator, eigsh

from ..errors import NotConverged, Remark
from ..forms.roles import Slender, having
from ..nonlinear.system import System
from ..results import modes as results
from ..results.result import Result
from ..results.stage import StageResult
from ..solvers.direct import SingularSystem, Solve
from ..sparse import scattered, within
from .setup import Setup
from .vibrations import check_number, symmetric_part, warn_of_penalties

#: Vectors of the Krylov space: the first mode of a column needs 4, of a frame of ten members 8.
_VECTORS = 12
#: Share of the largest energy of a vector below which it depends on the others.
_DEPENDENT = 1e-12
#: Up to so many free dofs the problem is solved as a full one.
_FEW = 300
#: Share of the largest eigenvalue below which it is round-off of members without thrust.
_NO_THRUST = 1e-10
#: Share of the buckling load from which second-order effects are reported.
_TOLD = 0.1


def remark_on(system: System, last: StageResult) -> tuple[str, Remark] | None:
    """Return the form whose thrust is nearest to buckling, and a remark, or None.

    The structure buckles under the thrust over mu, the largest eigenvalue of G v = mu K v with its
    tangent K and the stiffness G that thrusts take away. Moments of second order are larger by
    about 1 / (1 - mu).
    """
    # Stiffness that thrusts take away: (K - a G) mode = 0 at buckling.
    lost = _lost(system, last, _TOLD)
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
    advice = (
        "; hold the member or stiffen it; in the plane kinematics='finite' counts these moments"
    )
    return name, Remark("buckling", share, text + advice)


def buckling(setup: Setup, n: int, *, start: Result | StageResult) -> results.Buckling:
    """Return the loads at which a structure buckles, and its modes.

    The thrusts of the start grow by one factor; its tangent stays: small strains, displacements
    before buckling that are small, closed contact that stays closed. A beam with
    ``kinematics="finite"`` follows the path itself, which imperfections change.

    Parameters
    ----------
    n
        Number of modes.
    start
        Result, or one of its stages, with the thrusts.

    Raises
    ------
    ValueError
        Fewer modes, no thrust, finite kinematics, or a tangent that is not symmetric.

    Examples
    --------
    See :class:`~skfem_contact.results.Buckling`.
    """
    check_number(n)
    setup.refuse_finite("buckling loads are of small kinematics: finite ones follow the path")
    last = start[-1] if isinstance(start, Result) else start
    setup = setup.after(last)
    forms = {name: setup.forms[name] for name in last.states}
    system = setup.system(forms, np.union1d(setup.fixed, setup.inactive(forms)))

    # Stiffness of the start, and what its thrusts take away
    lost = _lost(system, last, 0.0)
    if not lost:
        raise ValueError("no member has a thrust at the start: nothing buckles")
    now = system.evaluate(last.x, last.states, last.load)
    K = symmetric_part(system.tangent(now), system.free)
    shares, modes = _modes(system, K, reduce(add, lost.values()), int(n))
    thrust = shares > _NO_THRUST * shares[0]
    if not thrust.all():
        raise ValueError(f"there are {int(thrust.sum())} modes with a thrust, not {n}")
    shapes = np.zeros((system.size, n))
    shapes[system.free] = modes
    energies = np.einsum("ik,ik->k", shapes, K @ shapes)
    warn_of_penalties(forms, now.responses, shapes, energies, ("buckling loads", 1.0))
    largest = shapes[np.abs(shapes).argmax(axis=0), np.arange(n)]
    return results.Buckling(1.0 / shares, shapes / largest, last)


def _lost(system: System, last: StageResult, share: float) -> dict[str, csr_matrix]:
    """Return the stiffness, (N, N), that the thrusts of each form take away."""
    lost = {}
    for name, form in having(system.forms, Slender).items():
        found = form.lost_by_thrust(last.states[name], share)
        if found is not None:
            dofs, matrix = found
            lost[name] = scattered(matrix, dofs, system.size)
    return lost


def _modes(system: System, K: csr_matrix, G: csr_matrix, n: int) -> tuple[ndarray, ndarray]:
    """Return the n largest mu of G v = mu K v among free dofs, descending, and their vectors."""
    free = system.free
    size = len(free)
    K_free = within(K, free)
    G_free = within(G, free)
    if size <= max(_FEW, 4 * n):
        shares, modes = eigh(G_free.toarray(), K_free.toarray())
    else:
        solve = system.factor(K)

        def inverse(right: ndarray) -> ndarray:
            whole = np.zeros(system.size)
            whole[free] = np.ravel(right)
            return solve(whole)[free]

        solved = LinearOperator(K_free.shape, matvec=inverse)
        begin = G_free @ np.cos(np.arange(size) ** 2.0)
        shares, modes = eigsh(G_free, n, K_free, Minv=solved, which="LA", v0=begin)
    order = np.argsort(shares)[::-1][:n]
    return shares[order], modes[:, order]


def _first_mode(solve: Solve, G: csr_matrix) -> tuple[float, ndarray]:
    """Return the largest eigenvalue of G v = mu K v, and its vector, from a Krylov space."""
    # build vectors w = K^-1 r, r = G w of the last one
    size = G.shape[0]
    r = np.where(G.diagonal() != 0.0, np.cos(np.arange(size) ** 2.0), 0.0)
    vectors = []
    forces = []
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
