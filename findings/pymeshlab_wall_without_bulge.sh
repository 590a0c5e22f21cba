#!/usr/bin/env bash
# pymeshlab 2025.7.post1: a wall that bulges by 50 mm is 50 mm off its plan, or 0 mm if the plan was loaded last.
#
# Expected: the Hausdorff distance between the surveyed wall and the planned one is the largest distance of the one
#     from the other, 50 mm where the wall bulges by 50 mm, whichever is sampled and whichever was loaded first.
# Seen: the plan has two triangles, the survey 10,201 vertices.  With the survey as `sampledmesh` and loaded last 50.0
#     mm at 10,201 points; with the plan loaded last 0.0 mm at 4 points.  With the plan as `sampledmesh` 0.0 mm at 4
#     points.  With `samplenum=10201` the survey has 50.0 mm in both orders.
# Meaning: the distance is taken in one direction, at vertices, and the default number of points is the one of the
#     mesh that was loaded last, not of the sampled one.  A coarse plan makes deformed walls and settled floors
#     perfect; mean and root mean square come from the same points.  The only hint is `n_samples` in the result.  Give
#     `samplenum`, sample the survey, and the faces of a coarse mesh.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pymeshlab==2025.7.post1 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import pymeshlab

SIDE, BULGE = 10.0, 0.05  # m
CENTRE, WIDTH = (5.5, 3.5), 0.5  # m


def wall(number, bulge):
    """Mesh of a wall with a number of squares along each side."""
    axis = np.linspace(0, SIDE, number + 1)
    x, y = (values.ravel() for values in np.meshgrid(axis, axis, indexing="ij"))
    z = bulge * np.exp(-((x - CENTRE[0]) ** 2 + (y - CENTRE[1]) ** 2) / (2 * WIDTH**2))
    nodes = np.arange(x.size).reshape(number + 1, number + 1)
    a, b, c, d = (part.ravel() for part in (nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]))
    triangles = np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return pymeshlab.Mesh(np.column_stack([x, y, z]), triangles)


def distance(meshes, sampled, target, **options):
    """Largest distance in m between two meshes, which are loaded in the given order, and the number of points."""
    loaded = pymeshlab.MeshSet()
    for mesh in meshes.values():
        loaded.add_mesh(mesh)
    order = list(meshes)
    result = loaded.get_hausdorff_distance(
        sampledmesh=order.index(sampled), targetmesh=order.index(target), **options
    )
    return result["max"], result["n_samples"]


meshes = {"plan": wall(1, 0.0), "survey": wall(100, BULGE)}
vertices = meshes["survey"].vertex_number()
for last in ("survey", "plan"):
    loaded = {name: meshes[name] for name in sorted(meshes, key=lambda name: name == last)}
    assert list(loaded)[-1] == last
    survey = distance(loaded, "survey", "plan")
    plan = distance(loaded, "plan", "survey")
    given = distance(loaded, "survey", "plan", samplenum=vertices)
    print(f"{last} loaded last: from the survey {1e3 * survey[0]:.1f} mm at {survey[1]} points, number given "
          f"{1e3 * given[0]:.1f} mm, from the plan {1e3 * plan[0]:.1f} mm at {plan[1]} points; right {1e3 * BULGE} mm")
    assert plan[0] < 1e-6 and plan[1] == 4
    assert abs(given[0] - BULGE) < 1e-6 and given[1] == vertices
    if last == "survey":
        assert survey == given
    else:
        assert survey[1] == 4 and survey[0] < 0.5 * BULGE
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
