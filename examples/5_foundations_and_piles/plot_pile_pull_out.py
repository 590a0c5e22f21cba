r"""
Pile that is pulled out
=======================

A round pile stands in ground at rest, :math:`\sigma_h = K_0 \gamma z`, and is pulled. Once it
slips along all of its shaft the force is the friction that the pressure of the ground allows,

.. math:: Q = \mu K_0 \int_0^L \gamma z\, \pi D\, dz = \tfrac{1}{2} \pi D L^2 \mu K_0 \gamma .

A quarter of the pile and of the ground is computed in space, in kN and m. First the pile is rigid
and the ground elastic, to compare with the formula. Then both are real: the pile lengthens, slip
begins at its head, and the ground yields where its strength is less than the friction.
"""

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from pile_meshes import pile_in_ground
from skfem import Basis, ElementHex1, ElementVector

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("kN", "m")

DIAMETER, LENGTH, GAMMA, K0, MU = 0.6, 10.0, 18.0, 0.5, 0.4
mesh = pile_in_ground(m=5, diameter=DIAMETER, length=LENGTH)
basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2)

# %%
# Ground at rest
# --------------
# The pile is wished in place: it begins with the weight of the ground, and what it carries along
# its shaft is what the ground carried there.

pile = np.unique(basis.get_dofs(elements="pile").all())
ground = np.unique(basis.get_dofs(elements="soil").all())
rollers = sc.box_supports(basis, base="rollers")  # symmetry, the outer rim and the base
top = basis.get_dofs(lambda x: np.isclose(x[2], 0.0)).all("u^3")
head = np.intersect1d(top, pile)
weight = sc.weight(basis, GAMMA)


def pull(soil, shaft, held, displacements):
    """Force at the head, in kN of the whole pile, for each displacement; forms, result, time."""
    begin = process_time()
    forms = {
        "soil": sc.SolidForm(basis.with_elements("soil"), soil),
        "pile": sc.SolidForm(basis.with_elements("pile"), shaft),
        "shaft": sc.ContactPair(basis, "soil:shaft", "pile:shaft", sc.Coulomb(MU), 2),
    }
    rim = [d for d in ground if d % 3 < 2 and np.hypot(*basis.doflocs[:2, d]) > 5.99]
    start = sc.Model(forms, np.union1d(rollers, rim)).k0_state(weight, unit_weights=GAMMA, K0=K0)
    below = np.intersect1d(rollers, pile[pile % 3 == 2])  # the pile leaves its base
    fixed = np.union1d(np.union1d(np.setdiff1d(rollers, below), rim), held)
    stages = []
    for u in displacements:
        lifted = basis.zeros()
        lifted[held[held % 3 == 2]] = u
        stages.append(sc.Stage(f"{1e3 * u:g} mm", weight, prescribed=lifted))
    result = sc.Model(forms, fixed).run(stages, start=start, progress=False)
    own = GAMMA * np.pi * DIAMETER**2 / 4 * LENGTH
    upward = held[held % 3 == 2]
    force = [4 * step.reactions()[upward].sum() - own for step in list(result)[1:]]
    return np.array(force), forms, result, process_time() - begin


# %%
# Rigid pile, elastic ground
# --------------------------

elastic = sc.LinearElastic(E=2e4, nu=0.3)
steel = sc.LinearElastic(E=3e7, nu=0.2)
exact = 0.5 * np.pi * DIAMETER * LENGTH**2 * MU * K0 * GAMMA
rigid = pull(elastic, steel, pile, [0.01])
print(f"Q = {rigid[0][-1]:.2f} kN, by the formula {exact:.2f} kN")
print(rigid[2]["10 mm"].contact("shaft"))

# %%
# Concrete pile in sand
# ---------------------

sand = sc.MohrCoulomb(E=2e4, nu=0.3, c=1.0, phi=30.0, psi=0.0)
displacements = np.array([0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0]) * 1e-3
concrete = pull(sand, steel, head, displacements)
force, forms, result, _ = concrete

fig, ax = plt.subplots(figsize=(7, 4), layout="constrained")
ax.plot(1e3 * np.append(0, displacements), np.append(0, force), "o-", label="concrete pile in sand")
ax.axhline(exact, color="k", lw=1, label="friction of ground at rest")
ax.set(xlabel="displacement of the head [mm]", ylabel="force [kN]", xlim=(0, None), ylim=(0, None))
ax.legend(frameon=False, loc="lower right")
plt.show()

# %%
# Force along the pile
# --------------------
# The force at the head goes into the ground along the shaft, first near the head. What the pile
# carried at rest is subtracted.

cuts = sc.Cuts.line((0, 0, -0.95 * LENGTH), (0, 0, -0.05 * LENGTH), depth=1.1 * DIAMETER, n=19)
fig, ax = plt.subplots(figsize=(5, 4.5), layout="constrained")
rest = result["initial"].section_forces("pile", cuts).N
for name in ("0.5 mm", "2 mm", "8 mm"):
    along = result[name].section_forces("pile", cuts)
    ax.plot(4 * (along.N - rest), along.z, label=name)
ax.set(xlabel="force [kN]", ylabel="height [m]", xlim=(0, None))
ax.legend(frameon=False)
plt.show()

# %%
# The ground that is drawn along
# ------------------------------

plot.cutaway(
    result["8 mm"],
    "uz",
    since=result["initial"],
    limits=(0, 1.6e-3),
    cuts=[((1, 0, 0), (2.5, 0, 0)), ((0, 1, 0), (0, 2.5, 0))],
    towards=(1, 1.4, -0.8),
)

# %%
# Headline numbers
# ----------------

assert abs(rigid[0][-1] / exact - 1) < 0.01
assert np.all(np.diff(force) > -1e-3 * exact) and abs(force[-1] / exact - 1) < 0.2
rows = [
    {
        "method": method,
        "n": 5,
        "unknowns": int(basis.N),
        "error": float(abs(Q[-1] / exact - 1)),
        "force": float(Q[-1]),
        "cpu_s": round(cpu, 2),
        "iterations": sum(sum(step.iterations) for step in run),
    }
    for method, (Q, _, run, cpu) in {
        "rigid pile, elastic ground": rigid,
        "concrete pile in sand": concrete,
    }.items()
]
print(json.dumps({"case": "pile that is pulled out", "rows": rows}))
