"""The benchmark of a tied-back pit in Berlin sand: mesh, stages and published displacements.

The benchmark is that of the working group AK 1.6 of the German Geotechnical Society (H. F.
Schweiger, Benchmarking in Geotechnics 1, Graz 2002). Geometry, parameters and steps are those of
the analysis that the developers of ZSoil publish with their program (2026, example Berlin Sand of
ZSoil-FEM/zsoil-output-examples), and so are the displacements, read from its figures to about .3
mm.
"""

import warnings
from dataclasses import replace

import numpy as np
from skfem import Basis, ElementQuad2, ElementVector, MeshQuad

import skfem_contact as sc

EDGE, TOE, CUT_OFF, TABLE = 30.0, -32.0, -31.0, -3.0
FLOORS, DRAINED = (-4.8, -9.3, -14.35, -16.8), (-4.8, -9.3, -14.35, -17.9)
#: Height of the head, end of the free length, spacing and force of the jack of each row.
ANCHORS = (
    (-4.3, (40.51, -9.66), 2.3, 768.0),
    (-8.8, (43.63, -15.75), 1.35, 945.0),
    (-13.85, (44.08, -21.02), 1.35, 980.0),
)
#: Laws by layer. The published one has the stiffness at small strains, E0 = 405 and 675 MPa.
SAND = {
    "upper": sc.HardeningSoil(45e3, 45e3, 180e3, m=0.5, c=1.0, phi=35.0, psi=5.0, K0nc=0.4264),
    "lower": sc.HardeningSoil(75e3, 67.5e3, 300e3, m=0.5, c=1.0, phi=38.0, psi=6.0, K0nc=0.3843),
}
G0 = {"upper": 405e3 / 2.4, "lower": 675e3 / 2.4}
LAWS = {
    "Hardening Soil": SAND,
    "Hardening Soil, small strains": {
        layer: replace(sand, G0_ref=G0[layer], gamma_07=2e-4) for layer, sand in SAND.items()
    },
    "Mohr-Coulomb": {
        "upper": sc.MohrCoulomb(E=45e3 * 0.6**0.5, nu=0.3, c=1.0, phi=35.0, psi=5.0),
        "lower": sc.MohrCoulomb(E=75e3 * 2.0**0.5, nu=0.3, c=1.0, phi=38.0, psi=6.0),
    },
}
#: Depths, and the published displacements of the wall there after the last lift: mm, into the pit.
DEPTHS = [0.3, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 27.5]
WALL = [
    26.91,
    27.6,
    28.57,
    29.89,
    31.2,
    32.69,
    33.66,
    33.21,
    31.37,
    27.77,
    23.24,
    19.06,
    16.15,
    14.26,
    13.17,
]
#: Largest settlement of the street and largest displacement, that of the bottom, after the last
#: lift: mm.
SETTLEMENT, HEAVE = 19.5, 34.8
RUBBING = sc.Coulomb(float(np.tan(np.radians(28.0))))

across = [0, 8, 15, 21, 25, 28, 30, 32, 35, 38, 41, 44, 48, 53, 59, 66, 75, 88, 103, 120]
levels = [
    0,
    1.5,
    3,
    4.3,
    4.8,
    6.6,
    8.8,
    9.3,
    11.5,
    13.85,
    14.35,
    15.5,
    16.8,
    18.2,
    20,
    23,
    26,
    28.5,
    31,
    32,
    34,
    39,
    47,
    58,
    72,
    90,
]
mesh = MeshQuad.init_tensor(np.array(across, float), -np.array(levels, float)[::-1]).with_defaults()
x, y = mesh.p[:, mesh.t].mean(axis=1)
# the lifts, what stays below them, and the ground outside and below the cut-off
lift = 1 + np.searchsorted(-np.array(FLOORS), -y)
inside = np.where(lift < 5, np.char.add("lift ", lift.astype(str)), "inside")
body = np.where((x > EDGE) | (y < CUT_OFF), "ground", inside)
bodies = [str(name) for name in np.unique(body)]
layer = np.where(y > -20.0, "upper", "lower")
parts = {f"{b} {s}": (body == b) & (layer == s) for b in bodies for s in ("upper", "lower")}
parts |= {b: body == b for b in bodies} | {"dry": y > TABLE, "wet": y < TABLE}
mesh = mesh.with_subdomains(
    {name: np.flatnonzero(part) for name, part in parts.items() if part.any()}
)
lines = {
    "wall": lambda p: (np.abs(p[0] - EDGE) < 1e-9) & (p[1] > TOE),
    "cut-off": lambda p: (np.abs(p[1] - CUT_OFF) < 1e-9) & (p[0] < EDGE),
}
mesh = mesh.with_boundaries(lines, boundaries_only=False)
# the wall stands in a slit, and so does the cut-off, whose upthrust nearly lifts the sand above it
mesh = sc.split_along(sc.split_along(mesh, "wall"), "cut-off")
height, left = mesh.p[1, mesh.facets].mean(axis=0), mesh.boundaries["wall|left"]
inner = dict(
    zip(
        ("lift 1", "lift 2", "lift 3", "lift 4", "inside", "toe"),
        np.split(
            left[np.argsort(-height[left])],
            np.searchsorted(np.sort(-height[left]), -np.array([*FLOORS, CUT_OFF])),
        ),
        strict=True,
    )
)
mesh = mesh.with_boundaries({f"{name}|wall": facets for name, facets in inner.items()})
basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)


