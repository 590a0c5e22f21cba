r"""
An excavation below the water
=============================

A pit 6 m deep is dug in sand beside a sheet pile wall 14 m long, next to open water that
stands at the surface. Each lift is pumped dry, then dug; after the first one a strut is
set. The wall is tight: water flows round its toe into the pit. It presses on the wall,
makes the sand behind heavier and the sand before the toe, which should hold it, lighter.

What is the moment in the wall, with the water and without? And does the bottom of the pit
hold? Two checks from hydraulics answer that: the exit gradient, and Terzaghi's block before
the wall, :math:`D` deep and :math:`D / 2` wide, whose weight under water is compared with
the lift of the flow on its base. A third one, of strength, is a factor of safety between
two proven bounds.

The flow is compared with the method of fragments (M. E. Harr, Groundwater and Seepage,
1962, ch. 5): below the toe the head is taken as constant, :math:`q = k h / (\Phi_1 +
\Phi_2)`, and each side of the wall is a rectangle with a form factor :math:`\Phi` that
conformal mapping tells exactly.
"""

# sphinx_gallery_thumbnail_number = 1

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from scipy.special import ellipj, ellipk
from skfem import Basis, ElementTriP2, ElementVector, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("kN", "m")

INNER, THICK, FAR, TOE, BASE = 6.0, 0.3, 30.0, -14.0, -20.0
OUTER = INNER + THICK
LEVELS = (0.0, -2.0, -4.0, -6.0)  # surface, and bottom of each lift: there the water stands
LIFTS = {f"lift {i}": (LEVELS[i], LEVELS[i - 1]) for i in (1, 2, 3)}
WEIGHT, WATER, K0, K = 20.0, 9.81, 0.5, 1e-4  # kN/m³, m/s
SOIL = sc.MohrCoulomb(E=4e4, nu=0.3, c=3.0, phi=33.0, psi=10.0)
WALL = sc.LinearElastic(E=5.2e7, nu=0.2)  # as stiff as a profile of 1.2e5 kNm²/m
WALL_WEIGHT = 6.0

# %%
# Mesh and forms
# --------------
# The lifts are bodies that go, and so is their contact with the wall. Both sides of the
# joint are cut into the parts that belong to the lifts and to the rest.


def is_wall(x):
    """Points of the wall."""
    return (x[0] > INNER) & (x[0] < OUTER) & (x[1] > TOE)


def in_lift(name):
    """Points of a lift."""
    low, high = LIFTS[name]
    return lambda x: (x[0] < INNER) & (x[1] > low) & (x[1] < high)


def ground_and_wall():
    """Mesh of sand, lifts and wall with the parts of their joint."""
    behind = OUTER + (FAR - OUTER) * np.expm1(np.linspace(0, 3, 11)) / np.expm1(3)
    across = np.concatenate((INNER * (1 - np.linspace(1, 0, 10) ** 1.4), behind))
    heights = np.append(
        TOE + (BASE - TOE) * np.linspace(1, 0, 7) ** 1.5, np.linspace(TOE, 0, 22)[1:]
    )
    mesh = (
        MeshQuad.init_tensor(across, heights)
        .to_meshtri()
        .with_defaults()
        .with_subdomains(
            {
                "wall": is_wall,
                **{name: in_lift(name) for name in LIFTS},
                "sand": lambda x: (
                    ~(is_wall(x) | np.any([in_lift(name)(x) for name in LIFTS], axis=0))
                ),
            }
        )
    )
    mesh = sc.join_bodies(mesh, bodies={"ground": ["sand", *LIFTS], "piles": "wall"})
    named = {"lake": mesh.facets_satisfying(lambda x: (x[1] > -1e-9) & (x[0] > OUTER), True)}
    for i, level in enumerate(LEVELS):
        named[f"floor {i}"] = mesh.facets_satisfying(
            lambda x, y=level: (abs(x[1] - y) < 1e-9) & (x[0] < INNER)
        )
    for one, other in (("ground", "piles"), ("piles", "ground")):
        facets = np.asarray(mesh.boundaries[f"{one}|{other}"])
        x = mesh.p[:, mesh.facets[:, facets]].mean(axis=1)
        parts = {
            name: (x[0] < INNER + 1e-9) & (x[1] > low) & (x[1] < high)
            for name, (low, high) in LIFTS.items()
        }
        parts["sand"] = ~np.any(list(parts.values()), axis=0)
        for name, part in parts.items():
            named[f"{name}|wall" if one == "ground" else f"wall|{name}"] = facets[part]
    return mesh.with_boundaries(named)


