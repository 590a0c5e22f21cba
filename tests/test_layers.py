"""The house: who may know whom."""

from __future__ import annotations

import ast
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact
from skfem_contact.solvers.direct import DirectSolver

PACKAGE = Path(skfem_contact.__file__).parent
#: Rooms from the ground up: a room may use what stands before it. Those of one entry know nothing
#: of each other.
ROOMS = (
    {"arrays"},
    {"checks"},
    {"errors"},
    {"units"},
    {"display", "sparse", "versions"},
    {"layout"},
    {"materials", "mesh", "loads", "surfaces"},
    {"forms"},
    {"contact"},
    {"beams"},
    {"shells"},
    {"laboratory", "section"},
    {"ground"},
    {"results"},
    {"solvers"},
    {"nonlinear"},
    {"dynamics"},
    {"stages"},
    {"limit_analysis"},
    {"collapse"},
    {"water"},
    {"model"},
    {"design"},
    {"testing"},
    {"plot"},
    {"demo", "data"},
    {""},
)
#: Results and a section draw and report themselves: the only calls that go up, and at run time
#: only.
SHORTCUTS = {
    ("results.points", "plot"),
    ("results.stage", "plot"),
    ("results.result", "plot"),
    ("section.section", "plot"),
}
#: Private members of other libraries and of named tuples.
OUTSIDE = {
    "_getframe",
    "_replace",
    "_asdict",
    "_repr_html_",
    "_repr_png_",
    "_id_name",
    "_ALL_PLOTTERS",
}
#: What these rooms ask a form, a state or a law they ask by its calls.
ASKING = ("solvers", "nonlinear", "stages", "collapse", "results")
KINDS = {
    "Form",
    "SolidForm",
    "ContactPair",
    "SolidState",
    "ContactState",
    "Bar",
    "MatrixForm",
    "Coulomb",
    "Tied",
    "Beam",
    "Reinforcement",
}


@cache
def modules() -> dict[str, ast.Module]:
    """Syntax trees of all modules by their dotted names, without the package's own."""
    trees = {}
    for path in PACKAGE.rglob("*.py"):
        name = ".".join(path.relative_to(PACKAGE).with_suffix("").parts)
        trees[name.removesuffix(".__init__").replace("__init__", "")] = ast.parse(
            path.read_text(encoding="utf-8")
        )
    return trees


@cache
def imported(name: str, typing_too: bool = False) -> set[str]:
    """Modules of the package that a module imports, those for types alone only where they are asked
    for.
    """
    tree, found = modules()[name], set()
    types = {
        id(n)
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test)
        for n in ast.walk(node)
    }
    parents = (
        name.split(".")
        if f"{name}.__init__" in modules() or any(m.startswith(f"{name}.") for m in modules())
        else name.split(".")[:-1]
    )
    for node in ast.walk(tree):
        if (
            isinstance(node, ast.ImportFrom)
            and node.level
            and (typing_too or id(node) not in types)
        ):
            base = parents[: len(parents) - node.level + 1]
            path = ".".join([*base, *(node.module.split(".") if node.module else [])])
            for alias in node.names:
                full = f"{path}.{alias.name}".strip(".")
                found.add(full if full in modules() else path)
    return found


def floor(name: str) -> int:
    """Where in the house a module stands."""
    return next(i for i, rooms in enumerate(ROOMS) if name.split(".")[0] in rooms)


def test_no_arrow_goes_up() -> None:
    """A room uses those below it, and itself."""
    wrong = [
        f"{name} -> {other}"
        for name in modules()
        for other in imported(name)
        if name.split(".")[0] != other.split(".")[0]
        and floor(other) >= floor(name)
        and (name, other.split(".")[0]) not in SHORTCUTS
    ]
    assert not wrong


def test_no_circles() -> None:
    """No module needs itself, however long the way."""
    graph = {
        name: {o for o in imported(name) if (name, o.split(".")[0]) not in SHORTCUTS}
        for name in modules()
    }
    done: set[str] = set()

    def visit(name: str, way: tuple[str, ...]) -> None:
        assert name not in way, " -> ".join((*way, name))
        if name not in done:
            for other in graph.get(name, ()):
                visit(other, (*way, name))
            done.add(name)

    for name in graph:
        visit(name, ())


