r"""
How to add a material
=====================

A material is a small immutable class with two functions: its elasticity, and an ``update`` that
returns the stress after a strain increment. It declares its memory, and how this memory follows
from the stresses in the ground. Nothing has to be registered, and nothing changes while Newton's
method iterates: ``update`` is a pure function of the increment and of the accepted state.

The example adds a clay with a cap: its pores close for good where the pressure exceeds the largest
one that the clay has ever borne, the preconsolidation pressure. One implementation serves plane
strain, axial symmetry and, with six components, three dimensions.
"""

import json
from dataclasses import dataclass
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad2, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact import plot
from skfem_contact.materials import Update

# %%
# The law
# -------
# Tension is positive, the components are (xx, yy, zz, xy[, yz, zx]), and shear strains are
# engineering strains. Arrays are (components, anything), so there is no loop over points.
#
# Shear is limited by the cylinder of :class:`~skfem_contact.VonMises`, from which the law derives.
# Where the trial pressure :math:`p` exceeds the preconsolidation pressure :math:`p_c`, the volume
# shrinks by
# :math:`\Delta\varepsilon_v = (p - p_c) / (K + H)`, and :math:`p_c` grows by
# :math:`H \Delta\varepsilon_v`. The bulk modulus of the consistent tangent is then
# :math:`K - K^2 / (K + H)`.
#
# ``internal`` declares the memory; a variable that is returned but not declared is refused.
# ``initial_internal`` gives its values when an analysis starts from given stresses: here the clay
# has once borne ``ocr`` times its pressure. ``tangent`` is a function: a line search, which asks
# for stresses alone, never pays for it. It concerns the points in ``plastic`` only, all others keep
# their elastic stiffness.


@dataclass(frozen=True, eq=False)
class CapClay(sc.VonMises):
    """Linear elasticity, von Mises plasticity, and a cap that hardens linearly with the plastic
    volume.
    """

    hardening: float = 500.0
    ocr: float = 1.0
    internal = (
        sc.Internal("plastic strain"),
        sc.Internal("preconsolidation pressure", initial=1.0, unit="kPa"),
    )

    def initial_internal(self, stress):
        """Return the memory of ground under a stress."""
        values = super().initial_internal(stress)
        values[1] = np.maximum(-self.ocr * stress[:3].mean(axis=0), values[1])
        return values

    def update(self, strain_increment, stress, internal):
        """Return to the cylinder, then to the cap."""
        sheared = super().update(strain_increment, stress, internal[:1])
        bulk = self.lame[0] + 2 / 3 * self.lame[1]
        volume = np.maximum(-sheared.stress[:3].mean(axis=0) - internal[1], 0.0) / (
            bulk + self.hardening
        )
        new = sheared.stress.copy()
        new[:3] += bulk * volume
        memory = np.stack((sheared.internal[0] + volume, internal[1] + self.hardening * volume))
        capped = volume.ravel() > 0
        plastic = np.union1d(sheared.plastic, np.flatnonzero(capped))

        def tangent():
            moduli = np.tile(self.elasticity(len(stress)), (capped.size, 1, 1))
            moduli[sheared.plastic] = sheared.tangent()
            moduli[capped, :3, :3] -= bulk**2 / (bulk + self.hardening)
            return moduli[plastic]

        return Update(new, memory, plastic, tangent)


# %%
# Is it right?
# ------------
# :func:`~skfem_contact.testing.check_material` checks the law on random paths. Arguments must not
# change, the returned stress must be admissible, the tangent must be the derivative of the stress,
# and plastic flow must dissipate. The largest error of the tangent is returned.

clay = CapClay(E=6e3, nu=0.25, strength=70.0)
for components in (4, 6):
    print(
        f"{components} components: "
        f"{sc.testing.check_material(clay, strain=1e-2, ncomp=components):.1e}"
    )

# %%
# The oedometer has a closed form. A sample that starts under a vertical stress of 40 kPa with K0 =
# 0.8 and has once borne 1.5 times its pressure is loaded, unloaded and loaded again. The curve
# bends where the pressure reaches the preconsolidation pressure, for the second time at the largest
# stress before.

