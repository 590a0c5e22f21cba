#!/usr/bin/env bash
# pyvista 0.49.1, VTK 9.7.2, meshio 5.3.5: a mesh from Exodus II arrives in its deformed state.
#
# Expected: the points of a step of results are the coordinates of the file, as meshio reads them,
#     and the displacement is a field beside them.
# Seen: a cube of 1 m that is pressed to half its height in the last step. meshio has the height
#     1.0; pyvista moves the points of this step by itself: height and volume are 0.5.  Warped by
#     the field that is beside them, the cube has the height 0.  The field is named `disp_`, of
#     `disp_x`, `disp_y` and `disp_z`.
# Meaning: a nodal vector named "disp" moves the mesh.  Displacements shown by `warp_by_vector` are
#     doubled, and volumes, resultants of stress and points of sampling are of the deformed body, in
#     a theory of small displacements by mistake.  Turn it off by
#     `reader.reader.ApplyDisplacementsOff()`.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pyvista==0.49.1 vtk==9.7.2 meshio==5.3.5 numpy==2.4.6 netCDF4==1.7.5.1.post1
cat > run.py <<'PY'
import meshio
import netCDF4
import numpy as np
import pyvista

NAMES = ("disp_x", "disp_y", "disp_z")
corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
points = np.vstack([np.c_[corners, np.zeros(4)], np.c_[corners, np.ones(4)]])
with netCDF4.Dataset("cube.e", "w", format="NETCDF3_64BIT_OFFSET") as file:
    file.api_version = file.version = np.float32(8.03)
    file.floating_point_word_size, file.file_size, file.title = np.int32(8), np.int32(1), "cube"
    sizes = dict(
        len_string=33, len_line=81, len_name=33, four=4, num_dim=3, num_nodes=8, num_elem=1,
        num_el_blk=1, num_el_in_blk1=1, num_nod_per_el1=8, num_nod_var=3, time_step=None,
    )
    for name, size in sizes.items():
        file.createDimension(name, size)
    file.createVariable("time_whole", "f8", ("time_step",))[:] = [0, 1]
    for i, axis in enumerate("xyz"):
        file.createVariable(f"coord{axis}", "f8", ("num_nodes",))[:] = points[:, i]
    file.createVariable("eb_status", "i4", ("num_el_blk",))[:] = [1]
    number = file.createVariable("eb_prop1", "i4", ("num_el_blk",))
    number.setncattr("name", "ID")
    number[:] = [1]
    block = file.createVariable("connect1", "i4", ("num_el_in_blk1", "num_nod_per_el1"))
    block.elem_type = "HEX8"
    block[:] = [np.arange(1, 9)]
    file.createVariable("coor_names", "S1", ("num_dim", "len_name"))
    names = file.createVariable("name_nod_var", "S1", ("num_nod_var", "len_name"))
    for i, name in enumerate(NAMES):
        names[i] = netCDF4.stringtochar(np.array([name], "S33"))[0]
        values = file.createVariable(f"vals_nod_var{i + 1}", "f8", ("time_step", "num_nodes"))
        values[0] = np.zeros(8)
        values[1] = -0.5 * points[:, 2] if name == "disp_z" else np.zeros(8)


def last_step(apply):
    """The mesh at the last step, as read by default or with the displacement turned off."""
    reader = pyvista.get_reader("cube.e")
    if not apply:
        reader.reader.ApplyDisplacementsOff()
    reader.set_active_time_value(1.0)
    return reader.read().combine()


other = meshio.read("cube.e")
mesh, plain = last_step(True), last_step(False)
twice = mesh.warp_by_vector("disp_")
print(f"heights: meshio {np.ptp(other.points[:, 2])}, pyvista {np.ptp(mesh.points[:, 2])}, "
      f"warped {np.ptp(twice.points[:, 2])}, turned off {np.ptp(plain.points[:, 2])}")
print(f"volume {mesh.volume:.3f}, fields {list(mesh.point_data)}")
assert np.ptp(other.points[:, 2]) == np.ptp(plain.points[:, 2]) == 1
assert np.ptp(mesh.points[:, 2]) == 0.5 and abs(mesh.volume - 0.5) < 1e-9
assert np.ptp(twice.points[:, 2]) == 0 and "disp_" in mesh.point_data
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
