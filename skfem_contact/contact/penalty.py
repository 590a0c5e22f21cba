"""Default penalties from the stiffness and the size of the elements on both sides."""
from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.sparse import csr_matrix

from ..errors import AnalysisWarning
from ..forms.base import Form, as_forms
from ..surfaces.surface import Surface

if TYPE_CHECKING:
    from .pair import ContactPair

#: Penalty over the stiffness of the layers of elements beside the surfaces.  On the average over many loads
#: the nodal forces of a Hertz contact are closest to the exact ones at 6 to 12 (surface-to-surface rules, 10 and 20
#: elements in the half-width): softer ones blunt the contact, harder ones show more of the mesh and take more
#: iterations.  The penetration is about a sixth of the compression of those layers.
#: The tangential penalty is the same: half of it saves no iterations in partial slip, and blunts its reversal.
_RATIO = 6.0
#: A penalty that is larger than the stiffness by this factor leaves three digits of the penetration.
_HARDEST = 1e9


def choose_penalties(forms: Mapping[str, Any]) -> dict[str, Form]:
    """Give every contact pair without a penalty one that suits the bodies it joins.

    The stiffness of a surface is that of its nodes, each by itself, against pressure, per length of surface: about
    E/h.  Slave and master act in series, so the softer one decides.

    Parameters
    ----------
    forms
        Forms by name; the solids among them supply the stiffness.

    Warns
    -----
    AnalysisWarning
        A penalty of the user's is so hard that the penetration is lost in round-off.

    Returns
    -------
    dict
        The same forms, contact pairs with a penalty.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> block = MeshQuad().refined(1).with_defaults()
    >>> mesh = sc.join_bodies({"lower": block, "upper": block.translated((0., 1.))})
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> forms = choose_penalties({
    ...     "blocks": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=.3)),
    ...     "contact": sc.ContactPair(basis, "upper:bottom", "lower:top", sc.Coulomb(mu=.3))})
    >>> bool(1e3 < forms["contact"].penalty[0] < 1e5)        # some E/h
    True
    """
    given = as_forms(forms)
    return {name: form.completed(given) for name, form in given.items()}


def with_chosen_penalty(pair: ContactPair, forms: Mapping[str, Form]) -> ContactPair:
    """The pair with the stiffness of its surfaces, and with the default penalty where it has none."""
    bodies = [form for form in forms.values() if form.elastic_stiffness is not None]
    if not bodies:
        raise ValueError("there is no SolidForm among the forms: contact takes its stiffness from what it joins")
    if any(form.coordinates == "axisymmetric" for form in bodies) != pair.axisymmetric:
        raise ValueError(f"contact of '{pair.slave.name}' on '{pair.facets.name}' has axisymmetric="
                         f"{pair.axisymmetric}, unlike the solids: pass axisymmetric={not pair.axisymmetric} to "
                         "ContactPair")
    solids = [form.elastic_stiffness for form in bodies]
    # one value for the whole surface: a pressure that is uniform stays so, whatever the sizes of the elements
    stiffness = _per_length(pair.slave, solids, pair.axisymmetric)
    if not pair.facets.rigid:
        stiffness = 1.0 / (1.0 / stiffness + 1.0 / _per_length(pair.facets, solids, pair.axisymmetric))
    penalty = pair.penalty or (_RATIO * stiffness, _RATIO * stiffness)
    if pair.enforcement is None and max(penalty) > _HARDEST * stiffness:
        warnings.warn(f"contact of '{pair.slave.name}' on '{pair.facets.name}': the penalty, {max(penalty):.3g}, is "
                      f"{max(penalty) / stiffness:.0e} times the stiffness of the surfaces: round-off hides the "
                      "penetration; 1 to 1e3 times are enough", AnalysisWarning, stacklevel=4)
    return pair.with_penalty(*penalty, stiffness=stiffness)


def _per_length(surface: Surface, solids: Sequence[csr_matrix], axisymmetric: bool) -> float:
    """Largest stiffness against pressure per length, or area in space, among the facets of a surface: about E/h.

    That along the surface does not count: in thin elements it is larger by the square of their shape.
    """
    dim, m = surface.dim, len(surface.facets)
    middle = surface.at(np.arange(m), np.tile(surface.shape.centre, (m, 1)), surface.nodes)
    normal = middle.normal
    blocks = np.array([[sum(K[surface.dofs[:, i], surface.dofs[:, j]] for K in solids) for j in range(dim)]
                       for i in range(dim)]).reshape(dim, dim, -1)  # fmt: skip
    at_nodes = np.einsum("si,ijsk,sj->sk", normal, blocks[:, :, surface.facets], normal)
    intervals = int(surface.shape.exponents.max())  # between the nodes on a side
    stiffness = at_nodes.mean(axis=1) * (intervals / surface.size) ** (dim - 1)
    if axisymmetric:
        stiffness /= middle.x[0][:, 0]
    if not (stiffness > 0).all():
        raise ValueError(f"boundary '{surface.name}' belongs to no solid among the forms")
    return float(stiffness.max())
