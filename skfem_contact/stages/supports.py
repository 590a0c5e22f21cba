"""Checks of supports: every body is held before the analysis starts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from typing import Any

import numpy as np
from numpy import ndarray
from skfem import CellBasis

from ..arrays import max_abs
from ..checks import format_point
from ..contact.base import ContactBase
from ..errors import Remark
from ..forms.base import Form, Forms, solids_of
from ..forms.roles import Couples, having, joined_by
from ..layout import different, elements_in, others, rigid_modes
from ..mesh import bodies
from ..surfaces.surface import Surface

#: Strain of a turn that is remarked on. Below a disc that is pressed by a strain of 2e-3 and
#: turned, pressures are off by 8, 31 and 100 % with 4e-5, 1.5e-4 and 6e-4.
_STRAIN_OF_TURN = 1e-4
#: Distance of nodes from a rigid motion, over their displacements, up to which they move rigidly:
#: with displacements that are linear in the angle it is half the angle.
_RIGID = 1e-6


def check_supports(forms: Forms, fixed: ndarray) -> None:
    """Refuse bodies that nothing holds.

    Bodies are held when their fixed dofs leave them no rigid motion. Bodies that contact pairs join
    count as one, and bodies that meet a rigid obstacle pass: contact may hold them. Other forms may
    hold any body.
    """
    check_pairs(forms)
    # Forms may join bodies, or hold any of them.
    solids = solids_of(forms)
    joined = []
    holding = []  # forms that may hold any body
    for form in forms.values():
        dofs = joined_by(form)
        if dofs is None:
            holding.append(form)
        else:
            joined.append(dofs)
    if not solids and not holding:
        raise ValueError("there is no SolidForm among the forms: nothing resists load")
    if not solids:
        return
    basis = next(solid.basis for solid in solids.values())
    covered = elements_in(solids.values())
    _check_elements(solids, basis, covered, fixed, holding)
    if not holding:
        axial = all(form.coordinates == "axisymmetric" for form in solids.values())
        _check_bodies(basis, np.sort(covered), joined, fixed, axial)


def remarks_on_turns(basis: CellBasis, held: ndarray, u: ndarray) -> Iterator[Remark]:
    """Yield a remark on held nodes that turn rigidly, by which solids beside them are strained."""
    # Find the nodes that move and are held in all directions, of elements that are not held whole.
    dim = basis.mesh.dim()
    moved = u[: basis.N].reshape(-1, dim)
    is_free = ~np.isin(np.arange(basis.N), held)
    deforming = is_free[basis.element_dofs].any(axis=0)
    beside = np.unique(basis.element_dofs[:, deforming] // dim)
    nodes = beside[~is_free.reshape(-1, dim)[beside].any(axis=1) & moved[beside].any(axis=1)]
    if len(nodes) <= dim:
        return

    # Fit a rigid motion: the rotation R = U V^T of the covariance X^T x = V S U^T (Kabsch 1976).
    before = basis.doflocs[:, dim * nodes].T
    before = before - before.mean(axis=0)
    after = before + moved[nodes] - moved[nodes].mean(axis=0)
    V, _, UT = np.linalg.svd(before.T @ after)
    V[:, -1] *= np.linalg.det(V @ UT)
    R = (V @ UT).T
    cosine = (np.trace(R) - dim + 2.0) / 2.0
    if 1.0 - cosine < _STRAIN_OF_TURN:
        return
    if max_abs(after - before @ R.T) < _RIGID * max_abs(after - before):
        angle = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
        yield Remark(
            "turns",
            1.0 - cosine,
            f"prescribed displacements turn {len(nodes)} nodes by {angle:.1f} degrees, which "
            f"solids of small rotations take for a strain of {1.0 - cosine:.2%}: take "
            "kinematics='finite', or displacements that are linear in the angle",
        )


def _check_elements(
    solids: Mapping[str, Any],
    basis: CellBasis,
    covered: ndarray,
    fixed: ndarray,
    holding: Sequence[Form],
) -> None:
    """Refuse elements of two solids, and dofs of no solid that nothing holds."""
    count = np.bincount(covered)
    if count.max() > 1:
        raise ValueError(
            f"{(count > 1).sum()} elements belong to more than one of the solids {list(solids)}"
        )
    known = [form.basis.element_dofs for form in solids.values()]
    known.append(fixed[fixed < basis.N])
    for form in holding:
        if isinstance(form, Couples):
            acts_on = form.acts_on
        else:
            acts_on = None
        if acts_on is None:  # it may hold any dof
            return
        known.append(acts_on[acts_on < basis.N])
    loose = others(basis.N, *known)
    if len(loose):
        raise ValueError(
            f"{len(loose)} dofs belong to no solid among the forms and are not fixed; the "
            f"first is at {format_point(basis.doflocs[:, loose[0]])}{_without(basis, count)}. Give "
            "every body a form, also one that is activated later, or leave it out of the mesh"
        )


def check_pairs(forms: Forms) -> None:
    """Refuse two contact pairs of the same facets that do more than the work of one together."""
    pairs = having(forms, ContactBase)
    if len(pairs) < 2:
        return
    sides = {}
    for name, pair in pairs.items():
        sides[name] = _facets_of(pair.slave), _facets_of(pair.facets)
    for one, other in combinations(pairs, 2):
        slave, master = sides[one]
        alike = not (slave.isdisjoint(sides[other][0]) or master.isdisjoint(sides[other][1]))
        turned = not (slave.isdisjoint(sides[other][1]) or master.isdisjoint(sides[other][0]))
        if (alike or turned) and _work_of(pairs[one]) + _work_of(pairs[other]) > 1.0:
            raise ValueError(
                f"'{one}' and '{other}' are contact of the same facets: stiffness, adhesion and "
                "bonds act twice; leave one out or deactivate it, or give both share=0.5 for two "
                "passes"
            )


def _facets_of(surface: Surface) -> set[Any]:
    """Return the facets of a surface by their dofs; a rigid one is the same as itself alone."""
    if surface.rigid:
        return {id(surface)}
    dofs = np.sort(surface.dofs[surface.facets, 0], axis=1)
    return set(map(tuple, dofs.tolist()))


def _work_of(pair: ContactBase) -> float:
    """Return the share of the work of contact that a pair does; of one surface both walls do it."""
    return pair.share * (2.0 if pair.folds else 1.0)


def _without(basis: CellBasis, count: ndarray) -> str:
    """Return the subdomains without a solid, for a message."""
    covered = np.flatnonzero(count)
    names = []
    for name, part in (basis.mesh.subdomains or {}).items():
        if not np.isin(part, covered).any():
            names.append(name)
    if names:
        return f", in the subdomains {names}"
    return ""


def _check_bodies(
    basis: CellBasis,
    elements: ndarray,
    joined: Sequence[ndarray],
    fixed: ndarray,
    axial: bool,
) -> None:
    """Check groups of bodies that contact joins: supports leave a group no common rigid motion.

    Without some of its elements a body may fall apart into several. In axial symmetry the one rigid
    motion is the one along the axis.
    """
    # Find the dofs of each body.
    mesh = basis.mesh
    if len(elements) < mesh.nelements:
        mesh = mesh.restrict(elements, skip_boundaries=True)
    dofs = {}
    for name, part in bodies(mesh).items():
        dofs[name] = different(basis.N, basis.dofs.element_dofs[:, elements[part]])
    # Check the bodies that are joined, as one.
    groups, obstacles = _groups(dofs, joined)
    for group in groups:
        held = np.intersect1d(np.concatenate([dofs[name] for name in group]), fixed)
        modes = rigid_modes(basis.doflocs, held)
        if axial:
            modes = modes[:, 1:2]
        # The rank is how many rigid motions the supports hold.
        free = modes.shape[1] - int(np.linalg.matrix_rank(modes, tol=1e-9))
        if free and not group & obstacles:
            listed = " and ".join(f"'{name}'" for name in sorted(group))
            who = f"the bodies {listed} hold only each other"
            if len(group) == 1:
                who = f"body {listed} is not held"
            raise ValueError(
                f"{who}: {len(held)} of the dofs are fixed, which leaves {free} of "
                f"{modes.shape[1]} rigid motions free; give Model(forms, fixed), such as "
                "box_supports(basis)"
            )


def _groups(
    dofs: Mapping[str, ndarray], joined: Sequence[ndarray]
) -> tuple[list[set[str]], set[str]]:
    """Return groups of bodies that are joined, and the bodies that meet a rigid obstacle."""
    # Begin with each body alone; each contact joins what it meets.
    groups = [{name} for name in dofs]
    obstacles: set[str] = set()
    for surfaces in joined:
        if not len(surfaces):
            continue
        met = {name for name in dofs if np.isin(surfaces, dofs[name]).any()}
        apart = []
        together = set(met)
        for group in groups:
            if group & met:
                together |= group
            else:
                apart.append(group)
        groups = apart
        if together:
            groups.append(together)
        if (surfaces < 0).any():
            obstacles |= met
    return groups, obstacles
