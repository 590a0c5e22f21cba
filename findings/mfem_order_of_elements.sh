#!/usr/bin/env bash
# mfem 4.10.0.1 (PyMFEM): the lower half of a box is its left half, and clay lets 250 times the water through.
#
# Expected: the elements of `Mesh.MakeCartesian2D` are counted row by row from below, as its nodes are, so that the
#     first 32 of 8 x 8 elements are the lower layer.
# Seen: a block of 1 m x 1 m under a head of 1 m, the first half of the elements clay of 1e-8 m/s, the other half sand
#     of 1e-5 m/s.  Discharge with 4 x 4, 8 x 8 and 16 x 16 elements: 5.0e-6 m2/s in place of 2.0e-8 m2/s: the clay is
#     the left half, beside the sand.  The same in a cube of 8 x 8 x 8 elements.  The nodes are counted row by
#     row.  With `sfc_ordering=False`, the last argument, 2.0e-8 m2/s; the constructor `Mesh(...)` has the same last
#     argument, and pays no attention to it.  No message.
# Meaning: elements follow a space-filling curve by default.  Layers, stages of excavation and fields that are given
#     by the number of the element are in other places, though areas and numbers of elements of each soil are
#     right.  Set attributes by the centre of the element, or switch the curve off.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    mfem==4.10.0.1 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import mfem.ser as mfem  # codespell:ignore ser
import numpy as np

CLAY, SAND = 1e-8, 1e-5  # m/s
PERMEABILITY = mfem.PWConstCoefficient(mfem.Vector([CLAY, SAND]))
ONE = mfem.ConstantCoefficient(1.0)
# dimension: function that makes a box, its element, and the attributes of its lower and upper side
BOXES = {
    2: (mfem.Mesh.MakeCartesian2D, mfem.Element.QUADRILATERAL, 1, 3),
    3: (mfem.Mesh.MakeCartesian3D, mfem.Element.HEXAHEDRON, 1, 6),
}


def block(count, dimension, by_rows):
    """Block of side 1 m with the first half of its elements in clay, and the centres of the clay."""
    make, element, _, _ = BOXES[dimension]
    edges = [True] if dimension == 2 else []
    order = [False] if by_rows else []
    mesh = make(*[count] * dimension, element, *edges, *[1.0] * dimension, *order)
    nodes = np.array([list(mesh.GetVertexArray(node)) for node in range(mesh.GetNV())])
    # nodes row by row
    rows = np.arange(count + 1) / count
    grid = np.meshgrid(*[rows] * dimension, indexing="ij")
    assert np.allclose(nodes, np.transpose([axis.ravel() for axis in reversed(grid)]))
    clay = range(mesh.GetNE() // 2)
    for number in range(mesh.GetNE()):
        mesh.SetAttribute(number, 1 if number in clay else 2)
    mesh.SetAttributes()
    return mesh, np.array([nodes[list(mesh.GetElementVertices(number))].mean(axis=0) for number in clay])


def flow(space):
    """Form of the flow of water."""
    form = mfem.BilinearForm(space)
    form.AddDomainIntegrator(mfem.DiffusionIntegrator(PERMEABILITY))
    form.Assemble()
    form.Finalize()
    return form


def discharge(mesh, dimension):
    """Discharge under a head of 1 m on the upper side, and none on the lower one."""
    collection = mfem.H1_FECollection(1, dimension)
    space = mfem.FiniteElementSpace(mesh, collection)
    _, _, lower, upper = BOXES[dimension]
    marker = mfem.intArray(2 * dimension)
    marker.Assign(0)
    marker[upper - 1] = 1
    head = mfem.GridFunction(space)
    head.Assign(0.0)
    head.ProjectBdrCoefficient(ONE, marker)
    marker[lower - 1] = 1
    given = mfem.intArray()
    space.GetEssentialTrueDofs(marker, given)
    load = mfem.LinearForm(space)
    load.Assemble()
    form = flow(space)
    matrix, right, solution = mfem.SparseMatrix(), mfem.Vector(), mfem.Vector()
    form.FormLinearSystem(given, head, load, matrix, solution, right)
    solver = mfem.CGSolver()
    solver.SetRelTol(1e-12)
    solver.SetMaxIter(5000)
    smoother = mfem.GSSmoother(matrix)
    solver.SetPreconditioner(smoother)
    solver.SetOperator(matrix)
    solver.Mult(right, solution)
    form.RecoverFEMSolution(solution, load, head)
    # the dissipated power is the discharge times the head of 1 m
    return flow(space).InnerProduct(head, head)


layers, columns = 1 / (0.5 / CLAY + 0.5 / SAND), 0.5 * (CLAY + SAND)
for count, dimension in ((4, 2), (8, 2), (16, 2), (8, 3)):
    for by_rows in (False, True):
        mesh, clay = block(count, dimension, by_rows)
        found = discharge(mesh, dimension)
        ranges = ", ".join(f"{low:.2f} to {high:.2f}" for low, high in zip(clay.min(axis=0), clay.max(axis=0)))
        print(f"{count} elements a side, {dimension} dimensions, {'by rows' if by_rows else 'default'}: "
              f"{found:.3e}, right {layers:.3e}; centres of the clay {ranges}")
        assert np.isclose(found, layers if by_rows else columns, rtol=1e-6)


def numbers(mesh):
    """Nodes of all elements."""
    return [list(mesh.GetElementVertices(number)) for number in range(mesh.GetNE())]


orders = [numbers(mfem.Mesh(4, 4, "QUADRILATERAL", True, 1.0, 1.0, by_curve)) for by_curve in (True, False)]
assert orders[0] == orders[1] == numbers(block(4, 2, False)[0])
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
