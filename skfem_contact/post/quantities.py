"""Names of fields: their titles and units, and how they follow from displacements, strains or stresses."""
from __future__ import annotations

from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np
from numpy import ndarray


class Quantity(NamedTuple):
    """A field that can be drawn.

    Attributes
    ----------
    title
        What a legend calls it.
    unit
        Kind of unit: ``"length"``, ``"stress"``, or none.
    source
        What it follows from: ``"displacement"`` (dim, n), ``"strain"`` or ``"stress"`` (ncomp, n), or ``"points"``,
        values of the integration points as they are.
    value
        Function of the source.
    """

    title: str
    unit: Literal["length", "stress", ""]
    source: Literal["displacement", "strain", "stress", "points"]
    value: Callable[[ndarray], ndarray] = lambda values: values[0]


def principal(stress: ndarray) -> ndarray:
    """Principal stresses of (4 or 6, ...) in ascending order along the last axis."""
    xx, yy, zz, xy, *out_of_plane = stress
    if out_of_plane:
        yz, zx = out_of_plane
        tensors = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
        return np.linalg.eigvalsh(np.moveaxis(tensors, (0, 1), (-2, -1)))
    center, radius = 0.5 * (xx + yy), np.hypot(0.5 * (xx - yy), xy)
    return np.sort(np.stack((center - radius, center + radius, zz), axis=-1), axis=-1)


def mises(stress: ndarray) -> ndarray:
    """Von Mises' equivalent of stresses (4 or 6, ...)."""
    xx, yy, zz = stress[:3]
    return np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * (stress[3:] ** 2).sum(axis=0))


def shear_strain(strain: ndarray) -> ndarray:
    """Largest (engineering) shear strain; of plane strains (4, ...) that in the plane."""
    if len(strain) == 4:
        return np.hypot(strain[0] - strain[1], strain[3])
    values = principal(np.concatenate((strain[:3], 0.5 * strain[3:])))
    return values[..., 2] - values[..., 0]


def _component(i: int) -> Callable[[ndarray], ndarray]:
    return lambda values: values[i]


#: Fields of plane bodies.
PLANE = {
    "ux": Quantity("horizontal displacement", "length", "displacement", _component(0)),
    "uy": Quantity("vertical displacement", "length", "displacement", _component(1)),
    "u": Quantity("displacement", "length", "displacement", lambda u: np.hypot.reduce(u, axis=0)),
    "sxx": Quantity("horizontal stress", "stress", "stress", _component(0)),
    "syy": Quantity("vertical stress", "stress", "stress", _component(1)),
    "szz": Quantity("out-of-plane stress", "stress", "stress", _component(2)),
    "sxy": Quantity("shear stress", "stress", "stress", _component(3)),
    "s1": Quantity("largest principal stress", "stress", "stress", lambda s: principal(s)[..., 2]),
    "s2": Quantity("middle principal stress", "stress", "stress", lambda s: principal(s)[..., 1]),
    "s3": Quantity("smallest principal stress", "stress", "stress", lambda s: principal(s)[..., 0]),
    "mean": Quantity("mean stress", "stress", "stress", lambda s: s[:3].mean(axis=0)),
    "mises": Quantity("von Mises stress", "stress", "stress", mises),
    "exx": Quantity("horizontal strain", "", "strain", _component(0)),
    "eyy": Quantity("vertical strain", "", "strain", _component(1)),
    "exy": Quantity("engineering shear strain", "", "strain", _component(3)),
    "gamma": Quantity("largest shear strain", "", "strain", shear_strain),
    "ev": Quantity("volumetric strain", "", "strain", lambda e: e[:3].sum(axis=0)),
    "plastic": Quantity("equivalent plastic strain", "", "points"),
    "mobilised": Quantity("mobilised strength", "", "points"),
    "pore": Quantity("pore pressure", "stress", "points"),
}

#: Fields of bodies in space.
SPACE = PLANE | {
    "ux": Quantity("displacement along x", "length", "displacement", _component(0)),
    "uy": Quantity("displacement along y", "length", "displacement", _component(1)),
    "uz": Quantity("displacement along z", "length", "displacement", _component(2)),
    "sxx": Quantity("stress along x", "stress", "stress", _component(0)),
    "syy": Quantity("stress along y", "stress", "stress", _component(1)),
    "szz": Quantity("stress along z", "stress", "stress", _component(2)),
    "syz": Quantity("shear stress yz", "stress", "stress", _component(4)),
    "szx": Quantity("shear stress zx", "stress", "stress", _component(5)),
}
