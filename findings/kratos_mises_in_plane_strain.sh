#!/usr/bin/env bash
# Kratos 10.4.4: the equivalent stress of soil in plane strain leaves out the stress across the plane.
#
# Expected: `VON_MISES_STRESS` of an element in plane strain is the one of a brick with the same strains: the
#     stress across the plane counts.
# Seen: soil (E = 10 MPa, nu = 0.3) that is compressed by 0.1 % vertically: 11.70 kPa in
#     `SmallDisplacementElement2D4N` with `LinearElasticPlaneStrain2DLaw`, 7.69 kPa in
#     `SmallDisplacementElement3D8N` and by hand.  Compressed by 0.1 % in both directions of the plane: 19.23 and
#     7.69 kPa.  In pure shear they agree.  No message.
# Meaning: the formula is the one of plane stress.  At rest, soil is used one and a half times as much as it
#     is, and two and a half times under equal pressure, while shear is right: maps of utilisation show the
#     pressure of the ground as if it were shear.  Take a slice of bricks, or use nu (sigma_xx + sigma_yy).
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
SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
CUBE = SQUARE + [(x, y, 1) for x, y, _ in SQUARE]


def equivalent(element, law, corners, strain):
    """Equivalent stress in kPa of one element under strains in x and y."""
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
    values = block.CalculateOnIntegrationPoints(Structural.VON_MISES_STRESS, part.ProcessInfo)
    return float(np.mean(values))


def closed_form(strain):
    """Equivalent stress in kPa with the stress across the plane, and without it."""
    lame, shear = YOUNG * POISSON / (1 + POISSON) / (1 - 2 * POISSON), YOUNG / 2 / (1 + POISSON)
    stress = lame * sum(strain) + 2 * shear * np.array([*strain, 0])
    right, plane = [np.sqrt(1.5 * ((s - s.mean()) ** 2).sum()) for s in (stress, [1, 1, 0] * stress)]
    return float(right), float(plane)


for name, strain in (
    ("vertical", (0, -1e-3)),
    ("both directions", (-1e-3, -1e-3)),
    ("pure shear", (1e-3, -1e-3)),
):
    plane = equivalent(
        "SmallDisplacementElement2D4N", Structural.LinearElasticPlaneStrain2DLaw(), SQUARE, strain
    )
    brick = equivalent("SmallDisplacementElement3D8N", Structural.LinearElastic3DLaw(), CUBE, strain)
    right, without = closed_form(strain)
    print(f"{name}: plane strain {plane:.2f} kPa, brick {brick:.2f} kPa, by hand {right:.2f} kPa")
    assert abs(brick - right) < 1e-6 and abs(plane - without) < 1e-6
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
