"""Where water leaves the ground: faces that none enters, and whether a mesh and a stage can show what leaves."""
from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from copy import copy
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from typing_extensions import override

from ..errors import Remark, names_of
from ..forms.base import Form, Response
from ..layout import Field
from .conditions import Given

if TYPE_CHECKING:
    from .pore_water import PoreWater

#: Conductance of the face over that of the ground beside it: pressures exceed zero by a hundredth of the drop in an
#: element. By 1e4, and steps of 1e4 h² / c_v, SuperLU has been seen to pass LAPACK illegal sizes.
_OPEN = 1e2
#: A pressure of one everywhere that strains nothing beyond this share of what it does without supports is undetermined.
_RIGID = 1e-12
#: Degrees of consolidation, T = c_v t / H², that no stage of an analysis has in any sensible units.
_LEAST, _MOST = 1e-10, 1e8
#: From here on round-off of the pressures moves as much water as the ground holds.
_LOST = 1e12


class SeepageFace(Form):
    r"""Boundary where water leaves the ground if its pressure would be positive, and none enters: as rain would.

    The condition of contact, with the pressure for the gap: at the nodes flows
    :math:`c \langle p_0 + p \rangle`, with the pressure :math:`p_0` at the beginning and the excess p of
    :class:`PoreWater`. Where dofs are held, those under a level for instance, it has no effect.

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
        As :meth:`PoreWater.dofs`; pressures that are not finite.

    Examples
    --------
    Water leaves a layer under load, and none comes back when the load goes: the ground stays where it is.

    >>> import numpy as np
    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> mesh = MeshTri.init_tensor(np.array([0., .1]), np.linspace(0, 1, 6)).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    >>> pores = sc.PoreWater(basis, permeability=1e-4, unit_weight=10.)
    >>> forms = {"clay": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.)), "water": pores,
    ...          "face": sc.water.SeepageFace(pores, "top", 0.)}
    >>> load = sc.traction(basis, "top", (0., -100.))
    >>> stages = [sc.Stage("load", load, duration=100.), sc.Stage("unload", 0 * load, duration=100.)]
    >>> result = sc.Model(forms, sc.box_supports(basis, base="rollers")).run(stages)
    >>> top = basis.get_dofs("top").all("u^2")
    >>> [round(float(stage.x[top].mean()), 4) for stage in result]
    [-0.01, -0.01]
    """

    symmetric, second_order, unilateral = True, True, True
    _at: ndarray

    def __init__(self, water: PoreWater, boundaries: str | Collection[str], pressure: Given = 0.0) -> None:
        self._water, names = water, names_of(boundaries)
        self.size, self.borrowed = water.porous.basis.N, water.fields
        self._vertices = water.dofs(*names).indices if names else np.zeros(0, int)
        self._limit = -water.at_boundaries(dict.fromkeys(names, pressure))[self._vertices]
        self._conductance, self._duration = np.zeros(0), 0.0

    def __repr__(self) -> str:
        return f"<SeepageFace {len(self._vertices)} nodes>"

    @override
    def completed(self, forms: Mapping[str, Form]) -> SeepageFace:
        return self._in(self._water.completed(forms))

    @override
    def continues(self, old: Form) -> SeepageFace:
        super().continues(old)
        return self._in(old._water)  # type: ignore[attr-defined]

    def _in(self, water: PoreWater) -> SeepageFace:
        """Return the face with the conductance of its ground."""
        new = copy(self)
        new._water, new._conductance = water, _OPEN * water.porous.conductance[self._vertices]
        return new

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> SeepageFace:
        new = copy(self)
        new.joins = new._at = numbers[self.borrowed[0]][self._vertices]
        new.size = None
        return new

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


