"""Pictures of motions in time and of spectra."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact import plot

RECORD = sc.Record.synthetic(peak=2.0, duration=4.0, step=0.01)


def lines(figure):
    """Return the curves of all panels, (panels, curves)."""
    return [[line.get_ydata() for line in ax.lines] for ax in figure.axes]


def test_panels_hold_the_values(tmp_path):
    """[X] Records, histories and spectra are drawn with their own numbers."""
    figure = plot.motion({"a": RECORD, "b": RECORD.scaled(0.5)}, file=tmp_path / "record.png")
    assert (tmp_path / "record.png").stat().st_size > 1000
    (first, half), (velocity, _), (displacement, _) = lines(figure)
    np.testing.assert_array_equal(first, RECORD.values)
    np.testing.assert_allclose(half, 0.5 * first)
    np.testing.assert_array_equal(velocity, RECORD.velocity)
    np.testing.assert_array_equal(displacement, RECORD.displacement)
    assert [text.get_text() for text in figure.axes[0].get_legend().get_texts()] == ["a", "b"]

    time = np.linspace(0.0, 1.0, 5)
    values = np.column_stack((time, time**2))
    figure = plot.motion(sc.results.History("velocity", np.zeros(2), time, values))
    assert [ax.get_ylabel() for ax in figure.axes] == ["velocity x", "velocity y"]
    np.testing.assert_array_equal(lines(figure)[1][0], time**2)

    spectrum = RECORD.spectrum()
    figure = plot.motion(spectrum)
    np.testing.assert_array_equal(lines(figure)[0][0], spectrum.acceleration)
    assert figure.axes[-1].get_xscale() == "log"
    plt.close("all")


def test_kinds_do_not_mix():
    """One sentence says which kinds were given."""
    with pytest.raises(ValueError, match="of one kind, not Record, Spectrum"):
        plot.motion({"a": RECORD, "b": RECORD.spectrum()})
    with pytest.raises(ValueError, match="of one kind, not nothing"):
        plot.motion({})
