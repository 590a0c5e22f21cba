"""Boundaries of loaded meshes, whose facets are numbered when they are first used."""

from __future__ import annotations

import copy
import dataclasses
import gc
import json
import pickle
import weakref

import numpy as np
import pytest
from skfem import MeshHex, MeshQuad, MeshTet, MeshTri
from skfem.generic_utils import OrientedBoundary

import skfem_contact as sc
from skfem_contact.mesh.boundaries import Boundaries, Sides
from skfem_contact.mesh.find_sides import sides_between

KINDS = [MeshTri, MeshQuad, MeshTet, MeshHex]


@pytest.fixture(params=KINDS)
def pair(request, tmp_path):
    """Mesh of two halves with outer and inner boundaries, and its file."""
    mesh = request.param().refined(2)
    middle = mesh.facets_satisfying(lambda x: x[0] == 0.5)
    mesh = mesh.with_defaults().with_subdomains({"half": lambda x: x[0] < 0.5})
    ori = np.arange(len(middle)) % 2
    mesh = mesh.with_boundaries({"middle": OrientedBoundary(middle, ori)}, False)
    path = str(tmp_path / "mesh.med")
    sc.save_mesh(mesh, path)
    return mesh, path


def corners(mesh, facets):
    """Return the middles of facets, sorted, by columns."""
    x = mesh.p[:, mesh.facets[:, np.asarray(facets)]].mean(axis=1).round(9)
    return x[:, np.lexsort(x)]


def assert_same(mesh, found):
    """Compare names and places of boundaries."""
    assert sorted(found.boundaries) == sorted(mesh.boundaries)
    for name, facets in mesh.boundaries.items():
        np.testing.assert_array_equal(
            corners(found, found.boundaries[name]), corners(mesh, facets), err_msg=name
        )


def test_nothing_is_numbered_before_it_is_used(pair):
    """[X] Names are known without facets; the first use numbers them once, for the mesh as well."""
    mesh, path = pair
    found = sc.load_mesh(path)
    assert list(found.boundaries)[-1] == "middle"
    assert len(found.boundaries) == len(mesh.boundaries)
    assert "middle" in found.boundaries
    assert not hasattr(found, "_t2f")
    assert_same(mesh, found)
    assert hasattr(found, "_t2f")
    t2f = found.t2f
    assert found.boundaries._pending is None
    found.boundaries.number()
    assert found.t2f is t2f


def test_directions(pair):
    """[X] Boundaries are seen from the elements behind them: outward outside, as saved inside."""
    _, path = pair
    found = sc.load_mesh(path).boundaries
    left = found["left"]
    assert isinstance(left, OrientedBoundary)
    assert not left.ori.any()
    both = np.bincount(found["middle"].ori, minlength=2)
    assert both.min() == len(found["middle"]) // 2


@pytest.mark.parametrize(
    "change",
    [
        lambda mesh: mesh.translated([1.0] * mesh.dim()),
        lambda mesh: mesh.scaled([2.0] * mesh.dim()),
        lambda mesh: mesh.with_subdomains({"all": lambda x: x[0] > -1.0}),
        lambda mesh: mesh.with_boundaries({"new": lambda x: x[0] == 1.0}),
        lambda mesh: mesh.restrict("half"),
        lambda mesh: mesh.copy(),
        copy.copy,
        copy.deepcopy,
        lambda mesh: pickle.loads(pickle.dumps(mesh)),
        lambda mesh: dataclasses.replace(mesh, _boundaries=dict(mesh.boundaries)),
        lambda mesh: dataclasses.replace(mesh, _boundaries={**mesh.boundaries}),
        lambda mesh: dataclasses.replace(mesh, _boundaries=mesh.boundaries | {}),
        lambda mesh: dataclasses.replace(mesh, _boundaries={} | mesh.boundaries),
        lambda mesh: dataclasses.replace(mesh, _boundaries=mesh.boundaries.copy()),
        lambda mesh: type(mesh).from_dict(mesh.to_dict()),
    ],
)
def test_copies_keep_boundaries(pair, change):
    """[N] The same operations on the mesh that was saved; no boundary is read before."""
    mesh, path = pair
    found = change(sc.load_mesh(path))
    assert_same(change(mesh), found)
    assert type(found)(found.doflocs, found.t).nfacets == found.nfacets


