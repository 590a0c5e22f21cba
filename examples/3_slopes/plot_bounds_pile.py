r"""
A pile in a slope, between two bounds
=====================================

How much safer does a pile make a slope? Strength reduction with contact gives a factor, and a
coarse mesh or a search that ends early moves it. Here the slope of
:doc:`the stabilising pile </gallery/3_slopes/plot_pile_in_slope>` gets two numbers that
enclose the true factor of the model, with a proof, without the pile and with it, whose interface is
as strong as the soil (with ``--full`` also two thirds as strong, and smooth). Then strength
reduction with contact runs on the mesh that the bounds have refined.

What is proven holds for soils that flow with :math:`\psi = \phi`, which they do here, and for
interfaces that open as they slip. Those of contact do not, so the lower number is an estimate for
them. The safe one beside it, with the adhesion of the interface alone, is proven for both. Units
are kN and m. Run with ``--full`` for all interfaces, small gaps, and a stiffer pile.
"""

import json
import sys
import warnings
from itertools import pairwise
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

sc.set_units("kN", "m")

FULL = "--full" in sys.argv

# %%
# A coarse mesh
# -------------
# The bounds refine it. The slope rises 1 to 2 from left to right, and the head of the pile in its
# middle is the origin; columns of quadrilaterals follow the pile, rows the interface of the two
# layers.

width, tip, layer, base, toe, end = 0.2, -15.6, -10.6, -20.6, 16.1, 45.0


def slope(with_pile):
    """Some hundred triangles; soil and pile have nodes of their own."""
    right = np.array([0.1, 1.0, 2.5, 5.0, 9.0, toe, 28.0, end])
    level = np.array([base, -17.5, tip, -14, -12.5, -11.5, layer, -9.5, -8, -6, -4, -2, 0])
    x, y = np.meshgrid(np.concatenate((-right[::-1], right)), level)
    ground = np.interp(x, [-toe, -0.1, 0.1, toe], [-8.0, 0.0, 0.0, 8.0])
    y = np.where(y > layer, layer + (y - layer) * (ground - layer) / -layer, y)
    rows, columns = x.shape
    i, j = (k.ravel() for k in np.indices((rows - 1, columns - 1)))
    first = i * columns + j
    corners = np.array([first, first + 1, first + columns + 1, first + columns])
    mesh = MeshQuad(np.array([x.ravel(), y.ravel()]), corners).to_meshtri(style="x")

    def pile(x):
        return with_pile & (abs(x[0]) < 0.1) & (x[1] > tip)

    mesh = mesh.with_subdomains(
        {"upper": lambda x: (x[1] > layer) & ~pile(x), "lower": lambda x: (x[1] < layer) & ~pile(x)}
    )
    mesh = mesh.with_boundaries(
        {"bottom": lambda x: np.isclose(x[1], base), "sides": lambda x: np.isclose(abs(x[0]), end)}
    )
    if not with_pile:
        return mesh
    sides = {"left": lambda x: np.isclose(x[0], -0.1), "right": lambda x: np.isclose(x[0], 0.1)}
    faces = {"tip": lambda x: np.isclose(x[1], tip) & (abs(x[0]) < 0.1)}
    for name, on in sides.items():
        faces[f"{name} upper"] = lambda x, on=on: on(x) & (x[1] > layer)
        faces[f"{name} lower"] = lambda x, on=on: on(x) & (x[1] < layer) & (tip < x[1])
    mesh = mesh.with_subdomains({"pile": pile})
    mesh = mesh.with_boundaries(faces, boundaries_only=False)
    return sc.join_bodies(mesh, bodies={"ground": ["upper", "lower"], "pile": "pile"})


# %%
# Soils, pile and interface
# -------------------------
# The pile yields at a moment of 150 kNm/m. An interface of strength :math:`R` has :math:`R\, c` and
# :math:`R \tan\phi` of the layer that it touches. The pile keeps its strength, all else is reduced.

soils = {
    "upper": sc.MohrCoulomb(1e5, 0.3, c=32.5, phi=10.0, psi=10.0),
    "lower": sc.MohrCoulomb(2e5, 0.3, c=50.0, phi=35.0, psi=35.0),
}
weights = {"upper": 19.0, "lower": 20.0}


