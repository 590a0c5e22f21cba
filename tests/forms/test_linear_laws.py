"""Bodies of linear laws, whose force is that of their stiffness."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementHex1,
    ElementHex2,
    ElementQuad1,
    ElementQuad2,
    ElementTetP2,
    ElementTriP2,
    ElementVector,
    MeshHex,
    MeshQuad,
    MeshTet,
    MeshTri,
)

import skfem_contact as sc

QUIET = {"progress": False}


class ByPoint(sc.LinearElastic):
    """Linear elasticity by strains and stresses at points: a class of its own may be any law."""


CASES = {
    "B-bar": (MeshQuad().refined(2), ElementQuad1(), {"strain": "b_bar"}),
    "plane": (MeshQuad().refined(2), ElementQuad2(), {}),
    "triangles": (MeshTri().refined(2), ElementTriP2(), {}),
    "axisymmetric": (MeshTri().refined(2), ElementTriP2(), {"coordinates": "axisymmetric"}),
    "B-bar in space": (MeshHex().refined(1), ElementHex1(), {"strain": "b_bar"}),
    "hexahedra": (MeshHex().refined(1), ElementHex2(), {}),
    "tetrahedra": (MeshTet().refined(1), ElementTetP2(), {}),
}


def bodies(case: str) -> list[sc.SolidForm]:
    """The body by its stiffness, and by the strains and stresses at its points."""
    mesh, element, options = CASES[case]
    corners = isinstance(element, (ElementQuad1, ElementHex1))
    basis = Basis(mesh, ElementVector(element), intorder=2 if corners else None)
    laws = sc.LinearElastic(E=1e4, nu=0.3), ByPoint(E=1e4, nu=0.3)
    return [sc.SolidForm(basis, law, **options) for law in laws]


def motion(form: sc.SolidForm, size: float) -> np.ndarray:
    """A large displacement and, in the plane and in space, a rotation about the first node."""
    basis, d = form.basis, form.basis.mesh.dim()
    x = np.zeros(basis.N)
    x[d - 1 :: d] = size
    if form.coordinates != "axisymmetric":
        x[0::d] -= size * basis.doflocs[1, 0::d]
        x[1::d] += size * basis.doflocs[0, 0::d]
    return x


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("size", [0.0, 1e3, 1e8])
@pytest.mark.one_in(3)
def test_force_and_state_are_those_of_the_points(case: str, size: float) -> None:
    """[N] Initial stress, activation at displacements and large rigid motions: forces agree within
    the round-off that both report.
    """
    rng = np.random.default_rng(1)
    found = []
    x = None
    for form in bodies(case):
        if x is None:
            begin = motion(form, size)
            stress = 100.0 * rng.standard_normal((form._ncomp, *form.weight.shape))
            x = begin + 1e-2 * rng.standard_normal(form.basis.N)
        state = form.initial_state(begin, stress=stress)
        first = form.assemble(x, state)
        # a second increment back to half of the first
        found.append((first, form.assemble(0.5 * (x + begin), first.state)))
    for linear, by_point in zip(*found, strict=True):
        scale = np.linalg.norm(by_point.force)
        off = np.linalg.norm(linear.force - by_point.force)
        assert off <= linear.round_off + 1e-14 * scale, (off, linear.round_off)
        assert linear.round_off == pytest.approx(by_point.round_off, rel=1e-12)
        # rounding of x at the size of the motion, by the size of the elements
        strain = 1e-14 * max(size, 1e-2)
        np.testing.assert_allclose(linear.state.strain, by_point.state.strain, atol=20.0 * strain)
        np.testing.assert_allclose(
            linear.state.stress, by_point.state.stress, rtol=1e-12, atol=1e6 * strain
        )


def test_no_force_where_a_body_begins_and_after_unloading() -> None:
    """[X] What is left after activation at displacements, and after the load is gone, is called
    round-off.
    """
    for case in CASES:
        form = bodies(case)[0]
        x = 0.1 * np.random.default_rng(2).standard_normal(form.basis.N)
        at_start = form.assemble(x, form.initial_state(x))
        assert np.linalg.norm(at_start.force) <= at_start.round_off
        loaded = form.assemble(x, form.initial_state())
        unloaded = form.assemble(1e-16 * x, loaded.state)
        assert np.linalg.norm(unloaded.force) <= unloaded.round_off


def stages(law: type, element: object, options: dict) -> list:
    """Initial stresses, load, a stiffer and a softer region, a new body, a reset and unloading."""
    mesh = MeshQuad.init_tensor(np.linspace(0, 4, 9), np.linspace(0, 3, 7)).with_defaults()
    mesh = mesh.with_subdomains(
        {
            "low": lambda p: p[1] < 1,
            "high": lambda p: (p[1] > 1) & (p[1] < 2),
            "fill": lambda p: p[1] > 2,
        }
    )
    corners = isinstance(element, ElementQuad1)
    basis = Basis(mesh, ElementVector(element), intorder=2 if corners else None)
    laws = {"low": law(E=1e3, nu=0.3), "high": law(E=4e3, nu=0.2)}
    layers = basis.with_elements(["low", "high"])
    ground = sc.SolidForm(layers, laws, unit_weight=18.0, **options)
    fill = sc.SolidForm(
        basis.with_elements("fill"), law(E=2e3, nu=0.1), unit_weight=20.0, **options
    )
    stiffer = ground.with_materials({"low": law(E=5e5, nu=0.3)})
    supports = [sc.box_supports(basis)]
    above = np.setdiff1d(np.arange(basis.N), layers.element_dofs)
    start = sc.Model({"ground": ground}, [*supports, above]).k0_state(K0=0.5)
    model = sc.Model({"ground": ground, "fill": fill}, supports)
    load = basis.zeros()
    load[basis.get_dofs(lambda p: (p[1] == 2) & (p[0] < 2)).all("u^2")] = -10.0
    plan = [
        sc.Stage("load", load, increments=3),
        sc.Stage("stiffen", load, change={"ground": stiffer}),
        sc.Stage("more", 2.0 * load, increments=2),
        sc.Stage("fill", 2.0 * load, activate=["fill"]),
        sc.Stage("unload"),
    ]
    return list(model.run(plan, start=start, **QUIET))


@pytest.mark.parametrize(
    "element, options", [(ElementQuad2(), {}), (ElementQuad1(), {"strain": "b_bar"})]
)
def test_stages_give_the_same_digits(element: object, options: dict) -> None:
    """[N] Displacements, strains and stresses of all stages agree to 1e-12, and the iterations are
    as many.
    """
    pairs = zip(
        stages(sc.LinearElastic, element, options), stages(ByPoint, element, options), strict=True
    )
    for linear, by_point in pairs:
        scale = np.abs(by_point.x).max()
        np.testing.assert_allclose(linear.x, by_point.x, atol=1e-12 * scale)
        assert linear.iterations == by_point.iterations
        for name in by_point.states:
            for part in ("strain", "stress"):
                expected = getattr(by_point.states[name], part)
                actual = getattr(linear.states[name], part)
                np.testing.assert_allclose(actual, expected, atol=1e-12 * np.abs(expected).max())


def test_states_are_those_of_any_body(tmp_path) -> None:
    """Lazy states are copied, replaced, pickled and handed to a body of another law."""
    form, by_point = bodies("plane")
    x = 1e-2 * np.random.default_rng(3).standard_normal(form.basis.N)
    y = x.copy()
    state = form.assemble(y, form.initial_state()).state
    y[:] = 0.0  # the state keeps its displacements
    stress = by_point.assemble(x, by_point.initial_state()).state.stress
    assert type(state) is type(form.initial_state())
    assert not vars(state).keys() & {"strain", "stress"}
    copied = pickle.loads(pickle.dumps(state))
    np.testing.assert_allclose(copied.stress, stress, rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(replace(state, strain=0.0).stress, stress, rtol=1e-10, atol=1e-10)
    other = by_point.assemble(x, state)
    assert np.linalg.norm(other.force - form.assemble(x, state).force) < 1e-10
    with pytest.raises(AttributeError, match="no attribute 'stresses'"):
        state.stresses  # noqa: B018
