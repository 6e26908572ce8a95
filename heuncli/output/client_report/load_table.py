"""The tables of loads: of the foundation, of each joint and stop, in every case that is reported."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.output.client_report.cases_table import cases_table
from heuncli.output.client_report.load_groups import TOTAL, groups_of, without_components
from heuncli.output.client_report.parts import Part, Sentence
from heuncli.output.client_report.reported import Reported
from heuncli.output.tables.extremes_tables import MANY
from heuncli.output.tables.table_blocks import chosen_components
from heuncli.output.tables.table_plans import FOUNDATION, JOINTS, STOPS, TablePlan

UNHELD = "There are no joints, and nothing stands on the ground."
OF_BLOWS = "The scene is struck and nothing else is asked for: see the blows for its joints and the ground."
TOO_MANY = "{} {}: of vectors the magnitudes alone; heun run SPEC --format csv has the components"


def load_tables(of: Reported) -> list[Part]:
    """The tables of the foundation, the joints, the stops and the applied loads."""
    plans = (FOUNDATION, JOINTS, STOPS)
    found = [part for plan in plans for part in _table(of, plan)]
    return found or [Sentence(UNHELD if not of.spec.joints else OF_BLOWS)]


def _table(of: Reported, plan: TablePlan) -> Iterator[Part]:
    """The table of one kind of results, if the scene has it."""
    groups = list(groups_of(of, plan))
    if not groups:
        return
    notes = list(dict.fromkeys(note for run in of.runs for note in chosen_components(run.results)))
    if len(groups) > MANY:
        groups = [group if group.name == TOTAL else without_components(group) for group in groups]
        notes.append(TOO_MANY.format(len(groups), f"{plan.what or 'support'}s"))
    yield cases_table(of, plan.heading(of.runs[0].results, of.labels), groups, notes)
