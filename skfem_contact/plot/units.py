"""Units of the labels in all pictures."""

from __future__ import annotations

_STRESSES = {
    ("kN", "m"): "kPa",
    ("N", "m"): "Pa",
    ("MN", "m"): "MPa",
    ("N", "mm"): "MPa",
    ("kN", "mm"): "GPa",
}
#: Kinds of the units of quantities in tables.
_KINDS = {
    "displacement": "length",
    "N": "line",
    "V": "line",
    "M": "moment",
    "N_hoop": "line",
    "M_hoop": "moment",
    "pressure": "stress",
    "shear": "stress",
}
_chosen: dict[str, str] = {}


def set_units(
    force: str | None = None, length: str | None = None, stress: str | None = None
) -> None:
    """Choose the units in the labels of pictures; figures are not converted.

    Parameters
    ----------
    force, length
        Units of the analysis, such as ``"kN"`` and ``"m"``; without them pictures show no units.
    stress
        Unit of stress; by default kPa for kN and m, MPa for N and mm, and so on.

    Examples
    --------
    >>> import skfem_contact.plot as plot
    >>> plot.set_units("N", "mm")
    >>> plot.labelled("von Mises stress", "stress")
    'von Mises stress [MPa]'
    >>> plot.set_units()
    >>> plot.labelled("von Mises stress", "stress")
    'von Mises stress'
    """
    _chosen.clear()
    if force is not None and length is not None:
        pressure = _STRESSES.get((force, length), f"{force}/{length}²")
        _chosen.update(
            force=force,
            length=length,
            stress=stress or pressure,
            line=f"{force}/{length}",
            moment=f"{force}{length}/{length}",
        )
    elif length is not None:
        _chosen.update(length=length)
    if stress is not None:
        _chosen.update(stress=stress)


def in_words(title: str, kind: str = "") -> str:
    """Return a title of a table with its unit, by its last word if no kind is given."""
    last = title.split(" ")[-1]
    return labelled(title, kind or _KINDS.get(last, ""))


def labelled(title: str, kind: str) -> str:
    """Return a title with its unit, if units were set.

    Parameters
    ----------
    title
        Name of the quantity.
    kind
        ``"length"``, ``"force"``, ``"stress"``, ``"line"`` (force per length), ``"moment"`` (per
        length), or nothing.
    """
    return f"{title} [{_chosen[kind]}]" if kind in _chosen else title
