r"""
A wall as a beam, beside a wall of elements
===========================================

A concrete wall of 9 m, with a strut at its head, holds the ground while 5 m are dug out in front of
it. It touches Mohr-Coulomb soil on both sides, with friction.

The wall is a :class:`skfem_contact.Beam` of a thickness, whose two sides are in contact with the
faces of a slot in the mesh; or it consists of thin elements in the slot. Both must move alike, and
have the same moments. Run with ``--full`` for elements of half the size as well.
"""

# sphinx_gallery_thumbnail_number = 1

import json
import sys
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc

E, NU, THICK, TOE, DUG, STRUT = 3e7, 0.2, 0.4, -9.0, -5.0, 2e4
WIDTH, DEPTH, WEIGHT, K0 = 30.0, 20.0, 18.0, 0.5
SOIL = sc.MohrCoulomb(E=3e4, nu=0.3, c=5.0, phi=30.0, psi=10.0)
JOINT = sc.Coulomb(mu=0.3)
rows = []

# %%
# Ground with a slot
# ------------------
# The elements of the slot are left out, or are the wall. Its faces have names: the one behind the
# wall, and the two in front, above and below the bottom of the pit. The weight of the wall stands
# on the ground below its toe: a traction.


def ground_and_slot(n):
    """Mesh of the ground around a slot, and of the slot."""
    x = 0.5 * THICK + (WIDTH - 0.5 * THICK) * np.linspace(0, 1, 8 * n + 1) ** 1.6
    y = np.concatenate(
        (
            TOE - (DEPTH + TOE) * np.linspace(1, 0, 4 * n + 1) ** 1.3,
            np.linspace(TOE, DUG, 4 * n + 1)[1:],
            np.linspace(DUG, 0, 5 * n + 1)[1:],
        )
    )
    whole = MeshTri.init_tensor(np.concatenate((-x[::-1], [0.0], x)), y)
    middle = whole.p[:, whole.t].mean(axis=1)
    slot = np.flatnonzero((abs(middle[0]) < 0.5 * THICK) & (middle[1] > TOE))
    side = 0.5 * THICK
    ground = (
        whole.remove_elements(slot)
        .with_subdomains(
            {
                "pit": lambda x: (x[0] < -side) & (x[1] > DUG),
                "rest": lambda x: (x[0] > -side) | (x[1] < DUG),
            }
        )
        .with_boundaries(
            {
                "back": lambda x: (abs(x[0] - side) < 1e-9) & (x[1] > TOE),
                "front": lambda x: (abs(x[0] + side) < 1e-9) & (x[1] > TOE) & (x[1] < DUG),
                "dug": lambda x: (abs(x[0] + side) < 1e-9) & (x[1] > DUG),
                "toe": lambda x: (abs(x[0]) < side) & (abs(x[1] - TOE) < 1e-9),
                "base": lambda x: x[1] < -DEPTH + 1e-9,
                "sides": lambda x: abs(x[0]) > WIDTH - 1e-9,
            }
        )
    )
    wall = whole.restrict(slot).with_boundaries(
        {"left": lambda x: x[0] < -side + 1e-9, "right": lambda x: x[0] > side - 1e-9}
    )
    return ground, wall, y[y >= TOE - 1e-9][::-1]


# %%
# Two models
# ----------
# ``wall.contact`` makes a pair for every boundary that lies on a side of the beam. The strut is a
# spring at the head of the wall; that of the beam acts on the field of displacements that the beam
# brings.


class Strut(sc.Form, sc.roles.Couples):
    """A level spring at the first node of a beam."""

    def __init__(self, beam):
        self.borrowed = beam.fields[:1]

    def numbered(self, numbers):
        """Take the first dof of the beam."""
        self.dofs = numbers[self.borrowed[0]][:1]
        return self

    def assemble(self, x, state):
        """Return the force of the strut."""
        return sc.Response(
            STRUT * x[self.dofs],
            lambda: None,
            lambda: sc.MatrixForm([[STRUT]]).elastic_stiffness,
            dofs=self.dofs,
        )


def model(n, solid):
    """Model of the wall as a solid or as a beam."""
    ground, slot, heights = ground_and_slot(n)
    mesh = sc.join_bodies({"ground": ground, "wall": slot}) if solid else ground
    own = "ground:" if solid else ""
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    forms = {
        name: sc.SolidForm(basis.with_elements(f"{own}{name}"), SOIL, unit_weight=WEIGHT)
        for name in ("rest", "pit")
    }
    if solid:
        forms["wall"] = sc.SolidForm(
            basis.with_elements("wall"), sc.LinearElastic(E=E, nu=NU), unit_weight=0.0
        )
        forms |= {
            name: sc.ContactPair(basis, f"ground:{name}", f"wall:{side}", JOINT, 2)
            for name, side in (("back", "right"), ("front", "left"), ("dug", "left"))
        }
        forms["strut"] = sc.Spring(basis, (0.0, 0.0), (STRUT, 0.0), part="wall")
    else:
        plate = E / (1 - NU**2)
        wall = sc.Beam(
            basis,
            np.column_stack((0 * heights, heights)),
            EI=plate * THICK**3 / 12,
            EA=plate * THICK,
            GA=5 / 6 * THICK * E / 2 / (1 + NU),
            thickness=THICK,
        )
        forms |= {"wall": wall, **wall.contact(basis, JOINT), "strut": Strut(wall)}
    return sc.Model(
        forms, [basis.get_dofs(f"{own}base").all(), basis.get_dofs(f"{own}sides").all("u^1")]
    )


