"""Loads: ordinary scikit-fem load vectors."""
from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy import ndarray
from skfem import CellBasis, LinearForm

from .checks import check_basis, look_up


def weight(basis: CellBasis, unit_weights: float | Mapping[str, float],
           direction: tuple[float, float] = (0.0, -1.0)) -> ndarray:
    """Own weight of bodies as a load vector.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh.
    unit_weights
        Weight per volume: one number, or by subdomain; subdomains that are not named are weightless.
    direction
        Unit vector of gravity.

    Returns
    -------
    ndarray
        Nodal forces, (N,).

    Raises
    ------
    ValueError
        Unknown subdomain, or an element that two of them give a weight.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(1), ElementVector(ElementQuad1()))
    >>> float(sc.weight(basis, 20.).sum())
    -20.0
    """
    check_basis(basis)
    gamma = np.zeros(basis.mesh.nelements)
    if isinstance(unit_weights, Mapping):
        given = np.zeros(basis.mesh.nelements, dtype=int)
        for name, value in unit_weights.items():
            elements = look_up(name, basis.mesh.subdomains or {}, "subdomain")
            gamma[elements] = value
            given[elements] += 1
        if given.max() > 1:
            raise ValueError(f"{(given > 1).sum()} elements get their weight twice: the subdomains "
                             f"{list(unit_weights)} overlap")
    else:
        gamma[:] = unit_weights
    here = gamma if basis.tind is None else gamma[basis.tind]
    field = np.broadcast_to(here[:, None], basis.dx.shape).copy()

    @LinearForm
    def body_force(v, w):  # type: ignore[no-untyped-def]
        return w.gamma * (direction[0] * v[0] + direction[1] * v[1])

    return np.asarray(body_force.assemble(basis, gamma=field))
