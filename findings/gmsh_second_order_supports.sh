#!/usr/bin/env bash
# gmsh 4.15.2, meshio 5.3.5, scikit-fem 12.0.2: the supports vanish with the second order.
#
# Expected: the same model, meshed with second-order elements, has the same named curves and surfaces.
# Seen: the named surfaces (soils) are read and the named curve (base) is lost, in MSH 2.2 and 4.1.
#     `boundaries` is None; the log says that tags cannot be parsed.  With first-order elements
#     the curve is read, but in MSH 4.1 a subdomain "gmsh:bounding_entities" appears, whose
#     "elements" are the tags of curves of the geometry.
# Meaning: a change of order turns a supported model into one without supports or loads, and a loop
#     over `subdomains` that gives soils to elements overwrites a few arbitrary ones.  Ask for
#     the names you expect after every load, and find boundaries of second-order meshes by position.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    scikit-fem==12.0.2 numpy==2.4.6 scipy==1.17.1 meshio==5.3.5 gmsh==4.15.2
cat > run.py <<'PY'
import gmsh
from skfem import Mesh


def layers(version, order):
    """A section of sand under clay, with a named base, through a file."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    geometry = gmsh.model.occ
    sand = geometry.addRectangle(0, 0, 0, 10, 3)
    clay = geometry.addRectangle(0, 3, 0, 10, 3)
    geometry.fragment([(2, sand)], [(2, clay)])
    geometry.synchronize()
    base = gmsh.model.getEntitiesInBoundingBox(-1, -0.1, -1, 11, 0.1, 1, dim=1)
    gmsh.model.addPhysicalGroup(2, [sand], name="sand")
    gmsh.model.addPhysicalGroup(2, [clay], name="clay")
    gmsh.model.addPhysicalGroup(1, [tag for _, tag in base], name="base")
    gmsh.option.setNumber("Mesh.MeshSizeMax", 1)
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(order)
    gmsh.write("layers.msh")
    gmsh.finalize()
    return Mesh.load("layers.msh")


for version in (2.2, 4.1):
    first, second = layers(version, 1), layers(version, 2)
    for mesh in (first, second):
        sizes = {name: len(part) for name, part in mesh.subdomains.items()}
        print(version, type(mesh).__name__, "boundaries", list(mesh.boundaries or ()), sizes)
        assert sizes["sand"] + sizes["clay"] == mesh.nelements
    assert len(first.boundaries["base"]) == 10
    assert second.boundaries is None
    stray = first.subdomains.get("gmsh:bounding_entities")
    assert (stray is not None) == (version == 4.1)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
