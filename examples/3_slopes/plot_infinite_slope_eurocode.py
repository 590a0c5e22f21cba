r"""
An infinite slope by Eurocode 7, as published
=============================================

Bond and Harris (Decoding Eurocode 7, 2008, chapter 9) give a chart for infinite slopes by design
approach 1. Their example is a layer 2.5 m thick at a gradient of 1 in 3, with a weight density of
20 kN/m³, 30 degrees of friction and :math:`r_u = 0.5`: the characteristic stability number must be
:math:`c'_k / \gamma H = 0.115`. The page is
`www.eurocode.us <https://www.eurocode.us/structural-design-eurocode-7/s-rtp.html>`__.

With this cohesion the factor of the design model must be 1. A length of the layer slides on rock;
the axes are along and across the slope, and gravity is inclined. The published number holds if
:math:`r_u` is the share of the normal stress, :math:`u = r_u \gamma H \cos^2\beta`, so that

.. math:: F = \frac{c' + (1 - r_u) \gamma H \cos^2\beta \tan\varphi'}{\gamma H \sin\beta\cos\beta} .
"""

import json
from time import process_time

import numpy as np
from skfem import Basis, ElementQuad2, ElementVector, MeshQuad

import skfem_contact as sc

begin = process_time()
sc.set_units("kN", "m")
weight, depth, beta, phi, r_u = 20.0, 2.5, np.arctan(1.0 / 3.0), 30.0, 0.5
cohesion = 0.115 * weight * depth  # published
length, thickness = 40.0, depth * np.cos(beta)

# %%
# The layer, 40 m long, and the rock share an interface with the strength of the soil. Water presses
# on the layer from below. Near its upper end the interface opens, which costs half a per cent.
layer = MeshQuad.init_tensor(np.linspace(0.0, length, 41), np.linspace(0.0, thickness, 3))
rock = MeshQuad.init_tensor(np.linspace(-1.0, length + 1.0, 43), np.linspace(-2.0, 0.0, 3))
mesh = sc.join_bodies({"layer": layer.with_defaults(), "rock": rock.with_defaults()})
basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
soils = {"layer": sc.LinearElastic(E=2e4, nu=0.3), "rock": sc.LinearElastic(E=2e6, nu=0.2)}
solid = sc.SolidForm(basis, soils, unit_weight={"layer": weight, "rock": 0.0})
law = sc.Coulomb(mu=np.tan(np.radians(phi)), adhesion=cohesion)
pair = sc.ContactPair(basis, "layer:bottom", "rock:top", law)
fixed = basis.get_dofs("rock:bottom").all()
down = [np.sin(beta), -np.cos(beta)]
model = sc.Model({"solid": solid, "base": pair}, fixed, gravity=down)
water = model.traction("layer:bottom", (0.0, r_u * weight * depth * np.cos(beta) ** 2))

# %%
# The characteristic model, and those of both combinations of design approach 1. Combination 1
# multiplies permanent actions, which drive and resist alike here.
factors = {}
for name in ("characteristic", "DA1-2"):
    design = model
    if name != "characteristic":
        design = sc.design.factored(model, sc.design.EC7[name])
    found = design.strength_reduction(water, tolerance=0.005, certify=False)
    factors[name] = found.factor
    print(f"{name:15} factor {found.factor:.3f}")

# %%
# The published cohesion gives a factor of 1 in the design model, and the lumped factor of 1.25 that
# the authors name for these strengths.
error = abs(factors["DA1-2"] - 1.0)
assert error < 0.01
assert abs(factors["characteristic"] / 1.25 - 1.0) < 0.01
row = {"method": "DA1-2", "n": mesh.nelements, "unknowns": model.layout.size, "error": error}
row |= {"cpu_s": process_time() - begin, "iterations": found.iterations}
print(json.dumps({"case": "infinite slope by Eurocode 7", "rows": [row]}))
