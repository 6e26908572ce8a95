"""Rules about the method of integration: each code is one of scene/file_format/methods.py."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base.method_rows import SMOOTH_ONLY, row_of
from heuncli.scene.expressions.discontinuities import jumps
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format.format import CurveJoint, RodJoint
from heuncli.scene.file_format.format_couplings import RopeEntry
from heuncli.scene.file_format.methods import unfit
from heuncli.scene.file_format.rules.conditions import conditions
from heuncli.scene.file_format.rules.joints import drives
from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule
from heuncli.scene.file_format.semantics import span_of, type_of


def among(draft: DraftDocument, code: str) -> Iterator[Violation]:
    """What speaks against the method and the step, of one code; not that one is missing which could not be read."""
    if "analysis" in draft.unread and code == "fixed-step":
        return
    analysis = draft.document.analysis
    last = analysis.duration if analysis.times is None else max(analysis.times, default=None)
    for one in unfit(analysis.method, analysis.step, last):
        if one.code == code:
            yield Violation(("analysis", one.key), one.message, one.hint)


@rule("unknown-method")
def unknown_method(draft: DraftDocument) -> Iterator[Violation]:
    """The method is one that `heun methods` lists."""
    yield from among(draft, "unknown-method")


@rule("fixed-step")
def fixed_step(draft: DraftDocument) -> Iterator[Violation]:
    """A method of fixed step has one, no other has."""
    yield from among(draft, "fixed-step")


@rule("step")
def step(draft: DraftDocument) -> Iterator[Violation]:
    """A step is positive, no longer than the run, and not so short that it needs too many."""
    yield from among(draft, "step")


@rule("method-scene")
def method_scene(draft: DraftDocument) -> Iterator[Violation]:
    """SciPy's methods run what is smooth: what strikes, ends or jumps by the state is refused by name."""
    row = row_of(draft.document.analysis.method)
    if row is None or row.kind != "SciPy" or type_of(draft.document) != "motion":
        return
    for path, what in not_smooth(draft):
        yield Violation(path, f"{row.name} does not run {what}", SMOOTH_ONLY, key=True)


def not_smooth(draft: DraftDocument) -> Iterator[tuple[Path_, str]]:
    """Stops, ropes, blows, conditions in time and state, drives whose rates jump, loads that jump with a coordinate."""
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
    for path, given in conditions(draft):
        if isinstance(given, Expression):
            yield path, f"the condition {path[-1]}"
    end = span_of(document.analysis)
    for name, _, driven in drives(draft):
        if jumps(driven.value, end, order=0 if driven.by_rate else 1):
            yield ("drives", name), f"the drive {name}, whose rate jumps"
    for block, entries in (("drives", document.drives), ("forces", document.forces)):
        for name, entry in entries.items():
            for field, value in vars(entry).items():
                for part in value if isinstance(value, tuple) else (value,):
                    if isinstance(part, Expression) and part.uses and part.held:
                        source = part.source.strip()
                        yield (block, name, field), f"'{source}', which jumps or bends with a coordinate"
