"""
A slope with its bracket
========================

How safe is a slope of clay on a foundation of the same clay, and how certain is that figure? Two
proven bounds, a stress field in equilibrium and a mechanism, enclose the factor of safety on meshes
that are refined where the two differ. Strength reduction on the last of these meshes gives the
displacements. Taylor's chart (1937) says 1.47. Units are kN and m.
"""

# sphinx_gallery_thumbnail_number = 2

import json
from time import process_time

from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact as sc
import skfem_contact.plot as plot

sc.set_units("kN", "m")

begin = process_time()
section = sc.section.slope(10.0, 26.57, {"clay": -10.0}, size=3.0, crest=28.0, toe=20.0)
section.plot()

# %%


def model(mesh):
    """The slope on any mesh with its names."""
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    clay = sc.Tresca(E=1e5, nu=0.3, c=50.0)
    return sc.Model(section.solids(basis, clay, unit_weight=20.0), sc.box_supports(basis))


proven = model(section.mesh()).bounds(gap=0.02)
print(proven)
plot.mechanism(proven)

# %%
found = model(proven.mesh).strength_reduction(certify=False)
print(found)
plot.mechanism(found)

# sphinx_gallery_start_ignore
assert proven.gap < 0.02 and found.stop.kind == "plateau"
assert (
    proven.lower < 1.47 and proven.lower < found.factor < 1.01 * proven.upper
)  # elements are too stiff, if anything
error = abs(found.factor / 1.47 - 1.0)
assert error < 0.02, error  # two digits of the chart, whose circles lie above the factor
print(
    json.dumps(
        {
            "case": "slope_with_bracket",
            "rows": [
                {
                    "method": "strength reduction",
                    "n": proven.mesh.nelements,
                    "unknowns": len(found.x),
                    "error": error,
                    "factor": found.factor,
                    "bounds": [proven.lower, proven.upper],
                    "cpu_s": round(process_time() - begin, 1),
                    "iterations": found.iterations,
                }
            ],
        }
    )
)
# sphinx_gallery_end_ignore
