"""Fields at points and along lines of shells."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import MeshQuad

import skfem_contact as sc

QUIET = {"progress": False}


@pytest.fixture(scope="module")
def plate() -> sc.Result:
    """A square plate on simple supports under q = 1, then 3."""
    line = np.linspace(0, 1, 17)
    mesh = MeshQuad.init_tensor(line, line)
    points = np.column_stack((*mesh.p, 0 * mesh.p[0]))
    form = sc.Shell(None, points, E=12e3, nu=0.3, thickness=0.1, cells=mesh.t.T)
    rim = [p for p in points if p[:2].min() == 0.0 or p[:2].max() == 1.0]
    held = [dof for p in rim for dof in form.dofs(p, ["u^1", "u^2", "u^3"])]
    model = sc.Model({"plate": form}, held)
    load = model.forms["plate"].area_load((0.0, 0.0, -1.0))
    return model.run([sc.Stage("one", load), sc.Stage("three", 3.0 * load)], **QUIET)


def test_moments_along_a_line(plate):
    """[P] Timoshenko: 0.00406 q L^4 / D and 0.0479 q L^2 in the middle, symmetric; changes since a
    stage and histories have the same.
    """
    D = 12e3 * 0.1**3 / 12 / (1 - 0.3**2)
    stage = plate["one"]
    middle = stage.at((0.5, 0.5, 0.0), "uz", "u", "m_1", "m_2", "m_12", of="plate")
    assert -middle["uz"][0] * D == pytest.approx(0.00406, rel=5e-3)
    assert middle["u"] == pytest.approx(-middle["uz"])
    assert middle["m_1"][0] == pytest.approx(0.0479, rel=0.01)  # 1.4 % with half the elements
    assert middle["m_2"] == pytest.approx(middle["m_1"], rel=1e-9)
    assert abs(middle["m_12"][0]) < 1e-9

    # Between nodes, as symmetric as the load
    across = stage.along([(0.03, 0.5, 0.0), (0.97, 0.5, 0.0)], "m_1", "uz", of="plate", n=24)
    np.testing.assert_allclose(across["m_1"], across["m_1"][::-1], atol=1e-9)
    assert across["uz"].min() == pytest.approx(middle["uz"][0], rel=0.01)
    assert across["position"][-1] == pytest.approx(0.94)
    assert len(across.table) == 24
    (panel,) = stage.along([(0.03, 0.5, 0.0), (0.97, 0.5, 0.0)], "m_1", of="plate").plot().axes
    assert panel.get_ylabel() == "moment m_1"

    # In stages
    since = plate["three"].at((0.5, 0.5, 0.0), "m_1", of="plate", since=stage)
    assert since["m_1"] == pytest.approx(2.0 * middle["m_1"], rel=1e-9)
    history = plate.at({"middle": (0.5, 0.5, 0.0)}, "m_1", of="plate")
    assert history["m_1"] == pytest.approx([middle["m_1"][0], 3.0 * middle["m_1"][0]], rel=1e-9)


def test_values_are_linear_in_triangles(plate):
    """[X] At shares of the corners of triangles of the shell, also a little off its plane."""
    points, values = plate["one"].outputs("plate").triangles
    shares = np.array([0.2, 0.5, 0.3])
    for k in (0, 77, 400):
        at = shares @ points[3 * k : 3 * k + 3] + [0.0, 0.0, 1e-3]
        found = plate["one"].at(at, "m_1", "m_12", of="plate")
        for name in ("m_1", "m_12"):
            expected = shares @ values[name][3 * k : 3 * k + 3]
            assert found[name][0] == pytest.approx(expected, rel=1e-9)


def test_points_off_the_shell(plate):
    """Points beside it and above it are counted, and other fields named."""
    stage = plate["one"]
    for point in ((1.1, 0.5, 0.0), (0.5, 0.5, 0.1)):
        message = r"1 of 2 points lie outside of the shell 'plate': the first is \(" + str(point[0])
        with pytest.raises(ValueError, match=message):
            stage.at([(0.5, 0.5, 0.0), point], "m_1", of="plate")
    with pytest.raises(ValueError, match="no field of shells 'syy'"):
        stage.at((0.5, 0.5, 0.0), "syy", of="plate")


def test_the_only_shell_needs_no_name(plate):
    """Without solids the fields are of the only shell; of two shells one must be named."""
    stage = plate["one"]
    middle = (0.5, 0.5, 0.0)
    named = stage.at(middle, "m_1", of="plate")
    assert stage.at(middle, "m_1")["m_1"] == named["m_1"]
    line = [(0.1, 0.5, 0.0), (0.9, 0.5, 0.0)]
    assert np.array_equal(stage.along(line, "uz")["uz"], stage.along(line, "uz", of="plate")["uz"])
    assert plate.at(middle, "m_1")["m_1"][0] == named["m_1"]
    mesh = MeshQuad.init_tensor(*2 * [np.linspace(0, 1, 3)])
    forms = {}
    held = []
    for name, height in (("low", 0.0), ("high", 1.0)):
        points = np.column_stack((*mesh.p, np.full(mesh.nvertices, height)))
        forms[name] = sc.Shell(None, points, E=12e3, nu=0.3, thickness=0.1, cells=mesh.t.T)
        for p in points:
            held += forms[name].dofs(p)
    two = sc.Model(forms, held).run([sc.Stage("two")], **QUIET)["two"]
    with pytest.raises(ValueError, match="shells and no solids: name one, of='low' or 'high'"):
        two.at(middle, "uz")
    assert two.at(middle, "uz", of="low")["uz"] == 0.0
