"""Results of stages: data with all that can be computed from them."""
from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy import ndarray

from ..checks import look_up
from ..display import html_table
from ..forms.base import Form, as_forms, internal_force, pairs_of, solids_of
from . import export, fields, files, strength
from .sections import Envelope, SectionForces, Sections, section_forces
from .tractions import ContactReport, Tractions, contact_report, tractions

#: Change of a form's internal force at a reset, as a share of all forces, that is more than round-off.
_SAME_FORCE = 1e-9
_COLUMNS = ("stage", "increments", "iterations", "residual", "load", "state")


@dataclass(frozen=True)
class StageResult(files.StageData):
    """Equilibrium at the end of a stage, or of an increment.

    Attributes
    ----------
    name, time
        Name of the stage, and time at its end: the durations of all stages so far.
    x, load : ndarray, shape (N,)
        Displacements with the other degrees of freedom behind them, and external forces.
    forms, states, summary
        Forms by name as they are in the stage, their accepted states, and one line of text for each.
    iterations, residual, fraction
        Newton iterations of every increment, relative residual at the end, and share of the stage's load that was
        reached: 1 unless the analysis failed.
    increments
        Accepted increments that were kept, in their order.
    unreleased : ndarray, shape (N,), or None
        Forces of deactivated bodies that the load still holds, see ``Stage.release``.
    layout
        Numbers of the dofs of all fields.
    water
        Water at rest whose load is part of ``load``; a stage that follows keeps it.
    placed
        Displacements at which bodies were activated, (N,), by name: fields of displacements count from there.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(2).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> forms = {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.))}
    >>> bottom = basis.get_dofs("bottom")
    >>> stage = sc.Model(forms, bottom.all()).run([sc.Stage("weight", sc.weight(basis, 20.))])["weight"]
    >>> stage
    <StageResult 'weight', 100% of its load, 50 dofs, forms: block>
    >>> round(float(stage.reactions()[bottom.all("u^2")].sum()), 9)
    20.0
    >>> stage.section_forces("block", sc.Sections.line((.5, 0.), (.5, 1.), depth=1., n=3)).N.round(9).tolist()
    [-17.5, -10.0, -2.5]
    """

    def reactions(self) -> ndarray:
        """Return the forces of the supports, (N,): internal forces less the load; the residual where none is fixed."""
        return internal_force(self.forms, self.x, self.states) - self.load

    def tractions(self, pair: str) -> Tractions:
        """Return tractions, gaps and slips of a contact pair."""
        return tractions(*self._pair(pair))

    def report(self, pair: str) -> ContactReport:
        """Return resultants, status and penetration of a contact pair."""
        form, state = self._pair(pair)
        return contact_report(form, self.x[:form.size], state)

    def section_forces(self, body: str, sections: Sections | None = None) -> SectionForces:
        """Return normal force, shear force and moment at sections of a body, or at both ends of a beam's elements.

        Parameters
        ----------
        body
            Name of a :class:`~skfem_contact.Beam`, or of the solid that holds the body; it may hold other bodies.
        sections
            Cuts through a solid, :meth:`Sections.ring` or :meth:`Sections.line`; a beam needs none.

        Notes
        -----
        Between two lines of nodes forces are interpolated linearly; at the end of a body they are its last layer's.
        A curved body without layers of elements of length h has moments to ``N h**2 / 8 R``.
        """
        along = look_up(body, self.forms, f"form in stage '{self.name}'").line_forces(self.states[body])
        return SectionForces(*along) if along and not sections else section_forces(*self._solid(body), sections)

    def field(self, name: str, since: StageResult | None = None, *, water: fields.Water | None = None) -> ndarray:
        """Return a field at the nodes, shape (N / dim,), the mesh's vertices first; NaN at nodes of no solid.

        Stresses are recovered at the nodes of every region from its elements' forces and stresses
        (:doc:`theory </theory/recovery>`); invariants are theirs. A node between regions has the mean of their values.

        Parameters
        ----------
        name
            ``"ux"``, ``"uy"``, ``"u"`` (length of the displacement); stresses ``"sxx"``, ``"syy"``, ``"szz"``,
            ``"sxy"``; principal stresses ``"s1"`` >= ``"s2"`` >= ``"s3"``; ``"mean"``, ``"mises"``; strains ``"exx"``,
            ``"eyy"``, ``"exy"`` (engineering shear), ``"gamma"`` (largest shear strain, in the plane), ``"ev"``
            (volumetric); ``"plastic"``, the equivalent plastic strain (zero in elastic bodies); ``"mobilised"``, the
            share of the shear strength that is used; ``"pore"``, the excess pore pressure of :class:`PoreWater` or of
            undrained ground, and that of `water` with it. In three dimensions also ``"uz"``, ``"syz"``, ``"szx"``.
        since
            Earlier stage from which the change is returned; displacements of bodies that it does not hold count from
            their activation. Strains are those of the change; invariants of stresses are subtracted.
        water
            Given pore pressure: a :class:`~skfem_contact.water.Seepage`, or a function of coordinates such as
            :func:`hydrostatic`.
        """
        return fields.nodal_field(self, name, since, water)

    def pore_pressure(self, solid: str) -> ndarray:
        """Return the excess pore pressure of :class:`Undrained` soil at points, (n_elements, n_points), zero elsewhere.

        Compression is positive. The pressure of :func:`water_load`, which is part of the load, is not included.
        """
        return strength.pore_pressure(*self._solid(solid))

    def undrained_strength(self, solid: str) -> dict[str, ndarray]:
        r"""Return the undrained shear strength in plane strain that follows from the stresses in the ground.

        Without drainage and dilation the mean effective stress in the plane, :math:`s' = -(\sigma_1' + \sigma_3') / 2`,
        remains constant if the soil is elastic and isotropic before it yields. The strength is

        .. math:: s_u = c \cos\varphi + s' \sin\varphi .

        Stresses are effective where :func:`water_load` acts. Every region with `c` and `phi` has an array, shape
        (n_elements,): means of the points of each element, at least zero, to be the `c` of :class:`Tresca`.
        """
        return strength.undrained_strength(*self._solid(solid))

    def to_vtu(self, file: str | Path) -> None:
        """Write the solids, the contact and the beams to a ``.vtu`` file.

        Points have the ``displacement``, the recovered ``stress`` and ``strain`` (xx, yy, zz, xy, yz, xz; engineering
        shear) and the equivalent ``plastic_strain``. Regions share no points, so that no value is averaged between
        regions. Cells have means of ``stress`` and ``plastic_strain``, the number of the ``body``, in the order of
        :func:`~skfem_contact.mesh.join.bodies`, and of the ``region``, counted through the materials of all solids. The
        slave's facets of every contact pair are cells with ``pressure``, ``shear``, ``gap``, ``slip`` and ``status``.
        Quadratic elements stay quadratic. Elements of beams have points of their own with ``N``, ``V`` and ``M``.
        """
        export.grid(self).write(file, file_format="vtu")

    def to_pyvista(self) -> Any:
        """Return pyvista's ``UnstructuredGrid`` with the data of :meth:`to_vtu`."""
        import pyvista

        return pyvista.from_meshio(export.grid(self))

    def to_frame(self) -> Any:
        """Return fields at the nodes of solids as a pandas data frame; tractions: ``DataFrame(vars(tractions))``."""
        return export.frame(self)

    def contour(self, quantity: str, **options: Any) -> Any:
        """Draw a field, see :func:`~skfem_contact.plot.contour`."""
        from ..plot import contour

        return contour(self, quantity, **options)

    def _solid(self, name: str) -> tuple[Any, Any]:
        """Return a solid and its state."""
        return self._of(name, "SolidForm", {key: f for key, f in solids_of(self.forms).items() if f.materials})

    def _pair(self, name: str) -> tuple[Any, Any]:
        """Return a contact pair and its state."""
        return self._of(name, "ContactPair", pairs_of(self.forms))

    def _of(self, name: str, kind: str, there: Mapping[str, Any]) -> tuple[Any, Any]:
        """Return one of the forms of a kind, and its state."""
        form = look_up(name, self.forms, f"form in stage '{self.name}'")
        if name not in there:
            raise ValueError(f"'{name}' is a {type(form).__name__}, no {kind}; there are {list(there)}")
        return form, self.states[name]

    def __repr__(self) -> str:
        return (f"<StageResult '{self.name}', {self.fraction:.0%} of its load, {len(self.x)} dofs, "
                f"forms: {', '.join(self.states)}>")


