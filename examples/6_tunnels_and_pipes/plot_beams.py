r"""
Beams: walls, linings and frames against closed forms
=====================================================

A wall, a lining or a frame is a :class:`skfem_contact.Beam`: Timoshenko elements of three nodes,
straight or curved, with nodes of their own or those of a line of the mesh. Plastic hinges flow at
nodes, where
:math:`|M| / M_p + |N| / N_p` reaches one. Section forces are those on the nodes of the elements, so
that they are as good as the displacements.

Here beams stand on springs and on an elastic half-plane, are bent as a ring, bear the water of a
tank, and collapse.
"""

# sphinx_gallery_thumbnail_number = 2

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from scipy.sparse import coo_matrix
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc

rows = []


def record(method, n, model, begin, values, exact, largest, iterations=1):
    """Keep the largest relative error of some values, which must not exceed a limit."""
    error = float(np.abs(np.divide(values, exact) - 1.0).max())
    rows.append(
        {
            "method": method,
            "n": n,
            "unknowns": int(model.layout.size),
            "error": error,
            "cpu_s": round(process_time() - begin, 2),
            "iterations": int(iterations),
        }
    )
    print(f"{method}, {n} elements: {', '.join(f'{v:.6g}' for v in values)}, error {error:.1e}")
    assert error <= largest, (method, n, error)


def level(start, end, n):
    """Nodes of a level beam of n elements."""
    return np.column_stack((np.linspace(start, end, n + 1), np.zeros(n + 1)))


# %%
# A long beam on springs
# ----------------------
# A force P on a beam on springs k per length: with :math:`\lambda^4 = k / 4 EI` the deflection
# below it is
# :math:`P \lambda / 2 k` and the moment :math:`P / 4 \lambda`. The springs are a form of their own,
# which acts on the dofs that the beam brings: their matrix is that of a quadratic element. The
# moment is positive where the fibres to the left of the beam's way are in tension, here the upper
# ones.


class Springs(sc.Form, sc.roles.Couples):
    """Springs k per length across a level beam."""

    symmetric = True

    def __init__(self, beam, k, length):
        self.borrowed = beam.fields[:1]
        block = k * length / 30.0 * np.array([[4, -1, 2], [-1, 4, 2], [2, 2, 16]])
        upright = 2 * beam.cells + 1
        at = (np.repeat(upright, 3, axis=1).ravel(), np.tile(upright, (1, 3)).ravel())
        self.K = coo_matrix(
            (np.tile(block.ravel(), len(upright)), at), shape=(2 * len(beam.points),) * 2
        ).tocsr()

    def numbered(self, numbers):
        """Take the dofs of the beam."""
        self.dofs = numbers[self.borrowed[0]]
        return self

    def assemble(self, x, state):
        """Return the forces of the springs."""
        return sc.Response(self.K @ x[self.dofs], lambda: None, lambda: self.K, dofs=self.dofs)


fig, ax = plt.subplots(figsize=(5.5, 3.8), layout="constrained")
s = np.linspace(0, 6, 200)
ax.plot(s, np.exp(-s) * (np.cos(s) - np.sin(s)) / 4, "k-", lw=1, label="exact")
for per, largest in ((1, 1.2e-3), (2, 1e-4)):
    begin = process_time()
    beam = sc.Beam(None, level(-8, 8, 16 * per), EI=1.0, EA=1e3, GA=1e5)
    model = sc.Model(
        {"beam": beam, "springs": Springs(beam, 4.0, 1 / per)}, beam.dofs((-8.0, 0.0), ["u^1"])
    )
    wall = model.forms["beam"]
    stage = model.run([sc.Stage("force", wall.load((0.0, -1.0), at=(0.0, 0.0)))], progress=False)[
        "force"
    ]
    forces = stage.section_forces("beam")
    record(
        "beam on springs, w and M",
        16 * per,
        model,
        begin,
        [-stage.x[wall.numbers((0.0, 0.0))[1]], -forces.M.min()],
        [1 / 8, 1 / 4],
        largest,
    )
    right = (forces.x >= 0.0) & (forces.x <= 6.0)
    ax.plot(
        forces.x[right],
        -forces.M[right],
        "os"[per - 1],
        ms=4,
        mfc="none",
        label=f"{per} elements per 1/λ",
    )
