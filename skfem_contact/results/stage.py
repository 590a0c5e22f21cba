"""Result of a stage: data with all that can be computed from them."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike

from ..checks import check_upright, finite, look_up, number
from ..display import Table
from ..forms.base import Forms, internal_force, solids_of
from ..forms.roles import Touching, having
from ..materials.base import EXCESS_PRESSURE
from . import export, fields, files, strength, tables
from .cuts import Cuts, SectionForces
from .motion import energy_table, history
from .points import along_line, at_points
from .sections import section_forces
from .tractions import ContactReport, Tractions, contact_report, tractions


@dataclass(frozen=True)
class StageResult(files.StageData):
    """Equilibrium at the end of a stage, or of an increment.

    Attributes
    ----------
    name, time
        Name of the stage, and time at its end: the durations of all stages so far.
    x, load : ndarray, shape (N,)
        All dofs: displacements, then the other fields; and external forces.
    forms, states, summary
        Forms by name as they are in the stage, their accepted states, and one line of text for
        each.
    iterations, residual, fraction
        Newton iterations of every increment, in a step in time of second order of both equilibria;
        relative residual at the end, and share of the stage's load that was reached: 1 unless the
        analysis failed.
    increments
        Accepted increments that were kept, in their order.
    unreleased : ndarray, shape (N,), or None
        Forces of deactivated bodies that the load still holds, see ``Stage.release``.
    layout
        Numbers of the dofs of all fields.
    water, water_unit_weight
        Water at rest whose load is part of ``load``; a stage that follows keeps it.
    placed
        Displacements at which bodies were activated, (N,), by name: their fields of displacements
        count from these.
    next_step
        Length that the error in time allows for a step of the stage that follows.
    remarks, seconds
        Remarks of the forms on the end of the stage, and the time that its run took.
    changed, supports
        Forms that stages have changed, and supported dofs, with which a further run of the same
        model continues.
    supports_given
        True if a stage has given the supports in place of the model.
    before
        Displacements, load and time of the increment before: a run that continues from here
        extrapolates from both.
    velocity, acceleration : ndarray, shape (N,), or None
        Motion in a stage with ``dynamic``.
    inertial : ndarray, shape (N,), or None
        Forces of inertia and damping, which with the internal forces balance the load; means of a
        step, see :doc:`theory </theory/dynamics>`.
    series
        Records of all steps: energies and motions, see :attr:`energy` and :meth:`history`.
    gravity
        Acceleration of all weights over that of gravity, (dim,).
    new_mesh
        Mesh of deformed bodies that begins here, see :func:`~skfem_contact.remeshed`.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> mesh = MeshQuad().refined(2).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> forms = {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.))}
    >>> bottom = basis.get_dofs("bottom")
    >>> model = sc.Model(forms, bottom.all())
    >>> stage = model.run([sc.Stage("weight", sc.weight(basis, 20.))])["weight"]
    >>> stage
    <StageResult 'weight', 100% of its load, 50 dofs, forms: block>
    >>> round(float(stage.reactions()[bottom.all("u^2")].sum()), 9)
    20.0
    >>> sections = sc.Cuts.line((.5, 0.), (.5, 1.), depth=1., n=3)
    >>> stage.section_forces("block", sections).N.round(9).tolist()
    [-17.5, -10.0, -2.5]
    """

    def reactions(self) -> ndarray:
        """Return internal forces less the load, (N,): reactions of supports, else residuals."""
        balance = internal_force(self.forms, self.x, self.states) - self.load
        if self.inertial is None:
            return balance
        return balance + self.inertial

    @property
    def energy(self) -> Table:
        """Energies of a stage with ``dynamic``, a table with one row for each step.

        Columns: ``time``; ``kinetic``; since the start of the stage the change of the ``elastic``
        energy of bodies, structures and penalties, what ``plastic`` flow, ``friction`` and
        ``damping`` have taken, and the ``work`` of loads and moved supports. ``missing``: kinetic
        energy at the start and work, less all others: the damping of the scheme. Members and links
        that yield count as elastic, and so do laws without internal variables.

        Raises
        ------
        ValueError
            A stage without inertia.
        """
        return energy_table(self.series, self.name)

    history = history

    def tractions(self, pair: str) -> Tractions:
        """Return tractions, gaps and slips of a contact pair."""
        form, state = self._pair(pair)
        return tractions(form, state, self.x[: form.size])

    def contact(self, pair: str) -> ContactReport:
        """Return resultants, status and penetration of a contact pair."""
        form, state = self._pair(pair)
        return contact_report(form, self.x[: form.size], state)

    def report(self, pair: str) -> ContactReport:
        """Return :meth:`contact`: deprecated, as :meth:`Result.report` writes a file."""
        warnings.warn(
            "stage.report is deprecated: use stage.contact", DeprecationWarning, stacklevel=2
        )
        return self.contact(pair)

    def section_forces(self, body: str, sections: Cuts | None = None) -> SectionForces:
        """Return normal force, shear force and moment of a body or beam.

        Parameters
        ----------
        body
            Name of a :class:`~skfem_contact.Beam`, or of the solid that holds the body; it may hold
            other bodies.
        sections
            Cuts through a solid, :meth:`Cuts.ring` or :meth:`Cuts.line`; a beam needs none:
            its section forces are at both ends of its elements.

        Notes
        -----
        Between two lines of nodes forces are interpolated linearly; at the end of a body they are
        its last layer's. A curved body without layers of elements of length h has moments to ``N
        h**2 / 8 R``. With water in the pores forces of solids are effective: a total normal force
        is N less the pressure times the area of the cut. In axial symmetry they are per radian.

        Warns
        -----
        AnalysisWarning
            The body continues next to a cut that is not deep enough or off its middle.
        """
        look_up(body, self.forms, f"form in stage '{self.name}'")
        along = self.outputs(body).lines
        if along and not sections:
            return SectionForces(*along)
        return section_forces(*self._solid(body), sections)

    table = tables.of_form

    field = fields.nodal_field

    at = at_points

    along = along_line

    def pore_pressure(self, solid: str) -> ndarray:
        """Return the excess pore pressure of :class:`Undrained` soil, (n_elements, n_points).

        Compression is positive, other soil has zero. The pressure of :func:`water_load`, which is
        part of the load, is not included. A solid without such soil raises a ``ValueError``:
        ``field("pore")`` has the pressure of :class:`PoreWater`.
        """
        form, state = self._solid(solid)
        names: list[str] = []
        for material in form.materials.values():
            names += [variable.name for variable in material.internal]
        if EXCESS_PRESSURE not in names:
            raise ValueError(
                f"'{solid}' has no Undrained soil: field('pore') has the pressure of PoreWater at "
                f"nodes"
            )
        return strength.pore_pressure(form, state)

    def undrained_strength(self, solid: str) -> dict[str, ndarray]:
        r"""Return the undrained shear strength in plane strain from the stresses in the ground.

        Without drainage and dilation the mean effective stress in the plane,
        :math:`s' = -(\sigma_1' + \sigma_3') / 2`, remains constant if the soil is elastic and
        isotropic before it yields. The strength is

        .. math:: s_u = c \cos\varphi + s' \sin\varphi .

        Stresses are effective where :func:`water_load` acts. Every region with `c` and `phi` has an
        array, shape (n_elements,): means of the points of each element, at least zero, to be the
        `c` of :class:`Tresca`.
        """
        return strength.undrained_strength(*self._solid(solid))

    def shansep(
        self,
        solid: str,
        *,
        S: float,
        m: float = 0.8,
        OCR: float | Callable[[ndarray], ArrayLike] = 1.0,
        POP: float | Callable[[ndarray], ArrayLike] = 0.0,
    ) -> dict[str, ndarray]:
        r"""Return undrained strengths from the vertical effective stresses of the stage.

        .. math:: s_u = S \, \sigma_v' \, (\sigma_p' / \sigma_v')^m , \qquad
                  \sigma_p' = {\rm OCR} \, \sigma_v' + {\rm POP}

        Every region has an array, shape (n_elements,): means of the points of each element, to be
        the `c` of :class:`Tresca` in a later stage. C. C. Ladd, R. Foott, J. Geotech. Eng. Div. 100
        (1974) 763-786.

        Parameters
        ----------
        solid
            Name of the solid.
        S, m
            Strength ratio of normally consolidated clay, and exponent.
        OCR, POP
            Overconsolidation ratio, at least 1, and pressure that was removed: numbers or functions
            of the coordinates.

        Examples
        --------
        >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
        >>> import skfem_contact as sc
        >>> basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
        >>> clay = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=.3), unit_weight=8.)
        >>> rest = sc.Model({"clay": clay}, sc.box_supports(basis)).k0_state(K0=.5)
        >>> strength = rest["initial"].shansep("clay", S=.22, m=.8, OCR=2.)
        >>> strength["all"].round(4).tolist()   # .22 * 4 * 2^.8
        [1.5322]
        """
        if not S > 0.0 or not m > 0.0:
            raise ValueError(f"S and m must be positive, not {S!r} and {m!r}")
        if self.gravity is not None:
            check_upright(self.gravity, "vertical stresses of shansep need")
        return strength.shansep(*self._solid(solid), S, m, OCR, POP)

    def drawdown_strength(
        self,
        solid: str,
        *,
        c: float,
        phi: float,
        c_R: float,
        phi_R: float,
        region: str | None = None,
        after: StageResult | None = None,
        mechanism: ndarray | None = None,
    ) -> dict[str, ndarray]:
        r"""Return strengths just after a rapid drawdown, by the three-stage method.

        The stage is the one before the drawdown, with steady seepage. Its effective stresses
        consolidate the ground: they give the undrained strength on the failure plane, between the
        lines of isotropic consolidation and of failure (stage 2). Where the drained strength under
        the stresses of `after` is less, it counts (stage 3). J. M. Duncan, S. G. Wright, K. S.
        Wong, Proc. H. B. Seed Memorial Symposium 2 (1990) 235-272.

        Parameters
        ----------
        solid, region
            Name of the plane solid, and of one of its regions; by default all of them.
        c, phi
            Effective strength, the angle in degrees.
        c_R, phi_R
            Cohesion and friction angle in degrees of the envelope of total stresses, R, of
            consolidated undrained tests.
        after
            Stage after the drawdown with the final, drained pressures.
        mechanism
            Displacements of a collapse on the same basis, :attr:`CollapseResult.mechanism`: the
            stresses on its slip planes count, as on the surfaces of limit equilibrium. By default
            those on planes at 45 + phi / 2 degrees to the largest principal stress, which
            underrates slopes: 0.74 where 1.05 is published for Pilarcitos dam, and 1.07 with the
            mechanism. A collapse by the strengths on its own planes need not be the least one: a
            rotation gives the strengths on circles.

        Returns
        -------
        dict
            Arrays (n_elements,) by region, to be the `c` of :class:`Tresca` under total stresses:
            saturated unit weights, and water on the surface alone.

        Examples
        --------
        >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
        >>> import skfem_contact as sc
        >>> basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
        >>> clay = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=.3), unit_weight=10.)
        >>> rest = sc.Model({"clay": clay}, sc.box_supports(basis)).k0_state(K0=1.)["initial"]
        >>> found = rest.drawdown_strength("clay", c=0., phi=30., c_R=2., phi_R=15.)
        >>> share = np.cos(np.pi / 6.) / (1. - np.sin(np.pi / 12.))
        >>> by_hand = share * (2. * np.cos(np.pi / 12.) + 5. * np.sin(np.pi / 12.))
        >>> bool(np.isclose(found["all"][0], by_hand))
        True
        """
        # Check the strengths.
        for name, value, low in (
            ("c", c, -1e-300),
            ("c_R", c_R, -1e-300),
            ("phi", phi, 0.0),
            ("phi_R", phi_R, -1e-300),
        ):
            number(value, name, low, 90.0 if name.startswith("phi") else np.inf)
        # Find the solid and the mechanism.
        form, state = self._solid(solid)
        if form.coordinates != "plane":
            raise ValueError("strengths after a drawdown are those of plane bodies")
        later = None if after is None else after._solid(solid)[1]
        if mechanism is not None:
            mechanism = finite(mechanism, "mechanism")
            if mechanism.ndim != 1 or len(mechanism) < form.basis.N:
                raise ValueError(
                    f"mechanism has shape {mechanism.shape}; '{solid}' has {form.basis.N} dofs: "
                    "search the collapse on the same basis"
                )
        return strength.drawdown(
            form,
            state,
            later,
            region,
            (c, phi),
            (c_R, phi_R),
            mechanism,
        )

    def to_vtu(self, file: str | Path) -> None:
        """Write the solids, the contact and the beams to a ``.vtu`` file.

        Points have the ``displacement``, the recovered ``stress`` and ``strain`` (xx, yy, zz, xy,
        yz, xz; engineering shear) and the equivalent ``plastic_strain``, and the excess
        ``pore_pressure`` of consolidating or undrained ground. Regions share no points, so that no
        value is averaged between regions. Cells have means of ``stress`` and
        ``plastic_strain``, the number of the ``body``, in the order of
        :func:`~skfem_contact.mesh.join.bodies`, and of the ``region``, counted through the
        materials of all solids. The slave's facets of every contact pair are cells with
        means of ``pressure``, ``shear``, ``gap`` and ``slip``, the share ``closed`` of their area
        that is in contact, and the ``status`` of most of this share. Quadratic elements stay
        quadratic. Elements of beams have points of their own with ``N``, ``V`` and ``M``.
        """
        export.grid(self).write(file, file_format="vtu")

    def to_pyvista(self) -> Any:
        """Return pyvista's ``UnstructuredGrid`` with the data of :meth:`to_vtu`."""
        import pyvista

        return pyvista.from_meshio(export.grid(self))

    to_frame = export.frame

    def contour(self, quantity: str, **options: Any) -> Any:
        """Draw a field, see :func:`~skfem_contact.plot.contour`."""
        from ..plot import contour

        return contour(self, quantity, **options)

    def _solid(self, name: str) -> tuple[Any, Any]:
        """Return a solid and its state."""
        bodies = {}
        for key, form in solids_of(self.forms).items():
            if form.materials:
                bodies[key] = form
        return self._of(name, "SolidForm", bodies)

    def _pair(self, name: str) -> tuple[Any, Any]:
        """Return a contact pair and its state."""
        return self._of(name, "ContactPair", having(self.forms, Touching))

    def _of(self, name: str, kind: str, existing: Mapping[str, Any]) -> tuple[Any, Any]:
        """Return one of the forms of a kind, and its state."""
        form = look_up(name, self.forms, f"form in stage '{self.name}'")
        if name not in existing:
            raise ValueError(
                f"'{name}' is a {type(form).__name__}, no {kind}; there are {list(existing)}"
            )
        return form, self.states[name]

    def __repr__(self) -> str:
        return (
            f"<StageResult '{self.name}', {self.fraction:.0%} of its load, {len(self.x)} dofs, "
            f"forms: {', '.join(self.states)}>"
        )


def undeformed(name: str, forms: Forms, size: int) -> StageResult:
    """Return a stage of undeformed bodies without load, of some forms among `size` dofs."""
    states = {key: form.initial_state() for key, form in forms.items()}
    nothing = np.zeros(size)
    return StageResult(name, nothing, nothing.copy(), states, (), 0.0)
