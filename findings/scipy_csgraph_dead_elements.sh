#!/usr/bin/env bash
# scipy 1.17.1: an excavated element still joins two bodies in `connected_components`.
#
# Expected: an entry of value zero is no edge of the graph, so that two chains of springs whose
#     connecting spring has lost its stiffness are two components.
# Seen: zeros that are stored in a sparse matrix count as edges: one component.  The same matrix as a
#     dense array has two, and so has the sparse one after `eliminate_zeros`.  `coo_array.tocsr`
#     keeps stored zeros, and also sums like 5 - 5.
# Meaning: stages of construction multiply the stiffness of dead elements by zero in a fixed pattern,
#     which the factor of the solver needs.  A search for bodies without supports then finds none,
#     and the direct solver meets a singular matrix.  Search in a copy without zeros.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

# Five nodes in a chain of springs.  The spring between nodes 1 and 2 is excavated.
first, second = np.arange(4), np.arange(1, 5)
stiffness = np.array([5.0, 0.0, 5.0, 5.0])
rows = np.r_[first, second, first, second]
columns = np.r_[first, second, second, first]
values = np.r_[stiffness, stiffness, -stiffness, -stiffness]
matrix = coo_array((values, (rows, columns))).tocsr()
clean = matrix.copy()
clean.eliminate_zeros()
sparse, dense, without = (
    connected_components(graph, directed=False)[0] for graph in (matrix, matrix.toarray(), clean)
)
print(f"{(matrix.data == 0).sum()} stored zeros; components: sparse {sparse}, dense {dense}, "
      f"sparse without zeros {without}")
assert (sparse, dense, without) == (1, 2, 2)

# The same with an element that is added and taken away again.
removed = coo_array((np.r_[values, 5.0, -5.0], (np.r_[rows, 1, 1], np.r_[columns, 2, 2]))).tocsr()
print(f"added and taken away: {connected_components(removed, directed=False)[0]} component")
assert connected_components(removed, directed=False)[0] == 1
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
