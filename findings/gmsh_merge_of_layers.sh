#!/usr/bin/env bash
# gmsh 4.15.2: two layers with a mesh of their own become one soil when their files are merged.
#
# Expected: `gmsh.merge` of a mesh of clay and a mesh of sand keeps two surfaces and two groups with their elements,
#     as it keeps both sets of triangles.
# Seen: 162 triangles each.  With the numbers that gmsh gives to groups by default, all 324 triangles are clay if the
#     clay is read first, and sand if the sand is.  With the numbers 1 and 2 each group has all 324 triangles.
#     The same in the formats 2.2 and 4.1.  No message.
# Meaning: surfaces and groups of the second file are known by their number alone, and each drawing starts with 1. A
#     model that is put together from files of contractors or of stages has one soil, or two in the same place. Give
#     surfaces and groups numbers of their own in each drawing, and compare the areas of the groups.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    gmsh==4.15.2 numpy==2.4.6
cat > run.py <<'PY'
import gmsh

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)


def groups():
    """Number of elements of each group of triangles."""
    found = {}
    for dim, tag in gmsh.model.getPhysicalGroups(2):
        surfaces = set(gmsh.model.getEntitiesForPhysicalGroup(dim, tag).tolist())
        count = sum(len(gmsh.model.mesh.getElements(2, surface)[1][0]) for surface in surfaces)
        found[gmsh.model.getPhysicalName(dim, tag)] = count
    return found


def draw(name, level, number):
    """Write the mesh of one layer, with a group of its own number, or of the next free one."""
    gmsh.clear()
    layer = gmsh.model.occ.addRectangle(0, level, 0, 1, 1)
    gmsh.model.occ.synchronize()
    gmsh.model.addPhysicalGroup(2, [layer], number, name)
    gmsh.model.mesh.generate(2)
    for version in (2.2, 4.1):
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.write(f"{name}_{version}.msh")
    return groups()


for numbers in ((-1, -1), (1, 2)):
    alone = [draw("clay", 0, numbers[0]), draw("sand", 1, numbers[1])]
    assert alone == [{"clay": 162}, {"sand": 162}]
    print("numbers given" if 2 in numbers else "numbers by default", alone)
    for version in (2.2, 4.1):
        for order in (("clay", "sand"), ("sand", "clay")):
            gmsh.clear()
            gmsh.logger.start()
            for name in order:
                gmsh.merge(f"{name}_{version}.msh")
            words = [line for line in gmsh.logger.get() if line.startswith(("Warn", "Err"))]
            gmsh.logger.stop()
            total = sum(len(tags) for tags in gmsh.model.mesh.getElements(2)[1])
            seen = groups()
            print(f"  format {version}, {' then '.join(order)}: {total} triangles, {seen}, {words}")
            assert total == 324 and not words
            assert seen == dict.fromkeys(order if 2 in numbers else order[:1], 324)
gmsh.finalize()
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
