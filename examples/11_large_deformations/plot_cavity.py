r"""
Cavities expanded in clay
=========================

A cylindrical and a spherical cavity in undrained clay of shear modulus G and strength c are
expanded to three times their radius :math:`a_0`, as by a pressuremeter, a pile or a cone. The
pressures of incompressible clay are (Gibson and Anderson 1961)

.. math::

    p = c \left(1 + \ln \frac{G}{c}\left(1 - \frac{a_0^2}{a^2}\right)\right), \qquad
    p = \tfrac43 c \left(1 + \ln \frac{G}{c}\left(1 - \frac{a_0^3}{a^3}\right)\right).

In soil with friction the pressure tends to a limit, which H. S. Yu and G. T. Houlsby (1991)
derived; here a differential equation of a cavity that grows from nothing gives it.

The strains at the wall exceed 100 %. Four-node elements with F-bar, the default of
``kinematics="finite"`` for soil that yields, do not lock at :math:`\nu = .499`.
"""

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import solve_ivp
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

G, c, nu = 100.0, 1.0, 0.499
clay = sc.Tresca(E=2.0 * G * (1.0 + nu), nu=nu, c=c)
radii = np.linspace(1.0, 3.0, 21)[1:]
r = np.geomspace(1.0, 200.0, 81)

# %%
# A disc of unit radius for the cylinder, and a quarter of a circle for the sphere, both in axial
# symmetry.


def cylinder(r=r):
    """Disc of soil between two planes that keep their distance."""
    mesh = MeshQuad.init_tensor(r, np.array([0.0, 0.1])).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    inner = basis.get_dofs("left").all("u^1")
    ends = [basis.get_dofs(end).all("u^2") for end in ("bottom", "top")]
    return basis, np.concatenate([inner, *ends]), inner


def sphere(n=12, r=r):
    """Quarter of a circle, whose sides are a plane of symmetry and the axis."""
    grid = MeshQuad.init_tensor(r, np.linspace(0.0, np.pi / 2.0, n + 1)).with_defaults()
    radius, angle = grid.p
    points = np.array([radius * np.cos(angle), radius * np.sin(angle)])
    mesh = MeshQuad(points, grid.t, _boundaries=grid.boundaries)
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    inner = basis.get_dofs("left").all()
    sides = basis.get_dofs("bottom").all("u^2"), basis.get_dofs("top").all("u^1")
    return basis, np.concatenate([inner, *sides]), inner


def expanded(basis, fixed, inner, soil=clay, radii=radii):
    """Move the wall to each radius; return the result and the work of its reactions per radius."""
    body = sc.SolidForm(basis, soil, coordinates="axisymmetric", kinematics="finite")
    model = sc.Model({"soil": body}, np.unique(fixed))
    directions = basis.doflocs[inner % 2, inner]
    stages = []
    for radius in radii:
        x = np.zeros(basis.N)
        x[inner] = (radius - 1.0) * directions
        stages.append(sc.Stage(f"{radius:.3f} a0", prescribed=x))
    result = model.run(stages)
    forces = np.array([stage.reactions()[inner] @ directions for stage in result])
    return result, forces


# %%
# Both are expanded; the pressure follows from the reactions of the wall over its present area.

start = process_time()
runs = {"cylinder": expanded(*cylinder()), "sphere": expanded(*sphere())}
seconds = process_time() - start
pressure = {
    "cylinder": runs["cylinder"][1] / (0.1 * radii),
    "sphere": runs["sphere"][1] / radii**2,
}
exact = {
    "cylinder": c * (1.0 + np.log(G / c * (1.0 - radii**-2))),
    "sphere": 4.0 / 3.0 * c * (1.0 + np.log(G / c * (1.0 - radii**-3))),
}

fig, ax = plt.subplots()
for name, values in pressure.items():
    ax.plot(radii, values, "o", label=name)
    ax.plot(radii, exact[name], "k-", lw=0.8)
ax.set_xlabel("radius of the cavity over its first radius")
ax.set_ylabel("pressure over strength")
ax.legend()
plt.show()

# %%
# The equivalent plastic strain around the sphere, on the displaced mesh.

plot.contour(runs["sphere"][0][-1], "plastic", window=(0.0, 8.0, 0.0, 8.0))

# %%
# Soil with friction
# ------------------
# Where a cavity grows from nothing, stresses and velocity v are functions of r over the radius of
# the plastic zone. In that zone :math:`\sigma_r' = -m (\sigma_r - \sigma_\theta) / r` with
# m = 1 or 2, the strength holds, and dilatancy ties the plastic strain rates. The wall is where
# v = r.

E, friction, psi = 260.0, 30.0, {"cylinder": 0.0, "dilatant": 10.0, "sphere": 0.0}


def limit(m, phi, psi, nu=0.3):
    """Limit pressure of a cylinder (m = 1) or sphere (m = 2) in soil without stress at rest."""
    phi, psi = np.radians((phi, psi))
    alpha, beta = ((1 + np.sin(angle)) / (1 - np.sin(angle)) for angle in (phi, psi))
    Y = 2 * c * np.cos(phi) / (1 - np.sin(phi))
    k = 1 - nu**2 if m == 1 else 1.0  # plane strain, or three dimensions
    n = nu / (1 - nu) if m == 1 else nu

    def rates(rho, z):
        radial, v = z
        d_radial = -m * (radial - (radial - Y) / alpha) / rho
        rate = (v - rho) * d_radial
        elastic = k / E * (rate - m * n * rate / alpha)
        around = k / E * ((1.0 if m == 1 else 1 - nu) * rate / alpha - n * rate)
        return d_radial, -elastic - m / beta * (v / rho + around)

    def wall(rho, z):
        return z[1] - rho

    wall.terminal = True
    at_border = Y / (1 + alpha / m)
    begin = at_border, (m + 1) * at_border * (1 + nu) / (m * E)
    found = solve_ivp(rates, (1.0, 1e-4), begin, events=wall, rtol=1e-9, atol=1e-12)
    return found.y[0, -1]


# %%
# The pressures at six to twenty times the first radius. Dilatant soil needs longer: the stress
# that limits a law is the one per undeformed volume, which grows.

wide = np.geomspace(1.0, 5000.0, 181)
for name, most in (("cylinder", 12.0), ("dilatant", 20.0), ("sphere", 6.0)):
    soil = sc.MohrCoulomb(E=E, nu=0.3, c=c, phi=friction, psi=psi[name])
    way = np.geomspace(1.0, most, 41)[1:]
    shape = sphere(8, r[::2]) if name == "sphere" else cylinder(wide)
    result, forces = expanded(*shape, soil, way)
    area = way[-1] ** 2 if name == "sphere" else 0.1 * way[-1]
    reached = forces[-1] / area
    tends = limit(2 if name == "sphere" else 1, friction, psi[name])
    print(
        f"{name}, psi {psi[name]:.0f}: {reached:.3f}, limit {tends:.3f}, {reached / tends - 1:+.1%}"
    )
    assert abs(reached / tends - 1) < (0.02 if psi[name] else 0.01)

rows = []
for name, (result, _) in runs.items():
    error = float(np.abs(pressure[name] / exact[name] - 1.0).max())
    assert error < 0.005, (name, pressure[name] / exact[name])
    iterations = sum(sum(stage.iterations) for stage in result)
    rows.append(
        {
            "method": name,
            "n": 80,
            "unknowns": len(result[-1].x),
            "error": error,
            "cpu_s": seconds,
            "iterations": iterations,
        }
    )
print(json.dumps({"case": "cavity", "rows": rows}))
