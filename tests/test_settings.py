"""Settings of a wrong kind: one error that names the setting."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc
from tests.tools.helpers import grid, run_stages, vector_basis
from tests.tools.scenes import block_on_base


def ground():
    basis = vector_basis(grid("Q1", np.linspace(0, 4, 9), np.linspace(0, 2, 5)), "Q1", intorder=2)
    forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3))}
    return basis, forms, sc.weight(basis, 20.0), basis.get_dofs("bottom").all()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            {"stages": lambda load: [sc.Stage("a", np.ma.masked_array(load, mask=load < 0))]},
            "not masked",
        ),
        ({"stages": lambda load: [sc.Stage("a", load + 1j)]}, "real numbers"),
        (
            {"stages": lambda load: (sc.Stage(n, load) for n in "ab")},
            "stages must be several values, each a Stage",
        ),
        ({"stages": lambda load: ["a"]}, "each a Stage"),
        ({"start": "x"}, "start must be a Result"),
        ({"newton": "x"}, "newton must be a Newton"),
    ],
)
def test_input_of_a_run(options, message):
    _, forms, load, fixed = block_on_base()
    make = options.pop("stages", lambda load: [sc.Stage("a", load)])
    with pytest.raises(ValueError, match=message):
        stages = make(load)
        run_stages(forms, stages, fixed, progress=False, **options)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: sc.Newton(max_iterations=np.nan), "whole number"),
        (lambda: sc.Newton(tolerance="x"), "tolerance must be a finite number"),
        (lambda: sc.MohrCoulomb(E=1e4, nu=0.3, c=None, phi=30.0), "c must be a finite number"),
        (lambda: sc.join_bodies({1: grid("Q1", [0, 1], [0, 1])}), "bodies have names"),
        (lambda: ground()[1]["ground"].assemble(np.zeros(3), None), "3 displacements for 90 dofs"),
        (lambda: assembled_contact(-2), "88 displacements for 90 dofs"),
        (lambda: assembled_contact(50), "140 displacements for 90 dofs"),
    ],
)
def test_settings(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def assembled_contact(longer):
    """A contact pair is asked with displacements of a wrong length."""
    basis, forms, *_ = block_on_base()
    return forms["joint"].assemble(np.zeros(basis.N + longer), forms["joint"].initial_state())


#: Settings that are as they should be, by the class that takes them.
SETTINGS = {
    sc.Coulomb: {"mu": 0.3, "adhesion": 1.0, "tension": 1.0},
    sc.AugmentedLagrangian: {"tolerance": 1e-4},
    sc.Newton: {"tolerance": 1e-8, "max_iterations": 25},
    sc.LinearElastic: {"E": 1e3, "nu": 0.3},
    sc.MohrCoulomb: {"E": 1e3, "nu": 0.3, "c": 1.0, "phi": 30.0, "psi": 5.0},
    sc.Tresca: {"E": 1e3, "nu": 0.3, "c": 1.0},
    sc.VonMises: {"E": 1e3, "nu": 0.3, "strength": 1.0},
    sc.DruckerPrager: {"E": 1e3, "nu": 0.3, "k": 1.0, "alpha": 0.1, "beta": 0.1},
    sc.HardeningMohrCoulomb: {
        "E": 1e3,
        "nu": 0.3,
        "c": 1.0,
        "c_end": 0.5,
        "phi": 30.0,
        "phi_end": 20.0,
        "strain_end": 0.1,
        "psi": 5.0,
    },
    sc.HardeningSoil: {
        "E50_ref": 37e3,
        "Eoed_ref": 29.6e3,
        "Eur_ref": 90e3,
        "m": 0.5,
        "c": 1.0,
        "phi": 41.0,
        "psi": 14.0,
    },
    sc.Undrained: {"nu_undrained": 0.495},
    sc.water.VanGenuchten: {"alpha": 2.0, "n": 3.0, "least": 1e-6},
    sc.water.Ramp: {"width": 0.5, "least": 1e-3},
}


SOIL = sc.LinearElastic(E=1e3, nu=0.3)


@pytest.mark.parametrize("cls", SETTINGS, ids=lambda cls: cls.__name__)
@pytest.mark.parametrize(
    "wrong",
    [
        None,
        "x",
        np.nan,
        np.inf,
        -1.0,
        [1, "a"],
        [[1.0], [1.0, 2.0]],
        1j,
        True,
        np.ma.masked_array([0.5], mask=[True]),
    ],
    ids=str,
)
def test_settings_of_a_wrong_kind(cls, wrong):
    """One ValueError, which names the setting, for every field of every class of settings."""
    good = SETTINGS[cls]
    first = (SOIL,) if cls is sc.Undrained else ()
    cls(*first, **good)
    for name in good:
        with pytest.raises(ValueError, match=rf"{name}|either"):
            cls(*first, **{**good, name: wrong})


@pytest.mark.parametrize(
    "setting",
    [
        "slave",
        "master",
        "law",
        "quadrature",
        "penalty",
        "smoothing",
        "enforcement",
        "initial",
        "share",
        "tangent",
    ],
)
@pytest.mark.parametrize("wrong", ["x", np.nan, -1.0, [1, "a"], 1j], ids=str)
def test_settings_of_contact_of_a_wrong_kind(setting, wrong):
    basis, *_ = block_on_base()
    good = {"slave": "block:bottom", "master": "base:top", "law": sc.Coulomb(0.3)}
    with pytest.raises(ValueError):
        sc.ContactPair(basis, **{**good, setting: wrong})


@pytest.mark.parametrize(
    "setting", ["start", "end", "EA", "fixed_end", "yield_force", "tension_only", "part"]
)
@pytest.mark.parametrize("wrong", ["x", np.nan, [1, "a"], 1j], ids=str)
def test_settings_of_bars_of_a_wrong_kind(setting, wrong):
    basis, *_ = ground()
    good = {"start": (0.0, 2.0), "end": (0.0, 5.0), "EA": 1e3, "fixed_end": True}
    sc.Bar(basis, **good)
    with pytest.raises(ValueError):
        sc.Bar(basis, **{**good, setting: wrong})
