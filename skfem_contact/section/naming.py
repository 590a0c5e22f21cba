"""Names of a section's mesh: bodies, interfaces with both sides, slits, outer boundaries."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace

import numpy as np
from numpy import ndarray
from skfem import Mesh
from skfem.generic_utils import OrientedBoundary

from ..beams.lines import split_along
from ..checks import format_point
from ..layout import centroids
from ..mesh.join import join_bodies

Tags = dict[str, ndarray]
#: Names of the outer boundary.
OUTER = ("left", "right", "bottom", "surface")
#: Largest distance of a node from an end of the section on which it lies, as a share of the width.
_AT = 1e-9


def name_outside(mesh: Mesh, holes: Tags, area: ndarray) -> Tags:
    """Return the boundaries of a welded mesh: its outside by names, and its holes.

    Parts that lie apart from the largest one have their areas' names, such as ``"block:outside"``.
    """
    # Find the loops that are no sides of holes
    cut = np.concatenate([np.zeros(0, int), *holes.values()])
    loops = []
    sizes = []
    for facets, nodes in _loops(mesh, np.flatnonzero(mesh.f2t[1] < 0)):
        if not np.isin(facets, cut).all():
            loops.append((facets, nodes))
            sizes.append(np.ptp(mesh.p[:, nodes], axis=1).prod())
    largest = int(np.argmax(sizes))

    # Name them
    found = dict(holes)
    for k, (loop, nodes) in enumerate(loops):
        x, y = mesh.p[:, nodes]
        areas = x * np.roll(y, -1) - y * np.roll(x, -1)
        if areas.sum() < 0.0:
            raise ValueError(
                f"the areas enclose a gap near {format_point(mesh.p[:, nodes].mean(axis=1))}: "
                f"close it, or name it in holes="
            )
        if k == largest:
            parts = _sides(loop, x, y)
        else:
            parts = {f"{area[mesh.f2t[0, loop[0]]]}:outside": loop}
        for name, facets in parts.items():
            before = found.get(name, np.zeros(0, int))
            found[name] = np.append(before, np.setdiff1d(facets, cut))
    return {name: np.unique(facets) for name, facets in found.items() if len(facets)}


def _loops(mesh: Mesh, free: ndarray) -> list[tuple[ndarray, ndarray]]:
    """Return closed chains of boundary facets, with their first nodes, the mesh on their left."""
    # Turn the facets so that the mesh is on their left
    ends = mesh.facets[:, free]
    owner = mesh.f2t[0, free]
    centre = centroids(mesh, owner)
    inner = centre - mesh.p[:, ends[0]]
    along = mesh.p[:, ends[1]] - mesh.p[:, ends[0]]
    is_left = along[0] * inner[1] > along[1] * inner[0]
    start, stop = np.where(is_left, ends, ends[::-1])
    direction = np.where(start == ends[0], along, -along)
    angle = np.arctan2(direction[1], direction[0])
    begin_at: dict[int, list[int]] = {}
    for k, node in enumerate(start.tolist()):
        begin_at.setdefault(node, []).append(k)

    # Follow them; where outlines meet in a point the chain stays next to the same outside
    loops = []
    remaining = set(range(len(free)))
    while remaining:
        first = k = min(remaining)
        chain: list[int] = []
        while not chain or k != first:
            chain.append(k)
            following = [n for n in begin_at[int(stop[k])] if n in remaining]
            turns = (angle[following] - angle[k] - np.pi) % (2.0 * np.pi)
            k = following[int(np.argmin(turns))]
            remaining.discard(k)
        loops.append((free[chain], start[chain]))
    return loops


def _sides(loop: ndarray, x: ndarray, y: ndarray) -> Tags:
    """Return left, right, bottom and surface of an anticlockwise loop from its facets' nodes."""
    near = _AT * np.ptp(x)
    low = x < x.min() + near
    high = x > x.max() - near
    left = low & np.roll(low, -1)
    right = high & np.roll(high, -1)

    # The bottom lies between the lower ends of both sides, the surface between the upper ones
    begin = np.flatnonzero(low)[np.argmin(y[low])]
    end = np.flatnonzero(high)[np.argmin(y[high])]
    steps = (np.arange(len(loop)) - begin) % len(loop)
    bottom = (steps < (end - begin) % len(loop)) & ~left & ~right
    sides = left, right, bottom, ~(left | right | bottom)
    return {name: loop[side] for name, side in zip(OUTER, sides, strict=True)}


