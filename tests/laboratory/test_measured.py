"""Measured tests: files, fits of known parameters to noisy curves, and bad input."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.laboratory import Measured, fit, read_csv, triaxial


def clay(M: float, lambda_: float) -> sc.CamClay:
    return sc.CamClay(0.02, lambda_, M, nu=0.25, p_ref=100.0)


def noisy(cell: float, noise: float, seed: int) -> Measured:
    """Drained test of known clay, M = 1.1 and lambda = .12, with noise as a share of the largest
    value.
    """
    path = triaxial(strain=-0.1, increments=6)
    test = sc.element_test(clay(1.1, 0.12), cell, path)
    rng, columns = np.random.default_rng(seed), {"axial": test.axial[:, 0]}
    for name in ("q", "volume"):
        values = getattr(test, name)[:, 0]
        columns[name] = values + noise * np.abs(values).max() * rng.standard_normal(len(values))
    return Measured(cell, path, columns)


@pytest.mark.slow
def test_known_parameters() -> None:
    """[X] Without noise the parameters come back; with 1 % they lie within three standard
    errors.
    """
    start = {"M": 1.4, "lambda_": 0.08}
    exact = fit(clay, start, noisy(-100.0, 0.0, 0))
    np.testing.assert_allclose(
        [*exact.parameters.values()], [1.1, 0.12], rtol=1e-5
    )  # of the finite differences
    both = fit(clay, start, [noisy(-100.0, 0.01, 1), noisy(-200.0, 0.01, 2)])
    for name, value in (("M", 1.1), ("lambda_", 0.12)):
        assert 0.0 < both.errors[name] < 0.02 * value
        assert abs(both.parameters[name] - value) < 3.0 * both.errors[name]
    assert 0.005 < np.sqrt((both.differences**2).mean()) < 0.02
    assert both.parameters["M"] == both.material.M


def test_file(tmp_path) -> None:
    """[X] Columns by name, in any order, with units and signs; drawn beside a test."""
    file = tmp_path / "test.csv"
    file.write_text("time;q [kPa];eps_a [%]\n0;0;0\n1;50;1.5\n2;80;3\n", encoding="utf-8-sig")
    columns = read_csv(
        file, {"axial": "eps_a [%]", "q": "q [kPa]"}, {"axial": -0.01}, delimiter=";"
    )
    np.testing.assert_allclose(columns["axial"], [0.0, -0.015, -0.03])
    np.testing.assert_allclose(columns["q"], [0.0, 50.0, 80.0])
    sc.element_test(sc.Tresca(5e3, 0.3, 40.0), -100.0, triaxial(-0.03)).plot(beside=columns)
    with pytest.raises(
        ValueError, match=r"no column of .* 'q'; existing: eps_a \[%\], q \[kPa\], time"
    ):
        read_csv(file, {"q": "q"}, delimiter=";")
    with pytest.raises(ValueError, match="no quantity of a test 'strain'; existing: axial"):
        read_csv(file, {"strain": "eps_a [%]"}, delimiter=";")


def test_bad_fits() -> None:
    """Figures and names."""
    test = noisy(-100.0, 0.0, 0)
    with pytest.raises(ValueError, match="no fitted parameter 'nu'; existing: M, lambda_"):
        fit(clay, {"M": 1.2, "lambda_": 0.1}, test, limits={"nu": (0.1, 0.2)})
    with pytest.raises(ValueError, match=r"goes beyond the end of the path by 0\.05"):
        fit(
            clay, {"M": 1.2, "lambda_": 0.1}, Measured(-100.0, triaxial(strain=-0.05), test.columns)
        )
    with pytest.raises(ValueError, match="first values of its parameters that are not zero"):
        fit(clay, {"M": 0.0, "lambda_": 0.1}, test)


def test_decimal_commas_among_commas_are_refused(tmp_path) -> None:
    """[X] Four numbers below two names: one sentence."""
    file = tmp_path / "test.csv"
    file.write_text("axial,q\n0,5,80,2\n1,5,90,2\n")
    with pytest.raises(ValueError, match="has 2 names of columns, but 4 columns"):
        sc.laboratory.read_csv(file, {"axial": "axial", "q": "q"})
