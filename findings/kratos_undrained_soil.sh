#!/usr/bin/env bash
# KratosGeoMechanicsApplication 10.4.4: undrained soil is 1.3 times as stiff as drained soil, right is 287 times.
#
# Expected: with `GEO_DRAINAGE_TYPE` "UNDRAINED" the stiffness of the water in the pores, from `BULK_MODULUS_FLUID`,
#     `BULK_MODULUS_SOLID` and `POROSITY`, is added to that of the skeleton, as in "FULLY_COUPLED" without flow.
# Seen: E = 10 MPa, nu = 0.3, porosity 0.4, water 2 GPa, grains 10 GPa, one cube compressed by 0.1 % without lateral
#     strain.  The drained cube takes 13.46 kPa.  "FULLY_COUPLED" in one step without flow takes 3860 kPa, the value of
#     the closed form M + 1 / (n / Kf + (1 - n) / Ks).  "UNDRAINED" takes 17.63 kPa.  The stiffer the grains, the
#     softer it is: 13.67 kPa with 200 GPa.  No message about it.
# Meaning: Skempton's B = 1 / (1 + n K / Kf) needs the bulk modulus K of the skeleton, 8.3 MPa here, which makes it
#     0.998.  Kratos puts `BULK_MODULUS_SOLID` there, and B is 0.33.  Undrained settlements and heave are nearly the
#     drained ones.  Give `GEO_SKEMPTON_B` or `GEO_POISSON_UNDRAINED`: then 388 kPa are reached, as the undrained
#     Poisson's ratio is cut to 0.495 with a warning.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    KratosMultiphysics==10.4.4 KratosStructuralMechanicsApplication==10.4.4 KratosLinearSolversApplication==10.4.4 \
    KratosGeoMechanicsApplication==10.4.4 numpy==2.4.6
cat > run.py <<'PY'
import KratosMultiphysics as Kratos
import KratosMultiphysics.GeoMechanicsApplication as Geo
from KratosMultiphysics import StructuralMechanicsApplication  # noqa: F401

Kratos.Logger.GetDefaultOutput().SetSeverity(Kratos.Logger.Severity.WARNING)
named = Kratos.KratosGlobals.GetVariable
YOUNG, POISSON, POROSITY, FLUID, STRAIN = 10e6, 0.3, 0.4, 2e9, -1e-3  # Pa
CORNERS = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]


