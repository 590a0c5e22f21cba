r"""
A cantilever that bends by two thirds of its length
===================================================

The load at the tip of a slender cantilever is :math:`5\,EI / L^2` and keeps its direction. The tip
moves by .714 L downwards and by .388 L back (Mattiasson 1981, by elliptic integrals of the
inextensible beam). Small strains would stretch the beam to nearly twice its length:
``kinematics="finite"`` is all that the solid needs.
"""

import json
from time import process_time

import numpy as np
from skfem import Basis, ElementQuad2, ElementVector, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

L, h, E = 10.0, 0.05, 1.2e6
P = 5.0 * E * h**3 / 12.0 / L**2
mesh = MeshQuad.init_tensor(np.linspace(0.0, L, 161), np.array([-h, h]) / 2.0).with_defaults()
basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
beam = sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.0), kinematics="finite")
model = sc.Model({"beam": beam}, basis.get_dofs("left").all())

# %%
# Newton's method takes full steps for such bodies. Five increments serve the pictures; one is
# enough.

start = process_time()
load = model.traction("right", (0.0, -P / h))
result = model.run([sc.Stage("tip", load, increments=5, keep="all")])
seconds = process_time() - start
print(result)

# %%
# Pictures of bodies of finite kinematics show their true displacements.

plot.contour(result["tip"], "u", mesh=False)

# %%
# Deflection and shortening against the exact ones.

tip = basis.get_dofs("right")
x = result["tip"].x
down = -x[tip.all("u^2")].mean() / L
back = -x[tip.all("u^1")].mean() / L
print(f"down {down:.5f} L (exact .71379), back {back:.5f} L (exact .38763)")

error = max(abs(down / 0.71379 - 1.0), abs(back / 0.38763 - 1.0))
assert error < 1e-4, (down, back)
print(
    json.dumps(
        {
            "case": "cantilever",
            "rows": [
                {
                    "method": "Q2",
                    "n": 160,
                    "unknowns": int(basis.N),
                    "error": error,
                    "cpu_s": seconds,
                    "iterations": sum(result["tip"].iterations),
                }
            ],
        }
    )
)
