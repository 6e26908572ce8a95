"""`-k TEXT`: the specs that have it in their path or title, in any case. Impure: reads files."""

from __future__ import annotations

import re
from collections.abc import Sequence

from heuncli.app.cli.entry import UsageError
from heuncli.app.commands.check.folders import Found
from heuncli.base.errors import Finding, HeunError, Problem
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes
from heuncli.scene.file_format.source import LARGEST, read

PLAIN_TITLE = re.compile(r"^title:[ \t]+(?![|>&*!\"'\[{])([^#\n]*)", re.MULTILINE)


def picked(found: Sequence[Found], text: str) -> list[Found]:
    """Those with the text in path or title. Raises UsageError where there is none."""
    wanted = text.casefold()
    chosen = [one for one in found if wanted in one.path.casefold() or wanted in title_of(one).casefold()]
    if not chosen:
        hint = "it is looked for in paths and titles, in capitals or not"
        raise UsageError(Problem("nothing-to-check", f"-k {text}: none of {len(found)} specs", hint=hint))
    return chosen


def title_of(one: Found) -> str:
    """The title of a spec; empty where it has none, or cannot be read, which is told where it is checked."""
    if one.problem is not None or one.path == STANDARD_INPUT:
        return ""
    try:
        text = read_bytes(one.path, LARGEST).decode("utf-8", "replace")
        if (plain := PLAIN_TITLE.search(text)) is not None:
            return plain[1]
        data = read(one.path, None).data if "title" in text else {}
    except (Finding, HeunError):
        return ""
    title = data.get("title") if isinstance(data, dict) else None
    return title if isinstance(title, str) else ""