def vertical_stress(drainage, grains, with_flow_equation=False, **more):
    """Total vertical stress in Pa of a cube under the vertical strain STRAIN, without flow through its sides."""
    part = Kratos.Model().CreateModelPart("soil")
    part.SetBufferSize(2)
    for name in (
        "DISPLACEMENT", "VELOCITY", "ACCELERATION", "REACTION", "VOLUME_ACCELERATION", "WATER_PRESSURE",
        "DT_WATER_PRESSURE", "REACTION_WATER_PRESSURE", "TOTAL_DISPLACEMENT", "INCREMENTAL_DISPLACEMENT",
        "HYDRAULIC_DISCHARGE",
    ):
        part.AddNodalSolutionStepVariable(named(name))
    soil = part.CreateNewProperties(0)
    constants = {
        "YOUNG_MODULUS": YOUNG, "POISSON_RATIO": POISSON, "POROSITY": POROSITY, "BULK_MODULUS_FLUID": FLUID,
        "BULK_MODULUS_SOLID": grains, "BIOT_COEFFICIENT": 1.0, "DENSITY_SOLID": 2650.0, "DENSITY_WATER": 1000.0,
        "DYNAMIC_VISCOSITY": 1e-3, "PERMEABILITY_XX": 1e-15, "PERMEABILITY_YY": 1e-15, "PERMEABILITY_ZZ": 1e-15,
        "PERMEABILITY_XY": 0.0, "PERMEABILITY_YZ": 0.0, "PERMEABILITY_ZX": 0.0, "RETENTION_LAW": "SaturatedLaw",
        "SATURATED_SATURATION": 1.0, "GEO_DRAINAGE_TYPE": drainage,
    }
    for name, value in {**constants, **more}.items():
        soil.SetValue(named(name), value)
    law = Kratos.KratosGlobals.Kernel.GetConstitutiveLaw("GeoIncrementalLinearElastic3DLaw")
    soil.SetValue(Kratos.CONSTITUTIVE_LAW, law.Clone())
    for number, corner in enumerate(CORNERS, 1):
        node = part.CreateNewNode(number, *corner)
        for axis in "XYZ":
            node.AddDof(named(f"DISPLACEMENT_{axis}"), named(f"REACTION_{axis}"))
            node.Fix(named(f"DISPLACEMENT_{axis}"))
        node.AddDof(named("WATER_PRESSURE"), named("REACTION_WATER_PRESSURE"))
        if not with_flow_equation:
            node.Fix(named("WATER_PRESSURE"))
    part.CreateNewElement("UPwSmallStrainElement3D8N", 1, list(range(1, 9)), soil)
    strategy = Kratos.ResidualBasedNewtonRaphsonStrategy(
        part, Geo.BackwardEulerQuasistaticUPwScheme(), Kratos.ResidualCriteria(1e-6, 1e-6),
        Kratos.ResidualBasedBlockBuilderAndSolver(Kratos.SkylineLUFactorizationSolver()), 20, True, False, False,
    )
    strategy.SetEchoLevel(0)
    strategy.Initialize()
    part.CloneTimeStep(1.0)
    part.ProcessInfo[Kratos.DELTA_TIME] = 1.0
    for node in part.Nodes:
        node.SetSolutionStepValue(named("DISPLACEMENT_Z"), STRAIN * node.Z0)
    strategy.InitializeSolutionStep()
    strategy.Predict()
    assert strategy.SolveSolutionStep()
    strategy.FinalizeSolutionStep()
    return sum(node.GetSolutionStepValue(named("REACTION_Z")) for node in part.Nodes if node.Z0 > 0.5)


confined = YOUNG * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON))
skeleton = YOUNG / (3 * (1 - 2 * POISSON))
for grains, seen in ((10e9, -17.628e3), (200e9, -13.667e3)):
    right = STRAIN * (confined + 1 / (POROSITY / FLUID + (1 - POROSITY) / grains))
    drained = vertical_stress("CONSTANT_PW_FIELD", grains)
    coupled = vertical_stress("FULLY_COUPLED", grains, with_flow_equation=True)
    undrained = vertical_stress("UNDRAINED", grains)
    print(f"grains of {grains / 1e9:.0f} GPa: drained {drained / 1e3:.2f} kPa, coupled {coupled / 1e3:.2f} kPa, "
          f"right {right / 1e3:.2f} kPa, undrained {undrained / 1e3:.2f} kPa")
    assert abs(drained / (STRAIN * confined) - 1) < 1e-6 and abs(coupled / right - 1) < 1e-3
    assert abs(undrained / seen - 1) < 1e-3
    # The stiffness that is added is B K / (1 - B), with the modulus of the grains in B.
    wrong = 1 / (1 + POROSITY * grains / FLUID)
    assert abs(undrained / (STRAIN * (confined + skeleton * wrong / (1 - wrong))) - 1) < 1e-6

# With a given B the stiffness is right, up to an undrained Poisson's ratio of 0.495, to which it is cut with a warning.
skempton = 1 / (1 + POROSITY * skeleton / FLUID)
given = vertical_stress("UNDRAINED", 10e9, GEO_SKEMPTON_B=0.95)
assert abs(given / (STRAIN * (confined + skeleton * 0.95 / 0.05)) - 1) < 1e-6
best = vertical_stress("UNDRAINED", 10e9, GEO_SKEMPTON_B=skempton)
ratio = 0.495
shear = YOUNG / (2 * (1 + POISSON))
print(f"GEO_SKEMPTON_B 0.95: {given / 1e3:.2f} kPa, {skempton:.4f} as in this soil: {best / 1e3:.2f} kPa")
assert abs(best / (STRAIN * 2 * shear * (1 - ratio) / (1 - 2 * ratio)) - 1) < 1e-6
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
