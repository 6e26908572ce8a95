"""Paths into the results, as in the JSON: `joints.elbow.force.z`, `impulses.0.foundation.force.z`.

Elements of lists are selected by numbers, or by x, y, z on axes of space. A path of a number at each instant stops
before the instant, or selects it as the first index.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np

from heuncli.base.errors import Finding, Problem, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import find_similar, reset_effort
from heuncli.results.cut_rows import find_cut_row
from heuncli.results.path_words import (  # fmt: skip
    NO_RUN,
    find_position_word,
    find_quantity,
    find_unknown_key,
    is_block_or_words,
    is_cut_word,
    join_path,
    split_leading_key,
    split_path,
)
from heuncli.results.results import Array, Block, Results
from heuncli.results.results_schema import CUT, IMPULSES, INDEX, INSTANT, SPACE, Axis, Quantity, Shape

MAX_NAMES = 12  # of the known names an error lists


class PathValues(NamedTuple):
    """The values at a path: with the instants first if `is_timed`, and the other axes as in the schema.

    instant: index of the instant that the path selects
    keys: the words of the path that name the quantity
    """

    values: Array
    is_timed: bool
    axes: Shape
    instant: int | None = None
    keys: tuple[str, ...] = ()

    @property
    def is_vector(self) -> bool:
        """Whether the last axis is that of a vector's components; a run of three cuts is not a vector."""
        return self.axes[-1:] == (SPACE,)


def find_values(results: Results, path: str) -> PathValues:
    """Return the values at a path; nan is indeterminate. Raises SpecError [unknown-path] with the known names where it
    fails.
    """
    try:
        return _find_path_values(results, path)
    except SpecError as error:
        from heuncli.results.path_hints import find_similar_path  # only on the way to an error

        reset_effort()  # the spec's own problems are behind
        (problem,) = error.problems
        similar = (
            find_similar_path(path, lambda words: _has_values(results, words))
            if problem.code == "unknown-path"
            else None
        )
        if similar is None:
            raise
        raise SpecError(problem._replace(hint=f"did you mean {similar}?")) from None


def _has_values(results: Results, words: Sequence[str]) -> bool:
    """Whether a path leads to values."""
    try:
        _find_path_values(results, join_path(words))
    except SpecError:
        return False
    return True


def _find_path_values(results: Results, path: str) -> PathValues:
    """Return the values at a path. The words after the quantity select a component, a cut or an instant.

    Raises SpecError [unknown-path].
    """
    keys, node, rest = _follow_keys(results, path)
    if is_block_or_words(keys):
        raise _unknown_path_error(path, keys, "", [])
    values = _to_array(path, keys, node)
    row = find_quantity(keys)
    # an impulse has one instant, and no axis for it
    is_timed = row is not None and row.is_timed and keys[0] != "impulses" and isinstance(node, np.ndarray)
    axes = _find_axes(results, keys, row, values.ndim, is_timed)
    if CUT in axes:
        values, axes, rest = _select_cut(results, path, keys, values, axes, rest)
    if len(rest) > len(axes):
        raise _unknown_path_error(path, keys, rest[len(axes)], [])
    instant = None
    if is_timed and len(rest) == len(axes):
        is_timed, instant = False, _parse_index(path, keys, rest[0], axes[0], len(values))
    elif is_timed:
        for word in rest:
            values = values[:, _parse_index(path, keys, word, axes[1], values.shape[1])]
            axes = (axes[0], *axes[2:])
        return PathValues(values, True, axes[1:], keys=tuple(keys))
    for word in rest:
        values = np.asarray(values[_parse_index(path, keys, word, axes[0], len(values))])
        axes = axes[1:]
    return PathValues(values, False, axes, instant, tuple(keys))


def _follow_keys(results: Results, path: str) -> tuple[list[str], Any, list[str]]:
    """Return the keys that a path names, the value there, and the remaining words."""
    node: Any = vars(results)
    keys: list[str] = []
    rest = split_path(path)
    while rest and isinstance(node, (dict, list, tuple)):
        if isinstance(node, dict):
            key, behind = split_leading_key(node, rest)
            if key is None:
                raise _unknown_path_error(path, keys, find_unknown_key(node, rest), sorted(node))
            node, rest = node[key], behind
            keys.append(key)
        else:
            index = _parse_index(path, keys, rest[0], INDEX, len(node))
            node, rest = node[index], rest[1:]
            keys.append(str(index))
    if isinstance(node, (dict, str)) or (node is None and rest):
        names = sorted(node) if isinstance(node, dict) else []
        raise _unknown_path_error(path, keys, rest[0] if rest else "", names)
    return keys, node, rest


