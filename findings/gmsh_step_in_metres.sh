#!/usr/bin/env bash
# gmsh 4.15.2: a drawing in metres is read a thousand times too large, and written too small.
#
# Expected: a STEP file of a box of 2 that says metres is read as 2, or a remark tells that it is
#     not; a model that is drawn in metres is written in metres, or the unit is asked for.
# Seen: the box from a file with SI_UNIT($,.METRE.) is 2000 long and has the volume 2e9.  A box of
#     length 2, written by default, has SI_UNIT(.MILLI.,.METRE.) in its file, and any other program
#     reads it as 2 mm.  With `Geometry.OCCTargetUnit` "M" the first is 2 long, and the second is
#     written as 2000 mm.
# Meaning: a foundation from a CAD file is a thousand times as wide as the layers drawn around it;
#     if all comes from the file, weights are 1e9 times too large.  Set the target unit before
#     import and export, and check one length.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    gmsh==4.15.2 numpy==2.4.6
cat > run.py <<'PY'
import sys

import gmsh

action, name, unit = sys.argv[1:]
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
if unit != "default":
    gmsh.option.setString("Geometry.OCCTargetUnit", unit)
if action == "write":
    gmsh.model.occ.addBox(0, 0, 0, 2, 1, 1)
    gmsh.model.occ.synchronize()
    gmsh.write(name)
else:
    gmsh.model.occ.importShapes(name)
    gmsh.model.occ.synchronize()
    box = gmsh.model.getBoundingBox(-1, -1)
    print(f"{box[3] - box[0]:.3f} {gmsh.model.occ.getMass(3, 1):.6g}", file=sys.stderr)
gmsh.finalize()
PY
ask() {
    OMP_NUM_THREADS=1 venv/bin/python run.py "$@" 2>&1 > /dev/null
}
ask write default.step default
ask write metres.step M
sed 's/SI_UNIT(.MILLI.,.METRE.)/SI_UNIT($,.METRE.)/' default.step > box.step
grep -q 'SI_UNIT(.MILLI.,.METRE.)' default.step && grep -q 'SI_UNIT(.MILLI.,.METRE.)' metres.step
grep -q 'SI_UNIT($,.METRE.)' box.step && ! grep -q MILLI box.step
corner=$(grep -c "CARTESIAN_POINT('',(2.,1.,1.))" default.step)
corner_metres=$(grep -c "CARTESIAN_POINT('',(2.E+03,1.E+03,1.E+03))" metres.step)
by_default=$(ask read box.step default)
by_metres=$(ask read box.step M)
echo "in mm by default, corners at (2, 1, 1): $corner; with M at (2000, 1000, 1000): $corner_metres"
echo "the box in metres: length and volume $by_default by default, $by_metres with M"
[[ "$corner" -ge 1 && "$corner_metres" -ge 1 ]]
[[ "$by_default" == '2000.000 2e+09' && "$by_metres" == '2.000 2' ]]
