"""Records of the acceleration of the ground: reading, correction, filters and integrals."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike

from ..arrays import max_abs
from ..checks import finite, format_point, positive
from ..display import Table
from ..results.motion import History
from .spectrum import Spectrum, response_spectrum

#: Times of a file may differ from equal steps by this share of a step, as its digits are cut.
_EQUAL = 1e-3
#: Taps of the filter before a record is resampled to longer steps, and its corner as a share of the
#: highest frequency of the new steps.
_TAPS = 101
_CORNER = 0.8
#: Frequency (Hz) and damping of the ground by Kanai and Tajimi, and shares of the duration in which
#: a synthetic record rises and falls.
_GROUND = 2.5
_DAMPED = 0.6
_RISE = 0.15
_FALL = 0.5


@dataclass(frozen=True)
class Record:
    """Acceleration of the ground at equal steps in time, linear between them.

    Parameters
    ----------
    step
        Step in time.
    values : array_like, shape (n,)
        Accelerations in the units of the model, from time zero on.
    name
        Name for tables.

    Raises
    ------
    ValueError
        A step that is not positive, fewer than two values, or values that are not finite.

    Examples
    --------
    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> time = np.arange(0., 10., .01)
    >>> record = sc.Record(.01, .3 * 9.81 * np.sin(2 * np.pi * time))
    >>> record
    <Record 1000 values, step 0.01, peak 2.943>
    >>> round(record.arias(9.81), 3)                             # pi / (2 g) a^2 t / 2
    6.93
    """

    step: float
    values: ndarray
    name: str = field(default="", repr=False)

    def __post_init__(self) -> None:
        positive(self.step, "the step of a record")
        values = finite(self.values, "the values of a record")
        if values.ndim != 1 or len(values) < 2:
            raise ValueError(
                f"the values of a record must have the shape (n,), n at least 2, not {values.shape}"
            )
        object.__setattr__(self, "values", values)

    def __repr__(self) -> str:
        return f"<Record {len(self.values)} values, step {self.step:g}, peak {self.peak:.4g}>"

    @classmethod
    def of(cls, history: History, axis: str = "x") -> Record:
        """Return a record of an acceleration of a stage, such as for its response spectrum.

        Steps that differ are interpolated linearly at the shortest one.

        Parameters
        ----------
        history
            Accelerations at a node, :meth:`~skfem_contact.results.StageResult.history`, by
            ``absolute=True`` with those of the base.
        axis
            ``"x"``, ``"y"`` or ``"z"``.

        Raises
        ------
        ValueError
            A history of another quantity, or an axis that it has not.
        """
        if history.quantity != "acceleration":
            raise ValueError(f"a record has accelerations, not those of a {history.quantity}")
        axes = "xyz"[: history.values.shape[1]]
        if axis not in tuple(axes):
            raise ValueError(f"axis must be one of {', '.join(axes)}, not {axis!r}")
        time = history.time - history.time[0]
        step = float(np.diff(time).min())
        equal = step * np.arange(round(time[-1] / step) + 1)
        values = np.interp(equal, time, history.values[:, axes.index(axis)])
        return cls(step, values, f"acceleration {axis} at {format_point(history.point)}")

    @classmethod
    def read(cls, file: str | Path, scale: float | None = None) -> Record:
        """Read a file of PEER (``.AT2``), or two columns of times and accelerations.

        Parameters
        ----------
        file
            Columns may be separated by blanks, commas or semicolons, beside which commas are
            decimal; lines that begin with letters
            or ``#``, ``%``, ``!`` are comments.
        scale
            Factor from the unit of the file to the unit of the model, such as 9.81 for a file in g.
            Files of PEER are in g and need it; by default 1 for columns.

        Raises
        ------
        ValueError
            Files of PEER without a number of points and a step, or with other numbers of points;
            times that do not rise by equal steps.
        """
        path = Path(file)
        lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
        heads = []
        for k, line in enumerate(lines[:10]):
            if re.search(r"\bNPTS\b", line, re.I):
                heads.append(k)
        if heads:
            return _peer(path, lines, heads[0], scale)
        return _columns(path, lines, 1.0 if scale is None else scale)

    @classmethod
    def synthetic(
        cls,
        peak: float,
        duration: float = 20.0,
        step: float = 0.01,
        seed: int = 0,
    ) -> Record:
        """Return a record similar to an earthquake: filtered noise that swells and fades.

        The noise has the spectrum of Kanai (1957) and Tajimi (1960) of firm ground at 2.5 Hz, and
        its velocity ends near zero.

        Parameters
        ----------
        peak
            Largest acceleration.
        duration, step
            Length and step.
        seed
            Number of the record: the same numbers give the same record.

        Examples
        --------
        >>> import skfem_contact as sc
        >>> sc.Record.synthetic(2.)
        <Record 2001 values, step 0.01, peak 2>
        """
        from scipy.signal import bilinear, lfilter

        n = round(positive(duration, "duration") / positive(step, "step")) + 1
        noise = np.random.default_rng(seed).standard_normal(n)

        # H(s) = (2 z w s + w^2) / (s^2 + 2 z w s + w^2), and slow motions removed
        w = 2.0 * np.pi * _GROUND
        damping = 2.0 * _DAMPED * w
        b, a = bilinear([damping, w**2], [1.0, damping, w**2], 1.0 / step)
        shaken = lfilter(b, a, noise)
        # Let the motion swell, stay and fade.
        share = np.arange(n) / (n - 1)
        envelope = np.clip(share / _RISE, 0.0, 1.0) ** 2
        envelope *= np.exp(-5.0 * np.maximum(share - _FALL, 0.0))
        record = cls(step, shaken * envelope, f"synthetic {seed}")
        record = record.filtered(low=max(0.2, 2.0 / duration)).corrected()
        return record.scaled(peak / record.peak)

    @property
    def time(self) -> ndarray:
        """Times of the values, (n,)."""
        return self.step * np.arange(len(self.values))

    @property
    def duration(self) -> float:
        """Time of the last value."""
        return self.step * (len(self.values) - 1)

    @property
    def peak(self) -> float:
        """Largest acceleration, without its sign."""
        return max_abs(self.values)

    @property
    def velocity(self) -> ndarray:
        """Velocities from rest, (n,), exact for linear accelerations."""
        a = self.values
        gained = 0.5 * self.step * (a[1:] + a[:-1])
        return np.append(0.0, np.cumsum(gained))

    @property
    def displacement(self) -> ndarray:
        """Displacements from rest, (n,), exact for linear accelerations."""
        a = self.values
        v = self.velocity
        moved = self.step * v[:-1] + self.step**2 * (2.0 * a[:-1] + a[1:]) / 6.0
        return np.append(0.0, np.cumsum(moved))

    def at(self, time: float) -> float:
        """Return the acceleration at a time; zero before the record and after it."""
        if time < 0.0 or time > self.duration * (1.0 + 1e-12):
            return 0.0
        position = min(time / self.step, len(self.values) - 1.0)
        k = min(int(position), len(self.values) - 2)
        share = position - k
        return float((1.0 - share) * self.values[k] + share * self.values[k + 1])

    def motion(self, time: float) -> tuple[float, float, float]:
        """Return displacement, velocity and acceleration at a time, from rest at time zero."""
        end = min(max(time, 0.0), self.duration)
        # Integrate the linear pieces of the acceleration: v exactly, u exactly.
        k = min(int(end / self.step), len(self.values) - 2)
        h = end - k * self.step
        a0 = self.values[k]
        rate = (self.values[k + 1] - a0) / self.step
        v0 = self._integrals[0][k]
        v = v0 + a0 * h + 0.5 * rate * h**2
        u = self._integrals[1][k] + v0 * h + 0.5 * a0 * h**2 + rate * h**3 / 6.0
        # After the end the velocity stays.
        return float(u + v * max(time - end, 0.0)), float(v), self.at(time)

    @property
    def _integrals(self) -> tuple[ndarray, ndarray]:
        """Velocities and displacements, computed once."""
        if "_known" not in vars(self):
            object.__setattr__(self, "_known", (self.velocity, self.displacement))
        return vars(self)["_known"]

    def scaled(self, factor: float) -> Record:
        """Return the record with all values times a factor."""
        return replace(self, values=factor * self.values)

    def corrected(self, order: int = 1) -> Record:
        """Return the record with a corrected baseline.

        The polynomial whose integral fits the velocity best, by least squares, is subtracted. Look
        at velocity and displacement afterwards: a record that begins in motion is not mended so.

        Parameters
        ----------
        order
            Order of the polynomial of the acceleration: 0, 1 or 2.
        """
        if order not in (0, 1, 2):
            raise ValueError(f"order must be 0, 1 or 2, not {order!r}")
        # v ~ sum_k c_k t^(k+1) / (k+1), a - sum_k c_k t^k, with times as shares of the duration
        share = np.arange(len(self.values)) / (len(self.values) - 1.0)
        columns = [share ** (k + 1) / (k + 1) for k in range(order + 1)]
        A = np.column_stack(columns)
        c = np.linalg.lstsq(A, self.velocity / self.duration, rcond=None)[0]
        line = sum(each * share**k for k, each in enumerate(c))
        return replace(self, values=self.values - line)

    def resampled(self, step: float) -> Record:
        """Return the record at another step.

        Longer steps need a filter, at 0.8 of their highest frequency, without delay. At shorter
        steps the record is linear between its values, as spectra and analyses take it to be.
        """
        positive(step, "step")
        # Filter before longer steps: nothing above half of their frequency may fold back.
        values = self.values
        if step > self.step * (1.0 + 1e-9):
            from scipy.signal import filtfilt, firwin

            taps = min(_TAPS, 2 * ((len(values) - 1) // 8) + 1)
            values = filtfilt(firwin(taps, _CORNER * self.step / step), [1.0], values)
        n = int(self.duration / step * (1.0 + 1e-12)) + 1
        found = np.interp(step * np.arange(n), self.time, values)
        return replace(self, step=step, values=found)

    def filtered(
        self,
        low: float | None = None,
        high: float | None = None,
        order: int = 4,
    ) -> Record:
        """Return the record without low or high frequencies, by a Butterworth filter without delay.

        Parameters
        ----------
        low, high
            Frequencies below and above which is filtered; None: no such limit.
        order
            Order of the filter, which runs forwards and backwards.

        Raises
        ------
        ValueError
            No limit at all, or limits that do not lie between 0 and half of the sampling rate.
        """
        from scipy.signal import butter, sosfiltfilt

        # Check the limits.
        limits = [each for each in (low, high) if each is not None]
        nyquist = 0.5 / self.step
        rises = limits == sorted(limits) and len(set(limits)) == len(limits)
        if not limits or not rises or limits[0] <= 0.0 or limits[-1] >= nyquist:
            raise ValueError(
                f"give `low`, `high` or both in this order, between 0 and half of the sampling "
                f"rate, {nyquist:.4g}, not {low!r} and {high!r}"
            )
        # Choose the kind of filter by the limits that are given.
        kind = "bandpass"
        if len(limits) == 1:
            kind = "highpass" if high is None else "lowpass"
        corners: Any = limits if len(limits) == 2 else limits[0]
        options: dict[str, Any] = {"btype": kind, "fs": 1.0 / self.step, "output": "sos"}
        sections = butter(order, corners, **options)
        return replace(self, values=sosfiltfilt(sections, self.values))

    def arias(self, gravity_acceleration: float) -> float:
        """Return the intensity of Arias (1970), ``pi / (2 g)`` times the integral of ``a**2``."""
        g = positive(gravity_acceleration, "gravity_acceleration")
        return float(np.pi / (2.0 * g) * self._squares()[-1])

    def significant_duration(self, begin: float = 0.05, end: float = 0.95) -> float:
        """Return the time between two shares of the intensity of Arias."""
        squares = self._squares()
        if not 0.0 <= begin < end <= 1.0 or squares[-1] == 0.0:
            raise ValueError(
                f"shares must rise between 0 and 1 and the record must move, not {begin}, {end}"
            )
        times = np.interp([begin, end], squares / squares[-1], self.time)
        return float(times[1] - times[0])

    def _squares(self) -> ndarray:
        """Return the integral of the square of the acceleration, exact for linear pieces, (n,)."""
        a = self.values[:-1]
        b = self.values[1:]
        squares = self.step * (a * a + a * b + b * b) / 3.0
        return np.append(0.0, np.cumsum(squares))

    def spectrum(self, periods: ArrayLike | None = None, ratio: float = 0.05) -> Spectrum:
        """Return the response spectrum of oscillators with a damping ratio.

        Parameters
        ----------
        periods : array_like, shape (n,), optional
            Natural periods; by default 100 of them, from 4 steps to a fifth of the duration.
        ratio
            Damping ratio.
        """
        if periods is None:
            periods = np.geomspace(4.0 * self.step, 0.2 * self.duration, 100)
        return response_spectrum(self.step, self.values, finite(periods, "periods"), ratio)

    def table(self) -> Table:
        """Return time, acceleration, velocity and displacement as a table."""
        columns = {
            "time": self.time,
            "acceleration": self.values,
            "velocity": self.velocity,
            "displacement": self.displacement,
        }
        return Table.of(columns, self.name or "record")


def _peer(path: Path, lines: Sequence[str], head: int, scale: float | None) -> Record:
    """Return the record of a file of PEER, whose line `head` has number and step."""
    if scale is None:
        raise ValueError(f"{path.name} is in g: give scale=9.81, or g in the units of the model")
    # Read the number of values and the step, also from the line after.
    if head + 1 < len(lines):
        text = lines[head] + " " + lines[head + 1]
    else:
        text = lines[head]
    number = re.search(r"NPTS\s*=?\s*(\d+)", text, re.I)
    step = re.search(r"\bDT\s*=?\s*([0-9.]+(?:E[+-]?\d+)?)", text, re.I)
    if number is None or step is None:
        # Older files have both numbers before these words.
        number = re.match(r"\s*(\d+)\s", lines[head])
        step = re.match(r"\s*\d+\s+([0-9.]+(?:E[+-]?\d+)?)\s*,?\s*NPTS", lines[head], re.I)
    if number is None or step is None:
        raise ValueError(f"{path.name} has no NPTS and DT in its line {head + 1}")
    # Read the values.
    words = " ".join(lines[head + 1 :]).split()
    values = _numbers(path, words)
    n = int(number[1])
    if len(values) != n:
        raise ValueError(
            f"{path.name} says NPTS={n}, and has {len(values)} values: it is cut or has a gap"
        )
    return Record(float(step[1]), scale * values, path.stem)


def _words(line: str) -> list[str]:
    """Return the numbers of a line as words, none of a line of text."""
    # Commas beside semicolons are decimal.
    comma = " "
    if ";" in line:
        comma = "."
    words = line.replace(",", comma).replace(";", " ").split()
    if words and (words[0][0].isalpha() or words[0][0] in "#%!\"'"):
        return []
    return words


def _columns(path: Path, lines: Sequence[str], scale: float) -> Record:
    """Return the record of a file with columns of times and accelerations."""
    # Leave out lines of text.
    rows = [words[:2] for words in map(_words, lines) if words]
    if len(rows) < 2 or min(map(len, rows)) < 2:
        raise ValueError(f"{path.name} must have two columns, times and accelerations")
    # Check that times rise by equal steps.
    words = [word for row in rows for word in row]
    time, values = _numbers(path, words).reshape(-1, 2).T
    steps = np.diff(time)
    step = float(np.median(steps))
    wrong = np.flatnonzero(np.abs(steps - step) > _EQUAL * abs(step))
    if step <= 0.0 or len(wrong):
        k = 0
        if len(wrong):
            k = int(wrong[0])
        raise ValueError(
            f"the times of {path.name} must rise by equal steps: {time[k + 1]:g} follows "
            f"{time[k]:g}, the usual step is {step:g}; interpolate the record, or fill its gap"
        )
    mean = float((time[-1] - time[0]) / (len(time) - 1))
    return Record(float(f"{mean:.6g}"), scale * values, path.stem)


def _numbers(path: Path, words: Sequence[str]) -> ndarray:
    """Return words as numbers."""
    try:
        values = np.array(words, float)
    except ValueError as error:
        raise ValueError(f"{path.name} has values that are no numbers: {error}") from None
    if not np.isfinite(values).all():
        k = int(np.flatnonzero(~np.isfinite(values))[0])
        raise ValueError(f"{path.name} has a gap: value {k + 1} is {values[k]}")
    return values
