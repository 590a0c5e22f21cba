r"""
An anchored wall in stages
==========================

A sheet pile wall with prestressed, grouted anchors every 2.5 m, and a pit of 6 m that is dug in two
lifts. Two figures are compared with a hand calculation: the shear force of the wall jumps by the
level part of the anchor's force, and the factor of safety of the embedment follows from moments of
the earth pressures about the anchor, as Blum's free earth support. Coulomb's coefficients with wall
friction are

.. math:: K = \cos^2\varphi \,/\, (1 \pm \sqrt{\sin(\varphi + \delta) \sin\varphi /
   \cos\delta})^2 ,

with plus for active pressure. Units are kN and m.
"""

import json

import numpy as np
from scipy.optimize import brentq
from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact as sc
import skfem_contact.plot as plot

pit = sc.section.pit(8.0, [-2.0, -6.0], (-1.5, -9.0), {"sand": -16.0}, 2.0, beyond=24.0, fine=0.6)
basis = Basis(pit.mesh(), ElementVector(ElementTriP2()), intorder=2)
wall = sc.Beam(basis, "wall|right", EI=6e4, EA=4e6, bonded=False)
body = sc.Beam(None, np.linspace((9.0, -6.0), (14.0, -8.5), 6), EI=10.0, EA=2e5, spacing=2.5)
sand = sc.MohrCoulomb(E=5e4, nu=0.3, c=0.1, phi=33.0, psi=5.0)
forms = pit.solids(basis, sand, unit_weight=18.0)
forms |= wall.contact(basis, sc.Coulomb(np.tan(np.radians(15.0))), pit.sides("wall", basis.mesh))
bar = sc.Bar(None, wall.at((0.0, -1.5)), body.at((9.0, -6.0)), EA=1.2e5, spacing=2.5)
forms |= {"wall": wall, "body": body, "grout": sc.Embedded(basis, body, 200.0), "anchor": bar}

# %%
# The anchor is jacked to 150 kN and locked in the next stage.
anchor = ["body", "grout", "anchor"]
stages = [
    sc.Stage("dig 1", deactivate=["lift 1", "lift 1|wall", *anchor], increments=2),
    sc.Stage("jack", activate=anchor, change={"anchor": bar.prestressed(150.0)}),
    sc.Stage("dig 2", deactivate=["lift 2", "lift 2|wall"], change={"anchor": bar}, increments=2),
]
model = sc.Model(forms, sc.box_supports(basis))
result = model.run(stages, start=model.k0_state(K0=0.46))
found = model.strength_reduction(start=result, flow="davis_b")
print(result.table("wall", "anchor"))
plot.mechanism(found)

# %%
# By hand:
forces = result["dig 2"].section_forces("wall")
above, below = forces.V[np.flatnonzero(np.isclose(forces.y, -1.5))]
pull = result["dig 2"].states["anchor"].force[0] / 2.5 * 9.0 / np.hypot(9.0, 4.5)


def overturning(factor):
    """Return a multiple of the moment of active less passive pressures about the anchor."""
    phi, delta = np.arctan(np.tan(np.radians([33.0, 15.0])) / factor)
    root = np.sqrt(np.sin(phi + delta) * np.sin(phi) / np.cos(delta))
    return (9.0 / (1.0 + root)) ** 2 * 4.5 - (3.0 / (1.0 - root)) ** 2 * 6.5


by_hand = brentq(overturning, 1.0, 3.0)
print(found, f"by Blum {by_hand:.3f}; jump {below - above:.1f}, anchor {pull:.1f} kN/m", sep="\n\n")
assert abs(abs(below - above) / pull - 1.0) < 5e-3  # friction beside the node
assert found.factor / (1.0 + found.added) < by_hand < found.factor  # between mesh and exact value
row = {"method": "Blum", "n": basis.mesh.nelements, "unknowns": model.layout.size}
row |= {"error": found.factor / by_hand - 1.0, "cpu_s": None, "iterations": found.iterations}
print(json.dumps({"case": "anchored_wall", "rows": [row]}))
