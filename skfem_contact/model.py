"""Model: forms and supports of an analysis, and everything that can be asked of them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, Literal

import numpy as np
from numpy import ndarray

from .collapse.limit_load import is_stable, limit_load
from .collapse.result import CollapseResult
from .collapse.strength import strength_reduction
from .limit_analysis import Bounds, bounds
from .materials.base import Flow
from .results import Result, StageResult
from .stages.initial import gravity_state, initial_state, k0_state
from .stages.run import Observer, run
from .stages.setup import Setup
from .stages.stage import AtRest, Force, Stage


class Model(Setup):
    """Forms and supports of an analysis, with the settings that its runs and searches share.

    The model completes the forms (contact takes its default penalty from the stiffness of the
    bodies), numbers all dofs and checks that the forms fit together.

    Parameters
    ----------
    forms
        Solids, contact pairs and other forms by name, those included that are active in some stages
        only.
    fixed
        Dofs that are held (or moved by ``Stage.prescribed``): numbers, dofs of a field such as
        ``water.dofs("top")``, or a list of both.
    solver
        A scikit-fem linear solver ``(A, b) -> x``, or ``"amg"``, algebraic multigrid by pyamg. By
        default a direct solver with an ordering of its own; for large bodies in space multigrid
        where it is faster and installed.
    newton
        Settings of Newton's method; by default the settings of each method.
    gravity
        Direction of gravity, a unit vector (dim,); by default against the last axis.
    seismic
        Horizontal acceleration over the one of gravity, a number or a component for each
        horizontal axis.
    water_unit_weight
        Unit weight of water, for water levels.

    Attributes
    ----------
    forms
        The forms, completed and numbered.
    layout
        Numbers of all dofs.
    coordinates
        Coordinate system of the forms: ``"plane"``, ``"axisymmetric"`` or ``"space"``.

    Raises
    ------
    ValueError
        Objects that are no forms, forms of different meshes or coordinate systems, fields that two
        forms bring, dofs that do not exist, weights across the axis.

    Examples
    --------
    A square under its own weight:

    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> mesh = MeshQuad().refined(2).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> square = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.), unit_weight=20.)
    >>> model = sc.Model({"square": square}, basis.get_dofs("bottom").all())
    >>> print(model.run([sc.Stage("gravity")]))
    stage            increments  iterations  residual  load    state
    gravity                   1           1   ...  100%
    """

    def __repr__(self) -> str:
        forms = ", ".join(self.forms)
        return f"<Model {self.coordinates or ''} {self.layout.size} dofs, forms: {forms}>"

    def initial_state(
        self,
        load: Force = None,
        *,
        stress: Callable[[ndarray], ndarray],
        water: AtRest = None,
        name: str = "initial",
    ) -> Result:
        """Return a start with a given field of stresses; nothing has moved.

        Where a stress is not admissible it is returned to the yield surface, and counted as
        yielded. Contact pairs get the tractions that balance the stresses on both sides.

        Parameters
        ----------
        load
            External forces besides the weight of the forms, (N,): stresses, weight and these are in
            equilibrium.
        stress
            Stress (xx, yy, zz, xy), tension positive, at coordinates (2, n_elements, n_points): (4,
            n_elements, n_points); in three dimensions 6 components at coordinates (3, n_elements,
            n_points).
        water
            Water at rest, as in :class:`Stage`.
        name
            Name of the state in the result.

        Returns
        -------
        Result
            A start for :meth:`run`, with the residual of its equilibrium. A stage with the same
            load, a *null step*, removes the rest.

        Warns
        -----
        AnalysisWarning
            The forces out of balance exceed 1e-6 of the load.
        """
        return initial_state(self, load, stress, water, name)

    def k0_state(
        self,
        load: Force = None,
        *,
        K0: float | Mapping[str, float],
        unit_weights: float | Mapping[str, float] | None = None,
        surcharge: float = 0.0,
        water: AtRest = None,
        name: str = "initial",
    ) -> Result:
        """Return the K0 state of level ground.

        The vertical stress follows from the weight above, the horizontal stress is K0 times it.
        Where the surface or the layers are not level use :meth:`gravity_state`.

        Parameters
        ----------
        load, name
            As for :meth:`initial_state`.
        K0
            Ratio of the effective stresses: one number, or by subdomain.
        unit_weights
            Unit weights, one number or by subdomain; by default the forms' own. Subdomains that
            are not named are weightless.
        surcharge
            Pressure on the surface, with the water above it.
        water
            Water at rest: its level, points of it, or the pore pressure as a function of the
            coordinates or at the vertices, (n_vertices,). Stresses are then effective, everywhere.
            A wall that is wished in place begins as ground. Where the forms have unit weights the
            load of the water is added, otherwise `load` holds it.

        Raises
        ------
        ValueError
            Unknown subdomain, elements without K0, different unit weights at the same height (the
            ground is not level).

        Examples
        --------
        >>> import numpy as np
        >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
        >>> import skfem_contact as sc
        >>> mesh = MeshQuad().refined(1).with_defaults()
        >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
        >>> soil = sc.MohrCoulomb(E=1e4, nu=.3, c=1., phi=30.)
        >>> ground = sc.SolidForm(basis, soil, unit_weight=20.)
        >>> start = sc.Model({"ground": ground}, sc.box_supports(basis)).k0_state(K0=.5)
        >>> stress = start["initial"].states["ground"].stress
        >>> bool(np.allclose(stress[0], .5 * stress[1])), bool(start["initial"].residual < 1e-12)
        (True, True)
        """
        return k0_state(self, load, K0, unit_weights, surcharge, water, name)

    def gravity_state(
        self,
        load: Force = None,
        *,
        K0: float | Mapping[str, float] | None = None,
        water: AtRest = None,
        name: str = "initial",
        increments: int = 1,
    ) -> Result:
        """Turn gravity on in ground of any shape; the displacements are then set to zero.

        Contact has followed the bodies: where it does not balance once it is back, equilibrium is
        found from this state.

        Parameters
        ----------
        load, water, name
            As for :meth:`initial_state`. Excess pressures of :class:`PoreWater` are zero.
        K0
            Where it is given, for all regions or by the name of a region, gravity first acts on
            elastic ground with Poisson's ratio K0 / (1 + K0), which gives this ratio under a level
            surface; then the ground's own materials find their equilibrium.
        increments
            Number of increments to begin with.

        Raises
        ------
        ValueError
            K0 outside (0, 1), or of a region that does not exist.
        """
        return gravity_state(self, load, K0, water, name, increments)

    def run(
        self,
        stages: Sequence[Stage],
        *,
        start: Result | StageResult | None = None,
        on_increment: Observer | None = None,
        progress: bool | None = None,
    ) -> Result:
        """Run stages one after the other.

        Parameters
        ----------
        stages
            Stages in their order.
        start
            Result, or one stage, to continue from, with the changes by its stages; forms it lacks
            are inactive.
        on_increment
            Function of every accepted increment, a :class:`StageResult`, such as
            ``sc.results.Append(file)``.
        progress
            Show a progress bar; by default where the output is a terminal.

        Returns
        -------
        Result
            The stages of ``start``, if any, and the new ones.

        Raises
        ------
        ValueError
            Bad input, before anything is computed: sizes, NaN, unknown or repeated names, a body
            that nothing holds.
        NotConverged
            With the partial result, whose last entry is the last increment that was accepted; so
            has the ``KeyboardInterrupt`` of a run that is stopped by hand, as its attribute
            ``result``.

        Warns
        -----
        AnalysisWarning
            Remarks of the forms on their states, each kind once; stages and supports that change
            nothing.
        """
        return run(self, stages, start, on_increment, progress)

    def strength_reduction(
        self,
        load: Force = None,
        *,
        start: Result | StageResult | None = None,
        water: AtRest = None,
        reduce: str | Collection[str] | None = None,
        exclude: str | Collection[str] = (),
        flow: Flow = "given",
        tolerance: float = 0.01,
        step: float = 0.1,
        max_value: float = 100.0,
        certify: bool | Literal["auto"] | Mapping[str, Any] = "auto",
        undrained: bool = False,
        progress: bool | None = None,
    ) -> CollapseResult:
        """Reduce the strength until the structure collapses under its load.

        The work of the load is prescribed and the factor follows, up to its plateau.

        Parameters
        ----------
        load
            External forces besides the weight of the forms and the water, (N,); by default the ones
            of ``start``.
        start
            Where to start: a result (its last stage) or a stage. By default the load is applied to
            the unstrained bodies first.
        water
            Water at rest, as of a :class:`Stage`; by default the water of ``start``; ``False``:
            none.
        reduce
            Names of forms and of regions whose strength is reduced, or one; by default all that
            have a strength: regions of solids, and friction and adhesion of contact pairs.
        exclude
            Names of forms and of regions that keep their strength, or one.
        flow
            Flow rule: ``"given"``, ``"associated"``, ``"davis_a"``, ``"davis_b"``, ``"davis_c"`` or
            ``"lagged"``, see
            :doc:`theory </theory/plasticity>`.
        tolerance
            Width of the bracket; the curve is followed until a quarter of it is left.
        step
            First step of the factor, at least `tolerance`: over less a curve looks like its
            plateau.
        max_value
            The search ends above this factor.
        certify
            Prove bounds as well, :attr:`CollapseResult.proven`. ``"auto"``: on the mesh of a plane
            search if that takes no more than about its time. True, or arguments of :meth:`bounds`
            such as ``{"gap": .02}``: on meshes of their own. The load must be a sum of weights and
            linear tractions on boundaries; water at rest is known.
        undrained
            Let no water flow in ground with :class:`PoreWater`: a collapse just after a quick
            change. By default its pressures stay: a collapse as slow as the drainage.
        progress
            Show a progress bar; by default where the output is a terminal.

        Raises
        ------
        NotConverged
            No equilibrium was found to start from.

        Warns
        -----
        AnalysisWarning
            The factor is below 1, outside of the proven bounds, or needs displacements beyond a
            tenth of the model; no collapse was shown (:attr:`CollapseResult.stop`); elements lock;
            pressures are kept that have yet to drain.

        Examples
        --------
        A column of soil that can spread collapses at ``q = 2 c / F``, or under 2 c:

        >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
        >>> import skfem_contact as sc
        >>> mesh = MeshQuad().refined(1).with_defaults()
        >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
        >>> column = sc.SolidForm(basis, sc.MohrCoulomb(E=1e3, nu=.3, c=10., phi=0.))
        >>> fixed = [basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")]
        >>> model = sc.Model({"soil": column}, fixed)
        >>> load = model.traction("top", (0., -10.))
        >>> f"{model.strength_reduction(load).factor:.2f} {model.limit_load(load).multiplier:.2f}"
        '2.00 2.00'
        """
        return strength_reduction(
            self,
            load,
            start,
            water,
            reduce,
            exclude,
            flow,
            tolerance,
            step,
            max_value,
            certify,
            undrained,
            progress,
        )

    def limit_load(
        self,
        load: Force,
        *,
        start: Result | StageResult | None = None,
        tolerance: float = 0.005,
        step: float = 1.0,
        max_value: float = np.inf,
        flow: Flow = "given",
        max_step: float = np.inf,
        min_displacement: float = 0.0,
        certify: bool | Mapping[str, Any] = False,
        undrained: bool = False,
        progress: bool | None = None,
    ) -> CollapseResult:
        """Multiply a load until the structure collapses.

        The work of the load is prescribed and its multiplier follows, until the curve over the work
        has levelled off.

        Parameters
        ----------
        load
            Reference load, (N,).
        start
            Where to start: a result (its last stage) or a stage, whose load stays. By default the
            bodies are unstrained, and the weight of the forms stays.
        tolerance
            The curve ends when its last slope lets the multiplier rise by no more than this share.
        step
            First multiplier; it is halved until an equilibrium is found.
        max_value
            The curve ends when the multiplier exceeds this.
        flow
            Flow rule. With psi < phi the law as given takes hundreds of iterations or stalls; one
            that is ``"lagged"`` (Krabbenhoft and others 2012) does not, but must start from
            equilibrium with its own friction, and in long steps it resists more than the given law:
            `max_step` keeps them short.
        max_step
            Work of the longest step over the work of the first one. Steps grow up to it.
        min_displacement
            The curve does not end at a peak or plateau before a displacement is as large as this.
        certify, undrained, progress
            As for :meth:`strength_reduction`; water is the water of the start.

        Raises
        ------
        NotConverged
            No step was small enough to begin with.

        Warns
        -----
        AnalysisWarning
            The search has shown no limit, and it may be higher: :attr:`CollapseResult.stop` says
            why. Or the value lies outside of the proven bounds by more than `tolerance`, or needs
            displacements beyond a tenth of the model.
        """
        return limit_load(
            self,
            load,
            start,
            tolerance,
            step,
            max_value,
            flow,
            max_step,
            min_displacement,
            certify,
            undrained,
            progress,
        )

    def is_stable(
        self,
        load: Force = None,
        *,
        start: Result | StageResult | None = None,
        water: AtRest = None,
        undrained: bool = False,
    ) -> bool:
        """Return True if the structure resists its load: its factor of safety is above 1.

        An equilibrium means True; displacements that run away along a mechanism
        (:class:`NoEquilibrium`) mean False.

        Parameters
        ----------
        load, start, water, undrained
            As for :meth:`strength_reduction`.

        Raises
        ------
        NotConverged
            Neither an equilibrium nor a collapse was found; :meth:`limit_load` proceeds by
            steps.
        """
        return is_stable(self, load, start, water, undrained)

    def bounds(self, **options: Any) -> Bounds:
        """Return proven bounds of the factor of safety or of the limit load.

        See :func:`~.limit_analysis.bounds`.
        """
        return bounds(self.forms, self.fixed, **{"seismic": self.seismic, **options})
