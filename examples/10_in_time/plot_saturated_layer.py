r"""
Saturated ground in motion: drained, undrained and between
==========================================================

A pressure pulsates on a saturated layer on rock. Pores that drain at once leave the motion of the
skeleton. Pores that do not drain stiffen the layer by their water. Between both, water flows with
every cycle and damps the motion. Displacements and pore pressures are compared with the exact
solution over seven decades of the permeability.
"""

# %%
# Exact solution
# --------------
# With the displacement u, the pressure p and the flow by Darcy's law,
#
# .. math:: M u'' - p' + \omega^2 \rho u = 0, \qquad
#           i \omega (u' + S p) = \frac{k}{\gamma_w} p'' .
#
# Two exponentials in depth meet the drained top and the tight base (Zienkiewicz, Chang and Bettess
# 1980). Rayleigh damping makes M and the density complex.

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad2, ElementVector, MeshQuad

import skfem_contact as sc

H, M, rho, S = 10.0, 1e5, 2.0, 2e-7  # m, kPa, t/m3, 1/kPa
g, weight_of_water = 10.0, 10.0
first = 0.5 * np.pi * np.sqrt(M / rho) / H  # angular frequency of the dry skeleton
omega = 0.8 * first
damping = sc.Rayleigh(0.05, f=(omega / (2 * np.pi), 20.0))


def exact(k):
    """Displacement of the top and pressure at the base by a pressure of 1, complex."""
    modulus = M * (1 + 1j * omega * damping.beta)
    density = rho * (1 - 1j * damping.alpha / omega)
    b = k / weight_of_water / (1j * omega)
    # u = sum A sinh(l z), p = sum A r cosh(l z): l^2 from the determinant, r from the second row
    a0 = omega**2 * density
    squares = np.roots([modulus * b, -modulus * S + a0 * b - 1.0, -a0 * S])
    rate = np.sqrt(squares.astype(complex))
    r = -rate / (S - b * squares)
    # hyperbolic functions at the top over exp(l H)
    cosh, sinh = (0.5 * (1 + sign * np.exp(-2 * rate * H)) for sign in (1, -1))
    A = np.linalg.solve([modulus * rate * cosh, r * cosh], [-1.0, 0.0])
    return A @ sinh, (A * r) @ np.exp(-rate * H)


# %%
# Finite elements
# ---------------
# Elements are finer towards the drained top, where the pressure changes most. The layer first rests
# under its weight.

z = H * (1.0 - np.linspace(1.0, 0.0, 17) ** 2)
mesh = MeshQuad.init_tensor(np.array([0.0, 0.5]), z).with_defaults()
basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
top = basis.get_dofs("top").all("u^2")[0]
base = int(np.argmin(mesh.p[1]))
period = 2 * np.pi / omega
unit = sc.traction(basis, "top", (0.0, -1.0))


def load(time):
    """A pressure that swells for four periods."""
    return min(time / (4 * period), 1.0) * np.sin(omega * time) * unit


def shaken(k):
    """Amplitudes of displacement and pressure in the last two of ten periods, and iterations."""
    soil = sc.SolidForm(basis, sc.LinearElastic(E=M, nu=0.0), unit_weight=rho * g)
    water = sc.PoreWater(basis, k, unit_weight=weight_of_water, storage=S)
    fixed = [basis.get_dofs("bottom").all(), basis.get_dofs().all("u^1"), water.dofs("top")]
    model = sc.Model({"soil": soil, "water": water}, fixed, gravity_acceleration=g)
    slow = 1e3 * H**2 * weight_of_water / (k * M)
    rest = [sc.Stage("weight", duration=slow), sc.Stage("rest", duration=slow)]
    settings = sc.Dynamic(period / 60, mass="consistent", damping=damping)
    shake = sc.Stage("shake", load, duration=10 * period, dynamic=settings, keep="all")
    result = model.run([*rest, shake], progress=False)
    kept = [each for each in result["shake"].increments if each.fraction > 0.8 - 1e-9]
    time = np.array([each.time for each in kept]) - result["rest"].time
    x = np.array([each.x for each in kept]) - result["rest"].x
    found = x[:, [top, model.forms["water"].first + base]]
    # the harmonic part, beside what fades
    late = (time - 9 * period) / period
    columns = [np.sin(omega * time), np.cos(omega * time), *(late**j for j in range(4))]
    parts = np.linalg.lstsq(np.column_stack(columns), found, rcond=None)[0]
    return parts[0] + 1j * parts[1], sum(result["shake"].iterations)


conductive = [1e-4, 1e-3, 5e-3]
runs = [shaken(k) for k in conductive]
found = np.array([amplitudes for amplitudes, _ in runs])

# %%
# From tight to open pores
# ------------------------
# Displacements are over the static one, pressures over the load. The inertia of the water itself is
# left out. Its share of the resistance to flow is omega k rho / gamma_w, 0.03 in the last run.
# Results with larger shares have a remark; the solution from 0.1 on, grey, is no good one.

k = np.geomspace(1e-7, 1.0, 200)
wanted = np.array([exact(each) for each in k])
fig, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
scales = H / M, 1.0
for ax, j, name in zip(axes, (0, 1), ("displacement of the top", "pore pressure at the base")):
    ax.semilogx(k, np.abs(wanted[:, j]) / scales[j], label="exact")
    ax.semilogx(conductive, np.abs(found[:, j]) / scales[j], "o", label="finite elements")
    ax.axvspan(0.1 * weight_of_water / (omega * rho), k[-1], color="0.9")
    ax.set(xlabel="permeability (m/s)", title=name)
axes[0].legend(frameon=False)

for each, (u, p) in zip(conductive, found):
    u_exact, p_exact = exact(each)
    print(
        f"k {each:.0e} m/s: displacement {abs(u) * M / H:.4f} (exact {abs(u_exact) * M / H:.4f}), "
        f"pressure {abs(p):.4f} ({abs(p_exact):.4f})"
    )

# sphinx_gallery_start_ignore
import json

right = np.array([exact(each) for each in conductive])
errors = np.abs(found - right) / np.abs(right)
assert errors.max() < 0.01, errors
print(
    json.dumps(
        {
            "case": "saturated_layer",
            "rows": [
                {
                    "method": f"k {each:g}",
                    "n": 16,
                    "unknowns": int(basis.N + mesh.nvertices),
                    "error": float(error),
                    "cpu_s": None,
                    "iterations": int(iterations),
                }
                for each, error, (_, iterations) in zip(conductive, errors.max(axis=1), runs)
            ],
        }
    )
)
# sphinx_gallery_end_ignore
