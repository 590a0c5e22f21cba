#!/usr/bin/env bash
# KratosGeoMechanicsApplication 10.4.4: the load on undrained soil makes it stronger at once, as if it were drained.
#
# Expected: with `GEO_DRAINAGE_TYPE` "UNDRAINED" the water takes a load that comes from all sides, and the strength by
#     `GEO_FRICTION_ANGLE` and `GEO_COHESION`, which belong to effective stress, stays, as in "FULLY_COUPLED" without
#     flow.
# Seen: 30 degrees, 10 kPa, no dilatancy, an undrained Poisson's ratio of 0.495, one cube under a cell pressure, then
#     sheared without change of volume.  Coupled, the deviator at failure is 20.9, 21.0 and 21.3 kPa under 50, 100 and
#     200 kPa, the values of the closed form.  "UNDRAINED": 80.8, 140.8 and 260.8 kPa.  `CAUCHY_STRESS_TENSOR`, the
#     effective stress, contains the whole cell pressure, `WATER_PRESSURE` is zero.  No message.
# Meaning: the stiffness of the water is put into the elastic matrix of the skeleton, and Mohr and Coulomb see its
#     pressure as stress between grains.  Dams and footings on soft clay are safe by the weight that should bring them
#     down.  Use "FULLY_COUPLED" with a small permeability, or an angle of zero with the undrained strength.
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
import numpy as np
from KratosMultiphysics import StructuralMechanicsApplication  # noqa: F401

Kratos.Logger.GetDefaultOutput().SetSeverity(Kratos.Logger.Severity.WARNING)
named = Kratos.KratosGlobals.GetVariable
YOUNG, POISSON, POROSITY, FLUID, GRAINS = 10e6, 0.3, 0.4, 2e9, 10e9  # Pa
COHESION, ANGLE, RATIO = 10e3, 30.0, 0.495
CORNERS = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]


def triaxial(drainage, volume):
    """Total mean stress, deviator and effective mean stress in Pa of a cube after compression and shear."""
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
        "BULK_MODULUS_SOLID": GRAINS, "BIOT_COEFFICIENT": 1.0, "DENSITY_SOLID": 2650.0, "DENSITY_WATER": 1000.0,
        "DYNAMIC_VISCOSITY": 1e-3, "PERMEABILITY_XX": 1e-15, "PERMEABILITY_YY": 1e-15, "PERMEABILITY_ZZ": 1e-15,
        "PERMEABILITY_XY": 0.0, "PERMEABILITY_YZ": 0.0, "PERMEABILITY_ZX": 0.0, "RETENTION_LAW": "SaturatedLaw",
        "SATURATED_SATURATION": 1.0, "GEO_DRAINAGE_TYPE": drainage, "GEO_COHESION": COHESION,
        "GEO_FRICTION_ANGLE": ANGLE, "GEO_DILATANCY_ANGLE": 0.0, "GEO_TENSILE_STRENGTH": 17e3,
        "GEO_COULOMB_HARDENING_TYPE": "None", "GEO_POISSON_UNDRAINED": RATIO,
    }
    for name, value in constants.items():
        soil.SetValue(named(name), value)
    law = Kratos.KratosGlobals.Kernel.GetConstitutiveLaw("GeoMohrCoulombWithTensionCutOff3D")
    soil.SetValue(Kratos.CONSTITUTIVE_LAW, law.Clone())
    for number, corner in enumerate(CORNERS, 1):
        node = part.CreateNewNode(number, *corner)
        for axis in "XYZ":
            node.AddDof(named(f"DISPLACEMENT_{axis}"), named(f"REACTION_{axis}"))
            node.Fix(named(f"DISPLACEMENT_{axis}"))
        node.AddDof(named("WATER_PRESSURE"), named("REACTION_WATER_PRESSURE"))
        if drainage != "FULLY_COUPLED":
            node.Fix(named("WATER_PRESSURE"))
    cube = part.CreateNewElement("UPwSmallStrainElement3D8N", 1, list(range(1, 9)), soil)
    strategy = Kratos.ResidualBasedNewtonRaphsonStrategy(
        part, Geo.BackwardEulerQuasistaticUPwScheme(), Kratos.ResidualCriteria(1e-6, 1e-6),
        Kratos.ResidualBasedBlockBuilderAndSolver(Kratos.SkylineLUFactorizationSolver()), 20, True, False, False,
    )
    strategy.SetEchoLevel(0)
    strategy.Initialize()
    for step in range(1, 31):
        part.CloneTimeStep(float(step))
        part.ProcessInfo[Kratos.DELTA_TIME] = 1.0
        shear = 0.03 * max(step - 10, 0) / 20
        alike = -volume / 3 * min(step, 10) / 10
        for node in part.Nodes:
            for axis, place, share in zip("XYZ", (node.X0, node.Y0, node.Z0), (0.5, 0.5, -1.0)):
                node.SetSolutionStepValue(named(f"DISPLACEMENT_{axis}"), (alike + share * shear) * place)
        strategy.InitializeSolutionStep()
        strategy.Predict()
        assert strategy.SolveSolutionStep()
        strategy.FinalizeSolutionStep()
    total = [
        sum(
            node.GetSolutionStepValue(named(f"REACTION_{axis}"))
            for node in part.Nodes if getattr(node, f"{axis}0") > 0.5
        )
        for axis in "XYZ"
    ]
    effective = np.array(cube.CalculateOnIntegrationPoints(named("CAUCHY_STRESS_TENSOR"), part.ProcessInfo)[0])
    return -sum(total) / 3, total[0] - total[2], -np.trace(effective) / 3


sine, cosine = np.sin(np.radians(ANGLE)), np.cos(np.radians(ANGLE))
skeleton = YOUNG / (3 * (1 - 2 * POISSON))
water = 1 / (POROSITY / FLUID + (1 - POROSITY) / GRAINS)
undrained = YOUNG / (2 * (1 + POISSON)) * 2 * (1 + RATIO) / (3 * (1 - 2 * RATIO))


def strength(mean):
    """Deviator in Pa at failure in triaxial compression under an effective mean stress."""
    return 6 * (COHESION * cosine + mean * sine) / (3 - sine)


for cell in (50e3, 100e3, 200e3):
    volume = cell / (skeleton + water)
    mean, coupled, effective = triaxial("FULLY_COUPLED", volume)
    assert abs(mean / cell - 1) < 1e-3 and abs(effective / (skeleton * volume) - 1) < 1e-3
    right = strength(skeleton * volume)
    mean, found, effective = triaxial("UNDRAINED", cell / undrained)
    assert abs(mean / cell - 1) < 1e-3 and abs(effective / cell - 1) < 1e-3
    print(f"{cell / 1e3:.0f} kPa: coupled {coupled / 1e3:.2f} kPa, right {right / 1e3:.2f} kPa, "
          f"undrained {found / 1e3:.2f} kPa, drained under the cell pressure {strength(cell) / 1e3:.2f} kPa")
    assert abs(coupled / right - 1) < 1e-3 and abs(found / strength(cell) - 1) < 1e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
