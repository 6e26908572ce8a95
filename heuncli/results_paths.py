"""Paths into the results, as in the JSON: `joints.elbow.force.z`, `impulses.0.foundation.force.z`.

List places are numbers, or x, y, z. Where a number runs over the instants the path stops short of the instant, or names
it as the first list place.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields
from typing import Any, NamedTuple

import numpy as np

from heuncli.errors import Problem, SpecError
from heuncli.nearest import nearest
from heuncli.results import Array, Results
from heuncli.results_schema import TIMED, XYZ, is_static

MOST_NAMES = 12  # of the known names an error lists


class Found(NamedTuple):
    """What a path leads to: `values` with the instants first if `timed`, else without."""

    values: Array
    timed: bool


def find(results: Results, path: str) -> Found:
    """The numbers at a path; nan is open. Raises SpecError [unknown-path] with what is known at the place it fails."""
    node: Any = {f.name: getattr(results, f.name) for f in fields(results)}
    tokens: list[str] = path.split(".")
    walked: list[str] = []
    while tokens and not isinstance(node, np.ndarray):
        if isinstance(node, dict):
            key, used = _longest_key(node, tokens)
            if key is None:
                raise _unknown(path, walked, tokens[0], sorted(node))
            node, tokens, walked = node[key], tokens[used:], [*walked, key]
        elif isinstance(node, (list, tuple)):
            place = _place(path, walked, tokens[0], len(node))
            node, tokens, walked = node[place], tokens[1:], [*walked, str(place)]
        else:
            break
    if isinstance(node, (dict, str)) or (node is None and tokens):
        known = sorted(node) if isinstance(node, dict) else []
        raise _unknown(path, walked, tokens[0] if tokens else "", known)
    timed = isinstance(node, np.ndarray) and _is_timed(walked)
    values = _numbers(path, walked, node)
    if len(tokens) > values.ndim:
        raise _unknown(path, walked, tokens[values.ndim], [])
    if timed and len(tokens) < values.ndim:
        for token in tokens:
            values = values[:, _place(path, walked, token, values.shape[1])]
        return Found(values, timed=True)
    for token in tokens:
        values = np.asarray(values[_place(path, walked, token, len(values))])
    return Found(values, timed=False)


def _is_timed(walked: list[str]) -> bool:
    if walked[0] == "certain_sums":
        return walked[-1] == "value"
    return walked[0] in TIMED and not is_static(walked[0], walked[1:-1], walked[-1])


def _longest_key(node: dict[str, Any], tokens: list[str]) -> tuple[str | None, int]:
    """The key that the most leading tokens spell together (names of points hold a dot), and how many they are."""
    for used in range(min(len(tokens), 8), 0, -1):
        if (key := ".".join(tokens[:used])) in node:
            return key, used
    return None, 0


def _place(path: str, walked: list[str], token: str, size: int) -> int:
    place = XYZ.index(token) if token in XYZ else int(token) if token.isdecimal() else size
    if place >= size:
        raise _unknown(path, walked, token, [*XYZ[:size]] if size <= 3 else [f"0 ... {size - 1}"])
    return place


def _numbers(path: str, walked: list[str], node: Any) -> Array:
    try:
        return np.asarray(np.nan if node is None else node, dtype=np.float64)
    except (TypeError, ValueError):
        raise _unknown(path, walked, "", []) from None


def _unknown(path: str, walked: list[str], token: str, known: Iterable[str]) -> SpecError:
    names = list(known)
    at = ".".join(walked) or "the results"
    what = f"{at} has no '{token}'" if token else f"{at} is not a number"
    listed = ", ".join(names[:MOST_NAMES]) + (", ..." if len(names) > MOST_NAMES else "")
    near = nearest(token, names)
    hint = f"did you mean {near}?" if near else None
    return SpecError(Problem("unknown-path", f"{path}: {what}" + (f"; known: {listed}" if names else ""), hint=hint))
