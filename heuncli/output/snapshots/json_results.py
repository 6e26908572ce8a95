"""Make a run snapshot from a result in JSON, with extremes of its samples only: the file holds nothing between them.

The file holds the names in the scene but not the kinds: whether a joint turns or slides follows from its coordinates.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from heuncli.base.errors import Finding
from heuncli.base.joint_kinds import TYPES
from heuncli.base.tolerances import SAME_INSTANT
from heuncli.output.snapshots.golden_file import N_EVEN, RunSnapshot
from heuncli.output.snapshots.record import (
    ResultView,
    SnapshotBounds,
    SnapshotCourse,
    SnapshotScope,
    collect_all_columns,
    make_run_snapshot,
)
from heuncli.output.tables.page import Page, make_page
from heuncli.results.path_words import find_quantity
from heuncli.results.results import Array, Block, Magnitudes, Results
from heuncli.results.results_schema import REPORT_OF
from heuncli.study.quantities.channels import iter_channels
from heuncli.study.quantities.digits import largest_magnitude
from heuncli.study.quantities.labels import ForceInfo, JointInfo, Labels
from heuncli.study.quantities.table_units import Units

REQUIRED_KEYS = ("model", "status", "time", "accuracy")
EXAMPLE_HINT = "heun run SPEC --format json writes one"
KIND_DEPENDENT = ("value", "rate")  # of a load: units depend on its kind
UNKNOWN_UNIT = ""  # unit of a load of unknown kind


def read_run_snapshot(data: Mapping[str, Any], indices: Sequence[int] | None = None) -> RunSnapshot:
    """Make the snapshot of a result; indices: restrict it to these of its instants. Raises Finding [not-a-result].

    Its errors are those of the whole result, as they are shares of the largest number in it.
    """
    missing_keys = [key for key in REQUIRED_KEYS if key not in data]
    if missing_keys:
        raise Finding("not-a-result", f"not a result of heun run: '{missing_keys[0]}' is missing", EXAMPLE_HINT)
    try:
        results = _to_results(data)
        labels = _infer_labels(results)
        page = make_page(results, labels, _find_magnitudes(results, labels))
        scope = SnapshotScope(frozenset(REPORT_OF[block] for block in REPORT_OF if getattr(results, block)), labels)
        if indices is not None:
            results = _to_results(_select_instants(data, indices))
            page = make_page(results, labels, _find_magnitudes(results, labels))._replace(
                stated_errors=page.stated_errors
            )
        run = make_run_snapshot(_make_course(page, results, scope), page, scope)
    except (KeyError, IndexError, TypeError, ValueError, AttributeError) as error:
        raise Finding("not-a-result", f"incomplete result of heun run: {error!s:.100}", EXAMPLE_HINT) from None
    unclear = {f"joints.{name}.drive" for name in results.joints if name not in labels.joints}
    unclear |= {
        f"forces.{name}.{key}" for name in results.forces if name not in labels.forces for key in KIND_DEPENDENT
    }
    numbers = {
        path: number.model_copy(update={"unit": UNKNOWN_UNIT}) if path in unclear else number
        for path, number in run.numbers.items()
    }
    return run.model_copy(update={"numbers": numbers})


def read_instants(data: Mapping[str, Any]) -> Array:
    """Return the instants of a result, (n,)."""
    return np.atleast_1d(np.asarray(data["time"], dtype=np.float64))


def find_common_instants(first: Mapping[str, Any], second: Mapping[str, Any]) -> tuple[list[int], list[int]]:
    """Return the indices of the common instants of two results, in each of them."""
    times, second_times = read_instants(first), read_instants(second)
    tolerance = SAME_INSTANT * max(float(np.ptp(times)), float(np.ptp(second_times)))
    nearest = (
        np.abs(times[:, None] - second_times[None, :]).argmin(axis=1)
        if len(second_times)
        else np.zeros(0, dtype=np.intp)
    )
    pairs = [(i, int(k)) for i, k in enumerate(nearest) if abs(times[i] - second_times[k]) <= tolerance]
    increasing = [pair for n, pair in enumerate(pairs) if not n or pair[1] > pairs[n - 1][1]]
    return [i for i, _ in increasing], [k for _, k in increasing]


def _select_instants(data: Mapping[str, Any], indices: Sequence[int]) -> dict[str, Any]:
    """Return a result at some of its instants."""
    n = len(read_instants(data))

    def select(values: Any) -> Any:
        return [values[i] for i in indices] if isinstance(values, list) and len(values) == n else values

    def select_timed(keys: tuple[str, ...], value: Any) -> Any:
        if isinstance(value, Mapping):
            return {key: select_timed((*keys, key), member) for key, member in value.items()}
        row = find_quantity(keys)
        return select(value) if row is not None and row.is_timed else value

    selected = {key: select_timed((key,), value) for key, value in data.items()}
    selected["time"] = [read_instants(data)[i] for i in indices]
    if "certain_sums" in data:
        selected["certain_sums"] = [
            {
                "terms": {path: select(factor) for path, factor in block["terms"].items()},
                "value": select(block["value"]),
                **({"unit": block["unit"]} if "unit" in block else {}),
            }
            for block in data["certain_sums"]
        ]
    return selected


def _to_results(data: Mapping[str, Any]) -> Results:
    """Convert the blocks to arrays, with nan for `null`. Raises ValueError if a length is wrong."""
    known = {field.name for field in fields(Results)}
    blocks = {key: _to_arrays((key,), value) for key, value in data.items() if key in known}
    blocks["time"] = np.atleast_1d(np.asarray(data["time"], dtype=np.float64))
    if blocks["time"].ndim != 1 or not len(blocks["time"]) or not np.all(np.isfinite(blocks["time"])):
        raise ValueError("time: expected a list of times")
    accuracy = dict(data["accuracy"])
    estimate = accuracy.get("estimate") or {}
    accuracy["estimate"] = {kind: float("inf") if error is None else float(error) for kind, error in estimate.items()}
    results = Results(**{"title": "", "spec": {}, "version": "", **blocks, "accuracy": accuracy})
    for keys, value in _iter_leaves(data):
        row = find_quantity(keys)
        is_course = row is not None and row.is_timed and row.units and isinstance(value, list)
        if is_course and len(value) != len(results.time):
            raise ValueError(f"{'.'.join(keys)}: {len(value)} values at {len(results.time)} instants")
    return results


def _iter_leaves(block: Any, keys: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Yield the values below all keys, except within lists of blocks."""
    if not isinstance(block, Mapping):
        yield keys, block
        return
    for key, value in block.items():
        yield from _iter_leaves(value, (*keys, key))


