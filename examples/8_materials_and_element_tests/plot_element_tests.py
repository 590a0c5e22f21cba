r"""
Laboratory tests of clay, rock and sand
=======================================

:func:`~skfem_contact.element_test` follows a material along a path of prescribed stresses and
strains, as a laboratory does with a sample. The tests of Modified Cam Clay are compared with closed
forms and quadratures of the law, those of Hoek-Brown with its strength, loops of sand at small
strains with Masing's rule, creep with the logarithm of time, and the undrained strengths of clay in
all directions of the plane with the ellipse of NGI-ADP.
"""

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

import skfem_contact as sc
from skfem_contact.laboratory import PathStep, isotropic, oedometer, simple_shear, triaxial

KAPPA, LAMBDA, M, NU, P = 0.02, 0.10, 1.2, 0.25, 100.0
SHEAR = 1.5 * (1 - 2 * NU) / (1 + NU) / KAPPA  # shear modulus over mean stress
rows = []


def timed(name, material, stress, path):
    """Result of an element test, and the row of its figures without an error."""
    begin = process_time()
    test = sc.element_test(material, stress, path)
    rows.append(
        {
            "method": name,
            "n": len(test.p) - 1,
            "unknowns": test.stress.shape[1],
            "error": None,
            "cpu_s": round(process_time() - begin, 3),
            "iterations": int(test.iterations.sum()),
        }
    )
    return test


def clay(OCR=1.0, **options):
    """Clay with an overconsolidation ratio."""
    return sc.CamClay(KAPPA, LAMBDA, M, NU, p_ref=P, OCR=OCR, **options)


# %%
# Isotropic compression and unloading
# -----------------------------------
# The logarithm of the volume falls by :math:`\lambda` and rises by :math:`\kappa` times the change
# of :math:`\ln p`: one increment is as exact as many.

for increments in (1, 10):
    test = timed(
        f"isotropic, {increments} increments",
        clay(),
        -P,
        [isotropic(-4 * P, increments), isotropic(-2 * P, increments)],
    )
    exact = -LAMBDA * np.log(4), -LAMBDA * np.log(4) + KAPPA * np.log(2)
    rows[-1]["error"] = float(np.abs(test.volume[[increments, -1], 0] / exact - 1).max())
    assert rows[-1]["error"] < 1e-9

# %%
# Undrained triaxial compression
# ------------------------------
# On the yield surface the volume stays if
# :math:`\lambda \ln(p / p_0) = (\lambda - \kappa) [\ln OCR - \ln(1 + \eta^2 / M^2)]`
# with the stress ratio :math:`\eta = q / p`. The path does not depend on the increments.
# Overconsolidated clay goes to the right of its initial stress, and ends at the same line, with the
# strength :math:`c_u = \tfrac12 M p_0 (OCR / 2)^{1 - \kappa / \lambda}` of the textbooks.
# Poisson's ratio is constant. With ``conservative=True`` the stiffness has a free energy, and the
# term :math:`\eta^2 / (6 g)` with :math:`g = G / p` is added on the right: the strength is
# larger by :math:`\exp(M^2 / (6 g \lambda))`.

undrained = {}
for OCR in (1.0, 1.5, 4.0):
    for increments in (50, 200):
        test = timed(
            f"undrained, OCR {OCR}, {increments} increments",
            clay(OCR),
            -P,
            triaxial(-0.3, drained=False, increments=increments),
        )
        on = test.variable("plastic strain")[:, 0] > 1e-6
        p, eta = test.p[on, 0], test.q[on, 0] / test.p[on, 0]
        exact = P * np.exp((1 - KAPPA / LAMBDA) * np.log(OCR / (1 + eta**2 / M**2)))
        rows[-1]["error"] = float(np.abs(p / exact - 1).max())
        assert rows[-1]["error"] < 1e-7
    strength = 0.5 * M * P * (OCR / 2) ** (1 - KAPPA / LAMBDA)
    print(f"OCR {OCR}: c_u = {test.q[-1, 0] / 2:.2f}, exact {strength:.2f} kPa")
    assert abs(test.q[-1, 0] / 2 / strength - 1) < 2e-3
    undrained[OCR] = test

path = triaxial(-0.3, drained=False, increments=100)
test = timed("undrained, conservative", clay(conservative=True), -P, path)
factor = np.exp(M**2 / (6 * SHEAR * LAMBDA))
ratio = test.q[-1, 0] / undrained[1.0].q[-1, 0]
print(f"conservative elasticity: c_u larger by {ratio:.4f}, exact {factor:.4f}")
rows[-1]["error"] = float(abs(ratio / factor - 1))
assert rows[-1]["error"] < 2e-3

# %%
# Drained triaxial compression
# ----------------------------
# The stress path is the straight line :math:`p = 3 p_0 / (3 - \eta)`. The plastic shear strain is a
# quadrature over the stress ratio. The flow is taken at the end of an increment: the error halves
# with the increments.


