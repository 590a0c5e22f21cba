r"""
Stresses before anything is built
=================================

An analysis in the ground begins with the stresses that are there. This example shows the ways to
them, and that nothing moves afterwards:

* the **K0 procedure** for level ground: layers, groundwater, a surcharge, and a pile that is
  *wished in place*, whose contact with the ground carries the earth pressure at rest from the
  start;
* **gravity** for ground of any shape: here a slope;
* the **null step**, a stage of the same load, which tells what was out of balance and removes it.
"""

# sphinx_gallery_thumbnail_number = 2

import json
import warnings
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad2, ElementVector, FacetBasis, LinearForm, MeshQuad

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("kN", "m")

rows = []


def row(method, n, step, error, begin):
    """Figures of a case."""
    rows.append(
        {
            "method": method,
            "n": n,
            "unknowns": len(step.x),
            "error": float(error),
            "cpu_s": round(process_time() - begin, 2),
            "iterations": sum(step.iterations),
        }
    )


# %%
# Level ground with a pile
# ------------------------
# 4 m of clay under 4 m of sand, a water table 2 m below the surface, and a surcharge of 10 kPa. The
# pile is a body of its own in the middle. Its weight is that of the ground for now: the difference
# can be added as a load later.

SURFACE, TABLE, SURCHARGE, WATER = 8.0, 6.0, 10.0, 10.0
GAMMA = {"clay": 19.0, "moist sand": 17.0, "wet sand": 20.0}
K0 = {"clay": 0.7, "moist sand": 0.5, "wet sand": 0.5}


def is_pile(x):
    """Points of the pile."""
    return (abs(x[0]) < 0.25) & (x[1] > 3)


begin = process_time()
columns = np.array([-4, -2.5, -1.25, -0.25, 0, 0.25, 1.25, 2.5, 4])
mesh = MeshQuad.init_tensor(columns, np.linspace(0, SURFACE, 17)).with_subdomains(
    {
        "clay": lambda x: x[1] < 4,
        "wet sand": lambda x: (x[1] > 4) & (x[1] < TABLE),
        "moist sand": lambda x: x[1] > TABLE,
        "pile": is_pile,
        "ground": lambda x: ~is_pile(x),
    }
)
mesh = sc.join_bodies(mesh.with_defaults(), bodies={"soil": "ground", "concrete": "pile"})
basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
forms = {
    "ground": sc.SolidForm(
        basis.with_elements("soil"), sc.MohrCoulomb(E=2e4, nu=0.3, c=2.0, phi=30.0)
    ),
    "pile": sc.SolidForm(basis.with_elements("concrete"), sc.LinearElastic(E=3e7, nu=0.2)),
    "skin": sc.ContactPair(
        basis, "soil|concrete", "concrete|soil", sc.Coulomb(mu=0.5), quadrature=2
    ),
}
fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))

# %%
# Loads are weight, surcharge and water. The water presses on both sides of the contact too, which
# then carries the effective stress; without their names a warning would remind us. The pile is
# taken for ground as yet, water included.

water = sc.hydrostatic(TABLE, unit_weight=WATER)
top = FacetBasis(mesh, basis.elem, facets="top")
pressed = LinearForm(lambda v, w: -SURCHARGE * v[1]).assemble(top)
load = (
    sc.weight(basis, GAMMA)
    + sc.water_load(basis, water, ["soil|concrete", "concrete|soil"])
    + pressed
)
start = sc.Model(forms, fixed).k0_state(
    load, unit_weights=GAMMA, K0=K0, surcharge=SURCHARGE, water=water
)
result = sc.Model(forms, fixed).run([sc.Stage("null step", load)], start=start)
print(result)
assert start["initial"].residual < 1e-12
assert not result["null step"].x.any()

# %%
# Contact pressure along the pile and its tip: exactly the effective stress at rest.

skin = result["null step"].tractions("skin")


def effective(y):
    """Vertical effective stress and K0 at a height."""
    levels, total = (
        [0, 4, 6, 8],
        [SURCHARGE + 34 + 40 + 76, SURCHARGE + 74, SURCHARGE + 34, SURCHARGE],
    )
    return np.interp(y, levels, total) - WATER * np.maximum(TABLE - y, 0), np.where(y < 4, 0.7, 0.5)


vertical, ratio = effective(skin.y)
side = skin.y > 3 + 1e-9
error = np.abs(skin.pressure - np.where(side, ratio, 1.0) * vertical).max() / vertical.max()
print(
    f"largest error of the contact pressure: {error:.1e}; largest displacement "
    f"{np.abs(result[-1].x).max():.1e}"
)
assert error < 1e-9
row("K0, pile wished in place", 16, result["null step"], error, begin)

