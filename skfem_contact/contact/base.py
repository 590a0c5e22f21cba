"""Data of a contact pair: surfaces, law, quadrature and settings, checked and connected once."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from copy import copy
from dataclasses import replace
from typing import Any, Literal

import numpy as np
import scipy
from numpy import ndarray
from scipy.sparse import csr_matrix
from skfem import CellBasis
from typing_extensions import Self, override

from ..checks import check_basis, format_point, is_number
from ..forms.base import Form, Forms
from ..forms.roles import Dissipating, Reducible, Regularised, Staged, Stiff, Touching, having
from ..sparse import Gathering
from ..surfaces.smoothing import smoothed
from ..surfaces.surface import Surface
from ..surfaces.vectors import dot
from .augmented import AugmentedLagrangian
from .dual import DualMultipliers
from .enforcement import Enforcement
from .fold import Fold
from .interface import TOUCHING, ContactState, Interface
from .laws import InterfaceLaw, Status
from .multipliers import Nodes
from .penalty import Penalty, chosen
from .quadrature import SlavePoints
from .stretch import Stretch
from .symmetry import mirrored

#: Initial fit of bodies; a number: they touch exactly, and interfere by that much.
NamedFit = Literal["as meshed", "adjusted", "ramped"]
Fit = NamedFit | float

#: Gaps below this share of the slave segment are those of one surface meshed twice.
_ADJUSTED = 0.5
#: Gauss points on each facet, in the plane and in space, of a surface that touches itself.
_POINTS = {2: 5, 3: 3}
#: Cosine of the angle between facets, above which they face the same way.
_SAME_WAY = 0.5
#: Round-off of the axis, as a share of a facet.
_ON_AXIS = 1e-9
#: Largest tractions in the damped tangent's geometric part, over those at which the surfaces yield
#: by a segment.
_LARGEST_TRACTION = 0.1


class ContactBase(Form, Touching, Staged, Reducible, Regularised, Dissipating):
    """Data of a contact pair, for regularisation, diagnosis and prestress."""

    unilateral = True
    # A regularised pair has other values here: present and final clearance, (2, n), share of the
    # tangential penalty, shift of the slip, (dim - 1, n), points with a broken bond, (n,), and the
    # families in force.
    clearance: ndarray | None = None
    _nodes: tuple[Any, Any] = (None, None)
    # The penalty that was given, and True until supports show planes of symmetry.
    given_penalty: tuple[float, float] | None = None
    awaits_supports: bool = False
    softness: float = 1.0
    slip_shift: ndarray | None = None
    debonded: ndarray | None = None
    families: tuple[Any, ...] = ()
    # Bodies of finite kinematics: strengths count the present area, and points choose facets
    # between increments; those that do so now.
    finite: bool = False
    choosing: ndarray | None = None
    symmetry: Any = None  # nodes that supports hold along the joint, which a model x
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
        enforcement: Penalty | AugmentedLagrangian | DualMultipliers | None = None,
        initial: Fit = "as meshed",
        share: float = 1.0,
        tangent: Literal["exact", "primary"] = "exact",
    ) -> None:
        # Find the surfaces, and smooth the master.
        self.mesh_dofs = 0 if basis is None else int(basis.N)
        self.slave = _surface(basis, slave)
        self.folds = master is slave or (isinstance(master, str) and master == slave)
        if self.folds:
            self.facets = self.slave
        else:
            self.facets = _surface(basis, master)
        curves = self.facets
        if smoothing is not None:
            curves = smoothed(self.facets, smoothing)
        self.master = curves.facing(self.slave)
        # Check how they are to be joined.
        self.law = law
        self.quadrature = quadrature
        self.tangent = tangent
        self.enforcement: Enforcement = Penalty() if enforcement is None else enforcement
        self.initial = initial
        self.share = share
        _check_settings(quadrature, initial, share)
        _check_law(law, len(self.slave.nodes))
        if self.folds:
            self._touch_itself()
        else:
            _check_surfaces(self.slave, self.master)
        self.enforcement.check(self.slave, law, self.quadrature, self.share)

        # Multipliers are fields of the pair.
        self.saddle = self.enforcement.saddle
        self.fields = self.enforcement.fields(self.slave)
        self.penalty: tuple[float, float] | None = None
        self.stiffness: float | None = None
        self.complete = False
        self._connect()
        if penalty is not None:
            if isinstance(penalty, tuple) and len(penalty) == 2:
                both = penalty
            else:
                both = (penalty, penalty)
            self.penalty = self.with_penalty(*both).penalty

    def _touch_itself(self) -> None:
        """Let each wall, which is slave and master, have half of the work at points that stay."""
        _check_fold(self.slave)
        if self.enforcement.saddle:
            raise ValueError(
                f"'{self.slave.name}' against itself takes the penalty method or "
                "AugmentedLagrangian, not DualMultipliers: each wall is slave and master"
            )
        self.share = 0.5 * self.share
        if self.quadrature == "segments":
            self.quadrature = _POINTS[self.slave.dim]

    def _connect(self) -> None:
        adjusted = _adjusted(self.initial, self.law.bonds)
        rounds = (
            not self.folds
            and self.initial in ("as meshed", "ramped")
            and not self.law.bonds
            and self.master.facets is self.facets.facets
        )
        self.interface = Interface(
            self.slave,
            self.master,
            rule=self.quadrature,
            adjusted=adjusted,
            rounds=rounds,
            fold=Fold.of(self.slave, self.master) if self.folds else None,
        )
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
            f"facets, quadrature {self.quadrature}, {self.law!r}>"
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
        self,
        normal: float,
        tangential: float,
        stiffness: float | None = None,
    ) -> Self:
        """Return a copy with other penalties, and the surfaces' traction per displacement, E/h."""
        for value in (normal, tangential):
            if not is_number(value, 0.0, np.inf):
                raise ValueError(f"penalties must be positive numbers, not {value!r}")
        penalty = (float(normal), float(tangential))
        return self.with_(penalty=penalty, stiffness=stiffness, awaits_supports=False)

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
    def completed(self, forms: Forms) -> Self:
        if self.complete:
            return self
        # Ask the other forms for symmetry and kinematics.
        axisymmetric = any(form.coordinates == "axisymmetric" for form in forms.values())
        finite = any(form.kinematics == "finite" for form in forms.values())
        if finite and self.law.per_area and self.saddle:
            raise ValueError(
                "adhesion and tension count the present area of bodies of finite kinematics: take "
                "the penalty method or AugmentedLagrangian, not DualMultipliers"
            )
        new = self._about_axis(axisymmetric).with_(complete=True, finite=finite)
        if new.stiffness is not None:
            return new
        # Choose a penalty that suits the stiffness of the bodies.
        penalty, stiffness = chosen(
            new.slave,
            new.facets,
            bodies=_stiffnesses(forms),
            penalty=new.penalty,
            warns=new.enforcement.keeps_penalty,
        )
        new.given_penalty = new.penalty
        new.fields = tuple(replace(field, scale=stiffness or penalty[0]) for field in new.fields)
        new = new.with_penalty(*penalty, stiffness=stiffness)
        new.awaits_supports = stiffness is not None
        return new

    @override
    def mirrored(self, forms: Forms, fixed: ndarray) -> Self:
        if not self.awaits_supports:
            return self
        sides = [side for side in (self.slave, self.facets) if side.meshed]
        if not any(any(mirrored(side, fixed, self.axisymmetric)) for side in sides):
            return self.with_(awaits_supports=False)
        penalty, stiffness = chosen(
            self.slave,
            self.facets,
            bodies=_stiffnesses(forms),
            penalty=self.given_penalty,
            warns=False,
            fixed=fixed,
        )
        return self.with_penalty(*penalty, stiffness=stiffness)

    @property
    def axisymmetric(self) -> bool:
        """True if forces are per radian about the axis x = 0, as in the solids."""
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
        """Equilibrium after which multipliers improve ("exact"), or cuts follow bodies ("near")."""
        if self.enforcement.outer_after is not None:
            return self.enforcement.outer_after
        follows = self.quadrature == "segments" or self.interface.smooth
        if follows:
            return "near"
        return None

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
    def behind(self) -> ndarray:
        """Elements of the mesh behind the facets of both surfaces."""
        return np.concatenate((self.slave.elements, self.facets.elements))

    @property
    @override
    def changing(self) -> ndarray:  # type: ignore[override]
        return np.concatenate((self.acts_on, self.multipliers.ravel()))

    @property
    @override
    def acts_on(self) -> ndarray:  # type: ignore[override]
        return self.joins[self.joins >= 0]

    @property
    @override
    def nodes(self) -> tuple[ndarray, ndarray] | None:  # type: ignore[override]
        """Dofs of the slave's nodes and their coordinates, if they are nodes of the mesh."""
        if self.slave.meshed:
            return (self.slave.dofs[:, 0], self.slave.nodes.T)
        return None

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
        if type(self.law).reduced is InterfaceLaw.reduced:
            return ()
        return ("",)

    @override
    def reduced(self, factor: float, flow: str, names: Collection[str]) -> Self:
        if names:
            return self.with_law(self.law.reduced(factor))
        return self

    def points(self, state: ContactState) -> SlavePoints:
        """Return the slave's points of a state."""
        return self.interface.points(state.cuts)

    def nodes_at(self, state: ContactState) -> Nodes:
        """Return the slave's nodes at the points of a state."""
        points = self.points(state)
        known, nodes = self._nodes
        if known is not points:
            nodes = Nodes.of(self.slave, points)
            self._nodes = (points, nodes)
        return nodes

    def depth(self, points: SlavePoints) -> ndarray:
        """Return the largest penetration of points that may have traction, shape (n,)."""
        if self.law.reaches_far:
            return np.full(len(points.weight), np.inf)
        return self.interface.depth(points)

    def stretch(self, nodes: ndarray, points: SlavePoints) -> Stretch:
        """Return the stretch of the slave's area at points; coordinates count from its middle."""
        return Stretch.of(self.slave, nodes + self.slave.middle, points.facet, points.xi)

    @property
    def holds_points(self) -> bool:
        """True where bodies slide far over facets, at points that do not move on the slave."""
        return self.finite and self.quadrature != "segments"

    def held(self, state: ContactState) -> ndarray | None:
        """Return a mask of the points that stay on their facets in an increment; None for none.

        Where bodies slide and strain much, points at kinks of the master would go back and forth.
        """
        if not self.holds_points:
            return None
        held = self.interface.within_facets(state)
        if self.choosing is None:
            return held
        return held & ~self.choosing

    def choosing_facets(self, accepted: ContactState) -> Self:
        """Return the pair whose points choose facets anew where the last increment has left them.

        It is this pair where no others choose.
        """
        if self.held(accepted) is None:
            return self
        choosing = self.interface.off_facets(accepted)
        if not choosing.any():
            if self.choosing is None:
                return self
            return self.with_(choosing=None)
        same = self.choosing is not None and np.array_equal(self.choosing, choosing)
        if same:
            return self
        return self.with_(choosing=choosing)

    @property
    def largest_traction(self) -> float:
        """Largest traction in the damped tangent's geometric part."""
        if self.stiffness is None:
            return np.inf
        return _LARGEST_TRACTION * self.stiffness * self.slave.spacing

    def penalties(self, state: ContactState) -> tuple[float, float]:
        """Return the normal and the tangential penalty in a state."""
        if self.penalty is None:
            raise ValueError(
                f"contact of '{self.slave.name}' on '{self.master.name}' has no penalty yet: give "
                "`penalty=`, or take the pair from Model(forms).forms"
            )
        return self.enforcement.penalties(self, state)

    @override
    def dissipated(self, before: ContactState, after: ContactState, work: float) -> float:
        return work - (self._stored(after) - self._stored(before))

    def _stored(self, state: ContactState) -> float:
        """Return the energy that penalties store: half of the tractions times their jumps."""
        if not self.enforcement.keeps_penalty or not state.traction.any():
            return 0.0
        normal, tangential = self.penalties(state)
        pressure, *shear = state.traction**2
        twice = pressure / normal + sum(shear) / tangential
        return 0.5 * self.share * float(self.points(state).weight @ twice)

    def penetration(self, state: ContactState) -> float:
        """Return the largest penetration as a share of its slave segment."""
        closed = state.status != Status.OPEN
        depth = (state.clearance - state.gap)[closed]
        return float(np.max(depth / self.points(state).size[closed], initial=0.0))

    def effective(self, state: ContactState) -> ContactState:
        """Return an accepted state as this pair sees it: law, clearance, stick and broken bonds.

        Internal variables that the state lacks are zero, as before any update.
        """
        changes: dict[str, Any] = {}
        internal = state.internal
        # Another law may have more or fewer variables.
        missing = self.law.n_internal - len(internal)
        if missing:
            padded = np.pad(internal, ((0, max(missing, 0)), (0, 0)))
            internal = padded[: self.law.n_internal]
        # Broken bonds, clearance and softness of the pair count before the state's own.
        if self.debonded is not None:
            internal = np.where(self.debonded, self.law.debonded(internal), internal)
        if internal is not state.internal:
            changes["internal"] = internal
        if self.clearance is not None:
            changes["clearance"] = self.clearance[0]
        if self.softness < 1.0:
            changes["penalty_factor"] = state.penalty_factor * [1.0, self.softness]
        if changes:
            return replace(state, **changes)
        return state


