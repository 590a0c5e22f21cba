r"""
A lined tunnel after partial release
====================================

When the lining of a tunnel is placed the face has moved on, and the ground has moved inwards
already. In a plane model the nodal forces :math:`S` of the stresses at rest on the wall stand for
the ground inside. A part of them is released before the lining is there, and the lining takes its
share of the rest. The stages are

1. the ground alone, in equilibrium with :math:`S`,
2. 60 % released: the support falls to :math:`0.4\,S`,
3. the lining and its contact become active, and the support falls to nothing.

The lining is stress-free when it is placed, and fits into the wall where this has got to. The
tunnel is so deep that the stresses around it count as uniform; in ground with weight its load
:math:`W` is added in every stage.

First the ground is elastic: thrust and moment of the lining have a closed form. Then it yields: the
lining meets the ground reaction curve.
"""

# sphinx_gallery_thumbnail_number = 3

import json
from dataclasses import astuple, replace
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from michell_fields import DECAYING, WAVY, harmonics, michell, thrust_and_moment
from skfem import Basis, ElementQuad2, ElementVector, MeshQuad, MeshQuad2

import skfem_contact as sc
import skfem_contact.plot as plot
from skfem_contact.contact.laws import Status

plot.set_units("kN", "m")

INNER, WALL, END = (
    2.76,
    3.0,
    120.0,
)  # radii in m: of both faces of the lining, and of the end of the ground
VERTICAL, K0 = (
    500.0,
    0.6,
)  # pressure at the depth of the tunnel in kPa, and the horizontal one as a share of it
RELEASED = 0.6  # before the lining is placed
SHOTCRETE, ELASTIC = sc.LinearElastic(E=1.5e7, nu=0.2), sc.LinearElastic(E=1.5e5, nu=0.3)

# %%
# Closed form
# -----------
# In the elastic case the lining takes what is released after it is placed. Einstein and Schwartz
# (1979) give this for a thin ring. Here the lining has a thickness: radial stress, hoop stress and
# radial displacement are a constant plus a multiple of :math:`\cos 2\theta`, the shear stress and
# the tangential displacement a multiple of
# :math:`\sin 2\theta`, with :math:`\theta` from the springline. All of Michell's six fields, in
# ``michell_fields.py``, act in the lining, and the three that decay in the ground. It does not
# count how the ground was compressed long ago: the stresses of the far field belong to the
# conditions at the wall, its displacements do not.


def exact_lining(smooth):
    """Constant and wave of pressure, thrust, moment and movement of a lining that takes
    everything.
    """
    far = -VERTICAL / 4 * np.array([0, 1 + K0, 1 - K0, 0, 0, 0])  # factors of the uniform stresses
    (srr_a, _, srt_a, _, _), (srr, _, srt, ur, ut) = (
        michell(INNER, SHOTCRETE),
        michell(WALL, SHOTCRETE),
    )
    ground, none = michell(WALL, ELASTIC), np.zeros(6)
    conditions = [
        (srr_a, none, none),
        (srt_a, none, none),
        (srr, ground[0], ground[0]),
        (ur, ground[3], none),
    ]
    if smooth:
        conditions += [(srt, none, none), (none, ground[2], ground[2])]
    else:
        conditions += [(srt, ground[2], ground[2]), (ut, ground[4], none)]
    conditions = [
        (part * left, part * right, part * given)
        for left, right, given in conditions
        for part in (1 - WAVY, WAVY)
    ]
    matrix = np.array([np.concatenate((left, -right[DECAYING])) for left, right, _ in conditions])
    factors = np.linalg.lstsq(
        matrix, np.array([given @ far for *_, given in conditions]), rcond=None
    )[0][:6]
    thrust, moment = thrust_and_moment(INNER, WALL, SHOTCRETE, factors)
    return {
        "pressure": -harmonics(srr, factors),
        "movement": harmonics(ur, factors),
        "thrust": thrust,
        "moment": moment,
    }


# %%
# Without lining the wall moves as in Kirsch's solution.

