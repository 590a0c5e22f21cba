"""Degrees of freedom of an analysis: displacements of the basis, then the fields of forms.

The displacements of a node follow each other, component by component.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations
from typing import Any, Literal

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import CellBasis, Element, ElementHex1, ElementQuad1, ElementTetP1, ElementTriP1, Mesh

from .arrays import row_norms
from .checks import finite, format_point, look_up

#: Linear elements by the numbers of dimensions and of corners.
_LINEAR = {(2, 3): ElementTriP1, (2, 4): ElementQuad1, (3, 4): ElementTetP1, (3, 8): ElementHex1}
#: A node lies at given coordinates if it is nearer than this share of the mesh.
_AT = 1e-6

#: Kinds of fields.
Kind = Literal["displacement", "rotation", "pressure", "multiplier"]


def different(n: int, *numbers: ndarray) -> ndarray:
    """Return the different ones of some numbers from 0 to n - 1, sorted.

    It takes a tenth of the time of ``np.unique``.
    """
    chosen = np.zeros(n, bool)
    for part in numbers:
        chosen[part] = True
    return np.flatnonzero(chosen)


def others(n: int, *numbers: ndarray) -> ndarray:
    """Return the numbers from 0 to n - 1 that are not among some, sorted."""
    remaining = np.ones(n, bool)
    for part in numbers:
        remaining[part] = False
    return np.flatnonzero(remaining)


@dataclass(frozen=True, eq=False)
class Field:
    """Degrees of freedom of one kind that a form brings besides the displacements of the basis.

    Parameters
    ----------
    name
        Name for messages, such as ``"pore pressure"``. Residuals are measured field by field.
    coordinates : ndarray, shape (dim, n)
        Coordinates of the dofs, for the elimination order and for messages.
    kind
        Displacements and rotations become zero when displacements are reset; pressures and
        multipliers stay.
    scale
        Change of the dof that goes with a unit of displacement: E/h for a pressure, 1/h for a
        rotation. Linear systems are solved in scaled dofs: without the scale a direct solver leaves
        its elimination order.
    shared
        Name under which several forms share one field, such as the pore pressure of two parts of
        the ground.
    taken
        Dofs that belong to another field or to the basis: pairs of indices and of
        :class:`FieldDofs` or numbers.

    Notes
    -----
    The model numbers the dofs and hands the numbers to the form: see :meth:`Form.numbered`. A field
    is known by its identity, which :func:`dataclasses.replace` keeps.

    Examples
    --------
    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> sc.Field("rotation", np.zeros((2, 5)), kind="rotation", scale=2.).n
    5
    """

    name: str
    coordinates: ndarray
    kind: Kind = "displacement"
    scale: float = 1.0
    shared: str = ""
    taken: tuple[tuple[ndarray, Any], ...] = ()
    key: object = field(default_factory=object, repr=False)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Field) and other.key is self.key

    def __hash__(self) -> int:
        return hash(id(self.key))

    @property
    def n(self) -> int:
        """Number of dofs."""
        return int(self.coordinates.shape[1])

    @property
    def own(self) -> ndarray:
        """Indices of the dofs that are not taken."""
        return others(self.n, *(indices for indices, _ in self.taken))

    @property
    def moves(self) -> bool:
        """True if the dofs are motions."""
        return self.kind in ("displacement", "rotation")


@dataclass(frozen=True)
class FieldDofs:
    """Dofs of a field, which the model numbers: ``Model(forms, [supports, water.dofs("top")])``."""

    field: Field
    indices: ndarray


@dataclass(frozen=True, eq=False)
class Layout:
    """Numbers of all dofs: the displacements of the basis, then one field after the other.

    Attributes
    ----------
    fields
        The fields in the order of their numbers; the first one holds the displacements of the
        basis.
    parts
        Dofs of each field in a vector.
    """

    fields: tuple[Field, ...]
    parts: tuple[slice, ...]

    @classmethod
    def of(cls, displacements: ndarray, brought: Iterable[Field] = ()) -> Layout:
        """Give numbers to the fields after the displacements at their coordinates, (dim, N)."""
        # Fields that forms share are one.
        fields = [Field("displacement", displacements)]
        for new in brought:
            if new.taken:
                new = replace(new, coordinates=new.coordinates[:, new.own])
            twin = next((f for f in fields if _same(f, new)), None)
            if twin is None:
                fields.append(new)
            elif not np.array_equal(twin.coordinates, new.coordinates):
                raise ValueError(
                    f"two forms share the field '{new.shared}', but at other coordinates"
                )
        # Number the fields one after the other.
        parts = []
        start = 0
        for f in fields:
            parts.append(slice(start, start + f.n))
            start += f.n
        return cls(tuple(fields), tuple(parts))

    def numbers(self, fields: Iterable[Field]) -> Mapping[Field, ndarray]:
        """Return the dofs of some fields."""
        result = {}
        for sought in fields:
            for known, part in zip(self.fields, self.parts, strict=True):
                if _same(known, sought):
                    result[sought] = self._with_taken(sought, np.arange(part.start, part.stop))
        return result

    def _with_taken(self, field: Field, own: ndarray) -> ndarray:
        """Return all dofs of a field, given its own ones."""
        if not field.taken:
            return own
        result = np.empty(field.n, int)
        result[field.own] = own
        for indices, other in field.taken:
            if isinstance(other, FieldDofs):
                result[indices] = self.numbers([other.field])[other.field][other.indices]
            else:
                result[indices] = other
        return result

    def dofs(self, given: Any) -> ndarray:
        """Return dofs, sorted and each once, from numbers, :class:`FieldDofs`, or several."""
        several = isinstance(given, list | tuple) and any(map(_is_part, given))
        parts = given if several else [given]
        numbers = [self._numbers_of(part) for part in parts]
        dofs = np.unique(np.concatenate(numbers).astype(int))
        if len(dofs) and (dofs[0] < 0 or dofs[-1] >= self.size):
            raise ValueError(f"fixed dofs must lie between 0 and {self.size - 1}")
        return dofs

    def _numbers_of(self, part: Any) -> ndarray:
        """Return dofs from numbers, or from dofs of a field."""
        # Dofs of a field become numbers.
        if isinstance(part, FieldDofs):
            known = self.numbers([part.field])
            if not known:
                raise ValueError(
                    f"fixed dofs belong to the field '{part.field.name}', which no form of "
                    "the model brings"
                )
            part = known[part.field][part.indices]
        # Check that they are whole numbers.
        numbers = np.asarray(part).ravel()
        if len(numbers) and numbers.dtype.kind not in "iu":
            raise ValueError(
                "fixed must be dofs, integers such as basis.get_dofs('bottom').all(), those of "
                "beams as *beam.dofs((x, y))"
            )
        return numbers

    def moves_of(self, basis: CellBasis | None, nodes: Any) -> ndarray:
        """Return the displacements, (n, dim), of nodes by coordinates, or of nodes of a beam."""
        if isinstance(nodes, FieldDofs):
            return self._numbers_of(nodes).reshape(nodes.indices.shape)
        if isinstance(nodes, list | tuple) and any(isinstance(node, FieldDofs) for node in nodes):
            return np.concatenate([self.moves_of(basis, node) for node in nodes])
        if basis is None:
            raise ValueError(
                "nodes by coordinates are those of solids, and there is no solid: give nodes of "
                "beams as beam.at((x, y))"
            )
        return dofs_at(basis, nodes)

    @property
    def size(self) -> int:
        """Number of all dofs."""
        return self.parts[-1].stop

    @property
    def n_displacements(self) -> int:
        """Number of displacements of the basis."""
        return self.parts[0].stop

    @property
    def coordinates(self) -> ndarray:
        """Coordinates of all dofs, (dim, N)."""
        if len(self.fields) == 1:
            return self.fields[0].coordinates
        return np.concatenate([f.coordinates for f in self.fields], axis=1)

    @property
    def scale(self) -> ndarray | None:
        """Scales of all dofs, (N,); None for displacements only."""
        if len(self.fields) == 1:
            return None
        return np.concatenate([np.full(f.n, f.scale) for f in self.fields])

    @cached_property
    def scales(self) -> ndarray:
        """Scales of the fields, (n_fields,)."""
        return np.array([f.scale for f in self.fields])

    @cached_property
    def _filled(self) -> tuple[ndarray, ndarray]:
        """Numbers of the fields with dofs, and the first dofs of these."""
        starts = np.array([part.start for part in self.parts])
        filled = np.flatnonzero([part.stop > part.start for part in self.parts])
        return filled, starts[filled]

    def norms(self, values: ndarray) -> ndarray:
        """Return the norms of the fields' parts of a vector, (n_fields,)."""
        if len(self.fields) == 1:
            return np.array([np.linalg.norm(values)])
        norms = np.zeros(len(self.fields))
        filled, starts = self._filled
        norms[filled] = np.sqrt(np.add.reduceat(values * values, starts))
        return norms

    @property
    def still(self) -> ndarray:
        """Dofs that are no motions, such as pressures and multipliers."""
        return self._of([not f.moves for f in self.fields])

    @property
    def pressures(self) -> ndarray:
        """Dofs that are pressures of water."""
        return self._of([f.kind == "pressure" for f in self.fields])

    @property
    def displacements(self) -> ndarray:
        """Dofs that are lengths of motions: neither rotations nor pressures nor multipliers."""
        return self._of([f.kind == "displacement" for f in self.fields])

    def _of(self, chosen: Sequence[bool]) -> ndarray:
        """Return the dofs of chosen fields."""
        return np.flatnonzero(np.repeat(chosen, [f.n for f in self.fields]))

    def located(self, dof: int | None) -> str:
        """Return the end of a message on a dof, with its coordinates; nothing for None."""
        return "" if dof is None else f", {self.describe(dof)}"

    def describe(self, dof: int) -> str:
        """Return coordinates of a dof, and its field if it is no displacement, for a message."""
        k = next(k for k, part in enumerate(self.parts) if dof < part.stop)
        name = f"the {self.fields[k].name} " if k else ""
        coordinates = self.fields[k].coordinates[:, dof - self.parts[k].start]
        return f"{name}at {format_point(coordinates)}"


