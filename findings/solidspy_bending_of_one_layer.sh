#!/usr/bin/env bash
# solidspy 1.1.0.post1: a beam of one layer of elements bends without stress, one of two layers with half of it.
#
# Expected: `strain_nodes` returns strains and stresses at the nodes: "the variable is extrapolated from the Gauss
#     point to nodes for each element", then averaged.  A strain that is linear over the height is exact.
# Seen: pure bending (u = x y, strain y, E = 1, height 1 m, quadrilaterals) of beams of 8 elements in length and 1,
#     2, 4 and 8 in height.  The stress at the lower edge is 0.000, -0.250, -0.375 and -0.438 at each inner node,
#     right is -0.500.  With one layer it is -0.289 at one end and +0.289 at the other.  A uniform strain is exact.
#     No message.
# Meaning: nothing is extrapolated: node i gets the value of Gauss point i, and the points are counted along y first,
#     the nodes around the element.  An inner node of an edge gets one value from each side of the neutral axis of
#     its elements, whose mean is the value at the centre.  Bending stresses of walls and linings are too small by
#     1 / n with n layers.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    solidspy==1.1.0.post1 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2
cat > run.py <<'PY'
import matplotlib

matplotlib.use("Agg")
import numpy as np
from solidspy.postprocesor import strain_nodes

LENGTH, PARTS = 8.0, 8
assert "extrapolated from the Gauss" in " ".join(strain_nodes.__doc__.split())


def beam(layers):
    """Nodes and counterclockwise quadrilaterals of a beam of height 1 around y = 0."""
    x, y = np.meshgrid(np.linspace(0, LENGTH, PARTS + 1), np.linspace(-0.5, 0.5, layers + 1))
    nodes = np.zeros((x.size, 5))
    nodes[:, 0], nodes[:, 1], nodes[:, 2] = np.arange(x.size), x.ravel(), y.ravel()
    first = (np.arange(layers)[:, None] * (PARTS + 1) + np.arange(PARTS)).ravel()
    corners = np.column_stack([first, first + 1, first + PARTS + 2, first + PARTS + 1])
    heading = np.column_stack([np.arange(first.size), np.full(first.size, 1), np.zeros(first.size, int)])
    return nodes, np.hstack([heading, corners])


material = np.array([[1.0, 0.0]])
for layers in (1, 2, 4, 8):
    nodes, elements = beam(layers)
    x, y = nodes[:, 1], nodes[:, 2]
    tension, _ = strain_nodes(nodes, elements, material, np.column_stack([x, 0 * x]))
    assert np.allclose(tension[:, 0], 1)
    _, stress = strain_nodes(nodes, elements, material, np.column_stack([x * y, -(x**2) / 2]))
    lower = stress[y == -0.5, 0]
    print(f"{layers} layers: stress of the lower edge {np.round(lower, 3)}, right -0.5")
    assert np.allclose(lower[1:-1], -0.5 + 0.5 / layers, atol=1e-6)
    if layers == 1:
        assert np.allclose(lower[[0, -1]], [-0.5 / np.sqrt(3), 0.5 / np.sqrt(3)])
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
