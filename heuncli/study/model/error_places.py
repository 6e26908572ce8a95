"""Find the entry of the spec that is at fault when a scene cannot be solved: the solver knows names, the spec knows
locations.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

from heuncli.base.errors import Problem, SolveError, SourceLocation
from heuncli.scene.file_format.models import Spec

ENTRY_PATH = re.compile(r"\b(?:joints|bodies|drives|forces|stops|impulses|couplings|rolling|sections|analysis)\.\w+")
# problems with impulses give the bare name of an entry
IMPULSE_BLOCKS = ("impulses", "stops", "latches", "joints", "drives", "couplings", "rolling")
BLOCK_BY_CODE = {"contacts-undecided": "stops"}  # for problems that name no entry
FALLBACK = "analysis"  # the location of problems without any other


@contextmanager
def attach_locations(spec: Spec) -> Iterator[None]:
    """Add to every problem of a SolveError raised within the context its location in the spec."""
    try:
        yield
    except SolveError as error:
        error.replace_problems(*(problem._replace(location=find_location(problem, spec)) for problem in error.problems))
        raise


def find_location(problem: Problem, spec: Spec) -> SourceLocation:
    """Return the location of the entry that a problem is about, or of the first that its text names, or of the
    analysis.
    """
    if problem.location is not None:
        return problem.location
    candidates = (
        problem.entry_path,
        *(f"{block}.{problem.entry_path}" for block in IMPULSE_BLOCKS),
        BLOCK_BY_CODE.get(problem.code, ""),
    )
    paths = (*candidates, *ENTRY_PATH.findall(f"{problem.message} {problem.hint}"), FALLBACK)
    return spec.location(next((path for path in paths if path in spec.locations), "bodies"))
