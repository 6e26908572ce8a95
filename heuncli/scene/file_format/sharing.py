"""Compare values bit by bit, and keep the older of two equal ones so that results derived from it can be reused.

A scene read again with other parameters is mostly the same. Where a value is the same object as before, everything
derived from it stays valid.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np

T = TypeVar("T")


def is_same(first: Any, second: Any) -> bool:
    """Whether two values have the same type and bits; values of types unknown here are the same only as one object.

    0.0 and -0.0 differ, as do 1 and 1.0; two mappings are the same only if their keys have the same order.
    """
    if first is second:
        return True
    kind = type(first)
    if kind is not type(second):
        return False
    if kind is float:
        return bool(
            (first == second and math.copysign(1.0, first) == math.copysign(1.0, second))
            or (first != first and second != second)
        )
    if kind in (int, str, bytes, bool, set, frozenset):  # sets hold names and numbers of bodies
        return bool(first == second)
    if issubclass(kind, tuple) or kind is list:
        return len(first) == len(second) and all(map(is_same, first, second))
    if kind in (dict, MappingProxyType):
        return [*first] == [*second] and all(map(is_same, first.values(), second.values()))
    if kind is array:
        return bool(first.typecode == second.typecode) and first.tobytes() == second.tobytes()
    if kind is np.ndarray:
        return bool(first.dtype == second.dtype) and first.shape == second.shape and first.tobytes() == second.tobytes()
    names: tuple[str, ...] = getattr(kind, "__record_fields__", ())
    return bool(names) and all(is_same(getattr(first, name), getattr(second, name)) for name in names)


def reuse_if_same(new: T, old: T) -> T:
    """Return the old value if the new one is the same."""
    return old if is_same(new, old) else new


def reuse_entries(new: Mapping[str, Any], old: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the old mapping if the new one is the same, else the new mapping with unchanged values taken from the old
    one.
    """
    if new is old:
        return old
    merged = {key: reuse_if_same(value, old.get(key)) for key, value in new.items()}
    unchanged = [*merged] == [*old] and all(merged[key] is old[key] for key in merged)
    return old if unchanged else merged
