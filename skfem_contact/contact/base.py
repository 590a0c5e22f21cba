"""Data of a contact pair: surfaces, law, quadrature and settings, checked and connected once."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from copy import copy
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree
from skfem import CellBasis
from typing_extensions import Self, override

from ..checks import check_basis, is_number
from ..forms.base import Form
from ..forms.roles import Reducible, Regularised, Staged, Stiff, Touching, having
from ..layout import Field
from ..sparse import Gathering
from ..surfaces.smoothing import smoothed
from ..surfaces.surface import Surface
from .interface import ContactState, Interface
from .laws import InterfaceLaw, Status
from .multipliers import Nodes
from .penalty import AugmentedLagrangian, DualMultipliers, chosen
from .quadrature import SlavePoints

#: Initial fit of bodies; a number: they touch exactly, and interfere by that much.
NamedFit = Literal["as meshed", "adjusted", "ramped"]
Fit = NamedFit | float

#: Gaps of the mesh below this share of the slave segment are round-off: such bodies touch.
TOUCHING = 1e-8
#: Gaps below this share of it are those of one surface meshed twice.
_ADJUSTED = 0.5
#: Nodes of facets whose corners have negative areas: where a facet is closed in part, multipliers
#: there double the pressure at the edge of the contact, of a sphere on a block with 4 elements in
#: its half-width.
_NEGATIVE = 8
#: Cosine of the angle between facets, above which they face the same way.
_SAME_WAY = 0.5
#: Round-off of the axis, as a share of a facet.
_ON_AXIS = 1e-9


class ContactBase(Form, Touching, Staged, Reducible, Regularised):
    """Data of a contact pair, for regularisation, diagnosis and prestress."""

    unilateral = True
    # A regularised pair has other values here: present and final clearance, (2, n), share of the
    # tangential penalty, shift of the slip, (dim - 1, n), points with a broken bond, (n,), and the
    # families in force.
    clearance: ndarray | None = None
    _nodes: tuple[Any, Any] = (None, None)
    softness: float = 1.0
    slip_shift: ndarray | None = None
    debonded: ndarray | None = None
    families: tuple[Any, ...] = ()
    multipliers = np.zeros((0, 0), int)  # their dofs, (dim, n_nodes), which the model numbers

    def __init__(
        self,
        basis: CellBasis | None,
        slave: str | Surface,
        master: str | Surface,
        law: InterfaceLaw,
        quadrature: Literal["nodal", "segments"] | int = "segments",
        penalty: float | tuple[float, float] | None = None,
        smoothing: float | None = None,
        enforcement: AugmentedLagrangian | DualMultipliers | None = None,
        initial: Fit = "as meshed",
        share: float = 1.0,
        tangent: Literal["exact", "primary"] = "exact",
    ) -> None:
        if basis is not None or isinstance(slave, str) or isinstance(master, str):
            check_basis(basis)
        self.mesh_dofs = 0 if basis is None else int(basis.N)
        self.slave, self.facets = (
            side if isinstance(side, Surface) else Surface.from_boundary(basis, side)
            for side in (slave, master)
        )
        self.master = (
            self.facets if smoothing is None else smoothed(self.facets, smoothing)
        ).facing(self.slave)
        _check_surfaces(self.slave, self.master)
        _check_settings(self.slave, quadrature, enforcement, initial, share)
        _check_law(law, len(self.slave.nodes))
        self.law, self.quadrature, self.tangent = law, quadrature, tangent
        self.enforcement, self.initial, self.share = enforcement, initial, share
        self.dual = self.saddle = isinstance(enforcement, DualMultipliers)
        if self.dual:
            _check_dual(self.slave, law, quadrature, share)
            nodes = np.repeat(self.slave.nodes.T, self.slave.dim, axis=1)
            self.fields = (Field(f"contact traction of '{self.slave.name}'", nodes, "multiplier"),)
        self.penalty: tuple[float, float] | None = None
        self.stiffness: float | None = None
        self.complete = False
        self._connect()
        if penalty is not None:
            both = (
                penalty if isinstance(penalty, tuple) and len(penalty) == 2 else (penalty, penalty)
            )
            self.penalty = self.with_penalty(*both).penalty

    def _connect(self) -> None:
        adjusted = _adjusted(self.initial, self.law.bonds)
        self.interface = Interface(self.slave, self.master, self.quadrature, adjusted)
        size = max(
            self.mesh_dofs,
            self.slave.end,
            self.master.end,
            int(self.multipliers.max(initial=-1)) + 1,
        )
        self.size: int = size or None  # type: ignore[assignment]  # unknown before fields are numbered
        self.gathering = Gathering(size)

    def __repr__(self) -> str:
        return (
            f"<ContactPair {self.slave.name} on {self.master.name}, {len(self.slave.facets)} "
            f"facets, "
            f"quadrature {self.quadrature}, {self.law!r}>"
        )

    def _parameters(self) -> Mapping[str, Any]:
        """Return the settings by their names, for reports."""
        return {
            "slave": self.slave.name,
            "master": self.master.name,
            "law": self.law,
            "penalty": self.penalty,
            "quadrature": self.quadrature,
        }

    def with_(self, **changes: Any) -> Self:
        """Return a copy with other attributes."""
        new = copy(self)
        vars(new).update(changes)
        return new

    def with_penalty(
        self, normal: float, tangential: float, stiffness: float | None = None
    ) -> Self:
        """Return a copy with other penalties; `stiffness` is the traction per displacement of the
        surfaces, E/h.
        """
        for value in (normal, tangential):
            if not is_number(value, 0.0, np.inf):
                raise ValueError(f"penalties must be positive numbers, not {value!r}")
        return self.with_(penalty=(float(normal), float(tangential)), stiffness=stiffness)

    def with_law(self, law: InterfaceLaw) -> Self:
        """Return a copy with another interface law."""
        _check_law(law, len(self.slave.nodes))
        return self.with_(law=law)

    def with_surfaces(self, slave: Surface, facets: Surface, master: Surface) -> Self:
        """Return a copy between other surfaces of the same facets."""
        new = self.with_(slave=slave, facets=facets, master=master)
        new._connect()
        return new

    @property
    def borrowed(self) -> tuple[Any, ...]:  # type: ignore[override]
        """Fields of other forms whose dofs the surfaces have."""
        return tuple(dict.fromkeys((*self.slave.fields, *self.facets.fields)))

    def numbered(self, numbers: Mapping[Any, ndarray]) -> Self:
        """Return a copy whose surfaces have global dofs, numbers[field] : ndarray, shape (n,)."""
        new = self
        if self.fields:
            new = self.with_(multipliers=numbers[self.fields[0]].reshape(-1, self.slave.dim).T)
            new._connect()
        if not self.borrowed:
            return new
        return new.with_surfaces(
            *(part.numbered(numbers) for part in (self.slave, self.facets, self.master))
        )

    @override
    def completed(self, forms: Mapping[str, Form]) -> Self:
        if self.complete:
            return self
        stiff = [f for f in having(forms, Stiff).values() if f.elastic_stiffness is not None]
        axisymmetric = any(form.coordinates == "axisymmetric" for form in forms.values())
        new = self._about_axis(axisymmetric).with_(complete=True)
        if new.stiffness is not None:
            return new
        penalty, stiffness = chosen(
            new.slave,
            new.facets,
            [form.elastic_stiffness for form in stiff],
            new.penalty,
            new.enforcement is None,
        )
        if self.dual:
            new.fields = (replace(self.fields[0], scale=stiffness or penalty[0]),)
        return new.with_penalty(*penalty, stiffness=stiffness)

    @property
    def axisymmetric(self) -> bool:
        """True if forces are per radian about the axis x = 0, as those of the solids."""
        return self.slave.axisymmetric

    def _about_axis(self, axisymmetric: bool) -> Self:
        if axisymmetric == self.axisymmetric:
            return self
        slave = replace(self.slave, axisymmetric=axisymmetric)
        if axisymmetric and (slave.dim == 3 or slave.nodes[:, 0].min() < -_ON_AXIS * slave.spacing):
            raise ValueError(
                f"contact of '{slave.name}': axial symmetry is for plane meshes with x >= 0"
            )
        return self.with_surfaces(slave, self.facets, self.master)

    @property
    @override
    def outer_after(self) -> Literal["near", "exact"] | None:  # type: ignore[override]
        """Equilibrium after which multipliers are improved ("exact"), or cuts follow the bodies
        ("near").
        """
        if isinstance(self.enforcement, AugmentedLagrangian):
            return "exact"
        return "near" if self.quadrature == "segments" else None

    @property
    @override
    def has_friction(self) -> bool:  # type: ignore[override]
        """True if the law may have friction: its coefficient `mu` is not zero everywhere."""
        return bool(np.any(getattr(self.law, "mu", 1.0)))

    @property
    @override
    def joins(self) -> ndarray:  # type: ignore[override]
        """Dofs of the two surfaces; -1 among them for a rigid obstacle."""
        return np.union1d(self.slave.all_dofs, self.facets.all_dofs)

    @property
    @override
    def changing(self) -> ndarray:  # type: ignore[override]
        return (
            np.concatenate((self.acts_on, self.multipliers.ravel())) if self.dual else self.acts_on
        )

    @property
    @override
    def acts_on(self) -> ndarray:  # type: ignore[override]
        return self.joins[self.joins >= 0]

    @property
    @override
    def nodes(self) -> tuple[ndarray, ndarray] | None:  # type: ignore[override]
        """Dofs of the slave's nodes and their coordinates, if they are nodes of the mesh."""
        return (self.slave.dofs[:, 0], self.slave.nodes.T) if self.slave.meshed else None

    @property
    @override
    def symmetric(self) -> bool:  # type: ignore[override]
        """Symmetry of the tangent, which the law decides.

        Points that stick have no symmetric tangent once they transfer shear or have slipped
        elastically.
        """
        return self.law.symmetric

    @property
    @override
    def strengths(self) -> tuple[str, ...]:  # type: ignore[override]
        return () if type(self.law).reduced is InterfaceLaw.reduced else ("",)

    @override
    def reduced(self, factor: float, flow: str, names: Collection[str]) -> Self:
        return self.with_law(self.law.reduced(factor)) if names else self

    def points(self, state: ContactState) -> SlavePoints:
        """Return the slave's points of a state."""
        return self.interface.points(state.cuts)

    def nodes_at(self, state: ContactState) -> Nodes:
        """Return the slave's nodes at the points of a state."""
        points = self.points(state)
        if self._nodes[0] is not points:
            self._nodes = (points, Nodes.of(self.slave, points))
        return self._nodes[1]

    def penalties(self, state: ContactState) -> tuple[float, float]:
        """Return the normal and the tangential penalty in a state."""
        if self.penalty is None:
            raise ValueError(
                f"contact of '{self.slave.name}' on '{self.master.name}' has no penalty yet: give "
                "`penalty=`, or take the pair from Model(forms).forms"
            )
        if self.dual and self.stiffness is not None:  # on the way only
            return self.stiffness, self.stiffness
        normal, tangential = self.penalty * state.penalty_factor
        return float(normal), float(tangential)

    def penetration(self, state: ContactState) -> float:
        """Return the largest penetration as a share of the slave segment there."""
        closed, size = state.status != Status.OPEN, self.points(state).size
        return float(np.max((state.clearance - state.gap)[closed] / size[closed], initial=0.0))

    def effective(self, state: ContactState) -> ContactState:
        """Return an accepted state with this pair's internal variables, clearance, stick and broken
        bonds.

        Internal variables that the state lacks are zero, as before any update.
        """
        missing, changes = self.law.n_internal - len(state.internal), {}
        internal = state.internal
        if missing:
            internal = np.pad(internal, ((0, max(missing, 0)), (0, 0)))[: self.law.n_internal]
        if self.debonded is not None:
            internal = np.where(self.debonded, self.law.debonded(internal), internal)
        if internal is not state.internal:
            changes["internal"] = internal
        if self.clearance is not None:
            changes["clearance"] = self.clearance[0]
        if self.softness < 1.0:
            changes["penalty_factor"] = state.penalty_factor * [1.0, self.softness]
        return replace(state, **changes) if changes else state


