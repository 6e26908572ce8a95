"""Speed against accuracy: run several methods at several tolerances, or steps, on a scene's own motion.

Each run is compared with a reference that is itself verified. Impure: reads the clock.
"""

from __future__ import annotations

import time

from heuncli.analyses.work_precision.motion import make_motion
from heuncli.analyses.work_precision.plan import ChartOptions, plan_chart
from heuncli.analyses.work_precision.reference import find_reference
from heuncli.analyses.work_precision.results import ChartResults, mark_front
from heuncli.analyses.work_precision.runs import ChartRunner, ReportProgress
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.setup import attach_locations

DRIVEN_NOTE = (
    "motion fully prescribed: heun run solves each instant (followed), nothing integrated; the other "
    "rows show what integrating it would cost"
)


def chart(
    spec: Spec, options: ChartOptions, report_progress: ReportProgress = lambda done, of, what: None
) -> ChartResults:
    """Return the chart of a spec. Raises SpecError, SolveError, LimitError if there is none."""
    with attach_locations(spec):
        return make_chart(spec, options, report_progress)


def make_chart(spec: Spec, options: ChartOptions, report_progress: ReportProgress) -> ChartResults:
    """Return the chart of a spec. Errors name bodies, joints and sections, but not their location in the file."""
    deadline = None if options.time_limit is None else time.monotonic() + options.time_limit
    motion = make_motion(spec, deadline)
    chart_plan = plan_chart(motion, options)
    report_progress(0, 1, "reference")
    verified = find_reference(motion)
    runs = ChartRunner(motion, verified, report_progress).run_all(chart_plan.rows)
    return ChartResults(
        title=spec.title,
        spec={"path": spec.path, "sha256": spec.sha256},
        reference=verified.reference,
        runs=mark_front(runs),
        size=motion.setup.scene.layout.size,
        notes=(*([DRIVEN_NOTE] if motion.is_determined else []), *chart_plan.notes),
    )
