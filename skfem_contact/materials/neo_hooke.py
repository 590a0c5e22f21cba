"""Rubber: compressible neo-Hookean elasticity on logarithmic strains."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from typing_extensions import override

from ..arrays import max_abs
from .base import Array, Update, along_elements, check_shapes
from .elastic import Isotropic
from .spectral import Frame, principal

#: Newton's iterations for the volume of a stress, which converge monotonically; 6 are usual.
_ITERATIONS = 60
#: Smallest square of a stretch at which they begin.
_LEAST = 1e-9


@dataclass(frozen=True, eq=False)
class NeoHooke(Isotropic):
    r"""Neo-Hookean elasticity of rubber.

    The stress follows from the energy (J. Simo and K. Pister 1984)

    .. math::

        W = \frac{\mu}{2}\left(\mathrm{tr}\,b - 3 - 2 \ln J\right) + \frac{\lambda}{2} (\ln J)^2,
        \qquad \tau = \mu (b - 1) + \lambda \ln J\, 1,

    with :math:`b = F F^T` and the Kirchhoff stress :math:`\tau`, for solids of finite kinematics.
    In a solid of small ones, strains count as logarithmic. A parameter is a number, one number an
    element, or a function of the coordinates.

    Parameters
    ----------
    E
        Young's modulus at small strains.
    nu
        Poisson's ratio at small strains; .499 for rubber, with ``strain="f_bar"`` in elements of
        corner nodes.

    Examples
    --------
    A strip is stretched to three times its length: :math:`\tau = \mu (l^2 - 1)` for nu = 0.

    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> rubber = sc.NeoHooke(E=2., nu=0.)
    >>> strain = np.log(3.) * np.array([1., 0., 0., 0.])[:, None]
    >>> rubber.at_strain(strain, np.zeros((0, 1))).stress[:, 0].round(9)
    array([8., 0., 0., 0.])
    """

    stress_dependent = True
    hyperelastic = True

    @property
    @override
    def symmetric(self) -> bool:
        return True

    @override
    def elastic_strain(self, stress: Array, internal: Array) -> Array:
        frame = self._strain_frame(stress)
        strain = frame.stress(frame.values)
        strain[3:] *= 2.0
        return strain.reshape(stress.shape)

    def _constants(self, shape: tuple[int, ...]) -> tuple[Array, Array]:
        """Return Lamé's constants at the points of a field (ncomp, n_elements, ...), (n,) each."""
        lam, mu = (along_elements(value, shape) for value in self.lame)
        return np.broadcast_to(lam, shape[1:]).ravel(), np.broadcast_to(mu, shape[1:]).ravel()

    def _strain_frame(self, stress: Array) -> Frame:
        """Return principal logarithmic strains of stresses, with their directions.

        ``ln J`` solves ``sum ln(1 + (tau_i - lambda ln J) / mu) / 2 = ln J``, whose residual is
        concave: iterations from the linear solution fall to the root.
        """
        # Begin from the growth of small strains, within the range of the logarithm.
        lam, mu = self._constants(stress.shape)
        frame = principal(stress.reshape(len(stress), -1))
        tau = frame.values
        growth = tau.sum(axis=0) / (3.0 * lam + 2.0 * mu)
        with np.errstate(divide="ignore", invalid="ignore"):
            limit = (tau[2] + (1.0 - _LEAST) * mu) / lam
        growth = np.where(lam > 0.0, np.minimum(growth, limit), growth)
        # Solve sum of log1p(z) / 2 = growth by Newton's method.
        for _ in range(_ITERATIONS):
            z = (tau - lam * growth) / mu
            residual = 0.5 * np.log1p(z).sum(axis=0) - growth
            inverse = (1.0 / (1.0 + z)).sum(axis=0)
            slope = 0.5 * lam / mu * inverse + 1.0
            change = residual / slope
            growth = growth + change
            largest = max_abs(growth)
            if not max_abs(change) > 1e-15 * largest:
                break
        z = (tau - lam * growth) / mu
        return frame._replace(values=0.5 * np.log1p(z))

    @override
    def elasticity(
        self,
        ncomp: int,
        stress: Array | None = None,
        internal: Array | None = None,
    ) -> Array:
        if stress is None:
            return super().elasticity(ncomp)
        lam, mu = self._constants(stress.shape)
        moduli = _tangent(self._strain_frame(stress), lam, mu)
        return moduli.reshape(*stress.shape[1:], ncomp, ncomp)

    @override
    def update(self, strain_increment: Array, stress: Array, internal: Array) -> Update:
        check_shapes(strain_increment, stress)
        return self.at_strain(self.elastic_strain(stress, internal) + strain_increment, internal)

    @override
    def at_strain(self, strain: Array, internal: Array) -> Update:
        lam, mu = self._constants(strain.shape)
        tensor = strain.reshape(len(strain), -1).copy()
        tensor[3:] *= 0.5
        frame = principal(tensor)
        new = frame.stress(_principal_stresses(frame.values, lam, mu))
        return Update(
            new.reshape(strain.shape),
            internal,
            np.arange(lam.size),
            lambda: _tangent(frame, lam, mu),
        )


def _principal_stresses(strain: Array, lam: Array, mu: Array) -> Array:
    """Return Kirchhoff stresses, (3, n), of principal logarithmic strains."""
    # tau = mu (b - 1) + lambda ln J
    return mu * np.expm1(2.0 * strain) + lam * strain.sum(axis=0)


def _tangent(frame: Frame, lam: Array, mu: Array) -> Array:
    """Return d tau / d e, (n, ncomp, ncomp), engineering shear, at a frame of strains."""
    # d tau_i / d e_j = lambda + 2 mu b_i delta_ij
    moduli = np.empty((3, 3, lam.size))
    moduli[:] = lam
    for own, strain in enumerate(frame.values):
        moduli[own, own] += 2.0 * mu * np.exp(2.0 * strain)
    # shear between principal axes: (tau_i - tau_j) / (e_i - e_j) / 2
    return frame.tangent(moduli, _principal_stresses(frame.values, lam, mu), shear=0.5)
