r"""
Settlement of an embankment on soft clay
========================================

Two lifts of fill are placed on 8 m of soft clay, which then consolidates for years. Modified Cam
Clay starts from its history: it is stiff up to its preconsolidation pressure and soft beyond.
Mohr-Coulomb with one modulus, chosen by hand for about the same final settlement, stands beside it.
How do settlement, pore pressure and yielded zone differ?
"""

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc
from skfem_contact import plot

plot.set_units("kN", "m")

DEPTH, LIFT, CREST, TOE, WIDTH = 8.0, 0.9, 5.0, 10.0, 30.0
GAMMA_CLAY, GAMMA_FILL = 6.0, 19.0  # of the clay under water, of the fill, kN/m³
PERMEABILITY = 1e-4  # m/day
M, NU, K0 = 1.1, 0.25, 0.6
PHI = np.degrees(np.arcsin(3 * M / (6 + M)))  # of the same critical state in triaxial compression

# %%
# Ground
# ------
# Half of the embankment. The clay is under water, whose surface is that of the clay and drains. The
# lowest stress is that of the surface: an attraction of 8 kPa gives it stiffness, and that cohesion
# goes into Mohr-Coulomb. The clay has once had 20 kPa more than today, everywhere.

x = np.concatenate(
    (
        np.linspace(0, CREST, 4)[:-1],
        np.linspace(CREST, TOE, 5)[:-1],
        TOE + (WIDTH - TOE) * np.linspace(0, 1, 7) ** 1.4,
    )
)
ground = MeshTri.init_tensor(x, -DEPTH * np.linspace(1, 0, 8) ** 1.3)
fill = MeshTri.init_tensor(x[:8], np.linspace(0, 2 * LIFT, 5))
fill = MeshTri(
    np.stack((fill.p[0] / TOE * (TOE - (TOE - CREST) / (2 * LIFT) * fill.p[1]), fill.p[1])), fill.t
)
parts = {
    "clay": lambda x: x[1] < 0,
    "lift 1": lambda x: (x[1] > 0) & (x[1] < LIFT),
    "lift 2": lambda x: x[1] > LIFT,
}
mesh = (ground + fill).with_subdomains(parts)
mesh = mesh.with_boundaries({"surface": lambda x: abs(x[1]) < 1e-9}, boundaries_only=False)
basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
at = basis.doflocs
sides = np.flatnonzero((at[0] < 1e-9) | (at[0] > WIDTH - 1e-9))
fixed = np.union1d(sides[sides % 2 == 0], np.flatnonzero(at[1] < 1e-9 - DEPTH))
centre = np.flatnonzero((at[0] < 1e-9) & (abs(at[1]) < 1e-9))[-1]

clays = {
    "Modified Cam Clay": sc.CamClay(
        kappa=0.012, lambda_=0.08, M=M, nu=NU, p_ref=30.0, POP=20.0, attraction=8.0
    ),
    "Mohr-Coulomb": sc.MohrCoulomb(E=1.2e3, nu=0.3, c=8.0 * np.tan(np.radians(PHI)), phi=PHI),
}
sand = sc.MohrCoulomb(E=1e4, nu=0.3, c=8.0, phi=33.0)
STAGES = [
    ("lift 1", 10.0, 5),
    ("wait", 90.0, 1),
    ("lift 2", 10.0, 5),
    ("a year", 365.0, 1),
    ("ten years", 3285.0, 1),
]


def built(clay):
    """Results of all stages."""
    forms = {
        name: sc.SolidForm(basis.with_elements(name), clay if name == "clay" else sand)
        for name in parts
    }
    forms["water"] = sc.PoreWater(basis.with_elements("clay"), PERMEABILITY, unit_weight=9.81)
    load = sc.weight(basis, {"clay": GAMMA_CLAY})
    start = sc.Model({"clay": forms["clay"]}, fixed).k0_state(
        load, unit_weights={"clay": GAMMA_CLAY}, K0=K0
    )
    stages = []
    for name, duration, increments in STAGES:
        active = ()
        if name.startswith("lift"):
            load = load + sc.weight(basis, {name: GAMMA_FILL})
            active = [name, "water"] if name == "lift 1" else name
        stages.append(
            sc.Stage(name, load, duration=duration, increments=increments, activate=active, keep=1)
        )
    return sc.Model(forms, [fixed, forms["water"].dofs("surface")]).run(
        stages, start=start, progress=False
    )


