"""`--measure`: single numbers of a run, such as `max abs sections.middle.M1` or `at 0.5 energy.kinetic`.

asked_by: what asked for them, as it is called in messages.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from itertools import pairwise
from typing import Any, TypeVar

from heuncli.base.errors import Finding, Problem, SpecError, UsageError
from heuncli.output.tables.export import dump
from heuncli.results.results_paths import find
from heuncli.results.run_places import marked, words_of
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import names_in
from heuncli.scene.file_format.rules.outcome import wrong_path
from heuncli.study.ask.asked_values import all_or_errors
from heuncli.study.ask.measure import NOT_CLAIMED, MeasureRequest, NotOneNumber, Peak, lost_from, value
from heuncli.study.ask.smoothed_friction import friction_warning
from heuncli.study.ask.study import Study
from heuncli.study.compose.smoothed_friction import has_smoothed_friction
from heuncli.study.quantities.digits import OPEN, UNKNOWN

T = TypeVar("T")
PATH = re.compile(r"[\w.]+(?:[@:][\w.:+-]*)*\Z")
OTHER_WORDS = {
    "last": "final", "end": "final", "start": "first", "initial": "first", "maximum": "max", "largest": "max",
    "highest": "max", "minimum": "min", "least": "min", "lowest": "min", "maxabs": "max abs", "peak": "max abs",
    "amplitude": "max abs", "t": "at",
}  # fmt: skip

FORMS = "expected [max | min | max abs | first | final | at T] PATH"
SUCH = "such as {} 'max abs sections.middle.M1'"


def parse(text: str, asked_by: str = "--measure") -> MeasureRequest:
    """The MeasureRequest that the words mean. Raises UsageError."""
    words = text.split()
    match words if words and PATH.match(words[-1]) else []:
        case [path] if path not in ("max", "min", "abs", "first", "final", "at"):
            return MeasureRequest("", path)
        case ["max" | "min" | "abs" | "first" | "final" as how, path]:
            return MeasureRequest(how, path)
        case ["max", "abs", path]:
            return MeasureRequest("abs", path)
        case ["at", t, path] if _is_number(t):
            return MeasureRequest("at", path, float(t))
    raise UsageError(Problem("bad-option", f"{asked_by} '{text}': {FORMS}", hint=meant(text, asked_by)))


def meant(text: str, asked_by: str = "--measure") -> str:
    """A hint: the words in the order and spelling in which they are read, where that makes them a form."""
    if "," in text:
        return f"one number each: {asked_by} may be repeated"
    plain = re.sub(r"\[(\d+)\]", r".\1", text)
    words = [OTHER_WORDS.get(word.lower(), word) for word in re.split(r"[\s()|]+", plain) if word]
    words.sort(key=lambda word: "." in word and not _is_number(word))
    proposed = " ".join(words)
    if proposed == text or "," in proposed:
        return SUCH.format(asked_by)
    try:
        parse(proposed)
    except UsageError:
        return SUCH.format(asked_by)
    return f"did you mean '{proposed}'?"


def parse_all(texts: Sequence[str]) -> list[MeasureRequest]:
    """The Measures that several mean. Raises UsageError with all that mean none."""
    return all_or_errors([partial(parse, text) for text in texts])


def check(several: Sequence[MeasureRequest], spec: Spec, asked_by: str = "--measure") -> None:
    """Whether their paths lead anywhere, as far as that is seen before the run. Raises SpecError [unknown-path]."""
    names = names_in(spec)
    runs = {name: section.from_ is not None for name, section in spec.sections.items()}
    wrong = [found for asked in several if (found := wrong_path(asked.path, names, runs)) is not None]
    wrong += [found for asked in several if (found := wrong_place(asked.path, spec)) is not None]
    if wrong:
        raise SpecError(*(Problem("unknown-path", f"{asked_by}: {what}", hint=hint) for what, hint in wrong))


def known(
    several: Sequence[MeasureRequest], spec: Spec, others: Iterable[Callable[[], T]], asked_by: str = "--measure"
) -> list[T]:
    """What the others give, beside measures that are checked. Raises with all that is wrong with any of them."""
    calls: tuple[Callable[[], Any], ...] = (partial(check, several, spec, asked_by), *others)
    _, *given = all_or_errors(calls)
    return given


def wrong_place(path: str, spec: Spec) -> tuple[str, str] | None:
    """What is wrong with the place along a run of cuts that a path names by its distance, and a hint."""
    words = words_of(path)
    place = marked(words)
    name = next((after for word, after in pairwise(words) if word == "sections"), "")
    section = spec.sections.get(name)
    if place is None or section is None or section.from_ is None or section.to is None:
        return None
    from heuncli.results.cut_rows import asked_distances, rows_at

    try:
        rows_at(place, asked_distances(section.from_, section.to, section.count), None)
    except Finding as finding:
        return f"'{path}': {finding.message}", finding.hint
    return None


def write(several: Sequence[MeasureRequest], study: Study, form: str) -> str:
    """Each number as text, all its digits, on a line; as JSON with its instant, several in a list.

    What is not known beyond the horizon is `?`.
    """
    if form == "json":
        blocks = all_or_errors([partial(block, asked, study) for asked in several])
        return dump(blocks[0] if len(blocks) == 1 else blocks)
    return "".join(all_or_errors([partial(line, asked, study) for asked in several]))


def line(asked: MeasureRequest, study: Study) -> str:
    """One number as text."""
    peak, horizon = measured(asked, study)
    if horizon is not None:
        return f"{UNKNOWN}\n"
    if math.isnan(peak.value):
        return f"{UNKNOWN if peak.at in study.unknown else OPEN}\n"
    return f"{peak.value!r}\n"


def block(asked: MeasureRequest, study: Study) -> dict[str, Any]:
    """One number for JSON."""
    return described(asked, study, *measured(asked, study))


def described(asked: MeasureRequest, study: Study, peak: Peak, horizon: float | None) -> dict[str, Any]:
    """A number as it was `measured`, for JSON: with its instant, and along a run of cuts its place."""
    found: dict[str, Any] = {"measure": f"{asked.how} {asked.path}".strip(), "value": peak.value, "at": peak.at}
    if horizon is None and (note := friction_warning(study, asked.path, peak.at)) is not None:
        found["notes"] = [note]
    if "axes" in study.results.model and "joints." in asked.path:
        found["axes"] = study.results.model["axes"]
    if horizon is not None:
        return found | {"value": None, "at": None, "horizon": horizon}
    if peak.place is not None and not math.isnan(peak.value):
        found |= peak.place._asdict()
        if peak.place.cut is not None:
            found["cut"] = number_of_cut(asked, study, peak.place.cut)
    return found


def number_of_cut(asked: MeasureRequest, study: Study, row: int) -> int:
    """The number of an asked cut, by which paths name it; row: in the results, which may have two of one cut."""
    from heuncli.results.cut_rows import cut_numbers  # where there are runs of cuts

    keys = find(study.results, asked.path).keys
    s = next(cuts.s for cuts in study.setup.cuts if cuts.name == keys[keys.index("sections") + 1])
    assert s is not None
    return int(cut_numbers(s)[row])


def measured(asked: MeasureRequest, study: Study, asked_by: str = "--measure") -> tuple[Peak, float | None]:
    """The number, and the horizon where it lies beyond. Raises UsageError."""
    try:
        return value(asked, study), lost_from(asked, study)
    except NotOneNumber as error:
        (problem,) = error.problems
        raise UsageError(problem._replace(message=f"{asked_by}: {problem.message}")) from None


def warnings(several: Sequence[MeasureRequest], study: Study) -> list[str]:
    """Why there is `?` in place of some numbers, and which stand where friction is not at its value."""
    lost = [(asked.path, lost_from(asked, study)) for asked in several]
    told = [f"{path} is not known: {NOT_CLAIMED.format(horizon)}" for path, horizon in lost if horizon is not None]
    if has_smoothed_friction(study.setup.scene.mechanism):
        known = [asked for asked, (_, horizon) in zip(several, lost, strict=True) if horizon is None]
        found = (friction_warning(study, asked.path, value(asked, study).at) for asked in known)
        told += [text for text in found if text is not None]
    return told


def _is_number(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False
