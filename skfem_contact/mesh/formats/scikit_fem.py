"""Names in files that scikit-fem saved: data of elements, "skfem:s:NAME" and "skfem:b:NAME"."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..content import Content, side_kind
from ..kinds import KINDS, Integers, from_vtk

_MARK = "skfem"


def add_encoded(content: Content, data: Mapping[str, Integers]) -> None:
    """Add the subdomains and boundaries of scikit-fem's data of elements.

    A subdomain is 1 in its elements.  Bit k of a boundary is set in elements whose side k belongs
    to it.  Names may have colons.
    """
    kinds = [kind for kind in content.cells if KINDS[kind].dim == content.dim]
    # Keys are marked by the package, then by the letter of their kind.
    for key, values in data.items():
        mark, _, rest = key.partition(":")
        letter, _, name = rest.partition(":")
        if mark != _MARK or letter not in ("s", "b") or len(kinds) != 1:
            continue
        kind = kinds[0]
        if len(values) != len(content.cells[kind]):
            raise ValueError(
                f"'{key}' has {len(values)} values for {len(content.cells[kind])} elements"
            )
        # Subdomains are masks, boundaries are numbers of sides by bits.
        if letter == "s":
            content.add(name, kind, np.flatnonzero(values))
        else:
            _add_boundary(content, name, kind, values)


def _add_boundary(content: Content, name: str, kind: str, values: Integers) -> None:
    """Add the sides that the bits of the values name, in scikit-fem's order of sides."""
    shape = KINDS[kind]
    refdom = shape.mesh.elem.refdom  # type: ignore[union-attr]
    corners = content.cells[kind][:, : shape.corners]
    if kind.startswith("hexahedron"):
        corners = corners[:, from_vtk(8)]
    parts = []
    for number, side in enumerate(refdom.facets):
        members = np.flatnonzero(values.astype(int) >> number & 1)
        parts.append(corners[members][:, list(side)])
    sides = np.concatenate(parts)
    content.add_sides(name, side_kind(sides.shape[1], shape.dim), sides)