def at_rest(x):
    """Stress of level ground with a weightless wall."""
    vertical = np.where((abs(x[0]) < 0.5 * THICK) & (x[1] > TOE), 0.0, WEIGHT * x[1])
    return np.stack((K0 * WEIGHT * x[1], vertical, K0 * WEIGHT * x[1], 0 * vertical))


# %%
# Excavation
# ----------
# The initial stresses are in balance with contact on both sides of the wall. Then 5 m are dug out
# at once.
found, factors = {}, {}
sizes = (1, 2) if "--full" in sys.argv else (1,)
for n in sizes:
    for kind in ("solid", "beam"):
        begin = process_time()
        pit = model(n, kind == "solid")
        toe = pit.traction("ground:toe" if kind == "solid" else "toe", (0.0, WEIGHT * TOE))
        start = pit.initial_state(toe, stress=at_rest)
        stages = [sc.Stage("rest", toe), sc.Stage("dig", toe, deactivate=["pit", "dug"])]
        result = pit.run(stages, start=start, progress=False)
        stage = result["dig"]
        cuts = sc.Cuts.line((0.0, 0.0), (0.0, TOE), depth=THICK, n=9 * n + 1)
        forces = stage.section_forces("wall", cuts if kind == "solid" else None)
        dofs = (
            pit.forms["wall"].numbers((0.0, 0.0))[:1]
            if kind == "beam"
            else sc.dofs_at(pit.solids["wall"].basis, (0.0, 0.0), part="wall")[0, :1]
        )
        found[kind, n] = (forces, stage.x[dofs[0]], np.abs(forces.M).max())
        iterations = sum(stage.iterations)
        print(
            f"{kind}, n = {n}: max |M| {found[kind, n][2]:.2f} kNm/m, head "
            f"{1e3 * stage.x[dofs[0]]:.4f} mm, {sum(result['rest'].iterations)} and {iterations} "
            f"iterations, {process_time() - begin:.1f} s"
        )
        assert result["rest"].iterations == (0,)
        assert (kind, n) != ("beam", 1) or iterations <= 30
        error = abs(found[kind, n][2] / found["solid", n][2] - 1.0) if kind == "beam" else None
        rows.append(
            {
                "method": kind,
                "n": n,
                "unknowns": int(pit.layout.size),
                "error": error,
                "cpu_s": round(process_time() - begin, 2),
                "iterations": iterations,
            }
        )
        if n == 1:
            begin = process_time()
            safety = factors[kind] = pit.strength_reduction(
                start=result, flow="davis_b", certify=False, progress=False
            )
            rows.append(
                {
                    "method": f"{kind}, factor of safety",
                    "n": n,
                    "unknowns": int(pit.layout.size),
                    "error": None,
                    "cpu_s": round(process_time() - begin, 2),
                    "iterations": safety.iterations,
                    "factor": round(safety.factor, 4),
                }
            )

finest = (found[kind, sizes[-1]] for kind in ("solid", "beam"))
(solid, solid_head, solid_largest), (beam, beam_head, beam_largest) = finest
print(
    f"beam over elements: movement of the head {beam_head / solid_head - 1:+.3%}, largest moment "
    f"{beam_largest / solid_largest - 1:+.2%}"
)
assert abs(beam_head / solid_head - 1) < 1e-3
assert (
    abs(beam_largest / solid_largest - 1) < 5e-3
)  # of which the sections of the solid may be a half

# %%
# Factor of safety
# ----------------
# The strength of the ground and of both joints is divided by a factor until the pit collapses. The
# wall then slides along all of both faces, and has no stiffness along its axis but for the few
# points where the slip turns round.
for kind, safety in factors.items():
    print(
        f"{kind}: factor {safety.factor:.3f}, {safety.stop.kind} after {safety.iterations} "
        f"iterations"
    )
    assert safety.stop.kind == "plateau"
assert (
    abs(factors["beam"].factor / factors["solid"].factor - 1) < 1e-3
)  # the searches end within .0025 of a limit

fig, axes = plt.subplots(1, 3, figsize=(9, 4.5), sharey=True, layout="constrained")
for ax, name, unit in zip(axes, "MVN", ("kNm/m", "kN/m", "kN/m"), strict=True):
    ax.plot(getattr(solid, name), solid.y, "k-", lw=1, label="elements")
    ax.plot(getattr(beam, name), beam.y, "C1--", lw=1.5, label="beam")
    ax.axhline(DUG, color="0.7", lw=1)
    ax.set(xlabel=f"{name} [{unit}]")
axes[0].set_ylabel("height [m]")
axes[0].legend(frameon=False)
plt.show()

# %%
# A beam saves the thin elements and the cuts; it does not save time, since contact takes most of
# it.

# %%
# Headline numbers
# ----------------
print(json.dumps({"case": "wall", "rows": rows}))
