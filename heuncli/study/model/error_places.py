"""Where in the spec a scene that cannot be solved is at fault: the numeric part knows names, the spec knows places."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

from heuncli.base.errors import Problem, SolveError, SourceLocation
from heuncli.scene.file_format.models import Spec

NAMED = re.compile(r"\b(?:joints|bodies|drives|forces|stops|impulses|couplings|rolling|sections|analysis)\.\w+")
# what takes part in a blow is told by its bare name
ACTING = ("impulses", "stops", "latches", "joints", "drives", "couplings", "rolling")
WHERE = {"contacts-undecided": "stops"}  # where nothing at fault has a name
RUN = "analysis"  # what is asked for: where nothing else is at fault


@contextmanager
def placed(spec: Spec) -> Iterator[None]:
    """Give every problem of a SolveError from within the place in the spec of what it is about."""
    try:
        yield
    except SolveError as error:
        error.tell(*(problem._replace(location=location_of(problem, spec)) for problem in error.problems))
        raise


def location_of(problem: Problem, spec: Spec) -> SourceLocation:
    """Where the entry stands that a problem is about, or the first that its words name; else the analysis."""
    if problem.location is not None:
        return problem.location
    about = (problem.about, *(f"{block}.{problem.about}" for block in ACTING), WHERE.get(problem.code, ""))
    named = (*about, *NAMED.findall(f"{problem.message} {problem.hint}"), RUN)
    return spec.location(next((path for path in named if path in spec.locations), "bodies"))
