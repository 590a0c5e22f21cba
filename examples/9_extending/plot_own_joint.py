r"""
A law of your own and its output
================================

A joint in rock that closes by a hyperbola, after Bandis, Lumsden and Barton (1983): the closure
:math:`\delta` never exceeds :math:`V`,

.. math:: \sigma = \frac{k \, \delta}{1 - \delta / V}
   \quad\Longleftrightarrow\quad \delta = \frac{\sigma}{k + \sigma / V} .

The law is a class of two parameters and one function; an observer writes a line for each increment.
Units are MPa and m.
"""

import json
from dataclasses import dataclass

import numpy as np
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact.contact import LawUpdate


@dataclass(frozen=True, eq=False)
class Hyperbolic(sc.InterfaceLaw):
    """Joint without friction: initial stiffness k and largest closure V."""

    k: float
    V: float

    def update(self, jump, internal, penalty):
        """Return the pressure at a closure, the negative gap, and its slope; straight at last."""
        closed = np.minimum(-jump[0], 0.98 * self.V)
        room = 1.0 - closed / self.V
        traction, tangent = np.zeros_like(jump), np.zeros((len(jump), *jump.shape))
        tangent[0, 0] = self.k / room**2
        traction[0] = (jump[0] + closed) * tangent[0, 0] - self.k * closed / room
        return LawUpdate(traction, internal, tangent, 0.0 * jump[1:], np.ones(jump.shape[1], int))


# %%
# Checked without a mesh, then in a block that is pressed on rigid ground:
law = Hyperbolic(k=2e3, V=1e-3)
print(f"error of the tangent {sc.testing.check_interface_law(law):.0e}")
mesh = MeshQuad.init_tensor(np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 5)).with_defaults()
basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
block = sc.SolidForm(basis, sc.LinearElastic(E=5e4, nu=0.0))
joint = sc.ContactPair(basis, "bottom", sc.rigid.line((-1.0, 0.0), (2.0, 0.0)), law)
model = sc.Model({"block": block, "joint": joint}, basis.get_dofs("left").all("u^1"))

# %%
# The observer writes closure and pressure of every increment:
lines = ["pressure [MPa], closure [m]"]


def record(stage):
    """Add a line to the output."""
    forces = stage.tractions("joint")
    lines.append(f"{forces.pressure.mean():.6e}, {-forces.gap.mean():.6e}")


press = sc.Stage("press", model.traction("top", (0.0, -20.0)), increments=8)
model.run([press], on_increment=record, progress=False)
print("\n".join(lines))
sigma, closure = np.array([line.split(", ") for line in lines[1:]], float).T
error = np.abs(closure / (sigma / (law.k + sigma / law.V)) - 1.0).max()
assert error < 1e-5 and np.isclose(sigma[-1], 20.0)
row = {"method": "hyperbola", "n": 16, "unknowns": int(basis.N), "error": error}
row |= {"cpu_s": None, "iterations": None}
print(json.dumps({"case": "own_joint", "rows": [row]}))
