r"""
Rigid indenters: a flat punch, a cone, and crossed cylinders
============================================================

Three rigid bodies are pressed into an elastic half-space: the end of a round cylinder of radius a,
a cone that slopes by :math:`\beta`, and a cylinder that lies across another, elastic one at 45
degrees. The closed forms are

.. math:: \text{punch:} \quad \delta = \frac{P}{2 E^* a}, \qquad
          p = \frac{P}{2 \pi a^2} \frac{1}{\sqrt{1 - r^2/a^2}}

.. math:: \text{cone:} \quad \delta = \frac{\pi}{2}\, a \tan \beta, \qquad
          P = \frac{\pi}{2}\, a^2 E^* \tan \beta, \qquad
          p = \frac{E^* \tan \beta}{2} \cosh^{-1} \frac{a}{r}

and Hertz's ellipse for the gap :math:`A x^2 + B y^2` of the cylinders (K. L. Johnson, Contact
Mechanics, sections 3.8, 5.2 and 4.2). The blocks are ten times as wide as the contact; their edges
move as those of the half-space do under the force (Boussinesq), so that nothing is cut off.

The depth is given. All figures are set against the closed form for the force that is found.

Run with ``--full`` for finer meshes.
"""

import json
import sys
from time import process_time

import half_space
import matplotlib.pyplot as plt
import numpy as np
from round_blocks import MODULUS, Block, drawn, growing, quarter_disc
from skfem import MeshHex

import skfem_contact as sc
import skfem_contact.plot as plot

FULL = "--full" in sys.argv
rows = []


def press(name, n, block, master, depth, force):
    """The block under a rigid body: its forms, result, nodes with their forces, and a row."""
    begin = process_time()
    pair = block.contact(master, quadrature="nodal", enforcement=sc.AugmentedLagrangian())
    forms = {"block": block.solid, "joint": pair}
    stage = sc.Stage(name, block.basis.zeros(), block.moved(depth, force), increments=2)
    result = sc.Model(forms, block.fixed).run([stage], progress=False)
    row = {
        "method": name,
        "n": n,
        "unknowns": int(block.basis.N),
        "error": 0.0,
        "cpu_s": round(process_time() - begin, 2),
        "iterations": sum(result[-1].iterations),
    }
    return forms, result[-1], block.touched(result[-1].x), row


def report(row, **errors):
    """Relative errors, the largest of which is that of the row."""
    rows.append({**row, **errors, "error": max(map(abs, errors.values()))})
    listed = "  ".join(f"{name} {error:+.2%}" for name, error in errors.items())
    print(f"{row['method']:18} {row['unknowns']:6} unknowns {row['cpu_s']:6.1f} s:  {listed}")


def drawn_beside(position, pressure, line, exact, title, along, **limits):
    """Pressures at the nodes beside the exact ones."""
    _, ax = plt.subplots(figsize=(6.4, 3.6), layout="constrained")
    ax.plot(position, pressure, ".", ms=4, label="nodal forces over areas")
    ax.plot(line, exact, "k", lw=1, label="exact")
    ax.set(title=title, xlabel=along, ylabel="pressure", **limits)
    ax.legend(frameon=False)


# %%
# A flat punch
# ------------
# The pressure is infinite at the rim, where the elements are smallest. What they make of it does
# not matter a few elements away.

n, size, growth = (6, 0.0025, 1.5) if FULL else (4, 0.005, 1.5)
away = growing(size, growth, 9.0)
inside = away[away < 0.36] / 0.4  # from the rim towards the square in the middle
section = quarter_disc(n, np.append(0.0, 1 - inside[:0:-1]), 1 + away)
block = Block.of(drawn(section, away), near=lambda p: np.hypot(*p[:2]) < 1.0)
depth = 0.0182
force, _, _ = half_space.flat_punch(np.ones(1), depth, 1.0, MODULUS)
plane = sc.rigid.plane((0, 0, 0), (0, 0, -1), width=4.0, name="punch")
forms, step, found, row = press("flat punch", n, block, plane, depth, force)

force = found.normal.sum()
exact_depth = force / (2 * MODULUS)
half = found.circle(0.5)
_, pressure, _ = half_space.flat_punch(found.r[half], exact_depth, 1.0, MODULUS)
surface = np.unique(block.basis.get_dofs("surface").all("u^3"))
r = np.hypot(*block.basis.doflocs[:2, surface])
settled = depth - step.x[surface]
_, _, exact_surface = half_space.flat_punch(r, exact_depth, 1.0, MODULUS)
beside = np.argmin(np.abs(r - 2.0))
report(
    row,
    depth=depth / exact_depth - 1,
    pressure=(found.pressure[half] / pressure).mean() - 1,
    surface=settled[beside] / exact_surface[beside] - 1,
)

line = np.linspace(0, 0.999, 400)
_, pressure, _ = half_space.flat_punch(line, exact_depth, 1.0, MODULUS)
drawn_beside(found.r, found.pressure, line, pressure, "flat punch", "r / a", ylim=(0, 40))

# %%
# How the ground settles, thirty times enlarged, and its vertical stress.

plot.cutaway(
    step,
    "szz",
    deformed=30.0,
    limits=(-20.0, 0.0),
    towards=(1.0, 1.4, -0.7),
    cuts=[((1, 0, 0), (2.5, 0, 0)), ((0, 1, 0), (0, 2.5, 0)), ((0, 0, -1), (0, 0, -2.0))],
)