def _is_part(given: Any) -> bool:
    """Return True for dofs of a field, or several numbers."""
    return isinstance(given, FieldDofs) or np.ndim(given) > 0


def _same(a: Field, b: Field) -> bool:
    """Return True if two fields have the same dofs."""
    return a == b or bool(a.shared and a.shared == b.shared)


def nodes(basis: CellBasis) -> ndarray:
    """Return nodes, (n_elements, n_nodes): corners, middles of edges and faces, centre."""
    dim = basis.mesh.dim()
    return np.asarray(basis.element_dofs[0::dim].T) // dim


def elements_of(basis: CellBasis) -> ndarray:
    """Return the numbers in the mesh of the elements of a basis, (n_elements,)."""
    if basis.tind is None:
        return np.arange(basis.mesh.nelements)
    return np.asarray(basis.tind)


def elements_in(forms: Iterable[Any]) -> ndarray:
    """Return the elements of several bodies, one after the other."""
    return np.concatenate([np.zeros(0, int), *(form.elements for form in forms)])


def centroids(mesh: Mesh, elements: ndarray) -> ndarray:
    """Return the means of the corners of elements, (dim, n)."""
    return np.asarray(mesh.p[:, mesh.t[:, elements]].mean(axis=1))


def facet_corners(mesh: Mesh, facets: ndarray) -> ndarray:
    """Return the coordinates of the corners of facets, (dim, corners, n)."""
    return np.asarray(mesh.p[:, mesh.facets[:, facets]])


