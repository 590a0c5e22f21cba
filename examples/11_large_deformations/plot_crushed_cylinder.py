r"""
Crushed rubber cylinder
=======================

A long cylinder of nearly incompressible rubber is crushed between two smooth plates to half of its
diameter. T. Sussman and K.-J. Bathe (Comput. Struct. 26 (1987) 357-409) introduced this problem
with the law of Mooney and Rivlin, :math:`c_{10}` = .293, :math:`c_{01}` = .177 and a bulk modulus
of 1410 MPa. In plane strain without change of volume both invariants are equal, and the law is the
neo-Hookean one with the shear modulus :math:`2 (c_{10} + c_{01})`.

The load follows the finite element solution of I. Bijelonja, I. Demirdzic and S. Muzaferija (Int.
J. Numer. Methods Eng. 64 (2005) 1594-1609), as solids4foam's data of tutorials have it, within 2 %
of the largest load, and within 1 % at the end.
"""

import json
import sys
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("N", "mm")
n = int(sys.argv[1]) if len(sys.argv) > 1 else 8  # elements along each side of three blocks
radius = 200.0
#: Way of each plate [m], and load [kN/mm].
PUBLISHED = np.array(
    [
        (0.019, 0.056),
        (0.036, 0.136),
        (0.046, 0.216),
        (0.057, 0.343),
        (0.069, 0.503),
        (0.078, 0.690),
        (0.087, 0.906),
        (0.094, 1.160),
        (0.100, 1.418),
    ]
)

# %%
# A quarter is enough: a square with a blunt corner, and two blocks between it and the circle.

start = process_time()
grid = MeshQuad.init_tensor(np.linspace(0.0, 1.0, n + 1), np.linspace(0.0, 1.0, n + 1))
s, t = grid.p
side = radius * np.stack((0.5 - 0.1 * t, 0.4 * t))  # the right side of the square
circle = radius * np.stack((np.cos(0.25 * np.pi * t), np.sin(0.25 * np.pi * t)))
right = (1.0 - s) * side + s * circle
square = radius * np.stack((s * (0.5 - 0.1 * t), t * (0.5 - 0.1 * s)))
blocks = [MeshQuad(x, grid.t) for x in (square, right, right[::-1])]
mesh = (blocks[0] + blocks[1] + blocks[2]).with_boundaries(
    {
        "skin": lambda x: np.hypot(*x) > 0.97 * radius,
        "left": lambda x: x[0] < 1e-6 * radius,
        "bottom": lambda x: x[1] < 1e-6 * radius,
    }
)
basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
G, K = 2.0 * (0.293 + 0.177), 1410.0
rubber = sc.NeoHooke(E=9.0 * K * G / (3.0 * K + G), nu=(3.0 * K - 2.0 * G) / (6.0 * K + 2.0 * G))

# %%
# The plate stands still, and the plane of symmetry moves up.

forms = {
    "cylinder": sc.SolidForm(basis, rubber, kinematics="finite", strain="f_bar"),
    "plate": sc.ContactPair(
        basis,
        "skin",
        sc.rigid.line((2.0 * radius, radius), (-2.0 * radius, radius)),
        sc.Coulomb(mu=0.0),
        quadrature=3,
        enforcement=sc.AugmentedLagrangian(),
    ),
}
up, left = basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")
model = sc.Model(forms, np.union1d(up, left))
stages = []
for way in 1000.0 * PUBLISHED[:, 0]:
    moved = basis.zeros()
    moved[up] = way
    stages.append(sc.Stage(f"{way:.0f} mm", prescribed=moved, increments=2))
result = model.run(stages)
load = np.array([2e-3 * abs(stage.reactions()[up].sum()) for stage in result])
seconds = process_time() - start

fig, ax = plt.subplots()
ax.plot(2000.0 * PUBLISHED[:, 0], load, label="here")
ax.plot(*(PUBLISHED.T * [[2000.0], [1.0]]), "k+", label="Bijelonja and others")
ax.set_xlabel("change of the diameter [mm]")
ax.set_ylabel("load [kN/mm]")
ax.legend()
plt.show()

# %%
# Stresses of the crushed quarter.

plot.contour(result[-1], "mises")

error = np.abs(load - PUBLISHED[:, 1]).max() / PUBLISHED[-1, 1]
print(f"load at the end {load[-1]:.3f} kN/mm, published {PUBLISHED[-1, 1]:.3f}")
print(f"largest difference {error:.1%} of the largest load")
assert abs(load[-1] / PUBLISHED[-1, 1] - 1.0) < 0.01
assert error < 0.02
row = {
    "method": "f_bar",
    "n": n,
    "unknowns": int(basis.N),
    "error": float(error),
    "cpu_s": seconds,
    "iterations": sum(sum(stage.iterations) for stage in result),
}
print(json.dumps({"case": "crushed_cylinder", "rows": [row]}))
