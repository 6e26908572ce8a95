"""Rules about names: their form, and reserved names."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.scene.file_format.names import NAMED_BLOCKS, RESERVED_NAMES, is_name
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule


@rule("bad-name")
def check_name_form(draft: DraftDocument) -> Iterator[Violation]:
    """A name is a letter, then letters, digits and _."""
    hint = "a name starts with a letter and contains only letters, digits and _"
    for block in NAMED_BLOCKS:
        for name in draft.names.entries[block]:
            if not is_name(name):
                yield Violation((block, name), f"'{name}' is not a valid name", hint, key=True)
    for body, points in draft.names.points.items():
        for name in points:
            if not is_name(name):
                path = ("ground",) if body == "ground" else ("bodies", body)
                yield Violation((*path, "points", name), f"'{name}' is not a valid name", hint, key=True)


@rule("reserved-name")
def check_reserved_name(draft: DraftDocument) -> Iterator[Violation]:
    """Names with a meaning of their own are not used for entries."""
    for block, reserved in RESERVED_NAMES.items():
        for name in draft.names.entries[block]:
            if name in reserved:
                meaning = (
                    "the ground"
                    if name == "ground"
                    else "a built-in name of expressions"
                    if block != "forces"
                    else "a cause in the results"
                )
                yield Violation(
                    (block, name), f"'{name}' is reserved: it is {meaning}", f"call it {name}_1, for example", key=True
                )
