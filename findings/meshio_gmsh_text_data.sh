#!/usr/bin/env bash
# meshio 5.3.5, numpy 2.4.6, gmsh 4.15.2: data in gmsh's text files are written as Python objects, which nobody reads.
#
# Expected: `mesh.write("soil.msh", file_format="gmsh22", binary=False)` writes the head at points and the moduli of
#     cells as numbers, as the binary file of the same call has them.
# Seen: the lines of data are `1 np.float64(0.0)`.  No message at writing.  meshio cannot read its own file ("could not
#     be read to its end due to unmatched data"), nor can gmsh ("Could not read data in file").  So in the formats 2.2
#     and 4.1.  Binary files come back with all values.
# Meaning: with numpy 2 the readable file, kept as a record of parameters or heads, is lost for the analysis.  Write
#     binary files, or repair the lines with a text editor.
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
for kind in ("gmsh22", "gmsh"):
    for binary in (False, True):
        soil.write("soil.msh", file_format=kind, binary=binary)
        lines = [line for line in open("soil.msh", "rb").read().split(b"\n") if b"np." in line]
        try:
            back = meshio.read("soil.msh")
            by_meshio = [*back.cell_data["young"][0], *back.point_data["head"]]
        except ValueError as error:
            by_meshio = str(error)
        gmsh.initialize()
        gmsh.option.setNumber("General.Terminal", 0)
        try:
            gmsh.open("soil.msh")
            by_gmsh = [
                float(value)
                for tag in gmsh.view.getTags()
                for value in gmsh.view.getHomogeneousModelData(tag, 0)[2]
            ]
        except Exception as error:
            by_gmsh = str(error)
        gmsh.finalize()
        by_meshio = by_meshio if isinstance(by_meshio, str) else [float(v) for v in by_meshio]
        print(f"{kind}, binary={binary}: {len(lines)} lines such as {lines[:1]}; meshio: {by_meshio}; gmsh: {by_gmsh}")
        if binary:
            assert not lines
            assert sorted(by_meshio) == sorted(by_gmsh) == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 20.0, 50.0]
        else:
            assert len(lines) == 8 and lines[0] == b"1 np.float64(0.0)"
            assert "unmatched data" in by_meshio
            assert "Could not read data" in by_gmsh
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
