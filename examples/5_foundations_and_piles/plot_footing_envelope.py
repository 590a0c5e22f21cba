r"""
A footing under inclined loads
==============================

A rough strip footing, 2 m wide, on clay of the strength :math:`c` = 20 kPa. Which vertical and
horizontal loads V and H does it carry together? Each inclination of the load gets two proven
bounds. Exact is, for a pressure without a lever (Green 1954),

.. math:: \frac{V}{B c} = 1 + \frac{\pi}{2} + \arccos h + \sqrt{1 - h^2}, \qquad h = \frac{H}{B c}
   \le 1 .

Units are kN and m.
"""

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact as sc
import skfem_contact.plot as plot

sc.set_units("kN", "m")

begin = process_time()
width, c = 2.0, 20.0
ground = sc.section.layers((-5.0, 5.0), 0.0, {"clay": -3.0})
section = sc.section.Section(
    ground, 1.5, lines={"footing": [(-1, 0), (1, 0)]}, sizes={"footing": 0.5}
)
basis = Basis(section.mesh(), ElementVector(ElementTriP2()), intorder=2)
model = sc.Model(section.solids(basis, sc.Tresca(E=1e4, nu=0.45, c=c)), sc.box_supports(basis))
towards = [(np.sin(a), -np.cos(a)) for a in np.radians([0.0, 8.0, 16.0, 30.0])]
found = [model.bounds(tractions={"footing": t}, live="footing", gap=0.05) for t in towards]
H, V = np.transpose(
    [(one.lower * width * x, -one.lower * width * y) for one, (x, y) in zip(found, towards)]
)
print("  H [kN/m]  V [kN/m]  bounds of both")
print(
    "\n".join(f"{h:10.1f}{v:10.1f}  +{p.upper / p.lower - 1:.1%}" for h, v, p in zip(H, V, found))
)

# %%
h = np.linspace(0, 1, 101)
fig, ax = plt.subplots(figsize=(6, 4.2), layout="constrained")
ax.plot(
    width * c * h,
    width * c * (1 + np.pi / 2 + np.arccos(h) + np.sqrt(1 - h**2)),
    "k",
    label="exact (Green)",
)
ax.plot(np.full(2, width * c), [0, width * c * (1 + np.pi / 2)], "k")
more = np.array([p.upper / p.lower for p in found])
ax.plot(H, V, "^", label="proven lower bound")
ax.plot(more * H, more * V, "v", label="proven upper bound")
ax.set(xlabel="H [kN/m]", ylabel="V [kN/m]", xlim=(0, None), ylim=(0, None))
ax.legend(frameon=False, loc="lower left")

# %%
plot.mechanism(found[2], window=(-3, 4, -2.5, 0.2))

# sphinx_gallery_start_ignore
errors = []
for one, (x, y) in zip(found, towards):
    q = np.linspace(1.0, c / x if x else 6.0 * c, 100_001)
    over = (
        -q * y / c
        - 1
        - np.pi / 2
        - np.arccos(q * x / c)
        - np.sqrt(np.maximum(1 - (q * x / c) ** 2, 0))
    )
    exact = q[np.argmax(over > 0)] if over[-1] > 0 else q[-1]
    assert one.lower < 1.0001 * exact and one.upper > 0.9999 * exact  # grid of the search
    errors.append(abs(0.5 * (one.lower + one.upper) / exact - 1.0))
assert max(errors) < 0.025  # half of the gap
print(
    json.dumps(
        {
            "case": "footing_envelope",
            "rows": [
                {
                    "method": "bounds",
                    "n": found[0].mesh.nelements,
                    "unknowns": found[0].certificates[1].unknowns,
                    "error": max(errors),
                    "cpu_s": round(process_time() - begin, 1),
                    "iterations": sum(c.iterations for one in found for c in one.history),
                }
            ],
        }
    )
)
# sphinx_gallery_end_ignore
