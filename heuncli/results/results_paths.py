"""Paths into the results, as in the JSON: `joints.elbow.force.z`, `impulses.0.foundation.force.z`.

Places in lists are numbers, or x, y, z on axes of space. Where a number runs over the instants the path stops short of
the instant, or names it as the first place.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np

from heuncli.base.errors import Finding, Problem, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.nearest import begin_file, nearest
from heuncli.results.cut_rows import row_at
from heuncli.results.results import Array, Block, Results
from heuncli.results.results_schema import (
    BLOWS,
    CUT,
    INDEX,
    INSTANT,
    SPACE,
    Axis,
    Quantity,
    Shape,
    is_no_number,
    leading_key,
    quantity,
    unknown_key,
)  # fmt: skip
from heuncli.results.run_places import NO_RUN, marked, names_a_cut, path_of, words_of

MOST_NAMES = 12  # of the known names an error lists


class Numbers(NamedTuple):
    """What a path leads to: `values` with the instants first if `timed`, and the other axes as the schema has them.

    instant: the number of the instant that the path names; keys: the words of the path that name the quantity.
    """

    values: Array
    timed: bool
    axes: Shape
    instant: int | None = None
    keys: tuple[str, ...] = ()

    @property
    def of_vectors(self) -> bool:
        """Whether the last axis is that of a vector's components; a run of three cuts is none."""
        return self.axes[-1:] == (SPACE,)

    @property
    def bent(self) -> bool:
        """Whether it is of a section and no polynomial of its loads: stresses, and where the reduction line lies."""
        return self.keys[:1] == ("sections",) and self.keys[2:3] in (("stress",), ("line",))


def find(results: Results, path: str) -> Numbers:
    """The numbers at a path; nan is open. Raises SpecError [unknown-path] with what is known at the place it fails."""
    try:
        return _found(results, path)
    except SpecError as error:
        from heuncli.results.path_hints import meant  # only on the way to an error

        begin_file()  # the spec's own problems are behind
        (problem,) = error.problems
        likely = meant(path, lambda words: _leads(results, words)) if problem.code == "unknown-path" else None
        if likely is None:
            raise
        raise SpecError(problem._replace(hint=f"did you mean {likely}?")) from None


def _leads(results: Results, words: Sequence[str]) -> bool:
    """Whether there is a number at a path."""
    try:
        _found(results, path_of(words))
    except SpecError:
        return False
    return True


def _found(results: Results, path: str) -> Numbers:
    keys, node, rest = _walk(results, path)
    if is_no_number(keys):
        raise _unknown(path, keys, "", [])
    values = _numbers(path, keys, node)
    row = quantity(keys)
    # a blow has one instant, and no axis for it
    timed = row is not None and row.timed and keys[0] != "impulses" and isinstance(node, np.ndarray)
    axes = _axes(results, keys, row, values.ndim, timed)
    if CUT in axes:
        values, axes, rest = _at_a_cut(results, path, keys, values, axes, rest)
    if len(rest) > len(axes):
        raise _unknown(path, keys, rest[len(axes)], [])
    instant = None
    if timed and len(rest) == len(axes):
        timed, instant = False, _index(path, keys, rest[0], axes[0], len(values))
    elif timed:
        for word in rest:
            values = values[:, _index(path, keys, word, axes[1], values.shape[1])]
            axes = (axes[0], *axes[2:])
        return Numbers(values, True, axes[1:], keys=tuple(keys))
    for word in rest:
        values = np.asarray(values[_index(path, keys, word, axes[0], len(values))])
        axes = axes[1:]
    return Numbers(values, False, axes, instant, tuple(keys))


