"""Specs whose numbers are of any magnitude: of a spec one to three numbers become ±10^u, 0 or a denormal, by a seed."""

from __future__ import annotations

import re
from random import Random

from tests.shared.folders import SPECS

# a number that is no part of a name, nor of the format's version; its unit stays behind it
NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.])")
SPECIAL = ("0", "-0.0", "5e-324", "-2e-310", "1.8e308", "1e-60", "1e60", "-1e-60", "9.9e59")


def mutated(random: Random) -> str:
    """Some spec with such numbers, without its comments and expectations."""
    path = random.choice(sorted(SPECS.glob("*.yaml")))
    lines = [line.partition(" #")[0] for line in path.read_text().splitlines() if not line.startswith("#")]
    text = "\n".join(lines).partition("\nexpect:")[0] + "\n"
    places = [found.span() for found in NUMBER.finditer(text) if not text[: found.start()].endswith("heun: ")]
    places = [(a, b) for a, b in places if "title:" not in text[text.rfind("\n", 0, a) : a]]
    for a, b in sorted(random.sample(places, random.randint(1, min(3, len(places)))), reverse=True):
        text = text[:a] + magnitude(random) + text[b:]
    return text


def magnitude(random: Random) -> str:
    """A number of any magnitude, as it is written: often within what is computed with, sometimes beyond."""
    if random.random() < 0.08:
        return random.choice(SPECIAL)
    reach = random.choice(((-320.0, 308.0), *[(-59.0, 59.0)] * 3, *[(-20.0, 20.0)] * 2, *[(-6.0, 6.0)] * 3))
    power = random.uniform(*reach)
    figure = f"{10.0 ** (power % 1.0):.3f}e{int(power // 1.0)}"
    return f"-{figure}" if random.random() < 0.2 else figure
