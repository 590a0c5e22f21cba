"""
A laterally loaded pile by p-y curves
=====================================

A steel pile in soft clay under a horizontal force, on springs by the curves of API RP 2GEO. Each
figure has a hand calculation beside it: the force of the ground, the moment from the resistances,
and the largest force, under which it turns about a point of its shaft. Units are kN and m.
"""

import json

import numpy as np

import skfem_contact as sc
import skfem_contact.plot as plot

sc.set_units("kN", "m")

length, diameter, su, weight = 12.0, 0.8, 30.0, 8.0


def lateral(depth):
    """Resistance per length of soft clay."""
    return sc.curves.clay_p_y(depth, diameter, su=su, unit_weight=weight)


pile = sc.Beam(None, np.linspace((0.0, 0.0), (0.0, -length), 49), EI=4e5, EA=7e6)
tip = sc.curves.q_z(9.0 * su * np.pi * diameter**2 / 4.0, diameter)
ground = sc.PileSprings(pile, lateral, sc.curves.clay_t_z(20.0, diameter), tip)
model = sc.Model({"pile": pile, "ground": ground})
push = model.forms["pile"].load((150.0, 0.0), at=(0.0, 0.0))
result = model.run([sc.Stage("push", push, increments=4)])
stage = result["push"]

# %%
# Deflection, resistance and moment along the pile:
table = stage.table("ground")
across = table["kind"] == "p"
depth, y, p = (table[name][across] for name in ("position", "deflection", "resistance"))
forces = stage.section_forces("pile")
plot.diagram(forces, "M", upright=True)
print(f"deflection of the head {1e3 * y[0]:.1f} mm, largest moment {abs(forces.M).max():.0f} kNm")

# %%
# By hand
# -------
# Equilibrium: the resistances add up to the force, and their moments give the moment of the pile.
total = np.trapezoid(p, depth)
at = float(forces.position[np.abs(forces.M).argmax()])
above = depth <= at
moment = 150.0 * at - np.trapezoid(p[above] * (at - depth[above]), depth[above])
print(f"sum of the resistances {total:.1f} kN, moment by hand {moment:.0f} kNm")
assert abs(total / 150.0 - 1.0) < 0.01
assert abs(moment / abs(forces.M).max() - 1.0) < 0.01

# %%
# The largest force: the pile turns about a depth a at which the moments of all limits vanish.
limit = np.array([lateral(z)[-1, 1] for z in depth])
about = [np.trapezoid(np.where(depth < a, 1.0, -1.0) * limit * depth, depth) for a in depth]
a = np.interp(0.0, about, depth)
rigid = np.trapezoid(np.where(depth < a, 1.0, -1.0) * limit, depth)
found = model.limit_load(push, step=0.5, progress=False)
largest = 150.0 * found.multiplier
error = abs(largest / rigid - 1.0)
print(f"largest force {largest:.0f} kN, by hand {rigid:.0f} kN about {a:.2f} m")
assert error < 0.03  # nodes 0.5 m apart
row = {"method": "p-y", "n": len(pile.cells), "unknowns": model.layout.size, "error": error}
row |= {"cpu_s": None, "iterations": sum(stage.iterations)}
print(json.dumps({"case": "pile by curves", "rows": [row]}))
