"""The options of `heun lagrange` read from words: ranges, instants, what goes together. Raises UsageError."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.analyses.lagrange.over import Range
from heuncli.app.cli.entry import UsageError
from heuncli.app.commands.lagrange.forms import KEYS
from heuncli.app.commands.lagrange.request import LagrangeRequest
from heuncli.base.errors import Finding, Problem
from heuncli.base.joint_kinds import JOINTS, is_length
from heuncli.base.nearest import did_you_mean
from heuncli.base.units import LENGTH, NUMBER, Dimension
from heuncli.scene.expressions.grammar import Scope
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.quantity import number

FORM = "such as --over main.angle=0:360deg/73"
COUNT = 73  # every five degrees of a turn
MOST = 100_000  # values


def words(given: str | None) -> tuple[str, ...]:
    """Names with commas between them."""
    return tuple(word.strip() for word in given.split(",")) if given else ()


def places(given: Sequence[str]) -> tuple[str, ...]:
    """Of --seen: main.angle,bucket.tip:0,0,1 names two; numbers belong to the direction before them."""
    found: list[str] = []
    for word in (part.strip() for own in given for part in own.split(",")):
        if found and ":" in found[-1] and is_number(word):
            found[-1] += f",{word}"
        elif word:
            found.append(word)
    return tuple(found)


def is_number(word: str) -> bool:
    """Whether a word is one."""
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
        told = "the one free coordinate is told over its range"
        wrong += [(f"--over and {name}", told) for name, on in others.items() if on]
    if not request.state_space:
        named = {"--inputs": request.inputs, "--outputs": request.outputs, "--format m, or -o FILE.m": form == "m"}
        wrong += [(f"{name} without --state-space", "add --state-space") for name, on in named.items() if on]
    unknown = [part for part in words(request.only) if part not in KEYS]
    wrong += [(f"--only {part}: no part is called so", f"known: {', '.join(KEYS)}") for part in unknown]
    for place in places(request.seen):
        wrong += seen_wrongly(place)
    if wrong:
        raise UsageError(*(Problem("bad-option", message, hint=hint) for message, hint in wrong))


def seen_wrongly(place: str) -> list[tuple[str, str]]:
    """What is wrong with a place of --seen, and what to write."""
    point, colon, direction = place.partition(":")
    if not colon:
        return []
    n = [float(word) for word in direction.split(",") if is_number(word)]
    if len(n) == 3 == len(direction.split(",")) and all(map(math.isfinite, n)) and any(n):
        return []
    return [(f"--seen {place}: expected a direction of three numbers", f"such as --seen {point}:0,0,1")]


def require_instant(at: float | None, spec: Spec) -> None:
    """Raise UsageError for an instant that the analysis does not have."""
    if at is None:
        return
    if not (math.isfinite(at) and at >= 0.0):
        raise UsageError(
            Problem("bad-option", f"--at {at:g}: expected an instant from 0 on", hint="such as --at 0.5, in s")
        )
    if spec.analysis.type != "motion" and at > 0.0:
        message = f"--at {at:g}: the analysis is no motion (type: {spec.analysis.type})"
        raise UsageError(Problem("bad-option", message, hint="leave it out; or ask for a motion, by analysis.duration"))


def range_of(given: str, spec: Spec) -> Range:
    """The range that is asked for: NAME=FROM:TO/COUNT. Raises UsageError."""
    name, equals, rest = (part.strip() for part in given.partition("="))
    bounds, slash, count = rest.partition("/")
    first, colon, last = bounds.partition(":")
    if not (equals and colon) or (slash and not count.strip().isdigit()):
        raise refused(given, "expected NAME=FROM:TO/COUNT", FORM)
    n = int(count) if slash else COUNT
    if not 2 <= n <= MOST:
        raise refused(given, f"expected 2 to {MOST} values", FORM)
    joint, _, quantity = name.rpartition(".")
    known = [f"{own.name}.{q}" for own in spec.joints.values() for q in JOINTS[own.kind].drives if not own.tension_only]
    if name not in known:
        hint = did_you_mean(name, known, "coordinates") or "of pins, slides, cylinders and rods"
        raise refused(given, f"no coordinate is called {name}", hint)
    a, b = (bound(given, text, LENGTH if is_length(name) else NUMBER) for text in (first, last))
    if a == b:
        raise refused(given, "both ends are the same", FORM)
    return Range(name, joint, quantity, np.linspace(a, b, n))


def bound(given: str, text: str, dimension: Dimension) -> float:
    """An end of a range, a number with a unit or without, SI."""
    try:
        return number(text, dimension, Scope())
    except Finding as finding:
        raise refused(given, str(finding), f"{finding.hint}; {FORM}" if finding.hint else FORM) from None


def refused(given: str, message: str, hint: str) -> UsageError:
    """The error of a range that cannot be read."""
    return UsageError(Problem("bad-option", f"--over {given}: {message}", hint=hint))
