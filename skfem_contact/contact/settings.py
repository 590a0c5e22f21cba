"""Settings of a contact pair: what they may be, and how bodies fit together where they become active."""
from __future__ import annotations

from typing import Any, Literal, get_args

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree

from ..errors import is_number
from ..surfaces.surface import Surface
from .augmented import AugmentedLagrangian
from .laws import InterfaceLaw

#: What becomes of gaps and overlaps; a number: they touch exactly, and interfere by that much.
NamedFit = Literal["as meshed", "adjusted", "ramped"]
Fit = NamedFit | float

#: Gaps of the mesh below this share of the slave segment are round-off: such bodies touch.
TOUCHING = 1e-8
#: Gaps below this share of it are those of one surface meshed twice.
_ADJUSTED = 0.5
#: Nodes of facets whose corners have negative areas: where a facet is closed in part, multipliers there double the
#: pressure at the edge of the contact, of a sphere on a block with 4 elements in its half-width.
_NEGATIVE = 8
#: Cosine of the angle between facets, above which they face the same way.
_SAME_WAY = 0.5
#: Round-off of the axis, as a share of a facet.
_ON_AXIS = 1e-9


def check_surfaces(slave: Surface, master: Surface) -> None:
    """Refuse surfaces that share nodes or face the same way, and axial symmetry of what has none."""
    if np.isin(slave.dofs[:, 0], master.dofs[:, 0]).any():
        raise ValueError(f"slave '{slave.name}' and master '{master.name}' share nodes: a body cannot touch "
                         "itself there; separate the bodies with join_bodies")
    # what is not finite is refused by a run
    here, there = (np.nan_to_num(surface.centres.x[0]) for surface in (slave, master))
    opposite = cKDTree(there).query(here)[1]
    if (np.einsum("nc,nc->n", slave.centres.normal, master.centres.normal[opposite]) > _SAME_WAY).all():
        raise ValueError(f"slave '{slave.name}' and master '{master.name}' face the same way, and cannot touch: take "
                         "the boundary on the other side of the body; a rigid line is free to the left of its way")
    if not isinstance(slave.axisymmetric, bool):
        raise ValueError(f"axisymmetric must be True or False, not {slave.axisymmetric!r}")
    if slave.axisymmetric and (slave.dim == 3 or slave.nodes[:, 0].min() < -_ON_AXIS * slave.spacing):
        raise ValueError(f"contact of '{slave.name}': axial symmetry is for plane meshes with x >= 0")


def check_settings(slave: Surface, quadrature: Any, enforcement: Any, initial: Any, share: Any, tangent: Any) -> None:
    """Refuse a setting that means nothing to a contact pair, see there."""
    if not _counts(quadrature):
        _one_of("quadrature", quadrature, ("nodal", "segments"), " or a positive number of Gauss points")
    _one_of("tangent", tangent, ("exact", "primary"))
    if not is_number(initial, 0.0, np.inf):
        _one_of("initial", initial, get_args(NamedFit), " or a positive interference")
    if not (share == 1.0 or is_number(share, 0.0, 1.0)):
        raise ValueError(f"share must lie in (0, 1], not {share!r}")
    if not isinstance(enforcement, AugmentedLagrangian | None):
        raise ValueError(f"enforcement must be None or AugmentedLagrangian(), not {enforcement!r}")
    if enforcement is not None and slave.facets.shape[1] == _NEGATIVE:
        raise ValueError(f"the augmented method is not for facets of eight nodes, as '{slave.name}' has them: the "
                         "corners have negative areas for their multipliers; take ElementHex2 or ElementHex1, or the "
                         "penalty method")


def check_law(law: Any, n_nodes: int) -> None:
    """Refuse what is no interface law, and a parameter that has not one value for each node of the slave."""
    if not isinstance(law, InterfaceLaw) or type(law).update is InterfaceLaw.update:
        raise ValueError(f"law must be an InterfaceLaw with an `update`, like Coulomb(mu=.3), unlike {law!r}")
    for name, value in vars(law).items():
        if isinstance(value, np.ndarray) and value.shape != (n_nodes,):
            raise ValueError(f"{type(law).__name__}: {name} has shape {value.shape}; the slave has {n_nodes} nodes")


def _counts(value: object) -> bool:
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool) and int(value) > 0


def _one_of(name: str, value: object, allowed: tuple[str, ...], other: str = "") -> None:
    if not (isinstance(value, str) and value in allowed):
        raise ValueError(f"{name} must be one of {allowed}{other}, not {value!r}")


def touching(gap: ndarray, meshed: ndarray, size: ndarray, fit: Fit, bonded: bool) -> ndarray:
    """Gaps that count as touching, (n,), of slave segments of some size; what is near may be bonded as it is meshed.

    Gaps are given where the bodies are when they become active, and where they are meshed: bodies are built to fit into
    displaced surfaces, so that gaps are still those of the mesh.
    """
    with np.errstate(invalid="ignore"):  # nothing near, neither now nor in the mesh: inf - inf
        # a change of more than this is no displacement: other surfaces have come to face each other
        moved = np.where(np.abs(gap - meshed) <= 0.5 * size, gap - meshed, 0.0)
    ramped = fit == "ramped" or not isinstance(fit, str)
    if ramped:
        moved = np.zeros_like(gap)
    nothing = (_ADJUSTED if bonded or fit == "adjusted" or not isinstance(fit, str) else TOUCHING) * size
    offset = np.where(np.abs(gap - moved) <= nothing, gap, moved)
    return np.minimum(gap, offset) if ramped else offset
