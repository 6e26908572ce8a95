"""Whether a method of integration and a step go together, and with the run: one check for specs and for options."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base import tolerances
from heuncli.base.method_rows import AUTO, METHODS, NAMES, row_of
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.nearest import did_you_mean
from heuncli.scene.file_format.words import METHOD_WORDS


class Unfit(NamedTuple):
    """What is wrong: the code, the key concerned (method or step), the message and a hint."""

    code: str
    key: str
    message: str
    hint: str


def unfit(method: str, step: float | None, last: float | None) -> Iterator[Unfit]:
    """What speaks against a method with a step, in a run to `last`; none of them: it is not given, or nothing moves."""
    row = row_of(method)
    if row is None and method.lower() != AUTO:
        yield Unfit("unknown-method", "method", f"'{method}' is no method of integration", meant(method))
        return
    if step is not None and step <= 0.0:
        return  # told as what must be positive
    fixed = row is not None and row.steps == "fixed"
    if fixed and step is None:
        hint = f"analysis: {{method: {method}, step: 0.001}}, or --step 0.001; method: {AUTO} finds its own steps"
        yield Unfit("fixed-step", "method", f"{method} goes in steps of a given length, and none is given", hint)
    if not fixed and step is not None:
        listed = ", ".join(row.name for row in METHODS if row.steps == "fixed")
        hint = f"a step goes with {listed}; here tolerance: 1e-9 tells how exactly"
        yield Unfit("fixed-step", "step", f"{method} finds its own steps and takes none", hint)
    elif step is not None:
        yield from unfit_step(step, last)


def unfit_tolerance(tolerance: float) -> Unfit | None:
    """What speaks against a tolerance; None: nothing. One range for specs and for options."""
    low, high = tolerances.LEAST_ASKED, tolerances.MOST_ASKED
    if low <= tolerance <= high:
        return None
    hint = "the default is 1e-9"
    if tolerance > high:
        hint += "; for a quick look 1e-3 is coarse enough"
    elif tolerance > 0.0:
        hint += "; beyond that rounding is all that is left"
    return Unfit("tolerance", "tolerance", f"tolerance {tolerance:g} is not between {low:g} and {high:g}", hint)


def unfit_step(step: float, last: float | None) -> Iterator[Unfit]:
    """What speaks against the length of a step."""
    most, times = tolerances.MOST_STEPS, tolerances.CHECK_STEPS
    if last is not None and step > last:
        yield Unfit("step", "step", f"the step of {step:g} s is longer than the run of {last:g} s", "a shorter one")
    elif last is not None and times * last > most * step:
        message = (
            f"steps of {step:g} s are too many: {last / step:.3g} to {last:g} s, {times} times as many in the check "
            f"run, and {most:,} is the most"
        )
        least = times * last / most
        yield Unfit("step", "step", message, f"steps of {least:.2g} s and more, or a method of higher order")


def meant(method: str) -> str:
    """Which method may be meant by a word that is none."""
    word = METHOD_WORDS.get(bare(method))
    if word is not None and (word == AUTO or row_of(word) is not None):
        return f"here that is method: {word}"
    same = next((name for name in NAMES if bare(name) == bare(method)), method)
    hint = did_you_mean(same, NAMES, "methods") or ""
    return f"{hint}{'' if hint.endswith('?') else ';'} `heun methods` lists them"


def bare(name: str) -> str:
    """A name in lower case, without hyphens and blanks."""
    return "".join(x for x in name.lower() if x not in "-_ ")
