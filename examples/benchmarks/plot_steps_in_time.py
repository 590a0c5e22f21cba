r"""
Steps in time
=============

A rectangle of elastic ground with Rayleigh damping shakes by forces on its surface, in equal steps
of the trapezoidal rule. A step of the package is compared with one of a plain loop that keeps one
factor of ``scipy.sparse.linalg.splu``, and with ``--full`` with OpenSees, whose fastest solver
counts. All have the same mesh, masses, steps and results. Then explicit steps of the same ground,
and iterations of a footing on Mohr-Coulomb soil in time and at rest. Times are medians of process
time over steps of runs that take turns.
"""

import json
import sys
from importlib.metadata import version
from importlib.util import find_spec
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from scipy.sparse.linalg import splu
from skfem import Basis, ElementQuad1, ElementTriP2, ElementVector, MeshQuad, MeshTri

import skfem_contact as sc

step, unit_weight, g = 0.01, 20.0, 10.0
E, nu = 2e5, 0.3
damping = sc.Rayleigh(0.05, f=(1.0, 5.0))
full = "--full" in sys.argv
#: Elements along both sides, steps and rounds.
sizes = {2_000: (40, 24), 10_000: (99, 49), 40_000: (199, 99)}
if not full:
    del sizes[40_000]
steps, rounds = (40, 5) if full else (20, 3)


def swings(time):
    """Force of each node of the surface."""
    return np.sin(4.0 * np.pi * time)


