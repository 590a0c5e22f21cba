"""Newton's method: order of convergence, closed forms of contact problems, invariances, loops of
one's own.
"""

from __future__ import annotations

import ast
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve
from skfem import BilinearForm, FacetBasis, Mesh, condense, solve
from skfem.utils import solver_direct_scipy

import skfem_contact as sc
from skfem_contact.contact.interface import ContactState
from skfem_contact.contact.laws import Status
from skfem_contact.contact.penalty import choose_penalties
from skfem_contact.nonlinear.newton import Evaluation, Problem, full_step
from tests.tools.helpers import (
    body_along,
    grid,
    rotation,
    run_stages,
    traction,
    unknowns_of,
    vector_basis,
)

#: For comparisons to nine digits; a penalty of 1e6 times the round-off of coordinates is 1e-12 of
#: the forces.
EXACT = sc.Newton(tolerance=1e-11, max_iterations=40)


def run(forms, load, fixed, prescribed=None, increments=1, **options):
    """One stage of loading from rest."""
    stage = sc.Stage("load", load, prescribed, increments)
    return run_stages(forms, [stage], fixed, **{"newton": EXACT, "progress": False, **options})[
        "load"
    ]


def two_blocks(
    element: str = "Q1", n: int = 4, gap: float = 0.0, overhang: float = 0.0, mapped=None
):
    """A unit block above another one, as wide or wider; boundaries "upper:bottom" and so on."""
    blocks = {
        "lower": grid(
            element, np.linspace(-overhang, 1 + overhang, n + 1), np.linspace(-1, 0, n + 1)
        ),
        "upper": grid(element, np.linspace(0, 1, n + 2), np.linspace(gap, 1 + gap, n + 1)),
    }
    if mapped is not None:
        blocks = {name: mapped(mesh) for name, mesh in blocks.items()}
    return vector_basis(sc.join_bodies(blocks), element, intorder=2 if element == "Q1" else None)


