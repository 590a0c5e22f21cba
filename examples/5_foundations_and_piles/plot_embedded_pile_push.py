r"""
Deflection, resistance, shear force and moment of an embedded pile
==================================================================

A pile of 20 m and the radius :math:`r` in elastic ground is pushed sideways at its head. It is a
beam that the mesh need not know, :class:`skfem_contact.Embedded`, and half of it is computed, for
the mesh is cut along its axis. Deflection of the head and largest moment of a long pile are
(Randolph 1981, by finite elements)

.. math:: u = 0.27 \left(\frac{E_p}{G^*}\right)^{1/7} \frac{2 H}{G^* l_c}, \quad
   M = 0.1\, H l_c, \quad l_c = 2 r \left(\frac{E_p}{G^*}\right)^{2/7}, \quad
   G^* = G \left(1 + \tfrac{3}{4} \nu\right) .

Then the ground resists with no more than :math:`p` per length: a pile without hinges turns about
the depth :math:`L / \sqrt{2}`, and bears :math:`(\sqrt{2} - 1)\, p L` (Broms 1964).
Units are kN and m.
"""

import json

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementHexS2, ElementVector, MeshHex

import skfem_contact as sc

L, r, H, far, half = 20.0, 0.4, 100.0, 30.0, 0.5
soil, Ep = sc.LinearElastic(E=1e4, nu=0.3), 1e7
away = np.array([0.0, 1.6, 3.2, 5.1, 8.0, 12.8, 20.8, far])
z = np.append(np.linspace(-far, -L, 4)[:-1], -L * np.linspace(1.0, 0.0, 9) ** 1.4)
mesh = MeshHex.init_tensor(np.append(-away[:0:-1], away), away, z).with_defaults()
basis = Basis(mesh, ElementVector(ElementHexS2()), intorder=4)
line, area = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, -L), 21), half * np.pi * r**2
pile = sc.Beam(None, line, EI=(Ep - soil.E) * area * r**2 / 4.0, EA=(Ep - soil.E) * area)
upright = [dof for p in pile.points for dof in pile.dofs(p, ["u^2", "theta^1", "theta^3"])]


def model_of(**limits):
    """Model of half of the pile."""
    ground = sc.Embedded(basis, pile, T_max=1e6, radius=r, **limits)
    forms = {"soil": sc.SolidForm(basis, soil), "pile": pile, "ground": ground}
    return sc.Model(forms, [sc.box_supports(basis), *upright])


model = model_of()
push = model.forms["pile"].load((half * H, 0.0, 0.0), at=(0.0, 0.0, 0.0))
stage = model.run([sc.Stage("push", push)])["push"]

# %%
# Along the pile
# --------------
# The table of an embedded pile is that of springs by curves: deflections y of the pile and
# resistances p of the ground, in space along x, y and z.
table = stage.table("ground")
along_x = table["kind"] == "px"
depth, y, p = (table[name][along_x] for name in ("position", "deflection", "resistance"))
forces = stage.section_forces("pile").towards((-1.0, 0.0, 0.0))
fig, axes = plt.subplots(1, 4, figsize=(10, 4), sharey=True, layout="constrained")
axes[0].plot(1e3 * y, depth)
axes[1].plot(p / half, depth)
axes[2].plot(forces.V / half, forces.position)
axes[3].plot(forces.M / half, forces.position)
for ax, label in zip(axes, ("y [mm]", "p [kN/m]", "V [kN]", "M [kNm]")):
    ax.axvline(0.0, color="0.7", lw=0.8)
    ax.set(xlabel=label)
axes[0].set(ylabel="depth [m]", ylim=(L, 0.0))
plt.show()

# %%
# By hand:
G = soil.E / (2.0 * (1.0 + soil.nu)) * (1.0 + 0.75 * soil.nu)
length = 2.0 * r * (Ep / G) ** (2.0 / 7.0)
by_hand = 0.27 * (Ep / G) ** (1.0 / 7.0) * 2.0 * H / (G * length), 0.1 * H * length
head = stage.x[model.forms["pile"].numbers((0.0, 0.0, 0.0))[0]]
found = head, np.abs(forces.M).max() / half
print(f"head {1e3 * found[0]:.2f} mm, by Randolph {1e3 * by_hand[0]:.2f} mm")
print(f"moment {found[1]:.1f} kNm, by Randolph {by_hand[1]:.1f} kNm")
off = [abs(a / b - 1.0) for a, b in zip(found, by_hand)]
assert max(off) < 0.03

# %%
# The limit
# ---------
limit = 40.0
bears = model_of(p_max=half * limit).limit_load(push, step=2.0, progress=False)
exact = (np.sqrt(2.0) - 1.0) * limit * L
print(f"largest force {H * bears.multiplier:.1f} kN, by Broms {exact:.1f} kN")
error = abs(H * bears.multiplier / exact - 1.0)
assert error < 2e-3
row = {"method": "embedded", "n": mesh.nelements, "unknowns": model.layout.size, "error": error}
row |= {"cpu_s": None, "iterations": bears.iterations, "off": max(off)}
print(json.dumps({"case": "embedded_pile_push", "rows": [row]}))
