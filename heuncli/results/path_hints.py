"""What was meant by a path that leads nowhere in the results: `shaft.angle`, `elbow.Fz`, `bodies.bar.z`.

The path is tried in other words: behind each block of the results, in place of the one it begins with, with components
as other programs spell them. The first that leads to a number is what was meant; whoever asks knows which paths lead.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import islice, product

from heuncli.base.nearest import afford, nearest
from heuncli.results.results_schema import AFTER_THE_RUN, BLOWS, NAMES, ROWS, XYZ
from heuncli.results.run_places import path_of, words_of

COMMON = ("joints", "coordinates", "sections", "bodies", "points", "forces")  # tried first
SHORT = {  # what other programs and textbooks call quantities, by what they are here, the likeliest first
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
TAKEN = ("force", "center", "position", "angle", "travel", "value", "N")  # where a path names no quantity
INNER = ("stress", "axis", "mass_effect", "supports", "elements", "line")
COMPONENT = re.compile(r"(.+?)_?([xyz])\Z", re.IGNORECASE)
BALANCE = "system_vector"  # few ask for it, and none by a short name
MOST = 5000  # readings that are tried
MOST_WORDS = 8  # of a path; no path into the results has more, and each may be read in several ways
EFFORT_HERE = 500_000  # of nearest.EFFORT: some thirty paths of a file are read in other words


def meant(path: str, leads: Callable[[list[str]], bool]) -> str | None:
    """The path that was meant, if there is one like it that leads to a number."""
    words = words_of(path)
    if len(words) > MOST_WORDS or not afford(EFFORT_HERE):
        return None
    tried = (reading for reading in islice(readings(words), MOST) if reading != words)
    return next((path_of(reading) for reading in tried if leads(reading)), None)


def readings(words: Sequence[str]) -> Iterator[list[str]]:
    """The path in other words, the likeliest first."""
    if len(words) > 1 and words[-1].lower() in MAGNITUDE:  # a vector counts by its magnitude
        yield from readings_behind_blocks([words[:-1]], BLOCKS)
    spelled = ([part for parts in each for part in parts] for each in product(*map(spellings, words)))
    yield from readings_behind_blocks(spelled, BLOCKS)
    if len(words) > 1 and words[-1].lower() in MAGNITUDE:
        words = words[:-1]
    yield from readings_behind_blocks(completed(words), [(block,) for block in COMMON])


def readings_behind_blocks(several: Iterable[Sequence[str]], blocks: Sequence[tuple[str, ...]]) -> Iterator[list[str]]:
    """Each as it is, behind a block, and with a block in place of one."""
    for words in several:
        yield list(words)
        yield from ([*block, *words] for block in blocks)
        if len(words) > 1 and nearest(words[0], KNOWN_BLOCKS):
            yield from ([*block, *words[1:]] for block in blocks)


def completed(words: Sequence[str]) -> list[list[str]]:
    """The words of a path that names no quantity, with one; of one that leaves out a block within a block, with it."""
    place = len(words) - (words[-1].lower() in XYZ)
    if not place:
        return []
    inner = [[*words[:-1], block, words[-1]] for block in INNER]
    return inner + [[*words[:place], quantity, *(word.lower() for word in words[place:])] for quantity in TAKEN]


def spellings(word: str) -> list[tuple[str, ...]]:
    """A word of a path, and what it may be called here; of `Fz` that is force, z."""
    quantity, component = word, tuple[str, ...]()
    found = COMPONENT.match(word)
    if found is not None:
        quantity, component = found[1], (found[2].lower(),)
    own = [(word,)] if component == () else [(word,), (quantity.lower(), *component)]
    if word in ("X", "Y", "Z"):
        return [(word.lower(),)]
    return [*own, *((name, *component) for name, short in SHORT.items() if quantity.lower() in short)]


def _blocks() -> tuple[tuple[str, ...], ...]:
    """The words before the names of the scene, or before the quantity where there are none."""
    found: dict[tuple[str, ...], None] = {(word,): None for word in COMMON}
    for row in ROWS:
        words = row.path.split(".")
        named = next((i for i, word in enumerate(words) if word in NAMES), len(words) - 1)
        if row.units and named and words[0] not in (BLOWS, BALANCE, *AFTER_THE_RUN):
            found[tuple(words[:named])] = None
    return tuple(found)


BLOCKS = _blocks()
KNOWN_BLOCKS = frozenset(word for block in BLOCKS for word in block)