@pytest.mark.parametrize("quadrature", ["nodal", 2, "segments"])
@pytest.mark.parametrize("element", ["P1", "P2", "Q1", "Q2", "QuadS2"])
def test_penalty_bar(element, quadrature):
    """[X] Case A1: a column closes a gap of 0.05 against a rigid stop; the modulus is the
    oedometric one.
    """
    modulus, nu, F, gap, eps = 1000.0, 0.3, 100.0, 0.05, 1e5
    E = modulus * (1 + nu) * (1 - 2 * nu) / (1 - nu)
    basis = vector_basis(grid(element, np.linspace(0, 1, 4), np.linspace(0, 1, 5)), element)
    forms = {
        "column": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=nu)),
        "stop": sc.ContactPair(
            basis,
            "bottom",
            sc.rigid.line((-1.0, -gap), (2.0, -gap)),
            sc.Coulomb(),
            quadrature,
            penalty=eps,
        ),
    }
    fixed = np.concatenate(
        (basis.get_dofs("top").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    )
    result = run(forms, traction(basis, "bottom", (0.0, -F)), fixed)
    u = -result.x[basis.get_dofs("bottom").all("u^2")]
    # the residual is solved to 1e-13 of the load, 100; u is of the order 0.05 and the stiffness 1e5
    np.testing.assert_allclose(u, (F + eps * gap) / (modulus + eps), rtol=1e-12)
    np.testing.assert_allclose(u, 0.0504950495049505, rtol=1e-12)
    np.testing.assert_allclose(-result.states["stop"].traction[0], 49.5049504950495, rtol=1e-10)
    force = forms["stop"].assemble(result.x, result.states["stop"]).force[1::2].sum()
    exact = F - modulus * gap
    assert 1 + force / exact == pytest.approx(
        1 / (1 + eps / modulus), rel=1e-8
    )  # two digits lost in 1 - 0.99
    assert len(result.iterations) == 1 and result.iterations[0] <= 3


@pytest.mark.parametrize("ratio", [0.9, pytest.param(1.1, marks=pytest.mark.slow)])
@pytest.mark.parametrize("quadrature", ["nodal", 2, "segments"])
def test_frictional_patch(quadrature, ratio):
    """[X] Case A10: sides carry the shear; below mu p all points stick, above it no equilibrium
    exists.
    """
    mu, p = 0.4, 10.0
    q = ratio * mu * p
    basis = two_blocks()
    forms = {
        "blocks": sc.SolidForm(
            basis, sc.LinearElastic(E=1e4, nu=0.0)
        ),  # it does not widen under pressure
        "joint": sc.ContactPair(
            basis, "upper:bottom", "lower:top", sc.Coulomb(mu), quadrature, penalty=1e6
        ),
    }
    # pressure and pure shear on the upper block: only the joint holds it
    load = traction(basis, "upper:top", (q, -p)) + traction(basis, "upper:left", (0, -q))
    load = load + traction(basis, "upper:right", (0, q))
    fixed = unknowns_of(basis, "lower").ravel()
    squeeze = sc.Stage("pressure", traction(basis, "upper:top", (0, -p)))
    stages = [squeeze, sc.Stage("shear", load)]
    if ratio > 1:
        with pytest.raises(sc.NotConverged) as error:
            # the stage that fails tries many increments
            newton = sc.Newton(EXACT.tolerance, max_iterations=8)
            sc.Model(forms, fixed, newton=newton).run(stages, progress=False)
        partial = error.value.result
        assert [s.name for s in partial] == ["pressure", "shear"]
        # the last increment holds at the limit, to the smallest increment of a thousandth
        assert partial["shear"].fraction == pytest.approx(1 / ratio, abs=2e-3)
        return
    result = sc.Model(forms, fixed, newton=EXACT).run(stages, progress=False)["shear"]
    state = result.states["joint"]
    assert (state.status == Status.STICK).all()
    np.testing.assert_allclose(state.traction[0], -p, rtol=1e-8)
    np.testing.assert_allclose(state.traction[1], q, rtol=1e-8)
    np.testing.assert_allclose(state.slip[0], q / 1e6, rtol=1e-6)
    stress = result.states["blocks"].stress[:, basis.mesh.subdomains["upper"]]
    np.testing.assert_allclose(stress[1], -p, rtol=1e-8)
    np.testing.assert_allclose(stress[3], q, rtol=1e-8)


@pytest.mark.parametrize("quadrature", ["nodal", 3, "segments"])
def test_frictional_patch_slips(quadrature):
    """[X] Case A10 under displacement control: shear tau = mu p everywhere, whatever the
    distance.
    """
    E, nu, mu, p = 1e4, 0.2, 0.4, 10.0
    modulus, G = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)), E / (2 + 2 * nu)
    basis = two_blocks(overhang=0.5)
    forms = {
        "blocks": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=nu)),
        "joint": sc.ContactPair(
            basis, "upper:bottom", "lower:top", sc.Coulomb(mu), quadrature, penalty=1e6
        ),
    }
    # the exact field: uniform strain under -p and mu p, and any rigid shift
    upper = unknowns_of(basis, "upper")
    y = basis.doflocs[1, upper[:, 0]]
    fields, signs = [], (1, 1, -1)
    for shift, sign in zip((0.05, 0.3, 0.1), signs, strict=True):
        field = basis.zeros()
        field[upper] = np.stack((sign * mu * p / G * y + shift, -p / modulus * y - p / 1e6), axis=1)
        fields.append(field)
    held = basis.get_dofs({"upper:left", "upper:right", "upper:top"}).all()
    fixed = np.concatenate((unknowns_of(basis, "lower").ravel(), held))
    stages = [sc.Stage(f"shift {k}", basis.zeros(), field) for k, field in enumerate(fields)]
    result = sc.Model(forms, fixed, newton=EXACT).run(stages, progress=False)
    for stage, field, sign in zip(result, fields, signs, strict=True):
        state = stage.states["joint"]
        np.testing.assert_allclose(state.traction[0], -p, rtol=1e-8)
        np.testing.assert_allclose(state.traction[1], sign * mu * p, rtol=1e-8)
        np.testing.assert_allclose(stage.x, field, atol=1e-10)


