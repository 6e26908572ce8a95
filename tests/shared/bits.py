"""Everything that a value holds, to the bit, by the path to it: two runs are the same if these are."""

from __future__ import annotations

import struct
from array import array
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from heuncli.base.records import fields

Leaf = tuple[str, bytes | str]


def bits(value: Any, path: str = "") -> Iterator[Leaf]:
    """Each number, word and array with its path and its type."""
    if isinstance(value, np.ndarray):
        yield path, f"{value.dtype} {value.shape}"
        yield path, value.tobytes()
    elif isinstance(value, array):
        yield path, value.typecode
        yield path, value.tobytes()
    elif isinstance(value, Mapping):
        for key, member in value.items():
            yield from bits(member, f"{path}.{key}")
        yield path, f"a mapping of {len(value)}"
    elif isinstance(value, list | tuple):
        for i, member in enumerate(value):
            yield from bits(member, f"{path}.{i}")
        yield path, f"{type(value).__name__} of {len(value)}"
    elif hasattr(type(value), "__record_fields__"):
        yield from bits(fields(value), path)
    elif isinstance(value, float):
        yield path, struct.pack("d", value)
    else:
        assert value is None or isinstance(value, int | str | np.integer | np.bool_), f"{path}: {type(value)}"
        yield path, f"{type(value).__name__} {value}"
