"""
A rubber seal beside CalculiX
=============================

A hollow seal of rubber, of radius 1, is squeezed between plates without friction by a fifth of its
height. The same quadrilaterals of eight nodes are computed here in the plane, and by CalculiX with
``NLGEOM`` as one layer of hexahedra of twenty nodes that cannot strain across the plane. Both have
contact by a penalty of 1000 E per unit of length. Without the option ``--calculix``, the page
compares with a file of version 2.20.
"""

import json
import sys
from pathlib import Path
from time import process_time

import layer
import numpy as np
from skfem import Basis, ElementQuadS2, ElementVector, MeshQuad, MeshQuad2

import skfem_contact as sc
import skfem_contact.plot as plot

E, nu = 1.0, 0.49
inner, squeeze, penalty, steps = 0.4, 0.2, 1e3, 8
n = 8

# %%
# A quarter of the seal, with curved elements. The plate stays, and the middle of the seal moves up.

grid = MeshQuad.init_tensor(np.linspace(0.0, 1.0, 2 * n + 1), np.linspace(0.0, 1.0, n // 2 + 1))
grid = MeshQuad2.from_mesh(grid)
angle, radius = 0.5 * np.pi * grid.doflocs[0], inner + (1.0 - inner) * grid.doflocs[1]
mesh = MeshQuad2(np.stack((radius * np.sin(angle), radius * np.cos(angle))), grid.t)
mesh = mesh.with_boundaries(
    {
        "left": lambda x: x[0] < 1e-9,
        "bottom": lambda x: x[1] < 1e-9,
        "outside": lambda x: np.hypot(*x) > 0.99,
    }
)
basis = Basis(mesh, ElementVector(ElementQuadS2()), intorder=4)
plate = sc.rigid.polyline([(3.0, 1.0), (-3.0, 1.0)])
forms = {
    "rubber": sc.SolidForm(basis, sc.NeoHooke(E=E, nu=nu), kinematics="finite"),
    "plate": sc.ContactPair(basis, "outside", plate, sc.Coulomb(), penalty=penalty),
}
middle = basis.get_dofs("bottom").all("u^2")
model = sc.Model(forms, np.concatenate([basis.get_dofs("left").all("u^1"), middle]))
up = basis.zeros()
up[middle] = squeeze
began = process_time()
result = model.run([sc.Stage("squeeze", prescribed=up, increments=steps, keep="all")])
seconds = process_time() - began
force = [float(stage.reactions()[middle].sum()) for stage in result["squeeze"].increments]
print(result)

# %%
plot.contour(result["squeeze"], "mises", mesh=False)

# %%
# The deck
# --------
# CalculiX's law is ``C10 (I1 - 3) + (J - 1)^2 / D1``, with the first invariant at constant volume;
# the two laws differ by terms of the change of volume, which is small.


def deck(thick):
    """Return CalculiX's input of one layer of hexahedra, and of the plate as an element."""
    x, N = mesh.doflocs, mesh.doflocs.shape[1]
    cells = mesh.dofs.element_dofs[:8].T + 1
    used, corners = np.unique(cells), np.unique(cells[:, :4])
    lines = ["*NODE, NSET=NALL"]
    for level, nodes in ((0, used), (2, corners), (1, used)):  # below, halfway, above
        height = -thick * {0: 0.0, 1: 1.0, 2: 0.5}[level]
        lines += [
            f"{k + level * N}, {x[0, k - 1]:.12g}, {x[1, k - 1]:.12g}, {height}" for k in nodes
        ]
    lines.append("*ELEMENT, TYPE=C3D20, ELSET=RUBBER")
    for number, cell in enumerate(cells, start=1):
        c, m = cell[:4], cell[4:]
        nodes = [*c, *(c + N), *m, *(m + N), *(c + 2 * N)]
        lines.append(f"{number}, " + ", ".join(map(str, nodes[:10])) + ",")
        lines.append(", ".join(map(str, nodes[10:])))
    plate = 3 * N + 1 + np.arange(8)
    corner = [(-0.5, 1.0), (2.0, 1.0), (2.0, 1.5), (-0.5, 1.5)]
    lines.append("*NODE, NSET=PLATE")
    for k, number in enumerate(plate):
        (px, py), z = corner[k % 4], thick * (-1.5, 0.5)[k // 4]
        lines.append(f"{number}, {px}, {py}, {z}")
    last = len(cells) + 1
    lines += ["*ELEMENT, TYPE=C3D8, ELSET=RIGID", f"{last}, " + ", ".join(map(str, plate))]

    lines += ["*SURFACE, NAME=SLAVE", *layer.faces(mesh, "outside")]
    lines += ["*SURFACE, NAME=MASTER", f"{last}, S3"]
    for name, axis in (("LEFT", 0), ("BOTTOM", 1)):
        held = used[np.abs(x[axis, used - 1]) < 1e-9]
        half = np.intersect1d(held, corners) + 2 * N
        lines += [f"*NSET, NSET={name}", *(f"{k}," for k in (*held, *(held + N), *half))]
    return "\n".join(
        [
            *lines,
            *layer.rubber("RUBBER", E, nu),
            *("*MATERIAL, NAME=STIFF", "*ELASTIC", "1e3, 0.3"),
            "*SOLID SECTION, ELSET=RIGID, MATERIAL=STIFF",
            *layer.contact(penalty),
            *("*BOUNDARY", "NALL, 3, 3", "LEFT, 1, 1", "BOTTOM, 2, 2"),
            *("PLATE, 1, 3", "*STEP, NLGEOM, INC=1000", "*STATIC"),
            f"{1.0 / steps}, 1., 1e-5, {1.0 / steps}",
            *("*BOUNDARY", f"PLATE, 2, 2, {-squeeze}"),
            *("*NODE PRINT, NSET=BOTTOM, TOTALS=ONLY", "RF", "*END STEP", ""),
        ]
    )


# %%
# Force and time
# --------------

thick = 1.0 / n
folder = Path(".")
theirs = None
if "--calculix" in sys.argv:
    folder, theirs = layer.run("seal", deck(thick))
totals = [b for b in sc.testing.read_dat(folder / "seal.dat") if b.quantity == "total force"]
peer = np.array([block.values[0, 1] for block in totals]) / thick
for ours, other in zip(force, peer):
    print(f"force {ours:.5f}, CalculiX {other:.5f}, {ours / other - 1.0:+.2%}")
error = float(np.abs(np.array(force) / peer - 1.0).max())
if theirs is not None:
    print(f"{seconds:.2f} s of processor time, CalculiX {theirs:.2f} s: 1/{theirs / seconds:.1f}")

# sphinx_gallery_start_ignore
assert len(peer) == steps
assert error < 0.01
row = {
    "method": "Q8",
    "n": n,
    "unknowns": int(basis.N),
    "error": error,
    "cpu_s": round(seconds, 2),
    "iterations": sum(result["squeeze"].iterations),
    "peer": "CalculiX 2.20",
}
print(json.dumps({"case": "seal", "rows": [row]}))
# sphinx_gallery_end_ignore
