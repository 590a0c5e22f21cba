"""A wedge of rock on two planes, which slides along the line in which these meet."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import LinearForm, MeshHex, MeshQuad, MeshTet

import skfem_contact as sc
from skfem_contact.nonlinear.loose import share_held
from skfem_contact.stages import run
from tests.tools.helpers import counted, vector_basis

QUIET = {"progress": False}

#: The planes dip by 45 degrees across the line, which plunges by 40: the wedge stands if tan(phi) >
#: tan(40) sin(45), phi > 30.7 degrees.
PLUNGE = np.radians(40.0)


@LinearForm
def weight(v, w):
    """Weight of the rock."""
    return -25.0 * v[2]


def wedge(phi: float, adhesion: float = 0.0) -> tuple[sc.Model, np.ndarray]:
    """The model of a tetrahedral wedge of height 2.6, and its weight."""
    along = np.array([np.cos(PLUNGE), 0.0, -np.sin(PLUNGE)])
    across = np.array([np.sin(PLUNGE), 0.0, np.cos(PLUNGE)])
    aside = np.array([0.0, 1.0, 0.0])
    dips = {"left": across + aside, "right": across - aside}
    back = -4.0 * along
    crest = [-2.0 * along + (back[2] + 2.0 * along[2]) / dip[2] * dip for dip in dips.values()]
    corners = np.array([np.zeros(3), back, *crest]).T
    mesh = MeshTet(corners, np.arange(4)[:, None]).refined(1)
    normals = {name: np.cross(along, dip) for name, dip in dips.items()}
    normals["right"] = -normals["right"]  # both into the wedge
    mesh = mesh.with_boundaries(
        {
            name: lambda x, n=normal: np.abs(np.tensordot(n, x, 1)) < 1e-9
            for name, normal in normals.items()
        }
    )
    basis = vector_basis(mesh, "P1")
    law = sc.Coulomb(mu=np.tan(np.radians(phi)), adhesion=adhesion)
    forms = {"wedge": sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=0.2))}
    for name, normal in normals.items():
        plane = sc.rigid.plane(0.5 * back + dips[name], normal, width=40.0)
        forms[name] = sc.ContactPair(basis, name, plane, law)
    return sc.Model(forms, np.zeros(0, int)), weight.assemble(basis)


def test_a_wedge_that_friction_holds_stands():
    """[X] Friction above that of statics."""
    model, load = wedge(31.5)
    assert len(model.run([sc.Stage("weight", load)], **QUIET)) == 1


def first_share(model: sc.Model, stages: list, monkeypatch: pytest.MonkeyPatch) -> float:
    """Share of the first increment that failed which contact may hold."""
    found: list[float] = []

    def first(*given) -> float:
        found.append(share_held(*given))
        raise KeyboardInterrupt

    monkeypatch.setattr(run, "share_held", first)
    with pytest.raises(KeyboardInterrupt):
        model.run(stages, **QUIET)
    return found[0]


@pytest.mark.parametrize("phi", [20.0, 26.5])
def test_a_wedge_that_friction_does_not_hold_ends_at_once(phi, monkeypatch: pytest.MonkeyPatch):
    """[X] No pressures balance the weight below 27 degrees, where tan(40) sin(45) = mu / sqrt(1 -
    mu^2): friction across the line, of mu^2, raises the pressure to 1 / (1 - mu^2).
    """
    tried = counted(monkeypatch, run, "solve_step")
    model, load = wedge(phi)
    with pytest.raises(sc.NotConverged, match=r"0.00% of its load, for no contact forces hold"):
        model.run([sc.Stage("weight", load)], **QUIET)
    assert len(tried) == 1


@pytest.mark.parametrize("held", ["adhesion", "spring"])
def test_other_holds_are_tried_in_small_increments(held: str, monkeypatch: pytest.MonkeyPatch):
    """[X] Adhesion and springs may hold some part of the weight."""
    model, load = wedge(20.0, adhesion=0.02 * (held == "adhesion"))
    forms = dict(model.forms)
    corner = -4.0 * np.array([np.cos(PLUNGE), 0.0, -np.sin(PLUNGE)])
    if held == "spring":  # however weak
        forms["spring"] = sc.Spring(forms["wedge"].basis, corner, 1e-3)
    model = sc.Model(forms, np.zeros(0, int))
    assert first_share(model, [sc.Stage("weight", load)], monkeypatch) == 1.0


@pytest.mark.parametrize("dim, error", [(2, 0.005), (3, 0.01)])
def test_share_of_a_push_that_friction_may_hold(dim, error, monkeypatch: pytest.MonkeyPatch):
    """[X] A block under its weight that is pushed by 2 mu times as much: half, and the margin."""
    line = np.linspace(-1.0, 1.0, 3)
    mesh = {
        2: lambda: MeshQuad.init_tensor(line, [0.0, 0.5, 1.0]),
        3: lambda: MeshHex.init_tensor(line, line, [0.0, 0.5, 1.0]),
    }[dim]()
    mesh = mesh.with_boundaries({"base": lambda x: x[-1] == 0.0})
    basis = vector_basis(mesh, "Q1")
    if dim == 2:
        floor = sc.rigid.line((-9.0, 0.0), (9.0, 0.0))
    else:
        floor = sc.rigid.plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), width=18.0)
    forms = {
        "block": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.2)),
        "joint": sc.ContactPair(basis, "base", floor, sc.Coulomb(mu=0.3)),
    }
    down, along = (-10.0 * np.eye(dim)[[-1, 0]]).tolist()
    weight, push = (
        LinearForm(lambda v, w, f=f: sum(c * v[i] for i, c in enumerate(f))).assemble(basis)
        for f in (down, along)
    )
    stages = [sc.Stage("weight", weight), sc.Stage("push", weight + 0.6 * push)]
    share = first_share(sc.Model(forms, np.zeros(0, int)), stages, monkeypatch)
    assert share == pytest.approx(0.5 * (1.0 + error), rel=2e-4)