def _surface(basis: CellBasis | None, side: str | Surface) -> Surface:
    """Return a side of a pair: a surface, or a boundary of the mesh."""
    if isinstance(side, Surface):
        if basis is not None:
            check_basis(basis)
        return side
    return Surface.from_boundary(basis, side)


def _stiffnesses(forms: Forms) -> list[csr_matrix]:
    """Return the elastic stiffness of all forms that have one, (N, N) each."""
    known = [form.elastic_stiffness for form in having(forms, Stiff).values()]
    return [stiffness for stiffness in known if stiffness is not None]


def _check_surfaces(slave: Surface, master: Surface) -> None:
    """Check that surfaces can touch: no common nodes, not both rigid, facing each other."""
    if slave.rigid and master.rigid:
        raise ValueError(
            f"both '{slave.name}' and '{master.name}' are rigid: at least one surface needs dofs"
        )
    if not (slave.fields or master.fields):
        _check_apart(slave, master)
    # Compare each facet of the slave with the nearest one; a run refuses what is not finite
    slave_centres = np.nan_to_num(slave.centres.x[0])
    master_centres = np.nan_to_num(master.centres.x[0])
    opposite = scipy.spatial.cKDTree(master_centres).query(slave_centres)[1]
    cosine = dot(slave.centres.normal, master.centres.normal[opposite])
    if (cosine > _SAME_WAY).all():
        raise ValueError(
            f"slave '{slave.name}' and master '{master.name}' face the same way, and cannot touch: "
            "take the boundary on the other side of the body; a rigid line is free to the left of "
            "its way"
        )