rows, results = [], {}
for name, clay in clays.items():
    begin = process_time()
    result = results[name] = built(clay)
    water, last = result[-1].forms["water"], result[-1].states["water"]
    lost = abs(water.inflow(last, "surface") / water.volume(last) - 1)
    most = max(max(stage.iterations) for stage in result.stages[1:])
    steps = sum(len(stage.iterations) for stage in result.stages[1:])
    settled = {stage.name: -float(stage.x[centre]) for stage in result.stages[1:]}
    pressure = {
        stage.name: float(np.nanmax(stage.forms["water"].pressure(stage.x)))
        for stage in result.stages[1:]
    }
    rows.append(
        {
            "method": name,
            "n": mesh.nelements,
            "unknowns": len(result[-1].x),
            "error": float(lost),
            "cpu_s": round(process_time() - begin, 2),
            "iterations": sum(sum(stage.iterations) for stage in result),
            "most_iterations": most,
            "steps": steps,
            "settlement_m": {k: round(v, 4) for k, v in settled.items()},
            "pore_pressure": {k: round(v, 2) for k, v in pressure.items()},
        }
    )
    print(
        f"{name}: settlement",
        ", ".join(f"{k} {1e3 * v:.0f}" for k, v in settled.items()),
        "mm; excess pressure",
        ", ".join(f"{v:.1f}" for v in pressure.values()),
        f"kPa; {rows[-1]['cpu_s']} s",
    )
    assert (
        rows[-1]["iterations"] <= 3 * 2 * steps and most <= 2 * 5
    )  # every step consists of two solutions
    assert lost < 1e-8  # all water that the clay has lost has left through its surface
    assert (np.diff(list(settled.values())) > 0).all()
    assert pressure["ten years"] < 0.1 * pressure["lift 2"]

# %%
# Settlement in time
# ------------------
# Both settle by about the same in the end. Below its preconsolidation pressure Cam Clay is stiff:
# while the fill is placed it settles by less than half as much, and most of the settlement is still
# to come. Its pressures sink faster at first, because stiff ground consolidates faster. A step in
# time consists of two solutions, of second order; each takes two to four iterations, six at most,
# right after a lift.

clay, plain = (row["settlement_m"] for row in rows)
assert abs(clay["ten years"] / plain["ten years"] - 1) < 0.15
assert clay["lift 2"] < 0.5 * plain["lift 2"]
assert rows[0]["pore_pressure"]["a year"] < 0.7 * rows[1]["pore_pressure"]["a year"]

figure, axes = plt.subplots(figsize=(7, 3.8), layout="constrained")
for (name, result), style in zip(results.items(), ("o-", "s--"), strict=True):
    stages = [part for stage in result.stages[1:] for part in (*stage.increments, stage)]
    course = [-1e3 * part.x[centre] for part in stages]
    axes.plot([part.time for part in stages], course, style, markersize=3, label=name)
axes.set(
    xscale="log", xlabel="time [days]", ylabel="settlement under the centre [mm]", xlim=(1, None)
)
axes.invert_yaxis()
axes.legend(frameon=False)

# %%
# Pore pressure under the centre
# ------------------------------

depths = {f"{z} m": (0.0, -z) for z in (2.0, 4.0, 8.0)}
plot.history(results["Modified Cam Clay"], "pore", depths, time=True)

# %%
plot.history(results["Mohr-Coulomb"], "pore", depths, time=True)

# %%
# Yielded zone
# ------------
# Cam Clay yields by compression below the whole embankment, Mohr-Coulomb by shear alone.

for name, result in results.items():
    last = result["ten years"]
    form = last.forms["clay"]
    share = float((form.variable("plastic strain", last.states["clay"]) > 0).mean())
    print(f"{name}: {share:.0%} of the clay have yielded")
    rows[list(results).index(name)]["yielded"] = round(share, 3)
assert rows[0]["yielded"] > 2 * rows[1]["yielded"]
plot.contour(results["Modified Cam Clay"]["ten years"], "plastic")

# %%
plot.contour(results["Mohr-Coulomb"]["ten years"], "plastic")
plt.show()

# %%
# Headline numbers
# ----------------
print(json.dumps({"case": "soft clay", "rows": rows}))
