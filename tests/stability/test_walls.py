"""Sheet piles in a slit: any stiffness, any unit, mirrored, toes anywhere, two walls that meet,
interrupted.
"""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pytest
from skfem import MeshTri

import skfem_contact as sc
from tests.tools.helpers import vector_basis

QUIET = {"progress": False}
DEEP = 4.0


def slit(length, mirror, slab):
    """Ground with a slit of 4 m, and with a level one that meets it at a depth of 2 m."""
    mesh = MeshTri.init_tensor(np.linspace(-6.0, 6.0, 13), np.linspace(-6.0, 0.0, 7))
    if mirror < 0.0:
        mesh = MeshTri(mesh.p * np.array([[-1.0], [1.0]]), mesh.t[[1, 0, 2]])
    mesh = mesh.with_defaults().with_boundaries(
        {
            "wall": lambda x: (abs(x[0]) < 1e-9) & (x[1] > -DEEP),
            "slab": lambda x: (
                (abs(x[1] + 2.0) < 1e-9) & (mirror * x[0] > 0.0) & (mirror * x[0] < 3.0)
            ),
        },
        False,
    )
    mesh, sides = sc.split_along(mesh, "wall"), ["wall|left", "wall|right"]
    if slab:
        mesh, there = sc.split_along(mesh, "slab"), sides.pop(1 if mirror > 0.0 else 0)
        facets = mesh.boundaries[there]
        high = mesh.p[1, mesh.facets[:, facets]].mean(axis=0) > -2.0
        mesh = mesh.with_boundaries({"high": facets[high], "low": facets[~high]})
        sides += ["high", "low"]
    return mesh.scaled(length), sides


def pulled(EI=5e3, EA=1e6, toe=DEEP, length=1.0, mirror=1.0, slab=False):
    """Model, stages and K0 state of a sheet pile that is pulled at its head; a metre is `length`
    units.
    """
    mesh, sides = slit(length, mirror, slab)
    basis = vector_basis(mesh, "P2", intorder=2)
    soil = sc.MohrCoulomb(E=2e4 / length**2, nu=0.3, c=3.0 / length**2, phi=32.0, psi=32.0)
    depth, joint, section = (
        np.linspace(0.0, toe, 5),
        sc.Coulomb.from_soil(soil, 2 / 3),
        (EI * length, EA / length),
    )
    wall = sc.Beam(basis, length * np.column_stack((0 * depth, -depth)), *section)
    forms = {"ground": sc.SolidForm(basis, soil, unit_weight=18.0 / length**3), "wall": wall}
    forms |= wall.contact(basis, joint, sides)
    if slab:
        along = np.linspace(0.0, 3.0, 4)
        plate = sc.Beam(
            basis, length * mirror * np.column_stack((along, 0 * along - 2.0 * mirror)), *section
        )
        forms |= {"plate": plate, **plate.contact(basis, joint, ["slab|above", "slab|below"])}
    model = sc.Model(forms, sc.box_supports(basis))
    head = model.forms["wall"].load((mirror / length, 0.0), at=(0.0, 0.0))
    stages = [sc.Stage("half", 2.0 * head), sc.Stage("whole", 4.0 * head)]
    return model, stages, model.k0_state(K0=0.5)


def moved(**options):
    """Head's displacements and rotation, section forces, and iterations of both stages."""
    model, stages, start = pulled(**options)
    result = model.run(stages, start=start, **QUIET)
    stage = result["whole"]
    return stage.x[model.forms["wall"].numbers((0.0, 0.0))], stage.section_forces("wall"), result


@pytest.mark.parametrize(
    ("name", "values"), [("EI", np.logspace(-2, 8, 6)), ("EA", np.logspace(0, 10, 6))]
)
def test_stiffness(name, values):
    """The head moves less the stiffer the pile, from one limit to the other; ten decades take no
    more iterations.
    """
    found = [moved(**{name: value}) for value in values]
    head = np.array([u[0] for u, _, _ in found])
    assert (np.diff(head) < 0.0).all()
    assert head[-2] == pytest.approx(head[-1], rel=0.02)  # a stiff pile is rigid
    assert max(sum(stage.iterations) for *_, result in found for stage in result) <= 8
    for _, forces, _ in found:
        assert abs(forces.M[[0, -1]]).max() < 1e-6


