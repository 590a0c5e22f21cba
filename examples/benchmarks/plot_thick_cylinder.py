r"""
Thick cylinder of Mohr-Coulomb soil under internal pressure
===========================================================

A cylinder (inner radius 1, outer radius 4, plane strain) is pressed apart from inside.  A ring of
soil beside the bore yields, and everything is known in closed form: stresses, the radius of the
plastic zone, the displacement of the bore for associated (:math:`\psi = \varphi = 30°`) and for
incompressible flow (:math:`\psi = 0`), and the pressure at which the whole wall yields.

One load step, without any load history, is compared with the exact solution on three meshes of
curved nine-node elements; the collapse pressure comes from indirect continuation.
"""

# %%
# Model
# -----
# A quarter of the cylinder.  The elements are finer towards the bore.

import json
from dataclasses import replace
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad2, ElementVector, FacetBasis, LinearForm, MeshQuad, MeshQuad2

import skfem_contact as sc

A, B, E, NU, C, PHI, PRESSURE = 1.0, 4.0, 1e4, 0.3, 10.0, 30.0, 20.0
BORE = {
    30.0: 4.083045445e-3,
    0.0: 4.985552854e-3,
}  # exact displacement of the bore for psi = 30 and 0
RADIUS, COLLAPSE = 2.08364829, 26.324437  # exact plastic radius and collapse pressure


def quarter(n: int) -> MeshQuad2:
    """Curved elements, n along the radius and n / 3.5 along the arc."""
    s = np.linspace(0, 1, n + 1)
    radius = A + (B - A) * np.expm1(1.4 * s) / np.expm1(1.4)
    flat = MeshQuad.init_tensor(
        radius, np.linspace(0, np.pi / 2, round(n / 3.5) + 1)
    ).with_boundaries(
        {
            "bore": lambda x: np.isclose(x[0], A),
            "x axis": lambda x: np.isclose(x[1], 0),
            "y axis": lambda x: np.isclose(x[1], np.pi / 2),
        }
    )
    curved = MeshQuad2.from_mesh(flat)
    r, angle = curved.doflocs
    return replace(
        curved, doflocs=np.stack((r * np.cos(angle), r * np.sin(angle)))
    ).with_boundaries(flat.boundaries)


def model(n: int, psi: float) -> tuple[Basis, dict, np.ndarray, np.ndarray]:
    """Basis, forms, load of a unit pressure in the bore, and fixed unknowns."""
    mesh = quarter(n)
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=6)
    forms = {"cylinder": sc.SolidForm(basis, sc.MohrCoulomb(E=E, nu=NU, c=C, phi=PHI, psi=psi))}
    bore = FacetBasis(mesh, basis.elem, facets="bore", intorder=6)
    load = LinearForm(lambda v, w: -(v[0] * w.n[0] + v[1] * w.n[1])).assemble(bore)
    fixed = np.concatenate(
        (basis.get_dofs("x axis").all("u^2"), basis.get_dofs("y axis").all("u^1"))
    )
    return basis, forms, load, fixed


def bore_displacement(basis: Basis, x: np.ndarray) -> float:
    """Mean radial displacement of the nodes on the bore."""
    dofs = basis.get_dofs("bore")
    ux, uy = (np.concatenate((dofs.nodal[c], dofs.facet[c])) for c in ("u^1", "u^2"))
    points = basis.doflocs[:, ux]
    return float(np.mean((points[0] * x[ux] + points[1] * x[uy]) / np.linalg.norm(points, axis=0)))


# %%
# One load step
# -------------
rows = []
for psi in (30.0, 0.0):
    for n in (7, 14, 28):
        begin = process_time()
        basis, forms, load, fixed = model(n, psi)
        result = sc.Model(forms, fixed).run([sc.Stage("pressure", PRESSURE * load)])
        error = bore_displacement(basis, result["pressure"].x) / BORE[psi] - 1
        rows.append(
            {
                "method": f"Q2, psi = {psi:g}",
                "n": n,
                "unknowns": int(basis.N),
                "error": abs(error),
                "cpu_s": round(process_time() - begin, 2),
                "iterations": sum(result["pressure"].iterations),
            }
        )
        print(
            f"psi = {psi:2g}  {basis.N:5d} unknowns  bore displacement {error:+.4%}  "
            f"{rows[-1]['iterations']} iterations"
        )
        if basis.N < 600:
            assert sum(result["pressure"].iterations) <= 6
            assert n < 14 or abs(error) <= 1e-4

