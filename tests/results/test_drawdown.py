"""Strengths after a rapid drawdown, by the three-stage method."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc

C, PHI, C_R, PHI_R = 5.0, 32.0, 12.0, 16.0


def stage_of(vertical, horizontal, shear=0.0):
    """A square with one effective stress, compression positive, and the solid's name."""
    basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3))
    stress = np.array([-horizontal, -vertical, -horizontal, shear])[:, None, None]
    state = solid.initial_state(stress=np.tile(stress, (1, *solid.weight.shape)))
    return sc.results.of({"clay": solid}, basis.zeros(), {"clay": state})


def strength(stage, **more):
    return stage.drawdown_strength("clay", c=C, phi=PHI, c_R=C_R, phi_R=PHI_R, **more)["all"][0]


def line(normal):
    """Line of isotropic consolidation on the failure plane: tangent to the circles of R tests.

    A test consolidated to s3 fails with s1 - s3 = 2 (c_R cos + s3 sin) / (1 - sin); the shear
    stress on the plane of failure is half of it times cos(phi').
    """
    r = np.radians(PHI_R)
    difference = 2 * (C_R * np.cos(r) + normal * np.sin(r)) / (1 - np.sin(r))
    return 0.5 * difference * np.cos(np.radians(PHI))


def test_isotropic_consolidation():
    """[X] The strength of an R test that was consolidated to the same stress."""
    assert np.isclose(strength(stage_of(80.0, 80.0)), line(80.0), rtol=1e-12)


def test_consolidation_at_failure():
    """[X] Stresses at failure give the drained strength: s1 = s3 K + 2 c sqrt(K)."""
    K = np.tan(np.radians(45 + PHI / 2)) ** 2
    s3 = 40.0
    s1 = s3 * K + 2 * C * np.sqrt(K)
    f = np.radians(PHI)
    normal = 0.5 * ((s1 + s3) - (s1 - s3) * np.sin(f))
    assert np.isclose(strength(stage_of(s1, s3)), C + normal * np.tan(f), rtol=1e-9)


def test_between_the_lines():
    """[N] Interpolation by the ratio of the principal stresses, computed from the definition."""
    s1, s3 = 120.0, 70.0
    f = np.radians(PHI)
    normal = 0.5 * ((s1 + s3) - (s1 - s3) * np.sin(f))
    at_failure = ((normal + C * np.cos(f)) * (1 + np.sin(f))) / (
        (normal - C * np.cos(f)) * (1 - np.sin(f))
    )
    K = s1 / s3
    drained = C + normal * np.tan(f)
    expected = ((at_failure - K) * line(normal) + (K - 1) * drained) / (at_failure - 1)
    assert np.isclose(strength(stage_of(s1, s3)), expected, rtol=1e-12)
    # turned by 45 degrees the principal stresses are the same
    mean, radius = 0.5 * (s1 + s3), 0.5 * (s1 - s3)
    assert np.isclose(strength(stage_of(mean, mean, radius)), expected, rtol=1e-12)


def test_little_or_no_consolidation_counts_the_lower_line():
    """[X] The drained line where hardly anything, or less than nothing, presses on the plane; the
    line of isotropic consolidation where the smaller principal stress is a tension.
    """
    f = np.radians(PHI)
    for s in (-3.0, 0.0, 2.0):  # the drained line needs more than c cos(phi') = 4.24
        assert np.isclose(strength(stage_of(s, s)), C + max(s, 0.0) * np.tan(f), rtol=1e-12)
    normal = 0.5 * (199.0 - 201.0 * np.sin(f))
    assert line(normal) < C + normal * np.tan(f)
    assert np.isclose(strength(stage_of(200.0, -1.0)), line(normal), rtol=1e-12)


def test_third_stage():
    """[X] A lower drained strength after the drawdown counts, a higher one does not."""
    before = stage_of(120.0, 70.0)
    low = stage_of(20.0, 20.0)
    assert np.isclose(strength(before, after=low), C + 20.0 * np.tan(np.radians(PHI)))
    high = stage_of(500.0, 500.0)
    assert np.isclose(strength(before, after=high), strength(before))


def test_wrong_strengths():
    """One sentence each."""
    stage = stage_of(50.0, 50.0)
    for given, message in (
        ({"c": -1.0}, "c must be a finite number"),
        ({"phi": 95.0}, "phi must be a finite number"),
        ({"region": "dam"}, "no region 'dam'"),
    ):
        with pytest.raises(ValueError, match=message):
            stage.drawdown_strength(
                "clay", **({"c": C, "phi": PHI, "c_R": C_R, "phi_R": PHI_R} | given)
            )


def test_strength_on_the_slip_planes_of_a_mechanism() -> None:
    """[X] A block that slides level under K0 stresses: the vertical stress is normal to its plane,
    without shear, so that the line of isotropic consolidation counts.
    """
    mesh = MeshQuad().refined(1).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    clay = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3), unit_weight=10.0)
    rest = sc.Model({"clay": clay}, sc.box_supports(basis)).k0_state(K0=0.5)["initial"]
    level = basis.zeros()
    level[basis.nodal_dofs[0]] = 1.0
    given = {"c": 0.0, "phi": 30.0, "c_R": 2.0, "phi_R": 15.0}
    found = rest.drawdown_strength("clay", mechanism=level, **given)["all"]
    depth = 1.0 - mesh.p[1, mesh.t].mean(axis=0)
    share = np.cos(np.pi / 6.0) / (1.0 - np.sin(np.pi / 12.0))
    by_hand = share * (2.0 * np.cos(np.pi / 12.0) + 10.0 * depth * np.sin(np.pi / 12.0))
    np.testing.assert_allclose(found, by_hand, rtol=1e-9)
    with pytest.raises(ValueError, match="search the collapse on the same basis"):
        rest.drawdown_strength("clay", mechanism=level[:4], **given)


def test_strength_on_a_steep_slip_plane() -> None:
    """[X] At 45 degrees the mean stress is normal, and the ratio follows from the shear."""
    mesh = MeshQuad().refined(1).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    clay = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3), unit_weight=10.0)
    rest = sc.Model({"clay": clay}, sc.box_supports(basis)).k0_state(K0=0.5)["initial"]
    found = rest.drawdown_strength(
        "clay", c=0.0, phi=30.0, c_R=0.0, phi_R=15.0, mechanism=basis.zeros() + 1.0
    )["all"]
    depth = 1.0 - mesh.p[1, mesh.t].mean(axis=0)
    normal, shear = 7.5 * depth, 2.5 * depth
    ratio = (normal + shear * np.sqrt(3.0)) / (normal - shear / np.sqrt(3.0))
    way = (ratio - 1.0) / 2.0  # sigma_1 / sigma_3 is 3 at failure
    sine = np.sin(np.pi / 12.0)
    isotropic = normal * np.cos(np.pi / 6.0) * sine / (1.0 - sine)
    drained = normal * np.tan(np.pi / 6.0)
    np.testing.assert_allclose(found, (1.0 - way) * isotropic + way * drained, rtol=1e-9)
