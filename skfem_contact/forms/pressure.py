r"""Pressure that follows a boundary.

Per undeformed area the force of a pressure p on the deformed boundary is (Nanson)

.. math::

    f = -p\, \mathrm{cof}(F) N , \qquad
    (\mathrm{cof}(F) N)_i = \epsilon_{ij} \epsilon_{IJ} N_I F_{jJ} \quad \text{in the plane}, \qquad
    \tfrac12 \epsilon_{ijk} \epsilon_{IJK} N_I F_{jJ} F_{kK} \quad \text{in space.}

Only derivatives along the boundary enter. In axial symmetry the force grows with the radius.
"""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from itertools import permutations
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix
from skfem import FacetBasis
from typing_extensions import override

from ..checks import facets_of, is_number
from ..layout import Field
from ..loads.vectors import Body, basis_of
from .base import Form, Outputs, Response
from .roles import Couples


def _levi_civita() -> ndarray:
    """Return the permutation symbol, (3, 3, 3)."""
    symbol = np.zeros((3, 3, 3))
    for order in permutations(range(3)):
        symbol[order] = np.linalg.det(np.eye(3)[list(order)])
    return symbol


_SPACE = _levi_civita()
_PLANE = np.array([[0.0, 1.0], [-1.0, 0.0]])


