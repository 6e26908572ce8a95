"""Check whether an integration method and a step fit each other and the run; used for specs and for command options."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base import tolerances
from heuncli.base.method_rows import AUTO, METHODS, NAMES, find_method
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import suggest
from heuncli.scene.file_format.foreign_words import METHOD_WORDS


class MethodProblem(NamedTuple):
    """What is wrong with method, step or tolerance: the code, the key concerned, the message and a hint."""

    code: str
    key: str
    message: str
    hint: str


def iter_method_problems(method: str, step: float | None, end_time: float | None) -> Iterator[MethodProblem]:
    """Yield what is wrong with a method and a step in a run until `end_time`; None: not given, or no motion."""
    method_row = find_method(method)
    if method_row is None and method.lower() != AUTO:
        yield MethodProblem("unknown-method", "method", f"'{method}' is not an integration method", method_hint(method))
        return
    if step is not None and step <= 0.0:
        return  # reported by the rule on positive numbers
    has_fixed_step = method_row is not None and method_row.steps == "fixed"
    if has_fixed_step and step is None:
        hint = f"analysis: {{method: {method}, step: 0.001}}, or --step 0.001; method: {AUTO} chooses its own steps"
        yield MethodProblem("fixed-step", "method", f"{method} needs a fixed step, and none is given", hint)
    if not has_fixed_step and step is not None:
        listed = ", ".join(method_row.name for method_row in METHODS if method_row.steps == "fixed")
        hint = f"only {listed} take a step; for {method} give a tolerance: 1e-9"
        yield MethodProblem("fixed-step", "step", f"{method} chooses its own step size, so no step can be given", hint)
    elif step is not None:
        yield from iter_step_problems(step, end_time)


def find_tolerance_problem(tolerance: float) -> MethodProblem | None:
    """Return what is wrong with a tolerance, or None. The range is the same for specs and for options."""
    low, high = tolerances.LEAST_ASKED, tolerances.MOST_ASKED
    if low <= tolerance <= high:
        return None
    hint = "the default is 1e-9"
    if tolerance > high:
        hint += "; for a quick look 1e-3 is accurate enough"
    elif tolerance > 0.0:
        hint += "; below this range rounding errors dominate"
    return MethodProblem("tolerance", "tolerance", f"tolerance {tolerance:g} is not between {low:g} and {high:g}", hint)


def iter_step_problems(step: float, end_time: float | None) -> Iterator[MethodProblem]:
    """Yield what is wrong with the size of a step."""
    max_steps, check_factor = tolerances.MOST_STEPS, tolerances.CHECK_STEPS
    if end_time is not None and step > end_time:
        yield MethodProblem(
            "step", "step", f"the step of {step:g} s is longer than the run of {end_time:g} s", "give a shorter step"
        )
    elif end_time is not None and check_factor * end_time > max_steps * step:
        message = (
            f"steps of {step:g} s are too short: {end_time / step:.3g} to {end_time:g} s and "
            f"{check_factor} times as many in the check "
            f"run; the limit is {max_steps:,}"
        )
        smallest_step = check_factor * end_time / max_steps
        yield MethodProblem(
            "step", "step", message, f"use steps of at least {smallest_step:.2g} s, or a method of higher order"
        )


def method_hint(method: str) -> str:
    """Return a hint on which method an unknown word may mean."""
    word = METHOD_WORDS.get(normalize_name(method))
    if word is not None and (word == AUTO or find_method(word) is not None):
        return f"write method: {word}"
    same_name = next((name for name in NAMES if normalize_name(name) == normalize_name(method)), method)
    hint = suggest(same_name, NAMES, "methods") or ""
    return f"{hint}{'' if hint.endswith('?') else ';'} `heun methods` lists them"


def normalize_name(name: str) -> str:
    """Return a name in lower case, without hyphens, underscores and blanks."""
    return "".join(x for x in name.lower() if x not in "-_ ")
