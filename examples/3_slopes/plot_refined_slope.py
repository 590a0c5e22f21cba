"""
A factor of safety on a mesh that refines itself
================================================

A coarse mesh is too strong in slip surfaces. ``strength_reduction(refine=True)`` cuts the elements
of the mechanism and searches again, until the error that the mesh adds is below the tolerance. The
slope is example 1 of Griffiths and Lane (1999), 1 in 2 without foundation layer, c = 0.05 gamma H
and phi = 20 degrees, whose factor is 1.4 with finite elements and 1.38 with charts. Certified
bounds enclose it.
"""

# sphinx_gallery_thumbnail_number = 2

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc
import skfem_contact.plot as plot

begin = process_time()
height = 10.0
x, y = np.meshgrid(np.linspace(-12.0, 20.0, 17), np.linspace(0.0, 1.0, 6))
flat = MeshTri.init_tensor(x[0], y[:, 0])
surface = height - 0.5 * np.clip(flat.p[0], 0.0, 19.0)
mesh = MeshTri(np.stack((flat.p[0], flat.p[1] * surface)), flat.t).with_defaults()
basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
soil = sc.MohrCoulomb(E=1e5, nu=0.3, c=10.0, phi=20.0, psi=20.0)
ground = sc.SolidForm(basis, soil, unit_weight=20.0)
fixed = [basis.get_dofs("bottom").all(), basis.get_dofs(["left", "right"]).all("u^1")]
model = sc.Model({"ground": ground}, fixed)

# %%
# On the given mesh, with the error in the title:
coarse = model.strength_reduction(certify=False)
plot.mechanism(coarse, mesh=True)

# %%
# Refined in one call:
found = model.strength_reduction(refine=True, certify=False)
print(found)
plot.mechanism(found, mesh=True)

# %%
# The value falls with every mesh towards the exact one, which lies between the certified bounds.
bounds = model.bounds(weight=20.0, gap=0.03)
elements, values, added = np.array(found.meshes).T
figure, ax = plt.subplots(figsize=(7.0, 3.6), layout="constrained")
ax.axhspan(bounds.lower, bounds.upper, color="#cfe0ef", label="certified bounds")
ax.semilogx(elements, values, "o-", color="#d55e00", label="factor of safety")
ax.semilogx(elements, values / (1.0 + added), "o--", color="#444444", label="less its error")
ax.set(xlabel="elements", ylabel="factor of safety")
ax.legend(frameon=False)
middle = 0.5 * (bounds.lower + bounds.upper)
error = abs(found.factor / middle - 1.0)
assert found.added * found.factor < 0.01
assert found.factor < coarse.factor
assert bounds.lower < found.factor < bounds.upper + 0.01
row = {"method": "refined", "n": int(elements[-1]), "unknowns": len(found.x), "error": error}
row |= {"cpu_s": process_time() - begin, "iterations": found.iterations}
print(json.dumps({"case": "refined slope", "rows": [row]}))
