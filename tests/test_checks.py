"""Checks of input: what passes, and what is refused with the name of the argument."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_matrix
from skfem import Basis, ElementQuad1
from skfem.generic_utils import OrientedBoundary
from typing_extensions import TypeAliasType

import skfem_contact as sc
from skfem_contact import checks
from skfem_contact.results.fields import Shown
from tests.tools.helpers import grid, vector_basis


@pytest.mark.parametrize("value", [True, "1", None, np.nan, np.inf, [1.0], 1j])
def test_no_number(value):
    assert not checks.is_number(value)
    with pytest.raises(ValueError, match="width must be a finite number above 0, not"):
        checks.positive(value, "width")


def test_numbers():
    assert checks.number(np.float32(0.5), "share", 0.0, 1.0) == 0.5
    with pytest.raises(
        ValueError, match="share must be a finite number above 0 and below 1, not 1"
    ):
        checks.number(1, "share", 0.0, 1.0)
    with pytest.raises(ValueError, match="factor must be a finite number, not nan"):
        checks.number(np.nan, "factor")
    np.testing.assert_array_equal(checks.finite([1, 2], "lengths"), [1.0, 2.0])


@pytest.mark.parametrize(
    "value",
    [
        [1.0],
        [1.0, np.nan],
        7.0,
        [1j, 0],
        ["a", "b"],
        [[1.0], [1.0, 2.0]],
        np.ma.masked_array([1.0, 2.0], [True, False]),
    ],
)
def test_no_vector(value):
    with pytest.raises(ValueError, match="center must"):
        checks.vector(value, 2, "center")


def test_names():
    assert checks.names("a", ("a", "b"), "form") == ("a",)
    assert checks.names(["b", "a"], ("a", "b"), "form") == ("b", "a")
    with pytest.raises(ValueError, match="there is no form 'c'; existing: a, b"):
        checks.names(("a", "c"), ("a", "b"), "form")


def test_dofs():
    assert checks.dofs([3, 1, 1], 4, "fixed").tolist() == [1, 3]
    assert checks.dofs([], 4, "fixed").tolist() == []
    for value in ([-1], [4], [0.5], [True], ["a"]):
        with pytest.raises(ValueError, match="fixed must be numbers of dofs from 0 to 3"):
            checks.dofs(value, 4, "fixed")


def test_wrong_names_suggest_the_nearest():
    """Misspelt names and keywords are followed by the nearest existing ones."""
    with pytest.raises(ValueError, match=r"existing: left, right, top; did you mean 'left'\?"):
        checks.look_up("lft", dict.fromkeys(("left", "right", "top")), "boundary")
    with pytest.raises(ValueError, match=r"existing: Clay, sand; did you mean 'Clay'\?"):
        checks.look_up("clay", dict.fromkeys(("Clay", "sand")), "region")
    with pytest.raises(ValueError, match=r"existing: a, b$"):
        checks.look_up("nonsense", dict.fromkeys("ab"), "region")
    wrong = {"actvate": "fill"}
    with pytest.raises(TypeError, match=r"'actvate'; its arguments are .*; did you mean 'act"):
        sc.Stage("dig", **wrong)


def test_calls_of_a_form_are_checked_in_the_first_increment():
    """A form that calls the package with a wrong argument is told so by its name."""

    class Calling(sc.Form):
        """A spring that asks for supports of a mesh."""

        size = 1

        def __init__(self, basis):
            self.basis = basis

        def initial_state(self, x=None):
            return np.zeros(1)

        def assemble(self, x, state):
            sc.box_supports(self.basis)
            return sc.Response(x, lambda: state, lambda: csr_matrix([[1.0]]))

    def run(basis):
        stage = sc.Stage("push", np.ones(1), increments=2)
        return sc.Model({"form": Calling(basis)}).run([stage], progress=False)["push"]

    basis = vector_basis(grid("Q1", [0.0, 1.0], [0.0, 1.0]), "Q1")
    assert run(basis).x[0] == pytest.approx(1.0)
    with pytest.raises(ValueError, match="basis must be a CellBasis, not MeshQuad"):
        run(basis.mesh)


def test_kinds_of_aliases():
    """`NDArray` and `ArrayLike` are aliases from numpy 2.5 on, which Python 3.12 and later have."""
    scalar = TypeVar("scalar", bound=np.generic)
    values = TypeAliasType("values", NDArray[scalar], type_params=(scalar,))
    for hint in (NDArray[np.float64], values[np.float64], TypeAliasType("array", np.ndarray)):
        assert checks.kind_of(hint).name == "an array of real numbers"
    for hint in (ArrayLike, TypeAliasType("numbers", ArrayLike)):
        assert checks.kind_of(hint).name == "finite numbers"


@pytest.mark.parametrize(
    ("hint", "name", "held", "refused"),
    [
        (ArrayLike | None, "finite numbers or None", [1.0, None, [1.0, 2.0]], ["a", [np.nan]]),
        (float | ArrayLike, "finite numbers", [1.0, (1, 2)], [None, True]),
        (str | None, "a string or None", ["a", None], [1.0, [1.0]]),
    ],
)
def test_kinds_of_unions(hint, name, held, refused):
    kind = checks.kind_of(hint)
    assert kind.name == name
    assert all(map(kind.holds, held)) and not any(map(kind.holds, refused))


def test_kind_of_shown_water():
    """True and False are held although `ArrayLike` has `bool` of its own before numpy 2.3."""
    kind = checks.kind_of(Shown)
    assert all(map(kind.holds, [True, False, 2.0, [1.0, 2.0], np.zeros(3), lambda x: x]))
    assert not kind.holds("a")
    assert kind.name.startswith("finite numbers or an object with pressure_at or a function")


def test_facets_are_named_once():
    """[X] A facet that is named twice would be loaded twice; an inner one has two sides."""
    mesh = grid("Q1", np.linspace(0, 2, 3), np.linspace(0, 1, 2))
    inner = np.setdiff1d(np.arange(mesh.nfacets), mesh.boundary_facets())
    both = OrientedBoundary(np.append(inner, inner), np.repeat([0, 1], len(inner)))
    top = mesh.facets_satisfying(lambda x: x[1] == 1.0)
    mask = np.isin(np.arange(mesh.nfacets), top)
    named = replace(mesh, _boundaries={"both": both, "twice": np.append(top, top), "mask": mask})
    assert len(checks.facets_of(named, "both")) == 2 * len(inner)
    with pytest.raises(ValueError, match="'twice' names 2 facets more than once"):
        checks.facets_of(named, "twice")
    with pytest.raises(ValueError, match="boundary 'mask' is a mask: give numbers"):
        sc.traction(vector_basis(named, "Q1"), "mask", (0.0, -1.0))


def test_mask_of_a_subdomain():
    """A mask, whose entries were taken for elements 0 and 1, is refused by its name."""
    mesh = grid("Q1", np.linspace(0, 2, 3), np.linspace(0, 1, 2))
    named = replace(mesh, _subdomains={"soil": np.ones(mesh.nelements, bool)})
    with pytest.raises(ValueError, match="'soil' is a mask: give numbers"):
        sc.SolidForm(vector_basis(named, "Q1"), {"soil": sc.LinearElastic(E=1.0, nu=0.3)})


def with_wrong_facets(kind: str):
    """A square whose boundary "top" names facets by a mask, or twice."""
    mesh = grid("Q1", np.linspace(0, 2, 3), np.linspace(0, 1, 2)).with_defaults()
    top = np.asarray(mesh.boundaries["top"])
    wrong = np.append(top, top)
    if kind == "mask":
        wrong = np.isin(np.arange(mesh.nfacets), top)
    return mesh, replace(mesh, _boundaries={**mesh.boundaries, "top": wrong})


def test_masks_are_refused_by_models_and_flows():
    """Checks ended in an IndexError, and the discharge through a mask was that of two facets."""
    mesh, wrong = with_wrong_facets("mask")
    for part in (wrong, replace(mesh, _subdomains={"all": np.ones(mesh.nelements, bool)})):
        basis = vector_basis(part, "Q1")
        soil = sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.3))
        with pytest.raises(ValueError, match="is a mask: give numbers"):
            sc.Model({"soil": soil}, basis.get_dofs("bottom").all())
    with pytest.raises(ValueError, match="boundary 'top' is a mask"):
        sc.water.Flow(Basis(wrong, ElementQuad1()), 1.0, unit_weight=10.0)


def test_flows_and_bounds_refuse_facets_that_are_named_twice():
    """A discharge, an open joint and the loads of bounds have the check of all boundaries."""
    told = "'top' names 2 facets more than once"
    _, wrong = with_wrong_facets("twice")
    flow = sc.water.Flow(Basis(wrong, ElementQuad1()), 1.0, unit_weight=10.0)
    seepage = flow.steady(sc.water.Conditions(head={"left": 1.0, "right": 1.0}))
    with pytest.raises(ValueError, match=told):
        seepage.discharge("top")
    basis = vector_basis(wrong, "Q1")
    soil = sc.SolidForm(basis, sc.Tresca(E=1e3, nu=0.3, c=10.0))
    model = sc.Model({"soil": soil}, basis.get_dofs("bottom").all())
    with pytest.raises(ValueError, match=told):
        model.bounds(tractions={"top": (0.0, -10.0)}, elements=1, progress=False)
    with pytest.raises(ValueError, match=told):
        sc.PoreWater(basis, 1.0, unit_weight=10.0, connected=[("top", "bottom")])