# %%
# A cone
# ------
# The radius of the contact follows from the second moment of the pressure, which is
# :math:`a^2 / 3`. At the tip the pressure is infinite, like the logarithm of r.

n, slope = 14 if FULL else 10, 0.02
fine = np.arange(round(0.3 * n) + 1) / n
radii = 1 + np.append(fine, fine[-1] + growing(1.5 / n, 1.5, 8.5)[1:])
section = quarter_disc(round(0.4 * n), np.arange(round(0.4 * n)) / round(0.4 * n), radii)
depths = np.append(2 * fine, 2 * fine[-1] + growing(1.5 / n, 1.5, 8.5)[1:])
block = Block.of(drawn(section, depths), near=lambda p: np.hypot(*p[:2]) < 1.3)
force, depth, _ = half_space.cone(np.ones(1), 1.0, slope, MODULUS)
tip = sc.rigid.cone((0, 0, 0), (0, 0, 1), slope, radius=2.0, name="cone")
forms, step, found, row = press("cone", n, block, tip, depth, force)

force = found.normal.sum()
a = np.sqrt(force / (0.5 * np.pi * MODULUS * slope))
half = found.circle(0.5)
_, exact_depth, pressure = half_space.cone(found.r[half], a, slope, MODULUS)
by_moment = np.sqrt(3 * found.normal @ found.r**2 / force)
report(
    row,
    depth=depth / exact_depth - 1,
    radius=by_moment / a - 1,
    pressure=(found.pressure[half] / pressure).mean() - 1,
)

line = np.linspace(0.005, 1.3, 400)
exact = half_space.cone(line, a, slope, MODULUS)[2]
drawn_beside(found.r, found.pressure, line, exact, "cone", "r / a", ylim=(0, 50))

# %%
# Crossed cylinders
# -----------------
# Both have the radius 20. The elastic one lies at 22.5 degrees to the long axis of the ellipse,
# the rigid one at as much to the other side. The lines of the mesh are parallel to the axes of
# the ellipse, so that nothing is symmetric. Its semi-axes follow from the second moments of the
# pressure, a fifth of their squares.

RADIUS, TURN = 20.0, np.radians(22.5)
A, B = np.sin(TURN) ** 2 / RADIUS, np.cos(TURN) ** 2 / RADIUS
unit_axis = half_space.hertz_ellipse(1.0, A, B, MODULUS)[0]
a, b, _, depth = half_space.hertz_ellipse(unit_axis**-3, A, B, MODULUS)  # a = 1


def lines(size, fine):
    """Coordinates from 0 on: equal steps as far as `fine`, then growing ones."""
    even = np.arange(round(fine / size) + 1) * size
    return np.append(even, even[-1] + growing(2 * size, 2.0, 8.5)[1:])


def across(p):
    """Height of the elastic cylinder; far away, where nothing touches, it is level."""
    way = -np.sin(TURN) * p[0] + np.cos(TURN) * p[1]
    return -np.minimum(way**2, 1.5) / (2 * RADIUS)


n = 9 if FULL else 6
x, y, z = lines(1 / n, 1.3), lines(1.3 * b / n, 1.3 * b), lines(1.3 * b / n, 2.6 * b / n)
x, y = (np.append(-c[:0:-1], c) for c in (x, y))
level = Block.of(
    MeshHex.init_tensor(x, y, -z[::-1]),
    near=lambda p: (np.abs(p[0]) < 1.3) & (np.abs(p[1]) < 1.3 * b),
)
axis = 3 * np.array([np.cos(TURN), -np.sin(TURN), 0.0])
above = np.array([0.0, 0.0, RADIUS])
rod = sc.rigid.cylinder(above - axis, above + axis, RADIUS, name="cylinder")
forms, step, found, row = press(
    "crossed cylinders", n, level.raised(across), rod, depth, unit_axis**-3
)

force = found.normal.sum()
a, b, peak, exact_depth = half_space.hertz_ellipse(force, A, B, MODULUS)
long, short = (np.sqrt(5 * found.normal @ c**2 / force) for c in found.coordinates)
report(
    row,
    depth=depth / exact_depth - 1,
    a=long / a - 1,
    b=short / b - 1,
    peak=found.pressure[found.circle(0.0)].mean() / peak - 1,
)

line = np.linspace(0, 1.3, 400)
out = np.hypot(found.coordinates[0] / a, found.coordinates[1] / b)
exact = peak * half_space.dome(line, 1.0)
drawn_beside(out, found.pressure, line, exact, "crossed cylinders", r"$(x^2/a^2 + y^2/b^2)^{1/2}$")

# %%
# The elliptic contact from above: pressure at the nodes and Hertz's ellipse.

fig, ax = plt.subplots(figsize=(8, 3), layout="constrained")
marks = ax.scatter(*found.coordinates, c=found.pressure, s=60, cmap="magma_r")
angle = np.linspace(0, 2 * np.pi, 200)
ax.plot(a * np.cos(angle), b * np.sin(angle), "k", lw=1)
ax.set(aspect="equal", xlabel="x", ylabel="y")
fig.colorbar(marks, label="pressure")
plt.show()

# %%
# Headline numbers
# ----------------

for row in rows:
    assert row["error"] <= 0.03

print(json.dumps({"case": "rigid indenters", "rows": rows}))
