"""Whether two values are the same to the bit, and the older of two that are: so that what hangs on it is known again.

A scene read again with other parameters is for the most part the same. Where a value is the very object that it was
before, nothing that was made of it needs to be made again.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np

T = TypeVar("T")


def same(a: Any, b: Any) -> bool:
    """Whether two values are of one type and of the same bits; of types that are not known here only the same object.

    0.0 and -0.0 are two values, as are 1 and 1.0; mappings of one order of keys are the same.
    """
    if a is b:
        return True
    kind = type(a)
    if kind is not type(b):
        return False
    if kind is float:
        return bool((a == b and math.copysign(1.0, a) == math.copysign(1.0, b)) or (a != a and b != b))
    if kind in (int, str, bool, set, frozenset):  # sets hold names and numbers of bodies
        return bool(a == b)
    if issubclass(kind, tuple) or kind is list:
        return len(a) == len(b) and all(map(same, a, b))
    if kind in (dict, MappingProxyType):
        return [*a] == [*b] and all(map(same, a.values(), b.values()))
    if kind is array:
        return bool(a.typecode == b.typecode) and a.tobytes() == b.tobytes()
    if kind is np.ndarray:
        return bool(a.dtype == b.dtype) and a.shape == b.shape and a.tobytes() == b.tobytes()
    names: tuple[str, ...] = getattr(kind, "__record_fields__", ())
    return bool(names) and all(same(getattr(a, name), getattr(b, name)) for name in names)


def shared(new: T, old: T) -> T:
    """The old value where the new one is the same."""
    return old if same(new, old) else new


def shared_entries(new: Mapping[str, Any], old: Mapping[str, Any]) -> Mapping[str, Any]:
    """The old mapping where the new one is the same, else the new one with the old values that are."""
    if new is old:
        return old
    found = {key: shared(value, old.get(key)) for key, value in new.items()}
    unchanged = [*found] == [*old] and all(found[key] is old[key] for key in found)
    return old if unchanged else found
