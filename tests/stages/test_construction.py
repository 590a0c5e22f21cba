"""Stages in which bodies, contacts, materials and supports come and go."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementTriP2, ElementVector, FacetBasis, LinearForm, MeshQuad

import skfem_contact as sc
from skfem_contact.contact.laws import Status
from skfem_contact.contact.penalty import choose_penalties
from skfem_contact.results.tractions import tractions
from tests.tools.helpers import grid, unknowns_of, vector_basis

QUIET = {"progress": False}
E, NU = 3e4, 0.3
MODULUS = E * (1 - NU) / ((1 + NU) * (1 - 2 * NU))
LAYERS = ((0.0, 7.0), (7.0, 9.0), (9.0, 10.0))


def column(element: str = "Q2", material=None):
    """A column of three layers between smooth walls, one form a layer."""
    tags = {
        f"layer {k}": lambda x, ends=ends: (x[1] > ends[0]) & (x[1] < ends[1])
        for k, ends in enumerate(LAYERS)
    }
    mesh = grid(element, np.linspace(0, 2, 3), np.linspace(0, 10, 11)).with_subdomains(tags)
    basis = vector_basis(mesh, element)
    material = material or sc.LinearElastic(E=E, nu=NU)
    forms = {name: sc.SolidForm(basis.with_elements(name), material) for name in tags}
    fixed = np.concatenate(
        (basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    )
    return basis, forms, fixed


def own_weight(basis, n_layers: int) -> np.ndarray:
    """Weight of the lowest layers."""
    return sc.weight(basis, {f"layer {k}": 20.0 for k in range(n_layers)})


def at_height(basis, y: float) -> np.ndarray:
    return basis.get_dofs(lambda x: np.isclose(x[1], y)).all("u^2")


def test_excavation_and_fill():
    """[X] Case K3: heave and settlement gamma h H / M; stresses drop by gamma h; fill starts
    without stress.
    """
    basis, forms, fixed = column()
    stages = [
        sc.Stage("gravity", own_weight(basis, 3)),
        sc.Stage("first lift", own_weight(basis, 2), deactivate="layer 2", increments=3),
        sc.Stage("second lift", own_weight(basis, 1), deactivate=["layer 1"]),
        sc.Stage("fill", own_weight(basis, 2), activate=["layer 1"]),
        sc.Stage("fill again", own_weight(basis, 3), activate="layer 2", increments=2),
    ]
    result = sc.Model(forms, fixed).run(stages, **QUIET)
    surface = at_height(basis, 7.0)
    move = 20 * 7 / MODULUS  # of the surface at 7 m by a layer of 1 m
    heights = {"gravity": 3, "first lift": 2, "second lift": 0, "fill": 2, "fill again": 3}
    for name, above in heights.items():
        moved = result[name].x[surface] - result["gravity"].x[surface]
        np.testing.assert_allclose(moved, move * (3 - above), rtol=1e-9, atol=1e-9 * move)
        base = result[name].states["layer 0"].stress[1]
        depth = 7 + above - np.asarray(forms["layer 0"].basis.global_coordinates())[1]
        np.testing.assert_allclose(base, -20 * depth, atol=1e-9 * 200)
    assert list(result["second lift"].states) == ["layer 0"]
    # the fill carries its own weight alone, whatever the ground did before
    y = np.asarray(forms["layer 1"].basis.global_coordinates())[1]
    np.testing.assert_allclose(
        result["fill"].states["layer 1"].stress[1], -20 * (9 - y), atol=1e-9 * 200
    )
    np.testing.assert_allclose(
        result["fill"].states["layer 1"].stress[0], -20 * (9 - y) * 3 / 7, atol=1e-9 * 200
    )


def test_new_layer_is_carried_along_by_the_ground():
    """[X] The nodes of a layer follow the settled surface below it as a rigid body, without
    stress.
    """
    basis, forms, fixed = column("Q1")
    stages = [
        sc.Stage("gravity", 50 * own_weight(basis, 1)),
        sc.Stage("placed", 50 * own_weight(basis, 1), activate=("layer 1", "layer 2")),
    ]
    result = sc.Model(forms, fixed).run(stages, **QUIET)
    assert result["placed"].iterations == (0,)
    down = result["gravity"].x[at_height(basis, 7.0)][0]
    assert down < -0.01
    above = np.concatenate([at_height(basis, y) for y in (8.0, 9.0, 10.0)])
    np.testing.assert_allclose(
        result["placed"].x[above], down, rtol=1e-6
    )  # springs of 1e-9 hold them
    assert not result["placed"].states["layer 1"].stress.any()
    assert not result["gravity"].x[above].any()


@pytest.mark.slow
def test_released_forces_go_in_proportion():
    """[X] Half of an excavation: half of the heave; a failed stage can be gone on with."""
    basis, forms, fixed = column()
    soil = sc.MohrCoulomb(E=E, nu=NU, c=1e3, phi=30.0)
    forms["layer 0"] = sc.SolidForm(forms["layer 0"].basis, soil)
    gravity, low = own_weight(basis, 3), own_weight(basis, 1)
    lifts = {"deactivate": ("layer 1", "layer 2")}
    whole = sc.Model(forms, fixed).run(
        [sc.Stage("g", gravity), sc.Stage("dug", low, increments=4, **lifts)], **QUIET
    )
    assert len(whole["dug"].iterations) == 4
    pull = sc.weight(basis, {"layer 0": -1e4})  # beyond its strength
    with pytest.raises(sc.NotConverged) as error:
        sc.Model(forms, fixed).run(
            [sc.Stage("g", gravity), sc.Stage("dug", pull, increments=4, **lifts)], **QUIET
        )
    partial = error.value.result
    assert 0 < partial["dug"].fraction < 1 and set(partial["dug"].states) == {"layer 0"}
    rest = sc.Model(forms, fixed).run([sc.Stage("rest", low)], start=partial, **QUIET)["rest"]
    assert rest.residual < 1e-8 and set(rest.states) == {"layer 0"}


def test_support_that_is_removed():
    """[X] A propped cantilever: without the prop it is the one that never had it; its reaction goes
    gradually.
    """
    basis = vector_basis(grid("Q2", np.linspace(0, 5, 11), np.linspace(0, 0.5, 2)), "Q2")
    forms = {"beam": sc.SolidForm(basis, sc.LinearElastic(E=1e5, nu=0.2))}
    wall, prop = basis.get_dofs("left").all(), basis.nodal_dofs[1, basis.mesh.p[0] == 5]
    load = sc.weight(basis, 1.0)
    stages = [sc.Stage("propped", load), sc.Stage("free", load, fixed=wall, increments=4)]
    result = sc.Model(forms, np.append(wall, prop)).run(stages, **QUIET)
    free = sc.Model(forms, wall).run([sc.Stage("free", load)], **QUIET)["free"]
    assert result["free"].iterations == (1, 0, 0, 0)
    np.testing.assert_allclose(result["free"].x, free.x, atol=1e-9 * np.abs(free.x).max())


def two_blocks(law, quadrature=2):
    """A block on a base, loaded downwards and aside."""
    mesh = sc.join_bodies(
        {
            "base": grid("Q1", np.linspace(-0.5, 1.5, 9), np.linspace(-0.5, 0, 3)),
            "block": grid("Q1", np.linspace(0, 1, 6), np.linspace(0, 0.5, 4)),
        }
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    forms = {
        "base": sc.SolidForm(basis.with_elements("base"), sc.LinearElastic(E=1e4, nu=0.3)),
        "block": sc.SolidForm(basis.with_elements("block"), sc.LinearElastic(E=1e4, nu=0.2)),
        "joint": sc.ContactPair(basis, "block:bottom", "base:top", law, quadrature),
    }
    top = LinearForm(lambda v, w: -20.0 * v[1]).assemble(
        FacetBasis(mesh, basis.elem, facets="block:top")
    )
    side = LinearForm(lambda v, w: 1.0 * v[0]).assemble(
        FacetBasis(mesh, basis.elem, facets="block:left")
    )
    return basis, forms, basis.get_dofs("base:bottom").all(), top, side


@pytest.mark.parametrize("quadrature", ["nodal", 2, "segments"])
def test_tie_becomes_friction(quadrature):
    """[X] The law of a pair changes and nothing moves, as long as friction bears what the tie
    carried.
    """
    _, forms, fixed, top, side = two_blocks(sc.Tied(), quadrature)
    # the edges of the block slip where shear is large under little pressure: friction as large as
    # it may be
    change = {"joint": forms["joint"].with_law(sc.Coulomb(mu=5.0))}
    stages = [sc.Stage("tied", top + side), sc.Stage("friction", top + side, change=change)]
    result = sc.Model(forms, fixed, newton=sc.Newton(1e-11)).run(stages, **QUIET)
    assert result["friction"].iterations == (0,)
    np.testing.assert_array_equal(result["friction"].x, result["tied"].x)
    tied, now = (result[s].states["joint"].traction for s in ("tied", "friction"))
    np.testing.assert_allclose(now, tied, atol=1e-9 * 20)


@pytest.mark.parametrize("quadrature", [2, "segments"])
def test_contact_takes_the_place_of_a_tie(quadrature):
    """[X] Another pair between the same surfaces takes over the nodal forces of the one that
    goes.
    """
    basis, forms, fixed, top, side = two_blocks(sc.Tied(), 2)
    forms["friction"] = sc.ContactPair(
        basis, "block:bottom", "base:top", sc.Coulomb(mu=5.0), quadrature
    )
    stages = [
        sc.Stage("tied", top + side),
        sc.Stage("now", top + side, activate="friction", deactivate="joint"),
    ]
    result = sc.Model(forms, fixed).run(stages, **QUIET)
    assert set(result["tied"].states) == {"base", "block", "joint"}
    assert set(result["now"].states) == {"base", "block", "friction"}
    moved = np.abs(result["now"].x - result["tied"].x).max()
    # two Gauss points of the tie and those between the cuts pass the master's forces on a little
    # differently
    assert moved < (1e-12 if quadrature == 2 else 0.01) * np.abs(result["tied"].x).max()
    force = forms_force(basis, forms, result["now"], "friction")
    np.testing.assert_allclose(force[unknowns_of(basis, "block")[:, 1]].sum(), -20.0, rtol=1e-6)


def forms_force(basis, forms, step, name: str) -> np.ndarray:
    pair = choose_penalties(forms)[name]
    return pair.assemble(step.x, step.states[name]).force


def test_body_placed_on_settled_ground():
    """[X] Block and joint come later: no traction at first, then the block's weight, and no gap of
    the settlement.
    """
    basis, forms, fixed, *_ = two_blocks(sc.Coulomb(mu=0.5))
    ground = 1e3 * sc.weight(basis, {"base": 1.0})
    stages = [
        sc.Stage("settled", ground),
        sc.Stage("placed", ground, activate=("block", "joint")),
        sc.Stage("heavy", ground + sc.weight(basis, {"block": 24.0})),
    ]
    result = sc.Model(forms, fixed).run(stages, **QUIET)
    top = basis.get_dofs("base:top").all("u^2")
    assert result["settled"].x[top].min() < -0.005
    assert result["placed"].iterations == (0,)
    assert not result["placed"].states["joint"].traction[0].any()
    assert (result["placed"].states["joint"].status != Status.OPEN).all()
    joint = result["heavy"].states["joint"]
    pressed = (tractions(forms["joint"], joint).weight * joint.traction[0]).sum()
    assert pressed == pytest.approx(-12.0, rel=1e-4)  # the surface has become a little curved


def test_body_lifted_away():
    """[X] Load, contact and block go: the base springs back."""
    basis, forms, fixed, top, _ = two_blocks(sc.Coulomb(mu=0.5))
    own = sc.weight(basis, {"base": 10.0})
    stages = [
        sc.Stage("base", own),
        sc.Stage("placed", own, activate=("block", "joint")),
        sc.Stage("loaded", own + top),
        sc.Stage("lifted", own, deactivate=("block", "joint"), increments=2),
    ]
    result = sc.Model(forms, fixed, newton=sc.Newton(1e-12)).run(stages, **QUIET)
    base = unknowns_of(basis, "base").ravel()
    np.testing.assert_allclose(result["lifted"].x[base], result["base"].x[base], atol=1e-12)


def test_softer_material_sinks_further():
    """[X] With half the modulus from now on only what is added counts double."""
    basis, forms, fixed = column()
    load = own_weight(basis, 3)
    soft = {
        name: form.with_materials({"all": sc.LinearElastic(E=E / 2, nu=NU)})
        for name, form in forms.items()
    }
    stages = [
        sc.Stage("g", load),
        sc.Stage("same", load, change=soft),
        sc.Stage("double", 2 * load),
    ]
    result = sc.Model(forms, fixed).run(stages, **QUIET)
    assert result["same"].iterations == (0,)
    np.testing.assert_allclose(result["double"].x, 3 * result["g"].x, atol=1e-12)


def test_weaker_material_yields_gradually():
    """[X] Strength that has gone is released over the stage: the Rankine ratio of the weaker soil
    in the end.
    """
    strong, weak = (
        sc.MohrCoulomb(E=E, nu=NU, c=c, phi=phi) for c, phi in ((1e3, 30.0), (0.0, 20.0))
    )
    basis, forms, _ = column("Q1", strong)
    fixed = np.concatenate(
        (basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    )
    load = own_weight(basis, 3)
    change = {name: form.with_materials({"all": weak}) for name, form in forms.items()}
    result = sc.Model(forms, fixed).run(
        [sc.Stage("g", load), sc.Stage("weak", load, change=change, increments=3)], **QUIET
    )
    stress = result["weak"].states["layer 0"].stress
    ratio = (1 - np.sin(np.radians(20))) / (1 + np.sin(np.radians(20)))
    np.testing.assert_allclose(stress[0] / stress[1], ratio, rtol=1e-6)


def test_resumed_in_the_middle(tmp_path):
    """[X] Case S25: saved with a layer away and gone on with: the same."""
    basis, forms, fixed = column()
    stages = [
        sc.Stage("g", own_weight(basis, 3)),
        sc.Stage("dug", own_weight(basis, 2), deactivate="layer 2"),
        sc.Stage("filled", own_weight(basis, 3), activate="layer 2"),
    ]
    whole = sc.Model(forms, fixed).run(stages, **QUIET)
    sc.Model(forms, fixed).run(stages[:2], **QUIET).save(tmp_path / "two.npz")
    start = sc.load_result(tmp_path / "two.npz", forms)
    resumed = sc.Model(forms, fixed).run(stages[2:], start=start, **QUIET)
    np.testing.assert_allclose(resumed["filled"].x, whole["filled"].x, atol=1e-15)


def test_names_are_checked():
    """One error before anything is computed, with the stage and what exists."""
    basis, forms, fixed = column()
    load = own_weight(basis, 3)

    def error(match, *stages, **options):
        with pytest.raises(ValueError, match=match):
            sc.Model(forms, fixed).run(stages, **QUIET, **options)

    error(
        r"stage 's': there is no form 'layer 3'; existing: layer 0, layer 1, layer 2",
        sc.Stage("s", load, deactivate="layer 3"),
    )
    whole = sc.Model({"all": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=NU))}, fixed)
    with pytest.raises(ValueError, match=r"'layer 2' is a subdomain .*with_elements\('layer 2'\)"):
        whole.run([sc.Stage("s", load, deactivate="layer 2")], **QUIET)
    error("there is no form 'pile'", sc.Stage("s", load, activate="pile"))
    error("there is no form 'pile'", sc.Stage("s", load, change={"pile": forms["layer 0"]}))
    error(
        "stage 't': 'layer 2' is activated, but it is active already",
        sc.Stage("r", own_weight(basis, 2), deactivate="layer 2"),
        sc.Stage("s", load, activate="layer 2"),
        sc.Stage("t", load, activate="layer 2"),
    )
    error(
        "stage 't': 'layer 2' is deactivated, but it is not active",
        sc.Stage("s", own_weight(basis, 2), deactivate="layer 2"),
        sc.Stage("t", own_weight(basis, 2), deactivate="layer 2"),
    )
    error(
        r"stage 's': a part of the load acts on inactive bodies; \['layer 2'\] are not active",
        sc.Stage("s", load, deactivate="layer 2"),
    )
    error(
        "stage 's': 'layer 0' can only be changed to another material",
        sc.Stage("s", load, change={"layer 0": forms["layer 1"]}),
    )
    error("stage 's': fixed must be dofs", sc.Stage("s", load, fixed=np.array([0.5])))
    error("there is no SolidForm", sc.Stage("s", 0 * load, deactivate=list(forms)))


def test_what_is_left_must_be_held():
    """A hanging layer is named, and the stage."""
    basis, forms, _ = column()
    load = sc.weight(basis, {"layer 0": 20.0, "layer 2": 20.0})
    free = np.concatenate((basis.get_dofs("bottom").all(), basis.get_dofs("left").all("u^1")))
    with pytest.raises(
        ValueError, match=r"stage 'dig': body 'layer 2' is not held: .* leaves 1 of 3 rigid motions"
    ):
        stages = [sc.Stage("g", own_weight(basis, 3)), sc.Stage("dig", load, deactivate="layer 1")]
        sc.Model(forms, free).run(stages, **QUIET)


def test_contact_with_what_is_not_there():
    """A pair whose body has gone is named, and so is the surface."""
    basis, forms, fixed, *_ = two_blocks(sc.Coulomb(mu=0.5))
    own = sc.weight(basis, {"base": 10.0})
    with pytest.raises(
        ValueError, match="stage 'away': 'joint' is active, but acts on an inactive body"
    ):
        sc.Model(forms, fixed).run(
            [sc.Stage("g", own), sc.Stage("away", own, deactivate="block")], **QUIET
        )


@pytest.mark.parametrize("element", ["Q1", "P1", "P2"])
def test_contact_beside_a_slot_one_element_high(element):
    """[X] A pair over a slot whose nodes all stay is refused, pairs of the facets that remain have
    the whole load.
    """
    y = np.linspace(0, 6, 7)
    plate = grid(element, np.linspace(0, 2, 3), y)
    soil = grid(element, np.linspace(2, 6, 5), y)
    height = soil.p[1, soil.t].mean(axis=0)
    parts = {"slot": np.flatnonzero((height > 3) & (height < 4))}
    parts["rest"] = np.setdiff1d(np.arange(soil.nelements), parts["slot"])
    below = {"below": lambda x: (x[0] < 2 + 1e-9) & (x[1] < 3)}
    above = {"above": lambda x: (x[0] < 2 + 1e-9) & (x[1] > 4)}
    soil = soil.with_subdomains(parts).with_boundaries(below | above)
    basis = vector_basis(sc.join_bodies({"plate": plate, "soil": soil}), element, intorder=2)
    law = sc.LinearElastic(E=E, nu=NU)
    forms = {
        name: sc.SolidForm(basis.with_elements(elements), law)
        for name, elements in {"plate": "plate", "slot": "soil:slot", "rest": "soil:rest"}.items()
    }
    fixed = [basis.get_dofs("soil:right").all(), basis.get_dofs("plate:bottom").all("u^2")]

    def dug(*masters):
        pairs = {
            side: sc.ContactPair(basis, "plate:right", side, sc.Coulomb(mu=0.0), penalty=1e6)
            for side in masters
        }
        model = sc.Model({**forms, **pairs}, fixed)
        push = model.traction("plate:left", (10.0, 0.0))
        stages = [sc.Stage("dug", push, deactivate="slot")]
        return model.run(stages, **QUIET)["dug"]

    with pytest.raises(ValueError, match="'soil:left' is active, but acts on an inactive body"):
        dug("soil:left")
    stage = dug("soil:below", "soil:above")
    forces = [stage.contact(name).force[0] for name in ("soil:below", "soil:above")]
    assert -sum(forces) == pytest.approx(60.0, rel=1e-6)  # on the plate


@pytest.mark.parametrize(
    "link",
    [
        lambda basis: sc.Bar(basis, (0.0, 10.0), (2.0, 7.0), EA=1e4),
        lambda basis: sc.Bar(basis, (2.0, 10.0), (5.0, 10.0), EA=1e4, fixed_end=True),
        lambda basis: sc.Spring(basis, (1.0, 7.0), 100.0, to=(1.0, 10.0)),
    ],
)
def test_links_to_what_is_not_there(link):
    """Nodes of a body that has gone are held where they are: they are no ground that an anchor may
    hold on to.
    """
    basis, forms, fixed = column()
    forms["link"] = link(basis)
    all_there, dug = sc.Stage("g", own_weight(basis, 3)), own_weight(basis, 2)
    with pytest.raises(
        ValueError, match="stage 'dig': 'link' is active, but acts on an inactive body"
    ):
        sc.Model(forms, fixed).run([all_there, sc.Stage("dig", dug, deactivate="layer 2")], **QUIET)
    with pytest.raises(ValueError, match="'link' is active, but acts on an inactive body"):
        sc.Model(forms, fixed).run(
            [sc.Stage("g", dug), sc.Stage("fill", all_there.load, activate="layer 2")], **QUIET
        )
    sc.Model(forms, fixed).run(
        [all_there, sc.Stage("dig", dug, deactivate=("layer 2", "link"))], **QUIET
    )


def test_links_hold_no_body_that_is_not_given():
    """A bar elsewhere is no reason not to say which unknowns belong to nothing."""
    basis, forms, fixed = column()
    there = {"layer 0": forms["layer 0"], "bar": sc.Bar(basis, (0.0, 7.0), (2.0, 5.0), EA=1e4)}
    with pytest.raises(
        ValueError, match=r"dofs belong to no solid .* in the subdomains \['layer 1', 'layer 2'\]"
    ):
        sc.Model(there, fixed).run([sc.Stage("g", own_weight(basis, 1))], **QUIET)


def test_start_with_another_penalty():
    """Tractions would change with the penalty: refused, with the way out."""
    _, forms, fixed, top, _ = two_blocks(sc.Coulomb(mu=0.5))
    first = sc.Model(forms, fixed).run([sc.Stage("g", top)], **QUIET)
    harder = {**forms, "joint": forms["joint"].with_penalty(1e7, 1e7)}
    with pytest.raises(
        ValueError, match="'joint' cannot continue the start: its penalty is another one"
    ):
        sc.Model(harder, fixed).run([sc.Stage("more", 2 * top)], start=first, **QUIET)


def test_forces_of_a_lost_body_are_released_in_shares_over_stages():
    """[X] Two fifths of the forces of a lost body move the ground by two fifths; a later stage
    releases the rest.
    """
    mesh = (
        MeshQuad()
        .refined(2)
        .with_defaults()
        .with_subdomains({"ground": lambda x: x[1] < 0.5, "fill": lambda x: x[1] > 0.5})
    )
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    forms = {
        name: sc.SolidForm(
            basis.with_elements(name), sc.LinearElastic(E=1e3, nu=0.2), unit_weight=20.0
        )
        for name in ("ground", "fill")
    }
    model, surface = (
        sc.Model(forms, basis.get_dofs("bottom").all()),
        basis.nodal_dofs[1, mesh.p[1] == 0.5],
    )
    result = model.run(
        [sc.Stage("filled"), sc.Stage("half", deactivate="fill", release=0.4), sc.Stage("cleared")]
    )
    filled, half, cleared = (stage.x[surface].mean() for stage in result)
    alone = (
        model.run([sc.Stage("filled"), sc.Stage("cleared", deactivate="fill")])["cleared"]
        .x[surface]
        .mean()
    )
    assert abs(half - (0.6 * filled + 0.4 * alone)) < 1e-12 * abs(filled)
    assert abs(cleared - alone) < 1e-12 * abs(filled)


@pytest.mark.parametrize("water", [10.0, 9.0, 4.0])
def test_forces_in_part_are_those_of_the_water_before(water):
    """[X] Two fifths of the buoyant weight of a lost layer heave the ground, whatever water the
    stage brings; its own change adds the settlement of a fall of the water table.
    """
    basis, forms, fixed = column()
    for name, form in forms.items():
        forms[name] = sc.SolidForm(form.basis, sc.LinearElastic(E=E, nu=NU), unit_weight=20.0)
    model = sc.Model(forms, fixed, water_unit_weight=10.0)
    start = model.k0_state(K0=0.5, water=10.0)
    dig = sc.Stage("dig", deactivate="layer 2", release=0.4, water=water)
    heave = model.run([dig], start=start, **QUIET)["dig"].x[at_height(basis, 9.0)]
    # The layer pressed with 10 on the ground below; stresses rise by 10 per metre of lost buoyancy.
    fall = 9.0 - water if water < 9.0 else 0.0
    settlement = 10.0 * (fall**2 / 2 + fall * water) / MODULUS
    # round-off of the solution
    assert np.allclose(heave, 0.4 * 10.0 * 9.0 / MODULUS - settlement, rtol=1e-9)


def test_water_of_a_stage_is_that_of_a_seepage_in_its_own_ground():
    """[X] Ground above the flow is dry, and its weight and that of the wet ground under water are
    carried.
    """
    mesh = (
        MeshQuad.init_tensor(np.linspace(0, 4, 5), np.linspace(0, 4, 9))
        .to_meshtri()
        .with_defaults()
    )
    mesh = mesh.with_subdomains(
        {"wet": lambda x: x[1] < 2, "dry": lambda x: x[1] > 2}
    ).with_boundaries({"table": mesh.facets_satisfying(lambda x: abs(x[1] - 2) < 1e-9)})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    forms = {
        name: sc.SolidForm(
            basis.with_elements(name), sc.LinearElastic(E=1e4, nu=0.3), unit_weight=20.0
        )
        for name in ("wet", "dry")
    }
    flow = sc.water.Flow(basis.with_elements("wet"), 1e-4, unit_weight=10.0).steady(
        sc.water.Conditions(head={"table": 2.0})
    )
    model = sc.Model(forms, sc.box_supports(basis), water_unit_weight=10.0)
    one, other = (
        model.run([sc.Stage("flow", water=flow)])["flow"],
        model.run([sc.Stage("level", water=2.0)])["level"],
    )
    np.testing.assert_allclose(one.load, other.load, atol=1e-9)
    assert abs(one.load[1::2].sum() + 4 * 4 * 20 - 4 * 2 * 10) < 1e-9


def test_displacements_of_a_fill_count_from_its_placement(tmp_path):
    """[X] A fill of 1 m on 2 m of ground, E = 1000 and weight 20: sinking with the ground by .04
    and .01 itself.
    """
    mesh = (
        MeshQuad.init_tensor(np.linspace(0, 4, 5), np.linspace(0, 3, 4))
        .with_defaults()
        .with_subdomains({"ground": lambda x: x[1] < 2, "fill": lambda x: x[1] > 2})
    )
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    soil = sc.LinearElastic(E=1e3, nu=0.0)
    forms = {
        name: sc.SolidForm(basis.with_elements(name), soil, unit_weight=20.0)
        for name in mesh.subdomains
    }
    model = sc.Model(forms, sc.box_supports(basis))
    result = model.run(
        [sc.Stage("ground", deactivate=("fill",)), sc.Stage("fill", activate=("fill",))],
        progress=False,
    )
    for read in (result, sc.load_result(result_file(result, tmp_path), model)):
        before, last = read["ground"], read["fill"]
        for since, beside in (
            (None, (-0.08 - 0.04) / 2),
            (before, -0.04),
        ):  # at the interface the mean of both bodies
            moved = last.field("uy", since=since)
            np.testing.assert_allclose(moved[mesh.p[1] == 3.0], -0.05, atol=1e-12)
            np.testing.assert_allclose(moved[mesh.p[1] == 2.0], beside, atol=1e-12)
    assert not result.reset()["fill"].field("uy").any()


def result_file(result, folder):
    """Return the name of a file that holds a result."""
    result.save(folder / "fill")
    return folder / "fill"
