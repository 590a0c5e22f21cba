r"""
Many steps without drift
========================

Undamped bodies swing for thousands of steps, a square that is held and a column that stands on a
plane by contact. With ``rho_inf=1`` the energy of both stays: it drifts by round-off and by the
residual of equilibria alone. A step adds its records to the memory, 64 bytes, and nothing else.
``--full`` takes 100,000 steps, a minute for the first body and a quarter of an hour for the second.
"""

# %%
# Two bodies
# ----------

import argparse
import tracemalloc
import warnings

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc

parser = argparse.ArgumentParser()
parser.add_argument("--full", action="store_true", help="100,000 steps")
full = parser.parse_known_args()[0].full

elastic = sc.LinearElastic(E=1e4, nu=0.0)
mesh = MeshQuad.init_tensor([0, 1], [0, 1, 2]).with_defaults()
basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
solid = sc.SolidForm(basis, elastic, unit_weight=20.0)
along = np.arange(0, basis.N, 2)
held = sc.Model({"solid": solid}, [along, basis.get_dofs("bottom").all()], gravity_acceleration=10)
plane = sc.rigid.line((-5, 0), (5, 0))
pair = sc.ContactPair(basis, "bottom", plane, sc.Coulomb(mu=0.5))
stands = sc.Model({"solid": solid, "pair": pair}, along, gravity_acceleration=10)

# %%
# Many steps
# ----------
# Forty steps are a period of the first mode. The second body stays on its plane: its weight is
# larger than the swing.


def swing(model, steps):
    """Energies of a stage of many steps, and bytes that a step has added."""
    v = basis.zeros()
    v[1::2] = 0.1 * np.sin(np.pi * mesh.p[1] / 4)
    step = 1 / (40 * held.frequencies(1)[0])
    settings = sc.Dynamic(step, rho_inf=1.0, velocity=v)
    marks = []

    def watch(stage):
        count = len(stage.iterations)
        if count in (steps // 2, steps - 1):
            marks.append((count, tracemalloc.get_traced_memory()[0]))

    stages = [sc.Stage("weight"), sc.Stage("swing", duration=steps * step, dynamic=settings)]
    tracemalloc.start()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sc.AnalysisWarning)  # the penalty is soft
        found = model.run(stages, on_increment=watch, progress=False)["swing"]
    tracemalloc.stop()
    (first, less), (last, more) = marks
    return found.energy, (more - less) / (last - first)


counts = {"held": 100_000 if full else 2_000, "on a plane": 100_000 if full else 400}
rows = []
fig, ax = plt.subplots(figsize=(7, 3), layout="constrained")
for (name, steps), model in zip(counts.items(), (held, stands)):
    energy, memory = swing(model, steps)
    drift = energy["missing"] / energy["kinetic"].max()
    print(
        f"{name:11s} {steps:6d} steps, drift {np.abs(drift).max():.1e}, {memory:.0f} bytes a step"
    )
    rows.append((name, steps, np.abs(drift).max(), memory))
    ax.plot(np.linspace(0, 1, steps + 1), drift, label=f"{name}, {steps} steps")
ax.set(xlabel="share of the steps", ylabel="drift of the energy")
ax.legend(frameon=False)

# sphinx_gallery_start_ignore
import json

for _, _, drift, _ in rows:
    assert drift < 1e-9, drift
assert rows[0][3] < 120, rows
assert rows[1][3] < 1000, rows
print(
    json.dumps(
        {
            "case": "many_steps",
            "rows": [
                {
                    "method": name,
                    "n": steps,
                    "unknowns": int(basis.N),
                    "error": float(drift),
                    "cpu_s": None,
                    "iterations": steps,
                }
                for name, steps, drift, _ in rows
            ],
        }
    )
)
# sphinx_gallery_end_ignore
