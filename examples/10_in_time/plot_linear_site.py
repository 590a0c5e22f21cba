r"""
Linear site response: exact transfer functions and pystrata
===========================================================

Two layers on elastic rock are shaken by a record of the outcrop. The linear response of a column is
compared with the exact transfer function of its layers, and with the program pystrata, which
multiplies the spectrum of the record by it.
"""

# %%
# Profile
# -------
# Without damping of the soil all energy leaves into the rock, and three methods have the same
# assumptions. With damping, Rayleigh's ratio depends on the frequency, and pystrata's does not:
# every mode is compared with the ratio at its own frequency.

import sys
from itertools import pairwise

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad2, ElementVector, MeshQuad

import skfem_contact as sc

g = 9.81
layers = [
    (12.0, 17.0, 180.0),
    (18.0, 19.0, 320.0),
]  # thickness (m), unit weight, vs (m/s), from top
rock = sc.Bedrock(unit_weight=24.0, vs=800.0)
record = sc.Record.synthetic(peak=1.0, duration=10.0, step=0.0025, seed=5).filtered(high=12.0)


# %%
# Exact transfer function
# -----------------------
# Waves up and down in each layer, from the free surface to the rock (Kramer 1996, section 7.2.1.5).
# Rayleigh damping makes modulus and density complex.


def amplification(frequency, damping=None):
    """Surface over outcrop of rock, complex, (n,)."""
    omega = 2.0 * np.pi * np.asarray(frequency, dtype=complex)
    up = down = np.ones_like(omega)
    waves = []
    for thickness, unit_weight, vs in layers:
        density = unit_weight / g * np.ones_like(omega)
        modulus = unit_weight / g * vs**2 * np.ones_like(omega)
        if damping is not None:
            density *= 1 - 1j * damping.alpha / omega
            modulus *= 1 + 1j * damping.beta * omega
        waves.append((thickness, omega * np.sqrt(density / modulus), np.sqrt(density * modulus)))
    waves.append((0.0, omega / rock.vs, rock.unit_weight / g * rock.vs))
    for (thickness, number, impedance), (_, _, below) in pairwise(waves):
        ratio = impedance / below
        shift = np.exp(1j * number * thickness)
        up, down = (
            0.5 * up * (1 + ratio) * shift + 0.5 * down * (1 - ratio) / shift,
            0.5 * up * (1 - ratio) * shift + 0.5 * down * (1 + ratio) / shift,
        )
    return 1.0 / up


fine = np.linspace(0.2, 15.0, 3000)
size = np.abs(amplification(fine))
modes = fine[1:-1][(size[1:-1] > size[:-2]) & (size[1:-1] > size[2:])][:3].round(3)
damping = sc.Rayleigh(0.03, f=(modes[0], modes[2]))
print("modes at", *modes, "Hz, damping ratios", *(round(damping.at(f), 5) for f in modes))

# %%
# Finite elements
# ---------------
# One column of quadratic elements, which moves sideways alone.

height = sum(thickness for thickness, _, _ in layers)
mesh = MeshQuad.init_tensor(np.array([0.0, 0.5]), np.linspace(0.0, height, 41))
level = layers[1][0]
parts = {"upper": lambda x: x[1] > level, "lower": lambda x: x[1] < level}
mesh = mesh.with_defaults().with_subdomains(parts)
basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
soils, weights = {}, {}
for name, (_, unit_weight, vs) in zip(("upper", "lower"), layers):
    soils[name] = sc.LinearElastic(E=2.6 * unit_weight / g * vs**2, nu=0.3)
    weights[name] = unit_weight
ground = sc.SolidForm(basis, soils, unit_weight=weights)
base = sc.ViscousBoundary(ground, "bottom", rock=rock)
held = basis.get_dofs().all("u^2")
model = sc.Model(
    {"ground": ground, "base": base},
    [basis.get_dofs("bottom").all(), held],
    gravity_acceleration=g,
)


def surface(damping=None):
    """Acceleration of the surface at the times of the record and 5 s more."""
    settings = sc.Dynamic(
        record.step,
        rho_inf=1.0,
        mass="consistent",
        damping=damping,
        points=[(0.0, height)],
    )
    shake = sc.Stage("shake", duration=15.0, dynamic=settings, base=record, fixed=held)
    result = model.run([sc.Stage("rest"), shake], progress=False)
    return result["shake"].history((0.0, height), "acceleration")


def ratio(motion, frequency):
    """Surface over outcrop at some frequencies, by sums of both records, complex."""
    waves = np.exp(-2j * np.pi * np.outer(frequency, motion.time))
    outcrop = np.zeros(len(motion.time))
    outcrop[: len(record.values)] = record.values
    return (waves @ motion.values[:, 0]) / (waves @ outcrop)


undamped = surface()
damped = surface(damping)

# %%
# pystrata
# --------
# Its numbers, by version 0.5.4, are stored; ``--pystrata`` computes them again where it is
# installed, also by its equivalent linear calculator, whose iterations change nothing here. The
# undamped motion is in m/s² at every tenth step from 2.5 s on.

