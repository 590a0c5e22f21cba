r"""
Tunnel in weak rock
===================

A circular tunnel in rock of the Hoek-Brown strength, under the same pressure in all directions. The
support pressure is lowered in stages. The radius of the plastic zone has a closed form, and the
displacement of the wall is a quadrature of the flow rule, computed here for comparison. Beside the
ground reaction curve stands the characteristic of a lining.
"""

# %%
# The reference
# -------------
# With :math:`t = m_b p / \sigma_{ci} + s` the wall yields below the pressure :math:`p_{cr}` at
# which
# :math:`2 (p_0 - p_{cr}) = \sigma_{ci} t_{cr}^a`, and the plastic zone reaches to the radius
# :math:`R / r_0 = \exp\{(t_{cr}^{1-a} - t^{1-a}) / [(1 - a) m_b]\}`. Outside of it the rock is
# elastic. Inside, the plastic strains obey :math:`\varepsilon_r = -K_\psi \varepsilon_\theta`,
# which is an ordinary differential equation of the displacement.

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from skfem import Basis, ElementQuad2, ElementVector, MeshQuad

import skfem_contact as sc

P0, ALONG, FAR, WALL = 15e3, 12e3, 30.0, 1.0  # pressures in kPa, radii in m
PRESSURES = [10e3, 7e3, 6e3, 5e3, 4e3, 3e3, 2e3, 1.5e3, 1e3]


def rock(psi):
    """Weak rock mass with a dilatancy."""
    return sc.HoekBrown(E=5.7e6, nu=0.25, sigma_ci=30e3, m_b=1.7, s=0.0039, a=0.51, psi=psi)


def strength(law, p):
    """Difference of the principal stresses at a confinement."""
    return law.sigma_ci * (law.m_b * p / law.sigma_ci + law.s) ** law.a


def critical(law):
    """Support pressure at which the wall begins to yield."""
    return brentq(lambda p: 2 * (P0 - p) - strength(law, p), 0.0, P0)


def plastic_radius(law, p):
    """Radius of the plastic zone, that of the wall where nothing yields."""
    t, begin = (law.m_b * value / law.sigma_ci + law.s for value in (p, critical(law)))
    return WALL * np.exp(
        max(begin ** (1 - law.a) - t ** (1 - law.a), 0.0) / ((1 - law.a) * law.m_b)
    )


def displacement(law, p):
    """Inward displacement of the wall."""
    shear, begin = law.E / (2 * (1 + law.nu)), critical(law)
    if p >= begin:
        return (P0 - p) * WALL / (2 * shear)
    R, sine = plastic_radius(law, p), np.sin(np.radians(law.psi))
    K, first = (1 + sine) / (1 - sine), law.m_b * begin / law.sigma_ci + law.s

    def slope(r, u):
        t = (first ** (1 - law.a) - (1 - law.a) * law.m_b * np.log(R / r)) ** (1 / (1 - law.a))
        radial = (t - law.s) * law.sigma_ci / law.m_b
        hoop = radial + strength(law, radial)
        strains = [
            ((1 - law.nu) * one - law.nu * other) / (2 * shear)
            for one, other in ((radial - P0, hoop - P0), (hoop - P0, radial - P0))
        ]
        return strains[0] + K * strains[1] - K * u / r

    return float(
        solve_ivp(slope, (R, WALL), [(P0 - begin) * R / (2 * shear)], rtol=1e-11, atol=1e-14).y[
            0, -1
        ]
    )


# %%
# The model
# ---------
# A slice of an axisymmetric body, with rings that grow with the radius. On its outer boundary acts
# the pressure of the infinite rock, which is known from the radius of the plastic zone. The
# reference takes the stress along the tunnel for the intermediate one, here 12 MPa at first. If it
# were 15 MPa too, rock at the wall would yield on an edge of the surface, and the wall would move
# by 0.1 % more.

n = 80
radii = np.geomspace(WALL, FAR, n + 1)
mesh = MeshQuad.init_tensor(radii, np.array([0.0, 0.05])).with_defaults()
basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
axial = basis.get_dofs(elements=True).all("u^2")  # plane strain along the axis


def outside(law, p):
    """Pressure at the outer radius."""
    R = plastic_radius(law, p)
    return P0 - (P0 - max(p, critical(law))) * (R / FAR) ** 2


