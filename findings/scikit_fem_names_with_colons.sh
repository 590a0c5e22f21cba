#!/usr/bin/env bash
# scikit-fem 12.0.2, meshio 5.3.5: two sides of a pile become one, because their names have a colon.
#
# Expected: boundaries "pile:left" and "pile:right" of a mesh that is saved as .vtu and loaded again
#     are there with their facets.
# Seen: one boundary "pile" with the facets of "pile:right" alone.  The file has both names,
#     "skfem:b:pile:left"; the reader cuts them at their third colon, and the last one wins.  Names
#     with a bar come back.
# Meaning: a load on both sides acts on one of them, a contact of one side is on the other one, and
#     the equilibrium of what is left is perfect.  Compare names and numbers of facets after loading.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    scikit-fem==12.0.2 numpy==2.4.6 scipy==1.17.1 meshio==5.3.5
cat > run.py <<'PY'
import meshio
from skfem import Mesh, MeshQuad


def again(separator):
    """Numbers of facets by name, after a round trip, and the names of the data in the file."""
    sides = {f"pile{separator}left": lambda x: x[0] == 0, f"pile{separator}right": lambda x: x[0] == 1}
    MeshQuad().refined(2).with_boundaries(sides).save("pile.vtu")
    names = sorted(meshio.read("pile.vtu").cell_data)
    loaded = Mesh.load("pile.vtu")
    x = {name: loaded.p[0, loaded.facets[:, part]].mean() for name, part in loaded.boundaries.items()}
    return {name: len(part) for name, part in loaded.boundaries.items()}, x, names


counts, x, names = again(":")
print("with colons", counts, "at x =", x, "in the file", names)
assert counts == {"pile": 4} and x == {"pile": 1.0}
assert names == ["skfem:b:pile:left", "skfem:b:pile:right"]
counts, x, _ = again("|")
print("with bars", counts, "at x =", x)
assert counts == {"pile|left": 4, "pile|right": 4}
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
