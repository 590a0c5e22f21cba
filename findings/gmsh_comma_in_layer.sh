#!/usr/bin/env bash
# gmsh 4.15.2, meshio 5.3.5: two layers become one where their names have a comma.
#
# Expected: physical groups "clay, stiff" and "clay, soft" are two element sets in an Abaqus deck, with
#     the comma quoted or replaced, as the blank is replaced by an underscore.
# Seen: the deck has the lines `*ELSET,ELSET=clay,_stiff` and `*ELSET,ELSET=clay,_soft`.  The name ends at
#     the comma, so both sets are called "clay", and the rest is an unknown parameter.  meshio reads
#     one set "clay" with the 4 m2 of the soft layer alone; the other 2 m2 belong to no named layer.
#     The same groups come back right from a file of Gmsh's own format.
# Meaning: a material that is given to "clay" goes to one of the layers, and a loop over all named layers
#     leaves a third of the ground without a material.  Names of layers that come from borehole logs
#     have commas: replace them before the deck is written.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    gmsh==4.15.2 meshio==5.3.5 numpy==2.4.6
cat > run.py <<'PY'
import gmsh
import meshio
import numpy as np

LAYERS = {"clay, stiff": (0.0, 1.0), "clay, soft": (1.0, 2.0)}


def areas(file):
    """Area of every named set of triangles in a file; sets that Gmsh names by numbers are left out."""
    mesh = meshio.read(file)
    found = {}
    for name, parts in mesh.cell_sets.items():
        if name.startswith(("Surface", "gmsh:")):
            continue
        found[name] = 0.0
        for block, part in zip(mesh.cells, parts):
            if block.type == "triangle" and part is not None:
                (ax, ay), (bx, by), (cx, cy) = mesh.points[block.data[part]].transpose(1, 2, 0)[:, :2]
                twice = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
                found[name] += 0.5 * float(np.abs(twice).sum())
    return found


gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ
tags = [occ.addRectangle(0, bottom, 0, 2, height) for bottom, height in LAYERS.values()]
occ.fragment([(2, tags[0])], [(2, tags[1])])
occ.synchronize()
for tag, name in zip(tags, LAYERS):
    gmsh.model.addPhysicalGroup(2, [tag], name=name)
gmsh.option.setNumber("Mesh.SaveGroupsOfElements", 1)
gmsh.model.mesh.generate(2)
for file in ("layers.msh", "layers.inp"):
    gmsh.write(file)
gmsh.finalize()

with open("layers.inp") as deck:
    print([line.strip() for line in deck if line.startswith("*ELSET")])
own, deck = areas("layers.msh"), areas("layers.inp")
print("layers.msh", own)
print("layers.inp", deck)
assert own.keys() == LAYERS.keys()
assert abs(own["clay, stiff"] - 2) < 1e-9 and abs(own["clay, soft"] - 4) < 1e-9
assert list(deck) == ["clay"] and abs(deck["clay"] - 4) < 1e-9
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
