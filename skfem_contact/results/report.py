"""Forces of the supports; resultants and status of a contact pair in a few lines."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy import ndarray

from ..contact import ContactPair, ContactState
from ..contact.laws import Status
from ..forms.base import carried
from ..stages.result import StageResult
from ..stages.setup import forms_there
from .tractions import check_state


def reactions(forms: Mapping[str, Any], step: StageResult) -> ndarray:
    """Forces that the supports exert on the bodies: what the bodies carry, less the load.

    Parameters
    ----------
    forms
        All forms of the analysis by name, with the materials and laws that they have in the stage.
    step
        A stage of its result.

    Returns
    -------
    ndarray
        Forces in the directions of the unknowns, (N,); at those that are not fixed the residual is left.

    Raises
    ------
    ValueError
        The stage holds forms that are not given.

    Examples
    --------
    The ground under a square bears its weight:

    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(2).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> forms = {"square": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=.3))}
    >>> bottom = basis.get_dofs("bottom")
    >>> result = sc.run(forms, [sc.Stage("weight", sc.weight(basis, 20.))], fixed=bottom.all())
    >>> round(float(sc.reactions(forms, result["weight"])[bottom.all("u^2")].sum()), 9)
    20.0
    """
    return carried(forms_there(step, forms), step.x, step.states) - step.load


@dataclass(frozen=True)
class ContactReport:
    """Sums over a contact pair; ``print`` shows it as text.

    Attributes
    ----------
    name
        Slave and master.
    normal, tangential
        Resultants of the contact pressure and of the friction on the slave, (dim,).
    pressure, friction
        Integrals of the pressure and of the magnitude of the friction over the surface.
    mobilised
        Largest friction over pressure of a point.
    penetration
        Largest penetration as a share of the slave's segment there.
    open, stick, slip
        Number of points of each status.
    """

    name: str
    normal: ndarray
    tangential: ndarray
    pressure: float
    friction: float
    mobilised: float
    penetration: float
    open: int
    stick: int
    slip: int

    @property
    def force(self) -> ndarray:
        """Resultant of all contact tractions on the slave, (dim,)."""
        return self.normal + self.tangential

    def __str__(self) -> str:
        lines = [f"contact of {self.name}: {self.stick} stick, {self.slip} slip, {self.open} open"]
        for what, total, vector in (("pressure", self.pressure, self.normal),
                                    ("friction", self.friction, self.tangential)):
            resultant = ", ".join(f"{part:.5g}" for part in vector)
            lines.append(f"  {what:8} {total:12.5g}   resultant on the slave ({resultant})")
        lines.append(f"  friction over pressure at most {self.mobilised:.3f}, "
                     f"penetration at most {self.penetration:.2%} of a segment")
        return "\n".join(lines)


def contact_report(pair: ContactPair, x: ndarray, state: ContactState) -> ContactReport:
    """Resultants, status and penetration of a contact pair.

    Parameters
    ----------
    pair
        The pair; it needs no penalty.
    x, state
        Displacements (N,) and the pair's state, as for ``pair.assemble``.

    Raises
    ------
    ValueError
        No contact pair, the state of another form, or displacements that are not those of the pair's basis.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> block = MeshQuad().refined(1).with_defaults()
    >>> mesh = sc.join_bodies({"lower": block, "upper": block.translated((0., 1.))})
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> pair = sc.ContactPair(basis, "upper:bottom", "lower:top", sc.Coulomb(mu=.3), "nodal", penalty=1e4)
    >>> x = basis.zeros()
    >>> x[basis.nodal_dofs[1, mesh.t[:, mesh.subdomains["upper"]]]] = -1e-3     # press the upper block down
    >>> print(sc.contact_report(pair, x, pair.assemble(x, pair.initial_state()).state))
    contact of upper:bottom on lower:top: 3 stick, 0 slip, 0 open
      pressure           10   resultant on the slave (0, 10)
      friction            0   resultant on the slave (0, 0)
      friction over pressure at most 0.000, penetration at most 0.20% of a segment
    """
    check_state(pair, state)
    if np.shape(x) != (pair.size,):
        raise ValueError(f"the displacements have shape {np.shape(x)}, not ({pair.size},)")
    closed = state.status != Status.OPEN
    weight = pair.share * pair.points(state).weight[closed]
    normal, friction = state.traction[0, closed], np.linalg.norm(state.traction[1:, closed], axis=0)
    resultants = _resultants(pair, x, state)
    counts = np.bincount(state.status, minlength=3)
    ratio = np.divide(friction, -normal, out=np.zeros(len(normal)), where=normal < 0)
    return ContactReport(
        name=f"{pair.slave.name} on {pair.master.name}",
        normal=resultants[0], tangential=resultants[1],
        pressure=-float(weight @ normal), friction=float(weight @ friction),
        mobilised=float(ratio.max(initial=0.0)), penetration=pair.penetration(state),
        open=int(counts[Status.OPEN]), stick=int(counts[Status.STICK]), slip=int(counts[Status.SLIP]))


def _resultants(pair: ContactPair, x: ndarray, state: ContactState) -> list[ndarray]:
    """Sums of the nodal forces on the slave from pressure and from friction, (dim,) each."""
    forces, normal = pair.tractions_at(x, state).forces, np.zeros_like(state.traction)
    normal[0] = state.traction[0]
    return [-(forces @ part.ravel())[pair.slave.dofs].sum(axis=0) + 0.0 for part in (normal, state.traction - normal)]
