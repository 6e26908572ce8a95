"""Random expressions as a user, or somebody worse, may write them: mostly in the grammar, some of it not."""

from __future__ import annotations

from random import Random

from tests.shared.random_programs import COMPARISONS, ONE

FUNCTIONS = tuple(name for name in ONE if name != "neg")
OPERATORS = ("+", "-", "*", "/", "**")
COMPARED = dict(zip(COMPARISONS, ("<", "<=", ">", ">=", "==", "!="), strict=True))
NUMBERS = (
    "0", "1", "2", "-1", "0.5", "1e-3", "3", "7.25", "1e8", "-0", "1e60", "1e-61", "1e308", "1e999", "5e-324", "1_000",
    "0x10", "1e", "1.", ".5", "00", "1j", "9" * 40, "²", "１", "٣", "inf", "nan", "1e-9",
)  # fmt: skip
SANE = 10  # of the numbers so many are ordinary
NO_EXPRESSIONS = (
    "", " ", "(", ")", "()", "1 +", "* 2", "t t", "sin", "sin()", "sin(1, 2)", "max()", "min(1)", "atan2(1)",
    "__import__('os')", "t.__class__", "lambda: 1", "[1, 2]", "{1: 2}", "'t'", "t if t", "t if t else", "1 if",
    "a := 1",
    "t ^ 2", "2t", "2 t", "sin t", "t; t", "t\nt", "t # t", "print(t)", "open('x')", "f(t)", "table(t)", "table(gas)",
    "table(gas, t, t)", "table('gas', t)", "not", "and t", "t and", "1 < 2 < 3", "t = 1", "t == 1", "\\", "t\\\n+1",
    "t @ t", "t // 2", "t % 2", "~t", "t << 1", "1 if t > 0 else -1", "-" * 300 + "t", "not " * 100 + "t", "e", "i",
    "g",
    "sinh(1000)", "exp(exp(exp(t)))", "log(-1)", "sqrt(-t)", "asin(2)", "0/0", "1/0", "0**-1", "(-1)**0.5",
    "9**9**9**9",
    "10**400", "1e200*1e200", "step(sin(1000*t))", "abs(sin(1e9*t))", "sign(t - t)", "min(100*t, 5)", "1/t", "log(t)",
    "t**1e9", "tan(pi/2)", "atan2(0, 0)", "hypot(1e200, 1e200)", "(" * 150 + "t" + ")" * 150, "t" + "+t" * 1500,
    "t" + "*(1+t" * 60 + ")" * 60, "\u202et", "t\u200b", "t\u00a0+ 1", "√t", "π*t", "t²", "2·t", "t−1", "1,5", "1 m",
    "1 m*t",
)  # fmt: skip


def random_expression(random: Random, names: tuple[str, ...] = ("t",), wrong: float = 0.15) -> str:
    """An expression in some names; wrong: how many of a hundred are none, or end badly."""
    if random.random() < wrong:
        return random.choice(NO_EXPRESSIONS)
    return _part(random, names, random.choice((0, 1, 1, 2, 2, 3, 5)))


def _part(random: Random, names: tuple[str, ...], deep: int) -> str:
    if not deep or random.random() < 0.1:
        return _leaf(random, names)

    def part() -> str:
        return _part(random, names, deep - 1)

    match random.randrange(9):
        case 0 | 1 | 2:
            return f"{part()} {random.choice(OPERATORS)} {part()}"
        case 3:
            return f"({part()})"
        case 4 | 5:
            return f"{random.choice(FUNCTIONS)}({part()})"
        case 6:
            return f"{random.choice(('min', 'max', 'atan2', 'hypot'))}({part()}, {part()})"
        case 7:
            return f"-{part()}"
        case _:
            return f"{part()} if {_condition(random, part(), part())} else {part()}"


def _condition(random: Random, left: str, right: str) -> str:
    word = f"{left} {random.choice(list(COMPARED.values()))} {right}"
    return random.choice((word, word, f"not {word}", f"{word} and {word}", f"({word}) or t < 0"))


def _leaf(random: Random, names: tuple[str, ...]) -> str:
    if random.random() < 0.6:
        return random.choice(names)
    return random.choice(NUMBERS[:SANE] if random.random() < 0.9 else NUMBERS)
