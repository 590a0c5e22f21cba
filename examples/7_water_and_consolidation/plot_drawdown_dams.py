r"""
Two dams that failed by rapid drawdown
======================================

The upstream slopes of Pilarcitos dam (1969) and of Walter Bouldin dam (1975) failed when their
reservoirs fell. Duncan, Wright and Wong (1990) compute the factors 1.05 and 1.04 by their
three-stage method. Sections and strengths are those of the verification corpus of xslope, which
repeats them from Slide2's problems 97 and 98 with 1.043 and 1.039. Units are feet and pounds.

The method takes the stresses on a slip surface. Here the mechanism of a first search gives the slip
planes, and the search is repeated with the strengths on them.
"""

import json
import sys

import numpy as np
from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact as sc
import skfem_contact.plot as plot

plot.set_units("lb", "ft")


def from_isotropic(d, psi, phi):
    """Return c_R and phi_R of the line d + sigma tan(psi) of isotropic consolidation."""
    slope = np.tan(np.radians(psi)) / np.cos(np.radians(phi))
    phi_R = np.arcsin(slope / (1.0 + slope))
    c_R = d * (1.0 - np.sin(phi_R)) / (np.cos(phi_R) * np.cos(np.radians(phi)))
    return c_R, np.degrees(phi_R)


# %%
# Stage 1 is the full reservoir. Clays count with their undrained strengths under total stresses
# afterwards, soils without a line of total stresses with the drained ones.
def factor(section, soils, levels):
    """Return the last collapse, by the strengths on the planes of the one before, and stages."""
    basis = Basis(section.mesh(), ElementVector(ElementTriP2()), intorder=2)
    supports, weights = sc.box_supports(basis), {name: soil[0] for name, soil in soils.items()}
    laws = {n: sc.MohrCoulomb(1e6, 0.3, max(s[1], 1.0), s[2], s[2]) for n, s in soils.items()}
    solid = sc.SolidForm(basis, laws, unit_weight=weights)
    model = sc.Model({"dam": solid}, supports, water_unit_weight=62.4)
    full, low = (sc.Stage(f"{level} ft", water=level, increments=2) for level in levels)
    result, found = model.run([full, low]), None
    before, after = result[full.name], result[low.name]
    for _ in range(3):
        forms = {}
        for name, (weight, *strengths) in soils.items():
            law = laws[name]
            drains = len(strengths) == 2
            if not drains:
                mechanism = None if found is None else found.mechanism
                strength = drawn_strength(before, after, soils, name, mechanism)
                law = sc.Tresca(1e6, 0.45, c=np.maximum(strength, 10.0))
            part = basis.with_elements(name)
            forms[name] = sc.SolidForm(part, law, unit_weight=weight, porous=drains)
        drawn = sc.Model(forms, supports, water_unit_weight=62.4)
        found = drawn.strength_reduction(water=levels[1], certify=False)
        print(f"{found.factor:.3f}")
    return found, before, after


def drawn_strength(before, after, soils, name, mechanism):
    """Return the strengths of a soil after the drawdown, on the planes of a mechanism."""
    _, c, phi, c_R, phi_R = soils[name]
    given = {"c": c, "phi": phi, "c_R": c_R, "phi_R": phi_R, "region": name}
    strength = before.drawdown_strength("dam", after=after, mechanism=mechanism, **given)
    return strength[name]


# %%
# Pilarcitos: unit weight, c', phi', and c_R, phi_R of the fill; 72 to 37 ft.
ground = [(0.0, 0.0), (145.0, 58.0), (205.0, 78.0), (240.0, 78.0), (240.0, 0.0)]
section = sc.section.Section({"fill": ground}, size=5.0)
pilarcitos, _, _ = factor(section, {"fill": (135.0, 0.0, 45.0, 60.0, 23.0)}, (72.0, 37.0))
plot.mechanism(pilarcitos)

# %%
# Walter Bouldin: four soils and riprap; 47 to 15 ft.
sand = [(95.6, 30.0), (158.0, 51.0), (180.0, 51.0), (180.0, 30.0)]
clay = [(5.3, 0.0), (95.6, 30.0), (180.0, 30.0), (180.0, 17.0), (58.0, 17.0), (11.0, 0.0)]
gravel = [(11.0, 0.0), (58.0, 17.0), (180.0, 17.0), (180.0, 0.0)]
riprap = [(100.0, 40.0), (140.0, 60.0), (144.0, 60.0), (104.0, 40.0)]
silty = [(0.0, 0.0), (100.0, 40.0), (104.0, 40.0), (144.0, 60.0), (180.0, 60.0), (180.0, 51.0)]
silty += [(158.0, 51.0), (95.6, 30.0), (5.3, 0.0)]
areas = {"silty sand": silty, "sand": sand, "clay": clay, "gravel": gravel, "riprap": riprap}
section = sc.section.Section(areas, size=2.5 if "--full" in sys.argv else 4.0)
soils = {
    "silty sand": (128.0, 240.0, 32.7, *from_isotropic(750.0, 15.0, 32.7)),
    "sand": (123.0, 220.0, 22.5, *from_isotropic(480.0, 13.0, 22.5)),
    "clay": (124.0, 180.0, 19.0, *from_isotropic(280.0, 15.5, 19.0)),
    "gravel": (125.0, 0.0, 40.0),
    "riprap": (125.0, 0.0, 40.0),
}
bouldin, before, after = factor(section, soils, (47.0, 15.0))
plot.mechanism(bouldin)


