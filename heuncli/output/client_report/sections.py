"""The sections: their diagrams, their extremes with places, and how much of the strength they use."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.client_report.cases_table import cases_table, timed
from heuncli.output.client_report.extremes import (
    Ends,
    governing,
    instant_text,
    is_steady,
    lacking,
    place_text,
    runs_in,
    style_of,
    text_of,
)
from heuncli.output.client_report.load_groups import LoadGroup, LoadNumber
from heuncli.output.client_report.parts import Drawing, Part, ReportCell, ReportTable, Sentence, some
from heuncli.output.client_report.reported import Reported, ReportedRun
from heuncli.output.figures.courses import Pictured, is_claimed
from heuncli.output.figures.diagrams import diagrams
from heuncli.output.tables.table_blocks import FAMILIES
from heuncli.output.tables.table_plans import SECTIONS
from heuncli.output.tables.text_table import TextColumn
from heuncli.results.results_schema import MAGNITUDES, RESULTANTS, STRESSES
from heuncli.study.quantities.digits import rough

SHARE = "utilisation: the largest von Mises stress (mises) over the strength given; above 1 the section is overloaded"
SAFE = "stresses are on the safe side where the shape of a section is not known"
LACKING = "{}: open or not known{}, and may be larger there"
MOST_USED = "bold: the section that is used most"
FIRST = ("stress.utilisation", "stress.mises", "M1", "M2", "N", "Q1", "Q2", "T")  # what governs a section
MOST_DIAGRAMS = 12
NO_STRENGTH = "not given"


def section_parts(of: Reported) -> list[Part]:
    """All that is told of the sections."""
    names = list(of.runs[0].results.sections)
    return [*_stress(of, names), *_diagrams(of, names), *_extremes(of, names)] if names else []


def _diagrams(of: Reported, names: list[str]) -> Iterator[Part]:
    """A figure for each run of cuts, of the case that governs it; of many for those that are used most."""
    runs = [name for name in names if "s" in of.runs[0].results.sections[name]]
    governs = {name: _governing(of, name) for name in runs}
    most = sorted(runs, key=lambda name: governs[name].size, reverse=True)[:MOST_DIAGRAMS]
    for name in (name for name in runs if name in most):
        run = governs[name].run
        if not is_claimed(run.study):
            yield Sentence(f"{name} has no diagram: all instants of the run are beyond its horizon.")
            continue
        figure = diagrams([Pictured("", run.study)], [name], of.units)._replace(title="")
        case = f", load case {run.name}" if run.name else ""
        yield Drawing(
            figure,
            f"Section {name}{case}{_unclear(of, name)}: the piece beyond the cut ON the part before it; N > 0 tension",
        )
    if len(runs) > len(most):
        yield Sentence(f"{len(runs) - len(most)} more sections are not drawn here: heun plot SPEC sections.NAME")


def _unclear(of: Reported, name: str) -> str:
    """In which cases loads of a section are open, so that these may govern after all."""
    lacks = [lacking(of, f"sections.{name}.{quantity}") for quantity in RESULTANTS]
    cases = [run.told for run in of.runs if any(run.told in own for own in lacks)]
    return f" (some loads are open in {some(cases)}, which may govern)" if cases and of.has_cases else ""


class GoverningCase(NamedTuple):
    """The case that governs a section; size: by what sections are compared, what comes first counting more."""

    run: ReportedRun
    size: tuple[float, ...]


def _governing(of: Reported, name: str) -> GoverningCase:
    """The case with the largest stress in a section, without stresses with the largest bending or force."""
    governs = governing(of)
    run, sizes = None, list[float]()
    for path in (f"sections.{name}.{quantity}" for quantity in FIRST):
        bounds = [bound for bound in (governs.low(path), governs.high(path)) if bound is not None]
        largest = max(bounds, key=lambda bound: abs(bound.value), default=None)
        sizes.append(abs(largest.value) if largest is not None else 0.0)
        if run is None and largest is not None and largest.value and not largest.is_rounding:
            run = next(one for one in of.runs if one.name == (largest.governing or largest.alike)[0])
    return GoverningCase(run or of.runs[0], tuple(sizes))


def _extremes(of: Reported, names: list[str]) -> Iterator[Part]:
    """The loads and stresses of all sections, single cuts apart from runs of cuts, which have places."""
    sections = of.runs[0].results.sections
    for along in (False, True):
        groups = [_group(of, name) for name in names if ("s" in sections[name]) == along]
        if groups:
            caption = SECTIONS.heading(of.runs[0].results, of.labels)
            yield cases_table(of, caption, groups, along=along)


def _group(of: Reported, name: str) -> LoadGroup:
    """The numbers of one section."""
    own = [(quantity, f"sections.{name}.{quantity}") for quantity in RESULTANTS]
    own += [(quantity, f"sections.{name}.stress.{quantity}") for quantity in STRESSES]
    rows = [
        LoadNumber(quantity.replace("_", " "), path, FAMILIES.get(quantity, "stress"), quantity in MAGNITUDES)
        for quantity, path in own
        if any(True for _ in runs_in(of, path))
    ]
    return LoadGroup(name, SECTIONS.note(name, of.labels), rows)


class UsedSection(NamedTuple):
    """The largest stress of a section in one case, and what share of the strength that is."""

    name: str
    run: ReportedRun
    mises: Ends
    used: Ends | None
    lacks: Sequence[str]

    @property
    def whole(self) -> bool:
        """Whether its stress is known in all cases, at all instants."""
        return not self.lacks


def _stress(of: Reported, names: list[str]) -> Iterator[Part]:
    """The table of utilisation, where sections have properties."""
    found = [used for name in names for used in _used(of, name)]
    if not found:
        return
    certain = all(one.whole for one in found)  # what is open may be larger
    most = max(map(_size, found))
    pa, m = of.units.of("Pa")[0], of.units.of("m")[0]
    heads = [TextColumn("section", "left"), *([TextColumn("case", "left")] if of.has_cases else [])]
    heads += [TextColumn(f"at s [{m}]"), *([TextColumn("at t [s]")] if timed(of) else [])]
    heads += [TextColumn(head) for head in (f"mises [{pa}]", f"± [{pa}]", f"strength [{pa}]", "utilisation")]
    rows = [_cells(of, one, found, most=certain and _size(one) == most) for one in found]
    notes = [SHARE, SAFE, *[MOST_USED] * certain] if any(one.used is not None for one in found) else [SAFE]
    notes += [LACKING.format(one.name, _where(of, one)) for one in found if not one.whole]
    yield ReportTable("STRESS  the largest of each section", heads, rows, notes)


def _cells(of: Reported, one: UsedSection, found: list[UsedSection], *, most: bool) -> list[ReportCell]:
    """The line of a section."""
    size = of.units.of("Pa")[1]
    how = style_of([each.mises for each in found], of, size)
    shares = style_of([each.used for each in found if each.used is not None], of, 1.0)
    end = (one.used or one.mises).high
    steady = end.place is None and is_steady(one.mises, how, size)
    strength = one.run.study.spec.sections[one.name].strength
    return [
        ReportCell(one.name),
        *([ReportCell(one.run.told)] if of.has_cases else []),
        ReportCell(place_text(end.place, of.units, named=False)),
        *([ReportCell("" if steady else instant_text(end.at, one.run))] if timed(of) else []),
        ReportCell(text_of(one.mises.high.value, how, size)),
        ReportCell(rough(one.mises.error * size) if isinstance(one.mises.high.value, float) else ""),
        ReportCell(NO_STRENGTH if strength is None else f"{strength * size:.6g}"),
        ReportCell(
            "" if one.used is None else text_of(one.used.high.value, shares, 1.0), most and one.used is not None
        ),
    ]


def _where(of: Reported, one: UsedSection) -> str:
    return f" in case {some(one.lacks)}" if of.has_cases else " at some instants" if timed(of) else ""


def _used(of: Reported, name: str) -> Iterator[UsedSection]:
    """Of a section the case that governs its stress."""
    path = f"sections.{name}.stress"
    shares = {run.name: ends for run, ends in runs_in(of, f"{path}.utilisation")}
    lacks = lacking(of, f"{path}.mises")
    found = [UsedSection(name, run, ends, shares.get(run.name), lacks) for run, ends in runs_in(of, f"{path}.mises")]
    if found:
        yield max(found, key=_size)


def _size(one: UsedSection) -> tuple[float, float]:
    """By what sections are compared: by their utilisation, those without a strength by their stress."""
    used = one.used.high.value if one.used is not None else 0.0
    stress = one.mises.high.value
    return (used if isinstance(used, float) else 0.0, stress if isinstance(stress, float) else 0.0)
