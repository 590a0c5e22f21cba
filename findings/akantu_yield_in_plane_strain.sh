#!/usr/bin/env bash
# akantu 5.0.7.post1: clay of the von Mises criterion in plane strain fails under confined compression.
#
# Expected: `plastic_linear_isotropic_hardening` in a model of dimension 2, which is plane strain unless it says
#     otherwise, gives the stresses of a slice of bricks: the stress across the plane counts in the criterion.
# Seen: one element of 1 m (E = 10 MPa, nu = 0.3, yield stress 100 kPa, no hardening), compressed vertically by 4 %.
#     Free at its side: 100.5 kPa, right is 115.5 kPa, 2 / sqrt(3) of the yield stress, as one brick
#     gives.  Confined: 117.4 kPa, constant from 1 % on; right is 400 kPa and rising with the bulk modulus, as the
#     brick gives.  Elastic stresses are right.  No message.
# Meaning: the trial stress has no component across the plane, so a pressure in the plane counts as a deviator.
#     Undrained clay yields in its initial state and under any wide load; it settles without limit where it cannot
#     fail, and its strength is 13 % too small where it can.  Use a slice of bricks.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    akantu==5.0.7.post1 numpy==2.4.6
cat > run.py <<'PY'
import akantu
import numpy as np

YOUNG, POISSON, YIELD = 10e3, 0.3, 100.0  # kPa
SHEAR, BULK = YOUNG / (2 * (1 + POISSON)), YOUNG / (3 * (1 - 2 * POISSON))
CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))
# dimension: type of the element for gmsh and for akantu
ELEMENTS = {2: (3, akantu._quadrangle_4), 3: (5, akantu._hexahedron_8)}

with open("clay.dat", "w") as file:
    file.write(
        "material plastic_linear_isotropic_hardening [\n"
        f"  name = clay\n  rho = 2\n  E = {YOUNG}\n  nu = {POISSON}\n  sigma_y = {YIELD}\n  h = 0\n]\n"
    )
akantu.parseInput("clay.dat")


def element(dimension):
    """Mesh of one square or cube of 1 m."""
    nodes = [(x, y, z) for z in range(dimension - 1) for x, y in CORNERS]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(nodes))]
    lines += [f"{number} {x} {y} {z}" for number, (x, y, z) in enumerate(nodes, 1)]
    corners = " ".join(str(number) for number in range(1, len(nodes) + 1))
    lines += ["$EndNodes", "$Elements", "1", f"1 {ELEMENTS[dimension][0]} 2 1 1 {corners}", "$EndElements"]
    name = f"element_{dimension}.msh"
    with open(name, "w") as file:
        file.write("\n".join(lines) + "\n")
    mesh = akantu.Mesh(dimension)
    mesh.read(name)
    return mesh


def pressures(dimension, confined):
    """Vertical pressure in kPa at a compression of 0.5, 1, ... 4 %, in steps of 0.1 %."""
    mesh = element(dimension)
    model = akantu.SolidMechanicsModel(mesh)
    model.initFull(_analysis_method=akantu._static)
    x, y = np.array(mesh.getNodes()).T[:2]
    displacements, blocked = model.getDisplacement(), model.getBlockedDOFs()
    blocked[:, 1] = True
    blocked[(x == 0) | confined, 0] = True
    if dimension == 3:
        blocked[:, 2] = True
    solver = model.getNonLinearSolver()
    solver.set("max_iterations", 200)
    solver.set("threshold", 1e-9)
    solver.set("convergence_type", akantu.SolveConvergenceCriteria.residual)
    vertical = dimension + 1  # column of the stress, counted row by row
    result = []
    for step in range(1, 41):
        displacements[y == 1, 1] = -1e-3 * step
        model.solveStep()
        stress = np.array(model.getMaterial(0).getStress(ELEMENTS[dimension][1]))
        result.append(-stress[:, vertical].mean())
    return np.array(result[4::5])


# yield of confined compression at a difference of stresses of 2 G eps = YIELD, then the bulk modulus
strain = 0.005 * np.arange(1, 9)
first = YIELD / (2 * SHEAR)
oedometer = np.where(strain < first, (BULK + 4 / 3 * SHEAR) * strain, BULK * strain + 2 / 3 * YIELD)
for confined, name in ((False, "free"), (True, "confined")):
    plane, brick = pressures(2, confined), pressures(3, confined)
    print(f"{name}: plane strain {np.round(plane, 2)}, brick {np.round(brick, 2)} kPa")
    assert abs(plane[0] - brick[0]) < 1e-4 * plane[0]
    if confined:
        print(f"right: {np.round(oedometer, 2)} kPa")
        assert np.allclose(brick, oedometer, rtol=1e-4)
        assert np.allclose(plane[3:], 117.3, atol=0.2)
    else:
        print(f"right: at most {2 / np.sqrt(3) * YIELD:.2f} kPa")
        assert abs(brick[-1] - 2 / np.sqrt(3) * YIELD) < 0.05
        assert np.allclose(plane[1:], 100.44, atol=0.1)
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
