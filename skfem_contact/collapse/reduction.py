"""Which forms and regions a strength reduction applies to."""
from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from ..solid import SolidForm


def reduced_parts(forms: Mapping[str, Any], reduce: str | Collection[str] | None,
                  exclude: str | Collection[str]) -> dict[str, tuple[str, ...] | None]:
    """Regions to reduce by form; None stands for the law of a contact pair.

    Parameters
    ----------
    forms
        Forms by name.
    reduce, exclude
        Names of forms and of regions that are reduced, by default those with a strength, and that are not.

    Raises
    ------
    ValueError
        A name that does not exist or has no strength, or nothing to reduce.
    """
    reduce = [reduce] if isinstance(reduce, str) else reduce
    exclude = [exclude] if isinstance(exclude, str) else exclude
    regions = {name: tuple(form.materials) for name, form in forms.items() if isinstance(form, SolidForm)}
    known = sorted({*forms, *(r for names in regions.values() for r in names)})
    for name in {*(reduce or ()), *exclude}:
        if name not in known:
            raise ValueError(f"there is no form or region '{name}' to reduce; existing: {', '.join(known)}")
    targets: dict[str, tuple[str, ...] | None] = {}
    for name, form in forms.items():
        if name in exclude:
            continue
        if name in regions:
            chosen = tuple(r for r in regions[name] if r not in exclude and _has_strength(
                form.materials[r], r, reduce, name))
            if chosen:
                targets[name] = chosen
        elif reduce is not None and name in reduce:
            _has_strength(form.law, name, reduce, name)
            targets[name] = None
    if not targets:
        raise ValueError("there is nothing to reduce: no material among the forms has a strength")
    return targets


def _has_strength(material: Any, region: str, reduce: Collection[str] | None, form: str) -> bool:
    """Whether a material is to be reduced; one that is named must have a strength."""
    if hasattr(material, "reduced"):
        return reduce is None or region in reduce or form in reduce
    if reduce is not None and region in reduce:
        raise ValueError(f"'{region}' cannot be reduced: {type(material).__name__} has no strength")
    return False
