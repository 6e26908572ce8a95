"""The lines above the tables of a run, as text."""

from __future__ import annotations

from heuncli.output.documents.as_text import render_text
from heuncli.output.documents.document import OutputDocument
from heuncli.output.tables.run_description import make_heading
from heuncli.results.results import Results


def format_heading(results: Results) -> str:
    """Format what `heun run` prints above its tables."""
    return render_text(OutputDocument(results.title, make_heading(results)))
