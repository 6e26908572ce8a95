"""`--measure`: single numbers of a run, such as `max abs sections.middle.M1` and their units."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from itertools import pairwise
from typing import Any, TypeVar

from heuncli.base.errors import Finding, Problem, SpecError, UsageError
from heuncli.output.documents.as_data import dump_json
from heuncli.results.path_words import find_position_word, find_quantity, split_path
from heuncli.results.results import Results
from heuncli.results.results_paths import find_values
from heuncli.results.results_schema import IMPULSES
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import collect_scene_names
from heuncli.scene.file_format.rules.outcome import find_path_error
from heuncli.study.compose.warnings import has_smoothed_friction
from heuncli.study.model.options import collect_results
from heuncli.study.quantities.digits import OPEN, UNKNOWN
from heuncli.study.quantities.table_units import DisplayUnit, Units, find_si_unit
from heuncli.study.queries.measure import (
    NOT_CLAIMED,
    MeasureRequest,
    NotOneNumber,
    Peak,
    find_exceeded_horizon,
    measure_value,
)
from heuncli.study.queries.measure_uncertainty import find_unit
from heuncli.study.queries.study import Study, make_friction_warning

T = TypeVar("T")
PATH = re.compile(r"[\w.]+(?:[@:][\w.+-]*)*\Z")
SYNONYMS = {
    "last": "final", "end": "final", "start": "first", "initial": "first", "maximum": "max", "largest": "max",
    "highest": "max", "minimum": "min", "least": "min", "lowest": "min", "maxabs": "max abs", "peak": "max abs",
    "amplitude": "max abs", "t": "at",
}  # fmt: skip

KINDS = {"tension": "rod", "torque": "cv", "contact_point": "curve"}  # the only kinds of joints with these

FORMS = "expected [max | min | max abs | first | final | at T] PATH"
EXAMPLE_HINT = "for example {} 'max abs sections.middle.M1'"


def parse_measure(text: str, option: str = "--measure") -> MeasureRequest:
    """Parse the words of a measure. Raises UsageError."""
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
    raise UsageError(Problem("bad-option", f"{option} '{text}': {FORMS}", hint=make_hint(text, option)))


def make_hint(text: str, option: str = "--measure") -> str:
    """Return a hint: the words in the correct order and spelling, if that makes them a measure."""
    if "," in text:
        return f"one number each: {option} may be repeated"
    plain = re.sub(r"\[(\d+)\]", r".\1", text)
    words = [SYNONYMS.get(word.lower(), word) for word in re.split(r"[\s()|]+", plain) if word]
    words.sort(key=lambda word: "." in word and not _is_number(word))
    proposed = " ".join(words)
    if proposed == text or "," in proposed:
        return EXAMPLE_HINT.format(option)
    try:
        parse_measure(proposed)
    except UsageError:
        return EXAMPLE_HINT.format(option)
    return f"did you mean '{proposed}'?"


def parse_measures(texts: Sequence[str]) -> list[MeasureRequest]:
    """Parse several measures. Raises UsageError with all that cannot be parsed."""
    return collect_results([partial(parse_measure, text) for text in texts])


def require_known_paths(requests: Sequence[MeasureRequest], spec: Spec, option: str = "--measure") -> None:
    """Check the paths of measures, as far as that is possible before the run. Raises SpecError [unknown-path]."""
    names = collect_scene_names(spec)
    cut_series = {name: section.from_ is not None for name, section in spec.sections.items()}
    path_errors = (find_path_error(request.path, names, cut_series) for request in requests)
    problems = [found for found in path_errors if found is not None]
    problems += [found for request in requests if (found := find_place_problem(request.path, spec)) is not None]
    problems += [found for request in requests if (found := find_absent_quantity(request.path, spec)) is not None]
    if problems:
        raise SpecError(*(Problem("unknown-path", f"{option}: {what}", hint=hint) for what, hint in problems))


def find_absent_quantity(path: str, spec: Spec) -> tuple[str, str] | None:
    """Return what is wrong with a path to a quantity that this kind of joint, or this section, does not have, and a
    hint; None if nothing is.
    """
    words = split_path(path)
    block, name, word = [*(words[2:] if words[0] == IMPULSES else words), "", "", ""][:3]
    if block == "sections" and word == "stress" and name in spec.sections and not spec.sections[name].properties:
        return f"'{path}': the section has no properties", "stresses need `properties`: heun explain stresses"
    section = spec.sections.get(name) if block == "sections" and word in ("deflection", "buckling") else None
    if section is not None and section.beam_theory is None:
        return f"'{path}': the section has no deflection", "give it `deflection: true`: heun explain stresses"
    joint = spec.joints.get(name) if block == "joints" else None
    if joint is not None and word in KINDS and joint.kind != KINDS[word]:
        return (
            f"'{path}': a {joint.kind} has no {word}",
            f"only a {KINDS[word]} has it: heun explain joints.JOINT.{word}",
        )
    if joint is not None and word == "pressure" and joint.bearing is None:
        return f"'{path}': the joint has no bearing", "give it `bearing: {diameter, width}`"
    return None


def check_with_others(
    requests: Sequence[MeasureRequest], spec: Spec, others: Iterable[Callable[[], T]], option: str = "--measure"
) -> list[T]:
    """Check the paths of measures and call the other functions; return their results. Raises one error with all
    problems.
    """
    calls: tuple[Callable[[], Any], ...] = (partial(require_known_paths, requests, spec, option), *others)
    _, *results = collect_results(calls)
    return results


def find_place_problem(path: str, spec: Spec) -> tuple[str, str] | None:
    """Return what is wrong with the place that a path names by its distance along a series of cuts, and a hint; None if
    nothing is.
    """
    words = split_path(path)
    place = find_position_word(words)
    name = next((after for word, after in pairwise(words) if word == "sections"), "")
    section = spec.sections.get(name)
    if place is None or section is None or section.from_ is None or section.to is None:
        return None
    from heuncli.results.cut_rows import cut_distances, find_cut_rows

    try:
        find_cut_rows(place, cut_distances(section.from_, section.to, section.count), None)
    except Finding as finding:
        return f"'{path}': {finding.message}", finding.hint
    return None


def format_measures(
    requests: Sequence[MeasureRequest], study: Study, form: str, sizes: Sequence[float] | None = None
) -> str:
    """Format each number on a line with all its digits; for "json" in SI with its instant, several as a list.

    A number beyond the horizon is `?`. sizes: how many of the unit in which each number is printed make one SI unit
    """
    if form == "json":
        blocks = collect_results([partial(to_json_block, request, study) for request in requests])
        return dump_json(blocks[0] if len(blocks) == 1 else blocks)
    pairs = zip(requests, sizes or [1.0] * len(requests), strict=True)
    return "".join(collect_results([partial(format_line, request, study, size) for request, size in pairs]))


def format_line(request: MeasureRequest, study: Study, size: float = 1.0) -> str:
    """Format one number as text, times `size`."""
    peak, horizon = measure_number(request, study)
    if horizon is not None:
        return f"{UNKNOWN}\n"
    if math.isnan(peak.value):
        return f"{UNKNOWN if peak.time in study.unknown else OPEN}\n"
    return f"{peak.value * size!r}\n"


def to_json_block(request: MeasureRequest, study: Study) -> dict[str, Any]:
    """Return one number for JSON."""
    return describe_measure(request, study, *measure_number(request, study))


def describe_measure(request: MeasureRequest, study: Study, peak: Peak, horizon: float | None) -> dict[str, Any]:
    """Return a measured number for JSON, with its instant, and along a series of cuts its place."""
    found: dict[str, Any] = {"measure": f"{request.how} {request.path}".strip(), "value": peak.value, "at": peak.time}
    if horizon is None and (note := make_friction_warning(study, request.path, peak.time)) is not None:
        found["notes"] = [note]
    if "axes" in study.results.model and "joints." in request.path:
        found["axes"] = study.results.model["axes"]
    if horizon is not None:
        return found | {"value": None, "at": None, "horizon": horizon}
    if peak.place is not None and not math.isnan(peak.value):
        found |= peak.place._asdict()
        if peak.place.cut is not None:
            found["cut"] = find_cut_number(request, study, peak.place.cut)
    return found


def find_cut_number(request: MeasureRequest, study: Study, row: int) -> int:
    """Return the number of a requested cut, by which paths name it.

    row: in the results, which may have two rows for one cut
    """
    from heuncli.results.cut_rows import cut_indices  # where there are series of cuts

    keys = find_values(study.results, request.path).keys
    s = next(cuts.s for cuts in study.setup.cuts if cuts.name == keys[keys.index("sections") + 1])
    assert s is not None
    return int(cut_indices(s)[row])


def measure_number(request: MeasureRequest, study: Study, option: str = "--measure") -> tuple[Peak, float | None]:
    """Return the number, and the horizon if it lies beyond. Raises UsageError."""
    try:
        return measure_value(request, study), find_exceeded_horizon(request, study)
    except NotOneNumber as error:
        (problem,) = error.problems
        raise UsageError(problem._replace(message=f"{option}: {problem.message}")) from None


def find_warnings(requests: Sequence[MeasureRequest], study: Study) -> list[str]:
    """Return why some numbers are `?`, and which stand at instants at which friction is not at its full value."""
    lost = [(request.path, find_exceeded_horizon(request, study)) for request in requests]
    sentences = [f"{path} is unknown: {NOT_CLAIMED.format(horizon)}" for path, horizon in lost if horizon is not None]
    if has_smoothed_friction(study.setup.scene.mechanism):
        known_requests = [request for request, (_, horizon) in zip(requests, lost, strict=True) if horizon is None]
        found = (
            make_friction_warning(study, request.path, measure_value(request, study).time) for request in known_requests
        )
        sentences += [text for text in found if text is not None]
    return sentences


def _is_number(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False


SUMS = "certain_sums"
EXAMPLES = {
    "N": "kN", "N·m": "kN,m", "N·s": "kN", "N·m·s": "kN,m", "m": "mm", "m/s": "mm", "m/s²": "mm", "rad": "deg",
    "rad/s": "rpm", "rad/s²": "deg", "Pa": "MPa", "J": "kJ", "W": "kW",
}  # fmt: skip


def require_fitting_units(requests: Sequence[MeasureRequest], spec: Spec, units: Units, words: str | None) -> None:
    """Raise UsageError [bad-option] if none of the units of `--units` applies to any of the measures."""
    if words is None:
        return
    known = {request.path: find_unit(request.path, spec) for request in requests}
    if any(_is_unclear(path) or _find_chosen_unit(unit, units, words) is not None for path, unit in known.items()):
        return
    stated = ", ".join(
        f"{path} is in {unit}" if unit not in ("", "1") else f"{path} has no unit" for path, unit in known.items()
    )
    examples = [EXAMPLES[unit] for unit in known.values() if unit in EXAMPLES]
    hint = (
        f"for example --units {examples[0]}; without --units it is printed in SI" if examples else "leave --units out"
    )
    raise UsageError(Problem("bad-option", f"--units {words}: {stated}", hint=hint))


def choose_units(
    requests: Sequence[MeasureRequest], study: Study, units: Units, words: str | None
) -> list[DisplayUnit]:
    """Return the unit in which each measure is printed, and how many of it make one SI unit."""
    found = []
    for request in requests:
        unit = _find_unit_after_run(request.path, study)
        found.append((words is not None and _find_chosen_unit(unit, units, words)) or (unit, 1.0))
    return found


def describe_units(requests: Sequence[MeasureRequest], display_units: Sequence[DisplayUnit]) -> list[str]:
    """Return a line for the unit of each measure; of several with the measure."""
    lines = [f"unit: {unit or '1'}" for unit, _ in display_units]
    if len(lines) == 1:
        return lines
    return [f"{line} ({_describe(request)})" for line, request in zip(lines, requests, strict=True)]


def _describe(request: MeasureRequest) -> str:
    how = {"abs": "max abs", "at": f"at {request.time:g}" if request.time is not None else "at"}
    return f"{how.get(request.how, request.how)} {request.path}".strip()


def _find_chosen_unit(unit: str, units: Units, words: str) -> DisplayUnit | None:
    """Return the unit that `--units` sets in place of an SI unit; MPa, the unit of tables, only if it is asked for."""
    if unit == "Pa" and all(find_si_unit(word.strip())[0] != unit for word in words.split(",")):
        return None
    return units.display_units.get(unit)


def _is_unclear(path: str) -> bool:
    """Whether the unit of a path is known only after the run."""
    return SUMS in split_path(path)


def _find_unit_after_run(path: str, study: Study) -> str:
    """Return the SI unit of a path; a determinate sum is one of moments if no force is among its terms."""
    if not _is_unclear(path):
        return find_unit(path, study.spec)
    return find_sum_unit(study.results, study.find_numbers(path).keys)


def find_sum_unit(results: Results, keys: Sequence[str]) -> str:
    """Return the unit of a determinate sum: that of a moment if no force is among its terms; of an impulse times
    seconds.
    """
    block: Any = vars(results)
    for key in keys[:-1]:
        block = block[int(key) if isinstance(block, list) else key]
    row = find_quantity(tuple(keys))
    if row is None:
        return ""
    return block.get("unit") or row.select_unit(turning=not any(".force." in term for term in block["terms"]))
