"""Boreholes and cone penetration tests of files: AGS 4, GEF and BRO XML."""

from __future__ import annotations

import contextlib
import inspect
import io
import re
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy import ndarray

from ..checks import one_line
from .columns import Column
from .sounding import Sounding

#: kPa and m of the units of files.
_PRESSURES = {"PA": 1e-3, "KPA": 1.0, "KN/M2": 1.0, "MPA": 1e3, "MN/M2": 1e3, "BAR": 100.0}
_LENGTHS = {"M": 1.0, "MM": 1e-3, "CM": 1e-2, "FT": 0.3048, "IN": 0.0254}
#: Ends of the names of coordinate systems that have degrees: ETRS89, WGS 84, Amersfoort, NAD83.
_DEGREES = (":4258", ":4326", ":4289", ":4269", ":4979", ":4937")
#: Readings below this number are codes of missing ones, also where a file does not declare them.
_VOID = -900.0
#: Steps between depths that are reported: so many times the median, and so many m.
_WIDE = 5.0
_WIDEST = 0.25
#: Slope of the rods, as the depth over their length, from which a correction is reported.
_STRAIGHT = 1e-6


@dataclass(frozen=True)
class Site:
    """Boreholes and soundings of a file.

    Attributes
    ----------
    boreholes
        Columns by the names of their locations.
    soundings
        Cone penetration tests by the names of their locations; further ones at a location have
        the number of the test as well.
    remarks
        Parts that were left out, in words.
    """

    boreholes: dict[str, Column]
    soundings: dict[str, Sounding]
    remarks: tuple[str, ...] = field(default=())


def read_ags(file: str | Path, soil: str = "GEOL_GEOL") -> Site:
    """Read the boreholes and cone penetration tests of a file of AGS 4.

    Units are the ones of the file. Coordinates are ``LOCA_NATE`` and ``LOCA_NATN``, or the local
    ones.

    Parameters
    ----------
    file
        Name of the file.
    soil
        Heading of the group ``GEOL`` with the names of soils: ``GEOL_GEOL``, ``GEOL_LEG``,
        ``GEOL_FORM`` or ``GEOL_DESC``.

    Raises
    ------
    ValueError
        If the file is not of AGS 4, or has units that are not known, depths that are no numbers,
        or locations without coordinates or level.
    ImportError
        If python-ags4 is missing: install the extra ``ground``.
    """
    # Find the locations.
    tables = _ags_tables(str(file))
    with _named(file):
        if "LOCA" not in tables:
            raise ValueError("it has no group LOCA, which locates boreholes and tests")
        places = _places(tables["LOCA"])
        remarks: list[str] = []
        boreholes = {}
        # Read the layers of boreholes.
        for (hole,), rows in _by_location(tables.get("GEOL"), ("LOCA_ID",)).items():
            units = _units(tables["GEOL"])
            boreholes[hole] = _borehole(hole, rows, units, places, _units(tables["LOCA"]), soil)
        # Report what is missing.
        soundings, tested = _soundings(tables, places)
        if not boreholes and not soundings:
            raise ValueError("it has no layers (GEOL) and no cone penetration tests (SCPT)")
        for name in places:
            if name not in boreholes and name not in tested:
                remarks.append(f"'{name}' has no layers and no cone penetration test")
    return Site(boreholes, soundings, tuple(remarks))


def _places(table: Any) -> dict[str, dict[str, str]]:
    """Return the lines of the group LOCA by the names of their locations."""
    places: dict[str, dict[str, str]] = {}
    for row in _rows(table):
        if row["LOCA_ID"] in places:
            raise ValueError(f"LOCA has the location '{row['LOCA_ID']}' twice")
        places[row["LOCA_ID"]] = row
    return places


def _soundings(
    tables: Mapping[str, Any],
    places: Mapping[str, dict[str, str]],
) -> tuple[dict[str, Sounding], set[str]]:
    """Return the cone penetration tests, and the locations that have one.

    The first test of a location has its name.
    """
    tests = _by_location(tables.get("SCPT"), ("LOCA_ID", "SCPG_TESN"))
    heads = _by_location(tables.get("SCPG"), ("LOCA_ID", "SCPG_TESN"))
    soundings: dict[str, Sounding] = {}
    for key, rows in tests.items():
        if key[0] not in soundings:
            name = key[0]
        else:
            name = " ".join(key)
        head = heads.get(key, [{}])[0]
        units = _units(tables["SCPT"]) | _units(tables.get("SCPG"))
        soundings[name] = _sounding(
            name,
            key[0],
            rows,
            head,
            units,
            places,
            _units(tables["LOCA"]),
        )
    return soundings, {key[0] for key in tests}