stored = {
    "undamped": [4.74501, 3.94792, 5.57253],
    "damped": [3.94866, 3.0595, 2.70838],
    "peak": 2.92986,
    "motion": [
        *(1.94466, 2.43281, 2.57031, 1.95441, 0.72223, -0.60873, -1.38588, -1.16145, -0.5337),
        *(-0.31773, -0.45683, -0.59467, -0.44483, -0.10382, 0.20906, 0.32584, 0.42853, 0.64653),
        *(0.67468, 0.65865),
    ],
}


def by_pystrata():
    """Amplifications at the modes without and with damping, and the motion of the surface."""
    from pystrata import motion, propagation, site

    shaken = motion.TimeSeriesMotion("", "", record.step, record.values / g, fa_length=2**16)

    def amplified(z, calculator):
        soils = [
            site.Layer(site.SoilType("", unit_weight, None, z), thickness, vs)
            for thickness, unit_weight, vs in layers
        ]
        soils.append(site.Layer(site.SoilType("", rock.unit_weight, None, 0.0), 0.0, rock.vs))
        profile = site.Profile(soils)
        outcrop = profile.location("outcrop", index=-1)
        calculator(shaken, profile, outcrop)
        return calculator.calc_accel_tf(outcrop, profile.location("outcrop", index=0))

    def at(frequency, transfer):
        return float(np.interp(frequency, shaken.freqs, np.abs(transfer)))

    linear = propagation.LinearElasticCalculator()
    whole = amplified(0.0, linear)
    equivalent = amplified(0.0, propagation.EquivalentLinearCalculator())
    assert np.abs(equivalent - whole).max() < 1e-12
    moved = shaken.calc_time_series(whole) * g
    return {
        "undamped": [at(f, whole) for f in modes],
        "damped": [at(f, amplified(damping.at(f), linear)) for f in modes],
        "peak": float(np.abs(moved).max()),
        "motion": moved[1000:1200:10],
    }


if "--pystrata" in sys.argv:
    live = by_pystrata()
    for name, values in stored.items():
        np.testing.assert_allclose(live[name], values, atol=1e-4)
    print("pystrata has the stored numbers")

# %%
# Amplification
# -------------

fig, ax = plt.subplots(figsize=(7, 4), layout="constrained")
for name, motion, given in (("undamped", undamped, None), ("damped", damped, damping)):
    (line,) = ax.plot(fine, np.abs(amplification(fine, given)), lw=0.8, label=f"{name}, exact")
    ax.plot(modes, np.abs(ratio(motion, modes)), "o", color=line.get_color(), mfc="none")
    ax.plot(modes, stored[name], "x", color=line.get_color())
ax.plot([], [], "ko", mfc="none", label="finite elements")
ax.plot([], [], "kx", label="pystrata")
ax.set(xlabel="frequency [Hz]", ylabel="surface over outcrop")
ax.legend(frameon=False)

exact = {
    "undamped": np.abs(amplification(modes)),
    "damped": np.abs(amplification(modes, damping)),
}
own = {"undamped": np.abs(ratio(undamped, modes)), "damped": np.abs(ratio(damped, modes))}
print("                  mode  finite elements  exact  pystrata")
for name, values in own.items():
    for k, value in enumerate(values):
        print(f"{name:>17} {k + 1:5} {value:16.4f} {exact[name][k]:6.4f} {stored[name][k]:9.4f}")

# %%
# Motion of the surface
# ---------------------

fig, ax = plt.subplots(figsize=(7, 3.5), layout="constrained")
ax.plot(undamped.time, undamped.values[:, 0], lw=0.8, label="finite elements")
part = undamped.time[1000:1200:10]
ax.plot(part, stored["motion"], "x", label="pystrata")
ax.set(xlim=(1.5, 4.0), xlabel="time [s]", ylabel="surface [m/s²]")
ax.legend(frameon=False)
print(f"peak {undamped.largest:.4f} m/s², by pystrata {stored['peak']:.4f} m/s²")

# sphinx_gallery_start_ignore
import json

errors = {}
for name in own:
    errors[f"{name}, exact"] = np.abs(own[name] / exact[name] - 1).max()
    errors[f"{name}, pystrata"] = np.abs(own[name] / np.array(stored[name]) - 1).max()
apart = np.abs(undamped.values[1000:1200:10, 0] - stored["motion"]).max()
errors["motion, pystrata"] = max(apart, abs(undamped.largest - stored["peak"])) / stored["peak"]
assert max(errors.values()) < 0.01, errors
print(
    json.dumps(
        {
            "case": "linear_site",
            "rows": [
                {
                    "method": name,
                    "n": 40,
                    "unknowns": int(basis.N),
                    "error": float(error),
                    "cpu_s": None,
                    "iterations": None,
                    **({"peer": "pystrata 0.5.4"} if "pystrata" in name else {}),
                }
                for name, error in errors.items()
            ],
        }
    )
)
# sphinx_gallery_end_ignore