GROUND = ("sand", *LIFTS)
mesh = ground_and_wall()
basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
materials = dict.fromkeys(GROUND, SOIL) | {"wall": WALL}
forms = {
    name: sc.SolidForm(basis.with_elements(name), material, unit_weight=WEIGHT)
    for name, material in materials.items()
}
steel = sc.SolidForm(basis.with_elements("wall"), WALL, unit_weight=WALL_WEIGHT, porous=False)
friction = sc.Coulomb(mu=float(np.tan(np.radians(20))))
forms |= {
    f"{name}|wall": sc.ContactPair(basis, f"{name}|wall", "piles|ground", friction, quadrature=2)
    for name in GROUND
}
fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
at_top = np.flatnonzero((basis.doflocs[1] > -1e-9) & (abs(basis.doflocs[0] - INNER) < 1e-9))
of_wall = np.unique(basis.element_dofs[:, mesh.subdomains["wall"]])
strut = np.intersect1d(at_top[at_top % 2 == 0], of_wall)

# %%
# The flow
# --------
# Sand that has been pumped dry is left out. The wall is no part of the basis either, and
# therefore tight.


def left_after(lift: int) -> list[str]:
    """Parts of the ground that are wet once so many lifts have been pumped dry."""
    return ["sand", *list(LIFTS)[lift:]]


def form_factor(s: float, T: float, b: float) -> float:
    """Drop over q / k between the top of a rectangle, b wide, T deep, and its side below s.

    sn² of the rectangle's modulus (its nome is exp(-pi T / b)) maps it on a half-plane; the
    cross ratio of the ends of top and side is the modulus of the rectangle in which the
    flow is parallel.
    """
    nome, n = np.exp(-np.pi * T / b), np.arange(1, 30)
    theta2 = 2 * nome**0.25 * (1 + (nome ** (n * (n + 1))).sum())
    theta3 = 1 + 2 * (nome**n**2).sum()
    m = (theta2 / theta3) ** 4
    toe, base = ellipj(s / T * ellipk(1 - m), 1 - m)[2] ** -2, 1 / m
    ratio = (toe - 1) * base / (toe * (base - 1))
    return float(ellipk(ratio) / ellipk(1 - ratio))


def fragments(lift: int) -> tuple[float, float]:
    """Discharge, and what is left of the drop at the toe."""
    inside = form_factor(LEVELS[lift] - TOE, LEVELS[lift] - BASE, INNER)
    outside = form_factor(-TOE, -BASE, FAR - OUTER)
    return -K * LEVELS[lift] / (inside + outside), inside / (inside + outside)


flows, rows = {}, []
for lift in (1, 2, 3):
    began = process_time()
    wet = basis.with_elements(left_after(lift))
    flow = sc.water.Flow(wet, K, unit_weight=WATER).steady(
        sc.water.Conditions(head={"lake": 0.0, f"floor {lift}": LEVELS[lift]})
    )
    flows[lift] = flow
    q, (expected, share) = flow.discharge("lake"), fragments(lift)
    at_toe = flow.head_at(np.array([INNER + THICK / 2, TOE])) / -LEVELS[lift] + 1
    rows.append(
        {
            "method": f"flow, {-LEVELS[lift]:g} m",
            "n": mesh.nelements,
            "unknowns": len(flow.head),
            "error": abs(q / expected - 1),
            "cpu_s": round(process_time() - began, 2),
            "iterations": sum(flow.iterations),
        }
    )
    print(
        f"drop {-LEVELS[lift]:g} m: q = {q:.4g}, fragments {expected:.4g}; "
        f"at the toe {at_toe:.3f}, fragments {share:.3f}"
    )
    # the fragments let no head be lost along the line below the toe: a few per cent
    assert abs(q / expected - 1) < 0.05 and abs(at_toe / share - 1) < 0.05

# %%
# Stages
# ------
# At rest the water is still. The wall is wished in place: it begins as the ground around
# it, with water in its pores; the first stage replaces it by steel without pores. From then
# on water presses
# on it from outside only, and the contact carries the effective stress. Pumping lowers the
# water to the bottom of the lift, digging takes the lift away.


def dig(wet: bool):
    """Result of all stages."""
    model = sc.Model(forms, fixed, water_unit_weight=WATER)
    start = model.k0_state(K0=K0, water=LEVELS[0] if wet else None, name="at rest")
    print(f"out of balance at rest: {start['at rest'].residual:.1e}")
    stages = [sc.Stage("wall", change={"wall": steel})]
    for i, lift in enumerate(LIFTS, 1):
        if wet:
            stages.append(sc.Stage(f"pump {i}", water=flows[i], increments=2))
        stages.append(sc.Stage(f"dig {i}", increments=4, deactivate=(lift, f"{lift}|wall")))
        if i == 1:
            stages.append(sc.Stage("strut", fixed=[fixed, strut]))
    return model.run(stages, start=start)


