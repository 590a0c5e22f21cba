"""Lines of beams and bars in pictures: where they are, how they move, and their values."""

from __future__ import annotations

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
import pytest
from skfem import Basis, ElementTriP2, ElementVector, MeshQuad, MeshTri

import skfem_contact as sc
import skfem_contact.plot as plot
from skfem_contact.plot.contour import contours
from skfem_contact.plot.marks import named_waters
from skfem_contact.plot.report_parts import diagrams_of
from skfem_contact.plot.shells import _parts, _ShellScene
from skfem_contact.plot.structures import BAR, BEAM, structures
from skfem_contact.results import SectionForces


@pytest.fixture(scope="module")
def stage():
    """An anchored post on a block: a beam, a bar to it, and a bar to a fixed point."""
    mesh = MeshTri().refined(2).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    post = sc.Beam(None, [(0.5, 1.0), (0.5, 1.5), (0.5, 2.0)], EI=10.0, EA=1e3)
    forms = {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.2)), "post": post}
    forms["stay"] = sc.Bar(basis, post.at((0.5, 2.0)), (0.0, 1.0), EA=50.0)
    forms["rope"] = sc.Bar(None, post.at((0.5, 1.5)), (2.0, 1.5), EA=50.0, fixed_end=True)
    supports = [sc.box_supports(basis), *post.dofs((0.5, 1.0))]
    model = sc.Model(forms, supports)
    push = model.forms["post"].load((1.0, 0.0), at=(0.5, 2.0))
    return model.run([sc.Stage("push", push)], progress=False)["push"]


def test_lines_move_with_their_nodes(stage) -> None:
    """[X] Ends of bars have the displacements of the beam and of the block, fixed ends none."""
    found = {line.name: line for line in structures(stage)}
    assert list(found) == ["post", "stay", "rope"]
    assert [line.color for line in found.values()] == [BEAM, BAR, BAR]
    post = stage.forms["post"]
    head = stage.x[post.numbers((0.5, 2.0))[:2]]
    middle = stage.x[post.numbers((0.5, 1.5))[:2]]
    np.testing.assert_allclose(found["post"].points[-1], [(0.5, 1.5), (0.5, 1.75), (0.5, 2.0)])
    np.testing.assert_allclose(found["post"].displacement[-1, [0, 2]], [middle, head])
    np.testing.assert_allclose(found["stay"].displacement[0, 0], head)
    corner = stage.at((0.0, 1.0), "ux", "uy")
    on_block = [corner["ux"][0], corner["uy"][0]]
    assert np.abs(on_block).max() > 1e-5
    np.testing.assert_allclose(found["stay"].displacement[0, 1], on_block, rtol=1e-9)
    np.testing.assert_allclose(found["rope"].displacement[0], [middle, (0.0, 0.0)])


def test_contours_show_them(stage) -> None:
    """[X] The picture has one mesh of lines for each, where the deformed nodes are."""
    plotter = plot.contour(stage, "uy", deformed=20.0)
    if plotter is None:
        pytest.skip("this machine cannot draw")
    lines = [mesh for mesh in plotter.meshes if getattr(mesh, "n_lines", 0) > 0]
    ends = np.concatenate([mesh.points[:, :2] for mesh in lines])
    head = (0.5, 2.0) + 20.0 * stage.x[stage.forms["post"].numbers((0.5, 2.0))[:2]]
    assert np.linalg.norm(ends - head, axis=1).min() < 1e-6
    assert np.linalg.norm(ends - (2.0, 1.5), axis=1).min() < 1e-6
    plotter.close()


def test_small_extremes_are_not_written() -> None:
    """[X] A value below 1 % of the largest gets no text, one of 2 % does."""
    y = np.linspace(0.0, -4.0, 5)
    for smallest, texts in ((-0.5, 1), (-2.0, 2)):
        M = np.array([0.0, smallest, 10.0, 50.0, 100.0])
        forces = SectionForces(-y, 0.0 * y, y, 0.0 * y, 0.0 * y, M)
        basis = Basis(MeshTri().with_defaults(), ElementVector(ElementTriP2()), intorder=2)
        block = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.2), unit_weight=1.0)
        model = sc.Model({"block": block}, sc.box_supports(basis))
        on = model.run([sc.Stage("weight")], progress=False)["weight"]
        figure = plot.diagram(forces, "M", on=on)
        assert len(figure.axes[0].texts) == texts
        plt.close(figure)


def test_scale_covers_the_window() -> None:
    """[X] The largest stress lies in a small part of the ground: a window on it has its scale."""
    mesh = MeshTri.init_tensor(np.linspace(0.0, 60.0, 31), np.linspace(-60.0, 0.0, 31))
    near = lambda x: np.isclose(x[1], 0.0) & (x[0] < 2.1)  # noqa: E731
    mesh = mesh.with_defaults().with_boundaries({"strip": near})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    ground = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3))
    model = sc.Model({"ground": ground}, sc.box_supports(basis))
    load = model.traction("strip", (0.0, -100.0))
    stage = model.run([sc.Stage("load", load)], progress=False)["load"]
    whole = contours([stage], "syy").scale
    seen = contours([stage], "syy", window=(0.0, 5.0, -5.0, 0.0)).scale
    assert whole.levels[0] > -40.0  # 1 % of the area lies below
    assert seen.levels[0] < -80.0


