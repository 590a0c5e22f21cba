"""Models with design values of the strengths."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace
from typing import Any

import numpy as np
from numpy import ndarray
from typing_extensions import TypeVar

from ..checks import names, names_of
from ..contact.laws import Coulomb, InterfaceLaw
from ..errors import warn
from ..forms.base import Form
from ..forms.roles import Body, Reducible, Touching, having, materials_of
from ..forms.solid import SolidForm
from ..materials.base import as_given, parameters_of
from ..materials.elastic import angle_over
from ..model import Model
from .factors import PartialFactors

#: Parameters of laws that are undrained strengths.
_UNDRAINED = frozenset(("s_uA", "s_uDSS", "s_uP", "strength"))
M = TypeVar("M", bound=Model)


def factored(model: M, factors: PartialFactors, *, exclude: str | Collection[str] = ()) -> M:
    r"""Return the model with design values of its strengths; the model itself stays as it is.

    Cohesion and :math:`\tan\varphi` of materials, undrained strengths, and friction and adhesion of
    contact pairs are divided by their factors. Tensile strength has the factor of the cohesion,
    which without friction is that of undrained strength, as adhesion has.
    Forms that stages change are factored as well. Runs, searches and bounds of the new model start
    from results of either one.

    Parameters
    ----------
    model
        The model with characteristic strengths.
    factors
        The set; its factors on actions belong to the loads, see :meth:`PartialFactors.load`.
    exclude
        Names of forms and regions that keep their strength.

    Warns
    -----
    AnalysisWarning
        A law whose strength cannot be divided keeps it.

    Examples
    --------
    A bank of clay has the limit load 2 c, with design values 2 c / 1.4:

    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()))
    >>> clay = sc.SolidForm(basis, sc.Tresca(E=1e3, nu=.3, c=10.))
    >>> fixed = [basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")]
    >>> model = sc.Model({"clay": clay}, fixed)
    >>> load = model.traction("top", (0., -1.))
    >>> design = sc.design.factored(model, sc.design.EC7["DA1-2"])
    >>> f"{model.limit_load(load).multiplier:.0f} {design.limit_load(load).multiplier:.0f}"
    '20 14'
    """
    regions: set[str] = set()
    for body in having(model.forms, Body).values():
        regions |= set(body.materials)
    names(exclude, (*model.forms, *sorted(regions)), "form or region of the model")
    return model.with_each(_Factoring(factors, frozenset(names_of(exclude))))


class _Factoring:
    """Division of the strengths of forms; none is divided twice."""

    def __init__(self, factors: PartialFactors, exclude: frozenset[str]) -> None:
        self.factors = factors
        self.exclude = exclude
        self._made: dict[int, tuple[Any, Any]] = {}
        self._new: dict[int, Any] = {}

    def __call__(self, name: str, form: Form) -> Form:
        """Return a form with design values of its strengths."""
        if name in self.exclude:
            return form
        if isinstance(form, SolidForm):
            return self._solid(name, form)
        if materials_of(form):
            warn(f"{name}: the materials of {type(form).__name__} keep their strength")
        if not isinstance(form, Reducible) or "" not in form.strengths:
            return form
        if isinstance(form, Touching):
            law = self._once(form.law, lambda law: divided_interface(law, self.factors))
            return form if law is form.law else form.with_law(law)  # type: ignore[attr-defined]
        return self._once(form, lambda one: one.reduced(self.factors.phi, "given", ("",)))

    def _solid(self, name: str, form: SolidForm) -> SolidForm:
        """Return a solid with design values of its materials."""
        changed = {}
        # the materials of a model have the values of functions, which cannot be given again
        for region, material in form.given_materials.items():
            if region not in self.exclude:
                new = self._once(material, lambda law: divided(law, self.factors))
                if new is not material:
                    changed[region] = new
                elif self._keeps(material):
                    warn(f"{name}.{region}: {material.label} keeps its strength")
        if changed:
            return form.with_materials(changed)
        return form

    def _keeps(self, material: Any) -> bool:
        """Return True for a characteristic material with a memory: it may yield."""
        return material.n_internal > 0 and id(material) not in self._new

    def _once(self, old: Any, change: Callable[[Any], Any]) -> Any:
        """Return the changed object, the same one for the same argument."""
        if id(old) in self._new:
            return old
        if id(old) not in self._made:
            new = change(old)
            self._made[id(old)] = (old, new)
            if new is not old:
                self._new[id(new)] = new
        return self._made[id(old)][1]


def divided(material: Any, factors: PartialFactors) -> Any:
    """Return a material with design values of its strength, or itself if it has none."""
    # Divide the soil of undrained ground, and the joints of rock.
    own = as_given(material)
    existing = parameters_of(material)
    if "soil" in existing:
        return replace(own, soil=divided(existing["soil"], factors))
    if "joints" in existing:
        joints = tuple(divided(joint, factors) for joint in existing["joints"])
        return replace(own, joints=joints)

    # Divide the parameters of Mohr and Coulomb, and undrained strengths.
    by = dict.fromkeys(_UNDRAINED, factors.undrained)
    cohesion = _of_cohesion(existing.get("phi", 0.0), factors)
    by |= dict.fromkeys(("c", "c_end", "tension"), cohesion)
    changed: dict[str, Any] = {}
    for name, value in existing.items():
        if name in by:
            changed[name] = _over(value, by[name])
        elif name in ("phi", "phi_end"):
            changed[name] = _angle_over(value, factors.phi)
    if not changed:
        if material.reducible:
            return material.reduced(factors.phi)
        return material
    if "psi" in existing and "phi" in changed:
        changed["psi"] = _least(existing["psi"], changed["phi"])
    return replace(own, **changed)


def divided_interface(law: InterfaceLaw, factors: PartialFactors) -> InterfaceLaw:
    """Return a law of contact with design values, by one factor where it is not Coulomb's."""
    if not isinstance(law, Coulomb):
        return law.reduced(factors.phi)
    cohesion = _of_cohesion(law.mu, factors)
    return replace(
        law,
        mu=law.mu / factors.phi,
        adhesion=law.adhesion / cohesion,
        tension=law.tension / cohesion,
    )


def _of_cohesion(friction: Any, factors: PartialFactors) -> float:
    """Return the factor of the cohesion: without friction it is an undrained strength."""
    if _has_friction(friction):
        return factors.cohesion
    return factors.undrained


def _has_friction(phi: Any) -> bool:
    return callable(phi) or bool(np.any(np.greater(phi, 0.0)))


def _over(value: Any, factor: float) -> Any:
    """Return a number, an array or a function over a factor; None remains."""
    if value is None:
        return None
    if callable(value):
        return lambda x: np.asarray(value(x)) / factor
    return value / factor


def _angle_over(value: Any, factor: float) -> Any:
    """Return the angle in degrees whose tangent is divided by a factor; None remains."""
    if value is None:
        return None
    if callable(value):
        return lambda x: _angle_over(np.asarray(value(x)), factor)
    angle = angle_over(value, factor)
    if isinstance(value, ndarray):
        return angle
    return float(angle)


def _least(psi: Any, phi: Any) -> Any:
    """Return the dilatancy, at most the friction."""
    if callable(psi) or callable(phi):

        def least(x: ndarray) -> ndarray:
            first = psi(x) if callable(psi) else psi
            second = phi(x) if callable(phi) else phi
            return np.minimum(first, second)

        return least
    smallest = np.minimum(psi, phi)
    if np.ndim(smallest):
        return smallest
    return float(smallest)