results = {}
for key in ("without water", "with water"):
    began = process_time()
    results[key] = dig(key == "with water")
    rows.append(
        {
            "method": key,
            "n": mesh.nelements,
            "unknowns": int(basis.N),
            "error": None,
            "cpu_s": round(process_time() - began, 2),
            "iterations": sum(sum(stage.iterations) for stage in results[key]),
        }
    )
    print(results[key])

# %%
# Forces on the wall
# ------------------
# The water alone: the load of the analysis against the pressures of the flow, integrated
# along both faces. Then all that acts on the wall, water, contact and strut, must be in
# balance; and below, sand and water carry the whole weight.

last, flow = results["with water"]["dig 3"], flows[3]
on_wall = of_wall[of_wall % 2 == 0]
sides = ["sand|wall", "wall|sand"]
of_sand = sc.water_load(basis.with_elements("sand"), flow.pressure_at, sides)
pushed = float(of_sand[on_wall].sum())
y, below = np.linspace(TOE, 0, 4001), np.linspace(TOE, LEVELS[3], 4001)
outside = np.trapezoid(flow.pressure_at(np.array([np.full(4001, OUTER), y])), y)
inside = np.trapezoid(flow.pressure_at(np.array([np.full(4001, INNER), below])), below)
contact = [last.contact(name) for name in last.states if name.endswith("|wall")]
strutted = float(last.reactions()[strut][0])
balance = abs(pushed - sum(c.force[0] for c in contact) + strutted) / strutted
weight = -sc.weight(basis, {"sand": WEIGHT, "wall": WALL_WEIGHT}).sum()
x = np.unique(mesh.p[0, mesh.p[1] < BASE + 1e-9])
uplift = np.trapezoid(flow.pressure_at(np.array([x, np.full(len(x), BASE)])), x)
carried = (last.reactions()[fixed[fixed % 2 == 1]].sum() + uplift) / weight - 1
print(
    f"water pushes with {-pushed:.1f} kN/m, {outside:.1f} - {inside:.1f} from the pressures; strut "
    f"{strutted:.1f} kN/m; out of balance: wall {balance:.1e}, ground {abs(carried):.1e}"
)
assert abs((outside - inside) / -pushed - 1) < 1e-4
assert balance < 1e-5 and abs(carried) < 1e-6
rows[-1]["error"] = float(balance)

# %%
# Moments
# -------

cuts = sc.Cuts.line((INNER + THICK / 2, -0.25), (INNER + THICK / 2, TOE + 0.25), THICK, n=55)
moments = {
    key: {stage.name: stage.section_forces("wall", cuts) for stage in result}
    for key, result in results.items()
}
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4.8), sharey=True, layout="constrained")
for key, style in (("without water", "--"), ("with water", "-")):
    for i, color in ((1, "#777777"), (2, "#1f4e8c"), (3, "#d55e00")):
        forces = moments[key][f"dig {i}"]
        left.plot(forces.M, -forces.y, style, color=color, label=f"{-LEVELS[i]:g} m, {key}")
    print(key, {name: round(float(np.abs(f.M).max()), 1) for name, f in moments[key].items()})
for i in (1, 2, 3):
    wet, dry = (np.abs(moments[key][f"dig {i}"].M).max() for key in ("with water", "without water"))
    assert wet > 2.5 * dry
right.plot(flow.pressure_at(np.array([np.full(4001, OUTER), y])), -y, label="lake")
right.plot(flow.pressure_at(np.array([np.full(4001, INNER), below])), -below, label="pit")
right.plot(-WATER * y, -y, ":", color="#777777", label="still water")
left.set(xlabel="moment in the wall [kNm/m]", ylabel="depth [m]", ylim=(-TOE, 0))
right.set(xlabel="pore pressure at the wall [kPa]")
for ax in (left, right):
    ax.grid(color="#dddddd", linewidth=0.6)
    ax.legend(frameon=False, fontsize=8)

# %%
# On the wall itself, and the movements into the pit at the end.

plot.diagram(moments["with water"]["dig 3"], "M", on=last)

# %%

plot.contour(last, "ux", deformed=20.0, window=(0, 20, -17, 1))

# %%
# The bottom of the pit
# ---------------------
# Exit gradient at the wall, and Terzaghi's block, lifted by the water under it.

