"""New meshes of deformed bodies, and the states of laws and contact on them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

import numpy as np
import scipy
from numpy import ndarray
from skfem import Mesh
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTri

from ..arrays import max_abs
from ..checks import is_number, look_up
from ..display import Table
from ..errors import NotConverged, warn
from ..forms.base import Forms, States, solids_of
from ..forms.regions import Region, by_elasticity
from ..forms.roles import Touching, having
from ..layout import elements_in
from ..nonlinear.newton import Evaluation
from ..nonlinear.system import System
from ..results.result import Result
from ..results.stage import StageResult
from ..results.tractions import tractions as tractions_of
from ..section.deformed import outline, triangles
from ..solvers.direct import SingularSystem
from .initial import nearest_points, state_of
from .setup import Setup
from .stage import Force

#: Gap, as a share of a facet, with which a new point beside a closed one touches, too.
_TOUCHING = 0.1
#: Change of volume, and of stresses on the yield surface, of which a warning is given: a pipe in
#: clay loses 2e-5 and 7e-5 at a new mesh, a block sheared by .5 with four elements a side 1e-3 and
#: 4e-4.
_LOST = (5e-3, 0.05)
#: Change of stresses that balance takes, of which a warning is given: it is .1 to .32 for pipes,
#: cones and wedges in clay as in the gallery, whose forces fall by 3 to 9 % and recover, and .38 to
#: .46 with elements twice as long and in layers of one element, whose forces fall by 10 to 34 %.
_UNBALANCED = 0.35
#: Iterations of Newton's method for this change: it is off by 30, 10 and 3 % after 1, 2 and 3.
_ITERATIONS = 2


@dataclass(frozen=True, eq=False)
class Remeshed:
    """New mesh of the deformed bodies of a stage.

    Attributes
    ----------
    mesh : Mesh
        Triangles in the deformed bodies, with the names of subdomains and boundaries.
    stage : StageResult
        The stage that it comes from.
    volume : tuple of float
        Area of the deformed bodies before and now.
    """

    mesh: Mesh
    stage: StageResult
    volume: tuple[float, float]

    def start(self, model: Setup, load: Force = None, *, name: str = "new mesh") -> Result:
        """Return the state of the stage on a model of the new mesh, without displacements.

        Cauchy stresses and internal variables are interpolated linearly between the integration
        points of each part, which stays inside of convex yield surfaces. Contact that was closed
        is closed, with tractions that balance the stresses.

        Parameters
        ----------
        model
            Model on :attr:`mesh`, with forms of the same names.
        load
            External forces besides weights, (N,), as for a :class:`~skfem_contact.Stage`.
        name
            Name of the state in the result.

        Returns
        -------
        Result
            A start for :meth:`Model.run`, whose stages then find equilibrium. Prescribed
            displacements count from here.

        Warns
        -----
        AnalysisWarning
            Much volume, stress or balance was lost, see :meth:`loss`.
        """
        return _started(self, model, load, name)

    def loss(self, start: Result) -> Table:
        """Return what the new mesh has lost: shares of volume, stress and balance.

        ``volume`` is the change of area, ``stress`` the largest change of a stress that was beyond
        the strength, over the largest stress, and ``balance`` the change of stresses by which the
        next stage finds equilibrium, over the stresses, both as roots of their elastic energy; NaN
        where the tangent is singular or the displacements run away.
        """
        end = start[-1]
        lost = end.series["loss"]
        columns = {"quantity": np.array(["volume", "stress", "balance"]), "lost": lost}
        return Table.of(columns, f"loss of '{end.name}'")


def remeshed(
    stage: StageResult,
    size: float | Callable[[ndarray], ndarray],
    *,
    order: Literal[1, 2] = 2,
) -> Remeshed:
    """Return a new mesh of the deformed bodies of a stage, from Gmsh.

    Boundaries and borders of subdomains become smooth curves through their displaced nodes, between
    corners of more than 30 degrees. All names are kept. Bodies that large strains have distorted
    continue with a model that is built anew on this mesh.

    Parameters
    ----------
    stage
        Stage of solids in the plane or of axial symmetry, with ``kinematics="finite"``.
    size
        Size of the elements: a number, or a function of coordinates (2, n) that returns (n,).
    order
        2: curved triangles, ``MeshTri2``, for ``ElementTriP2``; 1: straight ones.

    Raises
    ------
    ValueError
        Solids in space or of small kinematics, a size that is not positive, an outline that crosses
        itself, bodies that Gmsh cannot mesh. The stage is untouched, and a run can continue from
        it.

    See Also
    --------
    Remeshed.start : State of the stage on the new mesh.

    Examples
    --------
    A sheared block continues with new elements:

    >>> import numpy as np
    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> def model_of(mesh):
    ...     basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
    ...     clay = sc.Tresca(E=100., nu=.49, c=1.)
    ...     forms = {"block": sc.SolidForm(basis, clay, kinematics="finite")}
    ...     ends = [basis.get_dofs(name).all() for name in ("bottom", "top")]
    ...     return sc.Model(forms, np.concatenate(ends)), basis
    >>> model, basis = model_of(MeshQuad().refined(2).to_meshtri().with_defaults())
    >>> u = basis.zeros()
    >>> u[basis.get_dofs("top").all("u^1")] = .5
    >>> stage = model.run([sc.Stage("sheared", prescribed=u)])["sheared"]
    >>> new = sc.remeshed(stage, size=.25)
    >>> sorted(new.mesh.boundaries), round(float(new.volume[1]), 2)
    (['bottom', 'left', 'right', 'top'], 1.0)
    >>> again, basis = model_of(new.mesh)
    >>> start = new.start(again)
    >>> bool((new.loss(start)["lost"][:2] < .002).all())
    True
    >>> rest = again.run([sc.Stage("rest")], start=start)["rest"]
    """
    field = size_field(size)
    # Outline the deformed bodies, and fill the outline anew.
    solids = solids_of(stage.forms)
    mesh = mesh_of(solids, f"stage '{stage.name}'")
    elements = np.unique(elements_in(solids.values()))
    basis = next(iter(solids.values())).basis
    vertices, middles = _displaced(basis, stage.x)
    new = triangles(outline(mesh, elements, vertices, middles), field, order)
    before = sum(_area(form, stage.states[name]) for name, form in solids.items())
    return Remeshed(new, stage, (before, _area_of(new)))


def size_field(size: Any) -> Callable[[ndarray], ndarray]:
    """Return the size as a function of coordinates (2, n)."""
    if callable(size):

        def checked(x: ndarray) -> ndarray:
            values = np.broadcast_to(np.asarray(size(x), float), x.shape[1:])
            if not (np.isfinite(values) & (values > 0.0)).all():
                raise ValueError("size must return positive numbers, one for each point")
            return values

        return checked
    if not is_number(size, 0.0, np.inf):
        raise ValueError(f"size must be a positive number or a function, not {size!r}")
    return lambda x: np.full(x.shape[1:], float(size))


def mesh_of(solids: dict[str, Any], where: str) -> Mesh:
    """Return the mesh of solids; refuse one that cannot be taken over to another."""
    # Check dimension and kinematics.
    if not solids:
        raise ValueError(f"{where} has no solids, of which a mesh could be made")
    mesh: Mesh = next(iter(solids.values())).basis.mesh
    if mesh.dim() != 2:
        raise ValueError("new meshes are for bodies in the plane and of axial symmetry")
    small = [name for name, form in solids.items() if form.kinematics != "finite"]
    if small:
        raise ValueError(
            f"new meshes are for solids with kinematics='finite', unlike {small}: others do not "
            "leave their mesh"
        )
    # Tensors in the memory would have to turn.
    for name, form in solids.items():
        for region, material in form.materials.items():
            if material.slips_on_planes:
                raise ValueError(
                    f"'{name}.{region}' slips along planes, which turn with the body and cannot be "
                    "taken over to new meshes"
                )
            tensors = [v.name for v in material.internal if v.name.endswith((" xx", "_xx"))]
            if tensors:
                raise ValueError(
                    f"'{name}.{region}' remembers tensors ({tensors[0]}), which turn with the body "
                    "and cannot be taken over to new meshes"
                )
    return mesh


def check_memory(forms: Forms, states: States) -> None:
    """Refuse forms that have a state, but are neither solids nor contact."""
    known = {*solids_of(forms), *having(forms, Touching)}
    others = [key for key, state in states.items() if state is not None and key not in known]
    if others:
        raise ValueError(
            f"{others} are no solids or contact: new meshes do not take over their state"
        )


def _displaced(basis: Any, x: ndarray) -> tuple[ndarray, ndarray | None]:
    """Return displaced vertices, (2, n), and middles of facets, None in the first order."""
    vertices = basis.doflocs[:, basis.nodal_dofs[0]] + x[basis.nodal_dofs]
    if len(basis.facet_dofs) < 2:
        return vertices, None
    return vertices, basis.doflocs[:, basis.facet_dofs[0]] + x[basis.facet_dofs]


def _area(form: Any, state: Any) -> float:
    """Return the present area of a solid in the plane."""
    plane = state.gradient
    growth = plane[0] + plane[1] + plane[0] * plane[1] - plane[3] * plane[4]
    dx = np.asarray(form.basis.dx)
    return float((dx * (1.0 + growth)).sum())


def _area_of(mesh: Mesh) -> float:
    """Return the area of a mesh, with its curved sides."""
    mapping = mesh.mapping()
    points, weights = get_quadrature(RefTri, 4)
    return float((np.abs(mapping.detDF(points)) @ weights).sum())


def _positions(form: Any, x: ndarray) -> ndarray:
    """Return displaced integration points, (2, n_elements, n_points)."""
    own = x[: form.basis.N]  # without the dofs of other forms
    return np.asarray(form.basis.global_coordinates()) + np.asarray(form.basis.interpolate(own))


class _Carrier:
    """Values at points of old parts, interpolated linearly; the nearest one outside of them."""

    def __init__(self, points: ndarray, values: ndarray) -> None:
        self._tree = scipy.spatial.cKDTree(points)
        self._values = values
        self._linear = (
            scipy.interpolate.LinearNDInterpolator(points, values) if len(points) > 3 else None
        )

    def at(self, x: ndarray) -> ndarray:
        """Return values at points (n, 2): (n, n_values)."""
        nearest = self._values[self._tree.query(x)[1]]
        if self._linear is None:
            return nearest
        found = self._linear(x)
        return np.where(np.isnan(found), nearest, found)


def _started(new: Remeshed, model: Setup, load: Force, name: str) -> Result:
    """Return the state of an old stage on a model of the new mesh."""
    stage = new.stage
    whole = model.load(load) + model.weights(model.forms)
    system = model.checked_system(model.forms, model.fixed)
    x = np.zeros(system.size)
    states = {key: form.initial_state() for key, form in system.forms.items()}

    # Take over the states of the laws
    returned = 0.0
    solids = solids_of(system.forms)
    for key, form in solids.items():
        look_up(key, stage.states, "solid of the old stage")
        states[key], change = _carried(form, stage.forms[key], stage, key)
        returned = max(returned, change)

    # Close contact where it was closed
    check_memory(system.forms, states)
    touching = having(system.forms, Touching)
    for key, pair in touching.items():
        if key in stage.states:
            bodies = solids, states
            states[key] = _touching_again(pair, states[key], x[: pair.size], bodies, stage, key)

    # Measure what was lost
    now = system.evaluate(x, states, whole)
    before, after = new.volume
    lost = np.array([abs(after / before - 1.0), returned, _unbalanced(system, now, whole, states)])
    _warn_of_losses(name, lost)
    end = state_of(name, system, now, whole, states)
    return Result((replace(end, series={"loss": lost}, new_mesh=new.mesh),))


def _unbalanced(system: System, now: Evaluation, load: ndarray, states: dict[str, Any]) -> float:
    """Return the change of stresses that restores balance over the stresses, by their energies.

    The first iterations of Newton's method give the displacements that restore it.
    """
    # Round-off is in balance.
    if now.norm == 0.0:
        return 0.0
    try:
        for _ in range(_ITERATIONS):
            step = system.factor(system.tangent(now))(now.residual)
            now = system.evaluate(now.z + step, states, load)
    except (SingularSystem, NotConverged):
        return np.nan
    # Compare the energies of the change and of the stresses.
    changed = 0.0
    stored = 0.0
    for name, form in solids_of(system.forms).items():
        for region, stress, internal in form.at_regions(states[name]):
            change = now.states[name].stress[:, region.elements] - stress
            changed += _energy(form, region, change, stress, internal)
            stored += _energy(form, region, stress, stress, internal)
    if stored == 0.0:
        return np.inf
    return float(np.sqrt(changed / stored))


def _energy(
    form: Any, region: Region, change: ndarray, stress: ndarray, internal: ndarray
) -> float:
    """Return twice the elastic energy of a change of stresses, with the elasticity of a state."""
    strain = by_elasticity(region.material, change, stress, internal)
    return float((form.weight[region.elements] * (change * strain).sum(axis=0)).sum())


def _warn_of_losses(name: str, lost: ndarray) -> None:
    """Warn of large losses."""
    volume, stress, balance = lost
    if (lost[:2] > _LOST).any():
        warn(
            f"'{name}' loses {volume:.1%} of the volume and {stress:.1%} of a stress: take new "
            "meshes earlier, or smaller elements"
        )
    if balance > _UNBALANCED:
        warn(
            f"'{name}' is out of balance: the next stage restores it, which changes the stresses "
            f"by about {balance:.0%} in the norm of their energy, and reactions with them: take "
            "smaller elements, on the mesh before as well"
        )


def _carried(form: Any, old: Any, stage: StageResult, key: str) -> tuple[Any, float]:
    """Return the state of a solid on its new mesh, and the largest return of a stress."""
    # Interpolate stresses and memory of each region by coordinates.
    state = stage.states[key]
    known = np.concatenate((old.cauchy(state), state.internal))
    at_old = _positions(old, stage.x)
    at_new = np.asarray(form.basis.global_coordinates())
    values = np.zeros((len(known), *at_new.shape[1:]))
    parts = {region.name: region.elements for region in old.regions}
    for region in form.regions:
        part = parts.get(region.name, slice(None))
        carrier = _Carrier(
            at_old[:, part].reshape(2, -1).T, known[:, part].reshape(len(known), -1).T
        )
        found = carrier.at(at_new[:, region.elements].reshape(2, -1).T)
        values[:, region.elements] = found.T.reshape(len(known), -1, at_new.shape[2])
    # Return stresses to the yield surface.
    n = len(state.stress)
    start = form.initial_state(stress=values[:n])
    start = replace(start, internal=values[n:])
    resisted = form.assemble(np.zeros(form.size), start).state
    largest = max_abs(values[:n])
    change = max_abs(resisted.stress - values[:n])
    return resisted, change / largest if largest else 0.0


def _nearest_stress(points: ndarray, solids: dict[str, Any], states: dict[str, Any]) -> ndarray:
    """Return stresses of the nearest integration points, (4, n)."""
    stresses = [states[key].stress.reshape(4, -1) for key in solids]
    return np.asarray(np.concatenate(stresses, axis=1)[:, nearest_points(points, solids)])


class _OldContact(NamedTuple):
    """Contact of the points on a new mesh, from the nearest ones of the old mesh.

    Attributes
    ----------
    state : ContactState
        State with closed points, internal variables and clearances.
    gap : ndarray, shape (n,)
        Gaps of the old points at closed ones, else the present ones.
    pressure : ndarray, shape (n,)
        Normal tractions of the old points per present area, 0 where open.
    """

    state: Any
    gap: ndarray
    pressure: ndarray


def _touching_again(
    pair: Any, state: Any, x: ndarray, bodies: tuple[Any, Any], stage: StageResult, key: str
) -> Any:
    """Return the state of a pair on a new mesh, with the pressures and gaps of the old one.

    A closed point takes the gap g of the nearest old one for its own. Its clearance, g - t_N /
    penalty, then is the old one, but for the area that the penalty counts. With gaps of its own,
    each new mesh would add the errors of its curves, and surfaces would drift apart.
    """
    old = _old_contact(pair, state, stage, key)
    operator = pair.tractions_at(x, old.state)
    if operator is None:
        raise ValueError(
            f"'{key}' has DualMultipliers, whose contact new meshes do not take over: "
            "take the penalty method or AugmentedLagrangian()"
        )
    # Take shear from the stresses beside the points.
    stresses = _nearest_stress(operator.coordinates, *bodies)
    tractions = operator.of_stress(stresses).reshape(pair.slave.dim, -1)
    tractions[0] = old.pressure
    started = operator.state_with(tractions.ravel())
    # Points far from all facets have infinite gaps, which do not change.
    change = np.zeros_like(old.gap)
    np.subtract(old.gap, old.state.gap, out=change, where=old.gap != old.state.gap)
    clearance = started.clearance + change
    return pair.assemble(x, replace(started, clearance=clearance)).state


def _old_contact(pair: Any, state: Any, stage: StageResult, key: str) -> _OldContact:
    """Return the contact of the old mesh at the points of a new one."""
    # Find the old contact points, where they are now, beside the new ones.
    old: Any = stage.forms[key]
    before = stage.states[key]
    x = stage.x[: old.size]
    slave, _ = old.interface.positions(x)
    at_old = old.points(before).positions(slave + old.slave.middle)
    points = pair.points(state)
    at_new = points.positions(pair.slave.nodes)
    nearest = scipy.spatial.cKDTree(at_old).query(at_new)[1]
    was_closed = np.flatnonzero(before.status != 0)
    same = replace(
        state,
        status=np.zeros_like(state.status),
        clearance=state.rounded + (before.clearance - before.rounded)[nearest],
        internal=before.internal[:, nearest],
    )
    if not len(was_closed):
        return _OldContact(same, state.gap, np.zeros_like(state.gap))

    # A new point is closed beside old closed ones, if its gap is small.
    distance, number = scipy.spatial.cKDTree(at_old[was_closed]).query(at_new)
    nearest = was_closed[number]
    near = np.isfinite(state.gap) & (np.abs(state.gap) < _TOUCHING * points.size)
    near &= distance < points.size
    gap = state.rounded + (before.gap - before.rounded)[nearest]
    pressure = -tractions_of(old, before, x).pressure
    return _OldContact(
        replace(same, status=np.where(near, before.status[nearest], 0)),
        np.where(near, gap, state.gap),
        np.where(near, pressure[nearest], 0.0),
    )
