r"""
Reading meshes
==============

``load_mesh`` reads a mesh of tetrahedra with ten volumes and ten surfaces. meshio reads the same
files to lists of elements. The elements behind named sides are found, and facets numbered, at the
first use of a boundary: "load_mesh, facets" is ``load_mesh`` and one look at a boundary. "meshio,
MeshTet" is the least that scikit-fem needs for the same: ``meshio.read``, ``MeshTet``, and
``mesh.facets``, ``mesh.t2f`` and ``mesh.f2t``, which scikit-fem numbers by sorting rows, without
names. ``load_mesh`` sorts packed numbers instead. The size is that of 1,000,000 tetrahedra with
``--full``. The memory is the peak of the arrays that Python reports, over that of nodes, elements,
facets and neighbours of the mesh.
"""

import json
import sys
import tempfile
import tracemalloc
from importlib.util import find_spec
from pathlib import Path
from time import process_time

import gmsh
import matplotlib.pyplot as plt
import meshio
import numpy as np
from skfem import MeshTet

import skfem_contact as sc

# %%
# A cube with names:
full = "--full" in sys.argv
n = 55 if full else 10
turns = 15 if full else 3
cube = MeshTet.init_tensor(*[np.linspace(0, 1, n + 1)] * 3)
layer = (10 * cube.p[0, cube.t].mean(axis=0)).astype(int)
outside = cube.boundary_facets()
strip = (10 * cube.p[1, cube.facets[:, outside]].mean(axis=0)).clip(0, 9.9).astype(int)
cube = cube.with_subdomains({f"layer{k}": np.flatnonzero(layer == k) for k in range(10)})
cube = cube.with_boundaries({f"strip{k}": outside[strip == k] for k in range(10)})
folder = Path(tempfile.mkdtemp())

# %%
# The files; the ones of Gmsh's format 2.2 are written by meshio, the binary one of 4.1 by Gmsh:
files = {}
for end in (".msh", ".vtu", ".inp", ".mdpa", ".f3grid", *([".med"] if find_spec("h5py") else [])):
    files[end] = str(folder / f"cube{end}")
    sc.save_mesh(cube, files[end])
tags = [layer + 1, strip + 11]
names = {f"layer{k}": [k + 1, 3] for k in range(10)} | {f"strip{k}": [k + 11, 2] for k in range(10)}
cells = meshio.Mesh(
    cube.p.T,
    [("tetra", cube.t.T), ("triangle", cube.facets[:, outside].T)],
    cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
    field_data={name: np.array(tag) for name, tag in names.items()},
)
for word, binary in (("text", False), ("binary", True)):
    files[f".msh 2.2, {word}"] = str(folder / f"{word}.msh")
    cells.write(files[f".msh 2.2, {word}"], file_format="gmsh22", binary=binary)
gmsh.initialize(["-v", "0"])
gmsh.open(files[".msh"])
gmsh.option.setNumber("Mesh.Binary", 1)
files[".msh, binary"] = str(folder / "binary41.msh")
gmsh.write(files[".msh, binary"])
gmsh.finalize()


def with_facets(file):
    """Mesh with the facets of its boundaries."""
    mesh = sc.load_mesh(file)
    assert len(mesh.boundaries["strip0"])
    return mesh


def topology(file):
    """Facets of the mesh of scikit-fem with the elements of meshio."""
    found = meshio.read(file)
    t = np.concatenate([block.data for block in found.cells if block.type == "tetra"])
    mesh = MeshTet(np.ascontiguousarray(found.points.T), np.ascontiguousarray(t.T))
    return mesh.facets, mesh.t2f, mesh.f2t


def peak(file):
    """Mesh, and the peak of the memory in bytes."""
    tracemalloc.start()
    mesh = with_facets(file)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return mesh, most


# %%
# Medians of three readings, one program after the other, or of fifteen without facets with
# ``--full``:
programs = {
    "load_mesh": sc.load_mesh,
    "meshio.read": meshio.read,
    "load_mesh, facets": with_facets,
    "meshio, MeshTet": topology,
}
rows = []
for end, file in files.items():
    times = {program: [] for program in programs}
    for turn in range(turns):
        for program, read in programs.items():
            if end == ".mdpa" and program == "meshio, MeshTet":
                continue  # meshio finds no elements there
            if turn > 2 and (read in (with_facets, topology) or sum(times[program]) > 3.0):
                continue
            begin = process_time()
            read(file)
            times[program].append(process_time() - begin)
    for program, seconds in times.items():
        if not seconds:
            continue
        row = {
            "method": f"{end}, {program}",
            "n": cube.nelements,
            "unknowns": int(cube.nvertices),
            "error": None,
            "cpu_s": round(float(np.median(seconds)), 3),
            "iterations": None,
        }
        if program == "load_mesh":
            mesh, most = peak(file)
            arrays = (mesh.p, mesh.t, mesh.facets, mesh.t2f, mesh.f2t)
            row["memory_over_mesh"] = round(most / sum(array.nbytes for array in arrays), 2)
            assert set(mesh.boundaries) == set(cube.boundaries)
            assert all(
                len(mesh.subdomains[name]) == len(part) for name, part in cube.subdomains.items()
            )
        rows.append(row)
        print(row["method"], row["cpu_s"], row.get("memory_over_mesh", ""))

if full:
    for end in files:
        seconds = {row["method"]: row["cpu_s"] for row in rows}
        assert seconds[f"{end}, load_mesh"] < 1.5 * seconds[f"{end}, meshio.read"], end
        least = seconds.get(f"{end}, meshio, MeshTet", np.inf)
        assert seconds[f"{end}, load_mesh, facets"] < least, end
    assert max(row.get("memory_over_mesh", 0.0) for row in rows) < 2.0

# %%
# Time by format:

fig, ax = plt.subplots(figsize=(7, 8.0), layout="constrained")
ax.barh([row["method"] for row in rows], [row["cpu_s"] for row in rows], color="#1f4e8c")
ax.invert_yaxis()
ax.set(xlabel="processor time [s]")
plt.show()

# %%
# Figures
# -------

print(json.dumps({"case": "load_mesh", "rows": rows}))