def facet_counts(mesh: Mesh, elements: ndarray) -> ndarray:
    """Return how many of some elements meet at each facet of a mesh, (n_facets,)."""
    return np.bincount(mesh.t2f[:, elements].ravel(), minlength=mesh.nfacets)


def linear_element(mesh: Mesh) -> Element:
    """Return the linear element of a mesh, straight or curved."""
    return _LINEAR[mesh.dim(), len(mesh.t)]()


def _first_components(basis: CellBasis, part: str | None) -> ndarray:
    """Return the dofs of the first component at all nodes, or at the nodes of a subdomain."""
    dofs = basis.dofs.element_dofs[:: basis.mesh.dim()]
    if part is not None:
        dofs = dofs[:, look_up(part, basis.mesh.subdomains or {}, "subdomain")]
    return np.unique(dofs)


def dofs_at(basis: CellBasis, coordinates: ArrayLike, part: str | None = None) -> ndarray:
    """Return the dofs of the nodes at given coordinates.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh.
    coordinates : array_like, shape (n, dim) or (dim,)
        Coordinates of the nodes.
    part
        Subdomain of the nodes, where bodies touch.

    Returns
    -------
    ndarray
        Dofs of the components.

    Raises
    ------
    ValueError
        No node or several nodes at given coordinates; coordinates that are not finite.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> sc.dofs_at(Basis(MeshQuad(), ElementVector(ElementQuad1())), (1., 0.)).tolist()
    [[2, 3]]
    """
    # Sort the nodes along x: those beside a point are neighbours in this order.
    dim = basis.mesh.dim()
    x = np.atleast_2d(finite(coordinates, "coordinates"))
    if x.ndim != 2 or x.shape[1] != dim:
        raise ValueError(
            f"coordinates must be finite points of {dim} components, not {coordinates!r}"
        )
    numbers = _first_components(basis, part)
    nodes = basis.doflocs[:, numbers]
    order = np.argsort(nodes[0])
    near = _near(basis)
    begins = np.searchsorted(nodes[0, order], x[:, 0] - near)
    ends = np.searchsorted(nodes[0, order], x[:, 0] + near, side="right")
    # Refuse points without a node, and with several.
    nearest: list[int] = []
    for point, begin, end in zip(x, begins, ends):
        beside = order[begin:end]
        found = beside[row_norms(nodes[:, beside].T - point) <= near]
        nearest.extend(found)
        if len(found) == 1:
            continue
        hint = "say by `part` which body is meant"
        if not len(found):
            node = np.argmin(row_norms(nodes.T - point))
            hint = f"the nearest one is at {format_point(nodes[:, node])}"
        raise ValueError(f"there are {len(found)} nodes at {format_point(point)}; {hint}")
    return numbers[np.array(nearest, int)][:, None] + np.arange(dim)


