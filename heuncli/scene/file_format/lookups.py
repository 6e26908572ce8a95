"""Which values were looked up while something was made: what it hangs on, computed and not guessed.

A mapping that is handed on is wrapped, and writes down what is asked of it: the values under single keys, or, where it
is asked which keys there are, KEYS. So is a document: of its entries the fields are written down that are looked at.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.entries import Entry, fields_of, once
from heuncli.scene.file_format.sharing import same

KEYS = "*"  # no name of a user's
KIND = "()"  # nor this: of which kind an entry is
GIVEN = "="  # nor this: which of its fields were given


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


class Watched(Mapping[Any, Any]):
    """A mapping that writes into a log what is looked up in it; inner: its values are mappings that do so themselves.

    What goes through it meets its keys and, where it wants them, one value after another.
    """

    def __init__(self, of: str, values: Mapping[Any, Any], log: Log, inner: bool = False) -> None:
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


class WatchedDocument:
    """Stands for a document, and writes into a log which fields of which entries are looked at."""

    def __init__(self, of: str, document: Any, log: Log) -> None:
        self._of, self._document, self._log = of, document, log
        self._watched: dict[str, Any] = {}

    def __getattr__(self, name: str) -> Any:
        if name not in self._watched:
            value, of = getattr(self._document, name), f"{self._of}.{name}"
            self._watched[name] = (
                WatchedBlock(of, value, self._log) if isinstance(value, dict) else watched_entry(of, value, self._log)
            )
        return self._watched[name]


class WatchedBlock(Mapping[Any, Any]):
    """A block of entries that write into a log which of their fields are looked at."""

    def __init__(self, of: str, entries: Mapping[Any, Entry], log: Log) -> None:
        self._of, self._log = of, log
        self._entries = {name: watched_entry(f"{of}.{name}", entry, log) for name, entry in entries.items()}

    def __getitem__(self, name: Any) -> Any:
        self._log.lookups.add(Lookup(self._of, str(name)))  # whether it is there
        found = self._entries[name]
        self._log.lookups.add(Lookup(f"{self._of}.{name}", KIND))
        return found

    def __iter__(self) -> Iterator[Any]:
        self._log.lookups.add(Lookup(self._of, KEYS))
        return iter(self._entries)

    def __len__(self) -> int:
        self._log.lookups.add(Lookup(self._of, KEYS))
        return len(self._entries)


def watched_entry(of: str, entry: Any, log: Log) -> Any:
    """What stands for an entry, is of its kind, and writes into a log which of its fields are looked at."""
    made: Any = object.__new__(_watched_kind(type(entry)))
    made.__dict__.update(_of=of, _entry=entry, _log=log)
    return made


@once
def _watched_kind(kind: type[Entry]) -> type[Entry]:
    names = frozenset(fields_of(kind))

    def read(self: Any, name: str) -> Any:
        own = object.__getattribute__(self, "__dict__")
        if name in names:
            own["_log"].lookups.add(Lookup(own["_of"], name))
            return getattr(own["_entry"], name)
        if name in ("__dict__", "__pydantic_fields_set__") and "_entry" in own:
            own["_log"].lookups.add(Lookup(own["_of"], KEYS if name == "__dict__" else GIVEN))
            return getattr(own["_entry"], name)
        return object.__getattribute__(self, name)

    return type(kind.__name__, (kind,), {"__getattribute__": read})


def changed(of: str, new: Mapping[Any, Any], old: Mapping[Any, Any]) -> Iterator[Lookup]:
    """The lookups of a mapping that do not give now what they gave; a value is the same if it is the same object."""
    if new is old:
        return
    for key in new.keys() | old.keys():
        if key not in new or key not in old or new[key] is not old[key]:
            yield Lookup(of, key)
    if [*new] != [*old]:
        yield Lookup(of, KEYS)


def changed_in_document(of: str, new: Any, old: Any) -> Iterator[Lookup]:
    """The lookups of a document that do not give now what they gave."""
    for name in old._fields:
        now, before = getattr(new, name), getattr(old, name)
        if now is before:
            continue
        path = f"{of}.{name}"
        if not isinstance(before, dict):
            yield from changed_in_entry(path, now, before)
            continue
        for key in now.keys() | before.keys():
            if key not in now or key not in before:
                yield Lookup(path, str(key))
            elif now[key] is not before[key]:
                yield from changed_in_entry(f"{path}.{key}", now[key], before[key])
        if [*now] != [*before]:
            yield Lookup(path, KEYS)


def changed_in_entry(of: str, new: Entry, old: Entry) -> Iterator[Lookup]:
    """The lookups of an entry that do not give now what they gave."""
    kinds = type(new), type(old)
    if kinds[0] is not kinds[1]:
        yield Lookup(of, KIND)
    names = fields_of(kinds[0]).keys() | fields_of(kinds[1]).keys()
    differing = [name for name in names if not alike(getattr(new, name, None), getattr(old, name, None))]
    if differing:
        yield Lookup(of, KEYS)
    yield from (Lookup(of, name) for name in differing)
    if new.model_fields_set != old.model_fields_set:
        yield Lookup(of, GIVEN)


def alike(new: Any, old: Any) -> bool:
    """Whether two values of fields are the same; entries by their own, also in lists."""
    if new is old:
        return True
    if type(new) is type(old) is list:
        return len(new) == len(old) and all(map(alike, new, old))
    if not isinstance(old, Entry) or type(new) is not type(old):
        return same(new, old)
    own = all(alike(getattr(new, name), value) for name, value in vars(old).items())
    return own and new.model_fields_set == old.model_fields_set
