"""What another analysis of the same scene must find as well."""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

import skfem_contact as sc
from skfem_contact.contact.interface import ContactState
from skfem_contact.results import Result, StageResult

from .frames import Frame, in_units, mirrored, shifted, turned
from .model import HEIGHT, Model, build
from .oracles import Finding
from .scenes import STRAIN, Scene

#: Displacements of two analyses with residuals of 1e-10, relative to the largest: that times the
#: condition of scenes whose bodies differ in stiffness by up to 1e3, and whose penalties are ten
#: times stiffer than the bodies.
SAME = 1e-5
#: ... whose multipliers may be those of one more round: ten times the tolerance of the augmented
#: method.
AUGMENTED = 1e-3
#: ... of other increments where joints follow the bodies: a clearance between curves stays until
#: its pressure changes by 5e-4 of the largest, adjusted gaps are interpolated between moved cuts.
#: A wavy joint of 1 to 12 increments differs by 8e-4, and by 5e-11 if the clearance always follows.
FOLLOWING = 1e-3
#: What the augmented method says where nodes are left to the penalty, and more than its tolerance
#: remains.
LEFT = "leave an error"
#: Comparisons of other increments.
_INCREMENTS = ("split", "path")


def tolerance(scene: Scene, model: Model, name: str) -> float:
    """How much displacements may differ in a comparison."""
    if scene.augmented:
        return AUGMENTED
    pairs = [form for form in model.forms.values() if isinstance(form, sc.ContactPair)]
    interpolated = scene.quadrature == "segments" and scene.initial == "adjusted"
    follows = interpolated or any(pair.interface.smooth for pair in pairs)
    if follows and name in _INCREMENTS:
        return FOLLOWING
    return SAME


def of_result(
    scene: Scene, model: Model, result: Result, name: str, remarks: Sequence[str] = ()
) -> Iterator[Finding]:
    """The findings of one comparison; none where it says nothing, or the other analysis gives up
    and says so.

    Nor are there any where one of the two says that its multipliers do not reach their tolerance,
    or where brittle bonds broke: there are several equilibria then, and last bits tell which point
    goes first.
    """
    if any(_broken(stage) for stage in result):
        return
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            pairs = COMPARISONS[name](scene, model, result)
    except sc.NotConverged:
        return
    if any(LEFT in text for text in (*remarks, *(str(warning.message) for warning in caught))):
        return
    for stage, x in pairs:
        size = max(np.abs(stage.x).max(), STRAIN * HEIGHT * model.frame.length)
        yield Finding(
            name, stage.name, float(np.abs(x - stage.x).max() / size), tolerance(scene, model, name)
        )


def _broken(stage: StageResult) -> bool:
    """Whether a point has lost its bond, of a law that has one."""
    states = {
        name: state for name, state in stage.states.items() if isinstance(state, ContactState)
    }
    pairs = [(stage.forms[name].law, state) for name, state in states.items()]
    return any(
        isinstance(law, sc.Coulomb)
        and (law.adhesion > 0.0 or law.tension > 0.0)
        and bool(state.internal.any())
        for law, state in pairs
    )


Pairs = list[tuple[StageResult, np.ndarray]]


def _same_increments(one: Result, other: Result) -> Iterator[tuple[StageResult, StageResult]]:
    """Stages up to the first one of which one analysis took other increments: friction follows
    another path there.
    """
    for a, b in zip(one, other):
        if len(a.iterations) != len(b.iterations):
            return
        yield a, b


def _in_frame(frame: Frame) -> Callable[[Scene, Model, Result], Pairs]:
    def seen(scene: Scene, model: Model, result: Result) -> Pairs:
        other = build(scene, frame).run()
        return [(a, frame.back(b.x)) for a, b in _same_increments(result, other)]

    return seen


def _mirror(scene: Scene, model: Model, result: Result) -> Pairs:
    if any(_at_joints(pair) for pair in model.forms.values() if isinstance(pair, sc.ContactPair)):
        return []
    if scene.quadrature == "segments" and scene.dim == 3:
        # pieces are cut into triangles from their first corner, which is another one in the mirror
        return []
    return _in_frame(mirrored(scene.dim, 1 if scene.kind == "axisymmetric" else 0))(
        scene, model, result
    )


def _at_joints(pair: sc.ContactPair) -> bool:
    """Whether points face joints of the master: they belong to the facet before, which is another
    in the mirror.
    """
    return pair.master.shape.dim == 1 and bool((np.abs(pair.initial_state().position) > 0.99).any())


def _rotation(scene: Scene, model: Model, result: Result) -> Pairs:
    if scene.kind == "axisymmetric":
        return []
    return _in_frame(turned(scene.dim, 0.7))(scene, model, result)


def _shift(scene: Scene, model: Model, result: Result) -> Pairs:
    shift = 30.0 * np.ones(scene.dim)
    if scene.kind == "axisymmetric":
        shift[0] = 0.0
    return _in_frame(shifted(scene.dim, shift))(scene, model, result)


def _units(scene: Scene, model: Model, result: Result) -> Pairs:
    return _in_frame(in_units(scene.dim, 1e3, 1e-3))(scene, model, result)


def _saved(scene: Scene, model: Model, result: Result) -> Pairs:
    """Saved after the first stage, loaded, and continued."""
    half = Result(result.stages[:1])
    with tempfile.TemporaryDirectory() as folder:
        half.save(Path(folder, "half"))
        loaded = sc.load_result(Path(folder, "half"), model.forms)
    other = model.run(model.stages[1:], start=loaded)
    return [(a, b.x) for a, b in _same_increments(result, other)]


def _split(scene: Scene, model: Model, result: Result) -> Pairs:
    """The first stage in two increments, or as two stages."""
    first = model.stages[0]
    x = None if first.prescribed is None else 0.5 * first.prescribed
    once = model.run([replace(first, increments=2)])[-1]
    both = model.run(
        [
            replace(first, name="half", load=0.5 * first.load, prescribed=x, increments=1),
            replace(first, increments=1),
        ]
    )
    if any(len(stage.iterations) != 1 for stage in both) or len(once.iterations) != 2:
        return []
    return [(once, both[-1].x)]


def _path(scene: Scene, model: Model, result: Result) -> Pairs:
    """Without friction and yielding the way does not matter: the first stage in three increments,
    or in one. Gaps between nodes are left to the penalty, which augmented multipliers choose by
    their progress.
    """
    if not (scene.frictionless and scene.elastic and not scene.bonded and scene.built != "cap"):
        return []
    first = model.stages[0]
    one, three = (model.run([replace(first, increments=n)])[-1] for n in (1, 3))
    if _penalties(one) != _penalties(three):
        return []
    return [(one, three.x)]


def _penalties(stage: StageResult) -> list[list[float]]:
    """The factors of the penalties of each pair."""
    states = stage.states.values()
    return [state.penalty_factor.tolist() for state in states if isinstance(state, ContactState)]


def _nothing(scene: Scene, model: Model, result: Result) -> Pairs:
    """A stage that changes nothing."""
    other = model.run([sc.Stage("nothing", result[-1].load, result[-1].x)], start=result)
    return [(result[-1], other[-1].x)]


COMPARISONS = {
    "mirror": _mirror,
    "rotation": _rotation,
    "shift": _shift,
    "units": _units,
    "saved": _saved,
    "split": _split,
    "path": _path,
    "nothing": _nothing,
}