def shear_strain(eta):
    """Shear strain of drained compression up to a stress ratio."""

    def rate(x):
        return (1 / (3 - x) + 2 * x / (M**2 + x**2)) * 2 * x / (M**2 - x**2)

    return (LAMBDA - KAPPA) * quad(rate, 0, eta, epsabs=1e-12)[0] + np.log(3 / (3 - eta)) / SHEAR


errors = []
for increments in (50, 100, 200):
    test = timed(
        f"drained, {increments} increments", clay(), -P, triaxial(-0.1, increments=increments)
    )
    ratio, strain = test.q[-1, 0] / test.p[-1, 0], test.volume[-1, 0] / 3 - test.axial[-1, 0]
    exact = brentq(lambda x, s=strain: shear_strain(x) - s, 0.1, M - 1e-9)
    errors.append(abs(ratio / exact - 1))
    rows[-1]["error"] = float(errors[-1])
    assert np.abs(test.p[-1] * (3 - ratio) / (3 * P) - 1) < 1e-9
print("drained, relative errors of the stress ratio:", " ".join(f"{error:.1e}" for error in errors))
assert errors[-1] < 2e-3
assert 1.8 < errors[0] / errors[1] < 2.2
assert 1.8 < errors[1] / errors[2] < 2.2

# %%
# Many samples at once
# --------------------
# An array of stresses gives one sample each. The four diagrams show three cell pressures in drained
# compression, an unloading and a second compression.

several = timed(
    "three cell pressures",
    clay(),
    [-50.0, -100.0, -200.0],
    [triaxial(-0.06), triaxial(0.005, increments=10), triaxial(-0.1)],
)
several.plot()
assert np.ptp(several.q[-1] / several.p[-1]) < 1e-9  # the law has no length of stress

# %%
# Rock
# ----
# Hoek-Brown in triaxial compression, triaxial extension, oedometric compression and simple shear.
# The dilatancy of 20 degrees is capped by the friction of the tangent, which falls with the
# pressure.

rock = sc.HoekBrown(E=5.7e6, nu=0.25, sigma_ci=30e3, m_b=1.7, s=0.0039, a=0.51, psi=20.0)
cell = np.array([-0.5e3, -2e3, -8e3])


def excess(stress):
    """Principal stress difference over the strength, less one."""
    full = np.array(
        [
            [stress[0], stress[3], 0 * stress[0]],
            [stress[3], stress[1], 0 * stress[0]],
            [0 * stress[0], 0 * stress[0], stress[2]],
        ]
    )
    values = np.linalg.eigvalsh(full.transpose(2, 0, 1))
    strength = rock.sigma_ci * (rock.s - rock.m_b * values[:, 2] / rock.sigma_ci) ** rock.a
    return np.abs((values[:, 2] - values[:, 0]) / strength - 1).max()


for name, step in {
    "compression": triaxial(-0.02),
    "extension": triaxial(0.02),
    "simple shear": simple_shear(0.05),
    "oedometer": oedometer(strain=-0.05),
}.items():
    test = timed(f"rock, {name}", rock, cell, step)
    rows[-1]["error"] = float(excess(test.stress[-1]))
    assert rows[-1]["error"] < 1e-8

# %%
# Sand at small strains
# ---------------------
# :class:`~skfem_contact.HardeningSoil` with ``G0_ref`` and ``gamma_07``: dense sand is loaded in
# triaxial compression, unloaded, and goes through two cycles. From each reversal on, the secant
# modulus falls with the strain as
# :math:`G_0 / (1 + 0.385\, \gamma / (2 \gamma_{0.7}))`, since a loop is twice as large as the curve
# of first loading. At twice the threshold it is :math:`0.722\, G_0`. The loops close. Here the
# stiffness does not depend on the stress.

G0, THRESHOLD = 110e3, 2e-4
sand = sc.HardeningSoil(
    37e3, 29.6e3, 90e3, m=0.0, c=0.0, phi=41.0, psi=14.0, G0_ref=G0, gamma_07=THRESHOLD
)
constant_volume = {"xx": THRESHOLD * 2 / 3, "yy": -THRESHOLD * 4 / 3, "zz": THRESHOLD * 2 / 3}
back = {name: -value for name, value in constant_volume.items()}


def sheared(strain):
    """Step of a triaxial deviator without a change of volume, in 20 increments."""
    return sc.laboratory.PathStep(strain={**strain, "xy": 0.0}, increments=20)


path = [
    triaxial(-0.004, increments=40),
    sheared(back),
    *2 * [sheared(constant_volume), sheared(back)],
]
loops = timed("sand, loops at small strains", sand, -100.0, path)
q, tips = loops.stress[:, 0, 0] - loops.stress[:, 1, 0], 40 + 20 * np.arange(6)
secant = (q[tips[0]] - q[tips[1]]) / (2 * 2 * THRESHOLD)
rows[-1]["error"] = float(abs(secant / G0 * 1.385 - 1))
print(
    f"secant modulus at the threshold {secant / G0:.6f} of G_0, loop open by "
    f"{abs(q[tips[3]] - q[tips[1]]):.1e} kPa"
)
assert rows[-1]["error"] < 1e-6
assert np.abs(q[tips[3:]] - q[tips[1:4]]).max() < 1e-6 * np.abs(q).max()

