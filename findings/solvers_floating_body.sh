#!/usr/bin/env bash
# scipy 1.17.1 (SuperLU) and pypardiso 0.4.7: a body without supports is solved without a word.
#
# Expected: an exception or a warning from both, since the stiffness is singular (three rigid motions).
# Seen: neither.  A block loaded on its top alone gets displacements of more than 1e6 m, and the
#     residual is of the size of the load.  With equal and opposite loads the residual is 1e-14,
#     which no check of the residual finds, but the two solvers differ: the rigid motion is
#     arbitrary.
# Meaning: forgotten supports, or a structure that no joint or contact holds, need a check of their
#     own: count rigid motions, or compare the resultant of the reactions with the load.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    scikit-fem==12.0.2 numpy==2.4.6 scipy==1.17.1 pypardiso==0.4.7
cat > run.py <<'PY'
import warnings

import numpy as np
import pypardiso
from scipy.sparse.linalg import splu, spsolve
from skfem import Basis, ElementTriP2, ElementVector, FacetBasis, LinearForm, MeshTri, asm
from skfem.models.elasticity import lame_parameters, linear_elasticity

mesh = MeshTri.init_tensor(np.linspace(0, 10, 21), np.linspace(0, 5, 11))
mesh = mesh.with_boundaries({"base": lambda x: x[1] == 0, "top": lambda x: x[1] == 5})
basis = Basis(mesh, ElementVector(ElementTriP2()))
matrix = asm(linear_elasticity(*lame_parameters(1e7, 0.3)), basis)
press = LinearForm(lambda v, w: -1e4 * v[1])
down = asm(press, FacetBasis(mesh, basis.elem, facets="top"))
up = -asm(press, FacetBasis(mesh, basis.elem, facets="base"))

solvers = {
    "spsolve": lambda b: spsolve(matrix.tocsc(), b),
    "splu": lambda b: splu(matrix.tocsc()).solve(b),
    "pypardiso": lambda b: pypardiso.spsolve(matrix.tocsr(), b),
}
balanced = {}
with warnings.catch_warnings():
    warnings.simplefilter("error")
    for name, solve in solvers.items():
        u = solve(down)
        residual = np.linalg.norm(matrix @ u - down) / np.linalg.norm(down)
        print(f"{name}: top alone, displacement {abs(u).max():.1e} m, residual {residual:.1e}")
        assert abs(u).max() > 1e6 and residual > 1e-3
        u = balanced[name] = solve(down + up)
        residual = np.linalg.norm(matrix @ u - down - up) / np.linalg.norm(down)
        print(f"{name}: in balance, displacement {abs(u).max():.3e} m, residual {residual:.1e}")
        assert residual < 1e-9
difference = abs(balanced["spsolve"] - balanced["pypardiso"]).max()
print(f"difference of the solvers {difference:.1e} m")
assert difference > 1e-5
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
