r"""
An upset billet
===============

A cylindrical billet of steel, 30 mm high with a radius of 10 mm, is upset by 60 % between two flat
dies: E = 200 GPa, Poisson's ratio 0.3, and a yield stress of 0.7 GPa that grows by 0.3 GPa a unit
of plastic strain. These are the data of the tutorial ``upsetBillet`` of solids4foam.

Between smooth dies it stays a cylinder. With the logarithmic strain :math:`\ln \lambda` of its
height the force is

.. math::

    F = \frac{\pi R^2}{\lambda} \, \frac{\sigma_Y + H |\ln \lambda|}{1 + H / E} ,

as the Kirchhoff stress is uniaxial. Between rough dies it bulges, its sides fold onto the dies, and
its force is compared with bounds.
"""

import json
import sys
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
from steel import Steel

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("kN", "mm")
n = int(sys.argv[1]) if len(sys.argv) > 1 else 6  # elements along the radius
R, half = 10.0, 15.0
E, nu, y0, H = 200.0, 0.3, 0.7, 0.3
steps = 45
ways = 0.6 * half * np.arange(1, steps + 1) / steps

# %%
# A quarter of the meridian is enough. The die stands still, and the plane of symmetry moves up.

grid = MeshQuad.init_tensor(np.linspace(0.0, R, n + 1), np.linspace(0.0, half, 3 * n // 2 + 1))
mesh = grid.with_boundaries(
    {
        "axis": lambda x: x[0] < 1e-9,
        "middle": lambda x: x[1] < 1e-9,
        "skin": lambda x: (x[0] > R - 1e-9) | (x[1] > half - 1e-9),
    }
)
basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
steel = Steel(K=E / (3.0 - 6.0 * nu), G=E / (2.0 + 2.0 * nu), y0=y0, y_inf=y0, H=H)
billet = sc.SolidForm(basis, steel, coordinates="axisymmetric", kinematics="finite")
die = sc.rigid.polyline([(4.0 * R, half), (-R, half)])
middle, axis = basis.get_dofs("middle").all("u^2"), basis.get_dofs("axis").all("u^1")


def upset(law, enforcement=None):
    """Return the stages of the billet between dies of a law, and their forces [kN]."""
    contact = sc.ContactPair(basis, "skin", die, law, quadrature=3, enforcement=enforcement)
    model = sc.Model({"billet": billet, "die": contact}, np.union1d(middle, axis))
    stages = []
    for way in ways:
        moved = basis.zeros()
        moved[middle] = way
        stages.append(sc.Stage(f"{way:.1f} mm", prescribed=moved))
    result = model.run(stages)
    return result, np.array([2.0 * np.pi * stage.reactions()[middle].sum() for stage in result])


start = process_time()
results, forces = {}, {}
results["smooth"], forces["smooth"] = upset(sc.Coulomb(), sc.AugmentedLagrangian())
results["rough"], forces["rough"] = upset(sc.Coulomb(mu=0.5))
seconds = process_time() - start

# %%
# No stress exceeds the yield stress, so that the power of the real stresses on any velocities is at
# most their dissipation. With a uniform upsetting of the height h at the unit rate, and the shear
# strength :math:`\sigma_Y / \sqrt 3` on the die,
#
# .. math::
#
#     F \le \frac{1}{h} \left( \int \sigma_Y \, dV
#     + \int \frac{\sigma_Y}{\sqrt 3} \, \frac{r}{2} \, dA \right) .
#
# Columns in uniaxial compression, as strong as their weakest point, are a lower bound of the load
# at which the billet flows. Both take the yield stresses that were computed.


skin = [basis.get_dofs("skin").all(name) for name in ("u^1", "u^2")]
radii = basis.global_coordinates().value[0]


def bounds_of(stage):
    """Return lower and upper bound of the force [kN]."""
    h = half - stage.x[middle[0]]
    y = steel.yield_stress(stage.states["billet"].internal[0])[0]

    # The rim of the contact is the last node on the die
    r, z = (basis.doflocs[i, dofs] + stage.x[dofs] for i, dofs in enumerate(skin))
    rim = r[z >= half].max()
    work = 2.0 * np.pi * (radii * basis.dx * y).sum()
    on_die = y.max() / np.sqrt(3.0) * np.pi * rim**3 / 3.0

    # Columns are rings in the deformed billet
    now = radii + np.asarray(basis.interpolate(stage.x))[0]
    edges = np.linspace(0.0, rim, n + 1)
    ring = np.digitize(now, edges) - 1
    weakest = np.array([y[ring == i].min() for i in range(n)])
    return np.pi * np.diff(edges**2) @ weakest, (work + on_die) / h


height = 1.0 - ways / half
exact = np.pi * R**2 / height * (y0 + H * np.abs(np.log(height))) / (1.0 + H / E)
lower, upper = np.array([bounds_of(stage) for stage in results["rough"]]).T

fig, ax = plt.subplots()
ax.plot(2.0 * ways, exact, "k-", lw=0.8, label="smooth, exact")
ax.plot(2.0 * ways, forces["smooth"], "k+", label="smooth")
ax.plot(2.0 * ways, forces["rough"], label="rough")
ax.fill_between(2.0 * ways, lower, upper, alpha=0.2, label="rough, bounds")
ax.set_xlabel("shortening [mm]")
ax.set_ylabel("force [kN]")
ax.legend()
plt.show()

# %%
# The plastic strains between rough dies.

plot.contour(results["rough"][-1], "plastic")

error = np.abs(forces["smooth"] / exact - 1.0).max()
at_end = [force[-1] for force in (lower, forces["rough"], upper)]
print(f"smooth dies: largest error {error:.1e}")
print("rough dies at the end: {:.0f} < {:.0f} < {:.0f} kN".format(*at_end))
# the tolerance of the augmented method
assert error < 1e-4
assert (lower < forces["rough"]).all()
assert (forces["rough"] < upper).all()
row = {
    "method": "Q1, F-bar, smooth",
    "n": n,
    "unknowns": int(basis.N),
    "error": float(error),
    "cpu_s": seconds,
    "iterations": sum(sum(stage.iterations) for stage in results["smooth"]),
}
print(json.dumps({"case": "upset_billet", "rows": [row]}))
