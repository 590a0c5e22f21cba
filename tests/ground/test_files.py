"""Files of ground data, as their dictionaries define them: missing readings stay missing."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc

ags4 = pytest.importorskip("python_ags4")
pygef = pytest.importorskip("pygef")

AGS = """"GROUP","PROJ"
"HEADING","PROJ_ID","PROJ_NAME"
"UNIT","",""
"TYPE","ID","X"
"DATA","1","Made for a test"

"GROUP","LOCA"
"HEADING","LOCA_ID","LOCA_NATE","LOCA_NATN","LOCA_GL"
"UNIT","","m","m","m"
"TYPE","ID","2DP","2DP","2DP"
"DATA","B1","100.00","50.00","4.00"
"DATA","B2","130.00","90.00","1.50"
"DATA","C1","115.00","70.00","3.00"
"DATA","TP","0.00","0.00","1.00"

"GROUP","GEOL"
"HEADING","LOCA_ID","GEOL_TOP","GEOL_BASE","GEOL_DESC","GEOL_GEOL"
"UNIT","","m","m","",""
"TYPE","ID","2DP","2DP","X","PA"
"DATA","B1","0.00","3.00","Loose SAND","SAND"
"DATA","B1","3.00","5.00","Soft CLAY","CLAY"
"DATA","B1","6.00","12.00","Firm CLAY","CLAY"
"DATA","B2","0.00","","Loose SAND","SAND"
"DATA","B2","1.00","11.00","Soft CLAY","CLAY"

"GROUP","SCPG"
"HEADING","LOCA_ID","SCPG_TESN","SCPG_WAT","SCPG_CAR"
"UNIT","","","m",""
"TYPE","ID","X","2DP","3DP"
"DATA","C1","1","1.00","0.800"

