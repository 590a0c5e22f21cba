r"""
An embankment on soft clay
==========================

A road is built up in three lifts on 6 m of soft clay under water, and the clay is given time to
consolidate after each. Quickly placed fill is carried by the pressure of the water at first: that
does not make the clay any stronger. While the water leaves the clay settles and gains strength, and
the next lift can come. How safe is the embankment at each moment?

The soil dilates not at all, or as much as it has friction: :math:`\psi = 0` and :math:`\varphi`.
``--full`` adds 5°, and searches for the factor after each stage of all three.
"""

import json
import sys
import time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("kN", "m")

DEPTH, LIFT, LIFTS, CREST, SLOPE, WIDTH = 6.0, 1.0, 3, 4.0, 2.0, 24.0
GAMMA_CLAY, GAMMA_FILL = 7.0, 19.0  # of the clay under water, of the fill, kN/m³
PHI = 24.0
PLACING, WAITING = 4.0, 60.0  # days for a lift, and for the clay after it
K = 2e-4  # m/day
FULL = "--full" in sys.argv

# %%
# The ground and the lifts
# ------------------------
# Half of the road. The fill is a grid whose outer side is drawn in to the slope; it stands on the
# nodes of the clay.

TOE = CREST + SLOPE * LIFT * LIFTS
x = np.concatenate(
    (
        np.linspace(0, CREST, 3)[:-1],
        np.linspace(CREST, TOE, 7)[:-1],
        TOE + (WIDTH - TOE) * np.linspace(0, 1, 5) ** 1.4,
    )
)
clay = MeshTri.init_tensor(x, -DEPTH * np.linspace(1, 0, 6) ** 1.3)
fill = MeshTri.init_tensor(x[:9], np.linspace(0, LIFT * LIFTS, LIFTS + 1))
inside = fill.p[0] / TOE * (TOE - SLOPE * fill.p[1])
mesh = clay + MeshTri(np.stack((inside, fill.p[1])), fill.t)
parts = {"clay": lambda x: x[1] < 0}
parts |= {
    f"lift {i + 1}": lambda x, i=i: (x[1] > i * LIFT) & (x[1] < (i + 1) * LIFT)
    for i in range(LIFTS)
}
mesh = mesh.with_subdomains(parts).with_boundaries(
    {"surface": lambda x: abs(x[1]) < 1e-9}, boundaries_only=False
)
basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
sides = np.flatnonzero((basis.doflocs[0] < 1e-9) | (basis.doflocs[0] > WIDTH - 1e-9))
fixed = np.union1d(sides[sides % 2 == 0], np.flatnonzero(basis.doflocs[1] < 1e-9 - DEPTH))

# %%
# Stages
# ------
# Water is in the clay alone; its surface drains. The pressures count from those of still water,
# under which the clay weighs less. The fill is dry.


def build(psi: float, wait: float = WAITING):
    """Forms, and the result of all stages, in which the clay is given some time after each lift."""
    soft = sc.MohrCoulomb(E=3e3, nu=0.3, c=4.0, phi=PHI, psi=psi)
    sand = sc.MohrCoulomb(E=2e4, nu=0.3, c=2.0, phi=33.0, psi=0.0)
    forms = {
        name: sc.SolidForm(basis.with_elements(name), soft if name == "clay" else sand)
        for name in parts
    }
    forms["water"] = sc.PoreWater(basis.with_elements("clay"), K, unit_weight=9.81)
    load = sc.weight(basis, {"clay": GAMMA_CLAY})
    start = sc.Model({"clay": forms["clay"]}, fixed).k0_state(
        load, unit_weights={"clay": GAMMA_CLAY}, K0=0.6
    )
    stages = []
    for i in range(LIFTS):
        name = f"lift {i + 1}"
        load = load + sc.weight(basis, {name: GAMMA_FILL})
        stages += [
            sc.Stage(
                name,
                load,
                duration=PLACING,
                increments=4,
                activate=[name, "water"] if i == 0 else name,
            ),
            sc.Stage(f"rest {i + 1}", load, duration=wait),
        ]
    drained = [fixed, forms["water"].dofs("surface")]
    return forms, sc.Model(forms, drained).run(stages, start=start, progress=False)


