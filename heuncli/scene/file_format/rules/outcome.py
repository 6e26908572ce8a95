"""What the results will hold, as the paths of expectations name it: dimension and shape of every quantity."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, TypeAlias

from heuncli.base import units as u
from heuncli.base.errors import Finding
from heuncli.base.joint_kinds import RATES, TYPES
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.nearest import did_you_mean, listed, nearest
from heuncli.results.results_schema import (
    BLOWS,
    CUT,
    INSTANT,
    TREE,
    Node,
    Quantity,
    Shape,
    below,
    counted,
    leading_key,
)  # fmt: skip
from heuncli.results.run_places import NO_RUN, marked, names_a_cut, words_of
from heuncli.scene.file_format.names import GROUND, Names
from heuncli.scene.file_format.rules.registry import DraftDocument
from heuncli.scene.file_format.rules.sections import is_run
from heuncli.scene.file_format.semantics import limitable

NUMBER = "NUMBER"
IN_TWO_WORDS, EVERYWHERE = ".", ".."  # places of keys that no path has


class NumberKind(NamedTuple):
    """Numbers: the dimensions they may have, the axes of one instant, and whether they run over the instants.

    instant: the number of the instant that the path names. known: whether dimensions and axes are, before the run.
    """

    dimensions: tuple[u.Dimension, ...]
    axes: Shape
    timed: bool
    instant: int | None = None
    known: bool = True


class UnknownWord(NamedTuple):
    """The word of a path that leads nowhere (empty: it ends too early), with those that would lead on."""

    word: str
    known: Collection[str]


class InWords(NamedTuple):
    """What stands there is text, or names: no number."""


# a Finding tells what is wrong with the place along a run of cuts; None: of what could not be read
Result: TypeAlias = NumberKind | UnknownWord | InWords | Finding | None
ONLY_THE_RUN_TELLS = NumberKind((), (), timed=False, known=False)


class Reached(NamedTuple):
    """A quantity, the keys that lead to it, and the words that say which of its numbers are meant."""

    quantity: Quantity
    keys: list[str]
    rest: list[str]


def runs_of(draft: DraftDocument) -> dict[str, bool]:
    """Whether the sections that could be read are runs of cuts."""
    return {name: is_run(section) for name, section in draft.document.sections.items()}


def reached_in(draft: DraftDocument, path: str) -> Result:
    """What a path leads to in a document."""
    if path not in draft.reached:
        draft.reached[path] = result(words_of(path), draft.names, runs_of(draft))
    found: Result = draft.reached[path]
    return found


def result(path: list[str], names: Names, runs: Mapping[str, bool]) -> Result:
    """What the words of a path lead to; runs: of the sections, whether they are runs of cuts."""
    reached = follow(path, names)
    if not isinstance(reached, Reached):
        return reached
    if not reached.quantity.units:
        return InWords() if reached.quantity.is_words else ONLY_THE_RUN_TELLS
    run, at_a_blow = False, reached.keys[0] == BLOWS
    keys = reached.keys[2:] if at_a_blow else reached.keys
    if keys[0] == "sections":
        if keys[1] not in runs:
            return None
        run = runs[keys[1]]
    dimensions = tuple(u.parse_unit(unit)[1] for unit in reached.quantity.units)
    timed = reached.quantity.timed and not at_a_blow
    whole = NumberKind(dimensions, reached.quantity.axes(run), timed)
    try:
        return part(*at_a_cut(whole, reached.rest))
    except Finding as finding:
        return finding


def follow(path: list[str], names: Names) -> Reached | UnknownWord | None:
    """The quantity that the first words of a path lead to."""
    node: Node | Quantity | None = TREE
    keys: list[str] = []
    rest = path
    while isinstance(node, dict):
        known = keys_in(node, keys, names)
        key, behind = leading_key(known, rest)
        if NUMBER in node and rest[:1] and counted(rest[0]) is not None:  # how many there are, only the run tells
            key, behind = rest[0], rest[1:]
        if key is None:
            return UnknownWord(unknown_word(rest, keys, names) if rest else "", known)
        node, rest = below(node, key), behind
        keys.append(key)
    return Reached(node, keys, rest) if node is not None else None


def keys_in(node: Node, above: list[str], names: Names) -> Collection[str]:
    """The keys that the results will have there: words of the schema, and names of the scene; above: where it is.

    They are gathered once: thousands of expectations ask for those of thousands of bodies.
    """
    place = tuple(above)
    if place not in names.keys:
        struck = above[:1] == [BLOWS]
        known = [key for word in node for key in named(word, names, struck)]
        if above[:1] == ["coordinates"]:
            known = [key for key in known if has_coordinate(above[1:], key, names)]
        if len(own := above[2:] if struck else above) == 2 and own[0] == "stops":
            known = [key for key in known if key in loads_of_stop(stop_meant(above[-1], names))]
        names.keys[place] = dict.fromkeys(known)
    return names.keys[place]


def unknown_word(path: list[str], above: list[str], names: Names) -> str:
    """The leading words of a path that spell no key: two of them where keys in two words begin with the first."""
    place = (*above, IN_TWO_WORDS)
    if place not in names.keys:
        names.keys[place] = dict.fromkeys(key.partition(".")[0] for key in names.keys[tuple(above)] if "." in key)
    return ".".join(path[: 2 if path[0] in names.keys[place] else 1])


def has_coordinate(joint: list[str], key: str, names: Names) -> bool:
    """Whether a joint, the key or the one given, has coordinates, or this one."""
    kind = TYPES.get(names.joints[joint[0] if joint else key])
    if kind is None:
        return True
    own = {*kind.coordinates, *(TYPES[kind.planar].coordinates if kind.planar in TYPES else ())}
    if not joint or len(own) == 2:
        return bool(own)
    return key in {word for quantity in own for word in (quantity, RATES[quantity], "acceleration")}


EXERTED = {"moment": "an angle", "force": "a travel or length"}


def stop_meant(name: str, names: Names) -> Any:
    """The stop of a name, or what a latch of that name holds; of a spec, or as plain data that may be in error."""
    own = names.entries["latches"].get(name, names.entries["stops"].get(name))
    if name not in names.entries["latches"] or not isinstance(own, dict):
        return own
    if "stop" in own:
        return names.entries["stops"].get(str(own["stop"]))
    kind = TYPES.get(names.joints.get(str(own.get("joint")), ""))
    return dict.fromkeys(limitable(kind)) if kind is not None else None


def loads_of_stop(stop: Any) -> set[str]:
    """What a stop exerts, by the coordinate that it limits; stop: of a spec, or as plain data that may be in error."""
    words = stop if isinstance(stop, dict) else {getattr(stop, "quantity", "")}
    found = {
        "moment" if quantity == "angle" else "force" for quantity in ("angle", "travel", "length") if quantity in words
    }
    return found or set(EXERTED)


def wrong_path(path: str, names: Names, runs: Mapping[str, bool]) -> tuple[str, str] | None:
    """What is wrong with a path into the results, and a hint; None: nothing, or only the run can tell."""
    reached = result(words_of(path), names, runs)
    if isinstance(reached, Finding):
        return f"'{path}': {reached.message}", reached.hint
    if isinstance(reached, InWords):
        return f"'{path}' is words, not a number", words_hint(path)
    if not isinstance(reached, UnknownWord):
        return None
    for own, limited in EXERTED.items():
        if reached.word in EXERTED and list(reached.known) == [own]:
            return f"'{path}': '{reached.word}' is not a result", f"a stop of {limited} exerts a {own}: write {own}"
    from heuncli.results.path_hints import meant  # only on the way to an error

    likely = meant(path, lambda words: isinstance(found := result(words, names, runs), NumberKind) and found.known)
    what = f"'{path}': '{reached.word}' is not a result" if reached.word else f"'{path}' is not a number"
    if likely is not None:
        return what, f"did you mean {likely}?"
    return what, names_hint(words_of(path), reached, names)


def words_hint(path: str) -> str:
    """What to name in place of words: of those that tell what is open, a component."""
    block, _, last = path.rpartition(".")
    if last == "open":
        return f"that a component is open is expected of itself: {{of: {block}.force.z, is: null}}"
    return "name a number: joints.NAME.force.z, sections.NAME.N, energy.kinetic, ..."


def names_hint(path: list[str], reached: UnknownWord, names: Names) -> str:
    """What may stand at the place where a path leads nowhere."""
    block, *rest = path
    if not reached.word:
        return f"it goes on with one of {listed(reached.known)}"
    if reached.word.startswith("@"):
        return NO_RUN
    if not reached.known:
        of_scene = block in names.entries and not names.entries[block]
        return f"the scene has no {block}" if of_scene and rest else "leave it out: the path ends before it"
    if reached.word.startswith("-"):
        return f"places are counted from 0, from the first on: {', '.join(reached.known)}"
    if reached.word == block and nearest(block, reached.known) is None:
        kinds = [kind for kind, own in names.entries.items() if kind in TREE and block in own]
        if kinds:
            whole = f"{kinds[-1]}.{block}"
            return f"{block} is one of the {kinds[-1]}; {whole} has {', '.join(keys_behind(whole, names))}"
        if (EVERYWHERE,) not in names.keys:
            every = (own for kind, own in names.entries.items() if kind in TREE)
            names.keys[EVERYWHERE,] = dict.fromkeys(name for own in every for name in own)
        known = names.keys[EVERYWHERE,]
        told = did_you_mean(block, known, "names") or ""
        begin = [key for key, row in TREE.items() if not (isinstance(row, Quantity) and row.is_words)]
        return told if nearest(block, known) else f"{told}; a path begins with one of {', '.join(begin)}"
    return did_you_mean(reached.word, reached.known, "words here") or ""


def keys_behind(path: str, names: Names) -> list[str]:
    """The keys with which a path that is too short goes on."""
    reached = follow(path.split("."), names)
    return list(reached.known) if isinstance(reached, UnknownWord) else []


def named(word: str, names: Names, struck: bool = False) -> list[str]:
    """What stands in the results where the schema has this word; struck: in those of a blow."""
    entries = names.entries
    match word:
        case "POINT":
            return [f"{body}.{point}" for body, points in names.points.items() if body != GROUND for point in points]
        case "ELEMENT":
            shared = [f"drives.{name}" for name in entries["drives"] if name in entries["forces"]]
            earlier = {name for block in ("forces", "drives", "stops", "latches") for name in entries[block]}
            shared += [f"couplings.{name}" for name in entries["couplings"] if name in earlier]
            own = ("forces", "drives", "stops", "latches", "couplings", "rolling")
            return [*(name for block in own for name in entries[block]), *shared]
        case "BODY":
            return list(entries["bodies"])
        case "JOINT":
            return list(entries["joints"])
        case "SECTION":
            return list(entries["sections"])
        case "STOP":
            return [*entries["stops"], *entries["latches"]]
        case "COUPLING":
            return [*entries["couplings"], *entries["rolling"]]
        case "END":
            return [*entries["bodies"], GROUND]
        case "NUMBER":
            return ["0", "1", "2"]
        case "FORCE":
            return list(entries["forces"])
        case "EVENT":
            return [*entries["events"], *entries["latches"]]
        case "CAUSE":
            if struck:  # what may strike: blows, drives, and what closes
                blocks = ("impulses", "joints", "stops", "latches", "couplings")
                return [*(name for block in blocks for name in entries[block]), "drives"]
            return ["gravity", *entries["forces"], *entries["couplings"], "drives", "motion"]
    return [word]


def at_a_cut(whole: NumberKind, words: list[str]) -> tuple[NumberKind, list[str]]:
    """What is left of a quantity along a run of cuts, and of the words, where one names a place. Raises Finding."""
    word = marked(words)
    if CUT not in whole.axes or not words:
        return whole, words
    left = words.copy()
    k = words.index(word) if word is not None else int(whole.timed and len(words) > len(whole.axes))
    if not names_a_cut(words[k]):
        return whole, words
    from heuncli.results.cut_rows import place_of  # few paths name one

    place_of(left.pop(k))
    return whole._replace(axes=tuple(axis for axis in whole.axes if axis is not CUT)), left


def part(whole: NumberKind, words: list[str]) -> NumberKind | UnknownWord:
    """What is left of a quantity where indices are given: along its axes, or along the instants first."""
    axes, timed, instant = whole.axes, whole.timed, None
    if timed and len(words) == len(axes) + 1:
        axes, timed, instant = (INSTANT, *axes), False, counted(words[0])
    if len(words) > len(axes):
        return UnknownWord(words[len(axes)], [])
    for word, axis in zip(words, axes, strict=False):
        if axis.index_of(word) is None:
            return UnknownWord(word, list(axis.letters) or ["0, 1, 2, ..."])
    return whole._replace(axes=axes[len(words) :], timed=timed, instant=instant)
