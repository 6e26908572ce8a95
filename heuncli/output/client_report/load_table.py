"""The tables of loads: foundation, joints, stops, couplings, forces, and points at their worst instants."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from heuncli.output.client_report.cases_table import make_cases_table
from heuncli.output.client_report.hardpoints import make_hardpoint_table
from heuncli.output.client_report.load_groups import TOTAL, LoadGroup, drop_components, iter_groups
from heuncli.output.client_report.report_data import ReportData
from heuncli.output.documents.document import OutputTable, Part, Sentence
from heuncli.output.tables.extremes_tables import MAX_FULL_GROUPS
from heuncli.output.tables.table_blocks import describe_chosen_components
from heuncli.output.tables.table_plans import COUPLINGS, FORCES, FOUNDATION, JOINTS, STOPS, TablePlan
from heuncli.scene.file_format.loads import Bushing

NO_JOINTS_NOTE = "No joints, and no connection to the ground."
ONLY_IMPACTS_NOTE = "Only impulses are requested: see the impulses for the joints and the ground."
MAGNITUDES_NOTE = "{} {}: only magnitudes of vectors; components: heun run SPEC --format csv"
SUPPORTS_NOTE = "supports on the ground: the reactions of their joints, with the opposite sign"


def make_load_parts(data: ReportData) -> list[Part]:
    """Make the tables of loads, or a sentence if there are none."""
    hardpoints = make_hardpoint_table(data)
    tables: list[Part] = [hardpoints] if hardpoints is not None else []
    tables += [part for plan in (FOUNDATION, JOINTS, STOPS, COUPLINGS, FORCES) for part in _iter_table(data, plan)]
    tables.sort(key=lambda table: isinstance(table, OutputTable) and table.fill == "half")
    tables = gather_notes(tables)
    if not any(data.runs[0].results.joints) and not data.spec.joints:
        return tables or [Sentence(NO_JOINTS_NOTE)]
    return tables or [Sentence(ONLY_IMPACTS_NOTE)]


def gather_notes(parts: Sequence[Part]) -> list[Part]:
    """Gather the notes that stand below several tables: once, below the last."""
    notes = [note for part in parts if isinstance(part, OutputTable) for note in part.notes]
    shared = [note for note in dict.fromkeys(notes) if notes.count(note) > 1]
    if not shared:
        return list(parts)
    own = [
        part._replace(notes=[note for note in part.notes if note not in shared])
        if isinstance(part, OutputTable)
        else part
        for part in parts
    ]
    return [*own, OutputTable("", notes=shared)]


def _iter_table(data: ReportData, plan: TablePlan) -> Iterator[Part]:
    """Yield the table of one kind of results, if the scene has it. What stands in another table is left out: supports
    of the foundation, components of bushings.
    """
    groups = list(iter_groups(data, plan))
    if not groups:
        return
    notes = []
    if plan.kind == "joints":
        notes = list(dict.fromkeys(note for run in data.runs for note in describe_chosen_components(run.results)))
    if plan is FOUNDATION:
        notes = [SUPPORTS_NOTE] if len(groups) > 1 else []
        groups = [group._replace(name="total") for group in groups if group.name == TOTAL]
    if plan is FORCES:
        groups = [_shorten_bushing(data, group) for group in groups]
    if len(groups) > MAX_FULL_GROUPS:
        groups = [drop_components(group) for group in groups]
        notes.append(MAGNITUDES_NOTE.format(len(groups), f"{plan.what or 'support'}s"))
    yield make_cases_table(data, plan.heading(data.runs[0].results, data.labels), groups, notes)


def _shorten_bushing(data: ReportData, group: LoadGroup) -> LoadGroup:
    """Drop the components of a bushing, which stand in the table of points."""
    return drop_components(group) if isinstance(data.spec.forces.get(group.key), Bushing) else group
