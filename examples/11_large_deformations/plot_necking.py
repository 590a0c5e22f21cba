r"""
A bar of steel that necks
=========================

A bar of circular section, 53.3 mm long with a radius of 6.413 mm, is pulled by 14 mm. Its force is
largest where the hardening of the steel equals its stress (Considère), at 79.7 kN times the area of
the middle, which is tapered by 1.8 % in radius. Then it necks, to .3 of its radius (Simo and Armero
1992). A quarter of a meridian is computed in axial symmetry, with F-bar.
"""

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import minimize_scalar
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
from steel import Steel

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("kN", "mm")
R, half, taper = 6.413, 53.334 / 2.0, 0.982
heights = half * np.linspace(0.0, 1.0, 21) ** 1.7
grid = MeshQuad.init_tensor(np.linspace(0.0, 1.0, 6), heights).with_defaults()
radius = R * (taper + (1.0 - taper) * grid.p[1] / half)
mesh = MeshQuad(grid.p * np.array([radius, np.ones_like(radius)]), grid.t).with_boundaries(
    grid.boundaries
)

basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
steel = Steel()
bar = sc.SolidForm(basis, steel, coordinates="axisymmetric", kinematics="finite")
top, bottom, axis = (basis.get_dofs(name) for name in ("top", "bottom", "left"))
fixed = np.concatenate([top.all(), bottom.all("u^2"), axis.all("u^1")])
model = sc.Model({"bar": bar}, np.unique(fixed))

# %%
# Half of the elongation is prescribed at the top, in steps that are smaller once it necks.

elongations = 2.0 * np.concatenate([np.linspace(0.25, 3.0, 12), np.linspace(3.1, 7.0, 40)])
stages = []
for elongation in elongations:
    x = np.zeros(basis.N)
    x[top.all("u^2")] = elongation / 2.0
    stages.append(sc.Stage(f"{elongation:.1f} mm", prescribed=x))
start = process_time()
result = model.run(stages)
seconds = process_time() - start

force = [2.0 * np.pi * stage.reactions()[top.all("u^2")].sum() for stage in result]
corner = sc.dofs_at(basis, (R * taper, 0.0)).ravel()[0]
neck = [(R * taper + stage.x[corner]) / R for stage in result]

fig, ax = plt.subplots()
ax.plot(elongations, force)
ax.set_xlabel("elongation [mm]")
ax.set_ylabel("force [kN]")
plt.show()

# %%
# The bar at the end.

plot.contour(result[-1], "plastic")

# %%
# The largest force of a bar that stays straight is that of its stress over its stretch.

considere = minimize_scalar(
    lambda k: -steel.yield_stress(k)[0] * np.exp(-k), bounds=(0.0, 1.0), method="bounded"
)
largest = -considere.fun * np.pi * (taper * R) ** 2
print(f"largest force {max(force):.1f} kN, of a straight bar {largest:.1f} kN")
print(f"radius of the neck {neck[-1]:.3f} R (published: .3)")
error = abs(max(force) / largest - 1.0)
assert error < 0.02
assert abs(neck[-1] - 0.3) < 0.03
print(
    json.dumps(
        {
            "case": "necking",
            "rows": [
                {
                    "method": "Q1, F-bar",
                    "n": 100,
                    "unknowns": int(basis.N),
                    "error": error,
                    "cpu_s": seconds,
                    "iterations": sum(sum(stage.iterations) for stage in result),
                }
            ],
        }
    )
)