ax.set(xlabel="distance from the force × λ", ylabel="moment × λ / P")
ax.legend(frameon=False)

# %%
# A ring of 16 curved elements
# ----------------------------
# Two forces P press a ring of radius R: it gives way by :math:`(\pi/4 - 2/\pi) P R^3 / EI`, and the
# moment below them is :math:`P R / \pi`. The way is anticlockwise, and the left fibres are the
# inner ones. The middle nodes lie on the circle; 16 straight elements err by 3 % and 1.3 %.
begin = process_time()
angle = 2 * np.pi * np.arange(32) / 32
ends = np.arange(0, 32, 2)
beam = sc.Beam(
    None,
    np.column_stack((np.cos(angle), np.sin(angle))),
    EI=1.0,
    EA=1e6,
    GA=1e6,
    cells=np.column_stack((ends, (ends + 2) % 32, ends + 1)),
)
crown, foot = (0.0, 1.0), (0.0, -1.0)
model = sc.Model(
    {"ring": beam},
    [*beam.dofs((1.0, 0.0), ["u^2"]), *beam.dofs(crown, ["u^1"]), *beam.dofs(foot, ["u^1"])],
)
ring = model.forms["ring"]
load = ring.load((0.0, -1.0), at=crown) + ring.load((0.0, 1.0), at=foot)
stage = model.run([sc.Stage("press", load)], progress=False)["press"]
forces = stage.section_forces("ring")
closer = stage.x[ring.numbers(foot)[1]] - stage.x[ring.numbers(crown)[1]]
record("ring, deflection", 16, model, begin, [closer], [np.pi / 4 - 2 / np.pi], 6e-4)
record("ring, moment", 16, model, begin, [np.abs(forces.M).max()], [1 / np.pi], 2e-5)
phi = np.linspace(0, 360, 361)
fig, ring_ax = plt.subplots(figsize=(5.5, 3.8), layout="constrained")
ring_ax.plot(phi, 1 / np.pi - np.abs(np.cos(np.radians(phi))) / 2, "k-", lw=1, label="exact")
ring_ax.plot(
    np.degrees(np.arctan2(forces.y, forces.x)) % 360,
    forces.M,
    "o",
    ms=4,
    mfc="none",
    label="16 curved elements",
)
ring_ax.set(
    xlabel="angle from the right end [degrees]",
    ylabel="moment / P R",
    xticks=[0, 90, 180, 270, 360],
)
ring_ax.legend(frameon=False, loc="upper center", fontsize="small")
plt.show()