D, critical = LEVELS[3] - TOE, (WEIGHT - WATER) / WATER
nodes, flux = flow.flux("floor 3")
gradient = -float(flux[mesh.p[0, nodes].argmax()]) / K
base = np.linspace(INNER - D / 2, INNER, 401)
lift = np.mean(flow.head_at(np.array([base, np.full(401, TOE)]))) - LEVELS[3]
block = critical * D / lift
print(
    f"exit gradient {gradient:.3f}, critical {critical:.3f}: "
    f"factor {critical / gradient:.2f}; Terzaghi's block {block:.2f}"
)
assert 0 < gradient < critical and 2.5 < block < 4.0

# %%
# And the strength: by what may it be divided until the ground fails? The bounds answer for
# all mechanisms, here with a rigid wall that may turn about the strut, a stub on which it
# presses. Below, stresses that the soil bears with the pressures of the flow in its pores;
# above, velocities that make it yield. Joints stick by 1 kPa, or the proof from below would
# hang on their ends, which carry nothing. Both hold for sand with :math:`\psi = \phi`; this
# one dilates less, and has the estimate of Davis.

X, Y = mesh.p[:, mesh.t].mean(axis=1)
stub = np.flatnonzero((Y > -0.5) & (X < INNER) & (X > INNER - 0.27))
pit = mesh.with_subdomains({"stub": stub})
kept = np.concatenate([pit.subdomains[name] for name in ("sand", "wall", "stub")])
pit = pit.restrict(kept)
pit = pit.with_boundaries(
    {"abutment": lambda x: (abs(x[0] - INNER + 0.25) < 0.1) & (x[1] > LEVELS[1])}
)
there = Basis(pit, ElementVector(ElementTriP2()), intorder=2)
bodies = {
    name: sc.SolidForm(there.with_elements(name), SOIL if name == "sand" else WALL)
    for name in ("sand", "wall", "stub")
}
joints = {
    "sand|wall": ("wall|sand", sc.Coulomb(friction.mu, adhesion=1.0)),
    "lift 1|wall": ("wall|lift 1", sc.Coulomb(mu=0.1, adhesion=1.0)),
}
bodies |= {
    name: sc.ContactPair(there, name, other, law, quadrature=2)
    for name, (other, law) in joints.items()
}
held = np.concatenate(
    (
        there.get_dofs({"bottom", "abutment"}).all(),
        there.get_dofs({"left", "right"}).all("u^1"),
    )
)


def in_pores(x):
    """Pressure of the flow; on the wall that of its nearer side, none above the pit."""
    x = np.array(x)
    on_wall = (abs(x[0] - INNER - THICK / 2) < THICK) & (x[1] > TOE + 1e-9)
    side = np.where(x[0] < INNER + THICK / 2, INNER - 1e-9, OUTER + 1e-9)
    x[0] = np.where(on_wall, side, x[0])
    wet = (x[0] > INNER) | (x[1] <= LEVELS[3])
    p = np.zeros(x.shape[1:])
    p[wet] = flow.pressure_at(x[:, wet])
    return p


began, found = process_time(), {}
for key in ("associated", "given"):
    found[key] = sc.Model(bodies, held).bounds(
        weight={"sand": WEIGHT, "wall": WALL_WEIGHT},
        water=in_pores,
        submerged=("sand|wall", "wall|sand"),
        flow=key,
        gap=0.1,
        elements=1300,
    )
proven, davis = found["associated"], found["given"].lower
rows.append(
    {
        "method": "bounds, psi = phi",
        "n": proven.mesh.nelements,
        "unknowns": proven.history[-1].unknowns,
        "iterations": sum(mesh.iterations for mesh in proven.history),
        "lower": round(proven.lower, 4),
        "upper": round(proven.upper, 4),
        "davis": round(davis, 4),
        "error": None,
        "cpu_s": round(process_time() - began, 2),
    }
)
print(
    f"factor of safety between {proven.lower:.3f} and {proven.upper:.3f}, "
    f"for psi = 10 about {davis:.2f}"
)
assert 1.7 < proven.lower < proven.upper < 2.05 and 1.5 < davis < proven.lower

# %%
# The mechanism of the upper bound: the toe moves into the pit and lifts its bottom.

plot.mechanism(proven)

# %%
# The flow round the toe.

figure, ax = plt.subplots(figsize=(9, 6), layout="constrained")
plot.flow_diagram(flow, ax=ax)
ax.fill([INNER, OUTER, OUTER, INNER], [TOE, TOE, 0, 0], color="black")
ax.set(xlim=(0, 22), ylim=(BASE, 0.5), xlabel="x [m]", ylabel="height [m]")
plt.show()

# %%
# Figures
# -------

print(json.dumps({"case": "excavation_below_water", "rows": rows}))