def model(mesh, share=None, stiffness=2.8e7):
    """Forms, supports and weights; without a share of strength there is no pile."""
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs("sides").all("u^1"))
    if share is None:
        return {"ground": sc.SolidForm(basis, soils)}, fixed, weights
    concrete = sc.Tresca(E=stiffness, nu=0.2, c=2.0 * 150.0 / width**2)
    forms = {
        "ground": sc.SolidForm(basis.with_elements("ground"), soils),
        "pile": sc.SolidForm(basis.with_elements("pile"), concrete),
    }
    for face in ("left upper", "left lower", "right upper", "right lower", "tip"):
        soil = soils["upper" if "upper" in face else "lower"]
        law = sc.Coulomb(mu=share * np.tan(np.radians(soil.phi)), adhesion=share * soil.c)
        sides = f"ground:{face}", f"pile:{face}"
        forms[face] = sc.ContactPair(basis, *sides, law, "nodal", penalty=(6e5, 6e4))
    return forms, fixed, {**weights, "pile": 25.0}


# %%
# Bounds, and strength reduction on their mesh
# --------------------------------------------
# A factor of strength reduction above its bracket is the mesh's, one below would be an error. A
# weaker interface never raises a factor.

gap, elements = (0.05, 3000) if FULL else (0.1, 700)
cases = {"without pile": None, "interface 1": 1.0, "interface 2/3": 2 / 3, "smooth": 0.0}
if not FULL:
    cases = {name: cases[name] for name in ("without pile", "interface 1")}
proven, factors, rows = {}, {}, []
for name, share in cases.items():
    kept = () if share is None else "pile"
    forms, fixed, weight = model(slope(share is not None), share)
    begin = process_time()
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "the bounds .* differ", sc.AnalysisWarning)
        found = sc.Model(forms, fixed).bounds(
            weight=weight, exclude=kept, gap=gap, elements=elements, progress=False
        )
    middle = begin, process_time()
    forms, fixed, weight = model(found.mesh, share)
    basis = Basis(found.mesh, ElementVector(ElementTriP2()), intorder=2)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "no collapse was shown", sc.AnalysisWarning)
        reduction = sc.Model(forms, fixed).strength_reduction(
            sc.weight(basis, weight), exclude=kept, tolerance=0.02, certify=False, progress=False
        )
    proven[name], factors[name] = found, reduction.factor
    safe = "" if found.safe is None else f", safe {found.safe:.3f}"
    print(
        f"{name:14} [{found.lower:.3f}, {found.upper:.3f}]{safe}, strength reduction "
        f"{reduction.factor:.3f} ({reduction.stop.kind})"
    )
    rows += [
        {
            "method": f"bounds, {name}",
            "n": found.mesh.nelements,
            "lower": round(found.lower, 4),
            "upper": round(found.upper, 4),
            "unknowns": found.certificates[1].unknowns,
            "error": found.gap,
            "cpu_s": round(middle[1] - begin, 2),
            "iterations": sum(c.iterations for c in found.history),
        },
        {
            "method": f"strength reduction, {name}",
            "n": found.mesh.nelements,
            "factor": round(reduction.factor, 4),
            "unknowns": len(reduction.x),
            "error": None,
            "cpu_s": round(process_time() - middle[1], 2),
            "iterations": reduction.iterations,
        },
    ]

for name, found in proven.items():
    assert found.lower < factors[name] < found.upper * 1.02
ordered = list(cases)[1:]
for strong, weak in pairwise(ordered):
    assert factors[weak] <= factors[strong] and proven[weak].lower <= proven[strong].upper
assert factors["without pile"] < factors["interface 1"]

# %%
# Young's modulus
# ---------------
# Limits do not know it. With a pile ten times as stiff strength reduction finds the same factor,
# but for its tolerance.

if FULL:
    forms, fixed, weight = model(proven["interface 1"].mesh, 1.0, stiffness=2.8e8)
    basis = Basis(proven["interface 1"].mesh, ElementVector(ElementTriP2()), intorder=2)
    stiff = sc.Model(forms, fixed).strength_reduction(
        sc.weight(basis, weight), exclude="pile", certify=False, progress=False
    )
    print(f"a pile ten times as stiff: {stiff.factor:.3f}")
    assert abs(stiff.factor - factors["interface 1"]) < 0.02

# %%
# The mechanism
# -------------
# That of the upper bound with the rough pile, and all brackets.

name = "interface 1"
plot.mechanism(proven[name])

# %%

figure, ax = plt.subplots(figsize=(7, 3), layout="constrained")
for y, name in enumerate(proven):
    ax.plot([proven[name].lower, proven[name].upper], [y, y], "|-", color="#1f4e8c", markersize=12)
    ax.plot(factors[name], y, "o", color="#d55e00", label="strength reduction" if y == 0 else None)
ax.set(yticks=range(len(proven)), yticklabels=list(proven), xlabel="factor of safety")
ax.margins(y=0.25)
ax.legend(frameon=False)
ax.grid(color="#dddddd", linewidth=0.6)
plt.show()

print(json.dumps({"case": "bounds of a pile in a slope", "rows": rows}))