# %%
# The wall of a tank
# ------------------
# With ``coordinates="axisymmetric"`` the beam is a shell of revolution. A tank of concrete, 9 m
# high, with a radius of 8 m and a wall of 0.3 m, is clamped at its foot and full of water. With
# :math:`\beta^4 = 3 (1 - \nu^2) / a^2 t^2` the moment at the foot is
# :math:`\gamma (h - 1/\beta) / 2 \beta^2`, and the rest of the water is carried around. Theory of
# thin shells has no shear strain, so GA is large here; that of concrete makes the moment 3 %
# smaller.
E, nu, t, a, h, fluid = 3e7, 0.2, 0.3, 8.0, 9.0, 9.81
beta = (3 * (1 - nu**2) / (a * t) ** 2) ** 0.25
fig, (ax, hoop_ax) = plt.subplots(1, 2, figsize=(8, 3.8), layout="constrained", sharey=True)
for n, largest in ((9, 2e-3), (18, 1e-3)):
    begin = process_time()
    wall = sc.Beam(
        None,
        np.column_stack((np.full(n + 1, a), np.linspace(0, h, n + 1))),
        EI=E * t**3 / 12 / (1 - nu**2),
        EA=E * t / (1 - nu**2),
        GA=1e12,
        coordinates="axisymmetric",
        nu=nu,
    )
    model = sc.Model({"wall": wall}, wall.dofs((a, 0.0)))
    load = model.forms["wall"].line_load(lambda x: np.stack((fluid * (h - x[1]), 0 * x[1])))
    forces = model.run([sc.Stage("full", load)], progress=False)["full"].section_forces("wall")
    y, exact = (
        forces.y,
        fluid
        / (2 * beta**2)
        * np.exp(-beta * forces.y)
        * ((h - 1 / beta) * np.cos(beta * forces.y) - h * np.sin(beta * forces.y)),
    )
    record("tank, M at the foot", n, model, begin, [abs(forces.M[0])], [exact[0]], largest)
    assert abs(np.abs(forces.M) - np.abs(exact)).max() < 2e-3 * exact[0]
    ax.plot(
        np.sign(forces.M[0]) * forces.M, y, "os"[n > 9], ms=4, mfc="none", label=f"{n} elements"
    )
    hoop_ax.plot(forces.N_hoop, y, "os"[n > 9], ms=4, mfc="none")
ax.plot(exact, y, "k-", lw=1, label="exact")
hoop_ax.plot(
    fluid
    * a
    * (h - y - np.exp(-beta * y) * (h * np.cos(beta * y) + (h - 1 / beta) * np.sin(beta * y))),
    y,
    "k-",
    lw=1,
)
ax.set(xlabel="moment [kNm/m]", ylabel="height [m]")
hoop_ax.set(xlabel="normal force around [kN/m]")
ax.legend(frameon=False)
plt.show()

# %%
# In space
# --------
# Points (x, y, z) make beams in space, with six dofs a node and round sections. A quarter of a
# circle, held at one end and loaded across its plane at the other, is bent and twisted. By
# Castigliano's theorem its end moves by
# :math:`P R^3 (\pi / 4 EI + (3 \pi / 4 - 2) / GJ) + \pi P R / 2 GA`.
for n, largest in ((4, 1e-3), (8, 1e-4)):
    begin = process_time()
    angle, ends = np.linspace(0, np.pi / 2, 2 * n + 1), np.arange(0, 2 * n, 2)
    points = 1.5 * np.column_stack((np.cos(angle), np.sin(angle), 0 * angle))
    bow = sc.Beam(
        None,
        points,
        EI=3.0,
        GJ=2.0,
        EA=1e4,
        GA=1e3,
        cells=np.column_stack((ends, ends + 2, ends + 1)),
    )
    model = sc.Model({"bow": bow}, bow.dofs(points[0]))
    form = model.forms["bow"]
    stage = model.run(
        [sc.Stage("bent", form.load((0.0, 0.0, 1.0), at=points[-1]))], progress=False
    )["bent"]
    exact = 1.5**3 * (np.pi / 4 / 3.0 + (3 * np.pi / 4 - 2) / 2.0) + np.pi * 1.5 / 2e3
    record(
        "quarter circle in space, w",
        n,
        model,
        begin,
        [stage.x[form.numbers(points[-1])[2]]],
        [exact],
        largest,
    )

