"""Find the instant at which a machine is drawn if none is given: that of the greatest joint force."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base.load_kinds import LOAD_KINDS
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.axes import format_short
from heuncli.output.figures.curves import choose_number_style
from heuncli.output.figures.posed_machine import PosedMachine
from heuncli.output.summary.summary_rows import SummaryRow
from heuncli.results.results import Results
from heuncli.results.results_paths import find_values
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.channels import Channel, make_path_channel
from heuncli.study.quantities.labels import make_labels
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.measure_uncertainty import find_search_error
from heuncli.study.queries.study import Study
from heuncli.study.search.columns import ChannelSearch

TIME_DIGITS = 4
WORST_WORDS = {"joints": "joint", "forces": "bushing"}


class WorstInstant(NamedTuple):
    """The instant [s] of the greatest force, and what transmits it.

    kind, name: joints and a joint, or forces and a bushing in a scene without joints; empty if no force is known, and
    then the instant is the first of the run
    force: its magnitude [N]
    """

    time: float
    kind: str = ""
    name: str = ""
    force: float = 0.0


def select_worst(rows: Sequence[SummaryRow]) -> SummaryRow | None:
    """Select the row of a summary with the greatest joint force; without joints, that of the greatest load between
    bodies or of the foundation. None if no force is known.
    """
    forces = [row for row in rows if row.unit == "N" and not row.is_given and row.kind != "section"]
    joints = [row for row in forces if row.path.startswith("joints.") and row.kind == "joint"]
    return max(joints or forces, key=lambda row: abs(row.value), default=None)


def find_worst_instant(study: Study) -> WorstInstant:
    """Find the greatest joint force of a run before its horizon, between the samples too; without joints, the greatest
    force of a bushing.
    """
    spec, first = study.spec, float(study.results.time[0])
    bushings = [name for name, force in spec.forces.items() if LOAD_KINDS[force.type].place == "bodies"]
    kind, names = ("joints", list(spec.joints)) if spec.joints else ("forces", bushings)
    if study.has_one_instant or not names:
        return WorstInstant(first)

    def collect(results: Results) -> list[Channel]:
        if names[0] not in getattr(results, kind):  # the run was asked for other reports
            results = study.compute_reports(results.time, frozenset({kind}))
        return [make_path_channel(find_values(results, f"{kind}.{name}.force")) for name in names]

    error = find_search_error(study, (kind, names[0], "force"))
    search = ChannelSearch(collect, lambda channel: error if math.isfinite(error) else math.nan, (1.0,))
    bounds = study.search_extremes(search, frozenset({kind}))
    forces = np.nan_to_num(np.asarray(bounds.high), nan=-math.inf)
    k = int(np.argmax(forces))
    if not forces[k] > 0.0:
        return WorstInstant(first)
    return WorstInstant(float(bounds.high_at[k]), kind, names[k], float(forces[k]))


def describe_instants(posed_machine: PosedMachine, worst: WorstInstant | None, units: Units) -> str:
    """Describe the instants and the view; worst: the instant of the greatest joint force, if that is known."""
    times = posed_machine.poses.times.tolist()
    text = f"t = {format_short(times[0], TIME_DIGITS)} s"
    if worst is not None and worst.name and worst.time == times[0]:
        style = choose_number_style("N", worst.force, units)
        name = describe_object(worst.kind, worst.name, make_labels(posed_machine.spec))
        text += (
            f", worst instant: greatest {WORST_WORDS[worst.kind]} force, {name} {style.write(worst.force)} {style.unit}"
        )
    if len(times) > 1:
        text += f"; pale: t = {', '.join(format_short(t, TIME_DIGITS) for t in times[1:])} s"
    return f"{text}; seen from {posed_machine.view.description}"
