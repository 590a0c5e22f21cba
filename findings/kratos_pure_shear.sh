#!/usr/bin/env bash
# Kratos 10.4.4: soil in pure shear never yields.
#
# Expected: a soil of the modified Mohr-Coulomb law whose strengths are 173 kPa in compression and 58 kPa
#     in tension yields in pure shear at 43 kPa.
# Seen: `SmallStrainIsotropicPlasticity3DModifiedMohrCoulombModifiedMohrCoulomb` is elastic for any shear
#     strain: 153.8 kPa at 2 %, 1538 kPa at 20 %, and for strains of (1, -1, 0) alike.  With (1.001, -1, 0)
#     it lies on the surface of Mohr and Coulomb.  Tresca's law (58 kPa) has 29 kPa in pure shear.  No
#     message.
# Meaning: where the mean stress is exactly zero the equivalent stress is set to zero.  That is the
#     first step of a shear test, of torsion, and of an undrained layer that starts without stress:
#     the strength of a first check is infinite.  Start with a small confining stress, and compare.
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
TRESCA = Laws.SmallStrainIsotropicPlasticity3DTrescaTresca
COMPRESSION, TENSION = 300e3 / 3**0.5, 100e3 / 3**0.5
SOIL = dict(
    YIELD_STRESS_COMPRESSION=COMPRESSION, YIELD_STRESS_TENSION=TENSION,
    FRICTION_ANGLE=30.0, DILATANCY_ANGLE=30.0,
)
shear = COMPRESSION * TENSION / (COMPRESSION + TENSION) / 1e3
print(f"strength in pure shear {shear:.1f} kPa")
for name, direction in (
    ("shear", (0, 0, 0, 1, 0, 0)),
    ("ten times as much", (0, 0, 0, 10, 0, 0)),
    ("strains 1 and -1", (1, -1, 0, 0, 0, 0)),
    ("strains 1.001 and -1", (1.001, -1, 0, 0, 0, 0)),
):
    modified, tresca = [stress(law(), direction, **SOIL) for law in (MODIFIED, TRESCA)]
    print(f"{name}: modified Mohr-Coulomb {modified[:4].round(1)}, Tresca {tresca[:4].round(1)} kPa")
    elastic = 20e3 / 1.3 * 0.02 * np.array([*direction[:3], direction[3] / 2])
    matrix = np.diag(modified[:3])
    matrix[0, 1] = matrix[1, 0] = modified[3]
    least, _, largest = np.linalg.eigvalsh(matrix)
    used = 1e3 * (largest / TENSION - least / COMPRESSION)
    print(f"    modified Mohr-Coulomb uses {used:.2f} of its strength")
    if sum(direction[:3]) == 0:
        assert np.allclose(modified[:4], elastic, atol=1e-6) and used > 3
    else:
        assert abs(used - 1) < 1e-3
    assert np.abs(tresca).max() < 60
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
