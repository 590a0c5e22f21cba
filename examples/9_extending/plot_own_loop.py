"""
A Newton loop of your own with forms of your own
================================================

``run`` is a convenience. Here a beam on a bed of springs that cannot pull, a form that is written
on the spot, is loaded by a Newton loop of ten lines with scikit-fem's ``condense`` and ``solve``.
Where the beam lifts off, the bed lets go.
"""

import numpy as np
from scipy.sparse import diags
from skfem import Basis, ElementQuad2, ElementVector, MeshQuad, condense, solve

import skfem_contact as sc
import skfem_contact.plot as plot

mesh = MeshQuad.init_tensor(np.linspace(0, 10, 41), np.linspace(0, 0.5, 3)).with_defaults()
basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)


class Bed(sc.Form):
    """Springs below the beam that push and do not pull: stiffness k per length."""

    def __init__(self, basis, k):
        self.k = -k * sc.traction(
            basis, "bottom", (0.0, -1.0)
        )  # of every node, by its share of the length

    def assemble(self, x, state):
        """Force and tangent at the displacements x."""
        pressed = self.k * (x <= 0.0)
        return sc.Response(pressed * x, lambda: state, lambda: diags(pressed).tocsr())


forms = {"beam": sc.SolidForm(basis, sc.LinearElastic(E=3e7, nu=0.2)), "bed": Bed(basis, k=2e4)}
load = sc.traction(basis, "top", lambda x: (0 * x[0], -200.0 * (x[0] < 2)))
fixed = sc.dofs_at(basis, (5.0, 0.0))[0, :1]  # it cannot slide away

x, state = basis.zeros(), {name: form.initial_state() for name, form in forms.items()}
for iteration in range(20):
    out = {name: form.assemble(x, state[name]) for name, form in forms.items()}
    residual = load - sum(answer.force for answer in out.values())
    residual[fixed] = 0.0
    print(f"{iteration}: out of balance {np.linalg.norm(residual):.2e}")
    if np.linalg.norm(residual) < 1e-8 * np.linalg.norm(load):
        break
    x = x + solve(*condense(sum(answer.stiffness for answer in out.values()), residual, D=fixed))
state = {name: answer.state for name, answer in out.items()}  # accepting the step

# %%
# The result of a stage gives pictures and tables of the state that was found.
found = sc.results.of(forms, x, state, load=load)
plot.contour(found, "sxx", deformed=50.0, loads=load)

# sphinx_gallery_start_ignore
import json

again = sc.Model(forms, fixed).run([sc.Stage("load", load)], progress=False)["load"]
error = float(np.abs(again.x - x).max() / np.abs(x).max())
assert error < 1e-6
assert (x[basis.get_dofs("bottom").all("u^2")] > 0).any()  # it lifts off
print(
    json.dumps(
        {
            "case": "own_loop",
            "rows": [
                {
                    "method": "Q2",
                    "n": 40,
                    "unknowns": int(basis.N),
                    "error": error,
                    "cpu_s": None,
                    "iterations": iteration,
                }
            ],
        }
    )
)
# sphinx_gallery_end_ignore
