"""Model: forms and supports of an analysis, and everything that can be asked of them."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, Literal

import numpy as np

from .collapse import limit_load as limits
from .collapse import strength
from .limit_analysis import Bounds, bounds
from .limit_analysis.model import TractionLike
from .solvers import single_threaded
from .stages import buckling as buckles
from .stages import initial, new_meshes, vibrations
from .stages.setup import Setup
from .stages.stage import AtRest


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
        A scikit-fem linear solver ``(A, b) -> x``; ``"amg"``, algebraic multigrid by pyamg; or
        :class:`~skfem_contact.Petsc`, for several processes. By default a direct solver with an
        ordering of its own; for large bodies in space multigrid where it is faster and installed.
    newton
        Settings of Newton's method; by default the settings of each method.
    gravity
        Direction of gravity, a unit vector (dim,); by default against the last axis.
    seismic
        Horizontal acceleration over the one of gravity, a number or a component for each
        horizontal axis: the axes across `gravity`, in their order. In the plane gravity may be
        inclined; the acceleration is then across it, towards x.
    water_unit_weight
        Unit weight of water, for water levels.
    gravity_acceleration
        Acceleration of gravity in the units of the model, such as 9.81 for kN and m: unit weights
        over it are the densities of stages with ``dynamic`` and of natural frequencies.

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

    initial_state = initial.initial_state
    k0_state = initial.k0_state
    gravity_state = single_threaded(initial.gravity_state)
    run = new_meshes.run
    modes = single_threaded(vibrations.modes)
    frequencies = single_threaded(vibrations.frequencies)
    buckling = single_threaded(buckles.buckling)
    strength_reduction = single_threaded(strength.strength_reduction)
    limit_load = single_threaded(limits.limit_load)
    is_stable = single_threaded(limits.is_stable)

    def bounds(
        self,
        weight: float | np.ndarray | Mapping[str, float] | None = None,
        *,
        tractions: Mapping[str, TractionLike] | None = None,
        water: AtRest = None,
        submerged: str | Collection[str] = (),
        seismic: float | None = None,
        reduce: str | Collection[str] | None = None,
        exclude: str | Collection[str] = (),
        live: str | Collection[str] = (),
        flow: Literal["given", "associated"] = "given",
        gap: float = 0.01,
        elements: int = 20_000,
        seconds: float = np.inf,
        progress: bool | None = None,
    ) -> Bounds:
        """Return proven bounds of the factor of safety or of the limit load.

        See :func:`~.limit_analysis.bounds`; by default the acceleration is that of the model, and
        `water` may be a level, a line or a seepage as well.
        """
        given_by_model = self.seismic  # refuses gravity that bounds do not know
        horizontal: Any = given_by_model if seismic is None else seismic
        given: Any = weight
        resting: Any = water
        return bounds(
            self.forms,
            self.fixed,
            given,
            tractions=tractions,
            water=resting,
            water_unit_weight=self.water_unit_weight,
            submerged=submerged,
            seismic=horizontal,
            reduce=reduce,
            exclude=exclude,
            live=live,
            flow=flow,
            gap=gap,
            elements=elements,
            seconds=seconds,
            progress=progress,
        )
