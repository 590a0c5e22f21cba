"""A stage of an analysis."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from numpy import ndarray

from ..forms import Form


@dataclass(frozen=True)
class Stage:
    """A stage of the analysis.

    Parameters
    ----------
    name
        Its name in the result.
    load
        External forces at its end, (N,): the whole load, not the increment.
    prescribed
        Displacements at its end, (N,), of which the values at the fixed unknowns count.  By default they
        stay where they are.
    increments
        Number of increments to begin with; they are cut where Newton fails and grow where it is easy.
    activate
        Names of forms that become active; they are inactive before. Solids start stress-free in the deformed ground:
        nodes that they share with it are where it has brought them, the others follow. Contact starts without
        traction, with the gaps of the mesh; but where it replaces a pair between the same surfaces that is
        deactivated in this stage, it takes over its tractions.
    deactivate
        Names of forms that are taken away. What they carried is released in proportion over the stage.
    change
        Forms that are replaced from this stage on, with other materials (``form.with_materials``) or another law
        (``pair.with_law``). They go on from what the old ones carry.
    fixed
        Supported unknowns from this stage on; by default those of the stage before. Reactions that are lost are
        released in proportion over the stage.
    duration
        Time that the stage takes, for forms to which it matters (:meth:`Form.over`); load and prescribed displacements
        go from their last values to those of the stage in proportion to it. Beside :class:`PoreWater` increments are
        cut and grow with their estimated error in time, too.

    Notes
    -----
    Nodes of bodies that are not there stay where they are, and no load may act on them.

    Examples
    --------
    A column on which a layer is placed, and from which it is taken away again:

    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> mesh = MeshQuad().refined(1).with_defaults().with_subdomains({
    ...     "ground": lambda x: x[1] < .5, "fill": lambda x: x[1] > .5})
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> soil = sc.LinearElastic(E=1e3, nu=0.)
    >>> forms = {name: sc.SolidForm(basis.with_elements(name), soil) for name in ("ground", "fill")}
    >>> ground, both = sc.weight(basis, {"ground": 20.}), sc.weight(basis, 20.)
    >>> stages = [sc.Stage("ground", ground), sc.Stage("filled", both, activate="fill"),
    ...           sc.Stage("cleared", ground, deactivate="fill")]
    >>> result = sc.run(forms, stages, fixed=basis.get_dofs("bottom").all())
    >>> surface = basis.nodal_dofs[1, mesh.p[1] == .5]
    >>> [float(f"{stage.x[surface][0]:.6f}") for stage in result]
    [-0.0025, -0.0075, -0.0025]
    """

    name: str
    load: ndarray
    prescribed: ndarray | None = None
    increments: int = 1
    activate: str | Sequence[str] = ()
    deactivate: str | Sequence[str] = ()
    change: Mapping[str, Form] = field(default_factory=dict)
    fixed: ndarray | None = None
    duration: float = 0.0
