"""Which values were looked up while something was made: what it hangs on, computed and not guessed.

A mapping that is handed on is wrapped, and writes down what is asked of it: the values under single keys, or, where it
is asked which keys there are, KEYS.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from heuncli.named_tuples import NamedTuple

KEYS = "*"  # no name of a user's


class Lookup(NamedTuple):
    """A key whose value was asked for, and of which mapping; KEYS: which keys there are, in which order."""

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
    """A mapping that writes into a log what is looked up in it; inner: its values are mappings that do so themselves.

    What goes through it meets its keys and, where it wants them, one value after another.
    """

    def __init__(self, of: str, values: Mapping[str, Any], log: Log, inner: bool = False) -> None:
        self.of, self.log = of, log
        self.inside = {k: Watched(f"{of}.{k}", v, log) for k, v in values.items()} if inner else values
        self.inner = inner

    def __getitem__(self, key: str) -> Any:
        if not self.inner:
            self.log.lookups.add(Lookup(self.of, key))
        return self.inside[key]

    def __contains__(self, key: object) -> bool:
        self.log.lookups.add(Lookup(self.of, KEYS))
        return key in self.inside

    def __iter__(self) -> Iterator[str]:
        self.log.lookups.add(Lookup(self.of, KEYS))
        return iter(self.inside)

    def __len__(self) -> int:
        self.log.lookups.add(Lookup(self.of, KEYS))
        return len(self.inside)


class WatchedFields:
    """Stands for an object, and writes into a log which of its fields are looked at."""

    def __init__(self, of: str, values: Any, log: Log) -> None:
        self._of, self._values, self._log = of, values, log

    def __getattr__(self, name: str) -> Any:
        self._log.lookups.add(Lookup(self._of, name))
        return getattr(self._values, name)


def changed(of: str, new: Mapping[str, Any], old: Mapping[str, Any]) -> Iterator[Lookup]:
    """The lookups of a mapping that do not give now what they gave; a value is the same if it is the same object."""
    for key in new.keys() | old.keys():
        if key not in new or key not in old or new[key] is not old[key]:
            yield Lookup(of, key)
    if [*new] != [*old]:
        yield Lookup(of, KEYS)
