"""Is every body held?  Asked before the analysis starts."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy import ndarray
from skfem import CellBasis

from ..assembly import axisymmetric
from ..contact.pair import ContactPair
from ..mesh import bodies
from ..mesh_check import check_mesh
from ..solid import SolidForm


def as_unknowns(fixed: Any) -> ndarray:
    """Numbers of unknowns, sorted and each once, or a ``ValueError`` where they are no integers."""
    numbers = np.unique(np.asarray(fixed))
    if len(numbers) and numbers.dtype.kind not in "iu":
        raise ValueError("fixed must be numbers of unknowns, integers such as basis.get_dofs('bottom').all()")
    return numbers.astype(int)


def check_supports(forms: Mapping[str, Any], fixed: ndarray) -> ndarray:
    """Refuse bodies that nothing holds; return the places of the unknowns.

    Bodies are held when their fixed unknowns leave them no rigid motion.  Bodies that contact pairs join
    count as one, and those that meet a rigid obstacle pass: contact may hold them.

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
    sizes = {k: int(f.basis.N) if isinstance(f, SolidForm) else int(f.n) for k, f in forms.items()
             if isinstance(f, (SolidForm, ContactPair))}
    if len(set(sizes.values())) > 1:
        raise ValueError(f"the forms belong to different bases; their numbers of unknowns are {sizes}")
    first, basis = next((name, solid.basis) for name, solid in solids.items())
    check_mesh(basis.mesh)
    _check_places(forms, first, basis)
    if len(fixed) and (fixed.min() < 0 or fixed.max() >= basis.N):
        raise ValueError(f"fixed unknowns must lie between 0 and {basis.N - 1}")
    count = np.bincount(np.concatenate([_elements(f.basis) for f in solids.values()]))
    if count.max() > 1:
        raise ValueError(f"{(count > 1).sum()} elements belong to more than one of the solids {list(solids)}")
    carried = np.unique(np.concatenate([np.unique(f.basis.element_dofs) for f in solids.values()]))
    loose = np.setdiff1d(np.arange(basis.N), np.concatenate((carried, fixed)))
    if len(loose):
        x, y = basis.doflocs[:, loose[0]]
        raise ValueError(f"{len(loose)} unknowns belong to no solid among the forms and are not fixed; the "
                         f"first is at ({x:g}, {y:g})")
    if all(isinstance(f, (SolidForm, ContactPair)) for f in forms.values()):  # others may hold what they like
        elements = np.sort(np.concatenate([_elements(f.basis) for f in solids.values()]))
        axial = all(f.strain is axisymmetric for f in solids.values())
        _check_bodies(basis, elements, [f for f in forms.values() if isinstance(f, ContactPair)], fixed, axial)
    return np.asarray(basis.doflocs)


def _check_places(forms: Mapping[str, Any], first: str, basis: CellBasis) -> None:
    """Forms of different meshes may have as many unknowns as each other, but not at the same places."""
    for name, form in forms.items():
        if isinstance(form, SolidForm):
            same = np.array_equal(form.basis.doflocs, basis.doflocs)
        elif isinstance(form, ContactPair):
            same = np.array_equal(form.slave.nodes.T, basis.doflocs[:, form.slave.dofs[:, 0]])
        else:
            continue
        if not same:
            raise ValueError(f"'{name}' belongs to another mesh or another element than '{first}'")


def _elements(basis: CellBasis) -> ndarray:
    return np.arange(basis.mesh.nelements) if basis.tind is None else np.asarray(basis.tind)


def _check_bodies(basis: CellBasis, elements: ndarray, pairs: list[ContactPair], fixed: ndarray,
                  axial: bool) -> None:
    """Bodies that contact joins stand or fall together: a common rigid motion of theirs meets no force.

    What the elements of the solids leave of a body may fall apart into several. In axial symmetry the one rigid
    motion is that along the axis.
    """
    mesh = basis.mesh
    if len(elements) < mesh.nelements:
        mesh = mesh.restrict(elements, skip_boundaries=True)
    dofs = {name: np.unique(basis.dofs.element_dofs[:, elements[part]]) for name, part in bodies(mesh).items()}
    groups = [{name} for name in dofs]
    obstacles = set()
    for pair in pairs:
        surfaces = np.concatenate((pair.slave.dofs.ravel(), pair.facets.dofs.ravel()))
        met = {name for name in dofs if np.isin(surfaces, dofs[name]).any()}
        groups = [g for g in groups if not g & met] + [met.union(*(g for g in groups if g & met))]
        obstacles |= met if (pair.facets.dofs < 0).any() else set()
    for group in filter(len, groups):
        held = np.intersect1d(np.concatenate([dofs[name] for name in group]), fixed)
        free = int(not (held % 2 == 1).any()) if axial else _rigid_motions(basis.doflocs, held)
        if free and not group & obstacles:
            listed = " and ".join(f"'{name}'" for name in sorted(group))
            alone = len(group) == 1
            who = f"body {listed} is not held" if alone else f"the bodies {listed} hold only each other"
            raise ValueError(f"{who}: {len(held)} of the unknowns are fixed, which leaves {free} of "
                             f"{1 if axial else 3} rigid motions free")


def _rigid_motions(locations: ndarray, held: ndarray) -> int:
    """Number of rigid motions (of three) that fixed unknowns leave free."""
    x, y = locations[:, held]
    across = (held % 2).astype(float)
    if len(held) == 0:
        return 3
    scale = max(float(np.ptp(locations)), 1e-300)
    turn = across * (x - x.mean()) - (1 - across) * (y - y.mean())
    modes = np.stack((1 - across, across, turn / scale))
    return 3 - int(np.linalg.matrix_rank(modes, tol=1e-9))
