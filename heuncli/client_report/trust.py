"""How far the numbers can be trusted: stated errors, residuals, horizons; and what no number can be given of."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.client_report.parts import Cell, Facts, Grid, Listing, Part, Sentence
from heuncli.client_report.reported import Reported, ReportedRun
from heuncli.report.certain_sums import sums_table
from heuncli.report.digits import LOADS, rough
from heuncli.report.heading import heading
from heuncli.report.text_table import TextColumn

MEANING = (
    "Every motion is integrated a second time, with a thirtieth of the error allowed. The stated errors are twice the "
    "largest difference of the two, of all instants so far, and not below rounding; they hold for all numbers of a "
    "kind. They tell of the solution of the model, not of how well the model is the machine."
)
AT_REST = (
    "Nothing is integrated: the equations of one instant are solved, and the stated errors are those of rounding. They "
    "tell of the solution of the model, not of how well the model is the machine."
)
ESTIMATES: dict[str, tuple[str, ...]] = {"motion": ("m",), **dict.fromkeys(LOADS, ("N", "N·m"))}
NAMED = {"motion": "places of points", "reactions": "joint loads", "drives": "drives", "foundation": "foundation",
         "sections": "section loads"}  # fmt: skip
CERTAIN = "Nothing is open: the laws of rigid bodies determine every load that is reported."


def trust_parts(of: Reported) -> list[Part]:
    """What is said of each run, and the errors that it states."""
    moved = any(run.results.work.get("steps") for run in of.runs)
    parts: list[Part] = [Sentence(MEANING if moved else AT_REST)]
    for run in of.runs:
        if of.has_cases:
            parts.append(Sentence(f"Case {run.told}:"))
        parts.append(Facts([line for line in heading(run.results) if line[0] not in ("heun", "model", "warning")]))
    return [*parts, _errors(of)]


def _errors(of: Reported) -> Grid:
    """The stated errors of all kinds, the largest of all cases."""
    rows = []
    for kind, units in ESTIMATES.items():
        for unit in units:
            worst = max(of.runs, key=lambda run: _error(run, kind, unit))
            error = _error(worst, kind, unit)
            shown, size = of.units.of(unit)
            if error:
                rows.append([Cell(NAMED[kind]), Cell(shown), Cell(rough(error * size)), Cell(worst.name)])
    heads = [TextColumn("of", "left"), TextColumn("unit", "left"), TextColumn("±"), TextColumn("case", "left")]
    if not of.has_cases:
        heads, rows = heads[:3], [row[:3] for row in rows]
    return Grid("STATED ERRORS  of all numbers of a kind", heads, rows)


def _error(run: ReportedRun, kind: str, unit: str) -> float:
    """The error of a kind in SI; 0 where the run tells nothing of it."""
    certain = run.page.certain
    return certain.error(kind, unit) if (kind, unit) in certain.errors else 0.0


def open_parts(of: Reported) -> list[Part]:
    """What is open, and the sums that are certain all the same."""
    parts: list[Part] = []
    for run in of.runs:
        if run.kept.open:
            parts.append(Listing(f"Open{_in(run)}", run.kept.open))
        parts += _sums(of, run)
    if not parts:
        return [Sentence(CERTAIN)]
    chosen = dict.fromkeys(run.results.model["split"] for run in of.runs if run.results.model.get("split"))
    return [
        *parts,
        *(Sentence(f"Chosen, not certain: {words}; other splits do as well.", "unsure") for words in chosen),
    ]


def _sums(of: Reported, run: ReportedRun) -> Iterator[Part]:
    table = sums_table(run.page.results, run.page.certain, run.page.beyond, of.units.of("N"))
    if table is not None:
        yield Listing(f"Certain sums{_in(run)}", table.notes)


def _in(run: ReportedRun) -> str:
    return f" in case {run.name}" if run.name else ""
