"""Contact of a surface with itself: neighbours, balance, tangent and folded bodies."""

import pickle

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementHex1,
    ElementQuad1,
    ElementTriP2,
    ElementVector,
    MeshHex,
    MeshQuad,
)

import skfem_contact as sc

ARM, BEND, INNER, THICK = 3.0, 12, 0.3, 0.25  # arms, elements of the bend, radius and thickness


def hairpin(n_arm=12, layers=2):
    """Return a strip of two arms along x and a bend; its chain is anticlockwise."""
    n = 2 * n_arm + BEND
    grid = MeshQuad.init_tensor(np.linspace(0, 1, n + 1), np.linspace(0, 1, layers + 1))
    k = np.rint(grid.p[0] * n)
    radius = INNER + THICK * grid.p[1]
    angle = np.pi / 2 + np.pi * np.clip((k - n_arm) / BEND, 0, 1)
    x = radius * np.cos(angle)
    y = radius * np.sin(angle)
    x[k < n_arm] = ARM * (1 - k[k < n_arm] / n_arm)
    x[k > n - n_arm] = ARM * (k[k > n - n_arm] - n + n_arm) / n_arm
    turned = MeshQuad(np.stack((x, y)), grid.t[[0, 3, 2, 1]])
    mesh = turned.with_boundaries(
        {
            "upper": lambda x: (x[0] > 2.0) & (x[1] > INNER + THICK - 1e-9),
            "lower": lambda x: (x[0] > 2.0) & (x[1] < -INNER - THICK + 1e-9),
        }
    )
    return mesh.with_boundaries({"skin": mesh.boundary_facets()})


def strip(mesh=None, mu=0.0, element=None, material=None, **settings):
    """Return basis and model of a hairpin that touches itself."""
    mesh = hairpin() if mesh is None else mesh
    basis = Basis(mesh, ElementVector(element or ElementQuad1()), intorder=2)
    law = sc.NeoHooke(E=100.0, nu=0.3) if material is None else material
    forms = {
        "strip": sc.SolidForm(basis, law, kinematics="finite"),
        "fold": sc.ContactPair(basis, "skin", "skin", sc.Coulomb(mu=mu), **settings),
    }
    ends = [basis.get_dofs(name).all() for name in ("upper", "lower")]
    return basis, sc.Model(forms, np.concatenate(ends))


def pinched(basis, gap):
    """Return displacements that leave a gap between the arms' ends."""
    u = np.zeros(basis.N)
    u[basis.get_dofs("upper").all("u^2")] = 0.5 * gap - INNER
    u[basis.get_dofs("lower").all("u^2")] = INNER - 0.5 * gap
    return u


