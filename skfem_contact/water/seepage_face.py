"""Seepage faces of consolidating ground: boundaries that water leaves and does not enter."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from copy import copy
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from typing_extensions import Self, override

from ..checks import names_of
from ..forms.base import Response
from ..forms.roles import Draining, Regularised
from ..layout import Field
from .at_nodes import AtNodes
from .boundary import Given
from .pore_water import PoreWater

#: Conductance of the face over the conductance of the ground at it: pressures exceed zero by a
#: hundredth of the drop in an element. By 1e4, and steps of 1e4 h² / c_v, SuperLU has been seen to
#: pass LAPACK illegal sizes.
_OPEN = 1e2


class SeepageFace(AtNodes, Regularised, Draining):
    r"""Boundary that water leaves if its pressure would be positive, and does not enter.

    The condition is that of contact, with the pressure for the gap: the outflow at the nodes is
    :math:`c \langle p_0 + p \rangle`, with the pressure :math:`p_0` at the beginning and the excess
    p of :class:`PoreWater`. Fixed dofs, such as dofs under a level, are not affected.

    Parameters
    ----------
    water
        Water of the ground.
    boundaries
        Names of boundaries.
    pressure
        Pore pressure there at the beginning, a number or a function of coordinates (dim, n):
        :func:`hydrostatic`.

    Examples
    --------
    Water leaves a layer under load, and none returns after the load: the ground keeps its
    settlement.

    >>> import numpy as np
    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> mesh = MeshTri.init_tensor(np.array([0., .1]), np.linspace(0, 1, 6)).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    >>> pores = sc.PoreWater(basis, permeability=1e-4, unit_weight=10.)
    >>> forms = {"clay": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.)), "water": pores,
    ...          "face": sc.water.SeepageFace(pores, "top", 0.)}
    >>> load = sc.traction(basis, "top", (0., -100.))
    >>> stages = [sc.Stage("load", load, duration=100.),
    ...           sc.Stage("unload", 0 * load, duration=100.)]
    >>> result = sc.Model(forms, sc.box_supports(basis, base="rollers")).run(stages)
    >>> top = basis.get_dofs("top").all("u^2")
    >>> [round(float(stage.x[top].mean()), 4) for stage in result]
    [-0.01, -0.01]
    """

    unilateral = True
    leaks: ndarray
    _conductance: ndarray

    def __init__(
        self,
        water: PoreWater,
        boundaries: str | Collection[str],
        pressure: Given = 0.0,
    ) -> None:
        names = names_of(boundaries)
        self.water = water
        self.size = water.ground.N
        self.borrowed = water.fields
        if names:
            self.leaks = water.dofs(*names).indices
        else:
            self.leaks = np.zeros(0, int)
        # The excess pressure is -p_0 where the pressure is zero.
        self._limit = -water.at_boundaries(dict.fromkeys(names, pressure))[self.leaks]

    def __repr__(self) -> str:
        return f"<SeepageFace {len(self.leaks)} nodes>"

    @override
    def _in(self, water: PoreWater) -> Self:
        new = copy(self)
        new.water = water
        new._conductance = _OPEN * water.porous.conductance[self.leaks]
        return new

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> SeepageFace:
        new = copy(self)
        new._dofs = numbers[self.borrowed[0]][self.leaks]
        new.joins = new._dofs
        new.size = None
        return new

    @override
    def assemble(self, x: ndarray, state: Any) -> Response:
        n = len(x)
        above = x[self._dofs] - self._limit
        leaking = above > 0.0
        slope = np.where(leaking, -self._duration * self._conductance, 0.0)
        force = np.zeros(n)
        force[self._dofs] = slope * above
        stiffness = csr_matrix((slope, (self._dofs, self._dofs)), shape=(n, n))
        return Response(force, lambda: None, lambda: stiffness, active=leaking.tobytes())