"GROUP","SCPT"
"HEADING","LOCA_ID","SCPG_TESN","SCPT_DPTH","SCPT_RES","SCPT_FRES","SCPT_PWP2"
"UNIT","","","m","MPa","{unit}","kPa"
"TYPE","ID","X","2DP","3DP","4DP","4DP"
{rows}
"""


#: Units of pressure and length, as they are in one kPa and one m.
PRESSURES = {"Pa": 1e3, "kPa": 1.0, "kN/m2": 1.0, "MPa": 1e-3, "MN/m2": 1e-3, "bar": 0.01}
LENGTHS = {"m": 1.0, "mm": 1e3, "cm": 100.0, "ft": 1 / 0.3048, "in": 1 / 0.0254}


def ags(path, unit="kPa", rows=None):
    """Write a file with a sand of 8 MPa over a clay of 0.6 MPa."""
    if rows is None:
        factor = PRESSURES.get(unit, 1.0)
        rows = []
        for depth in np.arange(0.1, 10.05, 0.1):
            sand = depth <= 4.0
            cone = 8.0 if sand else 0.6
            sleeve = (48.0 if sand else 24.0) * factor
            pore = 0.0 if sand else 100.0
            rows.append(f'"DATA","C1","1","{depth:.2f}","{cone}","{sleeve:.4f}","{pore}"')
    path.write_text(AGS.format(unit=unit, rows="\n".join(rows)), newline="\r\n")
    return path


@pytest.mark.parametrize("unit", PRESSURES)
def test_ags_with_the_units_of_its_headings(tmp_path, unit):
    """[X] Layers, coordinates and readings in kPa, whatever unit a heading has."""
    site = sc.ground.read_ags(ags(tmp_path / "site.ags", unit))
    first = site.boreholes["B1"]
    assert first.position == (100.0, 50.0) and first.level == 4.0
    assert first.layers == (("SAND", 1.0), ("CLAY", -8.0))
    assert any("nothing is described from 5 to 6 m" in text for text in first.remarks)
    second = site.boreholes["B2"]
    assert second.layers == (("SAND", 0.5), ("CLAY", -9.5))
    assert any("has no base" in text for text in second.remarks)
    test = site.soundings["C1"]
    assert (test.water, test.area_ratio) == (1.0, 0.8)
    np.testing.assert_allclose(test.cone[[0, -1]], [8000.0, 600.0])
    np.testing.assert_allclose(test.sleeve[[0, -1]], [48.0, 24.0])
    np.testing.assert_allclose(test.resistance[-1], 600.0 + 0.2 * 100.0)
    assert site.remarks == ("'TP' has no layers and no cone penetration test",)


@pytest.mark.parametrize("unit", LENGTHS)
def test_lengths_with_the_units_of_their_headings(tmp_path, unit):
    """[X] Depths in m."""
    file = ags(tmp_path / "site.ags", rows=[f'"DATA","C1","1","{2.0 * LENGTHS[unit]}","8","40",""'])
    file.write_text(file.read_text().replace('"m","MPa"', f'"{unit}","MPa"'))
    depth = sc.ground.read_ags(file).soundings["C1"].depth
    np.testing.assert_allclose(depth, [2.0], rtol=1e-12)


def test_thin_gaps_between_layers_are_told(tmp_path):
    """[X] A gap of 5 cm is a remark as well."""
    file = ags(tmp_path / "site.ags")
    file.write_text(file.read_text().replace('"6.00","12.00"', '"5.05","12.00"'))
    borehole = sc.ground.read_ags(file).boreholes["B1"]
    assert any("nothing is described from 5 to 5.05 m" in text for text in borehole.remarks)


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ('"3.00","5.00"', '"2.00","5.00"', "below SAND begins at 2 m, above its base at 3 m"),
        ('"B1","0.00"', '"B1","0.50"', "the description begins at 0.5 m"),
    ],
)
def test_layers_that_overlap_or_begin_below_the_surface(tmp_path, old, new, text):
    """[X] The layers are as before, with a remark."""
    file = ags(tmp_path / "site.ags")
    content = file.read_text()
    assert old in content
    file.write_text(content.replace(old, new))
    borehole = sc.ground.read_ags(file).boreholes["B1"]
    assert borehole.layers == (("SAND", 1.0), ("CLAY", -8.0))
    assert any(text in remark for remark in borehole.remarks)


def test_locations_that_come_twice_are_refused(tmp_path):
    """[X] Two levels of one borehole: one sentence."""
    file = ags(tmp_path / "site.ags")
    line = '"DATA","B2","130.00","90.00","1.50"'
    file.write_text(file.read_text().replace(line, f"{line}\n{line}"))
    with pytest.raises(ValueError, match="LOCA has the location 'B2' twice"):
        sc.ground.read_ags(file)


def test_area_ratios_are_shares(tmp_path):
    """[X] Per cent by their unit; 80 without it is refused, in AGS and in BRO."""
    file = ags(tmp_path / "site.ags")
    without = file.read_text().replace('"0.800"', '"80"')
    file.write_text(without)
    with pytest.raises(ValueError, match=r"'C1' has the area ratio 80 of its cone"):
        sc.ground.read_ags(file)
    file.write_text(without.replace('"UNIT","","","m",""', '"UNIT","","","m","%"'))
    assert sc.ground.read_ags(file).soundings["C1"].area_ratio == pytest.approx(0.8)
    xml = bro(tmp_path / "one.xml")
    xml.write_text(xml.read_text().replace('uom="1">0.8', 'uom="1">80'))
    with pytest.raises(ValueError, match=r"'one' has the area ratio 80 of its cone"):
        sc.ground.read_cpt(xml)


def test_readings_at_one_depth_are_told(tmp_path):
    """[X] Two readings at one depth are kept, with a remark."""
    rows = [f'"DATA","C1","1","{depth}","8.0","40",""' for depth in ("0.10", "0.10", "0.20")]
    test = sc.ground.read_ags(ags(tmp_path / "site.ags", rows=rows)).soundings["C1"]
    assert any("1 readings have the depth of the one before" in text for text in test.remarks)


def test_readings_that_are_missing_stay_missing(tmp_path):
    """[X] Empty fields and codes of -9999 are NaN, and are told."""
    rows = ['"DATA","C1","1","0.10","8.0","40",""', '"DATA","C1","1","0.20","","40",""']
    rows += ['"DATA","C1","1","0.30","-9999","40",""', '"DATA","C1","1","3.00","8.0","40",""']
    test = sc.ground.read_ags(ags(tmp_path / "site.ags", rows=rows)).soundings["C1"]
    assert test.measured.tolist() == [True, False, False, True]
    assert any("no readings at 2 of 4 depths, from 0.2 to 0.3 m" in text for text in test.remarks)
    assert any("no rows from 0.3 to 3 m" in text for text in test.remarks)


def test_wrong_ags_files(tmp_path):
    """[X] One sentence with the name of the file."""
    with pytest.raises(ValueError, match=r"site.ags: SCPT_FRES has the unit 'psi', not PA, KPA"):
        sc.ground.read_ags(ags(tmp_path / "site.ags", "psi"))
    rows = ['"DATA","C1","1","deep","8.0","40",""']
    with pytest.raises(ValueError, match=r"site.ags: SCPT_DPTH is 'deep', which is not a number"):
        sc.ground.read_ags(ags(tmp_path / "site.ags", rows=rows))
    for given in (['"DATA","C1","1","","8.0","40",""'], ['"DATA","C1","1","-9999","8.0","40",""']):
        with pytest.raises(ValueError, match=r"site.ags: 'C1' has no depths"):
            sc.ground.read_ags(ags(tmp_path / "site.ags", rows=given))
    text = (tmp_path / "site.ags").read_text()
    (tmp_path / "none.ags").write_text(text[: text.index('"GROUP","GEOL"')])
    with pytest.raises(ValueError, match=r"none.ags: it has no layers \(GEOL\) and no cone"):
        sc.ground.read_ags(tmp_path / "none.ags")
    (tmp_path / "empty.ags").write_text("")
    with pytest.raises(ValueError, match=r"empty.ags is not a file of AGS 4"):
        sc.ground.read_ags(tmp_path / "empty.ags")
    with pytest.raises(FileNotFoundError, match=r"there is no file .*missing.ags"):
        sc.ground.read_ags(tmp_path / "missing.ags")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"DATA","B1","100.00","50.00","4.00"\n', "", "LOCA has no location 'B1'"),
        ('"50.00","4.00"', '"","4.00"', "the location 'B1' has no coordinates or no level"),
        ('"50.00","4.00"', '"50.00",""', "the location 'B1' has no coordinates or no level"),
        ('"DATA","B2","1.00","11.00"', '"DATA","B2","1.00",""', "last layer of 'B2' has no GEOL_B"),
    ],
)
def test_wrong_tables_of_ags(tmp_path, old, new, message):
    """[X] Locations that are missing, or have no place, and a borehole without an end."""
    path = ags(tmp_path / "site.ags")
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new), newline="\r\n")
    with pytest.raises(ValueError, match=f"site.ags: .*{message}"):
        sc.ground.read_ags(path)


GEF = """#GEFID = 1, 1, 0
#COLUMN = {columns}
#COLUMNINFO = 1, m, penetration length, 1
#COLUMNINFO = 2, {unit}, cone resistance, 2
#COLUMNINFO = 3, {unit}, sleeve friction, 3
{more}#COLUMNVOID = 2, -9999
#COLUMNVOID = 3, -9999
#COLUMNSEPARATOR = ;
#RECORDSEPARATOR = !
#LASTSCAN = 101
#REPORTCODE = GEF-CPT-Report, 1, 1, 2
#XYID = 31000, 100000, 400000
#ZID = 31000, 1.5
#STARTDATE = 2024, 1, 1
#TESTID = CPT1
#EOH =
"""


def gef(path, unit="MPa", incline=None):
    """Write a sounding without readings from 4 to 6 m."""
    more = "" if incline is None else "#COLUMNINFO = 4, degrees, inclination, 8\n"
    text = GEF.format(unit=unit, more=more, columns=3 if incline is None else 4)
    factor = 1e3 * PRESSURES.get(unit, 1.0)
    for step in range(101):
        cone, sleeve = (10.0, 0.05) if step <= 40 else (0.5, 0.02)
        values = "-9999;-9999;" if 40 < step < 60 else f"{cone * factor:g};{sleeve * factor:g};"
        text += f"{step / 10:.2f};{values}{'' if incline is None else f'{incline:g};'}!\n"
    path.write_text(text, newline="\r\n")
    return path


@pytest.mark.parametrize("unit", ["MPa", "kPa"])
def test_gef_without_interpolation_over_voids(tmp_path, unit):
    """[X] Nothing between 4.1 and 5.9 m: pygef alone has 5.25 MPa of sand there at 5 m."""
    test = sc.ground.read_cpt(gef(tmp_path / "one.gef", unit))
    assert test.level == 1.5 and test.position == (100000.0, 400000.0)
    gap = (test.depth > 4.05) & (test.depth < 5.95)
    assert np.isnan(test.cone[gap]).all() and not test.measured[gap].any()
    np.testing.assert_allclose(test.cone[[0, -1]], [10000.0, 500.0])
    np.testing.assert_allclose(test.sleeve[[0, -1]], [50.0, 20.0])
    assert any("no readings at 19 of 101 depths, from 4.1 to 5.9 m" in t for t in test.remarks)


def test_gef_with_depths_in_other_units(tmp_path):
    """[X] pygef reads 10 cm as 10 m; units that are no lengths are refused."""
    text = gef(tmp_path / "one.gef", incline=10.0).read_text()
    (tmp_path / "cm.gef").write_text(text.replace("1, m, penetration", "1, cm, penetration"))
    test = sc.ground.read_cpt(tmp_path / "cm.gef")
    assert test.depth[-1] == pytest.approx(0.1 * np.cos(np.deg2rad(10.0)), rel=1e-5)
    (tmp_path / "s.gef").write_text(text.replace("1, m, penetration", "1, s, penetration"))
    with pytest.raises(ValueError, match="'penetration length' has the unit 's', not M, MM, CM"):
        sc.ground.read_cpt(tmp_path / "s.gef")


def test_gef_with_an_inclination_tells_the_correction(tmp_path):
    """[X] 10 m along rods at 10 degrees reach a depth of 9.848 m."""
    test = sc.ground.read_cpt(gef(tmp_path / "one.gef", incline=10.0))
    # pygef has the cosine in single precision
    assert test.depth[-1] == pytest.approx(10.0 * np.cos(np.deg2rad(10.0)), rel=1e-5)
    assert any("corrected for the inclination, by up to 0.152 m" in text for text in test.remarks)


def test_readings_that_an_old_pygef_leaves_out(tmp_path, monkeypatch):
    """[N] pygef before 0.14 drops rows above the excavation: it is refused, whatever the file."""
    monkeypatch.setattr(pygef, "read_cpt", lambda file, replace_column_voids=True: None)
    with pytest.raises(ImportError, match=r"older than 0\.14 .* Python 3\.11"):
        sc.ground.read_cpt(tmp_path / "one.gef")


def test_wrong_gef_files(tmp_path):
    """[X] One sentence with the name of the file."""
    with pytest.raises(ValueError, match=r"one.gef: 'cone resistance' has the unit 'psi'"):
        sc.ground.read_cpt(gef(tmp_path / "one.gef", "psi"))
    data = (tmp_path / "one.gef").read_bytes()
    for text in (b"", b"hello", data[:100]):
        (tmp_path / "two.gef").write_bytes(text)
        with pytest.raises(ValueError, match=r"two.gef: it is no cone penetration test"):
            sc.ground.read_cpt(tmp_path / "two.gef")
    lines = data.splitlines(keepends=True)
    (tmp_path / "half.gef").write_bytes(b"".join(lines[:-50]))
    with pytest.raises(ValueError, match=r"half.gef: it announces 101 depths.*but has 51"):
        sc.ground.read_cpt(tmp_path / "half.gef")


#: Columns of a cone penetration test of BRO, in their fixed order.
COLUMNS = [
    "penetrationLength",
    "depth",
    "elapsedTime",
    "coneResistance",
    "correctedConeResistance",
    "netConeResistance",
    "magneticFieldStrengthX",
    "magneticFieldStrengthY",
    "magneticFieldStrengthZ",
    "magneticFieldStrengthTotal",
    "electricalConductivity",
    "inclinationEW",
    "inclinationNS",
    "inclinationX",
    "inclinationY",
    "inclinationResultant",
    "magneticInclination",
    "magneticDeclination",
    "localFriction",
    "poreRatio",
    "temperature",
    "porePressureU1",
    "porePressureU2",
    "porePressureU3",
    "frictionRatio",
]

BRO = """<?xml version="1.0" encoding="UTF-8"?>
<dispatchDataResponse xmlns="http://www.broservices.nl/xsd/dscpt/1.1"
  xmlns:brocom="http://www.broservices.nl/xsd/brocommon/3.0"
  xmlns:cptcommon="http://www.broservices.nl/xsd/cptcommon/1.1"
  xmlns:gml="http://www.opengis.net/gml/3.2" xmlns:swe="http://www.opengis.net/swe/2.0">
