"""
Stiffness and strength of a reinforced wall
===========================================

A diaphragm wall of 0.8 m has bars on both sides. Its moment is followed over the curvature with the
laws of Eurocode 2: the secant stiffness and the largest moment become ``EI`` and ``Mp`` of a beam.
The largest moment is compared with a hand calculation, the beam with its plastic limit load.
"""

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np

import skfem_contact as sc

begin = process_time()
sc.set_units("kN", "m")
f_cd, f_yd, area, depth = 20e3, 435e3, 3e-3, 0.74
section = sc.moment_curvature(1.0, 0.8, [(area, depth)], f_c=f_cd, f_y=f_yd, f_t=2e3)
figure, ax = plt.subplots(figsize=(7.0, 4.0), layout="constrained")
ax.plot(section.curvature, section.moment, color="#1f4e8c")
ax.axhline(section.cracking, color="#888888", linestyle=":", label="cracking")
ax.set(xlabel="curvature [1/m]", ylabel="moment M [kNm/m]", xlim=(0.0, None), ylim=(0.0, None))
ax.legend(frameon=False)

# %%
# By hand: the parabola and the rectangle fill 0.8095 of the compressed depth, at 0.416 of it.
compressed = area * f_yd / (0.8095 * f_cd)
by_hand = area * f_yd * (depth - 0.416 * compressed)
print(f"largest moment {section.largest:.0f} kNm/m, by hand {by_hand:.0f} kNm/m")
error = abs(section.largest / by_hand - 1.0)
assert error < 0.01

# %%
# A cantilever of 4 m under a force at its end flows at Mp / 4:
wall = sc.Beam(
    None, np.linspace((0.0, 0.0), (0.0, 4.0), 5), EI=section.stiffness, EA=2e7, Mp=section.largest
)
model = sc.Model({"wall": wall}, wall.dofs((0.0, 0.0)))
push = model.forms["wall"].load((1.0, 0.0), at=(0.0, 4.0))
limit = model.limit_load(push, step=50.0).multiplier
print(f"limit {limit:.1f} kN/m, by hand {section.largest / 4.0:.1f} kN/m")
assert abs(4.0 * limit / section.largest - 1.0) < 0.01
sc.set_units()
row = {"method": "section", "n": 200, "unknowns": model.layout.size, "error": error}
row |= {"cpu_s": process_time() - begin, "iterations": None}
print(json.dumps({"case": "wall section", "rows": [row]}))
