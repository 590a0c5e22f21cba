r"""
Earthquake in layered ground: rock, free field and spectra
==========================================================

A box of sand on clay stands on elastic rock. An earthquake arrives from below as a shear wave.
Waves leave through dashpots at the base, and through the sides into the free field: columns of the
same ground that do not feel the box. The surface then moves alike everywhere, and like a single
column, whatever the width of the box.
"""

# %%
# Model
# -----
# All boundaries do nothing in stages without ``dynamic``, where supports hold the box.

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc

width, height = 60.0, 24.0
parts = {"clay": lambda x: x[1] < 12.0, "sand": lambda x: x[1] > 12.0}
mesh = MeshQuad.init_tensor(np.linspace(0, width, 21), np.linspace(0, height, 25))
basis = Basis(
    mesh.with_defaults().with_subdomains(parts), ElementVector(ElementQuad1()), intorder=2
)
soils = {"clay": sc.LinearElastic(E=1.2e5, nu=0.45), "sand": sc.LinearElastic(E=1.5e5, nu=0.3)}
ground = sc.SolidForm(basis, soils, unit_weight={"clay": 18.0, "sand": 20.0})

rock = sc.Bedrock(unit_weight=25.0, vs=900.0)
forms = {
    "ground": ground,
    "base": sc.ViscousBoundary(ground, "bottom", rock=rock),
    "left": sc.FreeField(ground, "left", rock=rock),
    "right": sc.FreeField(ground, "right", rock=rock),
}
model = sc.Model(forms, sc.box_supports(basis), gravity_acceleration=9.81)

# %%
# Earthquake
# ----------
# The record is the motion of an outcrop of the rock. The stage takes all supports away; their
# reactions stay as loads. Damping is 3 % near the first frequency and at 12 Hz.

record = sc.Record.synthetic(peak=2.0, duration=12.0, step=0.01, seed=3).filtered(high=15.0)
first = model.frequencies(1)[0]
surface = [(0.0, height), (width / 2, height)]
settings = sc.Dynamic(0.01, damping=sc.Rayleigh(0.03, f=(first, 12.0)), points=surface)
shake = sc.Stage("shake", duration=14.0, dynamic=settings, base=record, fixed=np.zeros(0, int))
result = model.run([sc.Stage("gravity"), shake])
print(result)

# %%
# Motion of the surface
# ---------------------

shaken = result["shake"]
side, middle = (shaken.history(point, "acceleration") for point in surface)
fig, (top, bottom) = plt.subplots(
    2, 1, sharex=True, sharey=True, figsize=(7, 5), layout="constrained"
)
top.plot(middle.time, middle.values[:, 0], lw=0.8)
top.set(ylabel="surface [m/s²]")
bottom.plot(record.time, record.values, "C1", lw=0.8)
bottom.set(xlabel="time [s]", ylabel="outcrop of rock [m/s²]")

# %%
# Response spectra
# ----------------
# The ground amplifies motions near its natural period.

periods = np.geomspace(0.05, 3.0, 120)
fig, ax = plt.subplots(figsize=(7, 4), layout="constrained")
felt = sc.Record(0.01, middle.values[:, 0])
for name, motion in (("surface", felt), ("outcrop of rock", record)):
    ax.semilogx(periods, motion.spectrum(periods, ratio=0.05).acceleration, label=name)
ax.axvline(1 / first, color="k", lw=0.5)
ax.set(xlabel="period [s]", ylabel="pseudo-acceleration, 5 % [m/s²]")
ax.legend(frameon=False)
print(f"peak {felt.peak:.2f} m/s² at the surface, {record.peak:.2f} m/s² on rock")
print(f"intensity of Arias {felt.arias(9.81):.2f} and {record.arias(9.81):.2f} m/s")

# %%
# Energy
# ------
# What the wave brings is damped in the ground or leaves into the rock.

energy = shaken.energy
fig, ax = plt.subplots(figsize=(7, 3.5), layout="constrained")
for name in ("work", "damping", "kinetic", "elastic"):
    ax.plot(energy["time"], energy[name] - energy[name][0], label=name)
ax.set(xlabel="time [s]", ylabel="energy [kJ/m]")
ax.legend(frameon=False)

# sphinx_gallery_start_ignore
import json

apart = np.abs(side.values - middle.values).max() / middle.largest
assert apart < 1e-4, apart
assert 1.2 < felt.peak / record.peak < 6.0
assert abs(energy["missing"]).max() < 0.02 * energy["damping"].max()
print(
    json.dumps(
        {
            "case": "site_response",
            "rows": [
                {
                    "method": "free field",
                    "n": 24,
                    "unknowns": int(model.layout.size),
                    "error": float(apart),
                    "cpu_s": None,
                    "iterations": sum(shaken.iterations),
                }
            ],
        }
    )
)
# sphinx_gallery_end_ignore
