"""Half of a block of weightless clay below a rigid tool, for examples that push a tool into it."""

import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshQuad

import skfem_contact as sc


def sizes(h, centre, radius):
    """Return the size of elements: h within a radius of a point of the axis, then growing."""

    def size(x):
        return h + 0.3 * np.maximum(0.0, np.hypot(x[0], x[1] - centre) - radius)

    return size


def model_of(mesh, clay, tool, *contact, coordinates="plane"):
    """Return a model: the tool stays and the bottom moves up; `contact` has law and penalty."""
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
    forms = {
        "clay": sc.SolidForm(basis, clay, kinematics="finite", coordinates=coordinates),
        "tool": sc.ContactPair(basis, "top", tool, *contact),
    }
    sides = [basis.get_dofs(name).all("u^1") for name in ("left", "right")]
    return sc.Model(forms, np.concatenate([basis.get_dofs("bottom").all(), *sides]))


def bottom_of(forms):
    """Return the vertical dofs of the bottom."""
    return forms["clay"].basis.get_dofs("bottom").all("u^2")


def pushed(build, size, wide, deep, way, n, every=5):
    """Return the result of n stages, in each of which the bottom moves up by `way`.

    Five increments of a stage are a fifth of an element or less each: Newton's method has no
    equilibrium for the whole stage, and would find that out in each of them.

    The first mesh has elements of `size`. The run makes a new one after `every` stages and
    continues by itself, with the stresses and the contact of the last mesh.
    """
    block = MeshQuad.init_tensor(np.linspace(0, wide, 6), np.linspace(-deep, 0, 5))
    at_rest = build(block.to_meshtri().with_defaults()).run([sc.Stage("at rest")])[-1]
    model = build(sc.remeshed(at_rest, size).mesh)
    stages = []
    for k in range(1, n + 1):
        u = np.zeros(model.layout.size)
        u[bottom_of(model.forms)] = k * way
        stages.append(sc.Stage(f"w = {k * way:.2f}", prescribed=u, increments=3))
    return model.run(stages, remesh=sc.Remeshing(build, size, every=every))


def stages_of(result):
    """Return the stages in which the bottom moves up, without the new meshes between them."""
    return [stage for stage in result if stage.name.startswith("w")]


def force_of(stage):
    """Return the reaction of the bottom; in axial symmetry it belongs to one radian."""
    return stage.reactions()[bottom_of(stage.forms)].sum()


def surface_of(stage):
    """Return the deformed nodes of the top, (2, n), from the axis outwards."""
    basis = stage.forms["clay"].basis
    dofs = basis.get_dofs("top")
    components = (dofs.all("u^1"), dofs.all("u^2"))
    x = np.array([basis.doflocs[k, d] + stage.x[d] for k, d in enumerate(components)])
    return x[:, np.argsort(x[0])]


def losses_of(result):
    """Return the largest relative loss of volume, and of stress, at a new mesh."""
    meshes = [stage for stage in result if stage.name.startswith("mesh")]
    return np.max([stage.series["loss"] for stage in meshes], axis=0)
