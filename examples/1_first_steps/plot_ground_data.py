"""
A slope from ground data
========================

Two boreholes and two cone penetration tests of an AGS 4 file become a section with its layers, the
parameters of its soils and a factor of safety. The file is synthetic. Correlations estimate
parameters, and all between the four columns is interpolated: both are for the engineer to judge.
Units are kN and m.
"""

# sphinx_gallery_thumbnail_number = 1

import json
from time import process_time

import numpy as np
from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact as sc
import skfem_contact.plot as plot

sc.set_units("kN", "m")

begin = process_time()

# %%
# From the file to the factor of safety. Zones of soil behaviour 2 to 4 are called clay, and 5 to 7
# sand, as the boreholes call them.
site = sc.ground.read_ags("site.ags")
soils = dict.fromkeys((2, 3, 4), "clay") | dict.fromkeys((5, 6, 7), "sand")
tests = list(site.soundings.values())
columns = [*site.boreholes.values(), *(test.column(soils) for test in tests)]
line = ((1000.0, 500.0), (1032.0, 524.0))
section = sc.ground.section(columns, size=2.0, along=line, width=8.0)
phi = tests[0].profile("phi")
strength = tests[0].profile("su", N_kt=14.0)
ground = {
    "sand": sc.MohrCoulomb(E=3e4, nu=0.3, c=1.0, phi=min(phi.between(0.0, 2.8), 36.0)),
    "clay": sc.Tresca(E=2e4, nu=0.48, c=strength.between(3.0, 10.0)),
}
basis = Basis(section.mesh(), ElementVector(ElementTriP2()), intorder=2)
forms = section.solids(basis, ground, unit_weight={"sand": 18.0, "clay": 18.5})
model = sc.Model(forms, sc.box_supports(basis))
found = model.strength_reduction(certify=False)
print(*site.remarks, *tests[0].remarks, phi.correlation, strength.correlation, sep="\n")
print(f"s_u = {strength.between(3.0, 10.0):.1f} kPa, factor of safety {found.factor:.2f}")

# %%
# Depths without readings are hatched. The clay of the tests ends where the tests end.
plot.soundings(tests, columns, section)

# %%
plot.mechanism(found)

# sphinx_gallery_start_ignore
assert list(section.areas) == ["sand", "clay"]
assert any("no readings at 4 of" in text for text in tests[0].remarks)
depth = strength.depth
made = 26.0 + 1.1 * depth  # undrained strength from which the file was made, but for waves
estimated = strength.between(3.0, 10.0)
assert abs(estimated / np.median(made[(depth >= 3.0) & (depth <= 10.0)]) - 1.0) < 0.03
assert 1.3 < found.factor < 2.2
row = {
    "method": "slope",
    "n": basis.mesh.nelements,
    "unknowns": model.layout.size,
    "error": None,
    "cpu_s": round(process_time() - begin, 1),
    "iterations": None,
    "factor": found.factor,
}
print(json.dumps({"case": "ground_data", "rows": [row]}))
# sphinx_gallery_end_ignore
