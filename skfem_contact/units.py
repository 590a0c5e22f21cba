"""Units in the labels of pictures, in tables and in reports."""

from __future__ import annotations

from typing import Literal

from .checks import nearest
from .errors import warn

#: Units that are known, by what they measure; others are taken as they are.
_KNOWN = {
    "force": ("N", "kN", "MN", "GN", "daN", "dyn", "kp", "kgf", "t", "tf", "lb", "lbf", "kip"),
    "length": ("m", "mm", "cm", "dm", "km", "µm", "in", "ft", "yd"),
    "stress": ("Pa", "hPa", "kPa", "MPa", "GPa", "bar", "psi", "ksi", "psf", "ksf"),
}
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
    "force": "force",
}
#: Kinds of the units of section forces in space, of whole members.
_IN_SPACE = {"N": "force", "V": "force", "M": "couple", "T": "couple"}
#: Extent to which forces and stiffnesses of a form belong: a whole member, a unit of length out of
#: the plane, or a radian about the axis.
Extent = Literal["member", "length", "radian"]
#: Kinds of the units of quantities of a member, per length and per radian.
_PER = {
    "member": {},
    "length": {"force": "line", "couple": "moment", "bending": "bending per length"},
    "radian": {"force": "force per radian"},
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
    **dict.fromkeys(("yield_force", "jack", "F_base", "EA", "GA", "Np"), "force"),
    **dict.fromkeys(("EI", "GJ"), "bending"),
    "Mp": "couple",
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
        are shown. Any text will do; one that resembles a known unit is a warning.
    stress
        Unit of stress; by default kPa for kN and m, MPa for N and mm, and so on.

    Raises
    ------
    ValueError
        A unit that is empty or measures something else, a force without a length, a stress that is
        not the one of force and length.

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
    for kind, unit in {"force": force, "length": length, "stress": stress}.items():
        if unit is not None:
            _check(kind, unit)
    if force is not None and length is None:
        raise ValueError(f"the force has the unit {force!r}: give that of the length as well")
    chosen = {}
    if length is not None:
        chosen["length"] = length
    if force is not None and length is not None:
        pressure = _STRESSES.get((force, length), f"{force}/{length}²")
        if stress != pressure and {stress, pressure} <= set(_STRESSES.values()):
            raise ValueError(
                f"stresses are {pressure} with {force} and {length}, not {stress}: figures are not "
                "converted"
            )
        chosen.update(
            force=force,
            stress=pressure,
            weight=f"{force}/{length}³",
            line=f"{force}/{length}",
            moment=f"{force}{length}/{length}",
            couple=f"{force}{length}",
            bending=f"{force}{length}²",
        )
        chosen.update(
            {
                "force per radian": f"{force}/rad",
                "bending per length": f"{force}{length}²/{length}",
            }
        )
    if stress is not None:
        chosen["stress"] = stress
    _chosen.clear()
    _chosen.update(chosen)


def _check(kind: str, unit: str) -> None:
    """Refuse an empty unit and one of another kind, and warn of one that resembles another."""
    if not unit.strip():
        raise ValueError(f"a unit is a text such as 'kN' or 'm', not {unit!r}")
    if unit in _KNOWN[kind]:
        return
    for other, units in _KNOWN.items():
        if unit in units:
            raise ValueError(f"{unit!r} is a unit of {other}, not of {kind}")
    alike = nearest(unit, _KNOWN[kind])
    if alike:
        warn(f"there is no unit of {kind} {unit!r} that is known, and it is taken as it is{alike}")


def unit_of(kind: str) -> str:
    """Return the unit of a kind of quantities, empty if none was set."""
    return _chosen.get(kind, "")


def unit_of_parameter(name: str, extent: Extent = "member") -> str:
    """Return the unit of a parameter of a law or structure, empty where it has none."""
    kind = _PARAMETERS.get(name, "")
    if kind == "angle":
        return "°"
    return unit_of(kind_per(kind, extent))


def kind_per(kind: str, extent: Extent) -> str:
    """Return the kind of a unit per extent, given its kind for a whole member."""
    return _PER[extent].get(kind, kind)


def kind_of(title: str, in_space: bool = False) -> str:
    """Return the kind of the unit of a title in a table, by its last word."""
    word = title.split(" ")[-1]
    kind = _KINDS.get(word, "")
    if in_space:
        return _IN_SPACE.get(word, kind)
    return kind


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