def _check_apart(slave: Surface, master: Surface) -> None:
    """Refuse numbered surfaces with common nodes, of common facets or where they meet."""
    common = np.isin(slave.dofs[:, 0], master.dofs[master.dofs >= 0])
    if not common.any():
        return
    advice = "leave the facets there out of one of them, as at the inner tips of a slit"
    if common[slave.facets].all(axis=1).any():
        advice = "give the whole boundary of a body that folds as both"
    raise ValueError(
        f"slave '{slave.name}' and master '{master.name}' share {common.sum()} nodes, as at "
        f"{format_point(slave.nodes[common][0])}: a body cannot touch itself there; {advice}"
    )


def _check_fold(surface: Surface) -> None:
    """Refuse a surface that faces one way, given as slave and master by mistake."""
    normal = surface.centres.normal
    mean = surface.area @ normal
    same_way = normal @ mean > _SAME_WAY * np.linalg.norm(mean)  # none on closed surfaces
    if len(normal) > 1 and same_way.all():
        raise ValueError(
            f"all facets of '{surface.name}' face the same way: it cannot touch itself; take "
            "another master, or a boundary with both sides of the fold"
        )


def _check_settings(quadrature: Any, initial: Any, share: Any) -> None:
    """Check numbers that may be given in place of names, and the share of the work."""
    for name, value, meaning in (
        ("quadrature", quadrature, "number of points"),
        ("initial", initial, "interference"),
    ):
        if not isinstance(value, str) and value <= 0:
            raise ValueError(
                f"{name} must be one of its names, or a positive {meaning}, not {value!r}"
            )
    if not (share == 1.0 or is_number(share, 0.0, 1.0)):
        raise ValueError(f"share must lie in (0, 1], not {share!r}")


