"""States of forms as arrays: to save them, to read them again, to compare them."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

from numpy import ndarray


def arrays_of(state: Any) -> dict[str, Any]:
    """What a state consists of: the fields of a dataclass, the items of a tuple, an array or number, or nothing."""
    if is_dataclass(state):
        return {field.name: getattr(state, field.name) for field in fields(state)}
    if isinstance(state, tuple):
        return {str(k): values for k, values in enumerate(state)}
    return {} if state is None else {"values": state}


def with_arrays(like: Any, arrays: Mapping[str, ndarray]) -> Any:
    """A state like another one of these arrays; the inverse of :func:`arrays_of`."""
    if is_dataclass(like):
        return type(like)(**arrays)  # type: ignore[misc]
    if isinstance(like, tuple):
        return type(like)(*arrays.values()) if hasattr(like, "_fields") else tuple(arrays.values())
    return arrays.get("values")
