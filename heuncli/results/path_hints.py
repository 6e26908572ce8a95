"""Guess what was meant by a path that is not in the results: `shaft.angle`, `elbow.Fz`, `bodies.bar.z`.

The path is tried in other words: behind each block of the results, in place of its first word, with components as other
programs spell them. The first one that leads to a number is suggested; the caller knows which paths lead to numbers.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import islice, product

from heuncli.base.spelling import find_similar, spend_effort
from heuncli.results.path_words import NAMES, join_path, split_path
from heuncli.results.results_schema import BLOCKS_KNOWN_AFTER_RUN, IMPULSES, ROWS, XYZ

COMMON = ("joints", "coordinates", "sections", "bodies", "points", "forces")  # tried first
ALIASES = {  # what other programs and textbooks call quantities, by what they are here, the likeliest first
    "force": ("f", "force", "reaction", "load", "forces"),
    "moment": ("m", "moment", "torque", "couple", "moments"),
    "center": ("pos", "position", "com", "cog", "centre", "displacement"),
    "position": ("pos", "center", "displacement", "coordinates"),
    "velocity": ("v", "vel", "speed"),
    "center_velocity": ("v", "vel", "velocity"),
    "acceleration": ("a", "acc", "alpha"),
    "center_acceleration": ("a", "acc", "acceleration"),
    "angular_velocity": ("w", "omega", "rate", "spin"),
    "angular_acceleration": ("alpha", "acceleration"),
    "angle": ("phi", "theta", "rotation", "position"),
    "rate": ("omega", "speed", "velocity", "w"),
    "travel": ("s", "position", "displacement", "stroke"),
    "speed": ("v", "rate", "velocity"),
    "tension": ("force", "n", "axial"),
    "N": ("axial", "normal", "tension"),
    "kinetic": ("kin", "kinetic_energy", "t"),
    "potential": ("pot", "potential_energy", "v"),
    "drive": ("torque", "motor", "moment", "force"),
    "value": ("force", "torque"),
}
MAGNITUDE = frozenset({"mag", "magnitude", "norm", "abs", "total", "resultant", "res", "xyz", "len", "value", "r"})
DEFAULT_QUANTITIES = ("force", "center", "position", "angle", "travel", "value", "N")  # where a path names no quantity
INNER_BLOCKS = ("stress", "deflection", "axis", "mass_effect", "supports", "elements", "line")
COMPONENT = re.compile(r"(.+?)_?([xyz])\Z", re.IGNORECASE)
BALANCE = "system_vector"  # rarely requested, and never by a short name
MAX_READINGS = 5000  # readings that are tried
MAX_WORDS = 8  # of a path; no path into the results has more, and each may be read in several ways
EFFORT_PER_PATH = 500_000  # of nearest.EFFORT: some thirty paths of a file are read in other words


def find_similar_path(path: str, is_number: Callable[[list[str]], bool]) -> str | None:
    """Find a similar path that leads to a number; None if there is none."""
    words = split_path(path)
    if len(words) > MAX_WORDS or not spend_effort(EFFORT_PER_PATH):
        return None
    candidates = (reading for reading in islice(iter_readings(words), MAX_READINGS) if reading != words)
    return next((join_path(reading) for reading in candidates if is_number(reading)), None)


def iter_readings(words: Sequence[str]) -> Iterator[list[str]]:
    """Yield the path in other words, the likeliest first."""
    if len(words) > 1 and words[-1].lower() in MAGNITUDE:  # a vector counts by its magnitude
        yield from iter_block_readings([words[:-1]], BLOCKS)
    respelled = ([part for parts in each for part in parts] for each in product(*map(find_spellings, words)))
    yield from iter_block_readings(respelled, BLOCKS)
    if len(words) > 1 and words[-1].lower() in MAGNITUDE:
        words = words[:-1]
    yield from iter_block_readings(complete_words(words), [(block,) for block in COMMON])


def iter_block_readings(word_lists: Iterable[Sequence[str]], blocks: Sequence[tuple[str, ...]]) -> Iterator[list[str]]:
    """Yield each path as it is, behind each block, and with each block in place of its first word."""
    for words in word_lists:
        yield list(words)
        yield from ([*block, *words] for block in blocks)
        if len(words) > 1 and find_similar(words[0], KNOWN_BLOCKS):
            yield from ([*block, *words[1:]] for block in blocks)


def complete_words(words: Sequence[str]) -> list[list[str]]:
    """Complete a path that names no quantity with one, or a path that leaves out an inner block with it."""
    place = len(words) - (words[-1].lower() in XYZ)
    if not place:
        return []
    inner = [[*words[:-1], block, words[-1]] for block in INNER_BLOCKS]
    return inner + [
        [*words[:place], quantity, *(word.lower() for word in words[place:])] for quantity in DEFAULT_QUANTITIES
    ]


def find_spellings(word: str) -> list[tuple[str, ...]]:
    """Return a word of a path, and what it may be called here; for `Fz` that is force, z."""
    quantity, component = word, tuple[str, ...]()
    match = COMPONENT.match(word)
    if match is not None:
        quantity, component = match[1], (match[2].lower(),)
    unchanged = [(word,)] if component == () else [(word,), (quantity.lower(), *component)]
    if word in ("X", "Y", "Z"):
        return [(word.lower(),)]
    return [*unchanged, *((name, *component) for name, short in ALIASES.items() if quantity.lower() in short)]


def _find_blocks() -> tuple[tuple[str, ...], ...]:
    """Return the words before the names of the scene, or before the quantity where there are none."""
    blocks: dict[tuple[str, ...], None] = {(word,): None for word in COMMON}
    for row in ROWS:
        words = row.path.split(".")
        name_index = next((i for i, word in enumerate(words) if word in NAMES), len(words) - 1)
        if row.units and name_index and words[0] not in (IMPULSES, BALANCE, *BLOCKS_KNOWN_AFTER_RUN):
            blocks[tuple(words[:name_index])] = None
    return tuple(blocks)


BLOCKS = _find_blocks()
KNOWN_BLOCKS = frozenset(word for block in BLOCKS for word in block)
