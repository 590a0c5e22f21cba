#!/usr/bin/env bash
# scikit-fem 12.0.2: after a search for duplicate nodes that finds none, a load on the top acts inside the block.
#
# Expected: `remove_duplicate_nodes` of a mesh without duplicate nodes returns the same mesh, with its named
#     boundaries.
# Seen: unit squares and cubes with the boundaries "left" and "top" and the subdomain "clay".  Nodes and elements are
#     the same ones in another order.  The boundary "top", all at height 1 before, has its centre at 0.40
#     (triangles), 0.59 (quadrilaterals), 0.51 (tetrahedra) and 0.56 (hexahedra); its measure is 1.21 and 1.39 in
#     place of 1 for triangles and tetrahedra.  75 to 100 % of its facets are inside.  Subdomains are right.  No
#     message.
# Meaning: nodes are sorted, and the names keep the numbers of the old facets.  A pressure on "top" becomes loads in
#     the ground, which add up to 140 % at worst.  Define boundaries after this call, or check their measures and
#     centres.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    scikit-fem==12.0.2 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import numpy as np
import skfem

BLOCKS = {
    "triangles": (skfem.MeshTri().refined(2), skfem.ElementTriP1()),
    "quadrilaterals": (skfem.MeshQuad().refined(2), skfem.ElementQuad1()),
    "tetrahedra": (skfem.MeshTet().refined(2), skfem.ElementTetP1()),
    "hexahedra": (skfem.MeshHex().refined(1), skfem.ElementHex1()),
}


def top_of(mesh, element):
    """Measure and mean height of the boundary, share of its facets inside, volume of the clay."""
    top = skfem.FacetBasis(mesh, element, facets="top")
    measure = skfem.Functional(lambda w: 1 + 0 * w.x[0]).assemble(top)
    height = skfem.Functional(lambda w: w.x[-1]).assemble(top) / measure
    inside = np.mean(mesh.f2t[1, mesh.boundaries["top"]] >= 0)
    clay = skfem.Basis(mesh, element, elements="clay")
    return measure, height, inside, skfem.Functional(lambda w: 1 + 0 * w.x[0]).assemble(clay)


for name, (mesh, element) in BLOCKS.items():
    mesh = mesh.with_boundaries({"left": lambda x: x[0] == 0, "top": lambda x: x[-1] == 1})
    mesh = mesh.with_subdomains({"clay": lambda x: x[0] < 0.5})
    assert np.unique(mesh.p, axis=1).shape == mesh.p.shape
    searched = mesh.remove_duplicate_nodes()
    assert searched.p.shape == mesh.p.shape and searched.t.shape == mesh.t.shape
    before, after = top_of(mesh, element), top_of(searched, element)
    print(f"{name}: measure, height, share inside and clay {np.round(before, 3)} -> {np.round(after, 3)}")
    assert np.allclose(before, [1, 1, 0, 0.5])
    assert after[1] < 0.7 and after[2] > 0.5 and abs(after[3] - 0.5) < 1e-9
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
