"""Take the labels of named things out of the plain data of a spec, before anything else reads them.

A label is a text for readers and changes no number. What is read afterwards (entries, rules, settings, variants) is the
same as for a spec without labels. A thing has the key `label`; a parameter, a point or an event, which is a plain value
otherwise, is written as a mapping with its value: `{value: 40 mm, label: Throw}`, `{at: [0, 0, 0], label: Crank pin}`,
`{when: t > 1, label: Start}`.

A label belongs to a path of the results: `joints.main`, `points.crank.pin`; wheels count as couplings there, latches
as stops.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import suggest
from heuncli.base.text_safety import escape
from heuncli.scene.file_format.quantity import describe_kind

Path_ = tuple[str | int, ...]
LABEL = "label"
MAX_TEXT = 80  # characters: they share a line of a table with the name
# Block of a spec -> block of the results that its entries belong to
BLOCKS = {
    "parameters": "parameters", "bodies": "bodies", "joints": "joints", "drives": "drives", "forces": "forces",
    "impulses": "impulses", "stops": "stops", "latches": "stops", "couplings": "couplings", "rolling": "couplings",
    "sections": "sections", "sensors": "sensors", "tables": "tables", "cases": "cases",
}  # fmt: skip
# What is a plain value without a label -> the key of the value in a mapping
VALUE_KEYS = {"parameters": "value", "points": "at", "events": "when"}
POINTS, EVENTS, GROUND, ANALYSIS = "points", "events", "ground", "analysis"
NO_LABELS: Mapping[str, str] = {}


class LabelError(NamedTuple):
    """A problem of a label, with its path in the spec."""

    path: Path_
    finding: Finding
    is_key: bool = False


class LabelSplitter:
    """Splits the labels from data; containers that hold one are copied, all others stay shared.

    labels: by the path of the results
    unwrapped: path of a value that was given as a mapping -> the key of the value in it
    """

    def __init__(self) -> None:
        self.labels: dict[str, str] = {}
        self.errors: list[LabelError] = []
        self.unwrapped: dict[Path_, str] = {}

    def split(self, data: dict[str, Any]) -> dict[str, Any]:
        """Return the data of a spec without labels."""
        changed = {
            block: self._split_entries((block,), BLOCKS[block], data[block]) for block in BLOCKS if block in data
        }
        if GROUND in data:
            changed[GROUND] = self._split_entry((GROUND,), GROUND, data[GROUND])
        analysis = data.get(ANALYSIS)
        if type(analysis) is dict and EVENTS in analysis:
            events = self._split_entries((ANALYSIS, EVENTS), EVENTS, analysis[EVENTS])
            changed[ANALYSIS] = analysis if events is analysis[EVENTS] else {**analysis, EVENTS: events}
        return replace_changed(data, changed)

    def _split_entries(self, path: Path_, kind: str, entries: Any) -> Any:
        """Return named entries without their labels.

        kind: the words before a name in the path of the results
        """
        if type(entries) is not dict:
            return entries
        is_value = kind.split(".")[0] in VALUE_KEYS
        split = self._unwrap if is_value else self._split_entry
        changed = {
            name: split((*path, name), f"{kind}.{name}", entry)
            for name, entry in entries.items()
            if type(entry) is dict and (is_value or LABEL in entry or POINTS in entry)
        }  # most entries of a large scene have none
        return replace_changed(entries, changed) if changed else entries

    def _split_entry(self, path: Path_, label_path: str, entry: Any) -> Any:
        """Return an entry without its label and those of its points."""
        if type(entry) is not dict:
            return entry
        if POINTS in entry and path[0] in (GROUND, "bodies"):
            points = self._split_entries((*path, POINTS), f"{POINTS}.{path[-1]}", entry[POINTS])
            entry = replace_changed(entry, {POINTS: points})
        if LABEL not in entry:
            return entry
        self._add((*path, LABEL), label_path, entry[LABEL])
        return {key: value for key, value in entry.items() if key != LABEL}

    def _unwrap(self, path: Path_, label_path: str, entry: Any) -> Any:
        """Return the value that a mapping gives with a label, or the entry as it is."""
        key = VALUE_KEYS[label_path.split(".")[0]]
        if type(entry) is not dict or not {key, LABEL} & entry.keys():
            return entry
        if LABEL in entry:
            self._add((*path, LABEL), label_path, entry[LABEL])
        if label_path.startswith(f"{EVENTS}.") and key not in entry:  # a condition on a result is a mapping
            return {name: value for name, value in entry.items() if name != LABEL}
        others = [name for name in entry if name not in (key, LABEL)]
        for name in others:
            finding = Finding("unknown-key", f"'{name}' is not known here", suggest(name, (key, LABEL), "keys"))
            self.errors.append(LabelError((*path, name), finding, is_key=True))
        if key not in entry:
            if len(others) != 1:  # the reader of the value says what it expects
                return {}
            key = others[0]
        self.unwrapped[path] = key
        return entry[key]

    def _add(self, path: Path_, label_path: str, value: Any) -> None:
        try:
            self.labels[label_path] = check_plain_text(value)
        except Finding as finding:
            self.errors.append(LabelError(path, finding))


def replace_changed(owner: dict[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """Return a mapping with new values; itself if they are those that it holds."""
    changed = {key: value for key, value in values.items() if value is not owner[key]}
    return {**owner, **changed} if changed else owner


def iter_moved_paths(paths: Mapping[Path_, Any], unwrapped: Mapping[Path_, str]) -> Iterator[tuple[Path_, Any]]:
    """Yield locations by path, those of values that were unwrapped from a mapping by the path of the mapping."""
    lengths = {len(path) for path in unwrapped}
    for path, location in paths.items():
        cut = next((n for n in lengths if len(path) > n and unwrapped.get(path[:n]) == path[n]), None)
        yield path if cut is None else (*path[:cut], *path[cut + 1 :]), location


def check_plain_text(value: Any) -> str:
    """Return a text for readers, without blanks at its ends. Raises Finding [wrong-kind, bad-label]."""
    if type(value) is not str:
        hint = "write it in quotes" if isinstance(value, int | float) else "for example label: Main bearing"
        raise Finding("wrong-kind", f"expected a text, found {describe_kind(value)}", hint)
    text = value.strip()
    if not text:
        raise Finding("bad-label", "the text is empty", "leave the key out; the name is shown then")
    if len(text) > MAX_TEXT:
        raise Finding("bad-label", f"{len(text)} characters; at most {MAX_TEXT} fit", "write a name, not a description")
    if escape(text) != text:
        message = f"the text has a line break or an invisible character: {escape(text)}"
        raise Finding("bad-label", message, "delete it; a label is one line")
    return text
