"""Degrees of freedom of an analysis: displacements of the basis first, then the fields that forms
bring.

The displacements of a node follow each other, component by component.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree
from skfem import CellBasis, Element, ElementHex1, ElementQuad1, ElementTetP1, ElementTriP1, Mesh

from .checks import finite, format_point, look_up

#: Linear elements by the numbers of dimensions and of corners.
_LINEAR = {(2, 3): ElementTriP1, (2, 4): ElementQuad1, (3, 4): ElementTetP1, (3, 8): ElementHex1}
#: A node lies at given coordinates if it is nearer than this share of the mesh.
_AT = 1e-6

#: Kinds of fields.
Kind = Literal["displacement", "rotation", "pressure", "multiplier"]


def different(n: int, *numbers: ndarray) -> ndarray:
    """Return the different ones of some numbers from 0 to n - 1, sorted, in a tenth of the time of
    ``np.unique``.
    """
    there = np.zeros(n, bool)
    for part in numbers:
        there[part] = True
    return np.flatnonzero(there)


def others(n: int, *numbers: ndarray) -> ndarray:
    """Return the numbers from 0 to n - 1 that are not among some, sorted."""
    away = np.ones(n, bool)
    for part in numbers:
        away[part] = False
    return np.flatnonzero(away)


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
        Dofs that are those of another field or of the basis: pairs of indices and of
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
        return others(self.n, *(at for at, _ in self.taken))

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
    """Numbers of all dofs of an analysis: the displacements of the basis, then the fields one
    behind the other.

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
        ends = np.cumsum([f.n for f in fields])
        return cls(
            tuple(fields),
            tuple(slice(int(end) - f.n, int(end)) for f, end in zip(fields, ends, strict=True)),
        )

    def numbers(self, fields: Iterable[Field]) -> Mapping[Field, ndarray]:
        """Return the dofs of some fields."""
        return {
            sought: self._with_taken(sought, np.arange(part.start, part.stop))
            for sought in fields
            for f, part in zip(self.fields, self.parts, strict=True)
            if _same(f, sought)
        }

    def _with_taken(self, field: Field, own: ndarray) -> ndarray:
        """Return the dofs of a field from those that are its own."""
        if not field.taken:
            return own
        found = np.empty(field.n, int)
        found[field.own] = own
        for at, other in field.taken:
            field_dofs = isinstance(other, FieldDofs)
            found[at] = (
                self.numbers([other.field])[other.field][other.indices] if field_dofs else other
            )
        return found

    def dofs(self, given: Any) -> ndarray:
        """Return dofs, sorted and each once, from numbers, :class:`FieldDofs`, or a list of
        both.
        """
        several = isinstance(given, list | tuple) and any(
            isinstance(p, FieldDofs) or np.ndim(p) for p in given
        )
        parts = given if several else [given]
        numbers = []
        for part in parts:
            if isinstance(part, FieldDofs):
                if not (known := self.numbers([part.field])):
                    raise ValueError(
                        f"fixed dofs belong to the field '{part.field.name}', which no form of the "
                        f"model "
                        "brings"
                    )
                part = known[part.field][part.indices]
            numbers.append(np.asarray(part).ravel())
            if len(numbers[-1]) and numbers[-1].dtype.kind not in "iu":
                raise ValueError(
                    "fixed must be dofs, integers such as basis.get_dofs('bottom').all(), those of "
                    "beams "
                    "as *beam.dofs((x, y))"
                )
        found = np.unique(np.concatenate(numbers).astype(int))
        if len(found) and (found[0] < 0 or found[-1] >= self.size):
            raise ValueError(f"fixed dofs must lie between 0 and {self.size - 1}")
        return found

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
        """Scales of all dofs, (N,); None where there are displacements only."""
        if len(self.fields) == 1:
            return None
        return np.concatenate([np.full(f.n, f.scale) for f in self.fields])

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

    def describe(self, dof: int) -> str:
        """Return the coordinates of a dof, and its field unless it is a displacement, for a
        message.
        """
        k = next(k for k, part in enumerate(self.parts) if dof < part.stop)
        what = f"the {self.fields[k].name} " if k else ""
        return f"{what}at {format_point(self.fields[k].coordinates[:, dof - self.parts[k].start])}"