def read_cpt(file: str | Path) -> Sounding:
    """Read the cone penetration test of a GEF or BRO XML file.

    Readings that the file declares void, and codes such as -9999, are NaN: pygef would interpolate
    over them. The depth is corrected for the inclination where the file has it, as a remark
    reports.

    Parameters
    ----------
    file
        Name of the file.

    Raises
    ------
    ValueError
        If the file is of another kind, or has no cone resistance or level.
    ImportError
        If pygef 0.14 is missing: install the extra ``ground``, on Python 3.11 or newer.
    """
    try:
        import pygef
    except ImportError as error:
        raise ImportError(
            "pygef reads GEF and BRO files: install the extra `ground`, on Python 3.11 or newer"
        ) from error
    if "remove_pre_excavated_rows" not in inspect.signature(pygef.read_cpt).parameters:
        raise ImportError(
            "pygef is older than 0.14 and would leave readings out: update it, on Python 3.11 or "
            "newer"
        )
    path = Path(file)
    if not path.is_file():
        raise FileNotFoundError(f"there is no file {path}")
    with _named(path), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        tests = len(re.findall(rb"<(?:\w+:)?CPT_O\b", path.read_bytes()))
        if tests > 1:
            raise ValueError(f"it has {tests} tests: save each of them in a file of its own")
        try:
            data = pygef.read_cpt(path, replace_column_voids=False, remove_pre_excavated_rows=False)
        except Exception as error:  # pygef passes errors of its parsers on
            raise ValueError(
                f"it is no cone penetration test of GEF or BRO: {one_line(error)}"
            ) from error
        return _from_pygef(path.stem, data)


