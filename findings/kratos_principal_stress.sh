#!/usr/bin/env bash
# Kratos 10.4.4: the principal stresses and the pressure of an element are zero, without a word.
#
# Expected: `CalculateOnIntegrationPoints` returns PRINCIPAL_CAUCHY_STRESS_VECTOR of a solid element, as it does
#     CAUCHY_STRESS_VECTOR, or stops if an element does not know the result.
# Seen: an element in plane strain and a brick under -30.8 and -46.2 kPa.  CAUCHY_STRESS_VECTOR is right;
#     PRINCIPAL_CAUCHY_STRESS_VECTOR is zero in all components, and so is PRESSURE.  No message.
# Meaning: a result that an element does not have is a zero, not an error.  Checks of tension ("no principal stress is
#     positive"), of cracks and of utilisation pass in the whole model, and outputs that are listed in the
#     settings become maps of zeros.  Compute principal stresses from the stress, and distrust a map that is zero.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    KratosMultiphysics==10.4.4 KratosStructuralMechanicsApplication==10.4.4 numpy==2.4.6
cat > run.py <<'PY'
import KratosMultiphysics as Kratos
import KratosMultiphysics.StructuralMechanicsApplication as Structural
import numpy as np

Kratos.Logger.GetDefaultOutput().SetSeverity(Kratos.Logger.Severity.WARNING)
YOUNG, POISSON = 10e3, 0.3  # kPa
CLOSED_FORM = [-30.769230769, -46.153846154]  # kPa, for strains of -0.1 % and -0.3 %
SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
CUBE = SQUARE + [(x, y, 1) for x, y, _ in SQUARE]


def result(wanted, element, law, corners, strain):
    """Result of one element at its first point under strains in x and y."""
    model = Kratos.Model()
    part = model.CreateModelPart("part")
    part.AddNodalSolutionStepVariable(Kratos.DISPLACEMENT)
    for number, corner in enumerate(corners, 1):
        part.CreateNewNode(number, *corner)
    soil = part.CreateNewProperties(0)
    constants = (("YOUNG_MODULUS", YOUNG), ("POISSON_RATIO", POISSON), ("THICKNESS", 1.0))
    for name, value in (*constants, ("CONSTITUTIVE_LAW", law)):
        soil.SetValue(getattr(Kratos, name), value)
    block = part.CreateNewElement(element, 1, list(range(1, len(corners) + 1)), soil)
    block.Initialize(part.ProcessInfo)
    for node in part.Nodes:
        moved = [strain[0] * node.X, strain[1] * node.Y, 0]
        node.SetSolutionStepValue(Kratos.DISPLACEMENT, moved)
    variable = Kratos.KratosGlobals.GetVariable(wanted)
    return np.array(block.CalculateOnIntegrationPoints(variable, part.ProcessInfo)[0])


for element, law, corners in (
    ("SmallDisplacementElement2D4N", Structural.LinearElasticPlaneStrain2DLaw, SQUARE),
    ("SmallDisplacementElement3D8N", Structural.LinearElastic3DLaw, CUBE),
):
    strain = (-1e-3, -3e-3)
    stress, principal, pressure = [
        result(name, element, law(), corners, strain)
        for name in ("CAUCHY_STRESS_VECTOR", "PRINCIPAL_CAUCHY_STRESS_VECTOR", "PRESSURE")
    ]
    print(f"{element}: stress {stress.round(3)}, principal stresses {principal}, pressure {pressure}")
    assert np.allclose(stress[:2], CLOSED_FORM)
    assert np.all(principal == 0) and pressure == 0
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
