"""`heun lagrange`: compute Lagrange's equations in numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated

import numpy as np

from heuncli.analyses.lagrange.inertia_curve import CoordinateRange, find_inertia_curve
from heuncli.analyses.lagrange.study import LagrangeOptions, solve_lagrange
from heuncli.app.cli import timeout
from heuncli.app.cli.documents import emit_document
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.options import CASE, OUTPUT, QUIET, SET, SPEC, TIME_LIMIT, UNITS, Option, make_format_option
from heuncli.app.cli.output import emit
from heuncli.app.cli.solving import load_spec, print_warnings
from heuncli.app.cli.target import choose_format, note_si_format, parse_units, require_other_file
from heuncli.app.commands.lagrange import forms, page
from heuncli.app.commands.lagrange.forms import KEYS
from heuncli.base.errors import Finding, Problem
from heuncli.base.joint_kinds import JOINTS, is_length
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import suggest
from heuncli.base.units import LENGTH, NUMBER, Dimension
from heuncli.scene.expressions.scope import Scope
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.quantity import read_number
from heuncli.study.quantities.table_units import Units


class LagrangeRequest(NamedTuple):
    """The options and arguments of `heun lagrange`."""

    spec: Annotated[str, SPEC]
    at: Annotated[
        float | None, Option(("--at",), "Instant of the motion [s]. Default: the start, or the rest position.", "T")
    ] = None
    over: Annotated[
        str | None,
        Option(
            ("--over",),
            "Evaluate over a range of a coordinate, for 1 degree of freedom; nothing is integrated.",
            "COORDINATE=FROM:TO/COUNT",
        ),
    ] = None
    coordinates: Annotated[
        str | None,
        Option(
            ("--coordinates",),
            "Generalised coordinates; rodrigues: Rodrigues parameters for bodies on ball joints.",
            "NAME,...",
        ),
    ] = None
    seen: Annotated[
        tuple[str, ...],
        Option(
            ("--seen",),
            "Where to show the effective inertia: coordinates, or points in a direction.",
            "NAME|POINT:X,Y,Z,...",
        ),
    ] = ()
    christoffel: Annotated[bool, Option(("--christoffel",), "Also show the Christoffel symbols.")] = False
    state_space: Annotated[
        bool, Option(("--state-space",), "Show A, B, C, D of small motions about the state, for controller design.")
    ] = False
    inputs: Annotated[
        str | None, Option(("--inputs",), "State-space inputs: forces by value, drives by acceleration.", "NAME,...")
    ] = None
    outputs: Annotated[
        str | None, Option(("--outputs",), "State-space outputs: coordinates, their rates, points.", "NAME,...")
    ] = None
    only: Annotated[
        str | None,
        Option(("--only",), "Show only these parts: equations, mass, forces, sections and others.", "PART,..."),
    ] = None
    format: Annotated[
        str | None,
        make_format_option(("table", "json", "csv", "m")),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    units: Annotated[str | None, UNITS] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False


FORMATS = ("table", "json", "csv", "m")


def main(request: LagrangeRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = choose_format(request.format, request.output, FORMATS)
    require_together(request, form)
    units_shown = parse_units(request.units)
    question = LagrangeOptions(
        at=request.at,
        coordinates=parse_names(request.coordinates),
        seen=parse_places(request.seen),
        christoffel=request.christoffel,
        state_space=request.state_space,
        inputs=parse_names(request.inputs),
        outputs=parse_names(request.outputs),
        time_limit=timeout.remaining_time(),
    )
    spec = load_spec(request)
    require_other_file(request.output, [request.spec])
    require_instant(request.at, spec)
    write_result(spec, request, question, form, units_shown)
    note_si_format(request.units, form, request.quiet)
    print_warnings(spec, None, request.quiet)
    return 0


def write_result(spec: Spec, request: LagrangeRequest, question: LagrangeOptions, form: str, units: Units) -> None:
    """Compute the requested result, and write it in a format; tables in the given units."""
    if request.over is not None:
        course = find_inertia_curve(spec, parse_range(request.over, spec))
        emit_document(page.make_course_document(course, units), form, request.output)
        return
    results = solve_lagrange(spec, question)
    if form == "m" and results.state_space is not None:
        emit(forms.to_m(results.state_space), request.output)
    else:
        emit_document(page.make_document(results, parse_names(request.only), units), form, request.output)


FORM = "for example --over main.angle=0:360deg/73"
COUNT = 73  # every five degrees of a turn
MAX_VALUES = 100_000  # values


def parse_names(argument: str | None) -> tuple[str, ...]:
    """Split names separated by commas."""
    return tuple(word.strip() for word in argument.split(",")) if argument else ()


def parse_places(arguments: Sequence[str]) -> tuple[str, ...]:
    """Split the places of --seen.

    main.angle,bucket.tip:0,0,1 names two places; numbers belong to the direction before them.
    """
    places_found: list[str] = []
    for word in (part.strip() for argument in arguments for part in argument.split(",")):
        if places_found and ":" in places_found[-1] and is_number(word):
            places_found[-1] += f",{word}"
        elif word:
            places_found.append(word)
    return tuple(places_found)


def is_number(word: str) -> bool:
    """Return whether a word is a number."""
    try:
        float(word)
    except ValueError:
        return False
    return True


def require_together(request: LagrangeRequest, form: str) -> None:
    """Raise UsageError for options that do not go together."""
    wrong = []
    if request.over is not None:
        others = {"--at": request.at is not None, "--coordinates": request.coordinates, "--seen": request.seen}
        others |= {"--christoffel": request.christoffel, "--state-space": request.state_space, "--only": request.only}
        hint_text = "leave it out; --over shows the single free coordinate over its range"
        wrong += [(f"--over and {name} cannot be combined", hint_text) for name, on in others.items() if on]
    if not request.state_space:
        dependent = {"--inputs": request.inputs, "--outputs": request.outputs, "--format m, or -o FILE.m": form == "m"}
        wrong += [(f"{name} without --state-space", "add --state-space") for name, on in dependent.items() if on]
    unknown = [part for part in parse_names(request.only) if part not in KEYS]
    wrong += [(f"--only {part}: unknown part", f"accepted: {', '.join(KEYS)}") for part in unknown]
    for place in parse_places(request.seen):
        wrong += check_place(place)
    if wrong:
        raise UsageError(*(Problem("bad-option", message, hint=hint) for message, hint in wrong))


def check_place(place: str) -> list[tuple[str, str]]:
    """Return what is wrong with a place of --seen and what to write, or an empty list."""
    point, colon, direction = place.partition(":")
    if not colon:
        return []
    n = [float(word) for word in direction.split(",") if is_number(word)]
    if len(n) == 3 == len(direction.split(",")) and all(map(math.isfinite, n)) and any(n):
        return []
    return [(f"--seen {place}: expected a direction of three numbers", f"for example --seen {point}:0,0,1")]


def require_instant(instant: float | None, spec: Spec) -> None:
    """Raise UsageError for an instant that the analysis does not have."""
    if instant is None:
        return
    if not (math.isfinite(instant) and instant >= 0.0):
        raise UsageError(
            Problem("bad-option", f"--at {instant:g}: expected 0 or later", hint="for example --at 0.5, in s")
        )
    if spec.analysis.type != "motion" and instant > 0.0:
        message = f"--at {instant:g}: the analysis is not a motion (type: {spec.analysis.type})"
        raise UsageError(
            Problem("bad-option", message, hint="leave it out, or request a motion with analysis.duration")
        )


def parse_range(argument: str, spec: Spec) -> CoordinateRange:
    """Parse the range NAME=FROM:TO/COUNT. Raises UsageError."""
    name, equals, rest = (part.strip() for part in argument.partition("="))
    bounds, slash, count = rest.partition("/")
    first, colon, last = bounds.partition(":")
    if not (equals and colon) or (slash and not count.strip().isdigit()):
        raise make_range_error(argument, "expected NAME=FROM:TO/COUNT", FORM)
    n = int(count) if slash else COUNT
    if not 2 <= n <= MAX_VALUES:
        raise make_range_error(argument, f"expected 2 to {MAX_VALUES} values", FORM)
    joint, _, quantity = name.rpartition(".")
    known = [
        f"{joint_spec.name}.{q}"
        for joint_spec in spec.joints.values()
        for q in JOINTS[joint_spec.kind].drives
        if not joint_spec.tension_only
    ]
    if name not in known:
        hint = suggest(name, known, "coordinates") or "use coordinates of pins, slides, cylinders and rods"
        raise make_range_error(argument, f"there is no coordinate {name}", hint)
    a, b = (parse_bound(argument, text, LENGTH if is_length(name) else NUMBER) for text in (first, last))
    if a == b:
        raise make_range_error(argument, "both ends are the same", FORM)
    return CoordinateRange(name, joint, quantity, np.linspace(a, b, n))


def parse_bound(argument: str, text: str, dimension: Dimension) -> float:
    """Parse an end of a range, a number with or without a unit; returns SI."""
    try:
        return read_number(text, dimension, Scope())
    except Finding as finding:
        raise make_range_error(argument, str(finding), f"{finding.hint}; {FORM}" if finding.hint else FORM) from None


def make_range_error(argument: str, message: str, hint: str) -> UsageError:
    """Make the error of a range that cannot be read."""
    return UsageError(Problem("bad-option", f"--over {argument}: {message}", hint=hint))
