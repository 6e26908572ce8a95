"""The options of one command beside the spec, and how they override it."""

from __future__ import annotations

from heuncli.base.errors import Problem, SpecError
from heuncli.base.method_rows import canonical_name, find_method
from heuncli.base.records import record
from heuncli.results.results_schema import REPORTS, add_shared_reports
from heuncli.scene.file_format.methods import iter_method_problems
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.memory_estimate import MemoryBudget
from heuncli.study.model.selection import EntryKeys, Selection


@record
class Options:
    """Options of one command; None leaves the choice to the spec.

    requested_reports: names of reports, None for all
    entries: single entries of reports, in place of whole ones
    axes: of joint loads
    """

    tolerance: float | None = None
    method: str | None = None
    step: float | None = None  # of a method of fixed step [s]
    requested_reports: frozenset[str] | None = None
    entries: frozenset[EntryKeys] = frozenset()
    axes: str = "world"
    time_limit: float | None = None
    least_norm: bool = False
    reduce: bool = True  # whether a smaller scene may be solved where the results are the same
    memory_budget: MemoryBudget | None = None  # for the results; None: no limit
    in_parts: bool = False  # whether results of many instants may be kept in a file; possible if they are only exported
    load_seconds: float = 0.0  # time for reading the spec, for the block `work`

    @property
    def reports(self) -> frozenset[str]:
        """The reports that are composed."""
        return frozenset(REPORTS) if self.requested_reports is None else add_shared_reports(self.requested_reports)

    @property
    def selection(self) -> Selection:
        """The part of the results that is requested."""
        return Selection(self.reports, self.entries, self.axes)


def apply_options(spec: Spec, options: Options) -> Spec:
    """Return the spec with the tolerance, method and step of the options. The spec's own step is kept only for methods
    of fixed step.

    Raises SpecError where they do not go together.
    """
    analysis = spec.analysis
    method = analysis.method if options.method is None else options.method
    row = find_method(method)
    is_fixed = row is not None and row.steps == "fixed"
    step = options.step if options.step is not None or not (is_fixed or options.method is None) else analysis.step
    problems = [
        Problem(one.code, one.message, hint=one.hint) for one in iter_method_problems(method, step, analysis.duration)
    ]
    if problems:
        raise SpecError(*problems)
    analysis = analysis._replace(method=canonical_name(method), step=step)
    if options.tolerance is not None:
        analysis = analysis._replace(tolerance=options.tolerance, tolerance_given=True)
    return spec._replace(analysis=analysis)
