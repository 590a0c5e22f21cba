"""Checks of supports: every body is held before the analysis starts."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy import ndarray
from skfem import CellBasis

from ..checks import format_point
from ..forms.base import Form, solids_of
from ..forms.roles import Couples, joined_by
from ..layout import different, others, rigid_modes
from ..mesh import bodies


def check_supports(forms: Mapping[str, Form], fixed: ndarray) -> None:
    """Refuse bodies that nothing holds.

    Bodies are held when their fixed dofs leave them no rigid motion. Bodies that contact pairs join
    count as one, and those that meet a rigid obstacle pass: contact may hold them. Other forms may
    hold any body.
    """
    solids = solids_of(forms)
    joined = {name: joined_by(form) for name, form in forms.items()}
    if not solids and all(dofs is not None for dofs in joined.values()):
        raise ValueError("there is no SolidForm among the forms: nothing resists load")
    if not solids:
        return
    basis = next(solid.basis for solid in solids.values())
    count = np.bincount(np.concatenate([form.elements for form in solids.values()]))
    if count.max() > 1:
        raise ValueError(
            f"{(count > 1).sum()} elements belong to more than one of the solids {list(solids)}"
        )
    free = [form for name, form in forms.items() if joined[name] is None]
    acts_on = [form.acts_on for form in free if isinstance(form, Couples)]
    linked = [dofs for dofs in acts_on if dofs is not None]
    loose = others(
        basis.N,
        *(form.basis.element_dofs for form in solids.values()),
        *(dofs[dofs < basis.N] for dofs in (fixed, *linked)),
    )
    if len(loose) and len(linked) == len(free):
        raise ValueError(
            f"{len(loose)} dofs belong to no solid among the forms and are not fixed; the "
            f"first is at {format_point(basis.doflocs[:, loose[0]])}{_without(basis, count)}. Give "
            "every body a form, also one that is activated later, or leave it out of the mesh"
        )
    if not free:
        elements = np.sort(np.concatenate([form.elements for form in solids.values()]))
        axial = all(form.coordinates == "axisymmetric" for form in solids.values())
        _check_bodies(
            basis,
            elements,
            [dofs for dofs in joined.values() if dofs is not None],
            fixed,
            axial,
        )


def _without(basis: CellBasis, count: ndarray) -> str:
    """Return the subdomains without a solid, for a message."""
    covered = np.flatnonzero(count)
    names = [
        name
        for name, part in (basis.mesh.subdomains or {}).items()
        if not np.isin(part, covered).any()
    ]
    return f", in the subdomains {names}" if names else ""


def _check_bodies(
    basis: CellBasis, elements: ndarray, joined: list[ndarray], fixed: ndarray, axial: bool
) -> None:
    """Check groups of bodies that contact joins: a common rigid motion of a group meets no force.

    What the elements of the solids leave of a body may fall apart into several. In axial symmetry
    the one rigid motion is that along the axis.
    """
    mesh = basis.mesh
    if len(elements) < mesh.nelements:
        mesh = mesh.restrict(elements, skip_boundaries=True)
    dofs = {
        name: different(basis.N, basis.dofs.element_dofs[:, elements[part]])
        for name, part in bodies(mesh).items()
    }
    groups = [{name} for name in dofs]
    obstacles = set()
    for surfaces in filter(len, joined):
        met = {name for name in dofs if np.isin(surfaces, dofs[name]).any()}
        groups = [g for g in groups if not g & met] + [met.union(*(g for g in groups if g & met))]
        obstacles |= met if (surfaces < 0).any() else set()
    for group in filter(len, groups):
        held = np.intersect1d(np.concatenate([dofs[name] for name in group]), fixed)
        modes = (
            rigid_modes(basis.doflocs, held)[:, 1:2] if axial else rigid_modes(basis.doflocs, held)
        )
        free = modes.shape[1] - int(np.linalg.matrix_rank(modes, tol=1e-9))
        if free and not group & obstacles:
            listed = " and ".join(f"'{name}'" for name in sorted(group))
            alone = len(group) == 1
            who = (
                f"body {listed} is not held"
                if alone
                else f"the bodies {listed} hold only each other"
            )
            raise ValueError(
                f"{who}: {len(held)} of the dofs are fixed, which leaves {free} of "
                f"{modes.shape[1]} rigid motions free"
            )