def _same(a: Field, b: Field) -> bool:
    """Return True if two fields have the same dofs."""
    return a == b or bool(a.shared and a.shared == b.shared)


def nodes(basis: CellBasis) -> ndarray:
    """Return the nodes of all elements, (n_elements, n_nodes): corners, middles of edges and faces,
    centre.
    """
    dim = basis.mesh.dim()
    return np.asarray(basis.element_dofs[0::dim].T) // dim


def elements_of(basis: CellBasis) -> ndarray:
    """Return the numbers in the mesh of the elements of a basis, (n_elements,)."""
    return np.arange(basis.mesh.nelements) if basis.tind is None else np.asarray(basis.tind)


def linear_element(mesh: Mesh) -> Element:
    """Return the linear element of a mesh, straight or curved."""
    return _LINEAR[mesh.dim(), len(mesh.t)]()


def _first_components(basis: CellBasis, part: str | None) -> ndarray:
    """Return the dofs of the first component at all nodes, or at those of a subdomain."""
    elements = (
        slice(None) if part is None else look_up(part, basis.mesh.subdomains or {}, "subdomain")
    )
    return np.unique(basis.dofs.element_dofs[:: basis.mesh.dim(), elements])


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
    dim = basis.mesh.dim()
    x = np.atleast_2d(finite(coordinates, "coordinates"))
    if x.ndim != 2 or x.shape[1] != dim:
        raise ValueError(
            f"coordinates must be finite points of {dim} components, not {coordinates!r}"
        )
    numbers = _first_components(basis, part)
    tree, near = (
        cKDTree(basis.doflocs[:, numbers].T),
        _AT * float(np.ptp(basis.doflocs, axis=1).max()),
    )
    for point, found in zip(x, tree.query_ball_point(x, near)):
        if len(found) != 1:
            at = format_point(basis.doflocs[:, numbers[tree.query(point)[1]]])
            raise ValueError(
                f"there are {len(found)} nodes at {format_point(point)}"
                + (
                    "; say by `part` which body is meant"
                    if found
                    else f"; the nearest one is at {at}"
                )
            )
    return numbers[tree.query(x)[1]][:, None] + np.arange(dim)


def box_supports(
    basis: CellBasis, part: str | None = None, base: Literal["fixed", "rollers"] = "fixed"
) -> ndarray:
    """Return the dofs that the supports of a box of ground hold: its base, and its sides in normal
    direction.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh; the last axis is upright.
    part
        Subdomain whose lowest nodes are the base and whose outermost ones are the sides; by default
        the whole mesh.
    base
        ``"fixed"``: nothing moves there; ``"rollers"``: the base holds the upright direction only.

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
    near = _AT * float(np.ptp(basis.doflocs, axis=1).max())
    low, high = x.min(axis=1), x.max(axis=1)
    bottom = numbers[x[-1] < low[-1] + near]
    held = [bottom + (dim - 1)] if base == "rollers" else [bottom + c for c in range(dim)]
    held += [numbers[(x[c] < low[c] + near) | (x[c] > high[c] - near)] + c for c in range(dim - 1)]
    return np.unique(np.concatenate(held))


def rigid_modes(locations: ndarray, dofs: ndarray) -> ndarray:
    """Return small rigid motions of a body: translations, then rotations about its centre, scaled
    by its size.

    From the coordinates of all dofs, (dim, N), and the n dofs of the body: displacements, (n, 3),
    in space (n, 6).
    """
    x = locations[:, dofs]
    dim = len(x)
    component = np.eye(dim)[dofs % dim]
    centre = x.mean(axis=1, keepdims=True) if len(dofs) else 0.0
    arm = ((x - centre) / max(float(np.ptp(locations)), 1e-300)).T
    planes = [(i, j) for i in range(dim) for j in range(i + 1, dim)]
    turns = [component[:, j] * arm[:, i] - component[:, i] * arm[:, j] for i, j in planes]
    return np.column_stack((component, *turns))
