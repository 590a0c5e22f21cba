"""A footing and a pit with every law of soils: Newton's method takes few iterations, and no
increment is cut.
"""

from __future__ import annotations

import logging

import numpy as np
import pytest
from skfem import Basis, ElementQuad2, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact.materials import Material

LAWS: dict[str, Material] = {
    "MohrCoulomb": sc.MohrCoulomb(2e4, 0.3, c=5.0, phi=30.0),
    "HoekBrown": sc.HoekBrown(2e4, 0.3, sigma_ci=100.0, m_b=2.0, s=0.1, a=0.51),
    "CamClay": sc.CamClay(0.01, 0.06, 1.2, 0.25, 100.0, OCR=1.3, attraction=5.0),
    "CamClay, Lode": sc.CamClay(
        0.01, 0.06, 1.2, 0.25, 100.0, OCR=1.3, extension=0.71, attraction=5.0
    ),
    "SoftSoilCreep": sc.SoftSoilCreep(
        0.01, 0.06, 1.2, 0.25, 100.0, mu=2e-3, tau=1.0, OCR=1.3, attraction=5.0
    ),
    "HardeningSoil": sc.HardeningSoil(2e4, 2e4, 6e4, 0.5, c=5.0, phi=30.0),
    "HardeningSoil, small strains": sc.HardeningSoil(
        2e4, 2e4, 6e4, 0.5, 5.0, 30.0, G0_ref=6e4, gamma_07=2e-4
    ),
    "NgiAdp": sc.NgiAdp(
        2e4, 0.45, s_uA=80.0, s_uDSS=65.0, s_uP=50.0, gamma_A=0.01, gamma_DSS=0.02, gamma_P=0.03
    ),
}


def ground(law: Material, width: float, across: int, pit: float) -> tuple[Basis, sc.Model]:
    """Ground of 8 m, and a pit of 3 m beside a smooth rigid wall if it has a width."""
    mesh = MeshQuad.init_tensor(
        np.linspace(0, width, across + 1), np.linspace(0, 8, 9)
    ).with_defaults()
    parts = {"ground": lambda x: (x[1] < 5) | (x[0] > pit)}
    if pit:
        parts["pit"] = lambda x: (x[1] > 5) & (x[0] < pit)
    basis = Basis(mesh.with_subdomains(parts), ElementVector(ElementQuad2()), intorder=4)
    wall = basis.get_dofs(lambda x: (np.abs(x[0] - pit) < 1e-9) & (x[1] > 5 - 1e-9)).all("u^1")
    forms = {name: sc.SolidForm(basis.with_elements(name), law, unit_weight=20.0) for name in parts}
    return basis, sc.Model(forms, np.union1d(sc.box_supports(basis), wall))


@pytest.mark.slow
@pytest.mark.filterwarnings(
    "ignore:.*(rotate by|are taken for small)"
)  # clay below the footing: strains of 20 %
@pytest.mark.parametrize("name", LAWS)
def test_few_iterations(name: str, caplog: pytest.LogCaptureFixture) -> None:
    """[B] At most 5 an increment; the first one of a footing on clay, which trebles the pressure
    there, may take 6.

    Steps of clay that creeps are as short as the error of their strains demands: increments are
    more than asked for where the footing sinks in, and none for want of equilibrium.
    """
    caplog.set_level(logging.INFO, "skfem_contact")
    law, counts = LAWS[name], []
    for width, across, pit, increments in ((10.0, 8, 0.0, 10), (12.0, 12, 4.0, 8)):
        basis, model = ground(law, width, across, pit)
        duration = 1.0 if law.time_dependent else 0.0
        push = (
            None if pit else sc.traction(basis, "top", lambda x: (0 * x[0], -150.0 * (x[0] < 2.5)))
        )
        stage = sc.Stage(
            "loaded",
            push,
            deactivate="pit" if pit else (),
            increments=increments,
            duration=duration,
        )
        result = model.run([stage], start=model.k0_state(K0=0.55), progress=False)
        taken = len(result["loaded"].iterations)
        if law.time_dependent and not pit:
            assert increments < taken <= 5 * increments
        else:
            assert taken == increments
        counts += result["loaded"].iterations
    assert not [record for record in caplog.records if "failed, cut" in record.getMessage()]
    assert max(counts[1:]) <= 5
    assert counts[0] <= (6 if name == "CamClay" else 5)