def excavated(law):
    """Stages of falling support pressure: displacements of the wall and the outermost yielded
    point.
    """
    form = sc.SolidForm(basis, law, coordinates="axisymmetric")
    model = sc.Model({"rock": form}, axial)

    def load(p, far):
        return model.traction("left", (p, 0.0)) + model.traction("right", (-far, 0.0))

    def at_rest(x):
        across, none = np.full_like(x[0], -P0), np.zeros_like(x[0])
        return np.stack((across, np.full_like(x[0], -ALONG), across, none))

    start = model.initial_state(load(P0, P0), stress=at_rest)
    stages = [sc.Stage(f"{p:g}", load(p, outside(law, p)), increments=2) for p in PRESSURES]
    result = model.run(stages, start=start, progress=False)
    wall = basis.get_dofs("left").all("u^1")
    r = np.asarray(form.basis.global_coordinates())[0]
    moved = [-float(result[s.name].x[wall].mean()) for s in stages]
    edge = [
        float(
            r[form.variable("plastic strain", result[s.name].states["rock"]) > 0].max(initial=WALL)
        )
        for s in stages
    ]
    return result, np.array(moved), np.array(edge)


rows, curves = [], {}
for psi in (0.0, 8.0):
    begin, law = process_time(), rock(psi)
    result, moved, edge = excavated(law)
    exact = np.array([displacement(law, p) for p in PRESSURES])
    R = np.array([plastic_radius(law, p) for p in PRESSURES])
    error, iterations = np.abs(moved / exact - 1), [sum(stage.iterations) for stage in result][1:]
    at = result[f"{PRESSURES[-1]:g}"]
    print(
        f"psi {psi:g}: p_cr {critical(law):.2f} kPa; at {PRESSURES[-1]:g} kPa R {R[-1]:.5f}, found "
        f"{edge[-1]:.4f} m; wall {1e3 * exact[-1]:.4f}, found {1e3 * moved[-1]:.4f} mm; largest "
        f"error {error.max():.1e}; iterations {at.iterations}"
    )
    assert error.max() < 1e-3
    size = np.diff(radii)[np.maximum(np.searchsorted(radii, R) - 1, 0)]
    assert (np.abs(edge - R) <= size).all()
    assert (edge[np.array(PRESSURES) > critical(law)] == WALL).all()
    assert max(max(stage.iterations) for stage in result if stage.iterations) <= 5
    curves[psi] = exact, moved
    rows.append(
        {
            "method": f"psi = {psi:g}",
            "n": n,
            "unknowns": int(basis.N),
            "error": float(error.max()),
            "cpu_s": round(process_time() - begin, 2),
            "iterations": sum(iterations),
            "radius": round(edge[-1], 4),
            "exact_radius": round(R[-1], 5),
        }
    )

# %%
# Reaction curve and support
# --------------------------
# The lining is a shell of concrete, 20 cm thick, installed when a part of the displacement has
# happened: the longitudinal profile of N. Vlachopoulos and M. S. Diederichs (Rock Mech. Rock Eng.
# 42 (2009) 131-146) gives 2 m behind the face. Both curves meet at the equilibrium.

fig, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.8), layout="constrained")
for psi, (exact, moved) in curves.items():
    left.plot(1e3 * exact, PRESSURES, color="#1f4e8c", label="exact" if psi == 0 else None)
    left.plot(
        1e3 * moved,
        PRESSURES,
        "o",
        color="#d55e00",
        markersize=4,
        label="computed" if psi == 0 else None,
    )
law = rock(0.0)
largest, R = displacement(law, 0.0), plastic_radius(law, 0.0)


def profile(x):
    """Share of the displacement at a distance behind the face."""
    face = np.exp(-0.15 * R) / 3
    return np.where(
        x < 0, face * np.exp(np.minimum(x, 0)), 1 - (1 - face) * np.exp(-1.5 * np.maximum(x, 0) / R)
    )


E_C, NU_C, THICK = 20e6, 0.2, 0.2
inner = WALL - THICK
stiffness = E_C * (WALL**2 - inner**2) / ((1 + NU_C) * WALL * ((1 - 2 * NU_C) * WALL**2 + inner**2))
installed = float(profile(2.0)) * largest
support = brentq(lambda p: installed + p / stiffness - displacement(law, p), 0.0, P0)
print(f"support pressure {support:.0f} kPa at {1e3 * displacement(law, support):.2f} mm")
reach = np.linspace(installed, displacement(law, support), 2)
left.plot(1e3 * reach, stiffness * (reach - installed), "ks-", ms=4, label="lining")
left.set(xlabel="displacement of the wall [mm]", ylabel="support pressure [kPa]", ylim=(0, None))
left.legend(frameon=False)
x = np.linspace(-4, 10, 200)
right.plot(x, 1e3 * largest * profile(x), color="#1f4e8c")
right.set(xlabel="distance behind the face [m]", ylabel="displacement of the wall [mm]")
assert 0 < support < critical(law)
plt.show()

# %%
# Headline numbers
# ----------------
print(json.dumps({"case": "rock tunnel", "rows": rows}))
