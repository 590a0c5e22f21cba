#!/usr/bin/env bash
# meshio 5.3.5: triangles of Kratos are read as lines with a node in the middle.
#
# Expected: elements SmallDisplacementElement2D3N of an .mdpa file are triangles, and the sub-model
#     part "clay" with one of them is a set of cells.
# Seen: two cells "line3", whose third node is no middle, and no set of cells or points.  Kratos'
#     own names of geometries, Triangle2D3, are read as triangles; names of elements are not known to
#     the reader, which takes the number of nodes alone.
# Meaning: a model of a pit from Kratos has no area at all in the next program, and its soils have
#     no names.  Count kinds of cells and sum up areas after reading.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    meshio==5.3.5 numpy==2.4.6
cat > run.py <<'PY'
import meshio

TEXT = """Begin ModelPartData
End ModelPartData
Begin Properties 0
End Properties
Begin Nodes
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
End Nodes
Begin Elements {name}
1 0 1 2 3
2 0 1 3 4
End Elements
Begin SubModelPart clay
Begin SubModelPartNodes
1
2
3
End SubModelPartNodes
Begin SubModelPartElements
1
End SubModelPartElements
End SubModelPart
"""


def read(name):
    """The mesh of a file whose elements have this name."""
    with open("pit.mdpa", "w") as file:
        file.write(TEXT.format(name=name))
    return meshio.read("pit.mdpa")


mesh = read("SmallDisplacementElement2D3N")
print([(block.type, len(block.data)) for block in mesh.cells], mesh.cell_sets, mesh.point_sets)
assert [(block.type, len(block.data)) for block in mesh.cells] == [("line3", 2)]
assert not mesh.cell_sets and not mesh.point_sets
assert [block.type for block in read("Triangle2D3").cells] == ["triangle"]
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
