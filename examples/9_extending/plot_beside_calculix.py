"""
A cantilever beside CalculiX
============================

The same mesh, of ten-node tetrahedra, in two programs: ``save_mesh`` writes it for CalculiX, and
``sc.testing`` reads the results with the order of components and nodes of their files. Without
CalculiX the page compares with the files of version 2.20 that are shipped with it. Units are kN
and m.
"""

import json
import shutil
import subprocess
import tempfile
from pathlib import Path
from time import process_time

import numpy as np
from skfem import Basis, ElementTetP2, ElementVector, MeshTet, MeshTet2

import skfem_contact as sc
import skfem_contact.plot as plot

sc.set_units("kN", "m")

begin = process_time()

# %%
# A block of 2 m, held at one end, under its weight of 20 kN/m³:
lines = (np.linspace(0.0, 2.0, 3), np.linspace(0.0, 1.0, 2), np.linspace(0.0, 1.0, 2))
mesh = MeshTet2.from_mesh(MeshTet.init_tensor(*lines)).with_boundaries(
    {"wall": lambda x: x[0] == 0.0}
)
mesh = mesh.with_subdomains({"block": lambda x: x[0] < 2.0})
basis = Basis(mesh, ElementVector(ElementTetP2()), intorder=2)
block = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3), unit_weight=20.0)
model = sc.Model({"block": block}, basis.get_dofs("wall").all())
stage = model.run([sc.Stage("weight")])["weight"]

# %%
# The same for CalculiX, whose numbers of nodes and elements begin with one:
DECK = """*INCLUDE, INPUT=mesh.inp
*NSET, NSET=FIXED
{fixed}
*MATERIAL, NAME=SOIL
*ELASTIC
1e4, 0.3
*DENSITY
2.
*SOLID SECTION, ELSET=block, MATERIAL=SOIL
*BOUNDARY
FIXED, 1, 3
*STEP
*STATIC
*DLOAD
block, GRAV, 10., 0., 0., -1.
*NODE FILE
U
*EL FILE
S
*NODE PRINT, NSET=FIXED, TOTALS=ONLY
RF
*EL PRINT, ELSET=block
S
*END STEP
"""
folder = Path(tempfile.mkdtemp())
sc.save_mesh(mesh, folder / "mesh.inp")
fixed = np.flatnonzero(mesh.doflocs[0] == 0.0) + 1
(folder / "cantilever.inp").write_text(DECK.format(fixed=",\n".join(map(str, fixed))))
if shutil.which("ccx"):
    subprocess.run(["ccx", "cantilever"], cwd=folder, capture_output=True, check=True)
else:
    folder = Path(".")
frd = sc.testing.read_frd(folder / "cantilever.frd")
dat = sc.testing.read_dat(folder / "cantilever.dat")

# %%
# Displacements at nodes agree to the digits of the file, and so do mean stresses of elements:
found = sc.testing.compare(stage, frd, dat)
print(found)

# %%
# Reactions do not: CalculiX prints the sum of the forces of elements at the nodes, without the
# weight that acts on these nodes themselves.
ours = stage.reactions()[basis.get_dofs("wall").all("u^3")].sum()
(total,) = (block.values[0, 2] for block in dat if block.quantity == "total force")
on_nodes = model.weight(20.0)[basis.get_dofs("wall").all("u^3")].sum()
print(f"weight 40, reaction here {ours:.4f}, there {total:.4f}, weight on the wall {-on_nodes:.4f}")

# %%
plot.cutaway(stage, "uz", deformed="auto")

# sphinx_gallery_start_ignore
assert found.displacement < 1e-5  # six digits
assert found.stress < 1e-5
assert found.nodes == mesh.doflocs.shape[1]
assert abs(ours - 40.0) < 1e-8
assert abs(total - on_nodes - 40.0) < 1e-4
row = {
    "method": "cantilever",
    "n": mesh.nelements,
    "unknowns": int(basis.N),
    "error": found.displacement,
    "cpu_s": round(process_time() - begin, 2),
    "iterations": 1,
    "peer": "CalculiX 2.20",
}
print(json.dumps({"case": "beside_calculix", "rows": [row]}))
# sphinx_gallery_end_ignore
