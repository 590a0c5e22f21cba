#!/usr/bin/env bash
# scikit-fem 12.0.2: after a local refinement the support of a block holds nodes inside it, and clay turns to sand.
#
# Expected: `mesh.refined(elements)` of tetrahedra keeps named boundaries and subdomains, with their areas and volumes,
#     or drops the names with a message, as it does for triangles.
# Seen: a block of 2 m x 1 m x 1 m of clay and sand with the boundaries left, right and joint (1 m2 each).  Two elements
#     are refined.  Triangles: soils right, boundaries dropped with a message.  Tetrahedra: the clay has 0.875 m3, the
#     boundaries 1.067, 1.155 and 1.134 m2; 62 % of the facets of "left" are not at x = 0.  No message.  After a uniform
#     refinement the soils are right, and the boundaries are dropped with a message.
# Meaning: the names keep the old numbers of facets and elements, which belong to others in the new mesh.  Adaptive
#     analyses get supports and loads inside the ground, and parts of a layer have the wrong stiffness.
#     Define boundaries and soils anew from coordinates after each refinement, and print areas and volumes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    scikit-fem==12.0.2 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import logging

import numpy as np
from skfem import CellBasis, ElementTetP1, ElementTriP1, FacetBasis, Functional, MeshTet, MeshTri

messages = []
handler = logging.Handler()
handler.emit = lambda record: messages.append(record.getMessage())
logging.getLogger("skfem").addHandler(handler)
LINES = np.linspace(0, 2, 5), np.linspace(0, 1, 3), np.linspace(0, 1, 3)
PLANES = {"left": 0.0, "right": 2.0, "joint": 1.0}


def block(kind, dimensions):
    mesh = kind.init_tensor(*LINES[:dimensions])
    planes = {name: lambda x, at=at: x[0] == at for name, at in PLANES.items()}
    soils = {"clay": lambda x: x[0] < 1, "sand": lambda x: x[0] > 1}
    return mesh.with_boundaries(planes, boundaries_only=False).with_subdomains(soils)


def sizes(mesh, element):
    """Areas of the named boundaries and volumes of the soils."""
    one = Functional(lambda w: 1 + 0 * w.x[0])
    found = {}
    for name, part in (mesh.boundaries or {}).items():
        found[name] = one.assemble(FacetBasis(mesh, element, facets=part))
    for name, part in (mesh.subdomains or {}).items():
        found[name] = one.assemble(CellBasis(mesh, element, elements=part))
    return {name: round(float(size), 3) for name, size in found.items()}


for kind, dimensions, element in ((MeshTri, 2, ElementTriP1()), (MeshTet, 3, ElementTetP1())):
    mesh = block(kind, dimensions)
    assert set(sizes(mesh, element).values()) == {1.0}
    for name, elements in (("uniform", ()), ("local", (np.array([0, 1]),))):
        new = mesh.refined(*elements)
        found = sizes(new, element)
        print(f"{kind.__name__}, {name} refinement: {found}, messages {messages}")
        if kind is MeshTet and name == "local":
            assert found == {"left": 1.067, "right": 1.155, "joint": 1.134, "clay": 0.875, "sand": 1.0}
            assert not messages
            middles = new.p[:, new.facets[:, new.boundaries["left"]]].mean(axis=1)
            elsewhere = (np.abs(middles[0]) > 1e-9).mean()
            print(f"    share of the facets of left that are not at x = 0: {elsewhere:.2f}")
            assert elsewhere > 0.5
        else:
            assert set(found.values()) == {1.0} and len(messages) == (0 if "left" in found else 1)
        messages.clear()
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
