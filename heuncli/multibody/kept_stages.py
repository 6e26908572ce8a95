"""Stages of a computation whose results are kept, each with what of its input it has looked at.

A stage is a function of records that changes nothing. Run for the first time its input is handed to it wrapped, and
every field that it reads is written down. Given other input in which all that it read is the same to the bit, its
result can be no other, and is taken over: that a force does not move the pose in which a scene is assembled is
found out by that, and asserted nowhere.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import cache
from typing import Any, TypeVar

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import fields
from heuncli.multibody.stages import Stages
from heuncli.scene.file_format.sharing import same

T = TypeVar("T")

Key = tuple[Callable[..., Any], str]


class KeptStage(NamedTuple):
    """The result of a stage and what it looked at."""

    result: Any
    looked_at: tuple[LookedAt, ...]

    def stands(self, given: tuple[Any, ...]) -> bool:
        """Whether the stage would see in this input what it saw."""
        for one, new in zip(self.looked_at, given, strict=True):
            if new is not one.value and not one.stands(new):
                return False
        return True


class FirstStages(Stages):
    """Runs stages for the first time, and keeps what they look at; of one that is run again the first run."""

    def __init__(self) -> None:
        self.kept: dict[Key, KeptStage] = {}

    def run(self, stage: Callable[..., T], *given: Any, of: str = "", by: Callable[[], T] | None = None) -> T:
        """The result of a stage; where it is kept its arrays cannot be written to.

        It is not kept where it holds some of the input, nor where wrapped input gives another one or none: a stage may
        ask whether two records are the same object.
        """
        result = stage(*given) if by is None else by()
        if (stage, of) not in self.kept:
            looked_at = tuple(map(LookedAt, given))
            with suppress(Exception):
                again = stage(*map(watched, looked_at))
                if holds_no_input(again) and same(again, result):
                    lock(result)
                    self.kept[stage, of] = KeptStage(result, looked_at)
        return result


class LaterStages(Stages):
    """Takes the results of first stages where they stand."""

    def __init__(self, first: FirstStages) -> None:
        self.first = first

    def run(self, stage: Callable[..., T], *given: Any, of: str = "", by: Callable[[], T] | None = None) -> T:
        """The result of a stage."""
        kept = self.first.kept.get((stage, of))
        if kept is not None and kept.stands(given):
            result: T = kept.result
            return result
        return stage(*given) if by is None else by()


class LookedAt:
    """A value that was handed to a stage, and the parts of it that were looked at; a value without parts counts whole.

    parts: fields of a record by their names, members of a list or tuple with records by their places.
    """

    __slots__ = ("parts", "value")

    def __init__(self, value: Any) -> None:
        self.value = value
        self.parts: dict[Any, LookedAt] | None = None
        if is_record(value):
            self.parts = {}
        elif type(value) in (tuple, list) and any(map(is_record, value)):
            self.parts = {place: LookedAt(member) for place, member in enumerate(value)}

    def stands(self, new: Any) -> bool:
        """Whether another value is the same in all that was looked at."""
        old = self.value
        if new is old:
            return True
        if self.parts is None:
            return same(new, old)
        if type(new) is not type(old):
            return False
        if is_record(old):
            members = [(part, getattr(new, name)) for name, part in self.parts.items()]
        elif len(new) != len(old):
            return False
        else:
            members = [(part, new[place]) for place, part in self.parts.items()]
        for part, member in members:  # noqa: SIM110 - half the time of all()
            if member is not part.value and not part.stands(member):
                return False
        return True


def is_record(value: Any) -> bool:
    return hasattr(type(value), "__record_fields__")


def watched(seen: LookedAt) -> Any:
    """What stands for a value and writes down which parts of it are looked at."""
    value = seen.value
    if seen.parts is None:
        return value
    if not is_record(value):
        return type(value)(watched(part) for part in seen.parts.values())
    kind: Any = type(value)
    return _standing_for(_watched_class(kind), seen, {})


def _standing_for(kind: Any, seen: LookedAt, parts: dict[str, Any]) -> Any:
    """A record of a watched kind in the place of another; parts: what stands for those of its fields that were read."""
    made = object.__new__(kind)
    made.__dict__.update(_looked_at=seen, _parts=parts)
    return made


@cache
def _watched_class(kind: Any) -> Any:
    """A kind of record whose fields are read from the record that it stands for, but for those that were replaced."""
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
                part = seen.parts[name] = LookedAt(getattr(seen.value, name))
            parts[name] = watched(part)
        return parts[name]

    def copy(self: Any) -> Any:
        """What `replace` puts its changes into: what it leaves has not been looked at."""
        own = object.__getattribute__(self, "__dict__")
        made = _standing_for(type(self), own["_looked_at"], own["_parts"])
        made.__dict__.update({name: value for name, value in own.items() if name in names})
        return made

    return type(kind.__name__, (kind,), {"__getattribute__": read, "__record_copy__": staticmethod(copy)})


def holds_no_input(value: Any) -> bool:
    """Whether a result consists of numbers, words and records of its own, and of nothing behind which others hide."""
    if isinstance(value, Mapping):
        return all(map(holds_no_input, value.values()))
    if isinstance(value, list | tuple | set | frozenset):
        return all(map(holds_no_input, value))
    if is_record(value):
        return "_looked_at" not in vars(value) and all(map(holds_no_input, fields(value).values()))
    return value is None or isinstance(value, bool | int | float | str | np.ndarray)


def lock(value: Any) -> None:
    """Keep the arrays of a result from being written to."""
    if isinstance(value, np.ndarray):
        value.flags.writeable = False
    elif isinstance(value, Mapping | list | tuple):
        for member in value.values() if isinstance(value, Mapping) else value:
            lock(member)
    elif is_record(value):
        lock(fields(value))
