r"""
Reading meshes
==============

``load_mesh`` reads a mesh of tetrahedra with ten volumes and ten surfaces. meshio reads the same
files to lists of elements; facets, on which boundaries of scikit-fem rest, are not among them.
``skfem.Mesh.load`` numbers the facets, as ``load_mesh`` does. The size is that of 1,000,000
tetrahedra with ``--full``. The memory is the peak of the arrays that Python reports, over that of
nodes, elements, facets and neighbours of the mesh.
"""

import json
import sys
import tempfile
import tracemalloc
from pathlib import Path
from time import process_time

import matplotlib.pyplot as plt
import meshio
import numpy as np
from skfem import Mesh, MeshTet

import skfem_contact as sc

# %%
# A cube with names:
n = 55 if "--full" in sys.argv else 16
cube = MeshTet.init_tensor(*[np.linspace(0, 1, n + 1)] * 3)
layer = (10 * cube.p[0, cube.t].mean(axis=0)).astype(int)
outside = cube.boundary_facets()
strip = (10 * cube.p[1, cube.facets[:, outside]].mean(axis=0)).clip(0, 9.9).astype(int)
cube = cube.with_subdomains({f"layer{k}": np.flatnonzero(layer == k) for k in range(10)})
cube = cube.with_boundaries({f"strip{k}": outside[strip == k] for k in range(10)})
folder = Path(tempfile.mkdtemp())


def timed(read, file):
    """Processor seconds of the second of two readings."""
    read(file)
    begin = process_time()
    read(file)
    return process_time() - begin


def peak(read, file):
    """Peak of the memory in bytes."""
    tracemalloc.start()
    mesh = read(file)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return mesh, most


# %%
# The formats:
rows = []
for end in (".msh", ".vtu", ".inp"):
    file = str(folder / f"cube{end}")
    sc.save_mesh(cube, file)
    programs = {"load_mesh": sc.load_mesh, "meshio.read": meshio.read}
    if end == ".msh":
        programs["skfem.Mesh.load"] = Mesh.load
    for program, read in programs.items():
        row = {
            "method": f"{end}, {program}",
            "n": cube.nelements,
            "unknowns": int(cube.nvertices),
            "error": None,
            "cpu_s": round(timed(read, file), 3),
            "iterations": None,
        }
        if program == "load_mesh":
            mesh, most = peak(read, file)
            arrays = (mesh.p, mesh.t, mesh.facets, mesh.t2f, mesh.f2t)
            row["memory_over_mesh"] = round(most / sum(array.nbytes for array in arrays), 2)
            assert set(mesh.boundaries) == set(cube.boundaries)
        rows.append(row)
        print(row["method"], row["cpu_s"], row.get("memory_over_mesh", ""))

# %%
# Time by format:

fig, ax = plt.subplots(figsize=(7, 3.6), layout="constrained")
ax.barh([row["method"] for row in rows], [row["cpu_s"] for row in rows], color="#1f4e8c")
ax.invert_yaxis()
ax.set(xlabel="processor time [s]")
plt.show()

# %%
# Figures
# -------

print(json.dumps({"case": "load_mesh", "rows": rows}))