@dataclass(frozen=True)
class Result:
    """Results of stages in their order; ``result["gravity"]`` is one of them, ``print(result)`` a table.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=.3))}
    >>> result = sc.Model(forms, basis.get_dofs("bottom").all()).run([sc.Stage("gravity", sc.weight(basis, 20.))])
    >>> print(result)
    stage            increments  iterations  residual  load    state
    gravity                   1           1   ...  100%
    >>> start = result.reset()["gravity"]
    >>> bool(start.x.any()), bool(start.states["ground"].stress.any())
    (False, True)
    """

    stages: tuple[StageResult, ...]

    def __getitem__(self, key: str | int) -> StageResult:
        if isinstance(key, int):
            return self.stages[key]
        if found := [stage for stage in self.stages if stage.name == key]:
            return found[0]
        raise KeyError(f"there is no stage '{key}'; existing: {[s.name for s in self.stages]}")

    def __iter__(self) -> Iterator[StageResult]:
        return iter(self.stages)

    def __len__(self) -> int:
        return len(self.stages)

    def __str__(self) -> str:
        return "\n".join("{:16} {:>10}  {:>10}  {:>8}  {:>4}    {}".format(*row) for row in (_COLUMNS, *self._rows()))

    __repr__ = __str__  # the arrays of all stages would fill a notebook

    def _repr_html_(self) -> str:
        return html_table(_COLUMNS, self._rows())

    def _rows(self) -> list[tuple[Any, ...]]:
        return [(s.name, len(s.iterations), sum(s.iterations), f"{s.residual:.1e}", f"{s.fraction:.0%}",
                 "; ".join(f"{k}: {v}" for k, v in s.summary.items() if v)) for s in self.stages]

    def envelope(self, body: str, sections: Sections | None = None) -> Envelope:
        """Return the extreme section forces at the ends of all stages that hold a body; increments do not count."""
        there = [stage for stage in self if body in stage.states] or self.stages[-1:]  # which names what is missing
        return Envelope.of({stage.name: stage.section_forces(body, sections) for stage in there})

    def save(self, file: str | Path) -> None:
        """Write all stages to one compressed file, from which :func:`load_result` resumes; it gets the end ``.npz``.

        A file of that name is replaced once the new one is complete.
        """
        files.write(file, self.stages)

    def to_pvd(self, file: str | Path) -> list[Path]:
        """Write a ``.pvd`` series for ParaView, and beside it a ``.vtu`` file for each stage or kept increment.

        ``"dig.pvd"`` has the parts ``dig_0.vtu``, ``dig_1.vtu``, ... Its time is that of the analysis where stages have
        a duration, otherwise a number. The names of the written files are returned, the series first.
        """
        return export.series(file, [part for stage in self for part in stage.increments or (stage,)])

    def reset(self) -> Result:
        """Return the result with displacements counted from its end on: they become zero, and all forces stay.

        Contact has followed the bodies and comes back with them: a stage of the same load finds equilibrium there.

        Raises
        ------
        ValueError
            A form without a ``rebased`` of its own changes its internal force.
        """
        last = self[-1]
        x = np.zeros_like(last.x)
        if last.layout is not None:
            x[last.layout.still] = last.x[last.layout.still]
        states = {name: form.rebased(last.x, last.states[name]) for name, form in last.forms.items()}
        scale = float(np.abs(last.load).max(initial=0.0))
        for name, form in last.forms.items():
            if getattr(form.rebased, "__func__", None) is not Form.rebased:
                continue  # the form has a rule of its own: contact follows the bodies
            before = form.assemble(last.x[:form.size], last.states[name]).force
            change = float(np.abs(form.assemble(x[:form.size], states[name]).force - before).max(initial=0.0))
            scale = max(scale, float(np.abs(before).max(initial=0.0)))
            if change > _SAME_FORCE * scale:
                raise ValueError(f"the force of '{name}' changes by {change:.3g} when displacements are reset: give it "
                                 "a method rebased(x, state) whose state has that force at zero displacements")
        return Result((*self.stages[:-1], replace(last, x=x, states=states, placed={})))