@pytest.mark.parametrize("room", ASKING)
def test_forms_states_and_laws_are_asked(room: str) -> None:
    """No `isinstance` on a form, a state or a law decides what an analysis does."""
    wrong = []
    for name, tree in modules().items():
        if name.split(".")[0] != room:
            continue
        for node in ast.walk(tree):
            if (
                isinstance(node, ast.Call)
                and isinstance(node.func, ast.Name)
                and node.func.id == "isinstance"
            ):
                kinds = {n.id for n in ast.walk(node.args[1]) if isinstance(n, ast.Name)} & KINDS
                wrong += [f"{name}:{node.lineno} {kind}" for kind in kinds]
    assert not wrong


def test_contact_and_solids_do_not_know_each_other() -> None:
    """... nor any analysis, not even by a type."""
    for name in modules():
        room = name.split(".")[0]
        others = {other.split(".")[0] for other in imported(name, typing_too=True)}
        if room in ("contact", "forms", "materials"):
            assert not others & ({"contact", *ASKING} - {room}), name
        if room == "contact":
            known = {o for o in imported(name, typing_too=True) if o.startswith("forms.")}
            assert known <= {"forms.base", "forms.roles"}, name


def test_a_form_has_few_members() -> None:
    """At most 12 public members; what only some forms can do belongs to a role."""
    assert len([name for name in dir(skfem_contact.Form) if not name.startswith("_")]) <= 12


def test_roles_are_small() -> None:
    """At most 6 members of their own, none of them a member of forms."""
    forms = set(dir(skfem_contact.Form))
    for role in skfem_contact.roles.ROLES:
        members = {name for name in vars(role) if not name.startswith("_")}
        assert 1 <= len(members) <= 6, role
        assert not members & forms, role


def test_materials_and_laws_are_asked_by_their_calls() -> None:
    """No `hasattr` on a material or a law."""
    found = {}
    for name, tree in modules().items():
        for node in ast.walk(tree):
            if (
                isinstance(node, ast.Call)
                and isinstance(node.func, ast.Name)
                and node.func.id == "hasattr"
            ):
                found[name] = ast.unparse(node)
    # protocols; objects that derive from no base class; named tuples; calls of the system
    allowed = {
        "checks",
        "forms.base",
        "forms.roles",
        "materials.base",
        "solvers.in_threads",
    }
    assert set(found) <= allowed, found


def test_private_members_are_read_in_their_module() -> None:
    """No module reads a private member that none of its own classes has."""
    found = []
    for name, tree in modules().items():
        own = set()
        read = []
        for node in ast.walk(tree):
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
                own.add(node.name)
            elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
                own.add(node.target.id)
            elif isinstance(node, ast.Attribute):
                of_self = isinstance(node.value, ast.Name) and node.value.id in ("self", "cls")
                if of_self or isinstance(node.ctx, ast.Store):
                    own.add(node.attr)
                read.append(node)
        for node in read:
            private = node.attr.startswith("_") and not node.attr.endswith("_")
            if private and node.attr not in own and node.attr not in OUTSIDE:
                found.append(f"{name}:{node.lineno} {ast.unparse(node)}")
    assert not found


def test_functions_of_the_iterations_have_few_parameters() -> None:
    """At most seven."""
    found = {}
    for name, tree in modules().items():
        if name.split(".")[0] != "nonlinear":
            continue
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef):
                given = node.args
                count = len(given.posonlyargs) + len(given.args) + len(given.kwonlyargs)
                if count > 7:
                    found[f"{name}.{node.name}"] = count
    assert not found


def test_few_calls_lie_between_a_run_and_the_factorisation(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """At most 15 from ``Model.run`` to ``factor`` of the solver, both of them counted."""
    calls = []
    factor = DirectSolver.factor

    def counted(self: DirectSolver, *given: Any, **named: Any) -> Any:
        names = ["factor"]
        frame = sys._getframe().f_back
        while frame is not None and names[-1] != "run":
            if Path(frame.f_code.co_filename).is_relative_to(PACKAGE):
                names.append(frame.f_code.co_name)
            frame = frame.f_back
        calls.append(names)
        return factor(self, *given, **named)

    monkeypatch.setattr(DirectSolver, "factor", counted)
    strip = skfem_contact.section.rectangle((0, 2), (0, 1))
    mesh = skfem_contact.section.Section({"ground": strip}, size=1.0).mesh()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    soil = skfem_contact.SolidForm(basis, skfem_contact.LinearElastic(1e4, 0.3), unit_weight=20.0)
    model = skfem_contact.Model({"soil": soil}, skfem_contact.box_supports(basis), solver="superlu")
    model.run([skfem_contact.Stage("weight")])
    assert calls
    assert max(len(names) for names in calls) <= 15
