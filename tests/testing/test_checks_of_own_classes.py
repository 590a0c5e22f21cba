"""The public checks: they pass what is right and name what is wrong."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.sparse import identity

import skfem_contact as sc
from skfem_contact.errors import Remark
from skfem_contact.forms.roles import Regularised
from skfem_contact.materials import HardeningMohrCoulomb
from tests.tools.helpers import distorted, grid, rough_pair, vector_basis

STIFF = {"E": 1e4, "nu": 0.3}
#: Stresses of about 10: all these laws yield at strains of 1e-3.
MATERIALS = [
    sc.LinearElastic(**STIFF),
    sc.MohrCoulomb(**STIFF, c=5.0, phi=30.0, psi=10.0),
    sc.MohrCoulomb(**STIFF, c=5.0, phi=30.0, psi=0.0),
    sc.Tresca(**STIFF, c=5.0),
    sc.VonMises(**STIFF, strength=5.0),
    sc.DruckerPrager.plane_strain(**STIFF, c=5.0, phi=30.0, psi=10.0),
    HardeningMohrCoulomb(
        **STIFF, c=5.0, c_end=2.0, phi=30.0, phi_end=20.0, strain_end=0.05, psi=5.0
    ),
    sc.MohrCoulomb(
        E=np.linspace(5e3, 2e4, 50), nu=0.3, c=np.linspace(1.0, 9.0, 50), phi=30.0, psi=10.0
    ),
]
LAWS = [
    sc.Coulomb(),
    sc.Coulomb(0.3),
    sc.Coulomb(0.3, adhesion=2.0),
    sc.Coulomb(0.3, adhesion=2.0, tension=3.0),
    sc.Tied(),
]


@pytest.mark.parametrize("ncomp", [4, 6])
@pytest.mark.parametrize("material", MATERIALS, ids=lambda m: type(m).__name__)
@pytest.mark.one_in(3)
def test_materials(material, ncomp):
    """[X] Every material of the package passes; differences over a step of 1e-9 are good to
    1e-6.
    """
    assert sc.testing.check_material(material, ncomp=ncomp, steps=3) < 1e-6


@pytest.mark.parametrize("law", LAWS, ids=repr)
def test_interface_laws(law):
    """[X] Every interface law passes; these are piecewise linear or bilinear, so differences are
    exact.
    """
    assert sc.testing.check_interface_law(law) < 1e-8


@pytest.mark.parametrize("law", [sc.Coulomb(0.3), sc.Tied()], ids=repr)
@pytest.mark.parametrize("quadrature", ["nodal", 2, "segments"])
@pytest.mark.parametrize("element", ["P1", "Q2"])
def test_contact_pairs(element, quadrature, law, rng):
    """[X] Tangent, action and reaction, and rigid motions of bent, displaced surfaces."""
    basis, pair, x, state = rough_pair(element, quadrature, law, rng)
    assert np.abs(pair.assemble(x, state).force).max() > 1.0
    assert sc.testing.check_form(pair, x, state, basis.doflocs) < 1e-7


def test_rigid_obstacle_is_a_support(rng):
    """[X] Its reaction is no force of the form: without places the check passes, with them it says
    so.
    """
    basis = vector_basis(grid("Q1", np.linspace(-1, 1, 5), np.linspace(0, 1, 3)), "Q1")
    pair = sc.ContactPair(
        basis, "bottom", sc.rigid.circle((0.0, -0.9), 1.0), sc.Coulomb(0.3), 3, penalty=1e3
    )
    x = 1e-3 * rng.standard_normal(basis.N)
    assert (
        sc.testing.check_form(pair, x, pair.initial_state()) < 1e-6
    )  # steps of 1e-9 in coordinates of order one
    with pytest.raises(sc.testing.CheckFailed, match="forces do not balance"):
        sc.testing.check_form(pair, x, pair.initial_state(), basis.doflocs)


@pytest.mark.parametrize("strain", ["full", "b_bar"])
def test_solids(strain, rng):
    """[X] A plastic body of distorted elements."""
    mesh = distorted(grid("Q1", np.linspace(0, 2, 6), np.linspace(0, 1, 4)), rng, 0.03)
    basis = vector_basis(mesh, "Q1", intorder=2)
    form = sc.SolidForm(basis, MATERIALS[1], strain=strain)
    x = 1e-3 * rng.standard_normal(basis.N)
    assert len(form.assemble(x, form.initial_state()).state.internal)
    # on the apex and at edges of the yield surface second differences are small, not zero
    assert sc.testing.check_form(form, x, form.initial_state(), basis.doflocs) < 1e-6


class Wrong(sc.LinearElastic):
    """An elastic law with one fault."""

    fault = ""

    def update(self, strain_increment, stress, internal):
        new = super().update(strain_increment, stress, internal)
        if self.fault == "writes":
            stress += 1.0
        if self.fault == "shape":
            return new._replace(stress=new.stress[:3])
        if self.fault == "nan":
            return new._replace(stress=new.stress * np.nan)
        if self.fault == "drifts":
            return new._replace(stress=1.01 * new.stress)
        if self.fault == "silent":
            return new._replace(stress=np.minimum(new.stress, 3.0))
        everywhere = np.arange(new.stress[0].size)
        if self.fault == "tangent":
            return new._replace(
                plastic=everywhere, tangent=lambda: np.tile(1.1 * self.elasticity(4), (200, 1, 1))
            )
        if self.fault == "twice named":
            return new._replace(
                plastic=0 * everywhere, tangent=lambda: np.tile(self.elasticity(4), (200, 1, 1))
            )
        return new

    def elasticity(self, ncomp):
        D = super().elasticity(ncomp).copy()
        if self.fault == "unsymmetric":
            D[0, 1] *= 2
        if self.fault == "negative":
            D[0, 0] = -D[0, 0]
        return D


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        ("writes", "changes its arguments"),
        ("shape", "the stress has the shape"),
        ("nan", "not finite"),
        ("drifts", "not admissible: a zero increment changes it"),
        ("silent", "are not elastic"),
        ("tangent", "the tangent differs .* by 1.0e-01"),
        ("twice named", "different indices"),
        ("unsymmetric", "not symmetric"),
        ("negative", "not positive definite"),
    ],
)
def test_faulty_material(fault, message):
    """[X] Each fault is found and named."""
    with pytest.raises(sc.testing.CheckFailed, match=message):
        sc.testing.check_material(type("Faulty", (Wrong,), {"fault": fault})(**STIFF))


def test_material_with_a_memory_of_its_own():
    """[X] State that is kept in the law, which breaks the line search, shows in the second
    answer.
    """
    calls = []

    class Ageing(sc.LinearElastic):
        def update(self, strain_increment, stress, internal):
            calls.append(1)
            new = super().update(strain_increment, stress, internal)
            return new._replace(stress=new.stress + len(calls))

    with pytest.raises(sc.testing.CheckFailed, match="returns other values the second time"):
        sc.testing.check_material(Ageing(**STIFF))


@dataclass(frozen=True)
class WrongFriction(sc.Coulomb):
    """Friction with one fault."""

    fault: str = ""

    @property
    def bonds(self):
        return None if self.fault == "no bonds" else super().bonds

    def reaches(self, gap, internal, closed):
        if self.fault == "not yet":
            return gap < 0.0
        return gap <= 1e-4 if self.fault == "far" else super().reaches(gap, internal, closed)

    def update(self, jump, internal, penalty):
        new = super().update(jump, internal, penalty)
        size = np.ones((len(jump), 1))  # of the components
        if self.fault == "backward":
            size[1:] = -1.0
            return new._replace(traction=size * new.traction, tangent=size[:, None] * new.tangent)
        if self.fault == "tangent":
            size[1:] = -1.0
            return new._replace(
                tangent=np.where(np.eye(len(jump))[..., None], 1.0, size[:, None]) * new.tangent
            )
        if self.fault == "forgets":
            return new._replace(elastic_slip=0 * new.elastic_slip)
        if self.fault == "soft":
            size[0] = -1.0
            return new._replace(traction=size * new.traction, tangent=size[:, None] * new.tangent)
        if self.fault == "loose":
            return new._replace(tangent=np.where(jump[0] < 0.0, new.tangent, 0.0))
        if self.fault == "one way":
            size[0] = 0.0
            return new._replace(traction=new.traction + size)
        if self.fault == "flat":
            return new._replace(elastic_slip=new.elastic_slip[0])
        return new


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        ("", None),
        ("far", "were open and still are"),
        ("backward", "dissipates negative work"),
        ("tangent", r"tangent\[1, 0\] differs"),
        ("flat", "elastic_slip has the shape"),
        ("forgets", "not admissible"),
        ("soft", "pressure falls"),
        ("one way", "not admissible|opposite"),
        ("not yet", "zero gap are out of reach"),
        ("loose", "zero gap have no stiffness"),
        ("no bonds", "`bonds` must be True or False"),
    ],
)
def test_faulty_friction(fault, message):
    """[X] Each fault is found and named; without one the law passes."""
    law = WrongFriction(0.3, fault=fault)
    if message is None:
        assert sc.testing.check_interface_law(law) < 1e-8
        return
    with pytest.raises(sc.testing.CheckFailed, match=message):
        sc.testing.check_interface_law(law)


class WrongForm(sc.Form, Regularised):
    """A contact pair with one fault."""

    def __init__(self, pair, fault):
        self.pair, self.fault, self.calls = pair, fault, 0
        self.symmetric = fault == "symmetric"  # friction has no symmetric tangent

    def initial_state(self):
        return self.pair.initial_state()

    def assemble(self, x, state):
        out = self.pair.assemble(x, state)
        self.calls += 1
        if self.fault == "memory":
            return sc.Response(out.force * self.calls, lambda: out.state, lambda: out.stiffness)
        if self.fault == "eager":
            assert out.stiffness is not None
        if self.fault == "writes":
            x[0] += 1e-9
        if self.fault == "tangent":
            return sc.Response(out.force, lambda: out.state, lambda: 1.001 * out.stiffness)
        if self.fault == "state":
            away = replace(out.state, stick_point=out.state.stick_point + 1.0)
            return sc.Response(out.force, lambda: away, lambda: out.stiffness)
        if self.fault == "springs":
            springs = 1e3 * identity(len(x), format="csr")
            return sc.Response(
                out.force + springs @ x, lambda: out.state, lambda: out.stiffness + springs
            )
        return out

    def outer(self, x, accepted, candidate):
        return 1.0 if self.fault == "outer" else None

    def outputs(self, x, state):
        if self.fault == "outputs":
            return "text"
        summary = 1 if self.fault == "summary" else "text"
        remarks = [1] if self.fault == "remarks" else [Remark("kind", 1.0, "text")]
        return sc.Outputs(summary=lambda: summary, remarks=lambda: remarks)


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        ("", None),
        ("memory", "returns other values the second time"),
        ("eager", "computed before its first access"),
        ("writes", "changes its arguments"),
        ("tangent", "tangent differs"),
        ("symmetric", "the tangent is not symmetric"),
        ("state", "accepted candidate gives another force"),
        ("springs", "forces do not balance"),
        ("outer", "`outer`"),
        ("outputs", "`outputs` returns no Outputs"),
        ("summary", "the summary of `outputs`"),
        ("remarks", "the remarks of `outputs`"),
    ],
)
def test_faulty_form(fault, message, rng):
    """[X] Each fault is found and named; without one the form passes."""
    basis, pair, x, _ = rough_pair("Q1", 2, sc.Coulomb(0.3), rng)
    form = WrongForm(pair, fault)
    if message is None:
        assert sc.testing.check_form(form, x, form.initial_state(), basis.doflocs) < 1e-7
        return
    with pytest.raises(sc.testing.CheckFailed, match=message):
        sc.testing.check_form(form, x, form.initial_state(), basis.doflocs)
