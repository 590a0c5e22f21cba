#!/usr/bin/env bash
# meshio 5.3.5, gmsh 4.15.2: a mesh that is written as .msh is not one of gmsh, and has no moduli.
#
# Expected: `mesh.write("soil.msh")` writes gmsh's format with the data of points and cells, as `meshio.read` reads
#     gmsh's .msh files.
# Seen: the file is one of Ansys (Fluent).  gmsh stops at line 1.  meshio reads it back with its six points and two
#     cells, without the modulus of the cells and the head of the points.  With `file_format="gmsh22"` both are
#     there, and gmsh reads it.  No message at writing.
# Meaning: a round trip by .msh in one's own scripts works and loses all materials and results, so that a default
#     takes their place.  Name the format in each call, and check that the data is there after reading.
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

points = np.array([[x, y, 0.0] for y in range(3) for x in range(2)])
soil = meshio.Mesh(
    points,
    [("quad", np.array([[0, 1, 3, 2], [2, 3, 5, 4]]))],
    cell_data={"young": [np.array([20.0, 50.0])]},
    point_data={"head": np.arange(6.0)},
)
for kind in (None, "gmsh22"):
    soil.write("soil.msh", file_format=kind)
    first = open("soil.msh", "rb").readline()[:40]
    back = meshio.read("soil.msh")
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    try:
        gmsh.open("soil.msh")
        words = f"{len(gmsh.model.mesh.getNodes()[0])} nodes"
    except Exception as error:
        words = str(error)
    gmsh.finalize()
    print(f"file_format={kind}: first line {first}, read by meshio: {len(back.points)} points, "
          f"{sorted(back.cell_data)} {sorted(back.point_data)}; by gmsh: {words}")
    fields = sorted(back.cell_data) + sorted(back.point_data)
    assert len(back.points) == 6 and len(back.get_cells_type("quad")) == 2
    if kind is None:
        assert not fields and first.startswith(b"(1 ") and "syntax error" in words
    else:
        assert {"young", "head"} <= set(fields) and words == "6 nodes"
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
