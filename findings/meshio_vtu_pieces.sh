#!/usr/bin/env bash
# vtk 9.7.2, meshio 5.3.5: the last piece of a .vtu file is taken for the whole mesh.
#
# Expected: a block of 2 m x 1 m x 1 m that VTK writes in two pieces, as it does for large grids and
#     streamed data, has 80 tetrahedra and 2 m3 for every program that reads the file.
# Seen: VTK reads 80 tetrahedra and 2 m3; meshio reads 40 and 1 m3, those of the last piece.  There
#     is no message.
# Meaning: half of the ground is missing, and nothing looks wrong on a picture of the rest.  Compare
#     the volume of a mesh with that of the program that wrote it, or write one piece.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    vtk==9.7.2 meshio==5.3.5 numpy==2.4.6
cat > run.py <<'PY'
import meshio
import numpy as np
import vtk


def block():
    """Grid of a block of 2 m x 1 m x 1 m in 4 x 2 x 2 cubes, each of five tetrahedra."""
    box = vtk.vtkRectilinearGrid()
    box.SetDimensions(5, 3, 3)
    for name, n, size in (("X", 5, 2.0), ("Y", 3, 1.0), ("Z", 3, 1.0)):
        values = vtk.vtkDoubleArray()
        for value in np.linspace(0.0, size, n):
            values.InsertNextValue(value)
        getattr(box, f"Set{name}Coordinates")(values)
    cells = vtk.vtkDataSetTriangleFilter()
    cells.AddInputData(box)
    cells.Update()
    return cells.GetOutput()


def written(pieces):
    """Write the block in pieces; cells and volume by VTK and by meshio."""
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetFileName("block.vtu")
    parts = vtk.vtkExtractUnstructuredGridPiece()
    parts.SetInputData(block())
    parts.CreateGhostCellsOff()
    writer.SetInputConnection(parts.GetOutputPort())
    writer.SetDataModeToAscii()
    writer.SetNumberOfPieces(pieces)
    assert writer.Write() == 1
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName("block.vtu")
    reader.Update()
    by_vtk = reader.GetOutput().GetNumberOfCells()
    mesh = meshio.read("block.vtu")
    corners = mesh.points[np.concatenate([part.data for part in mesh.cells])]
    volume = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])).sum() / 6.0
    return by_vtk, len(corners), volume


for pieces, seen in ((1, (80, 80, 2.0)), (2, (80, 40, 1.0))):
    found = written(pieces)
    print(f"{pieces} pieces: VTK {found[0]} cells, meshio {found[1]} cells of {found[2]:.3f} m3")
    assert found[:2] == seen[:2] and abs(found[2] - seen[2]) < 1e-9
PY
venv/bin/python run.py
