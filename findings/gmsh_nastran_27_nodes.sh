#!/usr/bin/env bash
# gmsh 4.15.2: bulk data of Nastran (.bdf) with bricks of 27 nodes.
#
# Expected: a mesh of bricks of second order is written with CHEXA of 20 nodes, the most that the card
#     has, or is refused.
# Seen: CHEXA of 27 nodes over four lines, and sides as CQUAD9, a card that Nastran does not have; no
#     message.  The edges are in gmsh's own order.  A reader that takes the 20 nodes of the card gets
#     edges in the wrong places: a cube of 1 m with 8 bricks has no longer 1 m3.  After
#     Mesh.SecondOrderIncomplete = 1 the cards have 20 nodes in the right order.
# Meaning: set Mesh.SecondOrderIncomplete = 1 before setOrder(2), and compare the volume of what the
#     other program has read.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    gmsh==4.15.2 numpy==2.4.6
cat > run.py <<'PY'
import gmsh
import numpy as np

#: Corners of the edges of CHEXA, in the order of nodes 9 to 20.
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 5), (2, 6), (3, 7), (4, 5), (5, 6), (6, 7), (7, 4)]


def cards(path):
    """Points by number, names of cards, and the nodes of bricks."""
    points, names, bricks = {}, set(), []
    for line in open(path).read().splitlines():
        fields = [line[k : k + 8].strip() for k in range(0, 72, 8)]
        if fields[0] == "GRID":
            points[int(fields[1])] = [float(word) for word in fields[3:6]]
        elif fields[0].startswith("+"):
            if brick:
                bricks[-1] += [int(word) for word in fields[1:] if word]
        elif fields[0].startswith("C"):
            names.add(fields[0])
            brick = fields[0] == "CHEXA"
            if brick:
                bricks.append([int(word) for word in fields[3:] if word])
    return points, names, bricks


def away(points, bricks):
    """Largest distance of nodes 9 to 20 from the middles of their edges."""
    x = np.array([[points[node] for node in brick[:20]] for brick in bricks])
    middles = np.array([x[:, pair].mean(axis=1) for pair in map(list, EDGES)])
    return np.linalg.norm(x[:, 8:].transpose(1, 0, 2) - middles, axis=2).max()


gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
gmsh.model.occ.synchronize()
gmsh.model.addPhysicalGroup(3, [1], name="soil")
gmsh.model.addPhysicalGroup(2, [1], name="left")
for dim, curve in gmsh.model.getEntities(1):
    gmsh.model.mesh.setTransfiniteCurve(curve, 3)
for dim, surface in gmsh.model.getEntities(2):
    gmsh.model.mesh.setTransfiniteSurface(surface)
    gmsh.model.mesh.setRecombine(2, surface)
gmsh.model.mesh.setTransfiniteVolume(1)
gmsh.model.mesh.generate(3)
gmsh.model.mesh.setOrder(2)
gmsh.write("full.bdf")
points, names, bricks = cards("full.bdf")
assert {len(brick) for brick in bricks} == {27} and len(bricks) == 8
assert "CQUAD9" in names
assert away(points, bricks) > 0.2

gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
gmsh.model.mesh.setOrder(1)
gmsh.model.mesh.setOrder(2)
gmsh.write("edges.bdf")
points, names, bricks = cards("edges.bdf")
assert {len(brick) for brick in bricks} == {20}
assert "CQUAD8" in names
assert away(points, bricks) < 1e-6
gmsh.finalize()
print("27 nodes, and 20 with Mesh.SecondOrderIncomplete")
PY
venv/bin/python run.py
