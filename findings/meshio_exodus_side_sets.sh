#!/usr/bin/env bash
# meshio 5.3.5: the load and the soils of an Exodus file are gone, its supports if they have no name.
#
# Expected: blocks, side sets and node sets of an Exodus II file arrive as sets, or a message says
#     that they are left out.
# Seen: a file has the blocks "soil" (10) and "wall" (20), the side set "load" and a node set for the
#     base.  Two blocks of hexahedra arrive, without names and numbers, and no side set.  The node
#     set arrives if it has a name; with its number alone it is gone too.  No message in any case.
#     VTK's reader of the same file lists all of them.
# Meaning: side sets are where mesh generators that write Exodus put pressures and contact, and numbers
#     are their default for sets.  The mesh looks complete, and is one soil without loads and
#     supports.  Compare the sets with the output of a second reader, or read the file by netCDF4.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    meshio==5.3.5 netCDF4==1.7.5.1.post1 numpy==2.4.6
cat > run.py <<'PY'
import meshio
import numpy as np
from netCDF4 import Dataset, stringtochar

POINTS = np.array([(x, y, z) for x in (0.0, 1.0, 2.0) for z in (0.0, 1.0) for y in (0.0, 1.0)])
BRICKS = [[0, 4, 5, 1, 2, 6, 7, 3], [4, 8, 9, 5, 6, 10, 11, 7]]


def write(name, node_set_named):
    """Two bricks in blocks 10 (soil) and 20 (wall), the load as a side set, the base as a node set."""
    file = Dataset(name, "w", format="NETCDF3_64BIT_OFFSET")
    file.setncatts({
        "api_version": np.float32(5.1), "version": np.float32(5.1), "title": "ground",
        "floating_point_word_size": np.int32(8), "file_size": np.int32(1),
    })
    sizes = dict(
        len_string=33, num_dim=3, num_nodes=12, num_elem=2, num_el_blk=2, num_el_in_blk1=1,
        num_el_in_blk2=1, num_nod_per_el1=8, num_nod_per_el2=8, num_side_sets=1, num_side_ss1=1,
        num_node_sets=1, num_nod_ns1=6,
    )
    for dimension, size in sizes.items():
        file.createDimension(dimension, size)

    # A file without steps of results: its times are an empty list.
    file.createDimension("time_step", None)
    file.createVariable("time_whole", "f8", ("time_step",))

    def put(key, kind, dimensions, values):
        variable = file.createVariable(key, kind, dimensions)
        variable[:] = values
        return variable

    def names(key, dimension, texts):
        put(key, "S1", (dimension, "len_string"), stringtochar(np.array(texts, dtype="S33")))

    for axis, values in zip("xyz", POINTS.T):
        put(f"coord{axis}", "f8", ("num_nodes",), values)
    for block, brick in enumerate(BRICKS, start=1):
        dimensions = (f"num_el_in_blk{block}", f"num_nod_per_el{block}")
        put(f"connect{block}", "i4", dimensions, [np.add(brick, 1)]).elem_type = "HEX8"
    put("eb_prop1", "i4", ("num_el_blk",), [10, 20])
    names("eb_names", "num_el_blk", ["soil", "wall"])
    put("ss_prop1", "i4", ("num_side_sets",), [1])
    names("ss_names", "num_side_sets", ["load"])
    put("elem_ss1", "i4", ("num_side_ss1",), [2])
    put("side_ss1", "i4", ("num_side_ss1",), [6])
    put("ns_prop1", "i4", ("num_node_sets",), [1])
    if node_set_named:
        names("ns_names", "num_node_sets", ["base"])
    put("node_ns1", "i4", ("num_nod_ns1",), [1, 2, 5, 6, 9, 10])
    file.close()


for named in (True, False):
    write("ground.e", named)
    mesh = meshio.read("ground.e")
    print(f"node set {'with' if named else 'without'} a name: {mesh}")
    print("point sets", mesh.point_sets, "cell sets", mesh.cell_sets, "data", mesh.cell_data)
    assert len(mesh.points) == 12 and sum(len(block.data) for block in mesh.cells) == 2
    assert list(mesh.point_sets) == (["base"] if named else [])
    assert not mesh.cell_sets and not mesh.cell_data
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