UNLINED = (
    VERTICAL
    * WALL
    * (1 + ELASTIC.nu)
    / ELASTIC.E
    / 2
    * np.array([-1 - K0, (1 - K0) * (3 - 4 * ELASTIC.nu)])
)

# %%
# Model
# -----
# A quarter of the tunnel, in curved nine-node elements that grow outwards. The ground is held forty
# radii away, where next to nothing moves. ``join_bodies`` takes the lining and the ground apart and
# names both sides of their interface.


def quarter(n):
    """Lining and ground with n elements around."""
    radii = np.r_[np.linspace(INNER, WALL, 3), np.geomspace(WALL, END, 5 * n // 2 + 1)[1:]]
    flat = MeshQuad.init_tensor(radii, np.linspace(0, np.pi / 2, n + 1)).with_boundaries(
        {
            "end": lambda x: np.isclose(x[0], END),
            "x axis": lambda x: np.isclose(x[1], 0),
            "y axis": lambda x: np.isclose(x[1], np.pi / 2),
        }
    )
    flat = flat.with_subdomains({"ground": lambda x: x[0] > WALL, "lining": lambda x: x[0] < WALL})
    curved = MeshQuad2.from_mesh(flat)
    r, angle = curved.doflocs
    curved = replace(curved, doflocs=np.stack((r * np.cos(angle), r * np.sin(angle))))
    curved = curved.with_boundaries(flat.boundaries).with_subdomains(flat.subdomains)
    return sc.join_bodies(curved, bodies={"ground": "ground", "lining": "lining"})


basis = Basis(quarter(18), ElementVector(ElementQuad2()), intorder=4)
fixed = np.concatenate(
    (
        basis.get_dofs("x axis").all("u^2"),
        basis.get_dofs("y axis").all("u^1"),
        basis.get_dofs("end").all(),
    )
)
AT_REST = -VERTICAL * np.array([K0, 1.0, K0, 0.0])  # xx, yy, zz, xy
MEAN = VERTICAL * (1 + K0) / 2  # pressure on the wall


def tunnel(ground, mu):
    """Forms by name: the ground, the lining, and contact between them."""
    return {
        "ground": sc.SolidForm(basis.with_elements("ground"), ground),
        "lining": sc.SolidForm(basis.with_elements("lining"), SHOTCRETE),
        "skin": sc.ContactPair(
            basis,
            "ground|lining",
            "lining|ground",
            sc.Coulomb(mu=mu),
            quadrature=3,
            enforcement=sc.AugmentedLagrangian(),
        ),
    }


# %%
# At first only the ground is there, and its wall is held: the model of the initial state has no
# other form, and one support more. Then this support goes, and its forces S are released share by
# share. A stage releases a share of what is left. The lining can go on from any of the stages.


def release(forms, shares, at_rest=AT_REST):
    """Take the support of the wall back to shares of S."""
    held = [fixed, basis.get_dofs("ground|lining").all()]
    start = sc.Model({"ground": forms["ground"]}, held).initial_state(
        stress=lambda x: np.multiply.outer(at_rest, np.ones(x.shape[1:])), name="at rest"
    )
    stages = [
        sc.Stage(f"{share:g} S", fixed=None if k else fixed, release=1 - share / before)
        for k, (before, share) in enumerate(zip([1.0, *shares], shares))
    ]
    return sc.Model(forms, held).run(stages, start=start)


def line(forms, placed):
    """Place the lining in a stage, and take away the support that is left there."""
    stage = sc.Stage("lined", activate=("lining", "skin"), increments=4)
    return sc.Model(forms, fixed).run([stage], start=placed)["lined"]


# %%
# Pressure, thrust, moment and movement are reduced to a constant and a wave. In a quarter there are
# 19 of 72 cuts, on the radial lines of nodes; the first and the last are left out, for no elements
# lie beyond them.

CUTS = sc.Cuts(*(values[1:18] for values in astuple(sc.Cuts.ring((0, 0), INNER, WALL, n=72))))


def fit(position, values):
    """Constant and wave of values at central angles from the crown."""
    waves = np.column_stack((np.ones(len(values)), -np.cos(2 * np.radians(position))))
    return np.linalg.lstsq(waves, values, rcond=None)[0]


def movement(stage, face):
    """Constant and wave of the radial displacement of a face."""
    dofs = basis.get_dofs(face)
    ux, uy = (np.concatenate((dofs.nodal[c], dofs.facet[c])) for c in ("u^1", "u^2"))
    x, y = basis.doflocs[:, ux]
    return fit(np.degrees(np.arctan2(x, y)), (x * stage.x[ux] + y * stage.x[uy]) / WALL)


def measured(forms, stage):
    """The quantities of the closed form, and the curves behind them."""
    skin = stage.tractions("skin")
    cuts = stage.section_forces("lining", CUTS)
    fits = {
        "pressure": fit(skin.central_angle(), skin.pressure),
        "thrust": fit(cuts.position, cuts.N),
        "moment": fit(cuts.position, cuts.M),
        "movement": movement(stage, "lining|ground"),
    }
    return fits, skin, cuts


# %%
# Elastic ground
# --------------
# Without friction, and with so much that nothing slips. The wall has moved before the lining is
# there; the lining moves with it from then on. Errors are those of constant and wave together.

rows, elastic = [], {}
for label, mu in (("full slip", 0.0), ("no slip", 1.0)):
    begin = process_time()
    forms = tunnel(ELASTIC, mu)
    bare = release(forms, [1 - RELEASED])
    last = line(forms, bare[-1])
    cpu = process_time() - begin
    fits, skin, cuts = measured(forms, last)
    exact = {name: (1 - RELEASED) * values for name, values in exact_lining(mu == 0).items()}
    elastic[label] = exact, skin, cuts
    fits["wall"], exact["wall"] = (
        movement(last, "ground|lining"),
        RELEASED * UNLINED + exact["movement"],
    )
    errors = {
        name: float(np.linalg.norm(fits[name] - exact[name]) / np.linalg.norm(exact[name]))
        for name in exact
    }
    print(f"\n{label}: {basis.N} unknowns\n{'':14}constant     exact      wave     exact   error")
    for name, error in errors.items():
        unit = 1e3 if name in ("movement", "wall") else 1.0  # in mm
        values = unit * np.column_stack((fits[name], exact[name])).ravel()
        print(f"{name:12}" + "{:10.3f}{:10.3f}{:10.3f}{:10.3f}".format(*values) + f"{error:8.2%}")
    rows.append(
        {
            "method": f"elastic, {label}",
            "n": 18,
            "unknowns": int(basis.N),
            "error": max(errors.values()),
            "cpu_s": round(cpu, 2),
            "iterations": sum(bare[-1].iterations + last.iterations),
        }
    )
    assert (
        skin.status == (Status.STICK if mu else Status.SLIP)
    ).all()  # the interface of the closed form
    # The end of the ground holds back 0.2 % of the movement. Contact acts on the displaced bodies,
    # and the wall has moved by 0.2 % of its radius: were everything a hundred times as stiff, the
    # forces would be right to 0.3 %.
    assert max(errors.values()) < 0.01

# %%
# The lining as a beam
# --------------------
# A :class:`skfem_contact.Beam` along the wall of the tunnel, bonded to it or in contact without
# friction: a thin ring. Movements :math:`u=a\cos 2\theta` outwards and :math:`v=b\sin 2\theta`
# along it with rotations :math:`c\sin 2\theta` have the strains :math:`(a + 2 b)/R`,
# :math:`(2 a + b)/R - c` and :math:`2 c/R`; ground and ring move together. Nodes of the solid
# lining are held, as are the rotations on the axes of symmetry.

THICK = WALL - INNER
PLATE = SHOTCRETE.E / (1 - SHOTCRETE.nu**2)
SECTION = {
    "EA": PLATE * THICK,
    "GA": 5 / 6 * SHOTCRETE.E / 2 / (1 + SHOTCRETE.nu) * THICK,
    "EI": PLATE * THICK**3 / 12,
}


def exact_ring(smooth):
    """Constant and wave of thrust, moment and movement of a thin ring that takes everything."""
    far = -VERTICAL / 4 * np.array([0, 1 + K0, 1 - K0, 0, 0, 0])
    srr, _, srt, ur, ut = michell(WALL, ELASTIC)
    strains = np.array([[1, 2, 0], [2, 1, -WALL], [0, 0, 2]]) / WALL
    K = strains.T @ np.diag([SECTION["EA"], SECTION["GA"], SECTION["EI"]]) @ strains
    soft = np.linalg.inv(K)  # a, b and c by p and q
    shear = np.zeros(6) if smooth else srt
    moves = np.array([ur * (1 - WAVY), ur * WAVY, 0 * ut if smooth else ut])
    pushed = np.array(
        [
            WALL**2 / SECTION["EA"] * srr * (1 - WAVY),
            soft[0, 0] * srr * WAVY + soft[0, 1] * shear,
            srt if smooth else soft[1, 0] * srr * WAVY + soft[1, 1] * shear,
        ]
    )
    own = np.zeros(6)
    own[DECAYING] = np.linalg.solve((moves - pushed)[:, DECAYING], pushed @ far)
    a, b, c = soft @ [(srr * WAVY) @ (own + far), shear @ (own + far), 0.0]
    moved = harmonics(ur, own)
    return {
        "thrust": np.array([SECTION["EA"] * moved[0], SECTION["EA"] * (a + 2 * b)]) / WALL,
        "moment": np.array([0.0, SECTION["EI"] * 2 * c / WALL]),
        "movement": moved,
    }


for label, smooth in (("full slip", True), ("no slip", False)):
    begin = process_time()
    ground = sc.SolidForm(basis.with_elements("ground"), ELASTIC)
    ring = sc.Beam(basis, "ground|lining", bonded=not smooth, **SECTION)
    forms = {"ground": ground, "lining": ring}
    if smooth:
        forms |= ring.contact(
            basis, sc.Coulomb(mu=0.0), "ground|lining", enforcement=sc.AugmentedLagrangian()
        )
    ends = [*ring.dofs((0.0, WALL), ["u^1", "theta"]), *ring.dofs((WALL, 0.0), ["u^2", "theta"])]
    still = [fixed, np.setdiff1d(np.arange(basis.N), np.unique(ground.basis.element_dofs))]
    held = [*still, basis.get_dofs("ground|lining").all()]
    start = sc.Model({"ground": ground}, held).initial_state(
        stress=lambda x: np.multiply.outer(AT_REST, np.ones(x.shape[1:])), name="at rest"
    )
    stages = [
        sc.Stage("released", fixed=[*still, *ends], release=RELEASED),
        sc.Stage("lined", activate=[name for name in forms if name != "ground"]),
    ]
    result = sc.Model(forms, held).run(stages, start=start)
    forces, before, last = (
        result["lined"].section_forces("lining"),
        result["released"],
        result["lined"],
    )
    angle = np.degrees(np.arctan2(forces.x, forces.y))
    fits = {
        "thrust": fit(angle, forces.N),
        "moment": fit(angle, forces.M),
        "movement": movement(last, "ground|lining") - movement(before, "ground|lining"),
    }
    exact = {name: (1 - RELEASED) * values for name, values in exact_ring(smooth).items()}
    errors = {
        name: float(np.linalg.norm(fits[name] - exact[name]) / np.linalg.norm(exact[name]))
        for name in exact
    }
    print(f"beam, {label}: {', '.join(f'{name} {error:.2%}' for name, error in errors.items())}")
    rows.append(
        {
            "method": f"beam, {label}",
            "n": 18,
            "unknowns": len(last.x),
            "error": max(errors.values()),
            "cpu_s": round(process_time() - begin, 2),
            "iterations": sum(last.iterations),
        }
    )
    assert max(errors.values()) < 0.01

# %%
# Ground that yields
# ------------------
# In Mohr-Coulomb soil the tunnel would stand without a lining, but its wall would move more than
# twice as far as in elastic ground. The lining is placed after 60 %, or after 80 %, and the soil
# may slide along it.

SOIL = sc.MohrCoulomb(E=ELASTIC.E, nu=ELASTIC.nu, c=50.0, phi=30.0, psi=5.0)
SHARES = [
    0.8,
    0.6,
    0.5,
    0.4,
    0.38,
    0.36,
    0.3,
    0.2,
    0.195,
    0.19,
    0.1,
    0.0,
]  # closer where a lining will end
forms = tunnel(SOIL, mu=0.3)


def inwards(stage):
    """Mean inward movement of the wall."""
    return -movement(stage, "ground|lining")[0]


def reaction_curve(bare):
    """Mean movement and mean pressure of the wall without lining."""
    return np.array([inwards(stage) for stage in bare]), MEAN * np.array([1.0, *SHARES])


bare = release(forms, SHARES)
curve = reaction_curve(bare)
print(f"\n{bare}")
assert 2 < -curve[0][-1] / UNLINED[0] < 3  # 2.4: it yields, and stands

# %%
# A designer takes the mean pressure on the lining from two curves: the ground reaction curve, and
# the line of the lining :math:`p = k\,(u-u_0)`, with the stiffness k of a thick ring, from where
# the lining is placed.

RING = (
    SHOTCRETE.E
    / (1 + SHOTCRETE.nu)
    * (WALL**2 - INNER**2)
    / (WALL * ((1 - 2 * SHOTCRETE.nu) * WALL**2 + INNER**2))
)


def intersection(curve, placed):
    """Pressure at which the line of a lining meets a ground reaction curve."""
    u = np.linspace(placed, curve[0][-1], 100001)
    return float(np.interp(0.0, RING * (u - placed) - np.interp(u, *curve), RING * (u - placed)))


# %%
# In isotropic stresses this is exact.

begin = process_time()
isotropic = release(forms, SHARES, at_rest=-MEAN * np.array([1.0, 1.0, 1.0, 0.0]))
placed = isotropic["0.2 S"]
met = intersection(reaction_curve(isotropic), inwards(placed))
last = line(forms, placed)
pressure = measured(forms, last)[0]["pressure"][0]
print(f"\nisotropic, lining after 80%: pressure {pressure:.2f} kPa, from the two curves {met:.2f}")
rows.append(
    {
        "method": "yielding, isotropic, lining after 80%",
        "n": 18,
        "unknowns": int(basis.N),
        "error": float(abs(pressure / met - 1)),
        "cpu_s": round(process_time() - begin, 2),
        "iterations": sum(sum(stage.iterations) for stage in isotropic) + sum(last.iterations),
    }
)
assert (
    abs(pressure / met - 1) < 0.005
)  # the curve is made of straight lines between the computed points

# %%
# Here the stresses are not isotropic, and the lining also holds the wall against becoming oval:
# most of the soil that has yielded is unloaded, and answers as if it were elastic. So the lining
# gets less than the two curves say, though not less than in elastic ground.

lined = {}
for left in (0.4, 0.2):
    label, placed = f"lining after {1 - left:.0%}", bare[f"{left:g} S"]
    begin = process_time()
    last = line(forms, placed)
    cpu = process_time() - begin
    fits, skin, cuts = measured(forms, last)
    u, pressure = np.array([inwards(placed), inwards(last)]), fits["pressure"][0]
    lined[label] = u, pressure, skin, cuts, last

    least, met = left * exact_lining(smooth=False)["pressure"][0], intersection(curve, u[0])
    before, after = (stage.states["ground"].internal[0] for stage in (placed, last))
    unloaded = np.mean(after[before > 0] == before[before > 0])
    print(
        f"\n{label}: pressure {pressure:.1f} kPa (elastic ground {least:.1f}, two curves "
        f"{met:.1f}),\n"
        f"    wall {1e3 * u[1]:.1f} mm inwards instead of {1e3 * curve[0][-1]:.1f}, thrust "
        f"{-cuts.N.max():.0f} to "
        f"{-cuts.N.min():.0f} kN/m, moment up to {np.abs(cuts.M).max():.1f} kNm/m,\n    "
        f"{unloaded:.0%} of what had "
        f"yielded yields no more, {np.mean(skin.status == Status.SLIP):.0%} of the interface slips"
    )
    balance = float(abs(fits["thrust"][0] / (WALL * pressure) + 1))
    rows.append(
        {
            "method": f"yielding, {label}",
            "n": 18,
            "unknowns": int(basis.N),
            "error": balance,
            "cpu_s": round(cpu, 2),
            "iterations": sum(last.iterations),
        }
    )
    assert (
        least < pressure < met < 1.1 * least
    )  # the bounds are close: the lining is stiff, the wall hardly moves
    assert unloaded > 0.5  # "most"
    assert (
        balance < 2e-3
    )  # mean thrust of a ring: mean pressure times radius; the means are those of fits

# %%
# Elastic ground: pressure, thrust and moment
# -------------------------------------------
# Lines are exact, points are computed. A lining along which the ground slides has next to no
# variation in pressure and thrust, and a greater moment.

alpha = np.linspace(0, 90, 91)
fig, axes = plt.subplots(1, 3, figsize=(10, 3.4), layout="constrained")
for color, (label, (exact, skin, cuts)) in zip(
    ("#d55e00", "#1f4e8c"), elastic.items(), strict=True
):
    points = {
        "pressure": (skin.central_angle()[::4], skin.pressure[::4]),
        "thrust": (cuts.position, cuts.N),
        "moment": (cuts.position, cuts.M),
    }
    for ax, (name, (position, values)) in zip(axes, points.items(), strict=True):
        constant, wave = exact[name]
        ax.plot(alpha, constant - wave * np.cos(2 * np.radians(alpha)), color=color)
        ax.plot(position, values, "o", color=color, markersize=3.5, label=label)
for ax, label in zip(
    axes, ("contact pressure [kPa]", "normal force [kN/m]", "moment [kNm/m]"), strict=True
):
    ax.set(
        xlabel="central angle from the crown [°]",
        ylabel=label,
        xlim=(0, 90),
        xticks=range(0, 91, 30),
    )
    ax.grid(color="#dddddd", linewidth=0.6)
axes[0].legend(frameon=False)

# %%
# Yielding ground: where the lining meets it
# ------------------------------------------
# The lining starts without pressure where the ground has got to, and hardly moves. Placed after 80
# % it carries half as much as after 60 %. Friction rises steeply to its bound where the soil begins
# to slip: within that element its course is not resolved.

fig, axes = plt.subplots(2, 2, figsize=(10, 7), layout="constrained")
reaction, contact, thrust, moment = axes.flat
reaction.plot(1e3 * curve[0], curve[1], "o-", color="0.4", markersize=4, label="without lining")
for color, (label, (u, pressure, skin, cuts, _)) in zip(
    ("#1f4e8c", "#d55e00"), lined.items(), strict=True
):
    reaction.plot(1e3 * u, [0, pressure], ".-", color=color, label=label)
    contact.plot(skin.central_angle(), skin.pressure, color=color)
    contact.plot(skin.central_angle(), np.abs(skin.shear), "--", color=color, linewidth=1)
    thrust.plot(cuts.position, cuts.N, ".-", color=color)
    moment.plot(cuts.position, cuts.M, ".-", color=color)
reaction.set(
    xlabel="mean inward movement of the wall [mm]",
    ylabel="mean pressure on the wall [kPa]",
    xlim=0,
    ylim=0,
)
for ax, label in (
    (contact, "pressure, and friction (dashed) [kPa]"),
    (thrust, "normal force [kN/m]"),
    (moment, "moment [kNm/m]"),
):
    ax.set(
        xlabel="central angle from the crown [°]",
        ylabel=label,
        xlim=(0, 90),
        xticks=range(0, 91, 30),
    )
for ax in axes.flat:
    ax.grid(color="#dddddd", linewidth=0.6)
reaction.legend(frameon=False)
contact.set_ylim(0)

# %%
# Plastic strain of the soil at the end, with the lining placed after 80 %. The horizontal stress is
# the smaller one, so that the sides of the tunnel yield and not its crown.

# sphinx_gallery_thumbnail_number = 2
plot.contour(lined["lining after 80%"][-1], "plastic", window=(0.0, 6.0, 0.0, 5.0))

# %%
# Figures
# -------

print(json.dumps({"case": "lined_tunnel", "rows": rows}))
