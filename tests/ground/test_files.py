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


def ags(path, unit="kPa", rows=None):
    """Write a file with a sand of 8 MPa over a clay of 0.6 MPa."""
    if rows is None:
        factor = {"kPa": 1.0, "MPa": 1e-3}.get(unit, 1.0)
        rows = []
        for depth in np.arange(0.1, 10.05, 0.1):
            sand = depth <= 4.0
            cone = 8.0 if sand else 0.6
            sleeve = (48.0 if sand else 24.0) * factor
            pore = 0.0 if sand else 100.0
            rows.append(f'"DATA","C1","1","{depth:.2f}","{cone}","{sleeve:.4f}","{pore}"')
    path.write_text(AGS.format(unit=unit, rows="\n".join(rows)), newline="\r\n")
    return path


@pytest.mark.parametrize("unit", ["kPa", "MPa"])
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
    text = (tmp_path / "site.ags").read_text()
    (tmp_path / "none.ags").write_text(text[: text.index('"GROUP","GEOL"')])
    with pytest.raises(ValueError, match=r"none.ags: it has no layers \(GEOL\) and no cone"):
        sc.ground.read_ags(tmp_path / "none.ags")
    (tmp_path / "empty.ags").write_text("")
    with pytest.raises(ValueError, match=r"empty.ags is not a file of AGS 4"):
        sc.ground.read_ags(tmp_path / "empty.ags")
    with pytest.raises(FileNotFoundError, match=r"there is no file .*missing.ags"):
        sc.ground.read_ags(tmp_path / "missing.ags")


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
    factor = {"MPa": 1.0, "kPa": 1e3}.get(unit, 1.0)
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


def test_gef_with_an_inclination_tells_the_correction(tmp_path):
    """[X] 10 m along rods at 10 degrees reach a depth of 9.848 m."""
    test = sc.ground.read_cpt(gef(tmp_path / "one.gef", incline=10.0))
    # pygef has the cosine in single precision
    assert test.depth[-1] == pytest.approx(10.0 * np.cos(np.deg2rad(10.0)), rel=1e-5)
    assert any("corrected for the inclination, by up to 0.152 m" in text for text in test.remarks)


def test_wrong_gef_files(tmp_path):
    """[X] One sentence with the name of the file."""
    with pytest.raises(ValueError, match=r"one.gef: 'cone resistance' has the unit 'psi'"):
        sc.ground.read_cpt(gef(tmp_path / "one.gef", "psi"))
    data = (tmp_path / "one.gef").read_bytes()
    for text in (b"", b"hello", data[:100]):
        (tmp_path / "two.gef").write_bytes(text)
        with pytest.raises(ValueError, match=r"two.gef: it is no cone penetration test"):
            sc.ground.read_cpt(tmp_path / "two.gef")