def _check_surfaces(slave: Surface, master: Surface) -> None:
    """Check that surfaces can touch: no common nodes, not both rigid, facing each other."""
    if slave.rigid and master.rigid:
        raise ValueError(
            f"both '{slave.name}' and '{master.name}' are rigid: at least one surface needs dofs"
        )
    known = slave.dofs[slave.dofs >= 0]
    if not (slave.fields or master.fields) and np.isin(known, master.dofs).any():
        raise ValueError(
            f"slave '{slave.name}' and master '{master.name}' share nodes: a body cannot touch "
            "itself there; separate the bodies with join_bodies"
        )
    # a run refuses what is not finite
    here, there = (np.nan_to_num(surface.centres.x[0]) for surface in (slave, master))
    opposite = cKDTree(there).query(here)[1]
    if (
        np.einsum("nc,nc->n", slave.centres.normal, master.centres.normal[opposite]) > _SAME_WAY
    ).all():
        raise ValueError(
            f"slave '{slave.name}' and master '{master.name}' face the same way, and cannot touch: "
            f"take "
            "the boundary on the other side of the body; a rigid line is free to the left of its "
            "way"
        )


def _check_settings(
    slave: Surface, quadrature: Any, enforcement: Any, initial: Any, share: Any
) -> None:
    for name, value, what in (
        ("quadrature", quadrature, "number of points"),
        ("initial", initial, "interference"),
    ):
        if not isinstance(value, str) and value <= 0:
            raise ValueError(
                f"{name} must be one of its names, or a positive {what}, not {value!r}"
            )
    if not (share == 1.0 or is_number(share, 0.0, 1.0)):
        raise ValueError(f"share must lie in (0, 1], not {share!r}")
    if enforcement is not None and slave.facets.shape[1] == _NEGATIVE:
        raise ValueError(
            f"multipliers are not for facets of eight nodes, as '{slave.name}' has them: the "
            f"corners have "
            "negative areas; take ElementHex2 or ElementHex1, or the penalty method"
        )


