"""The option `-k TEXT`: select the specs with the text in path or title, ignoring case. Impure: reads files."""

from __future__ import annotations

import re
from collections.abc import Sequence

from heuncli.app.cli.entry import UsageError
from heuncli.app.commands.check.folders import FoundSpec
from heuncli.base.errors import Finding, HeunError, Problem
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes
from heuncli.scene.file_format.source import MAX_SIZE, read_source

PLAIN_TITLE = re.compile(r"^title:[ \t]+(?![|>&*!\"'\[{])([^#\n]*)", re.MULTILINE)


def select_specs(specs: Sequence[FoundSpec], text: str) -> list[FoundSpec]:
    """Return the specs with the text in path or title. Raises UsageError if there is none."""
    needle = text.casefold()
    chosen = [one for one in specs if needle in one.path.casefold() or needle in read_title(one).casefold()]
    if not chosen:
        hint = "it is looked for in paths and titles, in capitals or not"
        raise UsageError(Problem("nothing-to-check", f"-k {text}: none of {len(specs)} specs", hint=hint))
    return chosen


def read_title(one: FoundSpec) -> str:
    """Return the title of a spec; empty if it has none or cannot be read, which the check reports later."""
    if one.problem is not None or one.path == STANDARD_INPUT:
        return ""
    try:
        text = read_bytes(one.path, MAX_SIZE).decode("utf-8", "replace")
        if (plain := PLAIN_TITLE.search(text)) is not None:
            return plain[1]
        data = read_source(one.path, None).data if "title" in text else {}
    except (Finding, HeunError):
        return ""
    title = data.get("title") if isinstance(data, dict) else None
    return title if isinstance(title, str) else ""
