"""Permeability of regions: one number, one for each direction, or a tensor."""
from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import CellBasis

from ..errors import look_up
from ..unknowns import elements_of

#: Permeability of a region: a number, one number for each axis, or a symmetric tensor (dim, dim).
Permeability = ArrayLike

T = TypeVar("T")

#: Largest ratio of permeabilities: the flow through a dam is known to 5e-4 with a core 1e10 times as permeable as the
#: rest, and the matrix is singular with 1e12.
_MOST = 1e10


def regions(basis: CellBasis, values: T | Mapping[str, T], what: str) -> list[tuple[ndarray, T]]:
    """Which elements of a basis have which value, where one is given for all or one for each subdomain."""
    here = elements_of(basis)
    if not isinstance(values, Mapping):
        return [(np.arange(len(here)), values)]
    count = np.zeros(len(here), dtype=int)
    found = []
    for name, value in values.items():
        part = np.flatnonzero(np.isin(here, look_up(name, basis.mesh.subdomains or {}, "subdomain")))
        count[part] += 1
        found.append((part, value))
    for wrong, text in ((count == 0, f"have no {what}"), (count > 1, f"have more than one {what}")):
        if wrong.any():
            names = [name for name, part in (basis.mesh.subdomains or {}).items() if np.isin(part, here[wrong]).any()]
            raise ValueError(f"{wrong.sum()} elements {text}; they lie in the subdomains {names}")
    return found


def permeability_tensors(basis: CellBasis, k: Permeability | Mapping[str, Permeability]) -> ndarray:
    """Tensor of permeability of every element of a basis, (n_elements, dim, dim)."""
    dim = basis.mesh.dim()
    tensors = np.empty((basis.nelems, dim, dim))
    found: list[float] = []
    for part, value in regions(basis, k, "permeability"):
        tensor = tensors[part] = _tensor(value, dim)
        found += np.linalg.eigvalsh(tensor).tolist() if len(part) else []
    if max(found) > _MOST * min(found):
        raise ValueError(f"the permeabilities from {min(found):.3g} to {max(found):.3g} are too far apart: round-off "
                         "would hide the flow through the tightest ground; leave that out of the basis")
    return tensors


def _tensor(value: object, dim: int) -> ndarray:
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        array = np.full(0, np.nan)
    if array.shape not in ((), (dim,), (dim, dim)):
        raise ValueError(f"a permeability is a number, {dim} numbers along the axes or a tensor ({dim}, {dim}), "
                         f"not {value!r}")
    tensor = array if array.ndim == 2 else array * np.eye(dim)
    if not np.isfinite(tensor).all() or not np.allclose(tensor, tensor.T, rtol=1e-12, atol=0.0) \
            or np.linalg.eigvalsh(tensor).min() <= 0.0:
        raise ValueError(f"a permeability must be positive and finite in all directions, not {value!r}; leave elements "
                         "that no water enters out of the basis")
    return tensor
