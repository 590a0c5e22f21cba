"""Usual slips of new users: each gets one error, or one warning, that says what to do."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc


@pytest.fixture(scope="module")
def scene() -> SimpleNamespace:
    """A block on ground with contact, its model and the result of its weight."""
    line = np.linspace(0, 2, 5)
    grid = MeshQuad.init_tensor(line, line).with_defaults()
    mesh = sc.join_bodies({"ground": grid, "block": grid.translated((0.0, 2.0))})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=30.0)
    stiff = sc.LinearElastic(E=1e6, nu=0.2)
    solid = sc.SolidForm(basis, {"ground": soil, "block": stiff}, unit_weight=20.0)
    pair = sc.ContactPair(basis, "block:bottom", "ground:top", sc.Coulomb(0.5))
    forms = {"solid": solid, "pair": pair}
    fixed = basis.get_dofs("ground:bottom").all()
    model = sc.Model(forms, fixed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sc.AnalysisWarning)
        result = model.run([sc.Stage("weight")])
    return SimpleNamespace(
        mesh=mesh,
        basis=basis,
        soil=soil,
        solid=solid,
        forms=forms,
        fixed=fixed,
        model=model,
        result=result,
        stage=result["weight"],
    )


def other_pair(s: SimpleNamespace) -> sc.ContactPair:
    """Contact on another mesh."""
    basis = Basis(s.mesh.refined(1), ElementVector(ElementQuad1()), intorder=2)
    return sc.ContactPair(basis, "block:bottom", "ground:top", sc.Coulomb(0.5))


#: What was written by mistake, and a part of the message, with its remedy.
SLIPS: dict[str, tuple[Callable[[Any], Any], str]] = {
    # names
    "keyword": (lambda s: sc.Stage("dig", **{"deactvate": "block"}), "did you mean 'deactivate'"),
    "boundary of a load": (
        lambda s: s.model.traction("block:tpo", (0.0, -1.0)),
        "existing: block:bottom.*did you mean 'block:top'",
    ),
    "boundary of contact": (
        lambda s: sc.ContactPair(s.basis, "block:botom", "ground:top", sc.Coulomb(0.5)),
        "did you mean 'block:bottom'",
    ),
    "stage": (lambda s: s.result["wieght"], "did you mean 'weight'"),
    "field": (lambda s: s.stage.field("Uy"), "did you mean 'uy'"),
    "form of a stage": (
        lambda s: s.model.run([sc.Stage("dig", deactivate="solids")]),
        "did you mean 'solid'",
    ),
    "region": (
        lambda s: sc.SolidForm(s.basis, {"ground": s.soil, "blcok": s.soil}),
        "did you mean 'block'",
    ),
    "pair that is none": (lambda s: s.stage.tractions("contact"), "existing: pair, solid"),
    "solid for a pair": (lambda s: s.stage.tractions("solid"), r"there are \['pair'\]"),
    "two stages of one name": (
        lambda s: s.model.run([sc.Stage("a"), sc.Stage("a")]),
        "two stages are named 'a'",
    ),
    # materials
    "class for an object": (
        lambda s: sc.SolidForm(s.basis, sc.LinearElastic),
        r"give an object, LinearElastic\(\.\.\.\)",
    ),
    "region without material": (
        lambda s: sc.SolidForm(s.basis, {"ground": s.soil}),
        r"no material; they lie in the subdomains \['block'\]",
    ),
    "angles in radians": (
        lambda s: sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=0.52),
        "angles are given in degrees",
    ),
    "psi above phi": (
        lambda s: sc.MohrCoulomb(E=1e4, nu=0.3, c=1.0, phi=20.0, psi=30.0),
        "psi must not exceed phi",
    ),
    "nu of water": (lambda s: sc.LinearElastic(E=1e4, nu=0.5), "between -1 and 0.5"),
    "negative stiffness": (lambda s: sc.LinearElastic(E=-1e4, nu=0.3), "E must be positive"),
    "negative cohesion": (
        lambda s: sc.MohrCoulomb(E=1e4, nu=0.3, c=-1.0, phi=30.0),
        "c must not be negative",
    ),
    "friction in degrees": (lambda s: sc.Coulomb(mu=30.0), "tangent of the angle of friction"),
    # models
    "no supports": (
        lambda s: sc.Model(s.forms).run([sc.Stage("weight")]),
        r"rigid motions free; give Model\(forms, fixed\), such as box_supports",
    ),
    "supports as coordinates": (
        lambda s: sc.Model(s.forms, fixed=[0.5]),
        "fixed must be dofs, integers such as",
    ),
    "gravity in m/s2": (
        lambda s: sc.Model(s.forms, s.fixed, gravity=(0.0, -9.81)),
        "gravity must be a unit vector",
    ),
    "seismic in per cent": (
        lambda s: sc.Model(s.forms, s.fixed, seismic=15.0),
        "acceleration over that of gravity",
    ),
    "scalar element": (
        lambda s: sc.SolidForm(Basis(s.mesh, ElementQuad1()), s.soil),
        r"supported are ElementVector\(",
    ),
    "two meshes": (
        lambda s: sc.Model({"solid": s.solid, "pair": other_pair(s)}),
        "belong to different bases",
    ),
    "form twice": (
        lambda s: sc.Model({"a": s.solid, "b": s.solid}, s.fixed),
        "are the same form: it acts twice",
    ),
    "body without a form": (
        lambda s: sc.Model(
            {"a": sc.SolidForm(s.basis.with_elements("ground"), s.soil)}, s.fixed
        ).run([sc.Stage("weight")]),
        "Give every body a form",
    ),
    # loads, stages and water
    "load of another mesh": (
        lambda s: s.model.run([sc.Stage("a", np.zeros(7))]),
        r"the load has shape \(7,\), not \(100,\)",
    ),
    "load with NaN": (
        lambda s: s.model.run([sc.Stage("a", np.full(s.basis.N, np.nan))]),
        "NaN or infinite",
    ),
    "load function without return": (
        lambda s: s.model.run([sc.Stage("a", lambda share: None)]),
        "returns None at 1: return the load vector",
    ),
    "increments as a share": (
        lambda s: s.model.run([sc.Stage("a", increments=2.5)]),
        "whole number",
    ),
    "one stage without a list": (lambda s: s.model.run(sc.Stage("a")), "several values"),
    "water without unit weight": (
        lambda s: s.model.run([sc.Stage("a", water=1.0)]),
        "give the model `water_unit_weight`",
    ),
    "K0 of some ground": (
        lambda s: s.model.k0_state(K0={"ground": 0.5}),
        r"no K0; they lie in the subdomains \['block'\]",
    ),
    # structures
    "bar beside the nodes": (
        lambda s: sc.Bar(s.basis, (0.33, 0.77), (5.0, 5.0), EA=1.0),
        r"the nearest one is at \(0\.5, 1\)",
    ),
    "beam without stiffness": (
        lambda s: sc.Beam(None, [[0.0, 0.0], [1.0, 0.0]], EI=0.0, EA=1.0),
        "EI of a beam must be positive",
    ),
    # results
    "sections of a solid": (
        lambda s: s.stage.section_forces("solid"),
        r"a solid needs `sections`, such as Cuts\.line",
    ),
    "point outside": (
        lambda s: s.stage.at((9.0, 1.0), "uy"),
        r"7 from the nearest one, at \(2, 1\)",
    ),
    "pressure without water": (lambda s: s.stage.field("pore"), "give water=True"),
    "format of a report": (lambda s: s.result.report("pit.pdf"), r"an \.html file, or a \.docx"),
    "units without a length": (lambda s: sc.set_units("kN"), "give that of the length"),
    "factor of zero": (lambda s: sc.design.PartialFactors(phi=0.0), "must be positive"),
}


@pytest.mark.parametrize("name", SLIPS)
def test_slip_is_told(scene: SimpleNamespace, name: str) -> None:
    """One error or warning with the remedy, at most 450 letters long."""
    slip, message = SLIPS[name]
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            slip(scene)
            texts = [str(one.message) for one in told if one.category is sc.AnalysisWarning]
            assert len(texts) == 1, texts
            text = texts[0]
        except (KeyError, TypeError, ValueError) as error:
            text = str(error)
    assert re.search(message, text), text
    assert len(text) < 450


def test_forty_slips() -> None:
    """The list is as long as it was when it was written."""
    assert len(SLIPS) >= 40
