#!/usr/bin/env bash
# sectionproperties 3.10.2, concreteproperties 0.7.0: a moment bends one section up, the other down.
#
# Expected: two libraries of the same authors, one of which takes its sections from the other, have
#     the same sign of a moment about x and of an axial force.
# Seen: with mxx > 0 the top of a concrete rectangle is in tension in sectionproperties (stress
#     +0.080 per kNm); with m_x > 0 it is in compression in concreteproperties, and n > 0 is
#     tension in the one and compression in the other.  Three bars at the side that the stresses of
#     the first call for give a moment of 8.0 kNm in the second in place of 197.5 kNm at the other side.
# Meaning: a lining or raft that is checked elastically with the one and designed with the other
#     has its steel on the wrong side, or its arch thrust as tension.  The name of a moment says
#     nothing: insert one unit moment in both, and look at the stress of one corner.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    sectionproperties==3.10.2 concreteproperties==0.7.0 numpy==2.4.6
cat > run.py <<'PY'
import warnings

import concreteproperties as cp
from sectionproperties.analysis import Section
from sectionproperties.pre.library import concrete_rectangular_section, rectangular_section

warnings.simplefilter("ignore", RuntimeWarning)
concrete = cp.Concrete(
    name="concrete",
    density=2.4e-6,
    stress_strain_profile=cp.ConcreteLinear(elastic_modulus=30e3),
    ultimate_stress_strain_profile=cp.RectangularStressBlock(
        compressive_strength=30, alpha=0.85, gamma=0.8, ultimate_strain=0.0035
    ),
    flexural_tensile_strength=3,
    colour="lightgrey",
)
law = cp.SteelElasticPlastic(yield_strength=500, elastic_modulus=200e3, fracture_strain=0.05)
steel = cp.SteelBar(name="steel", density=7.85e-6, stress_strain_profile=law, colour="grey")


def reinforced(top, bottom):
    """Section of 300 mm x 500 mm with bars of 314 mm2 at the top and the bottom."""
    shape = concrete_rectangular_section(
        d=500, b=300, dia_top=20, area_top=314, n_top=top, c_top=40, dia_bot=20, area_bot=314,
        n_bot=bottom, c_bot=40, n_circle=8, conc_mat=concrete, steel_mat=steel,
    )
    return cp.ConcreteSection(shape)


def top_stress(section, **forces):
    """Stress of the concrete at the top of the uncracked section."""
    result = section.calculate_uncracked_stress(**forces)
    found = {}
    for part, stresses in zip(result.concrete_analysis_sections, result.concrete_stresses):
        found |= {node[1]: stress for node, stress in zip(part.mesh_nodes, stresses)}
    return found[max(found)]


plain = rectangular_section(d=500, b=300)
plain.create_mesh([2000])
elastic = Section(plain)
elastic.calculate_geometric_properties()
elastic.calculate_warping_properties()
first = [elastic.get_stress_at_points([(150, 500)], **{name: 1e6})[0][0] for name in ("mxx", "n")]
second = [top_stress(reinforced(1, 1), **{name: 1e6}) for name in ("m_x", "n")]
strengths = [reinforced(*bars).ultimate_bending_capacity(theta=0).m_x / 1e6 for bars in ((3, 0), (0, 3))]
print("sectionproperties, stress at the top under a positive moment and axial force", first)
print("concreteproperties (compression is positive)", second)
print("strengths in kNm under a positive moment, bars at the top and at the bottom", strengths)
assert abs(first[0] - 0.08) < 1e-3 and first[1] > 0  # tension is positive
assert second[0] > 0.06 and second[1] > 0  # compression is positive
assert abs(strengths[0] - 8.0) < 0.1 and abs(strengths[1] - 197.5) < 0.5
squeezed = reinforced(0, 3).ultimate_bending_capacity(theta=0, n=500e3).m_x / 1e6
pulled = reinforced(0, 3).ultimate_bending_capacity(theta=0, n=-300e3).m_x / 1e6
print(f"with n = 500 kN {squeezed:.0f} kNm, with n = -300 kN {pulled:.0f} kNm")
assert squeezed > strengths[1] > pulled
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