# %%
# Stresses
# --------
# In the plastic zone :math:`\sigma_r = c\cot\varphi - (c\cot\varphi + p)(r/a)^{N}` with
# :math:`N = (1 - k)/k`, :math:`k = (1+\sin\varphi)/(1-\sin\varphi)`; outside, Lamé's solution with
# the pressure that acts at the plastic radius.  The points lie where the elements are integrated.
state = result["pressure"].states["cylinder"]
form = forms["cylinder"]
points = np.asarray(form.basis.global_coordinates())
r, angle = np.hypot(*points), np.arctan2(points[1], points[0])
cos, sin = np.cos(angle), np.sin(angle)
sx, sy, sz, txy = state.stress
radial = cos**2 * sx + sin**2 * sy + 2 * sin * cos * txy
hoop = sin**2 * sx + cos**2 * sy - 2 * sin * cos * txy

k = (1 + np.sin(np.deg2rad(PHI))) / (1 - np.sin(np.deg2rad(PHI)))
tip = C / np.tan(np.deg2rad(PHI))


def exact_stresses(radius: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Radial and hoop stress of the exact solution."""
    plastic = tip - (tip + PRESSURE) * (radius / A) ** ((1 - k) / k)
    at_front = (tip + PRESSURE) * (RADIUS / A) ** ((1 - k) / k) - tip
    lame = at_front * RADIUS**2 / (B**2 - RADIUS**2)
    elastic = lame * (1 - B**2 / radius**2), lame * (1 + B**2 / radius**2)
    inside = radius < RADIUS
    return (
        np.where(inside, plastic, elastic[0]),
        np.where(inside, tip + (plastic - tip) / k, elastic[1]),
    )


exact = exact_stresses(r)
stress_error = max(np.abs(radial - exact[0]).max(), np.abs(hoop - exact[1]).max()) / PRESSURE
yielded = state.internal[0] > 0
front = 0.5 * (r[yielded].max() + r[~yielded].min())
print(
    f"largest error of a stress {stress_error:.2%} of the pressure; plastic radius {front:.3f} "
    f"(exact {RADIUS:.3f})"
)
assert (
    stress_error < 0.02
)  # the kink of the hoop stress at the plastic radius runs through an element
assert abs(front / RADIUS - 1) < 0.02  # half the distance of two integration points

fig, ax = plt.subplots(figsize=(7, 4), layout="constrained")
line = np.linspace(A, B, 200)
for values, own, label, color in (
    (exact_stresses(line)[0], radial, "radial", "C0"),
    (exact_stresses(line)[1], hoop, "hoop", "C1"),
):
    ax.plot(line, values, color, label=f"{label}, exact")
    ax.plot(r.ravel()[::7], own.ravel()[::7], ".", color=color, ms=4)
ax.axvline(RADIUS, color="0.6", lw=1, ls="--")
ax.set(xlabel="radius", ylabel="stress (tension positive)", xlim=(A, B))
ax.legend(frameon=False)
plt.show()

# %%
# Collapse
# --------
# The wall yields as a whole when the plastic zone reaches its outside.
begin = process_time()
basis, forms, load, fixed = model(14, 30.0)
limit = sc.Model(forms, fixed).limit_load(PRESSURE * load, tolerance=0.002)
pressure = PRESSURE * limit.multiplier
print(
    f"collapse pressure {pressure:.3f}, exact {COLLAPSE:.3f}: {pressure / COLLAPSE - 1:+.3%}, "
    f"{limit.iterations} iterations"
)
rows.append(
    {
        "method": "Q2, collapse by continuation",
        "n": 14,
        "unknowns": int(basis.N),
        "error": abs(pressure / COLLAPSE - 1),
        "cpu_s": round(process_time() - begin, 2),
        "iterations": limit.iterations,
    }
)
assert abs(pressure / COLLAPSE - 1) <= 5e-3

# %%
# Headline numbers
# ----------------
print(json.dumps({"case": "thick cylinder", "rows": rows}))