def drainage_remarks(water: PoreWater, fixed: ndarray, held: ndarray, duration: float) -> Iterator[Remark]:
    """Remarks on a stage in which unknowns are fixed, others held for there is nothing; refuses what has no answer.

    The duration is from when loads, supports or anything else began to change to the end; zero without any.
    """
    if not duration > 0.0:
        raise ValueError("PoreWater needs time: give Stage(duration=...), a short one for what happens at once, or "
                         "activate the water in a later stage")
    basis = water.porous.basis
    if np.isin(basis.element_dofs, held).any():
        raise ValueError(f"PoreWater is active in ground that is not there: {water!r}")
    drained = np.intersect1d(fixed, water.carries)
    _check_determined(water, fixed, drained)
    around = water.around
    assert around is not None
    diffusivity = around.modulus * np.linalg.eigvalsh(water.mobility)[:, -1]
    used = basis.mesh.p[:, np.unique(basis.mesh.t[:, water.elements])]
    length = float(np.ptp(used, axis=1).max())
    time = float(diffusivity.max()) * duration / length**2, float(diffusivity.min()) * duration / length**2
    if time[0] < _LEAST or time[1] > _MOST:
        worst = time[0] if time[0] < _LEAST else time[1]
        text = (f"the stage ends after {worst:.1e} times H² / c_v, with c_v from {diffusivity.min():.3g} to "
                f"{diffusivity.max():.3g}: are permeability, stiffness and duration in the same units?")
        if worst > _LOST:
            raise ValueError(text)
        yield Remark("units", abs(np.log10(worst)), text)
    for name, joined in around.touching.items():
        if len(pressed := _under_pressure(water, joined, drained)):
            yield Remark("friction", len(pressed),
                         f"'{name}' carries the pressure of the water as well, at {len(pressed)} nodes that are not "
                         "drained: friction there counts the total stress, not the effective one")
    if not (fixed >= water.first).any():
        if not around.leaks:
            yield Remark("sealed", 0.0, "no pore pressure is held: no water can leave the ground")
        return
    shortest = _resolved(water, drained, diffusivity)
    if duration < shortest:
        yield Remark("short", shortest / duration, f"it ends after {duration:.3g}, less than h² / 6 c_v = "
                     f"{shortest:.3g} of the elements at drained boundaries: pressures may be too high beside these")


def _under_pressure(water: PoreWater, joined: ndarray, drained: ndarray) -> ndarray:
    """Nodes with a pressure that is not held, among some unknowns of displacements."""
    basis = water.porous.basis
    vertices = water.carries - water.first
    touched = vertices[np.isin(basis.nodal_dofs[0, vertices], joined)]
    return np.setdiff1d(touched, np.append(drained - water.first, water.porous.open))


def _check_determined(water: PoreWater, fixed: ndarray, drained: ndarray) -> None:
    """Refuse pressures that could all be higher by the same amount."""
    basis = water.porous.basis
    if len(drained) or water.storage.any():
        return
    thrust = np.abs(np.bincount(basis.element_dofs.T.ravel(), water.porous.coupling.sum(axis=2).ravel(),
                                minlength=basis.N))
    whole, by_element = thrust.max(), np.abs(water.porous.coupling).max()
    thrust[fixed[fixed < basis.N]] = 0.0
    if thrust.max() <= _RIGID * max(whole, by_element):
        raise ValueError("the pore pressure is not determined: nothing is drained, the water cannot be compressed, and "
                         "the ground can neither grow nor shrink; hold a pressure, `fixed` with water.dofs(...), "
                         "or give a storage")


def _resolved(water: PoreWater, drained: ndarray, diffusivity: ndarray) -> float:
    """Longest time h² / 6 c_v of the elements with a drained facet, h across it (P. A. Vermeer, A. Verruijt 1981)."""
    basis, mesh = water.porous.basis, water.porous.basis.mesh
    corners = np.isin(np.arange(mesh.p.shape[1]), drained - water.first)
    sides = mesh.t2f[:, water.elements]
    side, element = np.nonzero(corners[mesh.facets].all(axis=0)[sides])
    if len(element) == 0:
        return 0.0
    corner = mesh.p[:, mesh.facets[:, sides[side, element]]]
    area = np.linalg.norm(corner[:, 1] - corner[:, 0] if mesh.dim() == 2 else
                          0.5 * np.cross(corner[:, 2] - corner[:, 0], corner[:, -1] - corner[:, 1], axis=0), axis=0)
    simplex = len(mesh.t) == mesh.dim() + 1
    across = (mesh.dim() if simplex else 1) * basis.dx.sum(axis=1)[element] / area
    return float((across**2 / 6.0 / diffusivity[element]).max())
