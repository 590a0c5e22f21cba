"""Small vibrations of a model about an equilibrium."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..arrays import max_abs, quotient
from ..dynamics.mass import mass_and_damping, translation
from ..dynamics.modes import modes_of
from ..dynamics.settings import Dynamic
from ..errors import warn
from ..forms.base import Forms, Response, responses_of
from ..forms.roles import Touching, Wet, having
from ..results import modes as results
from ..results.result import Result
from ..results.stage import StageResult, undeformed
from ..sparse import Total, within
from .in_time import check_materials
from .setup import Setup

#: Skew part of a tangent, over the largest entries of its rows, that modes leave out. Joints that
#: stick have about the strains of their pressure, .03 at 5 %, and frequencies change by its square,
#: 5e-6; multipliers of joints that slide have up to 1.
_SKEW = 0.1
#: Rows below this share of the largest entry are round-off.
_ROUND_OFF = 1e-8
#: Share by which the penalty of contact may lower a figure without a warning.
_LOWER = 0.01
#: Kinds of masses.
Masses = Literal["lumped", "consistent"]


def modes(
    setup: Setup,
    n: int,
    *,
    start: Result | StageResult | None = None,
    mass: Masses = "lumped",
) -> results.Modes:
    """Return natural frequencies and modes of small vibrations.

    Masses are unit weights over ``gravity_acceleration``. The stiffness is the tangent of all
    forms at the start: closed contact and bars hold, open contact does not.

    Parameters
    ----------
    n
        Number of modes.
    start
        Result, or one of its stages, about which the model vibrates; by default the undeformed
        bodies.
    mass
        ``"lumped"`` or ``"consistent"``, as of :class:`Dynamic`.

    Raises
    ------
    ValueError
        No acceleration of gravity or no unit weight, more modes than masses, water that flows, or a
        tangent that is not symmetric, as of sliding friction.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad2, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(2).with_defaults(), ElementVector(ElementQuad2()))
    >>> block = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=.3), unit_weight=20.)
    >>> fixed = basis.get_dofs("bottom").all()
    >>> model = sc.Model({"block": block}, fixed, gravity_acceleration=9.81)
    >>> print(model.modes(2))
    natural frequencies
    mode  frequency  period  mass x  mass y
    ...
    """
    check_number(n)
    # Modes about a result, or about the undeformed body.
    last = start[-1] if isinstance(start, Result) else start
    setup = setup.after(last)
    if last is None:
        last = replace(
            undeformed("undeformed", setup.forms, setup.layout.size),
            forms=setup.forms,
            layout=setup.layout,
        )
    forms = {name: setup.forms[name] for name in last.states}
    wet = list(having(forms, Wet))
    if wet:
        raise ValueError(
            f"modes are those of ground whose water does not flow: deactivate {wet}, and give the "
            "soil an Undrained material"
        )
    check_materials(forms)
    settings = Dynamic(1.0, mass=mass, contact_mass="kept")
    M, _ = mass_and_damping(forms, setup.layout, settings, setup.acceleration_of_gravity())
    if M.nnz == 0:
        raise ValueError("no form has a mass: give the solids their unit_weight")

    # Assemble the tangent of the start
    inactive = setup.inactive(forms)
    if start is None:  # otherwise the stages have reported their forms
        for remark in setup.remarks_on(forms, setup.fixed, inactive, moving=True):
            warn(remark.text)
    system = setup.system(forms, np.union1d(setup.fixed, inactive))
    x = setup.vector(last.x, "start")
    responses = responses_of(system.forms, x, last.states)
    K = Total().of([response.stiffness for response in responses.values()])
    K = symmetric_part(K, system.free)
    # K shape = w^2 M shape
    squares, shapes = modes_of(K, M, system.fixed, system.factor, int(n))
    warn_of_penalties(forms, responses, shapes, squares, ("frequencies", 0.5))

    # Find the mass that is free, and the rigid translations
    moves: dict[int, ndarray] = {}
    for c in range(len(setup.layout.coordinates)):
        moves[c] = translation(setup.layout, c)
        moves[c][system.fixed] = 0.0
    return results.modes(squares, shapes, M, moves, last)


def check_number(n: int) -> None:
    """Refuse a number of modes that is not positive and whole."""
    if isinstance(n, bool) or not isinstance(n, int | np.integer) or n < 1:
        raise ValueError(f"the number of modes must be at least 1 and whole, not {n!r}")


def symmetric_part(K: csr_matrix, free: ndarray) -> csr_matrix:
    """Return the symmetric part of the tangent of a start; refuse a skew part that counts."""
    skew = 0.5 * (K - K.T)
    rows = abs(within(K, free)).max(axis=1).toarray()
    among = abs(within(skew, free)).max(axis=1).toarray()
    least = _ROUND_OFF * rows.max()
    if (among > 0.5 * _SKEW * np.maximum(rows, least)).any():
        raise ValueError(
            "the tangent is not symmetric: contact slides or soil flows at the start, about which "
            "there are no modes"
        )
    return csr_matrix(K - skew)


def warn_of_penalties(
    forms: Forms,
    responses: Mapping[str, Response],
    shapes: ndarray,
    energies: ndarray,
    lowered: tuple[str, float],
) -> None:
    """Warn of contact whose penalty lowers the frequencies of modes, or loads of buckling.

    To the first order a rigid joint raises shape' K shape by the share of its penalty in it.

    Parameters
    ----------
    shapes, energies
        Modes, (N, n), and shape' K shape, (n,).
    lowered
        Name of the figures, and their power of the energies.
    """
    what, power = lowered
    shares = {}
    for name in having(forms, Touching):
        stored = np.einsum("ik,ik->k", shapes, responses[name].stiffness @ shapes)
        shares[name] = power * quotient(stored, energies)
    lower = max_abs(sum(shares.values()))
    if lower > _LOWER:
        most = max(shares, key=lambda name: max_abs(shares[name]))
        warn(
            f"{most}: penalties of contact yield, which lowers {what} by up to {lower:.1%}: take "
            "DualMultipliers(), or the penalty method with ten times the penalty"
        )


def frequencies(
    setup: Setup,
    n: int,
    *,
    start: Result | StageResult | None = None,
    mass: Masses = "lumped",
) -> ndarray:
    """Return the lowest natural frequencies, (n,), in cycles per time (Hz).

    See :meth:`modes`.
    """
    return modes(setup, n, start=start, mass=mass).frequencies
