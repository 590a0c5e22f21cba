"""Flows by options that belong to the flow, to its conditions and to its times."""

from __future__ import annotations

from typing import Any

import skfem_contact as sc

CONDITIONS = ("head", "flux", "wells", "drains", "sources", "seepage_face", "suction")
TIMES = ("times", "start", "error")


def steady(basis: Any, permeability: Any, head: Any, **options: Any) -> sc.water.Seepage:
    """Return the steady flow."""
    given = {name: options.pop(name) for name in CONDITIONS if name in options}
    flow = sc.water.Flow(basis, permeability, **options)
    return flow.steady(sc.water.Conditions(head, **given))


def in_time(
    basis: Any, permeability: Any, head: Any = (), **options: Any
) -> sc.water.TransientSeepage:
    """Return the flow in time."""
    given = {name: options.pop(name) for name in CONDITIONS if name in options}
    times = {name: options.pop(name) for name in TIMES if name in options}
    flow = sc.water.Flow(basis, permeability, **options)
    return flow.in_time(sc.water.Conditions(head or {}, **given), **times)
