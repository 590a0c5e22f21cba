"""Records: files, correction, resampling, filters, integrals and intensity."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc

STEP = 0.005


def sine(frequency=2.0, n=4000, step=STEP):
    """Return a record of a sine."""
    return sc.Record(step, np.sin(2.0 * np.pi * frequency * step * np.arange(n)))


def written(path, values, npts=None, step=".0050 SEC"):
    """Write a file of PEER with five columns."""
    rows = values.reshape(-1, 5)
    head = "PEER\nsine\nACCELERATION IN UNITS OF G\n"
    head += f"NPTS= {npts or values.size}, DT= {step}\n"
    path.write_text(head + "\n".join(" ".join(f"{v:.7E}" for v in row) for row in rows))
    return path


def test_file_of_peer(tmp_path):
    """[X] Number, step and values come back, in the units of the model."""
    record = sine()
    file = written(tmp_path / "made.AT2", record.values / 9.81)
    found = sc.Record.read(file, scale=9.81)
    assert found.step == STEP
    assert found.name == "made"
    np.testing.assert_allclose(found.values, record.values, atol=1e-6)


@pytest.mark.parametrize("separator", [" ", ",", ";"])
def test_columns(tmp_path, separator):
    """[X] Two columns with a head, separated by blanks, commas or semicolons."""
    record = sine(n=50)
    rows = [f"{t:.4f}{separator}{a:.8f}" for t, a in zip(record.time, record.values, strict=True)]
    file = tmp_path / "made.csv"
    file.write_text(f"time{separator}acceleration\n# a comment\n" + "\n".join(rows))
    found = sc.Record.read(file)
    assert found.step == pytest.approx(STEP)
    np.testing.assert_allclose(found.values, record.values, atol=1e-8)


def test_decimal_commas(tmp_path):
    """[X] Columns of other countries: semicolons between numbers with decimal commas."""
    file = tmp_path / "made.csv"
    file.write_text("t (s); a, in m/s2\n0,00;0,5\n0,01;-1,25\n0,02;2\n", encoding="utf-8")
    record = sc.Record.read(file)
    np.testing.assert_array_equal(record.values, [0.5, -1.25, 2.0])
    assert record.step == pytest.approx(0.01)


def test_older_file_of_peer(tmp_path):
    """[X] Number and step before their names."""
    file = tmp_path / "old.AT2"
    head = "PEER\nmade\nACCELERATION IN UNITS OF G\n    4    .0050    NPTS, DT\n"
    file.write_text(head + "  .1000000E-01  .2000000E-01\n -.3000000E-01  .4\n", encoding="utf-8")
    record = sc.Record.read(file, scale=10.0)
    np.testing.assert_allclose(record.values, [0.1, 0.2, -0.3, 4.0])
    assert record.step == 0.005


def test_columns_may_begin_at_any_time(tmp_path):
    """[X] The step is the mean of the differences of the times."""
    file = tmp_path / "later.csv"
    file.write_text("\n".join(f"{3.0 + 0.02 * k:.2f} {k}" for k in range(11)))
    assert sc.Record.read(file).step == pytest.approx(0.02, rel=1e-6)


def test_values_at_both_ends():
    """[X] The first and the last value at these times, also at one of round-off, none outside."""
    record = sc.Record(0.1, np.array([1.0, 2.0, 4.0, 3.0]))
    assert record.at(0.0) == 1.0
    assert record.at(record.duration) == 3.0
    assert record.at(record.duration * (1.0 + 1e-15)) == 3.0
    assert record.at(-1e-9) == record.at(0.3 + 1e-9) == 0.0
    assert record.at(0.15) == pytest.approx(3.0)


def test_bad_files(tmp_path):
    """[X] One sentence each: no unit, wrong number, gaps, no columns."""
    values = sine(n=100).values
    file = written(tmp_path / "made.AT2", values)
    with pytest.raises(ValueError, match=r"is in g: give scale=9.81"):
        sc.Record.read(file)
    with pytest.raises(ValueError, match="says NPTS=120, and has 100 values"):
        sc.Record.read(written(tmp_path / "cut.AT2", values, npts=120), scale=9.81)
    with pytest.raises(ValueError, match="no NPTS and DT in its line 4"):
        sc.Record.read(written(tmp_path / "step.AT2", values, step="unknown"), scale=9.81)
    gap = tmp_path / "gap.txt"
    gap.write_text("0 0\n.01 1\n.02 2\n.05 1\n.06 0\n")
    with pytest.raises(ValueError, match=r"equal steps: 0.05 follows 0.02, the usual step is 0.01"):
        sc.Record.read(gap)
    gap.write_text("0 0\n.01 1\n.02 nan\n.03 1\n")
    with pytest.raises(ValueError, match="has a gap: value 6 is nan"):
        sc.Record.read(gap)
    gap.write_text("0\n1\n2\n")
    with pytest.raises(ValueError, match="must have two columns"):
        sc.Record.read(gap)
    gap.write_text("0 0\n.01 one\n.02 2\n")
    with pytest.raises(ValueError, match="values that are no numbers"):
        sc.Record.read(gap)


@pytest.mark.parametrize(
    "call, text",
    [
        (lambda: sc.Record(0.0, np.ones(3)), "step of a record must be"),
        (lambda: sc.Record(0.1, np.ones((3, 2))), r"must have the shape \(n,\)"),
        (lambda: sc.Record(0.1, np.array([0.0, np.nan])), "must be finite numbers"),
        (lambda: sine().corrected(5), "order must be 0, 1 or 2"),
        (lambda: sine().filtered(), "give `low`, `high` or both"),
        (lambda: sine().filtered(low=5.0, high=1.0), "give `low`, `high` or both"),
        (lambda: sine().filtered(high=200.0), "half of the sampling rate, 100"),
        (lambda: sine().spectrum([0.0]), "periods must be positive"),
        (lambda: sine().spectrum([1.0], ratio=5.0), "between 0 and 1"),
        (lambda: sine().significant_duration(0.9, 0.1), "shares must rise"),
    ],
)
def test_bad_input(call, text):
    """[X] One sentence about what is wrong."""
    with pytest.raises(ValueError, match=text):
        call()


def test_integrals_are_exact_for_linear_accelerations():
    """[X] a = 2 + 3 t gives v = 2 t + 3 t^2 / 2, u = t^2 + t^3 / 2, also between the values."""
    record = sc.Record(0.1, 2.0 + 0.3 * np.arange(11))
    t = record.time
    np.testing.assert_allclose(record.velocity, 2.0 * t + 1.5 * t**2, atol=1e-14)
    np.testing.assert_allclose(record.displacement, t**2 + 0.5 * t**3, atol=1e-14)
    t = 0.537
    u, v, a = record.motion(t)
    assert (u, v, a) == pytest.approx((t**2 + 0.5 * t**3, 2.0 * t + 1.5 * t**2, 2.0 + 3.0 * t))
    # after the end the velocity stays
    u, v, a = record.motion(1.5)
    assert (u, v, a) == pytest.approx((1.5 + 3.5 * 0.5, 3.5, 0.0))
    assert record.at(-0.1) == 0.0


def test_baseline():
    """[X] A drift of the acceleration that is linear is found, but for the motion itself."""
    # whole periods of a cosine: their velocity has no mean and no slope
    t = STEP * np.arange(4001)
    true = sc.Record(STEP, np.cos(2.0 * np.pi * 2.0 * t))
    drifting = sc.Record(STEP, true.values + 0.02 + 0.001 * t)
    assert drifting.velocity[-1] > 0.5
    found = drifting.corrected()
    # the velocity of the cosine correlates a little with a line: 6 / (pi f T)^2 of its amplitude
    np.testing.assert_allclose(found.values, true.values, atol=1e-3)
    assert abs(found.velocity[-1]) < 0.01 * drifting.velocity[-1]
    assert abs(drifting.corrected(order=0).velocity[-1]) > 1e-2


def test_resampling():
    """[X] A sine of 2 Hz survives longer and shorter steps; half of the higher rate is removed."""
    record = sine()
    longer = record.resampled(0.01)
    assert longer.duration == pytest.approx(record.duration, abs=0.01)
    np.testing.assert_allclose(longer.values[100:-100], record.values[::2][100:-100], atol=3e-3)
    shorter = record.resampled(0.0025)
    np.testing.assert_allclose(shorter.values[::2], record.values, atol=1e-12)
    # where the filter has all of its taps
    assert np.abs(sine(frequency=70.0).resampled(0.01).values[50:-50]).max() < 0.01


def test_filters():
    """[X] A Butterworth filter that runs both ways halves its corner, without delay."""
    record = sine(n=8000)
    middle = slice(3000, 5000)
    for given in ({"low": 2.0}, {"high": 2.0}):
        half = record.filtered(**given).values[middle]
        np.testing.assert_allclose(half, 0.5 * record.values[middle], atol=1e-3)
    kept = record.filtered(low=0.2, high=20.0).values[middle]
    np.testing.assert_allclose(kept, record.values[middle], atol=1e-3)
    assert np.abs(record.filtered(high=0.2).values[middle]).max() < 1e-3


def test_intensity_of_arias():
    """[X] pi / (2 g) a^2 T / 2 of a sine; 90 % of it in 90 % of the time."""
    # linear pieces lose (w step)^2 / 6 of a sine's square
    record = sine(n=4001)
    exact = np.pi / (2.0 * 9.81) * record.duration / 2.0
    assert record.arias(9.81) == pytest.approx(exact, rel=2e-3)
    assert record.significant_duration() == pytest.approx(0.9 * record.duration, rel=2e-3)


def test_synthetic_record():
    """[X] The same number gives the same record, which ends at rest."""
    record = sc.Record.synthetic(3.0, seed=4)
    assert record.peak == pytest.approx(3.0)
    np.testing.assert_array_equal(record.values, sc.Record.synthetic(3.0, seed=4).values)
    assert not np.allclose(record.values, sc.Record.synthetic(3.0, seed=5).values)
    assert abs(record.velocity[-1]) < 0.05 * np.abs(record.velocity).max()
    assert len(record.table()) == 2001


def history(time, values, quantity="acceleration"):
    """Motion of the origin."""
    return sc.results.History(quantity, np.zeros(2), np.asarray(time), np.asarray(values))


def test_record_of_a_history():
    """[X] Equal steps are taken as they are; others are interpolated at the shortest one."""
    time = np.linspace(2.0, 3.0, 11)
    values = np.column_stack((np.sin(time), np.cos(time)))
    found = sc.Record.of(history(time, values), "y")
    assert found.step == pytest.approx(0.1)
    np.testing.assert_allclose(found.values, np.cos(time), atol=1e-14)
    found = sc.Record.of(history([0.0, 0.1, 0.3, 0.5], [[0, 0], [1, 0], [3, 0], [5, 0]]))
    np.testing.assert_allclose(found.values, np.arange(6.0), atol=1e-12)
    with pytest.raises(ValueError, match="a record has accelerations, not those of a velocity"):
        sc.Record.of(history(time, values, "velocity"))
    with pytest.raises(ValueError, match="axis must be one of x, y, not 'z'"):
        sc.Record.of(history(time, values), "z")