def solids(laws):
    """Return the bodies of the ground; the sand weighs 16 kN/m³ above the water and 20 below."""
    forms = {}
    for name in bodies:
        inside = [f"{name} {soil}" for soil in laws if f"{name} {soil}" in mesh.subdomains]
        forms[name] = sc.SolidForm(
            basis.with_elements(inside),
            {own: laws[own.split()[-1]] for own in inside},
            unit_weight={"dry": 16.0, "wet": 20.0},
        )
    return forms


def wall_and_anchors():
    """Return a wall of .8 m that rubs at 28° on both sides, the cut-off, and three rows of anchors
    of 15 cm².

    The anchors are bars up to their grout of 8 m.
    """
    wall = sc.Beam(
        basis, "wall|right", EI=30e6 * 0.8**3 / 12, EA=24e6, unit_weight=19.2, bonded=False
    )
    forms = {
        "wall": wall,
        **wall.contact(
            basis, RUBBING, ["wall|right", *(f"{name}|wall" for name in inner)], quadrature="nodal"
        ),
        "cut-off": sc.ContactPair(basis, "cut-off|above", "cut-off|below", RUBBING),
    }
    for k, (level, free, row, _) in enumerate(ANCHORS, 1):
        way = np.subtract(free, (EDGE, level))
        grouted = sc.Beam(
            None,
            np.linspace(free, free + 8 * way / np.hypot(*way), 6),
            EI=10.0,
            EA=315e3,
            spacing=row,
        )
        forms |= {
            f"grouted {k}": grouted,
            f"grout {k}": sc.Embedded(basis, grouted, T_max=235.0),
            f"anchor {k}": sc.Bar(
                None, wall.at((EDGE, level)), grouted.at(free), EA=315e3, spacing=row
            ),
        }
    return forms


def drained(level):
    """Return load and water of a stage: the level inside, and its lack of pressure above the tight
    cut-off.
    """
    water = {name: TABLE if name == "ground" else level for name in bodies}
    return {
        "load": sc.traction(basis, "cut-off|above", (0.0, 10.0 * (TABLE - level))),
        "water": water,
    }


def dug(laws):
    """Return the model and the result of its nine stages.

    The force of a jack is held while the water is lowered, and locked before the next lift is dug.
    """
    forms = solids(laws) | wall_and_anchors()
    rows = [[f"grouted {k}", f"grout {k}", f"anchor {k}"] for k in (1, 2, 3)]
    later = [name for row in rows for name in row]
    stages = [
        sc.Stage("wall", deactivate=later, water=TABLE),
        sc.Stage("drained", **drained(DRAINED[0])),
    ]
    for k, increments in enumerate((8, 8, 12, 6)):
        locked = {f"anchor {k}": forms[f"anchor {k}"]} if k else {}
        stages.append(
            sc.Stage(
                f"lift {k + 1}",
                deactivate=[f"lift {k + 1}", f"lift {k + 1}|wall"],
                change=locked,
                increments=increments,
                **drained(DRAINED[k]),
            )
        )
        if k < 3:
            jacked = forms[f"anchor {k + 1}"].prestressed(ANCHORS[k][3])
            stages.append(
                sc.Stage(
                    f"anchors {k + 1}",
                    activate=rows[k],
                    change={f"anchor {k + 1}": jacked},
                    **drained(DRAINED[k + 1]),
                )
            )
    model = sc.Model(forms, sc.box_supports(basis), water_unit_weight=10.0)
    warnings.filterwarnings(
        "ignore", "water presses with", sc.AnalysisWarning
    )  # the cut-off: its traction is a load
    K0 = {
        name: 0.38 if name.endswith("lower") else 0.43
        for name in mesh.subdomains
        if name.split()[-1] in laws
    }
    return model, model.run(stages, start=model.k0_state(K0=K0, water=TABLE), progress=False)


def profiles(stage):
    """Return coordinates (m) and displacements (mm) of wall into the pit, street downwards and
    bottom upwards.
    """
    x, y = mesh.p
    moved = 1e3 * stage.x[basis.nodal_dofs]
    wall = np.unique(mesh.facets[:, mesh.boundaries["wall|right"]])
    street, bottom = (
        (y > -1e-9) & (x > EDGE + 1e-9),
        (np.abs(y - FLOORS[-1]) < 1e-9) & (x < EDGE - 1e-9),
    )
    return {
        "wall": (-y[wall], -moved[0, wall]),
        "street": (x[street] - EDGE, -moved[1, street]),
        "bottom": (x[bottom], moved[1, bottom]),
    }