def _check_dual(slave: Surface, law: InterfaceLaw, quadrature: Any, share: float) -> None:
    """Refuse what has more multipliers than motions, or directions of slip that differ at a
    node.
    """
    if slave.rigid:
        raise ValueError(
            f"DualMultipliers are dofs of a slave that deforms: '{slave.name}' is rigid, make it "
            f"the "
            "master"
        )
    if share != 1.0:
        raise ValueError(
            "DualMultipliers hold both surfaces in one pass: share must be 1, and no second pair"
        )
    if not isinstance(quadrature, str) and quadrature <= slave.shape.exponents.max():
        raise ValueError(
            f'DualMultipliers need quadrature="segments", or at least '
            f"{slave.shape.exponents.max() + 1} "
            f"points along a facet, not {quadrature}"
        )
    if slave.dim == 3 and not law.symmetric and (slave.directions != slave.directions[0]).any():
        raise ValueError(
            f"DualMultipliers with friction: the facets of '{slave.name}' have no axis that lies "
            f"along all"
            " of them, from which slip is counted; split the boundary, or take "
            "AugmentedLagrangian()"
        )


def _check_law(law: Any, n_nodes: int) -> None:
    """Check that a law has an update, and one parameter for each node of the slave where they are
    arrays.
    """
    if not isinstance(law, InterfaceLaw) or type(law).update is InterfaceLaw.update:
        raise ValueError(
            f"law must be an InterfaceLaw with an `update`, like Coulomb(mu=.3), unlike {law!r}"
        )
    for name, value in vars(law).items():
        if isinstance(value, np.ndarray) and value.shape != (n_nodes,):
            raise ValueError(
                f"{type(law).__name__}: {name} has shape {value.shape}; the slave has {n_nodes} "
                f"nodes"
            )


def initial_clearance(
    gap: ndarray, meshed: ndarray, size: ndarray, fit: Fit, bonded: bool
) -> ndarray:
    """Return the initial clearance of points, shape (n,), on slave segments of some size.

    Gaps are given where the bodies become active, and in the mesh: bodies are built to fit into
    displaced surfaces, so that their gaps remain those of the mesh.
    """
    with np.errstate(invalid="ignore"):  # inf - inf where nothing is near
        # a change of more than this is no displacement: other surfaces have come to face each other
        moved = np.where(np.abs(gap - meshed) <= 0.5 * size, gap - meshed, 0.0)
    ramped = fit == "ramped" or not isinstance(fit, str)
    if ramped:
        moved = np.zeros_like(gap)
    clearance = np.where(np.abs(gap - moved) <= _adjusted(fit, bonded) * size, gap, moved)
    return np.minimum(gap, clearance) if ramped else clearance


def _adjusted(fit: Fit, bonded: bool) -> float:
    """Return the share of a facet's size up to which gaps of the mesh are those of one surface
    meshed twice.
    """
    return _ADJUSTED if bonded or fit == "adjusted" or not isinstance(fit, str) else TOUCHING
