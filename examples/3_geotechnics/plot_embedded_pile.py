r"""
Piles and nails embedded in the ground
======================================

A pile, a nail or the grouted body of an anchor is thin beside the elements of the ground. It is a
:class:`skfem_contact.Beam` whose nodes need not meet those of the mesh: springs join it to the ground inside the
elements (:class:`skfem_contact.Embedded`). Along the beam they carry the skin resistance, at its end that of the foot.

Here a row of piles is loaded until skin and foot yield, and a nail is pulled out.
"""

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc

# %%
# A row of piles
# --------------
# Piles of 10 m, 2 m apart, have a skin resistance of 40 kN/m and a foot that bears 120 kN: the row carries 260 kN a
# metre. All that one pile has is given for one pile; forces and loads are those per metre of the row.


def pile(n):
    """Model of a row of piles, in a mesh of n elements in 4 m, and its unit load."""
    mesh = MeshTri.init_tensor(np.linspace(-15.3, 15, 6 * n + 1), np.linspace(-20, 0, 5 * n + 1)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    beam = sc.Beam(None, np.linspace((0, 0), (0, -10), 11), EI=2e5, EA=6e6, GA=2e6, spacing=2.0)
    forms = {"soil": sc.SolidForm(basis, sc.LinearElastic(E=3e4, nu=0.3)), "pile": beam,
             "skin": sc.Embedded(basis, beam, T_max=40.0, F_max=120.0)}
    model = sc.Model(forms, sc.box_supports(basis))
    return model, model.forms["pile"].load((0.0, -1.0), at=(0.0, 0.0))


rows = []
for n in (2, 4):
    begin = process_time()
    model, load = pile(n)
    found = model.limit_load(load, step=50.0, progress=False)
    rows.append({"method": "row of piles", "n": n, "unknowns": int(model.layout.size),
                 "error": abs(found.multiplier / 260 - 1), "cpu_s": round(process_time() - begin, 2),
                 "iterations": found.iterations})
    print(f"n = {n}: the row carries {found.multiplier:.3f} kN/m, stopped by {found.stop.kind}")
    assert rows[-1]["error"] < 1e-4 and found.stop.kind == "plateau"

# %%
# Under 240 kN/m the foot has reached its limit, and half of the skin. The settlement of a row in the plane depends on
# the mesh as that of a line load does, by one or two per cent here.

stages = [sc.Stage(f"{force}", force * load) for force in (60, 120, 180, 240)]
result = model.run(stages, progress=False)
head = model.forms["pile"].numbers((0.0, 0.0))[1]
fig, (left, right) = plt.subplots(1, 2, figsize=(8, 4), layout="constrained")
depth = model.forms["skin"].positions
for stage in result:
    left.plot(-stage.states["skin"].skin, depth, label=f"{stage.name} kN/m: {-1e3 * stage.x[head]:.1f} mm")
    forces = stage.section_forces("pile")
    right.plot(-2.0 * forces.N, -forces.y)
left.set(xlabel="skin of a pile [kN/m]", ylabel="depth [m]", ylim=(10, 0))
left.legend()
right.set(xlabel="thrust in a pile [kN]", ylim=(10, 0))
plt.show()
last = result["240"].states["skin"]
yields = (abs(last.skin) > 39.999).mean()
print(f"under 240 kN/m the foot bears {-last.foot[0]:.1f} kN, and {yields:.0%} of the skin yields")
assert abs(last.foot[0] + 120.0) < 0.01 and 0.4 < yields < 0.6

# %%
# A nail
# ------
# A nail of 5 m, inclined, is pulled at its head: the skin resistance times its length.

begin = process_time()
mesh = MeshTri.init_tensor(np.linspace(0, 10, 17), np.linspace(0, 6, 12)).with_defaults()
basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
nail = sc.Beam(None, np.linspace((0.4, 3.0), (5.2, 1.6), 7), EI=10.0, EA=1e5)
forms = {"soil": sc.SolidForm(basis, sc.LinearElastic(E=3e4, nu=0.3)), "nail": nail,
         "skin": sc.Embedded(basis, nail, T_max=15.0)}
model = sc.Model(forms, basis.get_dofs("bottom").all(), newton=sc.Newton(tolerance=1e-8))
pull = model.forms["nail"].load((-0.96, 0.28), at=(0.4, 3.0))
found = model.limit_load(pull, step=20.0, progress=False)
rows.append({"method": "nail", "n": 6, "unknowns": int(model.layout.size), "error": abs(found.multiplier / 75 - 1),
             "cpu_s": round(process_time() - begin, 2), "iterations": found.iterations})
print(f"the nail bears {found.multiplier:.4f} kN for 75")
assert rows[-1]["error"] < 1e-5

# %%
# Headline numbers
# ----------------
print(json.dumps({"case": "embedded pile", "rows": rows}))