# %%
# The least factor of circles
# ---------------------------
# A collapse by the strengths on its own slip planes need not be the least one. On a circle the same
# stresses give the factor by moments, as in limit equilibrium: its mass turns about the centre,
# which is a mechanism. Circles above the gravel and the low water level are compared.
def on_circle(exits, enters, rise):
    """Return the factor of safety on a circle, by its ends on the surface and its rise."""
    # Centre and radius of the circle through both ends.
    basis = before.forms["dam"].basis
    ends = np.array([(x, np.interp(x, (0, 100, 140), (0, 40, 60))) for x in (exits, enters)])
    chord = ends[1] - ends[0]
    length = np.hypot(*chord)
    radius = length * (0.25 + rise**2) / (2.0 * rise)
    normal = np.array([-chord[1], chord[0]]) / length
    centre = ends.mean(axis=0) + (radius - rise * length) * normal

    # Middles of slices on it, and elements there and above.
    edges = np.linspace(exits, enters, 81)
    x = 0.5 * (edges[1:] + edges[:-1])
    y = centre[1] - np.sqrt(radius**2 - (x - centre[0]) ** 2)
    top = np.interp(x, (0, 100, 140), (0, 40, 60))
    if y.min() < 17.0 or (y > top).any():
        return np.inf
    find = basis.mesh.element_finder()
    above = y[:, None] + (top - y)[:, None] * (np.arange(30) + 0.5) / 30
    weights = np.zeros(basis.mesh.nelements)
    for name, soil in soils.items():
        weights[basis.mesh.subdomains[name]] = soil[0]
    weight = weights[find(np.repeat(x, 30), above.ravel())].reshape(-1, 30).mean(axis=1)

    # Strengths on the planes of a rotation about the centre, and moments.
    turn, strength = basis.zeros(), np.zeros(basis.mesh.nelements)
    turn[::2], turn[1::2] = centre[1] - basis.doflocs[1, ::2], basis.doflocs[0, 1::2] - centre[0]
    for name in ("silty sand", "sand", "clay"):
        part = basis.mesh.subdomains[name]
        strength[part] = drawn_strength(before, after, soils, name, turn)
    arc = np.diff(edges) * radius / (centre[1] - y)
    resists = radius * strength[find(x, y)] @ arc
    return resists / (weight * (top - y) * np.diff(edges) @ (x - centre[0]))


circles = [
    (a, b, r)
    for a in np.linspace(42.0, 66.0, 5)
    for b in np.linspace(150.0, 174.0, 5)
    for r in np.linspace(0.13, 0.23, 6)
]
on_circles = [on_circle(*circle) for circle in circles]
least = min(on_circles)
print(f"least factor of circles {least:.3f} on {circles[int(np.argmin(on_circles))]}")

# %%
# Pilarcitos is 2 % above the published factor. On circles Walter Bouldin is 1.5 % above it; the
# search, less the error of its mesh, stays on a deeper mechanism and is 4.1 % above it, with
# ``--full`` and elements of 2.5 ft less. Poisson's ratios from 0.2 to 0.4, which change the
# stresses of the full reservoir, move the factor by half a per cent. Programs of slices differ as
# well: GEO-SLOPE publishes 1.013 for Walter Bouldin with the same method ("Rapid drawdown with
# multi-stage", www.scribd.com/document/436165615).
for name, found, published in (("Pilarcitos", pilarcitos, 1.05), ("Bouldin", bouldin, 1.04)):
    less = found.factor / (1.0 + found.added)
    print(
        f"{name} {found.factor:.3f}, {less:.3f} less the error of the mesh, published {published}"
    )
error = pilarcitos.factor / 1.05 - 1.0
assert abs(error) < 0.03
assert abs(least / 1.04 - 1.0) < 0.03
assert least < bouldin.factor / (1.0 + bouldin.added) < 1.042 * 1.04
row = {"method": "three stages", "n": len(pilarcitos.x), "unknowns": len(pilarcitos.x)}
row |= {"error": abs(error), "cpu_s": None, "iterations": pilarcitos.iterations}
print(json.dumps({"case": "drawdown_dams", "rows": [row]}))
