#!/usr/bin/env bash
# concretedesignpy 0.5.0: a beam that is clamped at one end sags as much as one on two hinges, 2.4 times too much.
#
# Expected: `deflection_computation` with `beam_type="propped_cantilever"` has a deflection between that of a simply
#     supported beam and that of a clamped one: w L^4 / (185 E I), and P L^3 / (107 E I) for a force at midspan.
# Seen: uncracked beam of 300 mm x 500 mm, 6 m. 10 kN/m: 2.17 mm, as on two hinges; by double integration 0.90 mm. 40
#     kN at midspan: 2.32 in place of 1.04 mm. The moment that decides on cracking is P L / 4 in place of 3 P L / 16.
#     The three other types are right. No message.
# Meaning: any type but the three others takes the formulas of the simply supported beam. End spans and edge beams of
#     slabs and walls seem to exceed the limits; a moment by hand in `ma` does not help. Multiply the deflection by
#     0.416 for a distributed load and by 0.447 for a force at midspan.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    --no-deps concretedesignpy==0.5.0 numpy==2.4.6
cat > run.py <<'PY'
import numpy as np
from concretedesignpy.calculators.beam_deflection import deflection_computation

WIDTH, HEIGHT, DEPTH, STRENGTH, SPAN = 300.0, 500.0, 440.0, 28.0, 6000.0  # mm, MPa
BENDING = 4700 * STRENGTH**0.5 * WIDTH * HEIGHT**3 / 12  # N mm2, uncracked


def found(kind, **load):
    """Deflection in mm of the uncracked beam by the library."""
    result = deflection_computation(
        WIDTH, HEIGHT, DEPTH, STRENGTH, 420.0, SPAN, 1500.0, 2, 16.0, ma=1.0, beam_type=kind, **load
    )
    assert result["ie"] == result["ig"]
    return result["short_deflection"]


def right(clamped, uniform_load=0.0, point_load=0.0):
    """Largest deflection in mm by double integration, with the reactions of the clamped ends by least energy."""
    x = np.linspace(0.0, SPAN, 40001)
    free = uniform_load * x * (SPAN - x) / 2 + point_load * np.minimum(x, SPAN - x) / 2

    def integral(values):
        return np.concatenate(([0.0], np.cumsum((values[1:] + values[:-1]) / 2 * np.diff(x))))

    shapes = np.array([1 - x / SPAN, x / SPAN][:clamped])  # moments by unit moments at the clamped ends
    if clamped:
        gram = [[np.trapezoid(first * second, x) for second in shapes] for first in shapes]
        ends = np.linalg.solve(gram, [-np.trapezoid(shape * free, x) for shape in shapes])
        free = free + ends @ shapes
    deflection = -integral(integral(free)) / BENDING
    return np.max(np.abs(deflection - deflection[-1] * x / SPAN))


for load in ({"uniform_load": 10.0}, {"point_load": 40e3}):  # N/mm, N
    for kind, clamped in (("simply_supported", 0), ("fixed_both", 2), ("propped_cantilever", 1)):
        wrong, exact = found(kind, **load), right(clamped, **load)
        print(f"{load} {kind}: {wrong:.3f} mm, by integration {exact:.3f} mm")
        if kind == "propped_cantilever":
            assert wrong == found("simply_supported", **load) and 2.2 < wrong / exact < 2.45
        else:
            assert abs(wrong / exact - 1) < 1e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