def separate(
    mesh: Mesh,
    bodies: Mapping[str, Collection[str]],
    slits: Collection[str],
    parts: Collection[str],
) -> Mesh:
    """Double the nodes round bodies and along slits, and name the interfaces of subdomains.

    Parts are the lifts and the remaining ground, if any; the other subdomains are areas.
    """
    areas = [name for name in mesh.subdomains if name not in parts]
    # Double the nodes.
    if len(bodies) > 1:
        mesh = join_bodies(mesh, bodies)
    for name in slits:
        mesh = split_along(mesh, name)
    boundaries = dict(mesh.boundaries or {})
    # Name the sides of areas, then of lifts.
    inside = np.flatnonzero(mesh.f2t[1] >= 0)
    sides = [*OUTER, *(f"ground|{body}" for body in bodies)]
    for group in (areas, list(parts)):
        labels = _labels(mesh, group)
        owners = labels[mesh.f2t[0]]
        for name in slits:
            boundaries |= _sides_of_slit(boundaries, name, group, owners)
        if len(group) > 1:
            for side in sides:
                boundaries |= _shares(boundaries, side, group, owners)
        boundaries |= _interfaces(labels[mesh.f2t[:, inside]], inside, group)
    # Part the surfaces of bodies into tops and sides.
    for body in bodies:
        boundaries |= _top_and_sides(mesh, boundaries, body)
    return replace(mesh, _boundaries=boundaries)


def _labels(mesh: Mesh, group: Collection[str]) -> ndarray:
    """Return the number of each element's subdomain in a group, -1 for none."""
    labels = np.full(mesh.nelements, -1)
    for k, name in enumerate(group):
        labels[mesh.subdomains[name]] = k
    return labels


def _interfaces(labels: ndarray, inside: ndarray, group: list[str]) -> Tags:
    """Return both sides of the interfaces, within bodies, between the subdomains of a group."""
    first, second = labels
    between = (first != second) & (first >= 0) & (second >= 0)
    result: Tags = {}
    for a, b in np.unique(labels[:, between], axis=1).T:
        forward = inside[(first == a) & (second == b)]
        backward = inside[(first == b) & (second == a)]
        facets = np.concatenate((forward, backward))
        side = np.repeat([0, 1], (len(forward), len(backward)))
        result[f"{group[a]}|{group[b]}"] = OrientedBoundary(facets, side)
        result[f"{group[b]}|{group[a]}"] = OrientedBoundary(facets, 1 - side)
    return result


def _shares(boundaries: Tags, side: str, group: list[str], owners: ndarray) -> Tags:
    """Return the shares of the subdomains in an outer boundary, or in a side of the ground."""
    facets = np.asarray(boundaries.get(side, np.zeros(0, int)))
    body = side.removeprefix("ground|")
    result: Tags = {}
    for name, part in _by_owner(facets, group, owners):
        result[f"{name}:{side}" if body == side else f"{name}|{body}"] = part
    return result


def _top_and_sides(mesh: Mesh, boundaries: Tags, body: str) -> Tags:
    """Return the facets of a body's surface that look upwards, its surface then, and the others."""
    facets = np.asarray(boundaries.get(f"{body}:surface", np.zeros(0, int)))
    first, last = mesh.p[:, mesh.facets[:2, facets]].transpose(1, 0, 2)
    corners = mesh.t[:3, mesh.f2t[0, facets]]
    inner = mesh.p[:, corners].mean(axis=1)
    along = last - first
    up = (0.5 * (first + last) - inner)[1] > 0.0
    upwards = up & (np.abs(along[1]) < np.abs(along[0]))
    if not upwards.any():
        return {}
    top = facets[upwards]
    found = {f"{body}:surface": top, f"{body}:top": top}
    if not upwards.all():
        found[f"{body}:sides"] = facets[~upwards]
    return found


def _sides_of_slit(boundaries: Tags, name: str, group: list[str], owners: ndarray) -> Tags:
    """Return the shares of subdomains in a slit: ``"lift|wall"``, or ``"lift|wall|left"``, ..."""
    shares: dict[str, Tags] = {}
    for end in ("left", "right", "below", "above"):
        side = f"{name}|{end}"
        facets = np.asarray(boundaries.get(side, np.zeros(0, int)))
        for part, share in _by_owner(facets, group, owners):
            shares.setdefault(part, {})[side] = share
    result: Tags = {}
    for part in group:
        sides = shares.get(part, {})
        for side, share in sides.items():
            result[f"{part}|{name}" if len(sides) == 1 else f"{part}|{side}"] = share
    return result


def _by_owner(facets: ndarray, group: list[str], owners: ndarray) -> Iterator[tuple[str, ndarray]]:
    """Yield the subdomains that have some of the facets, with their facets."""
    for k, name in enumerate(group):
        share = facets[owners[facets] == k]
        if len(share):
            yield name, share
