"""Rubber: compressible neo-Hookean elasticity on logarithmic strains."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from typing_extensions import override

from ..arrays import max_abs
from .base import Array, Parameter, Update, along_elements, check_shapes
from .elastic import Isotropic
from .spectral import COLUMN, ROW, rotation

#: Newton's iterations for the volume of a stress, which converge monotonically; 6 are usual.
_ITERATIONS = 60
#: Smallest square of a stretch at which they begin.
_LEAST = 1e-9
#: Difference of logarithmic strains below which slopes between them are a series.
_CLOSE = 1e-6


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
    >>> rubber.update(strain, np.zeros((4, 1)), np.zeros((0, 1))).stress[:, 0].round(9)
    array([8., 0., 0., 0.])
    """

    stress_dependent = True

    @property
    @override
    def symmetric(self) -> bool:
        return True

    @override
    def elastic_strain(self, stress: Array, internal: Array) -> Array:
        values, vectors = _principal(stress, 1.0)
        return _components(self._strains(values, stress.shape), vectors, len(stress), 2.0)

    def _constants(self, shape: tuple[int, ...]) -> tuple[Parameter, Parameter]:
        """Return Lamé's constants at the points of a field (ncomp, n_elements, ...)."""
        lam, mu = self.lame
        return along_elements(lam, shape), along_elements(mu, shape)

    def _strains(self, stress: Array, shape: tuple[int, ...]) -> Array:
        """Return principal logarithmic strains, (..., 3), of principal stresses.

        ``ln J`` solves ``sum ln(1 + (tau_i - lambda ln J) / mu) / 2 = ln J``, whose residual is
        concave: iterations from the linear solution fall to the root.
        """
        # Begin from the growth of small strains, within the range of the logarithm.
        lam, mu = (np.broadcast_to(value, shape[1:]) for value in self._constants(shape))
        growth = stress.sum(axis=-1) / (3.0 * lam + 2.0 * mu)
        with np.errstate(divide="ignore", invalid="ignore"):
            limit = (stress.min(axis=-1) + (1.0 - _LEAST) * mu) / lam
        growth = np.where(lam > 0.0, np.minimum(growth, limit), growth)
        # Solve sum of log1p(z) / 2 = growth by Newton's method.
        for _ in range(_ITERATIONS):
            z = (stress - (lam * growth)[..., None]) / mu[..., None]
            residual = 0.5 * np.log1p(z).sum(axis=-1) - growth
            inverse = (1.0 / (1.0 + z)).sum(axis=-1)
            slope = 0.5 * lam / mu * inverse + 1.0
            change = residual / slope
            growth = growth + change
            largest = max_abs(growth)
            if not max_abs(change) > 1e-15 * largest:
                break
        z = (stress - (lam * growth)[..., None]) / mu[..., None]
        return 0.5 * np.log1p(z)

    @override
    def elasticity(
        self,
        ncomp: int,
        stress: Array | None = None,
        internal: Array | None = None,
    ) -> Array:
        if stress is None:
            return super().elasticity(ncomp)
        values, vectors = _principal(stress, 1.0)
        return self._tangent(self._strains(values, stress.shape), vectors, ncomp, stress.shape)

    @override
    def update(self, strain_increment: Array, stress: Array, internal: Array) -> Update:
        check_shapes(strain_increment, stress)
        ncomp = len(stress)
        shape = stress.shape
        strain = self.elastic_strain(stress, internal) + strain_increment
        values, vectors = _principal(strain, 0.5)
        lam, mu = self._constants(shape)
        of_volume = lam * values.sum(axis=-1)
        tau = np.expm1(2.0 * values) * np.expand_dims(mu, -1) + of_volume[..., None]
        new = _components(tau, vectors, ncomp, 1.0)

        def tangent() -> Array:
            moduli = self._tangent(values, vectors, ncomp, shape)
            return moduli.reshape(-1, ncomp, ncomp)

        return Update(new, internal, np.arange(values[..., 0].size), tangent)

    def _tangent(self, strain: Array, vectors: Array, ncomp: int, shape: tuple[int, ...]) -> Array:
        """Return d tau / d e, (..., ncomp, ncomp), engineering shear, of principal strains."""
        lam, mu = (np.broadcast_to(value, shape[1:]) for value in self._constants(shape))
        # moduli along the principal axes: mu (b_i - b_j) / (e_i - e_j), 2 mu b_i where they meet
        b = np.exp(2.0 * strain)
        difference = strain[..., ROW] - strain[..., COLUMN]
        close = np.abs(difference) < _CLOSE
        mean = np.exp(strain[..., ROW] + strain[..., COLUMN])
        ratio = np.divide(
            np.sinh(difference), difference, out=np.ones_like(difference), where=~close
        )
        along = 2.0 * mu[..., None] * mean * ratio
        along[..., :3] = 2.0 * mu[..., None] * b
        R = rotation(vectors)[..., :ncomp]
        back = R.copy()
        back[..., 3:, :] *= 2.0  # shears count twice
        D = np.swapaxes(back, -1, -2) @ (along[..., None] * R)
        D[..., :, 3:] *= 0.5
        D[..., 3:, :] *= 0.5
        D[..., :3, :3] += lam[..., None, None]
        return np.asarray(D)


def _principal(tensor: Array, shear: float) -> tuple[Array, Array]:
    """Return eigenvalues, (..., 3), and eigenvectors of tensors of components (4 or 6, ...)."""
    T = np.zeros((*tensor.shape[1:], 3, 3))
    for values, i, j in zip(tensor, ROW, COLUMN):
        T[..., i, j] = values if i == j else shear * values
        T[..., j, i] = T[..., i, j]
    return np.linalg.eigh(T)


def _components(values: Array, vectors: Array, ncomp: int, shear: float) -> Array:
    """Return components, (ncomp, ...), of eigenvalues and eigenvectors."""
    T = (vectors * values[..., None, :]) @ np.swapaxes(vectors, -1, -2)
    components = T[..., ROW[:ncomp], COLUMN[:ncomp]]
    result = np.moveaxis(components, -1, 0).copy()
    result[3:] *= shear
    return result
