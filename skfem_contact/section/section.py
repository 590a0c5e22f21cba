"""Sections: named areas, lines and sizes, from which Gmsh makes a mesh with all names."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import CellBasis, Mesh

from ..checks import finite, look_up, names, positive, vector
from ..errors import warn
from ..forms.solid import SolidForm
from ..materials import Material
from .extrude import extruded
from .kernel import gmsh_model
from .meshing import REMAINING, Sizing, meshed
from .naming import OUTER
from .outline import Outline, outlines_of
from .pieces import Plan, cut_up

#: Shapes of areas: an outline, points (n, 2), or a list of either.
Shape = Any


@dataclass(frozen=True)
class Section:
    """A plane section of ground and structures from named areas, lines and sizes of elements.

    Outlines need not share points. Where they cross, touch or lie on each other they are cut.

    Parameters
    ----------
    areas
        Outlines by name: layers, fills, linings, footings. Each is a list of points (x, y), an
        :class:`Outline` such as :func:`circle`, or a list of several of them. Areas must not
        overlap, unless `replace` names the later one.
    size
        Size of elements.
    lifts
        Outlines by name of ground that stages dig or fill. They lie over the areas, and each may
        hold several of them.
    lines
        Points by name, or open outlines: walls, geogrids, drains, loaded strips of the surface.
    holes
        Outlines by name that are cut out: bores, the inside of pipes. Their boundaries have their
        names.
    surface
        Points of the surface, from the left to the right; all above it is cut off.
    replace
        Areas that replace the earlier ones below them; True for all.
    bodies
        Areas that share no nodes with the ground and with each other, and touch by contact alone.
    slits
        Lines along which the mesh is slit, such as walls whose sides slip.
    sizes
        Smaller sizes by names of areas, lifts, lines and holes.
    near
        Points and the sizes at them: ``[((0., -9.), .2)]``.
    coordinates
        ``"axisymmetric"`` for axial symmetry about x = 0.

    Raises
    ------
    ValueError
        Outlines that cross themselves, names that are not unique or do not exist, sizes that are
        not positive. Areas that overlap and lines outside of them are refused by name when the
        section is cut, by :attr:`parts` and :meth:`mesh`.
    ImportError
        Gmsh is missing: install the extra ``mesh``.

    See Also
    --------
    join_bodies, split_along : Meshes that were made otherwise.

    Examples
    --------
    A wall in two layers, with a pit on its left:

    >>> import skfem_contact as sc
    >>> box = sc.section.rectangle
    >>> layers = {"sand": box((-10, 20), (-4, 0)), "clay": box((-10, 20), (-15, -4))}
    >>> pit = sc.section.Section(
    ...     layers, size=3., lifts={"lift": box((-10, 0), (-5, 0))},
    ...     lines={"wall": [(0, 0), (0, -9)]}, slits=["wall"], sizes={"wall": 1.})
    >>> pit.parts
    {'remaining': ('sand', 'clay'), 'lift': ('sand', 'clay')}
    >>> mesh = pit.mesh()
    >>> [name for name in mesh.boundaries if "lift|" in name]
    ['lift|wall', 'lift|remaining']
    """

    areas: Mapping[str, Shape]
    size: float
    lifts: Mapping[str, Shape] = field(default_factory=dict)
    lines: Mapping[str, Shape] = field(default_factory=dict)
    holes: Mapping[str, Shape] = field(default_factory=dict)
    surface: ArrayLike | None = None
    replace: bool | str | Collection[str] = ()
    bodies: str | Collection[str] = ()
    slits: str | Collection[str] = ()
    sizes: Mapping[str, float] = field(default_factory=dict)
    near: Sequence[tuple[ArrayLike, float]] = ()
    coordinates: Literal["plane", "axisymmetric"] = "plane"

    def __post_init__(self) -> None:
        _check_names(self)
        object.__setattr__(self, "size", positive(self.size, "size"))
        for name, value in self.sizes.items():
            look_up(name, self.outlines, "area, lift, line or hole")
            positive(value, f"the size of '{name}'")
        for point, value in self.near:
            vector(point, 2, "a point of near")
            positive(value, "a size of near")
        if self.coordinates == "axisymmetric":
            for name, outlines in self.outlines.items():
                low = _corners(outlines)[:, 0].min()
                if low < 0.0:
                    raise ValueError(
                        f"'{name}' reaches to x = {low:.4g}: axisymmetric sections have x >= 0"
                    )
        self.plan  # noqa: B018 - refuses wrong outlines now

    @cached_property
    def outlines(self) -> dict[str, tuple[Outline, ...]]:
        """Checked outlines of all areas, lifts, holes and lines by name."""
        outlines = {}
        for name, shape in {**self.areas, **self.lifts, **self.holes, **self.lines}.items():
            outlines[name] = outlines_of(shape, name, closed=name not in self.lines)
        return outlines

    @cached_property
    def plan(self) -> Plan:
        """Outlines in the order in which they are cut."""
        # All areas but the first may replace others if it is asked for.
        replacing: Collection[str] | str = ()
        if self.replace is True:
            replacing = list(self.areas)[1:]
        elif self.replace:
            replacing = self.replace
        # Move the outlines to the origin.
        areas = self._of(self.areas)
        corners = np.vstack([outline.points for outline in chain(*areas.values())])
        return Plan(
            areas=areas,
            lifts=self._of(self.lifts),
            holes=self._of(self.holes),
            lines=self._of(self.lines),
            below=_below(self.surface, areas),
            replacing=frozenset(names(replacing, areas, "area")),
            bodies=frozenset(names(self.bodies, areas, "area")),
            shift=np.round(0.5 * (corners.min(axis=0) + corners.max(axis=0))),
        )

    def _of(self, group: Mapping[str, Shape]) -> dict[str, tuple[Outline, ...]]:
        """Return the checked outlines of a group."""
        return {name: self.outlines[name] for name in group}

    @cached_property
    def parts(self) -> dict[str, tuple[str, ...]]:
        """Areas of each part that stages and contact move by itself.

        Parts are the lifts, the bodies and the ground: ``"ground"``, or ``"remaining"`` in a
        section with lifts.
        """
        with gmsh_model() as gmsh:
            faces = cut_up(gmsh, self.plan).faces.values()
        held: dict[str, set[str]] = {}
        for area, lift in faces:
            held.setdefault(self._part(area, lift), set()).add(area)
        parts = {}
        for part in (self._ground, *self.lifts, *names(self.bodies, self.areas, "area")):
            if part in held:
                parts[part] = tuple(area for area in self.areas if area in held[part])
        return parts

    def mesh(self, order: Literal[1, 2] | None = None, scale: float = 1.0) -> Mesh:
        """Return the mesh of triangles with all names.

        Subdomains are the areas, the lifts, ``"ground"``, which is all but the bodies, and with
        lifts ``"remaining"``. Boundaries are:

        * ``"left"``, ``"right"``, ``"bottom"`` and ``"surface"``; ``"lift 1:surface"`` is the share
          of a lift or area. The share of a body is its upper side alone, ``"footing:surface"`` or
          ``"footing:top"``, and ``"footing:sides"`` is the rest;
        * lines and holes by their names; a hole between several bodies is ``"ring:bore"`` and
          ``"ground:bore"``;
        * ``"a|b"`` and ``"b|a"``, both sides of the interface between two areas, lifts or bodies;
        * ``"wall|left"`` and ``"wall|right"``, the sides of a slit, or ``"wall|below"`` and
          ``"wall|above"``. ``"lift 1|wall"`` is the share of a lift or area; if that lies on both
          sides, ``"remaining|wall|left"`` and ``"remaining|wall|right"``, see :meth:`sides`.

        Parameters
        ----------
        order
            2 for elements whose sides follow arcs; by default 2 with arcs, else 1. With order 1
            sides are chords.
        scale
            Factor of all sizes: .5 for elements of half the size.

        Raises
        ------
        ValueError
            Areas or lifts that overlap, lines or lifts outside of the areas, areas of which nothing
            is left, gaps between areas, outlines that nearly meet.

        Warns
        -----
        AnalysisWarning
            Triangles with an angle below 5 degrees, because outlines or lines meet at such an
            angle.
        """
        # Arcs need elements of second order.
        if order is None:
            order = 1
            for outline in chain(*self.outlines.values()):
                if outline.bulges.any():
                    order = 2
        # Move the points with sizes as the plan is moved.
        near = []
        for point, value in self.near:
            near.append((vector(point, 2, "near") - self.plan.shift, value))
        return meshed(
            self.plan,
            Sizing(self.size, self.sizes, near),
            names(self.slits, self.lines, "line"),
            order,
            positive(scale, "scale"),
        )

    def solids(
        self,
        basis: CellBasis,
        materials: Material | Mapping[str, Material],
        unit_weight: float | Mapping[str, float] | None = None,
        porous: bool = True,
    ) -> dict[str, SolidForm]:
        """Return a solid for each of the :attr:`parts`.

        Parameters
        ----------
        basis
            ``Basis`` of the section's mesh.
        materials, unit_weight
            One material and unit weight, or by area; 0 for areas without weight.
        porous
            As for :class:`~skfem_contact.SolidForm`.

        Raises
        ------
        ValueError
            An area without material, or a unit weight of an area that does not exist.

        Warns
        -----
        AnalysisWarning
            Unit weights by area lack an area, which is weightless.

        Examples
        --------
        >>> from skfem import Basis, ElementTriP2, ElementVector
        >>> import skfem_contact as sc
        >>> box = sc.section.rectangle
        >>> areas = {"clay": box((-4, 4), (-4, 0)), "footing": box((-1, 1), (0, 1))}
        >>> footing = sc.section.Section(areas, size=2., bodies="footing")
        >>> basis = Basis(footing.mesh(), ElementVector(ElementTriP2()), intorder=2)
        >>> soils = {"clay": sc.Tresca(1e4, .4, c=20.), "footing": sc.LinearElastic(3e7, .2)}
        >>> list(footing.solids(basis, soils, unit_weight=20.))
        ['ground', 'footing']
        """
        # Every area has a material; weights are reported where they lack.
        laws = self._by_area(materials)
        missing = [name for name in self.areas if name not in laws]
        if missing:
            raise ValueError(f"there is no material for the areas {missing}")
        weights = self._unit_weights(unit_weight)
        if self.coordinates == "plane":
            coordinates = None
        else:
            coordinates = self.coordinates
        # Make a solid for each part.
        forms = {}
        for part, areas in self.parts.items():
            weight = {area: weights[area] for area in weights if area in areas}
            forms[part] = SolidForm(
                basis.with_elements(part),
                {area: laws[area] for area in areas},
                coordinates=coordinates,
                unit_weight=weight or None,
                porous=porous,
            )
        return forms

    def _unit_weights(self, given: float | Mapping[str, float] | None) -> dict[str, float]:
        """Return the unit weights by area; report areas without one."""
        weights = self._by_area(given)
        for name in weights:
            look_up(name, self.areas, "area with a unit weight")
        weightless = [name for name in self.areas if name not in weights]
        if weightless:
            warn(f"{weightless} are weightless: name them too, with 0 if they are meant to be")
        return {name: weight for name, weight in weights.items() if weight is not None}

    def _by_area(self, value: Any) -> Mapping[str, Any]:
        """Return values by area from one value or a mapping."""
        if isinstance(value, Mapping):
            return value
        return dict.fromkeys(self.areas, value)

    def extruded(self, levels: ArrayLike, upright: bool = False, order: Literal[1, 2] = 1) -> Mesh:
        """Return the mesh of tetrahedra of a section that is extruded, with the names of its mesh.

        Parameters
        ----------
        levels
            Coordinates of the layers of elements, ascending, (n,).
        upright
            False: the section is upright, and is extruded along y; x remains, its heights become z,
            and the ends are the boundaries ``"front"`` and ``"back"``. True: the section is a plan,
            and is extruded along z; the ends are ``"base"`` and ``"top"``.
        order
            Order of the elements, see :meth:`mesh`.

        Examples
        --------
        >>> import skfem_contact as sc
        >>> wall = sc.section.Section({"wall": sc.section.rectangle((0, 1), (0, 2))}, size=1.)
        >>> mesh = wall.extruded([0, 1, 2])
        >>> type(mesh).__name__, sorted(mesh.boundaries)
        ('MeshTet1', ['back', 'bottom', 'front', 'left', 'right', 'surface'])
        """
        heights = finite(levels, "levels")
        if heights.ndim != 1 or len(heights) < 2 or (np.diff(heights) <= 0.0).any():
            raise ValueError(f"levels must be at least two ascending numbers, not {levels!r}")
        return extruded(self.mesh(order), heights, upright)

    def sides(self, line: str, mesh: Mesh) -> list[str]:
        """Return the boundaries on both sides of a slit: by lift, where lifts touch it.

        With ``wall.contact(basis, law, section.sides("wall", mesh))`` the contact of a lift can be
        deactivated with it.
        """
        look_up(line, dict.fromkeys(names(self.slits, self.lines, "line")), "slit")
        parts: set[str] = set()
        if self.lifts:
            parts = self.parts.keys() - self.plan.bodies
        by_part = []
        by_side = []
        for name in mesh.boundaries or {}:
            first, *others = name.split("|")
            if first == line:
                by_side.append(name)
            elif first in parts and others[:1] == [line]:
                by_part.append(name)
        return by_part or [name for name in by_side if name != line]

    def plot(self, file: str | Path | None = None, show: bool = False) -> Any:
        """Draw the section before it is meshed, see :func:`skfem_contact.plot.sketch`."""
        from ..plot import sketch

        return sketch(self, file, show)

    @property
    def _ground(self) -> str:
        if self.lifts:
            return REMAINING
        return "ground"

    def _part(self, area: str, lift: str) -> str:
        """Return the part to which a piece of an area belongs."""
        if area in self.plan.bodies:
            return area
        return lift or self._ground

    def __repr__(self) -> str:
        groups = {
            "areas": self.areas,
            "lifts": self.lifts,
            "lines": self.lines,
            "holes": self.holes,
        }
        listed = []
        for kind, group in groups.items():
            if group:
                listed.append(f"{kind}: {', '.join(group)}")
        return f"<Section {'; '.join(listed)}>"


def _check_names(section: Section) -> None:
    """Refuse names that are not unique, or that the mesh gives to other things."""
    # Check each name.
    given = [*section.areas, *section.lifts, *section.lines, *section.holes]
    if not section.areas:
        raise ValueError("a section needs at least one area")
    for name in given:
        if not isinstance(name, str) or not name.strip() or {"|", ":"} & set(name):
            raise ValueError(f"names are texts without '|' and ':', not {name!r}")
        if given.count(name) > 1:
            raise ValueError(f"the name '{name}' is not unique")
        if name in (*OUTER, REMAINING):
            raise ValueError(
                f"'{name}' is the name of a part of every mesh of a section: choose another one"
            )
    # Check the names that refer to others.
    bodies = names(section.bodies, section.areas, "area")
    soils = set(section.areas).difference(bodies)
    if "ground" in given and soils != {"ground"}:
        raise ValueError("'ground' is the name of all areas that are no bodies: choose another one")
    names(section.slits, section.lines, "line")


def _corners(outlines: Iterable[Outline]) -> ndarray:
    """Return the ends of all chords of outlines."""
    return np.vstack([np.vstack(outline.chords()[:2]) for outline in outlines])


def _below(surface: Any, areas: Mapping[str, tuple[Outline, ...]]) -> Outline | None:
    """Return the outline of the space below the surface."""
    if surface is None:
        return None
    # Check that the surface is simple and covers all areas.
    profile = Outline(surface, closed=False, name="surface")
    profile.check_simple("surface")
    corners = _corners(chain(*areas.values()))
    left, low = corners.min(axis=0)
    right = corners[:, 0].max()
    first, last = profile.points[[0, -1], 0]
    if first > left or last < right:
        raise ValueError(
            f"the surface reaches from x = {first:.4g} to {last:.4g}, the areas from {left:.4g} to "
            f"{right:.4g}: it must cover them, from the left to the right"
        )
    # Close it below everything.
    depth = min(low, profile.points[:, 1].min()) - 0.1 * (right - left)
    points = np.vstack((profile.points, [(last, depth), (first, depth)]))
    return Outline(points, closed=True, name="surface")