def overlapping(basis, seed=0):
    """Return displacements by which the arms overlap by a fifth of a facet, with some noise."""
    x, y = basis.doflocs[:, 0::2]
    u = np.zeros((2, basis.N // 2))
    u[1] = -np.sign(y) * np.clip(x, 0, 1) * (INNER + 0.02)
    noise = np.random.default_rng(seed).uniform(-1, 1, u.shape)
    return (u + 0.01 * noise).T.ravel()


def total(basis, x, force):
    """Return resultant and moment of forces at displaced nodes."""
    f = force.reshape(-1, 2)
    at = basis.doflocs[:, 0::2].T + x.reshape(-1, 2)
    return np.array([*f.sum(axis=0), (at[:, 0] * f[:, 1] - at[:, 1] * f[:, 0]).sum()])


def test_neighbours_by_distance_along_the_surface():
    """[N] Facets are neighbours where nodes are within reach along the chain, by sums of sides."""
    _, model = strip()
    pair = model.forms["fold"]
    surface = pair.slave
    n = len(surface.facets)
    start = np.concatenate(([0.0], np.cumsum(surface.area)))
    length = start[-1]
    reach = 3.0 * np.maximum(surface.size, surface.spacing)
    for i in range(n):
        for j in range(n):
            ends = np.abs(np.subtract.outer(start[i : i + 2], start[j : j + 2]))
            apart = np.minimum(ends, length - ends).min()
            of_nodes = max(reach[i], reach[i - 1], reach[(i + 1) % n])
            found = pair.interface.fold.adjoins(np.array([i]), np.array([j]))[0]
            if apart <= reach[i] - 1e-9:
                assert found
            if apart > of_nodes + 1e-9:
                assert not found


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_closest_points_are_those_of_all_facets_that_are_no_neighbours(seed):
    """[N] The search agrees with the distances of all facets, one by one."""
    basis, model = strip()
    pair = model.forms["fold"]
    x = overlapping(basis, seed)
    found = pair.interface.closest(x, np.zeros(0))
    copied = pickle.loads(pickle.dumps(pair))
    np.testing.assert_array_equal(copied.interface.closest(x, np.zeros(0)).gap, found.gap)
    slave, nodes = pair.interface.positions(x)
    points = pair.interface.points(np.zeros(0))
    at = points.positions(slave)
    a, b = nodes[pair.master.facets].transpose(1, 0, 2)
    share = ((at[:, None] - a) * (b - a)).sum(axis=2) / ((b - a) ** 2).sum(axis=1)
    foot = a + np.clip(share, 0, 1)[:, :, None] * (b - a)
    distance = np.linalg.norm(at[:, None] - foot, axis=2)
    n, m = distance.shape
    own, facet = np.repeat(points.facet, m), np.tile(np.arange(m), n)
    distance[pair.interface.fold.adjoins(own, facet).reshape(n, m)] = np.inf
    assert found.found.sum() > 100
    closest = distance.min(axis=1)[found.found]
    assert np.abs(found.gap[found.found]) == pytest.approx(closest, abs=1e-12)


@pytest.mark.parametrize("mu", [0.0, 0.3])
@pytest.mark.parametrize("enforcement", [None, sc.AugmentedLagrangian()], ids=["penalty", "aug"])
def test_forces_are_in_balance(mu, enforcement):
    """[X] A surface that touches itself has no resultant and, at its gaps, no moment."""
    basis, model = strip(mu=mu, enforcement=enforcement)
    pair = model.forms["fold"]
    x = overlapping(basis)
    state = pair.assemble(x, pair.initial_state()).state
    moved = x + 1e-3 * np.tile(np.sign(basis.doflocs[1, 1::2]), (2, 1)).T.ravel()
    response = pair.assemble(moved, state)
    force = response.force
    size = np.abs(force).sum()
    assert size > 1.0
    resultant = total(basis, moved, force)
    assert np.abs(resultant[:2]).max() < 1e-13 * size
    if mu == 0.0:
        assert abs(resultant[2]) < 1e-12 * size


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_tangent(mu):
    """[N] The tangent agrees with central differences of the force."""
    basis, model = strip(mu=mu)
    pair = model.forms["fold"]
    x = overlapping(basis)
    state = pair.assemble(x, pair.initial_state()).state
    x = x + 1e-3 * np.random.default_rng(1).uniform(-1, 1, basis.N)
    K = pair.assemble(x, state).stiffness
    way = np.random.default_rng(2).uniform(-1, 1, basis.N)
    step = 1e-7
    after, before = (pair.assemble(x + s * way, state).force for s in (step, -step))
    difference = (after - before) / (2 * step)
    assert np.abs(K @ way - difference).max() < 1e-6 * np.abs(difference).max()


def test_frictionless_forces_are_the_gradient_of_their_energy():
    """[X] Both walls have half of the penalty times the square of the penetration over two."""
    basis, model = strip()
    pair = model.forms["fold"]
    start = pair.initial_state()
    weight = pair.points(start).weight

    def energy(x):
        state = pair.assemble(x, start).state
        depth = np.where(state.status > 0, state.gap, 0.0)
        return 0.25 * pair.penalty[0] * weight @ depth**2

    x = overlapping(basis)
    way = np.random.default_rng(2).uniform(-1, 1, basis.N)
    step = 1e-6
    slope = (energy(x + step * way) - energy(x - step * way)) / (2 * step)
    assert pair.assemble(x, start).force @ way == pytest.approx(slope, rel=1e-7)


def test_fold_and_unfold():
    """[X] A folded elastic strip without friction is as before once it is open again."""
    basis, model = strip()
    gaps = (0.3, 0.1, 0.01, -0.005, 0.02, 0.2, 2 * INNER)
    result = model.run([sc.Stage(f"{gap}", prescribed=pinched(basis, gap)) for gap in gaps])
    assert (result["-0.005"].states["fold"].status > 0).sum() > 10
    assert np.abs(result[-1].x).max() < 1e-9
    end = basis.get_dofs("upper").all()
    reaction = [np.abs(stage.reactions()[end]).max() for stage in result]
    assert reaction[-1] < 1e-9 * max(reaction)
    for stage in result:
        forces = sum(
            model.forms["fold"].enforcement.nodal_forces(
                model.forms["fold"], stage.x, stage.states["fold"]
            )
        )
        assert np.abs(total(basis, stage.x, forces)).max() <= 1e-9 * np.abs(forces).sum()
        assert np.abs(total(basis, stage.x, stage.reactions())).max() < 1e-9 * max(reaction)


def ring(half):
    """Return basis, model and dofs above of a tube between plates, or of its half on a plane."""
    low = -np.pi / 2 if half else 0.0
    n = 28 if half else 14
    grid = MeshQuad.init_tensor(np.linspace(1.0, 1.25, 3), np.linspace(low, np.pi / 2, n + 1))
    grid = grid.with_defaults()
    p = np.stack((grid.p[0] * np.cos(grid.p[1]), grid.p[0] * np.sin(grid.p[1])))
    tube = MeshQuad(p, grid.t, _boundaries=grid.boundaries)
    plate = MeshQuad.init_tensor(np.linspace(0, 2.0, 10), np.linspace(0, 0.25, 2)).with_defaults()
    parts = {"tube": tube, "above": plate.translated((0.0, 1.25))}
    if half:
        parts["below"] = plate.translated((0.0, -1.5))
    basis = Basis(sc.join_bodies(parts), ElementVector(ElementQuad1()), intorder=2)
    law = sc.Coulomb(mu=0.0)
    solids = dict.fromkeys(parts, sc.NeoHooke(E=1000.0, nu=0.3))
    solids["tube"] = sc.NeoHooke(E=10.0, nu=0.4)
    forms = {
        "body": sc.SolidForm(basis, solids, kinematics="finite"),
        "above": sc.ContactPair(basis, "tube:right", "above:bottom", law, 5),
    }
    dofs = basis.get_dofs
    fixed = [dofs("above:top").all(), dofs(lambda x: np.abs(x[0]) < 1e-9).all("u^1")]
    if half:
        forms["below"] = sc.ContactPair(basis, "tube:right", "below:top", law, 5)
        forms["inside"] = sc.ContactPair(basis, "tube:left", "tube:left", law, penalty=1e3)
        fixed.append(dofs("below:bottom").all())
    else:
        plane = sc.rigid.line((-1.0, 0.0), (3.0, 0.0))
        forms["inside"] = sc.ContactPair(basis, "tube:left", plane, law, 5, 2e3)
        fixed.append(dofs("tube:bottom").all("u^2"))
    return basis, sc.Model(forms, np.unique(np.concatenate(fixed)))


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
def test_crushed_ring_as_its_half_on_the_plane_of_symmetry():
    """[N] A rigid plane is touched at half of the gap, so with twice the penalty: no self-contact.

    The gap to a facet opposite counts along its normal, which is vertical to 1e-2 at most.
    """
    forces = []
    for half in (True, False):
        basis, model = ring(half)
        stages = []
        for way in (0.5, 0.8, 0.95, 1.0, 1.03):
            u = np.zeros(basis.N)
            u[basis.get_dofs("above:top").all("u^2")] = -way
            if half:
                u[basis.get_dofs("below:bottom").all("u^2")] = way
            stages.append(sc.Stage(f"{way}", prescribed=u))
        result = model.run(stages)
        above = basis.get_dofs("above:top").all("u^2")
        forces.append(np.array([stage.reactions()[above].sum() for stage in result]))
        assert (result[-1].states["inside"].status > 0).mean() > 0.4
    assert forces[1][-1] < 4.0 * forces[1][-3] < 0.0
    assert forces[0] == pytest.approx(forces[1], rel=1e-4)


def test_fold_in_space_as_in_the_plane():
    """[N] One row of elements between planes of symmetry is in plane strain."""
    flat = hairpin()
    basis, model = strip(flat, penalty=5e3)
    gaps = (0.1, -0.01)
    plane = model.run([sc.Stage(f"{g}", prescribed=pinched(basis, g)) for g in gaps])
    depth = 0.2
    mesh = _extruded(flat, depth)
    space = Basis(mesh, ElementVector(ElementHex1()), intorder=2)
    forms = {
        "strip": sc.SolidForm(space, sc.NeoHooke(E=100.0, nu=0.3), kinematics="finite"),
        "fold": sc.ContactPair(space, "skin", "skin", sc.Coulomb(mu=0.0), 5, 5e3),
    }
    ends = [space.get_dofs(name).all() for name in ("upper", "lower")]
    sides = np.arange(2, space.N, 3)
    stages = []
    for gap in gaps:
        u = np.zeros(space.N)
        u[space.get_dofs("upper").all("u^2")] = 0.5 * gap - INNER
        u[space.get_dofs("lower").all("u^2")] = INNER - 0.5 * gap
        stages.append(sc.Stage(f"{gap}", prescribed=u))
    result = sc.Model(forms, np.unique(np.concatenate([*ends, sides]))).run(stages)
    for a, b in zip(plane, result, strict=True):
        force = a.reactions()[basis.get_dofs("upper").all("u^2")].sum() * depth
        found = b.reactions()[space.get_dofs("upper").all("u^2")].sum()
        assert found == pytest.approx(force, rel=1e-6)


def _extruded(flat, depth):
    n = flat.p.shape[1]
    p = np.concatenate((flat.p, flat.p), axis=1)
    z = np.repeat([0.0, depth], n)
    # scikit-fem's hexahedra: node 0 and its neighbours along x, y, z, then those opposite
    a, b, c, d = flat.t
    t = np.stack((a, d, b, a + n, c, d + n, b + n, c + n))
    mesh = MeshHex(np.vstack((p, z)), t)
    mesh = mesh.with_boundaries(
        {
            "upper": lambda x: (x[0] > 2.0) & (x[1] > INNER + THICK - 1e-9),
            "lower": lambda x: (x[0] > 2.0) & (x[1] < -INNER - THICK + 1e-9),
        }
    )
    facets = mesh.boundary_facets()
    middle = mesh.p[2, mesh.facets[:, facets]].mean(axis=0)
    return mesh.with_boundaries({"skin": facets[np.abs(middle - depth / 2) < 1e-9]})


def test_thin_wall_does_not_touch_its_own_back():
    """[X] A flat strip of one element of unit shape, bent or not, has no contact with itself."""
    mesh = MeshQuad.init_tensor(np.linspace(0, 10, 41), np.linspace(0, 0.25, 2))
    mesh = mesh.with_boundaries({"skin": mesh.boundary_facets()})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    pair = sc.ContactPair(basis, "skin", "skin", sc.Coulomb(mu=0.0), penalty=1.0)
    angle = basis.doflocs[0, 0::2] / 10.0 * 1.5 * np.pi
    radius = 10.0 / (1.5 * np.pi) - basis.doflocs[1, 0::2]
    bent = np.stack((radius * np.sin(angle), -radius * np.cos(angle)), axis=1)
    for x in (np.zeros(basis.N), (bent - basis.doflocs[:, 0::2].T).ravel()):
        state = pair.assemble(x, pair.initial_state()).state
        assert (state.status == 0).all()
        assert not (state.gap < 0).any()


def test_slit_that_is_closed_as_meshed():
    """[X] Coincident sides press on each other: a body of NeoHooke without lateral strain is as
    stiff as without the slit, but for the 1.7 % of an element at its tip.
    """
    line = np.linspace(0.0, 2.0, 17)
    mesh = MeshQuad.init_tensor(line, line).with_defaults()
    mesh = mesh.with_boundaries(
        {"slit": lambda x: (x[1] == 1.0) & (x[0] > 0.5)}, boundaries_only=False
    )
    mesh = sc.split_along(mesh, "slit")
    mesh = mesh.with_boundaries({"skin": mesh.boundary_facets()})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    body = sc.SolidForm(basis, sc.NeoHooke(E=100.0, nu=0.0), kinematics="finite")
    fold = sc.ContactPair(basis, "skin", "skin", sc.Coulomb(mu=0.0), penalty=1e4)
    top = basis.get_dofs("top").all("u^2")
    x = basis.zeros()
    x[top] = -0.02
    held = [top, basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")]
    model = sc.Model({"body": body, "fold": fold}, np.concatenate(held))
    force = model.run([sc.Stage("press", prescribed=x)])["press"].reactions()[top].sum()
    stretch = 1.0 - 0.01
    assert force == pytest.approx(100.0 * (stretch - 1.0 / stretch), rel=0.02)


def test_second_order():
    """[X] Triangles of second order, whose facets are curved, are in balance too."""
    mesh = hairpin().to_meshtri()
    mesh = mesh.with_boundaries(
        {
            "upper": lambda x: (x[0] > 2.0) & (x[1] > INNER + THICK - 1e-9),
            "lower": lambda x: (x[0] > 2.0) & (x[1] < -INNER - THICK + 1e-9),
        }
    )
    mesh = mesh.with_boundaries({"skin": mesh.boundary_facets()})
    basis, model = strip(mesh, element=ElementTriP2(), penalty=5e3)
    gaps = (0.2, 0.05, 0.0, -0.01)
    result = model.run([sc.Stage(f"{g}", prescribed=pinched(basis, g)) for g in gaps])
    reaction = result[-1].reactions()
    assert (result[-1].states["fold"].status > 0).any()
    assert np.abs(total(basis, result[-1].x, reaction)).max() < 1e-9 * np.abs(reaction).sum()


def test_refusals():
    """One facet, a block without a fold, and dual multipliers are refused."""
    mesh = MeshQuad().refined(1).with_defaults()
    mesh = mesh.with_boundaries({"one": np.array([mesh.boundaries["top"][0]])})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    law = sc.Coulomb(mu=0.0)
    with pytest.raises(
        ValueError, match="'one' cannot touch itself: all of its 1 facets lie within"
    ):
        sc.ContactPair(basis, "one", "one", law)
    with pytest.raises(ValueError, match="all facets of 'top' face the same way"):
        sc.ContactPair(basis, "top", "top", law)
    folded = Basis(hairpin(), ElementVector(ElementQuad1()), intorder=2)
    with pytest.raises(ValueError, match="not DualMultipliers: each wall is slave and master"):
        sc.ContactPair(folded, "skin", "skin", law, enforcement=sc.DualMultipliers())
