"""Is every body held?  Asked before the analysis starts."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy import ndarray
from skfem import CellBasis

from ..contact.pair import ContactPair
from ..errors import place
from ..mesh.check import check_mesh
from ..mesh.join import bodies
from ..solid import SolidForm
from ..strain import axisymmetric


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
        Coordinates of every unknown, (dim, N).

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
        raise ValueError(f"{len(loose)} unknowns belong to no solid among the forms and are not fixed; the "
                         f"first is at {place(basis.doflocs[:, loose[0]])}{_without(basis, count)}. Give every body a "
                         "form, also one that is activated later, or leave it out of the mesh")
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


def _without(basis: CellBasis, count: ndarray) -> str:
    """Subdomains of which no element belongs to a solid, for a message."""
    covered = np.flatnonzero(count)
    names = [name for name, part in (basis.mesh.subdomains or {}).items() if not np.isin(part, covered).any()]
    return f", in the subdomains {names}" if names else ""


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
        modes = rigid_modes(basis.doflocs, held)[:, 1:2] if axial else rigid_modes(basis.doflocs, held)
        free = modes.shape[1] - int(np.linalg.matrix_rank(modes, tol=1e-9))
        if free and not group & obstacles:
            listed = " and ".join(f"'{name}'" for name in sorted(group))
            alone = len(group) == 1
            who = f"body {listed} is not held" if alone else f"the bodies {listed} hold only each other"
            raise ValueError(f"{who}: {len(held)} of the unknowns are fixed, which leaves {free} of "
                             f"{modes.shape[1]} rigid motions free")


def rigid_modes(locations: ndarray, unknowns: ndarray) -> ndarray:
    """Small rigid motions of a body: translations, then rotations about its centre, scaled by its size.

    Parameters
    ----------
    locations
        Place of each unknown, (dim, N); the components of a node follow each other.
    unknowns
        Those of the body.

    Returns
    -------
    ndarray
        Displacements, (len(unknowns), 3), in three dimensions (len(unknowns), 6).

    Examples
    --------
    >>> import numpy as np
    >>> rigid_modes(np.array([[0., 0., 2., 2.], [0., 0., 0., 0.]]), np.arange(4))
    array([[ 1. ,  0. , -0. ],
           [ 0. ,  1. , -0.5],
           [ 1. ,  0. , -0. ],
           [ 0. ,  1. ,  0.5]])
    """
    x = locations[:, unknowns]
    dim = len(x)
    component = np.eye(dim)[unknowns % dim]
    centre = x.mean(axis=1, keepdims=True) if len(unknowns) else 0.0
    arm = ((x - centre) / max(float(np.ptp(locations)), 1e-300)).T
    planes = [(i, j) for i in range(dim) for j in range(i + 1, dim)]
    turns = [component[:, j] * arm[:, i] - component[:, i] * arm[:, j] for i, j in planes]
    return np.column_stack((component, *turns))