def _find_axes(results: Results, keys: Sequence[str], row: Quantity | None, dimensions: int, is_timed: bool) -> Shape:
    """Return the axes of the value at these keys, the instants included if it has them."""
    if row is None or not row.units:
        return (INDEX,) * dimensions
    return ((INSTANT,) if is_timed else ()) + row.instant_axes(_is_in_cut_series(results, keys))


def _is_in_cut_series(results: Results, keys: Sequence[str]) -> bool:
    """Whether the keys lead into a series of cuts, of the whole motion or of one impulse."""
    return "s" in find_section(results, keys)


def find_section(results: Results, keys: Sequence[str]) -> Block:
    """Return the section into which the keys lead, of the whole motion or of one impulse; empty if there is none."""
    sections = results.sections
    if keys[0] == IMPULSES:
        sections, keys = results.impulses[int(keys[1])].get("sections", {}), keys[2:]
    section: Block = sections[keys[1]] if keys[0] == "sections" else {}
    return section


def _select_cut(
    results: Results, path: str, keys: Sequence[str], values: Array, axes: Shape, rest: list[str]
) -> tuple[Array, Shape, list[str]]:
    """Select a cut if one of the words names a position along the run; return the remaining values, axes and words.

    A position with its @ may also follow a component; the index of a cut must be at its own place.
    """
    k, word = axes.index(CUT), find_position_word(rest)
    remaining = rest.copy()
    if word is not None:
        remaining.remove(word)
    elif rest:
        word = remaining.pop(k if len(rest) == len(axes) else 0)
    if word is None or not is_cut_word(word):
        return values, axes, rest
    section = find_section(results, keys)
    try:
        row = find_cut_row(
            word, section["s"], section.get("side") or [None] * len(section["s"]), np.moveaxis(values, k, -1)
        )
    except Finding as finding:
        raise SpecError(Problem(finding.code, f"{path}: {finding.message}", hint=finding.hint)) from None
    return np.take(values, row, axis=k), axes[:k] + axes[k + 1 :], remaining


def _parse_index(path: str, keys: Sequence[str], word: str, axis: Axis, size: int) -> int:
    """Return the index that a word selects on an axis. Raises SpecError [unknown-path]."""
    index = axis.find_index(word, size)
    if index is None:
        allowed = [*axis.letters] or ["0" if size == 1 else f"0 ... {size - 1}"] if size else []
        raise _unknown_path_error(path, keys, word, allowed, None if size else "there is none in this run")
    return index


def _to_array(path: str, keys: Sequence[str], node: Any) -> Array:
    """Return a value as an array; None is nan. Raises SpecError [unknown-path]."""
    try:
        return np.asarray(np.nan if node is None else node, dtype=np.float64)
    except (TypeError, ValueError):
        raise _unknown_path_error(path, keys, "", []) from None


def _unknown_path_error(
    path: str, keys: Sequence[str], word: str, known_names: Collection[str], empty: str | None = None
) -> SpecError:
    """Make the error of a path that leads nowhere, with the names known there."""
    names = list(known_names)
    parent = ".".join(keys) or "the results"
    what = f"{parent} has no '{word}'" if word else f"{parent} is not a number"
    name_list = ", ".join(names[:MAX_NAMES]) + (", ..." if len(names) > MAX_NAMES else "")
    hint = NO_RUN if word.startswith("@") else empty if empty is not None else _path_hint(".".join(keys), word, names)
    return SpecError(Problem("unknown-path", f"{path}: {what}" + (f"; known: {name_list}" if names else ""), hint=hint))


def _path_hint(parent: str, word: str, known_names: Sequence[str]) -> str:
    """Suggest how a path continues, or that it ends before the word."""
    if near := find_similar(word, known_names):
        return f"did you mean {near}?"
    if known_names:
        return (
            f"continue the path: {parent}.{known_names[0].partition(' ')[0]}"
            if parent
            else f"paths begin with {known_names[0]}, for example"
        )
    return f"leave .{word} out: the path ends before it" if word else "name a number, such as energy.kinetic"
