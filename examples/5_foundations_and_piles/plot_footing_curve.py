r"""
A footing and its load-settlement curve
=======================================

A rough strip footing, 2 m wide, is pressed into clay. Half of it is computed. Its settlement is
prescribed, stage by stage; the load is the sum of the reactions below it. The clay carries
:math:`(2 + \pi) c` at last (Prandtl). Units are kN and m.
"""

# sphinx_gallery_thumbnail_number = 2

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("kN", "m")
width, c = 1.0, 20.0
x = np.append(np.linspace(0, 1.5, 16), 1.5 + 4.5 * np.linspace(0, 1, 10)[1:] ** 1.5)
y = -4.0 * np.linspace(1, 0, 17) ** 1.5
mesh = MeshTri.init_tensor(x, y).with_defaults()
basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
forms = {"clay": sc.SolidForm(basis, sc.Tresca(E=1e4, nu=0.45, c=c))}

at = (basis.doflocs[1] > -1e-9) & (basis.doflocs[0] < width + 1e-9)
footing = np.flatnonzero(at)
down = footing[footing % 2 == 1]
settlements = np.array([0.005, 0.01, 0.015, 0.02, 0.03, 0.04, 0.06])
unit = basis.zeros()
unit[down] = -1.0
stages = [sc.Stage(f"{1e3 * s:g} mm", prescribed=s * unit) for s in settlements]
result = sc.Model(forms, np.union1d(sc.box_supports(basis), footing)).run(stages)
load = [-stage.reactions()[down].sum() / width for stage in result]

fig, ax = plt.subplots(figsize=(6, 4), layout="constrained")
ax.plot(1e3 * settlements, load, marker="o")
ax.axhline((2 + np.pi) * c, color="0.5", linestyle=":", label=r"$(2+\pi)c$")
ax.set(xlabel="settlement [mm]", ylabel="mean pressure [kPa]", xlim=(0, None), ylim=(0, None))
ax.legend(frameon=False)

# %%
plot.contour(result[-1], "gamma", since=result[-2], vectors=True, window=(0, 4, -2.5, 0.2))

# sphinx_gallery_start_ignore
import json

error = abs(load[-1] / ((2 + np.pi) * c) - 1)
assert (
    0 < load[-1] / ((2 + np.pi) * c) - 1 < 0.04
)  # from above, with quadratic triangles of this size
assert np.all(np.diff(load) > 0)
print(
    json.dumps(
        {
            "case": "footing_curve",
            "rows": [
                {
                    "method": "P2",
                    "n": 12,
                    "unknowns": int(basis.N),
                    "error": error,
                    "cpu_s": None,
                    "iterations": int(sum(sum(stage.iterations) for stage in result)),
                }
            ],
        }
    )
)
# sphinx_gallery_end_ignore
