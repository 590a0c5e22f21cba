#!/usr/bin/env bash
# pygimli 1.6.1: rain on a layer raises its head by finite elements, and by finite volumes not at all.
#
# Expected: `solveFiniteVolume` with a Neumann condition has the given slope of the head at that boundary,
#     as its documentation writes, and agrees with `solveFiniteElements`, which takes the same dictionary.
# Seen: a layer of 10 m with a head of 0 at its left end and a Neumann value of 3 at its right end.
#     Elements find a head of 30 m there, which is right; volumes find 0 everywhere.  With a head of 1 at
#     the left end elements find 31 m and volumes -0.05 m, lower than without inflow.  The value is
#     multiplied by the unknown head and added to the matrix, which is another condition: slope = 3 times
#     head.  A Robin condition is left out without a message: 0 in place of 1.67 m.  With given heads,
#     sources and two layers both agree.
# Meaning: recharge, wells on a border and flow through a face of an excavation disappear where the head
#     at the other end is zero, and change sign elsewhere.  Heads look smooth, and the balance of water
#     must be computed to see it.  Give an inflow as a source in the row of cells at the border, or use
#     elements.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pygimli==1.6.1 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
import pygimli as pg
from pygimli.solver import solveFiniteElements, solveFiniteVolume

layer = pg.createGrid(x=np.linspace(0, 10, 41), y=np.linspace(0, 1, 5))
nodes = np.array([node.pos()[0] for node in layer.nodes()])
centres = np.array([cell.center()[0] for cell in layer.cells()])


def heads(**given):
    """Head at the right end (marker 2) by elements and volumes, from a straight line through all values."""
    found = []
    for solve, places in ((solveFiniteElements, nodes), (solveFiniteVolume, centres)):
        values = np.array(solve(layer, a=1.0, **given))
        line = np.polyfit(places, values, 1)
        assert np.abs(np.polyval(line, places) - values).max() < 1e-6
        found.append(np.polyval(line, 10.0))
    return found


cases = {
    "heads of 0 and 5": ({"Dirichlet": {1: 0.0, 2: 5.0}}, 5.0, 5.0),
    "head of 0, inflow of 3": ({"Dirichlet": {1: 0.0}, "Neumann": {2: 3.0}}, 30.0, 0.0),
    "head of 1, inflow of 3": ({"Dirichlet": {1: 1.0}, "Neumann": {2: 3.0}}, 31.0, None),
    "head of 0, slope 0.5 (2 - head)": ({"Dirichlet": {1: 0.0}, "Robin": {2: [0.5, 2.0]}}, 10 / 6, 0.0),
}
for name, (conditions, right, seen) in cases.items():
    elements, volumes = heads(bc=conditions)
    print(f"{name}: right {right:.3f} m, elements {elements:.3f} m, volumes {volumes:.3f} m")
    assert abs(elements - right) < 1e-5
    if seen is None:
        assert -0.06 < volumes < -0.03
    else:
        assert abs(volumes - seen) < 1e-6
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
