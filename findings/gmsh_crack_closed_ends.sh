#!/usr/bin/env bash
# gmsh 4.15.2: a joint from one side of the rock to the other stays closed at both ends.
#
# Expected: the plugin Crack doubles all nodes of a joint that cuts a body in two, so that two
#     bodies result.
# Seen: the two nodes where the joint meets the outer boundary are not doubled: 16 nodes on a joint
#     of nine, one body.  The tips of a crack are kept closed, and the plugin takes every end for a
#     tip.  With the ends as a group in `OpenBoundaryPhysicalGroup` there are 18 nodes, and two
#     bodies.
# Meaning: contact, friction or flow on such a joint is carried by two welded nodes at its ends:
#     blocks do not slide, and the largest stresses are at the ends.  Count the connected bodies
#     after cutting.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    gmsh==4.15.2 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import gmsh
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components


def cut(open_ends):
    """Nodes on the joint y = 1 of a square block of 2 m, before and after, and connected bodies."""
    gmsh.clear()
    model, occ = gmsh.model, gmsh.model.occ
    block = occ.addRectangle(0, 0, 0, 2, 2)
    line = occ.addLine(occ.addPoint(0, 1, 0), occ.addPoint(2, 1, 0))
    occ.fragment([(2, block)], [(1, line)])
    occ.synchronize()
    joint = [c for _, c in model.getEntities(1) if abs(occ.getCenterOfMass(1, c)[1] - 1) < 1e-9]
    ends = [p for _, p in model.getEntities(0) if abs(model.getValue(0, p, [])[1] - 1) < 1e-9]
    assert len(joint) == 1 and len(ends) == 2
    model.addPhysicalGroup(1, joint, 11)
    model.addPhysicalGroup(0, ends, 12)
    model.addPhysicalGroup(2, [s for _, s in model.getEntities(2)], 13)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.4)
    model.mesh.generate(2)
    before = count()[0]
    gmsh.plugin.setNumber("Crack", "Dimension", 1)
    gmsh.plugin.setNumber("Crack", "PhysicalGroup", 11)
    gmsh.plugin.setNumber("Crack", "OpenBoundaryPhysicalGroup", 12 if open_ends else 0)
    gmsh.plugin.run("Crack")
    return (before, *count())


def count():
    """Nodes on the joint, and bodies that triangles connect."""
    tags, points, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    on_joint = abs(points.reshape(-1, 3)[:, 1] - 1) < 1e-9
    triangles = np.hstack(gmsh.model.mesh.getElements(2)[2]).reshape(-1, 3)
    nodes = order[np.searchsorted(tags[order], triangles)]
    links = np.vstack([nodes[:, :2], nodes[:, 1:]]).T
    graph = coo_array((np.ones(links.shape[1]), links), shape=(len(tags), len(tags)))
    labels = connected_components(graph, directed=False)[1]
    return int(on_joint.sum()), len(np.unique(labels[nodes]))


gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
closed, opened = cut(False), cut(True)
gmsh.finalize()
print("nodes on the joint before and after, bodies:", closed, "with open ends:", opened)
assert closed[1] == 2 * closed[0] - 2 and closed[2] == 1
assert opened[1] == 2 * opened[0] and opened[2] == 2
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
