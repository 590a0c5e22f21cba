r"""
A wedge driven under a load: statics, and self-locking
======================================================

A wedge is driven over a floor under a load, which a wall guides on its far side. Everything slides:
the wedge on the floor (:math:`\mu_1`), the load on the wedge (:math:`\mu_2 = \tan\varphi_2`) and
along the wall (:math:`\mu_3`). Statics alone give the force P that drives a wedge of angle
:math:`\alpha` under a weight W, and the force that holds it when it is let out again:

.. math::

   \frac{P}{W} = \frac{\tan(\alpha + \varphi_2) + \mu_1}{1 - \mu_3 \tan(\alpha + \varphi_2)}, \qquad
   \frac{P_{back}}{W} = \frac{\tan(\alpha - \varphi_2) - \mu_1}{1 + \mu_3 \tan(\alpha - \varphi_2)}.

Where the second is negative the wedge locks itself: it stays under the load when nobody holds it,
and must be pulled out. If even :math:`\alpha < \varphi_2` the load does not slide down the wedge
but goes away from the wall with it, and :math:`P_{back} = -\mu_1 W`.
"""

# %%
# Model
# -----
# Floor and wall are rigid lines. Wedge and load are elastic, but so hard that statics need not know
# of it: their strains are less than a thousandth. Three contact pairs act at once, each with a
# friction of its own, and nothing but contact holds the load.

import json
import warnings
from dataclasses import replace
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad1, ElementVector, FacetBasis, LinearForm, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot
from skfem_contact.contact.penalty import choose_penalties

weight, E, stroke, n_steps = 1.0, 2e3, 0.12, 6

wedges = {  # angle in degrees, mu1, mu2, mu3
    "friction everywhere": (10.0, 0.2, 0.2, 0.2),
    "smooth wall": (15.0, 0.1, 0.1, 0.0),
    "flat wedge": (8.0, 0.1, 0.1, 0.0),
    "no friction": (20.0, 0.0, 0.0, 0.0),
}


def bodies(slope):
    """Mesh of the wedge, and of the load from x = 0 to the wall at x = 1."""
    wedge = MeshQuad.init_tensor(np.linspace(-1.0, 1.5, 26), np.linspace(0, 1, 5)).with_defaults()
    load = MeshQuad.init_tensor(np.linspace(0, 1, 13), np.linspace(0, 1, 9)).with_defaults()
    top = 0.1 + slope * (1.5 - wedge.p[0])
    bottom = 0.1 + slope * (1.5 - load.p[0])
    return sc.join_bodies(
        {
            "wedge": replace(wedge, doflocs=np.stack((wedge.p[0], wedge.p[1] * top))),
            "load": replace(
                load, doflocs=np.stack((load.p[0], bottom + load.p[1] * (1.6 - bottom)))
            ),
        }
    )


@LinearForm
def pressed(v, w):
    """The weight, spread over the top of the load, whose width is 1."""
    return -weight * v[1]


# %%
# The face of the wedge is pushed ahead by more than one of its segments, and then drawn back. The
# way back begins with small steps, in which friction turns round everywhere.

there = np.linspace(0, stroke, n_steps + 1)[1:]
path = np.concatenate(
    (there, stroke - np.array([0.0005, 0.001, 0.002, 0.004, 0.01]), stroke - there)
)


def driven(angle, mu1, mu2, mu3):
    """Forms, result and the force that drives the wedge in every step of its way."""
    mesh = bodies(np.tan(np.radians(angle)))
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    face = basis.get_dofs("wedge:left").all("u^1")
    forms = {
        "bodies": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.3)),
        "floor": sc.ContactPair(
            basis,
            "wedge:bottom",
            sc.rigid.line((-3.0, 0.0), (3.0, 0.0)),
            sc.Coulomb(mu=mu1),
            "nodal",
        ),
        "slope": sc.ContactPair(basis, "load:bottom", "wedge:top", sc.Coulomb(mu=mu2), "nodal"),
        "wall": sc.ContactPair(
            basis, "load:right", sc.rigid.line((1.0, 0.0), (1.0, 3.0)), sc.Coulomb(mu=mu3), "nodal"
        ),
    }
    load = pressed.assemble(FacetBasis(mesh, basis.elem, facets=mesh.boundaries["load:top"]))
    stages = [sc.Stage("weight", load)]
    for k, way in enumerate(path):
        x = basis.zeros()
        x[face] = way
        stages.append(sc.Stage(f"step {k + 1}", load, prescribed=x))
    forms = choose_penalties(forms)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sc.AnalysisWarning)  # of the load that has left the wall
        result = sc.Model(forms, face).run(stages)
    return forms, result, np.array([step.reactions()[face].sum() for step in result])


