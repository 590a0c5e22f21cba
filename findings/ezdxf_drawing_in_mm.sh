#!/usr/bin/env bash
# ezdxf 1.4.5: a pile of 1.2 m in a drawing in mm is 1200 m wide in the site plan.
#
# Expected: drawings that both declare their unit are scaled when one is loaded into the other, as
#     CAD programs do on insertion, or a message says that the units differ.
# Seen: a circle with a radius of 600 in a drawing in mm is loaded into one in m by
#     `xref.load_modelspace` and by `Importer`: the radius is 600 in both.  No message.  The same for a
#     block definition, whose `units` stay mm.  `conversion_factor` of `ezdxf.units` is 0.001.
# Meaning: piles, anchors and struts of a detail drawing get a thousand times their size and
#     place in a plan that a mesh is made from.  Scale the entities by the conversion factor.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    ezdxf==1.4.5 numpy==2.4.6
cat > run.py <<'PY'
import ezdxf
import ezdxf.xref
from ezdxf import units
from ezdxf.addons.importer import Importer


def detail():
    """A drawing in mm with a pile of 1200 mm at (5000, 0)."""
    drawing = ezdxf.new(units=units.MM)
    drawing.modelspace().add_circle((5000, 0), 600)
    return drawing


def load(source, target):
    ezdxf.xref.load_modelspace(source, target)


def bring(source, target):
    importer = Importer(source, target)
    importer.import_modelspace()
    importer.finalize()


for name, way in (("xref.load_modelspace", load), ("Importer", bring)):
    plan = ezdxf.new(units=units.M)
    way(detail(), plan)
    (pile,) = plan.modelspace()
    print(f"{name}: radius {pile.dxf.radius}, centre {pile.dxf.center}, unit {units.unit_name(plan.units)}")
    assert pile.dxf.radius == 600 and pile.dxf.center.x == 5000 and plan.units == units.M
assert units.conversion_factor(units.MM, units.M) == 0.001
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