def _check_law(law: Any, n_nodes: int) -> None:
    """Check that a law has an update, and array parameters of one value for each slave node."""
    if not isinstance(law, InterfaceLaw) or type(law).update is InterfaceLaw.update:
        raise ValueError(
            f"law must be an InterfaceLaw with an `update`, like Coulomb(mu=.3), unlike {law!r}"
        )
    for name, value in vars(law).items():
        if isinstance(value, np.ndarray) and value.shape != (n_nodes,):
            raise ValueError(
                f"{type(law).__name__}: {name} has shape {value.shape}; the slave has {n_nodes} "
                "nodes"
            )


def initial_clearance(
    gap: ndarray,
    meshed: ndarray,
    size: ndarray,
    fit: Fit,
    bonded: bool,
) -> ndarray:
    """Return the initial clearance of points, shape (n,), on slave segments of some size.

    Gaps are given where the bodies become active, and in the mesh: bodies are built to fit into
    displaced surfaces, so that they keep the gaps of the mesh.
    """
    # A larger change than this is no displacement: other surfaces have come to face each other
    with np.errstate(invalid="ignore"):  # inf - inf where nothing is near
        moved = np.where(np.abs(gap - meshed) <= 0.5 * size, gap - meshed, 0.0)
    ramped = fit == "ramped" or not isinstance(fit, str)
    if ramped:
        moved = np.zeros_like(gap)
    touching = np.abs(gap - moved) <= _adjusted(fit, bonded) * size
    clearance = np.where(touching, gap, moved)
    if ramped:
        return np.minimum(gap, clearance)
    return clearance


def _adjusted(fit: Fit, bonded: bool) -> float:
    """Return the share of a facet's size below which gaps of the mesh are none."""
    touches = bonded or fit == "adjusted" or not isinstance(fit, str)
    if touches:
        return _ADJUSTED
    return TOUCHING