<brocom:responseType>dispatch</brocom:responseType>
<dispatchDocument><CPT_O>
<brocom:broId>CPT000000000001</brocom:broId>
<deliveredLocation><cptcommon:location srsName="urn:ogc:def:crs:EPSG::28992" gml:id="L1">
<gml:pos>100000.0 400000.0</gml:pos></cptcommon:location></deliveredLocation>
<deliveredVerticalPosition>
<cptcommon:localVerticalReferencePoint>maaiveld</cptcommon:localVerticalReferencePoint>
<cptcommon:offset uom="m">{level}</cptcommon:offset>
<cptcommon:verticalDatum>NAP</cptcommon:verticalDatum></deliveredVerticalPosition>
<conePenetrometerSurvey>
<cptcommon:trajectory><cptcommon:predrilledDepth uom="m">0.0</cptcommon:predrilledDepth>
<cptcommon:finalDepth uom="m">10.0</cptcommon:finalDepth></cptcommon:trajectory>
<cptcommon:conePenetrometer>
<cptcommon:coneSurfaceQuotient uom="1">0.8</cptcommon:coneSurfaceQuotient>
</cptcommon:conePenetrometer>
<cptcommon:parameters>{parameters}</cptcommon:parameters>
<cptcommon:conePenetrationTest><cptcommon:cptResult>
<swe:encoding><swe:TextEncoding collapseWhiteSpaces="true" decimalSeparator="."
 tokenSeparator="," blockSeparator=";"/></swe:encoding>