@pytest.mark.parametrize("quadrature", ["nodal", 2])
def test_block_pushed_off(quadrature):
    """[X] Case C6: W = 100, a = 2.5, phi = 26.6 degrees on 4 m: 60.076 kN/m, however far it is
    pushed.
    """
    phi = np.tan(np.radians(26.6))
    mesh = sc.join_bodies(
        {
            "base": grid("Q1", np.linspace(-1, 6, 29), np.linspace(-0.5, 0, 3)),
            "block": grid("Q1", np.linspace(0, 4, 14), np.linspace(0, 1, 4)),
        }
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    forms = {
        "solid": sc.SolidForm(
            basis,
            {"base": sc.LinearElastic(E=3e7, nu=0.2), "block": sc.LinearElastic(E=3e7, nu=0.2)},
        ),
        "joint": sc.ContactPair(
            basis, "block:bottom", "base:top", sc.Coulomb(phi, 2.5), quadrature, penalty=1e7
        ),
    }
    own = sc.weight(basis, {"block": 25.0})
    pushed = basis.get_dofs("block:left").all("u^1")
    fixed = np.concatenate((basis.get_dofs("base:bottom").all(), pushed))
    result = sc.Model(forms, fixed).run(
        [sc.Stage("weight", own)]
        + [sc.Stage(f"push {k}", own, k * 0.3 * _at(basis, pushed)) for k in (1, 2, 3)],
        progress=False,
    )
    for stage in list(result)[1:]:
        internal = sum(f.assemble(stage.x, stage.states[k]).force for k, f in forms.items())
        force = internal[pushed].sum()
        # the corners are open over a thousandth of the length at most
        assert force == pytest.approx(4 * 2.5 + 100 * phi, rel=2e-3)
        joint = stage.states["joint"]
        total = (forms["joint"].points(joint).weight * joint.traction[0]).sum()
        assert total == pytest.approx(-100, rel=1e-6)


def _at(basis, dofs) -> np.ndarray:
    x = basis.zeros()
    x[dofs] = 1.0
    return x


def own_loop(forms, load, fixed, x, state, prescribed=None, tolerance=1e-13, most=30):
    """The loop of the user guide; also the norms of the residual and the statuses of all
    iterations.
    """
    free = np.setdiff1d(np.arange(len(x)), fixed)
    if prescribed is not None:
        x = x.copy()
        x[fixed] = prescribed[fixed]
    norms, statuses = [], []
    for _ in range(most):
        out = {name: f.assemble(x, state[name]) for name, f in forms.items()}
        r = load - sum(o.force for o in out.values())
        scale = max(np.linalg.norm(load), *(np.linalg.norm(o.force) for o in out.values()))
        norms.append(np.linalg.norm(r[free]) / scale)
        statuses.append([o.state.status for o in out.values() if isinstance(o.state, ContactState)])
        if norms[-1] < tolerance:
            break
        x = x + solve(*condense(sum(o.stiffness for o in out.values()), r, D=fixed))
    return x, {name: o.state for name, o in out.items()}, np.array(norms), statuses


def bent_contact(law, tangent: str, smoothing=None):
    """A stiff arch that turns by 12 degrees on a soft block: large rotation of the interface."""
    arch = np.stack(
        (np.linspace(0.9, -0.9, 10), 0.35 * np.linspace(0.9, -0.9, 10) ** 2 - 0.02), axis=1
    )
    mesh = sc.join_bodies(
        {
            "arch": body_along(arch, "Q1", 0.4),
            "block": grid("Q1", np.linspace(-2, 2, 17), np.linspace(-2, 0, 9)),
        }
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    forms = {
        "solid": sc.SolidForm(
            basis,
            {"arch": sc.LinearElastic(E=1e5, nu=0.3), "block": sc.LinearElastic(E=1e3, nu=0.3)},
        ),
        "joint": sc.ContactPair(
            basis,
            "block:top",
            "arch:face",
            law,
            3,
            penalty=2e4,
            tangent=tangent,
            smoothing=smoothing,
        ),
    }
    body = unknowns_of(basis, "arch")
    back = body[np.isin(body[:, 0], basis.get_dofs(lambda x: x[1] > 0.35 * x[0] ** 2 + 0.15).all())]
    fixed = np.concatenate((basis.get_dofs("block:bottom").all(), back.ravel()))
    place = basis.zeros()
    place[back] = basis.doflocs[:, back[:, 0]].T @ (rotation(12) - np.eye(2)).T + [0.0, -0.08]
    return basis, forms, fixed, place


@pytest.mark.parametrize(
    "law", [sc.Coulomb(), sc.Coulomb(10.0), sc.Coulomb(0.2)], ids=["smooth", "stick", "slip"]
)
def test_quadratic_convergence(law):
    """[X] Case B5: with a fixed status the exact tangent squares the residual; the primary one does
    not.
    """
    orders, settled = {}, np.zeros(0)
    for tangent in ("exact", "primary"):
        basis, forms, fixed, place = bent_contact(law, tangent, smoothing=0.5)
        start = {name: f.initial_state() for name, f in forms.items()}
        x, state = basis.zeros(), start
        for share in (0.25, 0.5, 0.75):
            x, state, *_ = own_loop(
                forms, basis.zeros(), fixed, x, state, share * place, tolerance=1e-11, most=60
            )
        x, _, norms, statuses = own_loop(
            forms, basis.zeros(), fixed, x, state, place, tolerance=1e-13, most=60
        )
        orders[tangent] = norms
        assert norms[-1] < 1e-12
        if tangent == "exact":
            same = [
                all(np.array_equal(a, b) for a, b in zip(s, statuses[-1], strict=True))
                for s in statuses
            ]
            settled = norms[len(same) - same[::-1].index(False) if False in same else 0 :]
    # from where the status stays: r_new <= C r^2 down to round-off, over at least two steps
    assert len(settled) >= 3
    assert (settled[1:] <= np.maximum(10 * settled[:-1] ** 2, 1e-14)).all()
    assert len(orders["exact"]) <= 9
    # linear: the last steps above round-off gain a factor, not a doubling of digits
    last = orders["primary"][orders["primary"] > 1e-13]
    assert last[-1] > 100 * last[-2] ** 2 and len(orders["primary"]) > len(orders["exact"])


def test_ten_lines_of_the_user_guide():
    """[X] One's own loop with scikit-fem's condense and solve gives the displacements of run."""
    basis = two_blocks()
    materials = {
        "lower": sc.MohrCoulomb(E=1e4, nu=0.2, c=16.0, phi=20.0),
        "upper": sc.LinearElastic(E=1e4, nu=0.2),
    }
    forms = {
        "blocks": sc.SolidForm(basis, materials),
        "joint": sc.ContactPair(
            basis, "upper:bottom", "lower:top", sc.Coulomb(0.3), quadrature="nodal", penalty=1e6
        ),
    }
    fixed = basis.get_dofs("lower:bottom").all()
    load = sc.weight(basis, 20.0) + traction(basis, "upper:top", (1.0, -20.0))
    x, state, norms, _ = own_loop(
        forms,
        load,
        fixed,
        basis.zeros(),
        {k: f.initial_state() for k, f in forms.items()},
        tolerance=1e-12,
    )
    assert norms[-1] < 1e-12
    result = run(forms, load, fixed)
    np.testing.assert_allclose(result.x, x, atol=1e-9 * np.abs(x).max())
    np.testing.assert_allclose(
        result.states["joint"].traction[0], state["joint"].traction[0], atol=1e-8
    )
    assert result.states["blocks"].internal.max() > 0


@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")  # the penalty is a soft one
@pytest.mark.parametrize("solver", [solver_direct_scipy(), spsolve])
def test_solver_of_the_user(solver):
    """[X] A scikit-fem solver, or any function (A, b) -> x."""
    calls = []

    def counting(A, b, **options):
        calls.append(A.shape)
        return solver(A, b, **options)

    basis, forms, fixed, place = bent_contact(sc.Coulomb(0.3), "exact")
    ours, theirs = (run(forms, basis.zeros(), fixed, place, 4, solver=s) for s in (None, counting))
    assert len(calls) == sum(theirs.iterations) > 0
    assert set(calls) == {(basis.N - len(np.unique(fixed)),) * 2}
    np.testing.assert_allclose(ours.x, theirs.x, atol=1e-10 * np.abs(ours.x).max())


def pushed_blocks(
    mapped=None, element: str = "Q1", scale: dict | None = None, mirror: bool = False
):
    """An upper block pressed down and pushed aside with friction and yielding: displacements of all
    nodes.

    Parameters
    ----------
    mapped
        Function of a mesh, applied to each body, together with the rotation of vectors that belongs
        to it.
    scale
        Units: factors of length, and of force by area.
    mirror
        Whether to push to the left.
    """
    units = {"length": 1.0, "stress": 1.0} | (scale or {})
    change, turn = (None, np.eye(2)) if mapped is None else mapped
    basis = two_blocks(element, mapped=change)
    stress, length = units["stress"], units["length"]
    materials = {
        "lower": sc.MohrCoulomb(E=1e4 * stress, nu=0.3, c=5.0 * stress, phi=25.0),
        "upper": sc.LinearElastic(E=2e4 * stress, nu=0.2),
    }
    forms = {
        "blocks": sc.SolidForm(basis, materials, strain="b_bar" if element == "Q1" else "full"),
        "joint": sc.ContactPair(
            basis, "upper:bottom", "lower:top", sc.Coulomb(0.3, 0.5 * stress), 2
        ),
    }
    top, bottom = basis.get_dofs("upper:top"), basis.get_dofs("lower:bottom").all()
    places = [basis.zeros(), basis.zeros()]
    nodes = top.all().reshape(-1, 2)
    places[0][nodes] = turn @ [0.0, -2e-3 * length]
    places[1][nodes] = turn @ [(-1 if mirror else 1) * 3e-3 * length, -2e-3 * length]
    own = sc.weight(basis, 20.0 * stress / length, direction=tuple(turn @ [0.0, -1.0]))
    stages = [sc.Stage("press", own, places[0], 2), sc.Stage("push", own, places[1], 4)]
    result = sc.Model(forms, np.concatenate((top.all(), bottom)), newton=EXACT).run(
        stages, progress=False
    )
    return basis, forms, result


def test_the_reference_of_the_invariances_is_no_trivial_one():
    """[X] It slips and sticks and yields."""
    _, _, result = pushed_blocks()
    status = np.concatenate([s.states["joint"].status for s in result])
    assert set(status) >= {Status.STICK, Status.SLIP}
    assert 0.05 < (result["push"].states["blocks"].internal > 0).mean() < 0.9


def turned_by(degrees: float):
    Q = rotation(degrees)
    return lambda mesh: replace(mesh, doflocs=Q @ mesh.doflocs), Q


@pytest.mark.parametrize("element", ["Q1", "P2"])
def test_rotation_of_everything_changes_nothing(element):
    """[X] Case S18: bodies, supports and loads at 37 degrees: the same displacements, turned."""
    _, _, straight = pushed_blocks(element=element)
    change, Q = turned_by(37.0)
    _, _, turned = pushed_blocks((change, Q), element)
    for a, b in zip(straight, turned, strict=True):
        expected = (a.x.reshape(-1, 2) @ Q.T).ravel()
        # equilibrium to 1e-13 of forces; the tangent's condition number of 1e4 is between
        np.testing.assert_allclose(b.x, expected, atol=1e-9 * np.abs(expected).max())
        for old, new in zip(a.states["joint"].traction, b.states["joint"].traction, strict=True):
            np.testing.assert_allclose(new, old, atol=1e-8 * np.abs(old).max())


def renumbered(mesh: Mesh) -> Mesh:
    """The same mesh with nodes and elements in random order, and elements that begin at another
    corner.
    """
    rng = np.random.default_rng(5)
    order, elements = rng.permutation(mesh.nvertices), rng.permutation(mesh.nelements)
    t = np.roll(np.argsort(order)[mesh.t], 1, axis=0)[:, elements]
    return type(mesh)(mesh.p[:, order], t).with_defaults()


@pytest.mark.parametrize("element", ["Q1", "P2"])
def test_renumbering_changes_nothing(element):
    """[X] Case S18."""
    first, _, straight = pushed_blocks(element=element)
    other, _, mixed = pushed_blocks((renumbered, np.eye(2)), element)
    for body in ("lower", "upper"):
        a, b = unknowns_of(first, body), unknowns_of(other, body)
        rank = [
            np.lexsort(basis.doflocs[:, d[:, 0]].round(9)) for basis, d in ((first, a), (other, b))
        ]
        a, b = a[rank[0]], b[rank[1]]
        np.testing.assert_allclose(first.doflocs[:, a[:, 0]], other.doflocs[:, b[:, 0]], atol=1e-12)
        for s, t in zip(straight, mixed, strict=True):
            np.testing.assert_allclose(t.x[b], s.x[a], atol=1e-9 * np.abs(s.x).max())


@pytest.mark.parametrize(
    "stress, length", [(1e3, 1.0), (1e-3, 1e3), (1e6, 1e-3)], ids=["Pa", "MPa, mm", "km"]
)
def test_units_change_nothing(stress, length):
    """[X] Case S3: the same problem in other units, with default penalties and tolerances."""
    _, _, ours = pushed_blocks()

    def scaled(mesh):
        return replace(mesh, doflocs=length * mesh.doflocs)

    _, _, theirs = pushed_blocks((scaled, np.eye(2)), scale={"stress": stress, "length": length})
    for a, b in zip(ours, theirs, strict=True):
        np.testing.assert_allclose(b.x / length, a.x, atol=1e-8 * np.abs(a.x).max())
        for old, new in zip(
            a.states["joint"].traction, b.states["joint"].traction / stress, strict=True
        ):
            np.testing.assert_allclose(new, old, atol=1e-8 * np.abs(old).max())
        assert a.iterations == b.iterations


@pytest.mark.parametrize("element", ["Q1", "Q2", "P1"])
def test_mirrored_problem(element):
    """[X] Case S17: pushed to the left on a mirrored mesh: the mirrored result."""
    mirrored = np.array([-1.0, 1.0])

    def mirror(mesh):
        return type(mesh)(mesh.p * [[-1], [1]], mesh.t, _boundaries=mesh.boundaries)

    first, _, right = pushed_blocks(element=element)
    _, _, left = pushed_blocks((mirror, np.eye(2)), element, mirror=True)
    for a, b in zip(right, left, strict=True):
        expected = (a.x.reshape(-1, 2) * mirrored).ravel()
        assert b.x.shape == (first.N,)
        np.testing.assert_allclose(b.x, expected, atol=1e-9 * np.abs(expected).max())


def test_symmetric_problem_has_a_symmetric_result():
    """[X] Case S17: a punch on a wider block, friction and yielding: left and right to ten digits.

    No node of the punch faces one of the soil: which of two segments it belongs to would be
    arbitrary.
    """
    mesh = sc.join_bodies(
        {
            "soil": grid("Q1", np.linspace(-2, 2, 17), np.linspace(-1.5, 0, 7)),
            "punch": grid("Q1", np.linspace(-0.45, 0.45, 6), np.linspace(0, 0.5, 3)),
        }
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    materials = {
        "soil": sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=20.0),
        "punch": sc.LinearElastic(E=1e6, nu=0.2),
    }
    forms = {
        "solid": sc.SolidForm(basis, materials, "b_bar"),
        "joint": sc.ContactPair(
            basis, "punch:bottom", "soil:top", sc.Coulomb(0.3), quadrature="nodal"
        ),
    }
    fixed = basis.get_dofs({"soil:bottom", "soil:left", "soil:right", "punch:top"}).all()
    place = basis.zeros()
    place[basis.get_dofs("punch:top").all("u^2")] = -0.01
    result = run(forms, basis.zeros(), fixed, place, 4)
    assert result.states["solid"].internal.max() > 0
    for body in ("soil", "punch"):
        dofs = unknowns_of(basis, body)
        x, y = basis.doflocs[:, dofs[:, 0]].round(9)
        order, mirrored = np.lexsort((x, y)), np.lexsort((-x, y))
        u, v = result.x[dofs[order]], result.x[dofs[mirrored]]
        np.testing.assert_allclose(u, v * [-1, 1], atol=1e-10 * np.abs(result.x).max())


def test_far_from_the_origin():
    """[X] Coordinates of a national grid: the same problem 500 km away converges as well, to the
    same result.
    """
    _, _, here = pushed_blocks()

    def moved(mesh):
        return mesh.translated((2.0**19, -(2.0**19)))

    _, _, there = pushed_blocks((moved, np.eye(2)))
    for a, b in zip(here, there, strict=True):
        # the mesh itself is rounded to 1e-10
        np.testing.assert_allclose(b.x, a.x, atol=1e-8 * np.abs(a.x).max())
        assert a.iterations == b.iterations


# -- the loop of the guide, where bodies lift off


def documented(*names):
    """Functions that the guide defines, as it defines them."""
    text = (Path(__file__).parents[2] / "docs" / "guide" / "forms.md").read_text(encoding="utf-8")
    code = next(
        block
        for block in re.findall(r"```python\n(.*?)```", text, re.S)
        if f"def {names[0]}(" in block
    )
    scope = {"np": np, "sc": sc, "solve": solve, "condense": condense}
    tree = ast.parse(code)
    tree.body = [node for node in tree.body if isinstance(node, ast.FunctionDef | ast.ImportFrom)]
    exec(compile(tree, "forms.md", "exec"), scope)
    return [scope[name] for name in names]


@pytest.fixture(scope="module")
def footing_on_springs():
    """A block that stands on a slab on soft springs; pressed and pushed outside of its core, it
    lifts off.
    """
    base = grid("Q2", np.linspace(0, 4, 25), np.linspace(0, 0.5, 5))
    block = grid("Q2", np.linspace(1, 2.5, 13), np.linspace(0.5, 1.5, 9))
    basis = vector_basis(sc.join_bodies({"base": base, "block": block}), "Q2", intorder=4)
    bottom = FacetBasis(basis.mesh, basis.elem, facets="base:bottom")
    bed = BilinearForm(lambda u, v, w: 2e4 * (u[0] * v[0] + u[1] * v[1])).assemble(bottom)
    forms = {
        "solid": sc.SolidForm(basis, sc.LinearElastic(E=3e7, nu=0.2)),
        "bed": sc.MatrixForm(bed),
        "joint": sc.ContactPair(
            basis, "block:bottom", "base:top", sc.Coulomb(mu=0.5), quadrature=2
        ),
    }
    return basis, choose_penalties(forms)


#: Share by which the pressure grows along the block, and the push.
PUSHES = [(0.0, 0.0), (1.0, 10.0), (1.0, 20.0), (3.0, 20.0), (1.0, 22.0)]


@pytest.mark.parametrize(("eccentric", "push"), PUSHES)
@pytest.mark.one_in(3)
def test_loop_of_the_guide_holds_where_a_block_lifts_off(
    footing_on_springs, eccentric: float, push: float
) -> None:
    """[X] It finds the equilibrium that `run` finds, and what it finds balances."""
    basis, forms = footing_on_springs
    (equilibrium,) = documented("equilibrium")
    load = sc.traction(
        basis, "block:top", lambda x: np.stack((push + 0 * x[0], -50 * (1 + eccentric * x[0])))
    )
    none = np.zeros(0, int)
    start = {name: form.initial_state() for name, form in forms.items()}
    x, state = equilibrium(forms, basis.zeros(), start, load, none)
    left = load - sum(form.assemble(x, state[name]).force for name, form in forms.items())
    assert np.linalg.norm(left) < 1e-7 * np.linalg.norm(
        load
    )  # ten times the loop's tolerance: assembled again
    assert (state["joint"].status == Status.OPEN).any()
    stage = sc.Model(forms, none).run([sc.Stage("load", load)], progress=False)["load"]
    assert len(stage.iterations) == 1  # nothing is cut: the problem is homogeneous
    # residuals of 1e-8 on springs that are softer than the bodies by 1e3
    np.testing.assert_allclose(x, stage.x, atol=1e-6 * np.abs(stage.x).max())


def test_full_steps_are_halved_where_bodies_have_no_response():
    """[X] A step that turns elements inside out is halved four times, others are whole, whatever
    their residual.
    """

    class Narrow(Problem):
        def evaluate(self, z):
            if np.abs(z).max() > 0.3:
                raise sc.NotConverged("an element turns inside out", z)
            return Evaluation(z, {}, 1e3 * z, norm=1e3)

    now = Evaluation(np.zeros(2), {}, np.ones(2), norm=1.0)
    assert full_step(now, np.full(2, 0.2), Narrow()).z.tolist() == [0.2, 0.2]
    assert full_step(now, np.ones(2), Narrow()).z.tolist() == [0.25, 0.25]
    with pytest.raises(sc.NotConverged, match="inside out"):
        full_step(now, np.full(2, 10.0), Narrow())
