#!/usr/bin/env bash
# gmsh 4.15.2, ogs 6.5.9: clay and sand change places, by the option that is to keep physical groups.
#
# Expected: `GMSH2OGS` makes MaterialIDs of the physical groups, "clay" with the tag 20 and "sand" (two
#     surfaces) with the tag 10, in a file of version 2.2; with --gmsh2_physical_id, which its warning says
#     "must be used for a correct conversion from physical id to MaterialIDs", at any rate.
# Seen: without the option sand has the ID 0 and clay 1, by their tags in ascending order.  With it
#     clay has 0, and the two surfaces of sand have 1 and 2: these are the numbers of the surfaces in the
#     CAD model.  A group for the base, a line with the tag 5, takes the ID 0 and moves the soils to 1
#     and 2; with the option the line has the ID of clay, and there is no message.
# Meaning: properties are given to MaterialIDs in the project file, so that the soils swap their
#     permeability and strength, and do it again when a boundary gets a name.  Count the area of
#     each ID after the conversion.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    gmsh==4.15.2 ogs==6.5.9 numpy==2.4.6
cat > run.py <<'PY'
import subprocess

import gmsh

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
LEVELS = {"clay": (0.0, 1.0), "sand": (1.0, 3.0)}


def write(base):
    """Two soils, the upper one of two surfaces, and perhaps a group for the base."""
    gmsh.clear()
    occ = gmsh.model.occ
    layers = [occ.addRectangle(0, level, 0, 2, 1) for level in (0, 1, 2)]
    occ.fragment([(2, layers[0])], [(2, layer) for layer in layers[1:]])
    occ.synchronize()
    surfaces = [tag for _, tag in gmsh.model.getEntities(2)]
    heights = [occ.getCenterOfMass(2, tag)[1] for tag in surfaces]
    for name, number in (("clay", 20), ("sand", 10)):
        low, high = LEVELS[name]
        chosen = [tag for tag, height in zip(surfaces, heights) if low < height < high]
        gmsh.model.addPhysicalGroup(2, chosen, number, name=name)
    if base:
        curves = [tag for _, tag in gmsh.model.getEntities(1)]
        lowest = [tag for tag in curves if occ.getCenterOfMass(1, tag)[1] < 1e-9]
        gmsh.model.addPhysicalGroup(1, lowest, 5, name="base")
    gmsh.model.mesh.generate(2)
    gmsh.write("model.msh")


def materials(*options):
    """IDs of clay, sand and lines in the converted mesh (text format of OGS-5)."""
    subprocess.run(
        ["venv/bin/GMSH2OGS", "-i", "model.msh", "-o", "ogs.msh", *options],
        check=True, capture_output=True,
    )
    with open("ogs.msh") as file:
        words = [line.split() for line in file]
    starts = {line[0]: i for i, line in enumerate(words) if line and line[0][0] in "$#"}
    nodes = {row[0]: float(row[5]) for row in words[starts["$NODES"] + 2 : starts["$ELEMENTS"]]}
    found = {"clay": set(), "sand": set(), "line": set()}
    for row in words[starts["$ELEMENTS"] + 2 : starts["#STOP"]]:
        height = sum(nodes[node] for node in row[3:]) / len(row[3:])
        name = "line" if row[2] == "line" else "clay" if height < 1 else "sand"
        found[name].add(int(row[1]))
    return {name: sorted(numbers) for name, numbers in found.items()}


SEEN = {
    (False, False): {"clay": [1], "sand": [0], "line": []},
    (False, True): {"clay": [0], "sand": [1, 2], "line": []},
    (True, False): {"clay": [2], "sand": [1], "line": [0]},
    (True, True): {"clay": [0], "sand": [1, 2], "line": [0]},
}
for (base, option), seen in SEEN.items():
    write(base)
    found = materials(*(["--gmsh2_physical_id"] if option else []))
    print(f"base named: {base}, option: {option}: MaterialIDs {found}")
    assert found == seen
gmsh.finalize()
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