fig, ax = plt.subplots(figsize=(5.5, 4.2), layout="constrained")
y = np.linspace(0, SURFACE, 400)
vertical, ratio = effective(y)
ax.plot(vertical, SURFACE - y, color="#1f4e8c", label="vertical effective stress")
ax.plot(ratio * vertical, SURFACE - y, color="#d55e00", label="horizontal effective stress")
ax.plot(water([0 * y, y]), SURFACE - y, color="#56b4e9", linestyle="--", label="pore pressure")
right = side & (skin.x > 0)
ax.plot(
    skin.pressure[right],
    SURFACE - skin.y[right],
    "o",
    color="black",
    markersize=3.5,
    label="contact pressure",
)
ax.set(xlabel="stress [kPa]", ylabel="depth [m]", ylim=(SURFACE, 0), xlim=(0, None))
ax.grid(color="#dddddd", linewidth=0.6)
ax.legend(frameon=False, loc="upper right")

# %%
# K0 that the ground cannot bear
# ------------------------------
# With :math:`K_0 = 0.2` sand of :math:`\varphi = 30°` would slide. The stresses return to the yield
# surface at once, the user is told, and the null step brings them into equilibrium.

begin = process_time()
with warnings.catch_warnings(record=True) as told:
    warnings.simplefilter("always")
    weak = sc.Model(forms, fixed).k0_state(
        load, unit_weights=GAMMA, K0=0.2, surcharge=SURCHARGE, water=water
    )
print(told[0].message)
settled = sc.Model(forms, fixed).run([sc.Stage("null step", load)], start=weak)
print(settled)
texts = " ".join(str(warning.message) for warning in told)
assert "beyond its strength" in texts and "out of balance" in texts
assert settled["null step"].residual < 1e-8
stress = settled["null step"].states["ground"].stress
active = (1 - np.sin(np.pi / 6)) / (1 + np.sin(np.pi / 6))
bound = (active * -stress[1] - 4 * np.sqrt(active) + stress[0]).max() / -stress[
    1
].min()  # Rankine's with c = 2
print(
    f"horizontal stress below the active one by {max(bound, 0):.1e} of the largest stress at most"
)
assert bound < 1e-8
row("K0 too small, after the null step", 16, settled["null step"], max(bound, 0.0), begin)

# %%
# Ground that is not level
# ------------------------
# A slope under its own weight. Gravity is turned on in elastic ground whose Poisson's ratio gives
# the K0 that was asked for, then the soil finds its equilibrium, and the displacements are set to
# zero.

begin = process_time()
flat = MeshQuad.init_tensor(np.linspace(0, 1, 25), np.linspace(0, 1, 9))
x = 24 * flat.p[0]
height = 8 - 4 * np.clip((x - 8) / 8, 0, 1)
slope = MeshQuad(np.stack((x, height * flat.p[1])), flat.t).with_boundaries(
    {"base": lambda x: x[1] < 1e-9, "sides": lambda x: (x[0] < 1e-9) | (x[0] > 24 - 1e-9)}
)
basis = Basis(slope, ElementVector(ElementQuad2()), intorder=4)
hill = {"hill": sc.SolidForm(basis, sc.MohrCoulomb(E=2e4, nu=0.3, c=5.0, phi=30.0))}
held = np.append(basis.get_dofs("base").all(), basis.get_dofs("sides").all("u^1"))
own = sc.weight(basis, 19.0)
start = sc.Model(hill, held).gravity_state(own, K0=0.6)
null = sc.Model(hill, held).run([sc.Stage("null step", own)], start=start)
print(null)
assert not null["null step"].x.any()
assert null["null step"].iterations == (0,)
stress = null["null step"].states["hill"].stress
px, py = np.asarray(hill["hill"].basis.global_coordinates())
far = (px < 1) & (py < 1)
error = np.abs(stress[0] / stress[1] / 0.6 - 1)[far].max()
print(f"ratio of the stresses far from the slope: {(stress[0] / stress[1])[far].mean():.3f}")
assert error < 0.05
row("gravity, slope", 24, null["null step"], error, begin)

# %%
# The shear stress in the slope, in equilibrium before anything is done to it.

plot.contour(null["null step"], "sxy")

# %%
# Figures
# -------

print(json.dumps({"case": "k0", "rows": rows}))
