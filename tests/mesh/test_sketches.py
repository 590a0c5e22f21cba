"""Random sketches through Gmsh, and back through every format that is written."""

from __future__ import annotations

from importlib.util import find_spec

import numpy as np
import pytest
from skfem.quadrature import get_quadrature

import skfem_contact as sc

pytest.importorskip("gmsh", exc_type=(ImportError, OSError))
ENDS = [".msh", ".inp", ".vtu", ".mdpa"]
if find_spec("h5py"):
    ENDS.append(".med")


def sketch(seed):
    """A box of two layers with a disc, a hole or a lift, and a line, at random coordinates."""
    rng = np.random.default_rng(seed)
    width, height = rng.uniform(4.0, 9.0, 2)
    middle = rng.uniform(0.3, 0.7) * height
    tilt = rng.uniform(-0.2, 0.2) * middle
    bend = [(0.0, middle), (width, middle + tilt)]
    areas = {
        "lower": [(0.0, 0.0), (width, 0.0), *bend[::-1]],
        "upper": [*bend, (width, height), (0.0, height)],
    }
    centre = (rng.uniform(0.4, 0.6) * width, rng.uniform(0.4, 0.6) * height)
    radius = 0.2 * min(width, height)
    more = {}
    if seed % 3 == 0:
        areas["disc"] = sc.section.circle(centre, radius)
        more["replace"] = "disc"
    elif seed % 3 == 1:
        more["holes"] = {"bore": sc.section.circle(centre, radius)}
    else:
        box = sc.section.rectangle((0.0, 0.3 * width), (0.8 * height, height))
        more["lifts"] = {"lift": box}
    if seed % 2:
        x = rng.uniform(0.75, 0.9) * width
        more["lines"] = {"wall": [(x, height), (x, 0.85 * height)]}
    return sc.section.Section(areas, size=0.4 * height, **more)


def measures(mesh):
    """Areas of subdomains and lengths of boundaries; of second order also of their curves."""
    mapping = mesh.mapping()
    points, weights = get_quadrature(mesh.elem, 4)
    area = np.abs(mapping.detDF(points)) @ weights
    facets = np.unique(np.concatenate([np.asarray(part) for part in mesh.boundaries.values()]))
    points, weights = get_quadrature(mesh.brefdom, 6)
    length = mapping.detDG(points, find=facets) @ weights
    found = {("area", name): area[part].sum() for name, part in mesh.subdomains.items()}
    for name, part in mesh.boundaries.items():
        found["length", name] = length[np.searchsorted(facets, np.asarray(part))].sum()
    return found


def returned(mesh, path):
    """The largest relative difference of areas and lengths after a round trip, by format."""
    before = measures(mesh)
    worst = {}
    for end in ENDS:
        file = path / f"sketch{end}"
        sc.save_mesh(mesh, file)
        after = measures(sc.load_mesh(file))
        assert after.keys() == before.keys()
        worst[end] = max(abs(after[key] / before[key] - 1.0) for key in before)
    return worst


@pytest.mark.parametrize("seed", range(6))
def test_sketches_come_back(tmp_path, seed):
    """[X] Names, areas, and lengths of straight and curved sides; files have all digits."""
    mesh = sketch(seed).mesh(order=1 + seed % 2)
    assert max(returned(mesh, tmp_path).values()) < 1e-12


@pytest.mark.slow
def test_many_sketches_come_back(tmp_path):
    """[X] The same for 24 sketches: four of each kind, with and without curved sides."""
    for seed in range(24):
        mesh = sketch(seed).mesh(order=1 + seed // 3 % 2)
        assert max(returned(mesh, tmp_path).values()) < 1e-9, seed
