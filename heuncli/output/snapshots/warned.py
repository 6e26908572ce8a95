"""What a run is warned of, by reading and by solving: sentences, once each."""

from __future__ import annotations

from collections.abc import Iterable

from heuncli.results.results import Results
from heuncli.scene.file_format.models import Spec


def warnings_of(spec: Spec, results: Results | None, later: Iterable[str]) -> tuple[list[str], list[str]]:
    """Those of reading, with their places, and those of solving and of what came later that are not among them."""
    known = {problem.message for problem in spec.warnings}
    solved = [text for text in results.warnings if text not in known] if results else []
    return [str(problem) for problem in spec.warnings], solved + list(later)
