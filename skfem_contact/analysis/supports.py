"""Is every body held?  Asked before the analysis starts."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy import ndarray
from skfem import CellBasis

from ..contact.pair import ContactPair
from ..mesh import bodies
from ..mesh_check import check_mesh
from ..solid import SolidForm


def check_supports(forms: Mapping[str, Any], fixed: ndarray) -> ndarray:
    """Refuse bodies that nothing holds; return the places of the unknowns.

    A body is held when its fixed unknowns leave it no rigid motion.  A body that a contact pair joins to
    another one passes: contact may hold it.

    Parameters
    ----------
    forms
        Forms by name.
    fixed
        Fixed unknowns.

    Returns
    -------
    ndarray
        Coordinates of every unknown, (2, N).

    Raises
    ------
    ValueError
        No solid, forms of different bases, bad mesh, fixed unknowns that do not exist, or a loose body.
    """
    solids = {k: f for k, f in forms.items() if isinstance(f, SolidForm)}
    if not solids:
        raise ValueError("there is no SolidForm among the forms: nothing carries load")
    sizes = {k: f.basis.N if isinstance(f, SolidForm) else f.n for k, f in forms.items()
             if isinstance(f, (SolidForm, ContactPair))}
    if len(set(sizes.values())) > 1:
        raise ValueError(f"the forms belong to different bases; their numbers of unknowns are {sizes}")
    basis = next(iter(solids.values())).basis
    check_mesh(basis.mesh)
    if len(fixed) and (fixed.min() < 0 or fixed.max() >= basis.N):
        raise ValueError(f"fixed unknowns must lie between 0 and {basis.N - 1}")
    covered = np.concatenate([_elements(f.basis) for f in solids.values()])
    free_nodes = np.setdiff1d(np.arange(basis.N), np.concatenate((np.unique(
        np.concatenate([np.unique(f.basis.element_dofs) for f in solids.values()])), fixed)))
    if len(free_nodes):
        where = basis.doflocs[:, free_nodes[0]]
        raise ValueError(f"{len(free_nodes)} unknowns belong to no solid among the forms and are not fixed; the "
                         f"first is at ({where[0]:g}, {where[1]:g})")
    touched = {int(dof) for f in forms.values() if isinstance(f, ContactPair)
               for surface in (f.slave, f.master) for dof in surface.dofs[:, 0]}
    for name, elements in bodies(basis.mesh).items():
        dofs = np.unique(basis.element_dofs[:, elements] if basis.tind is None
                         else _whole(basis).element_dofs[:, elements])
        if not np.isin(elements, covered).any():
            continue
        held = np.intersect1d(dofs, fixed)
        if _rigid_motions(basis.doflocs, held) and not touched.intersection(dofs.tolist()):
            raise ValueError(f"body '{name}' is held by nothing: {len(held)} of its unknowns are fixed and no "
                             "contact pair touches it")
    return np.asarray(basis.doflocs)


def _elements(basis: CellBasis) -> ndarray:
    return np.arange(basis.mesh.nelements) if basis.tind is None else np.asarray(basis.tind)


def _whole(basis: CellBasis) -> CellBasis:
    return CellBasis(basis.mesh, basis.elem, quadrature=basis.quadrature)


def _rigid_motions(locations: ndarray, held: ndarray) -> int:
    """Number of rigid motions (of three) that fixed unknowns leave free."""
    x, y = locations[:, held]
    across = (held % 2).astype(float)
    scale = max(float(np.ptp(locations)), 1e-300)
    modes = np.stack((1 - across, across, (across * (x - x.mean()) - (1 - across) * (y - y.mean())) / scale)) \
        if len(held) else np.zeros((3, 0))
    return 3 - int(np.linalg.matrix_rank(modes, tol=1e-9))
