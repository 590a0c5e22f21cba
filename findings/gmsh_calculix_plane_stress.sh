#!/usr/bin/env bash
# gmsh 4.15.2 and CalculiX 2.20: a section of soil becomes a sheet in plane stress.
#
# Expected: a plane mesh that gmsh writes for Abaqus and CalculiX (.inp) has elements of plane strain,
#     or no assumption on the third direction.
# Seen: triangles are CPS3 and CPS6, quadrilaterals CPS4.  A layer of 1 m between smooth walls
#     (E = 10 MPa, Poisson's ratio 0.49) under its weight of 20 kN/m3 settles 0.76 mm; with CPE6 in
#     place of CPS6 the same file gives the right 0.058 mm.
# Meaning: the soil can expand out of the section, without a message, and the error grows with
#     Poisson's ratio: 1.3 at 0.33, 13 at 0.49.  Replace the type in the file.
#     Boundaries of the mesh arrive as bars (T3D2, T3D3) if their groups are saved.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
if [[ "$(ccx -v 2>&1 || true)" != *2.20* ]]; then
    echo 'needs CalculiX 2.20: apt-get install calculix-ccx'
    exit 1
fi
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    gmsh==4.15.2 numpy==2.4.6
cat > run.py <<'PY'
import subprocess


def run(name, text):
    """Run CalculiX.  Return its log and the text of the printed results."""
    with open(name + ".inp", "w") as file:
        file.write(text)
    log = subprocess.run(["ccx", name], capture_output=True, text=True, check=True).stdout
    assert "Job finished" in log
    with open(name + ".dat") as file:
        return log, file.read()


def rows(text, columns):
    """Rows of numbers that have as many columns."""
    found = []
    for line in text.splitlines():
        words = line.split()
        if len(words) == columns and all(w[-1].isdigit() for w in words):
            found.append([float(w) for w in words])
    return found


import gmsh

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
surface = gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
gmsh.model.occ.synchronize()
gmsh.model.addPhysicalGroup(2, [surface], name="soil")
gmsh.option.setNumber("Mesh.MeshSizeMax", 0.3)
gmsh.model.mesh.generate(2)
gmsh.model.mesh.setOrder(2)
gmsh.write("layer.inp")
tags, coordinates, _ = gmsh.model.mesh.getNodes()
nodes = dict(zip(tags, coordinates.reshape(-1, 3)))
gmsh.model.addPhysicalGroup(1, [1], name="base")
gmsh.write("with_boundary.inp")
gmsh.finalize()


def node_set(name, chosen):
    return f"*NSET,NSET={name}\n" + "".join(f"{tag},\n" for tag, x in nodes.items() if chosen(x))


with open("layer.inp") as file:
    written = file.read()
with open("with_boundary.inp") as file:
    assert "type=T3D3" in file.read()
assert "type=CPS6" in written and "CPE" not in written
model = (
    node_set("BASE", lambda x: x[1] < 1e-9)
    + node_set("TOP", lambda x: x[1] > 1 - 1e-9)
    + node_set("SIDES", lambda x: min(x[0], 1 - x[0]) < 1e-9)
    + """*MATERIAL,NAME=SOIL
*ELASTIC
1e7,0.49
*DENSITY
2000.
*SOLID SECTION,ELSET=soil,MATERIAL=SOIL
1.
*BOUNDARY
BASE,1,2
SIDES,1,1
*STEP
*STATIC
*DLOAD
soil,GRAV,10.,0,-1,0
*NODE PRINT,NSET=TOP
U
*END STEP
"""
)
confined = 1e7 * 0.51 / (1.49 * 0.02)
plane_stress = 1e7 / (1 - 0.49**2)
for kind, modulus in (("CPS6", plane_stress), ("CPE6", confined)):
    _, results = run(kind, written.replace("CPS6", kind) + model)
    settlement = -min(row[2] for row in rows(results, 4))
    print(f"{kind}: {settlement * 1e3:.4f} mm, closed form {1e3 * 20e3 / 2 / modulus:.4f} mm")
    assert abs(settlement / (20e3 / 2 / modulus) - 1) < 0.01
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
