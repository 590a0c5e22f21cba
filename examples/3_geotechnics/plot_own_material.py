r"""
How to add a material
=====================

A material is a small immutable class with three things: the number of its internal variables, its elasticity, and an
``update`` that answers a strain increment with a stress. Nothing has to be registered, and nothing changes while
Newton's method iterates: ``update`` is a pure function of the increment and of what has been accepted.

The example adds von Mises plasticity with linear hardening, a metal or a stiff clay whose strength grows with the
plastic strain. One implementation serves plane strain, axial symmetry and, with six components, three dimensions.
"""

import json
from dataclasses import dataclass
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad2, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact.materials import Update
from skfem_contact.materials.elastic import Isotropic

# %%
# The law
# -------
# Tension is positive, the components are (xx, yy, zz, xy[, yz, zx]), and shear strains are engineering strains.
# Arrays are (components, anything), so there is no loop over points.
#
# The elastic trial stress has the deviator :math:`s`, :math:`q = \sqrt{3/2\, s:s}`. Where q exceeds the strength
# :math:`\sigma_y + H\bar\varepsilon`, the deviator shrinks along itself, by
# :math:`\Delta\bar\varepsilon = (q - \sigma_y - H\bar\varepsilon) / (3G + H)` of plastic strain. With
# :math:`\beta = 1 - 3 G \Delta\bar\varepsilon / q` and :math:`n = s / \sqrt{s:s}` the consistent tangent is
#
# .. math:: K\, 1 \otimes 1 + 2 G \beta\, I_{dev} - 2 G \Big(\frac{3G}{3G + H} - (1 - \beta)\Big) n \otimes n .
#
# ``tangent`` is a function: a line search, which asks for stresses alone, never pays for it. It speaks of the
# points in ``plastic`` only, all others keep their elastic stiffness.


@dataclass(frozen=True, eq=False)
class HardeningVonMises(Isotropic):
    """Linear elasticity, von Mises plasticity, linear isotropic hardening."""

    strength: float
    hardening: float = 0.0

    @property
    def n_internal(self):
        """The equivalent plastic strain."""
        return 1

    def update(self, strain_increment, stress, internal):
        """Radial return."""
        trial = self.elastic_stress(strain_increment, stress)
        mean = trial[:3].mean(axis=0)
        deviator = trial.copy()
        deviator[:3] -= mean
        norm = np.sqrt((deviator[:3] ** 2).sum(axis=0) + 2 * (deviator[3:] ** 2).sum(axis=0))
        shear = self.lame[1]
        excess = np.sqrt(1.5) * norm - self.strength - self.hardening * internal[0]
        strain = np.maximum(excess, 0.0) / (3 * shear + self.hardening)
        kept = 1 - np.sqrt(6) * shear * strain / np.where(norm > 0, norm, 1.0)
        new = kept * deviator
        new[:3] += mean
        plastic = np.flatnonzero(strain > 0)

        def tangent():
            n = (deviator.reshape(len(trial), -1) / norm.ravel())[:, plastic]
            beta = kept.ravel()[plastic]
            bulk = np.zeros((len(trial), len(trial)))
            bulk[:3, :3] = self.lame[0] + 2 * shear / 3
            unit = np.diag([1.0] * 3 + [0.5] * (len(trial) - 3))  # engineering shear strains
            unit[:3, :3] -= 1 / 3
            turn = 3 * shear / (3 * shear + self.hardening) - (1 - beta)
            along = np.einsum("ip,jp->pij", n, n)
            return bulk + 2 * shear * (beta[:, None, None] * unit - turn[:, None, None] * along)

        return Update(new, internal + strain, plastic, tangent)


# %%
# Is it right?
# ------------
# :func:`~skfem_contact.testing.check_material` checks the law on random paths. Arguments must not change, the returned
# stress must be admissible, the tangent must be the derivative of the stress, and plastic flow must dissipate. The
# largest error of the tangent is returned.

steel = HardeningVonMises(E=2e5, nu=0.3, strength=200.0, hardening=5e3)
for components in (4, 6):
    print(f"{components} components: {sc.testing.check_material(steel, ncomp=components):.1e}")

# %%
# Simple shear has a closed form: beyond the strength :math:`\sigma_y / \sqrt 3` the slope is
# :math:`G H / (3 G + H)`. A square is sheared there and back again.

