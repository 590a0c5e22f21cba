#!/usr/bin/env bash
# mmgpy 0.17.1: an embedded wall is gone after remeshing, with `opnbdy=True` as well.
#
# Expected: edges with a reference of their own inside one material, here a wall of 6 m that ends in the
#     soil, are kept by `remesh`, at the latest with `opnbdy=True` ("Preserve open boundaries").
# Seen: with and without the option the edges of the wall are missing after `remesh`, and the same mesh is
#     made, of 239 triangles, 14 of which lie on both sides of the wall.  With `set_required_edges` the
#     wall is there, twice: 12 m of edges with its reference, and the old fine division.  No message.
# Meaning: sheet piles, geotextiles, joints and drains in one layer of soil are edges.  The plate has no
#     nodes of the soil after the refinement, and a sum over the edges counts it twice.  Compare the
#     length of each reference before and after.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check mmgpy==0.17.1 numpy==2.4.6
cat > run.py <<'PY'
import mmgpy
import numpy as np

CELLS, WIDTH, FOOT, WALL = 50, 10.0, 20, 7
numbers = np.arange((CELLS + 1) ** 2, dtype=np.int32).reshape(CELLS + 1, -1)
steps = np.linspace(0, WIDTH, CELLS + 1)
x, y = np.meshgrid(steps, steps, indexing="ij")
a, b, c, d = (part.ravel() for part in (numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]))
line = numbers[CELLS // 2, FOOT:]
edges = np.column_stack([line[:-1], line[1:]])


def remesh(required=False, **options):
    """Length of the wall before and after, triangles, and how many of them cross the wall."""
    mesh = mmgpy.MmgMesh2D()
    mesh.set_mesh_size(vertices=x.size, triangles=2 * len(a), edges=len(edges))
    mesh.set_vertices(np.column_stack([x.ravel(), y.ravel()]))
    triangles = np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    mesh.set_triangles(triangles, np.ones(len(triangles), dtype=np.int64))
    mesh.set_edges(edges, np.full(len(edges), WALL, dtype=np.int64))
    if required:
        mesh.set_required_edges(np.arange(len(edges), dtype=np.int32))
    before = length(mesh)
    mesh.remesh(hmax=1.0, verbose=-1, **options)
    corners = mesh.get_vertices()[mesh.get_triangles()]
    aside, height = corners[:, :, 0] - WIDTH / 2, corners[:, :, 1]
    above = height.min(axis=1) > steps[FOOT] + 1e-6
    crossing = (aside.min(axis=1) < -1e-6) & (aside.max(axis=1) > 1e-6) & above
    return before, length(mesh), len(corners), int(crossing.sum())


def length(mesh):
    """Total length of the edges of the wall."""
    found, references = mesh.get_edges_with_refs()
    ends = mesh.get_vertices()[found[references == WALL]]
    return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum()


for name, options in (
    ("default", {}),
    ("opnbdy", {"opnbdy": True}),
    ("required edges", {"required": True}),
):
    before, after, triangles, crossing = remesh(**options)
    print(f"{name}: wall of {before:.1f} m before, {after:.1f} m after, "
          f"{crossing} of {triangles} triangles cross it")
    assert abs(before - 6) < 1e-9
    if name == "required edges":
        assert abs(after - 12) < 1e-9 and crossing == 0
    else:
        assert after == 0 and crossing > 5
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
