"""How far the numbers can be trusted: stated errors, residuals, horizons; and what no number can be given of."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.output.client_report.parts import Facts, Listing, Part, ReportCell, ReportTable, Sentence
from heuncli.output.client_report.reported import Reported, ReportedRun
from heuncli.output.tables.certain_sums import sums_table
from heuncli.output.tables.heading import heading
from heuncli.output.tables.text_table import TextColumn
from heuncli.results.results_schema import XYZ, kind_of_error
from heuncli.study.quantities.digits import rough

MEANING = (
    "Every motion is integrated a second time, with a thirtieth of the error allowed. The stated errors are twice the "
    "largest difference of the two, of all instants so far, and not below rounding; they hold for all numbers of a "
    "kind. They tell of the solution of the model, not of how well the model is the machine."
)
FOLLOWED = (
    "Nothing is integrated: the drives leave no freedom, and every instant is solved by itself. The stated errors are "
    "those of rounding, found by solving again from values moved by it. They tell of the solution of the model, not of "
    "how well the model is the machine."
)
POSE_AT_REST = (
    "Nothing is integrated: a pose at rest is looked for, and again ten times finer. The stated errors are those of "
    "the pose, from the difference of the two finest, and of rounding. They tell of the solution of the model, not of "
    "how well the model is the machine."
)
AT_REST = (
    "Nothing is integrated: the equations of one instant are solved, and the stated errors are those of rounding. They "
    "tell of the solution of the model, not of how well the model is the machine."
)
NAMED = {"reactions": "joints", "drives": "drives", "foundation": "foundation", "sections": "sections"}
MOTION = ("places of points", "m")
LOADS = ("N", "N·m")
CASE = TextColumn("case", "left")
CERTAIN = "Nothing is open: the laws of rigid bodies determine every load that is reported."


def trust_parts(of: Reported) -> list[Part]:
    """What is said of each run, and the errors that it states."""
    parts: list[Part] = [Sentence(text) for text in dict.fromkeys(map(_meaning, of.runs))]
    for run in of.runs:
        if of.has_cases:
            parts.append(Sentence(f"Case {run.told}:"))
        parts.append(Facts([line for line in heading(run.results) if line[0] not in ("heun", "model", "warning")]))
    return [*parts, _errors(of)]


def _meaning(run: ReportedRun) -> str:
    """Where the stated errors of a run come from."""
    if run.study.of_one_instant:
        return POSE_AT_REST if "rest" in run.results.model else AT_REST
    return MEANING if run.study.history.followed_for is None else FOLLOWED


def _errors(of: Reported) -> ReportTable:
    """The stated errors of all kinds, the largest of all cases."""
    found: dict[tuple[str, str], tuple[float, str]] = {}
    for run in of.runs:
        own = {MOTION: run.page.certain.error("motion", "m")} | _of_loads(run)
        for key, error in own.items():
            found[key] = max(found.get(key, (0.0, run.name)), (error, run.name))
    rows = []
    for (kind, unit), (error, case) in found.items():
        shown, size = of.units.of(unit)
        rows.append(
            [
                ReportCell(kind),
                ReportCell(shown),
                ReportCell(rough(error * size)),
                *([ReportCell(case)] if of.has_cases else []),
            ]
        )
    heads = [TextColumn("of", "left"), TextColumn("unit", "left"), TextColumn("±")]
    return ReportTable("STATED ERRORS  of all numbers of a kind", [*heads, *([CASE] if of.has_cases else [])], rows)


def _of_loads(run: ReportedRun) -> dict[tuple[str, str], float]:
    """The largest error of each kind of loads and unit that a case tells of, by what they are called."""
    found: dict[tuple[str, str], float] = {}
    for path, number in run.kept.numbers.items():
        block, *name, quantity = [word for word in path.split(".") if word not in XYZ]
        kind = NAMED.get(kind_of_error(block, ".".join(name), quantity))
        if kind is not None and number.unit in LOADS:
            found[kind, number.unit] = max(found.get((kind, number.unit), 0.0), number.error)
    return found


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
