r"""Solids of large rotations and strains: deformation, internal force and tangent of all elements.

The formulation is total Lagrangian, with the multiplicative split of the deformation gradient and
logarithmic elastic strains. With :math:`F = Q U`, a law works on Kirchhoff stresses t in the frame
of the stretch U. Of the accepted state,

.. math::

    e_n = D^{-1} t_n, \qquad C_p^{-1} = U_n^{-1} \exp(2 e_n) U_n^{-1} ,

and of displacements,

.. math::

    e = \tfrac12 \ln(U C_p^{-1} U), \quad t = \mathrm{law}(e - e_n, t_n), \quad
    S = U^{-1} t\, U^{-1}, \quad P = F S, \quad f = \int P : \nabla N .

S depends on :math:`C = F^T F` alone: stresses and the memory of a law turn with the body. The
tangent is exact, :math:`\int \nabla N : (F (dS/dE) F^T + 1 \otimes S) : \nabla N`.

F-bar (de Souza Neto et al. 1996): :math:`\bar F = s F`, :math:`s = (J_0 / J)^{1/d}`, with
:math:`J_0` at the centre of the element, and d = 2 in plane strain, else 3. Then
:math:`S = s^{2-d} S(\bar C)`, and the tangent has a term of rank one at each point, which is not
symmetric.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy import ndarray
from skfem import Basis, CellBasis

from ..errors import IncrementTooLarge
from ..layout import centroids, elements_of
from .assembly import Pattern, shape_gradients
from .base import Coordinates
from .stretch_plane import PlaneStretch
from .stretch_space import SpaceStretch

#: Points of a batch: their tensors stay in the processor's cache.
_POINTS = 8192
#: Share of its volume to which an element may be compressed.
_CRUSHED = 1e-3

Stretch = PlaneStretch | SpaceStretch


@dataclass(frozen=True)
class _Batch:
    """Slice of elements with the stretch at their points."""

    elements: slice
    stretch: Stretch


class FiniteKinematics:
    """Geometry of a basis for large displacements.

    Parameters
    ----------
    basis
        Basis of displacements.
    weight : ndarray, shape (n_elements, n_points)
        Weights of the integration points, of the undeformed mesh.
    coordinates
        Coordinate system.
    f_bar
        True for volumes of the centre of each element.
    """

    def __init__(
        self,
        basis: CellBasis,
        weight: ndarray,
        coordinates: Coordinates,
        f_bar: bool,
    ) -> None:
        self.basis = basis
        self.weight = weight
        self.f_bar = f_bar
        self.dim = basis.mesh.dim()
        self.axial = coordinates == "axisymmetric"
        self.stretch: type[Stretch] = PlaneStretch if self.dim == 2 else SpaceStretch
        #: Rows of a gradient that are its diagonal.
        self.diagonal = (0, 1, 2) if self.dim == 2 else (0, 4, 8)
        #: Axes that F-bar scales.
        self.scaled = 3 if self.axial else self.dim
        #: Components of stresses and strains whose virtual work is not zero.
        self.acting = {2: [0, 1, 3], 3: list(range(6))}[self.dim]
        if self.axial:
            self.acting = [0, 1, 2, 3]
        self.G = self._operator(basis)
        self.G_centre = None
        if f_bar:
            centre = np.full((self.dim, 1), 0.5), np.ones(1)
            at_centre = Basis(basis.mesh, basis.elem, quadrature=centre, elements=basis.tind)
            self.G_centre = self._operator(at_centre)
        self.element_dofs = np.ascontiguousarray(basis.element_dofs.T)
        self.step = max(1, _POINTS // weight.shape[1])

    def _operator(self, basis: CellBasis) -> ndarray:
        """Return gradients of shape functions, (n_elements, n_points, axes, n_functions).

        In axial symmetry a third axis has ``N / r`` for the radial displacement.
        """
        G = shape_gradients(basis).transpose(0, 1, 3, 2)
        if not self.axial:
            return np.ascontiguousarray(G)
        # The hoop stretch is 1 + u_r / r.
        radius = np.asarray(basis.global_coordinates())[0]
        values = np.stack([np.asarray(field)[0] for (field,) in basis.basis[::2]])
        hoop = (values / radius).transpose(1, 2, 0)
        return np.concatenate((G, hoop[:, :, None]), axis=2)

    def gradient(self, x: ndarray, centre: bool = False) -> ndarray:
        """Return ``F - 1``, (5 or 9, n_elements, n_points).

        Components are xx, yy, zz, xy, yx in the plane and row by row in space.
        """
        # Gather the displacements of each element.
        G = self.G_centre if centre else self.G
        assert G is not None
        n_elements, n_points, n_axes, n_functions = G.shape
        u = x.take(self.element_dofs).reshape(n_elements, n_functions, self.dim)
        # Multiply by the gradients of shape functions: H_iJ = u_i,J.
        flat = G.reshape(n_elements, n_points * n_axes, n_functions)
        T = np.matmul(flat, u).reshape(n_elements, n_points, n_axes, self.dim)
        H = np.zeros((5 if self.dim == 2 else 9, n_elements, n_points))
        if self.dim == 3:
            for row in range(9):
                i, J = divmod(row, 3)
                H[row] = T[:, :, J, i]
            return H
        # Plane strain has no third gradient but the hoop strain of axial symmetry.
        for row, (i, J) in {0: (0, 0), 1: (1, 1), 3: (0, 1), 4: (1, 0)}.items():
            H[row] = T[:, :, J, i]
        if self.axial:
            H[2] = T[:, :, 2, 0]
        return H

    def batches(self) -> list[slice]:
        """Return slices of elements."""
        n = len(self.G)
        return [slice(start, min(start + self.step, n)) for start in range(0, n, self.step)]

    def inverse_plastic(self, gradient: ndarray, elastic: ndarray) -> ndarray:
        """Return ``Cp^-1 - 1`` of an accepted state, (n_components, n_elements, n_points)."""
        result = np.empty_like(elastic)
        for part in self.batches():
            shape = elastic[:, part].shape
            stretch = self.stretch(gradient[:, part].reshape(len(gradient), -1))
            found = stretch.inverse_plastic(elastic[:, part].reshape(len(elastic), -1))
            result[:, part] = found.reshape(shape)
        return result

    def log_strain(self, gradient: ndarray) -> ndarray:
        """Return ``ln V``, (n_components, n_elements, n_points), in space axes; V^2 = F F^T."""
        transposed = gradient[list(self.stretch.transposed)]
        shape = gradient.shape[1:]
        stretch = self.stretch(transposed.reshape(len(gradient), -1))
        return stretch.log_strain().reshape(-1, *shape)

    def cauchy(self, gradient: ndarray, stress: ndarray) -> ndarray:
        """Return Cauchy stresses ``F S F^T / J`` in space axes by t, (n_components, ...)."""
        shape = stress.shape
        flat = gradient.reshape(len(gradient), -1)
        # S = U^-1 t U^-1
        S = self.stretch(flat).second(stress.reshape(len(stress), -1))
        F = _full(flat)
        # sigma = F S F^T / J
        T = F @ _symmetric(S) @ F.transpose(0, 2, 1)
        T /= (1.0 + self.stretch.growth(flat))[:, None, None]
        pairs = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))[: len(stress)]
        return np.stack([T[:, i, j] for i, j in pairs]).reshape(shape)

    def at(self, x: ndarray) -> Deformation:
        """Return the deformation of displacements.

        Raises
        ------
        IncrementTooLarge
            An element that turns inside out.
        """
        H = self.gradient(x)
        growth = self._checked(H)
        if not self.f_bar:
            return Deformation(self, H, H, None)
        # F-bar = (J_0 / J)^(1/d) F, with J_0 at the centre of the element.
        centre = self.gradient(x, centre=True)
        log = (np.log1p(self._checked(centre)) - np.log1p(growth)) / self.scaled
        mean = H * np.exp(log)
        # As differences from one: s F - 1 = s (F - 1) + (s - 1).
        for row in self.diagonal:
            mean[row] += np.expm1(log)
        if self.scaled == 2:
            mean[2] = H[2]
        return Deformation(self, H, mean, log, centre)

    def growth(self, gradient: ndarray) -> ndarray:
        """Return ``det F - 1``, (n_elements, n_points)."""
        flat = gradient.reshape(len(gradient), -1)
        return self.stretch.growth(flat).reshape(gradient.shape[1:])

    def _checked(self, gradient: ndarray) -> ndarray:
        growth = self.growth(gradient)
        if not (growth > _CRUSHED - 1.0).all():
            # Name the coordinates of the worst element.
            worst = int(np.argmin(growth)) // gradient.shape[2]
            element = elements_of(self.basis)[worst]
            at = centroids(self.basis.mesh, element)
            where = ", ".join(f"{value:.4g}" for value in at)
            raise IncrementTooLarge(f"the element at ({where}) turns inside out")
        return growth


class Deformation:
    """Deformation of displacements, with force and tangent of stresses and moduli.

    Attributes
    ----------
    gradient : ndarray
        ``F - 1`` as laws get it: with F-bar the scaled one.
    """

    def __init__(
        self,
        kinematics: FiniteKinematics,
        own: ndarray,
        gradient: ndarray,
        log: ndarray | None,
        centre: ndarray | None = None,
    ) -> None:
        self._k = kinematics
        self._own = own
        self.gradient = gradient
        self._log = log
        self._centre = centre

    @property
    def acting(self) -> list[int]:
        """Components of stresses and strains whose virtual work is not zero."""
        return self._k.acting

    @property
    def parts(self) -> list[slice]:
        """Slices of elements that are computed together."""
        return self._k.batches()

    @cached_property
    def _batches(self) -> list[_Batch]:
        n = len(self.gradient)
        return [
            _Batch(part, self._k.stretch(self.gradient[:, part].reshape(n, -1)))
            for part in self._k.batches()
        ]

    def strain(self, plastic: ndarray) -> ndarray:
        """Return elastic trial strains, (n_components, n_elements, n_points)."""
        return self._strains(self._k.stretch.log_strain, plastic)

    def strain_of(self, step: ndarray) -> ndarray:
        """Return the change of :meth:`strain` in a step, linearised."""
        k = self._k
        change = k.gradient(step)
        if self._log is not None:
            change = self._scaled(change, step)
        return self._strains(k.stretch.log_strain_of, change)

    def _strains(self, of_stretch: Callable[[Any, ndarray], ndarray], values: ndarray) -> ndarray:
        """Return strains that a method of the stretch gives by values, components first."""
        result = np.empty((4 if self._k.dim == 2 else 6, *values.shape[1:]))
        for batch in self._batches:
            part = values[:, batch.elements]
            e = of_stretch(batch.stretch, part.reshape(len(part), -1))
            result[:, batch.elements] = e.reshape(len(result), *part.shape[1:])
        return result

    def _scaled(self, change: ndarray, step: ndarray) -> ndarray:
        """Return the change of F-bar, ``s dF + d ln s F-bar`` along the scaled axes."""
        k = self._k
        assert self._log is not None
        n = len(change)
        at_points = k.stretch.growth_of(self._own.reshape(n, -1), change.reshape(n, -1))
        scaling = (self.growth_of(step) - at_points.reshape(self._log.shape)) / k.scaled
        result = np.exp(self._log) * change + scaling * self.gradient
        for row in k.diagonal:
            result[row] += scaling
        if k.scaled == 2:
            result[2] = change[2]
        return result

    def _second(self, batch: _Batch, stress: ndarray) -> ndarray:
        """Return S, (n_components, m), at the points of a batch."""
        return batch.stretch.second(stress[:, batch.elements].reshape(len(stress), -1))

    def _share(self, batch: _Batch, power: int) -> ndarray | float:
        """Return ``s^power`` at the points of a batch, (m,)."""
        if self._log is None or power == 0:
            return 1.0
        return np.exp(power * self._log[batch.elements].ravel())

    def force(self, stress: ndarray) -> ndarray:
        """Return the internal force, (N,), of stresses t, (n_components, n_elements, n_points)."""
        k = self._k

        def first(batch: _Batch, F: ndarray) -> ndarray:
            # P = F S with the stress of the law; F-bar scales it by s^(2 - d).
            S = self._second(batch, stress) * self._share(batch, 2 - k.scaled)
            return _first(F, S * k.weight[batch.elements].ravel(), k.dim, k.axial)

        return self._assembled(first)

    def force_of_pressure(self, tension: ndarray) -> ndarray:
        r"""Return the internal force, (N,), of mean stresses, (n_elements, n_points).

        Of stresses t = p 1, S = p C^-1, and with F-bar :math:`P = s^{-d} p F^{-T}`.
        """
        k = self._k
        weighted = tension * k.weight

        def first(batch: _Batch, F: ndarray) -> ndarray:
            p = weighted[batch.elements].ravel() * self._share(batch, -k.scaled)
            return p[:, None, None] * _inverse(F, k.dim, k.axial)

        return self._assembled(first)

    def _assembled(self, first: Callable[[_Batch, ndarray], ndarray]) -> ndarray:
        """Return the internal force, (N,), of weighted P, (m, axes, dim), by batch and its F."""
        k = self._k
        force = np.empty(k.element_dofs.shape)
        for batch in self._batches:
            part = batch.elements
            F = self._own[:, part].reshape(len(self._own), -1)
            force[part] = self._nodal(part, first(batch, F))
        return np.bincount(k.element_dofs.ravel(), force.ravel(), minlength=k.basis.N)

    def log_growth(self, x: ndarray) -> ndarray:
        """Return ln J of displacements, (n_elements, n_points or 1).

        With F-bar it is the one at the centre of each element.
        """
        k = self._k
        return np.log1p(k.growth(k.gradient(x, centre=k.f_bar)))

    def growth_of(self, step: ndarray) -> ndarray:
        """Return the change of ln J in a step, linearised, (n_elements, n_points or 1).

        With F-bar it is the one at the centre of each element.
        """
        k = self._k
        H = self._own
        if k.f_bar:
            assert self._centre is not None
            H = self._centre
        change = k.gradient(step, centre=k.f_bar)
        shape = H.shape[1:]
        return k.stretch.growth_of(H.reshape(len(H), -1), change.reshape(len(H), -1)).reshape(shape)

    def integral(self, values: ndarray) -> float:
        """Return the integral of values at the points, (n_elements, n_points)."""
        return float(np.vdot(self._k.weight, values))

    def _nodal(self, part: slice, P: ndarray) -> ndarray:
        """Return forces of the nodes of elements, (n, n_local), by P, (m, axes, dim), weighted."""
        G = self._k.G[part]
        flat = G.reshape(len(G), -1, G.shape[3]).transpose(0, 2, 1)
        return np.matmul(flat, P.reshape(len(G), -1, self._k.dim)).reshape(len(G), -1)

    def stiffness(
        self,
        stress: ndarray,
        moduli: Callable[[slice], ndarray],
        pattern: Pattern,
    ) -> ndarray:
        """Return the data of the tangent.

        `moduli` returns the ones of the points of some elements, (m, n, n), in acting rows.
        """
        k = self._k
        n_axes, n_functions = k.G.shape[2:]
        K = np.empty((len(k.G), n_functions, k.dim, k.dim, n_functions))
        for batch in self._batches:
            # Pull stress and moduli back to the undeformed body.
            part = batch.elements
            n = part.stop - part.start
            S = self._second(batch, stress)
            C = batch.stretch.moduli(moduli(part), S)
            S = S * self._share(batch, 2 - k.scaled)
            C = C * np.reshape(self._share(batch, 4 - k.scaled), (-1, 1, 1))
            # Integrate G^T A G by element.
            F = self._own[:, part].reshape(len(self._own), -1)
            A = _tangent(F, S, C, k.dim, k.axial)
            A *= k.weight[part].reshape(-1, 1, 1)
            G = k.G[part]
            # Rows of A are axis, component, component; its columns are axes.
            AG = np.matmul(A.reshape(*G.shape[:2], -1, n_axes), G)
            flat = G.reshape(n, -1, n_functions).transpose(0, 2, 1)
            AG = AG.reshape(n, flat.shape[2], -1)
            K[part] = np.matmul(flat, AG).reshape(n, n_functions, k.dim, k.dim, n_functions)
            if k.f_bar:
                K[part] += self._of_volume(batch, F, S, C)
        return pattern.scatter_by_components(K)

    def _of_volume(self, batch: _Batch, F: ndarray, S: ndarray, C: ndarray) -> ndarray:
        r"""Return the part of F-bar: :math:`B^T q (g_0 - g)^T / d`.

        With :math:`q = s^{4-d} (dS/dE) : C + (2 - d) S` and the derivatives g of ln J.
        """
        k = self._k
        part = batch.elements
        n = part.stop - part.start
        # q
        full = _full(F)
        right = full.transpose(0, 2, 1) @ full
        pairs = np.array([(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)])[k.acting]
        doubled = np.where(pairs[:, 0] == pairs[:, 1], 1.0, 2.0)
        q = np.einsum("mrc,mc->rm", C, right[:, pairs[:, 0], pairs[:, 1]] * doubled)
        if k.scaled == 3:
            q -= S[k.acting]
        all_q = np.zeros_like(S)
        all_q[k.acting] = q
        P = _first(F, all_q * k.weight[part].ravel(), k.dim, k.axial)
        G = k.G[part]
        n_functions = G.shape[3]
        forces = np.matmul(
            G.transpose(0, 1, 3, 2), P.reshape(*G.shape[:3], k.dim)
        )  # (n, points, functions, dim)

        # derivatives of ln J
        assert k.G_centre is not None
        assert self._centre is not None
        centre = self._centre[:, part].reshape(len(F), -1)
        g = _of_growth(G, F, k.dim, k.axial)
        g_centre = _of_growth(k.G_centre[part], centre, k.dim, k.axial)
        v = (g_centre - g) / k.scaled  # (n, points, dim, functions)

        forces = forces.reshape(n, G.shape[1], -1).transpose(0, 2, 1)
        product = np.matmul(forces, v.reshape(n, G.shape[1], -1))
        return product.reshape(n, n_functions, k.dim, k.dim, n_functions)


def _full(gradient: ndarray) -> ndarray:
    """Return F, (m, 3, 3), by the components of ``F - 1``, (5 or 9, m)."""
    if len(gradient) == 9:
        return gradient.T.reshape(-1, 3, 3) + np.eye(3)
    # Components in the plane: xx, yy, zz, xy, yx.
    F = np.zeros((gradient.shape[1], 3, 3))
    for row, (i, J) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (1, 0))):
        F[:, i, J] = gradient[row]
    return F + np.eye(3)


def _symmetric(a: ndarray) -> ndarray:
    """Return tensors, (m, 3, 3), of components, (4 or 6, m)."""
    T = np.zeros((a.shape[1], 3, 3))
    pairs = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
    for row, (i, j) in zip(a, pairs):
        T[:, i, j] = row
        T[:, j, i] = row
    return T


def _rows(F: ndarray, dim: int) -> list[list[ndarray]]:
    """Return the components of F along the axes of displacements."""
    if dim == 3:
        return [[F[3 * i + J] + float(i == J) for J in range(3)] for i in range(3)]
    return [[1.0 + F[0], F[3]], [F[4], 1.0 + F[1]]]


def _first(F: ndarray, S: ndarray, dim: int, axial: bool) -> ndarray:
    """Return ``P = F S``, (m, axes, dim), of components first."""
    rows = _rows(F, dim)
    at = ((0, 3, 5), (3, 1, 4), (5, 4, 2))
    P = np.zeros((F.shape[1], dim + axial, dim))
    # P_iJ = F_iK S_KJ
    for i in range(dim):
        for J in range(dim):
            P[:, J, i] = sum(rows[i][k] * S[at[k][J]] for k in range(dim))
    # The hoop direction has no shear.
    if axial:
        P[:, 2, 0] = (1.0 + F[2]) * S[2]
    return P


def _tangent(F: ndarray, S: ndarray, C: ndarray, dim: int, axial: bool) -> ndarray:
    """Return dP / dF, (m, axes dim dim, axes), as axis, component, component, axis.

    With ``dE = Phi dF``, ``dP / dF = Phi^T (dS / dE) Phi + 1 x S``.
    """
    # Variation of the strain: dE = Phi : dF with the rows of F.
    rows = _rows(F, dim)
    n_axes = dim + axial
    n = C.shape[1]
    at = ((0, 3, 5), (3, 1, 4), (5, 4, 2)) if n != 3 else ((0, 2), (2, 1))
    Phi = np.zeros((len(C), n, dim, n_axes))
    for k in range(dim):
        for L in range(dim):
            for I in range(dim):
                Phi[:, at[I][L], k, L] = rows[k][I]
    if axial:
        Phi[:, 2, 0, 2] = 1.0 + F[2]
    # Material part: Phi^T C Phi.
    left = Phi.transpose(0, 1, 3, 2).reshape(len(C), n, -1)
    A = np.matmul(left.transpose(0, 2, 1), np.matmul(C, Phi.reshape(len(C), n, -1)))
    A = A.reshape(len(C), n_axes, dim, dim, n_axes)
    # Geometric part: S times the unit matrix.
    at = ((0, 3, 5), (3, 1, 4), (5, 4, 2))
    for J in range(dim):
        for L in range(dim):
            for i in range(dim):
                A[:, J, i, i, L] += S[at[J][L]]
    if axial:
        A[:, 2, 0, 0, 2] += S[2]
    return A.reshape(len(C), -1, n_axes)


def _of_growth(G: ndarray, F: ndarray, dim: int, axial: bool) -> ndarray:
    """Return the derivatives of ln J by displacements, (n, points, dim, functions)."""
    n, n_points, n_axes, _ = G.shape
    inverse = _inverse(F, dim, axial).reshape(n, n_points, n_axes, dim)
    return np.matmul(inverse.transpose(0, 1, 3, 2), G)


def _inverse(F: ndarray, dim: int, axial: bool) -> ndarray:
    """Return ``F^-1``, (m, axes, dim), along the axes of displacements."""
    rows = _rows(F, dim)
    if dim == 3:
        return np.linalg.inv(np.array(rows).transpose(2, 0, 1))
    # The inverse of two rows and columns is in closed form.
    (a, b), (c, d) = rows
    inverse = np.zeros((len(a), dim + axial, dim))
    inverse[:, :2] = np.array(((d, -b), (-c, a))).transpose(2, 0, 1)
    inverse[:, :2] /= (a * d - b * c)[:, None, None]
    if axial:
        inverse[:, 2, 0] = 1.0 / (1.0 + F[2])
    return inverse