def _to_arrays(keys: tuple[str, ...], value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _to_arrays((*keys, key), member) for key, member in value.items()}
    if not isinstance(value, list) or not value:
        return value
    if any(isinstance(member, dict) for member in value):
        return [_to_arrays((*keys, str(number)), member) for number, member in enumerate(value)]
    return np.array(value, dtype=np.float64) if _is_numeric(value) else value


def _is_numeric(value: Any) -> bool:
    """Return whether nested lists contain only numbers and `null`."""
    if isinstance(value, list):
        return all(map(_is_numeric, value))
    return value is None or (isinstance(value, (int, float)) and not isinstance(value, bool))


def _infer_labels(results: Results) -> Labels:
    """Infer the kinds of joints and loads, as far as their blocks show them."""
    joints = {name: JointInfo("rod", "", "") for name, joint in results.joints.items() if "tension" in joint}
    for name, block in results.coordinates.items():
        coordinates = tuple(word for word in ("angle", "travel") if word in block)
        kind = next((kind.name for kind in TYPES.values() if kind.coordinates == coordinates), "ball")
        joints[name] = JointInfo(kind, "", "")
    forces = {
        name: ForceInfo("turn_spring", turning=True) if "angle" in block else ForceInfo("spring")
        for name, block in results.forces.items()
        if "angle" in block or "length" in block
    }
    return Labels(joints, forces, units=Units({}), captions=results.labels)


def _find_magnitudes(results: Results, labels: Labels) -> Magnitudes:
    """Find the largest numbers by unit, and the size of the scene from the places of its bodies and points [m]."""
    by_unit: dict[str, float] = {}
    for channel in iter_channels(results, labels):
        by_unit[channel.unit] = max(by_unit.get(channel.unit, 0.0), largest_magnitude(channel.values))
    places = [block[key].reshape(-1, 3) for block, key in _iter_located_blocks(results)]
    size = float(np.ptp(np.concatenate(places), axis=0).max()) if places else 0.0
    return Magnitudes(by_unit, size or 1.0, size or 1.0, {})


def _iter_located_blocks(results: Results) -> Iterator[tuple[Block, str]]:
    for body in results.bodies.values():
        yield from ((dict(body), key) for key in ("position", "center") if key in body)
    for blocks, key in ((results.points, "position"), (results.joints, "point")):
        yield from ((dict(block), key) for block in blocks.values() if key in block)


def _make_course(page: Page, results: Results, scope: SnapshotScope) -> SnapshotCourse:
    """Return the columns with the extremes of their samples, and at even instants if there are samples."""
    view = ResultView(results, page.labels, page.stated_errors)
    columns = collect_all_columns(results, scope)
    page_columns = collect_all_columns(page.results, scope)
    even_samples = _choose_even_samples(results.time)
    even = {path: column.values[even_samples] for path, column in columns.items()}
    bounds = {path: _find_bounds(path, column.values, page.results.time) for path, column in page_columns.items()}
    return SnapshotCourse(view, columns, even, results.time[even_samples], bounds, {})


def _choose_even_samples(times: Array) -> slice:
    """Return the slice of eleven samples at even instants; empty if there are none."""
    last = len(times) - 1
    even_times = np.linspace(times[0], times[-1], len(times))
    if (
        last < N_EVEN - 1
        or last % (N_EVEN - 1)
        or np.any(np.abs(even_times - times) > SAME_INSTANT * (times[-1] - times[0]))
    ):
        return slice(0)
    return slice(None, None, last // (N_EVEN - 1))


def _find_bounds(path: str, values: Array, times: Array) -> SnapshotBounds:
    """Return the lowest and highest of the samples; of a series of cuts only the one that belongs to the column."""
    if not np.isfinite(values).any():
        low = high = (float("nan"), float(times[0]), None)
    else:
        lowest, highest = int(np.nanargmin(values)), int(np.nanargmax(values))
        low = float(values[lowest]), float(times[lowest]), None
        high = float(values[highest]), float(times[highest]), None
    return SnapshotBounds(None if path.endswith(".highest") else low, None if path.endswith(".lowest") else high)
