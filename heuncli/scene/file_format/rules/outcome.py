"""Predict what the results will hold, as result paths name it: dimension and shape of every quantity."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, TypeAlias

from heuncli.base import units as u
from heuncli.base.errors import Finding
from heuncli.base.joint_kinds import RATES, TYPES
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import find_similar, list_words, suggest
from heuncli.results.path_words import (  # fmt: skip
    NAMES,
    NO_RUN,
    TREE,
    Node,
    find_child,
    find_position_word,
    is_cut_word,
    split_leading_key,
    split_path,
)
from heuncli.results.results_schema import CUT, IMPULSES, INSTANT, Quantity, Shape, parse_index
from heuncli.scene.file_format.names import GROUND, SceneNames, list_sticking_names, name_sticking_event
from heuncli.scene.file_format.profiles import STRESS_POINTS
from heuncli.scene.file_format.rules.registry import DraftDocument
from heuncli.scene.file_format.rules.sections import is_cut_series
from heuncli.scene.file_format.semantics import limitable_coordinates

NUMBER = "NUMBER"
TWO_WORD_KEYS, ALL_NAMES = ".", ".."  # keys of the cache that no path can have


class NumberKind(NamedTuple):
    """Numbers in the results.

    dimensions: those they may have
    axes: of one instant
    is_timed: whether there is one per instant
    instant: index of the instant that the path names, or None
    is_known: whether dimensions and axes are known before the run
    """

    dimensions: tuple[u.Dimension, ...]
    axes: Shape
    is_timed: bool
    instant: int | None = None
    is_known: bool = True


class UnknownWord(NamedTuple):
    """The word of a path that leads nowhere (empty: the path ends too early), and the words that would be valid
    there.
    """

    word: str
    valid_words: Collection[str]


class TextResult(NamedTuple):
    """The path leads to text or names, not to a number."""


# a Finding: an invalid place along a series of cuts; None: the entry could not be read
PathTarget: TypeAlias = NumberKind | UnknownWord | TextResult | Finding | None
UNKNOWN_NUMBER = NumberKind((), (), is_timed=False, is_known=False)


class ResolvedPath(NamedTuple):
    """A quantity, the keys that lead to it, and the remaining words, which select some of its numbers."""

    quantity: Quantity
    keys: list[str]
    selectors: list[str]


def find_cut_series(draft: DraftDocument) -> dict[str, bool]:
    """Return, for each section that could be read, whether it is a series of cuts."""
    return {name: is_cut_series(section) for name, section in draft.document.sections.items()}


def find_path_target(draft: DraftDocument, path: str) -> PathTarget:
    """Return what a path leads to in a document; cached."""
    if path not in draft.path_targets:
        draft.path_targets[path] = resolve_path(split_path(path), draft.names, find_cut_series(draft))
    target: PathTarget = draft.path_targets[path]
    return target


def resolve_path(path: list[str], names: SceneNames, cut_series: Mapping[str, bool]) -> PathTarget:
    """Return what the words of a path lead to.

    cut_series: of each section, whether it is a series of cuts
    """
    resolved = follow_path(path, names)
    if not isinstance(resolved, ResolvedPath):
        return resolved
    if not resolved.quantity.units:
        return TextResult() if resolved.quantity.is_words else UNKNOWN_NUMBER
    has_cut_axis, is_at_impact = False, resolved.keys[0] == IMPULSES
    keys = resolved.keys[2:] if is_at_impact else resolved.keys
    if keys[0] == "sections":
        if keys[1] not in cut_series:
            return None
        has_cut_axis = cut_series[keys[1]]
    dimensions = tuple(u.parse_unit(unit)[1] for unit in resolved.quantity.units)
    is_timed = resolved.quantity.is_timed and not is_at_impact
    whole = NumberKind(dimensions, resolved.quantity.instant_axes(has_cut_axis), is_timed)
    try:
        return select_component(*select_cut(whole, resolved.selectors))
    except Finding as finding:
        return finding


def follow_path(path: list[str], names: SceneNames) -> ResolvedPath | UnknownWord | None:
    """Return the quantity that the first words of a path lead to."""
    node: Node | Quantity | None = TREE
    keys: list[str] = []
    remaining = path
    while isinstance(node, dict):
        valid_keys = list_keys(node, keys, names)
        key, remainder = split_leading_key(valid_keys, remaining)
        if (
            NUMBER in node and remaining[:1] and parse_index(remaining[0]) is not None
        ):  # their number is known only after the run
            key, remainder = remaining[0], remaining[1:]
        if key is None:
            return UnknownWord(join_unknown_words(remaining, keys, names) if remaining else "", valid_keys)
        node, remaining = find_child(node, key), remainder
        keys.append(key)
    return ResolvedPath(node, keys, remaining) if node is not None else None


def list_keys(node: Node, parent_keys: list[str], names: SceneNames) -> Collection[str]:
    """List the keys that the results will have below `parent_keys`: words of the schema, and names of the scene.

    The list is cached, because thousands of expectations look up those of thousands of bodies.
    """
    cache_key = tuple(parent_keys)
    if cache_key not in names.keys:
        is_impact = parent_keys[:1] == [IMPULSES]
        valid_keys = [key for word in node for key in expand_schema_word(word, names, is_impact)]
        if parent_keys[:1] == ["coordinates"]:
            valid_keys = [key for key in valid_keys if has_coordinate(parent_keys[1:], key, names)]
        if len(object_keys := parent_keys[2:] if is_impact else parent_keys) == 2 and object_keys[0] == "stops":
            valid_keys = [key for key in valid_keys if key in find_stop_loads(find_stop(parent_keys[-1], names))]
        names.keys[cache_key] = dict.fromkeys(valid_keys)
    return names.keys[cache_key]


def join_unknown_words(path: list[str], parent_keys: list[str], names: SceneNames) -> str:
    """Return the leading words of a path that are no key: two of them if some two-word key begins with the first."""
    cache_key = (*parent_keys, TWO_WORD_KEYS)
    if cache_key not in names.keys:
        names.keys[cache_key] = dict.fromkeys(
            key.partition(".")[0] for key in names.keys[tuple(parent_keys)] if "." in key
        )
    return ".".join(path[: 2 if path[0] in names.keys[cache_key] else 1])


def has_coordinate(joint_words: list[str], key: str, names: SceneNames) -> bool:
    """Whether a joint has coordinates or, if the joint is given, whether it has the coordinate `key`."""
    kind = TYPES.get(names.joints[joint_words[0] if joint_words else key])
    if kind is None:
        return True
    coordinates = {*kind.coordinates, *(TYPES[kind.planar].coordinates if kind.planar in TYPES else ())}
    if not joint_words or len(coordinates) == 2:
        return bool(coordinates)
    return key in {word for quantity in coordinates for word in (quantity, RATES[quantity], "acceleration")}


STOP_LOADS = {"moment": "an angle", "force": "a travel or length"}


def find_stop(name: str, names: SceneNames) -> Any:
    """Return the stop of a name, or what a latch of that name holds; of a spec, or as plain data that may have
    errors.
    """
    entry = names.entries["latches"].get(name, names.entries["stops"].get(name))
    if name not in names.entries["latches"] or not isinstance(entry, dict):
        return entry
    if "stop" in entry:
        return names.entries["stops"].get(str(entry["stop"]))
    kind = TYPES.get(names.joints.get(str(entry.get("joint")), ""))
    return dict.fromkeys(limitable_coordinates(kind)) if kind is not None else None


def find_stop_loads(stop: Any) -> set[str]:
    """Return what a stop exerts, by the coordinate that it limits; the stop is from a spec, or plain data with
    errors.
    """
    words = stop if isinstance(stop, dict) else {getattr(stop, "quantity", "")}
    loads = {
        "moment" if quantity == "angle" else "force" for quantity in ("angle", "travel", "length") if quantity in words
    }
    return loads or set(STOP_LOADS)


def find_path_error(path: str, names: SceneNames, cut_series: Mapping[str, bool]) -> tuple[str, str] | None:
    """Return what is wrong with a path into the results, and a hint; None if nothing is wrong or only the run can
    tell.
    """
    target = resolve_path(split_path(path), names, cut_series)
    if isinstance(target, Finding):
        return f"'{path}': {target.message}", target.hint
    if isinstance(target, TextResult):
        return f"'{path}' is text, not a number", words_hint(path)
    if not isinstance(target, UnknownWord):
        return None
    for load, coordinate_text in STOP_LOADS.items():
        if target.word in STOP_LOADS and list(target.valid_words) == [load]:
            return (
                f"'{path}': '{target.word}' is not a result",
                f"a stop of {coordinate_text} exerts a {load}: write {load}",
            )
    from heuncli.results.path_hints import find_similar_path  # only needed for an error

    suggestion = find_similar_path(
        path, lambda words: isinstance(found := resolve_path(words, names, cut_series), NumberKind) and found.is_known
    )
    message = f"'{path}': '{target.word}' is not a result" if target.word else f"'{path}' is not a number"
    if suggestion is not None:
        return message, f"did you mean {suggestion}?"
    return message, names_hint(split_path(path), target, names)


def words_hint(path: str) -> str:
    """Return a hint on what to name instead of text: for the text about indeterminate components, a component."""
    block, _, last = path.rpartition(".")
    if last == "open":
        return f"to expect an open component write {{of: {block}.force.z, is: null}}"
    return "give a number: joints.NAME.force.z, sections.NAME.N, energy.kinetic, ..."


def names_hint(path: list[str], unknown: UnknownWord, names: SceneNames) -> str:
    """Return a hint on what may stand where a path leads nowhere."""
    block, *further_words = path
    if not unknown.word:
        return f"continue it with one of {list_words(unknown.valid_words)}"
    if unknown.word.startswith("@"):
        return NO_RUN
    if not unknown.valid_words:
        is_empty_block = block in names.entries and not names.entries[block]
        return f"the model has no {block}" if is_empty_block and further_words else "leave it out: the path ends here"
    if unknown.word.startswith("-"):
        return f"places are numbered from 0: {', '.join(unknown.valid_words)}"
    if unknown.word == block and find_similar(block, unknown.valid_words) is None:
        kinds = [kind for kind, block_entries in names.entries.items() if kind in TREE and block in block_entries]
        if kinds:
            whole = f"{kinds[-1]}.{block}"
            return f"{block} is one of the {kinds[-1]}; {whole} has {', '.join(list_continuations(whole, names))}"
        if (ALL_NAMES,) not in names.keys:
            all_entries = (block_entries for kind, block_entries in names.entries.items() if kind in TREE)
            names.keys[ALL_NAMES,] = dict.fromkeys(name for block_entries in all_entries for name in block_entries)
        all_names = names.keys[ALL_NAMES,]
        suggestion = suggest(block, all_names, "names") or ""
        first_words = [key for key, row in TREE.items() if not (isinstance(row, Quantity) and row.is_words)]
        return (
            suggestion
            if find_similar(block, all_names)
            else f"{suggestion}; a path begins with one of {', '.join(first_words)}"
        )
    node = TREE.get(block)
    is_name = further_words[:1] == [unknown.word] and isinstance(node, dict) and not {*NAMES}.isdisjoint(node)
    return suggest(unknown.word, unknown.valid_words, f"names in {block}" if is_name else "quantities") or ""


def list_continuations(path: str, names: SceneNames) -> list[str]:
    """List the keys with which a path that is too short continues."""
    resolved = follow_path(path.split("."), names)
    return list(resolved.valid_words) if isinstance(resolved, UnknownWord) else []


def expand_schema_word(word: str, names: SceneNames, is_impact: bool = False) -> list[str]:
    """Return the keys of the results for a word of the schema.

    is_impact: in the results of an impact
    """
    entries = names.entries
    match word:
        case "POINT":
            return [f"{body}.{point}" for body, points in names.points.items() if body != GROUND for point in points]
        case "ELEMENT":
            shared = [f"drives.{name}" for name in entries["drives"] if name in entries["forces"]]
            earlier = {name for block in ("forces", "drives", "stops", "latches") for name in entries[block]}
            shared += [f"couplings.{name}" for name in entries["couplings"] if name in earlier]
            blocks_of_elements = ("forces", "drives", "stops", "latches", "couplings", "rolling")
            return [*(name for block in blocks_of_elements for name in entries[block]), *shared]
        case "BODY":
            return list(entries["bodies"])
        case "JOINT":
            return list(entries["joints"])
        case "SECTION":
            return list(entries["sections"])
        case "BEARING":
            return ["0", "1"]
        case "SENSOR":
            return list(entries["sensors"])
        case "CORNER":
            return [*STRESS_POINTS]
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
            sticking = [name_sticking_event(name) for name in list_sticking_names(entries)]
            return [*entries["events"], *entries["latches"], *sticking]
        case "CAUSE":
            if is_impact:  # causes of impacts: impulses, drives, and joints, stops and couplings that close
                blocks = ("impulses", "joints", "stops", "latches", "couplings")
                return [*(name for block in blocks for name in entries[block]), "drives"]
            return ["gravity", *entries["forces"], *entries["couplings"], "drives", "motion"]
    return [word]


def select_cut(run_kind: NumberKind, words: list[str]) -> tuple[NumberKind, list[str]]:
    """Remove the place along a series of cuts from a quantity and its words, if the words name one. Raises Finding."""
    word = find_position_word(words)
    if CUT not in run_kind.axes or not words:
        return run_kind, words
    remaining = words.copy()
    index = words.index(word) if word is not None else int(run_kind.is_timed and len(words) > len(run_kind.axes))
    if not is_cut_word(words[index]):
        return run_kind, words
    from heuncli.results.cut_rows import parse_cut  # few paths name one

    parse_cut(remaining.pop(index))
    return run_kind._replace(axes=tuple(axis for axis in run_kind.axes if axis is not CUT)), remaining


def select_component(whole: NumberKind, words: list[str]) -> NumberKind | UnknownWord:
    """Apply the remaining words as indices: along the axes, or along the instants first."""
    axes, is_timed, instant = whole.axes, whole.is_timed, None
    if is_timed and len(words) == len(axes) + 1:
        axes, is_timed, instant = (INSTANT, *axes), False, parse_index(words[0])
    if len(words) > len(axes):
        return UnknownWord(words[len(axes)], [])
    for word, axis in zip(words, axes, strict=False):
        if axis.find_index(word) is None:
            return UnknownWord(word, list(axis.letters) or ["0, 1, 2, ..."])
    return whole._replace(axes=axes[len(words) :], is_timed=is_timed, instant=instant)