<cptcommon:values>{values}</cptcommon:values>
</cptcommon:cptResult></cptcommon:conePenetrationTest>
</conePenetrometerSurvey></CPT_O></dispatchDocument></dispatchDataResponse>
"""


def bro(path, level=1.5, depth=True, friction=True):
    """Write a sounding at 10 degrees: sand to 4 m, no readings to 6 m, clay with pore pressures."""
    there = {"penetrationLength", "coneResistance", "porePressureU2"}
    there |= ({"depth"} if depth else set()) | ({"localFriction"} if friction else set())
    parameters = "".join(
        f"<cptcommon:{name}>{'ja' if name in there else 'nee'}</cptcommon:{name}>"
        for name in COLUMNS
    )
    blocks = []
    for step in range(101):
        sand = step <= 40
        row = dict.fromkeys(COLUMNS, "-999999")
        row["penetrationLength"] = f"{0.1 * step:.3f}"
        row["depth"] = f"{0.1 * step * np.cos(np.deg2rad(10.0)):.6f}"
        if not 40 < step < 60:
            row["coneResistance"] = "10.0" if sand else "0.5"
            row["localFriction"] = "0.05" if sand else "0.02"
            if not sand:
                row["porePressureU2"] = "0.1"
        blocks.append(",".join(row.values()))
    text = BRO.format(level=level, parameters=parameters, values=";".join(blocks) + ";")
    path.write_text(text)
    return path


def test_bro_xml(tmp_path):
    """[X] Units of MPa, voids of -999999, the depth of the file, and total resistance with u2."""
    test = sc.ground.read_cpt(bro(tmp_path / "one.xml"))
    assert (test.name, test.level, test.position) == ("one", 1.5, (100000.0, 400000.0))
    assert test.area_ratio == 0.8 and test.water is None
    np.testing.assert_allclose(test.cone[[0, -1]], [10000.0, 500.0])
    np.testing.assert_allclose(test.sleeve[[0, -1]], [50.0, 20.0])
    np.testing.assert_allclose(test.resistance[-1], 500.0 + 0.2 * 100.0)
    assert np.isnan(test.pore[0]) and test.pore[-1] == pytest.approx(100.0)
    assert test.depth[-1] == pytest.approx(10.0 * np.cos(np.deg2rad(10.0)), abs=1e-6)
    assert any("corrected for the inclination, by up to 0.152 m" in text for text in test.remarks)
    # pygef leaves out the rows without a cone resistance
    assert not test.measured[(test.depth > 3.95) & (test.depth < 5.9)].any()
    assert any("no rows from 3.93" in text for text in test.remarks)


def test_bro_xml_of_several_tests_or_in_degrees(tmp_path):
    """[X] Several tests are refused; degrees are no metres, as a remark says."""
    file = bro(tmp_path / "one.xml")
    text = file.read_text()
    file.write_text(
        text.replace("EPSG::28992", "EPSG::4258").replace("100000.0 400000.0", "52.1 4.3")
    )
    assert any("in degrees" in remark for remark in sc.ground.read_cpt(file).remarks)
    body = text[text.index("<dispatchDocument>") : text.index("</dispatchDataResponse>")]
    file.write_text(text.replace(body, 2 * body))
    with pytest.raises(ValueError, match=r"one.xml: it has 2 tests"):
        sc.ground.read_cpt(file)


def test_bro_xml_without_a_corrected_depth_or_friction(tmp_path):
    """[X] The length along the rods stands for the depth; friction is missing, not zero."""
    test = sc.ground.read_cpt(bro(tmp_path / "one.xml", depth=False, friction=False))
    assert test.depth[-1] == pytest.approx(10.0)
    assert np.isnan(test.sleeve).all() and not test.measured.any()


def test_wrong_bro_files(tmp_path):
    """[X] Cut, without a test, without a level: one sentence with the name of the file."""
    text = bro(tmp_path / "one.xml").read_text()
    for wrong in (text[:600], text.replace("dispatchDocument", "other"), "<a/>"):
        (tmp_path / "two.xml").write_text(wrong)
        with pytest.raises(ValueError, match=r"two.xml: it is no cone penetration test of GEF"):
            sc.ground.read_cpt(tmp_path / "two.xml")
    start, end = text.index("<deliveredVertical"), text.index("<conePenetrometerSurvey")
    (tmp_path / "two.xml").write_text(text[:start] + text[end:])
    with pytest.raises(ValueError, match=r"two.xml: it has no level of the surface"):
        sc.ground.read_cpt(tmp_path / "two.xml")
