"""Energies and motions of a stage in time, step by step."""

from __future__ import annotations

from array import array
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray

from ..arrays import max_abs
from ..dynamics.mass import lumped
from ..dynamics.scheme import Motion
from ..forms.roles import Dissipating, Touching, Wet, having
from ..nonlinear.system import System
from .slides import Slides

#: Name of the form of inertia in the system of a stage; results have its forces as `inertial`.
INERTIA = "inertia"
#: Time, kinetic, elastic, plastic, friction, damping, work.
_COLUMNS = 7


class _End(NamedTuple):
    """Displacements, load, reactions and internal forces by form at the end of a step."""

    x: ndarray
    load: ndarray
    reaction: ndarray
    forces: Mapping[str, ndarray]


class Log:
    """Energies and motions of recorded nodes, step by step.

    The work of a step is that of the means of the forces at both of its ends, which is exact for
    forces that change in proportion. Forms know the share that they dissipate; the rest is elastic.

    Parameters
    ----------
    system
        System with the form of inertia.
    in_time
        Inertia of the stage, an :class:`~skfem_contact.stages.in_time.InTime`.
    states
        States of the forms at the start.
    """

    def __init__(self, system: System, in_time: Any, states: Mapping[str, Any]) -> None:
        self._pairs = set(having(system.forms, Touching))
        self._wet = set(having(system.forms, Wet))
        self.slides = Slides()
        # Forms that never change do not dissipate.
        self._dissipating: dict[str, Any] = {}
        for name, form in having(system.forms, Dissipating).items():
            if form.changing is None or len(form.changing):
                self._dissipating[name] = form
        self._states = states
        self._fixed = system.fixed
        self._M = in_time.M
        self._masses = lumped(in_time.M)
        self._points = in_time.points
        self._in_time = in_time
        self._rows = array("d")  # a list of numbers takes five times the memory
        self._motions: list[ndarray] = []
        self._base: list[ndarray] = []
        self._began = 0.0
        self._elastic = self._plastic = self._friction = self._flow = self._work = 0.0
        self._squares = np.zeros(2)
        self._last: _End | None = None

    def add(
        self,
        time: float,
        motion: Motion,
        load: ndarray,
        forces: Mapping[str, ndarray],
        states: Mapping[str, Any] | None = None,
    ) -> None:
        """Record the end of a step, with the forces of all forms and the states of some."""
        if not self._rows:
            self._began = time
        # Supports react to the forces of forms, inertia and load.
        at = self._fixed
        reaction = motion.force[at] - load[at]
        for force in forces.values():
            reaction += force[at]
        now = _End(motion.x, load, reaction, forces)
        if self._last is not None:
            self._add_work(self._last, now, self._states if states is None else states)
        self._last = now
        # Write the energies down.
        kinetic = 0.5 * self._squared(motion.velocity)
        if self._wet:
            inertial = self._squared(motion.acceleration)
            self._squares += (2.0 * kinetic, inertial)
        dissipated = self._plastic, self._friction, motion.damped + self._flow
        self._rows.extend((time, kinetic, self._elastic, *dissipated, self._work))
        # Write the motions down.
        if self._points.size:
            at_points = (motion.x, motion.velocity, motion.acceleration)
            self._motions.append(np.array([values[self._points] for values in at_points]))
            if self._in_time.base and not self._in_time.of_rock:
                self._base.append(self._in_time.base_motion(time - self._began))

    def _squared(self, values: ndarray) -> float:
        """Return the square of the values, weighted with the masses."""
        if self._masses is not None:
            return float(np.dot(self._masses * values, values))
        return float(values @ (self._M @ values))

    def _add_work(self, last: _End, now: _End, states: Mapping[str, Any]) -> None:
        """Add the work of a step, and divide that of the forms."""
        # Work follows from the mean of the forces at both ends.
        moved = now.x - last.x
        self._work += 0.5 * (float(last.load @ moved) + float(now.load @ moved))
        self._work += 0.5 * float((last.reaction + now.reaction) @ moved[self._fixed])
        # What a form does not dissipate, it stores.
        for name, force in now.forces.items():
            work = 0.5 * (float(last.forces[name] @ moved) + float(force @ moved))
            lost = 0.0
            if name in self._dissipating and states is not self._states:
                form = self._dissipating[name]
                lost = form.dissipated(self._states[name], states[name], work)
            self._elastic += work - lost
            if name in self._pairs:
                if states is not self._states:
                    self.slides.add(name, self._states[name], states[name])
                self._friction += lost
            elif name in self._wet:
                self._flow += lost
            else:
                self._plastic += lost
        self._states = states

    def series(self) -> dict[str, ndarray]:
        """Return energies, (n, 7), motions, (n, 3, n_points, dim), and base, (n, 3, dim)."""
        found = {"energy": self._energies.copy()}
        if self._motions:
            found["motion"] = np.array(self._motions)
            found["points"] = self._points
        if self._base:
            found["base"] = np.array(self._base)
        return found

    @property
    def _energies(self) -> ndarray:
        """Energies of all steps, (n, 7), for as long as none is added."""
        return np.frombuffer(self._rows).reshape(-1, _COLUMNS)

    @property
    def frequency(self) -> float:
        """Angular frequency of motions with water, from squares of accelerations and velocities."""
        moved, inertial = self._squares
        if moved > 0.0:
            return float(np.sqrt(inertial / moved))
        return 0.0

    def gained(self) -> float:
        """Return the energy that comes from nowhere, as a share of the largest one."""
        _, kinetic, *spent, work = self._rows[-_COLUMNS:]
        first = self._rows[1]
        inner = sum(spent[:-1])
        gained = kinetic + sum(spent) - first - work
        return gained / max(kinetic, abs(inner), first, abs(work), 1e-300)

    def missing(self) -> float:
        """Return the energy that the scheme has taken, as a share of the largest one."""
        _, kinetic, elastic, plastic, friction, damped, work = self._energies.T
        inner = elastic + plastic + friction
        lost = kinetic[0] + work[-1] - kinetic[-1] - inner[-1] - damped[-1]
        largest = max(max_abs(each) for each in (kinetic, inner, work))
        if largest > 0.0:
            return float(lost / largest)
        return 0.0

    def gained_by_contact(self) -> float:
        """Return the energy that contact has given, as a share of the largest one.

        Friction takes energy only; steps that are long for penalties return more than they stored.
        """
        _, kinetic, _, _, friction, _, work = self._energies.T
        gained = -float(np.minimum(np.diff(friction), 0.0).sum())
        largest = max(float(kinetic.max()), max_abs(work))
        return gained / max(largest, 1e-300)

    def summary(self) -> str:
        """Return the kinetic energy, and the energy that the scheme has taken, in one line."""
        kinetic = self._energies[:, 1]
        share = self.missing()
        return (
            f"kinetic energy {kinetic[-1]:.4g}, {round(share, 4) + 0.0:.2%} of the energy missing"
        )
