"""What is not finite in the results, and not open: an error in place of a number that is none.

`nan` stands for what no law decides (and is `null` in JSON): loads of joints and sections that are open, axes and lines
that a wrench does not have, and what rounding reaches beside a singular pose. Everything else is a number.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from heuncli.base.errors import Problem, SolveError
from heuncli.results.results import Array, Mask, Results
from heuncli.results.results_schema import BLOWS, REPORT_OF, SPACE, Quantity, quantity

# where a number may be none: loads that supports leave open, the axis or line of a wrench that has none
MAY_BE_NONE = (
    "joints.JOINT.", "stops.", "couplings.", "sections.", "foundation.supports.", "foundation.elements.",
    "foundation.axis.", "bodies.BODY.rodrigues",
)  # fmt: skip
BLOCKS = ("time", *REPORT_OF, BLOWS, "events", "certain_sums", "accuracy")  # causes before what follows from them
NumericLeaves = Iterator[tuple[tuple[str, ...], Any, Mapping[str, Any]]]


def require_finite(results: Results) -> Results:
    """The results, if all that is not open in them is finite. Raises SolveError with the first path that is not."""
    unknown = results.accuracy.get("unknown", ())
    known = ~np.isin(results.time, unknown) if len(unknown) else np.ones(len(results.time), dtype=bool)
    named = vars(results)
    require_finite_blocks({name: named[name] for name in BLOCKS if len(named[name])}, results.time, known)
    return results


def require_finite_blocks(blocks: Mapping[str, Any], times: Array, known: Mask) -> None:
    """Raise SolveError with the first path in some blocks of results that is neither finite nor open.

    times, known (n_t,): the instants, and at which all is told.
    """
    if all_finite(blocks):
        return
    for keys, value, block in leaves(blocks, (), {}):
        if is_wrong(keys, value, block, known):
            instant = at_instant(keys, value, times, known)
            message = f"{'.'.join(keys)} is not finite{instant}: there is no such number"
            hint = "look at very large and very small values nearby, and at points that coincide"
            raise SolveError(Problem("not-finite-result", message, hint=hint))


def all_finite(node: Any) -> bool:
    """Whether all numbers below a node of the results are finite, as they are where nothing is open."""
    if isinstance(node, np.ndarray):
        return node.dtype.kind != "f" or bool(np.isfinite(node).all())
    if isinstance(node, float):
        return math.isfinite(node)
    if isinstance(node, list | tuple):
        return all(map(all_finite, node))
    return not isinstance(node, Mapping) or all(map(all_finite, node.values()))


def leaves(node: Any, keys: tuple[str, ...], block: Mapping[str, Any]) -> NumericLeaves:
    """The arrays and numbers below a node of the results: their path, their value, the block they stand in."""
    if isinstance(node, float | np.ndarray):
        yield keys, node, block
    elif isinstance(node, Mapping):
        for name, member in node.items():
            yield from leaves(member, (*keys, name), node)
    elif isinstance(node, list | tuple) and node and not isinstance(node[0], str):
        for i, member in enumerate(node):
            yield from leaves(member, (*keys, str(i)), block)


def is_wrong(keys: tuple[str, ...], value: Array | float, block: Mapping[str, Any], known: Mask) -> bool:
    """Whether a number is neither finite nor open."""
    if isinstance(value, float) and math.isfinite(value):
        return False
    array = np.asarray(value)
    if array.dtype.kind != "f" or np.isfinite(array).all():
        return False
    if np.isinf(array).any():
        return True
    row = quantity(keys)
    if row is None:
        return True
    path = row.path.removeprefix("impulses.NUMBER.")
    if row.timed and keys[0] != BLOWS and len(array) == len(known):
        array = array[known]
    if not path.startswith(MAY_BE_NONE):
        return bool(np.isnan(array).any())
    return "open" in block and path.startswith("joints.") and bool((nan_in(array, row) & ~named_open(row, block)).any())


def nan_in(array: Array, row: Quantity) -> Mask:
    """Whether each component of a quantity is nan at some instant: (3,) for a vector, else (1,)."""
    return np.asarray(np.isnan(array).reshape(-1, 3 if row.shape == (SPACE,) else 1).any(axis=0))


def named_open(row: Quantity, block: Mapping[str, Any]) -> Mask:
    """Whether each component of a joint's load is among those that its block names as open."""
    name = row.path.rpartition(".")[2]
    names = [f"{name}.{c}" for c in SPACE.letters] if row.shape == (SPACE,) else [name]
    return np.array([name in block["open"] for name in names])


def at_instant(keys: tuple[str, ...], value: Array | float, times: Array, known: Mask) -> str:
    """The first instant at which a number is not finite, in words; nothing of what does not run over the instants."""
    row = quantity(keys)
    if row is None or not row.timed or keys[0] == BLOWS or not isinstance(value, np.ndarray):
        return ""
    off = ~np.isfinite(value).reshape(len(value), -1).all(axis=1) & known
    return f" at t = {times[int(np.argmax(off))]:.6g} s" if off.any() else ""