rows, factors = [], {}


def factor(forms, stage, key) -> None:
    """Factor of safety at the end of a stage: the pressures are those of that moment."""
    began = time.process_time()
    found = sc.Model(forms, fixed).strength_reduction(start=stage, tolerance=0.05, progress=False)
    factors[key, stage.name] = found.factor
    rows.append(
        {
            "method": f"{key}, after {stage.name}",
            "n": mesh.nelements,
            "unknowns": len(stage.x),
            "factor": round(found.factor, 3),
            "error": None,
            "cpu_s": round(time.process_time() - began, 2),
            "iterations": found.iterations,
        }
    )


for psi in (0.0, 5.0, PHI) if FULL else (0.0, PHI):
    began, key = time.process_time(), f"psi = {psi:g}"
    forms, result = build(psi)
    water, last = forms["water"], result[-1].states["water"]
    lost = abs(water.inflow(last, "surface") / water.volume(last) - 1)
    rows.append(
        {
            "method": f"{key}, stages",
            "n": mesh.nelements,
            "unknowns": len(result[-1].x),
            "error": lost,
            "cpu_s": round(time.process_time() - began, 2),
            "iterations": sum(sum(stage.iterations) for stage in result),
        }
    )
    assert lost < 1e-8  # all water that the clay has lost has left through its surface
    searched = result.stages[1 if FULL else 3 if psi == 0.0 else -1 :]
    for stage in searched:
        factor(forms, stage, key)
    print(
        f"{key:<9}", ", ".join(f"{stage.name} {factors[key, stage.name]:.2f}" for stage in searched)
    )
    for i in range(4 - len(searched) // 2, 4):  # every rest makes it safer
        assert factors[key, f"rest {i}"] > factors[key, f"lift {i}"] + 0.1
    if psi == 0.0:
        kept = forms, result

# %%
# Without the time to wait
# ------------------------
# The same lifts, one right after the other.

quick, hurried = build(0.0, wait=1.0)
factor(quick, hurried["lift 3"], "no rest")
print(
    f"three lifts in {3 * PLACING + 2:g} days: {factors['no rest', 'lift 3']:.2f}, "
    f"in {3 * PLACING + 2 * WAITING:g} days: {factors['psi = 0', 'lift 3']:.2f}"
)
assert factors["no rest", "lift 3"] < factors["psi = 0", "lift 3"] - 0.02

# %%
# The factor falls with every lift and rises while the clay consolidates. What the clay dilates
# makes little difference, because it is far from failure.

figure, ax = plt.subplots(figsize=(7.5, 4.2), layout="constrained")
for key, style in (("psi = 0", "o-"), ("psi = 24", "^:"), ("psi = 5", "s--"))[: 3 if FULL else 2]:
    found = {
        stage.time: factors[key, stage.name]
        for stage in result.stages
        if (key, stage.name) in factors
    }
    ax.plot(found.keys(), found.values(), style, label=key)
ax.plot(hurried["lift 3"].time, factors["no rest", "lift 3"], "x", color="black", label="no rest")
ax.set(xlabel="time [days]", ylabel="factor of safety")
ax.legend(frameon=False)

# %%
# The excess pressure right after the last lift, and its course below the middle of the road.

forms, result = kept
plot.contour(result["lift 3"], "pore", mesh=False)

# %%

figure = plot.history(result, "pore", {"3 m deep": (0.0, -3.0), "base": (0.0, -DEPTH)}, time=True)
figure.axes[0].set_xlabel("time [days]")
plt.show()

# %%
# Figures
# -------

print(json.dumps({"case": "embankment", "rows": rows}))
