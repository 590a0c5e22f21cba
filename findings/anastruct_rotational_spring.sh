#!/usr/bin/env bash
# anastruct 1.7.0: a rotational spring lets a post deflect half of what it should.
#
# Expected: an element with a spring at its foot (`spring={1: k}`) has the deflection of the fixed
#     cantilever plus the rotation of the spring times the height, and a hinge (k = 0) in the middle
#     of a beam makes it two cantilevers.
# Seen: for a post of 5 m with EI = 1e4 kNm2, 10 kN at its head and k = 1000 kNm the head moves 161 mm
#     in place of 292 mm, though the moment at the foot, 50 kNm, is right.  `add_support_spring` with
#     the same k gives 292 mm.  A beam of 10 m with a hinge in its middle deflects 15.6 mm in place of
#     20.8 mm under 10 kN.  With a spring of 1000 kNm there the moments of the two ends are 8.75 and
#     15.0 kNm, where symmetry has 18.75 kNm at both.
# Meaning: the stiffness of an element with a spring is not the one of beam theory.  Joints of
#     sheet piles, segments of linings and semi-rigid feet are too stiff, and attract the wrong share
#     of the moment.  Use a support spring, or a short soft element; compare with a cantilever.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    anastruct==1.7.0 numpy==2.4.6
cat > run.py <<'PY'
import logging

from anastruct import SystemElements

logging.disable(logging.WARNING)
BENDING, LENGTH, LOAD, SPRING = 1e4, 5.0, 10.0, 1000.0


def post(in_element):
    """Deflection of the head of a post on a rotational spring in mm, and the moment at its foot."""
    system = SystemElements(EI=BENDING, EA=1e9)
    system.add_element([[0, 0], [LENGTH, 0]], spring={1: SPRING} if in_element else None)
    if in_element:
        system.add_support_fixed(1)
    else:
        system.add_support_hinged(1)
        system.add_support_spring(1, translation=3, k=SPRING)
    system.point_load(2, Fy=-LOAD)
    system.solve()
    result = system.get_element_results(1)
    moment = max(abs(result["Mmin"]), abs(result["Mmax"]))
    return -1000 * system.get_node_displacements(2)["uy"], moment


def beam(spring):
    """Deflection in mm and end moments in kNm of a clamped beam with a spring in its middle."""
    system = SystemElements(EI=BENDING, EA=1e9)
    system.add_element([[0, 0], [LENGTH, 0]], spring={2: spring})
    system.add_element([[LENGTH, 0], [2 * LENGTH, 0]])
    system.add_support_fixed(1)
    system.add_support_fixed(3)
    system.point_load(2, Fy=-LOAD)
    system.solve()
    moments = [abs(system.get_node_results_system(node)["Tz"]) for node in (1, 3)]
    return -1000 * system.get_node_displacements(2)["uy"], moments


right = 1000 * (LOAD * LENGTH**3 / (3 * BENDING) + LOAD * LENGTH**2 / SPRING)
(element, moment), (support, _) = post(True), post(False)
print(f"post: spring of the element {element:.1f} mm, of the support {support:.1f} mm, "
      f"right {right:.1f} mm; moment {moment:.1f} kNm")
assert abs(support - right) < 0.1 and abs(element - 160.7) < 0.1 and abs(moment - 50) < 1e-6

# Half of the symmetric beam: a cantilever with half of the load and twice the spring at its end.
for spring, seen, ends in ((0, 15.625, (25, 25)), (SPRING, 7.031, (8.75, 15))):
    rotation = LOAD * LENGTH**2 / (4 * BENDING) / (1 + 2 * spring * LENGTH / BENDING)
    held = 2 * spring * rotation
    right = 1000 * (LOAD * LENGTH**3 / (6 * BENDING) - held * LENGTH**2 / (2 * BENDING))
    deflection, moments = beam(spring)
    print(f"beam, k = {spring}: {deflection:.2f} mm, right {right:.2f} mm; end moments "
          f"{moments[0]:.2f} and {moments[1]:.2f} kNm, right {LOAD * LENGTH / 2 - held:.2f} kNm")
    assert abs(deflection - seen) < 0.01
    assert all(abs(moment - end) < 0.01 for moment, end in zip(moments, ends))
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