@pytest.mark.parametrize("length", [1e3, 1e-3])
def test_units(length):
    """Millimetres, metres or kilometres: the same rotation, and displacements in their unit."""
    (u, forces, result), (v, others, reference) = moved(length=length), moved()
    np.testing.assert_allclose(
        u / [length, length, 1.0], v, rtol=1e-7
    )  # tolerance of the iterations
    np.testing.assert_allclose(forces.M, others.M, rtol=1e-7, atol=1e-9)
    assert [stage.iterations for stage in result] == [stage.iterations for stage in reference]


@pytest.mark.parametrize("slab", [False, True])
def test_mirrored(slab):
    """A mirrored pile has the opposite moments, alone and beside a slab that meets it."""
    (u, forces, _), (v, others, _) = moved(slab=slab), moved(slab=slab, mirror=-1.0)
    np.testing.assert_allclose(u, v * [-1.0, 1.0, -1.0], rtol=1e-7)
    np.testing.assert_allclose(forces.M, -others.M, atol=1e-7)


def test_two_walls_that_meet():
    """The ground bears the pull on one of them, and none on the other."""
    _, _, result = moved(slab=True)
    push = {
        name: result["whole"].contact(name).force
        for name in result["whole"].states
        if name not in ("ground", "wall", "plate")
    }
    plate = push.pop("slab|above") + push.pop("slab|below")
    np.testing.assert_allclose(sum(push.values()), [4.0, 0.0], atol=1e-5)
    np.testing.assert_allclose(plate, 0.0, atol=1e-5)


@pytest.mark.slow
def test_toe():
    """The toe may lie in the middle of an element of the slit, at its end or below, without a
    jump.
    """
    head, moment = zip(
        *(
            (u[0], abs(forces.M).max())
            for u, forces, _ in (moved(toe=toe) for toe in (3.5, 3.7, 3.99, 4.0, 4.01, 4.3))
        ),
        strict=True,
    )
    assert (
        max(head) / min(head) < 1.015
    )  # half a metre of 4.5 tells 0.1 %, the end of the slit as it closes 1 %
    assert (np.diff(moment) < 0.0).all() and max(moment) / min(moment) < 1.15


def test_interrupted(tmp_path):
    """Saved in the middle, loaded and resumed: the same result."""
    model, stages, start = pulled()
    model.run(stages[:1], start=start, **QUIET).save(tmp_path / "half.npz")
    resumed = model.run(stages[1:], start=sc.load_result(tmp_path / "half.npz", model), **QUIET)[
        "whole"
    ]
    whole = model.run(stages, start=start, **QUIET)["whole"]
    np.testing.assert_allclose(
        resumed.x, whole.x, atol=1e-12 * abs(whole.x).max()
    )  # round-off of new factors


@pytest.mark.slow
def test_limit_of_the_pull(tmp_path):
    """The pile slides along both of its sides: one limit in metres, in millimetres, mirrored, and
    from a file.
    """
    limits = []
    for options in ({}, {"length": 1e3}, {"mirror": -1.0}):
        model, stages, start = pulled(**options)
        model.run(stages[:1], start=start, **QUIET).save(tmp_path / "half.npz")
        half = sc.load_result(tmp_path / "half.npz", model)
        found = model.limit_load(stages[1].load, start=half, certify=False, **QUIET)
        limits.append(found.multiplier)
        assert found.stop.kind == "plateau"
        assert found.bracket[1] < 1.01 * found.bracket[0]
    np.testing.assert_allclose(
        limits, limits[0], rtol=1e-4
    )  # 1e-11 but for noise, which may end a step earlier


@pytest.mark.parametrize("n", [1, 8, 32])
def test_stiff_in_shear(n):
    """[X] GA up to 1e8 EI / L^2 bends as without shear; 1e10 is told with the figure."""

    def deflection(shear):
        beam = sc.Beam(
            None, np.linspace((0.0, 0.0), (2.0, 0.0), n + 1), EI=1.0, EA=1e3, GA=shear / 4.0
        )
        model = sc.Model({"beam": beam}, beam.dofs((0.0, 0.0)))
        load = model.forms["beam"].load((0.0, 3.0), (2.0, 0.0))
        return model.run([sc.Stage("load", load)], **QUIET)["load"].x[
            model.forms["beam"].numbers((2.0, 0.0))[1]
        ]

    for shear in (1e4, 1e6, 1e8):
        # Newton's tolerance of 1e-6 and the digits that shear leaves
        assert deflection(shear) == pytest.approx(8.0 + 24.0 / shear, rel=1e-6)
    told = r"GA is 1\.0e\+10 EI / L\*\*2: beyond 1e\+09"
    with pytest.warns(sc.AnalysisWarning, match=told), suppress(sc.NotConverged):
        deflection(1e10)
