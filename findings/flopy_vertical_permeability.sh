#!/usr/bin/env bash
# flopy 3.11.0: clay with a permeability of 1e-9 m/s has one of 1 m/s in the vertical direction.
#
# Expected: an aquifer for which one permeability is given is isotropic, as in `ModflowGwfnpf` (MODFLOW 6)
#     of the same library, or the vertical one must be given.
# Seen: `ModflowLpf(model, hk=1e-9)` and `ModflowUpw(model, hk=1e-9)` write vka = 1.0 for each layer into
#     the input file, and layvka = 0, by which vka is a permeability and not a ratio.  Without `hk`
#     both are 1.0.  MODFLOW 6 with `k=1e-9` has no line for k33, which then is k.  No message.
# Meaning: 1.0 was meant with the default 1.0 of the other direction.  A clay layer between two
#     aquifers leaks through a resistance that is a billion times too small, and cut-off walls and
#     heaving bases of pits are judged with water that passes the clay freely.  Give
#     `layvka=1, vka=1.0` for isotropic layers.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    flopy==3.11.0 numpy==2.4.6
cat > run.py <<'PY'
import pathlib

import flopy

GRID = dict(nlay=3, nrow=1, ncol=2, delr=10.0, delc=10.0, top=0.0, botm=[-5.0, -7.0, -12.0])
CLAY = [1e-4, 1e-9, 1e-4]


def old(package, version):
    """Arrays of the input file of MODFLOW-2005 or MODFLOW-NWT: their values by their names."""
    model = flopy.modflow.Modflow("old", version=version, exe_name="none", model_ws=version)
    flopy.modflow.ModflowDis(model, **GRID)
    flopy.modflow.ModflowBas(model)
    flow = package(model, hk=CLAY)
    model.write_input()
    assert not flow.layvka.array.any()  # vka is a permeability, not a ratio
    text = pathlib.Path(version, f"old.{flow.extension[0]}").read_text()
    lines = [line.split("#") for line in text.splitlines() if "CONSTANT" in line]
    return {" ".join(name.split()): float(values.split()[1]) for values, name in lines}


for package, version in ((flopy.modflow.ModflowLpf, "mf2005"), (flopy.modflow.ModflowUpw, "mfnwt")):
    arrays = old(package, version)
    print(version, arrays)
    assert arrays["hk layer 2"] == 1e-9 and arrays["vka2"] == 1.0

simulation = flopy.mf6.MFSimulation(sim_ws="new")
flow = flopy.mf6.ModflowGwf(simulation)
flopy.mf6.ModflowGwfdis(flow, **GRID)
isotropic = flopy.mf6.ModflowGwfnpf(flow, k=CLAY)
print("MODFLOW 6, k33:", isotropic.k33.array)
assert isotropic.k33.array is None

# Specific discharge in m/s down through the 2 m of clay under a difference of heads of 1 m.
leakage = [1 / (5 / 1e-4 + 2 / clay) for clay in (1.0, 1e-9)]
print(f"leakage {leakage[0]:.2e} m/s for {leakage[1]:.2e} m/s")
assert leakage[0] > 1e4 * leakage[1]
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
