r"""
Strength of jointed rock over the dip of its joints
===================================================

A sample of rock with one set of joints is confined by 20 kPa and loaded to its limit. The strength
depends on the dip :math:`\beta` of the joints. Jaeger (1960) gives it by hand,

.. math:: \sigma_1 - \sigma_3 =
          \frac{2 (c + \sigma_3 \tan\varphi)}{(1 - \tan\varphi \cot\beta) \sin 2\beta} .
"""

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc

begin = process_time()
c, phi, side = 50.0, 25.0, 20.0
basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
corner = int(np.abs(basis.mesh.p).sum(axis=0).argmin())
fixed = [basis.get_dofs("bottom").all("u^2"), basis.nodal_dofs[0, corner]]


def strength(dip):
    """Difference of the stresses at the limit load."""
    rock = sc.JointedRock(E=1e6, nu=0.2, joints=sc.Joint(dip, c, phi, psi=phi))
    model = sc.Model({"rock": sc.SolidForm(basis, rock, strain="full")}, fixed)
    confined = model.traction("left", (side, 0.0)) + model.traction("right", (-side, 0.0))
    confined = confined + model.traction("top", (0.0, -side))
    start = model.run([sc.Stage("confined", confined)], progress=False)
    push = model.traction("top", (0.0, -1.0))
    return model.limit_load(push, start=start, step=20.0, progress=False).multiplier


def by_hand(dip):
    """Jaeger's strength."""
    f, b = np.radians(phi), np.radians(dip)
    return 2.0 * (c + side * np.tan(f)) / ((1.0 - np.tan(f) / np.tan(b)) * np.sin(2.0 * b))


# %%
# Strengths
# ---------
dips = np.array([40.0, 50.0, 57.5, 65.0, 75.0])
found = np.array([strength(dip) for dip in dips])
curve = np.linspace(33.0, 84.0, 100)
figure, ax = plt.subplots(figsize=(6.5, 4.0), layout="constrained")
ax.plot(curve, by_hand(curve), color="#444444", label="by hand (Jaeger)")
ax.plot(dips, found, "o", color="#d55e00", label="limit loads")
ax.set(xlabel="dip of the joints [°]", ylabel="strength [kPa]", ylim=(0.0, 800.0))
ax.legend(frameon=False)
error = float(np.abs(found / by_hand(dips) - 1.0).max())
print(f"weakest at {dips[found.argmin()]:g} degrees, 45 + phi / 2; largest error {error:.2%}")
assert error < 0.01
row = {"method": "joints", "n": 1, "unknowns": int(basis.N), "error": error}
row |= {"cpu_s": process_time() - begin, "iterations": None}
print(json.dumps({"case": "jointed rock", "rows": [row]}))
