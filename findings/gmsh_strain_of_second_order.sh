#!/usr/bin/env bash
# gmsh 4.15.2: undrained clay changes its volume in the plugin Divergence, and bending is a sawtooth.
#
# Expected: the plugins Gradient and Divergence differentiate the field as it is, with the midside nodes
#     of second-order elements, as `view.probe(..., gradient=True)` of the same view does.
# Seen: pure bending at constant volume, u = (x y, -(x2 + y2) / 2), lies exactly in second-order elements.
#     The probe finds the strain y and the volumetric strain 0.  Divergence finds up to 0.13 where the
#     largest strain is 0.5, and Gradient strains that are wrong by up to 0.26.  The results are those of
#     first-order elements on the same mesh, to the last digit.  No message.
# Meaning: strains, hydraulic gradients and volume changes of a second-order analysis, made in the
#     program that made the mesh, are as bad as if it were of first order, with one element over the
#     thickness at worst.  Use the probe, or write strains of the analysis into the file.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    gmsh==4.15.2 numpy==2.4.6
cat > run.py <<'PY'
import gmsh
import numpy as np

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
POINTS = [(x, y) for x in np.linspace(0.1, 3.9, 20) for y in (-0.4, -0.1, 0.2, 0.45)]


def apply(plugin, view):
    """View that a plugin makes of another one."""
    gmsh.plugin.setNumber(plugin, "View", gmsh.view.getIndex(view))
    return gmsh.plugin.run(plugin)


def strains(order):
    """Longitudinal and volumetric strain at the points, by the probe and by the plugins."""
    gmsh.clear()
    gmsh.model.occ.addRectangle(0, -0.5, 0, 4, 1)
    gmsh.model.occ.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
    gmsh.option.setNumber("Mesh.ElementOrder", order)
    gmsh.model.mesh.generate(2)
    nodes, places, _ = gmsh.model.mesh.getNodes()
    x, y, _ = places.reshape(-1, 3).T
    values = np.column_stack([x * y, -(x**2 + y**2) / 2, 0 * x])
    view = gmsh.view.add("displacement")
    gmsh.view.addHomogeneousModelData(
        view, 0, gmsh.model.getCurrent(), "NodeData", nodes, values.ravel(), 0, 3
    )
    gradient, divergence = apply("Gradient", view), apply("Divergence", view)
    found = []
    for point in POINTS:
        probe = gmsh.view.probe(view, *point, 0, gradient=True)[0]
        slope = gmsh.view.probe(gradient, *point, 0)[0]
        found.append([probe[0], probe[0] + probe[4], slope[0], gmsh.view.probe(divergence, *point, 0)[0][0]])
    return np.array(found).T


levels = np.array([y for _, y in POINTS])
linear, quadratic = strains(1), strains(2)
error, volume = abs(quadratic[2] - levels).max(), abs(quadratic[3]).max()
print(f"probe: errors of the strain {abs(quadratic[0] - levels).max():.1e}, "
      f"of the volumetric strain {abs(quadratic[1]).max():.1e}")
print(f"plugins: error of the strain {error:.3f}, volumetric strain {volume:.3f}, right 0")
print(f"difference of the plugins to first order: {abs(quadratic[2:] - linear[2:]).max():.1e}")
assert np.allclose(quadratic[0], levels) and np.allclose(quadratic[1], 0, atol=1e-9)
assert error > 0.1 and volume > 0.1
assert np.allclose(quadratic[2:], linear[2:], atol=1e-12)
gmsh.finalize()
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
