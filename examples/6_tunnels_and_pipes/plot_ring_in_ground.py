"""
A concrete ring in the ground, against the exact solution
=========================================================

A thick elastic ring lies in elastic ground that is loaded far away, twice as much vertically as
horizontally. The exact solution is known for a smooth interface and for one that does not slip.
With a coefficient of friction of 0.6 nothing slips: the greatest ratio of shear to pressure is
0.42. So two contact analyses, ``mu=0`` and ``mu=0.6``, have an exact answer in the four quantities
that a designer asks for: contact pressure, friction, thrust and moment.

The example shows contact pairs on meshes that do not match along a circle, what each discretisation
costs and yields, and section forces of a ring.
"""

import json
import sys
from dataclasses import replace
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from michell_fields import DECAYING, WAVY, harmonics, michell, thrust_and_moment
from skfem import Basis, ElementQuad1, ElementQuad2, ElementVector, MeshQuad, MeshQuad2

import skfem_contact as sc
import skfem_contact.plot as plot

inner, outer, end = 0.72, 0.90, 3.6  # radii of the ring, and where the mesh of the ground ends
vertical, horizontal = 100.0, 50.0  # pressures far away
concrete, soil = sc.LinearElastic(E=2.8e7, nu=0.2), sc.LinearElastic(E=3e4, nu=0.3)

# %%
# The exact solution
# ------------------
# Radial stress, hoop stress and radial displacement are a constant plus a multiple of
# :math:`\cos 2\theta`, the shear stress and the tangential displacement a multiple of
# :math:`\sin 2\theta`; :math:`\theta` is measured anticlockwise from the springline. Michell's six
# elementary fields, in ``michell_fields.py``, have these forms. All six act in the ring; in the
# ground three that decay are added to the far field. The stresses at the inner face, and stresses
# and displacements at the interface, determine their nine factors.


def exact(smooth):
    """Factors of the six fields in the ring and in the ground."""
    far = np.array([0, -(vertical + horizontal) / 4, -(vertical - horizontal) / 4, 0, 0, 0])
    (srr_a, _, srt_a, _, _), (srr, _, srt, ur, ut) = (
        michell(inner, concrete),
        michell(outer, concrete),
    )
    ground = michell(outer, soil)
    nothing = 0 * srr
    conditions = [
        (srr_a, nothing),
        (srt_a, nothing),
        (srr, ground[0]),
        (srt, ground[2]),
        (soil.E * ur, soil.E * ground[3]),
        (srt, nothing) if smooth else (soil.E * ut, soil.E * ground[4]),
    ]
    conditions = [
        (part * left, part * right) for left, right in conditions for part in (1 - WAVY, WAVY)
    ]
    matrix = np.array([np.concatenate((left, -right[DECAYING])) for left, right in conditions])
    factors = np.linalg.lstsq(
        matrix, np.array([right @ far for _, right in conditions]), rcond=None
    )[0]
    far[DECAYING] = factors[6:]
    return factors[:6], far


def exact_results(smooth):
    """Constant and wave of pressure, friction (its wave goes with the sine), thrust and moment."""
    ring, _ = exact(smooth)
    srr, _, srt, _, _ = michell(outer, concrete)
    thrust, moment = thrust_and_moment(inner, outer, concrete, ring)
    return {
        "pressure": -harmonics(srr, ring),
        "friction": harmonics(srt, ring),
        "thrust": thrust,
        "moment": moment,
    }


def exact_displacement(smooth, x, y):
    """Displacements of the ground at points of its mesh's end."""
    _, ground = exact(smooth)
    theta = np.arctan2(y, x)
    _, _, _, (constant, wave), (_, tangential) = (
        harmonics(row, ground) for row in michell(end, soil)
    )
    ur, ut = constant + wave * np.cos(2 * theta), tangential * np.sin(2 * theta)
    return ur * np.cos(theta) - ut * np.sin(theta), ur * np.sin(theta) + ut * np.cos(theta)


# %%
# Meshes
# ------
# Two annuli of quadrilaterals. The ground has five facets where the ring has six, so the meshes do
# not match. Elements of second order get curved sides.


def annulus(radii, n, curved):
    """Quadrilaterals between concentric circles, ``n`` around."""
    angle = 2 * np.pi * np.arange(n) / n
    p = np.array([np.outer(radii, np.cos(angle)).ravel(), np.outer(radii, np.sin(angle)).ravel()])
    i, j = (k.ravel() for k in np.indices((len(radii) - 1, n)))
    here, there = i * n + j, i * n + (j + 1) % n
    mesh = MeshQuad(p, np.array([here, here + n, there + n, there]))
    facets = mesh.boundary_facets()
    radius = np.hypot(*p)[mesh.facets[:, facets]].max(axis=0)
    sides = {
        "inside": facets[radius < 1.001 * radii[0]],
        "outside": facets[radius > 1.001 * radii[0]],
    }
    if curved:
        mesh = MeshQuad2.from_mesh(mesh)
        between = (
            np.cos(n * np.arctan2(*mesh.doflocs[::-1])) < 0
        )  # nodes at half an element's angle
        mesh = replace(mesh, doflocs=mesh.doflocs / np.where(between, np.cos(np.pi / n), 1))
    return mesh.with_boundaries(sides)


