r"""
What is not done
================

Much of what a general program would compute in each iteration is not needed: the stiffness of an
elastic body does not change, few elements yield at a time, most points of the surfaces do not
touch. What does each of these savings gain? They are switched off one by one, by replacing private
functions, and the same problem is solved again.

The results must be the same: to the last bit, or to round-off where sums are taken in another
order.
"""

# %%
# Three scenes
# ------------
# An elastic block under ten loads one after the other; two elastic bodies that are pressed together
# and then shifted in ten increments with friction; and an elastic footing on Mohr-Coulomb soil that
# yields under it.

import json
import sys
from contextlib import contextmanager
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from contact_problems import MU, hertz
from skfem import Basis, ElementQuad1, ElementVector, FacetBasis, LinearForm, MeshQuad

import skfem_contact as sc
from skfem_contact.contact import neighbours
from skfem_contact.materials.plastic import IsotropicPlasticity
from skfem_contact.nonlinear import system
from skfem_contact.nonlinear.stepping import Predictor
from skfem_contact.solvers import direct, schur, superlu
from skfem_contact.solvers.choice import as_solver
from skfem_contact.sparse import Total
from skfem_contact.stages import setup

FULL = "--full" in sys.argv
SOLVER = "superlu"  # whatever is installed
NEWTON = sc.Newton(tolerance=1e-10)


def elastic_block(m):
    """An elastic block with m times m elements; the load on its top turns."""
    t = np.linspace(0, 1, m + 1)
    basis = Basis(
        MeshQuad.init_tensor(t, t).with_defaults(), ElementVector(ElementQuad1()), intorder=2
    )
    top = FacetBasis(basis.mesh, basis.elem, facets="top")
    down, along = (LinearForm(lambda v, w, k=k: -v[k]).assemble(top) for k in (1, 0))
    stages = [sc.Stage(f"{k}", np.cos(0.3 * k) * down + np.sin(0.3 * k) * along) for k in range(10)]
    forms = {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3))}
    return forms, stages, basis.get_dofs("bottom").all()


def elastic_contact(n):
    """A parabola with n elements in the half-width of its contact, pressed and shifted with
    friction.
    """
    problem = hertz(n)
    stages = [problem.stage("press"), problem.stage("shift", tangential=1.0, increments=10)]
    return {"bodies": problem.solid, "contact": problem.pair(MU, 4)}, stages, problem.fixed


