#!/usr/bin/env bash
# pyshp 3.1.6: a layer of 2.7 m is written as 2 m, and its permeability as 0.
#
# Expected: a numeric field takes numbers as they are, or refuses what it would change; a field of
#     the type "F" (float) keeps fractions.
# Seen: with `writer.field("thickness", "N")` the thickness 2.7 is 2 in the file, -0.9 is 0, and 4.6e-9
#     is 0: numbers are cut, not rounded.  A field of type "F" does the same.  With `decimal=10`
#     thicknesses are right and 4.6e-12 is 0.  No message in any case.
# Meaning: the default of `decimal` is 0 for both types.  Levels, thicknesses and settlements lose up
#     to 1 m, always towards zero: a mean of thicknesses is half a metre low.  Give `decimal` for each
#     field, write permeabilities as logarithms, and read one record back.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    pyshp==3.1.6
cat > run.py <<'PY'
import warnings

import shapefile

warnings.simplefilter("error")
VALUES = [2.7, -0.9, 4.6e-9, 4.6e-12]


def stored(kind, **options):
    """Values that are read back from a field."""
    with shapefile.Writer("boreholes") as writer:
        writer.field("value", kind, **options)
        for value in VALUES:
            writer.point(0.0, 0.0)
            writer.record(value)
    with shapefile.Reader("boreholes") as reader:
        return [record[0] for record in reader.records()]


for kind in "NF":
    plain, decimals = stored(kind), stored(kind, decimal=10)
    print(f"{kind}: {plain} for {VALUES}; decimal=10 {decimals}")
    assert plain == [2, 0, 0, 0]
    assert decimals == [2.7, -0.9, 4.6e-9, 0]
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
