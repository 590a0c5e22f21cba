"""Units in the labels of pictures, in tables and in reports."""

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
    **dict.fromkeys(("n_1", "n_2", "n_12"), "line"),
    **dict.fromkeys(("m_1", "m_2", "m_12"), "moment"),
    "N_hoop": "line",
    "M_hoop": "moment",
    "pressure": "stress",
    "shear": "stress",
    "gap": "length",
    "slip": "length",
    "x": "length",
    "y": "length",
    "z": "length",
    "arc": "length",
    "position": "length",
    "unit weight": "weight",
    "skin": "line",
}
#: Kinds of the units of parameters of laws and structures by their names.
_PARAMETERS = {
    **dict.fromkeys(
        (
            "E",
            "c",
            "c_end",
            "tension",
            "adhesion",
            "strength",
            "E50_ref",
            "Eoed_ref",
            "Eur_ref",
            "G0_ref",
            "p_ref",
            "POP",
            "s_uA",
            "s_uDSS",
            "s_uP",
            "sigma_ci",
            "bulk_modulus_water",
        ),
        "stress",
    ),
    **dict.fromkeys(("phi", "psi", "phi_end"), "angle"),
    **dict.fromkeys(("yield_force", "jack", "F_base"), "force"),
    **dict.fromkeys(("spacing", "diameter"), "length"),
    **dict.fromkeys(("T_max", "p_max"), "line"),
    "unit_weight": "weight",
}
_chosen: dict[str, str] = {}


def set_units(
    force: str | None = None, length: str | None = None, stress: str | None = None
) -> None:
    """Choose the units in pictures, tables and reports; figures are not converted.

    Parameters
    ----------
    force, length
        Units of the analysis, such as ``"kN"`` and ``"m"``, both or none; without them no units
        are shown.
    stress
        Unit of stress; by default kPa for kN and m, MPa for N and mm, and so on.

    Raises
    ------
    ValueError
        A unit that is empty, or a force without a length.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> import skfem_contact.plot as plot
    >>> sc.set_units("N", "mm")
    >>> plot.labelled("von Mises stress", "stress")
    'von Mises stress [MPa]'
    >>> sc.set_units()
    >>> plot.labelled("von Mises stress", "stress")
    'von Mises stress'
    """
    for unit in (force, length, stress):
        if unit is not None and not unit.strip():
            raise ValueError(f"a unit is a text such as 'kN' or 'm', not {unit!r}")
    if force is not None and length is None:
        raise ValueError(f"the force has the unit {force!r}: give that of the length as well")
    _chosen.clear()
    if force is not None and length is not None:
        pressure = _STRESSES.get((force, length), f"{force}/{length}²")
        _chosen.update(
            force=force,
            length=length,
            stress=stress or pressure,
            weight=f"{force}/{length}³",
            line=f"{force}/{length}",
            moment=f"{force}{length}/{length}",
        )
    elif length is not None:
        _chosen.update(length=length)
    if stress is not None:
        _chosen.update(stress=stress)


def unit_of(kind: str) -> str:
    """Return the unit of a kind of quantities, empty if none was set."""
    return _chosen.get(kind, "")


def unit_of_parameter(name: str) -> str:
    """Return the unit of a parameter of a law or structure, empty where it has none."""
    kind = _PARAMETERS.get(name, "")
    if kind == "angle":
        return "°"
    return unit_of(kind)


def in_words(title: str, kind: str = "") -> str:
    """Return a title of a table with its unit, by its last word if no kind is given."""
    return labelled(title, kind or kind_of(title))


def kind_of(title: str) -> str:
    """Return the kind of the unit of a title in a table, by its last word."""
    return _KINDS.get(title.split(" ")[-1], "")


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
    if kind in _chosen:
        return f"{title} [{_chosen[kind]}]"
    return title
