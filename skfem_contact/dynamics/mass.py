"""Mass and damping of all forms of a stage."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import block_diag, csr_matrix, diags_array, eye_array, kron
from scipy.sparse.linalg import splu

from ..checks import look_up
from ..forms.base import Forms, solids_of
from ..forms.roles import Absorbing, Loaded, Touching, having
from ..layout import Layout, nodes
from ..sparse import padded, within
from .boundaries import Masses
from .settings import Dynamic, Rayleigh

#: Neighbours take the mass of a contact node by their distances to this power: it moves along the
#: normal, and hardly sideways. Blocks of 4 x 4 pairs of linear and quadratic triangles that fall
#: freely turn by 3.5 and 0.8 % of their way with -4, by 1.1 and 0.2 % with -8. With -16 they do by
#: 0.1 and 0.03 %, but slides at a tolerance of 1e-3 err by 3.7 %, and by 0.6 % with -8.
_NEAR = -8


def mass_and_damping(
    forms: Forms,
    layout: Layout,
    settings: Dynamic,
    acceleration: float,
) -> tuple[csr_matrix, csr_matrix]:
    """Return the matrices of mass and of Rayleigh damping of active forms, (N, N).

    Parameters
    ----------
    forms, layout
        Active forms, and the numbers of all dofs.
    settings
        Settings of the stage.
    acceleration
        Acceleration of gravity: masses are weights over it.
    """
    consistent = settings.mass == "consistent"
    M = weights(forms, layout, consistent)
    C = csr_matrix(M.shape)
    # Sort the coefficients of damping by region.
    damping = _damping(forms, settings.damping)
    of_mass = {}
    of_stiffness = {}
    for name, by_region in damping.items():
        of_mass[name] = {region: given.alpha for region, given in by_region.items()}
        of_stiffness[name] = {region: given.beta for region, given in by_region.items()}
    # Add the damping by mass before masses leave contact, that by stiffness after it.
    for name, form in solids_of(forms).items():
        if of_mass.get(name):
            part = form.weight_matrix(consistent, of_mass[name])
            C = csr_matrix(C + padded(part / acceleration, layout.size))
    if settings.moves_contact_mass:
        M, C = moved_from_contact(forms, [M, C], consistent)
    for name, form in solids_of(forms).items():
        if of_stiffness.get(name):
            part = form.scaled_stiffness(of_stiffness[name])
            C = csr_matrix(C + padded(part, layout.size))
    M = csr_matrix(M / acceleration)
    # Add what boundaries bring.
    by_region = {}
    for coefficients in damping.values():
        by_region |= coefficients
    given = Masses(acceleration, consistent, by_region, layout.size)
    for form in having(forms, Absorbing).values():
        more, viscous = form.matrices(given)
        M = M + padded(more, layout.size)
        C = C + padded(viscous, layout.size)
    return _canonical(M), _canonical(C)


def _canonical(A: Any) -> csr_matrix:
    """Return a matrix with sorted entries and without zeros."""
    A = csr_matrix(A)
    A.eliminate_zeros()
    A.sort_indices()
    return A


def weights(forms: Forms, layout: Layout, consistent: bool) -> csr_matrix:
    """Return the matrix of masses times the acceleration of gravity, (N, N).

    Raises
    ------
    ValueError
        A solid without a unit weight.
    """
    total = csr_matrix((layout.size, layout.size))
    for name, form in having(forms, Loaded).items():
        matrix = form.weight_matrix(consistent)
        if matrix is None and name in solids_of(forms):
            raise ValueError(
                f"'{name}' has no unit_weight, from which its mass follows: give it, or 0 for a "
                "body without mass"
            )
        if matrix is None:
            matrix = _sums(form, layout)
        total = total + padded(matrix, layout.size)
    return csr_matrix(total)


def _sums(form: Any, layout: Layout) -> csr_matrix:
    """Return the weights of the nodes of a form on the diagonal; rotations have no mass."""
    total = np.zeros(layout.size)
    for direction in np.eye(len(layout.coordinates)):
        weight = form.own_weight(direction)
        if weight is not None:
            total[: len(weight)] += weight
    chosen = np.zeros(layout.size)
    chosen[layout.displacements] = total[layout.displacements]
    return csr_matrix(diags_array(chosen))


def _damping(
    forms: Forms, given: Rayleigh | Mapping[str, Rayleigh] | None
) -> dict[str, dict[str, Rayleigh]]:
    """Return the damping by solid and region."""
    # Check the names.
    solids = solids_of(forms)
    known = dict.fromkeys(solids)
    for form in solids.values():
        known.update(dict.fromkeys(form.materials))
    by_name: Mapping[str, Rayleigh] = given if isinstance(given, Mapping) else {}
    whole = None if isinstance(given, Mapping) else given
    for name in by_name:
        look_up(name, known, "region or solid to damp")
    # A region's own damping counts before that of its solid, and that before the whole.
    found: dict[str, dict[str, Rayleigh]] = {}
    for name, form in solids.items():
        found[name] = {}
        for region in form.materials:
            damping = by_name.get(region) or by_name.get(name) or whole
            if damping is not None:
                found[name][region] = damping
    return found


def moved_from_contact(
    forms: Forms, matrices: list[csr_matrix], consistent: bool
) -> list[csr_matrix]:
    """Return matrices of masses with the mass of contact nodes moved to their neighbours.

    Contact nodes move like a mean of their neighbours inside the body, u = P u: the mass is
    P^T M P, a lumped one P^T m. The total stays.
    """
    P = to_neighbours(forms, matrices[0].shape[0])
    if P is None:
        return matrices
    found = []
    for M in matrices:
        if consistent:
            found.append(csr_matrix(P.T @ M @ P))
        else:
            found.append(csr_matrix(diags_array(P.T @ M.diagonal())))
    return found


def to_neighbours(forms: Forms, size: int) -> csr_matrix | None:
    """Return the matrix that gives contact nodes the motion of their neighbours, (N, N)."""
    # Find the contact nodes
    pairs = having(forms, Touching).values()
    joined = [pair.joins for pair in pairs if pair.joins is not None]
    solids = list(solids_of(forms).values())
    if not joined or not solids:
        return None
    basis = solids[0].basis
    dim = basis.mesh.dim()
    dofs = np.concatenate(joined)
    dofs = dofs[(dofs >= 0) & (dofs < basis.N)]
    touching = np.zeros(basis.N // dim, bool)
    touching[dofs // dim] = True

    # Weigh their neighbours in the same elements by the distance
    first = []
    second = []
    for solid in solids:
        cells = nodes(solid.basis)
        a = np.repeat(cells, cells.shape[1], axis=1).ravel()
        b = np.tile(cells, cells.shape[1]).ravel()
        chosen = touching[a] & ~touching[b]
        first.append(a[chosen])
        second.append(b[chosen])
    pairs_of_nodes = np.stack((np.concatenate(first), np.concatenate(second)))
    both = np.unique(pairs_of_nodes, axis=1)
    if both.size == 0:
        return None
    x = basis.doflocs[:, ::dim]
    distance = np.linalg.norm(x[:, both[0]] - x[:, both[1]], axis=0)
    weight = distance**_NEAR
    n_nodes = len(touching)
    sums = np.bincount(both[0], weight, minlength=n_nodes)
    of_neighbours = csr_matrix((weight / sums[both[0]], both), shape=(n_nodes, n_nodes))

    # Nodes without a neighbour inside keep their mass, other dofs than displacements as well
    kept = diags_array(np.where(sums > 0.0, 0.0, 1.0))
    of_displacements = kron(of_neighbours + kept, eye_array(dim))
    P = csr_matrix(block_diag((of_displacements, eye_array(size - basis.N))))
    P.eliminate_zeros()
    return P


def lumped(M: csr_matrix) -> ndarray | None:
    """Return the diagonal of a mass without other entries, which needs no product, or None."""
    diagonal = M.diagonal()
    if M.nnz == np.count_nonzero(diagonal):
        return np.asarray(diagonal)
    return None


def accelerations(M: csr_matrix, force: ndarray, fixed: ndarray) -> ndarray:
    """Return accelerations by forces, zero at supports and at nodes without mass, (N,)."""
    # M a = f at dofs that are free and have mass
    diagonal = M.diagonal()
    free = diagonal > 0.0
    free[fixed] = False
    dofs = np.flatnonzero(free)
    a = np.zeros(len(force))
    if not force[dofs].any():
        return a
    # A lumped mass needs no solver.
    block = within(M, dofs).tocsc()
    if block.nnz == len(dofs):
        a[dofs] = force[dofs] / diagonal[dofs]
    else:
        a[dofs] = splu(block).solve(force[dofs])
    return a


def translation(layout: Layout, axis: int) -> ndarray:
    """Return the rigid translation along an axis, of all displacements, (N,)."""
    dim = len(layout.coordinates)
    moved = np.zeros(layout.size)
    for field, part in zip(layout.fields, layout.parts, strict=True):
        if field.kind == "displacement":
            moved[part.start + axis : part.stop : dim] = 1.0
    return moved
