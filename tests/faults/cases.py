"""A case: files, command lines on them, and what they may leave with; a kind and a seed tell which, always the same."""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from typing import NamedTuple

from tests.faults import mutate_bytes, mutate_magnitudes, mutate_spec, sources
from tests.faults.random_commands import LIMIT, SPEC, random_command
from tests.faults.random_expectations import random_expectation
from tests.faults.random_expressions import random_expression

RUN = ("run", SPEC, "--time-limit", LIMIT)
AS_JSON = (*RUN, "--format", "json")
# What follows where `validate` found nothing: most often all of a run, as JSON, where every number is judged.
FOLLOWING = (
    AS_JSON, AS_JSON, AS_JSON, AS_JSON, AS_JSON, RUN, RUN,
    (*RUN, "--format", "csv"), (*RUN, "--format", "markdown", "--all"), (*RUN, "--by-cause"),
    (*AS_JSON, "--by-cause"), (*AS_JSON, "--least-norm", "--axes", "from"), (*AS_JSON, "--no-reduce"),
    ("model", SPEC, "--format", "json"), ("model", SPEC), ("modes", SPEC, "--format", "json"),
    ("probe", SPEC, "--time-limit", LIMIT, "--format", "json"),
    ("balance", SPEC, "--time-limit", LIMIT, "--format", "json"),
)  # fmt: skip


class Case(NamedTuple):
    """Files by name, and command lines; each but the first only where the one before it ended with 0.

    codes: those that the last one may end with; None: any documented one. given: whether the command line may be at
    fault by itself, so that 2 may follow a valid spec.
    """

    files: dict[str, bytes]
    commands: tuple[tuple[str, ...], ...]
    codes: frozenset[int] | None = None
    given: bool = False


def case(kind: str, seed: int) -> Case:
    """The case of a kind and a seed."""
    return KINDS[kind].make(Random(f"{kind} {seed}"))


def of_spec(random: Random) -> Case:
    """A spec changed as a tree."""
    return validated(random, sources.text(mutate_spec.mutated(random)))


def of_bytes(random: Random) -> Case:
    """A spec, or a table, changed as bytes."""
    name, content = mutate_bytes.mutated(random)
    if name in sources.tables():
        readers = [n for n in sources.names() if name in sources.text(sources.tree(n)).decode()]
        made = validated(random, sources.text(sources.tree(random.choice(readers))))
        return made._replace(files=made.files | {name: content})
    return validated(random, content)


def of_expressions(random: Random) -> Case:
    """Expressions in some numeric places of a spec."""
    tree = sources.tree(random.choice(sources.names()))
    for _ in range(random.choice((1, 1, 2, 3))):
        place = mutate_spec.spot(random, tree, mutate_spec.is_number)
        if place is not None:
            place[0][place[1]] = random_expression(random, mutate_spec.variables(tree))
    return validated(random, sources.text(tree))


def of_magnitudes(random: Random) -> Case:
    """Numbers of a spec of any magnitude."""
    return validated(random, mutate_magnitudes.mutated(Random(random.randrange(2**32))).encode())


def of_expectations(random: Random) -> Case:
    """What a spec expects of its results."""
    tree, codes = random_expectation(random)
    return Case({SPEC: sources.text(tree), **sources.tables()}, (("check", SPEC, "--format", "json"),), codes)


def of_commands(random: Random) -> Case:
    """A command line on a spec that is right."""
    tree = sources.tree(random.choice(sources.names()))
    return Case({SPEC: sources.text(tree), **sources.tables()}, (random_command(random, tree),), given=True)


def validated(random: Random, content: bytes) -> Case:
    """Validate a spec, and where it is fine do more with it."""
    return Case({SPEC: content, **sources.tables()}, (("validate", SPEC), random.choice(FOLLOWING)))


class Kind(NamedTuple):
    """How a case is made, and how many of its kind are among the others."""

    make: Callable[[Random], Case]
    share: int


KINDS = {
    "spec": Kind(of_spec, 10),
    "bytes": Kind(of_bytes, 4),
    "expressions": Kind(of_expressions, 3),
    "expectations": Kind(of_expectations, 2),
    "commands": Kind(of_commands, 4),
    "magnitudes": Kind(of_magnitudes, 2),
}
