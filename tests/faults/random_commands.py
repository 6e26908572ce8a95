"""Random command lines, from the rows of options that the commands themselves are made from."""

from __future__ import annotations

from collections.abc import Callable
from random import Random

from heuncli.app.cli.options import RequestField, list_fields
from heuncli.app.cli.registry import find_command
from tests.faults import sources
from tests.faults.mutate_spec import UNITS, misspelt, vocabulary
from tests.faults.random_expressions import random_expression

SPEC = "spec.yaml"
LIMIT = "2"  # seconds that a run may take
QUICK = ("run", "run", "run", "run", "validate", "model", "model", "modes", "balance", "probe", "check", "methods")
# of chart one cheap curve; all of them would take a minute a case
CHEAP = {"chart": ("--methods", "RK4", "--steps", "0.01", "--time-limit", LIMIT)}
NUMBERS = (
    "0", "1", "0.1", "0.25", "1e-6", "-1", "nan", "inf", "1e300", "1e-300", "1e999", "", " ", "x", "0,1", "1_0", "٣",
    "0x1", "1e3",
)  # fmt: skip
WORDS = (
    "", "-", "--", "x", "é", "\x1b[31m", "a\nb", "\udc80", "\u202e", "null", ".", "..", "a" * 300, "%s", "{}", "$x",
    "=", ",", ",,",
)  # fmt: skip
FILES = (
    "out.json", "out.csv", "out.txt", "out.md", "out", "out.xyz", "-", "", SPEC, "./" + SPEC, "no/such/out",
    "/dev/full", "/dev/null",
    ".", "a" * 300, "é.json", "engine.csv", "\udc80.json", "x\n.json", "/dev/stdout", "out.svg",
)  # fmt: skip
HOWS = ("", "max", "min", "max abs", "abs", "first", "final", "at 0.1", "at 1e9", "at nan", "mean", "max max", "at")
BLOCKS = (
    "motion", "points", "foundation", "joints", "sections", "forces", "energy", "impulses", "events", "shares",
    "stops", "bodies",
    "coordinates", "accuracy", "work", "status", "title", "certain_sums",
)  # fmt: skip
COMPONENTS = (
    "force",
    "moment",
    "force.z",
    "N",
    "M2",
    "position",
    "kinetic",
    "drive",
    "x",
    "0",
    "-1",
    "99",
    "s",
    "time",
    "value",
)


def random_command(random: Random, tree: sources.Tree) -> tuple[str, ...]:
    """A command line on the file SPEC, which holds this tree."""
    command = random.choice(QUICK) if random.random() < 0.97 else "chart"
    words = [command]
    row = find_command(command)
    assert row is not None
    options = list_fields(row.request)
    if any(not row.option.words for row in options):
        words += (
            [SPEC]
            if random.random() < 0.96
            else random.choices((SPEC, "no.yaml", "", "-", ".", *WORDS), k=random.randrange(3))
        )
    words += CHEAP.get(command, ())
    named = [row for row in options if row.option.words]
    for row in random.choices(named, k=random.choice((0, 1, 1, 2, 2, 3, 5))) if named else ():
        words += _option(random, row, tree)
    if any(row.name == "time_limit" for row in named) and "--time-limit" not in words:
        words += ["--time-limit", LIMIT]
    if random.random() < 0.05:
        words.insert(
            random.randrange(len(words)), random.choice(("--help", "--version", "--", "-x", "--no-such", *WORDS))
        )
    if random.random() < 0.02:
        random.shuffle(words)
    return tuple(words)


def _option(random: Random, row: RequestField, tree: sources.Tree) -> list[str]:
    """An option with a value, in one of the ways that it may be written in."""
    word = random.choice(row.option.words)
    if row.type is bool:
        return [word] if random.random() < 0.97 else [word, "true"]
    if random.random() < 0.02:
        return [word]
    value = random.choice(NUMBERS) if random.random() < 0.3 else VALUES.get(row.name, number)(random, tree)
    return [f"{word}={value}"] if word.startswith("--") and random.random() < 0.3 else [word, value]


def number(random: Random, _: sources.Tree) -> str:
    return random.choice(NUMBERS)


def time_limit(random: Random, _: sources.Tree) -> str:
    return random.choice(("1", LIMIT, "0.01", "1e-9", "-1", "nan", "x"))


def setting(random: Random, tree: sources.Tree) -> str:
    """`NAME=VALUE` of a parameter, of a dotted key that there is, or of neither."""
    name = random.choice(
        (*tree.get("parameters", ("x",)), dotted(random, tree), random.choice(vocabulary()), random.choice(WORDS))
    )
    value = random.choice((
        *NUMBERS, f"1 {random.choice(UNITS)}", random_expression(random), "[0, 0, 1]", "{a: 1}", "[", "²", "null",
        "true", *WORDS,
    ))  # fmt: skip
    return f"{name}={value}" if random.random() < 0.95 else random.choice((name, value))


def dotted(random: Random, tree: sources.Tree) -> str:
    """The path of some value, now and then misspelt."""
    path: list[str] = []
    while isinstance(tree, dict | list) and tree and random.random() < 0.9:
        key = random.choice(list(tree) if isinstance(tree, dict) else range(len(tree)))
        path, tree = [*path, str(key)], tree[key]
    word = ".".join(path)
    return word if random.random() < 0.8 else misspelt(random, word)


def entry(random: Random, tree: sources.Tree) -> str:
    """A block of the results, or an entry of one, or what is none."""
    block = random.choice(BLOCKS)
    names = list(tree.get(block, ())) if isinstance(tree.get(block), dict) else []
    word = f"{block}.{random.choice(names)}" if names and random.random() < 0.6 else block
    return word if random.random() < 0.85 else misspelt(random, word)


def several(random: Random, tree: sources.Tree) -> str:
    return ",".join(entry(random, tree) for _ in range(random.choice((1, 1, 2, 4))))


def measure(random: Random, tree: sources.Tree) -> str:
    """`max abs PATH` and the like."""
    path = ".".join([entry(random, tree), *random.choices(COMPONENTS, k=random.choice((0, 1, 1, 2)))])
    return f"{random.choice(HOWS)} {path}".strip()


def units(random: Random, _: sources.Tree) -> str:
    return ",".join(random.choices(UNITS, k=random.choice((1, 2, 3))))


def chosen(*words: str) -> Callable[[Random, sources.Tree], str]:
    """One of some words, or what looks alike."""
    return lambda random, _: random.choice(words) if random.random() < 0.8 else misspelt(random, random.choice(words))


def file(random: Random, _: sources.Tree) -> str:
    return random.choice(FILES)


VALUES: dict[str, Callable[[Random, sources.Tree], str]] = {
    "format": chosen("table", "json", "csv", "markdown", "text"), "output": file, "save": file, "junit": file,
    "golden": file,
    "only": several, "set": setting, "measure": measure, "units": units, "axes": chosen("world", "from", "to"),
    "method": chosen("auto", "DOP853", "RK4", "Radau5", "LSODA", "Gauss4", "Euler"), "methods": chosen("RK4", "DOP853",
    "RK4,Euler"),
    "time_limit": time_limit, "steps": chosen("0.01", "0.1,0.01"), "tolerances": chosen("1e-6", "1e-4,1e-6"),
}  # fmt: skip