# %%
# A beam bonded to a half-plane
# -----------------------------
# The name of a line instead of points: the beam has the nodes of the ground there. Under a force on
# a long beam the moment is :math:`2 P a / 3 \sqrt 3` with :math:`a^3 = 2 EI (1 - \nu^2) / E`.
for per, largest in ((1, 3.5e-3), (2, 1e-3)):
    begin = process_time()
    x = np.concatenate((np.arange(0, 6, 1 / per), 6 + 54 * np.linspace(0, 1, 5 * per + 1) ** 2.2))
    mesh = MeshTri.init_tensor(np.concatenate((-x[:0:-1], x)), -x[::-1]).with_boundaries(
        {
            "footing": lambda x: (x[1] > -1e-9) & (abs(x[0]) < 20),
            "far": lambda x: (x[1] < -59.9) | (abs(x[0]) > 59.9),
        }
    )
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    forms = {
        "soil": sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.3)),
        "beam": sc.Beam(basis, "footing", EI=0.5 / (1 - 0.3**2), EA=1e-9, GA=1e4),
    }
    model = sc.Model(forms, basis.get_dofs("far").all())
    load = model.forms["beam"].load((0.0, -1e-3), at=(0.0, 0.0))
    stage = model.run([sc.Stage("force", load)], progress=False)["force"]
    moment = -1e3 * stage.section_forces("beam").M.min()
    record("half-plane, M", per, model, begin, [moment], [2 / np.sqrt(27)], largest)

# %%
# Collapse
# --------
# Three frames of plastic moment Mp: a propped cantilever of length L, ``P = 6 Mp / L``; a portal of
# height h and span 2 h under ``V = 2 H``, ``H = 2 Mp / h``; and a cantilever under half of its
# plastic thrust, ``P = Mp / 2 L``. The curves level off exactly there, with four elements or with
# eight.
begin = process_time()
fig, ax = plt.subplots(figsize=(6.5, 4), layout="constrained")
strong = {"EI": 100.0, "EA": 1e4, "GA": 1e6, "Mp": 3.0}
portal = np.vstack(
    (
        np.column_stack((np.zeros(4), np.linspace(0, 1, 5)[:4])),
        level(0, 2, 8) + np.array([0, 1]),
        np.column_stack((np.full(4, 2.0), np.linspace(1, 0, 5)[1:])),
    )
)
propped, column = (
    sc.Beam(None, level(0, 2, 4), **strong),
    sc.Beam(None, level(0, 2, 4), Np=50.0, **strong),
)
frame = sc.Beam(None, portal, **strong)
cases = {
    "propped cantilever": (
        propped,
        [*propped.dofs((0.0, 0.0)), *propped.dofs((2.0, 0.0), ["u^2"])],
        {(1.0, 0.0): (0.0, -1.0)},
        None,
        9.0,
    ),
    "portal": (
        frame,
        [*frame.dofs((0.0, 0.0)), *frame.dofs((2.0, 0.0))],
        {(0.0, 1.0): (1.0, 0.0), (1.0, 1.0): (0.0, -2.0)},
        None,
        6.0,
    ),
    "cantilever under thrust": (
        column,
        column.dofs((0.0, 0.0)),
        {(2.0, 0.0): (0.0, 1.0)},
        ((-25.0, 0.0), (2.0, 0.0)),
        0.75,
    ),
}
for name, (beam, fixed, loads, thrust, exact) in cases.items():
    model = sc.Model({"frame": beam}, fixed, newton=sc.Newton(tolerance=1e-9))
    form = model.forms["frame"]
    start = (
        None
        if thrust is None
        else model.run([sc.Stage("thrust", form.load(*thrust))], progress=False)
    )
    found = model.limit_load(
        sum(form.load(force, at) for at, force in loads.items()), start=start, progress=False
    )
    assert found.stop.kind in ("plateau", "collapse")
    record(name, len(beam.cells), model, begin, [found.multiplier], [exact], 1e-6, found.iterations)
    _, multiplier, displacement = found.curve.T
    shown = displacement < 40 * displacement[1]
    ax.plot(
        displacement[shown] / displacement[1],
        multiplier[shown] / exact,
        "o-",
        ms=3,
        mfc="none",
        label=name,
    )
ax.axhline(1.0, color="0.6", lw=1, ls="--")
ax.set(
    xlabel="displacement over that of the first step",
    ylabel="load over the exact collapse load",
    ylim=(0, 1.1),
)
ax.legend(frameon=False)
plt.show()

# %%
# Headline numbers
# ----------------
print(json.dumps({"case": "beams", "rows": rows}))