def _near(basis: CellBasis) -> float:
    """Return the distance below which a node lies at given coordinates."""
    return _AT * float(np.ptp(basis.doflocs, axis=1).max())


def box_supports(
    basis: CellBasis, part: str | None = None, base: Literal["fixed", "rollers"] = "fixed"
) -> ndarray:
    """Return the dofs that the supports of a box of ground hold.

    The supports hold the base, and the sides in normal direction.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh; the last axis is upright.
    part
        Subdomain whose lowest nodes are the base and whose outermost ones are the sides; by default
        the whole mesh.
    base
        ``"fixed"``: nothing moves; ``"rollers"``: the base holds the upright direction only.

    Returns
    -------
    ndarray
        Dofs, ascending.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(1), ElementVector(ElementQuad1()))
    >>> len(sc.box_supports(basis)), len(sc.box_supports(basis, base="rollers"))      # of 18 dofs
    (10, 9)
    """
    dim = basis.mesh.dim()
    numbers = _first_components(basis, part)
    x = basis.doflocs[:, numbers]
    near = _near(basis)
    low = x.min(axis=1)
    high = x.max(axis=1)
    bottom = numbers[x[-1] < low[-1] + near]
    fixed = [bottom + (dim - 1)]
    for c in range(dim - 1):
        on_side = (x[c] < low[c] + near) | (x[c] > high[c] - near)
        fixed.append(numbers[on_side] + c)
        if base == "fixed":
            fixed.append(bottom + c)
    return np.unique(np.concatenate(fixed))


def rigid_modes(locations: ndarray, dofs: ndarray) -> ndarray:
    """Return small rigid motions of a body, scaled by the size of the mesh, (n, 3) or (n, 6).

    They are translations, then rotations about its centre, from the coordinates of all dofs,
    (dim, N), and the n displacements of the body.
    """
    x = locations[:, dofs]
    dim = len(x)
    component = np.eye(dim)[dofs % dim]
    centre: ndarray | float = 0.0
    if len(dofs):
        centre = x.mean(axis=1, keepdims=True)
    size = max(float(np.ptp(locations)), 1e-300)
    arm = ((x - centre) / size).T
    modes = [component]
    for i, j in combinations(range(dim), 2):
        modes.append(component[:, [j]] * arm[:, [i]] - component[:, [i]] * arm[:, [j]])
    return np.hstack(modes)