def statics(angle, mu1, mu2, mu3, sign):
    """P / W of a wedge that is driven in (+1) or let out (-1)."""
    slope = np.tan(np.radians(angle) + sign * np.arctan(mu2))
    if sign < 0 and slope < 0:
        return -mu1
    return (slope + sign * mu1) / (1 - sign * mu3 * slope)


# %%
# Four wedges
# -----------

runs = {}
for name, wedge in wedges.items():
    begin = process_time()
    runs[name] = *driven(*wedge), process_time() - begin

# %%
# The wedge of 15 degrees, driven in. The force flows from the top of the load to the floor, and to
# the wall. The outlines of the start are grey.

forms, result, *_ = runs["smooth wall"]
plot.contour(result[n_steps], "syy", deformed=1.0)

# %%
# The force on the way
# --------------------
# It is constant while the wedge slides, over the joints of the mesh too. Two of the wedges come
# back only when they are pulled: on the way their force passes through zero while everything
# sticks.

fig, ax = plt.subplots(figsize=(7, 4), layout="constrained")
ax.axhline(0.0, color="k", lw=0.5)
ways = np.concatenate(([0.0], path))
for k, (name, (_, _, force, _)) in enumerate(runs.items()):
    ax.plot(ways[: n_steps + 1], force[: n_steps + 1] / weight, f"C{k}>-", label=name)
    ax.plot(ways[n_steps:], force[n_steps:] / weight, f"C{k}<:", ms=4)
    for sign in (1, -1):
        ax.axhline(statics(*wedges[name], sign), color=f"C{k}", lw=0.5)
ax.set(xlabel="way of the wedge (in: solid; out: dotted)", ylabel="P / W", ylim=(-0.25, 0.9))
ax.legend(frameon=False, ncols=2, loc="upper center")

# %%
# Headline numbers
# ----------------
# All forces are those of statics to a thousandth of the weight, and those that drive to a
# thousandth of themselves.

rows = []
for name, (forms, result, force, cpu) in runs.items():
    driving, holding = (statics(*wedges[name], sign) for sign in (1, -1))
    into, out = force[1 : n_steps + 1] / weight, force[-n_steps:] / weight
    print(
        f"{name:20} in: {into[-1]:8.5f}, statics {driving:8.5f}   out: {out[-1]:8.5f}, statics "
        f"{holding:8.5f}"
    )
    error = np.abs(into / driving - 1).max()
    assert error < 1e-3
    assert np.abs(out - holding).max() < 1e-3
    rows.append(
        {
            "method": name,
            "n": n_steps,
            "unknowns": int(forms["bodies"].basis.N),
            "error": float(error),
            "cpu_s": round(cpu, 2),
            "iterations": int(sum(sum(step.iterations) for step in result)),
        }
    )

references = {"friction everywhere": 0.640015, "smooth wall": 0.478080, "no friction": 0.363970}
for name, value in references.items():
    assert abs(runs[name][2][n_steps] / weight - value) < 1e-3 * value
for name in ("friction everywhere", "flat wedge"):  # angles below 2 arctan(mu) lock
    assert (runs[name][2][-n_steps:] < 0).all()
for name in ("smooth wall", "no friction"):
    assert (runs[name][2] > 0).all()
# a load that goes with the wedge leaves friction on the floor, which is exact up to the tolerance
# of Newton's method
assert np.abs(runs["friction everywhere"][2][-n_steps:] / weight + 0.2).max() < 1e-6

plt.show()
print(json.dumps({"case": "sliding wedge", "rows": rows}))
