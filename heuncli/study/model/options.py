"""What a command asks beside the spec, and what of the spec it stands above."""

from __future__ import annotations

from heuncli.base.errors import Problem, SpecError
from heuncli.base.method_rows import canonical, row_of
from heuncli.base.records import record
from heuncli.results.results_schema import REPORTS, with_shared
from heuncli.scene.file_format.methods import unfit
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.memory_estimate import Room
from heuncli.study.model.selection import EntryKeys, Selection


@record
class Options:
    """What a command asks beside the spec; None leaves it to the spec.

    wanted: reports, None for all; entries: single ones of these, in place of the whole. axes: of joint loads.
    """

    tolerance: float | None = None
    method: str | None = None
    step: float | None = None  # of a method of fixed step [s]
    wanted: frozenset[str] | None = None
    entries: frozenset[EntryKeys] = frozenset()
    axes: str = "world"
    time_limit: float | None = None
    least_norm: bool = False
    reduce: bool = True  # whether less than the whole scene may be solved, where that changes nothing
    room: Room | None = None  # that results may take; None: as much as they want
    in_parts: bool = False  # whether results of many instants may stand in a file, as those can that are only exported
    load_seconds: float = 0.0  # what reading the spec took, for the block `work`

    @property
    def reports(self) -> frozenset[str]:
        """The reports that are asked for."""
        return frozenset(REPORTS) if self.wanted is None else with_shared(self.wanted)

    @property
    def asked(self) -> Selection:
        """What of the results is asked for."""
        return Selection(self.reports, self.entries, self.axes)


def as_asked(spec: Spec, options: Options) -> Spec:
    """The spec with the tolerance, method and step of the options; its own step goes with methods of fixed step alone.

    Raises SpecError where they do not go together.
    """
    given = spec.analysis
    method = given.method if options.method is None else options.method
    row = row_of(method)
    fixed = row is not None and row.steps == "fixed"
    step = options.step if options.step is not None or not (fixed or options.method is None) else given.step
    wrong = [Problem(one.code, one.message, hint=one.hint) for one in unfit(method, step, given.duration)]
    if wrong:
        raise SpecError(*wrong)
    given = given._replace(method=canonical(method), step=step)
    if options.tolerance is not None:
        given = given._replace(tolerance=options.tolerance, tolerance_given=True)
    return spec._replace(analysis=given)
