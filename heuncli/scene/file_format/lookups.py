"""Record which values were looked up while something was computed: its dependencies, observed rather than guessed.

A mapping is wrapped and logs every lookup: values under single keys, or KEYS where code asks which keys there are. A
document is wrapped too: the fields of its entries that are read are logged.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.entries import Entry, cached_by_model, fields_of
from heuncli.scene.file_format.sharing import is_same

KEYS = "*"  # not a possible name: the keys of a mapping
KIND = "()"  # the class of an entry
GIVEN_FIELDS = "="  # the fields that the spec gave


class Lookup(NamedTuple):
    """The record of one lookup: the mapping's name and the key; KEYS: which keys there are, in which order."""

    container: str
    key: str


class LookupLog:
    """The lookups made since the log was emptied."""

    def __init__(self) -> None:
        self.lookups: set[Lookup] = set()

    def take(self) -> frozenset[Lookup]:
        """Return all lookups so far and empty the log."""
        lookups = frozenset(self.lookups)
        self.lookups.clear()
        return lookups


class WatchedMapping(Mapping[Any, Any]):
    """A mapping that logs the lookups made in it; with `inner`, its values are mappings that log their own.

    Iterating logs the keys and then each value that is read.
    """

    def __init__(self, name: str, values: Mapping[Any, Any], log: LookupLog, inner: bool = False) -> None:
        self.name, self.log = name, log
        self.values_by_key = {k: WatchedMapping(f"{name}.{k}", v, log) for k, v in values.items()} if inner else values
        self.inner = inner

    def __getitem__(self, key: str) -> Any:
        if not self.inner:
            self.log.lookups.add(Lookup(self.name, key))
        return self.values_by_key[key]

    def __contains__(self, key: object) -> bool:
        self.log.lookups.add(Lookup(self.name, KEYS))
        return key in self.values_by_key

    def __iter__(self) -> Iterator[str]:
        self.log.lookups.add(Lookup(self.name, KEYS))
        return iter(self.values_by_key)

    def __len__(self) -> int:
        self.log.lookups.add(Lookup(self.name, KEYS))
        return len(self.values_by_key)


class WatchedDocument:
    """Stands for a document and logs which fields of which entries are read."""

    def __init__(self, name: str, document: Any, log: LookupLog) -> None:
        self._of, self._document, self._log = name, document, log
        self._watched: dict[str, Any] = {}

    def __getattr__(self, name: str) -> Any:
        if name not in self._watched:
            value, path = getattr(self._document, name), f"{self._of}.{name}"
            self._watched[name] = (
                WatchedBlock(path, value, self._log) if isinstance(value, dict) else watch_entry(path, value, self._log)
            )
        return self._watched[name]


class WatchedBlock(Mapping[Any, Any]):
    """A block of entries that log which of their fields are read."""

    def __init__(self, path: str, entries: Mapping[Any, Entry], log: LookupLog) -> None:
        self._of, self._log = path, log
        self._entries = {name: watch_entry(f"{path}.{name}", entry, log) for name, entry in entries.items()}

    def __getitem__(self, name: Any) -> Any:
        self._log.lookups.add(Lookup(self._of, str(name)))  # logs whether the entry exists
        found = self._entries[name]
        self._log.lookups.add(Lookup(f"{self._of}.{name}", KIND))
        return found

    def __iter__(self) -> Iterator[Any]:
        self._log.lookups.add(Lookup(self._of, KEYS))
        return iter(self._entries)

    def __len__(self) -> int:
        self._log.lookups.add(Lookup(self._of, KEYS))
        return len(self._entries)


def watch_entry(path: str, entry: Any, log: LookupLog) -> Any:
    """Make a stand-in for an entry, of the same class, that logs which of its fields are read."""
    watched: Any = object.__new__(_make_watched_class(type(entry)))
    watched.__dict__.update(_of=path, _entry=entry, _log=log)
    return watched


@cached_by_model
def _make_watched_class(kind: type[Entry]) -> type[Entry]:
    names = frozenset(fields_of(kind))

    def read(self: Any, name: str) -> Any:
        own = object.__getattribute__(self, "__dict__")
        if name in names:
            own["_log"].lookups.add(Lookup(own["_of"], name))
            return getattr(own["_entry"], name)
        if name in ("__dict__", "__pydantic_fields_set__") and "_entry" in own:
            own["_log"].lookups.add(Lookup(own["_of"], KEYS if name == "__dict__" else GIVEN_FIELDS))
            return getattr(own["_entry"], name)
        return object.__getattribute__(self, name)

    return type(kind.__name__, (kind,), {"__getattribute__": read})


def iter_changed(name: str, new: Mapping[Any, Any], old: Mapping[Any, Any]) -> Iterator[Lookup]:
    """Yield the lookups of a mapping that now give another value; values are compared by identity."""
    if new is old:
        return
    for key in new.keys() | old.keys():
        if key not in new or key not in old or new[key] is not old[key]:
            yield Lookup(name, key)
    if [*new] != [*old]:
        yield Lookup(name, KEYS)


def iter_changed_in_document(document_name: str, new: Any, old: Any) -> Iterator[Lookup]:
    """Yield the lookups of a document that now give another value."""
    for name in old._fields:
        new_block, old_block = getattr(new, name), getattr(old, name)
        if new_block is old_block:
            continue
        path = f"{document_name}.{name}"
        if not isinstance(old_block, dict):
            yield from iter_changed_in_entry(path, new_block, old_block)
            continue
        for key in new_block.keys() | old_block.keys():
            if key not in new_block or key not in old_block:
                yield Lookup(path, str(key))
            elif new_block[key] is not old_block[key]:
                yield from iter_changed_in_entry(f"{path}.{key}", new_block[key], old_block[key])
        if [*new_block] != [*old_block]:
            yield Lookup(path, KEYS)


def iter_changed_in_entry(entry_path: str, new: Entry, old: Entry) -> Iterator[Lookup]:
    """Yield the lookups of an entry that now give another value."""
    kinds = type(new), type(old)
    if kinds[0] is not kinds[1]:
        yield Lookup(entry_path, KIND)
    names = fields_of(kinds[0]).keys() | fields_of(kinds[1]).keys()
    differing = [name for name in names if not is_equal(getattr(new, name, None), getattr(old, name, None))]
    if differing:
        yield Lookup(entry_path, KEYS)
    yield from (Lookup(entry_path, name) for name in differing)
    if new.model_fields_set != old.model_fields_set:
        yield Lookup(entry_path, GIVEN_FIELDS)


def is_equal(new: Any, old: Any) -> bool:
    """Whether two field values are equal; entries are compared field by field, also within lists."""
    if new is old:
        return True
    if type(new) is type(old) is list:
        return len(new) == len(old) and all(map(is_equal, new, old))
    if not isinstance(old, Entry) or type(new) is not type(old):
        return is_same(new, old)
    fields_equal = all(is_equal(getattr(new, name), value) for name, value in vars(old).items())
    return fields_equal and new.model_fields_set == old.model_fields_set
