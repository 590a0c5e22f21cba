"""A face of consolidating ground through which water leaves, but none enters."""
from __future__ import annotations

from collections.abc import Collection
from copy import copy
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..forms import Form, Response
from .conditions import Given
from .pore_water import PoreWater

#: Conductance of the face over that of the ground beside it: pressures exceed zero by a hundredth of the drop in an
#: element. By 1e4, and steps of 1e4 h² / c_v, SuperLU has been seen to pass LAPACK illegal sizes.
_OPEN = 1e2


class SeepageFace(Form):
    r"""Boundary where water leaves the ground if its pressure would be positive, and none enters: as rain would.

    The condition of contact, with the pressure for the gap: at the nodes flows
    :math:`c \langle p_0 + p \rangle`, with the pressure :math:`p_0` at the beginning and the excess p of
    :class:`PoreWater`. Where unknowns are held, those under a level for instance, it says nothing.

    Parameters
    ----------
    water
        The ground's water.
    boundaries
        Names of boundaries.
    pressure
        Pore pressure there at the beginning, a number or a function of places (dim, n): :func:`hydrostatic`.

    Raises
    ------
    ValueError
        As :meth:`PoreWater.unknowns`; pressures that are not finite.

    Examples
    --------
    Water leaves a layer under load, and none comes back when the load goes: the ground stays where it is.

    >>> import numpy as np
    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> mesh = MeshTri.init_tensor(np.array([0., .1]), np.linspace(0, 1, 6)).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    >>> pores = sc.PoreWater(basis, k=1e-4, unit_weight=10.)
    >>> forms = {"clay": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.)), "water": pores,
    ...          "face": sc.SeepageFace(pores, "top", 0.)}
    >>> load = sc.traction(basis, "top", (0., -100.))
    >>> stages = [sc.Stage("load", load, duration=100.), sc.Stage("unload", 0 * load, duration=100.)]
    >>> result = sc.run(forms, stages, sc.rollers(basis, base="rollers"))
    >>> top = basis.get_dofs("top").all("u^2")
    >>> [round(float(stage.x[top].mean()), 4) for stage in result]
    [-0.01, -0.01]
    """

    symmetric, second_order, unilateral = True, True, True

    def __init__(self, water: PoreWater, boundaries: str | Collection[str], pressure: Given = 0.0) -> None:
        names = (boundaries,) if isinstance(boundaries, str) else tuple(boundaries)
        self.joins = self._at = water.unknowns(*names) if names else np.zeros(0, int)
        self._limit = -water.prescribed(dict.fromkeys(names, pressure))[self._at]
        self._conductance = _OPEN * water.porous.conductance[self._at - water.first]
        self._duration = 0.0

    def __repr__(self) -> str:
        return f"<SeepageFace {len(self._at)} nodes>"

    def over(self, duration: float) -> SeepageFace:
        """The form of a step in time."""
        new = copy(self)
        new._duration = duration
        return new

    def initial_state(self, x: ndarray | None = None) -> None:
        """It remembers nothing."""

    def assemble(self, x: ndarray, state: Any) -> Response:
        """Water that leaves in the step."""
        above, n = x[self._at] - self._limit, len(x)
        force, slope = np.zeros(n), np.where(above > 0.0, -self._duration * self._conductance, 0.0)
        force[self._at] = slope * above
        K = csr_matrix((slope, (self._at, self._at)), shape=(n, n))
        return Response(force, lambda: None, lambda: K, active=(above > 0.0).tobytes())
