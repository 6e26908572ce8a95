"""What the command's --measure tells of a run."""

from __future__ import annotations

import json
from typing import Any

from heuncli.output.tables import measure
from heuncli.study.queries.study import Study


def measured(run: Study, words: str) -> dict[str, Any]:
    """What `--measure WORDS --format json` prints."""
    block: dict[str, Any] = json.loads(measure.format_measures([measure.parse_measure(words)], run, "json"))
    return block
