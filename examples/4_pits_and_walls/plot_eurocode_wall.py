r"""
A published retaining wall by Eurocode 7
========================================

The wall of worked example A.4 of the European Commission's report on Eurocode 7 (Bond and others,
JRC 85029, 2013), as tests of the program XC quote it: a stem of 6 m by 0.7 m on a base of 3.9 m by
0.8 m, and fill with a slope of :math:`\beta` = 20 degrees, :math:`\varphi` = 32.5 degrees and
19 kN/m³ under 5 kPa. Base, stem and the fill above the heel are one body; Rankine's pressure acts
on its virtual back, parallel to the slope,

.. math:: K_a = \cos\beta\, \frac{\cos\beta - \sqrt{\cos^2\beta - \cos^2\varphi}}
   {\cos\beta + \sqrt{\cos^2\beta - \cos^2\varphi}} .

The published figures are compared with the forces of the contact below the base, under
characteristic and factored loads. Units are kN and m.
"""

import json

import numpy as np
from skfem import Basis, ElementQuad2, ElementVector, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

sc.set_units("kN", "m")

beta, B, toe, stem, base, height = np.radians(20.0), 3.9, 0.95, 0.7, 0.8, 6.8
back = height + (B - toe - stem) * np.tan(beta)  # length of the virtual back

# %%
# The body
# --------
x = np.concatenate((np.linspace(0.0, toe, 4), [1.3, 1.65, 2.2, 2.8, 3.4, B]))
y = np.concatenate((np.linspace(0.0, base, 3), np.linspace(base, height, 9)[1:]))
block = MeshQuad.init_tensor(x, y)
middle = block.p[:, block.t].mean(axis=1)
block = block.remove_elements(np.flatnonzero((middle[0] < toe) & (middle[1] > base)))
rise = 1.0 + np.maximum(block.p[0] - toe - stem, 0.0) * np.tan(beta) / (height - base)
top = np.where(block.p[1] > base, base + (block.p[1] - base) * rise, block.p[1])
block = MeshQuad(np.stack((block.p[0], top)), block.t).with_defaults()
fill = lambda x: (x[0] > toe + stem) & (x[1] > base)  # noqa: E731
block = block.with_subdomains({"fill": fill, "concrete": lambda x: ~fill(x)})
below = np.concatenate(([-8.0, -4.0, -2.0, -1.0], x, [5.0, 7.0, 11.0]))
ground = MeshQuad.init_tensor(below, np.array([-8.0, -5.0, -3.0, -1.5, -0.7, 0.0]))
mesh = sc.join_bodies({"wall": block, "ground": ground.with_defaults()})
basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
soft, stiff = sc.LinearElastic(E=4e4, nu=0.3), sc.LinearElastic(E=3e7, nu=0.2)
soils = {"wall:fill": soft, "wall:concrete": stiff, "ground": soft}
law = sc.Coulomb(np.tan(np.radians(30.0)))  # the angle at constant volume


def model_of(factor):
    """Return the model with weights times a factor."""
    weights = {"wall:fill": factor * 19.0, "wall:concrete": factor * 25.0, "ground": 0.0}
    solid = sc.SolidForm(basis, soils, unit_weight=weights)
    exact = sc.AugmentedLagrangian()
    pair = sc.ContactPair(basis, "wall:bottom", "ground:top", law, enforcement=exact)
    return sc.Model({"solid": solid, "base": pair}, sc.box_supports(basis, part="ground"))


# %%
# Pressures on the virtual back
# -----------------------------
def rankine(phi):
    """Return the active coefficient of ground with a slope."""
    root = np.sqrt(np.cos(beta) ** 2 - np.cos(phi) ** 2)
    return np.cos(beta) * (np.cos(beta) - root) / (np.cos(beta) + root)


Ka = rankine(np.radians(32.5))
towards = -np.array([np.cos(beta), np.sin(beta)])
model = model_of(1.0)
earth = model.traction(
    "wall:right", lambda x: Ka * 19.0 * (back - x[1]) * towards.reshape(-1, 1, 1)
)
traffic = model.traction("wall:right", Ka * 5.0 * towards)
E_G, E_Q = (np.hypot(*load[: basis.N].reshape(-1, 2).sum(axis=0)) for load in (earth, traffic))
found = {"Ka": Ka, "Ka of design": rankine(np.arctan(np.tan(np.radians(32.5)) / 1.25))}
found |= {"virtual back": back, "thrust of the fill": E_G, "of traffic": E_Q}

# %%
# Forces on the base
# ------------------
for name in ("characteristic", "DA2"):
    factors = sc.design.EC7[name]
    load = factors.load(permanent=earth, variable=traffic)
    stages = [sc.Stage("weight"), sc.Stage("thrust", load, increments=2)]
    stage = sc.design.factored(model_of(factors.permanent), factors).run(stages)["thrust"]
    check = sc.design.check(stage, "wall", base=[(0.0, 0.0), (B, 0.0)], factors=factors)
    print(check)
    found |= {f"V, {name}": check.vertical, f"H, {name}": check.horizontal}
X, f = basis.doflocs[:, ::2], load[: basis.N].reshape(-1, 2).T
found["moment of the thrust"] = float((X[1] * -f[0] + X[0] * f[1]).sum())
plot.contour(stage, "syy", loads=load, contact=True, window=(-4, 7, -4, 8))

# %%
# Published
# ---------
published = {
    "Ka": 0.365,
    "Ka of design": 0.486,
    "virtual back": 7.62,
    "thrust of the fill": 201.0,
    "of traffic": 13.9,
    "V, characteristic": 530.5,
    "H, characteristic": 202.0,
    "V, DA2": 716.9,
    "H, DA2": 274.6,
    "moment of the thrust": 332.5,
}
errors = [found[name] / value - 1.0 for name, value in published.items()]
for (name, value), error in zip(published.items(), errors):
    print(f"{name:22} {found[name]:8.4g}  published {value:8.4g}  {error:+.2%}")
assert np.abs(errors).max() < 0.005
assert np.isclose(check.sliding, 716.9 * np.tan(np.radians(30.0)) / 1.1 / 274.6, rtol=2e-3)
row = {"method": "contact forces", "n": mesh.nelements, "unknowns": int(basis.N)}
row |= {"error": float(np.abs(errors).max()), "cpu_s": None, "iterations": sum(stage.iterations)}
print(json.dumps({"case": "eurocode_wall", "rows": [row]}))
