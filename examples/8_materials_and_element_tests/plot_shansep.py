r"""
Undrained strength by stress history, and the limit load of a strip
===================================================================

SHANSEP takes the undrained strength of clay from its vertical effective stress and its
overconsolidation, :math:`s_u = S \sigma_v' (\sigma_p' / \sigma_v')^m`. The ground at rest gives the
stresses, the strengths become those of ``Tresca``, and a strip is loaded to its limit. With m = 1
the strength grows linearly with depth, and the limit load lies above Prandtl's for the strength at
the surface and below that for the strength at a depth of half the width.
"""

import json
from time import process_time

import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc

begin = process_time()
sc.set_units("kN", "m")
x = np.concatenate((np.linspace(0.0, 1.5, 7), [2.0, 2.6, 3.4, 4.5, 6.0]))
y = -np.array([0.0, 0.25, 0.5, 0.8, 1.2, 1.7, 2.4, 3.2, 4.0])[::-1]
mesh = MeshTri.init_tensor(x, y).with_defaults()
mesh = mesh.with_boundaries({"strip": lambda p: (p[1] > -1e-9) & (p[0] < 1.0)})
basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
clay = sc.SolidForm(basis, sc.LinearElastic(E=5e3, nu=0.3), unit_weight=17.0)
rest = sc.Model({"clay": clay}, sc.box_supports(basis), water_unit_weight=10.0).k0_state(
    K0=0.6, water=0.0
)["initial"]

# %%
# Strengths of all elements
# -------------------------
# By hand: at a depth of 2 m the effective stress is 14 kPa, and 40 kPa were removed.
strength = rest.shansep("clay", S=0.22, m=1.0, POP=40.0)["all"]
form = rest.forms["clay"]
depth = -mesh.p[1, mesh.t[:, form.elements]].mean(axis=0)
error = np.abs(strength / (0.22 * (7.0 * depth + 40.0)) - 1.0).max()
print(f"at 2 m {np.interp(2.0, np.sort(depth), np.sort(strength)):.2f} kPa, by hand 11.88 kPa")
assert error < 1e-6

# %%
# Limit load
# ----------
# Half of a strip of 2 m, smooth.
tresca = sc.SolidForm(basis, sc.Tresca(E=500.0 * strength, nu=0.48, c=strength))
model = sc.Model({"clay": tresca}, sc.box_supports(basis))
found = model.limit_load(model.traction("strip", (0.0, -1.0)), step=10.0)
low, high = ((2.0 + np.pi) * 0.22 * (7.0 * z + 40.0) for z in (0.0, 1.0))
print(f"limit load {found.multiplier:.1f} kPa, Prandtl {low:.1f} to {high:.1f} kPa")
assert low < found.multiplier < high
sc.set_units()
row = {"method": "SHANSEP", "n": mesh.nelements, "unknowns": int(basis.N), "error": error}
row |= {"cpu_s": process_time() - begin, "iterations": found.iterations}
print(json.dumps({"case": "shansep", "rows": [row]}))
