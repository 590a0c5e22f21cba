"""Names of a section's mesh: bodies, interfaces with both sides, slits, outer boundaries."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np
from numpy import ndarray
from skfem import Mesh
from skfem.generic_utils import OrientedBoundary

from ..beams.lines import split_along
from ..checks import format_point
from ..mesh.join import join_bodies

Tags = dict[str, ndarray]
#: Names of the outer boundary.
OUTER = ("left", "right", "bottom", "surface")
#: Share of the section up to which a node lies on its left or right end.
_AT = 1e-9


def name_outside(mesh: Mesh, holes: Tags, area: ndarray) -> Tags:
    """Return the boundaries of a welded mesh: its outside by names, those of holes by theirs.

    Parts that lie apart from the largest one have their areas' names, such as ``"block:outside"``.
    """
    cut = np.concatenate([np.zeros(0, int), *holes.values()])
    loops = [
        loop
        for loop in _loops(mesh, np.flatnonzero(mesh.f2t[1] < 0))
        if not np.isin(loop[0], cut).all()
    ]
    size = [np.ptp(mesh.p[:, chain], axis=1).prod() for _, chain in loops]
    found, main = dict(holes), int(np.argmax(size))
    for k, (loop, chain) in enumerate(loops):
        x, y = mesh.p[:, chain]
        if (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() < 0.0:
            raise ValueError(
                f"the areas enclose a gap near {format_point(mesh.p[:, chain].mean(axis=1))}: "
                f"close it, "
                "or name it in holes="
            )
        parts = _sides(loop, x, y) if k == main else {f"{area[mesh.f2t[0, loop[0]]]}:outside": loop}
        for name, facets in parts.items():
            found[name] = np.append(found.get(name, np.zeros(0, int)), np.setdiff1d(facets, cut))
    return {name: np.unique(facets) for name, facets in found.items() if len(facets)}


def _loops(mesh: Mesh, free: ndarray) -> list[tuple[ndarray, ndarray]]:
    """Return closed chains of boundary facets, with their first nodes, the mesh on their left."""
    ends = mesh.facets[:, free]
    inner = mesh.p[:, mesh.t[:, mesh.f2t[0, free]]].mean(axis=1) - mesh.p[:, ends[0]]
    along = mesh.p[:, ends[1]] - mesh.p[:, ends[0]]
    start, stop = np.where(along[0] * inner[1] > along[1] * inner[0], ends, ends[::-1])
    way = np.where(start == ends[0], along, -along)
    turn = np.arctan2(way[1], way[0])
    after: dict[int, list[int]] = {}  # facets that begin at a node
    for k, node in enumerate(start.tolist()):
        after.setdefault(node, []).append(k)
    loops, left = [], set(range(len(free)))
    while left:
        chain = [k := min(left)]
        while True:  # where outlines meet in a point the chain stays beside the same outside
            there = [n for n in after[int(stop[k])] if n in left]
            k = there[int(np.argmin((turn[there] - turn[k] - np.pi) % (2.0 * np.pi)))]
            left.discard(k)
            if k == chain[0]:
                break
            chain.append(k)
        loops.append((free[chain], start[chain]))
    return loops


def _sides(loop: ndarray, x: ndarray, y: ndarray) -> Tags:
    """Return left, right, bottom and surface of an anticlockwise outline, given by the first nodes
    of its facets.
    """
    near = _AT * np.ptp(x)
    low, high = x < x.min() + near, x > x.max() - near
    left, right = low & np.roll(low, -1), high & np.roll(high, -1)
    begin = np.flatnonzero(low)[np.argmin(y[low])]
    end = np.flatnonzero(high)[np.argmin(y[high])]
    steps = (np.arange(len(loop)) - begin) % len(loop)
    bottom = (steps < (end - begin) % len(loop)) & ~left & ~right
    return dict(zip(OUTER, (loop[left], loop[right], loop[bottom], loop[~(left | right | bottom)])))


def separate(
    mesh: Mesh,
    bodies: Mapping[str, Collection[str]],
    slits: Collection[str],
    parts: Collection[str],
) -> Mesh:
    """Double the nodes round bodies and along slits, and name the interfaces of areas and parts,
    which are subdomains.

    Parts are the lifts and what remains, if there are lifts.
    """
    groups = [[name for name in mesh.subdomains if name not in parts], list(parts)]
    if len(bodies) > 1:
        mesh = join_bodies(mesh, bodies)
    for name in slits:
        mesh = split_along(mesh, name)
    boundaries = dict(mesh.boundaries or {})
    inside = np.flatnonzero(mesh.f2t[1] >= 0)
    for group in groups:
        labels = _labels(mesh, group)
        for name in slits:
            boundaries |= _sides_of_slit(boundaries, name, group, labels[mesh.f2t[0]])
        for side in (*OUTER, *(f"ground|{body}" for body in bodies)) if len(group) > 1 else ():
            boundaries |= _shares(boundaries, side, group, labels[mesh.f2t[0]])
        boundaries |= _interfaces(labels[mesh.f2t[:, inside]], inside, group)
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
    found: Tags = {}
    for a, b in np.unique(labels[:, (first != second) & (first >= 0) & (second >= 0)], axis=1).T:
        here, there = (first == a) & (second == b), (first == b) & (second == a)
        facets = np.concatenate((inside[here], inside[there]))
        side = np.repeat([0, 1], (here.sum(), there.sum()))
        found[f"{group[a]}|{group[b]}"] = OrientedBoundary(facets, side)
        found[f"{group[b]}|{group[a]}"] = OrientedBoundary(facets, 1 - side)
    return found


def _shares(boundaries: Tags, side: str, group: list[str], owner: ndarray) -> Tags:
    """Return the shares that the subdomains of a group have in an outer boundary, or in a side of
    the ground.
    """
    facets = np.asarray(boundaries.get(side, np.zeros(0, int)))
    body = side.removeprefix("ground|")
    names = {
        k: f"{name}:{side}" if body == side else f"{name}|{body}" for k, name in enumerate(group)
    }
    return {
        name: facets[owner[facets] == k] for k, name in names.items() if (owner[facets] == k).any()
    }


def _sides_of_slit(boundaries: Tags, name: str, group: list[str], owner: ndarray) -> Tags:
    """Return the shares in the sides of a slit: ``"lift|wall"``, and by side, ``"lift|wall|left"``,
    if it has two.
    """
    found = Tags()
    sides = [
        f"{name}|{side}"
        for side in ("left", "right", "below", "above")
        if f"{name}|{side}" in boundaries
    ]
    for k, part in enumerate(group):
        on = {
            side: facets[owner[facets] == k]
            for side in sides
            if (owner[facets := np.asarray(boundaries[side])] == k).any()
        }
        for side, facets in on.items():
            found[f"{part}|{name}" if len(on) == 1 else f"{part}|{side}"] = facets
    return found
