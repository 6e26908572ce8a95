"""Rules about the integration method; their codes are those of scene/file_format/methods.py."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base.method_rows import SMOOTH_ONLY, find_method
from heuncli.scene.expressions.discontinuities import find_jumps
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format.format import CurveJoint, RodJoint
from heuncli.scene.file_format.format_couplings import RopeEntry
from heuncli.scene.file_format.methods import iter_method_problems
from heuncli.scene.file_format.rules.conditions import iter_conditions
from heuncli.scene.file_format.rules.joints import iter_drives
from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule
from heuncli.scene.file_format.semantics import find_analysis_type, run_duration


def iter_problems_of_code(draft: DraftDocument, code: str) -> Iterator[Violation]:
    """Yield the problems of method and step with one code; no missing step if the analysis could not be read."""
    if "analysis" in draft.unread and code == "fixed-step":
        return
    analysis = draft.document.analysis
    end_time = analysis.duration if analysis.times is None else max(analysis.times, default=None)
    for problem in iter_method_problems(analysis.method, analysis.step, end_time):
        if problem.code == code:
            yield Violation(("analysis", problem.key), problem.message, problem.hint)


@rule("unknown-method")
def check_unknown_method(draft: DraftDocument) -> Iterator[Violation]:
    """The method is one that `heun methods` lists."""
    yield from iter_problems_of_code(draft, "unknown-method")


@rule("fixed-step")
def check_fixed_step(draft: DraftDocument) -> Iterator[Violation]:
    """A method of fixed step has a step, no other method has one."""
    yield from iter_problems_of_code(draft, "fixed-step")


@rule("step")
def check_step(draft: DraftDocument) -> Iterator[Violation]:
    """A step is positive, no longer than the run, and not so short that it needs too many."""
    yield from iter_problems_of_code(draft, "step")


@rule("method-scene")
def check_smooth_for_scipy(draft: DraftDocument) -> Iterator[Violation]:
    """SciPy's methods need a smooth motion: impacts, ends and jumps that depend on the state are refused by name."""
    row = find_method(draft.document.analysis.method)
    if row is None or row.kind != "SciPy" or find_analysis_type(draft.document) != "motion":
        return
    for path, obstacle in iter_nonsmooth_parts(draft):
        yield Violation(path, f"{row.name} cannot handle {obstacle}", SMOOTH_ONLY, key=True)


def iter_nonsmooth_parts(draft: DraftDocument) -> Iterator[tuple[Path_, str]]:
    """Yield what makes a motion non-smooth: stops, ropes, impulses, conditions, drives with jumping rates, loads that
    jump with a coordinate.
    """
    document = draft.document
    for name in document.stops:
        yield ("stops", name), f"the stop {name}"
    for name in document.latches:
        yield ("latches", name), f"the latch {name}"
    for name, joint in document.joints.items():
        if isinstance(joint, RodJoint) and joint.tension_only:
            yield ("joints", name), f"the rope {name}, which may go slack"
        if isinstance(joint, CurveJoint) and joint.one_sided:
            yield ("joints", name), f"the curve {name}, which may lift off"
    for name, coupling in document.couplings.items():
        if isinstance(coupling, RopeEntry) and coupling.tension_only:
            yield ("couplings", name), f"the rope {name}, which may go slack"
    for name in document.impulses:
        yield ("impulses", name), f"the impulse {name}"
    for path, condition in iter_conditions(draft):
        if isinstance(condition, Expression):
            yield path, f"the condition {path[-1]}"
    end = run_duration(document.analysis)
    for name, _, driven in iter_drives(draft):
        if find_jumps(driven.value, end, order=0 if driven.by_rate else 1):
            yield ("drives", name), f"the drive {name}, whose rate jumps"
    for block, entries in (("drives", document.drives), ("forces", document.forces)):
        for name, entry in entries.items():
            for field, value in vars(entry).items():
                for expression in value if isinstance(value, tuple) else (value,):
                    if isinstance(expression, Expression) and expression.uses and expression.held_branches:
                        source = expression.source.strip()
                        yield (block, name, field), f"'{source}', which jumps or bends with a coordinate"
