"""A wedge of rock on two planes, which slides along the line in which these meet."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import LinearForm, MeshTet

import skfem_contact as sc
from skfem_contact.nonlinear.increment import in_proportion
from skfem_contact.stages import run
from tests.tools.helpers import vector_basis

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
    assert len(model.run([sc.Stage("weight", load)])) == 1


def test_a_wedge_that_friction_does_not_hold_ends_soon(monkeypatch: pytest.MonkeyPatch):
    """[N] Elastic bodies and friction are alike under any part of the load: two increments show
    that nothing resists it, and the message says so.
    """
    tried = []
    solve_step = run.solve_step
    monkeypatch.setattr(
        run, "solve_step", lambda step, *others: tried.append(step) or solve_step(step, *others)
    )
    model, load = wedge(20.0)
    with pytest.raises(sc.NotConverged, match=r"nothing resists any part of it.*friction"):
        model.run([sc.Stage("weight", load)])
    assert len(tried) == 2


@pytest.mark.parametrize("adhesion", [0.0, 0.02])
def test_adhesion_holds_a_part_of_the_load(adhesion: float, monkeypatch: pytest.MonkeyPatch):
    """Where adhesion holds some part of the weight, smaller increments are tried."""
    found = []

    def first(*given) -> bool:
        found.append(in_proportion(*given))
        raise KeyboardInterrupt

    monkeypatch.setattr(run, "in_proportion", first)
    model, load = wedge(20.0, adhesion)
    with pytest.raises(KeyboardInterrupt):
        model.run([sc.Stage("weight", load)])
    assert found == [adhesion == 0.0]
