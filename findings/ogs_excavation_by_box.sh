#!/usr/bin/env bash
# ogs 6.5.9: an excavation of 1 m, given by its levels, is 1.5 m deep.
#
# Expected: `removeMeshElements --z-min 1 --z-max 2` takes the elements between these levels out of a block
#     of 2 m whose elements have their faces at 0, 0.5, 1, 1.5 and 2 m.
# Seen: of 8 m3 there are 2 m3 left in place of 4: the layer from 0.5 to 1 m is removed as well, since its
#     upper nodes lie in the box.  With --z-min 1.001 it is right, and with --z-min 1.499 the same.  A
#     trench of 1 m x 1 m is 2 m wide and 1.5 m deep.  The log tells the number of removed elements only.
# Meaning: every element with one node in the closed box goes.  A level of an excavation is a face of the
#     elements in a good mesh, so that it is one layer too deep, and more in a coarse mesh.  Give the levels
#     a part of an element inside of the box, and compare the volume.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    ogs==6.5.9 meshio==5.3.5 numpy==2.4.6
cat > run.py <<'PY'
import subprocess

import meshio

SIZE = 0.5  # of the elements, in m


def run(tool, *arguments):
    """Run a tool of OpenGeoSys, which must not complain."""
    done = subprocess.run(
        [f"venv/bin/{tool}", *map(str, arguments)], check=True, capture_output=True, text=True
    )
    assert "error" not in done.stdout + done.stderr


def rest(*box):
    """Volume and highest level of what is left outside a box."""
    run("removeMeshElements", "-i", "block.vtu", "-o", "rest.vtu", *box)
    mesh = meshio.read("rest.vtu")
    elements = mesh.get_cells_type("hexahedron")
    return len(elements) * SIZE**3, mesh.points[elements][:, :, 2].max()


run("generateStructuredMesh", "-e", "hex", "-o", "block.vtu", "--lx", 2, "--ly", 2, "--lz", 2,
    "--nx", 4, "--ny", 4, "--nz", 4)
for low, seen in ((1, 2.0), (1.001, 4.0), (1.499, 4.0)):
    volume, level = rest("--z-min", low, "--z-max", 2)
    print(f"box from {low} to 2 m: {volume} m3 left, up to {level} m; by its levels {4 * low:.3f} m3")
    assert volume == seen and level == seen / 4
volume, _ = rest("--x-min", 0.5, "--x-max", 1.5, "--z-min", 1, "--z-max", 2)
print(f"trench of 1 m x 1 m: {8 - volume} m3 removed in place of 2 m3")
assert 8 - volume == 6
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
