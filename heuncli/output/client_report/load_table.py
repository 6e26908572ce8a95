"""The tables of loads: of the foundation, of each joint and stop, in every case of the report."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.output.client_report.cases_table import make_cases_table
from heuncli.output.client_report.load_groups import TOTAL, drop_components, iter_groups
from heuncli.output.client_report.report_data import ReportData
from heuncli.output.documents.document import Part, Sentence
from heuncli.output.tables.extremes_tables import MAX_FULL_GROUPS
from heuncli.output.tables.table_blocks import describe_chosen_components
from heuncli.output.tables.table_plans import FOUNDATION, JOINTS, STOPS, TablePlan

NO_JOINTS_NOTE = "No joints, and no connection to the ground."
ONLY_IMPACTS_NOTE = "Only impulses are requested: see the impulses for the joints and the ground."
MAGNITUDES_NOTE = "{} {}: only magnitudes of vectors; components: heun run SPEC --format csv"


def make_load_parts(data: ReportData) -> list[Part]:
    """Make the tables of the foundation, the joints and the stops, or a sentence if there are none."""
    plans = (FOUNDATION, JOINTS, STOPS)
    tables = [part for plan in plans for part in _iter_table(data, plan)]
    return tables or [Sentence(NO_JOINTS_NOTE if not data.spec.joints else ONLY_IMPACTS_NOTE)]


def _iter_table(data: ReportData, plan: TablePlan) -> Iterator[Part]:
    """Yield the table of one kind of results, if the scene has it."""
    groups = list(iter_groups(data, plan))
    if not groups:
        return
    notes = list(dict.fromkeys(note for run in data.runs for note in describe_chosen_components(run.results)))
    if len(groups) > MAX_FULL_GROUPS:
        groups = [group if group.name == TOTAL else drop_components(group) for group in groups]
        notes.append(MAGNITUDES_NOTE.format(len(groups), f"{plan.what or 'support'}s"))
    yield make_cases_table(data, plan.heading(data.runs[0].results, data.labels), groups, notes)
