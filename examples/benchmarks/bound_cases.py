"""Slopes, footings and a sliding block whose bounds or exact answers are published."""

from __future__ import annotations

import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc

EDGE = 1e-9


def slope_mesh(
    height: float, run: float, crest: float, depth: float = 0.0, beyond: float = 0.0
) -> MeshTri:
    """A few triangles of a slope on a foundation; it falls to the right, its toe is the origin."""
    x = np.array([-run - crest, -run, -0.5 * run, 0.0, 0.5 * beyond, beyond])
    level = [(a, 0.0) for a in x[:4]]
    points = [*level, (x[0], height), (x[1], height), (x[2], 0.5 * height)]
    triangles = [(0, 1, 5), (0, 5, 4), (1, 2, 6), (1, 6, 5), (2, 3, 6)]
    if depth:
        points += [(x[4], 0.0), (x[5], 0.0), *((a, -depth) for a in x)]
        top, low = [0, 1, 2, 3, 7, 8], [9, 10, 11, 12, 13, 14]
        for i in range(5):
            triangles += [(low[i], low[i + 1], top[i + 1]), (low[i], top[i + 1], top[i])]
    mesh = MeshTri(np.array(points).T, np.array(triangles).T).refined(1)
    left, right, base = x[0], max(beyond, 0.0), -depth
    return mesh.with_boundaries(
        {
            "base": lambda p: p[1] < base + EDGE,
            "sides": lambda p: (p[0] < left + EDGE) | ((p[0] > right - EDGE) & (depth > 0)),
        }
    )


def supported(mesh: MeshTri) -> tuple[Basis, np.ndarray]:
    """Quadratic triangles, a base that is held, and sides that let the ground settle."""
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    return basis, np.append(basis.get_dofs("base").all(), basis.get_dofs("sides").all("u^1"))


def ground(mesh: MeshTri, c: float, phi: float, gamma: float) -> dict:
    """A slope of one soil under its weight."""
    basis, fixed = supported(mesh)
    soil = sc.MohrCoulomb(E=1e5, nu=0.3, c=c, phi=phi, psi=phi)
    return {"forms": {"soil": sc.SolidForm(basis, soil)}, "fixed": fixed, "weight": gamma}


def vertical_cut() -> dict:
    """Strength such that the reference of the stability number, 3.776, is a factor of one."""
    grid = MeshTri.init_tensor(np.linspace(-1.6, 1.0, 14), np.linspace(-0.6, 1.0, 9))
    middle = grid.p[:, grid.t].mean(axis=1)
    mesh = grid.restrict(np.flatnonzero((middle[0] < 0) | (middle[1] < 0))).with_boundaries(
        {
            "base": lambda p: p[1] < -0.6 + EDGE,
            "sides": lambda p: (p[0] < -1.6 + EDGE) | (p[0] > 1.0 - EDGE),
        }
    )
    return ground(mesh, 1 / 3.776, 0.0, 1.0)


def footing(phi: float, width: float, depth: float) -> dict:
    """Half of a flexible strip of width 1 on weightless soil, c = 1: the bounds are those of
    N_c.
    """
    x, y = (
        np.linspace(start, end, round(2 * (end - start)) + 1)
        for start, end in ((0, width), (-depth, 0))
    )
    mesh = MeshTri.init_tensor(x, y).with_boundaries(
        {
            "base": lambda p: p[1] < -depth + EDGE,
            "sides": lambda p: (p[0] < EDGE) | (p[0] > width - EDGE),
            "strip": lambda p: (p[1] > -EDGE) & (p[0] < 0.5),
        }
    )
    return ground(mesh, 1.0, phi, 0.0) | {"tractions": {"strip": (0.0, -1.0)}, "live": "strip"}


