"""What is looked at before the first variant runs: names and units of all that is varied, all problems at once.

What hangs on the size of a value (a negative mass, a loop that does not close) is no matter of this: such a variant has
the reason in its row.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress

from heuncli.commands.sweep.given import GivenAxis
from heuncli.errors import Problem, SpecError
from heuncli.nearest import did_you_mean
from heuncli.spec.names import ALL_CASES
from heuncli.spec.overrides import path_of
from heuncli.variants.asking import CASE, OF_WORDS, Asker, varies_cases

# What is wrong with a value whatever its size; beside these all codes that begin with unknown-.
OF_NAMES = frozenset({
    "no-such-key", "dimension", "wrong-dimension", "wrong-kind", "expression-syntax", "expression-limit",
    "function-arguments", "parameter-circle", "not-in-time", "not-yaml", "bad-character", "too-deep", "empty",
})  # fmt: skip
ONCE = "one axis a parameter"


def problems_of(given: Sequence[GivenAxis], asker: Asker, first: dict[str, str]) -> list[Problem]:
    """What is wrong with the names and units of what is varied; first: values of a variant for specs that need them."""
    found = list(_twice(given, asker))
    for one in given if not found else ():
        if one.name == CASE and varies_cases(asker.spec):
            found += _cases(one, asker)
        elif one.name == CASE and CASE not in asker.spec.parameters:
            problem = Problem(
                "no-such-key", "the spec has no load cases", hint="cases: {NAME: {set: {PARAMETER: VALUE}}}"
            )
            found.append(one.told(problem))
        else:
            found += _values(one, asker, first)
    return list(dict.fromkeys(found))


def _twice(given: Sequence[GivenAxis], asker: Asker) -> Iterator[Problem]:
    """What is varied by two words, or varied and set."""
    data = {"parameters": dict.fromkeys(asker.spec.parameters)}
    paths = [path_of(one.name, data) for one in given]
    set_ = {path_of(name, data): name for name in asker.recipe.overrides}
    for k, one in enumerate(given):
        if paths[k] in paths[:k]:
            yield one.told(Problem("bad-option", f"{one.name} is varied twice", hint=ONCE))
        elif paths[k] in set_:
            message = f"{one.name} is varied, and set by --set"
            yield one.told(Problem("bad-option", message, hint="leave one of them out"))


def _cases(one: GivenAxis, asker: Asker) -> Iterator[Problem]:
    """The load cases that are none."""
    known = asker.spec.cases
    for text, k in one.samples().items():
        if text not in known and (text != ALL_CASES or len(one.texts) > 1 or one.column is not None):
            hint = did_you_mean(text, known, "cases")
            yield one.told(Problem("unknown-case", f"there is no load case '{text}'", hint=hint), k)


def _values(one: GivenAxis, asker: Asker, first: dict[str, str]) -> Iterator[Problem]:
    """What is wrong with an axis whatever the size of its values."""
    others = {name: text for name, text in first.items() if name != one.name}
    for text, k in one.samples().items():
        try:
            asker.load({**others, one.name: text})
        except SpecError as error:
            for problem in error.problems:
                if problem.code == "no-such-key":
                    yield one.told(problem)
                elif problem.code in OF_NAMES or problem.code.startswith("unknown-"):
                    yield one.told(problem, k)


def warnings_of(given: Sequence[GivenAxis], asker: Asker) -> list[str]:
    """What should be known of the axes before their variants are solved, a sentence each."""
    found = []
    for one in given:
        for text, k in one.samples().items():
            with suppress(SpecError):
                spec = asker.load({one.name: text})
                told = [one.told(problem, k) for problem in spec.warnings if problem.code in OF_WORDS]
                found += [str(problem._replace(hint=_with_unit(one, problem))) for problem in told]
    idle = asker.idle([one.name for one in given])
    found += [f"{one.word}: nothing hangs on {one.name}" for one in given if one.name in idle]
    return list(dict.fromkeys(found))


def _with_unit(one: GivenAxis, problem: Problem) -> str:
    unit = problem.message.rpartition(" in ")[2]
    return (
        f"in the head of the column: {one.name} [{unit}]"
        if one.column is not None
        else f"with the unit: {one.word}{unit}"
    )
