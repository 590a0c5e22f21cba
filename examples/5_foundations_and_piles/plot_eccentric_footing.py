r"""
A rigid footing under a load with a lever
=========================================

A rough strip footing, 2 m wide, on clay. ``sc.RigidBoundary`` lets its line sink and turn, but not
bend, and puts a force anywhere on it. With the load in its middle it carries :math:`(2 + \pi) c`;
nearer to its edge as much as a narrower one with the load in the middle (Meyerhof), and more where
the clay also holds it down. Units are kN and m.
"""

# sphinx_gallery_thumbnail_number = 2

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("kN", "m")
width, c = 2.0, 20.0
half = np.concatenate((np.sin(np.linspace(0, np.pi / 2, 8)), 1 + 4 * np.linspace(0, 1, 9)[1:] ** 2))
x, y = np.append(-half[:0:-1], half), -4 * np.linspace(1, 0, 13) ** 2
mesh = MeshQuad.init_tensor(x, y).to_meshtri(style="x")
mesh = mesh.with_boundaries({"footing": lambda x: (x[1] > -1e-9) & (abs(x[0]) < 1 + 1e-9)})
basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)

footing = sc.RigidBoundary(basis, "footing")
clay = sc.SolidForm(basis, sc.Tresca(E=1e4, nu=0.45, c=c))
model = sc.Model({"clay": clay, "footing": footing}, sc.box_supports(basis))
levers = np.array([0.0, 0.1, 0.2, 0.3, 0.4]) * width
found = [
    model.limit_load(footing.load((0, -1), at=(lever, 0)), step=20.0, progress=False)
    for lever in levers
]

fig, ax = plt.subplots(figsize=(6, 4), layout="constrained")
ax.plot(
    levers / width,
    [one.multiplier / (width * c) for one in found],
    marker="o",
    label="held down by the clay",
)
ax.plot(
    levers / width, (2 + np.pi) * (1 - 2 * levers / width), "k:", label="effective width (Meyerhof)"
)
ax.set(xlabel="lever / width", ylabel="load / (width c)", xlim=(0, 0.5), ylim=(0, None))
ax.legend(frameon=False)

# %%
plot.mechanism(found[3], window=(-3, 3, -3, 0.3))

# sphinx_gallery_start_ignore
import json

carried = np.array([collapse.multiplier for collapse in found])
error = abs(carried[0] / ((2 + np.pi) * width * c) - 1)
assert (
    error < 0.03 and carried[0] > (2 + np.pi) * width * c
)  # from above, with elements of this size
assert np.all(carried > (2 + np.pi) * c * (width - 2 * levers)) and np.all(np.diff(carried) < 0)
print(
    json.dumps(
        {
            "case": "eccentric_footing",
            "rows": [
                {
                    "method": "P2",
                    "n": 7,
                    "unknowns": int(basis.N),
                    "error": error,
                    "cpu_s": None,
                    "iterations": sum(collapse.iterations for collapse in found),
                }
            ],
        }
    )
)
# sphinx_gallery_end_ignore