begin = process_time()
basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad2()), intorder=4)
forms = {"square": sc.SolidForm(basis, steel)}
edge = basis.get_dofs().all()
amplitudes = np.concatenate((np.linspace(0, 0.01, 11)[1:], np.linspace(0.01, 0.002, 9)[1:]))
stages = []
for k, gamma in enumerate(amplitudes):
    x = basis.zeros()
    x[0::2] = gamma * basis.doflocs[1, 0::2]
    stages.append(sc.Stage(f"{k}", basis.zeros(), prescribed=x))
result = sc.Model(forms, edge).run(stages)
computed = np.array([stage.states["square"].stress[3].mean() for stage in result])

shear = steel.lame[1]
first = steel.strength / np.sqrt(3)
slope = shear * steel.hardening / (3 * shear + steel.hardening)
loading = np.where(shear * amplitudes < first, shear * amplitudes, first + slope * (amplitudes - first / shear))
exact = np.where(np.arange(len(amplitudes)) < 10, loading, np.nan)
peak = loading[9]
exact[10:] = np.maximum(peak - shear * (0.01 - amplitudes[10:]),
                        -peak - slope * (0.01 - 2 * peak / shear - amplitudes[10:]))  # fmt: skip
error = float(np.abs(computed / peak - exact / peak).max())
print(f"largest error in shear: {error:.1e} of the largest stress")
assert error < 1e-10

fig, ax = plt.subplots(figsize=(6, 3.8), layout="constrained")
ax.plot(np.append(0, 100 * amplitudes), np.append(0, exact), color="#1f4e8c", label="exact")
ax.plot(100 * amplitudes, computed, "o", color="#d55e00", markersize=4, label="computed")
ax.set(xlabel="shear strain [%]", ylabel="shear stress [MPa]")
ax.grid(color="#dddddd", linewidth=0.6)
ax.legend(frameon=False)

# %%
# Newton's method with it
# -----------------------
# A bar with a notch is drawn out, in plane strain and as a round bar in axial symmetry. Newton's method converges
# in a few iterations, because the tangent is consistent.

rows = [{"method": "simple shear", "n": 2, "unknowns": int(basis.N), "error": error,
         "cpu_s": round(process_time() - begin, 2),
         "iterations": sum(sum(stage.iterations) for stage in result)}]  # fmt: skip
flat = MeshQuad.init_tensor(np.linspace(0, 1, 9), np.linspace(0, 2, 17))
narrow = 1 - 0.3 * np.exp(-((flat.p[1] / 0.4) ** 2))
bar = MeshQuad(np.stack((flat.p[0] * narrow, flat.p[1])), flat.t).with_boundaries({
    "axis": lambda x: x[0] < 1e-9, "waist": lambda x: x[1] < 1e-9, "grip": lambda x: x[1] > 2 - 1e-9})  # fmt: skip
basis = Basis(bar, ElementVector(ElementQuad2()), intorder=4)
grip = basis.get_dofs("grip").all("u^2")
fixed = np.concatenate((basis.get_dofs("axis").all("u^1"), basis.get_dofs("waist").all("u^2"), grip))
drawn = basis.zeros()
drawn[grip] = 0.01
for coordinates in ("plane", "axisymmetric"):
    begin = process_time()
    forms = {"bar": sc.SolidForm(basis, steel, coordinates=coordinates)}
    step = sc.Model(forms, fixed).run([sc.Stage("drawn", basis.zeros(), prescribed=drawn, increments=8)])["drawn"]
    force = forms["bar"].assemble(step.x, step.states["bar"]).force[grip].sum()
    print(f"{coordinates}: force {force:.1f}, {step.summary['bar']}, iterations {step.iterations}")
    assert max(step.iterations) <= 8
    rows.append({"method": f"notched bar, {coordinates}", "n": 16, "unknowns": int(basis.N), "error": None,
                 "cpu_s": round(process_time() - begin, 2), "iterations": sum(step.iterations)})  # fmt: skip

# %%
# Materials whose strength shall be reduced by :func:`~skfem_contact.strength_reduction` have a method
# ``reduced(factor, flow)`` besides, which returns the material with its strength divided by the factor; the flow that
# is asked for (:func:`~skfem_contact.reduced_strength`) may be ignored by a law that has one only, as this one.
#
# Figures
# -------

print(json.dumps({"case": "own_material", "rows": rows}))
