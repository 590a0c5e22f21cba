#!/usr/bin/env bash
# pyvista 0.49.1, VTK 9.7.2: a column under 30 kPa is turned, and its principal stress becomes a tension of 20 kPa.
#
# Expected: `rotate_z(90, transform_all_input_vectors=True)` turns displacements and stress tensors, and leaves
#     three principal stresses, which have no direction, alone; `reflect` likewise.
# Seen: the displacement is turned.  The tensor, with nine or six components, stays as it was: 30 kPa in x,
#     where the turned block has them in y.  The principal stresses (-10, -20, -30) become (20, -10, -30), and
#     (10, -20, -30) if the block is mirrored.  No message.
# Meaning: each array of three components is taken for a vector, and no array is a tensor.  In a section that is
#     turned to the map, or a half that is mirrored to the whole, stresses point in the directions of the old
#     axes, and compression is shown as tension.  Give principal stresses as three arrays; turn
#     tensors by hand.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pyvista==0.49.1 vtk==9.7.2 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
import pyvista as pv

block = pv.ImageData(dimensions=(2, 2, 2)).cast_to_unstructured_grid()
one = np.ones((block.n_points, 1))
stress = np.diag([-30.0, -10.0, 0.0])
block["displacement"] = one * [1.0, 0, 0]
block["principal"] = one * [-10.0, -20.0, -30.0]
block["tensor"] = one * stress.ravel()
block["voigt"] = one * [-30.0, -10.0, 0, 0, 0, 0]

turned = block.rotate_z(90, transform_all_input_vectors=True, inplace=False)
mirrored = block.reflect((1, 0, 0), transform_all_input_vectors=True, inplace=False)
for name, mesh in (("before", block), ("turned by 90 degrees", turned), ("mirrored in x", mirrored)):
    values = {key: np.round(mesh[key][0], 9) + 0.0 for key in block.array_names}
    print(name, *(f"\n    {key}: {value}" for key, value in values.items()))
    assert np.allclose(values["tensor"], stress.ravel())
    assert np.allclose(values["voigt"], block["voigt"][0])
    if mesh is turned:
        assert np.allclose(values["displacement"], [0, 1, 0])
        assert np.allclose(values["principal"], [20, -10, -30])
    if mesh is mirrored:
        assert np.allclose(values["displacement"], [-1, 0, 0])
        assert np.allclose(values["principal"], [10, -20, -30])

# The stress that a column turned by 90 degrees has, for comparison.
turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
print("right tensor after the turn", (turn @ stress @ turn.T).ravel() + 0.0)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