@pytest.mark.parametrize("kind", [MeshTri, MeshQuad])
def test_refined(tmp_path, kind):
    """[N] scikit-fem refines named boundaries of plane meshes."""
    mesh = kind().refined(1).with_defaults()
    sc.save_mesh(mesh, tmp_path / "mesh.msh")
    found = sc.load_mesh(tmp_path / "mesh.msh").refined(1)
    assert_same(mesh.refined(1), found)


def test_files_of_scikit_fem(pair, tmp_path):
    """[N] scikit-fem saves and loads the names of an untouched mesh."""
    mesh, path = pair
    found = sc.load_mesh(path)
    found.save(tmp_path / "other.vtu")
    assert_same(mesh, type(mesh).load(tmp_path / "other.vtu"))
    found = sc.load_mesh(path)
    found.save_npz(str(tmp_path / "other.npz"))
    assert_same(mesh, type(mesh).load_npz(str(tmp_path / "other.npz")))


def test_methods_of_a_dict(pair):
    """[X] Every way to read or to change a dict sees facets, never an empty place."""
    _, path = pair

    def fresh():
        return sc.load_mesh(path).boundaries

    wanted = {name: list(map(int, part)) for name, part in fresh().items()}
    lists = {
        "get": {name: fresh().get(name) for name in wanted},
        "values": dict(zip(wanted, fresh().values())),
        "items": dict(fresh().items()),
        "pop": {name: fresh().pop(name) for name in wanted},
        "setdefault": {name: fresh().setdefault(name, None) for name in wanted},
        "keywords": (lambda **names: names)(**fresh()),
    }
    updated = {}
    updated.update(fresh())
    lists["update"] = updated
    added = fresh()
    added |= {}
    lists["or"] = added
    for word, parts in lists.items():
        assert {name: list(map(int, part)) for name, part in parts.items()} == wanted, word
    assert fresh().popitem()[1] is not None
    with pytest.raises(ValueError, match="truth value"):  # arrays are compared, as in any dict
        assert fresh() != dict.fromkeys(wanted)
    assert "None" not in repr(fresh())
    assert json.loads(json.dumps(fresh(), default=lambda part: part.tolist())) == wanted
    changed = fresh()
    changed["left"] = np.array([0])
    del changed["middle"]
    assert list(changed["left"]) == [0]
    assert "middle" not in changed
    assert len(changed["right"]) == len(wanted["right"])
    changed.clear()
    assert not changed
    match fresh():
        case {"left": part}:
            assert list(part) == wanted["left"]


def test_boundaries_outlive_their_mesh(pair):
    """[X] The mesh is freed at once, and its boundaries can be numbered after that."""
    mesh, path = pair
    found = sc.load_mesh(path)
    boundaries = found.boundaries
    gone = weakref.ref(found)
    gc.disable()
    del found
    assert gone() is None
    gc.enable()
    assert len(boundaries["left"]) == len(mesh.boundaries["left"])


def test_known_facets_are_kept(pair):
    """[X] Facets that scikit-fem numbered first are not numbered again."""
    _, path = pair
    found = sc.load_mesh(path)
    facets = found.facets
    assert len(found.boundaries["left"])
    assert found.facets is facets


def test_sides_without_direction():
    """[X] Sets of nodes name facets in ascending order, without directions."""
    mesh = MeshTri().refined(1)
    mesh = MeshTri(mesh.p, mesh.t)
    elements = mesh.f2t[0, mesh.boundary_facets()][::-1]
    local = np.argmax(mesh.t2f[:, elements] == mesh.boundary_facets()[::-1], axis=0)
    found = Boundaries.of(mesh, ["all"], lambda: {"all": Sides(elements, local, oriented=False)})[
        "all"
    ]
    assert not isinstance(found, OrientedBoundary)
    np.testing.assert_array_equal(found, mesh.boundary_facets())


def test_sides_between_nodes_are_outer_ones_if_possible():
    """[X] Nodes of the lower side and of a line inside name the lower side; of the line alone, the
    sides on it, each once.
    """
    mesh = MeshQuad.init_tensor(np.arange(4.0), np.arange(3.0))
    low, inside = mesh.p[1] == 0.0, mesh.p[0] == 1.0

    def found(chosen):
        facets = sides_between(mesh, np.flatnonzero(chosen)).facets(mesh)
        return mesh.p[:, mesh.facets[:, facets]].mean(axis=1).T

    middles = found(low | inside)
    assert sorted(map(tuple, middles)) == [(0.5, 0.0), (1.5, 0.0), (2.5, 0.0)]
    middles = found(inside)
    assert sorted(map(tuple, middles)) == [(1.0, 0.5), (1.0, 1.5)]