def two_bodies(n, curved):
    """The ring with ``n`` elements around, and the ground, whose elements grow outwards."""
    wall = np.linspace(inner, outer, n // (18 if curved else 24) + 1)
    outwards = np.geomspace(outer, end, n // 4 + 1)
    return sc.join_bodies(
        {"ring": annulus(wall, n, curved), "ground": annulus(outwards, 5 * n // 6, curved)}
    )


# %%
# Analysis
# --------
# The outer end of the ground's mesh gets the exact displacements. In a smooth interface the ring
# could still turn: one node is held.
#
# The chords of two polygons with different numbers of corners do not touch everywhere;
# ``initial="adjusted"`` lets what lies this close touch exactly. ``smoothing=.5`` rounds off the
# corners of the ring, as the source paper advises. The row "facets" shows what happens without it.

METHODS = {
    "Q1, nodal, smoothed": {"quadrature": "nodal", "smoothing": 0.5},
    "Q1, Gauss, smoothed": {"quadrature": 2, "smoothing": 0.5},
    "Q1, Gauss, facets": {"quadrature": 2},
    "Q2, Gauss": {"quadrature": 3},
    "Q2, Gauss, augmented": {"quadrature": 3, "enforcement": sc.AugmentedLagrangian()},
}


def analyse(method, mu, n, load=1.0):
    """Forms, result and processor time of an analysis under a share of the load."""
    begin = process_time()
    curved = method.startswith("Q2")
    mesh = two_bodies(n, curved)
    element = ElementVector(ElementQuad2() if curved else ElementQuad1())
    basis = Basis(mesh, element, intorder=4 if curved else 2)
    law = sc.Coulomb(mu=mu)
    forms = {
        "ring": sc.SolidForm(basis.with_elements("ring"), concrete),
        "ground": sc.SolidForm(basis.with_elements("ground"), soil),
        "joint": sc.ContactPair(
            basis, "ground:inside", "ring:outside", law, initial="adjusted", **METHODS[method]
        ),
    }
    ends, x = basis.get_dofs("ground:outside"), basis.zeros()
    ux, uy = exact_displacement(mu == 0, *basis.doflocs[:, ends.all("u^1")])
    x[ends.all("u^1")], x[ends.all("u^2")] = load * ux, load * uy
    fixed = ends.all()
    if mu == 0:
        face = basis.get_dofs("ring:inside").all("u^1")
        fixed = np.append(fixed, face[np.argmax(basis.doflocs[1, face])])
    result = sc.Model(forms, fixed).run([sc.Stage("loaded", basis.zeros(), prescribed=x)])
    return forms, result["loaded"], process_time() - begin


# %%
# The results are reduced to their harmonics. The section forces come from 72 cuts.


def fit(theta, values, weight, wave=np.cos):
    """Constant and wave of values around the ring."""
    constant = (weight * values).sum() / weight.sum() if wave is np.cos else 0.0
    return np.array([constant, 2 * (weight * values * wave(2 * theta)).sum() / weight.sum()])


def results(forms, step):
    """The same four quantities as in the exact solution, and the curves behind them."""
    joint = step.tractions("joint")
    cuts = sc.Cuts.ring((0, 0), inner, outer, n=72)
    ring = step.section_forces("ring", cuts)
    theta, cut, once = np.arctan2(joint.y, joint.x), np.radians(90 - ring.position), np.ones(72)
    fits = {
        "pressure": fit(theta, joint.pressure, joint.weight),
        "friction": fit(theta, -joint.shear, joint.weight, np.sin),
        "thrust": fit(cut, ring.N, once),
        "moment": fit(cut, ring.M, once),
    }
    return fits, joint, ring


def relative_errors(fits, right):
    """Errors of the harmonics; where the friction must vanish it is measured by the pressure."""
    scale = {name: np.linalg.norm(right[name]) for name in right}
    if scale["friction"] < 1e-9 * scale["pressure"]:
        scale["friction"] = scale["pressure"]
    return {name: float(np.linalg.norm(fits[name] - right[name]) / scale[name]) for name in right}


# %%
# All methods on two meshes; ``--full`` adds a third. The last column is the largest error in the
# raw pressure of a single point, over the largest pressure.

INTERFACES = {"smooth": 0.0, "rough": 0.6}
sizes = (72, 144, 288) if "--full" in sys.argv else (72, 144)
rows, curves = [], {}
print(f"{'':29} n unknowns   pressure friction thrust  moment   points")
for interface, mu in INTERFACES.items():
    right = exact_results(mu == 0)
    for method in METHODS:
        for n in sizes:
            n = n // 2 if method.startswith("Q2") else n
            forms, step, cpu = analyse(method, mu, n)
            fits, joint, ring = curves[interface, method] = results(forms, step)
            errors = relative_errors(fits, right)
            pressure = right["pressure"] @ [
                1 + 0 * joint.x,
                np.cos(2 * np.arctan2(joint.y, joint.x)),
            ]
            errors["points"] = float(np.abs(joint.raw_pressure - pressure).max() / pressure.max())
            name, figures = f"{method}, {interface}", " ".join(f"{e:8.2%}" for e in errors.values())
            print(f"{name:28}{n:4} {len(step.x):7}  {figures}")
            rows.append(
                {
                    "method": name,
                    "n": n,
                    "unknowns": len(step.x),
                    "cpu_s": round(cpu, 2),
                    "error": max(errors[quantity] for quantity in right),
                    "iterations": sum(step.iterations),
                    **errors,
                }
            )

# %%
# Every method gives all harmonics within 1 % on the second mesh. The error is halved with the size
# of the elements: it is the penetration of the penalty method, and the augmented method, which has
# none, leaves next to nothing. Without smoothing, the corners of the ring slide along the facets of
# the ground when the interface is smooth; resultants are still right, but the pressures of single
# points are not.
#
# What the augmented method leaves in the smooth interface is no error: contact is formulated on the
# displaced bodies, the exact solution on the undisplaced ones. At a hundredth of the load the
# difference is a hundredth.

last = {row["method"]: row for row in rows}
for name, row in last.items():
    before = rows[rows.index(row) - 1]
    assert row["error"] < 0.01
    assert row["error"] < before["error"]
    assert row["points"] < (0.02 if "facets" not in name else 1.0)
assert last["Q1, Gauss, facets, smooth"]["points"] > 0.3

forms, step, _ = analyse("Q2, Gauss, augmented", 0.0, 72, load=0.01)
fits = {name: 100 * fit for name, fit in results(forms, step)[0].items()}
small = max(relative_errors(fits, exact_results(smooth=True)).values())
print(f"augmented, smooth, at a hundredth of the load: {small:.4%}")
assert small < 1e-4

# %%
# Curves
# ------
# Lines are exact, points are computed with linear elements, nodal contact and smoothing. Central
# angles run clockwise from the crown.

alpha = np.linspace(0, 360, 361)
theta = np.radians(90 - alpha)
labels = {
    "pressure": "contact pressure",
    "friction": "friction",
    "thrust": "thrust",
    "moment": "moment",
}
fig, axes = plt.subplots(2, 2, figsize=(9, 6), sharex=True, layout="constrained")
for color, (interface, mu) in zip(("#d55e00", "#1f4e8c"), INTERFACES.items()):
    _, joint, ring = curves[interface, "Q1, nodal, smoothed"]
    around = joint.central_angle()
    points = {
        "pressure": (around, joint.pressure),
        "friction": (around, joint.shear),
        "thrust": (ring.position, ring.N),
        "moment": (ring.position, ring.M),
    }
    for ax, (name, (constant, wave)) in zip(axes.flat, exact_results(mu == 0).items()):
        sine = name == "friction"
        ax.plot(
            alpha,
            constant + wave * (-np.sin(2 * theta) if sine else np.cos(2 * theta)),
            color=color,
        )
        ax.plot(
            points[name][0][::4],
            points[name][1][::4],
            "o",
            color=color,
            markersize=3.5,
            label=interface,
        )
        ax.set(ylabel=labels[name], xlim=(0, 360), xticks=range(0, 361, 45))
        ax.grid(color="#dddddd", linewidth=0.6)
axes[0, 0].legend(frameon=False)
for ax in axes[1]:
    ax.set_xlabel("central angle [°]")

# %%
# The smooth ring, displacements enlarged: crown and invert come closer, and the ground slides past.

forms, step, _ = analyse("Q1, nodal, smoothed", 0.0, 72)
# sphinx_gallery_thumbnail_number = 2
plot.contour(step, "u", deformed=100.0, window=(-2.0, 2.0, -1.6, 1.6), limits=(0.0, 0.006))

# %%
# Figures
# -------

print(json.dumps({"case": "ring_in_ground", "rows": rows}))