# %%
# Secondary compression
# ---------------------
# An oedometer sample of Soft Soil Creep under a constant load, at the stress ratio whose flow has
# no lateral strain. The axial strain is :math:`\mu \ln(1 + (1 - \eta^2 / M^2)\, t / \tau)`, a
# straight line over the logarithm of time.

MU, DAY = 0.004, 1.0
eta = (9 + 4 * M**2) ** 0.5 / 2 - 1.5
lateral = (1 - eta / 3) / (1 + 2 * eta / 3)
held = [
    PathStep(
        stress={"yy": None}, strain={"xx": 0.0, "zz": 0.0, "xy": 0.0}, increments=1, duration=days
    )
    for days in np.diff(np.geomspace(1e-2, 1e4, 25), prepend=0.0)
]
creeping = sc.SoftSoilCreep(KAPPA, LAMBDA, M, NU, p_ref=P, mu=MU, tau=DAY)
creep = timed(
    "Soft Soil Creep, 24 steps of time",
    creeping,
    -P * np.array([[lateral], [1.0], [lateral], [0.0]]),
    held,
)
days, strain = np.geomspace(1e-2, 1e4, 25), -creep.axial[1:, 0]
exact = MU * np.log1p((1 - (eta / M) ** 2) * days / DAY)
rows[-1]["error"] = float(np.abs(strain / exact - 1).max())
slope = (strain[-1] - strain[-5]) / (MU * np.log(10.0))
print(f"creep of the last decade {slope:.5f} mu ln(10), error of the curve {rows[-1]['error']:.1e}")
assert rows[-1]["error"] < 1e-6 and abs(slope - 1) < 1e-3

# %%
# Strength by direction
# ---------------------
# Clay that is weaker in simple and in passive shearing (NGI-ADP), strained in 24 directions of the
# plane from its stress at rest. All of them end on the ellipse through the three strengths.

anisotropic = sc.NgiAdp.from_ratios(
    20.0, s_uDSS=0.7, s_uP=0.4, G_ur=500.0, gamma_A=0.01, gamma_DSS=0.02, gamma_P=0.04
)
angle = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
pushed = PathStep(
    strain={
        "xx": 0.3 * np.cos(angle),
        "yy": -0.3 * np.cos(angle),
        "zz": 0.0,
        "xy": 0.6 * np.sin(angle),
    },
    increments=50,
)
at_rest = np.tile(-np.array([[60.0], [80.0], [60.0], [0.0]]), 24)
ellipse = timed("NGI-ADP, 24 directions", anisotropic, at_rest, pushed)
t, tau = (ellipse.stress[:, 0] - ellipse.stress[:, 1]) / 2, ellipse.stress[:, 3]
active, dss, passive = anisotropic.s_uA, anisotropic.s_uDSS, anisotropic.s_uP
across = (2 * t[-1] - active + passive) / (active + passive)
rows[-1]["error"] = float(np.abs(np.hypot(across, tau[-1] / dss) - 1).max())
print(f"distance from the ellipse of strengths {rows[-1]['error']:.1e}")
assert rows[-1]["error"] < 1e-5

# %%
# Undrained paths
# ---------------

fig, ax = plt.subplots(figsize=(6, 4), layout="constrained")
for OCR, test in undrained.items():
    ax.plot(test.p, test.q, label=f"OCR {OCR:g}")
ax.plot([0, 150], [0, M * 150], "k--", linewidth=0.8, label="critical state")
ax.set(xlabel="p' [kPa]", ylabel="q [kPa]", xlim=(0, 180), ylim=(0, 200))
ax.legend(frameon=False)

# %%
# Loops of the sand
# -----------------

fig, ax = plt.subplots(figsize=(6, 4), layout="constrained")
ax.plot(1e3 * (loops.strain[40:, 0, 0] - loops.strain[40:, 1, 0]), q[40:])
ax.set(xlabel="shear strain [1/1000]", ylabel="q [kPa]")

# %%
# Creep, and paths to the ellipse of strengths
# --------------------------------------------

fig, axes = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
axes[0].semilogx(days, 100 * strain, "o", markersize=3, label="element test")
axes[0].semilogx(days, 100 * exact, linewidth=0.8, label="exact")
axes[0].set(xlabel="time [days]", ylabel="axial strain [%]")
axes[0].invert_yaxis()
axes[0].legend(frameon=False)
axes[1].plot(t, tau, linewidth=0.8)
axes[1].plot(t[-1], tau[-1], "k.")
axes[1].set(xlabel="half of (xx - yy) [kPa]", ylabel="shear stress xy [kPa]", aspect="equal")
plt.show()

# %%
# Headline numbers
# ----------------
print(json.dumps({"case": "element tests", "rows": rows}))
