"""Computations in stages, and a cache of their results, each with the part of its input that the stage has read.

A stage is a function of records without side effects. On its first run it gets its input wrapped in proxies that record
every field it reads. Given other input in which all of these fields are equal to the bit, its result must be the same
and is taken from the cache: that a force does not change the assembled pose is found out in this way, not asserted.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import cache
from typing import Any, TypeVar

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import fields
from heuncli.scene.file_format.sharing import is_same

T = TypeVar("T")


class Stages:
    """Runs stages without a cache."""

    def run(self, stage: Callable[..., T], *inputs: Any, key: str = "", fallback: Callable[[], T] | None = None) -> T:
        """Return the result of a stage. key: which one, of a stage that is run for several objects by name.

        fallback: computes the same from smaller stages, some of which may be cached when the stage itself is not
        """
        return stage(*inputs) if fallback is None else fallback()


NO_CACHE = Stages()


# The cache

Key = tuple[Callable[..., Any], str]


class CachedStage(NamedTuple):
    """The result of a stage and the trace of the input it read."""

    result: Any
    traces: tuple[InputTrace, ...]

    def is_valid_for(self, inputs: tuple[Any, ...]) -> bool:
        """Return whether the stage would read the same values from this input."""
        for trace, new in zip(self.traces, inputs, strict=True):
            if new is not trace.value and not trace.matches(new):
                return False
        return True


class RecordingStages(Stages):
    """Runs stages and records what they read; of a repeated stage the first run is stored."""

    def __init__(self) -> None:
        self.cached: dict[Key, CachedStage] = {}

    def run(self, stage: Callable[..., T], *inputs: Any, key: str = "", fallback: Callable[[], T] | None = None) -> T:
        """Return the result of a stage; the arrays of a cached result cannot be written to.

        A result is not cached if it contains part of the input, or if the proxies give another result or an error: a
        stage may test whether two records are the same object.
        """
        result = stage(*inputs) if fallback is None else fallback()
        if (stage, key) not in self.cached:
            traces = tuple(map(InputTrace, inputs))
            with suppress(Exception):
                again = stage(*map(make_tracing_proxy, traces))
                if holds_no_input(again) and is_same(again, result):
                    lock(result)
                    self.cached[stage, key] = CachedStage(result, traces)
        return result


class ReusingStages(Stages):
    """Takes the results of a recorded run where they are still valid."""

    def __init__(self, first: RecordingStages) -> None:
        self.first = first

    def run(self, stage: Callable[..., T], *inputs: Any, key: str = "", fallback: Callable[[], T] | None = None) -> T:
        """Return the result of a stage."""
        cached = self.first.cached.get((stage, key))
        if cached is not None and cached.is_valid_for(inputs):
            result: T = cached.result
            return result
        return stage(*inputs) if fallback is None else fallback()


class InputTrace:
    """An input of a stage, and which of its fields the stage read; a value without parts counts as a whole.

    parts: fields of a record by name, members of a list or tuple of records by index
    """

    __slots__ = ("parts", "value")

    def __init__(self, value: Any) -> None:
        self.value = value
        self.parts: dict[Any, InputTrace] | None = None
        if is_record(value):
            self.parts = {}
        elif type(value) in (tuple, list) and any(map(is_record, value)):
            self.parts = {place: InputTrace(member) for place, member in enumerate(value)}

    def matches(self, new: Any) -> bool:
        """Return whether another value is equal in all parts that were read."""
        old = self.value
        if new is old:
            return True
        if self.parts is None:
            return is_same(new, old)
        if type(new) is not type(old):
            return False
        if is_record(old):
            members = [(part, getattr(new, name)) for name, part in self.parts.items()]
        elif len(new) != len(old):
            return False
        else:
            members = [(part, new[place]) for place, part in self.parts.items()]
        for part, member in members:  # noqa: SIM110 - half the time of all()
            if member is not part.value and not part.matches(member):
                return False
        return True


def is_record(value: Any) -> bool:
    return hasattr(type(value), "__record_fields__")


def make_tracing_proxy(trace: InputTrace) -> Any:
    """Make a proxy of a value that records which parts of it are read."""
    value = trace.value
    if trace.parts is None:
        return value
    if not is_record(value):
        return type(value)(make_tracing_proxy(part) for part in trace.parts.values())
    kind: Any = type(value)
    return _make_proxy(_make_proxy_class(kind), trace, {})


def _make_proxy(proxy_class: Any, trace: InputTrace, parts: dict[str, Any]) -> Any:
    """Make a proxy record. parts: the proxies of those of its fields that were read."""
    proxy = object.__new__(proxy_class)
    proxy.__dict__.update(_looked_at=trace, _parts=parts)
    return proxy


@cache
def _make_proxy_class(kind: Any) -> Any:
    """Make a record class whose fields are read from the traced record, except those that were replaced."""
    names = frozenset(kind.__record_fields__)

    def read(self: Any, name: str) -> Any:
        own = object.__getattribute__(self, "__dict__")
        if name not in names or name in own:
            return object.__getattribute__(self, name)
        parts = own["_parts"]
        if name not in parts:
            seen = own["_looked_at"]
            part = seen.parts.get(name)
            if part is None:
                part = seen.parts[name] = InputTrace(getattr(seen.value, name))
            parts[name] = make_tracing_proxy(part)
        return parts[name]

    def copy(self: Any) -> Any:
        """Make the copy that `replace` then changes; fields that it leaves alone do not count as read."""
        own = object.__getattribute__(self, "__dict__")
        made = _make_proxy(type(self), own["_looked_at"], own["_parts"])
        made.__dict__.update({name: value for name, value in own.items() if name in names})
        return made

    return type(kind.__name__, (kind,), {"__getattribute__": read, "__record_copy__": staticmethod(copy)})


def holds_no_input(value: Any) -> bool:
    """Return whether a result consists of numbers, words and records of its own, and contains no proxy of the input."""
    if isinstance(value, Mapping):
        return all(map(holds_no_input, value.values()))
    if isinstance(value, list | tuple | set | frozenset):
        return all(map(holds_no_input, value))
    if is_record(value):
        return "_looked_at" not in vars(value) and all(map(holds_no_input, fields(value).values()))
    return value is None or isinstance(value, bool | int | float | str | np.ndarray)


def lock(value: Any) -> None:
    """Make the arrays of a result read-only."""
    if isinstance(value, np.ndarray):
        value.flags.writeable = False
    elif isinstance(value, Mapping | list | tuple):
        for member in value.values() if isinstance(value, Mapping) else value:
            lock(member)
    elif is_record(value):
        lock(fields(value))
