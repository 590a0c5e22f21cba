"""Steps in time of bodies that creep, as short as the error of their strains requires.

The strains of a step follow from its change of stress. At some points they are computed again in
three parts of this change, as in :mod:`.accuracy`. Where stresses are held a step is exact however
long it is; the error comes from stresses that change within it. It is measured in the norm of the
elastic energy, as a share of the largest step of the stage.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy import ndarray

from ..errors import InadmissibleStress, IncrementTooLarge
from ..forms.roles import Body, having
from ..laboratory.specimen import elasticity_at
from .accuracy import PARTS, Sample, chosen, followed, record

#: Allowed error of the strains of a step. A sample that is sheared in a day is then off by 4 %, a
#: strip on normally consolidated clay by .9 %, for 30 and 5 % in one step, in 7 and 5 steps; with
#: twice as much by 6 and 1.6 %, in 5 and 3 steps.
_ALLOWED = 0.01
#: Share of a stage that is short enough.
_SHORT = 1.0 / 256.0


def creep_errors(
    forms: Mapping[str, Any],
    states: tuple[Mapping[str, Any], Mapping[str, Any]],
    times: tuple[float, float],
    share: float,
    driven: bool,
) -> dict[str, tuple[float, float]]:
    """Return errors of a step over the tolerance, by body, with the sizes to compare them with.

    Parameters
    ----------
    forms, states, times
        Forms, and their states and the times at the beginning and at the end of the step.
    share
        Share of the stage that the step takes.
    driven
        Supports move: stresses follow from strains, and their error counts.
    """
    # Only steps that are long enough can err.
    begin, end = times
    errors: dict[str, tuple[float, float]] = {}
    if not end > begin or share < _SHORT:
        return errors
    for name, form in having(forms, Body).items():
        if not any(material.time_dependent for material in form.materials.values()):
            continue
        old = states[0][name]
        new = states[1][name]
        # Estimate the error at points that creep most.
        samples = chosen(form, old, new, creeping=True)
        record(samples, form, old, begin)
        record(samples, form, new, end)
        squares = np.zeros(2)
        for sample in samples.values():
            squares += _squares(sample, driven)
        error, size = np.sqrt(squares)
        if size > 0.0:
            errors[f"{name}, creep"] = float(error) / _ALLOWED, float(size)
    return errors


def _squares(sample: Sample, driven: bool) -> ndarray:
    """Return the squares of the error and of the change of a step, (2,)."""
    # follow the change of stress in parts
    old, new = sample.states
    try:
        with np.errstate(all="ignore"):  # at points that fail, which do not count
            strain, stress, solved = followed(sample.material, sample.states, driven)
    except (IncrementTooLarge, InadmissibleStress, np.linalg.LinAlgError):
        return np.zeros(2)

    # compare strains, or stresses, in the norm of the elastic energy
    moduli = elasticity_at(sample.material, old.stress, old.memory)
    change = new.strain - old.strain
    off = strain - new.strain
    if driven:
        moduli = np.linalg.inv(moduli)
        change = new.stress - old.stress
        off = stress - new.stress
    off *= PARTS / (PARTS - 1.0)
    squares = [np.einsum("in,nij,jn->n", each, moduli, each) for each in (off, change)]
    return (sample.weight * np.array(squares))[:, solved].sum(axis=1)
