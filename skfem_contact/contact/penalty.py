"""Penalty method, and default penalties from the stiffness of the surfaces."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from typing_extensions import override

from ..arrays import max_abs
from ..errors import Remark, warn
from ..forms.base import Form, Response, as_forms
from ..surfaces.surface import Surface
from .compliance import on_compliance, on_held_ends, on_penetration, on_round_off
from .enforcement import Enforcement
from .interface import ROUND_OFF, ContactState
from .kinematics import Kinematics, dragged, tangents, variations
from .laws import InterfaceLaw, LawUpdate, Status, resisting
from .symmetry import mirrored

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


def choose_penalties(forms: Mapping[str, Any]) -> dict[str, Form]:
    """Give contact pairs without a penalty a multiple of the stiffness of their surfaces.

    The stiffness of a surface is the stiffness of its nodes, each by itself, against pressure, per
    area: about E/h.  Slave and master act in series, so the softer one decides.  A surface without
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
    fixed: Collection[int] = (),
) -> tuple[tuple[float, float], float | None]:
    """Return penalties, chosen where none are given, and the stiffness of surfaces in series.

    At planes of symmetry, where `fixed` dofs hold the bodies, their mirror images count.

    Warns
    -----
    AnalysisWarning
        A given penalty is so hard that round-off hides the penetration.
    """
    # Surfaces without elements need a penalty of the user.
    stiffness = _in_series(slave, master, bodies, np.asarray(fixed, int))
    if stiffness is None:
        if penalty is None:
            raise ValueError(
                f"'{slave.name}' and '{master.name}' have no elements: give `penalty=` to "
                "ContactPair, or `stiffness=` to Surface.from_cells"
            )
        return penalty, None
    # Choose a penalty in proportion to the stiffness, softer along beams.
    if penalty is None:
        at_beam = not all(surface.meshed or surface.rigid for surface in (slave, master))
        along = 1.0
        if at_beam:
            along = _ALONG_BEAM
        penalty = (_RATIO * stiffness, along * _RATIO * stiffness)
    # Report penalties that hide the penetration.
    if warns and max(penalty) > _TOO_HARD * stiffness:
        warn(
            f"contact of '{slave.name}' on '{master.name}': the penalty, {max(penalty):.3g}, is "
            f"{max(penalty) / stiffness:.0e} times the stiffness of the surfaces: round-off hides "
            "the penetration; 1 to 1e3 times are enough"
        )
    return penalty, stiffness


def _in_series(
    slave: Surface,
    master: Surface,
    bodies: Sequence[csr_matrix],
    fixed: ndarray,
) -> float | None:
    """Return the stiffness of surfaces in series; rigid ones and some others have none.

    It is one value for the whole surface: a uniform pressure stays uniform, whatever the sizes of
    the elements.
    """
    # Rigid surfaces do not yield.
    moving = [surface for surface in (slave, master) if not surface.rigid]
    known = []
    for surface in moving:
        stiffness = _per_area(surface, bodies, slave.axisymmetric, fixed)
        if stiffness is not None:
            known.append(stiffness)
    # Two surfaces in series: 1 / k = 1 / k_1 + 1 / k_2.
    if len(known) == 2:
        return 1.0 / (1.0 / known[0] + 1.0 / known[1])
    if known:
        return known[0]
    if any(surface.meshed for surface in moving):
        raise ValueError(
            "there is no SolidForm among the forms: contact takes its stiffness from what it joins"
        )
    return None


def _per_area(
    surface: Surface,
    bodies: Sequence[csr_matrix],
    axisymmetric: bool,
    fixed: ndarray,
) -> float | None:
    """Return the largest stiffness of a facet against pressure per area, about E/h, if known.

    The stiffness along the surface does not count: in thin elements it is larger by the square of
    their shape.
    """
    if surface.stiffness is not None or not surface.meshed or not bodies:
        return surface.stiffness

    # Take the blocks of the nodes from the stiffness of all bodies, along the facets' normals
    dim = surface.dim
    blocks = np.zeros((dim, dim, len(surface.nodes)))
    for i in range(dim):
        for j in range(dim):
            blocks[i, j] = sum(K[surface.dofs[:, i], surface.dofs[:, j]] for K in bodies)

    # Add the mirror images of bodies: R K R with the reflection R
    for i, nodes in mirrored(surface, fixed, axisymmetric):
        reflection = np.ones(dim)
        reflection[i] = -1.0
        image = reflection[:, None] * reflection
        blocks[:, :, nodes] *= 1.0 + image[:, :, None]
    normal = surface.centres.normal
    at_nodes = np.einsum("si,ijsk,sj->sk", normal, blocks[:, :, surface.facets], normal)

    # Relate their mean to the area of a node
    intervals = int(surface.shape.exponents.max())  # between the nodes on a side
    stiffness = at_nodes.mean(axis=1) * (intervals / surface.size) ** (dim - 1)
    if axisymmetric:
        stiffness /= surface.centres.x[0][:, 0]
    if not (stiffness > 0).all():
        raise ValueError(f"boundary '{surface.name}' belongs to no solid among the forms")
    return float(stiffness.max())


