"""Which forms and regions a strength reduction applies to."""
from __future__ import annotations

from collections.abc import Collection, Mapping

from ..checks import names_of
from .base import Form


def reduced_parts(forms: Mapping[str, Form], reduce: str | Collection[str] | None,
                  exclude: str | Collection[str]) -> dict[str, tuple[str, ...]]:
    """Parts to reduce by form: names of regions, or ``""`` for a form as a whole; by default all that have a strength.

    Raises
    ------
    ValueError
        A name that does not exist or has no strength, or nothing to reduce.
    """
    exclude, named = set(names_of(exclude)), set(names_of(reduce or ()))
    known = sorted({*forms, *(region for form in forms.values() for region in form.materials)})
    for name in sorted(named | exclude):
        if name not in known:
            raise ValueError(f"there is no form or region '{name}' to reduce; existing: {', '.join(known)}")
    targets = {}
    for name, form in forms.items():
        for region in named.intersection(form.materials).difference(form.strengths):
            raise ValueError(f"'{region}' cannot be reduced: {type(form.materials[region]).__name__} has no strength")
        if not form.materials and not form.strengths and name in named:
            raise ValueError(f"'{name}' cannot be reduced: {form!r} has no strength")
        parts = tuple(part for part in form.strengths
                      if exclude.isdisjoint((name, part)) and (reduce is None or not named.isdisjoint((name, part))))
        if parts:
            targets[name] = parts
    if not targets:
        raise ValueError("there is nothing to reduce: nothing among the forms has a strength")
    return targets