@contextlib.contextmanager
def _named(file: str | Path) -> Iterator[None]:
    """Put the name of the file before the message of an error."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from error


def _ags_tables(file: str) -> dict[str, Any]:
    """Return the groups of a file as data frames of texts."""
    try:
        from python_ags4 import AGS4
    except ImportError as error:
        raise ImportError("python-ags4 reads AGS files: install the extra `ground`") from error
    if not Path(file).is_file():
        raise FileNotFoundError(f"there is no file {file}")
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        try:
            tables = AGS4.AGS4_to_dataframe(file)[0]
        except (Exception, SystemExit) as error:  # python-ags4 passes errors of its parser on
            raise ValueError(f"{file} is not a file of AGS 4: {one_line(error)}") from error
    if not tables:
        raise ValueError(f"{file} is not a file of AGS 4: it has no groups")
    return tables


def _units(table: Any) -> dict[str, str]:
    """Return the units of the headings of a group."""
    if table is None:
        return {}
    for row in table.to_dict("records"):
        if row["HEADING"] == "UNIT":
            return {str(name): str(unit).strip() for name, unit in row.items()}
    raise ValueError("a group has no line of units")


def _rows(table: Any) -> list[dict[str, str]]:
    """Return the lines of data of a group."""
    return [row for row in table.to_dict("records") if row["HEADING"] == "DATA"]


def _by_location(table: Any, keys: tuple[str, ...]) -> dict[tuple[str, ...], list[dict[str, str]]]:
    """Return the lines of every location, or of every test at it."""
    found: dict[tuple[str, ...], list[dict[str, str]]] = {}
    if table is not None:
        for row in _rows(table):
            found.setdefault(tuple(str(row.get(key, "")) for key in keys), []).append(row)
    return found


def _number(row: Mapping[str, str], key: str, units: Mapping[str, str], known: dict) -> float:
    """Return a number of a line in m or kPa, or NaN."""
    text = str(row.get(key, "")).strip()
    if not text:
        return float("nan")
    unit = units.get(key, "").upper().replace(" ", "").replace("²", "2")
    if unit not in known:
        raise ValueError(f"{key} has the unit '{units.get(key, '')}', not {', '.join(known)}")
    try:
        return float(text) * float(known[unit])
    except ValueError:
        raise ValueError(f"{key} is '{text}', which is not a number") from None


def _located(
    name: str, places: Mapping[str, dict[str, str]], units: Mapping[str, str]
) -> tuple[tuple[float, float], float]:
    """Return coordinates and level of a location."""
    if name not in places:
        raise ValueError(f"LOCA has no location '{name}'")
    row = places[name]
    for keys in (("LOCA_NATE", "LOCA_NATN", "LOCA_GL"), ("LOCA_LOCX", "LOCA_LOCY", "LOCA_LOCZ")):
        east, north, level = (_number(row, key, units, _LENGTHS) for key in keys)
        if np.isnan(level):
            level = _number(row, "LOCA_GL", units, _LENGTHS)
        if np.isfinite([east, north, level]).all():
            return (east, north), level
    raise ValueError(f"the location '{name}' has no coordinates or no level")


def _borehole(
    name: str,
    rows: list[dict[str, str]],
    units: Mapping[str, str],
    places: Mapping[str, dict[str, str]],
    place_units: Mapping[str, str],
    soil: str,
) -> Column:
    """Return the layers of a borehole; a layer without an end reaches to the next one."""
    # Sort the layers by depth.
    position, level = _located(name, places, place_units)
    tops = [_number(row, "GEOL_TOP", units, _LENGTHS) for row in rows]
    ends = [_number(row, "GEOL_BASE", units, _LENGTHS) for row in rows]
    remarks = []
    layers: list[tuple[str, float]] = []
    order = np.argsort(tops, kind="stable")
    if np.isfinite(tops).any() and np.nanmin(tops) != 0.0:
        remarks.append(
            f"'{name}': the description begins at {np.nanmin(tops):g} m; the first layer "
            "is continued from the surface"
        )
    following = np.append(tops, np.nan)[[*order[1:], len(tops)]]
    for k, next_top in zip(order, following, strict=True):
        text = str(rows[k].get(soil, "")).strip()
        if not text:
            raise ValueError(f"a layer of '{name}' at {tops[k]:g} has no {soil}")
        # Find its lower end beside the layer that follows, and join layers of the same soil.
        lower, told = _lower_end(text, ends[k], float(next_top))
        remarks += [f"'{name}': {remark}" for remark in told]
        if np.isnan(lower):
            raise ValueError(f"the last layer of '{name}' has no GEOL_BASE")
        if layers and layers[-1][0] == text:
            layers.pop()
        layers.append((text, level - lower))
    return Column(name, position, level, tuple(layers), tuple(remarks))


def _lower_end(text: str, base: float, following: float) -> tuple[float, list[str]]:
    """Return the depth of the lower end of a layer, NaN without one, and remarks."""
    if np.isnan(base) and np.isnan(following):
        return base, []
    if np.isnan(base):
        return following, [f"{text} has no base; it ends at the top of the next layer"]
    if following > base:
        return following, [
            f"nothing is described from {base:g} to {following:g} m; {text} above it is continued"
        ]
    if following < base:
        return base, [
            f"the layer below {text} begins at {following:g} m, above its base at {base:g} m, "
            "which is kept"
        ]
    return base, []


def _sounding(
    name: str,
    place: str,
    rows: list[dict[str, str]],
    head: Mapping[str, str],
    units: Mapping[str, str],
    places: Mapping[str, dict[str, str]],
    place_units: Mapping[str, str],
) -> Sounding:
    """Return the test of lines of the group SCPT, and of its head in SCPG."""
    position, level = _located(place, places, place_units)
    depth = np.array([_number(row, "SCPT_DPTH", units, _LENGTHS) for row in rows])
    readings = []
    for key in ("SCPT_RES", "SCPT_FRES", "SCPT_PWP2"):
        readings.append(np.array([_number(row, key, units, _PRESSURES) for row in rows]))
    water = _number(head, "SCPG_WAT", units, _LENGTHS)
    ratio = str(head.get("SCPG_CAR", "")).strip()
    share = 0.01 if units.get("SCPG_CAR") == "%" else 1.0
    area_ratio = share * float(ratio) if ratio else None
    table = None if np.isnan(water) else water
    return _checked(
        name,
        position,
        level,
        depth,
        readings,
        area_ratio,
        table,
        [],
    )


def _from_pygef(name: str, data: Any) -> Sounding:
    """Return the test that pygef read, in MPa, with its voids."""
    # Check what the file must have.
    table = data.data
    headers = data.raw_headers or {}
    if "coneResistance" not in table.columns:
        raise ValueError("it has no cone resistance")
    level = data.delivered_vertical_position_offset
    if level is None:
        raise ValueError("it has no level of the surface")
    _check_complete(headers, len(table))
    place = data.delivered_location
    position = (float(place.x), float(place.y))
    remarks = []
    if str(place.srs_name).endswith(_DEGREES):
        remarks.append(
            f"'{name}': the position is in degrees ({place.srs_name}): sections need metres"
        )
    # Depths are corrected for inclination where the file has them.
    metres = _factor_of(headers, 1, _LENGTHS, 1.0)
    length = metres * _column(table, "penetrationLength", None)
    depth = length
    if "depth" in table.columns:
        depth = _factor_of(headers, 11, _LENGTHS, metres) * _column(table, "depth", None)
        off = np.nanmax(np.abs(depth - length), initial=0.0)
        if off > _STRAIGHT * np.nanmax(length, initial=1.0):
            remarks.append(
                f"'{name}': depths are corrected for the inclination, by up to {off:.3g} m"
            )
    # Read the columns, voids as NaN.
    readings = _readings(data, len(length))
    # Keep water table and area ratio where they are known.
    water = data.groundwater_level
    depth_of_water = None if water is None else float(water)
    quotient = data.cone_surface_quotient
    area_ratio = None if quotient is None else float(quotient)
    return _checked(
        name,
        position,
        float(level),
        depth,
        readings,
        area_ratio,
        depth_of_water,
        remarks,
    )


def _readings(data: Any, count: int) -> list[ndarray]:
    """Return cone resistance, sleeve friction and pore pressure in kPa, NaN without readings."""
    headers = data.raw_headers or {}
    voids: Mapping[str, float] = {}
    if "COLUMNVOID" in headers:
        voids = data.column_void_mapping or {}
    readings = []
    for key, quantity in (("coneResistance", 2), ("localFriction", 3), ("porePressureU2", 6)):
        values = np.full(count, np.nan)
        if key in data.data.columns:
            factor = _factor_of(headers, quantity, _PRESSURES, 1e3)
            values = factor * _column(data.data, key, voids.get(key))
        readings.append(values)
    return readings


def _check_complete(headers: Mapping[str, Any], count: int) -> None:
    """Refuse a GEF file with fewer readings than its head announces."""
    for words in headers.get("LASTSCAN", []):
        announced = str(words[0]).strip()
        if announced.isdigit() and int(announced) > count:
            raise ValueError(
                f"it announces {announced} depths (LASTSCAN), but has {count}: it is not complete, "
                "or LASTSCAN is wrong"
            )


def _factor_of(
    headers: Mapping[str, Any],
    quantity: int,
    units: Mapping[str, float],
    otherwise: float,
) -> float:
    """Return kPa or metres of the unit of a quantity in the head of a GEF file.

    BRO files have MPa and metres.
    """
    for words in headers.get("COLUMNINFO", []):
        if str(words[-1]).strip() == str(quantity):
            unit = str(words[1]).strip()
            if unit.upper() not in units:
                raise ValueError(f"'{words[2]}' has the unit '{unit}', not {', '.join(units)}")
            return units[unit.upper()]
    return otherwise


def _column(table: Any, key: str, void: float | None) -> ndarray:
    """Return a column with NaN in place of voids."""
    values = table[key].to_numpy().astype(float)
    missing = values <= _VOID
    if void is not None:
        missing |= np.isclose(values, float(void))
    return np.where(missing, np.nan, values)


def _checked(
    name: str,
    position: tuple[float, float],
    level: float,
    depth: ndarray,
    readings: list[ndarray],
    area_ratio: float | None,
    water: float | None,
    remarks: list[str],
) -> Sounding:
    """Return a test in the order of its depths, with remarks on missing readings."""
    if area_ratio is not None and not 0.0 < area_ratio <= 1.0:
        raise ValueError(
            f"'{name}' has the area ratio {area_ratio:g} of its cone, which must lie in (0, 1]"
        )
    # Replace voids, and sort by depth.
    readings = [np.where(values <= 1e3 * _VOID, np.nan, values) for values in readings]
    depth = np.where(depth <= _VOID, np.nan, depth)
    usable = np.isfinite(depth)
    order = np.argsort(depth[usable], kind="stable")
    depth = depth[usable][order]
    if len(depth) == 0:
        raise ValueError(f"'{name}' has no depths")
    if (order != np.arange(len(order))).any():
        remarks.append(f"'{name}': readings are sorted by their depths")
    # Report missing readings and missing rows.
    cone, sleeve, pore = (values[usable][order] for values in readings)
    missing = ~(np.isfinite(cone) & np.isfinite(sleeve))
    if missing.any():
        remarks.append(
            f"'{name}': no readings at {np.count_nonzero(missing)} of {len(depth)} depths, from "
            f"{depth[missing].min():g} to {depth[missing].max():g} m"
        )
    gaps = np.diff(depth)
    if (gaps == 0.0).any():
        remarks.append(
            f"'{name}': {np.count_nonzero(gaps == 0.0)} readings have the depth of the one "
            f"before, first at {depth[np.argmin(gaps)]:g} m"
        )
    usual = 0.0
    if len(gaps):
        usual = float(np.median(gaps))
    for k in np.flatnonzero(gaps > max(_WIDE * usual, _WIDEST)):
        remarks.append(f"'{name}': the file has no rows from {depth[k]:g} to {depth[k + 1]:g} m")
    return Sounding(
        name,
        position,
        level,
        depth,
        cone,
        sleeve,
        pore,
        area_ratio=area_ratio,
        water=water,
        remarks=tuple(remarks),
    )