def footing(m):
    """A footing on yielding soil, m elements in a metre."""
    ground = MeshQuad.init_tensor(np.linspace(-6, 6, 12 * m + 1), np.linspace(-6, 0, 6 * m + 1))
    block = MeshQuad.init_tensor(np.linspace(-1, 1, 3 * m + 1), np.linspace(0, 0.5, m + 1))
    mesh = sc.join_bodies({"ground": ground.with_defaults(), "footing": block.with_defaults()})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    forms = {
        "ground": sc.SolidForm(
            basis.with_elements("ground"),
            sc.MohrCoulomb(E=3e4, nu=0.3, c=10.0, phi=20.0, psi=20.0),
            strain="b_bar",
        ),
        "footing": sc.SolidForm(basis.with_elements("footing"), sc.LinearElastic(E=3e7, nu=0.2)),
        "contact": sc.ContactPair(
            basis, "ground:top", "footing:bottom", sc.Coulomb(mu=0.5), "nodal"
        ),
    }
    gravity = sc.weight(basis, {"ground": 18.0, "footing": 25.0})
    top = FacetBasis(mesh, basis.elem, facets="footing:top")
    load = LinearForm(lambda v, w: -85.0 * v[1]).assemble(top)
    middle = basis.get_dofs("footing:top").all("u^1")
    fixed = np.concatenate(
        (
            basis.get_dofs("ground:bottom").all(),
            middle[len(middle) // 2, None],
            basis.get_dofs({"ground:left", "ground:right"}).all("u^1"),
        )
    )
    return forms, [sc.Stage("gravity", gravity), sc.Stage("load", gravity + load)], fixed


# %%
# What is skipped, and the switches
# ---------------------------------


def everywhere(self, *args, update=IsotropicPlasticity.update):
    """A return mapping that hands out the tangents of all points, elastic ones included."""
    answer = update(self, *args)
    moduli = np.tile(self.elasticity(4), (answer.stress[0].size, 1, 1))

    def tangent():
        moduli[answer.plastic] = answer.tangent()
        return moduli

    return answer._replace(plastic=np.arange(len(moduli)), tangent=tangent)


def eager(self, *args, init=sc.Response.__init__, **kwargs):
    """An answer that brings its tangent along."""
    init(self, *args, **kwargs)
    self.stiffness


def nothing_is_far(self, *args, at=neighbours.NeighbourList.at):
    """Neighbours that may be anywhere."""
    found = at(self, *args)
    return found._replace(clearance=np.full(len(found.clearance), -np.inf))


class Afresh(Total):
    """A sum of tangents that finds its pattern anew."""

    def of(self, matrices):
        """The sum."""
        return Total().of(matrices)


SKIPS = {
    "elastic stiffness assembled once": (
        elastic_contact,
        sc.SolidForm,
        "elastic_stiffness",
        property(sc.SolidForm.elastic_stiffness.func),
    ),
    "only elements that yield assembled": (footing, IsotropicPlasticity, "update", everywhere),
    "no tangent in the line search": (footing, sc.Response, "__init__", eager),
    "pattern of the sum kept": (footing, system, "Total", Afresh),
    "order of elimination kept": (footing, superlu.SuperLU, "outdated", lambda self: True),
    "unchanged matrix not factored again": (
        elastic_block,
        direct,
        "same_matrix",
        lambda A, B: False,
    ),
    "factors of elastic bodies in contact kept": (
        elastic_contact,
        setup,
        "linear_solver",
        lambda forms, *args: as_solver(*args),
    ),
    "one solution with kept factors": (elastic_contact, schur, "_NOTHING", 0.0),
    "increments start where the last one leads": (
        elastic_contact,
        Predictor,
        "start",
        lambda *args: None,
    ),
    "far points not projected": (elastic_contact, neighbours.NeighbourList, "at", nothing_is_far),
    "neighbours searched after motion only": (elastic_contact, neighbours, "_SLACK", 0.0),
}


@contextmanager
def replaced(owner, name, value):
    """Replace an attribute for a while."""
    before = vars(owner)[name]
    setattr(owner, name, value)
    try:
        yield
    finally:
        setattr(owner, name, before)


# %%
# With and without
# ----------------


def solved(scene, size):
    """The result and the process time that it took."""
    forms, stages, fixed = scene(size)
    start = process_time()
    result = sc.Model(forms, fixed, solver=SOLVER, newton=NEWTON).run(stages, progress=False)
    return result, process_time() - start


SIZES = (
    {elastic_block: 120, elastic_contact: 20, footing: 10}
    if FULL
    else {elastic_block: 20, elastic_contact: 4, footing: 3}
)
REPEATS = 3 if FULL else 1
for scene, size in SIZES.items():  # load what Python has not loaded yet
    solved(scene, min(size, 4))

rows = []
for name, (scene, owner, attribute, value) in SKIPS.items():
    size, times, without = SIZES[scene], [], []
    for _ in range(REPEATS):
        result, time = solved(scene, size)
        times.append(time)
        with replaced(owner, attribute, value):
            other, time = solved(scene, size)
        without.append(time)
    x, y = result[-1].x, other[-1].x
    error = float(np.abs(x - y).max() / np.abs(x).max())
    iterations = [sum(sum(stage.iterations) for stage in run) for run in (result, other)]
    assert iterations[0] == iterations[1] or (owner is Predictor and iterations[0] < iterations[1])
    assert error < 1e-9
    rows.append(
        {
            "method": name,
            "scene": scene.__name__,
            "n": size,
            "unknowns": len(x),
            "error": error,
            "cpu_s": min(times),
            "without_s": min(without),
            "ratio": min(without) / min(times),
            "iterations": iterations[0],
            "iterations_without": iterations[1],
        }
    )
    print(
        f"{name:42} {scene.__name__:16} {len(x):6} unknowns  {min(times):6.2f} s, without "
        f"{min(without):6.2f} s: x {rows[-1]['ratio']:5.2f}, difference {error:.0e}"
    )

# %%
# Times without each of them, relative to the time with all:

fig, ax = plt.subplots(figsize=(8, 4), layout="constrained")
order = sorted(rows, key=lambda row: row["ratio"])
colors = {"elastic_block": "#999999", "elastic_contact": "#009e73", "footing": "#d55e00"}
ax.barh(
    [row["method"] for row in order],
    [row["ratio"] for row in order],
    color=[colors[r["scene"]] for r in order],
)
ax.axvline(1.0, color="0.3", lw=0.8)
ax.set(xlabel="time without it / time with it")
ax.legend(
    handles=[
        plt.Rectangle((0, 0), 1, 1, color=c, label=s.replace("_", " ")) for s, c in colors.items()
    ],
    frameon=False,
)
plt.show()

# %%
# Figures
# -------

print(json.dumps({"case": "skips", "rows": rows}))