def heavy_footing() -> dict:
    """A rigid smooth strip of width 1: c = 10, phi = 30 degrees, unit weight 18, surcharge 20
    beside it.
    """
    soil = MeshTri.init_tensor(np.linspace(0, 6, 13), np.linspace(-3, 0, 7)).with_boundaries(
        {
            "base": lambda p: p[1] < -3 + EDGE,
            "sides": lambda p: (p[0] < EDGE) | (p[0] > 6 - EDGE),
            "strip": lambda p: (p[1] > -EDGE) & (p[0] < 0.5),
            "beside": lambda p: (p[1] > -EDGE) & (p[0] > 0.5),
        }
    )
    plate = MeshTri.init_tensor(np.array([0.0, 0.5]), np.array([0.0, 0.2])).with_defaults()
    basis = Basis(
        sc.join_bodies({"soil": soil, "plate": plate}), ElementVector(ElementTriP2()), intorder=2
    )
    forms = {
        "soil": sc.SolidForm(
            basis.with_elements("soil"), sc.MohrCoulomb(1e5, 0.3, c=10.0, phi=30.0, psi=30.0)
        ),
        "plate": sc.SolidForm(basis.with_elements("plate"), sc.LinearElastic(E=1e7, nu=0.2)),
        "joint": sc.ContactPair(basis, "soil:strip", "plate:bottom", sc.Coulomb(), "nodal"),
    }
    sides = [basis.get_dofs(name).all("u^1") for name in ("soil:sides", "plate:left")]
    return {
        "forms": forms,
        "fixed": np.concatenate([basis.get_dofs("soil:base").all(), *sides]),
        "weight": {"soil": 18.0},
        "tractions": {"soil:beside": (0.0, -20.0), "plate:top": (0.0, -1.0)},
        "live": "plate:top",
    }


def sliding_block() -> dict:
    """A block on a base of strong soil, pushed along a joint with friction and adhesion; meshes do
    not match.
    """
    base = MeshTri.init_tensor(np.linspace(0, 8, 9), np.linspace(-1, 0, 2)).with_defaults()
    block = MeshTri.init_tensor(np.linspace(2, 6, 6), np.linspace(0, 1, 2)).with_defaults()
    basis = Basis(
        sc.join_bodies({"base": base, "block": block}), ElementVector(ElementTriP2()), intorder=2
    )
    strong = sc.MohrCoulomb(E=1e5, nu=0.3, c=1000.0, phi=20.0, psi=20.0)
    joint = sc.Coulomb(mu=np.tan(np.radians(26.6)), adhesion=2.5)
    pair = sc.ContactPair(basis, "block:bottom", "base:top", joint, "nodal")
    forms = {"bodies": sc.SolidForm(basis, strong), "joint": pair}
    return {
        "forms": forms,
        "fixed": basis.get_dofs("base:bottom").all(),
        "weight": {"block": 25.0},
        "tractions": {"block:left": (1.0, 0.0)},
        "live": "block:left",
    }


def bracket(forms: dict, fixed: np.ndarray, **settings) -> sc.Bounds:
    """Bounds of a case, whose loads are among the settings."""
    return sc.Model(forms, fixed).bounds(**settings)


#: Problems, and an interval that the exact answer lies in: closed form, or rigorous bounds of
#: others.
CASES = {
    "Griffiths and Lane 1": (ground(slope_mesh(10, 20, 12), 10.0, 20.0, 20.0), (1.3748, 1.3800)),
    "Griffiths and Lane 2": (
        ground(slope_mesh(10, 20, 12, 5, 20), 10.0, 20.0, 20.0),
        (1.3616, 1.3716),
    ),
    "Griffiths and Lane 4": (
        ground(slope_mesh(10, 20, 20, 10, 20), 50.0, 0.0, 20.0),
        (1.4440, 1.4550),
    ),
    "ACADS 1(a)": (ground(slope_mesh(10, 20, 20, 5, 10), 3.0, 19.6, 20.0), (0.9788, 0.9879)),
    "Dawson, 45 degrees": (
        ground(slope_mesh(10, 10, 20, 5, 15), 12.38, 20.0, 20.0),
        (0.9958, 1.0016),
    ),
    "vertical cut": (vertical_cut(), (3.7706 / 3.776, 3.7957 / 3.776)),
    "N_c, 0 degrees": (footing(0.0, 3.0, 2.0), (5.14159, 5.14159)),
    "N_c, 20 degrees": (footing(20.0, 4.0, 2.0), (14.8347, 14.8347)),
    "N_c, 30 degrees": (footing(30.0, 6.0, 3.0), (30.1396, 30.1396)),
    "footing with c, q and weight": (heavy_footing(), (793.35, 793.35)),
    "sliding block": (sliding_block(), (60.0763, 60.0763)),
}