class Pressure(Form, Couples):
    """Pressure on a boundary, normal to the deformed surface and per deformed area.

    The pressure is a dof of its own, for which :meth:`load` makes a load vector: it rises in the
    increments of a stage as other loads do.

    Parameters
    ----------
    body
        ``Basis`` of the mesh, or a solid form, whose coordinate system counts.
    boundary
        Name of a boundary; the pressure acts against its outward normal.

    Raises
    ------
    ValueError
        Unknown or empty boundary.

    Examples
    --------
    A sheet of rubber under pressure at its lower side:

    >>> import numpy as np
    >>> from skfem import Basis, ElementQuad2, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> mesh = MeshQuad.init_tensor(np.linspace(0, 8, 9), np.linspace(0, .5, 3)).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    >>> sheet = sc.SolidForm(basis, sc.NeoHooke(E=1e3, nu=.45), kinematics="finite")
    >>> fixed = np.concatenate([basis.get_dofs("left").all(), basis.get_dofs("right").all()])
    >>> model = sc.Model({"sheet": sheet, "air": sc.Pressure(sheet, "bottom")}, fixed)
    >>> stage = sc.Stage("blow", model.forms["air"].load(20.), increments=4)
    >>> x = model.run([stage], progress=False)["blow"].x
    >>> bool(x[basis.get_dofs("top").all("u^2")].max() > 1.)
    True
    """

    kinematics = "finite"
    joins = np.zeros(0, int)

    def __init__(self, body: Body, boundary: str) -> None:
        basis, self._axial = basis_of(body)
        self.boundary = boundary
        facets = facets_of(basis.mesh, boundary)
        surface = FacetBasis(basis.mesh, basis.elem, facets=facets, intorder=2 * basis.elem.maxdeg)
        self._dim = basis.mesh.dim()
        self.coordinates = None
        if self._axial:
            self.coordinates = "axisymmetric"
        self._n = int(basis.N)

        # Evaluate shape functions, their gradients and the normals at the points.
        functions = [field for (field,) in surface.basis[:: self._dim]]
        values = np.stack([np.asarray(field)[0] for field in functions])
        gradients = np.stack([np.asarray(field.grad)[0] for field in functions])
        shape = (len(functions), *surface.dx.shape)
        self._N = np.broadcast_to(values, shape).transpose(1, 2, 0)  # (facets, points, functions)
        self._G = gradients.transpose(2, 3, 1, 0)  # (facets, points, axes, functions)
        self._normal = np.asarray(surface.normals).transpose(1, 2, 0)
        self._weight = np.asarray(surface.dx)
        coordinates = np.asarray(surface.global_coordinates())
        self._radius = coordinates[0]

        # Number the dofs, of which the last one is the pressure.
        element_dofs = np.asarray(surface.element_dofs).T
        self._dofs, local = np.unique(element_dofs, return_inverse=True)
        self.acts_on = self._dofs
        self._local: ndarray = local.reshape(element_dofs.shape)
        self._element_dofs = element_dofs
        middle = coordinates.mean(axis=(1, 2))
        self.fields = (Field("pressure", middle[:, None], kind="multiplier"),)
        self._dof = -1
        self.changing = None

    def __repr__(self) -> str:
        return f"<Pressure on '{self.boundary}', {len(self._weight)} facets>"

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> Pressure:
        new = copy(self)
        new._dof = int(numbers[self.fields[0]][0])
        new.size = new._dof + 1
        return new

    def load(self, pressure: float) -> ndarray:
        """Return the load vector of a pressure, positive where it compresses the body.

        It belongs to the form of a model, ``model.forms[name].load(20.)``, which knows the numbers.
        Several loads of a stage are a list.
        """
        if not is_number(pressure, -np.inf, np.inf):
            raise ValueError(f"the pressure must be a finite number, not {pressure!r}")
        if self._dof < 0:
            raise ValueError(
                "this pressure has no number yet: take that of a model, model.forms[name].load(...)"
            )
        load = np.zeros(self._dof + 1)
        load[self._dof] = pressure
        return load

    @override
    def assemble(self, x: ndarray, state: Any) -> Response:
        pressure = float(x[self._dof])
        u = x.take(self._element_dofs).reshape(len(self._local), -1, self._dim)
        gradient = np.einsum("eqJa,eai->eqiJ", self._G, u)
        F = np.eye(self._dim) + gradient
        cofactors, slope = _cofactors(F, self._normal)
        radius = np.ones_like(self._weight)
        if self._axial:
            radius = self._radius + np.einsum("eqa,ea->eq", self._N, u[..., 0])
        weight = self._weight * radius

        # Integrate the unit force, which opposes the pressure, and sum it up.
        unit = np.einsum("eqa,eqi,eq->eai", self._N, cofactors, weight)
        n = len(self._dofs) + 1
        unit = np.bincount(self._local.ravel(), unit.ravel(), minlength=n)
        force = pressure * unit
        force[-1] = pressure

        def stiffness() -> csr_matrix:
            return self._stiffness(pressure, unit, cofactors, slope, weight)

        dofs = np.append(self._dofs, self._dof)
        # the pressure itself is a load: it is compared with nothing else
        return Response(force, lambda: state, stiffness, dofs=dofs)

    def _stiffness(
        self,
        pressure: float,
        unit: ndarray,
        cofactors: ndarray,
        slope: ndarray,
        weight: ndarray,
    ) -> csr_matrix:
        """Return the tangent, not symmetric: moving boundaries, and the column of the pressure."""
        # Normals turn: the load is p cof(F) N, and its slope follows F.
        K = np.einsum(
            "eqa,eqijJ,eqJb,eq->eaibj", self._N, slope, self._G, pressure * weight, optimize=True
        )
        # In axial symmetry the circumference grows, too.
        if self._axial:
            growth = np.einsum(
                "eqa,eqi,eqb,eq->eaib",
                self._N,
                cofactors,
                self._N,
                pressure * self._weight,
                optimize=True,
            )
            K += growth[..., None] * np.eye(self._dim)[0]
        # The last column is the derivative by the amplitude.
        n_local = self._local.shape[-1]
        rows = np.repeat(self._local, n_local, axis=1).ravel()
        columns = np.tile(self._local, (1, n_local)).ravel()
        n = len(unit)
        last = np.full(n - 1, n - 1)
        rows = np.concatenate((rows, np.arange(n - 1), [n - 1]))
        columns = np.concatenate((columns, last, [n - 1]))
        data = np.concatenate((K.ravel(), unit[:-1], [1.0]))
        return csr_matrix(coo_matrix((data, (rows, columns)), shape=(n, n)))

    @override
    def outputs(self, x: ndarray, state: Any) -> Outputs:
        return Outputs(summary=f"p = {x[self._dof]:.4g}")


def _cofactors(F: ndarray, normal: ndarray) -> tuple[ndarray, ndarray]:
    """Return ``cof(F) N``, (..., i), and its derivatives by F, (..., i, j, J)."""
    if F.shape[-1] == 2:
        slope = np.einsum("ij,IJ,...I->...ijJ", _PLANE, _PLANE, normal)
        return np.einsum("...ijJ,...jJ->...i", slope, F), slope
    along = np.einsum("IJK,...I,...kK->...kJ", _SPACE, normal, F)
    slope = np.einsum("ijk,...kJ->...ijJ", _SPACE, along)
    return 0.5 * np.einsum("...ijJ,...jJ->...i", slope, F), slope
