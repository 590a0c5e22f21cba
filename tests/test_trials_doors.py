"""Input that nearly fits: what is refused by name, and what is told."""

from __future__ import annotations

import time

import numpy as np
import pytest
from skfem import MeshTri

import skfem_contact as sc
from tests.tools.helpers import grid, vector_basis

ELASTIC = sc.LinearElastic(E=1e4, nu=0.3)


def halves(right: float = 1.0):
    """Basis of two bodies, "l" and "r", of which the second begins at an abscissa."""
    side = np.linspace(0.0, 1.0, 3)
    mesh = sc.join_bodies({"l": grid("Q1", side, side), "r": grid("Q1", right + side, side)})
    return vector_basis(mesh, "Q1", intorder=2)


def test_subdomain_without_weight():
    basis = halves()
    with pytest.raises(
        ValueError, match=r"4 elements of the subdomains \['r'\] have no unit weight"
    ):
        sc.SolidForm(basis, ELASTIC, unit_weight={"l": 20.0})
    left = sc.SolidForm(
        basis.with_elements("l"), ELASTIC, unit_weight={"l": 20.0}
    )  # weight of all that it has
    assert left.own_weight(np.array([0.0, -1.0])).sum() == pytest.approx(-20.0)
    model = sc.Model({"both": sc.SolidForm(basis, ELASTIC)}, basis.get_dofs("l:bottom").all())
    with pytest.warns(sc.AnalysisWarning, match=r"4 elements .* of 'both' are weightless") as told:
        model.weight({"l": 20.0})
    assert told[0].filename == __file__
    model.weight({"l": 20.0, "r": 0.0})
    assert len(told) == 1


def test_pair_of_another_mesh_is_named():
    basis, other = halves(), vector_basis(halves().mesh, "Q2")
    joint = sc.ContactPair(other, "l:right", "r:left", sc.Tied())
    with pytest.raises(ValueError, match=r"different bases.*<ContactPair l:right on r:left"):
        sc.Model(
            {"both": sc.SolidForm(basis, ELASTIC), "joint": joint}, basis.get_dofs("l:bottom").all()
        )


def test_many_stages_begin_at_once():
    """The checks of ten times as many stages take ten times as long, not a hundred times."""
    basis = halves()
    model = sc.Model(
        {"both": sc.SolidForm(basis, ELASTIC)}, [basis.get_dofs(f"{k}:bottom").all() for k in "lr"]
    )

    def stop(stage):
        raise KeyboardInterrupt

    def seconds(n):
        stages = [sc.Stage(f"{k}", basis.zeros()) for k in range(n)]
        began = time.process_time()
        with pytest.raises(KeyboardInterrupt):
            model.run(stages, on_increment=stop, progress=False)
        return time.process_time() - began

    seconds(1)
    assert seconds(20_000) < 30.0 * seconds(2_000)


def test_file_of_elements_in_another_order(tmp_path):
    """States follow the order of the materials: a file is refused where another one would exchange
    them.
    """
    basis = halves()

    def model(names):
        solid = sc.SolidForm(basis, dict.fromkeys(names, ELASTIC), unit_weight=20.0)
        return sc.Model({"soil": solid}, basis.get_dofs({"l:bottom", "r:bottom"}).all())

    model("lr").run([sc.Stage("weight")]).save(tmp_path / "weight.npz")
    assert sc.load_result(tmp_path / "weight.npz", model("lr"))["weight"].residual < 1e-12
    with pytest.raises(
        ValueError,
        match="'soil' has another mesh, or another order of the elements, which follow its",
    ):
        sc.load_result(tmp_path / "weight.npz", model("rl"))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: sc.rigid.level_set(lambda x, y: x + y, (-1.0, 1.0, -1.0, 1.0), resolution=0),
            "at least 2, not 0",
        ),
        (
            lambda: sc.MatrixForm(np.ones((2, 3, 4))),
            r"square matrix, not an array of shape \(2, 3, 4\)",
        ),
        (lambda: column().k0_state(K0=0.5, unit_weights={}), "unit_weights names no subdomain"),
        (lambda: sc.testing.check_material(ELASTIC, ncomp=0), "ncomp must be one of 4, 6, not 0"),
        (
            lambda: (
                column()
                .run([sc.Stage("w")])[-1]
                .section_forces("soil", sc.Sections.line((9, 1), (9, 0), 1))
            ),
            "at .9, 1",
        ),
        (
            lambda: column(gravity=(0.0, -9.81)),
            r"gravity must be a unit vector with 2 components, not \(0.0, -9.81\)",
        ),
        (lambda: column(seismic=(0.1, 0.1)), "seismic must be finite, with at most 1 components"),
        (lambda: column("axisymmetric", seismic=0.1), "weights act along the axis"),
        (lambda: column("axisymmetric", gravity=(0.6, -0.8)), "weights act along the axis"),
    ],
)
def test_nothing_given(call, message):
    """Grids without points, no weights, sections elsewhere, gravity of 9.81 or across an axis:
    refused by name.
    """
    with pytest.raises(ValueError, match=message):
        call()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: sc.Coulomb(mu=20.0), "mu is 20: it is the tangent of the angle"),
        (
            lambda: sc.hydrostatic(2.0, unit_weight=1000.0),
            "unit weight of water is 1000, which is its density",
        ),
        (
            lambda: sc.PoreWater(column().forms["soil"].basis, 1e-4, unit_weight=1e3),
            "water is 1000, which is its density",
        ),
        (
            lambda: sc.water.seepage(
                column().forms["soil"].basis, 1e-5, {"left": 1.0}, unit_weight=1025.0
            ),
            "water is 1025",
        ),
        (lambda: column().k0_state(K0=50.0), "K0 is 50: it is the ratio"),
        (
            lambda: column(E=1.0).run([sc.Stage("weight")]),
            "small; are E and the loads in the same units",
        ),
        (
            lambda: column(seismic=-10.0),
            "seismic is -10.0: it is the acceleration over that of gravity",
        ),
        (lambda: column(unit_weight={"all": -18.0}), "unit weights are positive"),
        (
            lambda: sc.mesh.check_mesh(MeshTri().translated((5e3, 5e4))),
            r"lies at \(5000, 5e\+04\), .* move it by",
        ),
    ],
)
def test_slips_are_told(make, message):
    """Angles for coefficients, densities for weights, per cent for ratios, MPa beside kN."""
    with pytest.warns(sc.AnalysisWarning, match=message):
        make()


def column(coordinates: str = "plane", E: float = 1e4, unit_weight: float | dict = 20.0, **options):
    """Model of a body of 1 m under its own weight."""
    mesh = grid("Q1", np.linspace(0, 1, 3), np.linspace(0, 1, 3)).with_subdomains(
        {"all": lambda x: x[0] > 0.0}
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    soil = sc.SolidForm(
        basis, sc.LinearElastic(E, 0.3), coordinates=coordinates, unit_weight=unit_weight
    )
    return sc.Model({"soil": soil}, sc.box_supports(basis), **options)


def test_sound_input_is_not_told(recwarn):
    sc.Coulomb(mu=[0.2, 5.0])
    sc.Coulomb(mu=1e6)
    sc.hydrostatic(2.0, unit_weight=9810.0)
    column(seismic=0.9)
    sc.mesh.check_mesh(MeshTri().translated((1e3, -1e3)))
    column().k0_state(K0=3.0)
    column().run([sc.Stage("weight")])
    assert not recwarn.list
