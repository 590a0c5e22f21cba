"""Pictures of motions in time and of response spectra."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from matplotlib.figure import Figure
from numpy import ndarray

from ..dynamics.record import Record
from ..dynamics.spectrum import Spectrum
from ..results.motion import History
from .diagram import saved, stacked, styles, tidy

Motion = Record | History | Spectrum


def motion(
    parts: Motion | Mapping[str, Motion],
    *,
    file: str | Path | None = None,
) -> Figure:
    """Draw motions over the time, or response spectra over the period.

    Parameters
    ----------
    parts
        One motion or several by their labels, all of one kind:
        :class:`~skfem_contact.Record`, with panels of acceleration, velocity and displacement;
        :class:`~skfem_contact.results.History`, with a panel for each axis; or the spectra of
        records, with panels of acceleration and displacement.
    file
        Name of a picture to write.

    Raises
    ------
    ValueError
        Motions of several kinds, or none.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> import skfem_contact.plot as plot
    >>> record = sc.Record.synthetic(peak=2., duration=8., step=.01)
    >>> figure = plot.motion(record)
    >>> figure = plot.motion({"5 %": record.spectrum(), "10 %": record.spectrum(ratio=.1)})
    """
    if isinstance(parts, Mapping):
        series = dict(parts)
    else:
        series = {"": parts}
    kinds = set()
    for part in series.values():
        quantity = getattr(part, "quantity", "")
        kinds.add((type(part).__name__, quantity))
    if len(kinds) != 1:
        found = ", ".join(sorted(" ".join(kind).strip() for kind in kinds)) or "nothing"
        raise ValueError(f"motions of one picture are of one kind, not {found}")
    curves = {label: _curves(part) for label, part in series.items()}
    titles = list(next(iter(curves.values()))[1])

    # Draw a panel for each quantity.
    figure, axes = stacked(len(titles))
    for ax, title in zip(axes, titles, strict=True):
        for style, (label, (abscissa, values)) in zip(styles(len(curves)), curves.items()):
            ax.plot(abscissa, values[title], label=label, **style)
        ax.set_ylabel(title)
        tidy(ax, len(curves))
    if isinstance(next(iter(series.values())), Spectrum):
        axes[-1].set(xscale="log", xlabel="period")
    else:
        axes[-1].set_xlabel("time")
    return saved(figure, file)


def _curves(part: Motion) -> tuple[ndarray, dict[str, ndarray]]:
    """Return times or periods, and the values over them by their titles."""
    if isinstance(part, Spectrum):
        return part.periods, {
            "spectral acceleration": part.acceleration,
            "spectral displacement": part.displacement,
        }
    if isinstance(part, Record):
        return part.time, {
            "acceleration": part.values,
            "velocity": part.velocity,
            "displacement": part.displacement,
        }
    titles = [f"{part.quantity} {axis}" for axis in "xyz"[: part.values.shape[1]]]
    return part.time, dict(zip(titles, part.values.T, strict=True))
