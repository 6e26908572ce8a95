"""Collect the warnings of a run, from reading and from solving, each once."""

from __future__ import annotations

from collections.abc import Iterable

from heuncli.results.results import Results
from heuncli.scene.file_format.models import Spec


def collect_warnings(spec: Spec, results: Results | None, later: Iterable[str]) -> tuple[list[str], list[str]]:
    """Return the warnings of reading, with their places, and those of solving and later ones that are not among
    them.
    """
    reading_messages = {problem.message for problem in spec.warnings}
    solving_warnings = [text for text in results.warnings if text not in reading_messages] if results else []
    return [str(problem) for problem in spec.warnings], solving_warnings + list(later)
