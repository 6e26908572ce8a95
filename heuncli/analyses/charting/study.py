"""Speed against accuracy: methods at several tolerances, or steps, on a scene's own motion.

Each run is held against a reference that is itself checked. Impure: looks at the clock.
"""

from __future__ import annotations

import time

from heuncli.analyses.charting.motion import motion_of
from heuncli.analyses.charting.plan import ChartOptions, plan
from heuncli.analyses.charting.reference import refer
from heuncli.analyses.charting.results import ChartResults, with_front
from heuncli.analyses.charting.runs import ChartRuns, Tell
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.error_places import placed

DRIVEN = (
    "the drives leave no freedom: heun run solves every instant by itself (followed) and integrates nothing; the other "
    "rows are what integrating it would take"
)


def chart(spec: Spec, wanted: ChartOptions, tell: Tell = lambda done, of, what: None) -> ChartResults:
    """The chart of a spec. Raises SpecError, SolveError, LimitError where there is none."""
    with placed(spec):
        return charted(spec, wanted, tell)


def charted(spec: Spec, wanted: ChartOptions, tell: Tell) -> ChartResults:
    """The chart of a spec. Errors name bodies, joints and sections, but not where these stand in the file."""
    deadline = None if wanted.time_limit is None else time.monotonic() + wanted.time_limit
    motion = motion_of(spec, deadline)
    rows = plan(motion, wanted)
    tell(0, 1, "reference")
    referred = refer(motion)
    runs = ChartRuns(motion, referred, tell).all(rows.rows)
    return ChartResults(
        title=spec.title,
        spec={"path": spec.path, "sha256": spec.sha256},
        reference=referred.reference,
        runs=with_front(runs),
        size=motion.setup.scene.layout.size,
        notes=(*([DRIVEN] if motion.determined else []), *rows.notes),
    )
