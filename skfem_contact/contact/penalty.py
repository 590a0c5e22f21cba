"""Enforcement of contact: default penalties from the stiffness of the surfaces, and the augmented
Lagrangian method.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csc_matrix, csr_matrix, diags_array
from scipy.sparse.linalg import spsolve

from ..checks import is_number
from ..errors import warn
from ..forms.base import Form, as_forms
from ..surfaces.surface import Surface
from .interface import ContactState
from .laws import Status
from .quadrature import SlavePoints

logger = logging.getLogger("skfem_contact")

#: Penalty over the stiffness of the layers of elements beside the surfaces.  On the average over
#: many loads the nodal forces of a Hertz contact are closest to the exact ones at 6 to 12
#: (surface-to-surface rules, 10 and 20 elements in the half-width): softer ones blunt the contact,
#: harder ones show more of the mesh and take more iterations.  The penetration is about a sixth of
#: the compression of those layers. With 60 times the penalty has .1 and .9 % of the displacements
#: in the README and the guide, for .8 and 7.1 %, but pressures beside the edges of blocks that do
#: not match, from 15 to 30, then range from 0 to 30. The tangential penalty is the same: half of it
#: saves no iterations in partial slip, and blunts its reversal.
_RATIO = 6.0
#: Tangential penalty over the normal one beside beams and shells, which slip along most of their
#: length. With 1 a pit of 5 m beside a wall takes 30 iterations, and its strength reduction 304;
#: with .1 they take 19 and 122, for the same factor. The largest moment changes by .1 %.
_ALONG_BEAM = 0.1
#: A penalty that is larger than the stiffness by this factor leaves three digits of the
#: penetration.
_TOO_HARD = 1e9
#: Penalty over the stiffness of the surfaces that the method goes to from whatever it was given,
#: and the one that it goes to where the corrections hardly become less: in a tie of 3 elements with
#: 7 of a body 14 times as stiff by a tenth each time, so that 30 equilibria are not enough; with
#: the second one 26 iterations are.
_WANTED, _HARDEST = 10.0, 100.0
#: ... and the softest one that it starts from: with less, bodies might sink into each other by more
#: than an element.
_SOFTEST = 0.1
#: Share of the largest entry that is added to the products of the shape functions: fewer points
#: than nodes, as two on a quadratic facet, leave combinations of multipliers undetermined, which
#: are kept.
_INDIFFERENT = 1e-10
#: Share of the largest traction below which the mean at a node is none: beside a corner, where the
#: halves of an open element cancel, the last bits would decide.
_ROUND_OFF = 1e-12
#: A correction that has not become less by this factor so many times in a row will not do so.
_PROGRESS, _PATIENCE = 0.7, 2


def choose_penalties(forms: Mapping[str, Any]) -> dict[str, Form]:
    """Give every contact pair without a penalty a multiple of the stiffness of the surfaces that it
    joins.

    The stiffness of a surface is that of its nodes, each by itself, against pressure, per area:
    about E/h.  Slave and master act in series, so the softer one decides.  A surface without
    elements, see :meth:`Surface.from_cells`, has its own `stiffness`, or none; the other surface
    then decides alone.
    """
    given = as_forms(forms)
    return {name: form.completed(given) for name, form in given.items()}


def chosen(
    slave: Surface,
    master: Surface,
    bodies: Sequence[csr_matrix],
    penalty: tuple[float, float] | None,
    warns: bool,
) -> tuple[tuple[float, float], float | None]:
    """Return the penalties, chosen where none are given, and the stiffness of two surfaces in
    series.

    Warns
    -----
    AnalysisWarning
        A given penalty is so hard that round-off hides the penetration.
    """
    # one value for the whole surface: a uniform pressure stays uniform, whatever the sizes of the
    # elements
    moving = [surface for surface in (slave, master) if not surface.rigid]
    sides = [_per_area(surface, bodies, slave.axisymmetric) for surface in moving]
    known = [side for side in sides if side is not None]
    if not known and any(surface.meshed for surface in moving):
        raise ValueError(
            "there is no SolidForm among the forms: contact takes its stiffness from what it joins"
        )
    if not known and penalty is None:
        raise ValueError(
            f"'{slave.name}' and '{master.name}' have no elements: give `penalty=` to ContactPair, "
            f"or "
            "`stiffness=` to Surface.from_cells"
        )
    if not known:
        return penalty, None  # type: ignore[return-value]
    stiffness = known[0] if len(known) == 1 else 1.0 / (1.0 / known[0] + 1.0 / known[1])
    beside_beam = not all(surface.meshed for surface in moving)
    penalty = penalty or (
        _RATIO * stiffness,
        (_ALONG_BEAM if beside_beam else 1.0) * _RATIO * stiffness,
    )
    if warns and max(penalty) > _TOO_HARD * stiffness:
        warn(
            f"contact of '{slave.name}' on '{master.name}': the penalty, {max(penalty):.3g}, is "
            f"{max(penalty) / stiffness:.0e} times the stiffness of the surfaces: round-off hides "
            f"the "
            "penetration; 1 to 1e3 times are enough"
        )
    return penalty, stiffness


def _per_area(surface: Surface, bodies: Sequence[csr_matrix], axisymmetric: bool) -> float | None:
    """Return the largest stiffness of a facet against pressure per area, about E/h, or None where
    it is unknown.

    The stiffness along the surface does not count: in thin elements it is larger by the square of
    their shape.
    """
    if surface.stiffness is not None or not surface.meshed or not bodies:
        return surface.stiffness
    dim, middle = surface.dim, surface.centres
    normal = middle.normal
    blocks = np.array(
        [
            [sum(K[surface.dofs[:, i], surface.dofs[:, j]] for K in bodies) for j in range(dim)]
            for i in range(dim)
        ]
    ).reshape(dim, dim, -1)
    at_nodes = np.einsum("si,ijsk,sj->sk", normal, blocks[:, :, surface.facets], normal)
    intervals = int(surface.shape.exponents.max())  # between the nodes on a side
    stiffness = at_nodes.mean(axis=1) * (intervals / surface.size) ** (dim - 1)
    if axisymmetric:
        stiffness /= middle.x[0][:, 0]
    if not (stiffness > 0).all():
        raise ValueError(f"boundary '{surface.name}' belongs to no solid among the forms")
    return float(stiffness.max())


@dataclass(frozen=True)
class Progress:
    """Corrections over the penalties and their stalls, (dim, n_nodes), and the error of the
    tractions.
    """

    correction: ndarray | float = np.inf
    stalls: ndarray | int = 0
    error: float = np.inf

    def after(self, correction: ndarray, unfinished: ndarray, error: float) -> Progress:
        """Return the progress after one more correction; corrections that are small enough do not
        count.
        """
        no_less = unfinished & (np.abs(correction) > _PROGRESS * np.abs(self.correction))
        stalls = np.where(no_less, self.stalls + 1, 0)
        if (left := (stalls == _PATIENCE).any(axis=0)).any():
            logger.info(
                "augmented method: corrections at the nodes %s of the slave do not become less; "
                "the penalty "
                "acts there",
                np.flatnonzero(left),
            )
        return Progress(correction, stalls, error)


@dataclass(frozen=True)
class DualMultipliers:
    """Lagrange multipliers that Newton's method finds together with the displacements: no penalty,
    no tolerance.

    Tractions at the slave's nodes are dofs of the model, after the displacements in the vectors of
    its results. Nothing penetrates in the mean around a node, and what sticks does not slip.  One
    equilibrium is enough for an increment.  Elastic bodies take about 40 % of the iterations of
    :class:`AugmentedLagrangian`.  A penalty is neither needed nor used.

    Between nodes facets that do not match gape and overlap.  Searches for a collapse, initial
    states of the ground, two passes and slaves that are rigid need one of the other methods.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> block = MeshQuad().refined(1).with_defaults()
    >>> mesh = sc.join_bodies({"lower": block, "upper": block.translated((0., 1.))})
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> pair = sc.ContactPair(basis, "upper:bottom", "lower:top", sc.Coulomb(), enforcement=sc.DualMultipliers())
    >>> forms = {"blocks": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.)), "contact": pair}
    >>> x, top = basis.zeros(), basis.get_dofs("upper:top").all("u^2")
    >>> x[top] = -0.02                                                 # 1 % of the height
    >>> fixed = sorted({*top, *basis.get_dofs("lower:bottom").all(), *basis.get_dofs("upper:top").all()})
    >>> result = sc.Model(forms, fixed).run([sc.Stage("press", prescribed=x)], progress=False)
    >>> float(result["press"].tractions("contact").pressure.max().round(6))
    10.0
    """


@dataclass(frozen=True)
class AugmentedLagrangian:
    r"""Augmented Lagrangian method: multipliers take over the tractions until nothing penetrates.

    After an increment has converged, the tractions become multipliers,
    :math:`\lambda_N \leftarrow \lambda_N + \epsilon_N \bar g`, and the increment is solved again:
    each time the penetration shrinks by the factor :math:`1 / (1 + \epsilon_N / k)` with the
    stiffness k of the bodies' surfaces. The remaining gap and elastic slip, times k, are the error
    of the tractions.

    Multipliers live at the slave's nodes and are interpolated between them: multipliers at every
    Gauss point would constrain more than the nodes can follow.  At closed nodes they become the
    projection of the tractions onto these functions, which exerts the same nodal forces.  A node
    whose correction does not become less, as at the end of an interface on a fixed base, is left to
    the penalty, and the log names it.

    A given penalty is only the start.  It is brought between k/10 and 10 k before the first
    solution, to 10 k after it, and to 100 k where the corrections hardly become less.  Between the
    nodes facets that do not match gape and overlap, which is left to that penalty.

    Parameters
    ----------
    tolerance : float
        Error of the tractions, relative to the largest one, that is small enough; between 0 and 1.

    Examples
    --------
    >>> from skfem_contact import AugmentedLagrangian
    >>> AugmentedLagrangian().tolerance
    0.0001
    """

    tolerance: float = 1e-4

    def __post_init__(self) -> None:
        if not is_number(self.tolerance, 0.0, 1.0):
            raise ValueError(
                f"AugmentedLagrangian: tolerance must lie in (0, 1), not {self.tolerance!r}"
            )

    def start(self, penalties: tuple[float, float], stiffness: float) -> ndarray:
        """Return factors, shape (2,), that bring the penalties into the range of the first
        solution.
        """
        return np.clip(penalties, _SOFTEST * stiffness, _WANTED * stiffness) / penalties

    def augment(
        self,
        accepted: ContactState,
        found: ContactState,
        points: SlavePoints,
        penalties: tuple[float, float],
        stiffness: float,
        progress: Progress,
    ) -> tuple[ContactState, Progress]:
        """Return the accepted state, with improved multipliers unless these suffice, and the
        progress.
        """
        moves = np.broadcast_to(progress.stalls < _PATIENCE, accepted.multiplier.shape)
        after, correction, error = self._corrected(
            found, accepted.multiplier, points, penalties, stiffness, moves
        )
        unfinished = error > (limit := self.tolerance * np.abs(found.traction[0]).max(initial=0.0))
        if (
            progress.error == np.inf
        ):  # what was left to the penalty before is taken up again where it has changed
            _, left, before = self._corrected(
                accepted, accepted.multiplier, points, penalties, stiffness, moves
            )
            unfinished &= (before <= limit) | (stiffness * np.abs(correction - left) > limit)
        if not (unfinished & moves).any():
            return accepted, progress
        worst = float(error[moves].max())
        hardest = (_HARDEST if worst > _PROGRESS * progress.error else _WANTED) * stiffness
        factors = np.clip(penalties, hardest, _HARDEST * stiffness) / penalties
        improved = replace(
            accepted,
            multiplier=np.where(moves, after, accepted.multiplier),
            penalty_factor=accepted.penalty_factor * factors,
        )
        return improved, progress.after(correction, unfinished, worst)

    def error(
        self,
        state: ContactState,
        points: SlavePoints,
        penalties: tuple[float, float],
        stiffness: float,
    ) -> float:
        """Return the largest error of the tractions of an accepted state, relative to the largest
        of them.
        """
        moves = np.ones(state.multiplier.shape, dtype=bool)
        _, _, error = self._corrected(state, state.multiplier, points, penalties, stiffness, moves)
        return float(
            error.max() / max(np.abs(state.traction[0]).max(initial=0.0), np.finfo(float).tiny)
        )

    @staticmethod
    def _corrected(
        found: ContactState,
        before: ndarray,
        points: SlavePoints,
        penalties: tuple[float, float],
        stiffness: float,
        moves: ndarray,
    ) -> tuple[ndarray, ndarray, ndarray]:
        pressure = found.traction[0]
        largest = pressure.max(
            initial=0.0
        )  # a mean of tractions is no larger; zero where nothing pulls
        none = largest - _ROUND_OFF * np.abs(pressure).max(initial=0.0)
        closed = before[0] + _excess(points, pressure, before[0]) < none
        after = _improved(points, found.traction, before, closed & moves)
        after[0] = np.minimum(after[0], largest)
        after[:, _nodal_mean(points, np.abs(pressure)) == 0.0] = (
            0.0  # means of multipliers would vanish by halves
        )
        correction = (after - before) / np.array(
            [penalties[0], *penalties[1:] * (len(before) - 1)]
        )[:, None]
        # a sliding point's traction follows from the normal one; only where it sticks is its
        # elastic slip an error
        sticks = _nodal_mean(points, found.status == Status.STICK) > 0.99
        error = (
            stiffness
            * np.abs(correction)
            * np.stack((np.ones(len(sticks)), *[sticks] * (len(before) - 1)))
        )
        return after, correction, error


def _improved(
    points: SlavePoints, traction: ndarray, multiplier: ndarray, closed: ndarray
) -> ndarray:
    excess = np.stack([_excess(points, *rows) for rows in zip(traction, multiplier, strict=True)])
    forces = np.stack(
        [
            _integral(points, one - points.at(other), points.values)
            for one, other in zip(traction, multiplier, strict=True)
        ]
    )
    mass = _mass(points)
    mass = csc_matrix(
        mass + diags_array(np.full(mass.shape[0], _INDIFFERENT * mass.diagonal().max()))
    )
    for nodes in np.unique(
        closed, axis=0
    ):  # one factor for all directions with the same nodes, mostly all of them
        rows, at = np.flatnonzero((closed == nodes).all(axis=1)), np.flatnonzero(nodes)
        solution = spsolve(mass[at][:, at].tocsc(), forces[rows][:, at].T)
        excess[rows[:, None], at] = solution.reshape(len(at), len(rows)).T
    return multiplier + excess


def _excess(points: SlavePoints, traction: ndarray, multiplier: ndarray) -> ndarray:
    return _nodal_mean(points, traction - points.at(multiplier))


def _mass(points: SlavePoints) -> csc_matrix:
    N = points.values
    n, k = points.nodes.max() + 1, N.shape[1]
    products = points.weight[:, None, None] * N[:, :, None] * N[:, None, :]
    rows, columns = np.repeat(points.nodes, k, axis=1), np.tile(points.nodes, (1, k))
    return coo_matrix((products.ravel(), (rows.ravel(), columns.ravel())), shape=(n, n)).tocsc()


def _nodal_mean(points: SlavePoints, values: ndarray) -> ndarray:
    """Return nodal means of values at the points, weighted by the size of each node's shape
    function.

    With their sign the functions of a quadratic element have no weight on an axis of symmetry.
    """
    size = np.abs(points.values)
    weight = _integral(points, np.ones(len(values)), size)
    return _integral(points, values, size) / np.where(weight > 0.0, weight, np.inf)


def _integral(points: SlavePoints, values: ndarray, shapes: ndarray) -> ndarray:
    share = shapes * (points.weight * values)[:, None]
    return np.asarray(np.bincount(points.nodes.ravel(), share.ravel(), points.nodes.max() + 1))
