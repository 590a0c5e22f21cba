#!/usr/bin/env bash
# Kratos 10.4.4: an angle of friction of 10 or 45 degrees, the same soil, and at worst one without friction.
#
# Expected: in the modified Mohr-Coulomb law the largest stress at failure grows by (1 + sin) / (1 - sin)
#     of the angle of friction per smallest one: 1.42, 3 and 5.83 at 10, 30 and 45 degrees.
# Seen: it grows by the ratio of `YIELD_STRESS_COMPRESSION` to `YIELD_STRESS_TENSION`: 3 with 173 and 58
#     kPa at all three angles, 11 with 173 and 17 kPa.  With the single `YIELD_STRESS` it is 1: no
#     friction at all, with an angle of 30 degrees given.  The angle changes no digit of the stress in
#     compression, extension or tension.  The Mohr-Coulomb law of the same package has 3.00 at 30.
# Meaning: the angle cancels in the formula.  A soil with "phi = 30, c" in this law is Tresca's, or,
#     with a small tensile strength, one of 56 degrees.  Choose the two strengths so that their ratio
#     is (1 + sin) / (1 - sin), or take the other law.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    KratosMultiphysics==10.4.4 KratosStructuralMechanicsApplication==10.4.4 \
    KratosConstitutiveLawsApplication==10.4.4 numpy==2.4.6
cat > run.py <<'PY'
import KratosMultiphysics as Kratos
import KratosMultiphysics.ConstitutiveLawsApplication as Laws
import KratosMultiphysics.StructuralMechanicsApplication  # noqa: F401
import numpy as np

Kratos.Logger.GetDefaultOutput().SetSeverity(Kratos.Logger.Severity.WARNING)


def stress(law, direction, **constants):
    """Stress in kPa after twenty steps of strain, up to 2 % times the direction."""
    model = Kratos.Model()
    part = model.CreateModelPart("part")
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    nodes = [part.CreateNewNode(i + 1, *corner) for i, corner in enumerate(corners)]
    shape, soil = Kratos.Tetrahedra3D4(*nodes), part.CreateNewProperties(0)
    common = {"YOUNG_MODULUS": 20e6, "POISSON_RATIO": 0.3, "FRACTURE_ENERGY": 1e9}
    for name, value in {**common, **constants}.items():
        home = Kratos if hasattr(Kratos, name) else Laws
        soil.SetValue(getattr(home, name), value)
    soil.SetValue(Laws.HARDENING_CURVE, 3)  # perfect plasticity
    assert law.Check(soil, shape, part.ProcessInfo) == 0
    weights = Kratos.Vector(4, 0.25)
    law.InitializeMaterial(soil, shape, weights)
    for share in np.linspace(0.05, 1, 20):
        step = Kratos.ConstitutiveLawParameters()
        strain, result, tangent = Kratos.Vector(6), Kratos.Vector(6, 0.0), Kratos.Matrix(6, 6)
        for i in range(6):
            strain[i] = 0.02 * share * direction[i]
        options = Kratos.Flags()
        options.Set(Kratos.ConstitutiveLaw.USE_ELEMENT_PROVIDED_STRAIN)
        options.Set(Kratos.ConstitutiveLaw.COMPUTE_STRESS)
        step.SetOptions(options)
        step.SetStrainVector(strain)
        step.SetStressVector(result)
        step.SetConstitutiveMatrix(tangent)
        step.SetShapeFunctionsValues(weights)
        step.SetProcessInfo(part.ProcessInfo)
        step.SetMaterialProperties(soil)
        step.SetElementGeometry(shape)
        law.CalculateMaterialResponseCauchy(step)
        law.FinalizeMaterialResponseCauchy(step)
    return np.array([step.GetStressVector()[i] / 1e3 for i in range(6)])


MODIFIED = Laws.SmallStrainIsotropicPlasticity3DModifiedMohrCoulombModifiedMohrCoulomb
CLASSIC = Laws.SmallStrainIsotropicPlasticity3DMohrCoulombMohrCoulomb
HIGH, LOW, SMALL = 300e3 / 3**0.5, 100e3 / 3**0.5, 300e3 / 3**0.5 / 11
BOTH = dict(YIELD_STRESS_COMPRESSION=HIGH, YIELD_STRESS_TENSION=LOW)
UNLIKE = dict(YIELD_STRESS_COMPRESSION=HIGH, YIELD_STRESS_TENSION=SMALL)
ONE = dict(YIELD_STRESS=HIGH)
TRIAXIAL = (0.25, 0.25, -1, 0, 0, 0)


def growth(law, angle, strengths):
    """Growth of the largest stress at failure per smallest one, from two sizes of the strain."""
    constants = dict(FRICTION_ANGLE=float(angle), DILATANCY_ANGLE=float(angle), **strengths)
    first, second = [
        stress(law(), size * np.array(TRIAXIAL), **constants) for size in (1.0, 1.5)
    ]
    return (second[2] - first[2]) / (second[0] - first[0])


for angle in (10, 30, 45):
    right = (1 + np.sin(np.radians(angle))) / (1 - np.sin(np.radians(angle)))
    found = [growth(MODIFIED, angle, strengths) for strengths in (BOTH, UNLIKE, ONE)]
    print(f"{angle} degrees: {np.round(found, 3)} for three pairs of strengths, right {right:.2f}")
    assert np.allclose(found, [3, 11, 1], rtol=1e-3)
classic = growth(CLASSIC, 30, dict(COHESION=50e3, **ONE))
print(f"Mohr-Coulomb at 30 degrees: {classic:.3f}")
assert abs(classic - 3) < 1e-3
for direction in (TRIAXIAL, (-1, -1, 0.5, 0, 0, 0), (-0.2, -0.2, 1, 0, 0, 0), (0.6, 0, -1, 0, 0, 0)):
    ten, steep = [
        stress(MODIFIED(), direction, FRICTION_ANGLE=angle, DILATANCY_ANGLE=30.0, **BOTH)
        for angle in (10.0, 45.0)
    ]
    assert np.allclose(ten, steep, atol=1e-3 * np.abs(ten).max())
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
