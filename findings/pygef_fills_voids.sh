#!/usr/bin/env bash
# pygef 0.14.1: two metres without readings become sand.
#
# Expected: readings that the file declares void (#COLUMNVOID) are null or NaN in the table.
# Seen: a sounding has 10 MPa down to 4 m, no reading from 4.1 to 5.9 m (voids of -9999, as after
#     predrilling), and 0.5 MPa from 6 m.  The table has no null, and the cone resistance falls
#     linearly from 10 to 0.5 MPa over the gap: 5.25 MPa at 5 m.  The friction ratio is computed from
#     the filled values.
# Meaning: a stiffness or strength that is derived from the sounding has a layer of medium sand that
#     nobody measured, at the depth where something went wrong or was soft.  Look for voids in the
#     text of the file before the table is used.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pygef==0.14.1 polars==1.44.2
cat > run.py <<'PY'
import pygef

HEADER = """#GEFID = 1, 1, 0
#COLUMN = 3
#COLUMNINFO = 1, m, penetration length, 1
#COLUMNINFO = 2, MPa, cone resistance, 2
#COLUMNINFO = 3, MPa, sleeve friction, 3
#COLUMNVOID = 2, -9999
#COLUMNVOID = 3, -9999
#COLUMNSEPARATOR = ;
#RECORDSEPARATOR = !
#LASTSCAN = 101
#REPORTCODE = GEF-CPT-Report, 1, 1, 2
#XYID = 31000, 100000, 400000
#ZID = 31000, 1.0
#STARTDATE = 2024, 1, 1
#TESTID = CPT1
#EOH =
"""


def readings(step):
    """Cone resistance and sleeve friction at the depth of 0.1 m times the step."""
    if step <= 40:
        return 10, 0.05
    return (0.5, 0.02) if step >= 60 else (-9999, -9999)


with open("sounding.gef", "w", newline="\r\n") as file:
    file.write(HEADER)
    for step in range(101):
        cone, sleeve = readings(step)
        file.write(f"{step / 10:.2f};{cone};{sleeve};!\n")

table = pygef.read_cpt("sounding.gef").data
depth, cone = table["penetrationLength"].to_list(), table["coneResistance"].to_list()
gap = {round(z, 1): q for z, q in zip(depth, cone) if 4.05 < z < 5.95}
print(f"{len(depth)} rows, {table['coneResistance'].null_count()} nulls; in the gap: "
      + ", ".join(f"{q:.2f}" for q in gap.values()))
assert len(depth) == 101 and table["coneResistance"].null_count() == 0
assert all(abs(q - (10 - 9.5 * (z - 4) / 2)) < 1e-6 for z, q in gap.items())
ratio = dict(zip((round(z, 1) for z in depth), table["frictionRatioComputed"].to_list()))
print(f"friction ratio at 5 m {ratio[5.0]:.3f}, of filled values {100 * 0.035 / 5.25:.3f}")
assert abs(ratio[5.0] - 100 * 0.035 / 5.25) < 1e-3
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