def _walk(results: Results, path: str) -> tuple[list[str], Any, list[str]]:
    """The keys that a path names, what stands there, and the places behind them."""
    node: Any = vars(results)
    keys: list[str] = []
    rest = words_of(path)
    while rest and isinstance(node, (dict, list, tuple)):
        if isinstance(node, dict):
            key, behind = leading_key(node, rest)
            if key is None:
                raise _unknown(path, keys, unknown_key(node, rest), sorted(node))
            node, rest = node[key], behind
            keys.append(key)
        else:
            at = _index(path, keys, rest[0], INDEX, len(node))
            node, rest = node[at], rest[1:]
            keys.append(str(at))
    if isinstance(node, (dict, str)) or (node is None and rest):
        known = sorted(node) if isinstance(node, dict) else []
        raise _unknown(path, keys, rest[0] if rest else "", known)
    return keys, node, rest


def _axes(results: Results, keys: Sequence[str], row: Quantity | None, dimensions: int, timed: bool) -> Shape:
    """The axes of what stands under the keys, the instants among them if it runs over them."""
    if row is None or not row.units:
        return (INDEX,) * dimensions
    return ((INSTANT,) if timed else ()) + row.axes(run=_is_run(results, keys))


def _is_run(results: Results, keys: Sequence[str]) -> bool:
    """Whether the keys lead into a run of cuts, of the whole motion or of one blow."""
    return "s" in section_of(results, keys)


def section_of(results: Results, keys: Sequence[str]) -> Block:
    """The section into which the keys lead, of the whole motion or of one blow; empty where they lead into none."""
    sections = results.sections
    if keys[0] == BLOWS:
        sections, keys = results.impulses[int(keys[1])].get("sections", {}), keys[2:]
    section: Block = sections[keys[1]] if keys[0] == "sections" else {}
    return section


def _at_a_cut(
    results: Results, path: str, keys: Sequence[str], values: Array, axes: Shape, rest: list[str]
) -> tuple[Array, Shape, list[str]]:
    """The values, axes and words that are left where one of the words names a place along the run of cuts.

    A place with its @ may stand behind a component, too; the number of a cut stands in its own place.
    """
    k, word = axes.index(CUT), marked(rest)
    left = rest.copy()
    if word is not None:
        left.remove(word)
    elif rest:
        word = left.pop(k if len(rest) == len(axes) else 0)
    if word is None or not names_a_cut(word):
        return values, axes, rest
    section = section_of(results, keys)
    try:
        row = row_at(word, section["s"], section.get("side") or [None] * len(section["s"]), np.moveaxis(values, k, -1))
    except Finding as finding:
        raise SpecError(Problem(finding.code, f"{path}: {finding.message}", hint=finding.hint)) from None
    return np.take(values, row, axis=k), axes[:k] + axes[k + 1 :], left


def _index(path: str, keys: Sequence[str], word: str, axis: Axis, size: int) -> int:
    index = axis.index_of(word, size)
    if index is None:
        known = [*axis.letters] or ["0" if size == 1 else f"0 ... {size - 1}"] if size else []
        raise _unknown(path, keys, word, known, None if size else "there is none in this run")
    return index


def _numbers(path: str, keys: Sequence[str], node: Any) -> Array:
    try:
        return np.asarray(np.nan if node is None else node, dtype=np.float64)
    except (TypeError, ValueError):
        raise _unknown(path, keys, "", []) from None


def _unknown(path: str, keys: Sequence[str], word: str, known: Collection[str], empty: str | None = None) -> SpecError:
    names = list(known)
    at = ".".join(keys) or "the results"
    what = f"{at} has no '{word}'" if word else f"{at} is not a number"
    listed = ", ".join(names[:MOST_NAMES]) + (", ..." if len(names) > MOST_NAMES else "")
    hint = NO_RUN if word.startswith("@") else empty if empty is not None else _hint(".".join(keys), word, names)
    return SpecError(Problem("unknown-path", f"{path}: {what}" + (f"; known: {listed}" if names else ""), hint=hint))


def _hint(at: str, word: str, known: Sequence[str]) -> str:
    """Where a path leads on, or that it ends before the word."""
    if near := nearest(word, known):
        return f"did you mean {near}?"
    if known:
        return f"a path that leads on: {at}.{known[0].partition(' ')[0]}" if at else f"it begins with {known[0]}, say"
    return f"leave .{word} out: the path ends before it" if word else "name a number, as energy.kinetic"
