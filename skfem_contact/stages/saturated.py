"""Saturated ground in motion: displacements u and pressures p (O. C. Zienkiewicz et al. 1980).

The mixture moves with the density rho of saturated ground, and water follows Darcy's law without
inertia of its own:

    rho u'' = div(sigma' - p I) + b,    div u' + S p' = div(k / gamma_w grad p).

O. C. Zienkiewicz, C. T. Chang and P. Bettess (1980, Geotechnique 30, 385) compare the permeability
with Pi_1 = k V_c^2 rho / (g omega L^2 rho_w) and the frequency with Pi_2 = omega^2 L^2 / V_c^2. The
inertia that is left out is the share

    Pi_1 Pi_2 = omega k rho / (g rho_w) = omega t,    t = k rho / gamma_w,

of the resistance to flow, whatever the length L and the velocity V_c of waves. In a layer under a
harmonic load, u and p err by at most omega t of the solution with this inertia (M. A. Biot 1956),
for omega t up to .1 and frequencies from a tenth of the first drained one to half of the first
undrained one.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..dynamics.record import Record
from ..dynamics.settings import Dynamic
from ..forms.base import Form, Forms, solids_of
from ..forms.roles import Absorbing, Wet, having

#: Shares omega t from which results are remarked on, and from which records are refused: pressures
#: then err by some 3 and 8 %.
_REMARK = 0.03
_LARGEST = 0.1


def pores_in_motion(
    forms: Forms, settings: Dynamic, acceleration: float
) -> tuple[dict[str, Form], float]:
    """Return the forms of water in a stage with inertia, and the time in which it speeds up.

    Raises
    ------
    ValueError
        Explicit steps, boundaries of dry ground, or water that inertia is not supported with.
    """
    wet = having(forms, Wet)
    if not wet:
        return {}, 0.0
    # Refuse what knows no pressures.
    if settings.explicit:
        raise ValueError(
            f"pore pressures have no mass, and no explicit steps: take implicit ones for {[*wet]}"
        )
    dry = [name for name, form in having(forms, Absorbing).items() if not form.of_rock]
    if dry:
        raise ValueError(
            f"{dry} continue the ground without its water, where waves would be reflected: leave "
            "them out, give the boundary a `rock`, or take Undrained soil instead of PoreWater"
        )
    # Move the water with the density of its ground.
    density = np.zeros(0)
    for form in solids_of(forms).values():
        if not len(density):
            density = np.zeros(form.basis.mesh.nelements)
        density[form.elements] = form.unit_weights / acceleration
    found = {}
    lags = [0.0]
    for name, form in wet.items():
        try:
            found[name], lag = form.with_inertia(settings.rho_inf, density)
        except ValueError as error:
            raise ValueError(f"'{name}': {error}") from None
        lags.append(lag)
    return found, max(lags)


def check_base(lag: float, records: Iterable[Record]) -> None:
    """Refuse motions of the base in which water does not follow Darcy's law."""
    for record in records:
        moved = record.velocity - record.velocity.mean()
        size = max(float(np.linalg.norm(moved)), 1e-300)
        omega = float(np.linalg.norm(record.values)) / size
        if omega * lag > _LARGEST:
            raise ValueError(
                f"the inertia of the water is {omega * lag:.2g} of its resistance at the frequency "
                f"of the record, {omega / (2.0 * np.pi):.3g} a unit of time, but at most "
                f"{_LARGEST:g} is allowed: the ground drains freely, so leave PoreWater out"
            )


def remark_on_motion(omega: float, lag: float) -> str:
    """Return a remark on water that does not follow Darcy's law, or an empty text."""
    if omega * lag <= _REMARK:
        return ""
    return (
        f"the inertia of the pore water, which is left out, is {omega * lag:.2g} of its resistance "
        f"at the frequency of the motion, {omega / (2.0 * np.pi):.3g} a unit of time, and "
        f"pressures err by up to this share; ground with more than {_LARGEST:g} drains freely"
    )
