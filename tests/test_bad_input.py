"""One clear error for every mistake, before anything is computed: its message names the thing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementHex0,
    ElementLineP1,
    ElementQuad0,
    ElementQuad1,
    ElementQuad2,
    ElementTetCR,
    ElementTriCR,
    ElementTriP1,
    ElementTriP2,
    ElementTriP3,
    ElementVector,
    FacetBasis,
    InteriorFacetBasis,
    MeshHex,
    MeshLine,
    MeshQuad,
    MeshTet,
    MeshTri,
)

import skfem_contact as sc
import skfem_contact.plot as plot
from skfem_contact.contact.laws import Status
from skfem_contact.contact.penalty import choose_penalties
from tests.tools.helpers import grid, run_stages, unknowns_of, vector_basis

ELASTIC = sc.LinearElastic(E=1.0, nu=0.3)


def blocks():
    """Two blocks above each other."""
    return sc.join_bodies(
        {
            "a": grid("Q1", np.linspace(0, 1, 4), np.linspace(0, 1, 4)),
            "b": grid("Q1", np.linspace(0, 1, 5), np.linspace(1, 2, 4)),
        }
    )


def with_boundary(**boundaries):
    """Basis of the blocks with further boundaries."""
    return vector_basis(blocks().with_boundaries(boundaries), "Q1", intorder=2)


def pair(basis=None, slave="b:bottom", master="a:top", law=None, **options):
    basis = vector_basis(blocks(), "Q1", intorder=2) if basis is None else basis
    options = {"quadrature": "nodal", **options}
    return sc.ContactPair(basis, slave, master, sc.Coulomb(0.3) if law is None else law, **options)


# -- surfaces


@pytest.mark.parametrize("names", [{"slave": "b:botom"}, {"master": "b:botom"}])
def test_unknown_boundary_lists_what_exists(names):
    with pytest.raises(
        ValueError, match=r"no boundary 'b:botom'; existing: a:bottom, a:left, .*b:top"
    ):
        pair(**names)


def test_mesh_without_boundaries():
    with pytest.raises(ValueError, match="no boundary 'b:bottom'; existing: none at all"):
        pair(vector_basis(MeshQuad(), "Q1"))


def test_boundary_of_two_pieces():
    tags = blocks().boundaries
    basis = with_boundary(sides=np.concatenate((tags["a:left"], tags["a:right"])))
    with pytest.raises(
        ValueError, match="boundary 'sides' is no single chain: it consists of 2 pieces"
    ):
        pair(basis, slave="sides")


def test_open_chain_and_a_ring():
    mesh = blocks()
    ring = [mesh.boundaries[f"a:{side}"] for side in ("left", "right", "top", "bottom")]
    basis = with_boundary(both=np.concatenate((*ring, mesh.boundaries["b:top"])))
    with pytest.raises(ValueError, match=r"boundary 'both' is no single chain: .* not connected"):
        pair(basis, slave="both")


def test_branching_boundary():
    p = np.array([[0, 1, 1, 0, 2, 2, 1.0], [0, 0, 1, 1, 1, 2, 2]])
    mesh = MeshQuad(p, np.array([[0, 1, 2, 3], [2, 4, 5, 6]]).T)
    mesh = mesh.with_boundaries({"outline": mesh.boundary_facets()})
    with pytest.raises(ValueError, match="boundary 'outline' is no single chain: it branches"):
        sc.Surface.from_boundary(vector_basis(mesh, "Q1"), "outline")


def test_interior_boundary():
    mesh = blocks()
    basis = with_boundary(seam=np.flatnonzero(mesh.f2t[1] >= 0)[:1])
    with pytest.raises(ValueError, match="boundary 'seam' lies inside the mesh"):
        pair(basis, slave="seam")


def test_empty_boundary():
    with pytest.raises(ValueError, match="boundary 'nothing' is empty"):
        pair(with_boundary(nothing=np.zeros(0, int)), slave="nothing")


@pytest.mark.parametrize(
    "slave, master",
    [
        ("b:top", "a:top"),
        ("a:bottom", sc.rigid.line((2, 0), (-2, 0))),
        ("b:top", sc.rigid.circle((0.5, 4), 2, hole=True)),
    ],
)
def test_slave_and_master_that_face_the_same_way(slave, master):
    """Bodies fell as far as these sides are apart, without a word."""
    with pytest.raises(ValueError, match="face the same way, and cannot touch"):
        pair(slave=slave, master=master)


def test_slave_and_master_that_share_nodes():
    with pytest.raises(ValueError, match="slave 'a:left' and master 'a:top' share 1 nodes"):
        pair(slave="a:left")


def test_slave_that_is_master():
    with pytest.raises(ValueError, match="all facets of 'a:top' face the same way"):
        pair(slave="a:top")


# -- pairs


@pytest.mark.parametrize(
    "penalty",
    [
        0,
        -1.0,
        np.nan,
        np.inf,
        (1e3, 0.0),
        (-1.0, 1e3),
        (1e3,),
        (1.0, 2.0, 3.0),
        "stiff",
        [1e3, 1e3],
    ],
)
def test_penalty_that_is_none(penalty):
    with pytest.raises(ValueError, match=r"penalt|normal must be a finite number"):
        pair(penalty=penalty)


@pytest.mark.parametrize("quadrature", [0, -1, 2.5, "gauss", True, None])
def test_bad_quadrature(quadrature):
    with pytest.raises(ValueError, match="quadrature must be one of"):
        pair(quadrature=quadrature)


def test_number_of_points_may_be_numpy():
    assert pair(quadrature=np.int64(2), penalty=1.0).quadrature == 2


@pytest.mark.parametrize(
    "options, message",
    [
        ({"tangent": "full"}, "tangent must be one of"),
        ({"initial": "touching"}, "initial must be one of"),
        ({"share": 0.0}, "share must lie in"),
        ({"share": 1.5}, "share must lie in"),
        ({"smoothing": 0.7}, "alpha must lie in"),
        ({"smoothing": 0.0}, "alpha must lie in"),
        (
            {"enforcement": "augmented"},
            "enforcement must be a Penalty or an AugmentedLagrangian or a DualMultipliers or None",
        ),
        (
            {"enforcement": sc.AugmentedLagrangian},
            "enforcement must be a Penalty or an AugmentedLagrangian or a DualMultipliers",
        ),
    ],
)
def test_bad_options(options, message):
    with pytest.raises(ValueError, match=message):
        pair(**options)


class LawWithoutUpdate(sc.InterfaceLaw):
    pass


@pytest.mark.parametrize("law", [0.3, sc.Coulomb, "rough", LawWithoutUpdate()])
def test_law_that_is_none(law):
    with pytest.raises(ValueError, match="law must be an InterfaceLaw with an `update`"):
        pair(law=law)


def test_smoothing_of_curved_facets():
    with pytest.raises(ValueError, match="'a:top' are curved already"):
        pair(vector_basis(blocks(), "Q2"), smoothing=0.3)


def test_pair_without_penalty_is_assembled():
    p = pair()
    with pytest.raises(ValueError, match="'b:bottom' on 'a:top' has no penalty yet"):
        p.assemble(np.zeros(p.size), p.initial_state())


def test_no_solid_to_take_a_penalty_from():
    with pytest.raises(ValueError, match="no SolidForm among the forms"):
        choose_penalties({"joint": pair()})


# -- elements, meshes and materials


@pytest.mark.parametrize(
    "element, mesh, name",
    [
        (ElementVector(ElementTriP3()), MeshTri(), "ElementTriP3"),
        (ElementVector(ElementTriCR()), MeshTri(), "ElementTriCR"),
        (ElementVector(ElementQuad0()), MeshQuad(), "ElementQuad0"),
        (ElementQuad1(), MeshQuad(), "ElementQuad1"),
        (ElementVector(ElementTriP1(), 3), MeshTri(), "with 3 components"),
        (ElementVector(ElementTetCR()), MeshTet(), "ElementTetCR"),
        (ElementVector(ElementHex0()), MeshHex(), "ElementHex0"),
        (ElementVector(ElementLineP1()), MeshLine(), "ElementLineP1"),
    ],
)
def test_unsupported_element(element, mesh, name):
    basis = Basis(mesh, element)
    for make in (
        lambda: sc.SolidForm(basis, ELASTIC),
        lambda: sc.ContactPair(basis, "left", "right", sc.Coulomb(), quadrature="nodal"),
        lambda: sc.weight(basis, 1.0),
    ):
        with pytest.raises(
            ValueError, match=f"unsupported element .*{name}.*supported are ElementVector"
        ):
            make()


@pytest.mark.parametrize("kind", [FacetBasis, InteriorFacetBasis])
def test_basis_of_facets(kind):
    with pytest.raises(ValueError, match=f"basis must be a CellBasis, not {kind.__name__}"):
        sc.SolidForm(kind(MeshQuad().refined(1), ElementVector(ElementQuad1())), ELASTIC)


@pytest.mark.parametrize("what", [None, blocks()])
def test_no_basis_at_all(what):
    with pytest.raises(ValueError, match=r"basis must be a CellBasis"):
        sc.SolidForm(what, ELASTIC)


@pytest.mark.parametrize(
    "materials, message",
    [
        ({"clay": ELASTIC}, "no subdomain 'clay'; existing: a, all, b, void"),
        (
            {"a": ELASTIC},
            r"12 of 21 elements have no material; they lie in the subdomains \['b', 'all'\]",
        ),
        (
            {"a": ELASTIC, "all": ELASTIC},
            r"9 elements have more than one material.*\['a', 'all'\] overlap",
        ),
        ({"all": ELASTIC, "void": ELASTIC}, "subdomain 'void' holds no element"),
        ({}, "there is no material"),
        ({"a": ELASTIC, "b": None}, "material of 'b': None is no material"),
        (sc.LinearElastic, "material of 'all'.*is no material"),
        (
            {"a": sc.LinearElastic(E=np.ones(3), nu=0.3), "b": ELASTIC},
            "material of 'a'.*3 values for 9 elements",
        ),
        (
            {"a": ELASTIC, "b": sc.MohrCoulomb(E=1.0, nu=0.3, c=np.ones(9), phi=30.0)},
            "material of 'b'.*9 values for 12 elements",
        ),
    ],
)
def test_bad_materials(materials, message):
    mesh = blocks()
    mesh = mesh.with_subdomains({"all": np.arange(mesh.nelements), "void": np.zeros(0, int)})
    with pytest.raises(ValueError, match=message):
        sc.SolidForm(vector_basis(mesh, "Q1"), materials)


def test_parameter_array_of_wrong_length_by_replacement():
    form = sc.SolidForm(vector_basis(blocks(), "Q1"), {"a": ELASTIC, "b": ELASTIC})
    with pytest.raises(ValueError, match=r"material of 'b'.*2 values for 12 elements"):
        form.with_materials({"b": sc.LinearElastic(E=[1.0, 2.0], nu=0.3)})


@pytest.mark.parametrize(
    "parameters, message",
    [
        ({"E": 0.0}, "E must be positive"),
        ({"E": -1.0}, "E must be positive, got -1"),
        ({"E": np.nan}, "E must be a finite number"),
        ({"nu": 0.5}, "nu must lie between -1 and 0.5"),
        ({"nu": -1.0}, "nu must lie"),
        ({"c": -1.0}, "c must not be negative"),
        ({"phi": -1.0}, "phi must lie in"),
        ({"phi": 90.0}, "phi must lie in"),
        ({"psi": 31.0}, "psi must not exceed phi"),
        ({"psi": -1.0}, "psi must not be negative"),
        ({"E": [1.0, -2.0]}, "E must be positive, got -2.0 in element 1"),
    ],
)
def test_bad_soil(parameters, message):
    with pytest.raises(ValueError, match=message):
        sc.MohrCoulomb(**({"E": 1.0, "nu": 0.3, "c": 1.0, "phi": 30.0} | parameters))


def test_bad_weights():
    mesh = blocks()
    basis = vector_basis(mesh.with_subdomains({"all": np.arange(mesh.nelements)}), "Q1")
    with pytest.raises(ValueError, match="no subdomain 'clay'; existing: a, all, b"):
        sc.weight(basis, {"clay": 1.0})
    with pytest.raises(ValueError, match=r"9 elements get their weight twice.*\['a', 'all'\]"):
        sc.weight(basis, {"a": 1.0, "all": 2.0})
    with pytest.raises(ValueError, match="each a finite number"):
        sc.weight(basis, {"a": np.nan})
    forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.3))}
    with pytest.raises(ValueError, match="9 elements get their K0 twice"):
        sc.Model(forms, np.arange(2)).k0_state(
            basis.zeros(), unit_weights=20.0, K0={"a": 0.5, "all": 0.6}
        )


@pytest.mark.parametrize("direction", [(0.0, -2.0), (0.0, 0.0, -1.0), (np.nan, 1.0), -1.0])
def test_direction_of_weight_that_is_no_unit_vector(direction):
    with pytest.raises(
        ValueError, match=r"direction must be (a unit vector with 2|several values, each a finite)"
    ):
        sc.weight(vector_basis(blocks(), "Q1"), 1.0, direction=direction)


@pytest.mark.parametrize("unit_weight", [0.0, -9.81, np.nan, np.inf])
def test_bad_unit_weight_of_water(unit_weight):
    with pytest.raises(
        ValueError,
        match=r"unit weight of water must be positive|unit_weight must be a finite number",
    ):
        sc.hydrostatic(1.0, unit_weight=unit_weight)


# -- analyses


def problem(mesh=None):
    """Forms, stages and fixed unknowns of a sound analysis of the blocks."""
    basis = vector_basis(blocks() if mesh is None else mesh, "Q1", intorder=2)
    forms = {"solid": sc.SolidForm(basis, ELASTIC), "joint": pair(basis)}
    return basis, forms, [sc.Stage("rest", basis.zeros())], basis.get_dofs("a:bottom").all()


def run(forms, stages, fixed, **options):
    return run_stages(forms, stages, fixed, progress=False, **options)


def test_the_sound_analysis_is_accepted():
    _, *arguments = problem()
    assert len(run(*arguments)) == 1


def test_no_stages():
    _, forms, _, fixed = problem()
    with pytest.raises(ValueError, match="no stage"):
        run(forms, [], fixed)


def test_two_stages_of_one_name():
    basis, forms, stages, fixed = problem()
    with pytest.raises(ValueError, match="two stages are named 'rest'"):
        run(forms, [*stages, sc.Stage("rest", basis.zeros())], fixed)
    # result["rest"] would be the old one
    with pytest.raises(ValueError, match="the start has a stage of the name 'rest'"):
        run(forms, stages, fixed, start=run(forms, stages, fixed))


def test_stages_and_forms_of_the_wrong_kind():
    _, forms, stages, fixed = problem()
    with pytest.raises(ValueError, match="stages must be several values, each a Stage, not Stage"):
        run(forms, stages[0], fixed)
    with pytest.raises(ValueError, match="forms must be a dictionary of names, not list"):
        run(list(forms.values()), stages, fixed)


@pytest.mark.parametrize("forms", [{}, {"joint": pair(penalty=1.0)}])
def test_no_solid(forms):
    _, _, stages, fixed = problem()
    with pytest.raises(ValueError, match="no SolidForm among the forms"):
        run(forms, stages, fixed)


@pytest.mark.parametrize(
    "load, message",
    [
        (np.zeros(3), r"the load has shape \(3,\), not \(72,\)"),
        (np.zeros((72, 1)), r"the load has shape \(72, 1\), not \(72,\)"),
        (np.full(72, np.nan), "the load holds NaN"),
        (np.full(72, np.inf), "the load holds NaN or infinite"),
    ],
)
def test_bad_load(load, message):
    _, forms, _, fixed = problem()
    with pytest.raises(ValueError, match=f"stage 'gravity': {message}"):
        run(forms, [sc.Stage("gravity", load)], fixed)


@pytest.mark.parametrize(
    "value, message", [(np.zeros(3), "has shape"), (np.full(72, np.nan), "holds NaN")]
)
def test_bad_prescribed_displacement(value, message):
    basis, forms, _, fixed = problem()
    with pytest.raises(ValueError, match=f"stage 'push': the prescribed displacement {message}"):
        run(forms, [sc.Stage("push", basis.zeros(), value)], fixed)


def test_lists_of_numbers_are_arrays():
    basis, forms, _, fixed = problem()
    zero = basis.zeros().tolist()
    assert len(run(forms, [sc.Stage("rest", zero, zero)], fixed.tolist())) == 1


@pytest.mark.parametrize("increments", [0, -3, 2.5, "2"])
def test_bad_increments(increments):
    basis, forms, _, fixed = problem()
    with pytest.raises(ValueError, match=r"increments must be (at least 1|a whole number)"):
        run(forms, [sc.Stage("rest", basis.zeros(), None, increments)], fixed)


@pytest.mark.parametrize("duration", [-1.0, np.nan, np.inf, "2"])
def test_bad_duration(duration):
    basis, forms, _, fixed = problem()
    with pytest.raises(ValueError, match=r"duration must (not be negative|be a finite number)"):
        run(forms, [sc.Stage("rest", basis.zeros(), duration=duration)], fixed)


@pytest.mark.parametrize("fixed", [[-1], [72], [0.5], np.zeros(72, bool), "a:bottom", None])
def test_bad_fixed_unknowns(fixed):
    _, forms, stages, _ = problem()
    with pytest.raises(ValueError, match="fixed"):
        run(forms, stages, fixed)


def test_body_held_by_nothing():
    _, forms, stages, fixed = problem()
    with pytest.raises(
        ValueError, match=r"body 'b' is not held: 0 of the dofs are fixed.* 3 of 3 rigid motions"
    ):
        run({"solid": forms["solid"]}, stages, fixed)


@pytest.mark.parametrize(
    "boundary, component, left",
    [("b:top", "u^2", 1), ("b:left", "u^1", 1), ("b:left", "u^2", 2)],
)
def test_body_that_is_held_too_little(boundary, component, left):
    basis, forms, stages, fixed = problem()
    more = np.concatenate((fixed, basis.get_dofs(boundary).all(component)))
    with pytest.raises(
        ValueError, match=f"body 'b' is not held: .*leaves {left} of 3 rigid motions free"
    ):
        run({"solid": forms["solid"]}, stages, more)


def test_two_fixed_unknowns_leave_a_rotation():
    basis, forms, stages, fixed = problem()
    corner = unknowns_of(basis, "b")[0]
    with pytest.raises(
        ValueError, match=r"body 'b' is not held: 2 .*leaves 1 of 3 rigid motions free"
    ):
        run({"solid": forms["solid"]}, stages, np.concatenate((fixed, corner)))


def test_bodies_that_hold_only_each_other():
    basis, forms, stages, _ = problem()
    with pytest.raises(
        ValueError, match=r"the bodies 'a' and 'b' hold only each other: 4 .* 1 of 3 rigid"
    ):
        run(forms, stages, basis.get_dofs("a:bottom").all("u^2"))
    with pytest.raises(
        ValueError, match=r"the bodies 'a' and 'b' hold only each other: 0 .* 3 of 3 rigid"
    ):
        run(forms, stages, [])


def test_rigid_obstacle_may_hold_a_body():
    """[X] A block on a rigid floor, held aside at one side: accepted, and it comes to rest."""
    mesh = grid("Q1", np.linspace(0, 1, 4), np.linspace(0, 1, 4))
    basis = vector_basis(mesh, "Q1", intorder=2)
    floor = sc.rigid.line((-1.0, 0.0), (2.0, 0.0))
    forms = {
        "block": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
        "floor": sc.ContactPair(basis, "bottom", floor, sc.Coulomb(0.3), quadrature="nodal"),
    }
    stage = run(forms, [sc.Stage("weight", sc.weight(basis, 20.0))], [])[0]
    assert (stage.states["floor"].status != Status.OPEN).all()


def test_forms_on_different_bases():
    basis, forms, stages, fixed = problem()
    other = vector_basis(basis.mesh, "Q2")
    for wrong in (pair(other), pair(other, penalty=1.0)):
        with pytest.raises(ValueError, match=r"different bases.*{'solid': 72, 'joint': 224}"):
            run(forms | {"joint": wrong}, stages, fixed)
    halves = {
        "one": sc.SolidForm(basis.with_elements("a"), ELASTIC),
        "two": sc.SolidForm(other.with_elements("b"), ELASTIC),
    }
    with pytest.raises(ValueError, match="different bases"):
        run(halves | {"joint": pair(basis)}, stages, fixed)
    moved = vector_basis(basis.mesh.translated((1.0, 0.0)), "Q1")
    with pytest.raises(
        ValueError, match="'joint' belongs to another mesh or another element than 'solid'"
    ):
        run(forms | {"joint": pair(moved)}, stages, fixed)


def test_elements_without_a_solid_and_with_two():
    basis, forms, stages, fixed = problem()
    half = sc.SolidForm(basis.with_elements("a"), ELASTIC)
    with pytest.raises(
        ValueError, match=r"40 dofs belong to no solid .* at \(0, 1\), in the subdomains \['b'\]"
    ):
        run({"half": half}, stages, fixed)
    with pytest.raises(
        ValueError, match=r"9 elements belong to more than one of the solids \['solid', 'half'\]"
    ):
        run(forms | {"half": half}, stages, fixed)
    # fixed unknowns need no solid: a body that is not there yet
    assert (
        len(run({"half": half}, stages, np.concatenate((fixed, unknowns_of(basis, "b").ravel()))))
        == 1
    )


def test_coordinates_that_are_nan():
    mesh = blocks()
    p = mesh.p.copy()
    p[1, 7] = np.nan
    _, *arguments = problem(replace(mesh, doflocs=p))
    with pytest.raises(ValueError, match="coordinates that are not finite"):
        run(*arguments)


def test_inverted_element():
    mesh = blocks()
    p = mesh.p.copy()
    one, *_, opposite = mesh.t[[0, 1, 3, 2], 4]
    p[:, one] = 1.3 * p[:, opposite] - 0.3 * p[:, one]
    _, *arguments = problem(replace(mesh, doflocs=p))
    with pytest.raises(ValueError, match=r"inverted elements.*element 4"):
        run(*arguments)


def test_start_from_another_analysis():
    basis, forms, stages, fixed = problem()
    done = run(forms, stages, fixed)
    with pytest.raises(ValueError, match=r"start.*'solid'.*'joint'"):
        run(
            {"other": forms["solid"], "joint": forms["joint"]},
            [sc.Stage("s", basis.zeros())],
            fixed,
            start=done,
        )
    finer = vector_basis(basis.mesh, "Q2")
    with pytest.raises(ValueError, match=r"start.*72.*224"):
        run(
            {"solid": sc.SolidForm(finer, ELASTIC), "joint": pair(finer)},
            [sc.Stage("s", finer.zeros())],
            finer.get_dofs("a:bottom").all(),
            start=done,
        )


@pytest.mark.parametrize("solver", ["mumps", 3])
def test_solver_that_is_none(solver):
    _, *arguments = problem()
    with pytest.raises(ValueError):
        run(*arguments, solver=solver)


@pytest.mark.parametrize(
    "settings",
    [{"tolerance": 0.0}, {"tolerance": -1e-8}, {"tolerance": np.nan}, {"max_iterations": 0}],
)
def test_bad_newton_settings(settings):
    with pytest.raises(ValueError, match=next(iter(settings))):
        sc.Newton(**settings)


@pytest.mark.parametrize(
    ("mesh", "element", "points"),
    [
        (MeshQuad(), ElementQuad1(), 1),
        (MeshQuad(), ElementQuad2(), 4),
        (MeshTri(), ElementTriP2(), 1),
    ],
)
def test_too_few_integration_points(mesh, element, points):
    """Elements with hourglass modes would give displacements of any size without a word."""
    places, weights = (
        np.random.default_rng(0).uniform(0.2, 0.4, (2, points)),
        np.ones(points) / points,
    )
    basis = Basis(mesh.refined(1), ElementVector(element), quadrature=(places, weights))
    with pytest.raises(ValueError, match="integration points are too few"):
        sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.3))


# -- shapes, and objects of other kinds


def shapes() -> dict[str, tuple]:
    """Calls with one wrong argument, and what their messages say."""
    basis = vector_basis(grid("Q1", np.linspace(0, 2, 3), np.linspace(0, 1, 3)), "Q1", intorder=2)
    beam = sc.Beam(None, [[0.0, 0.0], [1.0, 0.0]], EI=1.0, EA=1.0)
    frame = sc.Model({"beam": beam}, beam.dofs((0.0, 0.0))).forms["beam"]
    factors = sc.design.PartialFactors("own")
    flow = sc.water.Flow(basis, 1e-4, unit_weight=10.0)
    steady = flow.steady(sc.water.Conditions({"left": 2.0, "right": 1.0}))
    record = sc.Record(0.1, np.sin(np.arange(40)))
    columns = [sc.ground.Column(n, (x, 0.0), 0.0, (("clay", -5.0),)) for n, x in (("A", 0.0),)]
    arc = sc.section.three_centres
    trench = {"bottoms": {"clay": -9.0}, "size": 2.0, "thickness": 0.1}
    return {
        "solid": (lambda: sc.ViscousBoundary(1.0, "left"), "solid must be a SolidForm"),
        "column": (lambda: sc.FreeField("ground", "left"), "solid must be a SolidForm"),
        "model": (lambda: sc.design.factored(basis, factors), "model must be a Model"),
        "section": (lambda: plot.sketch(basis), "section must be a Section"),
        "along": (lambda: sc.ground.section(columns, 2.0, along=3.0), "along must be 2 values"),
        "loads": (
            lambda: factors.load(np.ones(4), np.ones(3)),
            r"variable load has the shape \(3,\), the others \(4,\)",
        ),
        "coordinates": (
            lambda: steady.head_at(np.ones(7)),
            r"coordinates have the shape \(2, ...\), not \(7,\)",
        ),
        "periods": (
            lambda: record.spectrum(np.ones((2, 2))),
            r"periods have the shape \(n,\), not \(2, 2\)",
        ),
        "moment": (lambda: frame.load((0.0, 1.0), (1.0, 0.0), [1.0, 2.0]), "moment must have"),
        "angles": (lambda: arc(2.0, 2.0, (60.0,)), r"angles must have the shape \(2,\)"),
        "centre": (lambda: arc(2.0, 2.0, (60.0, 80.0), (1.0,)), r"centre must have the shape"),
        "outer": (
            lambda: sc.section.trench(2.0, 4.0, outer=(1.0,), **trench),
            r"outer must have the shape \(2,\)",
        ),
        "joined": (lambda: sc.mesh.check_mesh(basis.mesh, 3), r"numbers of nodes, \(n,\), not 3"),
        "level set": (
            lambda: sc.rigid.level_set(lambda x, y: 1.0, (0.0, 1.0, 0.0, 1.0), 9),
            "must return numbers of that shape",
        ),
        "picture": (
            lambda: plot.sketch(
                sc.section.Section({"a": sc.section.rectangle((0, 1), (0, 1))}, size=1.0), "a.abc"
            ),
            "pictures end in .*png.*, not in 'abc'",
        ),
    }


@pytest.mark.parametrize("name", shapes())
def test_other_shapes_and_kinds_are_refused(name):
    """The message has the argument, and what it must be."""
    call, message = shapes()[name]
    with pytest.raises(ValueError, match=message):
        call()


def calls():
    """Calls whose arguments contradict each other, with their messages."""
    basis = vector_basis(grid("Q2", [0.0, 1.0], [0.0, 1.0]), "Q2", intorder=4)
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=5.0, phi=30.0)
    solid = sc.SolidForm(basis, soil, unit_weight=20.0)
    model = sc.Model({"soil": solid}, sc.box_supports(basis), gravity_acceleration=9.81)
    flow = sc.water.Flow(basis, 1e-5, unit_weight=10.0)
    drained = sc.water.Conditions(head={"left": 1.0}, drains={"left": (0.0, 1.0)})
    law = sc.water.VanGenuchten(2.0, 3.0, content=(0.1, 0.4))
    bar = {"EA": 1.0, "tension_only": True, "compression_only": True}
    swing = sc.Dynamic(step=0.1)
    return {
        "bar": (lambda: sc.Bar(None, [(0.0, 0.0)], [(1.0, 0.0)], **bar), "resists nothing"),
        "limit point": (
            lambda: model.run([sc.Stage("a", duration=1.0, dynamic=swing, arc_length=True)]),
            "bodies with inertia pass a limit point in time",
        ),
        "drains": (
            lambda: flow.in_time(drained, start=1.0, times=[0.0, 1.0]),
            "drains are a condition of steady flow",
        ),
        "start": (
            lambda: sc.PoreWater(basis, 1e-3, unit_weight=10.0, start=1.0),
            "needs both `retention` and `start`",
        ),
        "retention": (
            lambda: sc.PoreWater(basis, 1e-3, unit_weight=10.0, retention=law),
            "needs both `retention` and `start`",
        ),
    }


@pytest.mark.parametrize("name", calls())
def test_arguments_that_contradict_each_other(name):
    """One sentence, before anything is computed."""
    call, message = calls()[name]
    with pytest.raises(ValueError, match=message):
        call()