def load_result(file: str | Path, forms: Any) -> Result:
    """Read a saved result, or the increments that :class:`~skfem_contact.results.Append` has written.

    Parameters
    ----------
    file
        Name of the file, with or without the end ``.npz`` of :meth:`Result.save`.
    forms
        The model, or the forms of the analysis by the same names.

    Raises
    ------
    ValueError
        The file is no result or damaged, another version of this library wrote it, or it holds other forms or meshes.

    Examples
    --------
    >>> import os, tempfile
    >>> import skfem_contact as sc
    >>> file = os.path.join(tempfile.mkdtemp(), "empty.npz")
    >>> sc.results.Result(()).save(file)
    >>> len(sc.load_result(file, {}))
    0
    """
    return Result(files.read(file, forms, StageResult))


def of(model: Any, x: ndarray, states: Mapping[str, Any], *, load: ndarray | None = None) -> StageResult:
    """Return the result of a loop of one's own.

    Parameters
    ----------
    model
        The model, or its forms by name; those without a state are inactive.
    x : ndarray, shape (N,)
        Displacements.
    states
        States of the forms by name.
    load : ndarray, shape (N,), optional
        External forces, by default none.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> line = sc.rigid.line((-1., 0.), (2., 0.))
    >>> floor = sc.ContactPair(basis, "bottom", line, sc.Coulomb(mu=.3), "nodal", penalty=1e4)
    >>> x = basis.zeros()
    >>> x[basis.nodal_dofs[1]] = -1e-3
    >>> stage = sc.results.of({"floor": floor}, x, {"floor": floor.assemble(x, floor.initial_state()).state})
    >>> print(stage.report("floor"))
    contact of bottom on obstacle: 2 stick, 0 slip, 0 open
      pressure           10   resultant on the slave (0, 10)
      friction            0   resultant on the slave (0, 0)
      friction over pressure at most 0.000, penetration at most 0.10% of a segment
    """
    given = as_forms(getattr(model, "forms", model))
    forms = {name: look_up(name, given, "form") for name in states}
    for name, form in forms.items():
        if np.ndim(x) != 1 or len(x) < (form.size or 0):
            raise ValueError(f"displacements of '{name}' have shape {np.shape(x)}, not ({form.size or 'N'},)")
        if not form.fits(states[name]):
            raise ValueError(f"the state of '{name}' belongs to another form: {type(states[name]).__name__}")
    return StageResult("state", x, np.zeros_like(x) if load is None else load, states, (), 0.0, forms=forms,
                       layout=getattr(model, "layout", None))
