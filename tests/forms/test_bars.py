"""Bars and struts that are prestressed."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementQuad1,
    ElementVector,
    MeshQuad,
)

import skfem_contact as sc
from skfem_contact.results import Result


@pytest.mark.parametrize("force", [30.0, 100.0])
def test_strut_that_is_prestressed_against_a_wall(force):
    """[X] A prestressed strut keeps its force; the wall slides in sand, and 25 iterations are
    enough.
    """
    across = np.concatenate((np.linspace(0, 6, 9), [6.25], 6.5 + 18 * np.linspace(0, 1, 13) ** 2))
    mesh = MeshQuad.init_tensor(across, np.linspace(0, 16, 33)).with_subdomains(
        {
            "concrete": lambda x: (x[0] > 6) & (x[0] < 6.5) & (x[1] > 6),
            "lift": lambda x: (x[0] < 6) & (x[1] > 14),
        }
    )
    rest = np.setdiff1d(np.arange(mesh.nelements), np.concatenate(list(mesh.subdomains.values())))
    mesh = sc.join_bodies(
        mesh.with_subdomains({"soil": rest}),
        bodies={"ground": ["soil", "lift"], "wall": "concrete"},
    )
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    sand, skin = sc.MohrCoulomb(E=4e4, nu=0.3, c=2.0, phi=30.0), sc.Coulomb(mu=0.36)
    laws = {"soil": sand, "lift": sand, "wall": sc.LinearElastic(E=3e7, nu=0.2)}
    forms = {
        name: sc.SolidForm(basis.with_elements(name), law, "b_bar", unit_weight=20.0)
        for name, law in laws.items()
    }
    forms |= {
        f"{name}|wall": sc.ContactPair(basis, f"{name}|wall", "wall|ground", skin, quadrature=2)
        for name in ("soil", "lift")
    }
    strut = forms["strut"] = sc.Bar(
        basis, (6.0, 15.0), (0.0, 15.0), EA=2e5, part="wall", fixed_end=True
    )
    model = sc.Model(forms, sc.box_supports(basis))
    stages = [
        sc.Stage("wall", sc.weight(basis, {"wall": 5.0}), deactivate=("strut",)),
        sc.Stage(
            "dug", sc.weight(basis, {"wall": 5.0}), deactivate=("lift", "lift|wall"), increments=4
        ),
        sc.Stage(
            "jacked",
            sc.weight(basis, {"wall": 5.0}),
            activate=("strut",),
            change={"strut": strut.prestressed(-force)},
        ),
    ]
    last = model.run(stages, start=model.k0_state(K0=0.5), progress=False)["jacked"]
    assert last.states["strut"].force[0] == -force
    assert sum(last.iterations) <= 25


def test_short_rope_is_slack_without_force() -> None:
    """[X] A rope of .05 m takes no compression at all, and EA times its strain in tension."""
    mesh = MeshQuad.init_tensor(np.linspace(0, 1, 2), np.linspace(0, 1, 2)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    rope = sc.Bar(basis, (0.0, 0.0), (-0.05, 0.0), EA=100.0, fixed_end=True, tension_only=True)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3))
    rope = sc.Model({"solid": solid, "rope": rope}).forms["rope"]
    for moved, force in ((-1e-3, 0.0), (1e-3, 100.0 * 1e-3 / 0.05)):
        x = basis.zeros()
        x[basis.nodal_dofs[0]] = moved
        found = rope.assemble(x, rope.initial_state()).force
        assert np.abs(found).max() == pytest.approx(force, abs=1e-12)


@pytest.mark.parametrize("fixed_end", [False, True])
def test_bars_that_turn_keep_their_length(fixed_end: bool) -> None:
    """[X] A bar of finite kinematics that turns with its body has no force; where it grows by 1 %
    on its way it has 1 % of EA, along its new axis.  The tangent is that of the force.
    """
    mesh = MeshQuad.init_tensor([0.0, 2.0], [0.0, 1.0]).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    start, end = np.array([[0.0, 1.0], [2.0, 0.0]])
    bar = sc.Bar(basis, [start], [end], EA=50.0, fixed_end=fixed_end, kinematics="finite")
    state = bar.initial_state()
    c, s = np.cos(0.7), np.sin(0.7)
    turned = np.array([[c, -s], [s, c]])
    axis = turned @ (end - start) / np.linalg.norm(end - start)

    def at(x: np.ndarray) -> sc.Response:
        return bar.assemble(x, state).padded(basis.N)

    for growth in (0.0, 0.01):
        # Turn and grow about the end, which stays in its place
        x = basis.zeros()
        moved = (1.0 + growth) * turned @ (mesh.p - end[:, None]) + end[:, None]
        x[basis.nodal_dofs] = moved - mesh.p
        forces = np.zeros((2, mesh.nvertices))
        forces[:, (mesh.p == start[:, None]).all(axis=0)] = -axis[:, None]
        if not fixed_end:
            forces[:, (mesh.p == end[:, None]).all(axis=0)] = axis[:, None]
        wanted = basis.zeros()
        wanted[basis.nodal_dofs] = 50.0 * growth * forces
        assert at(x).force == pytest.approx(wanted, abs=1e-12)

    way = 1e-4 * np.sin(np.arange(basis.N))
    change = 0.5 * (at(x + way).force - at(x - way).force)
    # the third derivative is 1e-8 of the change
    assert at(x).stiffness @ way == pytest.approx(change, abs=1e-6 * np.abs(change).max())


def ring(spacing: float | None, changed: float | None = None) -> Result:
    """A ring from 1 to 2, 4 high, of the unit weight 20, which hangs on bars at its outside."""
    mesh = MeshQuad.init_tensor(np.linspace(1, 2, 3), np.linspace(0, 4, 5)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    concrete = sc.LinearElastic(E=1e7, nu=0.2)
    body = sc.SolidForm(basis, concrete, coordinates="axisymmetric", unit_weight=20.0)
    ends = (2.0, 4.0), (2.0, 6.0)
    first, second = (
        sc.Bar(basis, *ends, EA=1e5, fixed_end=True, spacing=each)
        for each in (spacing, changed or spacing)
    )
    model = sc.Model({"ring": body, "hanger": first}, basis.get_dofs().all("u^1"))
    return model.run(
        [sc.Stage("weight"), sc.Stage("changed", change={"hanger": second})], progress=False
    )


@pytest.mark.parametrize("n", [3, 8])
def test_bars_in_axial_symmetry_count_per_radian_or_by_the_angle_between_them(n: int) -> None:
    """[X] The weight 20 * 4 * (2**2 - 1**2) / 2 = 120 per radian, of which n hangers have 2 pi / n
    each.
    """
    for stage in ring(None):
        np.testing.assert_allclose(stage.states["hanger"].force, 120.0)
    for stage in ring(2 * np.pi / n):
        np.testing.assert_allclose(stage.states["hanger"].force, 120.0 * 2 * np.pi / n)
        parameters = stage.outputs("hanger").parameters  # an angle has no unit of length
        assert parameters["angle of spacing"] == 2 * np.pi / n
        assert "spacing" not in parameters


def test_a_distance_is_no_spacing_in_axial_symmetry() -> None:
    """[X] 2 pi / 2 members make no circle, in the model and in the change of a stage."""
    with pytest.raises(ValueError, match=r"a spacing of 2 makes 3\.142 members round the axis"):
        ring(2.0)
    with pytest.raises(ValueError, match=r"a spacing of 2 makes 3\.142 members round the axis"):
        ring(np.pi / 2, changed=2.0)
    with pytest.raises(ValueError, match=r"a spacing of 1 makes 6\.283 members round the axis"):
        ring(1.0)


def test_files_of_bars_without_a_row(tmp_path) -> None:
    """In the plane bars of a spacing of one are bars a unit of length: files of one are of both."""
    beam = sc.Beam(None, [(0.0, 0.0), (0.0, -2.0)], EI=10.0, EA=1e3)
    saved = []
    for spacing in (1.0, None):
        at = beam.at((0.0, 0.0))
        bar = sc.Bar(None, at, (4.0, 3.0), EA=75.0, fixed_end=True, spacing=spacing)
        saved.append(sc.Model({"beam": beam, "bar": bar}, beam.dofs((0.0, -2.0))))
    old, new = saved
    old.run([sc.Stage("rest")], progress=False).save(tmp_path / "old.npz")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sc.load_result(tmp_path / "old.npz", new)