def test_arrows_of_single_nodes_are_shortened() -> None:
    """[X] One node that moves a hundred times as far does not hide the arrows of others."""
    basis = Basis(MeshTri().refined(4).with_defaults(), ElementVector(ElementTriP2()), intorder=2)
    block = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.2), unit_weight=1.0)
    model = sc.Model({"block": block}, sc.box_supports(basis))
    stage = model.run([sc.Stage("weight")], progress=False)["weight"]
    x = stage.x.copy()
    x[sc.dofs_at(basis, (1.0, 1.0))[0]] = 100.0 * np.abs(x).max()
    counts = []
    for moved in (stage.x, x):
        plotter = plot.contour(replace(stage, x=moved), "syy", vectors=True)
        if plotter is None:
            pytest.skip("this machine cannot draw")
        counts.append(max(mesh.n_lines for mesh in plotter.meshes if hasattr(mesh, "n_lines")))
        plotter.close()
    assert counts[1] > 0.9 * counts[0]


def test_water_tables_have_names() -> None:
    """[X] Lines that differ by region have the names of their regions, one line has one name."""
    line = [(0.0, 1.0), (1.0, 0.5)]
    assert [name for name, _ in named_waters(line)] == ["water table"]
    both = named_waters({"sand": line, "clay": line})
    assert [name for name, _ in both] == ["water table"]
    several = named_waters({"sand": line, "silt": line, "clay": 0.8})
    assert [name for name, _ in several] == ["water table, sand, silt", "water table, clay"]


def test_contours_of_shells() -> None:
    """[X] Bands of a slab and a wall on it follow their displacements; a view from above has the
    size of the slab, one along it also the wall; unknown names are refused.
    """
    mesh = MeshQuad().refined(3)
    flat = 2.0 * mesh.p
    floor = np.column_stack((*flat, 0.0 * flat[0]))
    points, number = np.unique(np.vstack((floor, floor[:, [2, 1, 0]])), axis=0, return_inverse=True)
    cells = number[np.vstack((mesh.t.T[:, ::-1], len(floor) + mesh.t.T))]
    shell = sc.Shell(None, points, cells=cells, E=1e4, thickness=0.1, axis=(0, 1, 0))
    held = [dof for p in floor for dof in shell.dofs(p)]
    model = sc.Model({"shell": shell}, held)
    top = model.forms["shell"].load((1.0, 0.0, 0.0), at=(0.0, 1.0, 2.0))
    stage = model.run([sc.Stage("push", top)], progress=False)["push"]
    parts = list(_parts(stage, None).values())
    above, along = (
        _ShellScene(parts, [], "ux", towards, 1.0) for towards in ((0, 0, -1), (1, 0, 0))
    )
    np.testing.assert_allclose(above.samples[1].sum(), 8.0, rtol=1e-12)
    at_top = np.linalg.norm(above.coordinates - (0.0, 1.0, 2.0), axis=1).argmin()
    moved = stage.x[model.forms["shell"].numbers((0.0, 1.0, 2.0))[0]]
    assert above.values[at_top] == moved == above.values.max()
    np.testing.assert_allclose(np.ptp(above.seen, axis=0), [2.0, 2.0], rtol=0.01)
    np.testing.assert_allclose(along.seen.max(axis=0), [0.0, 2.0], atol=0.01)
    for message, refused in {
        "quantity of shells": lambda: plot.shells(stage, "sxx"),
        "'roof'": lambda: plot.shells(stage, "u", names="roof"),
        "not zero": lambda: plot.shells(stage, "u", towards=(0, 0, 0)),
    }.items():
        with pytest.raises(ValueError, match=message):
            refused()
    plotter = plot.shells(stage, "n_2", names="shell", deformed="auto")
    if plotter is not None:
        assert max(mesh.n_cells for mesh in plotter.meshes) > len(cells)


def test_reports_have_moments_of_shells(tmp_path) -> None:
    """[X] A report has both moments of each shell in its last stage, a slab seen from above."""
    mesh = MeshQuad().refined(2)
    points = np.column_stack((*mesh.p, 0.0 * mesh.p[0]))
    parts = {}
    for name, p in (("slab", points), ("wall", points[:, [0, 2, 1]])):
        parts[name] = sc.Shell(None, p, cells=mesh.t.T, E=1e4, thickness=0.1)
    held = [dof for shell in parts.values() for p in shell.points[:4] for dof in shell.dofs(p)]
    model = sc.Model(parts, held)
    loads = [model.forms[name].area_load((0.0, 1.0, -1.0)) for name in parts]
    stages = [sc.Stage("push", loads), sc.Stage("out", deactivate="wall")]
    result = model.run(stages, progress=False)
    found = list(diagrams_of(result, {}))
    assert [text.split(",")[0] for text, _ in found] == [
        f"{name}: moments {quantity} per length" for name in parts for quantity in ("m_1", "m_2")
    ]
    assert "'push'" in found[2][0] and "'out'" in found[0][0]
    shown = [_ShellScene(list(_parts(result[0], n).values()), [], "u", None, None) for n in parts]
    np.testing.assert_allclose(shown[0].view[0], np.eye(3), atol=1e-12)
    assert not np.allclose(shown[1].view[0], np.eye(3))


def test_no_shell_to_draw(stage) -> None:
    """Stages without shells are refused."""
    with pytest.raises(ValueError, match="'push' has no active shell"):
        plot.shells(stage, "m_1")