def ground(nx, ny):
    """Basis, model, load of a unit and the dof at the corner of the surface."""
    mesh = MeshQuad.init_tensor(np.linspace(0, 2.0 * nx, nx + 1), np.linspace(0, 2.0 * ny, ny + 1))
    basis = Basis(mesh.with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    soil = sc.SolidForm(basis, sc.LinearElastic(E=E, nu=nu), unit_weight=unit_weight)
    fixed = basis.get_dofs("bottom").all()
    model = sc.Model({"soil": soil}, fixed, solver="superlu", gravity_acceleration=g)
    top = basis.get_dofs("top").all("u^1")
    unit = basis.zeros()
    unit[top] = 1.0
    return basis, soil, model, unit, top[np.argmin(basis.doflocs[0, top])]


# %%
# The package, with the state at rest under the weight as its start:
def by_package(model, start, unit, corner):
    """Motion of the corner, and the median time of a step."""
    times, moved = [], []
    settled = start[-1].x[corner]

    def see(stage):
        times.append(process_time())
        moved.append(stage.x[corner] - settled)

    settings = sc.Dynamic(step, rho_inf=1.0, damping=damping)
    shake = sc.Stage("shake", lambda t: swings(t) * unit, duration=steps * step, dynamic=settings)
    model.run([shake], start=start, progress=False, on_increment=see)
    return np.array(moved), np.median(np.diff(times)[2:])


# %%
# A plain loop by Newmark's rule on the matrices of the package:
class Plain:
    """The same steps with one kept factor."""

    def __init__(self, basis, soil):
        K = soil.elastic_stiffness
        M = soil.weight_matrix(False) / g
        C = damping.alpha * M + damping.beta * K
        self.free = np.setdiff1d(np.arange(basis.N), basis.get_dofs("bottom").all())
        A = (4.0 / step**2 * M + 2.0 / step * C + K)[self.free][:, self.free].tocsc()
        options = {"SymmetricMode": True}
        self.factor = splu(A, "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
        self.M = M[self.free][:, self.free].tocsr()
        self.C = C[self.free][:, self.free].tocsr()

    def run(self, unit, corner):
        """Motion of the corner, and the median time of a step."""
        unit = unit[self.free]
        at = np.searchsorted(self.free, corner)
        u = v = a = np.zeros(len(self.free))
        times, moved = [process_time()], []
        for k in range(steps):
            right = swings((k + 1) * step) * unit
            right = right + self.M @ (4.0 / step**2 * u + 4.0 / step * v + a)
            right = right + self.C @ (2.0 / step * u + v)
            new = self.factor.solve(right)
            new_a = 4.0 / step**2 * (new - u) - 4.0 / step * v - a
            v = v + 0.5 * step * (a + new_a)
            u, a = new, new_a
            moved.append(u[at])
            times.append(process_time())
        return np.array(moved), np.median(np.diff(times)[2:])


# %%
# OpenSees, with one kept factor of each of its solvers; in the largest mesh of the three fastest in
# the one before, for fewer steps:
SOLVERS = ("BandSPD", "ProfileSPD", "SparseSYM", "SuperLU", "UmfPack", "Mumps")


def by_opensees(nx, ny, solver, steps):
    """Motion of the corner, and the median time of a step; None where it has no such solver."""
    from openseespy import opensees as ops

    # The mesh and its material
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 2)
    for j in range(ny + 1):
        for i in range(nx + 1):
            ops.node(j * (nx + 1) + i + 1, 2.0 * i, 2.0 * j)
    for i in range(nx + 1):
        ops.fix(i + 1, 1, 1)
    ops.nDMaterial("ElasticIsotropic", 1, E, nu, unit_weight / g)
    for j in range(ny):
        for i in range(nx):
            a = j * (nx + 1) + i + 1
            corners = (a, a + 1, a + nx + 2, a + nx + 1)
            ops.element("quad", j * nx + i + 1, *corners, 1.0, "PlaneStrain", 1)

    # Load and damping
    ops.timeSeries("Trig", 1, 0.0, 100.0, 0.5)
    ops.pattern("Plain", 1, 1)
    for i in range(nx + 1):
        ops.load(ny * (nx + 1) + i + 1, 1.0, 0.0)
    ops.rayleigh(damping.alpha, damping.beta, 0.0, 0.0)

    # The analysis
    ops.constraints("Plain")
    ops.numberer("RCM")
    try:
        ops.system(solver)
    except Exception:
        return None
    ops.algorithm("Linear", "-factorOnce")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    times, moved = [process_time()], []
    for _ in range(steps):
        if ops.analyze(1, step) != 0:
            return None
        moved.append(ops.nodeDisp(ny * (nx + 1) + 1, 1))
        times.append(process_time())
    return np.array(moved), np.median(np.diff(times)[2:])


# %%
# Explicit steps of the same ground:
def explicitly(model, start, unit):
    """Median time of an explicit step."""
    times = []
    settings = sc.Dynamic(explicit=True)
    shake = sc.Stage("shake", swings(0.1) * unit, duration=0.3, dynamic=settings)

    def see(stage):
        times.append(process_time())

    model.run([shake], start=start, progress=False, on_increment=see)
    return np.median(np.diff(times)[2:])


# %%
# A footing whose load rises at rest or swings in time:
def footing():
    """Time of an iteration at rest and in time, with their numbers, and unknowns."""
    mesh = MeshTri.init_tensor(np.linspace(0, 10, 25), np.linspace(-5, 0, 13)).with_defaults()
    mesh = mesh.with_boundaries({"footing": lambda x: (x[1] > -1e-9) & (x[0] < 1.0 + 1e-9)})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
    sand = sc.MohrCoulomb(E=3e4, nu=0.3, c=10.0, phi=20.0, psi=5.0)
    soil = sc.SolidForm(basis, sand, unit_weight=18.0)
    model = sc.Model({"soil": soil}, sc.box_supports(basis), gravity_acceleration=g)
    pressure = sc.traction(basis, "footing", (0.0, -100.0))
    start = model.run([sc.Stage("rest")], progress=False)

    def swing(time):
        return np.sin(4.0 * np.pi * time) ** 2 * pressure

    stages = {
        "footing at rest": sc.Stage("load", pressure, increments=20),
        "footing in time": sc.Stage("shake", swing, duration=0.25, dynamic=sc.Dynamic(0.005)),
    }
    found = {name: [] for name in stages}
    iterations = {}
    for _ in range(rounds):
        for name, stage in stages.items():
            begin = process_time()
            result = model.run([stage], start=start, progress=False)
            iterations[name] = sum(result[-1].iterations)
            found[name].append((process_time() - begin) / iterations[name])
    return {name: np.median(times) for name, times in found.items()}, iterations, basis.N


# %%
# All rows:
rows, fastest = [], list(SOLVERS)
for unknowns, (nx, ny) in sizes.items():
    basis, soil, model, unit, corner = ground(nx, ny)
    start = model.run([sc.Stage("rest")], progress=False)
    # before factors have spread the memory of the process, which costs up to twice the time
    explicit = min(explicitly(model, start, unit) for _ in range(rounds))
    plain = Plain(basis, soil)
    seconds = {"package": [], "plain loop": []}
    for _ in range(rounds):
        moved, time = by_package(model, start, unit, corner)
        seconds["package"].append(time)
        wanted, time = plain.run(unit, corner)
        seconds["plain loop"].append(time)
    apart = np.abs(moved - wanted).max() / np.abs(wanted).max()
    errors = {"package": float(apart), "plain loop": None}
    peers = {}
    if full and find_spec("openseespy"):
        largest = unknowns == max(sizes)
        solvers, count = (fastest, 12) if largest else (SOLVERS, steps)
        speed = {}
        for solver in solvers:
            found = by_opensees(nx, ny, solver, count)
            if found is not None:
                name = f"OpenSees, {solver}"
                same = wanted[:count]
                errors[name] = float(np.abs(found[0] - same).max() / np.abs(same).max())
                seconds[name] = [found[1]]
                speed[solver] = found[1]
                peers[name] = f"OpenSees {version('openseespy')}"
                print(unknowns, solver, f"{1e3 * found[1]:.1f} ms", flush=True)
        fastest = sorted(speed, key=speed.get)[:3]
    seconds["explicit"] = [explicit]
    errors["explicit"] = None
    elements = basis.nelems / explicit
    print(f"{basis.N} unknowns: {elements:.3g} elements a second by explicit steps")
    for name, times in seconds.items():
        row = {
            "method": name,
            "n": unknowns,
            "unknowns": int(basis.N),
            "error": errors[name],
            "cpu_s": float(np.median(times)),
            "iterations": steps,
        }
        if name in peers:
            row["peer"] = peers[name]
        rows.append(row)

times, iterations, unknowns = footing()
for name, time in times.items():
    row = {"method": name, "n": int(unknowns), "unknowns": int(unknowns), "error": None}
    rows.append({**row, "cpu_s": float(time), "iterations": int(iterations[name])})

# %%
# Times of a step, and of an iteration of the footing:
fig, ax = plt.subplots(figsize=(7, 3.5), layout="constrained")
names = list(dict.fromkeys(row["method"] for row in rows))
for name in names:
    own = [row for row in rows if row["method"] == name]
    ax.loglog([r["unknowns"] for r in own], [1e3 * r["cpu_s"] for r in own], "o-", label=name)
ax.set(xlabel="unknowns", ylabel="time of a step [ms]")
ax.legend(frameon=False)
for row in rows:
    print(
        f"{row['unknowns']:6} {row['method']:22} {1e3 * row['cpu_s']:8.3f} ms, "
        f"difference {row['error'] or 0.0:.1e}"
    )
assert max(row["error"] or 0.0 for row in rows) < 1e-6
if full:
    assert times["footing in time"] < 1.3 * times["footing at rest"]
    for unknowns in sizes:
        times = {row["method"]: row["cpu_s"] for row in rows if row["n"] == unknowns}
        peer = [time for name, time in times.items() if name.startswith("OpenSees")]
        # Records, checks and results of a step take 150 microseconds, whatever its size.
        limit = 1.2 if unknowns >= 10_000 else 1.7
        assert times["package"] < limit * times["plain loop"], times
        assert not peer or times["package"] < min(peer) / 6.0, times
print(json.dumps({"case": "steps_in_time", "rows": rows}))