@dataclass(frozen=True)
class Penalty(Enforcement):
    """Penalty method: tractions in proportion to the penetration and to the elastic slip.

    Bodies penetrate by the pressure over the penalty, which the pair has as `penalty=`.

    Examples
    --------
    >>> from skfem_contact.contact import Penalty
    >>> Penalty()
    Penalty()
    """

    keeps_penalty = True

    def law_in_increment(self, pair: Any) -> InterfaceLaw:
        """Return the law of the points while an equilibrium is looked for."""
        return pair.law

    @override
    def respond(self, pair: Any, x: ndarray, accepted: ContactState) -> Response:
        """Return the response of a pair whose points have tractions by their law (eq. 13)."""
        law = self.law_in_increment(pair)
        state = pair.effective(accepted)
        points = pair.points(state)
        eps_N, eps_T = pair.penalties(state)
        slave, nodes = pair.interface.positions(x)
        round_off = ROUND_OFF * max_abs(nodes)

        # Project the points that are closed or near; multipliers shift gap and slip
        closing = state.clearance - points.at(state.multiplier[0]) / eps_N
        found, everywhere = pair.interface.near(
            slave, nodes, state, closing + round_off, pair.depth(points), pair.held(state)
        )
        gap = found.gap - closing
        gap = np.where(np.abs(gap) <= round_off, 0.0, gap)
        closed = state.status != Status.OPEN
        reached = law.take(points).reaches(gap, state.internal, closed)
        at = np.flatnonzero(found.found & reached)

        # Update the law there
        near = points.take(at)
        stick = state.stick.take(at)
        kinematics = variations(
            near,
            pair.slave,
            master=pair.master,
            projection=found.take(at),
            slave_nodes=slave,
            nodes=nodes,
            stick=stick,
        )
        multiplied = near.at(state.multiplier[1:].T).T / eps_T
        slip = kinematics.slip.T + multiplied
        if pair.slip_shift is not None:
            slip = slip + pair.slip_shift[:, at]
        jump = np.concatenate((gap[None, at], slip))
        law = law.take(near)
        if pair.finite and law.per_area:
            stretch = pair.stretch(slave, near)
        else:
            stretch = None

        def of_law(law: InterfaceLaw) -> LawUpdate:
            return law.update(jump, state.internal[:, at], (eps_N, eps_T))

        update = of_law(law if stretch is None else law.on_area(stretch.values))

        # Integrate the work of the tractions, eq. 13
        weight = pair.share * near.weight
        work = kinematics.expanded(kinematics.work)
        force = weight[:, None] * np.einsum("in,nim->nm", update.traction, work)

        def candidate() -> ContactState:
            elastic = np.where(update.status == Status.OPEN, 0.0, update.elastic_slip - multiplied)
            new_stick = dragged(kinematics, pair.master, nodes, stick, elastic)
            closest = everywhere()
            slid = accepted.slip + pair.interface.slid(accepted, closest.closest)
            return state.after(closest, at, update, new_stick, slid)

        def stiffness(update: LawUpdate) -> csr_matrix:
            K = _stiffness(pair, kinematics, update, weight)
            if stretch is None:
                return K
            change = weight * stretch.by_stretch(update, of_law, law)
            forces = np.einsum("in,nim->nm", change, work)
            return csr_matrix(K + stretch.tangent(kinematics.dofs, forces, K.shape[0]))

        return Response(
            pair.gathering.force(kinematics.dofs, force),
            state=candidate,
            stiffness=lambda: stiffness(update),
            damped=lambda: stiffness(_limited(pair, update, slip)),
            round_off=max(eps_N, eps_T) * round_off * float(np.linalg.norm(weight)),
            active=at.tobytes() + update.status.tobytes(),
        )

    @override
    def remarks(
        self,
        pair: Any,
        x: ndarray,
        state: ContactState,
        meshed: ndarray,
    ) -> Iterator[Remark]:
        too_deep = list(on_penetration(pair, state))
        yield from too_deep or on_compliance(pair, x, state)
        yield from on_held_ends(pair, state)
        yield from on_round_off(pair, state)


def _stiffness(pair: Any, kinematics: Kinematics, update: LawUpdate, weight: ndarray) -> csr_matrix:
    """Return the tangent of the points' forces: eqs 14 to 16, or 20 to 22."""
    traction = weight * update.traction
    K = tangents(kinematics, traction, weight * update.tangent, pair.tangent == "exact")
    return pair.gathering.matrix(kinematics.dofs, K)


def _limited(pair: Any, update: LawUpdate, slip: ndarray) -> LawUpdate:
    """Return the update with tractions that the bodies resist; without any a round body turns."""
    largest = pair.largest_traction
    traction = np.clip(update.traction, -largest, largest)
    return resisting(update, slip)._replace(traction=traction)
