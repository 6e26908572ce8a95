"""What is looked at before the first variant runs: names and units of all that is varied, all problems at once.

What hangs on the size of a value (a negative mass, a loop that does not close) is no matter of this: such a variant has
the reason in its row.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress

from heuncli.analyses.variants.asking import CASE, OF_WORDS, Asker, varies_cases
from heuncli.app.commands.sweep.given import GivenAxis
from heuncli.base.errors import Problem, SpecError
from heuncli.base.nearest import did_you_mean
from heuncli.scene.file_format.names import ALL_CASES
from heuncli.scene.file_format.overrides import path_of

# What is wrong with a value whatever its size; beside these all codes that begin with unknown-.
OF_NAMES = frozenset({
    "no-such-key", "dimension", "wrong-dimension", "wrong-kind", "expression-syntax", "expression-limit",
    "function-arguments", "parameter-circle", "not-in-time", "not-yaml", "bad-character", "too-deep", "empty",
})  # fmt: skip
ONCE = "one axis a parameter"


def problems_of(given: Sequence[GivenAxis], asker: Asker, set_: Collection[str]) -> list[Problem]:
    """What is wrong with the names and units of what is varied; set_: what is set in all variants."""
    found = list(_twice(given, asker, set_))
    for one in given if not found else ():
        if one.name == CASE and varies_cases(asker.spec):
            found += _cases(one, asker)
        elif one.name == CASE and CASE not in asker.spec.parameters:
            problem = Problem(
                "no-such-key", "the spec has no load cases", hint="cases: {NAME: {set: {PARAMETER: VALUE}}}"
            )
            found.append(one.told(problem))
        else:
            found += _values(one, asker)
    return list(dict.fromkeys(found))


def _twice(given: Sequence[GivenAxis], asker: Asker, set_: Collection[str]) -> Iterator[Problem]:
    """What is varied by two words, or varied and set."""
    data = {"parameters": dict.fromkeys(asker.spec.parameters)}
    paths = [path_of(one.name, data) for one in given]
    fixed = [path_of(name, data) for name in set_]
    for k, one in enumerate(given):
        if paths[k] in paths[:k]:
            yield one.told(Problem("bad-option", f"{one.name} is varied twice", hint=ONCE))
        elif paths[k] in fixed:
            message = f"{one.name} is varied, and set by --set"
            yield one.told(Problem("bad-option", message, hint="leave one of them out"))


def _cases(one: GivenAxis, asker: Asker) -> Iterator[Problem]:
    """The load cases that are none."""
    known = asker.spec.cases
    for text, k in one.samples().items():
        if text not in known and (text != ALL_CASES or len(one.texts) > 1 or one.column is not None):
            hint = did_you_mean(text, known, "cases")
            yield one.told(Problem("unknown-case", f"there is no load case '{text}'", hint=hint), k)


def _values(one: GivenAxis, asker: Asker) -> Iterator[Problem]:
    """What is wrong with an axis whatever the size of its values: of each kind the first place at which it is."""
    for text, k in one.samples().items():
        try:
            asker.load({one.name: text})
        except SpecError as error:
            found = [each for each in error.problems if each.code in OF_NAMES or each.code.startswith("unknown-")]
            more = f"; in all at {len(found)} places" if len(found) > 1 else ""
            for problem in found[:1]:
                told = problem._replace(message=problem.message + more)
                yield one.told(told, None if problem.code == "no-such-key" else k)


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