begin = process_time()
basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad2()), intorder=4)
firm = CapClay(E=6e3, nu=0.25, strength=1e3, ocr=1.5)
sample = sc.Model({"sample": sc.SolidForm(basis, firm)}, sc.box_supports(basis, base="rollers"))
unit = sc.traction(basis, "top", (0.0, -1.0))
start = sample.k0_state(40 * unit, unit_weights=0.0, K0=0.8, surcharge=40.0)
levels = np.array([*range(50, 151, 10), *range(140, 59, -20), *range(80, 201, 10)], dtype=float)
stages = [sc.Stage(f"{k}", level * unit) for k, level in enumerate(levels)]
result = sample.run(stages, start=start, progress=False)
computed = np.array([-stage.states["sample"].strain[1].mean() for stage in result])[1:]

shear, bulk = firm.lame[1], firm.lame[0] + 2 / 3 * firm.lame[1]
elastic = bulk + 4 / 3 * shear
plastic = bulk * firm.hardening / (bulk + firm.hardening) + 4 / 3 * shear
pressure = 40 * (1 + 2 * 0.8) / 3
bend = 40 + 0.5 * pressure * elastic / bulk  # vertical stress at the preconsolidation pressure
largest = np.maximum.accumulate(np.maximum(levels, bend))
exact = (levels - 40) / elastic + (largest - bend) * (1 / plastic - 1 / elastic)
error = float(np.abs(computed - exact).max() / exact.max())
print(f"largest error in strain: {error:.1e} of the largest strain")
assert error < 1e-10

fig, ax = plt.subplots(figsize=(6, 3.8), layout="constrained")
ax.plot(np.append(40, levels), -100 * np.append(0, exact), color="#1f4e8c", label="exact")
ax.plot(levels, -100 * computed, "o", color="#d55e00", markersize=4, label="computed")
ax.set(xlabel="vertical stress [kPa]", ylabel="vertical strain [%]")
ax.grid(color="#dddddd", linewidth=0.6)
ax.legend(frameon=False)

# %%
# A load on ground with a history
# -------------------------------
# A strip of 60 kPa on 8 m of clay, normally consolidated and overconsolidated. The K0 procedure
# fills the memory of every point from its own stress. Newton's method converges in a few
# iterations, because the tangent is consistent.

rows = [
    {
        "method": "oedometer",
        "n": 2,
        "unknowns": int(basis.N),
        "error": error,
        "cpu_s": round(process_time() - begin, 2),
        "iterations": sum(sum(stage.iterations) for stage in result),
    }
]
mesh = MeshQuad.init_tensor(np.linspace(0, 16, 17), np.linspace(-8, 0, 9)).with_defaults()
mesh = mesh.with_boundaries({"strip": lambda x: (x[1] > -1e-9) & (x[0] < 3)})
basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
strip, settlement = sc.traction(basis, "strip", (0.0, -60.0)), {}
for ocr in (1.0, 2.0):
    begin = process_time()
    clay = CapClay(E=6e3, nu=0.25, strength=70.0, ocr=ocr)
    ground = sc.Model({"clay": sc.SolidForm(basis, clay, unit_weight=18.0)}, sc.box_supports(basis))
    start = ground.k0_state(K0=0.7)
    stage = ground.run([sc.Stage("strip", strip, increments=4)], start=start, progress=False)[
        "strip"
    ]
    settlement[ocr] = -1e3 * float(stage.x[1::2].min())
    print(
        f"ocr {ocr}: {settlement[ocr]:.0f} mm, {stage.summary['clay']}, iterations "
        f"{stage.iterations}"
    )
    assert max(stage.iterations) <= 8
    rows.append(
        {
            "method": f"strip, ocr {ocr}",
            "n": 16,
            "unknowns": int(basis.N),
            "error": None,
            "cpu_s": round(process_time() - begin, 2),
            "iterations": sum(stage.iterations),
            "settlement_mm": round(settlement[ocr], 1),
        }
    )
assert settlement[1.0] > 1.5 * settlement[2.0]
plot.contour(stage, "plastic")

# %%
# Materials whose strength shall be reduced by :func:`~skfem_contact.strength_reduction` have a
# method ``reduced(factor, flow)`` besides, which this law has from ``VonMises``. All further
# questions have defaults in
# :class:`~skfem_contact.Material`: elasticity that depends on the stress, creep, the mobilised
# strength, bounds.
#
# Figures
# -------

print(json.dumps({"case": "own_material", "rows": rows}))
