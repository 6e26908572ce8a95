"""The chapter of sections: their diagrams, their extremes with places, and their utilisation of the strength."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.client_report.cases_table import LoadGroup, LoadNumber, has_instants, make_cases_table
from heuncli.output.client_report.extremes import (
    CaseExtremes,
    Family,
    choose_family,
    find_extremes,
    find_governing,
    find_uncertain_cases,
    format_instant,
    format_place,
    iter_run_extremes,
)
from heuncli.output.client_report.machine import HALF_WIDTH
from heuncli.output.client_report.report_data import ReportData, ReportedRun
from heuncli.output.documents.document import Drawing, OutputColumn, OutputTable, Part, Sentence, TextCell, join_names
from heuncli.output.drawing.figure import Figure, Panel, Spot
from heuncli.output.figures.courses import FigureSource, is_claimed
from heuncli.output.figures.diagrams import BAND_SENTENCE, make_diagrams
from heuncli.output.tables.table_plans import SECTIONS
from heuncli.results.results_schema import MAGNITUDES, RESULTANTS, STRESSES
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.channels import DECIMALS_OF
from heuncli.study.queries.bar_curves import BarExtremes, Extreme

UTIL_NOTE = (
    "utilisation: largest von Mises stress (mises) divided by the given strength; above 1 the section is overloaded"
)
SAFE_SIDE_NOTE = "stresses are conservative where the shape of a section is not known"
UNCERTAIN_NOTE = "{}: open or unknown{}, where it may be larger"
LARGEST_NOTE = "bold: section with the highest utilisation"
GOVERNING_QUANTITIES = ("stress.utilisation", "stress.mises", "M1", "M2", "N", "Q1", "Q2", "T")  # in order of priority
MAX_DIAGRAMS = 12
PANEL_HEIGHT = 66.0  # pixels
NO_STRENGTH = "not given"
DIAGRAM_NOTE = "Diagrams: force of the far side on the near side of the cut; N > 0 is tension."


def make_section_parts(data: ReportData) -> list[Part]:
    """Make all parts about the sections."""
    names = list(data.runs[0].results.sections)
    return (
        [*_iter_stress_table(data, names), *_iter_extremes(data, names), *_iter_diagrams(data, names)] if names else []
    )


def _iter_diagrams(data: ReportData, names: list[str]) -> Iterator[Part]:
    """Yield a figure for each series of cuts, of its governing case; of many runs only for the most loaded ones."""
    cut_runs = [name for name in names if "s" in data.runs[0].results.sections[name]]
    governing_cases = {name: _find_governing_case(data, name) for name in cut_runs}
    if cut_runs:
        is_moving = any(len(run.results.time) > 1 for run in data.runs)
        yield Sentence(f"{DIAGRAM_NOTE} {BAND_SENTENCE[0].upper()}{BAND_SENTENCE[1:]}" if is_moving else DIAGRAM_NOTE)
    drawn_runs = sorted(cut_runs, key=lambda name: governing_cases[name].rank, reverse=True)[:MAX_DIAGRAMS]
    for name in (name for name in cut_runs if name in drawn_runs):
        run = governing_cases[name].run
        if not is_claimed(run.study):
            yield Sentence(f"{name} has no diagram: all output times are past the horizon.")
            continue
        figure = make_diagrams(
            [FigureSource("", run.study)], [name], data.units, known_extremes=_collect_extremes(run, name)
        )
        figure = figure._replace(title="", words=())
        case = f", load case {run.case_label}" if run.name else ""
        words = describe_object("sections", name, data.labels)
        axes = data.labels.sections[name].first_axis if name in data.labels.sections else ""
        caption = f"Section {words}{case}{_format_open_cases(data, name)}{f'; e1 = {axes}' if axes else ''}"
        for k, half in enumerate(_split_panels(figure)):
            yield Drawing(half, caption if k == 0 else "", HALF_WIDTH, "half")
    if len(cut_runs) > len(drawn_runs):
        yield Sentence(
            f"{len(cut_runs) - len(drawn_runs)} further sections are not shown: heun plot SPEC sections.NAME"
        )


def _collect_extremes(run: ReportedRun, name: str) -> BarExtremes | None:
    """Collect the extremes of a series of cuts that the tables show; None if one is not known or not searched."""
    found = {}
    for quantity in RESULTANTS:
        ends = find_extremes(run, f"sections.{name}.{quantity}")
        if ends is None or not run.is_searched:
            return None
        extremes = []
        for end in (ends.low, ends.high):
            if isinstance(end.value, str) or end.place is None:
                return None
            time = float(run.results.time[0]) if end.time is None else end.time  # the same at all instants
            extremes.append(Extreme(end.value, end.place.s, time))
        found[quantity] = (extremes[0], extremes[1])
    return found


def _split_panels(figure: Figure) -> list[Figure]:
    """Split the panels of a bar into two columns: forces at the left, moments at the right, each with the sketch of
    the bar if there is one.
    """
    sketch = [panel for panel in figure.panels if panel.is_bare]
    panels = [_shorten_panel(panel) for panel in figure.panels if not panel.is_bare]
    middle = (len(panels) + 1) // 2
    halves = [half for half in (panels[:middle], panels[middle:]) if half]
    return [
        figure._replace(
            panels=[*sketch, *half[:-1], half[-1]._replace(x=half[-1].x._replace(hides_label=False))],
            notes=figure.notes if k == 0 else (),
        )
        for k, half in enumerate(halves)
    ]


def _shorten_panel(panel: Panel) -> Panel:
    """Return a panel for half the width, whose marks have their values alone; places and instants are in the table."""
    items = [
        item._replace(text=item.text.partition(" at ")[0], note="") if isinstance(item, Spot) else item
        for item in panel.items
    ]
    return panel._replace(height=min(panel.height, PANEL_HEIGHT), title="", items=tuple(items))


def _format_open_cases(data: ReportData, name: str) -> str:
    """Format the list of the cases in which loads of a section are indeterminate, so that these may govern after
    all.
    """
    case_lists = [find_uncertain_cases(data, f"sections.{name}.{quantity}") for quantity in RESULTANTS]
    cases = [
        run.case_label for run in data.runs if any(run.case_label in uncertain_cases for uncertain_cases in case_lists)
    ]
    return f" (some loads are open in {join_names(cases)}; these cases may govern)" if cases and data.has_cases else ""


class GoverningCase(NamedTuple):
    """The case that governs a section; rank: by which sections are compared, the first number counting most."""

    run: ReportedRun
    rank: tuple[float, ...]


def _find_governing_case(data: ReportData, name: str) -> GoverningCase:
    """Find the case with the largest stress in a section; without stresses, with the largest bending moment or
    force.
    """
    governing_bounds = find_governing(data)
    run, sizes = None, list[float]()
    for path in (f"sections.{name}.{quantity}" for quantity in GOVERNING_QUANTITIES):
        bounds = [
            bound
            for bound in (governing_bounds.find_least(path), governing_bounds.find_greatest(path))
            if bound is not None
        ]
        largest = max(bounds, key=lambda bound: abs(bound.value), default=None)
        sizes.append(abs(largest.value) if largest is not None else 0.0)
        if run is None and largest is not None and largest.value and not largest.is_rounding:
            run = next(case for case in data.runs if case.name == (largest.governing or largest.similar)[0])
    return GoverningCase(run or data.runs[0], tuple(sizes))


def _iter_extremes(data: ReportData, names: list[str]) -> Iterator[Part]:
    """Yield the tables of the section forces and stresses: one for single cuts, one for series of cuts, which have
    places.
    """
    sections = data.runs[0].results.sections
    for has_places in (False, True):
        groups = [_make_group(data, name) for name in names if ("s" in sections[name]) == has_places]
        if groups:
            caption = SECTIONS.heading(data.runs[0].results, data.labels)
            table = make_cases_table(data, caption, groups, has_places=has_places)
            yield table._replace(fill="page") if table.fill == "half" else table


def _make_group(data: ReportData, name: str) -> LoadGroup:
    """Make the group of the numbers of one section."""
    paths = [(quantity, f"sections.{name}.{quantity}") for quantity in RESULTANTS]
    paths += [(quantity, f"sections.{name}.stress.{quantity}") for quantity in STRESSES]
    rows = [
        LoadNumber(quantity.replace("_", " "), path, DECIMALS_OF.get(quantity, "stress"), quantity in MAGNITUDES)
        for quantity, path in paths
        if any(True for _ in iter_run_extremes(data, path))
    ]
    return LoadGroup(describe_object("sections", name, data.labels), SECTIONS.note(name, data.labels), rows, name)


class SectionUtilisation(NamedTuple):
    """The largest stress of a section in one case, and the utilisation of the strength.

    uncertain_cases: those in which the stress is indeterminate or not known at some instant
    """

    name: str
    run: ReportedRun
    mises: CaseExtremes
    utilisation: CaseExtremes | None
    uncertain_cases: Sequence[str]

    @property
    def is_known(self) -> bool:
        """Whether its stress is known in all cases at all instants."""
        return not self.uncertain_cases


def _iter_stress_table(data: ReportData, names: list[str]) -> Iterator[Part]:
    """Yield the table of utilisation, if sections have properties."""
    entries = [entry for name in names for entry in _iter_utilisation(data, name)]
    if not entries:
        return
    # an indeterminate stress may be the largest
    all_known = all(entry_of_section.is_known for entry_of_section in entries)
    largest = max(map(_rank_entry, entries))
    pa, m = _choose_stress_family(data, entries).unit, data.units.find("m")[0]
    heads = [OutputColumn("section", "text"), *([OutputColumn("case", "text")] if data.has_cases else [])]
    heads += [OutputColumn(f"at s [{m}]"), *([OutputColumn("at t [s]")] if has_instants(data) else [])]
    heads += [OutputColumn(head) for head in (f"mises [{pa}]", f"strength [{pa}]", "utilisation")]
    rows = [
        _make_cells(data, entry_of_section, entries, is_largest=all_known and _rank_entry(entry_of_section) == largest)
        for entry_of_section in entries
    ]
    notes = (
        [UTIL_NOTE, SAFE_SIDE_NOTE, *[LARGEST_NOTE] * all_known]
        if any(entry_of_section.utilisation is not None for entry_of_section in entries)
        else [SAFE_SIDE_NOTE]
    )
    notes += [
        UNCERTAIN_NOTE.format(entry_of_section.name, _format_uncertain_cases(data, entry_of_section))
        for entry_of_section in entries
        if not entry_of_section.is_known
    ]
    yield OutputTable("STRESS  largest in each section", heads, rows, notes, "page")


def _make_cells(
    data: ReportData, entry: SectionUtilisation, entries: list[SectionUtilisation], *, is_largest: bool
) -> list[TextCell]:
    """Make the row of a section."""
    stress_family = _choose_stress_family(data, entries)
    utilisations = [each.utilisation for each in entries if each.utilisation is not None]
    extreme = (entry.utilisation or entry.mises).high
    written = stress_family.write(entry.mises.high.value)
    is_constant = extreme.place is None and stress_family.write(entry.mises.low.value) == written
    strength = entry.run.study.spec.sections[entry.name].strength
    per_si = stress_family.style.per_si
    return [
        TextCell(describe_object("sections", entry.name, data.labels)),
        *([TextCell(entry.run.case_label)] if data.has_cases else []),
        TextCell(format_place(extreme.place, data.units)),
        *([TextCell("" if is_constant else format_instant(extreme.time, entry.run))] if has_instants(data) else []),
        TextCell(written),
        TextCell(NO_STRENGTH if strength is None else f"{strength * per_si:.6g}"),
        TextCell(
            "" if entry.utilisation is None else choose_family(utilisations, data).write(entry.utilisation.high.value),
            is_largest and entry.utilisation is not None,
        ),
    ]


def _choose_stress_family(data: ReportData, entries: Sequence[SectionUtilisation]) -> Family:
    """Choose how the stresses of the table are written: in MPa, unless the user chose another unit."""
    family = choose_family([each.mises for each in entries], data)
    if data.units.is_chosen("Pa"):
        return family
    unit, per_si = data.units.find("Pa")
    shift = round(math.log10(family.style.per_si / per_si))
    return family._replace(
        style=family.style._replace(
            unit=unit,
            per_si=per_si,
            decimals=max(family.style.decimals + shift, 0),
            error=family.style.error * per_si / family.style.per_si,
        )
    )


def _format_uncertain_cases(data: ReportData, entry: SectionUtilisation) -> str:
    return (
        f" in case {join_names(entry.uncertain_cases)}"
        if data.has_cases
        else " at some times"
        if has_instants(data)
        else ""
    )


def _iter_utilisation(data: ReportData, name: str) -> Iterator[SectionUtilisation]:
    """Yield the case that governs the stress of a section, if it has stresses."""
    path = f"sections.{name}.stress"
    utilisations = {run.name: ends for run, ends in iter_run_extremes(data, f"{path}.utilisation")}
    uncertain_cases = find_uncertain_cases(data, f"{path}.mises")
    entries = [
        SectionUtilisation(name, run, ends, utilisations.get(run.name), uncertain_cases)
        for run, ends in iter_run_extremes(data, f"{path}.mises")
    ]
    if entries:
        yield max(entries, key=_rank_entry)


def _rank_entry(entry: SectionUtilisation) -> tuple[float, float]:
    """Return the numbers by which sections are compared: the utilisation, then the stress."""
    utilisation = entry.utilisation.high.value if entry.utilisation is not None else 0.0
    stress = entry.mises.high.value
    return (utilisation if isinstance(utilisation, float) else 0.0, stress if isinstance(stress, float) else 0.0)
