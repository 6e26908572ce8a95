"""Which values were looked up while something was made: what it hangs on, computed and not guessed.

A mapping that is handed on is wrapped, and writes down what is asked of it: single keys, there or not, or, where it is
gone through as a whole, EVERYTHING.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

EVERYTHING = "*"  # no name of a user's


class Lookup(NamedTuple):
    """A key that was asked for, and of which mapping; EVERYTHING: the mapping was gone through."""

    of: str
    key: str


class Log:
    """What has been looked up since it was emptied."""

    def __init__(self) -> None:
        self.lookups: set[Lookup] = set()

    def taken(self) -> frozenset[Lookup]:
        """All lookups so far; the next ones are counted from here."""
        found = frozenset(self.lookups)
        self.lookups.clear()
        return found


class Watched(Mapping[str, Any]):
    """A mapping that writes into a log what is looked up in it."""

    def __init__(self, of: str, values: Mapping[str, Any], log: Log) -> None:
        self.of, self.values_, self.log = of, values, log

    def __getitem__(self, key: str) -> Any:
        self.log.lookups.add(Lookup(self.of, key))
        return self.values_[key]

    def __iter__(self) -> Iterator[str]:
        self.log.lookups.add(Lookup(self.of, EVERYTHING))
        return iter(self.values_)

    def __len__(self) -> int:
        self.log.lookups.add(Lookup(self.of, EVERYTHING))
        return len(self.values_)


class WatchedFields:
    """Stands for an object, and writes into a log which of its fields are looked at."""

    def __init__(self, of: str, values: Any, log: Log) -> None:
        self._of, self._values, self._log = of, values, log

    def __getattr__(self, name: str) -> Any:
        self._log.lookups.add(Lookup(self._of, name))
        return getattr(self._values, name)


def changed(of: str, new: Mapping[str, Any], old: Mapping[str, Any]) -> Iterator[Lookup]:
    """The lookups of a mapping that do not give now what they gave; a value is the same if it is the same object."""
    differing = [key for key in new.keys() | old.keys() if key not in new or new[key] is not old.get(key)]
    yield from (Lookup(of, key) for key in differing)
    if differing or [*new] != [*old]:
        yield Lookup(of, EVERYTHING)
